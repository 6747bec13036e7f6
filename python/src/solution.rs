//! The solution of a link.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use flexlink::beam::NodalHistories;
use flexlink::inverse::Solution as LibrarySolution;
use flexlink::link::ParameterError;
use flexlink::result::Notice;

use crate::arrays::{Every, Nodes, check_rows, frame, rows, view};
use crate::interrupt::until_pressed;
use crate::keywords;
use crate::link::{Link, PickledSource, Source};
use crate::messages::{Raised, objects};
use crate::motion::{Call, Given, PickledFile};
use crate::pool;
use crate::solve::solved;
use crate::solved::SolvedRun;

/// Columns of a data frame.
const HISTORIES: [&str; 9] = [
    "torque",
    "rigid_torque",
    "hub_angle",
    "hub_rate",
    "hub_acceleration",
    "tip_displacement",
    "tip_velocity",
    "tip_acceleration",
    "tip_deflection",
];

/// Keywords of `write`.
const WRITING: [&str; 6] = ["nodes", "stations", "every", "deflections", "digits", "golden"];

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// What the hub must do so that the tip moves as wanted. Arrays are views that cannot be written to, one value for each of
/// ``time``; units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Solution {
    pub(crate) given: Arc<Given>,
    /// How its file was read.
    pub(crate) reading: Vec<Notice>,
    pub(crate) run: SolvedRun,
}

impl Solution {
    fn solution(&self) -> &LibrarySolution {
        self.run.solution()
    }

    /// A quantity at nodes, all by default, of every `every`-th sample.
    fn nodal<'py>(
        &self,
        py: Python<'py>,
        (nodes, every): (Option<Nodes>, Every),
        find: impl FnOnce(&LibrarySolution, &[usize]) -> Result<NodalHistories, ParameterError> + Send,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let nodes = Nodes::or_all(nodes, self.solution().links[0].mesh().nodes_m().len());
        check_rows(self.solution().grid.thinned(every.0).len(), nodes.len())?;
        let found = until_pressed(py, || Ok(find(self.solution(), &nodes)?))?;
        rows(py, &found.samples, found.grid.len())
    }
}

#[pymethods]
impl Solution {
    /// Times in s; those of the motion, and before and after it.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let grid = &self.solution().grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque at the hub in N m.
    #[getter]
    fn torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().hub().torque_n_m)
    }

    /// Torque in N m that the same link would need, were it rigid.
    #[getter]
    fn rigid_torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().hub().rigid_torque_n_m)
    }

    /// Hub angle in rad.
    #[getter]
    fn hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().hub().angle_rad)
    }

    /// Hub rate in rad/s.
    #[getter]
    fn hub_rate<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().hub().rate_rad_s)
    }

    /// Hub acceleration in rad/s², computed by each call.
    #[getter]
    fn hub_acceleration<'py>(&self, py: Python<'py>) -> Result<Array<'py>, Raised> {
        let found = py
            .detach(|| pool::install(|| Ok(self.solution().acceleration_rad_s2(0).into_owned())))?;
        Ok(PyArray1::from_vec(py, found))
    }

    /// Hub angle in rad of the rigid link.
    #[getter]
    fn rigid_hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().hub().rigid_angle_rad)
    }

    /// Moment in N m that the hub exerts on the link's root.
    #[getter]
    fn root_moment<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().links[0].root_moment_n_m)
    }

    /// Displacement of the tip in m along its arc.
    #[getter]
    fn tip_displacement<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().tip[0].displacement_m)
    }

    /// Velocity of the tip in m/s.
    #[getter]
    fn tip_velocity<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().tip[0].velocity_m_s)
    }

    /// Acceleration of the tip in m/s².
    #[getter]
    fn tip_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution().tip[0].acceleration_m_s2)
    }

    /// Deflection of the tip in m from the hub's tangent line.
    #[getter]
    fn tip_deflection<'py>(&self, py: Python<'py>) -> Array<'py> {
        PyArray1::from_vec(py, self.solution().tip_deflection_m(0))
    }

    /// Torque of the motor in N m; None for a link without a drive.
    #[getter]
    fn motor_torque<'py>(slf: &Bound<'py, Self>) -> Option<Array<'py>> {
        slf.get().solution().hub().motor.as_ref()?;
        Some(view(slf, |own| {
            own.solution().hub().motor.as_ref().map_or(&[], |motor| &motor.torque_n_m)
        }))
    }

    /// Rate of the motor in rad/s; None for a link without a drive.
    #[getter]
    fn motor_rate<'py>(slf: &Bound<'py, Self>) -> Option<Array<'py>> {
        slf.get().solution().hub().motor.as_ref()?;
        Some(view(slf, |own| {
            own.solution().hub().motor.as_ref().map_or(&[], |motor| &motor.rate_rad_s)
        }))
    }

    /// Distances of the nodes from the axis in m.
    #[getter]
    fn nodes<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| own.solution().links[0].mesh().nodes_m())
    }

    /// Displacements of nodes in m, numbered from 0 at the root, all by default: a row for each sample, or for every
    /// ``every``-th, a column for each node.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn displacements<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Nodes>,
        every: Every,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.nodal(py, (nodes, every), |own, nodes| {
            Ok(own.displacements(nodes, every.0)?.histories())
        })
    }

    /// The same of the deflections in m from the hub's tangent line.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn deflections<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Nodes>,
        every: Every,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.nodal(py, (nodes, every), |own, nodes| {
            Ok(own.deflections(nodes, every.0)?.histories())
        })
    }

    /// The same of the bending moments in N m.
    #[pyo3(signature = (nodes=None, every=Every::ALL))]
    fn moments<'py>(
        &self,
        py: Python<'py>,
        nodes: Option<Nodes>,
        every: Every,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.nodal(py, (nodes, every), |own, nodes| Ok(own.moments(nodes, every.0)?.histories()))
    }

    /// How exact the answer is, as in summary.json: ``errors["tip"]`` is the tip's distance from its motion over its
    /// travel, ``errors["torque"]["mesh"]`` what elements of half the length change, over the peak, and so on.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("errors")
    }

    /// Peaks, lead and lag, as in summary.json.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("results")
    }

    /// What summary.json of a run holds.
    #[getter(summary)]
    fn summary_of<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Raised> {
        let text = py.detach(|| pool::install(|| self.run.summary(self.given.file())));
        Ok(py.import("json")?.call_method1("loads", (text?,))?)
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.run.warnings)
    }

    /// What is possible but rare, often a slip of units.
    #[getter]
    fn remarks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let found = self.run.remarks();
        let found = self.reading.iter().cloned().chain(found.iter().map(Notice::from));
        objects(py, &found.collect::<Vec<_>>())
    }

    /// Writes the files of ``flexlink solve`` into a folder, all or none: the same bytes, also of summary.json if link and
    /// motion are files. Keywords are its options ``nodes``, ``every``, ``deflections``, ``digits``, ``golden``, and
    /// ``stations``, places in m of nodes: :func:`solve` with the same keyword puts nodes there.
    #[pyo3(signature = (folder, **keywords))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> Result<(), Raised> {
        let more = keywords::of_writing(keywords.as_ref(), &WRITING)?;
        Ok(py.detach(|| pool::apart(|| self.run.write_into(&folder, self.given.file(), more)))?)
    }

    /// The histories as a `pandas.DataFrame` over the time.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &HISTORIES)
    }

    /// A pickle holds link and motion: they are solved again where it is read.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, own) = (slf.py(), slf.get());
        let (file, columns) = own.given.pickled(py)?;
        let arguments = (own.run.source.pickled(), file, columns, own.run.keywords.clone());
        Ok((slf.get_type().getattr("_unpickled")?, arguments.into_pyobject(py)?))
    }

    #[staticmethod]
    fn _unpickled(
        py: Python<'_>,
        link: PickledSource,
        file: Option<PickledFile>,
        columns: Bound<'_, PyDict>,
        arguments: Vec<String>,
    ) -> Result<Self, Raised> {
        let link = Link::of(Source::unpickled(link))?;
        let given = Arc::new(Given::unpickled((file, columns))?);
        let call = Call { given, arguments, motion: None };
        Ok(py.detach(|| pool::install(|| solved(&link, call)))?)
    }

    fn __repr__(&self) -> String {
        let peak = self.run.solved.metrics.hub().peak_torque_n_m.value;
        format!("Solution(samples={}, peak_torque={peak:.6})", self.solution().grid.len)
    }
}
