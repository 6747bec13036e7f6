//! What a simulation plays: a torque, and feedback around a reference, or a motion of the hub.

use std::f64::consts::TAU;

use super::driving::{CycleError, Driving, Interpolation, pieces};
use super::error::{SimulationError, SimulationWarning};
use super::history::{Feedback, HubReference, Torque};
use super::hub_loop::{held, in_loop};
use super::modes::{
    Equations, HubReaction, MOST_MODES, ModeSelection, REACH, kept_modes, torque_band_rad_s,
};
use super::state::{State, of_cycle};
use crate::beam::Mesh;
use crate::link::{Damping, Link};
use crate::modal::{DampingLaw, ModalBasis};
use crate::motion::is_repeated;
use crate::numeric::TimeGrid;

/// What modes may leave out of a state, over the whole.
pub(super) const LEFT_OUT: f64 = 1e-7;

/// Most samples that are simulated.
const LONGEST: usize = 1 << 24;

/// What moves a link.
#[derive(Debug, Clone, Copy)]
pub enum Input<'a> {
    /// The torque at the hub; zero before its first and after its last sample. A link with weight is held before
    /// the first sample, and the last one stays.
    Torque(&'a Torque),
    /// The hub angle, which the hub follows exactly. It is at rest before the first sample, and turns on at
    /// its rate after the last one.
    ///
    /// The angle between the samples is a quintic spline with neither rate nor acceleration at the start;
    /// rates that come with it are not used.
    HubAngle(&'a HubReference),
}

impl Input<'_> {
    /// True of a torque.
    pub fn is_torque(&self) -> bool {
        matches!(self, Self::Torque(_))
    }

    /// Times of the samples.
    pub fn grid(&self) -> TimeGrid {
        match self {
            Self::Torque(torque) => torque.grid(),
            Self::HubAngle(hub) => hub.grid(),
        }
    }

    /// Warnings of its first and its last sample, or of the torque that a hub angle takes.
    pub(super) fn warnings(&self, torque_n_m: &[f64]) -> [Option<SimulationWarning>; 2] {
        match self {
            Self::Torque(torque) => SimulationWarning::jumps(torque.torque_n_m()),
            Self::HubAngle(hub) => [
                SimulationWarning::hub_begins(&hub.slopes_rad_s(false)),
                SimulationWarning::rough(&torque_n_m[..hub.grid().len]),
            ],
        }
    }
}

/// A grid continued to a given end.
///
/// # Errors
/// [`SimulationError::EndsEarly`], [`SimulationError::TooLong`].
pub(super) fn continued(grid: TimeGrid, until_s: Option<f64>) -> Result<TimeGrid, SimulationError> {
    let Some(until_s) = until_s else { return Ok(grid) };
    let end_s = grid.end_s();
    let steps = (until_s - end_s) / grid.step_s;
    // A millionth of a step beside the last sample is that sample.
    if steps.is_nan() || steps < -1e-6 {
        return Err(SimulationError::EndsEarly { until_s, end_s });
    }
    let more = (steps - 1e-6).ceil().max(0.0);
    let samples = grid.len as f64 + more;
    if samples > LONGEST as f64 {
        return Err(SimulationError::TooLong { until_s, samples, limit: LONGEST });
    }
    Ok(TimeGrid { len: samples as usize, ..grid })
}

/// Refuses a play of so many samples and modes that takes more bytes than are allowed.
///
/// # Errors
/// [`SimulationError::TooMuchMemory`].
pub(super) fn refuse_memory(
    (samples, modes): (usize, usize),
    bytes: usize,
    allowed: Option<usize>,
) -> Result<(), SimulationError> {
    match allowed.filter(|allowed| bytes > *allowed) {
        Some(allowed) => Err(SimulationError::TooMuchMemory { samples, modes, bytes, allowed }),
        None => Ok(()),
    }
}

/// What to play on a link at rest, and how.
#[derive(Debug, Clone, Copy)]
pub struct Play<'a> {
    /// What moves the link.
    pub input: Input<'a>,
    /// A torque between its samples.
    pub interpolation: Interpolation,
    /// Time in s at which to end; `None`: at the last sample of the input.
    pub until_s: Option<f64>,
    /// Feedback at the hub, added to a torque.
    pub feedback: Option<&'a Feedback>,
    /// Displacement of the tip at the start in m, under a torque; a prescribed hub points to it.
    pub initial_tip_m: f64,
    /// Most memory in bytes that playing may take; `None`: no bound.
    pub memory_bytes: Option<usize>,
    /// Whether all terms of large angles are counted. With weight they always are.
    pub is_large: bool,
    /// Direction of the chord in rad where the tip's displacement is 0; `None`: that of the link, or 0 without weight.
    pub start_angle_rad: Option<f64>,
    /// Where the link starts instead of at rest, under a torque.
    pub state: Option<&'a State>,
    /// Set where the input is one cycle that repeats, and the link moves as after many of them: a hub that is moved, or that
    /// of a linear link that neither friction nor feedback holds, turns by so many rad in a cycle.
    pub cycle_turn_rad: Option<f64>,
}

impl<'a> Play<'a> {
    /// A torque played to its end, by cubics, without feedback, the tip at 0 at the start.
    pub fn of(torque: &'a Torque) -> Self {
        Self::with(Input::Torque(torque))
    }

    /// The hub moved as prescribed to the end of that motion.
    pub fn turning(hub: &'a HubReference) -> Self {
        Self::with(Input::HubAngle(hub))
    }

    fn with(input: Input<'a>) -> Self {
        Self {
            input,
            interpolation: Interpolation::default(),
            until_s: None,
            feedback: None,
            initial_tip_m: 0.0,
            memory_bytes: None,
            is_large: false,
            start_angle_rad: None,
            state: None,
            cycle_turn_rad: None,
        }
    }

    /// The input's grid, continued to the given end.
    pub(super) fn grid(&self) -> Result<TimeGrid, SimulationError> {
        continued(self.input.grid(), self.until_s)
    }

    /// Frequency in rad/s above which the link is not driven; none where nothing drives it.
    pub(super) fn band_rad_s(&self) -> Option<f64> {
        let grid = self.input.grid();
        let torque = match self.input {
            Input::Torque(torque) => torque_band_rad_s(&grid, torque.torque_n_m()),
            Input::HubAngle(hub) => {
                return torque_band_rad_s(&grid, &hub.accelerations(self.cycle_turn_rad).0);
            }
        };
        // The reference's rate, unlike its angle, is zero at both ends.
        let drives = |of: &&Feedback| of.stiffness_n_m_rad() > 0.0 || of.damping_n_m_s_rad() > 0.0;
        let repeats = self.cycle_turn_rad.is_some();
        let wanted = self.feedback.filter(drives).map(|of| of.rate_rad_s(repeats));
        let wanted = wanted.and_then(|rate| torque_band_rad_s(&grid, &rate));
        torque.into_iter().chain(wanted).reduce(f64::max)
    }

    /// The error of an input that moves nothing.
    pub(super) fn nothing(&self) -> SimulationError {
        match self.input {
            Input::Torque(_) => SimulationError::NoTorque,
            Input::HubAngle(_) => SimulationError::NoTurn,
        }
    }

    /// Direction of the chord in rad where the tip's displacement is 0, if there is gravity to give it.
    pub(super) fn origin_rad(&self, link: &Link) -> Option<f64> {
        self.start_angle_rad.or(link.gravity().and_then(|gravity| gravity.start_angle_rad))
    }

    /// Whether the link is played with all terms of large angles.
    pub(super) fn is_large_on(&self, link: &Link) -> bool {
        self.is_large || link.has_weight()
    }

    /// True if the start is given, or worked out as one that repeats: not that of a link at rest.
    fn is_started(&self) -> bool {
        self.state.is_some() || self.cycle_turn_rad.is_some()
    }

    /// The hub angle in rad from which the angles of a state count; none without a state.
    pub(super) fn zero_of_state_rad(&self, link: &Link) -> Option<f64> {
        self.is_started().then(|| self.origin_rad(link).unwrap_or(0.0))
    }

    /// Displacement of the tip at the start in m; a prescribed hub points to it.
    pub(super) fn start_m(&self, link: &Link) -> f64 {
        match self.input {
            // The coordinates of a state hold all of it.
            Input::Torque(_) if self.is_started() => 0.0,
            Input::Torque(_) => self.initial_tip_m,
            Input::HubAngle(hub) => {
                (hub.angle_rad()[0] - self.origin_rad(link).unwrap_or(0.0)) * link.length_m()
            }
        }
    }

    /// Turn in rad from the start to where feedback holds the hub in the end, if it does.
    pub(super) fn goal_rad(&self, link: &Link) -> Option<f64> {
        match self.input {
            Input::Torque(_) => {
                let holds = |feedback: &&Feedback| feedback.stiffness_n_m_rad() > 0.0;
                let feedback = self.feedback.filter(holds);
                feedback.map(|own| own.reference().turn_rad(self.zero_of_state_rad(link)))
            }
            Input::HubAngle(_) => None,
        }
    }

    /// The link's equations of motion under this input.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`].
    pub(super) fn equations(
        &self,
        link: &Link,
        (mesh, law): (&Mesh, &DampingLaw),
        basis: ModalBasis,
    ) -> Result<Equations, SimulationError> {
        let free = Equations::new(mesh, law, basis, self.reaction(link));
        match self.input {
            Input::Torque(_) => Ok(in_loop(free, law)),
            Input::HubAngle(hub) => {
                held(&free, law).ok_or(SimulationError::NotFinite { time_s: hub.grid().time_s(0) })
            }
        }
    }

    /// Friction and feedback at the hub.
    pub(super) fn reaction(&self, link: &Link) -> HubReaction {
        let friction_n_m_s_rad = link.hub().viscous_friction_n_m_s_rad;
        let gain = |of: fn(&Feedback) -> f64| self.feedback.map_or(0.0, of);
        HubReaction {
            stiffness_n_m_rad: gain(Feedback::stiffness_n_m_rad),
            damping_n_m_s_rad: friction_n_m_s_rad + gain(Feedback::damping_n_m_s_rad),
            friction_n_m_s_rad,
        }
    }

    /// The input at all samples and between them; after the last one the motor of a link with weight keeps its torque.
    ///
    /// # Errors
    /// [`SimulationError::OtherTimes`] of a reference.
    pub(super) fn driving(&self, link: &Link) -> Result<Driving, SimulationError> {
        let torque = match self.input {
            Input::Torque(torque) => torque,
            Input::HubAngle(hub) => {
                let turn_rad = self.cycle_turn_rad;
                if let Some(jump_rad) = turn_rad.and_then(|turn_rad| hub.jump_rad(turn_rad)) {
                    return Err(CycleError::Reference { jump_rad }.into());
                }
                let (samples, pieces, _) = hub.accelerations(turn_rad);
                return Ok(Driving {
                    samples,
                    pieces,
                    hold: 0.0,
                    repeats: turn_rad.is_some(),
                    turning: None,
                });
            }
        };
        let own = torque.torque_n_m();
        if self.cycle_turn_rad.is_some() && is_repeated(own, 0.0) {
            return Err(CycleError::Repeats.into());
        }
        let kept_n_m = if link.has_weight() { own[own.len() - 1] } else { 0.0 };
        let zero_rad = self.zero_of_state_rad(link);
        let repeats = self.cycle_turn_rad.is_some();
        let (samples, hold) = match self.feedback {
            None => (own.to_vec(), kept_n_m),
            Some(feedback) => {
                let wanted = feedback.wanted_torque_n_m(torque, zero_rad, repeats)?;
                let samples = own.iter().zip(wanted).map(|(t, wanted)| t + wanted).collect();
                let turn_rad = feedback.reference().turn_rad(zero_rad);
                (samples, kept_n_m + feedback.stiffness_n_m_rad() * turn_rad)
            }
        };
        let between = |samples: Vec<f64>, interpolation, hold, turning| match self.cycle_turn_rad {
            Some(_) => Driving { turning, ..Driving::repeated(samples, interpolation) },
            None => Driving {
                pieces: pieces(&samples, interpolation),
                samples,
                hold,
                repeats: false,
                turning,
            },
        };
        let is_hysteretic = matches!(link.damping(), Damping::Hysteretic { .. });
        let reference = self.feedback.filter(|of| is_hysteretic && of.stiffness_n_m_rad() > 0.0);
        let turning = reference.map(|of| {
            let rate_rad_s = of.rate_rad_s(repeats);
            Box::new(between(rate_rad_s, Interpolation::Cubic, 0.0, None))
        });
        Ok(between(samples, self.interpolation, hold, turning))
    }
}

impl Play<'_> {
    /// Coordinates and rates of a linear link at the start, and what its modes leave out of a state, over the whole.
    pub(super) fn start(
        &self,
        link: &Link,
        (equations, mesh): (&Equations, &Mesh),
        driving: &Driving,
    ) -> Result<([Vec<f64>; 2], f64), SimulationError> {
        if let Some(turn_rad) = self.cycle_turn_rad {
            let travel_m = turn_rad * link.length_m();
            let (grid, ends_m) = (self.input.grid(), [travel_m, self.initial_tip_m]);
            return Ok((of_cycle(equations, driving, (grid.step_s, grid.len), ends_m)?, 0.0));
        }
        let Some(state) = self.state else {
            let rest = vec![0.0; equations.coordinates.len()];
            return Ok(([rest.clone(), rest], 0.0));
        };
        let origin_rad = self.origin_rad(link).unwrap_or(0.0);
        Ok(state.coordinates(equations, mesh, origin_rad))
    }
}

/// A linear link before it is played.
pub(super) struct Started {
    pub(super) equations: Equations,
    pub(super) selection: ModeSelection,
    /// Coordinates and rates.
    pub(super) start: [Vec<f64>; 2],
    /// What the modes leave out of the state, over the whole.
    pub(super) left_out: f64,
}

impl Started {
    /// With the modes that an input drives up to `band_rad_s`, or that a state holds.
    pub(super) fn of(
        link: &Link,
        (mesh, law): (&Mesh, &DampingLaw),
        (play, driving): (&Play, &Driving),
        mut band_rad_s: f64,
    ) -> Result<Self, SimulationError> {
        loop {
            let (basis, selection) = kept_modes(mesh, band_rad_s, MOST_MODES);
            let equations = play.equations(link, (mesh, law), basis)?;
            let (start, left_out) = play.start(link, (&equations, mesh), driving)?;
            let has_all = selection.modes >= selection.of.min(MOST_MODES);
            if left_out <= LEFT_OUT || has_all {
                return Ok(Self { equations, selection, start, left_out });
            }
            band_rad_s = 2.0 * band_rad_s.max(TAU * selection.highest_hz / REACH);
        }
    }
}

/// How far the play of an arm is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArmProgress {
    /// How often it has been refined: more angles, half the step.
    pub refinement: usize,
    /// Samples that are played so finely.
    pub done: usize,
    /// All samples.
    pub samples: usize,
}
