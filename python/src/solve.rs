//! `solve`: the motion of a tip, and the solution.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::problem::Problem;
use flexlink::cli::terminal::{Failure, memory};
use flexlink::inverse::Resources;

use crate::arm::{Arm, GivenPath, solved_arm};
use crate::interrupt::until_pressed;
use crate::keywords::{self, solve_options};
use crate::link::{Link, described_by};
use crate::messages::warn;
use crate::motion::Call;
use crate::solution::Solution;
use crate::solved::SolvedRun;

/// Computes the hub torque that makes the tip of a link follow a motion, or the torques of an arm.
///
/// The motion is arrays over ``time`` in s, evenly spaced: ``acceleration`` in m/s², ``displacement`` along the arc in
/// m, ``velocity`` in m/s, or ``angle`` in rad; or a file, whose path is in place of the time, or a :class:`Motion`. An array
/// counts as a file that holds its numbers: few decimals limit its accuracy. Other keywords are the options of
/// ``flexlink solve``: ``resample``, ``noise``, ``lowpass``, ``periodic``, ``moving_ends``,
/// ``scale_distance``, ``scale_duration``, ``moments``, ``stations``; for a file ``columns``, ``time_unit``, ``unit``, ``scale``,
/// ``skip``, ``delimiter``, ``decimal``, ``drop_outliers``. An arm takes ``x`` and ``y`` of its tip in m, or the directions ``angle1``,
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
        let solution = until_pressed(py, || solved_arm(arm, given, arguments))?;
        warn(py, &solution.run.warnings)?;
        return Ok(Bound::new(py, solution)?.into_any());
    }
    let link = described_by::<Link>(link)?.get();
    let call = Call::take(time, &keywords)?;
    let solution = until_pressed(py, || solved(link, call))?;
    warn(py, &solution.run.warnings)?;
    Ok(Bound::new(py, solution)?.into_any())
}

pub(crate) fn solved(link: &Link, call: Call<'_>) -> Result<Solution, Failure> {
    let Call { given, arguments, motion: read } = call;
    let options = solve_options(&arguments)?;
    let own = link.specification.link();
    let (motion, reading) = match read {
        Some(read) => {
            read.refuse_other(own)?;
            (read.wanted(), read.reading.clone())
        }
        None => given.motion(&link.specification.arm, &options)?,
    };
    let resources = Resources {
        memory_bytes: memory::available(),
        periods: read.map(|read| &*read.periods),
        ..Resources::default()
    };
    let mut specification = link.specification.clone();
    options.nodes.meshes(&link.specification.arm, &mut specification.meshes)?;
    specification.analysis = options.analysis(&specification.analysis);
    let problem = Problem::of(&link.source.file, specification, motion);
    let run = SolvedRun::of(problem, &resources, (link.source.clone(), arguments))?;
    Ok(Solution { given, reading, run })
}
