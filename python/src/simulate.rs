//! `simulate`: a torque or a motion of the hub in arrays, played on a link.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arm::Arm;
use crate::arrays::{Every, Nodes, check_rows, frame, rows, view};
use crate::interrupt::until_pressed;
use crate::link::{Link, described_by};
use crate::messages::{Raised, objects, warn};
use crate::play::{Keywords, Run, link_moves};
use crate::simulate_arm::ArmSimulation;

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// Plays a torque, or a motion of the hub, on a link at rest, or torques on an arm, as ``flexlink simulate``: independent of
/// ``solve``.
///
/// Arrays over ``time`` in s, evenly spaced: ``torque`` in N m; or ``hub_angle`` in rad, and ``hub_rate`` if it is known.
/// Other keywords: ``hold``, the torque between its samples, ``"cubic"``, ``"linear"`` or ``"zero"``; ``until`` in s;
/// ``feedback``, a pair of gains in N m/rad and N m s/rad, around ``reference`` in rad with ``reference_rate``;
/// ``periodic``; ``target``, the wanted :class:`Motion` with which the tip is compared. The link starts where the target or
/// the reference does, or with its tip at ``initial_tip`` in m, or as ``state`` says: an earlier simulation, or the file
/// that its ``save_state`` wrote.
///
/// Of an arm ``torque``, ``reference`` and ``reference_rate`` have a column for each joint, as those of its solution, and
/// ``feedback`` is a pair for all joints or a list of pairs; ``target`` has x and y of the tip in m at each time. It starts at
/// rest where the reference does, or with its chords in the directions ``at`` in rad, or where the target does, or from a
/// ``state``. Ctrl-C ends it.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002},
/// ... )
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.002)
/// >>> solution = flexlink.solve(link, **motion)
/// >>> wanted = flexlink.Motion(**motion)
/// >>> played = flexlink.simulate(link, solution.time, torque=solution.torque, target=wanted)
/// >>> played.tip_error["share"] < 1e-3  # of the largest distance from the start
/// True
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    link: &Bound<'py, PyAny>,
    time: &Bound<'py, PyAny>,
    keywords: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let keywords = Keywords(&keywords);
    if let Ok(arm) = link.cast::<Arm>() {
        let played = ArmSimulation::play(py, arm.get(), time, &keywords)?;
        warn(py, &played.0.warnings)?;
        return Ok(Bound::new(py, played)?.into_any());
    }
    let link = &described_by::<Link>(link)?.get().specification;
    let moves = link_moves(link, time, &keywords)?;
    let run = until_pressed(py, || Run::of(link.clone(), moves))?;
    warn(py, &run.warnings)?;
    Ok(Bound::new(py, PlayedLink(run))?.into_any())
}

/// The motion of a link on which a torque, or a motion of the hub, was played. Arrays are views that cannot be written to,
/// one value for each of ``time``; units are SI.
#[pyclass(frozen, module = "flexlink", name = "Simulation")]
pub(crate) struct PlayedLink(pub(crate) Run);

#[pymethods]
impl PlayedLink {
    /// Times in s.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let grid = &self.0.played.grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque at the hub in N m, that of the feedback included.
    #[getter]
    fn torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.hub().torque_n_m)
    }

    /// Hub angle in rad.
    #[getter]
    fn hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.hub().angle_rad)
    }

    /// Hub rate in rad/s.
    #[getter]
    fn hub_rate<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.hub().rate_rad_s)
    }

    /// Hub acceleration in rad/s².
    #[getter]
    fn hub_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.hub().acceleration_rad_s2)
    }

    /// Displacement of the tip in m along its arc.
    #[getter]
    fn tip_displacement<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.tip[0].displacement_m)
    }

    /// Velocity of the tip in m/s.
    #[getter]
    fn tip_velocity<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.tip[0].velocity_m_s)
    }

    /// Acceleration of the tip in m/s².
    #[getter]
    fn tip_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.played.tip[0].acceleration_m_s2)
    }

    /// Distances of the nodes from the axis in m.
    #[getter]
    fn nodes<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| own.0.played.mesh().nodes_m())
    }

    /// Displacements of nodes in m, as those of a solution.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn displacements<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Nodes>,
        every: Every,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let nodes = Nodes::or_all(nodes, self.0.played.mesh().nodes_m().len());
        check_rows(self.0.played.grid.thinned(every.0).len(), nodes.len())?;
        let find = || Ok(self.0.played.displacements_m(&nodes, every.0)?);
        let found = until_pressed(py, find)?;
        rows(py, &found.samples, found.grid.len())
    }

    /// Errors of mesh and modes: of the tip over its travel, and of the hub angle over its peak; None where elements of half
    /// the length do not allow the damping.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(error) = &self.0.error else { return Ok(None) };
        let found = PyDict::new(py);
        found.set_item("tip", error.tip)?;
        found.set_item("hub_angle", error.hub_angle)?;
        Ok(Some(found))
    }

    /// Peaks, as in summary.json.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("results")
    }

    /// Distance of the tip from its ``target``, as in summary.json: ``worst_m``, ``share`` of the largest distance from the
    /// start, ``time_s``, ``rms_m``, ``final_m``; None without a target.
    #[getter]
    fn tip_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("tip_error")
    }

    /// What summary.json of a run holds.
    #[getter(summary)]
    fn summary_of<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Raised> {
        self.0.summary_of(py)
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.0.warnings)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none. Keywords are its options ``nodes``, ``stations``,
    /// ``every``, ``digits``.
    #[pyo3(signature = (folder, **keywords))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> Result<(), Raised> {
        self.0.write(py, &folder, keywords.as_ref())
    }

    /// Writes the state at the end, as ``--save-state`` of the command: ``state`` of a later call goes on from it.
    fn save_state(&self, py: Python<'_>, path: PathBuf) -> Result<(), Raised> {
        self.0.save_state(py, &path)
    }

    /// The histories as a `pandas.DataFrame` over the time.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &HISTORIES)
    }

    fn __repr__(&self) -> String {
        format!("Simulation(samples={})", self.0.played.grid.len)
    }
}

/// Columns of a data frame.
const HISTORIES: [&str; 7] = [
    "torque",
    "hub_angle",
    "hub_rate",
    "hub_acceleration",
    "tip_displacement",
    "tip_velocity",
    "tip_acceleration",
];
