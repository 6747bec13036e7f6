use thiserror::Error;

use crate::link::Link;
use crate::numeric::{largest, rounded};

/// Torque at its first or last sample over its peak, above which a warning is given.
const STEP_SHARE: f64 = 1e-3;

/// Steps in a period of the first mode below which a warning is given.
const STEPS_IN_A_PERIOD: f64 = 8.0;

/// Vibration over the tip's travel below which the rows need not show it.
const VIBRATES: f64 = 1e-6;

/// What the user must know to judge a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SimulationWarning {
    /// A torque that does not begin at zero.
    #[error(
        "the torque begins with {:?} N m, {:.1} % of its peak: it acts on the resting link as a jump",
        rounded(*torque_n_m, 4),
        100.0 * share
    )]
    BeginsWithJump {
        /// First sample in N m.
        torque_n_m: f64,
        /// The same over the peak.
        share: f64,
    },
    /// A torque that does not end at zero.
    #[error(
        "the torque ends with {:?} N m, {:.1} % of its peak: it drops to zero there",
        rounded(*torque_n_m, 4),
        100.0 * share
    )]
    EndsWithJump {
        /// Last sample in N m.
        torque_n_m: f64,
        /// The same over the peak.
        share: f64,
    },
    /// A step too long to show the vibration.
    #[error(
        "the step = {:?} s leaves {:?} steps to a period of the first mode, {:?} s: the rows do not \
         show its vibration",
        rounded(*step_s, 12),
        rounded(*steps, 2),
        rounded(*period_s, 4)
    )]
    CoarseStep {
        /// Step in s.
        step_s: f64,
        /// Period of the first mode in s.
        period_s: f64,
        /// Period over step.
        steps: f64,
    },
    /// A deflection beyond the linear theory.
    #[error("{}", Link::large_deflection_words(*share))]
    LargeDeflection {
        /// Largest deflection of the tip from the hub's tangent line over the length.
        share: f64,
    },
    /// Too few elements or modes for the torque.
    #[error(
        "mesh and modes make the tip wrong by {tip:.1e} of its way, the hub angle by \
         {hub_angle:.1e} of its peak (elements halved)"
    )]
    CoarseMesh {
        /// Error of the tip over its travel.
        tip: f64,
        /// Error of the hub angle over its peak.
        hub_angle: f64,
    },
}

impl SimulationWarning {
    /// Name of the kind in summary.json.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::BeginsWithJump { .. } => "begins_with_jump",
            Self::EndsWithJump { .. } => "ends_with_jump",
            Self::CoarseStep { .. } => "coarse_step",
            Self::LargeDeflection { .. } => "large_deflection",
            Self::CoarseMesh { .. } => "coarse_mesh",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::BeginsWithJump { .. } | Self::EndsWithJump { .. } => {
                "a torque of solve begins and ends at zero unless analysis.lead or analysis.lag cut it"
            }
            Self::CoarseStep { .. } => "a torque with a shorter step",
            Self::LargeDeflection { .. } => "a smaller torque or a stiffer link",
            Self::CoarseMesh { .. } => {
                "more elements, mesh.elements = \"auto\", or a torque without jumps and corners"
            }
        }
    }
}

/// What warnings depend on.
pub(super) struct Evidence<'a> {
    /// Samples of the torque.
    pub(super) torque_n_m: &'a [f64],
    pub(super) step_s: f64,
    /// Period of the first flexible mode in s.
    pub(super) first_period_s: Option<f64>,
    /// Residual vibration over the tip's travel.
    pub(super) vibration_share: f64,
    /// Largest deflection of the tip over the length.
    pub(super) deflection_share: f64,
}

/// All warnings that the evidence gives.
pub(super) fn warnings(evidence: &Evidence) -> Vec<SimulationWarning> {
    let Evidence { torque_n_m: torque, step_s, .. } = *evidence;
    let peak = largest(torque);
    let share = |torque_n_m: f64| torque_n_m.abs() / peak;
    let (first, last) = (torque[0], torque[torque.len() - 1]);
    let begins = SimulationWarning::BeginsWithJump { torque_n_m: first, share: share(first) };
    let ends = SimulationWarning::EndsWithJump { torque_n_m: last, share: share(last) };
    let coarse = evidence.first_period_s.and_then(|period_s| {
        let steps = period_s / step_s;
        let is_coarse = steps < STEPS_IN_A_PERIOD && evidence.vibration_share > VIBRATES;
        is_coarse.then_some(SimulationWarning::CoarseStep { step_s, period_s, steps })
    });
    let deflection = evidence.deflection_share;
    let deflects = SimulationWarning::LargeDeflection { share: deflection };
    (share(first) > STEP_SHARE)
        .then_some(begins)
        .into_iter()
        .chain((share(last) > STEP_SHARE).then_some(ends))
        .chain(coarse)
        .chain((deflection > Link::LARGE_DEFLECTION).then_some(deflects))
        .collect()
}
