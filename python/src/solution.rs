//! The solution of a link.

use std::path::{Path, PathBuf};
use std::slice::from_ref;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use flexlink::beam::NodalHistories;
use flexlink::inverse::{Solution as LibrarySolution, Unwatched};
use flexlink::link::ParameterError;
use flexlink::result::{Exceeded, Limits, Metrics, Notice};
use flexlink::store::{Findings, OutputFolder, RunInputs, RunOutputs, RunTables, Summary};

use crate::arrays::{Every, Nodes, check_rows, frame, rows, view};
use crate::interrupt::until_pressed;
use crate::keywords::{self, solve_options};
use crate::link::{Link, PickledSource, Source};
use crate::messages::{Raised, objects};
use crate::motion::{Call, Given, PickledFile};
use crate::pool;
use crate::solve::solved;
use flexlink::cli::options::inputs::remarks;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::{Failure, memory};

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

#[expect(clippy::struct_field_names, reason = "the library's solution")]
/// What the hub must do so that the tip moves as wanted. Arrays are views that cannot be written to, one value for each of
/// ``time``; units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Solution {
    source: Source,
    of_file: Vec<flexlink::result::Remark>,
    given: Arc<Given>,
    /// How its file was read.
    reading: Vec<Notice>,
    /// The keywords of the call, as options.
    keywords: Vec<String>,
    solution: LibrarySolution,
    metrics: Metrics,
    limits: Limits,
    exceeded: Vec<Exceeded>,
    pub(crate) warnings: Vec<Notice>,
}

impl Solution {
    pub(crate) fn new(
        link: &Link,
        (given, reading): (Arc<Given>, Vec<Notice>),
        keywords: Vec<String>,
        solution: LibrarySolution,
    ) -> Self {
        let metrics = Metrics::of(&solution);
        let exceeded = metrics.exceeded(&[link.specification.limits]);
        let of_limits = exceeded.iter().map(Notice::from);
        let warnings = solution.warnings.iter().map(Notice::from).chain(of_limits).collect();
        let limits = link.specification.limits;
        let (source, of_file) = (link.source.clone(), link.specification.remarks.clone());
        Self {
            source,
            of_file,
            given,
            reading,
            keywords,
            solution,
            metrics,
            limits,
            exceeded,
            warnings,
        }
    }

    /// What a run of the command would record, of link and motion that are no files the arguments alone.
    fn inputs(&self, options: &SolveOptions) -> RunInputs {
        match self.given.file() {
            Some(motion) if self.source.is_file => {
                RunInputs::of_solve(&self.source.file, motion, options.arguments())
            }
            _ => RunInputs::of_arguments(options.arguments()),
        }
    }

    /// The options of the call, with those of writing.
    fn options(&self, more: Vec<String>) -> Result<SolveOptions, Failure> {
        let changes =
            self.source.changes.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
        solve_options(&changes.chain(self.keywords.clone()).chain(more).collect::<Vec<_>>())
    }

    fn summary(&self, options: &SolveOptions, outputs: &RunOutputs) -> Summary {
        let remarks = remarks(&self.of_file, &self.solution);
        let findings = Findings {
            limits: from_ref(&self.limits),
            exceeded: &self.exceeded,
            verification: None,
            remarks: &remarks,
        };
        let inputs = self.inputs(options);
        Summary::of_solution(inputs, &self.solution, &self.metrics, &findings, outputs)
    }

    pub(crate) fn write_into(&self, folder: &Path, more: Vec<String>) -> Result<(), Failure> {
        let options = self.options(more)?;
        let outputs = options.outputs();
        options.nodes.check(&[self.solution.mesh().nodes_m()])?;
        let deflections = outputs.deflections(&self.solution)?;
        memory::check_nodes(deflections.bytes(), memory::available())?;
        let summary = self.summary(&options, &outputs);
        let folder = OutputFolder::stage(folder, &|_| {})?;
        let tables = RunTables::of_solution(&self.solution, deflections);
        Ok(outputs.write(folder, tables, (&summary, None), &Unwatched)?)
    }

    /// A quantity at nodes, all by default, of every `every`-th sample.
    fn nodal<'py>(
        &self,
        py: Python<'py>,
        (nodes, every): (Option<Nodes>, Every),
        find: impl FnOnce(&LibrarySolution, &[usize]) -> Result<NodalHistories, ParameterError> + Send,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let nodes = Nodes::or_all(nodes, self.solution.mesh().nodes_m().len());
        check_rows(self.solution.grid.thinned(every.0).len(), nodes.len())?;
        let found = until_pressed(py, || Ok(find(&self.solution, &nodes)?))?;
        rows(py, &found.samples, found.grid.len())
    }
}

#[pymethods]
impl Solution {
    /// Times in s; those of the motion, and before and after it.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let grid = &self.solution.grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque at the hub in N m.
    #[getter]
    fn torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.torque_n_m)
    }

    /// Torque in N m that the same link would need, were it rigid.
    #[getter]
    fn rigid_torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.rigid_torque_n_m)
    }

    /// Hub angle in rad.
    #[getter]
    fn hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.hub_angle_rad)
    }

    /// Hub rate in rad/s.
    #[getter]
    fn hub_rate<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.hub_rate_rad_s)
    }

    /// Hub acceleration in rad/s², computed by each call.
    #[getter]
    fn hub_acceleration<'py>(&self, py: Python<'py>) -> Result<Array<'py>, Raised> {
        let found = py.detach(|| pool::install(|| Ok(self.solution.hub_acceleration_rad_s2())))?;
        Ok(PyArray1::from_vec(py, found))
    }

    /// Hub angle in rad of the rigid link.
    #[getter]
    fn rigid_hub_angle<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.rigid_hub_angle_rad)
    }

    /// Moment in N m that the hub exerts on the link's root.
    #[getter]
    fn root_moment<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.root_moment_n_m)
    }

    /// Displacement of the tip in m along its arc.
    #[getter]
    fn tip_displacement<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.tip.displacement_m)
    }

    /// Velocity of the tip in m/s.
    #[getter]
    fn tip_velocity<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.tip.velocity_m_s)
    }

    /// Acceleration of the tip in m/s².
    #[getter]
    fn tip_acceleration<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.solution.tip.acceleration_m_s2)
    }

    /// Deflection of the tip in m from the hub's tangent line.
    #[getter]
    fn tip_deflection<'py>(&self, py: Python<'py>) -> Array<'py> {
        PyArray1::from_vec(py, self.solution.tip_deflection_m())
    }

    /// Torque of the motor in N m; None for a link without a drive.
    #[getter]
    fn motor_torque<'py>(slf: &Bound<'py, Self>) -> Option<Array<'py>> {
        slf.get().solution.motor.as_ref()?;
        Some(view(slf, |own| own.solution.motor.as_ref().map_or(&[], |motor| &motor.torque_n_m)))
    }

    /// Rate of the motor in rad/s; None for a link without a drive.
    #[getter]
    fn motor_rate<'py>(slf: &Bound<'py, Self>) -> Option<Array<'py>> {
        slf.get().solution.motor.as_ref()?;
        Some(view(slf, |own| own.solution.motor.as_ref().map_or(&[], |motor| &motor.rate_rad_s)))
    }

    /// Distances of the nodes from the axis in m.
    #[getter]
    fn nodes<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| own.solution.mesh().nodes_m())
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
        let text = serde_json::to_string(&self.solution.accuracy);
        let text = text.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        py.import("json")?.call_method1("loads", (text,))
    }

    /// Peaks, lead and lag, as in summary.json.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary_of(py)?.get_item("results")
    }

    /// What summary.json of a run holds.
    #[getter(summary)]
    fn summary_of<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Raised> {
        let text = py.detach(|| {
            pool::install(|| {
                let options = self.options(Vec::new())?;
                Ok(self.summary(&options, &options.outputs()).to_json())
            })
        });
        Ok(py.import("json")?.call_method1("loads", (text?,))?)
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.warnings)
    }

    /// What is possible but rare, often a slip of units.
    #[getter]
    fn remarks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let found = remarks(&self.of_file, &self.solution);
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
        Ok(py.detach(|| pool::apart(|| self.write_into(&folder, more)))?)
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
        let arguments = (own.source.pickled(), file, columns, own.keywords.clone());
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
        let peak = self.metrics.hub().peak_torque_n_m.value;
        format!("Solution(samples={}, peak_torque={peak:.6})", self.solution.grid.len)
    }
}
