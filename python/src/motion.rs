//! The wanted motion of a tip: its arrays or its file in a call, and the samples read from them.

use pyo3::types::PyString;

use flexlink::cli::options::inputs::Wanted;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::csv::{InputFile, MotionTable, Reading, SampleRows, read_motion_table_as};
use flexlink::link::{Arm, Gravity, Link as OneLink};
use flexlink::motion::{
    Motion as WantedMotion, MotionColumns, PathColumn, PathColumns, Periods, Recording, TipMotion,
    TipTarget,
};

use crate::arrays::{column, dictionary, places, times};
use crate::keywords::{self, OF_LINK, OF_TIP};
use crate::link::{Link, PickledSource};
use crate::messages::of_reading;
use crate::prelude::*;
use crate::threads::without_python;

/// Name of samples without a file in messages.
const MOTION: &str = "motion";

/// The samples of a motion in a call: a file, or columns by name with `time` as the first.
pub(crate) enum Samples {
    File(InputFile),
    Arrays(Vec<(String, Vec<f64>)>),
}

impl Samples {
    /// Takes the samples of one link or of an arm out of the keywords; `time` may be the path of a file instead.
    fn take(time: &Any<'_>, keywords: &Keywords<'_>, links: usize) -> Raises<Self> {
        let mut columns = Vec::new();
        for name in names(links) {
            let Some(values) = keywords::take(keywords, &name)? else { continue };
            let is_derivative = ["acceleration", "velocity"].contains(&&*name);
            let read = if is_derivative { column } else { places };
            columns.push((name.clone(), read(&name, &values)?));
        }
        match (path_of(time)?, columns.first()) {
            (Some(_), Some((name, _))) => {
                let message = format!("{name} stands beside a file");
                Err(usage(&message, Some("leave one of them out")).into())
            }
            (Some(path), None) => Ok(Self::File(InputFile::read(&path).map_err(Failure::from)?)),
            (None, _) => {
                columns.insert(0, ("time".to_owned(), column("time", time)?));
                Ok(Self::Arrays(columns))
            }
        }
    }

    /// The samples of a column.
    fn array(&self, name: &str) -> Option<Vec<f64>> {
        let Self::Arrays(columns) = self else { return None };
        columns.iter().find(|(own, _)| own == name).map(|(_, values)| values.clone())
    }

    /// The table of the motion of links with these lengths.
    fn table(&self, lengths_m: &[f64], options: &SolveOptions) -> Fails<MotionTable> {
        if let Self::File(InputFile { shown, bytes, .. }) = self {
            let format = options.resample.format(&options.read);
            return Ok(read_motion_table_as(shown, bytes, lengths_m, &format)?);
        }
        refuse_reading(options)?;
        let time_s = self.array("time").unwrap_or_default();
        match lengths_m {
            [length_m] => self.tip(time_s, *length_m),
            _ => self.path(time_s, lengths_m),
        }
    }

    fn tip(&self, time_s: Vec<f64>, length_m: f64) -> Result<MotionTable, Failure> {
        let [acceleration_m_s2, velocity_m_s, displacement_m, angle_rad] =
            OF_LINK.map(|name| self.array(name));
        let columns = MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m };
        match (angle_rad, self) {
            (Some(_), Self::Arrays(columns)) if columns.len() > 2 => {
                let hint = "an angle stands for the displacement, and has no columns beside it";
                Err(usage(&"angle stands beside another column", Some(hint)))
            }
            (Some(angle), _) => {
                Ok(MotionTable::of_angle(MOTION, columns.time_s, &angle, length_m)?)
            }
            (None, _) => Ok(MotionTable::of_columns(MOTION, columns)?),
        }
    }

    fn path(&self, time_s: Vec<f64>, lengths_m: &[f64]) -> Fails<MotionTable> {
        let column = |name: &str| {
            let (name, recording) = (name.to_owned(), Recording::default());
            self.array(&name).map(|values| PathColumn { name, values, recording })
        };
        let tip = match OF_TIP.map(column) {
            [Some(x), Some(y)] => Some([x, y]),
            [None, None] => None,
            _ => return Err(usage(&"x and y must come together", None)),
        };
        let angles = (1..=lengths_m.len()).map(|link| column(&angle(link))).collect();
        Ok(MotionTable::of_path(MOTION, PathColumns { time_s, tip, angles }, lengths_m)?)
    }

    /// The wanted motion of an arm, and remarks on its file.
    pub(crate) fn wanted(&self, arm: &Arm, options: &SolveOptions) -> Fails<(Wanted, Vec<Notice>)> {
        let table = self.table(&arm.lengths_m(), options)?;
        let reading = self.remarks(table.reading());
        let wanted = options.resample.motion_in(table, Some(arm))?;
        Ok((options.scale.scaled(wanted)?, reading))
    }

    fn remarks(&self, reading: &Reading) -> Vec<Notice> {
        self.file().map_or_else(Vec::new, |file| of_reading(&file.shown, reading))
    }

    pub(crate) fn file(&self) -> Option<&InputFile> {
        if let Self::File(file) = self { Some(file) } else { None }
    }

    /// The arguments for `unpickled`.
    pub(crate) fn pickled<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        Ok(match self {
            Self::File(InputFile { shown, name, bytes }) => {
                (Some((shown.clone(), name.clone(), bytes.clone())), PyDict::new(py))
            }
            Self::Arrays(columns) => (None, dictionary(py, columns.iter().cloned())?),
        })
    }

    pub(crate) fn unpickled((file, columns): Pickled<'_>) -> PyResult<Self> {
        let columns = columns.iter().map(|(name, values)| {
            let name: String = name.extract()?;
            Ok((name.clone(), column(&name, &values)?))
        });
        Ok(match file {
            Some((shown, name, bytes)) => Self::File(InputFile { shown, name, bytes }),
            None => Self::Arrays(columns.collect::<PyResult<_>>()?),
        })
    }
}

/// A motion in a pickle: the shown path, the name and the bytes of its file, or its columns.
pub(crate) type Pickled<'py> = (Option<(String, String, Vec<u8>)>, Bound<'py, PyDict>);

/// Names of the columns of a motion of so many links.
fn names(links: usize) -> Vec<String> {
    match links {
        1 => OF_LINK.map(str::to_owned).to_vec(),
        _ => OF_TIP.map(str::to_owned).into_iter().chain((1..=links).map(angle)).collect(),
    }
}

/// Name of the direction of a link, counted from 1.
fn angle(link: usize) -> String {
    format!("angle{link}")
}

/// Refuses options for reading files if the samples are arrays in SI.
fn refuse_reading(options: &SolveOptions) -> Fails<()> {
    let refused = |option: &str, hint| {
        let option = option.split('=').next().unwrap_or_default();
        Err(usage(&format!("{option} is for files, and the motion is arrays"), Some(hint)))
    };
    if options.resample.format(&options.read).drop_outliers {
        let hint = "the refusal of a bad sample gives its number and what its neighbours lead to";
        return refused("drop_outliers", hint);
    }
    let arguments = options.read.arguments();
    arguments.first().map_or(Ok(()), |option| refused(option, "arrays are in SI; multiply them"))
}

/// The path in a text or a path-like object.
pub(crate) fn path_of(value: &Any<'_>) -> PyResult<Option<PathBuf>> {
    let is_path = value.is_instance_of::<PyString>() || value.hasattr("__fspath__")?;
    is_path.then(|| value.extract()).transpose()
}

/// A motion in a call, and its options.
pub(crate) struct Call<'a> {
    pub(crate) samples: Arc<Samples>,
    pub(crate) arguments: Vec<String>,
    /// The object of the motion, if the call has one.
    pub(crate) motion: Option<&'a Motion>,
}

impl<'a> Call<'a> {
    /// Takes the motion out of the keywords; `time` may be a [`Motion`], or the path of a file.
    pub(crate) fn take(time: &'a Any<'_>, keywords: &Keywords<'_>, links: usize) -> Raises<Self> {
        keywords::refuse_commands(keywords)?;
        let Ok(motion) = time.cast::<Motion>() else {
            let samples = Arc::new(Samples::take(time, keywords, links)?);
            let arguments = keywords::arguments(keywords, &[])?;
            return Ok(Self { samples, arguments, motion: None });
        };
        if links > 1 {
            let message = "a Motion is of one link, and the arm has several";
            return Err(usage(&message, Some("pass time, x and y")).into());
        }
        let motion = motion.get();
        let is_there = |name: &&str| keywords.contains(name).unwrap_or_default();
        let column = OF_LINK.into_iter().find(is_there).map(str::to_owned);
        let own = keywords::arguments(keywords, &[])?;
        let beside = match column {
            Some(name) => Some(name),
            None => of_motion(&keywords::solve_options(&own)?).into_iter().next(),
        };
        if let Some(name) = beside {
            let name = name.split('=').next().unwrap_or_default();
            let message = format!("{name} stands beside a Motion, but must be passed to it");
            return Err(usage(&message, None).into());
        }
        let arguments = motion.arguments.iter().cloned().chain(own).collect();
        Ok(Self { samples: Arc::clone(&motion.samples), arguments, motion: Some(motion) })
    }

    /// The wanted motion of a link or an arm, and remarks on its file.
    pub(crate) fn wanted(
        &self,
        link: &Link,
        options: &SolveOptions,
    ) -> Fails<(Wanted, Vec<Notice>)> {
        let Some(motion) = self.motion else {
            return self.samples.wanted(&link.specification.arm, options);
        };
        motion.refuse_other(link.first())?;
        let rows = SampleRows::of_arrays(MOTION);
        let wanted = Wanted { motion: WantedMotion::Tip(motion.tip.clone()), rows };
        Ok((wanted, motion.reading.clone()))
    }
}

/// The options that define the motion, as arguments.
fn of_motion(options: &SolveOptions) -> Vec<String> {
    [options.resample.arguments(), options.scale.arguments(), options.read.arguments()].concat()
}

/// The motion of a tip, read once and solved for many links: :func:`solve` and :func:`sweep` take it in place of time and
/// columns, with the same results.
///
/// It takes the arrays or the file of :func:`solve`, and the keywords of the motion, from ``resample`` to ``decimal``.
/// Angles are arcs of a link's length: they need ``link``, and serve links of that length. The object keeps the cut-off
/// and the last two spectra of the motion, so that a loop over links does not compute them again.
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
    samples: Arc<Samples>,
    arguments: Vec<String>,
    reading: Vec<Notice>,
    tip: TipMotion,
    pub(crate) periods: Arc<Periods>,
    /// The link of the call.
    link: Option<PickledSource>,
    /// Length in m and gravity of the link, for angles that stand for its arcs.
    arcs_of: Option<(f64, Option<Gravity>)>,
}

impl Motion {
    fn read(samples: Samples, arguments: Vec<String>, link: Option<&Link>) -> Fails<Self> {
        let pickled = link.map(|link| link.source.pickled());
        let several = || usage(&"link = an arm of several links, but must be one link", None);
        let arm = link.map(|link| &link.specification.arm);
        let link = link.map(|link| link.one().ok_or_else(several)).transpose()?;
        let options = keywords::solve_options(&arguments)?;
        let own = of_motion(&options);
        let is_other = |option: &String| option.starts_with("--") && !own.contains(option);
        if let Some(option) = options.arguments().into_iter().find(is_other) {
            let message = format!("{option} is passed to a Motion, but must be passed to solve");
            return Err(usage(&message, None));
        }
        let table = samples.table(&[link.map_or(1.0, OneLink::length_m)], &options)?;
        let (is_of_angle, reading) = (table.is_of_angle(), samples.remarks(table.reading()));
        if link.is_none() && is_of_angle {
            return Err(usage(&"link is missing: angles are arcs of its length", None));
        }
        let wanted = options.scale.scaled(options.resample.motion_in(table, arm)?)?;
        let Some(tip) = wanted.motion.into_tip() else { return Err(usage(&"no motion", None)) };
        let arcs_of = link.filter(|_| is_of_angle);
        let arcs_of = arcs_of.map(|link| (link.length_m(), link.gravity().copied()));
        let (samples, periods) = (Arc::new(samples), Arc::new(Periods::of(&tip)));
        Ok(Self { samples, arguments, reading, tip, periods, link: pickled, arcs_of })
    }

    /// Refuses a link of another length or gravity if the motion is angles of a link.
    pub(crate) fn refuse_other(&self, link: &OneLink) -> Fails<()> {
        let Some((length_m, gravity)) = &self.arcs_of else { return Ok(()) };
        let is_same = length_m.total_cmp(&link.length_m()).is_eq();
        if is_same && gravity.as_ref() == link.gravity() {
            return Ok(());
        }
        let message =
            "the motion is angles of a link of another length or gravity, but must be of this link";
        Err(Failure::new(Exit::InputRefused, &message, Some("make a Motion with link=… of it")))
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
        time: &Any<'_>,
        link: Option<&Link>,
        keywords: Option<Keywords<'_>>,
    ) -> Raises<Self> {
        let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
        keywords::refuse_commands(&keywords)?;
        let samples = Samples::take(time, &keywords, 1)?;
        let arguments = keywords::arguments(&keywords, &[])?;
        without_python(py, || Self::read(samples, arguments, link))
    }

    /// Times in s, evenly spaced.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, times(&self.tip.grid()))
    }

    /// Displacement of the tip in m along its arc, computed by each call.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> Raises<Bound<'py, PyArray1<f64>>> {
        let grid = self.tip.grid();
        let find = || Ok(self.target(grid.time_s(0), grid.end_s()).displacement_m().to_vec());
        Ok(PyArray1::from_vec(py, without_python(py, find)?))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> Reduced<'py> {
        let (py, own) = (slf.py(), slf.get());
        let arguments = (own.samples.pickled(py)?, own.arguments.clone(), own.link.clone());
        Ok((slf.get_type().getattr("_unpickled")?, arguments.into_pyobject(py)?))
    }

    #[staticmethod]
    fn _unpickled(
        py: Python<'_>,
        samples: Pickled<'_>,
        arguments: Vec<String>,
        link: Option<PickledSource>,
    ) -> Raises<Self> {
        let samples = Samples::unpickled(samples)?;
        let link = link.map(Link::unpickled).transpose()?;
        without_python(py, || Self::read(samples, arguments, link.as_ref()))
    }

    fn __repr__(&self) -> String {
        format!("Motion(samples={}, travel={:.3})", self.tip.grid().len, self.tip.travel_m())
    }
}
