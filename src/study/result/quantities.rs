//! The quantities of a joint: the one list that summary.json, sweeps and limits read.

use super::metrics::JointMetrics;

/// A number of each joint, its link or its motor.
#[derive(Debug, Clone, Copy)]
pub struct JointQuantity {
    /// Its name in two parts; columns of arms insert the joint's number: `peak_torque`, `_n_m`.
    pub name: (&'static str, &'static str),
    /// True for a number of the motor.
    pub is_of_motor: bool,
    /// True if sweeps have a column for it.
    pub is_swept: bool,
    /// Key of its limit in `[limits]`.
    pub limit: Option<&'static str>,
    /// Reads the number; `None` for a motion without it.
    pub of: fn(&JointMetrics) -> Option<f64>,
}

/// All quantities of a joint, in the order of summary.json.
pub const QUANTITIES: [JointQuantity; 17] = [
    of_joint(("peak_torque", "_n_m"), |own| Some(own.peak_torque_n_m.value)).limited("torque"),
    of_joint(("peak_torque_time", "_s"), |own| Some(own.peak_torque_n_m.time_s)).not_swept(),
    of_joint(("rms_torque", "_n_m"), |own| Some(own.rms_torque_n_m)).limited("rms_torque"),
    of_joint(("peak_rigid_torque", "_n_m"), |own| Some(own.peak_rigid_torque_n_m.value)),
    of_joint(("torque_ratio", ""), |own| Some(own.torque_ratio)),
    of_joint(("lead", "_s"), |own| own.lead_s),
    of_joint(("lag", "_s"), |own| own.lag_s),
    of_joint(("peak_hub_angle", "_rad"), |own| Some(own.peak_hub_angle_rad.value)).not_swept(),
    of_joint(("peak_hub_rate", "_rad_s"), |own| Some(own.peak_hub_rate_rad_s.value))
        .limited("hub_rate"),
    of_joint(("peak_power", "_w"), |own| Some(own.peak_power_w.value)).limited("power"),
    of_joint(("peak_root_moment", "_n_m"), |own| Some(own.peak_root_moment_n_m.value))
        .limited("bending_moment"),
    of_joint(("peak_deflection", "_m"), |own| Some(own.peak_deflection_m.value))
        .limited("deflection"),
    of_motor(("peak_motor_torque", "_n_m"), |own| Some(own.motor?.peak_torque_n_m.value))
        .limited("motor_torque"),
    of_motor(("peak_motor_torque_time", "_s"), |own| Some(own.motor?.peak_torque_n_m.time_s))
        .not_swept(),
    of_motor(("rms_motor_torque", "_n_m"), |own| Some(own.motor?.rms_torque_n_m))
        .limited("motor_rms_torque"),
    of_motor(("peak_motor_rate", "_rad_s"), |own| Some(own.motor?.peak_rate_rad_s.value))
        .limited("motor_rate"),
    of_motor(("peak_motor_power", "_w"), |own| Some(own.motor?.peak_power_w.value))
        .limited("motor_power"),
];

const fn of_joint(
    name: (&'static str, &'static str),
    of: fn(&JointMetrics) -> Option<f64>,
) -> JointQuantity {
    JointQuantity { name, is_of_motor: false, is_swept: true, limit: None, of }
}

const fn of_motor(
    name: (&'static str, &'static str),
    of: fn(&JointMetrics) -> Option<f64>,
) -> JointQuantity {
    JointQuantity { is_of_motor: true, ..of_joint(name, of) }
}

impl JointQuantity {
    const fn limited(self, key: &'static str) -> Self {
        Self { limit: Some(key), ..self }
    }

    const fn not_swept(self) -> Self {
        Self { is_swept: false, ..self }
    }

    /// Its column in a sweep, for a joint with its number from 1: `peak_torque2_n_m`.
    pub fn column(&self, joint: Option<usize>) -> String {
        let number = joint.map(|joint| joint.to_string()).unwrap_or_default();
        format!("{}{number}{}", self.name.0, self.name.1)
    }
}

impl JointMetrics {
    /// The numbers by the keys of summary.json; null for a motion without the number.
    pub fn by_name(&self) -> serde_json::Map<String, serde_json::Value> {
        let quantities = QUANTITIES.iter().filter(|own| self.motor.is_some() || !own.is_of_motor);
        quantities.map(|own| (own.column(None), (own.of)(self).into())).collect()
    }
}
