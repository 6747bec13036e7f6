//! Motion of the tip over a period.

use std::sync::OnceLock;

use num_complex::Complex64;

use super::error::MotionError;
use super::images::Images;
use super::recording::Noise;
use super::samples::{Ends, Samples, Source};
use super::spectrum::{Cutoff, InputBand, TipSpectrum};
use crate::numeric::{fast_length, largest};

/// Largest difference of two columns over the peak of one.
const AGREEMENT_TOLERANCE: f64 = 1e-3;

/// A motion on a period, up to a cut-off: everything that does not depend on the link.
pub(crate) struct TipPeriod {
    /// Spectrum of the motion.
    pub spectrum: TipSpectrum,
    /// Histories of the motion.
    pub histories: TipHistories,
    samples: Samples,
    /// Images of the motion, computed on first use, because only hysteretic damping needs them.
    images: OnceLock<Images>,
}

impl TipPeriod {
    /// Computes spectrum and histories; arguments as for [`TipSpectrum::of`].
    pub(super) fn of(motion: &Samples, len: usize, seam: usize, cutoff: Cutoff) -> Self {
        Self::with(motion, TipSpectrum::of(motion, len, seam, cutoff))
    }

    fn with(motion: &Samples, spectrum: TipSpectrum) -> Self {
        let histories = TipHistories::of(motion, &spectrum);
        Self { spectrum, histories, samples: motion.clone(), images: OnceLock::new() }
    }

    /// A period whose tip moves only by the samples' errors, up to the same cut-off, with the expected amplitude at
    /// each frequency.
    pub(crate) fn of_noise(&self, noise: &Noise) -> Self {
        Self::with(&self.samples, self.spectrum.of_noise(noise))
    }

    /// Parts of the tip's motion beyond the band of uncertain samples, see [`TipSpectrum::beyond`].
    pub(crate) fn beyond(&self, input: &InputBand) -> Self {
        Self {
            histories: self.histories.clone(),
            spectrum: self.spectrum.beyond(input),
            samples: self.samples.clone(),
            images: OnceLock::new(),
        }
    }

    /// A possible error of the samples as displacement in m, with its rate and acceleration; see
    /// [`TipSpectrum::possible_error_m`].
    pub(crate) fn possible_error(
        &self,
        input: &InputBand,
        passes: (usize, f64),
        draw: &mut dyn FnMut() -> f64,
    ) -> [Vec<f64>; 3] {
        let spectrum = &self.spectrum;
        let error_m = spectrum.possible_error_m(input, passes, draw);
        [0, 1, 2].map(|order| spectrum.pair.samples(spectrum.derivative(&error_m, order)))
    }

    /// Contributions of the motion in all other periods to signals with a slow tail.
    pub(crate) fn images(&self) -> &Images {
        self.images.get_or_init(|| Images::new(&self.spectrum, self.samples.forcing_m_s2()))
    }

    /// Velocities in m/s before and after a motion that moves at its ends; 0 for any other.
    pub(crate) fn end_velocities_m_s(&self) -> [f64; 2] {
        if self.samples.ends == Ends::Moving { self.samples.velocities_m_s } else { [0.0; 2] }
    }

    /// Error of the solved tip in m: the part that the cut-off removes or, if all frequencies are kept, the ringing at
    /// the Nyquist frequency.
    pub(crate) fn tip_error_m(&self) -> f64 {
        let cutoff = &self.spectrum.cutoff;
        if !cutoff.keeps_all() {
            return cutoff.tip_error_m;
        }
        // A cycle has no rest to ring in: the solution meets its samples.
        let is_periodic = self.samples.ends == Ends::Periodic;
        if is_periodic { 0.0 } else { self.histories.ringing_m() }
    }
}

/// Motion of the tip over a period of N samples; sample 0 is the trajectory's first.
#[derive(Debug, Clone, PartialEq)]
pub struct TipHistories {
    /// Acceleration in m/s².
    pub acceleration_m_s2: Vec<f64>,
    /// Velocity in m/s.
    pub velocity_m_s: Vec<f64>,
    /// Displacement in m. Samples from `before` on precede the trajectory.
    pub displacement_m: Vec<f64>,
    /// The first sample whose time is one period earlier.
    pub before: usize,
    /// Number of the sample at which the motion starts, and number of samples from sample 0 on that count as travel.
    /// For a tip that moves on beyond its ends only the input samples count, for a periodic motion one cycle.
    start: usize,
    counted: usize,
}

impl TipHistories {
    /// If all frequencies are kept, the input samples stay unchanged; all else is the band-limited integral or
    /// derivative. The displacement is a ramp of the mean velocity plus a periodic part, so that it may end elsewhere
    /// than it starts.
    fn of(motion: &Samples, spectrum: &TipSpectrum) -> Self {
        let (len, before) = (spectrum.pair.len(), spectrum.seam);
        let (velocity_m_s, drift) = velocity_m_s(spectrum, motion.velocities_m_s[0]);
        let band_limited = || spectrum.pair.samples(&spectrum.acceleration_m_s2);
        let initial_m = match motion.ends {
            Ends::Moving => {
                motion.initial_displacement_m + motion.velocities_m_s[0] * since_s(spectrum, before)
            }
            _ => motion.initial_displacement_m,
        };
        let integrated = || integrated_displacement_m(initial_m, spectrum, &drift);
        let (acceleration_m_s2, displacement_m) = match &*motion.source {
            _ if !spectrum.cutoff.keeps_all() => (band_limited(), integrated()),
            Source::Acceleration(_) => (motion.forcing_over_m_s2(len), integrated()),
            Source::Displacement { samples, .. } => {
                (band_limited(), motion.displacement_over_m(samples, len, before))
            }
        };
        let (start, counted) = match motion.ends {
            Ends::AtRest => (before % len, len),
            Ends::Moving | Ends::Periodic => (0, motion.grid.len),
        };
        Self { acceleration_m_s2, velocity_m_s, displacement_m, before, start, counted }
    }

    /// Displacement in m at the start of the rest before the motion, or at its first sample if it has no rest.
    pub fn start_m(&self) -> f64 {
        self.displacement_m[self.start]
    }

    /// True if the displacement of a sample counts as travel.
    pub(crate) fn counts(&self, sample: usize) -> bool {
        sample < self.counted
    }

    /// Amplitude in m of the part that alternates from sample to sample in the middle of the rest, because the spectrum
    /// ends at the Nyquist frequency.
    fn ringing_m(&self) -> f64 {
        let all = &self.displacement_m;
        let rest = all.get(self.before..self.before + 3);
        let rest = rest.or_else(|| all.get(self.before.checked_sub(3)?..self.before));
        rest.map_or(0.0, |rest| 0.25 * (rest[0] - 2.0 * rest[1] + rest[2]).abs())
    }

    /// Largest displacement in m from the start.
    pub fn largest_travel_m(&self) -> f64 {
        farthest_m(self.start_m(), &self.displacement_m[..self.counted])
    }
}

/// Motion of the tip over the grid of a result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipMotionHistories {
    /// Displacement along the arc in m.
    pub displacement_m: Vec<f64>,
    /// Velocity in m/s.
    pub velocity_m_s: Vec<f64>,
    /// Acceleration in m/s².
    pub acceleration_m_s2: Vec<f64>,
}

impl TipMotionHistories {
    /// Largest displacement in m from the first sample.
    pub fn largest_travel_m(&self) -> f64 {
        self.displacement_m
            .first()
            .map_or(0.0, |start_m| farthest_m(*start_m, &self.displacement_m))
    }
}

/// Largest distance in m from a start.
pub(super) fn farthest_m(start_m: f64, displacement_m: &[f64]) -> f64 {
    displacement_m.iter().fold(0.0, |most, at_m| most.max((at_m - start_m).abs()))
}

/// Refuses columns of velocity and displacement that contradict the column of the motion.
pub(super) fn check_agreement(
    motion: &Samples,
    [velocity, displacement]: [Option<&[f64]>; 2],
    other: &'static str,
) -> Result<(), MotionError> {
    if velocity.is_none() && displacement.is_none() {
        return Ok(());
    }
    let given = motion.grid.len;
    let (len, seam) = motion.cycles().map_or_else(
        || {
            let len = fast_length(2 * given);
            (len, len - given / 2)
        },
        |len| (len, len),
    );
    let tip = TipPeriod::of(motion, len, seam, Cutoff::ALL).histories;
    let [a, v, d] = [&tip.acceleration_m_s2, &tip.velocity_m_s, &tip.displacement_m];
    for (column, unit, found, expected, derivative) in
        [("velocity", "m/s", velocity, v, a), ("displacement", "m", displacement, d, v)]
    {
        let Some(found) = found else { continue };
        let off = |k: &usize| (found[*k] - expected[*k]).abs();
        let nearer = |a: &usize, b: &usize| off(a).total_cmp(&off(b));
        let sample = (0..given).max_by(nearer).unwrap_or(0);
        let away = expected[..given].iter().map(|x| (x - expected[0]).abs());
        let peak = away.fold(0.0, f64::max);
        // The time of a jump of the derivative is only known to one step.
        let jump = largest(&derivative[..given]) * motion.grid.step_s;
        if off(&sample) > AGREEMENT_TOLERANCE * peak + jump {
            let (found, expected) = (found[sample], expected[sample]);
            return Err(MotionError::Disagree { sample, column, unit, found, expected, other });
        }
    }
    Ok(())
}

/// Time in s of a sample of a period; samples from the seam on are one period earlier.
fn since_s(spectrum: &TipSpectrum, sample: usize) -> f64 {
    let len = spectrum.pair.len();
    let steps = if sample < spectrum.seam { sample as f64 } else { sample as f64 - len as f64 };
    steps * spectrum.step_s
}

/// A periodic history in the middle of the rest before the motion. If all frequencies are kept, it rings at the Nyquist
/// frequency, which this mean cancels.
fn at_rest(periodic: &[f64], before: usize) -> f64 {
    let len = periodic.len();
    let begin = before % len;
    let [earlier, later] = [begin + len - 1, begin + 1].map(|k| periodic[k % len]);
    0.25 * (earlier + later) + 0.5 * periodic[begin]
}

/// Velocity of a tip that moves at its ends, without its periodic part: v = c + ā t.
struct Drift {
    /// c in m/s.
    velocity_m_s: f64,
    /// ā in m/s²: the change of the velocity over the period.
    acceleration_m_s2: f64,
}

/// Velocity in m/s over the period of a spectrum, and its drift; for a tip that moves at its ends it starts at
/// `before_m_s`.
fn velocity_m_s(spectrum: &TipSpectrum, before_m_s: f64) -> (Vec<f64>, Drift) {
    let mut periodic = spectrum.pair.samples(&spectrum.velocity_m_s);
    let Some(mean_m_s2) = spectrum.mean_m_s2 else {
        return (periodic, Drift { velocity_m_s: 0.0, acceleration_m_s2: 0.0 });
    };
    let begin_s = since_s(spectrum, spectrum.seam);
    let rest_m_s = at_rest(&periodic, spectrum.seam);
    let drift = Drift {
        velocity_m_s: before_m_s - mean_m_s2 * begin_s - rest_m_s,
        acceleration_m_s2: mean_m_s2,
    };
    for (k, velocity) in periodic.iter_mut().enumerate() {
        *velocity += drift.velocity_m_s + mean_m_s2 * since_s(spectrum, k);
    }
    (periodic, drift)
}

/// Displacement in m over the period of a spectrum, the integral of its velocity: `initial_m` at the start of the rest
/// before the motion or, without a rest, of the motion.
fn integrated_displacement_m(initial_m: f64, spectrum: &TipSpectrum, drift: &Drift) -> Vec<f64> {
    let (len, before) = (spectrum.pair.len(), spectrum.seam);
    let bins = spectrum.acceleration_m_s2.iter().zip(&spectrum.omegas_rad_s);
    let mut periodic: Vec<Complex64> = bins.map(|(a, omega)| -a / (omega * omega)).collect();
    periodic[0] = Complex64::ZERO;
    let periodic = spectrum.pair.samples(periodic);
    let ramp = (spectrum.velocity_m_s[0].re + drift.velocity_m_s) * spectrum.step_s;
    let bend = 0.5 * drift.acceleration_m_s2 * spectrum.step_s.powi(2);
    let steps = |j: usize| {
        if j < before { j as f64 } else { j as f64 - len as f64 }
    };
    let drifted = |j: usize| ramp * steps(j) + bend * steps(j).powi(2);
    let begin = before % len;
    let rest_m = spectrum.start_m.unwrap_or_else(|| at_rest(&periodic, before));
    let offset = initial_m - drifted(begin) - rest_m;
    (0..len).map(|j| offset + drifted(j) + periodic[j]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{MotionColumns, TipMotion};

    /// A step of the displacement by an error function: smooth, band-limited to round-off, from rest to rest, with all
    /// derivatives known.
    fn smooth(t: f64) -> [f64; 3] {
        let (s, pi) = ((t - 1.0) / 0.1, std::f64::consts::PI);
        let gauss = (-s * s).exp() / (0.1 * pi.sqrt());
        // A series for ∫gauss dt would be long; a fine Simpson sum is exact enough.
        let n = 4000;
        let h = t / f64::from(n);
        let g = |t: f64| (-((t - 1.0) / 0.1).powi(2)).exp() / (0.1 * pi.sqrt());
        let simpson: f64 = (0..n)
            .map(|k| {
                let a = f64::from(k) * h;
                (g(a) + 4.0 * g(a + 0.5 * h) + g(a + h)) * h / 6.0
            })
            .sum();
        [simpson, gauss, -2.0 * s / 0.1 * gauss]
    }

    fn samples() -> (Vec<f64>, [Vec<f64>; 3]) {
        let time_s: Vec<f64> = (0..201).map(|k| 0.01 * f64::from(k)).collect();
        let columns = [0, 1, 2].map(|d| time_s.iter().map(|t| smooth(*t)[d]).collect());
        (time_s, columns)
    }

    fn worst(found: &[f64], exact: &[f64]) -> f64 {
        found.iter().zip(exact).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
    }

    #[test]
    fn displacements_give_the_accelerations_of_a_smooth_motion_to_round_off() {
        let (time_s, [d, v, a]) = samples();
        let columns =
            MotionColumns { time_s, displacement_m: Some(d.clone()), ..Default::default() };
        let motion = TipMotion::new(columns).unwrap();
        for len in [202, 300, 512] {
            let found = motion.over_period(len, 201 + (len - 201) / 2, Cutoff::ALL).histories;
            // Round-off of the displacement, 1e-16, over the squared step.
            assert!(worst(&found.acceleration_m_s2, &a) < 1e-9, "{len} samples");
            assert!(worst(&found.velocity_m_s, &v) < 1e-11, "{len} samples");
            assert!(worst(&found.displacement_m, &d) < 1e-15, "{len} samples");
        }
    }

    #[test]
    fn accelerations_give_the_displacements_of_a_smooth_motion_to_round_off() {
        let (time_s, [d, v, a]) = samples();
        let columns =
            MotionColumns { time_s, acceleration_m_s2: Some(a.clone()), ..Default::default() };
        let motion = TipMotion::new(columns).unwrap();
        assert!((motion.travel_m() - 1.0).abs() < 1e-13);
        for len in [202, 300, 512] {
            let found = motion.over_period(len, 201 + (len - 201) / 2, Cutoff::ALL).histories;
            assert!(worst(&found.velocity_m_s, &v) < 1e-12, "{len} samples");
            assert!(worst(&found.displacement_m, &d) < 1e-12, "{len} samples");
            let last = found.displacement_m[len - 1];
            let expected = if found.before < len { 0.0 } else { 1.0 };
            assert!((last - expected).abs() < 1e-12, "the rest before the motion, {len} samples");
        }
    }

    #[test]
    fn a_derivative_multiplies_each_amplitude_by_its_own_rate() {
        let (time_s, [d, ..]) = samples();
        let columns = MotionColumns { time_s, displacement_m: Some(d), ..Default::default() };
        let spectrum = TipMotion::new(columns).unwrap().over_period(256, 230, Cutoff::ALL).spectrum;
        let derived = spectrum.derivative(&spectrum.velocity_m_s, 1);
        for (a, b) in derived.iter().zip(&spectrum.acceleration_m_s2).take(60) {
            assert!((a - b).norm() < 1e-14);
        }
    }
}
