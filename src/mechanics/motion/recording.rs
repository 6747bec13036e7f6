//! Quality of the samples of a recorded motion, and their errors as noise of the tip's displacement over frequency.
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

/// Distance from the rest, in standard deviations of the noise, above which a sample has left it.
const BEYOND_NOISE: f64 = 5.0;

/// Distance up to which a departure is followed: relative to the least distance beyond the noise, and relative to the
/// largest distance.
const FOLLOWED: f64 = 16.0;
const OF_TRAVEL: f64 = 0.25;

/// Fewest samples that show how a tip leaves its rest.
const FEWEST_ON_WAY: usize = 4;

/// Powers of time with which a tip leaves its rest: the acceleration, or a derivative of it, jumps.
const POWERS: [f64; 3] = [2.0, 3.0, 4.0];

/// Kind of the samples' uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Uncertainty {
    /// Displacements are rounded to a number of decimals in the unit of their file.
    Rounded {
        /// Number of decimals; negative for tens, hundreds, ….
        decimals: i32,
        /// The last decimal in m: each sample is off by up to half of it.
        step_m: f64,
    },
    /// Displacements have noise that is independent from sample to sample.
    Noisy {
        /// Standard deviation in m.
        deviation_m: f64,
        /// Largest distance in m by which the rests at the ends were moved to their means.
        moved_m: f64,
    },
    /// Velocities or accelerations are rounded, and then integrated.
    Integrated {
        /// Number of integrations: 1 or 2.
        times: i32,
        /// Number of decimals in the unit of their file.
        decimals: i32,
        /// The last decimal in m/s or m/s².
        step: f64,
    },
}

/// Quality of a motion's samples. By default they are exact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Recording {
    /// Uncertainty of displacements; `None` if it is too small to matter.
    pub uncertainty: Option<Uncertainty>,
    /// Largest distance of a time from the uniform grid, in steps, if the samples were taken between the grid's times
    /// and interpolated.
    pub jitter: Option<f64>,
    /// Number of samples replaced by a value from their neighbours.
    pub dropped: usize,
    /// True if a velocity column alone shows that the tip moves at the ends.
    pub moves_by_column: bool,
    /// Cut-off in rad/s chosen by the user; `None` for the cut-off that the tip needs.
    pub lowpass_rad_s: Option<f64>,
    /// Mean time in s between recorded samples, if they are interpolated.
    pub spacing_s: Option<f64>,
    /// Standard deviation in m/s of a velocity column besides the column of the motion.
    pub velocity_m_s: Option<f64>,
    /// Errors of the motion between recorded samples.
    pub between: Between,
    /// Direction in rad of the chord, from the axis to the tip, at displacement 0, if the samples are angles of a link
    /// with gravity.
    pub start_angle_rad: Option<f64>,
}

/// Errors of a motion between recorded samples, 0 by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Between {
    /// Standard deviation of the displacement in m, independent between samples.
    pub spline_m: f64,
    /// Error in m of the displacement as a whole, if it is an integral.
    pub displacement_m: f64,
    /// Error of the velocity in m/s.
    pub velocity_m_s: f64,
    /// Standard deviation of the acceleration in m/s².
    pub acceleration_m_s2: f64,
}

impl Between {
    /// The larger of each error in two records.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            spline_m: self.spline_m.max(other.spline_m),
            displacement_m: self.displacement_m.max(other.displacement_m),
            velocity_m_s: self.velocity_m_s.max(other.velocity_m_s),
            acceleration_m_s2: self.acceleration_m_s2.max(other.acceleration_m_s2),
        }
    }

    fn scaled(self, distance: f64, duration: f64) -> Self {
        let distance = distance.abs();
        Self {
            spline_m: distance * self.spline_m,
            displacement_m: distance * self.displacement_m,
            velocity_m_s: distance / duration * self.velocity_m_s,
            acceleration_m_s2: distance / duration.powi(2) * self.acceleration_m_s2,
        }
    }
}

impl Uncertainty {
    /// Number of integrations from the samples to displacements.
    pub fn times(&self) -> i32 {
        if let Self::Integrated { times, .. } = self { *times } else { 0 }
    }

    /// Standard deviation of a sample in m, m/s or m/s². Rounding errors are evenly distributed over one step.
    pub fn deviation(&self) -> f64 {
        match self {
            Self::Rounded { step_m: step, .. } | Self::Integrated { step, .. } => {
                step / 12.0_f64.sqrt()
            }
            Self::Noisy { deviation_m, .. } => *deviation_m,
        }
    }

    /// Distance in m within which a motion can follow `samples` displacements: the largest error of a sample, and √3
    /// standard deviations for the part of the motion that the cut-off removes. For rounding this is one step; the
    /// largest of n normal errors is √(2 ln n) deviations. It is 0 for integrated samples, which are followed by their
    /// frequencies.
    pub fn tolerance_m(&self, samples: usize) -> f64 {
        match self {
            Self::Rounded { step_m, .. } => *step_m,
            Self::Integrated { .. } => 0.0,
            Self::Noisy { deviation_m, .. } => {
                let largest = (2.0 * libm::log(samples.max(2) as f64)).sqrt();
                (largest + 3.0_f64.sqrt()) * deviation_m
            }
        }
    }

    fn scaled(self, distance: f64, duration: f64) -> Self {
        let distance = distance.abs();
        match self {
            Self::Rounded { decimals, step_m } => {
                Self::Rounded { decimals, step_m: distance * step_m }
            }
            Self::Noisy { deviation_m, moved_m } => {
                let [deviation_m, moved_m] = [deviation_m, moved_m].map(|x| distance * x);
                Self::Noisy { deviation_m, moved_m }
            }
            Self::Integrated { times, decimals, step } => {
                Self::Integrated { times, decimals, step: distance / duration.powi(times) * step }
            }
        }
    }
}

impl Recording {
    /// Standard deviation of a sample in m, m/s or m/s²; 0 for exact samples.
    pub fn deviation(&self) -> f64 {
        self.uncertainty.map_or(0.0, |own| own.deviation())
    }

    /// The coarser quality of two coordinates, with the larger move of their rests.
    pub(super) fn coarser(self, other: Self) -> Self {
        let mut coarser = if other.deviation() < self.deviation() { self } else { other };
        let moves = [self, other].map(|own| match own.uncertainty {
            Some(Uncertainty::Noisy { moved_m, .. }) => moved_m,
            _ => 0.0,
        });
        if let Some(Uncertainty::Noisy { moved_m, .. }) = &mut coarser.uncertainty {
            *moved_m = moves[0].max(moves[1]);
        }
        coarser
    }

    /// Multiplies displacements and duration by these factors.
    pub(super) fn scaled(self, distance: f64, duration: f64) -> Self {
        Self {
            uncertainty: self.uncertainty.map(|own| own.scaled(distance, duration)),
            between: self.between.scaled(distance, duration),
            spacing_s: self.spacing_s.map(|own| duration * own),
            velocity_m_s: self.velocity_m_s.map(|own| distance.abs() / duration * own),
            lowpass_rad_s: self.lowpass_rad_s.map(|own| own / duration),
            ..self
        }
    }

    /// Numbers of the last sample at rest before a motion and of the first one after it, if noise decides them.
    pub(super) fn moving_samples(&self, places_m: &[f64]) -> Option<(usize, usize)> {
        match self.uncertainty? {
            Uncertainty::Noisy { deviation_m, .. } => moving_beyond_noise(places_m, deviation_m),
            Uncertainty::Rounded { .. } | Uncertainty::Integrated { .. } => None,
        }
    }
}

/// Numbers of the last sample at rest before a motion and of the first one after it, for places in m with noise of this
/// standard deviation; `None` if they do not leave the noise.
///
/// The acceleration of noisy places does not show the rest. The place does: it exceeds the noise from some sample on.
/// Before it, the tip leaves its rest with a power of time, d ∝ (t − t₀)ⁿ; least squares over the following samples
/// give t₀ and n.
fn moving_beyond_noise(places_m: &[f64], deviation_m: f64) -> Option<(usize, usize)> {
    let last = places_m.len() - 1;
    let first = departure(places_m.iter().copied(), deviation_m)?;
    let end = departure(places_m.iter().rev().copied(), deviation_m)?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of a sample"
    )]
    let [first, end] = [first, end].map(|at| at.max(0.0) as usize);
    (first + end < last).then_some((first, last - end))
}

/// Time at which places leave the first one, in steps from it.
fn departure(places_m: impl Iterator<Item = f64> + Clone, deviation_m: f64) -> Option<f64> {
    let rest_m = places_m.clone().next()?;
    let distances = places_m.map(|place| (place - rest_m).abs());
    let farthest_m = distances.clone().fold(0.0, f64::max);
    let least_m = BEYOND_NOISE * deviation_m;
    let most_m = (FOLLOWED * least_m).min(OF_TRAVEL * farthest_m);
    let first = distances.clone().position(|distance| distance > least_m)?;
    let way = distances.enumerate().skip(first).take_while(|(_, distance)| *distance <= most_m);
    let way: Vec<(f64, f64)> = way.map(|(k, distance)| (k as f64, distance)).collect();
    let before = first as f64 - 1.0;
    if way.len() < FEWEST_ON_WAY {
        return Some(before);
    }
    let fits = POWERS.map(|power| departure_with(&way, power));
    let (_, start) = fits.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(start.min(before))
}

/// Sum of squared residuals, in m², of distances that grow with a power of time, and the time at which they are 0.
fn departure_with(way: &[(f64, f64)], power: f64) -> (f64, f64) {
    // An error of the distance d causes d^(1/n − 1)/n times this error in its root.
    let rooted = way.iter().map(|(at, distance)| {
        let root = libm::pow(*distance, power.recip());
        (*at, root, (power * distance / root).powi(2))
    });
    let sum = |of: &dyn Fn((f64, f64, f64)) -> f64| rooted.clone().map(of).sum::<f64>();
    let all = sum(&|(_, _, weight)| weight);
    let at = sum(&|(at, _, weight)| weight * at) / all;
    let root = sum(&|(_, root, weight)| weight * root) / all;
    let slope = sum(&|(own, y, weight)| weight * (own - at) * (y - root))
        / sum(&|(own, _, weight)| weight * (own - at).powi(2));
    let left = sum(&|(own, y, weight)| weight * (y - root - slope * (own - at)).powi(2));
    if slope > 0.0 { (left, at - root / slope) } else { (f64::INFINITY, f64::INFINITY) }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noisy_tip_leaves_its_rest_when_the_exact_one_does() {
        let septic = |u: f64| u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3));
        let quintic = |u: f64| u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        let bang = |u: f64| if u < 0.5 { 2.0 * u * u } else { 1.0 - 2.0 * (1.0 - u) * (1.0 - u) };
        let mut state = 1_u64;
        let mut part = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let motions: [fn(f64) -> f64; 3] = [septic, quintic, bang];
        for (motion, power) in motions.into_iter().zip([4, 3, 2]) {
            for (deviation_m, most_steps) in [(1e-6, 4), (2e-5, 7), (4e-4, 14)] {
                for _ in 0..20 {
                    let mut noisy = |k: usize| {
                        let radius = (-2.0 * libm::log(part().max(1e-300))).sqrt();
                        let noise = radius * libm::cos(TAU * part());
                        motion((k as f64 / 200.0 - 0.5).clamp(0.0, 1.0)) + deviation_m * noise
                    };
                    let mut places_m: Vec<f64> = (0..=400).map(&mut noisy).collect();
                    (places_m[0], places_m[400]) = (0.0, 1.0);
                    let (first, last) = moving_beyond_noise(&places_m, deviation_m).unwrap();
                    let off = first.abs_diff(100).max(last.abs_diff(300));
                    assert!(off <= most_steps, "power {power}, {deviation_m}: {first}, {last}");
                }
            }
        }
        assert_eq!(moving_beyond_noise(&[0.0, 1e-3, -1e-3, 0.0], 1e-3), None);
    }
}
