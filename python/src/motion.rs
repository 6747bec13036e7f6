//! A motion of a tip: its arrays or its file in a call, and the samples read from them.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use flexlink::cli::options::inputs::Wanted;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::{Exit, Failure};
use flexlink::csv::{InputFile, MotionTable, SampleRows, read_motion_table_as};
use flexlink::link::{Arm, Gravity, Link as LibraryLink};
use flexlink::motion::{Motion as LibraryMotion, MotionColumns, Periods, TipMotion, TipTarget};
use flexlink::result::Notice;

use crate::arrays::{column, dictionary, places};
use crate::keywords;
use crate::link::{Link, PickledSource, Source, described_by};
use crate::messages::{Raised, of_reading, usage};
use crate::pool;

/// Name of samples without a file in messages.
pub(crate) const MOTION: &str = "motion";

/// Keywords with samples of a motion.
pub(crate) const COLUMNS: [&str; 4] = ["acceleration", "velocity", "displacement", "angle"];

/// A motion in a call.
pub(crate) enum Given {
    File(InputFile),
    Samples(Box<MotionColumns>),
    Angle { time_s: Vec<f64>, angle_rad: Vec<f64> },
}

impl Given {
    /// Takes the samples out of the keywords; `time` may be the path of a file instead.
    fn take(time: &Bound<'_, PyAny>, keywords: &Bound<'_, PyDict>) -> Result<Self, Raised> {
        let mut samples = COLUMNS.map(|_| None);
        for (name, own) in COLUMNS.into_iter().zip(&mut samples) {
            if let Some(given) = keywords.get_item(name)? {
                keywords.del_item(name)?;
                let read = if matches!(name, "displacement" | "angle") { places } else { column };
                *own = if given.is_none() { None } else { Some(read(name, &given)?) };
            }
        }
        if let Some(path) = path_of(time)? {
            if let Some(at) = samples.iter().position(Option::is_some) {
                let message = format!("{} is given beside a file", COLUMNS[at]);
                return Err(usage(&message, Some("leave one of them out")).into());
            }
            return Ok(Self::File(InputFile::read(&path).map_err(Failure::from)?));
        }
        let time_s = column("time", time)?;
        Ok(match samples {
            [None, None, None, Some(angle_rad)] => Self::Angle { time_s, angle_rad },
            [_, _, _, Some(_)] => {
                let hint =
                    Some("an angle stands for the displacement, and has no columns beside it");
                return Err(usage(&"angle is given beside another column", hint).into());
            }
            [acceleration_m_s2, velocity_m_s, displacement_m, None] => {
                let columns =
                    MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m };
                Self::Samples(Box::new(columns))
            }
        })
    }

    /// The table of the tip of a link of this length, and remarks on its file.
    fn table(
        &self,
        length_m: f64,
        options: &SolveOptions,
    ) -> Result<(MotionTable, Vec<Notice>), Failure> {
        if !matches!(self, Self::File(_)) {
            refuse_reading(options)?;
        }
        let table = match self {
            Self::File(InputFile { shown, bytes, .. }) => {
                let table = read_motion_table_as(
                    shown,
                    bytes,
                    &[length_m],
                    &options.resample.format(&options.read),
                )?;
                let reading = of_reading(shown, table.reading());
                return Ok((table, reading));
            }
            Self::Samples(columns) => MotionTable::of_columns(MOTION, (**columns).clone())?,
            Self::Angle { time_s, angle_rad } => {
                MotionTable::of_angle(MOTION, time_s.clone(), angle_rad, length_m)?
            }
        };
        Ok((table, Vec::new()))
    }

    /// The motion of a link's tip, and remarks on its file.
    pub(crate) fn motion(
        &self,
        arm: &Arm,
        options: &SolveOptions,
    ) -> Result<(Wanted, Vec<Notice>), Failure> {
        let (table, reading) = self.table(arm.length_m(), options)?;
        let wanted = options.resample.motion_in(table, Some(arm))?;
        Ok((options.scale.scaled(&wanted)?, reading))
    }

    pub(crate) fn file(&self) -> Option<&InputFile> {
        if let Self::File(file) = self { Some(file) } else { None }
    }

    /// The arguments for `unpickled`.
    pub(crate) fn pickled<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let columns = match self {
            Self::File(file) => return Ok((Some(pickled_file(file)), PyDict::new(py))),
            Self::Angle { time_s, angle_rad } => {
                vec![("time", Some(time_s)), ("angle", Some(angle_rad))]
            }
            Self::Samples(own) => vec![
                ("time", Some(&own.time_s)),
                ("acceleration", own.acceleration_m_s2.as_ref()),
                ("velocity", own.velocity_m_s.as_ref()),
                ("displacement", own.displacement_m.as_ref()),
            ],
        };
        let given = columns.into_iter().filter_map(|(name, own)| Some((name, own?.clone())));
        Ok((None, dictionary(py, given)?))
    }

    pub(crate) fn unpickled((file, columns): Pickled<'_>) -> Result<Self, Raised> {
        match file {
            Some(file) => Ok(Self::File(unpickled_file(file))),
            None => Self::take(&taken_time(&columns)?, &columns),
        }
    }
}

/// A motion or path in a pickle: its file, or its columns.
pub(crate) type Pickled<'py> = (Option<PickledFile>, Bound<'py, PyDict>);

pub(crate) type PickledFile = (String, String, Vec<u8>);

pub(crate) fn pickled_file(InputFile { shown, name, bytes }: &InputFile) -> PickledFile {
    (shown.clone(), name.clone(), bytes.clone())
}

pub(crate) fn unpickled_file((shown, name, bytes): PickledFile) -> InputFile {
    InputFile { shown, name, bytes }
}

/// Takes the times out of columns.
pub(crate) fn taken_time<'py>(columns: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    let time = columns.as_any().get_item("time")?;
    columns.del_item("time")?;
    Ok(time)
}

/// Refuses options for reading files if the samples are arrays in SI.
pub(crate) fn refuse_reading(options: &SolveOptions) -> Result<(), Failure> {
    if options.resample.format(&options.read).drop_outliers {
        let hint =
            Some("the refusal of a bad sample gives its number and what its neighbours lead to");
        return Err(usage(&"drop_outliers is for files, and the motion is arrays", hint));
    }
    match options.read.arguments().first() {
        None => Ok(()),
        Some(option) => {
            let option = option.split('=').next().unwrap_or_default();
            let hint = Some("arrays are in SI; multiply them");
            Err(usage(&format!("{option} is for files, and the motion is arrays"), hint))
        }
    }
}

/// The path in a text or a path-like object.
pub(crate) fn path_of(given: &Bound<'_, PyAny>) -> PyResult<Option<PathBuf>> {
    if given.is_instance_of::<PyString>() || given.hasattr("__fspath__")? {
        return Ok(Some(given.extract::<PathBuf>()?));
    }
    Ok(None)
}

/// A motion in a call, and its options.
pub(crate) struct Call<'a> {
    pub(crate) given: Arc<Given>,
    pub(crate) arguments: Vec<String>,
    /// The object of the motion, if the call has one.
    pub(crate) motion: Option<&'a Motion>,
}

impl<'a> Call<'a> {
    /// Takes the motion out of the keywords; `time` may be a [`Motion`], or the path of a file.
    pub(crate) fn take(
        time: &'a Bound<'_, PyAny>,
        keywords: &Bound<'_, PyDict>,
    ) -> Result<Self, Raised> {
        keywords::refuse_commands(keywords)?;
        let Ok(motion) = time.cast::<Motion>() else {
            let given = Arc::new(Given::take(time, keywords)?);
            return Ok(Self { given, arguments: keywords::arguments(keywords)?, motion: None });
        };
        let motion = motion.get();
        let is_given = |name: &&&str| keywords.contains(**name).unwrap_or_default();
        let column = COLUMNS.iter().find(is_given).map(|name| (*name).to_owned());
        let own = keywords::arguments(keywords)?;
        let beside = match column {
            Some(name) => Some(name),
            None => of_motion(&keywords::solve_options(&own)?).into_iter().next(),
        };
        if let Some(name) = beside {
            let name = name.split('=').next().unwrap_or_default();
            let message = format!("{name} is given beside a Motion, but must be given to it");
            return Err(usage(&message, None).into());
        }
        let arguments = motion.arguments.iter().cloned().chain(own).collect();
        Ok(Self { given: Arc::clone(&motion.given), arguments, motion: Some(motion) })
    }
}

/// The options that define the motion, as arguments.
fn of_motion(options: &SolveOptions) -> Vec<String> {
    [options.resample.arguments(), options.scale.arguments(), options.read.arguments()].concat()
}

/// The motion of a tip, read once and solved for many links: :func:`solve` and :func:`sweep` take it in place of time and
/// columns, with the same results.
///
/// It takes the arrays or the file of :func:`solve`, and the keywords that say what the motion is, from ``resample`` to
/// ``decimal``. Angles are arcs of a link's length: they need ``link``, and are those of links of that length. The object
/// keeps the cut-off and the last two spectra that were computed of the motion, so that a loop over links does not compute
/// them again.
///
/// >>> import flexlink, numpy
/// >>> time = numpy.linspace(0, 0.88, 881)
/// >>> motion = flexlink.Motion(time, acceleration=4 * numpy.sin(2 * numpy.pi * time / 0.88))
/// >>> motion
/// Motion(samples=881, travel=0.493)
/// >>> strip = {"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}
/// >>> link = flexlink.Link(segments=[strip], hub={"inertia": 0.1}, damping={"ratio": 0.02})
/// >>> stiffer = [link.changed({"segments.*.EI*": factor}) for factor in (1, 2, 4)]
/// >>> peaks = [abs(flexlink.solve(own, motion).torque).max() for own in stiffer]
/// >>> bool(peaks[0] < peaks[1] < peaks[2])
/// True
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Motion {
    given: Arc<Given>,
    arguments: Vec<String>,
    pub(crate) reading: Vec<Notice>,
    pub(crate) tip: TipMotion,
    pub(crate) periods: Arc<Periods>,
    /// The link of the call.
    link: Option<Source>,
    /// Length in m and gravity of the link, for angles that stand for its arcs.
    arcs_of: Option<(f64, Option<Gravity>)>,
}

impl Motion {
    fn read(given: Given, arguments: Vec<String>, link: Option<&Link>) -> Result<Self, Failure> {
        let source = link.map(|own| own.source.clone());
        let arm = link.map(|own| &own.specification.arm);
        let link = link.map(|own| own.specification.link());
        let options = keywords::solve_options(&arguments)?;
        let own = of_motion(&options);
        let is_other = |option: &String| option.starts_with("--") && !own.contains(option);
        if let Some(option) = options.arguments().into_iter().find(is_other) {
            return Err(usage(
                &format!("{option} is given to a Motion, but must be given to solve"),
                None,
            ));
        }
        let (table, reading) = given.table(link.map_or(1.0, LibraryLink::length_m), &options)?;
        let is_of_angle = table.is_of_angle();
        if link.is_none() && is_of_angle {
            let message =
                "link = nothing, but must be given for angles: they are arcs of its length";
            return Err(usage(&message, None));
        }
        let wanted = options.scale.scaled(&options.resample.motion_in(table, arm)?)?;
        let Some(tip) = wanted.motion.into_tip() else { return Err(usage(&"no motion", None)) };
        let arcs_of = link.filter(|_| is_of_angle);
        let arcs_of = arcs_of.map(|link| (link.length_m(), link.gravity().copied()));
        let (given, periods) = (Arc::new(given), Arc::new(Periods::of(&tip)));
        Ok(Self { given, arguments, reading, tip, periods, link: source, arcs_of })
    }

    /// Refuses a link of another length or gravity if the motion is angles of a link.
    pub(crate) fn refuse_other(&self, link: &LibraryLink) -> Result<(), Failure> {
        let Some((length_m, gravity)) = &self.arcs_of else { return Ok(()) };
        let is_same = length_m.total_cmp(&link.length_m()).is_eq();
        if is_same && gravity.as_ref() == link.gravity() {
            return Ok(());
        }
        let message =
            "the motion is angles of a link of another length or gravity, but must be of this link";
        Err(Failure::new(Exit::InputRefused, &message, Some("make a Motion with link=… of it")))
    }

    /// The motion as `solve` takes it.
    pub(crate) fn wanted(&self) -> Wanted {
        let rows = SampleRows::of_arrays(MOTION);
        Wanted { motion: LibraryMotion::Tip(self.tip.clone()), rows }
    }

    /// The displacement of the tip between two times in s.
    pub(crate) fn target(&self, from_s: f64, until_s: f64) -> TipTarget {
        self.tip.target(from_s, until_s)
    }
}

#[pymethods]
impl Motion {
    #[new]
    #[pyo3(signature = (time, *, link=None, **keywords))]
    fn new(
        py: Python<'_>,
        time: &Bound<'_, PyAny>,
        link: Option<&Bound<'_, PyAny>>,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> Result<Self, Raised> {
        let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
        let link = link.map(described_by::<Link>).transpose()?.map(Bound::get);
        keywords::refuse_commands(&keywords)?;
        let given = Given::take(time, &keywords)?;
        let arguments = keywords::arguments(&keywords)?;
        Ok(py.detach(|| pool::install(|| Self::read(given, arguments, link)))?)
    }

    /// Times in s, evenly spaced.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let grid = self.tip.grid();
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Displacement of the tip in m along its arc, computed by each call.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Raised> {
        let grid = self.tip.grid();
        let find = || Ok(self.target(grid.time_s(0), grid.end_s()).displacement_m().to_vec());
        Ok(PyArray1::from_vec(py, py.detach(|| pool::install(find))?))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, own) = (slf.py(), slf.get());
        let (file, columns) = own.given.pickled(py)?;
        let link = own.link.as_ref().map(Source::pickled);
        let arguments = (file, columns, own.arguments.clone(), link).into_pyobject(py)?;
        Ok((slf.get_type().getattr("_unpickled")?, arguments))
    }

    #[staticmethod]
    fn _unpickled(
        py: Python<'_>,
        file: Option<PickledFile>,
        columns: Bound<'_, PyDict>,
        arguments: Vec<String>,
        link: Option<PickledSource>,
    ) -> Result<Self, Raised> {
        let given = Given::unpickled((file, columns))?;
        let link = link.map(|own| Link::of(Source::unpickled(own))).transpose()?;
        Ok(py.detach(|| pool::install(|| Self::read(given, arguments, link.as_ref())))?)
    }

    fn __repr__(&self) -> String {
        format!("Motion(samples={}, travel={:.3})", self.tip.grid().len, self.tip.travel_m())
    }
}
