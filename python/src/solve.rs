//! `solve`: the motion of a tip in arrays or in a file, and the solution.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use flexlink::csv::{InputFile, MotionTable};
use flexlink::inverse::{Resources, invert_with};
use flexlink::link::Link as LibraryLink;
use flexlink::motion::{MotionColumns, TipMotion};
use flexlink::result::StoredWarning;
use flexlink::spec::Specification;

use crate::arm::{Arm, GivenPath, solved_arm};
use crate::arrays::column;
use crate::cli::solve::run::SolveOptions;
use crate::keywords;
use crate::link::Link;
use crate::messages::{of_reading, usage, warn};
use crate::pool;
use crate::solution::Solution;
use crate::terminal::{Failure, memory};

/// What messages call samples that are from no file.
pub(crate) const MOTION: &str = "motion";

/// Keywords that hold samples of a motion.
const COLUMNS: [&str; 4] = ["acceleration", "velocity", "displacement", "angle"];

/// A motion as a call gives it.
pub(crate) enum Given {
    File(InputFile),
    Samples(Box<MotionColumns>),
    Angle { time_s: Vec<f64>, angle_rad: Vec<f64> },
}

impl Given {
    /// Takes the samples out of the keywords; `time` may be the path of a file instead.
    pub(crate) fn take(time: &Bound<'_, PyAny>, keywords: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut samples = COLUMNS.map(|_| None);
        for (name, own) in COLUMNS.into_iter().zip(&mut samples) {
            if let Some(given) = keywords.get_item(name)? {
                keywords.del_item(name)?;
                *own = if given.is_none() { None } else { Some(column(name, &given)?) };
            }
        }
        if let Some(path) = path_of(time)? {
            if let Some(at) = samples.iter().position(Option::is_some) {
                let message = format!("{} is given beside a file", COLUMNS[at]);
                return Err(usage(&message, Some("leave one of them out")).into());
            }
            return Ok(Self::File(InputFile::read(&path).map_err(Failure::from)?));
        }
        let time_s = column("time", time)?;
        Ok(match samples {
            [None, None, None, Some(angle_rad)] => Self::Angle { time_s, angle_rad },
            [_, _, _, Some(_)] => {
                let hint =
                    Some("an angle stands for the displacement, and has no columns beside it");
                return Err(usage(&"angle is given beside another column", hint).into());
            }
            [acceleration_m_s2, velocity_m_s, displacement_m, None] => {
                let columns =
                    MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m };
                Self::Samples(Box::new(columns))
            }
        })
    }

    /// The motion of a link's tip, and how its file was read.
    pub(crate) fn motion(
        &self,
        link: &LibraryLink,
        options: &SolveOptions,
    ) -> Result<(TipMotion, Vec<StoredWarning>), Failure> {
        let table = match self {
            Self::File(file) => {
                let (motion, reading) = options.resample.motion_of(file, link, &options.read)?;
                return Ok((options.scale.scaled(motion)?, of_reading(&file.shown, &reading)));
            }
            Self::Samples(columns) => MotionTable::of_columns(MOTION, (**columns).clone())?,
            Self::Angle { time_s, angle_rad } => {
                MotionTable::of_angle(MOTION, time_s.clone(), angle_rad, link.length_m())?
            }
        };
        let motion = options.scale.scaled(options.resample.motion_in(table, link)?)?;
        Ok((motion, Vec::new()))
    }

    pub(crate) fn file(&self) -> Option<&InputFile> {
        if let Self::File(file) = self { Some(file) } else { None }
    }
}

/// The path that a text or a path-like object names.
pub(crate) fn path_of(given: &Bound<'_, PyAny>) -> PyResult<Option<PathBuf>> {
    if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        return Ok(Some(given.extract::<PathBuf>()?));
    }
    Ok(None)
}

/// Computes the hub torque that makes the tip of a link follow a motion, or the torques of an arm.
///
/// The motion is arrays over ``time`` in s, evenly spaced: ``acceleration`` in m/s², ``displacement`` along the arc in
/// m, ``velocity`` in m/s, or ``angle`` in rad; or a file, whose path is in place of the time. Other keywords are the
/// options of ``flexlink solve``: ``resample``, ``noise``, ``lowpass``, ``periodic``, ``moving_ends``,
/// ``scale_distance``, ``scale_duration``, ``moments``; for a file ``columns``, ``time_unit``, ``unit``, ``scale``,
/// ``skip``, ``delimiter``, ``decimal``. An arm takes ``x`` and ``y`` of its tip in m, or the directions ``angle1``,
/// ``angle2``, … of its links in rad.
///
/// >>> import flexlink, numpy
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"ratio": 0.02},
/// ... )
/// >>> time = numpy.linspace(0, 0.88, 881)
/// >>> solution = flexlink.solve(link, time, acceleration=4 * numpy.sin(2 * numpy.pi * time / 0.88))
/// >>> solution.torque.shape == solution.time.shape
/// True
/// >>> bool(solution.time[abs(solution.torque) > 0.02].min() < -0.2)  # the torque starts before the tip
/// True
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    link: &Bound<'py, PyAny>,
    time: &Bound<'py, PyAny>,
    keywords: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    if let Ok(arm) = link.cast::<Arm>() {
        let arm = arm.get();
        let given = GivenPath::take(time, &keywords, arm.specification.arm.links().len())?;
        let arguments = keywords::arguments(&keywords)?;
        let solution = py.detach(|| pool::install(|| solved_arm(arm, given, arguments)))?;
        warn(py, &solution.warnings)?;
        return Ok(Bound::new(py, solution)?.into_any());
    }
    let link = link.cast::<Link>()?.get();
    let given = Given::take(time, &keywords)?;
    let arguments = keywords::arguments(&keywords)?;
    let solution = py.detach(|| pool::install(|| solved(link, given, arguments)))?;
    warn(py, &solution.warnings)?;
    Ok(Bound::new(py, solution)?.into_any())
}

fn solved(link: &Link, given: Given, keywords: Vec<String>) -> Result<Solution, Failure> {
    let options = read_options(&keywords)?;
    let Specification { link: own, mesh, analysis, .. } = &link.specification;
    let (motion, reading) = given.motion(own, &options)?;
    let resources = Resources { memory_bytes: memory::available(), ..Resources::default() };
    let mesh = options.nodes.mesh(own, mesh.clone())?;
    let solution = invert_with(own, &mesh, &motion, &options.analysis(analysis), &resources)?;
    Ok(Solution::new(link, (given, reading), keywords, solution))
}

/// Keywords as the options of `solve`.
pub(crate) fn read_options(arguments: &[String]) -> Result<SolveOptions, Failure> {
    SolveOptions::recorded(arguments).map_err(|error| keywords::refused(&error))
}
