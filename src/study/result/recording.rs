//! Recorded histories of a link in motion, by the names of the simulated ones.

use serde::{Deserialize, Serialize};

use crate::response::Played;

/// A quantity that is both recorded and simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SimulatedChannel {
    /// Hub angle in rad.
    HubAngle,
    /// Hub rate in rad/s.
    HubRate,
    /// Displacement of the tip in m.
    Tip,
    /// Velocity of the tip in m/s.
    Velocity,
    /// Acceleration of the tip in m/s².
    Acceleration,
    /// Deflection of the tip from the hub's tangent line in m.
    TipDeflection,
    /// Torque at the hub in N m.
    Torque,
}

impl SimulatedChannel {
    /// The name, as in summary.json.
    pub fn name(self) -> &'static str {
        match self {
            Self::HubAngle => "hub_angle",
            Self::HubRate => "hub_rate",
            Self::Tip => "tip",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::TipDeflection => "tip_deflection",
            Self::Torque => "torque",
        }
    }

    /// The SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::HubAngle => "rad",
            Self::HubRate => "rad/s",
            Self::Tip | Self::TipDeflection => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s²",
            Self::Torque => "N m",
        }
    }

    /// Samples of a simulation.
    pub(super) fn of(self, played: &Played) -> Vec<f64> {
        match self {
            Self::HubAngle => played.hub().angle_rad.clone(),
            Self::HubRate => played.hub().rate_rad_s.clone(),
            Self::Tip => played.tip[0].displacement_m.clone(),
            Self::Velocity => played.tip[0].velocity_m_s.clone(),
            Self::Acceleration => played.tip[0].acceleration_m_s2.clone(),
            Self::TipDeflection => played.tip_deflection_m(),
            Self::Torque => played.hub().torque_n_m.clone(),
        }
    }
}

/// A recording of some channels in SI. Times increase; they need not be uniform.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelRecording {
    /// Times in s.
    pub time_s: Vec<f64>,
    /// As many samples of each channel as there are times.
    pub channels: Vec<(SimulatedChannel, Vec<f64>)>,
}
