//! What a simulation plays: a torque, and feedback around a reference, or a motion of the hub.

use serde::Serialize;

use super::error::{SimulationError, SimulationWarning};
use super::history::{HubReference, Torque, same_times};
use super::modes::{Equations, HubReaction, held, torque_band_rad_s};
use super::state::State;
use crate::beam::Mesh;
use crate::link::{Link, ParameterError, not_negative};
use crate::modal::{DampingLaw, ModalBasis};
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid};

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
                SimulationWarning::hub_begins(&hub.slopes_rad_s()),
                SimulationWarning::rough(&torque_n_m[..hub.grid().len]),
            ],
        }
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
        }
    }

    /// The input's grid, continued to the given end.
    pub(super) fn grid(&self) -> Result<TimeGrid, SimulationError> {
        let grid = self.input.grid();
        let Some(until_s) = self.until_s else { return Ok(grid) };
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

    /// Frequency in rad/s above which the link is not driven; none where nothing drives it.
    pub(super) fn band_rad_s(&self) -> Option<f64> {
        let grid = self.input.grid();
        let torque = match self.input {
            Input::Torque(torque) => torque_band_rad_s(&grid, torque.torque_n_m()),
            Input::HubAngle(hub) => return torque_band_rad_s(&grid, &hub.accelerations().0),
        };
        // The reference's rate, unlike its angle, is zero at both ends.
        let drives = |of: &&Feedback| of.stiffness_n_m_rad > 0.0 || of.damping_n_m_s_rad > 0.0;
        let feedback = self.feedback.filter(drives);
        let wanted = feedback.and_then(|of| torque_band_rad_s(&grid, &of.rate_rad_s()));
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

    /// The hub angle in rad from which the angles of a state count; none without a state.
    pub(super) fn zero_of_state_rad(&self, link: &Link) -> Option<f64> {
        self.state.map(|_| self.origin_rad(link).unwrap_or(0.0))
    }

    /// Displacement of the tip at the start in m; a prescribed hub points to it.
    pub(super) fn start_m(&self, link: &Link) -> f64 {
        match self.input {
            // The coordinates of a state hold all of it.
            Input::Torque(_) if self.state.is_some() => 0.0,
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
                let holds = |feedback: &&Feedback| feedback.stiffness_n_m_rad > 0.0;
                let feedback = self.feedback.filter(holds);
                feedback.map(|own| own.reference.turn_rad(self.zero_of_state_rad(link)))
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
            Input::Torque(_) => Ok(free),
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
                let (samples, pieces) = hub.accelerations();
                return Ok(Driving { samples, pieces, hold: 0.0 });
            }
        };
        let own = torque.torque_n_m();
        let kept_n_m = if link.has_weight() { own[own.len() - 1] } else { 0.0 };
        let zero_rad = self.zero_of_state_rad(link);
        let (samples, hold) = match self.feedback {
            None => (own.to_vec(), kept_n_m),
            Some(feedback) => {
                let wanted = feedback.wanted_torque_n_m(torque, zero_rad)?;
                let samples = own.iter().zip(wanted).map(|(t, wanted)| t + wanted).collect();
                let turn_rad = feedback.reference.turn_rad(zero_rad);
                (samples, kept_n_m + feedback.stiffness_n_m_rad * turn_rad)
            }
        };
        let pieces = pieces(&samples, self.interpolation);
        Ok(Driving { samples, pieces, hold })
    }
}

/// Collocated feedback at the hub around a computed motion (Bayo 1987, section 6).
///
/// ```text
/// u = T + k_p (θ_ref − θ) + k_d (θ̇_ref − θ̇)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    stiffness_n_m_rad: f64,
    damping_n_m_s_rad: f64,
    reference: HubReference,
}

impl Feedback {
    /// Gains `k_p` in N m/rad and `k_d` in N m s/rad around a reference.
    ///
    /// # Errors
    /// [`ParameterError`] names the first gain that is negative or not finite.
    pub fn new(
        stiffness_n_m_rad: f64,
        damping_n_m_s_rad: f64,
        reference: HubReference,
    ) -> Result<Self, ParameterError> {
        not_negative("KP", stiffness_n_m_rad, "N m/rad")?;
        not_negative("KD", damping_n_m_s_rad, "N m s/rad")?;
        Ok(Self { stiffness_n_m_rad, damping_n_m_s_rad, reference })
    }

    /// `k_p` in N m/rad.
    pub fn stiffness_n_m_rad(&self) -> f64 {
        self.stiffness_n_m_rad
    }

    /// `k_d` in N m s/rad.
    pub fn damping_n_m_s_rad(&self) -> f64 {
        self.damping_n_m_s_rad
    }

    /// The reference.
    pub fn reference(&self) -> &HubReference {
        &self.reference
    }

    /// What the reference adds to the torque at each sample, `k_p (θ_ref − θ_ref(0)) + k_d θ̇_ref`;
    /// the link starts at the reference's first angle, or from a state whose angles count from `zero_rad`.
    ///
    /// # Errors
    /// [`SimulationError::OtherTimes`].
    fn wanted_torque_n_m(
        &self,
        torque: &Torque,
        zero_rad: Option<f64>,
    ) -> Result<Vec<f64>, SimulationError> {
        let (found, torque) = (self.reference.grid(), torque.grid());
        if !same_times(&found, &torque) {
            return Err(SimulationError::OtherTimes { found, torque });
        }
        let angle = self.reference.angle_rad();
        let zero_rad = zero_rad.unwrap_or(angle[0]);
        let wanted = angle.iter().zip(self.rate_rad_s()).map(|(angle_rad, rate)| {
            self.stiffness_n_m_rad * (angle_rad - zero_rad) + self.damping_n_m_s_rad * rate
        });
        Ok(wanted.collect())
    }

    /// Rate of the reference: as given, or that of a spline through its angles.
    fn rate_rad_s(&self) -> Vec<f64> {
        let given = self.reference.rate_rad_s().map(<[f64]>::to_vec);
        given.unwrap_or_else(|| self.reference.slopes_rad_s())
    }
}

/// Input u of the equations of motion: the hub's acceleration, or the torque, and the part of the feedback that
/// depends on its reference. The part that depends on the link's motion belongs to the equations.
#[derive(Debug, Clone)]
pub(super) struct Driving {
    samples: Vec<f64>,
    pieces: Vec<Cubic>,
    /// After the last sample of the input.
    hold: f64,
}

impl Driving {
    /// At a sample, also after the input's last.
    pub(super) fn at(&self, sample: usize) -> f64 {
        self.samples.get(sample).copied().unwrap_or(self.hold)
    }

    /// Over each step between so many samples.
    pub(super) fn steps(&self, samples: usize) -> impl Iterator<Item = Cubic> {
        (1..samples).map(|k| self.pieces.get(k - 1).copied().unwrap_or(self.held()))
    }

    /// Over any step after the last sample.
    pub(super) fn held(&self) -> Cubic {
        [self.hold, 0.0, 0.0, 0.0]
    }
}

/// A torque, or the voltage of a motor, between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// A cubic spline through all samples.
    #[default]
    Cubic,
    /// Straight lines.
    Linear,
    /// Each sample until the next one, as a converter plays a table.
    Zero,
}

/// Coefficients of a cubic over one step: `u(s) = Σ c_j (s/Δt)ʲ`.
pub(super) type Cubic = [f64; 4];

/// The pieces between samples, one fewer than there are samples.
pub(super) fn pieces(samples: &[f64], interpolation: Interpolation) -> Vec<Cubic> {
    match interpolation {
        Interpolation::Linear => {
            samples.windows(2).map(|ends| [ends[0], ends[1] - ends[0], 0.0, 0.0]).collect()
        }
        Interpolation::Zero => {
            samples[..samples.len().saturating_sub(1)].iter().map(|u| [*u, 0.0, 0.0, 0.0]).collect()
        }
        Interpolation::Cubic => {
            let spline = CubicSpline::uniform(samples, SplineEnds::NotAKnot);
            let ends = samples.windows(2).zip(spline.slopes().windows(2));
            ends.map(|(values, slopes)| {
                let (rise, [from, to]) = (values[1] - values[0], [slopes[0], slopes[1]]);
                [values[0], from, 3.0 * rise - 2.0 * from - to, from + to - 2.0 * rise]
            })
            .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_cubic_are_that_cubic() {
        let cubic = |s: f64| 0.5 - s + 0.25 * s * s - 0.125 * s * s * s;
        let samples: Vec<f64> = (0..6).map(|k| cubic(f64::from(k))).collect();
        let evaluated = |c: &Cubic, s: f64| c[0] + s * (c[1] + s * (c[2] + s * c[3]));
        for (k, piece) in pieces(&samples, Interpolation::Cubic).iter().enumerate() {
            for s in [0.0, 0.3, 1.0] {
                assert!((evaluated(piece, s) - cubic(k as f64 + s)).abs() < 1e-13);
            }
        }
        for (k, piece) in pieces(&samples, Interpolation::Linear).iter().enumerate() {
            let middle = 0.5 * (samples[k] + samples[k + 1]);
            assert!((evaluated(piece, 0.5) - middle).abs() < 1e-15);
        }
        for (k, piece) in pieces(&samples, Interpolation::Zero).iter().enumerate() {
            assert!((evaluated(piece, 0.99) - samples[k]).abs() < 1e-15);
        }
    }
}
