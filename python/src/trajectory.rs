//! `trajectory`: motions of a tip and paths of an arm's tip, from the command's options.

use flexlink::cli::options::common::option;
use flexlink::cli::trajectory::{Found, Trajectory};

use crate::arrays::dictionary;
use crate::keywords::{arguments, parsed, take_uncertain};
use crate::link::{Link, Source, without_line};
use crate::prelude::*;
use crate::threads::until_pressed;
use crate::wording::in_python;

/// Options that a list repeats once for each element.
const REPEATED: [&str; 3] = ["via", "set", "fit_limit"];

/// Options with another keyword: `from` is a word of Python.
const RENAMED: [(&str, &str); 1] = [("from", "start")];

/// The motion of a tip, or the path of an arm's tip, as a dictionary of the arrays that `solve` takes:
/// ``time`` and ``acceleration``, or ``displacement`` if it is shaped, or ``time``, ``x``, ``y``, and ``carriage`` for an arm
/// on one.
///
/// Keywords are the options of ``flexlink trajectory``: ``distance``, ``duration``, ``step``, ``rest_before``,
/// ``rest_after``, ``via``, ``dwell``, ``cycle``, ``link``, ``set`` and ``fit_limit``; ``shape``, ``of``, ``quiet_at``, ``modes``
/// and ``uncertain``, as that of :func:`robust`; ``path``, ``to``, ``corner``, ``center``, ``angle``, ``angles``, ``carriage``,
/// and ``start`` for ``--from``. ``link`` is a :class:`Link` or the path of its file. A list of ``via``, ``set`` or
/// ``fit_limit`` repeats the option; ``fit_limit`` may be a dictionary of limits. Notes, as on a duration that was found, go
/// to ``sys.stderr``.
///
/// >>> import flexlink
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.8, step=0.01)
/// >>> sorted(motion), motion["time"].size
/// (['acceleration', 'time'], 81)
/// >>> strip = {"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}
/// >>> link = flexlink.Link(segments=[strip], hub={"inertia": 0.1}, damping={"ratio": 0.02})
/// >>> turned = flexlink.trajectory("sine", link=link, distance="0.5 rad", duration=0.8, step=0.01)
/// >>> ratio = abs(turned["acceleration"]).max() / abs(motion["acceleration"]).max()
/// >>> float(ratio.round(9))  # an arc of 0.75 m
/// 1.5
#[pyfunction]
#[pyo3(signature = (profile, **keywords))]
pub(crate) fn trajectory<'py>(
    py: Python<'py>,
    profile: &str,
    keywords: Option<Keywords<'py>>,
) -> Dictionary<'py> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let link = keywords.get_item("link")?.and_then(|value| value.cast_into::<Link>().ok());
    let mut repeated = Vec::new();
    if let Some(link) = &link {
        keywords.del_item("link")?;
        let Source { file, changes, .. } = &link.get().source;
        repeated.extend(option("--link", &file.shown));
        repeated.extend(changes.iter().flat_map(|change| option("--set", change)));
    }
    for name in REPEATED {
        let Some(values) = keywords.get_item(name)? else { continue };
        let values = match values.cast::<PyDict>() {
            Ok(pairs) => {
                let each = |pair| Ok([pair].into_py_dict(py)?.into_any());
                pairs.iter().map(each).collect::<PyResult<Vec<_>>>()?
            }
            Err(_) => match values.cast::<PyList>() {
                Ok(values) => values.iter().collect::<Vec<_>>(),
                Err(_) => continue,
            },
        };
        keywords.del_item(name)?;
        for value in values {
            repeated.extend(arguments(&[(name, value)].into_py_dict(py)?, &[])?);
        }
    }
    repeated.extend(take_uncertain(&keywords)?);
    let options = arguments(&keywords, &RENAMED)?;
    let words = [options, repeated, vec![profile.to_owned()]].concat();
    let trajectory: Trajectory = parsed(&words, &[], &RENAMED)?;
    let trajectory = match &link {
        Some(link) => trajectory.of_link(link.get().source.file.clone()),
        None => trajectory,
    };
    let (columns, Found { notes, warnings, .. }) =
        until_pressed(py, || made(&trajectory).map_err(without_line))?;
    // The text that a notebook shows, too.
    let written = py.import("sys")?.getattr("stderr")?;
    for note in notes.iter().filter(|_| !written.is_none()) {
        written.call_method1("write", (format!("note: {}\n", in_python(note)),))?;
    }
    warn(py, &warnings)?;
    Ok(dictionary(py, columns)?)
}

/// Columns by name.
type Columns = Vec<(String, Vec<f64>)>;

/// The columns of a motion or a path, and what is to say of it.
fn made(trajectory: &Trajectory) -> Fails<(Columns, Found)> {
    let Some(curve) = trajectory.curve()? else {
        let (motion, found) = trajectory.motion()?;
        let columns = [
            ("time", Some(motion.time_s)),
            ("acceleration", motion.acceleration_m_s2),
            ("velocity", motion.velocity_m_s),
            ("displacement", motion.displacement_m),
        ];
        let columns = columns.into_iter().filter_map(|(name, own)| Some((name.to_owned(), own?)));
        return Ok((columns.collect(), found));
    };
    let (path, found) = trajectory.path_along(&curve, trajectory.arm()?.as_ref())?;
    let time = ("time".to_owned(), path.time_s);
    let columns = path.tip.into_iter().flatten().chain(path.angles.into_iter().flatten());
    let columns = columns.chain(path.carriage).map(|column| (column.name, column.values));
    Ok(([time].into_iter().chain(columns).collect(), found))
}
