//! `robust`: the tip of links that differ from their file.

use pyo3::sync::PyOnceLock;

use flexlink::cli::options::common::option;
use flexlink::cli::problem::Problem;
use flexlink::cli::robust::{RobustOptions, Studied};
use flexlink::cli::terminal::memory;
use flexlink::csv::InputFile;
use flexlink::inverse::Resources;
use flexlink::robust::{Key, Measure, Quantiles};
use flexlink::store::{Fingerprint, OutputFolder, RobustInputs, plant_columns};

use crate::arrays::{dictionary, gains};
use crate::fit::take_fit;
use crate::keywords::{OF_LINK, OF_TIP, of_writing, parsed, take, take_arguments, take_uncertain};
use crate::link::{Link, Source};
use crate::motion::Call;
use crate::prelude::*;
use crate::samples::Samples;
use crate::threads::{apart, until_pressed, without_python};

/// Keywords of a study beside those of its motion.
const STUDY: [&str; 8] =
    ["play", "command", "runs", "seed", "distribution", "band", "allow", "digits"];

/// The tip of links whose values differ within intervals. Lengths are in m, times in s; names are those of the files.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Robustness {
    source: Source,
    samples: Arc<Samples>,
    /// The record of a fit; true if it is a file.
    fit: Option<(InputFile, bool)>,
    /// The keywords of the call as options.
    arguments: Vec<String>,
    studied: Studied,
    /// How the file of the motion was read.
    reading: Vec<Notice>,
    /// Warnings of the solution.
    of_solution: Vec<Notice>,
    summary: PyOnceLock<String>,
}

/// Plays the torque of :func:`solve`, or its motion of the joints, on links whose values differ within intervals, as
/// ``flexlink robust``: each value alone, all corners, and a seeded sample.
///
/// The motion is passed as to :func:`solve`. ``uncertain`` has the intervals: a list of texts as those of ``--uncertain``,
/// or a dictionary of intervals by key, each a text such as ``"±5%"`` or its two ends. Without it those of the link
/// file count. ``fit`` is a :class:`Fit`, or the path of its record: its values vary with their covariance, and ``link`` is
/// the fitted link. ``play`` is what the drives hold, ``"effort"``, ``"position"`` or ``"feedback"``; ``feedback`` a pair of
/// gains, or one for each joint; ``command`` ``"inverse"``, or for comparison ``"rigid"``, ``"zv"``, ``"zvd"``, ``"ei"``,
/// ``"2hump"``. ``runs``, ``seed`` and ``distribution`` describe the sample; ``band`` is that of the settling time, and
/// beyond ``allow`` there is a warning: both a share of the travel such as ``"1%"``, or a length. Ctrl-C ends it.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"ratio": 0.02},
/// ... )
/// >>> motion = flexlink.trajectory("min-jerk", distance=0.5, duration=1, step=0.004)
/// >>> found = flexlink.robust(
/// ...     link, **motion, uncertain={"segments.*.EI*": "±5%", "hub.inertia": (0.099, 0.101)}, runs=50
/// ... )
/// >>> found.worst["tip_error"]["size_m"] > found.quantiles["tip_error"]["p95_m"][0]
/// True
/// >>> max(found.shares, key=lambda key: found.shares[key])  # the value to measure better
/// 'segments.*.EI*'
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn robust<'py>(
    py: Python<'py>,
    link: &Link,
    time: &Any<'py>,
    keywords: Option<Keywords<'py>>,
) -> PyResult<Robustness> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let gains = take(&keywords, "feedback")?.map(|value| gains(&value)).transpose()?;
    let gains = gains.map(|pairs| {
        let pairs = pairs.iter().map(|(kp, kd)| format!("{kp},{kd}"));
        option("--feedback", pairs.collect::<Vec<_>>().join(","))
    });
    let study = [
        take_uncertain(&keywords)?,
        gains.into_iter().flatten().collect(),
        take_arguments(&keywords, &STUDY)?,
    ];
    let fit = take_fit(&keywords)?;
    let call = Call::take(time, &keywords, link.links())?;
    let found = until_pressed(py, || Robustness::of(link, call, study.concat(), fit))?;
    warn(py, &found.notices())?;
    Ok(found)
}

/// The options of a study of a link.
fn options_of(source: &Source, arguments: &[String]) -> Fails<RobustOptions> {
    let changes = source.changes.iter().flat_map(|change| option("--set", change));
    let arguments: Vec<String> = changes.chain(arguments.iter().cloned()).collect();
    parsed(&arguments, &[&OF_LINK[..], &OF_TIP, &["fit"]].concat(), &[])
}

impl Robustness {
    fn of(
        link: &Link,
        call: Call<'_>,
        study: Vec<String>,
        fit: Option<(InputFile, bool)>,
    ) -> Fails<Self> {
        let source = &link.source;
        let arguments = [call.arguments.clone(), study].concat();
        let options = options_of(source, &arguments)?;
        let (wanted, reading) = call.wanted(link, &options.motion)?;
        let of_link = (&source.file, source.overrides(&[])?);
        let (plants, specification) =
            options.plants(of_link, fit.as_ref().map(|(file, _)| file))?;
        let problem = Problem::of(&source.file, specification, wanted);
        let periods = call.motion.map(|motion| &*motion.periods);
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let solved = problem.solved_within(&resources)?;
        let studied = options.study((&problem, &solved.solution), &plants)?;
        Ok(Self {
            source: source.clone(),
            samples: call.samples,
            fit,
            arguments,
            studied,
            reading,
            of_solution: solved.warnings(),
            summary: PyOnceLock::new(),
        })
    }

    fn notices(&self) -> Vec<Notice> {
        [self.of_solution.clone(), self.studied.warnings.clone()].concat()
    }

    /// The record. Inputs without files have only the arguments.
    fn record(&self, options: &RobustOptions) -> String {
        let arguments = options.arguments();
        let fit = self.fit.as_ref();
        let inputs = match self.samples.file() {
            Some(motion) if self.source.is_file && fit.is_none_or(|(_, is_file)| *is_file) => {
                RobustInputs {
                    link: Some(Fingerprint::of(&self.source.file)),
                    motion: Some(Fingerprint::of(motion)),
                    fit: fit.map(|(file, _)| Fingerprint::of(file)),
                    arguments,
                }
            }
            _ => RobustInputs { arguments, ..RobustInputs::default() },
        };
        self.studied.record(&inputs, self.of_solution.clone())
    }

    fn write_into(&self, folder: &Path, more: Vec<String>) -> Fails<()> {
        let options = options_of(&self.source, &[self.arguments.clone(), more].concat())?;
        let files = self.studied.files(&self.record(&options), options.digits);
        Ok(files.write(OutputFolder::stage(folder, &|_| {})?, None)?)
    }

    /// Values of the keys of a plant by their headings; None where the file's value counts.
    fn values<'py>(&self, py: Python<'py>, values: &[Option<f64>]) -> PyResult<Bound<'py, PyDict>> {
        let headings = self.studied.summary.keys().map(Key::heading);
        headings.zip(values.iter().copied()).into_py_dict(py)
    }
}

/// Name of a measure in the files.
fn name(measure: Measure) -> String {
    measure.word().replace(' ', "_")
}

#[pymethods]
impl Robustness {
    /// Measures of the link of the file: ``tip_error_m``, ``rest_vibration_m``, ``drift_m``, ``settling_s`` and the
    /// ``period_s`` of the mode that rings.
    #[getter]
    fn nominal<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        self.summary(py)?.get_item("nominal")
    }

    /// The largest ``tip_error``, ``rest_vibration`` and ``drift`` of all links: its ``size_m``, the ``kind`` of the link, and its
    /// ``values``.
    #[getter]
    fn worst<'py>(&self, py: Python<'py>) -> Dictionary<'py> {
        let all = PyDict::new(py);
        for own in &self.studied.summary.worst {
            let worst = PyDict::new(py);
            worst.set_item("size_m", own.size_m)?;
            worst.set_item("kind", own.kind.word())?;
            worst.set_item("values", self.values(py, &own.values)?)?;
            all.set_item(name(own.measure), worst)?;
        }
        Ok(all)
    }

    /// Quantiles of ``tip_error``, ``rest_vibration`` and ``drift`` over the sample: ``median_m``, ``p95_m`` and ``p99_m``, each
    /// with its standard error, None where few plants lie beyond. None without a sample.
    #[getter]
    fn quantiles<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(quantiles) = self.studied.summary.quantiles else { return Ok(None) };
        let of_measure = |(measure, own): (Measure, Quantiles)| {
            let three = [("median_m", own.median_m), ("p95_m", own.p95_m), ("p99_m", own.p99_m)];
            Ok((name(measure), three.into_py_dict(py)?))
        };
        let all = Measure::ALL.into_iter().zip(quantiles).map(of_measure);
        Ok(Some(all.collect::<PyResult<Vec<_>>>()?.into_py_dict(py)?))
    }

    /// Each value alone, as in summary.json: its interval, its worst tip error, rest vibration and drift, its share, and the
    /// worst values inside the interval.
    #[getter]
    fn keys<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        self.summary(py)?.get_item("keys")
    }

    /// Share of each value in the tip error, by the heading of its column.
    #[getter]
    fn shares<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.studied.summary.keys.iter().map(|own| (own.key.heading(), own.share)).into_py_dict(py)
    }

    /// All links, the columns of robust.csv: ``kind``, the values of the keys, ``tip_error`` and ``rest_vibration`` over the
    /// travel, ``drift_m`` and ``settling_s``, not a number where the tip does not settle.
    #[getter]
    fn plants<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Studied { outcome, summary, .. } = &self.studied;
        let columns = plant_columns(&outcome.plants, summary).into_iter();
        let all = PyDict::new(py);
        let kinds: Vec<&str> = outcome.plants.iter().map(|own| own.kind.word()).collect();
        all.set_item("kind", kinds)?;
        let numbers = columns.map(|(name, own)| {
            (name, own.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
        });
        all.update(dictionary(py, numbers)?.as_mapping())?;
        Ok(all)
    }

    /// Smallest and largest error of the sample over time, the columns of envelope.csv: ``time_s``, ``lowest_error_m``,
    /// ``highest_error_m``.
    #[getter]
    fn envelope<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let [low, high] = &self.studied.outcome.envelope_m;
        let columns = [
            ("time_s", self.studied.times_s.clone()),
            ("lowest_error_m", low.clone()),
            ("highest_error_m", high.clone()),
        ];
        dictionary(py, columns)
    }

    /// Other commands on the worst corners: ``what``, ``tip_error_m``, ``rest_vibration_m``, ``drift_m``.
    #[getter]
    fn helps<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        self.summary(py)?.get_item("help")
    }

    /// Content of summary.json.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        let write = || Ok(self.record(&options_of(&self.source, &self.arguments)?));
        let text = self.summary.get_or_try_init(py, || without_python(py, write))?;
        loaded(py, text)
    }

    /// Warnings, which Python's filters received, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Any<'py>>> {
        objects(py, &self.notices())
    }

    /// Remarks on the file of the motion.
    #[getter]
    fn remarks<'py>(&self, py: Python<'py>) -> PyResult<Vec<Any<'py>>> {
        objects(py, &self.reading)
    }

    /// Writes the files of ``flexlink robust`` into a folder, all or none: the same bytes, also of summary.json if link,
    /// motion and fit are files. ``digits`` is that of the command.
    #[pyo3(signature = (folder, **keywords))]
    fn write(&self, py: Python<'_>, folder: PathBuf, keywords: Option<Keywords<'_>>) -> Raises<()> {
        let more = of_writing(keywords.as_ref(), &["digits"])?;
        apart(py, || self.write_into(&folder, more))
    }

    fn __repr__(&self) -> String {
        let summary = &self.studied.summary;
        format!("Robustness(plants={}, worst={:.4})", summary.plants, summary.worst_m())
    }
}
