use thiserror::Error;

use super::metrics::Metrics;
use crate::link::ParameterError;

/// What a link and its motor stand. Absent values are no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Torque at the hub in N m.
    pub torque_n_m: Option<f64>,
    /// Root mean square of the torque in N m while it acts.
    pub rms_torque_n_m: Option<f64>,
    /// Hub rate in rad/s.
    pub hub_rate_rad_s: Option<f64>,
    /// Mechanical power at the hub in W.
    pub power_w: Option<f64>,
    /// Deflection of the tip from the hub's tangent line in m.
    pub deflection_m: Option<f64>,
    /// Moment at the link's root in N m.
    pub bending_moment_n_m: Option<f64>,
}

/// A limit that a solution exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("limits.{key} = {limit} {unit} is exceeded: {found:.4e} {unit}")]
pub struct Exceeded {
    /// Key of the limit in the link file.
    pub key: &'static str,
    /// The limit.
    pub limit: f64,
    /// What the solution reaches.
    pub found: f64,
    /// Unit of both.
    pub unit: &'static str,
}

impl Exceeded {
    /// Name of the kind of warning that it is, for machines.
    pub const KIND: &'static str = "limit_exceeded";

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "a slower motion, a stronger motor or a stiffer link"
    }
}

impl Limits {
    /// Checks that every limit is finite and above 0.
    ///
    /// # Errors
    /// [`ParameterError`] names the first that is not.
    pub fn check(self) -> Result<Self, ParameterError> {
        for (key, limit, unit) in self.entries() {
            if let Some(limit) = limit.filter(|limit| !limit.is_finite() || *limit <= 0.0) {
                let parameter = format!("limits.{key}");
                let must = "must be finite and above 0";
                return Err(ParameterError::new(parameter, limit, unit, must));
            }
        }
        Ok(self)
    }

    /// The limits that a solution exceeds, in the order of the link file.
    pub fn exceeded(&self, metrics: &Metrics) -> Vec<Exceeded> {
        let found = [
            metrics.peak_torque_n_m.value,
            metrics.rms_torque_n_m,
            metrics.peak_hub_rate_rad_s.value,
            metrics.peak_power_w.value,
            metrics.peak_deflection_m.value,
            metrics.peak_root_moment_n_m.value,
        ];
        let pairs = self.entries().into_iter().zip(found);
        pairs
            .filter_map(|((key, limit, unit), found)| Some((key, limit?, unit, found)))
            .filter(|(_, limit, _, found)| found > limit)
            .map(|(key, limit, unit, found)| Exceeded { key, limit, found, unit })
            .collect()
    }

    fn entries(&self) -> [(&'static str, Option<f64>, &'static str); 6] {
        [
            ("torque", self.torque_n_m, "N m"),
            ("rms_torque", self.rms_torque_n_m, "N m"),
            ("hub_rate", self.hub_rate_rad_s, "rad/s"),
            ("power", self.power_w, "W"),
            ("deflection", self.deflection_m, "m"),
            ("bending_moment", self.bending_moment_n_m, "N m"),
        ]
    }
}
