//! An arm of several links, its path and its solution.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use flexlink::cli::options::inputs::Wanted;
use flexlink::cli::problem::Problem;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::{Exit, Failure, memory};
use flexlink::csv::{InputFile, MotionTable};
use flexlink::inverse::{JointMotion, Resources};
use flexlink::link::Arm as LibraryArm;
use flexlink::motion::{PathColumn, PathColumns, Recording};
use flexlink::result::Notice;
use flexlink::spec::Specification;

use crate::arrays::{column, dictionary, frame, places, rows};
use crate::keywords::{self, solve_options};
use crate::link::{PickledSource, Source, python_text};
use crate::messages::{Raised, objects, usage};
use crate::motion::{
    MOTION, Motion, Pickled, PickledFile, path_of, pickled_file, refuse_reading, taken_time,
    unpickled_file,
};
use crate::pool;
use crate::solved::SolvedRun;

/// Keywords of `write`.
const WRITING: [&str; 6] = ["nodes", "stations", "every", "deflections", "digits", "golden"];

/// An arm of several flexible links, as an arm file describes it, or keywords that are the keys of one.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Arm {
    pub(crate) source: Source,
    pub(crate) specification: Specification,
}

impl Arm {
    fn of(source: Source) -> Result<Self, Failure> {
        let specification = source.described()?;
        if specification.arm.links().len() > 1 {
            return Ok(Self { source, specification });
        }
        let message = format!("{}: one link, but must be an arm of several", source.file.shown);
        let hint = Some("flexlink.Link.read reads links");
        Err(Failure::new(Exit::InputRefused, &message, hint))
    }
}

#[pymethods]
impl Arm {
    #[new]
    #[pyo3(signature = (**keys))]
    fn new(py: Python<'_>, keys: Option<Bound<'_, PyDict>>) -> Result<Self, Raised> {
        let keys = keys.unwrap_or_else(|| PyDict::new(py));
        Ok(Self::of(Source::of_keywords(&keys)?)?)
    }

    /// Reads an arm file, with changes as those of ``--set``: ``{"links.fore.payload.mass": 0.2}``.
    #[staticmethod]
    #[pyo3(signature = (path, changes=None))]
    fn read(path: PathBuf, changes: Option<&Bound<'_, PyDict>>) -> Result<Self, Raised> {
        Ok(Self::of(Source::read(&path, keywords::changes(changes)?)?)?)
    }

    /// The same arm with further changes.
    fn changed(&self, changes: &Bound<'_, PyDict>) -> Result<Self, Raised> {
        Ok(Self::of(self.source.changed(keywords::changes(Some(changes))?))?)
    }

    #[getter]
    fn title(&self) -> &str {
        self.specification.arm.title()
    }

    /// Lengths of the links in m, the inner one first.
    #[getter]
    fn lengths(&self) -> Vec<f64> {
        self.specification.arm.lengths_m()
    }

    fn __repr__(&self) -> String {
        format!("Arm({}, lengths={:?})", python_text(self.title()), self.lengths())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let unpickle = slf.get_type().getattr("_unpickled")?;
        Ok((unpickle, slf.get().source.pickled().into_pyobject(slf.py())?))
    }

    #[staticmethod]
    #[pyo3(signature = (*source))]
    fn _unpickled(source: &Bound<'_, PyTuple>) -> Result<Self, Raised> {
        Ok(Self::of(Source::unpickled(source.extract()?))?)
    }
}

/// A path in a call.
pub(crate) enum GivenPath {
    File(InputFile),
    Samples(Box<PathColumns>),
}

impl GivenPath {
    /// Takes `x`, `y` and `angle1`, `angle2`, … out of the keywords; `time` may be the path of a file instead.
    pub(crate) fn take(
        time: &Bound<'_, PyAny>,
        keywords: &Bound<'_, PyDict>,
        links: usize,
    ) -> Result<Self, Raised> {
        keywords::refuse_commands(keywords)?;
        if time.is_instance_of::<Motion>() {
            let message = "a Motion is of one link, and the arm has several";
            return Err(usage(&message, Some("give time, x and y")).into());
        }
        let take = |name: &str| -> Result<Option<PathColumn>, Raised> {
            let Some(given) = keywords.get_item(name)? else { return Ok(None) };
            keywords.del_item(name)?;
            let values = places(name, &given)?;
            Ok(Some(PathColumn { name: name.to_owned(), values, recording: Recording::default() }))
        };
        let (x, y) = (take("x")?, take("y")?);
        let angles = (1..=links).map(|link| take(&format!("angle{link}")));
        let angles = angles.collect::<Result<Vec<_>, Raised>>()?;
        if let Some(path) = path_of(time)? {
            if x.is_some() || y.is_some() || angles.iter().any(Option::is_some) {
                let hint = Some("leave one of them out");
                return Err(usage(&"samples are given beside a file", hint).into());
            }
            return Ok(Self::File(InputFile::read(&path).map_err(Failure::from)?));
        }
        let tip = match (x, y) {
            (Some(x), Some(y)) => Some([x, y]),
            (None, None) => None,
            _ => return Err(usage(&"one of x and y, but must be both or none", None).into()),
        };
        let columns = PathColumns { time_s: column("time", time)?, tip, angles };
        Ok(Self::Samples(Box::new(columns)))
    }

    /// The file of the path, if it has one.
    pub(crate) fn file(&self) -> Option<&InputFile> {
        match self {
            Self::File(file) => Some(file),
            Self::Samples(_) => None,
        }
    }

    /// The path, as that of an arm with these links.
    pub(crate) fn path(&self, arm: &LibraryArm, options: &SolveOptions) -> Result<Wanted, Failure> {
        let wanted = match self {
            Self::File(file) => options.resample.motion_of(file, arm, &options.read)?.0,
            Self::Samples(columns) => {
                refuse_reading(options)?;
                let columns = (**columns).clone();
                let table = MotionTable::of_path(MOTION, columns, &arm.lengths_m())?;
                options.resample.motion_in(table, Some(arm))?
            }
        };
        options.scale.scaled(&wanted)
    }

    /// The arguments for `unpickled`.
    fn pickled<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let PathColumns { time_s, tip, angles } = match self {
            Self::File(file) => return Ok((Some(pickled_file(file)), PyDict::new(py))),
            Self::Samples(columns) => &**columns,
        };
        let columns = tip.iter().flatten().chain(angles.iter().flatten());
        let columns = columns.map(|own| (own.name.as_str(), own.values.clone()));
        Ok((None, dictionary(py, columns.chain([("time", time_s.clone())]))?))
    }

    fn unpickled((file, columns): Pickled<'_>, links: usize) -> Result<Self, Raised> {
        match file {
            Some(file) => Ok(Self::File(unpickled_file(file))),
            None => Self::take(&taken_time(&columns)?, &columns, links),
        }
    }
}

/// The torques of all joints that make the tip of an arm follow its path. Arrays have a row for each of ``time`` and a
/// column for each joint, the inner one first; units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct ArmSolution {
    given: Arc<GivenPath>,
    pub(crate) run: SolvedRun,
}

/// Solves an arm.
pub(crate) fn solved_arm(
    arm: &Arm,
    given: GivenPath,
    keywords: Vec<String>,
) -> Result<ArmSolution, Failure> {
    let options = solve_options(&keywords)?;
    let mut specification = arm.specification.clone();
    options.nodes.meshes(&arm.specification.arm, &mut specification.meshes)?;
    let path = given.path(&arm.specification.arm, &options)?;
    let problem = Problem::of(&arm.source.file, specification, path);
    let resources = Resources { memory_bytes: memory::available(), ..Resources::default() };
    let run = SolvedRun::of(problem, &resources, (arm.source.clone(), keywords))?;
    Ok(ArmSolution { given: Arc::new(given), run })
}

impl ArmSolution {
    fn of_joints<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&JointMotion) -> &[f64],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let solution = self.run.solution();
        let histories: Vec<&[f64]> = solution.joints.iter().map(of).collect();
        rows(py, &histories, solution.grid.len)
    }
}

#[pymethods]
impl ArmSolution {
    /// Times in s; those of the path, and before and after it.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let grid = &self.run.solution().grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque in N m of each joint: it turns its link, and the link before the other way.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.of_joints(py, |joint| &joint.torque_n_m)
    }

    /// Torque in N m of each joint of the rigid arm.
    #[getter]
    fn rigid_torque<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.of_joints(py, |joint| &joint.rigid_torque_n_m)
    }

    /// Angle in rad of each joint: of its link's root against the tip of the link before, of the first joint against x.
    #[getter]
    fn joint_angle<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.of_joints(py, |joint| &joint.angle_rad)
    }

    /// Rate in rad/s of each joint.
    #[getter]
    fn joint_rate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.of_joints(py, |joint| &joint.rate_rad_s)
    }

    /// Direction in rad of each link's chord, from joint to joint.
    #[getter]
    fn chord_angle<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let solution = self.run.solution();
        let histories: Vec<&[f64]> = solution.shapes().map(|own| &own.chord[0][..]).collect();
        rows(py, &histories, solution.grid.len)
    }

    /// x and y of the tip in m.
    #[getter]
    fn tip<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let solution = self.run.solution();
        let places: Vec<&[f64]> = solution.tip.iter().map(|own| &own.displacement_m[..]).collect();
        rows(py, &places, solution.grid.len)
    }

    /// x and y in m of the nodes of a link, numbered from 0: an array over time, node and axis.
    fn positions<'py>(
        &self,
        py: Python<'py>,
        link: usize,
    ) -> Result<Bound<'py, PyArray3<f64>>, Raised> {
        let solution = self.run.solution();
        let Some(shape) = solution.shapes().nth(link) else {
            let links = solution.links.len();
            let message = format!("link = {link}, but must be below {links}, the number of links");
            return Err(usage(&message, None).into());
        };
        let histories: Vec<&[f64]> =
            shape.positions_m.iter().flatten().map(Vec::as_slice).collect();
        let shape = [solution.grid.len, shape.positions_m.len(), 2];
        Ok(rows(py, &histories, solution.grid.len)?.reshape(shape)?)
    }

    /// What summary.json of a run holds.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Raised> {
        Ok(py.import("json")?.call_method1("loads", (self.run.summary(self.given.file())?,))?)
    }

    /// How exact the answer is, as in summary.json.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("errors")
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.run.warnings)
    }

    /// What is possible but rare, often a slip of units.
    #[getter]
    fn remarks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.run.remarks().iter().map(Notice::from).collect::<Vec<_>>())
    }

    /// Writes the files of ``flexlink solve`` into a folder, all or none: the same bytes, also of summary.json if arm and
    /// path are files. Keywords are its options ``nodes``, ``every``, ``deflections``, ``digits``, ``golden``, and ``stations``,
    /// distances in m from a link's joint: :func:`solve` with the same keyword puts nodes there.
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

    /// The histories as a `pandas.DataFrame` over the time, a column for each joint: ``torque1``, ``torque2``.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &["torque", "rigid_torque", "joint_angle", "joint_rate", "tip"])
    }

    /// A pickle holds arm and path: they are solved again where it is read.
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
        arm: PickledSource,
        file: Option<PickledFile>,
        columns: Bound<'_, PyDict>,
        arguments: Vec<String>,
    ) -> Result<Self, Raised> {
        let arm = Arm::of(Source::unpickled(arm))?;
        let links = arm.specification.arm.links().len();
        let given = GivenPath::unpickled((file, columns), links)?;
        Ok(py.detach(|| pool::install(|| solved_arm(&arm, given, arguments)))?)
    }

    fn __repr__(&self) -> String {
        let solution = self.run.solution();
        format!("ArmSolution(samples={}, joints={})", solution.grid.len, solution.joints.len())
    }
}
