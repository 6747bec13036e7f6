//! Spectrum of a tip motion, up to a cut-off.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use super::recording::Noise;
use super::samples::{Ends, Samples, Source};
use crate::numeric::{FourierPair, angular_frequency, fast_length, largest, magnitude};

/// Ratio of the end of the roll-off to the cut-off.
pub(super) const ROLL_OFF: f64 = 1.5;

/// Factor on the tolerance for a second cut-off: the torque must not depend on the cut-off much.
pub(super) const LOOSER: f64 = 2.0;

/// Highest frequency of the solution of a motion, and the resulting error of the tip.
///
/// For a motion with a kink, with rounded digits or with a fine step the torque is unbounded: |T/a| grows with
/// frequency, while the tip's displacement falls as ω⁻². The motor need not produce motion that the tip does not show
/// (Bayo 1987, after eq 17): the cut-off is the lowest frequency that keeps the tip within a tolerance, a share of its
/// travel, at all times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutoff {
    /// Frequency in rad/s up to which amplitudes stay unchanged; infinite if all do.
    pub omega_rad_s: f64,
    /// Cut-off in rad/s with which the tip strays twice as far, counting motion that the samples do not hold.
    pub looser_rad_s: f64,
    /// Largest error in m of the solved tip relative to the wanted one, at any time.
    pub tip_error_m: f64,
    /// Reason why the tip misses the tolerance; `None` if it keeps it.
    pub shortfall: Option<Shortfall>,
    /// Uncertainty of the samples; `None` if it is below the tolerance.
    pub input: Option<InputBand>,
}

/// Uncertain samples, and how much the torque depends on the cut-off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputBand {
    /// Errors of the samples.
    pub noise: Noise,
    /// True if these errors set the cut-off, rather than the tolerance for exact samples.
    pub sets_band: bool,
    /// Distance in m within which the solution follows the samples.
    pub followed_m: f64,
    /// Largest error in m of the solved tip for exact samples.
    pub wanted_m: f64,
    /// Exponent of the fall of the tip's error with the cut-off: 3 for a motion with a jump of the jerk.
    pub fall: f64,
}

/// Reason why the samples of a motion do not bring the tip within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortfall {
    /// The step is too long; the field is a short enough step in s.
    Step(f64),
    /// The error hardly falls with frequency: noise, or too few digits.
    Noise,
}

impl Cutoff {
    /// All frequencies of the samples.
    pub const ALL: Self = Self {
        omega_rad_s: f64::INFINITY,
        looser_rad_s: f64::INFINITY,
        tip_error_m: 0.0,
        shortfall: None,
        input: None,
    };

    /// True if every frequency is kept.
    pub fn keeps_all(&self) -> bool {
        self.omega_rad_s.is_infinite()
    }

    /// Distance in m within which the solution follows uncertain samples, if their errors set it.
    pub fn followed_m(&self) -> Option<f64> {
        self.input.filter(|input| input.sets_band).map(|input| input.followed_m)
    }

    /// True if the samples' errors set the cut-off, rather than the tolerance for exact samples.
    pub fn is_set_by_input(&self) -> bool {
        self.input.is_some_and(|input| input.sets_band)
    }

    /// Factor on the amplitude at ω ≥ 0: 1 up to the cut-off, then a raised cosine down to 0 at [`Self::end_rad_s`].
    pub fn weight(&self, omega_rad_s: f64) -> f64 {
        weight(omega_rad_s, self.omega_rad_s)
    }

    /// Weight for the looser tolerance over [`Self::weight`], the factor from one to the other.
    pub(crate) fn weight_of_looser(&self, omega_rad_s: f64) -> f64 {
        let own = self.weight(omega_rad_s);
        if own > 0.0 { weight(omega_rad_s, self.looser_rad_s) / own } else { 0.0 }
    }

    /// Highest solved frequency in rad/s.
    pub fn end_rad_s(&self) -> f64 {
        ROLL_OFF * self.omega_rad_s
    }
}

pub(super) fn weight(omega_rad_s: f64, cutoff_rad_s: f64) -> f64 {
    if omega_rad_s <= cutoff_rad_s {
        return 1.0;
    }
    let beyond = (omega_rad_s / cutoff_rad_s - 1.0) / (ROLL_OFF - 1.0);
    if beyond >= 1.0 { 0.0 } else { 0.5 * (1.0 + libm::cos(PI * beyond)) }
}

/// Number of solved frequencies beyond the band of uncertain samples.
const BEYOND: usize = 64;

/// Share of the largest amplitude of the acceleration below which amplitudes are round-off of the transform.
const BAND_TOLERANCE: f64 = 1e-15;

/// Number of places on either side of the seam for measuring a decay.
const SEAM_PLACES: usize = 8;

/// Spectrum of the tip motion on a period of N samples; sample 0 is the trajectory's first.
///
/// Samples after the trajectory continue its rest; samples from the seam on are the rest before it.
#[derive(Clone)]
pub(crate) struct TipSpectrum {
    /// Fourier pair of the period.
    pub pair: FourierPair,
    /// Pair with twice the samples that the band needs. A peak between its samples is missed by at most a seventh at
    /// the cut-off, and three tenths at the end of the roll-off.
    pub band_pair: FourierPair,
    band_len: usize,
    /// Step in s.
    pub step_s: f64,
    /// Amplitudes â of the acceleration in m/s², N/2 + 1 of them. The one at zero is 0, except for a tip that moves at
    /// its ends.
    pub acceleration_m_s2: Vec<Complex64>,
    /// Amplitudes of the velocity in m/s: â/(iω), and at zero the mean over the period, travel over P; for a tip that
    /// moves at its ends 0.
    pub velocity_m_s: Vec<Complex64>,
    /// Angular frequency of every bin in rad/s (Bayo 1987, eq 13).
    pub omegas_rad_s: Vec<f64>,
    /// Magnitudes |â| in m/s².
    pub magnitudes_m_s2: Vec<f64>,
    /// Largest magnitude.
    pub largest_m_s2: f64,
    /// Mean acceleration in m/s² of a tip that moves at its ends, whose velocity is not periodic.
    pub mean_m_s2: Option<f64>,
    /// Displacement of a periodic motion at its first sample in m, relative to its mean without travel.
    pub start_m: Option<f64>,
    /// First sample before the trajectory; N without one.
    pub seam: usize,
    /// Cut-off of the motion.
    pub cutoff: Cutoff,
}

impl TipSpectrum {
    /// Spectrum of a motion, rolled off at a cut-off, on a period of `len` samples, an even number of at least the
    /// motion's. The padding from `seam` on precedes the trajectory.
    ///
    /// Acceleration samples are transformed unchanged. Displacement samples are first differenced twice, which is zero
    /// outside the motion for any travel; the spectrum undoes the difference:
    ///
    /// ```text
    /// â = D̂ (ωΔt/2)²/sin²(ωΔt/2),   D_k = (v_{k+1} − 2v_k + v_{k−1})/Δt²
    /// ```
    pub(super) fn of(motion: &Samples, len: usize, seam: usize, cutoff: Cutoff) -> Self {
        let (step_s, given) = (motion.grid.step_s, motion.grid.len);
        assert!((given..=len).contains(&seam), "seam {seam} of {given} samples in {len}");
        let pair = FourierPair::new(len);
        let mut acceleration_m_s2 = pair.amplitudes(motion.forcing_over_m_s2(len));
        let is_moving = motion.ends == Ends::Moving;
        let mean_m_s2 = is_moving.then(|| acceleration_m_s2[0].re);
        acceleration_m_s2[0] = mean_m_s2.unwrap_or_default().into();
        if let Source::Displacement { .. } = *motion.source {
            for (k, amplitude) in acceleration_m_s2.iter_mut().enumerate().skip(1) {
                let half = PI * k as f64 / len as f64;
                *amplitude *= (half / libm::sin(half)).powi(2);
            }
        }
        let omegas = (0..acceleration_m_s2.len()).map(|k| angular_frequency(k, len, step_s));
        let omegas_rad_s: Vec<f64> = omegas.collect();
        // The frequencies beyond a cut-off do not shift a cycle: its start includes all frequencies.
        let start_m = (motion.ends == Ends::Periodic).then(|| {
            let displacement = |(k, a): (usize, &Complex64)| match omegas_rad_s[k] {
                0.0 => 0.0,
                omega if 2 * k == len => -a.re / (omega * omega),
                omega => -2.0 * a.re / (omega * omega),
            };
            acceleration_m_s2.iter().enumerate().map(displacement).sum()
        });
        if !cutoff.keeps_all() {
            for (amplitude, omega) in acceleration_m_s2.iter_mut().zip(&omegas_rad_s) {
                *amplitude *= cutoff.weight(*omega);
            }
        }
        let bins = acceleration_m_s2.iter().zip(&omegas_rad_s);
        let mut velocity_m_s: Vec<Complex64> =
            bins.map(|(a, omega)| Complex64::new(a.im / omega, -a.re / omega)).collect();
        velocity_m_s[0] = match motion.ends {
            Ends::AtRest => motion.travel_m / (len as f64 * step_s),
            Ends::Moving => 0.0,
            Ends::Periodic => motion.velocities_m_s[0],
        }
        .into();
        let magnitudes_m_s2: Vec<f64> = acceleration_m_s2.iter().map(|a| magnitude(*a)).collect();
        let largest_m_s2 = largest(&magnitudes_m_s2);
        let carries = |magnitude: &f64| *magnitude > BAND_TOLERANCE * largest_m_s2;
        let band_len = magnitudes_m_s2.iter().rposition(carries).map_or(1, |last| last + 1);
        let few = fast_length(4 * band_len);
        let band_pair = if few < len { FourierPair::new(few) } else { pair.clone() };
        Self {
            pair,
            band_pair,
            band_len,
            step_s,
            acceleration_m_s2,
            velocity_m_s,
            omegas_rad_s,
            magnitudes_m_s2,
            largest_m_s2,
            mean_m_s2,
            start_m,
            seam,
            cutoff,
        }
    }

    /// Spectrum of the samples' errors: expected amplitude at each frequency of the band, and the error of the tip's
    /// end position.
    pub(super) fn of_noise(&self, of_samples: &Noise) -> Self {
        let mut noise = self.clone();
        for (k, omega) in self.omegas_rad_s.iter().enumerate() {
            let amplitude_m = || of_samples.amplitude_m(*omega, self.pair.len());
            let amplitude_m = if k == 0 { 0.0 } else { amplitude_m() * self.cutoff.weight(*omega) };
            noise.acceleration_m_s2[k] = (-omega * omega * amplitude_m).into();
            noise.velocity_m_s[k] = Complex64::new(0.0, omega * amplitude_m);
            noise.magnitudes_m_s2[k] = omega * omega * amplitude_m;
        }
        noise.velocity_m_s[0] = (of_samples.travel_m / self.period_s()).into();
        noise.mean_m_s2 = None;
        noise.largest_m_s2 = largest(&noise.magnitudes_m_s2);
        noise
    }

    /// Parts of the tip's motion beyond the band of uncertain samples, at frequencies evenly spaced logarithmically.
    /// From one to the next, the tip's error falls by the displacement's amplitude. Exact samples have another band
    /// even if they are solved to about the same error, because the spectrum of a motion has lobes.
    pub(super) fn beyond(&self, input: &InputBand) -> Self {
        let (mut beyond, cutoff) = (self.clone(), self.cutoff);
        // If the samples do not set the band, they widen it by the frequencies that leave an error of their size.
        let error_m = if cutoff.tip_error_m > input.wanted_m {
            cutoff.tip_error_m
        } else {
            cutoff.tip_error_m.min(input.noise.followed_m(cutoff.omega_rad_s))
        };
        let end = libm::pow((1.0 + error_m / input.wanted_m).max(1.0), 1.0 / input.fall);
        let step = libm::log(end) / BEYOND as f64;
        let left = |place: f64| libm::exp(-input.fall * step * place);
        let part_m =
            |place: f64| error_m * (left(place) - left(place + 1.0)) / (1.0 - left(BEYOND as f64));
        let parts = (0..BEYOND).map(|place| {
            let place = place as f64;
            let omega = self.cutoff.omega_rad_s * libm::exp(step * (place + 0.5));
            (omega, part_m(place))
        });
        // A spectrum begins at zero frequency, where the parts have no amplitude.
        let parts: Vec<(f64, f64)> =
            std::iter::once((0.0, 0.0)).chain(parts.filter(|_| step > 0.0)).collect();
        beyond.omegas_rad_s = parts.iter().map(|(omega, _)| *omega).collect();
        beyond.acceleration_m_s2 =
            parts.iter().map(|(omega, m)| (-omega * omega * m).into()).collect();
        beyond.velocity_m_s =
            parts.iter().map(|(omega, m)| Complex64::new(0.0, omega * m)).collect();
        beyond.magnitudes_m_s2 = parts.iter().map(|(omega, m)| omega * omega * m).collect();
        beyond.largest_m_s2 = largest(&beyond.magnitudes_m_s2);
        beyond.band_len = parts.len();
        beyond
    }

    /// Amplitudes of a possible displacement error of the samples in m: an offset, noise of random phases within the
    /// band, and the parts beyond it, which all have this phase at the time of sample `at`. `draw` yields random
    /// numbers from 0 to 1.
    pub(super) fn possible_error_m(
        &self,
        input: &InputBand,
        (at, phase): (usize, f64),
        draw: &mut dyn FnMut() -> f64,
    ) -> Vec<Complex64> {
        let wave = |size_m: f64, phase: f64| {
            Complex64::new(size_m * libm::cos(phase), size_m * libm::sin(phase))
        };
        let noise = self.of_noise(&input.noise);
        let sizes = noise.magnitudes_m_s2.iter().zip(&self.omegas_rad_s).enumerate();
        let mut error_m: Vec<Complex64> = sizes
            .map(|(k, (m_s2, omega))| match k {
                0 => input.noise.offset_m().copysign(draw() - 0.5).into(),
                _ => wave(m_s2 / (omega * omega), TAU * draw()),
            })
            .collect();
        let beyond = self.beyond(input);
        for (omega, m_s2) in beyond.omegas_rad_s.iter().zip(&beyond.magnitudes_m_s2).skip(1) {
            // The part beyond a cut-off lies in its roll-off.
            let bin = self.omegas_rad_s.partition_point(|own| *own < ROLL_OFF.sqrt() * omega);
            // Frequencies that the samples do not resolve belong to no motion through them.
            if bin + 1 < error_m.len() {
                let turned = self.omegas_rad_s[bin] * self.step_s * at as f64;
                error_m[bin] += wave(0.5 * m_s2 / (omega * omega), phase - turned);
            }
        }
        error_m
    }

    /// Displacement of the tip after the motion relative to before it, in m.
    pub(crate) fn travel_m(&self) -> f64 {
        self.velocity_m_s[0].re * self.period_s()
    }

    /// Period P in s.
    pub(crate) fn period_s(&self) -> f64 {
        self.pair.len() as f64 * self.step_s
    }

    /// Places around the seam for measuring the end of a decay: samples of the period with their times in s, and the
    /// time between them in s.
    pub(crate) fn around_seam(&self) -> (Vec<(usize, f64)>, f64) {
        let len = self.pair.len();
        let stride = (self.seam_reach() / SEAM_PLACES).max(1);
        let first = len + self.seam - SEAM_PLACES * stride;
        let place = |place: usize| {
            let k = first + place * stride;
            (k % len, (k as f64 - len as f64) * self.step_s)
        };
        ((0..=2 * SEAM_PLACES).map(place).collect(), stride as f64 * self.step_s)
    }

    /// Number of samples on either side of the seam for measuring a decay. For an antisymmetric motion the tails of two
    /// periods cancel at the seam; a thirty-second of the period away, half of one period's tail of t⁻⁴ remains. It
    /// spans at least one cycle of the cut-off, because the ringing of a roll-off is zero twice a cycle.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples, bounded")]
    pub(crate) fn seam_reach(&self) -> usize {
        let len = self.pair.len();
        let cycle = TAU / (self.cutoff.omega_rad_s * self.step_s);
        (len / 32).max(2).max((cycle.ceil() as usize).min(len / 4))
    }

    /// Number of bins from zero frequency to the last one above round-off.
    pub(crate) fn band_len(&self) -> usize {
        self.band_len
    }

    /// Amplitudes of the `order`-th time derivative of a quantity with `amplitudes`.
    pub(crate) fn derivative(&self, amplitudes: &[Complex64], order: usize) -> Vec<Complex64> {
        let mut derived = amplitudes.to_vec();
        for _ in 0..order {
            for (x, omega) in derived.iter_mut().zip(&self.omegas_rad_s) {
                *x = Complex64::new(-omega * x.im, omega * x.re);
            }
        }
        derived
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_is_one_up_to_the_cut_off_and_none_from_half_above_it() {
        let cutoff = Cutoff { omega_rad_s: 10.0, looser_rad_s: 8.0, ..Cutoff::ALL };
        let weights = [9.9, 12.5, 15.0].map(|omega| cutoff.weight(omega));
        assert!((weights[0], weights[2]) == (1.0, 0.0) && (weights[1] - 0.5).abs() < 1e-15);
        // 11 is three quarters of the way from 8 to 12.
        let looser = cutoff.weight(11.0) * cutoff.weight_of_looser(11.0);
        assert!((looser - 0.5 * (1.0 + (0.75 * PI).cos())).abs() < 1e-15);
        assert_eq!(cutoff.weight_of_looser(15.0).to_bits(), 0);
        assert!(Cutoff::ALL.keeps_all());
        assert_eq!(Cutoff::ALL.weight(1e9).to_bits(), 1.0_f64.to_bits());
    }
}
