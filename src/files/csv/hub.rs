use super::columns::{Columns, Header};
use super::format::{Reading, TableFormat};
use super::heading::{
    HUB_ANGLE, HUB_RATE, Heading, Spelling, TIME, TORQUE, Vocabulary, names, nearest, require,
    unread_unit,
};
use super::outliers::doubt;
use super::rows::{Place, TableError, quoted};
use super::samples::{Samples, refuse_samples};
use super::unit_name::{parse_unit, split_any_unit, split_unit};
use crate::response::{HubReference, Torque};

/// Names of a torque at the hub.
const RECORDING: Vocabulary = Vocabulary {
    quantities: &[TIME, TORQUE],
    prefix: "hub_",
    example: "time,torque",
    choice: Some("rename one of them, or choose a torque with --column"),
    by_option: "--columns time=1,torque=2 says which column is what",
};

/// Names of the hub's motion.
const HUB_MOTION: Vocabulary = Vocabulary {
    quantities: &[TIME, HUB_ANGLE, HUB_RATE],
    prefix: "",
    example: "time,hub_angle",
    choice: Some("rename one of them"),
    // Options do not apply to a reference.
    by_option: "",
};

/// Reads a torque over time: a row of names, then a row for each sample.
///
/// Without `column` the torque is the column `torque`, `torque_n_m`, `hub_torque` or `hub_torque_n_m`; with it, the
/// column of that name, with or without the unit in brackets. The unit is N m unless one follows the name in brackets.
/// Other columns than time and torque are ignored.
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
/// [`TableError`] names the file, and the faulty line and column.
pub fn read_torque_table(
    name: &str,
    bytes: &[u8],
    column: Option<&str>,
) -> Result<Torque, TableError> {
    let read = read_torque_table_as(name, bytes, column, &TableFormat::default());
    read.map(|(torque, _)| torque)
}

/// Reads a torque from a table with the user's options for its form; also returns its deviations from the standard
/// form.
///
/// # Errors
/// Those of [`read_torque_table`]; also options that do not fit the table.
pub fn read_torque_table_as(
    name: &str,
    bytes: &[u8],
    column: Option<&str>,
    format: &TableFormat,
) -> Result<(Torque, Reading), TableError> {
    let mut samples = Samples::read(name, bytes, format, |header| torque_columns(header, column))?;
    doubt(&mut samples);
    let (time_s, [torque_n_m]) = samples.take_uniform([TORQUE]);
    let Samples { lines, reading, .. } = samples;
    let torque = Torque::new(&time_s, torque_n_m.unwrap_or_default())
        .map_err(|error| refuse_samples(name, &lines, error.sample(), &error, error.hint()))?;
    Ok((torque, reading))
}

/// Reads a motion of the hub, for a feedback or as an input: `hub_angle`, and optionally `hub_rate`, as in the
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
/// [`TableError`] names the file, and the faulty line and column.
pub fn read_hub_reference(name: &str, bytes: &[u8]) -> Result<HubReference, TableError> {
    read_hub_reference_as(name, bytes, &TableFormat::default()).map(|(reference, _)| reference)
}

/// Reads a hub reference from a table with the user's options for its form; also returns its deviations from the
/// standard form.
///
/// # Errors
/// Those of [`read_hub_reference`]; also options that do not fit the table.
pub fn read_hub_reference_as(
    name: &str,
    bytes: &[u8],
    format: &TableFormat,
) -> Result<(HubReference, Reading), TableError> {
    let mut samples = Samples::read(name, bytes, format, hub_columns)?;
    doubt(&mut samples);
    let (time_s, [angle_rad, rate_rad_s]) = samples.take_uniform([HUB_ANGLE, HUB_RATE]);
    let Samples { lines, reading, .. } = samples;
    let reference = HubReference::new(&time_s, angle_rad.unwrap_or_default(), rate_rad_s)
        .map_err(|error| refuse_samples(name, &lines, error.sample(), &error, error.hint()))?;
    Ok((reference, reading))
}

fn hub_columns(header: Header) -> Result<(Columns, Reading), TableError> {
    let Header { fields, place, .. } = header;
    let columns = Columns::find(&HUB_MOTION, header)?;
    require(&columns.headings, TIME, fields, place)?;
    require(&columns.headings, HUB_ANGLE, fields, place)
        .map_err(|error| error.or_hint("hub_angle.csv of `flexlink solve` holds it".to_owned()))?;
    Ok((columns, Reading::default()))
}

const IN_BRACKETS: &str = "a unit follows in brackets: torque [N cm]";

/// Finds the time and the torque named `column` or, without it, `torque`.
fn torque_columns(header: Header, column: Option<&str>) -> Result<(Columns, Reading), TableError> {
    let Header { fields, place, .. } = header;
    let Some(column) = column else {
        let columns = Columns::find(&RECORDING, header)?;
        let by_option = || RECORDING.by_option.to_owned();
        require(&columns.headings, TIME, fields, place)
            .map_err(|error| error.or_hint(by_option()))?;
        require(&columns.headings, TORQUE, fields, place)
            .map_err(|error| error.or_hint(where_torque_is(fields)))?;
        return Ok((columns, Reading::default()));
    };
    RECORDING.check_names(fields, place)?;
    let torque = chosen_torque(header, column)?;
    let columns = Columns::find_beside(&RECORDING, header, Some(torque))?;
    require(&columns.headings, TIME, fields, place)?;
    Ok((columns, Reading::default()))
}

/// Hint for choosing the torque in a table without a column of its name.
fn where_torque_is(fields: &[&str]) -> String {
    match fields.iter().find(|field| field.to_lowercase().contains(TORQUE.word)) {
        Some(field) if unread_unit(field, TORQUE).is_some() => IN_BRACKETS.to_owned(),
        Some(field) => format!("choose the torque with --column {}", quoted(split_unit(field).0)),
        None => "choose the torque with --column NAME".to_owned(),
    }
}

/// Heading of the torque named `column`.
fn chosen_torque(header: Header, column: &str) -> Result<Heading, TableError> {
    let Header { fields, format, place } = header;
    let refuse = |found: String, must| Err(place.refuse("--column", found, must));
    if format.columns.iter().any(|choice| choice.quantity == TORQUE) {
        return refuse(quoted(column), "must not be given with --columns torque");
    }
    let index = chosen_index(fields, column, place)?;
    let field = fields[index];
    if matches!(RECORDING.spelling(field, TIME), Some(Spelling::Exact | Spelling::Suffixed)) {
        return refuse(quoted(column), "must be a torque, not the time");
    }
    let measure = format.measure(TORQUE);
    let unread = unread_unit(field, TORQUE).filter(|_| measure.unit.is_none());
    let round = split_any_unit(field).1.filter(|_| split_unit(field).1.is_none());
    let is_unit = round.is_some_and(|unit| parse_unit(unit).is_ok());
    if let (Some(word), false) = (unread, is_unit) {
        let must = format!("must have its unit in brackets: {} reads like one", quoted(word));
        return Err(place.refuse_column(index, field, must).with_hint(IN_BRACKETS.to_owned()));
    }
    // Parentheses may also contain a remark.
    let field = if round.is_some() && !is_unit { split_any_unit(field).0 } else { field };
    let suffixed = TORQUE.is_suffixed(split_unit(field).0);
    Heading::of(index, field, TORQUE, suffixed, measure, place)
}

/// Index of the only column with the heading `column`, with or without its unit.
fn chosen_index(fields: &[&str], column: &str, place: Place) -> Result<usize, TableError> {
    // A surplus comma leaves a column without a name.
    if column.is_empty() {
        return Err(place.refuse("--column", "nothing", "must name a column"));
    }
    let all = |is_meant: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..fields.len()).filter(|index| is_meant(fields[*index])).collect()
    };
    let mut found = all(&|field| field == column);
    if found.is_empty() {
        found = all(&|field| split_unit(field).0 == column);
    }
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
            Err(place.refuse_column(second, fields[second], must).with_hint(hint))
        }
    }
}

fn unknown_column(fields: &[&str], column: &str, place: Place) -> TableError {
    let names = names(fields);
    let same = |name: &&&str| name.to_lowercase() == column.to_lowercase();
    let meant = names.iter().find(same).copied().or_else(|| nearest(column, names.clone()));
    let hint = meant.map(|name| format!("did you mean {}?", quoted(name)));
    let must = format!("must be one of the columns {}", quoted(&names.join(",")));
    place.refuse("--column", quoted(column), must).with_hint(hint)
}
