//! Torques and motions of a hub or of an arm's joints, and places of its tip, over time.

use super::columns::{Beside, Columns, Header};
use super::format::{Reading, TableFormat};
use super::heading::{
    CARRIAGE, CARRIAGE_VELOCITY, FORCE, HUB_ANGLE, HUB_RATE, Heading, JOINT_RATES, JOINT_TORQUES,
    JOINTS, PATH_X, PATH_Y, Quantity, Spelling, TIME, TORQUE, Vocabulary, joined, names, nearest,
    unread_unit,
};
use super::input::{Place, TableError, quoted};
use super::quality::doubt;
use super::samples::Samples;
use super::unit_name::{parse_unit, split_any_unit, split_unit};
use crate::link::Arm;
use crate::response::{HubReference, Torque};
use crate::result::TipPlaces;

/// The joints of a table: their number, and whether a carriage slides. A number alone means hubs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joints {
    /// Number of links.
    pub links: usize,
    /// True for a link or an arm on a carriage.
    pub slides: bool,
}

impl From<usize> for Joints {
    fn from(links: usize) -> Self {
        Self { links, slides: false }
    }
}

impl From<&Arm> for Joints {
    fn from(arm: &Arm) -> Self {
        Self { links: arm.links().len(), slides: arm.joints().any(|joint| joint.slides()) }
    }
}

/// Columns of one link's joint.
struct OfJoint {
    effort: Quantity,
    /// Names of the effort.
    recording: Vocabulary,
    /// Position and rate.
    motion: [Quantity; 2],
    /// Names of the motion.
    moving: Vocabulary,
    /// File of `solve` with the motion.
    file: &'static str,
}

const OF_HUB: OfJoint = OfJoint {
    effort: TORQUE,
    recording: Vocabulary {
        quantities: &[TIME, TORQUE],
        prefix: "hub_",
        example: "time,torque",
        choice: None,
        by_option: "--columns time=1,torque=2 names the columns",
    },
    motion: [HUB_ANGLE, HUB_RATE],
    moving: Vocabulary {
        quantities: &[TIME, HUB_ANGLE, HUB_RATE],
        example: "time,hub_angle",
        ..Vocabulary::NONE
    },
    file: "hub_angle.csv",
};

const OF_CARRIAGE: OfJoint = OfJoint {
    effort: FORCE,
    recording: Vocabulary {
        quantities: &[TIME, FORCE],
        prefix: "carriage_",
        example: "time,force",
        choice: None,
        by_option: "--columns time=1,force=2 names the columns",
    },
    motion: [CARRIAGE, CARRIAGE_VELOCITY],
    moving: Vocabulary {
        quantities: &[TIME, CARRIAGE, CARRIAGE_VELOCITY],
        example: "time,carriage",
        ..Vocabulary::NONE
    },
    file: "carriage.csv",
};

impl Joints {
    /// Columns of the joint of one link.
    fn own(self) -> &'static OfJoint {
        if self.slides { &OF_CARRIAGE } else { &OF_HUB }
    }
}

/// Names of an arm's torques.
const TORQUES: Vocabulary = Vocabulary {
    quantities: &joined::<11>(&[&[TIME], &JOINT_TORQUES, &[FORCE]]),
    example: "time,torque1,torque2",
    ..Vocabulary::NONE
};

/// Names of the joints' motion.
const JOINT_MOTION: Vocabulary = Vocabulary {
    quantities: &joined::<21>(&[&[TIME], &JOINTS, &JOINT_RATES, &OF_CARRIAGE.motion]),
    example: "time,joint1,joint2",
    ..Vocabulary::NONE
};

/// Names of the tip's places.
const PLACES: Vocabulary = Vocabulary {
    quantities: &[TIME, PATH_X, PATH_Y],
    prefix: "tip_",
    example: "time,x,y",
    ..Vocabulary::NONE
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
    let read = read_torque_table_as(name, bytes, 1, column, &TableFormat::default());
    read.map(|(torque, _)| torque)
}

/// Reads the torque of one link, or the force on its carriage, from a table with the user's options for its form; also
/// returns its deviations from the standard form.
///
/// # Errors
/// Those of [`read_torque_table`]; also options that do not fit the table.
pub fn read_torque_table_as(
    name: &str,
    bytes: &[u8],
    joints: impl Into<Joints>,
    column: Option<&str>,
    format: &TableFormat,
) -> Result<(Torque, Reading), TableError> {
    let own = joints.into().own();
    let columns = |header: Header| torque_columns(header, own, column);
    let samples = Samples::read(name, bytes, format, columns)?;
    let (mut torques, reading) = torques(samples, &[own.effort])?;
    Ok((torques.remove(0), reading))
}

/// Reads the torques of an arm with `links` links: `time`, `torque1`, `torque2`, …, as in `torques.csv` of `solve`; of
/// one link those of [`read_torque_table`]. The force of an arm's carriage comes last if the table has the column `force`.
/// Other columns are ignored.
///
/// ```
/// use flexlink::csv::read_joint_torques;
/// let file = b"time [ms],torque1 [N cm],torque2\n0,0,0\n1,50,1\n2,50,1\n3,0,0\n";
/// let (torques, _) = read_joint_torques("torques.csv", file, 2, &Default::default())?;
/// assert_eq!(torques[0].torque_n_m(), [0.0, 0.5, 0.5, 0.0]);
/// # Ok::<(), flexlink::csv::TableError>(())
/// ```
///
/// # Errors
/// [`TableError`] names the file, and the faulty line and column.
pub fn read_joint_torques(
    name: &str,
    bytes: &[u8],
    joints: impl Into<Joints>,
    format: &TableFormat,
) -> Result<(Vec<Torque>, Reading), TableError> {
    let joints = joints.into();
    let Joints { links, slides } = joints;
    if links == 1 {
        let (torque, reading) = read_torque_table_as(name, bytes, joints, None, format)?;
        return Ok((vec![torque], reading));
    }
    let hint = "torques.csv of `flexlink solve` holds them";
    let columns = |header: Header| columns(&TORQUES, &JOINT_TORQUES, (header, links), hint);
    let of_carriage = &[FORCE][..usize::from(slides)];
    let quantities = [&JOINT_TORQUES[..links], of_carriage].concat();
    torques(Samples::read(name, bytes, format, columns)?, &quantities)
}

/// The torques in the columns of these quantities, as far as the table has them.
fn torques(
    mut samples: Samples,
    quantities: &[Quantity],
) -> Result<(Vec<Torque>, Reading), TableError> {
    doubt(&mut samples);
    let (time_s, columns) = samples.take_uniform(quantities)?;
    let torques = columns.into_iter().flatten().map(|n_m| Torque::new(&time_s, n_m));
    let torques = samples.history(quantities[0], torques.collect())?;
    Ok((torques, samples.reading))
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
    let (mut read, _) = read_joint_references(name, bytes, 1, &TableFormat::default())?;
    Ok(read.remove(0))
}

/// Reads the motion of an arm's joints, for a feedback or as an input: `time`, `joint1`, `joint2`, … up to `links`, and
/// optionally `joint1_rate`, …, as in `joint_angles.csv` of `solve`; of one link that of [`read_hub_reference`], or of a
/// carriage `carriage` and `carriage_velocity`. That of an arm's carriage comes last if the table has it. Also returns
/// the table's deviations from the standard form. Other columns are ignored.
///
/// # Errors
/// Those of [`read_joint_torques`].
pub fn read_joint_references(
    name: &str,
    bytes: &[u8],
    joints: impl Into<Joints>,
    format: &TableFormat,
) -> Result<(Vec<HubReference>, Reading), TableError> {
    let joints = joints.into();
    let (links, own) = (joints.links, joints.own());
    let columns = |header: Header| {
        if links > 1 {
            let hint = "joint_angles.csv of `flexlink solve` holds them";
            return columns(&JOINT_MOTION, &JOINTS, (header, links), hint);
        }
        let columns = Columns::find(&own.moving, header, Beside::Time)?;
        columns.require(TIME, header)?;
        let hint = || format!("{} of `flexlink solve` holds it", own.file);
        columns.require(own.motion[0], header).map_err(|error| error.or_hint(hint()))?;
        Ok(columns)
    };
    let samples = Samples::read(name, bytes, format, columns)?;
    let of_links = JOINTS.into_iter().zip(JOINT_RATES).map(|(angle, rate)| [angle, rate]);
    let of_links = of_links.take(if links > 1 { links } else { 0 });
    let motions = of_links.chain((links == 1 || joints.slides).then_some(own.motion));
    references(samples, &motions.collect::<Vec<_>>())
}

/// The motions in the columns of these angles and rates, as far as the table has them.
fn references(
    mut samples: Samples,
    motions: &[[Quantity; 2]],
) -> Result<(Vec<HubReference>, Reading), TableError> {
    doubt(&mut samples);
    let (time_s, columns) = samples.take_uniform(&motions.concat())?;
    let references = columns.chunks_exact(2).filter_map(|motion| {
        let angle_rad = motion[0].clone()?;
        Some(HubReference::new(&time_s, angle_rad, motion[1].clone()))
    });
    let references = samples.history(motions[0][0], references.collect())?;
    Ok((references, samples.reading))
}

/// Reads the places of a tip for comparison with a simulation, with the user's options for their form: `time`, `x` and `y`, as in `tip.csv` of `solve`. Other
/// columns are ignored.
///
/// # Errors
/// Those of [`read_joint_torques`].
pub fn read_tip_places(
    name: &str,
    bytes: &[u8],
    format: &TableFormat,
) -> Result<(TipPlaces, Reading), TableError> {
    let columns = |header: Header| {
        let columns = Columns::find(&PLACES, header, Beside::Time)?;
        [TIME, PATH_X, PATH_Y]
            .iter()
            .try_for_each(|quantity| columns.require(*quantity, header))?;
        Ok(columns)
    };
    let mut samples = Samples::read(name, bytes, format, columns)?;
    doubt(&mut samples);
    let (time_s, at_m) = samples.take_uniform(&[PATH_X, PATH_Y])?;
    let grid = samples.grid(&time_s)?;
    let at_m = at_m.into_iter().map(Option::unwrap_or_default).collect();
    Ok((TipPlaces { grid, at_m }, samples.reading))
}

/// Finds the time and the columns of `links` joints.
fn columns(
    vocabulary: &'static Vocabulary,
    each: &[Quantity; 9],
    (header, links): (Header, usize),
    hint: &str,
) -> Result<Columns, TableError> {
    let columns = Columns::find(vocabulary, header, Beside::Time)?;
    columns.require(TIME, header)?;
    for quantity in &each[..links] {
        columns.require(*quantity, header).map_err(|error| error.with_hint(hint.to_owned()))?;
    }
    if let Some(beyond) = each[links..].iter().find(|quantity| columns.has(**quantity)) {
        let must = format!("must be left out: the arm has {links} links");
        return Err(header.place.refuse(beyond.word, "a column", must));
    }
    Ok(columns)
}

/// Finds the time and the torque, or the force, named `column` or, without it, by its own name.
fn torque_columns(
    header: Header,
    own: &OfJoint,
    column: Option<&str>,
) -> Result<Columns, TableError> {
    let Header { fields, place, .. } = header;
    let (recording, effort) = (&own.recording, own.effort);
    let Some(column) = column else {
        let columns = Columns::find(recording, header, Beside::Time)?;
        let by_option = || recording.by_option.to_owned();
        columns.require(TIME, header).map_err(|error| error.or_hint(by_option()))?;
        let hint = || where_effort_is(fields, effort);
        columns.require(effort, header).map_err(|error| error.or_hint(hint()))?;
        return Ok(columns);
    };
    recording.check_names(fields, place)?;
    let torque = chosen_torque(header, own, column)?;
    let columns = Columns::find(recording, header, Beside::Column(torque))?;
    columns.require(TIME, header)?;
    Ok(columns)
}

/// Hint at the form of a unit.
fn in_brackets(effort: Quantity) -> String {
    format!("a unit follows in brackets: {} [{}]", effort.word, effort.units[1])
}

/// Hint for choosing the torque, or the force, in a table without a column of its name.
fn where_effort_is(fields: &[&str], effort: Quantity) -> String {
    let word = effort.word;
    let is_of_motor = |field: &str| field.to_lowercase().contains("motor");
    let fields = fields.iter().enumerate();
    let mut named = fields.filter(|(_, field)| field.to_lowercase().contains(word));
    match named.clone().find(|(_, field)| !is_of_motor(field)).or(named.next()) {
        Some((index, field)) if is_of_motor(field) => format!(
            "--columns {word}={} takes the {word} of the motor, which a gear turns into another one at the joint",
            index + 1
        ),
        Some((_, field)) if unread_unit(field, effort).is_some() => in_brackets(effort),
        Some((index, _)) => format!("--columns {word}={} chooses the {word}", index + 1),
        None => format!("--columns {word}=COLUMN chooses the {word}"),
    }
}

/// Heading of the torque, or of the force, named `column`.
fn chosen_torque(header: Header, own: &OfJoint, column: &str) -> Result<Heading, TableError> {
    let Header { fields, format, place } = header;
    let (effort, word) = (own.effort, own.effort.word);
    let refuse = |found: String, must| Err(place.refuse("--column", found, must));
    if format.columns.iter().any(|choice| choice.quantity == effort) {
        return refuse(quoted(column), format!("must not be given with --columns {word}"));
    }
    let index = chosen_index(fields, column, place)?;
    let field = fields[index];
    if matches!(own.recording.spelling(field, TIME), Some(Spelling::Exact | Spelling::Suffixed)) {
        return refuse(quoted(column), format!("must be a {word}, not the time"));
    }
    let measure = format.measure(effort);
    let unread = unread_unit(field, effort).filter(|_| measure.unit.is_none());
    let round = split_any_unit(field).1.filter(|_| split_unit(field).1.is_none());
    let is_unit = round.is_some_and(|unit| parse_unit(unit).is_ok());
    if let (Some(word), false) = (unread, is_unit) {
        let must = format!("must have its unit in brackets: {} reads like one", quoted(word));
        return Err(place.refuse_column(index, field, must).with_hint(in_brackets(effort)));
    }
    // Parentheses may also contain a remark.
    let field = if round.is_some() && !is_unit { split_any_unit(field).0 } else { field };
    let suffixed = effort.is_suffixed(split_unit(field).0);
    Heading::of(index, field, effort, suffixed, measure, place)
}

/// Index of the only column with the heading `column`, with or without its unit.
fn chosen_index(fields: &[&str], column: &str, place: Place) -> Result<usize, TableError> {
    // A surplus comma leaves a column without a name.
    if column.is_empty() {
        return Err(place.refuse_whole("--column is empty, but must name a column"));
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
