//! Results read back.

use flexlink::compare::{self, Cell};
use flexlink::csv::Joints;
use flexlink::result::{StoredArc, StoredJoint, StoredNodes, StoredRun};
use flexlink::store::{StoredResult, read_result};

use crate::arrays::rows;
use crate::prelude::*;
use crate::properties::Value::{Notices, Stored};
use crate::properties::{Properties, Value, check, frame};
use crate::threads::without_python;

/// Reads a result. The folder of a run of ``solve`` or ``simulate`` becomes a `Run`; the file of a sweep, and
/// robust.csv in the folder of a study of ``robust``, become a dictionary of their columns.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> Raises<Any<'_>> {
    match without_python(py, || Ok(read_result(&path)?))? {
        StoredResult::Sweep(sweep) => Ok(columns(py, &sweep.table)?.into_any()),
        StoredResult::Robust(study) => Ok(columns(py, &study.plants)?.into_any()),
        StoredResult::Runs(runs) => match runs.into_iter().next() {
            Some(run) => Ok(Bound::new(py, Run(run))?.into_any()),
            None => Err(PyTypeError::new_err("no run").into()),
        },
    }
}

/// Columns of numbers as arrays, columns with a word as lists.
fn columns<'py>(py: Python<'py>, table: &compare::Table) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for column in &table.columns {
        let cells: Vec<Cell> = (0..table.lines.len()).map(|row| column.cell(row)).collect();
        let number = |cell: &Cell| match cell {
            Cell::Number(number) => Some(*number),
            // An empty field is a missing number of a case.
            Cell::Word("") => Some(f64::NAN),
            Cell::Word(_) => None,
        };
        let text = |cell: &Cell| match cell {
            Cell::Number(number) => number.to_string(),
            Cell::Word(word) => (*word).to_owned(),
        };
        match cells.iter().map(number).collect::<Option<Vec<f64>>>() {
            Some(numbers) => all.set_item(column.name(), PyArray1::from_vec(py, numbers))?,
            None => all.set_item(column.name(), cells.iter().map(text).collect::<Vec<_>>())?,
        }
    }
    Ok(all)
}

/// A run of ``solve`` or ``simulate``, read from its folder: arrays with as many digits as the files have; those of an arm
/// have a column for each joint, the inner one first.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Run(StoredRun);

/// Advice for a folder without the tables of nodes, and for one without moments.
const NO_NODES: &str = "the folder must hold nodal_displacements.csv, and in a link with weight the direction from which they count";
const NO_MOMENTS: &str =
    "solve(…, moments=True) computes them, and `write` of it writes bending_moments.csv";

impl Run {
    /// Deflections or moments at nodes in the folder, if there are any.
    fn deflections_m(&self) -> Option<&StoredNodes> {
        self.0.arc.as_ref()?.deflections_m.as_ref()
    }

    fn moments_n_m(&self) -> Option<&StoredNodes> {
        self.0.links[0].moments_n_m.as_ref()
    }

    fn nodal(&self) -> Option<&StoredNodes> {
        self.deflections_m().or(self.moments_n_m())
    }

    /// A history of each joint that has it.
    fn joints(&self, of: fn(&StoredJoint) -> Option<&Vec<f64>>) -> Vec<&[f64]> {
        self.0.joints.iter().filter_map(|joint| of(joint).map(Vec::as_slice)).collect()
    }

    /// A history of the carriage, of one link or of an arm.
    fn carriage(&self, of: fn(&StoredJoint) -> Option<&Vec<f64>>) -> Vec<&[f64]> {
        let of_arm = self.0.carriage.as_ref().map(|own| &own.joint);
        of(of_arm.unwrap_or(&self.0.joints[0])).map(Vec::as_slice).into_iter().collect()
    }

    /// A history of one link, or its nodes.
    fn arc(&self, of: fn(&StoredArc) -> &[f64]) -> Vec<&[f64]> {
        self.0.arc.iter().map(of).collect()
    }

    /// Histories of a quantity at nodes, all by default. The turn of the hub adds its arc, if the quantity is total.
    fn histories<'py>(
        &self,
        py: Python<'py>,
        (name, stored, hint): (&str, Option<&StoredNodes>, &str),
        (nodes, is_total): (Option<Vec<usize>>, bool),
    ) -> Table<'py> {
        check(name, self.kind())?;
        let (Some(stored), Some(StoredArc { origin_rad, mesh, .. })) = (stored, &self.0.arc) else {
            let message = format!("{name} is missing: the run did not write it");
            return Err(Failure::new(Exit::InputRefused, &message, Some(hint)).into());
        };
        let (times_s, last) = (&self.0.times_s, self.0.times_s.len() - 1);
        let half_a_step_s = 0.5 * (times_s[last] - times_s[0]) / last as f64;
        // Both are ascending, and equal times have equal numbers.
        let mut hub = times_s.iter().zip(&self.0.joints[0].angle_rad);
        let turned = stored.times_s.iter().map(|at_s| {
            let at = hub.by_ref().find(|(time_s, _)| **time_s >= at_s - half_a_step_s);
            at.map_or(f64::NAN, |(_, angle_rad)| angle_rad - origin_rad)
        });
        let turned: Vec<f64> = turned.collect();
        let history = |node: usize| {
            let Some(at) = stored.nodes.iter().position(|own| *own == node) else {
                let all: Vec<String> = stored.nodes.iter().map(usize::to_string).collect();
                let must = format!("must be one that was written: {}", all.join(", "));
                return Err(usage(&format!("nodes = {node}, but {must}"), None));
            };
            let (rigid, history) = (mesh.rigid(node)[0], stored.histories[at].iter());
            let total = |(value, angle_rad): (&f64, &f64)| value + rigid * angle_rad;
            let arcs = history.clone().zip(&turned).map(total);
            Ok(if is_total { arcs.collect() } else { history.copied().collect() })
        };
        let nodes = nodes.unwrap_or_else(|| stored.nodes.clone());
        let histories = nodes.into_iter().map(history).collect::<Result<Vec<Vec<f64>>, _>>()?;
        Ok(rows(py, &histories, stored.times_s.len())?)
    }
}

impl Properties for Run {
    const PROPERTIES: &'static [(&'static str, Value<Self>)] = &[
        ("time", Stored(|own| vec![&own.0.times_s])),
        ("torque", Stored(|own| own.joints(|joint| Some(&joint.torque_n_m)))),
        ("force", Stored(|own| own.carriage(|joint| Some(&joint.torque_n_m)))),
        ("rigid_torque", Stored(|own| own.joints(|joint| joint.rigid_torque_n_m.as_ref()))),
        ("rigid_force", Stored(|own| own.carriage(|joint| joint.rigid_torque_n_m.as_ref()))),
        ("hub_angle joint_angle", Stored(|own| own.joints(|joint| Some(&joint.angle_rad)))),
        ("carriage", Stored(|own| own.carriage(|joint| Some(&joint.angle_rad)))),
        ("tip_displacement", Stored(|own| own.arc(|arc| &arc.tip.displacement_m))),
        ("tip_velocity", Stored(|own| own.arc(|arc| &arc.tip.velocity_m_s))),
        ("tip_acceleration", Stored(|own| own.arc(|arc| &arc.tip.acceleration_m_s2))),
        ("tip", Stored(|own| own.0.tip_m.iter().map(Vec::as_slice).collect())),
        ("nodes", Stored(|own| own.arc(|arc| arc.mesh.nodes_m()))),
        ("nodal_time", Stored(|own| vec![own.nodal().map_or(&[], |nodes| &nodes.times_s)])),
        ("warnings", Notices(|own| own.0.warnings.clone())),
    ];
    const FRAME: &'static str = "torque force hub_angle joint_angle carriage tip_displacement tip_velocity tip_acceleration tip";

    fn kind(&self) -> Joints {
        let slides = self.0.links[0].link.joint().slides() || self.0.carriage.is_some();
        Joints { links: self.0.joints.len(), slides }
    }
}

#[pymethods]
impl Run {
    /// ``"solve"`` or ``"simulate"``.
    #[getter]
    fn command(&self) -> &str {
        &self.0.origin.command
    }

    /// Title of the link file.
    #[getter]
    fn title(&self) -> &str {
        &self.0.origin.title
    }

    /// Numbers of the nodes that were written, from 0 at the root.
    #[getter]
    fn written_nodes(&self) -> PyResult<Vec<usize>> {
        check("written_nodes", self.kind())?;
        Ok(self.nodal().map(|stored| stored.nodes.clone()).unwrap_or_default())
    }

    /// Displacements of nodes of one link in m, as those of a solution, of ``nodes`` that were written, by default of all:
    /// a row for each of ``nodal_time``, a column for each node.
    #[pyo3(signature = (nodes=None))]
    fn displacements<'py>(&self, py: Python<'py>, nodes: Option<Vec<usize>>) -> Table<'py> {
        self.histories(py, ("displacements", self.deflections_m(), NO_NODES), (nodes, true))
    }

    /// Deflections of nodes in m from the hub's tangent line, in the form of ``displacements``.
    #[pyo3(signature = (nodes=None))]
    fn deflections<'py>(&self, py: Python<'py>, nodes: Option<Vec<usize>>) -> Table<'py> {
        self.histories(py, ("deflections", self.deflections_m(), NO_NODES), (nodes, false))
    }

    /// Bending moments at nodes in N m, written by a run with ``moments``, in the form of ``displacements``.
    #[pyo3(signature = (nodes=None))]
    fn moments<'py>(&self, py: Python<'py>, nodes: Option<Vec<usize>>) -> Table<'py> {
        self.histories(py, ("moments", self.moments_n_m(), NO_MOMENTS), (nodes, false))
    }

    /// Numbers of summary.json by name: ``peak_torque_n_m``.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.0.readings.iter().map(|(name, value)| (name, value)).into_py_dict(py)
    }

    /// The histories as a `pandas.DataFrame` over the time, those of an arm with a column for each joint: ``torque1``,
    /// ``torque2``.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Any<'py>> {
        frame(slf)
    }

    fn __repr__(&self) -> String {
        format!("Run({:?}, samples={})", self.command(), self.0.times_s.len())
    }
}
