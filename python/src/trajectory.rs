//! `trajectory`: motions of a tip and paths of an arm's tip, from the command's options.

use crate::messages::Raised;
use clap::Parser;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use flexlink::cli::terminal::Failure;
use flexlink::cli::trajectory::Trajectory;
use flexlink::motion::{MotionColumns, PathColumns};

use crate::arrays::dictionary;
use crate::interrupt::until_pressed;
use crate::keywords;

/// Keywords of `trajectory`.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Keywords {
    #[command(flatten)]
    trajectory: Trajectory,
}

/// Options that a list repeats once for each element.
const REPEATED: [&str; 3] = ["via", "set", "fit_limit"];

/// `from` is a word of Python.
const RENAMED: [(&str, &str); 1] = [("from", "start")];

/// Columns by name.
type Columns = Vec<(String, Vec<f64>)>;

/// The motion of a tip, or the path of an arm's tip, as a dictionary of the arrays that `solve` takes:
/// ``time`` and ``acceleration``, or ``time``, ``x``, ``y``.
///
/// Keywords are the options of ``flexlink trajectory``: ``distance``, ``duration``, ``step``, ``rest_before``,
/// ``rest_after``, ``via``, ``dwell``, ``cycle``, ``link``, ``set`` and ``fit_limit``; ``path``, ``to``, ``corner``, ``center``, ``angle``, ``angles``,
/// and ``start`` for ``--from``. A list of ``via``, ``set`` or ``fit_limit`` repeats the option.
///
/// >>> import flexlink
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.8, step=0.01)
/// >>> sorted(motion), motion["time"].size
/// (['acceleration', 'time'], 81)
#[pyfunction]
#[pyo3(signature = (profile, **keywords))]
pub(crate) fn trajectory<'py>(
    py: Python<'py>,
    profile: &str,
    keywords: Option<Bound<'py, PyDict>>,
) -> Result<Bound<'py, PyDict>, Raised> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    keywords::rename(&keywords, &RENAMED)?;
    let mut repeated = Vec::new();
    for name in REPEATED {
        let Some(values) = keywords.get_item(name)? else { continue };
        if let Ok(values) = values.cast_into::<PyList>() {
            keywords.del_item(name)?;
            for value in values {
                let one = PyDict::new(py);
                one.set_item(name, value)?;
                repeated.extend(keywords::arguments(&one)?);
            }
        }
    }
    let mut arguments = keywords::arguments(&keywords)?;
    arguments.extend(repeated);
    arguments.push(profile.to_owned());
    let read = Keywords::try_parse_from(arguments)
        .map_err(|error| keywords::refused::<Trajectory>(&error, &[], &RENAMED))?;
    let columns = until_pressed(py, || columns(&read.trajectory))?;
    Ok(dictionary(py, columns)?)
}

fn columns(trajectory: &Trajectory) -> Result<Columns, Failure> {
    match trajectory.curve()? {
        None => Ok(of_motion(trajectory.motion()?.0)),
        Some(curve) => {
            let arm = trajectory.arm()?;
            Ok(of_path(trajectory.path_along(&curve, arm.as_ref())?.0))
        }
    }
}

fn of_motion(motion: MotionColumns) -> Columns {
    let given = [
        ("time", Some(motion.time_s)),
        ("acceleration", motion.acceleration_m_s2),
        ("velocity", motion.velocity_m_s),
        ("displacement", motion.displacement_m),
    ];
    given.into_iter().filter_map(|(name, own)| Some((name.to_owned(), own?))).collect()
}

fn of_path(path: PathColumns) -> Columns {
    let time = ("time".to_owned(), path.time_s);
    let columns = path.tip.into_iter().flatten().chain(path.angles.into_iter().flatten());
    [time].into_iter().chain(columns.map(|column| (column.name, column.values))).collect()
}
