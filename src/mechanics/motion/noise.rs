//! The errors of a recording's samples as noise of the tip's displacement over frequency.
//!
//! Errors that are independent from sample to sample have a constant density over frequency, `σ² h` with the standard
//! deviation σ and the time h between two of them. Those of a velocity are integrated once, those of an acceleration
//! twice, so that the displacement has the density
//!
//! ```text
//! S(ω) = σ² h / ω^(2n),   n = 0, 1, 2
//! ```
//!
//! and its error grows with the duration of the motion. A slow signal crosses less than one of its last decimals from
//! one sample to the next: its errors are alike until it has crossed one, and h is the time that this takes.

use std::f64::consts::{PI, TAU};

use super::recording::Between;

/// Uncertainty of the samples, over the travel, from which on it is reported if every frequency is solved.
pub(super) const UNCERTAIN: f64 = 1e-6;

/// The errors of a motion's samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of a sample in m, m/s or m/s².
    pub(super) deviation: f64,
    /// How often the samples are integrated.
    pub(super) times: i32,
    /// Time in s between independent errors.
    pub(super) spacing_s: f64,
    /// Step of the samples in s.
    pub(super) step_s: f64,
    /// Standard deviation in m/s of a velocity before or after the motion that does not fit the samples.
    pub(super) ends_m_s: f64,
    /// Time in s between the samples that were recorded.
    pub(super) recorded_s: f64,
    /// What the motion may be off by between them.
    pub(super) between: Between,
    /// Duration of the motion in s.
    pub(super) lasts_s: f64,
    /// Standard deviation of where the tip ends in m.
    pub(super) travel_m: f64,
    /// The same of the tip on its way.
    pub(super) tip_m: f64,
    /// Largest error over the standard deviation, and √3 for what the cut-off leaves out of the motion itself.
    pub(super) largest: f64,
    /// Distance in m within which displacements are followed.
    pub(super) sampled_m: f64,
}

impl Noise {
    /// Standard deviation of where the tip ends in m.
    pub(super) fn travel_m(&self) -> f64 {
        self.travel_m
    }

    /// Expected amplitude of the displacement in m at a frequency of a period of `len` samples.
    pub(super) fn amplitude_m(&self, omega_rad_s: f64, len: usize) -> f64 {
        // Alike errors have no high frequencies.
        let alike = (TAU / (self.spacing_s * omega_rad_s)).min(1.0).powi(2);
        let steps = (self.spacing_s / self.step_s * alike).max(1.0);
        let of_sample = self.deviation * steps.sqrt() / (len as f64).sqrt();
        // Below its own frequency a motion that ends has no more than at that.
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

    /// Largest error of the tip in m, about.
    pub(super) fn largest_m(&self) -> f64 {
        self.sampled_m.max(self.largest * self.tip_m)
    }

    /// By how much all samples may be off alike in m: at rest they are, by as much as one of them at most.
    pub(super) fn offset_m(&self) -> f64 {
        0.5 * self.sampled_m
    }

    /// True if the motion is not known between its samples.
    pub(super) fn is_between(&self) -> bool {
        self.between != Between::default()
    }
}
