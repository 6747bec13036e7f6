//! A call's motion of a tip with its options, and motions that are read once.

use flexlink::cli::options::inputs::{MotionArgs, Wanted};
use flexlink::cli::options::reading::TableName;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::csv::{Reading, SampleRows};
use flexlink::link::{Gravity, Link as OneLink};
use flexlink::motion::{Motion as WantedMotion, Periods, TipMotion, TipTarget};

use crate::arrays::times;
use crate::keywords::{self, OF_LINK};
use crate::link::{Link, PickledSource};
use crate::prelude::*;
use crate::samples::{MOTION, Pickled, Samples};
use crate::threads::without_python;

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
            None => of_motion(&keywords::solve_options(&own)?),
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
    pub(crate) fn wanted(&self, link: &Link, options: &MotionArgs) -> Fails<(Wanted, Vec<Notice>)> {
        let Some(motion) = self.motion else {
            return self.samples.wanted(&link.specification.arm, options);
        };
        motion.refuse_other(link.first())?;
        let rows = SampleRows::of_arrays(MOTION);
        let reading = Reading::default();
        let wanted = Wanted { motion: WantedMotion::Tip(motion.tip.clone()), rows, reading };
        Ok((wanted, motion.reading.clone()))
    }
}

/// The first option that defines the motion.
fn of_motion(SolveOptions { motion, .. }: &SolveOptions) -> Option<String> {
    let read = motion.read.options_of(TableName::Motion, TableName::Motion);
    let others = [motion.samples.arguments(), motion.scale.arguments()].concat();
    read.into_iter().map(str::to_owned).chain(others).next()
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
        let own = options.motion.arguments();
        let is_other = |option: &String| option.starts_with("--") && !own.contains(option);
        if let Some(option) = options.arguments().into_iter().find(is_other) {
            let message = format!("{option} is passed to a Motion, but must be passed to solve");
            return Err(usage(&message, None));
        }
        let table = samples.table(&[link.map_or(1.0, OneLink::length_m)], &options.motion)?;
        let is_of_angle = table.is_of_angle();
        if link.is_none() && is_of_angle {
            return Err(usage(&"link is missing: angles are arcs of its length", None));
        }
        let wanted = options.motion.scale.scaled(&options.motion.motion_in(table, arm)?)?;
        let reading = samples.remarks(&wanted.reading);
        let Some(tip) = wanted.motion.into_tip() else { return Err(usage(&"no motion", None)) };
        let arcs_of = link.filter(|_| is_of_angle);
        let arcs_of = arcs_of.map(|link| (link.output_m(), link.gravity().copied()));
        let (samples, periods) = (Arc::new(samples), Arc::new(Periods::of(&tip)));
        Ok(Self { samples, arguments, reading, tip, periods, link: pickled, arcs_of })
    }

    /// Refuses a link of another length or gravity if the motion is angles of a link.
    pub(crate) fn refuse_other(&self, link: &OneLink) -> Fails<()> {
        let Some((length_m, gravity)) = &self.arcs_of else { return Ok(()) };
        let is_same = length_m.total_cmp(&link.output_m()).is_eq();
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
