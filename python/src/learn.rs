//! `learn`: the next torque of a repeated motion from the measured tip.

use pyo3::sync::PyOnceLock;

use flexlink::cli::learn::{LearnOptions, Step, Trial};
use flexlink::cli::options::common::option;
use flexlink::cli::options::reading::TableName;
use flexlink::cli::problem::Problem;
use flexlink::cli::terminal::{StageBar, console, memory};
use flexlink::csv::{InputFile, Joints};
use flexlink::inverse::Resources;
use flexlink::learn::Table as Played;
use flexlink::robust::Hold;
use flexlink::store::{Fingerprint, LearnInputs};

use crate::arrays::times;
use crate::fit::take_fit;
use crate::joints::{Driven, Of};
use crate::keywords::{OF_LINK, OF_TIP, of_writing, parsed, take_arguments, take_uncertain};
use crate::link::{Link, Source};
use crate::messages::of_reading;
use crate::motion::Call;
use crate::prelude::*;
use crate::properties::Value::{Computed, Notices};
use crate::properties::{Named, Properties};
use crate::samples::table_of;
use crate::threads::{until_pressed, without_python};

/// Keywords of a step beside those of its motion. Those of reading may name a table: ``columns="measured:tip=pos"``.
const STEP: [&str; 11] = [
    "play",
    "shift",
    "digits",
    "columns",
    "time_unit",
    "sample_rate",
    "unit",
    "scale",
    "skip",
    "delimiter",
    "decimal",
];

/// The next table of the joints, with the error to expect. Arrays have a row for each of ``time``, those of an arm a column
/// for each joint; those that ``play`` does not name are None. Units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Learned {
    source: Source,
    /// The keywords of the call as options.
    arguments: Vec<String>,
    /// The files of the call.
    inputs: LearnInputs,
    kind: Joints,
    step: Step,
    /// How files were read.
    reading: Vec<Notice>,
    /// Warnings of the solution.
    of_solution: Vec<Notice>,
    summary: PyOnceLock<String>,
}

/// The table that was played for a recording.
enum Applied {
    Next(Played),
    File(InputFile, bool),
}

/// The tables of a call.
struct Tables {
    /// The recording; true if it is a file.
    measured: (InputFile, bool),
    applied: Option<Applied>,
    fit: Option<(InputFile, bool)>,
}

/// Computes what the joints play next so that the tip follows its motion more closely, as ``flexlink learn``: what was
/// played, plus the inverse of the error of the measured tip.
///
/// The motion is passed as to :func:`solve`. ``measured`` is a recording with rest before and after the motion, as a file or
/// as a dictionary of its columns ``time`` and ``tip``, of an arm ``x`` and ``y``. The keywords of reading, from ``columns``
/// to ``decimal``, name its table: ``columns="measured:tip=pos"``. ``applied`` was played for it: an earlier result of this
/// function, a file, or a dictionary with the columns of such a file; by default the answer of :func:`solve`. ``play`` is ``"effort"`` or
/// ``"position"``. ``uncertain`` and ``fit`` are those of :func:`robust`: they set the band of frequencies in which the
/// error shrinks. ``shift`` is the time of the recording at the motion's time 0. Ctrl-C ends it.
///
/// >>> import flexlink
/// >>> from typing import Any
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}], hub={"inertia": 0.1},
/// ...     damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002},
/// ... )
/// >>> rig = link.changed({"segments.*.EI*": 0.9})
/// >>> motion = flexlink.trajectory(
/// ...     "min-jerk", distance=0.5, duration=2, step=0.004, rest_before=0.5, rest_after=2
/// ... )
/// >>> first = flexlink.solve(link, **motion)
/// >>> def measured(play: flexlink.Solution | flexlink.Learned) -> dict[str, Any]:
/// ...     played = flexlink.simulate(rig, play.time, torque=play.torque, until=max(6, play.time[-1]))
/// ...     rows = played.time <= 6  # as long in every step
/// ...     return {"time": played.time[rows], "tip": played.tip_displacement[rows]}
/// >>> step = flexlink.learn(link, measured=measured(first), uncertain=["segments.*.EI*=±15%"], **motion)
/// >>> again = flexlink.learn(
/// ...     link, measured=measured(step), applied=step, uncertain=["segments.*.EI*=±15%"], **motion
/// ... )
/// >>> again.rms < step.predicted_rms < step.rms
/// True
#[pyfunction]
#[pyo3(signature = (link, time, measured, *, applied=None, **keywords))]
pub(crate) fn learn<'py>(
    py: Python<'py>,
    link: &Link,
    time: &Any<'py>,
    measured: &Any<'py>,
    applied: Option<&Any<'py>>,
    keywords: Option<Keywords<'py>>,
) -> PyResult<Learned> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let own = [take_uncertain(&keywords)?, take_arguments(&keywords, &STEP)?].concat();
    let applied = applied.map(|table| -> Raises<Applied> {
        if let Ok(step) = table.cast::<Learned>() {
            return Ok(Applied::Next(step.get().step.next.clone()));
        }
        let (file, is_file) = table_of("applied", table)?;
        Ok(Applied::File(file, is_file))
    });
    let (measured, applied) = (table_of("measured", measured)?, applied.transpose()?);
    let tables = Tables { measured, applied, fit: take_fit(&keywords)? };
    let call = Call::take(time, &keywords, link.links())?;
    let learned = until_pressed(py, || Learned::of(link, call, own, &tables))?;
    warn(py, &learned.notices())?;
    Ok(learned)
}

/// The options of a step on a link.
fn options_of(source: &Source, arguments: &[String]) -> Fails<LearnOptions> {
    let changes = source.changes.iter().flat_map(|change| option("--set", change));
    let arguments: Vec<String> = changes.chain(arguments.iter().cloned()).collect();
    parsed(&arguments, &[&OF_LINK[..], &OF_TIP, &["measured", "applied", "fit"]].concat(), &[])
}

impl Learned {
    fn of(link: &Link, call: Call<'_>, own: Vec<String>, tables: &Tables) -> Fails<Self> {
        let source = &link.source;
        let of_call = options_of(source, &own)?.motion.read;
        let given = of_call.options_of(TableName::Motion, TableName::Motion);
        if let (Some(option), Some(_)) = (given.first(), call.motion) {
            let message = format!("{option} stands beside a Motion, but must be passed to it");
            let hint = "name the table that it is for, as in columns=\"measured:tip=pos\"";
            return Err(usage(&message, Some(hint)));
        }
        let arguments = [call.arguments.clone(), own].concat();
        let options = options_of(source, &arguments)?;
        let (wanted, mut reading) = call.wanted(link, &options.motion)?;
        let of_link = (&source.file, source.overrides(&[])?);
        let fit = tables.fit.as_ref().map(|(file, _)| file);
        let (plants, specification) = options.plants(of_link, fit)?;
        let problem = Problem::of(&source.file, specification, wanted);
        let arm = &problem.specification.arm;
        let applied = match &tables.applied {
            None => None,
            Some(Applied::Next(table)) => Some((table.clone(), "applied")),
            Some(Applied::File(file, _)) => {
                let (table, of_file) = options.table(file, arm)?;
                reading.extend(of_reading(&file.shown, &of_file));
                Some((table, &*file.shown))
            }
        };
        let (file, _) = &tables.measured;
        let (recording, of_file) = options.recording(file, arm)?;
        reading.extend(of_reading(&file.shown, &of_file));
        let periods = call.motion.map(|motion| &*motion.periods);
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let solved = problem.solved_within(&resources)?;
        let trial = Trial {
            shown: &file.shown,
            recording: &recording,
            applied: applied.as_ref().map(|(table, shown)| (table, *shown)),
        };
        let stages = StageBar::hidden();
        let step = options.step((&problem, &solved.solution), &plants, &trial, &stages)?;
        Ok(Self {
            source: source.clone(),
            inputs: tables.inputs(source, &call),
            kind: Joints::from(arm),
            arguments,
            step,
            reading,
            of_solution: solved.warnings(),
            summary: PyOnceLock::new(),
        })
    }

    fn notices(&self) -> Vec<Notice> {
        [self.of_solution.clone(), self.step.warnings.clone()].concat()
    }

    fn record(&self) -> Fails<String> {
        let arguments = options_of(&self.source, &self.arguments)?.arguments();
        let inputs = LearnInputs { arguments, ..self.inputs.clone() };
        Ok(self.step.record(&inputs, self.of_solution.clone()))
    }
}

impl Tables {
    /// The files, if all inputs are files.
    fn inputs(&self, source: &Source, call: &Call<'_>) -> LearnInputs {
        let applied = match &self.applied {
            Some(Applied::File(file, true)) => Some(file),
            _ => None,
        };
        let are_files = self.measured.1
            && self.applied.is_some() == applied.is_some()
            && self.fit.as_ref().is_none_or(|(_, is_file)| *is_file);
        match call.samples.file() {
            Some(motion) if source.is_file && are_files => LearnInputs {
                link: Some(Fingerprint::of(&source.file)),
                motion: Some(Fingerprint::of(motion)),
                measured: Some(Fingerprint::of(&self.measured.0)),
                applied: applied.map(Fingerprint::of),
                fit: self.fit.as_ref().map(|(file, _)| Fingerprint::of(file)),
                arguments: Vec::new(),
            },
            _ => LearnInputs::default(),
        }
    }
}

impl Driven for Learned {
    fn joints(&self, of: Of) -> Vec<Option<&[f64]>> {
        let column = match (self.step.hold == Hold::Position, of) {
            (false, Of::Effort) | (true, Of::Position) => Some(0),
            (true, Of::Rate) => Some(1),
            _ => None,
        };
        let joints = self.step.next.joints.iter();
        joints.map(|columns| Some(columns.get(column?)?.as_slice())).collect()
    }
}

impl Properties for Learned {
    const PROPERTIES: Named<Self> = &[
        ("time", Computed(|own| times(&own.step.next.grid))),
        ("warnings", Notices(Self::notices)),
        ("remarks", Notices(|own| own.reading.clone())),
    ];

    fn kind(&self) -> Joints {
        self.kind
    }
}

#[pymethods]
impl Learned {
    /// Root mean square in m of the measured error.
    #[getter]
    fn rms(&self) -> f64 {
        self.step.summary.rms_m
    }

    /// Largest measured error in m.
    #[getter]
    fn peak(&self) -> f64 {
        self.step.summary.peak_m
    }

    /// Largest root mean square in m of the next error, without noise.
    #[getter]
    fn predicted_rms(&self) -> f64 {
        self.step.summary.predicted_rms_m
    }

    /// Largest factor on the error where the whole error is corrected.
    #[getter]
    fn contraction(&self) -> f64 {
        self.step.summary.contraction
    }

    /// Factor on the error in the band, weighted by the error's spectrum.
    #[getter]
    fn weighted_contraction(&self) -> f64 {
        self.step.summary.weighted_contraction
    }

    /// Frequency in Hz up to which the error is corrected.
    #[getter]
    fn band_end(&self) -> f64 {
        self.step.summary.band_end_hz
    }

    /// The numbers that ``flexlink learn --json`` prints.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        let text = self.summary.get_or_try_init(py, || without_python(py, || self.record()))?;
        loaded(py, text)
    }

    /// Writes the table that ``flexlink learn`` writes. ``digits`` is that of the command.
    #[pyo3(signature = (path, **keywords))]
    fn write(&self, py: Python<'_>, path: PathBuf, keywords: Option<Keywords<'_>>) -> Raises<()> {
        let more = of_writing(keywords.as_ref(), &["digits"])?;
        let digits = options_of(&self.source, &[self.arguments.clone(), more].concat())?.digits;
        Ok(py.detach(|| console::deliver_by(Some(&path), |out| self.step.write(out, digits)))?)
    }

    fn __repr__(&self) -> String {
        let summary = &self.step.summary;
        format!("Learned(rms={:.3e}, predicted_rms={:.3e})", summary.rms_m, summary.predicted_rms_m)
    }
}
