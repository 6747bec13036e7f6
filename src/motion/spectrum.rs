use std::f64::consts::TAU;

use num_complex::Complex64;

use super::cutoff::Cutoff;
use super::histories::TipHistories;
use super::tip_motion::{Source, TipMotion};
use crate::numeric::{FourierPair, angular_frequency, largest, magnitude};

/// Amplitudes of the acceleration below this share of the largest carry nothing: they lie below the
/// round-off of a transform.
const BAND_TOLERANCE: f64 = 1e-15;

/// Places on either side of the seam.
const SEAM_PLACES: usize = 8;

/// Spectrum of the tip motion on a period of N samples; sample 0 is the trajectory's first.
///
/// Samples after the trajectory continue its rest; those from the seam on stand for the rest
/// before it.
#[derive(Clone)]
pub struct TipSpectrum {
    /// The Fourier pair of the period.
    pub pair: FourierPair,
    /// Step in s.
    pub step_s: f64,
    /// Amplitudes â of the acceleration in m/s², N/2 + 1 of them; the one at zero is 0.
    pub acceleration_m_s2: Vec<Complex64>,
    /// Amplitudes of the velocity in m/s: â/(iω), and at zero the mean over the period, travel over
    /// P.
    pub velocity_m_s: Vec<Complex64>,
    /// Angular frequency of every bin in rad/s (Bayo 1987, eq 13).
    pub omegas_rad_s: Vec<f64>,
    /// Magnitudes |â| in m/s².
    pub magnitudes_m_s2: Vec<f64>,
    /// The largest of them.
    pub largest_m_s2: f64,
    /// The sample from which on samples stand for times before the trajectory; N where none do.
    pub seam: usize,
    /// Up to which frequency the motion is followed.
    pub cutoff: Cutoff,
}

impl TipSpectrum {
    /// The spectrum with all that follows from its amplitudes alone.
    fn new(
        pair: FourierPair,
        step_s: f64,
        seam: usize,
        acceleration_m_s2: Vec<Complex64>,
        mean_velocity_m_s: f64,
    ) -> Self {
        let len = pair.len();
        let omegas = (0..acceleration_m_s2.len()).map(|k| angular_frequency(k, len, step_s));
        let omegas_rad_s: Vec<f64> = omegas.collect();
        let bins = acceleration_m_s2.iter().zip(&omegas_rad_s);
        let mut velocity_m_s: Vec<Complex64> =
            bins.map(|(a, omega)| Complex64::new(a.im / omega, -a.re / omega)).collect();
        velocity_m_s[0] = mean_velocity_m_s.into();
        let magnitudes_m_s2: Vec<f64> = acceleration_m_s2.iter().map(|a| magnitude(*a)).collect();
        let largest_m_s2 = largest(&magnitudes_m_s2);
        Self {
            pair,
            step_s,
            acceleration_m_s2,
            velocity_m_s,
            omegas_rad_s,
            magnitudes_m_s2,
            largest_m_s2,
            seam,
            cutoff: Cutoff::ALL,
        }
    }

    /// The same spectrum rolled off at a cut-off, nothing above it.
    #[must_use]
    pub fn up_to(self, cutoff: Cutoff) -> Self {
        if cutoff.keeps_all() {
            return self;
        }
        let weights = self.omegas_rad_s.iter().map(|omega| cutoff.weight(*omega));
        let bins = self.acceleration_m_s2.iter().zip(weights);
        let rolled_off = bins.map(|(a, weight)| a * weight).collect();
        let Self { pair, step_s, seam, velocity_m_s, .. } = self;
        Self { cutoff, ..Self::new(pair, step_s, seam, rolled_off, velocity_m_s[0].re) }
    }

    /// Period P in s.
    pub fn period_s(&self) -> f64 {
        self.pair.len() as f64 * self.step_s
    }

    /// Places around the seam at which the end of a decay is measured: samples of the period with their
    /// times in s, and the distance of two in s.
    pub fn around_seam(&self) -> (Vec<(usize, f64)>, f64) {
        let len = self.pair.len();
        let stride = (self.seam_reach() / SEAM_PLACES).max(1);
        let first = len + self.seam - SEAM_PLACES * stride;
        let place = |place: usize| {
            let k = first + place * stride;
            (k % len, (k as f64 - len as f64) * self.step_s)
        };
        ((0..=2 * SEAM_PLACES).map(place).collect(), stride as f64 * self.step_s)
    }

    /// Samples on either side of the seam that tell what is left there. Where the motion is antisymmetric,
    /// what two periods leave cancels at the seam itself: a thirty-second of the period away, a tail of
    /// t⁻⁴ shows half of one period's. At least one cycle of the cut-off, as a roll-off's ringing is zero
    /// twice a cycle.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples, bounded")]
    pub fn seam_reach(&self) -> usize {
        let len = self.pair.len();
        let cycle = TAU / (self.cutoff.omega_rad_s * self.step_s);
        (len / 32).max(2).max((cycle.ceil() as usize).min(len / 4))
    }

    /// Number of bins from zero frequency on that carry spectrum.
    pub fn band_len(&self) -> usize {
        let carries = |magnitude: &f64| *magnitude > BAND_TOLERANCE * self.largest_m_s2;
        self.magnitudes_m_s2.iter().rposition(carries).map_or(1, |last| last + 1)
    }

    /// Amplitudes of the `order`-th time derivative of a quantity with `amplitudes`.
    pub fn derivative(&self, amplitudes: &[Complex64], order: usize) -> Vec<Complex64> {
        let mut derived = amplitudes.to_vec();
        for _ in 0..order {
            for (x, omega) in derived.iter_mut().zip(&self.omegas_rad_s) {
                *x = Complex64::new(-omega * x.im, omega * x.re);
            }
        }
        derived
    }
}

impl TipMotion {
    /// Spectrum of the motion on a period of `len` samples, an even number not below its own. Of
    /// the samples beyond its own those from `seam` on stand for times before the trajectory.
    ///
    /// Acceleration samples are transformed as they are. Displacement samples are differenced
    /// twice first, which confines them to the motion whatever its travel, and the difference is
    /// undone in the spectrum:
    ///
    /// ```text
    /// â = D̂ (ωΔt/2)²/sin²(ωΔt/2),   D_k = (v_{k+1} − 2v_k + v_{k−1})/Δt²
    /// ```
    ///
    /// # Panics
    /// If `len` is odd or below the number of samples, or `seam` does not lie in the padding.
    pub fn spectrum(&self, len: usize, seam: usize) -> TipSpectrum {
        let given = self.grid().len;
        assert!((given..=len).contains(&seam), "seam {seam} of {given} samples in {len}");
        let pair = FourierPair::new(len);
        let mut samples = self.forcing_m_s2().to_vec();
        samples.resize(len, 0.0);
        let mut acceleration = pair.amplitudes(samples);
        acceleration[0] = Complex64::ZERO;
        if let Source::Displacement { .. } = self.source() {
            for (k, amplitude) in acceleration.iter_mut().enumerate().skip(1) {
                let half = std::f64::consts::PI * k as f64 / len as f64;
                *amplitude *= (half / libm::sin(half)).powi(2);
            }
        }
        let step_s = self.grid().step_s;
        let mean_velocity_m_s = self.travel_m() / (len as f64 * step_s);
        TipSpectrum::new(pair, step_s, seam, acceleration, mean_velocity_m_s)
    }

    /// The motion over the period of `spectrum`, which must be its own.
    ///
    /// Where all frequencies are kept, given samples stay as they are; what was not given, and all of a
    /// motion that is rolled off, is the band-limited integral or derivative. The displacement is a ramp of the mean velocity and a periodic rest, so that a
    /// step needs no periodic trick.
    pub fn histories(&self, spectrum: &TipSpectrum) -> TipHistories {
        let (len, given) = (spectrum.pair.len(), self.grid().len);
        let before = spectrum.seam;
        let velocity_m_s = spectrum.pair.samples(&spectrum.velocity_m_s);
        let (acceleration_m_s2, displacement_m) = match self.source() {
            _ if !spectrum.cutoff.keeps_all() => {
                let acceleration = spectrum.pair.samples(&spectrum.acceleration_m_s2);
                (acceleration, self.integrated_displacement(spectrum, before))
            }
            Source::Acceleration(samples) => {
                let mut acceleration = samples.clone();
                acceleration.resize(len, 0.0);
                (acceleration, self.integrated_displacement(spectrum, before))
            }
            Source::Displacement { samples, .. } => {
                let acceleration = spectrum.pair.samples(&spectrum.acceleration_m_s2);
                let mut displacement = samples.clone();
                displacement.resize(before, samples[given - 1]);
                displacement.resize(len, samples[0]);
                (acceleration, displacement)
            }
        };
        TipHistories { acceleration_m_s2, velocity_m_s, displacement_m, before }
    }

    fn integrated_displacement(&self, spectrum: &TipSpectrum, before: usize) -> Vec<f64> {
        let len = spectrum.pair.len();
        let bins = spectrum.acceleration_m_s2.iter().zip(&spectrum.omegas_rad_s);
        let mut periodic: Vec<Complex64> = bins.map(|(a, omega)| -a / (omega * omega)).collect();
        periodic[0] = Complex64::ZERO;
        let periodic = spectrum.pair.samples(periodic);
        let ramp = spectrum.velocity_m_s[0].re * spectrum.step_s;
        let steps = |j: usize| {
            if j < before { j as f64 } else { j as f64 - len as f64 }
        };
        // The tip stands at its initial displacement at the far end of the rest before the motion.
        let begin = before % len;
        // Where all frequencies are kept, the rest rings at the Nyquist frequency: that cancels here.
        let [earlier, later] = [begin + len - 1, begin + 1].map(|k| periodic[k % len]);
        let rest = 0.25 * (earlier + later) + 0.5 * periodic[begin];
        let offset = self.initial_displacement_m() - ramp * steps(begin) - rest;
        (0..len).map(|j| offset + ramp * steps(j) + periodic[j]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::MotionColumns;

    /// A step of the displacement by an error function: smooth, band-limited to round-off, from
    /// rest to rest, with every derivative known.
    fn smooth(t: f64) -> [f64; 3] {
        let (s, pi) = ((t - 1.0) / 0.1, std::f64::consts::PI);
        let gauss = (-s * s).exp() / (0.1 * pi.sqrt());
        // ∫gauss dt by its own series in steps would be long; a fine Simpson sum is exact enough.
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
            let found = motion.histories(&motion.spectrum(len, 201 + (len - 201) / 2));
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
            let found = motion.histories(&motion.spectrum(len, 201 + (len - 201) / 2));
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
        let spectrum = TipMotion::new(columns).unwrap().spectrum(256, 230);
        let derived = spectrum.derivative(&spectrum.velocity_m_s, 1);
        for (a, b) in derived.iter().zip(&spectrum.acceleration_m_s2).take(60) {
            assert!((a - b).norm() < 1e-14);
        }
    }
}
