//! The errors of a recording's samples as noise of the tip's displacement over frequency.
//!
//! Errors that are independent from sample to sample have a constant density over frequency, `σ² h` with the standard
//! deviation σ and the time h between two errors. Errors of a velocity are integrated once, of an acceleration twice,
//! so that the displacement has the density
//!
//! ```text
//! S(ω) = σ² h / ω^(2n),   n = 0, 1, 2
//! ```
//!
//! and its error grows with the duration of the motion. A slow signal changes by less than its last decimal from one
//! sample to the next. Its errors are equal until it has changed by one decimal, and h is the time for this change.

use std::f64::consts::{PI, TAU};

use super::recording::Between;

/// Uncertainty of the samples over the travel above which it is reported although all frequencies are solved.
pub(super) const UNCERTAIN: f64 = 1e-6;

/// The errors of a motion's samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of a sample in m, m/s or m/s².
    pub(super) deviation: f64,
    /// Number of integrations from the samples to displacements.
    pub(super) times: i32,
    /// Time in s between independent errors.
    pub(super) spacing_s: f64,
    /// Step of the samples in s.
    pub(super) step_s: f64,
    /// Standard deviation in m/s between a velocity before or after the motion and the samples' velocity.
    pub(super) ends_m_s: f64,
    /// Time in s between recorded samples.
    pub(super) recorded_s: f64,
    /// Errors of the motion between recorded samples.
    pub(super) between: Between,
    /// Duration of the motion in s.
    pub(super) lasts_s: f64,
    /// Standard deviation of the tip's end position in m.
    pub(super) travel_m: f64,
    /// Standard deviation of the tip during the motion in m.
    pub(super) tip_m: f64,
    /// Ratio of the largest error to the standard deviation, with √3 added for the part of the motion that the cut-off
    /// removes.
    pub(super) largest: f64,
    /// Distance in m within which displacements are followed.
    pub(super) sampled_m: f64,
}

impl Noise {
    /// Standard deviation of the tip's end position in m.
    pub(super) fn travel_m(&self) -> f64 {
        self.travel_m
    }

    /// Expected amplitude of the displacement in m at a frequency of a period of `len` samples.
    pub(super) fn amplitude_m(&self, omega_rad_s: f64, len: usize) -> f64 {
        // Equal errors have no high frequencies.
        let alike = (TAU / (self.spacing_s * omega_rad_s)).min(1.0).powi(2);
        let steps = (self.spacing_s / self.step_s * alike).max(1.0);
        let of_sample = self.deviation * steps.sqrt() / (len as f64).sqrt();
        // Below π over its duration, a finite motion has no more error than at that frequency.
        let omega = omega_rad_s.max(PI / self.lasts_s);
        let integrated_m = of_sample / omega.powi(self.times);
        let of_velocity = (omega / (PI * len as f64 * self.step_s)).sqrt() / omega.powi(2);
        let squared_m_s = self.ends_m_s.powi(2) + self.between.velocity_m_s.powi(2);
        let smooth = (TAU / (self.recorded_s * omega_rad_s)).min(1.0).powi(4);
        let of_recorded = (self.recorded_s / self.step_s / len as f64).sqrt();
        let of_spline_m = self.between.spline_m * smooth * of_recorded;
        let of_acceleration_m = self.between.acceleration_m_s2 / omega.powi(2) * of_recorded;
        let squared_m = integrated_m.powi(2)
            + squared_m_s * of_velocity.powi(2)
            + of_spline_m.powi(2)
            + of_acceleration_m.powi(2);
        squared_m.sqrt()
    }

    /// Distance in m within which samples can be followed with a cut-off.
    pub(super) fn followed_m(&self, omega_rad_s: f64) -> f64 {
        let beyond_m = |squared: f64| self.largest * (squared / PI).sqrt();
        let of_samples_m = match self.times {
            0 => self.sampled_m,
            times => {
                let power = 2 * times - 1;
                let density = self.deviation.powi(2) * self.spacing_s;
                beyond_m(density / (f64::from(power) * omega_rad_s.powi(power)))
            }
        };
        let of_ends_m = beyond_m((self.ends_m_s / omega_rad_s).powi(2) / (3.0 * PI));
        (of_samples_m * of_samples_m + of_ends_m * of_ends_m).sqrt()
    }

    /// Estimate of the tip's largest error in m.
    pub(super) fn largest_m(&self) -> f64 {
        self.sampled_m.max(self.largest * self.tip_m)
    }

    /// Largest common error of all samples in m: at rest they share the error of one sample.
    pub(super) fn offset_m(&self) -> f64 {
        0.5 * self.sampled_m
    }

    /// True if the motion has errors between its samples.
    pub(super) fn is_between(&self) -> bool {
        self.between != Between::default()
    }
}
