use crate::link::ParameterError;

/// How exact the answer must be and how much time around the motion it covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Analysis {
    tolerance: f64,
    lead_s: Option<f64>,
    lag_s: Option<f64>,
    modes: Option<usize>,
}

impl Analysis {
    /// Share of the peak torque that padding and wrap-around may cost.
    pub const DEFAULT_TOLERANCE: f64 = 1e-6;

    /// Checks the ranges: `tolerance` in [1e-12, 1e-2], lead and lag at least 0 s.
    ///
    /// # Errors
    /// [`ParameterError`] names the first value out of its range.
    pub fn new(
        tolerance: f64,
        lead_s: Option<f64>,
        lag_s: Option<f64>,
    ) -> Result<Self, ParameterError> {
        if !(1e-12..=1e-2).contains(&tolerance) {
            let must = "must lie in [1e-12, 1e-2]";
            return Err(ParameterError::new("analysis.tolerance", tolerance, "", must));
        }
        for (parameter, value) in [("analysis.lead", lead_s), ("analysis.lag", lag_s)] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v >= 0.0)) {
                let must = "must be finite and at least 0";
                return Err(ParameterError::new(parameter, value, "s", must));
            }
        }
        Ok(Self { tolerance, lead_s, lag_s, modes: None })
    }

    /// Flexible modes to keep; `None`: all of the mesh.
    pub fn modes(&self) -> Option<usize> {
        self.modes
    }

    /// Share of the peak torque that padding and wrap-around may cost.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Time to add before the trajectory's first sample in s; `None`: as much as needed.
    pub fn lead_s(&self) -> Option<f64> {
        self.lead_s
    }

    /// Time to add after the trajectory's last sample in s; `None`: as much as needed.
    pub fn lag_s(&self) -> Option<f64> {
        self.lag_s
    }
}

impl Default for Analysis {
    fn default() -> Self {
        Self { tolerance: Self::DEFAULT_TOLERANCE, lead_s: None, lag_s: None, modes: None }
    }
}
