use super::error::{Place, TableError, quoted};
use super::heading::{
    HUB_MOTION, Header, Heading, Quantity, TORQUE, check_names, find_column, find_time, names,
    nearest, refuse_missing, split_unit,
};
use super::samples::Samples;
use crate::numeric::reads_as_unit;
use crate::response::{HubReference, Torque};

/// Reads a torque over time: a row of names, then a row for each sample.
///
/// Without `column` the torque is the column `torque`, `torque_n_m`, `hub_torque` or
/// `hub_torque_n_m`; with it, the column of that name, with or without the unit in brackets. The unit
/// is N m unless one follows the name in brackets. Other columns than time and torque are ignored.
///
/// ```
/// use flexlink::csv::read_torque_table;
/// let file = b"time [ms],motor [N cm],state\n0,0,idle\n1,50,run\n2,50,run\n3,0,idle\n";
/// let torque = read_torque_table("lab.csv", file, Some("motor"))?;
/// assert_eq!(torque.torque_n_m(), [0.0, 0.5, 0.5, 0.0]);
/// assert_eq!(torque.grid().step_s, 0.001);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_torque_table(
    name: &str,
    bytes: &[u8],
    column: Option<&str>,
) -> Result<Torque, TableError> {
    let mut samples =
        Samples::read(name, bytes, |fields, place| read_torque_header(fields, column, place))?;
    let time_s = samples.take(Quantity::Time).unwrap_or_default();
    let torque_n_m = samples.take(Quantity::Torque).unwrap_or_default();
    Torque::new(&time_s, torque_n_m).map_err(|error| samples.refuse_history(name, &error))
}

/// Reads the hub motion that a feedback follows: `hub_angle`, and `hub_rate` if it is given, as in the
/// `hub_angle.csv` of `solve`. Other columns are ignored.
///
/// ```
/// use flexlink::csv::read_hub_reference;
/// let file = b"time_s,hub_angle [deg],note\n0,0,\n1,90,\n2,180,\n3,180,\n";
/// let reference = read_hub_reference("hub_angle.csv", file)?;
/// assert_eq!(reference.angle_rad()[2], std::f64::consts::PI);
/// assert_eq!(reference.rate_rad_s(), None);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and line and column where they are at fault.
pub fn read_hub_reference(name: &str, bytes: &[u8]) -> Result<HubReference, TableError> {
    let mut samples = Samples::read(name, bytes, read_hub_header)?;
    let time_s = samples.take(Quantity::Time).unwrap_or_default();
    let angle_rad = samples.take(Quantity::HubAngle).unwrap_or_default();
    let rate_rad_s = samples.take(Quantity::HubRate);
    HubReference::new(&time_s, angle_rad, rate_rad_s)
        .map_err(|error| samples.refuse_history(name, &error))
}

fn read_hub_header(fields: &[&str], place: Place) -> Result<Header, TableError> {
    check_names(fields, &HUB_MOTION, place)?;
    let time = find_time(fields, &HUB_MOTION, place)?;
    let angle = find_column(fields, Quantity::HubAngle, &HUB_MOTION, place)?.ok_or_else(|| {
        let hint = "hub_angle.csv of `flexlink solve` holds it".to_owned();
        refuse_missing(&names(fields), Quantity::HubAngle.word(), place).or_hint(hint)
    })?;
    let rate = find_column(fields, Quantity::HubRate, &HUB_MOTION, place)?;
    Ok(Header { width: fields.len(), headings: [time, angle].into_iter().chain(rate).collect() })
}

const IN_BRACKETS: &str = "a unit follows in brackets: torque [N cm]";

/// Reads the first row of a recording: the column of time, and the one named `column` or, without it,
/// the one named torque.
pub(super) fn read_torque_header(
    fields: &[&str],
    column: Option<&str>,
    place: Place,
) -> Result<Header, TableError> {
    check_names(fields, &TORQUE, place)?;
    let time = find_time(fields, &TORQUE, place)?;
    let torque = match column {
        Some(column) => chosen_torque(fields, column, &time, place)?,
        None => find_column(fields, Quantity::Torque, &TORQUE, place)?
            .ok_or_else(|| no_torque(fields, place))?,
    };
    Ok(Header { width: fields.len(), headings: vec![time, torque] })
}

fn no_torque(fields: &[&str], place: Place) -> TableError {
    let word = Quantity::Torque.word();
    let hint = match fields.iter().find(|field| field.to_lowercase().contains(word)) {
        Some(field) if unread_unit(field).is_some() => IN_BRACKETS.to_owned(),
        Some(field) => format!("choose the torque with --column {}", quoted(split_unit(field).0)),
        None => "choose the torque with --column NAME".to_owned(),
    };
    refuse_missing(&names(fields), word, place).or_hint(hint)
}

/// The heading of the torque named `column`.
fn chosen_torque(
    fields: &[&str],
    column: &str,
    time: &Heading,
    place: Place,
) -> Result<Heading, TableError> {
    let index = chosen_index(fields, column, place)?;
    if index == time.index {
        return Err(place.refuse("--column", quoted(column), "must be a torque, not the time"));
    }
    let field = fields[index];
    if let Some(word) = unread_unit(field) {
        let must = format!("must tell its unit in brackets: {} reads like one", quoted(word));
        let subject = format!("column {}", index + 1);
        return Err(place.refuse(subject, quoted(field), must).with_hint(IN_BRACKETS.to_owned()));
    }
    let suffixed = Quantity::Torque.is_suffixed(split_unit(field).0);
    Heading::of(index, field, Quantity::Torque, suffixed, place)
}

/// Index of the one column whose heading is `column`, with or without its unit.
fn chosen_index(fields: &[&str], column: &str, place: Place) -> Result<usize, TableError> {
    // A comma too many leaves a column without a name.
    if column.is_empty() {
        return Err(place.refuse("--column", "nothing", "must name a column"));
    }
    let whole = indices(fields, |field| field == column);
    let found = if whole.is_empty() {
        indices(fields, |field| split_unit(field).0 == column)
    } else {
        whole
    };
    match found[..] {
        [] => Err(unknown_column(fields, column, place)),
        [index] => Ok(index),
        [first, second, ..] => {
            let must = format!("must not repeat column {}, {}", first + 1, quoted(fields[first]));
            let hint = if fields[first] == fields[second] {
                "rename one of them".to_owned()
            } else {
                format!("choose one with its unit: --column {}", quoted(fields[first]))
            };
            let subject = format!("column {}", second + 1);
            Err(place.refuse(subject, quoted(fields[second]), must).with_hint(hint))
        }
    }
}

fn indices(fields: &[&str], is_meant: impl Fn(&str) -> bool) -> Vec<usize> {
    (0..fields.len()).filter(|&index| is_meant(fields[index])).collect()
}

fn unknown_column(fields: &[&str], column: &str, place: Place) -> TableError {
    let names = names(fields);
    let same = |name: &&&str| name.to_lowercase() == column.to_lowercase();
    let meant = names.iter().find(same).copied().or_else(|| nearest(column, names.clone()));
    let hint = meant.map(|name| format!("did you mean {}?", quoted(name)));
    let must = format!("must be one of the columns {}", quoted(&names.join(",")));
    place.refuse("--column", quoted(column), must).with_hint(hint)
}

/// The last word of a name without a unit in brackets, if that word reads like a unit other than the
/// suffix `_n_m`: `torque_n_cm`, `Torque (Nm)`, `hub_angle_rad`. Such a column may not be in SI.
fn unread_unit(field: &str) -> Option<&str> {
    let (name, unit) = split_unit(field);
    if unit.is_some() || Quantity::Torque.is_suffixed(name) {
        return None;
    }
    let mut words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.next()?;
    words.next_back().filter(|word| reads_as_unit(word))
}
