//! A simulation: the keywords of `simulate`, the play, its files.

use std::path::Path;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::options::moves::{AtRest, Begins, Moves, Moving};
use flexlink::cli::simulate::refusal;
use flexlink::cli::terminal::{Exit, Failure, console, memory};
use flexlink::csv::InputFile;
use flexlink::elastica::SecondOrder;
use flexlink::inverse::Unwatched;
use flexlink::motion::TipTarget;
use flexlink::response::{
    Feedback, HistoryError, HubReference, Interpolation, PlayError, Played, State, Torque, simulate,
};
use flexlink::result::{FollowedTarget, Notice, PlayedMetrics, TipPlaces};
use flexlink::spec::Specification;
use flexlink::store::{
    OutputFolder, PlayedRun, RunInputs, RunTables, Summary, read_state, state_json,
};

use crate::arrays::column;
use crate::keywords::{self, solve_options};
use crate::link::described_by;
use crate::messages::{Raised, usage};
use crate::motion::{Motion, path_of};
use crate::pool;
use crate::simulate::PlayedLink;
use crate::simulate_arm::ArmSimulation;

/// Keywords of `write`.
const WRITING: [&str; 4] = ["nodes", "stations", "every", "digits"];

/// Keywords of `simulate` for a link, and for an arm, with blanks between.
pub(crate) const OF_LINK: &str = "torque hub_angle hub_rate hold until feedback reference reference_rate initial_tip periodic target state";
pub(crate) const OF_ARM: &str =
    "torque hold until feedback reference reference_rate at target state";

/// The remaining keywords of a call; reading removes a keyword.
pub(crate) struct Keywords<'a, 'py>(pub(crate) &'a Bound<'py, PyDict>);

impl<'py> Keywords<'_, 'py> {
    /// Removes a keyword and returns its value, unless it is None.
    pub(crate) fn take(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(given) = self.0.get_item(name)? else { return Ok(None) };
        self.0.del_item(name)?;
        Ok((!given.is_none()).then_some(given))
    }

    pub(crate) fn array(&self, name: &str) -> PyResult<Option<Vec<f64>>> {
        self.take(name)?.map(|given| column(name, &given)).transpose()
    }

    pub(crate) fn number(&self, name: &str) -> PyResult<Option<f64>> {
        self.take(name)?.map(|given| given.extract::<f64>()).transpose()
    }

    /// The torque between its samples, if the call says so.
    pub(crate) fn hold(&self) -> Result<Option<Interpolation>, Raised> {
        let Some(given) = self.take("hold")? else { return Ok(None) };
        let hold: String = given.extract()?;
        Ok(Some(match &*hold {
            "zero" => Interpolation::Zero,
            "linear" => Interpolation::Linear,
            "cubic" => Interpolation::Cubic,
            _ => {
                let must = "must be \"zero\", \"linear\" or \"cubic\"";
                return Err(usage(&format!("hold = {hold:?}, but {must}"), None).into());
            }
        }))
    }

    /// Refuses a remaining keyword: one outside the `known` ones, or one of the `others`, for links or arms alone.
    pub(crate) fn refuse_rest(&self, known: &str, others: &str, why: &str) -> Result<(), Raised> {
        let Some(key) = self.0.keys().iter().next() else { return Ok(()) };
        let key = key.extract::<String>()?;
        if others.split(' ').any(|own| own == key) {
            return Err(usage(&format!("{key} {why}"), None).into());
        }
        Err(keywords::unknown(&key, known.split(' ')).into())
    }
}

/// The refusal of samples.
pub(crate) fn history(error: &HistoryError) -> Failure {
    Failure::new(Exit::InputRefused, error, error.hint())
}

/// Refuses two keywords in one call.
pub(crate) fn refuse_both(given: [(&str, bool); 2]) -> Result<(), Failure> {
    match given {
        [(one, true), (other, true)] => {
            Err(usage(&format!("{one} must not be given with {other}"), None))
        }
        _ => Ok(()),
    }
}

/// A simulation, and its inputs.
pub(crate) struct Run {
    pub(crate) specification: Specification,
    moves: Moves,
    pub(crate) played: Played,
    metrics: PlayedMetrics,
    pub(crate) error: Option<PlayError>,
    target: Option<FollowedTarget>,
    pub(crate) warnings: Vec<Notice>,
}

impl Run {
    /// Plays the input of a call.
    pub(crate) fn of(specification: Specification, moves: Moves) -> Result<Self, Failure> {
        let Specification { arm, meshes, .. } = &specification;
        let play = moves.play();
        let played = simulate(arm, meshes, &play, &|_| {}).map_err(|error| {
            let (message, hint) = refusal(&error, arm.links().len() > 1);
            let hint = hint.map(str::to_owned);
            Failure { message, hint, ..Failure::from(error) }
        })?;
        let error = PlayError::of(&played, arm, &play)?;
        let compared = moves.target.as_ref().map(|target| FollowedTarget::of(&played, target));
        let target = compared.transpose()?;
        let metrics = PlayedMetrics::of(&played);
        let warnings = Vec::new();
        let run = Self { specification, moves, played, metrics, error, target, warnings };
        let warnings = run.with(|run| run.notices(|limit| Notice::from(limit)));
        Ok(Self { warnings, ..run })
    }

    /// Does something with the run in the form of the command.
    fn with<T>(&self, with: impl FnOnce(&PlayedRun<'_>) -> T) -> T {
        with(&PlayedRun {
            arm: &self.specification.arm,
            play: &self.moves.play(),
            played: &self.played,
            metrics: &self.metrics,
            error: self.error.as_ref(),
            limits: &self.specification.limits,
            target: self.target.as_ref(),
            comparison: None,
        })
    }

    fn summary(&self, arguments: Vec<String>) -> Summary {
        self.with(|run| Summary::of_played(RunInputs::of_arguments(arguments), run))
    }

    /// The content of a run's summary.json.
    pub(crate) fn summary_of<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Raised> {
        let text = py.detach(|| pool::install(|| Ok(self.summary(Vec::new()).to_json())));
        Ok(py.import("json")?.call_method1("loads", (text?,))?)
    }

    /// Writes the files of ``flexlink simulate`` into a folder, all or none.
    pub(crate) fn write(
        &self,
        py: Python<'_>,
        folder: &Path,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> Result<(), Raised> {
        let keywords = keywords::of_writing(keywords, &WRITING)?;
        Ok(py.detach(|| pool::apart(|| self.write_into(folder, &keywords)))?)
    }

    fn write_into(&self, folder: &Path, keywords: &[String]) -> Result<(), Failure> {
        let options = solve_options(keywords)?;
        let (arm, outputs) = (&self.specification.arm, options.outputs());
        options.nodes.check(&self.played.nodes_m())?;
        memory::check_nodes(outputs.simulation_bytes(&self.played), memory::available())?;
        let summary = self.summary(options.arguments());
        let folder = OutputFolder::stage(folder, &|_| {})?;
        let tables = RunTables::of_played((arm, &self.played), self.target.as_ref(), &outputs)?;
        Ok(outputs.write(folder, tables, (&summary, None), &Unwatched)?)
    }

    /// Writes the state at the end, as ``--save-state`` of the command.
    pub(crate) fn save_state(&self, py: Python<'_>, path: &Path) -> Result<(), Raised> {
        let text = state_json(&self.played.state());
        Ok(py.detach(|| console::deliver(Some(path), text.as_bytes()))?)
    }
}

/// Takes all arrays of a call on one link out of its keywords.
pub(crate) fn link_moves(
    specification: &Specification,
    time: &Bound<'_, PyAny>,
    keywords: &Keywords<'_, '_>,
) -> Result<Moves, Raised> {
    let link = specification.link();
    let is_large = specification.analysis.second_order_of(link) != SecondOrder::None;
    let state = keywords.take("state")?.map(|given| state(&given, 1)).transpose()?;
    let time_s = column("time", time)?;
    let hub = |angle: Vec<f64>, rate: Option<Vec<f64>>| {
        HubReference::new(&time_s, angle, rate).map_err(|error| history(&error))
    };
    let [torque, angle, rate] = ["torque", "hub_angle", "hub_rate"].map(|own| keywords.array(own));
    let moving = match (torque?, angle?, rate?) {
        (Some(torque), None, None) => {
            let torque = Torque::new(&time_s, torque).map_err(|error| history(&error))?;
            Moving::Torques(vec![torque])
        }
        (None, Some(angle), rate) => Moving::Angles(vec![hub(angle, rate)?]),
        _ => {
            let must = "must be torque alone, or hub_angle with or without hub_rate";
            return Err(usage(&format!("what is played, but {must}"), None).into());
        }
    };
    let gains = keywords.take("feedback")?.map(|given| given.extract::<(f64, f64)>());
    let [reference, rate] = ["reference", "reference_rate"].map(|own| keywords.array(own));
    let feedback = match (gains.transpose()?, reference?, rate?) {
        (None, None, None) => Vec::new(),
        (Some((kp, kd)), Some(angle), rate) => {
            let feedback = Feedback::new(kp, kd, hub(angle, rate)?);
            vec![feedback.map_err(|error| usage(&format!("feedback: {error}"), None))?]
        }
        _ => return Err(usage(&HALF_A_FEEDBACK, None).into()),
    };
    let hold = keywords.hold()?;
    if let Moving::Angles(_) = moving {
        let hint = "a hub that moves as prescribed needs neither";
        for (name, is_given) in [("hold", hold.is_some()), ("feedback", !feedback.is_empty())] {
            if is_given {
                let message = format!("{name} is given with hub_angle, but must be with torque");
                return Err(usage(&message, Some(hint)).into());
            }
        }
    }
    let is_periodic = keywords.take("periodic")?.map(|given| given.is_truthy()).transpose()?;
    let is_periodic = is_periodic.unwrap_or_default();
    let tip_m = keywords.number("initial_tip")?;
    refuse_both([("periodic", is_periodic), ("state", state.is_some())])?;
    refuse_both([("initial_tip", tip_m.is_some()), ("state", state.is_some())])?;
    let until_s = keywords.number("until")?;
    let target = keywords.take("target")?;
    keywords.refuse_rest(OF_LINK, OF_ARM, "is for an arm, and this is one link")?;
    let target = target.as_ref().map(described_by::<Motion>).transpose()?.map(Bound::get);
    target.map_or(Ok(()), |target| target.refuse_other(link))?;
    let grid = match &moving {
        Moving::Torques(torques) => torques[0].grid(),
        Moving::Angles(hubs) => hubs[0].grid(),
    };
    let target = target.map(|own| own.target(grid.time_s(0), until_s.unwrap_or(grid.end_s())));
    let start_angle_rad = target.as_ref().and_then(TipTarget::start_angle_rad);
    let target = target.as_ref().map(TipPlaces::from);
    let begins = Begins { state: state.is_some(), moved: false, at: None, tip_m };
    let start = AtRest::of(&link.clone().into(), &begins, (&feedback, target.as_ref()))?;
    Ok(Moves {
        moving,
        interpolation: hold.unwrap_or(Interpolation::Cubic),
        until_s,
        feedback,
        start,
        state,
        target,
        start_angle_rad,
        is_large,
        is_periodic,
    })
}

/// The state at the end of an earlier simulation of this many links, from its object or from the file of
/// `save_state`.
pub(crate) fn state(given: &Bound<'_, PyAny>, links: usize) -> Result<State, Raised> {
    let of_link = given.cast::<PlayedLink>().ok().filter(|_| links == 1);
    let of_arm = given.cast::<ArmSimulation>().ok().filter(|_| links > 1);
    let run = of_link.map(|own| &own.get().0).or(of_arm.map(|own| &own.get().0));
    if let Some(run) = run {
        return Ok(run.played.state());
    }
    let Some(path) = path_of(given)? else {
        let found = given.get_type();
        let must = "must be an earlier simulation of the same kind, or the path of its state";
        return Err(PyTypeError::new_err(format!("state = {found}, but {must}")).into());
    };
    let file = InputFile::read(&path).map_err(Failure::from)?;
    Ok(read_state(&file.shown, &file.bytes, links).map_err(Failure::from)?)
}

/// Error of incomplete feedback.
pub(crate) const HALF_A_FEEDBACK: &str =
    "one of feedback and reference, but must be both or none, and reference_rate with them alone";
