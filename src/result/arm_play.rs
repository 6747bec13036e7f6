//! Numbers of an arm's simulation that a person reads first.

use serde::Serialize;

use super::limits::{Exceeded, Limits};
use crate::numeric::largest;
use crate::response::PlayedArm;

/// Numbers of an arm's simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArmPlayMetrics {
    /// Those of each joint, the inner one first.
    pub joints: Vec<PlayedJoint>,
    /// Largest distance of the tip from where it starts in m.
    pub way_m: f64,
    /// x and y of the tip at the last sample in m.
    pub final_tip_m: [f64; 2],
}

/// Numbers of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlayedJoint {
    /// Largest |T| of its motor in N m, feedback included.
    pub peak_torque_n_m: f64,
    /// Torque that holds the arm where it starts in N m.
    pub holding_torque_n_m: f64,
    /// Its angle at the first sample in rad.
    pub start_angle_rad: f64,
    /// At the last one.
    pub end_angle_rad: f64,
    /// Its largest rate in rad/s.
    pub peak_rate_rad_s: f64,
    /// Largest mechanical power |T φ̇| in W.
    pub peak_power_w: f64,
}

impl ArmPlayMetrics {
    /// The limits that a simulation exceeds, of those of torque, rate and power, with the number of the joint.
    pub fn exceeded(&self, limits: &[Limits]) -> Vec<(usize, Exceeded)> {
        let joints = self.joints.iter().zip(limits).enumerate();
        let of = |(number, (joint, limits)): (usize, (&PlayedJoint, &Limits))| {
            let exceeded = limits.exceeded_by(Limits {
                torque_n_m: Some(joint.peak_torque_n_m),
                hub_rate_rad_s: Some(joint.peak_rate_rad_s),
                power_w: Some(joint.peak_power_w),
                ..Limits::default()
            });
            exceeded.into_iter().map(move |exceeded| (number, exceeded))
        };
        joints.flat_map(of).collect()
    }

    /// Reads the numbers off a simulation.
    pub fn of(played: &PlayedArm) -> Self {
        let last = played.grid.len - 1;
        let joint = |(number, [angle, rate, _]): (usize, &[Vec<f64>; 3])| {
            let torque_n_m = &played.torques_n_m[number];
            let power: Vec<f64> = torque_n_m.iter().zip(rate).map(|(t, rate)| t * rate).collect();
            PlayedJoint {
                peak_torque_n_m: largest(torque_n_m),
                holding_torque_n_m: played.holding_n_m[number],
                start_angle_rad: angle[0],
                end_angle_rad: angle[last],
                peak_rate_rad_s: largest(rate),
                peak_power_w: largest(&power),
            }
        };
        Self {
            joints: played.joints.iter().enumerate().map(joint).collect(),
            way_m: played.way_m(),
            final_tip_m: [0, 1].map(|axis: usize| played.tip[axis][0][last]),
        }
    }
}
