//! Results read back.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::compare::Cell;
use flexlink::result::{StoredArm, StoredResult, StoredRun, StoredSweep};
use flexlink::store::read_result;

use crate::arrays::{frame, rows, view};
use crate::messages::objects;
use crate::pool;

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// Reads a result: the folder of a run of ``solve`` or ``simulate`` as a `Run`, that of an arm as an `ArmRun`, the file of a
/// sweep as a dictionary of its columns.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    match py.detach(|| pool::install(|| Ok(read_result(&path)?)))? {
        StoredResult::Run(run) => Ok(Bound::new(py, Run(*run))?.into_any()),
        StoredResult::Sweep(sweep) => Ok(table(py, &sweep)?.into_any()),
        StoredResult::Arms(runs) => match runs.into_iter().next() {
            Some(run) => Ok(Bound::new(py, ArmRun(run))?.into_any()),
            None => Err(PyTypeError::new_err("no run")),
        },
    }
}

/// Columns of numbers as arrays, those with a word as lists.
fn table<'py>(py: Python<'py>, sweep: &StoredSweep) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for column in &sweep.table.columns {
        let cells: Vec<Cell> = (0..sweep.table.lines.len()).map(|row| column.cell(row)).collect();
        let number = |cell: &Cell| match cell {
            Cell::Number(number) => Some(*number),
            // An empty field is a number that a case does not have.
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
pub(crate) struct Run(StoredRun);

#[pymethods]
impl Run {
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

    /// Torque at the hub in N m.
    #[getter]
    fn torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.torque_n_m)
    }

    /// Hub angle in rad.
    #[getter]
    fn hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.hub_angle_rad)
    }

    /// Displacement of the tip in m along its arc.
    #[getter]
    fn tip_displacement<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.tip.displacement_m)
    }

    /// Velocity of the tip in m/s.
    #[getter]
    fn tip_velocity<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.tip.velocity_m_s)
    }

    /// Acceleration of the tip in m/s².
    #[getter]
    fn tip_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.0.tip.acceleration_m_s2)
    }

    /// Torque in N m of the rigid link; None of a simulation.
    #[getter]
    fn rigid_torque<'py>(slf: &Bound<'py, Self>) -> Option<Array<'py>> {
        slf.get().0.solved.as_ref()?;
        Some(view(slf, |own| own.0.solved.as_ref().map_or(&[], |own| &own.rigid_torque_n_m)))
    }

    /// Distances of the nodes from the axis in m.
    #[getter]
    fn nodes<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| own.0.mesh.nodes_m())
    }

    /// Deflections in m from the hub's tangent line of the nodes that were written, a column each; None where none was.
    #[getter]
    fn deflections<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(own) = &self.0.deflections_m else { return Ok(None) };
        Ok(Some(rows(py, &own.histories, own.times_s.len())?))
    }

    /// Numbers of summary.json by name: ``peak_torque_n_m``.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        numbers(py, &self.0.readings)
    }

    /// What the user must know.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.0.warnings)
    }

    /// The histories as a `pandas.DataFrame` over the time.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let names = ["torque", "hub_angle", "tip_displacement", "tip_velocity", "tip_acceleration"];
        frame(slf, &names)
    }

    fn __repr__(&self) -> String {
        format!("Run({:?}, samples={})", self.command(), self.0.times_s.len())
    }
}

/// A run of an arm, read from its folder. Arrays have a column for each joint, the inner one first.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct ArmRun(StoredArm);

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

    /// What the user must know.
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
