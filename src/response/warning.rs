use thiserror::Error;

use super::play::Play;
use super::simulation::Simulation;
use crate::link::Link;
use crate::numeric::largest;
use crate::numeric::rounded;

/// Torque at its first or last sample, over its peak, from which on the user is told.
const STEP_SHARE: f64 = 1e-3;

/// Steps in a period of the first mode below which the user is told.
const STEPS_IN_A_PERIOD: f64 = 8.0;

/// Vibration over the tip's way below which no row needs to show it.
const VIBRATES: f64 = 1e-6;

/// Something that the user must know to believe a simulation. Returned, never printed here.
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
    /// A step too long for the vibration to be seen.
    #[error(
        "the step = {:?} s leaves {:?} steps to a period of the first mode, {:?} s: between the rows \
         the link does what no row shows",
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
    /// More bending than the linear theory of small deflections holds for.
    #[error("{}", Link::large_deflection_words(*share))]
    LargeDeflection {
        /// Largest deflection of the tip from the hub's tangent line over the length.
        share: f64,
    },
    /// A mesh, or modes, too few for the torque.
    #[error(
        "mesh and modes make the tip wrong by {tip:.1e} of its way, the hub angle by \
         {hub_angle:.1e} of its peak (elements halved)"
    )]
    CoarseMesh {
        /// Error of the tip over its way.
        tip: f64,
        /// Error of the hub angle over its peak.
        hub_angle: f64,
    },
}

impl SimulationWarning {
    /// Name of the kind, for machines.
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

/// All warnings that a simulation gives reason for.
pub(super) fn warnings(simulation: &Simulation, play: &Play) -> Vec<SimulationWarning> {
    let torque = play.torque.torque_n_m();
    let peak = largest(torque);
    let share = |torque_n_m: f64| torque_n_m.abs() / peak;
    let (first, last) = (torque[0], torque[torque.len() - 1]);
    let begins = SimulationWarning::BeginsWithJump { torque_n_m: first, share: share(first) };
    let ends = SimulationWarning::EndsWithJump { torque_n_m: last, share: share(last) };
    let step_s = simulation.grid.step_s;
    let coarse = simulation.equations.first_period_s().map(|period_s| {
        let steps = period_s / step_s;
        SimulationWarning::CoarseStep { step_s, period_s, steps }
    });
    let is_coarse = |warning: &SimulationWarning| match warning {
        SimulationWarning::CoarseStep { steps, .. } => {
            *steps < STEPS_IN_A_PERIOD && simulation.residual.share > VIBRATES
        }
        _ => false,
    };
    let bent = largest(&simulation.tip_deflection_m()) / simulation.mesh.length_m();
    let deflects = SimulationWarning::LargeDeflection { share: bent };
    (share(first) > STEP_SHARE)
        .then_some(begins)
        .into_iter()
        .chain((share(last) > STEP_SHARE).then_some(ends))
        .chain(coarse.filter(is_coarse))
        .chain((bent > Link::LARGE_DEFLECTION).then_some(deflects))
        .collect()
}
