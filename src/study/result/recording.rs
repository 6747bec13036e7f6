//! Recorded histories of a link or an arm in motion, by the names of the simulated ones.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::link::MOST_LINKS;
use crate::response::Played;

/// A quantity that is both recorded and simulated. Joints count from 0, and from 1 in names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum SimulatedChannel {
    /// Hub angle of one link in rad.
    HubAngle,
    /// Hub rate of one link in rad/s.
    HubRate,
    /// Displacement of one link's tip in m.
    Tip,
    /// Velocity of one link's tip in m/s.
    Velocity,
    /// Acceleration of one link's tip in m/s².
    Acceleration,
    /// Deflection of one link's tip from the hub's tangent line in m.
    TipDeflection,
    /// Torque at the hub of one link in N m.
    Torque,
    /// x of an arm's tip in m.
    TipX,
    /// y of an arm's tip in m.
    TipY,
    /// Angle of an arm's joint in rad.
    JointAngle(usize),
    /// Rate of an arm's joint in rad/s.
    JointRate(usize),
    /// Torque of an arm's joint in N m.
    JointTorque(usize),
}

/// A name without channel.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0} is no channel of a simulation")]
pub struct UnknownChannel(String);

impl SimulatedChannel {
    /// All channels of one link and of arms.
    fn all() -> impl Iterator<Item = Self> {
        let of_link = [
            Self::HubAngle,
            Self::HubRate,
            Self::Tip,
            Self::Velocity,
            Self::Acceleration,
            Self::TipDeflection,
            Self::Torque,
        ];
        let of_joint =
            |joint| [Self::JointAngle(joint), Self::JointRate(joint), Self::JointTorque(joint)];
        of_link
            .into_iter()
            .chain([Self::TipX, Self::TipY])
            .chain((0..MOST_LINKS).flat_map(of_joint))
    }

    /// The channel of this name.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        Self::all().find(|channel| channel.name() == name)
    }

    /// Number of the joint, from 0, for a quantity of an arm's joint.
    pub(crate) fn joint(self) -> Option<usize> {
        match self {
            Self::JointAngle(joint) | Self::JointRate(joint) | Self::JointTorque(joint) => {
                Some(joint)
            }
            _ => None,
        }
    }

    /// The name, as in summary.json.
    pub fn name(self) -> String {
        let name = match self {
            Self::HubAngle => "hub_angle",
            Self::HubRate => "hub_rate",
            Self::Tip => "tip",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::TipDeflection => "tip_deflection",
            Self::Torque => "torque",
            Self::TipX => "x",
            Self::TipY => "y",
            Self::JointAngle(joint) => return format!("joint{}", joint + 1),
            Self::JointRate(joint) => return format!("joint{}_rate", joint + 1),
            Self::JointTorque(joint) => return format!("torque{}", joint + 1),
        };
        name.to_owned()
    }

    /// The SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::HubAngle | Self::JointAngle(_) => "rad",
            Self::HubRate | Self::JointRate(_) => "rad/s",
            Self::Tip | Self::TipDeflection | Self::TipX | Self::TipY => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s²",
            Self::Torque | Self::JointTorque(_) => "N m",
        }
    }

    /// Samples of a simulation, if it has this channel.
    pub(super) fn of(self, played: &Played) -> Option<Vec<f64>> {
        let is_link = played.joints.len() == 1;
        let is_of_arm = self.joint().is_some() || matches!(self, Self::TipX | Self::TipY);
        let joint = self.joint().unwrap_or(0);
        let joint = played.joints.get(joint).filter(|_| is_link != is_of_arm)?;
        let tip = &played.tip[usize::from(self == Self::TipY)];
        Some(match self {
            Self::HubAngle | Self::JointAngle(_) => joint.angle_rad.clone(),
            Self::HubRate | Self::JointRate(_) => joint.rate_rad_s.clone(),
            Self::Tip | Self::TipX | Self::TipY => tip.displacement_m.clone(),
            Self::Velocity => tip.velocity_m_s.clone(),
            Self::Acceleration => tip.acceleration_m_s2.clone(),
            Self::TipDeflection => played.tip_deflection_m(),
            Self::Torque | Self::JointTorque(_) => joint.torque_n_m.clone(),
        })
    }
}

impl From<SimulatedChannel> for String {
    fn from(channel: SimulatedChannel) -> Self {
        channel.name()
    }
}

impl TryFrom<String> for SimulatedChannel {
    type Error = UnknownChannel;

    fn try_from(name: String) -> Result<Self, UnknownChannel> {
        Self::of_name(&name).ok_or(UnknownChannel(name))
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
