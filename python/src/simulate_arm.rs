//! `simulate` of an arm: torques of its joints in arrays, played.

use std::path::{Path, PathBuf};

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::beam::MeshPlan;
use flexlink::cli::options::play_arm::{ArmTorques, Start, feedback};
use flexlink::cli::simulate::arm::{nodes_m, refusal};
use flexlink::cli::terminal::{Exit, Failure, console};
use flexlink::csv::InputFile;
use flexlink::inverse::Unwatched;
use flexlink::numeric::TimeGrid;
use flexlink::response::{
    ArmPlayWarning, HubReference, Interpolation, PlayedArm, Torque, simulate_arm,
};
use flexlink::result::{FollowedTarget, Notice, PlayedMetrics, TipPlaces};
use flexlink::spec::ArmSpecification;
use flexlink::store::{
    OutputFolder, PlayedRun, RunInputs, RunTables, Summary, read_state, state_json,
};

use crate::arm::Arm;
use crate::arrays::{Every, column, columns, frame, rows, view};
use crate::interrupt::until_pressed;
use crate::keywords::{self, solve_options};
use crate::messages::{Raised, objects, usage};
use crate::play::{HALF_A_FEEDBACK, Keywords, OF_ARM, OF_LINK, history, refuse_both};
use crate::pool;
use crate::simulate::state;

type Array<'py> = Bound<'py, PyArray1<f64>>;
type Columns<'py> = Bound<'py, PyArray2<f64>>;

/// Keywords of `write`.
const WRITING: [&str; 2] = ["every", "digits"];

/// The refusal of gains that are no numbers.
const NO_GAINS: &str =
    "feedback = something else, but must be (stiffness, damping), or a list of one for each joint";

/// The gains of all joints, or of each.
#[derive(FromPyObject)]
enum Gains {
    One([f64; 2]),
    Each(Vec<[f64; 2]>),
}

/// What a call plays.
struct Given {
    played: ArmTorques,
    until_s: Option<f64>,
}

impl Given {
    /// Takes the arrays of the call out of its keywords, all that there are.
    fn take(
        arm: &Arm,
        time: &Bound<'_, PyAny>,
        keywords: &Keywords<'_, '_>,
    ) -> Result<Self, Raised> {
        let arm = &arm.specification.arm;
        let links = arm.links().len();
        let time_s = column("time", time)?;
        let of_joints = |name: &str| {
            let given = keywords.take(name)?;
            given.map(|given| columns(name, &given, (time_s.len(), links))).transpose()
        };
        let Some(torques) = of_joints("torque")? else {
            let must = "must be given, a column for each joint";
            return Err(usage(&format!("torque = nothing, but {must}"), None).into());
        };
        let torques = torques.into_iter().map(|own| Torque::new(&time_s, own));
        let torques: Vec<Torque> = torques.collect::<Result<_, _>>().map_err(|e| history(&e))?;
        let gains = keywords.take("feedback")?.map(|given| match given.extract::<Gains>() {
            Ok(Gains::One(pair)) => Ok(vec![pair.into()]),
            Ok(Gains::Each(pairs)) => Ok(pairs.into_iter().map(Into::into).collect()),
            Err(_) => Err(usage(&NO_GAINS, None)),
        });
        let gains: Option<Vec<(f64, f64)>> = gains.transpose()?;
        let references = match (&gains, of_joints("reference")?, of_joints("reference_rate")?) {
            (None, None, None) => Vec::new(),
            (Some(_), Some(angles), rates) => joint_references(&time_s, angles, rates)?,
            _ => return Err(usage(&HALF_A_FEEDBACK, None).into()),
        };
        let feedback = feedback(gains.as_deref(), references, links)?;
        let target = keywords.take("target")?;
        let target = target.map(|own| places(&own, torques[0].grid())).transpose()?;
        let at = keywords.array("at")?;
        let of_run = |given: &Bound<'_, PyAny>| {
            given.cast::<ArmSimulation>().ok().map(|own| own.get().motion.state())
        };
        let read = |file: &InputFile| read_state(&file.shown, &file.bytes);
        let state = keywords.take("state")?.map(|given| state(&given, of_run, read)).transpose()?;
        refuse_both([("at", at.is_some()), ("state", state.is_some())])?;
        let interpolation = keywords.hold()?.unwrap_or(Interpolation::Cubic);
        let until_s = keywords.number("until")?;
        keywords.refuse_rest(OF_ARM, OF_LINK, "is for one link, and the arm has several")?;
        let start = Start::of(arm, state, at.as_deref(), (&feedback, target.as_ref()))?;
        let played = ArmTorques { torques, feedback, interpolation, start, target };
        Ok(Self { played, until_s })
    }
}

/// Angles of the joints at these times, and their rates where they are known.
fn joint_references(
    time_s: &[f64],
    angles: Vec<Vec<f64>>,
    rates: Option<Vec<Vec<f64>>>,
) -> Result<Vec<HubReference>, Failure> {
    let rates = rates
        .map_or_else(|| vec![None; angles.len()], |rates| rates.into_iter().map(Some).collect());
    let joint = |(angle, rate)| HubReference::new(time_s, angle, rate);
    let joints = angles.into_iter().zip(rates).map(joint);
    joints.collect::<Result<_, _>>().map_err(|error| history(&error))
}

/// Wanted places of the tip at the times of the torques.
fn places(given: &Bound<'_, PyAny>, grid: TimeGrid) -> Result<TipPlaces, Raised> {
    let found = columns("target", given, (grid.len, 2))?;
    let stray = found.iter().flatten().find(|own| !own.is_finite());
    match (stray, <[Vec<f64>; 2]>::try_from(found.clone())) {
        (None, Ok(at_m)) => Ok(TipPlaces { grid, at_m }),
        _ => Err(usage(&"target: not a number, but must be finite numbers", None).into()),
    }
}

/// The motion of an arm on which torques were played. Arrays have a row for each of ``time`` and a column for each joint,
/// the inner one first; units are SI.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct ArmSimulation {
    specification: Box<ArmSpecification>,
    given: Given,
    motion: PlayedArm,
    metrics: PlayedMetrics,
    of_motion: Vec<ArmPlayWarning>,
    target: Option<FollowedTarget>,
    nodes_m: Vec<Vec<f64>>,
    pub(crate) warnings: Vec<Notice>,
}

impl ArmSimulation {
    /// Plays what the call gives, until Ctrl-C.
    pub(crate) fn play(
        py: Python<'_>,
        arm: &Arm,
        time: &Bound<'_, PyAny>,
        keywords: &Keywords<'_, '_>,
    ) -> Result<Self, Raised> {
        let given = Given::take(arm, time, keywords)?;
        let specification = arm.specification.clone();
        until_pressed(py, || Self::of(specification, given))
    }

    fn of(specification: Box<ArmSpecification>, given: Given) -> Result<Self, Failure> {
        let tolerance = MeshPlan::smallest_tolerance(&specification.meshes);
        let play = given.played.play(given.until_s, tolerance);
        let simulated = simulate_arm(&specification.arm, &specification.meshes, &play, &|_| {});
        let (motion, of_motion) = simulated.map_err(|error| {
            let (message, hint) = refusal(&error);
            Failure::new(Exit::NotSolvable, &message, hint)
        })?;
        let compared = given.played.target.as_ref();
        let compared = compared.map(|own| FollowedTarget::of_arm(&motion, own));
        let target = compared.transpose()?;
        let warnings = of_motion.iter().map(Notice::from);
        let late = target.as_ref().and_then(|target| target.tip_error.late);
        let late = late.map(Notice::from);
        let metrics = PlayedMetrics::of_arm(&motion);
        let exceeded = metrics.exceeded(&specification.limits);
        let exceeded = exceeded.iter().map(Notice::from);
        let warnings = warnings.chain(late).chain(exceeded).collect();
        let nodes_m = nodes_m(&specification)?;
        Ok(Self { specification, given, motion, metrics, of_motion, target, nodes_m, warnings })
    }

    fn of_joints<'py>(
        &self,
        py: Python<'py>,
        histories: &[impl AsRef<[f64]>],
    ) -> PyResult<Columns<'py>> {
        rows(py, histories, self.motion.grid.len)
    }

    /// A history of each joint: its angle, rate or acceleration.
    fn of_angle<'py>(&self, py: Python<'py>, order: usize) -> PyResult<Columns<'py>> {
        let histories: Vec<&[f64]> = self.motion.joints.iter().map(|own| &own[order][..]).collect();
        self.of_joints(py, &histories)
    }

    /// Does something with the run as the command writes it.
    fn with_run<T>(
        &self,
        arguments: Vec<String>,
        with: impl FnOnce(&PlayedRun<'_>, &Summary) -> T,
    ) -> T {
        let tolerance = MeshPlan::smallest_tolerance(&self.specification.meshes);
        let run = PlayedRun {
            arm: &self.specification.arm,
            play: &self.given.played.play(self.given.until_s, tolerance),
            played: &self.motion,
            metrics: &self.metrics,
            limits: &self.specification.limits,
            target: self.target.as_ref(),
            warnings: &self.of_motion,
            nodes_m: &self.nodes_m,
        };
        let summary = Summary::of_played_arm(RunInputs::of_arguments(arguments), &run);
        with(&run, &summary)
    }

    fn write_into(&self, folder: &Path, keywords: &[String]) -> Result<(), Failure> {
        let options = solve_options(keywords)?;
        let folder = OutputFolder::stage(folder, &|_| {})?;
        let outputs = options.outputs();
        let written = self.with_run(options.arguments(), |run, summary| {
            let played = (run.arm, run.played);
            let tables = RunTables::of_played_arm(played, run.nodes_m, run.target, &outputs);
            outputs.write(folder, tables, (summary, None), &Unwatched)
        });
        Ok(written?)
    }
}

#[pymethods]
impl ArmSimulation {
    /// Times in s.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let grid = &self.motion.grid;
        PyArray1::from_vec(py, (0..grid.len).map(|k| grid.time_s(k)).collect())
    }

    /// Torque in N m of each joint, that of the feedback included.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_joints(py, &self.motion.torques_n_m)
    }

    /// Angle in rad of each joint: of its link's root against the tip of the link before, of the first joint against x.
    #[getter]
    fn joint_angle<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_angle(py, 0)
    }

    /// Rate in rad/s of each joint.
    #[getter]
    fn joint_rate<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_angle(py, 1)
    }

    /// Acceleration in rad/s² of each joint.
    #[getter]
    fn joint_acceleration<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_angle(py, 2)
    }

    /// Direction in rad of each link's chord, from joint to joint.
    #[getter]
    fn chord_angle<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        self.of_joints(py, &self.motion.chords_rad)
    }

    /// x and y of the tip in m.
    #[getter]
    fn tip<'py>(&self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let [x, y] = &self.motion.tip;
        self.of_joints(py, &[&x[0], &y[0]])
    }

    /// Kinetic energy, and that of strain and weight, in J.
    #[getter]
    fn energy<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.motion.energy_j)
    }

    /// Work in J that the torques have done.
    #[getter]
    fn work<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.motion.work_j)
    }

    /// What damping and friction have dissipated in J.
    #[getter]
    fn dissipated<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.motion.lost_j)
    }

    /// Torques in N m that hold the arm where it starts.
    #[getter]
    fn holding_torque<'py>(slf: &Bound<'py, Self>) -> Array<'py> {
        view(slf, |own| &own.motion.holding_n_m)
    }

    /// x and y in m of the nodes of a link, numbered from 0, of every ``every``-th sample: an array over time, node and axis.
    #[pyo3(signature = (link, every=Every::ALL))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        link: usize,
        every: Every,
    ) -> Result<Bound<'py, PyArray3<f64>>, Raised> {
        let links = self.nodes_m.len();
        if link >= links {
            let message = format!("link = {link}, but must be below {links}, the number of links");
            return Err(usage(&message, None).into());
        }
        let found = py.detach(|| self.motion.positions_m(&self.nodes_m, every.0));
        let histories: Vec<&[f64]> = found[link].iter().flatten().map(Vec::as_slice).collect();
        let samples = self.motion.grid.thinned(every.0).len();
        Ok(rows(py, &histories, samples)?.reshape([samples, found[link].len(), 2])?)
    }

    /// What summary.json of a run holds.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = self.with_run(Vec::new(), |_, summary| summary.to_json());
        py.import("json")?.call_method1("loads", (text,))
    }

    /// Numbers of each joint and of the tip, as in summary.json.
    #[getter]
    fn results<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("results")
    }

    /// How exact the motion is, as in summary.json: what the last refinement changes, and the share of energy that is
    /// missing.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("errors")
    }

    /// Distance of the tip from its ``target``, as in summary.json: ``worst_m``, ``share`` of the largest distance from the
    /// start, ``time_s``, ``rms_m``, ``final_m``; None without a target.
    #[getter]
    fn tip_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.summary(py)?.get_item("tip_error")
    }

    /// What the user must know: warnings that were given to Python's filters, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.warnings)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none. Keywords are its options ``every``, ``digits``.
    #[pyo3(signature = (folder, **keywords))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        keywords: Option<Bound<'_, PyDict>>,
    ) -> Result<(), Raised> {
        let keywords = keywords::of_writing(keywords.as_ref(), &WRITING)?;
        Ok(py.detach(|| pool::apart(|| self.write_into(&folder, &keywords)))?)
    }

    /// Writes the state at the end, as ``--save-state`` of the command: ``state`` of a later call goes on from it.
    fn save_state(&self, py: Python<'_>, path: PathBuf) -> Result<(), Raised> {
        let text = state_json(&self.motion.state());
        Ok(py.detach(|| console::deliver(Some(&path), text.as_bytes()))?)
    }

    /// The histories as a `pandas.DataFrame` over the time, a column for each joint: ``torque1``, ``torque2``.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, &["torque", "joint_angle", "joint_rate", "chord_angle", "tip"])
    }

    fn __repr__(&self) -> String {
        let joints = self.motion.joints.len();
        format!("ArmSimulation(samples={}, joints={joints})", self.motion.grid.len)
    }
}
