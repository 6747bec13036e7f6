//! `modes` and `frf`, of links and of arms.

use std::f64::consts::TAU;

use clap::Parser;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::result::{BandMeshError, CoarseMesh, ModesResult, Notice};
use flexlink::store::{ResponseColumns, arm_response, link_response};

use crate::arm::Arm;
use crate::arrays::{dictionary, rows};
use crate::cli::arm_pose::ArmInPose;
use crate::cli::frf::Frf;
use crate::cli::modes::{computed, in_pose};
use crate::interrupt::until_pressed;
use crate::keywords;
use crate::link::{Link, described_by};
use crate::messages::{usage, warn};
use crate::options::common::directions;
use crate::terminal::Failure;

/// Natural frequencies, damping ratios, mode shapes and zeros, as a dictionary of arrays.
///
/// With ``at``, the direction of a link under gravity in rad, or those of all links of an arm, the frequencies are those of
/// small motions there: ``free_hz`` and ``held_hz``, of free joints and of held rotors, imaginary ones as negative numbers.
///
/// >>> import flexlink
/// >>> strip = {"length": 1.0, "EI": 10.0, "mass_per_length": 0.5}
/// >>> found = flexlink.modes(flexlink.Link(segments=[strip]), count=2)
/// >>> pinned = 3.926602312**2 * (10.0 / 0.5) ** 0.5 / 6.283185307  # of a pinned and free beam
/// >>> bool(abs(found["frequency_hz"][0] / pinned - 1) < 1e-6)
/// True
/// >>> found["shapes"].shape == (2, found["nodes"].size)
/// True
#[pyfunction]
#[pyo3(signature = (link, count=10, *, at=None))]
pub(crate) fn modes<'py>(
    py: Python<'py>,
    link: &Bound<'py, PyAny>,
    count: usize,
    at: Option<Directions>,
) -> PyResult<Bound<'py, PyDict>> {
    if !(1..=1000).contains(&count) {
        return Err(usage(&format!("count = {count}, but must be 1 to 1000"), None).into());
    }
    let at = at.map(Directions::list);
    if let Ok(arm) = link.cast::<Arm>() {
        let pose = ArmInPose::of(arm.get().specification.clone(), at.as_deref())?;
        let found = until_pressed(py, || pose.modes(count))?;
        let lists = [("mode, joints free,", &found.free), ("mode, rotors held,", &found.held)];
        let coarse = lists.map(|(what, own)| CoarseMesh::of(what, &own.errors));
        warn_of(py, coarse.into_iter().flatten())?;
        let squares = |modes: &[flexlink::response::PoseMode]| -> Vec<f64> {
            modes.iter().map(|mode| mode.square_per_s2).collect()
        };
        let (free, held) = (squares(&found.free.modes), squares(&found.held.modes));
        let table = in_directions(py, &free, &held)?;
        table.set_item("holding_torque", PyArray1::from_slice(py, &found.holding_torques_n_m))?;
        table.set_item("tip", PyArray1::from_slice(py, &found.tip_m))?;
        return Ok(table);
    }
    let specification = &described_by::<Link>(link)?.get().specification;
    if let Some(at) = at.map(|at| directions(Some(&at), 1)).transpose()? {
        let (_, found) = until_pressed(py, || in_pose(specification, at[0], count))?;
        let lists = [("mode", &found.free), ("mode with the hub held", &found.held)];
        let coarse = lists.map(|(what, own)| CoarseMesh::of(what, &own.mesh_errors));
        warn_of(py, coarse.into_iter().flatten())?;
        return in_directions(py, &found.free.squares_per_s2, &found.held.squares_per_s2);
    }
    let (_, found) = until_pressed(py, || computed(specification, count))?;
    warn_of(py, found.warnings())?;
    of_link(py, found)
}

/// Gives warnings of a coarse mesh to Python's filters.
fn warn_of(py: Python<'_>, coarse: impl IntoIterator<Item = CoarseMesh>) -> PyResult<()> {
    warn(py, &coarse.into_iter().map(Notice::from).collect::<Vec<_>>())
}

/// One direction, or one for each link.
#[derive(FromPyObject)]
pub(crate) enum Directions {
    One(f64),
    Each(Vec<f64>),
}

impl Directions {
    pub(crate) fn list(self) -> Vec<f64> {
        match self {
            Self::One(angle) => vec![angle],
            Self::Each(angles) => angles,
        }
    }
}

fn of_link(py: Python<'_>, found: ModesResult) -> PyResult<Bound<'_, PyDict>> {
    let hertz = found.omega_rad_s.iter().map(|omega| omega / TAU).collect();
    let nodes = found.nodes_m.len();
    let columns = [
        ("frequency_hz", hertz),
        ("damping_ratio", found.damping_ratios),
        ("mesh_error", found.mesh_errors),
        ("zero_per_s", found.zeros.zeros_per_s),
        ("zero_mesh_error", found.zeros.mesh_errors),
        ("blocked_hz", found.zeros.blocked_hz),
        ("nodes", found.nodes_m),
    ];
    let table = dictionary(py, columns)?;
    let held_hz = found.held.omega_rad_s.iter().map(|omega| omega / TAU).collect();
    table.set_item("held_hz", PyArray1::from_vec(py, held_hz))?;
    table.set_item("held_damping_ratio", PyArray1::from_vec(py, found.held.damping_ratios))?;
    // A row for each mode.
    table.set_item("shapes", rows(py, &found.shapes, nodes)?.call_method0("transpose")?)?;
    Ok(table)
}

fn in_directions<'py>(py: Python<'py>, free: &[f64], held: &[f64]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for (name, squares) in [("free_hz", free), ("held_hz", held)] {
        let hertz = squares.iter().map(|own| own.abs().sqrt().copysign(*own) / TAU).collect();
        table.set_item(name, PyArray1::from_vec(py, hertz))?;
    }
    Ok(table)
}

/// `from` is a word of Python.
const RENAMED: [(&str, &str); 2] = [("from", "start"), ("to", "stop")];

/// Keywords of `frf`.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Keywords {
    #[command(flatten)]
    frf: Frf,
}

/// Frequency response, as a dictionary of the columns that ``flexlink frf`` writes: of a link torque per tip acceleration,
/// hub angle per tip displacement, tip displacement per torque.
///
/// Keywords are the options ``start``, ``stop`` (``--from`` and ``--to``, in Hz), ``points``, ``linear``, and of an arm
/// ``at``, the directions of its links in rad.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(segments=[{"length": 1.0, "EI": 10.0, "mass_per_length": 0.5}])
/// >>> response = flexlink.frf(link, start=0.001, stop=10, points=3)
/// >>> inertia = response["torque_per_tip_acceleration_kg_m_real"][0]
/// >>> bool(abs(inertia - link.rigid_inertia / link.length) < 1e-6)  # slowly it turns as if it were rigid
/// True
#[pyfunction]
#[pyo3(signature = (link, **keywords))]
pub(crate) fn frf<'py>(
    py: Python<'py>,
    link: &Bound<'py, PyAny>,
    keywords: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    keywords::rename(&keywords, &RENAMED)?;
    let mut arguments = keywords::arguments(&keywords)?;
    // The parser wants a file; the link is here already.
    arguments.push("link".to_owned());
    let read = Keywords::try_parse_from(arguments)
        .map_err(|error| keywords::refused::<Frf>(&error, &[], &RENAMED))?;
    let columns = if let Ok(arm) = link.cast::<Arm>() {
        let at = read.frf.at.as_deref();
        let pose = ArmInPose::of(arm.get().specification.clone(), at)?;
        let (_, found) = until_pressed(py, || read.frf.compute_arm(&pose))?;
        arm_response(&found)
    } else {
        let own = described_by::<Link>(link)?.get();
        if read.frf.at.is_some() {
            let message = "at is for an arm of several links, and this is one";
            return Err(usage(&message, None).into());
        }
        let compute = || -> Result<(ResponseColumns, Option<CoarseMesh>), Failure> {
            let (rows, errors) = read.frf.compute(&own.specification)?;
            let known =
                rows.iter().map(|row| row.frequency_hz).zip(errors.iter().flatten().copied());
            let coarse = BandMeshError::of_errors(known).and_then(|error| error.warning);
            Ok((link_response(&rows, errors.as_deref()), coarse))
        };
        let (columns, coarse) = until_pressed(py, compute)?;
        warn_of(py, coarse)?;
        columns
    };
    dictionary(py, columns)
}
