//! Torques and angles of an arm's joints, and places of its tip, over time.

use super::columns::{Columns, Header};
use super::format::{Reading, TableFormat};
use super::heading::{
    JOINT_TORQUES, PATH_X, PATH_Y, Quantity, TIME, Vocabulary, find, nine, quantity, require,
};
use super::outliers::doubt;
use super::place::TableError;
use super::samples::{Samples, refuse_samples};
use crate::numeric::{Dimension, TimeGrid};
use crate::response::{HistoryError, HubReference, Torque};
use crate::result::TipPlaces;

/// Angles of an arm's joints.
const JOINTS: [Quantity; 9] = nine(
    ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7", "joint8", "joint9"],
    quantity("", "_rad", Dimension::NONE, ["rad", "deg"]),
);
/// Rates of an arm's joints.
const JOINT_RATES: [Quantity; 9] = nine(
    [
        "joint1_rate",
        "joint2_rate",
        "joint3_rate",
        "joint4_rate",
        "joint5_rate",
        "joint6_rate",
        "joint7_rate",
        "joint8_rate",
        "joint9_rate",
    ],
    quantity("", "_rad_s", Dimension::RATE, ["rad/s", "deg/s"]),
);

/// Names of an arm's torques.
const TORQUES: Vocabulary = Vocabulary {
    quantities: &[
        TIME,
        JOINT_TORQUES[0],
        JOINT_TORQUES[1],
        JOINT_TORQUES[2],
        JOINT_TORQUES[3],
        JOINT_TORQUES[4],
        JOINT_TORQUES[5],
        JOINT_TORQUES[6],
        JOINT_TORQUES[7],
        JOINT_TORQUES[8],
    ],
    prefix: "",
    example: "time,torque1,torque2",
    choice: Some("rename one of them"),
    by_option: "",
};

/// Names of the joints' motion.
const JOINT_MOTION: Vocabulary = Vocabulary {
    quantities: &[
        TIME,
        JOINTS[0],
        JOINTS[1],
        JOINTS[2],
        JOINTS[3],
        JOINTS[4],
        JOINTS[5],
        JOINTS[6],
        JOINTS[7],
        JOINTS[8],
        JOINT_RATES[0],
        JOINT_RATES[1],
        JOINT_RATES[2],
        JOINT_RATES[3],
        JOINT_RATES[4],
        JOINT_RATES[5],
        JOINT_RATES[6],
        JOINT_RATES[7],
        JOINT_RATES[8],
    ],
    prefix: "",
    example: "time,joint1,joint2",
    choice: Some("rename one of them"),
    by_option: "",
};

/// Names of the tip's places.
const PLACES: Vocabulary = Vocabulary {
    quantities: &[TIME, PATH_X, PATH_Y],
    prefix: "tip_",
    example: "time,x,y",
    choice: Some("rename one of them"),
    by_option: "",
};

/// Reads the torques of an arm with `links` links: `time`, `torque1`, `torque2`, …, as in `torques.csv` of `solve`.
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
    links: usize,
    format: &TableFormat,
) -> Result<(Vec<Torque>, Reading), TableError> {
    let hint = "torques.csv of `flexlink solve` holds them";
    let columns = |header: Header| columns(&TORQUES, &JOINT_TORQUES, (header, links), hint);
    let mut samples = Samples::read(name, bytes, format, columns)?;
    doubt(&mut samples);
    let (time_s, torques) = samples.take_uniform(JOINT_TORQUES);
    let Samples { lines, reading, .. } = samples;
    let torques = torques.into_iter().flatten().take(links);
    let torques = torques.map(|own| Torque::new(&time_s, own)).collect::<Result<_, _>>();
    Ok((torques.map_err(|error| refused(name, &lines, &error))?, reading))
}

/// Reads the motion of an arm's joints for a feedback: `time`, `joint1`, `joint2`, … up to `links`, and optionally
/// `joint1_rate`, …, as in `joint_angles.csv` of `solve`. Other columns are ignored.
///
/// # Errors
/// Those of [`read_joint_torques`].
pub fn read_joint_references(
    name: &str,
    bytes: &[u8],
    links: usize,
) -> Result<(Vec<HubReference>, Reading), TableError> {
    let hint = "joint_angles.csv of `flexlink solve` holds them";
    let columns = |header: Header| columns(&JOINT_MOTION, &JOINTS, (header, links), hint);
    let mut samples = Samples::read(name, bytes, &TableFormat::default(), columns)?;
    doubt(&mut samples);
    let (mut time_s, mut motions) = (samples.take(TIME).unwrap_or_default(), Vec::new());
    for joint in 0..links {
        let angle = samples.take(JOINTS[joint]).unwrap_or_default();
        motions.push((angle, samples.take(JOINT_RATES[joint])));
    }
    let columns = motions.iter_mut().flat_map(|(angle, rate)| [angle].into_iter().chain(rate));
    time_s = samples.make_uniform(time_s, columns.collect());
    let Samples { lines, reading, .. } = samples;
    let motions = motions.into_iter();
    let references = motions.map(|(angle, rate)| HubReference::new(&time_s, angle, rate));
    let references = references.collect::<Result<_, _>>();
    Ok((references.map_err(|error| refused(name, &lines, &error))?, reading))
}

/// Reads the places of a tip for comparison with a simulation: `time`, `x` and `y`, as in `tip.csv` of `solve`. Other
/// columns are ignored.
///
/// # Errors
/// Those of [`read_joint_torques`].
pub fn read_tip_places(name: &str, bytes: &[u8]) -> Result<(TipPlaces, Reading), TableError> {
    let columns = |header: Header| {
        let Header { fields, place, .. } = header;
        let columns = Columns::find(&PLACES, header)?;
        for quantity in [TIME, PATH_X, PATH_Y] {
            require(&columns.headings, quantity, fields, place)?;
        }
        Ok((columns, Reading::default()))
    };
    let mut samples = Samples::read(name, bytes, &TableFormat::default(), columns)?;
    doubt(&mut samples);
    let (time_s, at_m) = samples.take_uniform([PATH_X, PATH_Y]);
    let Samples { lines, reading, .. } = samples;
    let grid = TimeGrid::through(&time_s).map_err(|error| {
        refuse_samples(name, &lines, Some(error.sample), &error, Some(error.hint()))
    })?;
    Ok((TipPlaces { grid, at_m: at_m.map(Option::unwrap_or_default).to_vec() }, reading))
}

/// Finds the time and the columns of `links` joints.
fn columns(
    vocabulary: &'static Vocabulary,
    each: &[Quantity; 9],
    (header, links): (Header, usize),
    hint: &str,
) -> Result<(Columns, Reading), TableError> {
    let Header { fields, place, .. } = header;
    let columns = Columns::find(vocabulary, header)?;
    require(&columns.headings, TIME, fields, place)?;
    for quantity in &each[..links] {
        require(&columns.headings, *quantity, fields, place)
            .map_err(|error| error.with_hint(hint.to_owned()))?;
    }
    let beyond = each[links..].iter().find(|own| find(&columns.headings, **own).is_some());
    if let Some(beyond) = beyond {
        let must = format!("must not be there: the arm has {links} links");
        return Err(place.refuse(beyond.word, "a column", must));
    }
    Ok((columns, Reading::default()))
}

fn refused(name: &str, lines: &[u64], error: &HistoryError) -> TableError {
    refuse_samples(name, lines, error.sample(), error, error.hint())
}
