//! Results read back.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::terminal::{Exit, Failure};
use flexlink::compare::Cell;
use flexlink::result::{StoredArc, StoredJoint, StoredNodes, StoredResult, StoredRun, StoredSweep};
use flexlink::store::read_result;

use crate::arrays::{frame, rows, view};
use crate::messages::{Raised, objects, usage};
use crate::pool;

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// Reads a result. The folder of a run of ``solve`` or ``simulate`` becomes a `Run` or, for an arm, an `ArmRun`; the
/// file of a sweep becomes a dictionary of its columns.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> Result<Bound<'_, PyAny>, Raised> {
    match py.detach(|| pool::install(|| Ok(read_result(&path)?)))? {
        StoredResult::Sweep(sweep) => Ok(table(py, &sweep)?.into_any()),
        StoredResult::Runs(runs) => match runs.into_iter().next() {
            Some(mut run) => match run.arc.take() {
                Some(arc) => Ok(Bound::new(py, Run { run, arc })?.into_any()),
                None => Ok(Bound::new(py, ArmRun(run))?.into_any()),
            },
            None => Err(PyTypeError::new_err("no run").into()),
        },
    }
}

/// Columns of numbers as arrays, columns with a word as lists.
fn table<'py>(py: Python<'py>, sweep: &StoredSweep) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for column in &sweep.table.columns {
        let cells: Vec<Cell> = (0..sweep.table.lines.len()).map(|row| column.cell(row)).collect();
        let number = |cell: &Cell| match cell {
            Cell::Number(number) => Some(*number),
            // An empty field is a missing number of a case.
            Cell::Word("") => Some(f64::NAN),
            Cell::Word(_) => None,
        };
        if let Some(numbers) = cells.iter().map(number).collect::<Option<Vec<f64>>>() {
            table.set_item(column.name(), PyArray1::from_vec(py, numbers))?;
            continue;
        }
        let text = |cell: &Cell| match cell {
            Cell::Number(number) => number.to_string(),
            Cell::Word(word) => (*word).to_owned(),
        };
        table.set_item(column.name(), cells.iter().map(text).collect::<Vec<_>>())?;
    }
    Ok(table)
}

/// A run of ``solve`` or ``simulate``, read from its folder: arrays with as many digits as the files have.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Run {
    run: StoredRun,
    arc: StoredArc,
}

/// Advice for a folder without the tables of nodes, and for one without moments.
const NO_NODES: &str = "the folder must hold nodal_displacements.csv, and in a link with weight the direction from which they count";
const NO_MOMENTS: &str =
    "solve(…, moments=True) computes them, and `write` of it writes bending_moments.csv";

/// A quantity at nodes, or an error if the folder lacks it.
fn written<'a>(
    of: Option<&'a StoredNodes>,
    what: &str,
    hint: &str,
) -> Result<&'a StoredNodes, Failure> {
    let message = format!("{what} is missing: the run did not write it");
    of.ok_or_else(|| Failure::new(Exit::InputRefused, &message, Some(hint)))
}

impl Run {
    /// A quantity at nodes in the folder, if there is one.
    fn nodal(&self) -> Option<&StoredNodes> {
        self.arc.deflections_m.as_ref().or(self.run.links[0].moments_n_m.as_ref())
    }

    /// The hub.
    fn hub(&self) -> &StoredJoint {
        &self.run.joints[0]
    }

    /// Histories of nodes, all by default, each with an addend that depends on distance in m and hub angle in rad.
    fn histories<'py>(
        &self,
        py: Python<'py>,
        of: &StoredNodes,
        (nodes, addend): (Option<Vec<usize>>, impl Fn(f64, f64) -> f64),
    ) -> Result<Bound<'py, PyArray2<f64>>, Raised> {
        let StoredArc { origin_rad, mesh, .. } = &self.arc;
        // Both are ascending, and equal times have equal numbers.
        let mut hub = self.run.times_s.iter().zip(&self.hub().angle_rad);
        let turned = of.times_s.iter().map(|at_s| {
            let found = hub.by_ref().find(|(time_s, _)| **time_s >= at_s - self.half_a_step_s());
            found.map_or(f64::NAN, |(_, angle_rad)| angle_rad - origin_rad)
        });
        let turned: Vec<f64> = turned.collect();
        let history = |node: usize| {
            let Some(at) = of.nodes.iter().position(|own| *own == node) else {
                let all: Vec<String> = of.nodes.iter().map(usize::to_string).collect();
                let must = format!("must be one that was written: {}", all.join(", "));
                return Err(usage(&format!("nodes = {node}, but {must}"), None));
            };
            let x_m = mesh.nodes_m()[node];
            let both = of.histories[at].iter().zip(&turned);
            Ok(both.map(|(value, angle_rad)| value + addend(x_m, *angle_rad)).collect())
        };
        let nodes = nodes.unwrap_or_else(|| of.nodes.clone());
        let found = nodes.into_iter().map(history).collect::<Result<Vec<Vec<f64>>, _>>()?;
        Ok(rows(py, &found, of.times_s.len())?)
    }

    /// Half of the step of the run's times in s.
    fn half_a_step_s(&self) -> f64 {
        let times_s = &self.run.times_s;
        0.5 * (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1) as f64
    }
}

#[pymethods]
impl Run {
    /// ``"solve"`` or ``"simulate"``.
    #[getter]
    fn command(&self) -> &str {
        &self.run.origin.command
    }

    #[getter]
    fn title(&self) -> &str {
        &self.run.origin.title
    }

    /// Times in s.
    #[getter]
    fn time<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.run.times_s)
    }

    /// Torque at the hub in N m.
    #[getter]
    fn torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.hub().torque_n_m)
    }

    /// Hub angle in rad.
    #[getter]
    fn hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.hub().angle_rad)
    }

    /// Displacement of the tip in m along its arc.
    #[getter]
    fn tip_displacement<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.arc.tip.displacement_m)
    }

    /// Velocity of the tip in m/s.
    #[getter]
    fn tip_velocity<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.arc.tip.velocity_m_s)
    }

    /// Acceleration of the tip in m/s².
    #[getter]
    fn tip_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.arc.tip.acceleration_m_s2)
    }

    /// Torque in N m of the rigid link; None for a simulation.
    #[getter]
    fn rigid_torque<'py>(slf: &Bound<'py, Self>) -> Option<Array<'py>> {
        slf.get().hub().rigid_torque_n_m.as_ref()?;
        Some(view(slf, |own| own.hub().rigid_torque_n_m.as_deref().unwrap_or_default()))
    }

    /// Distances of the nodes from the axis in m.
    #[getter]
    fn nodes<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| own.arc.mesh.nodes_m())
    }

    /// Numbers of the nodes that were written, from 0 at the root.
    #[getter]
    fn written_nodes(&self) -> Vec<usize> {
        self.nodal().map(|own| own.nodes.clone()).unwrap_or_default()
    }

    /// Times in s of the nodes' histories: those of ``time`` that were written.
    #[getter]
    fn nodal_time<'py>(&self, py: Python<'py>) -> Array<'py> {
        PyArray1::from_slice(py, self.nodal().map_or(&[], |own| &own.times_s))
    }

    /// Displacements of nodes in m, as those of a solution, of ``nodes`` that were written, by default of all: a row for each
    /// of ``nodal_time``, a column for each node.
    #[pyo3(signature = (nodes=None))]
    fn displacements<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Vec<usize>>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Raised> {
        let own = written(self.arc.deflections_m.as_ref(), "displacements", NO_NODES)?;
        self.histories(py, own, (nodes, |x_m, angle_rad| x_m * angle_rad))
    }

    /// Deflections of nodes in m from the hub's tangent line, in the form of ``displacements``.
    #[pyo3(signature = (nodes=None))]
    fn deflections<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Vec<usize>>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Raised> {
        let own = written(self.arc.deflections_m.as_ref(), "deflections", NO_NODES)?;
        self.histories(py, own, (nodes, |_, _| 0.0))
    }

    /// Bending moments at nodes in N m, written by a run with ``moments``, in the form of ``displacements``.
    #[pyo3(signature = (nodes=None))]
    fn moments<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Vec<usize>>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Raised> {
        let own = written(self.run.links[0].moments_n_m.as_ref(), "moments", NO_MOMENTS)?;
        self.histories(py, own, (nodes, |_, _| 0.0))
    }

    /// Numbers of summary.json by name: ``peak_torque_n_m``.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        numbers(py, &self.run.readings)
    }

    /// Warnings of the run.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.run.warnings)
    }

    /// The histories as a `pandas.DataFrame` over the time.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let names = ["torque", "hub_angle", "tip_displacement", "tip_velocity", "tip_acceleration"];
        frame(slf, &names)
    }

    fn __repr__(&self) -> String {
        format!("Run({:?}, samples={})", self.command(), self.run.times_s.len())
    }
}

/// A run of an arm, read from its folder. Arrays have a column for each joint, the inner one first.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct ArmRun(StoredRun);

#[pymethods]
impl ArmRun {
    /// ``"solve"`` or ``"simulate"``.
    #[getter]
    fn command(&self) -> &str {
        &self.0.origin.command
    }

    #[getter]
    fn title(&self) -> &str {
        &self.0.origin.title
    }

    /// Times in s.
    #[getter]
    fn time<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.times_s)
    }

    /// Torque in N m of each joint.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let histories: Vec<&[f64]> =
            self.0.joints.iter().map(|joint| &joint.torque_n_m[..]).collect();
        rows(py, &histories, self.0.times_s.len())
    }

    /// Angle in rad of each joint.
    #[getter]
    fn joint_angle<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let histories: Vec<&[f64]> =
            self.0.joints.iter().map(|joint| &joint.angle_rad[..]).collect();
        rows(py, &histories, self.0.times_s.len())
    }

    /// x and y of the tip in m.
    #[getter]
    fn tip<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.0.tip_m, self.0.times_s.len())
    }

    /// Numbers of summary.json by name.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        numbers(py, &self.0.readings)
    }

    /// Warnings of the run.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.0.warnings)
    }

    /// The histories as a `pandas.DataFrame` over the time, a column for each joint: ``torque1``, ``torque2``.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &["torque", "joint_angle", "tip"])
    }

    fn __repr__(&self) -> String {
        format!("ArmRun({:?}, samples={})", self.command(), self.0.times_s.len())
    }
}

fn numbers<'py>(py: Python<'py>, readings: &[(String, f64)]) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    for (name, value) in readings {
        found.set_item(name, value)?;
    }
    Ok(found)
}
