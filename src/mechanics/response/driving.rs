//! Input of the equations of motion, at its samples and between them.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::motion::wrapped;
use crate::numeric::{CubicSpline, SplineEnds};
use crate::text::significant;

/// Input u of the equations of motion: the hub's acceleration, or the torque, and the part of the feedback that
/// depends on its reference. The part that depends on the link's motion belongs to the equations.
#[derive(Debug, Clone)]
pub(super) struct Driving {
    pub(super) samples: Vec<f64>,
    pub(super) pieces: Vec<Cubic>,
    /// Input after its last sample.
    pub(super) hold: f64,
    /// Whether the first sample follows the last.
    pub(super) repeats: bool,
    /// Rate in rad/s of the reference; the damping of a loop turns with it. `None`: at rest.
    pub(super) turning: Option<Box<Self>>,
    /// Jumps of a prescribed joint at the samples; empty for a smooth motion.
    pub(super) jumps: Vec<Jump>,
}

/// Jump of a prescribed joint's position in rad and rate in rad/s.
pub(super) type Jump = [f64; 2];

/// Input of one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) input: Cubic,
    /// Rate of the reference.
    pub(super) turning: Cubic,
    /// Jump of a prescribed joint at the end of the step.
    pub(super) jump: Jump,
}

impl From<Cubic> for Step {
    fn from(input: Cubic) -> Self {
        Self { input, turning: [0.0; 4], jump: [0.0; 2] }
    }
}

impl Driving {
    /// An input of these samples, 0 after the last one, about a reference at rest.
    pub(super) fn new(samples: Vec<f64>, pieces: Vec<Cubic>) -> Self {
        Self { samples, pieces, hold: 0.0, repeats: false, turning: None, jumps: Vec::new() }
    }

    /// A prescribed joint that moves by these jumps alone, and at the rates that they leave.
    pub(super) fn jumping(jumps: Vec<Jump>, repeats: bool) -> Self {
        let (samples, pieces) = (vec![0.0; jumps.len()], vec![[0.0; 4]; jumps.len()]);
        Self { repeats, jumps, ..Self::new(samples, pieces) }
    }

    /// Jump of a prescribed joint at a sample. At the first sample of a motion from rest the joint begins with it.
    pub(super) fn jump_at(&self, sample: usize) -> Jump {
        let len = self.jumps.len().max(1);
        let sample = if self.repeats { sample % len } else { sample };
        self.jumps.get(sample).copied().unwrap_or_default()
    }

    /// Jump from rest at the first sample. A cycle has none: its last step ends with it.
    pub(super) fn first_jump(&self) -> Jump {
        if self.repeats { [0.0; 2] } else { self.jump_at(0) }
    }

    /// Samples with a course between them: one cycle that `repeats`, or once.
    pub(super) fn sampled(samples: Vec<f64>, interpolation: Interpolation, repeats: bool) -> Self {
        if repeats {
            return Self::repeated(samples, interpolation);
        }
        let pieces = pieces(&samples, interpolation);
        Self::new(samples, pieces)
    }

    /// A cycle of samples: the last sample precedes the first one of the next cycle.
    pub(super) fn repeated(samples: Vec<f64>, interpolation: Interpolation) -> Self {
        let around = samples.len();
        let mut pieces = pieces(&wrapped(&samples, 0.0, around), interpolation);
        pieces.drain(..around);
        pieces.truncate(around);
        Self { repeats: true, ..Self::new(samples, pieces) }
    }

    /// The input at a sample, also after the last one.
    pub(super) fn at(&self, sample: usize) -> f64 {
        let sample = if self.repeats { sample % self.samples.len() } else { sample };
        self.samples.get(sample).copied().unwrap_or(self.hold)
    }

    /// The input a part s of a step after a sample.
    pub(super) fn within(&self, (sample, s): (usize, f64)) -> f64 {
        if s == 0.0 {
            return self.at(sample);
        }
        self.piece(sample).iter().rev().fold(0.0, |sum, term| sum * s + term)
    }

    /// Rate of the reference at a sample in rad/s.
    pub(super) fn turning_at(&self, sample: usize) -> f64 {
        self.turning.as_ref().map_or(0.0, |turning| turning.at(sample))
    }

    /// Rates of the reference at `samples` samples in rad/s.
    pub(super) fn turning_rad_s(&self, samples: usize) -> Vec<f64> {
        (0..samples).map(|sample| self.turning_at(sample)).collect()
    }

    /// Inputs of each step between `samples` samples.
    pub(super) fn steps(&self, samples: usize) -> impl Iterator<Item = Step> {
        let turning = self.turning.as_deref();
        (0..samples.saturating_sub(1)).map(move |k| Step {
            input: self.piece(k),
            turning: turning.map_or([0.0; 4], |turning| turning.piece(k)),
            jump: self.jump_at(k + 1),
        })
    }

    /// The input over the step after a sample.
    fn piece(&self, sample: usize) -> Cubic {
        let sample = if self.repeats { sample % self.pieces.len() } else { sample };
        self.pieces.get(sample).copied().unwrap_or(self.held())
    }

    /// The input over any step after the last sample.
    pub(super) fn held(&self) -> Cubic {
        [self.hold, 0.0, 0.0, 0.0]
    }
}

/// Reason why a torque has no repeating cycle of motion.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CycleError {
    /// A mean torque that turns a free hub faster and faster.
    #[error(
        "the mean torque = {} N m, but must be 0: without friction or feedback the hub turns faster \
         from cycle to cycle",
        significant(*mean_n_m, 6)
    )]
    Mean {
        /// The mean torque in N m.
        mean_n_m: f64,
    },
    /// A hub angle that does not return to its start.
    #[error(
        "the hub angle is {jump_rad:e} rad away from its start a step after its last sample, but must be back there: \
         it repeats"
    )]
    Reference {
        /// The angle in rad from the last sample to the first.
        jump_rad: f64,
    },
    /// A cycle with its first sample again as the last one.
    #[error("the last row of the cycle repeats the first one, but must be the row before it")]
    Repeats,
    /// A vibration of an undamped link that grows or is not finite.
    #[error("the cycle is in step with an undamped vibration, which grows without bound")]
    Resonance,
    /// A link at large angles with a free hub.
    #[error(
        "hub.viscous_friction = 0, but must be above 0 without feedback: the hub is free at large angles"
    )]
    Free,
    /// A link with weight or at large angles that does not settle.
    #[error(
        "cycle {cycles} still differs from the one before by {share:.1e} of its turn: the pose falls, or the swing \
         hardly decays"
    )]
    Unsettled {
        /// Number of simulated cycles.
        cycles: usize,
        /// Change from one cycle to the next over the turn of the hub.
        share: f64,
    },
}

impl CycleError {
    pub(super) fn hint(self) -> &'static str {
        match self {
            Self::Mean { .. } | Self::Unsettled { .. } | Self::Free => {
                "set hub.viscous_friction or a larger drive.friction_rate, or use --feedback"
            }
            Self::Reference { .. } => {
                "use whole cycles, or feedback without stiffness around a reference with rates: --feedback 0,KD"
            }
            Self::Repeats => {
                "leave the last row out: the first row follows the last one, a step later"
            }
            Self::Resonance => "add damping to the link",
        }
    }
}

/// A torque, the voltage of a motor, or the motion of a joint, between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// Each sample until the next one, like a converter with a table.
    Zero,
    /// Straight lines.
    Linear,
    /// A cubic spline through all samples.
    #[default]
    Cubic,
}

/// Coefficients of a cubic over one step: `u(s) = Σ c_j (s/Δt)ʲ`.
pub(super) type Cubic = [f64; 4];

/// The pieces between samples, one fewer than the samples.
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
