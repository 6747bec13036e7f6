//! Results read back.

use std::slice;

use flexlink::compare::{self, Cell};
use flexlink::csv::{InputFile, Joints};
use flexlink::result::{StoredArc, StoredJoint, StoredLink, StoredNodes, StoredRun};
use flexlink::store::{SUMMARY, StoredResult, read_result};

use crate::arrays::{pairs, rows};
use crate::joints::{Driven, Moving, Of, axes, no_link};
use crate::prelude::*;
use crate::properties::Value::{Entry, Notices, Stored};
use crate::properties::{Named, Properties, check, slices};
use crate::threads::without_python;

/// Reads a result. The folder of a run of ``solve`` or ``simulate`` becomes a `Run`; the file of a sweep, and
/// robust.csv in the folder of a study of ``robust``, become a dictionary of their columns.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> Raises<Any<'_>> {
    match without_python(py, || Ok(read_result(&path)?))? {
        StoredResult::Sweep(sweep) => Ok(columns(py, &sweep.table)?.into_any()),
        StoredResult::Robust(studies) => match studies.into_iter().next() {
            Some(study) => Ok(columns(py, &study.plants)?.into_any()),
            None => Err(PyTypeError::new_err("no study").into()),
        },
        StoredResult::Runs(runs) => match runs.into_iter().next() {
            Some(run) => Ok(Bound::new(py, Run::of(run, path)?)?.into_any()),
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

/// A run of ``solve`` or ``simulate``, read from its folder, with the names of a :class:`Solution`. The files lack
/// ``root_moment``, ``reaction``, the chords and ``tip_deflection``. Arrays have as many digits as the files; those of an arm
/// have a column for each joint, the inner one first. A quantity without a file is None.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Run {
    stored: StoredRun,
    folder: PathBuf,
    /// Content of summary.json.
    summary: String,
}

/// Advice for a folder without the tables of nodes, for that of an arm without deflections, and for one without moments.
const NO_NODES: &str = "the folder must hold nodal_displacements.csv, and in a link with weight the direction from which they count";
const NO_DEFLECTIONS: &str =
    "`write` of a solution with deflections=True writes nodal_deflections.csv";
const NO_MOMENTS: &str =
    "solve(…, moments=True) computes them, and `write` of it writes bending_moments.csv";

impl Run {
    fn of(stored: StoredRun, folder: PathBuf) -> Fails<Self> {
        let summary = InputFile::read(&folder.join(SUMMARY))?.text()?.to_owned();
        Ok(Self { stored, folder, summary })
    }

    /// A link by its number from 0.
    fn link(&self, link: usize) -> Fails<&StoredLink> {
        self.stored.links.get(link).ok_or_else(|| no_link(link, self.links()))
    }

    /// Deflections or moments at nodes of the first link in the folder, if there are any.
    fn nodal(&self) -> Option<&StoredNodes> {
        let StoredLink { deflections_m, moments_n_m, .. } = &self.stored.links[0];
        deflections_m.as_ref().or(moments_n_m.as_ref())
    }

    /// Times of the nodes' histories.
    fn nodal_times_s(&self) -> &[f64] {
        let of_link = || self.nodal().map_or(&[][..], |nodes| &nodes.times_s);
        if self.links() > 1 { &self.stored.nodal_times_s } else { of_link() }
    }

    /// Histories of a quantity at nodes, all by default. The turn of the hub adds its arc, if the quantity is total.
    fn histories<'py>(
        &self,
        py: Python<'py>,
        (name, stored, hint): (&str, Option<&StoredNodes>, &str),
        (nodes, is_total): (Option<Vec<usize>>, bool),
    ) -> Table<'py> {
        let Some(stored) = stored else {
            let message = format!("{name} is missing: the run did not write it");
            return Err(Failure::new(Exit::InputRefused, &message, Some(hint)).into());
        };
        let turned = match &self.stored.arc {
            Some(arc) if is_total => self.turned(arc, &stored.times_s),
            _ => Vec::new(),
        };
        let history = |node: usize| {
            let Some(at) = stored.nodes.iter().position(|own| *own == node) else {
                let all: Vec<String> = stored.nodes.iter().map(usize::to_string).collect();
                let must = format!("must be one that was written: {}", all.join(", "));
                return Err(usage(&format!("nodes = {node}, but {must}"), None));
            };
            let history = stored.histories[at].iter();
            let Some(arc) = self.stored.arc.as_ref().filter(|_| is_total) else {
                return Ok(history.copied().collect());
            };
            let rigid = arc.mesh.rigid(node)[0];
            let total = |(value, angle_rad): (&f64, &f64)| value + rigid * angle_rad;
            Ok(history.zip(&turned).map(total).collect())
        };
        let nodes = nodes.unwrap_or_else(|| stored.nodes.clone());
        let histories = nodes.into_iter().map(history).collect::<Result<Vec<Vec<f64>>, _>>()?;
        Ok(rows(py, &histories, stored.times_s.len())?)
    }

    /// Angle in rad by which the hub has turned at these times, some or all of those of the run.
    fn turned(&self, StoredArc { origin_rad, .. }: &StoredArc, at_s: &[f64]) -> Vec<f64> {
        let (times_s, last) = (&self.stored.times_s, self.stored.times_s.len() - 1);
        let half_a_step_s = 0.5 * (times_s[last] - times_s[0]) / last as f64;
        // Both are ascending, and equal times have equal numbers.
        let mut hub = times_s.iter().zip(&self.stored.joints[0].angle_rad);
        let turned = at_s.iter().map(|at_s| {
            let at = hub.by_ref().find(|(time_s, _)| **time_s >= at_s - half_a_step_s);
            at.map_or(f64::NAN, |(_, angle_rad)| angle_rad - origin_rad)
        });
        turned.collect()
    }
}

impl Driven for Run {
    fn joints(&self, of: Of) -> Vec<Option<&[f64]>> {
        fn history(joint: &StoredJoint, of: Of) -> Option<&Vec<f64>> {
            let motor = joint.motor.as_ref();
            match of {
                Of::Effort => Some(&joint.torque_n_m),
                Of::Position => Some(&joint.angle_rad),
                Of::Rate => Some(&joint.rate_rad_s),
                Of::Acceleration => Some(&joint.acceleration_rad_s2),
                Of::RigidEffort => joint.rigid_torque_n_m.as_ref(),
                Of::RigidPosition => joint.rigid_angle_rad.as_ref(),
                Of::MotorEffort => Some(&motor?.torque_n_m),
                Of::MotorRate => Some(&motor?.rate_rad_s),
                Of::MotorCurrent => motor?.current_a.as_ref(),
                Of::MotorVoltage => motor?.voltage_v.as_ref(),
                Of::MotorPosition | Of::MotorAcceleration | Of::MotorPower => None,
            }
        }
        let carriage = self.stored.carriage.iter().map(|own| &own.joint);
        let joints = self.stored.joints.iter().chain(carriage);
        joints.map(|joint| history(joint, of).map(Vec::as_slice)).collect()
    }
}

impl Moving for Run {
    fn tip(&self, order: usize) -> Vec<&[f64]> {
        match (&self.stored.arc, order) {
            (Some(arc), _) => axes(slice::from_ref(&arc.tip), order),
            (None, 0) => slices(self.stored.tip_m.iter()),
            // Files have the places of an arm's tip alone.
            (None, _) => Vec::new(),
        }
    }

    fn nodes_m(&self) -> Vec<&[f64]> {
        match &self.stored.arc {
            Some(arc) => vec![arc.mesh.nodes_m()],
            None => slices(self.stored.links.iter().map(|link| &link.nodes_m)),
        }
    }
}

impl Properties for Run {
    const PROPERTIES: Named<Self> = &[
        ("time", Stored(|own| vec![&own.stored.times_s])),
        ("nodal_time", Stored(|own| vec![own.nodal_times_s()])),
        ("errors", Entry),
        ("results", Entry),
        ("warnings", Notices(|own| own.stored.warnings.clone())),
        ("remarks", Notices(|own| own.stored.remarks.clone())),
    ];

    fn kind(&self) -> Joints {
        let slides = self.stored.links[0].link.joint().slides() || self.stored.carriage.is_some();
        Joints { links: self.stored.joints.len(), slides }
    }
}

#[pymethods]
impl Run {
    /// ``"solve"`` or ``"simulate"``.
    #[getter]
    fn command(&self) -> &str {
        &self.stored.origin.command
    }

    /// Title of the link file.
    #[getter]
    fn title(&self) -> &str {
        &self.stored.origin.title
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
        check("displacements", self.kind())?;
        let stored = self.stored.links[0].deflections_m.as_ref();
        self.histories(py, ("displacements", stored, NO_NODES), (nodes, true))
    }

    /// Deflections of nodes in m from the hub's tangent line, of the nodes of an arm's ``link`` from its chord, in the form of
    /// ``displacements``. ``link`` counts from 0; that of an arm has them by a run with ``deflections``.
    #[pyo3(signature = (nodes=None, *, link=0))]
    fn deflections<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Vec<usize>>,
        link: usize,
    ) -> Table<'py> {
        let hint = if self.links() > 1 { NO_DEFLECTIONS } else { NO_NODES };
        let stored = self.link(link)?.deflections_m.as_ref();
        self.histories(py, ("deflections", stored, hint), (nodes, false))
    }

    /// Bending moments at nodes in N m of a ``link``, numbered from 0, written by a run with ``moments``, in the form of
    /// ``displacements``.
    #[pyo3(signature = (nodes=None, *, link=0))]
    fn moments<'py>(&self, py: Python<'py>, nodes: Option<Vec<usize>>, link: usize) -> Table<'py> {
        let stored = self.link(link)?.moments_n_m.as_ref();
        self.histories(py, ("moments", stored, NO_MOMENTS), (nodes, false))
    }

    /// x and y in m of the nodes of an arm's ``link``, numbered from 0: an array over ``nodal_time``, node and axis.
    fn positions<'py>(&self, py: Python<'py>, link: usize) -> PairsOverTime<'py> {
        check("positions", self.kind())?;
        let axes: Vec<&Vec<f64>> = self.link(link)?.positions_m.iter().flatten().collect();
        Ok(pairs(py, &axes, self.stored.nodal_times_s.len())?)
    }

    /// Distances in m of the nodes of a ``link``, numbered from 0, from its joint.
    #[pyo3(signature = (link=0))]
    fn nodes_of<'py>(&self, py: Python<'py>, link: usize) -> Raises<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, self.nodes_of_link(link)?))
    }

    /// The folder.
    #[getter]
    fn folder(&self) -> &Path {
        &self.folder
    }

    /// Content of summary.json.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        loaded(py, &self.summary)
    }

    fn __repr__(&self) -> String {
        format!("Run({:?}, samples={})", self.command(), self.stored.times_s.len())
    }
}
