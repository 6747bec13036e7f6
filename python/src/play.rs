//! What is played on a link, and the keywords of `simulate` out of which it is taken.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::options::play::initial_tip_m;
use flexlink::cli::terminal::{Exit, Failure, memory};
use flexlink::link::Link as LibraryLink;
use flexlink::motion::TipTarget;
use flexlink::response::{
    Feedback, HistoryError, HubReference, Input, Interpolation, Play, State, Torque,
};

use crate::arrays::column;
use crate::keywords;
use crate::link::described_by;
use crate::messages::{Raised, usage};
use crate::motion::Motion;

/// Keywords of `simulate` for a link, and for an arm, with blanks between.
pub(crate) const OF_LINK: &str = "torque hub_angle hub_rate hold until feedback reference reference_rate initial_tip periodic target state";
pub(crate) const OF_ARM: &str =
    "torque hold until feedback reference reference_rate at target state";

/// The keywords of a call, from which each is taken out.
pub(crate) struct Keywords<'a, 'py>(pub(crate) &'a Bound<'py, PyDict>);

impl<'py> Keywords<'_, 'py> {
    /// The value of a keyword, unless it is None.
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

    /// The torque between its samples, if it is said.
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

    /// Refuses what is left: it is none of the `known`, or one of the `others` that belong to links or arms alone.
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

/// Refuses keywords of which the call has given both.
pub(crate) fn refuse_both(given: [(&str, bool); 2]) -> Result<(), Failure> {
    match given {
        [(one, true), (other, true)] => {
            Err(usage(&format!("{one} must not be given with {other}"), None))
        }
        _ => Ok(()),
    }
}

/// What moves the link.
enum Moving {
    Torque(Torque),
    HubAngle(HubReference),
}

/// What is played on a link, and how.
pub(crate) struct Playing {
    moving: Moving,
    interpolation: Interpolation,
    until_s: Option<f64>,
    feedback: Option<Feedback>,
    initial_tip_m: f64,
    pub(crate) target: Option<TipTarget>,
    state: Option<State>,
    pub(crate) is_large: bool,
    is_periodic: bool,
}

impl Playing {
    /// Takes the arrays of the call out of its keywords, all that there are; `state` is already taken.
    pub(crate) fn take(
        link: &LibraryLink,
        time: &Bound<'_, PyAny>,
        keywords: &Keywords<'_, '_>,
        (state, is_large): (Option<State>, bool),
    ) -> Result<Self, Raised> {
        let time_s = column("time", time)?;
        let hub = |angle: Vec<f64>, rate: Option<Vec<f64>>| {
            HubReference::new(&time_s, angle, rate).map_err(|error| history(&error))
        };
        let [torque, angle, rate] =
            ["torque", "hub_angle", "hub_rate"].map(|own| keywords.array(own));
        let moving = match (torque?, angle?, rate?) {
            (Some(torque), None, None) => {
                Moving::Torque(Torque::new(&time_s, torque).map_err(|error| history(&error))?)
            }
            (None, Some(angle), rate) => Moving::HubAngle(hub(angle, rate)?),
            _ => {
                let must = "must be torque alone, or hub_angle with or without hub_rate";
                return Err(usage(&format!("what is played, but {must}"), None).into());
            }
        };
        let gains = keywords.take("feedback")?.map(|given| given.extract::<(f64, f64)>());
        let [reference, rate] = ["reference", "reference_rate"].map(|own| keywords.array(own));
        let feedback = match (gains.transpose()?, reference?, rate?) {
            (None, None, None) => None,
            (Some((kp, kd)), Some(angle), rate) => {
                let feedback = Feedback::new(kp, kd, hub(angle, rate)?);
                Some(feedback.map_err(|error| usage(&format!("feedback: {error}"), None))?)
            }
            _ => return Err(usage(&HALF_A_FEEDBACK, None).into()),
        };
        let hold = keywords.hold()?;
        if let Moving::HubAngle(_) = moving {
            let hint = "a hub that moves as prescribed needs neither";
            for (name, is_given) in [("hold", hold.is_some()), ("feedback", feedback.is_some())] {
                if is_given {
                    let message =
                        format!("{name} is given with hub_angle, but must be with torque");
                    return Err(usage(&message, Some(hint)).into());
                }
            }
        }
        let is_periodic = keywords.take("periodic")?.map(|given| given.is_truthy()).transpose()?;
        let is_periodic = is_periodic.unwrap_or_default();
        let initial_tip_m = keywords.number("initial_tip")?;
        refuse_both([("periodic", is_periodic), ("state", state.is_some())])?;
        refuse_both([("initial_tip", initial_tip_m.is_some()), ("state", state.is_some())])?;
        let playing = Self {
            moving,
            interpolation: hold.unwrap_or(Interpolation::Cubic),
            until_s: keywords.number("until")?,
            feedback,
            initial_tip_m: 0.0,
            target: None,
            state,
            is_large,
            is_periodic,
        };
        let target = keywords.take("target")?;
        keywords.refuse_rest(OF_LINK, OF_ARM, "is for an arm, and this is one link")?;
        playing.compared(link, target.as_ref(), initial_tip_m)
    }

    /// The same with a target, at which the link starts unless the call says where.
    fn compared(
        self,
        link: &LibraryLink,
        target: Option<&Bound<'_, PyAny>>,
        given_m: Option<f64>,
    ) -> Result<Self, Raised> {
        let target = target.map(described_by::<Motion>).transpose()?.map(Bound::get);
        target.map_or(Ok(()), |target| target.refuse_other(link))?;
        let grid = self.input().grid();
        let until_s = self.until_s.unwrap_or(grid.end_s());
        let target = target.map(|motion| motion.target(grid.time_s(0), until_s));
        let reference = self.feedback.as_ref().map(Feedback::reference);
        let start_m = given_m.unwrap_or_else(|| initial_tip_m(link, target.as_ref(), reference));
        Ok(Self { initial_tip_m: start_m, target, ..self })
    }

    fn input(&self) -> Input<'_> {
        match &self.moving {
            Moving::Torque(torque) => Input::Torque(torque),
            Moving::HubAngle(hub) => Input::HubAngle(hub),
        }
    }

    /// What to play: as long as the call says, or else as input and target last.
    pub(crate) fn play(&self) -> Play<'_> {
        let input = self.input();
        let both_s = self.target.as_ref().map(|own| own.grid().end_s().max(input.grid().end_s()));
        Play {
            input,
            interpolation: self.interpolation,
            until_s: self.until_s.or(both_s),
            feedback: self.feedback.as_ref(),
            initial_tip_m: self.initial_tip_m,
            memory_bytes: memory::available(),
            is_large: self.is_large,
            cycle_turn_rad: self.is_periodic.then_some(0.0),
            state: self.state.as_ref(),
            start_angle_rad: self.target.as_ref().and_then(TipTarget::start_angle_rad),
        }
    }
}

/// Feedback that is not whole.
pub(crate) const HALF_A_FEEDBACK: &str =
    "one of feedback and reference, but must be both or none, and reference_rate with them alone";
