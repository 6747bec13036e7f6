use std::f64::consts::PI;

use num_complex::Complex64;

use super::spectrum::TipSpectrum;
use super::tip_motion::TipMotion;
use crate::numeric::{FourierPair, fast_length, largest};

/// The roll-off ends at so many times the cut-off.
const ROLL_OFF: f64 = 1.5;

/// The cut-off is found to this share of itself.
const PRECISION: f64 = 1e-3;

/// Share of the tolerated error that may lie above the highest frequency that the search transforms; it
/// is added to every error found.
const ABOVE_TRANSFORM: f64 = 1e-2;

/// Fall of the tip's error with frequency, as a power, below which a finer step does not help: the
/// samples hold noise or rounding.
const LEAST_FALL: f64 = 1.0;

/// Up to which frequency a motion is followed, and what the tip misses by it.
///
/// The torque of a motion with a kink, a rounded digit or a fine step has no limit: |T/a| grows with
/// frequency, while the tip's displacement falls as ω⁻². What the tip cannot show, the motor need not
/// do (Bayo 1987, after eq 17): the wanted motion is solved up to the lowest frequency at which the tip
/// is within a tolerance of its way at all times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutoff {
    /// Frequency in rad/s up to which every amplitude is kept; infinite where all are.
    pub omega_rad_s: f64,
    /// Largest distance in m, at any time, of the tip that is solved from the wanted one.
    pub tip_error_m: f64,
    /// Why the tip is not within the tolerance; none where it is.
    pub shortfall: Option<Shortfall>,
}

/// Why the samples of a motion do not bring the tip within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortfall {
    /// The step is too long; this one in s would do.
    Step(f64),
    /// What is missed does not fall with frequency: noise, or too few digits.
    Noise,
}

impl Cutoff {
    /// All frequencies of the samples.
    pub const ALL: Self = Self { omega_rad_s: f64::INFINITY, tip_error_m: 0.0, shortfall: None };

    /// Whether every frequency is kept.
    pub fn keeps_all(&self) -> bool {
        self.omega_rad_s.is_infinite()
    }

    /// Factor on the amplitude at ω ≥ 0: 1 up to the cut-off, then a raised cosine over half of it.
    pub fn weight(&self, omega_rad_s: f64) -> f64 {
        weight(omega_rad_s, self.omega_rad_s)
    }

    /// The highest frequency that is solved, in rad/s.
    pub fn end_rad_s(&self) -> f64 {
        ROLL_OFF * self.omega_rad_s
    }
}

fn weight(omega_rad_s: f64, cutoff_rad_s: f64) -> f64 {
    if omega_rad_s <= cutoff_rad_s {
        return 1.0;
    }
    let beyond = (omega_rad_s / cutoff_rad_s - 1.0) / (ROLL_OFF - 1.0);
    if beyond >= 1.0 { 0.0 } else { 0.5 * (1.0 + libm::cos(PI * beyond)) }
}

/// The displacement of a motion over frequency, and what is left of it above a cut-off.
struct Residual {
    omegas_rad_s: Vec<f64>,
    /// Amplitudes of the displacement in m, those at the end left out that do not matter.
    displacement_m: Vec<Complex64>,
    pair: FourierPair,
    /// Sum of the amplitudes left out, both signs of the frequency, in m.
    left_out_m: f64,
}

impl TipMotion {
    /// The lowest cut-off at which the tip is within `tolerance` of its way of the wanted motion at all
    /// times. It is a property of the motion: no link has a part in it.
    ///
    /// Where even the highest cut-off whose roll-off ends at the Nyquist frequency leaves more, that one
    /// is returned, with the reason.
    pub fn cutoff(&self, tolerance: f64) -> Cutoff {
        if tolerance == 0.0 {
            return Cutoff::ALL;
        }
        self.last_periods().cutoff(tolerance, || self.lowest_cutoff(tolerance))
    }

    fn lowest_cutoff(&self, tolerance: f64) -> Cutoff {
        let len = fast_length(2 * self.grid().len);
        let spectrum = self.spectrum(len, self.grid().len.midpoint(len));
        let allowed_m = tolerance * self.histories(&spectrum).way_m();
        let (residual, mut low, mut high) = Residual::bracketed(&spectrum, allowed_m);
        let mut error_m = residual.largest_m(high);
        if error_m > allowed_m {
            let fall = libm::log2(residual.largest_m(0.5 * high) / error_m);
            let finer = libm::pow(allowed_m / error_m, 1.0 / fall);
            let shortfall = if fall > LEAST_FALL {
                Shortfall::Step(self.grid().step_s * finer)
            } else {
                Shortfall::Noise
            };
            return Cutoff { omega_rad_s: high, tip_error_m: error_m, shortfall: Some(shortfall) };
        }
        while high > (1.0 + PRECISION) * low {
            let middle = (low * high).sqrt();
            let middle_error_m = residual.largest_m(middle);
            if middle_error_m <= allowed_m {
                (high, error_m) = (middle, middle_error_m);
            } else {
                low = middle;
            }
        }
        Cutoff { omega_rad_s: high, tip_error_m: error_m, shortfall: None }
    }
}

impl Residual {
    /// What is left of a motion, and two cut-offs in rad/s between which the lowest lies that leaves no
    /// more than `allowed_m`; the second may leave more where it is the highest possible.
    fn bracketed(spectrum: &TipSpectrum, allowed_m: f64) -> (Self, f64, f64) {
        let omegas = &spectrum.omegas_rad_s;
        let bins = spectrum.acceleration_m_s2.iter().zip(omegas);
        let mut displacement_m: Vec<_> = bins.map(|(a, omega)| -a / (omega * omega)).collect();
        displacement_m[0] = Complex64::ZERO;
        // Of the amplitudes from a bin on: none moves the tip farther than their sum, and some time it
        // is as far as their root mean square.
        let (mut sum, mut squares) = (0.0, 0.0);
        let (mut top, mut enough, mut too_low) = (omegas.len(), omegas.len(), 0);
        for (k, amplitude) in displacement_m.iter().enumerate().rev() {
            let size = amplitude.norm_sqr().sqrt();
            sum += 2.0 * size;
            squares += 2.0 * (size / allowed_m).powi(2);
            if sum <= ABOVE_TRANSFORM * allowed_m {
                top = k;
            }
            if sum <= allowed_m {
                enough = k;
            }
            if squares > 1.0 {
                too_low = k;
                break;
            }
        }
        let left_out_m = displacement_m[top..].iter().map(|d| 2.0 * d.norm_sqr().sqrt()).sum();
        let top = top.max(2);
        displacement_m.truncate(top);
        let pair = FourierPair::new(spectrum.pair.len().min(fast_length(4 * top)));
        let highest = omegas[omegas.len() - 1] / ROLL_OFF;
        let high = omegas[enough.min(omegas.len() - 1)].min(highest);
        let low = (omegas[too_low] / ROLL_OFF).max(0.5 * omegas[1]).min(high);
        let omegas_rad_s = omegas[..top].to_vec();
        (Self { omegas_rad_s, displacement_m, pair, left_out_m }, low, high)
    }

    /// Largest displacement in m, at any time, of what a cut-off leaves out.
    fn largest_m(&self, cutoff_rad_s: f64) -> f64 {
        let bins = self.displacement_m.iter().zip(&self.omegas_rad_s);
        let left: Vec<_> =
            bins.map(|(d, omega)| d * (1.0 - weight(*omega, cutoff_rad_s))).collect();
        largest(&self.pair.samples(left)) + self.left_out_m
    }
}
