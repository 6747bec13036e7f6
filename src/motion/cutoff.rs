//! The search of the lowest cut-off of a motion.

use num_complex::Complex64;

use super::spectrum::{Cutoff, LOOSER, ROLL_OFF, Shortfall, TipSpectrum, weight};
use super::tip_motion::TipMotion;
use crate::numeric::{FourierPair, fast_length, largest};

/// Largest tolerance that is searched for.
const LARGEST_TOLERANCE: f64 = 0.1;

/// Relative precision of the cut-off, and of that for the looser tolerance.
const PRECISION: f64 = 1e-3;
const LOOSER_PRECISION: f64 = 2e-2;

/// Share of the tolerated error above the highest frequency that the search transforms; it is added to
/// every error found.
const ABOVE_TRANSFORM: f64 = 1e-2;

/// Exponent with which the tip's error falls with frequency below which a finer step does not help. Samples
/// of rounded digits have 0.4 to 1.5, those of an acceleration that jumps 2.
const LEAST_FALL: f64 = 1.7;

/// Exponent beyond the Nyquist frequency from which a step is suggested: that of an acceleration that jumps.
/// Near the Nyquist frequency the error falls faster.
const SURE_FALL: f64 = 2.0;

/// Factor on the step that this exponent gives.
const STEP_MARGIN: f64 = 0.6;

/// A cut-off, and the largest displacement in m, at any time, of what it leaves out.
#[derive(Clone, Copy)]
struct Left {
    omega_rad_s: f64,
    error_m: f64,
}

/// The displacement of a motion over frequency, from which that above a cut-off is computed.
struct Residual {
    omegas_rad_s: Vec<f64>,
    /// Amplitudes of the displacement in m, without the negligible ones at the end.
    displacement_m: Vec<Complex64>,
    pair: FourierPair,
    /// Sum of the amplitudes at the end, both signs of the frequency, in m.
    left_out_m: f64,
}

impl TipMotion {
    /// The lowest cut-off whose tip error is at most `tolerance` times the travel at all times; all
    /// frequencies for a tolerance of 0 or below, and no fewer than for 0.1. It depends on the motion alone,
    /// on no link.
    ///
    /// If even the highest cut-off, whose roll-off ends at the Nyquist frequency, has a larger error, it is
    /// returned with the reason.
    pub fn cutoff(&self, tolerance: f64) -> Cutoff {
        if tolerance <= 0.0 {
            return Cutoff::ALL;
        }
        let tolerance = tolerance.min(LARGEST_TOLERANCE);
        // Four times as long as it moves: a shorter rest would change a low cut-off.
        let moves = |a: &f64| *a != 0.0;
        let forcing = self.samples().forcing_m_s2();
        let first = forcing.iter().position(moves).unwrap_or(0);
        let last = forcing.iter().rposition(moves).unwrap_or(0);
        let len = fast_length(self.grid().len.max(4 * (last + 1 - first)));
        let period = self.over_period(len, self.grid().len.midpoint(len), Cutoff::ALL);
        let allowed_m = tolerance * period.histories.largest_travel_m();
        let (residual, low, high) = Residual::bracketed(&period.spectrum, allowed_m);
        let high = residual.left_by(high);
        let (found, looser, shortfall) = if high.error_m > allowed_m {
            let fall = libm::log2(residual.left_by(0.5 * high.omega_rad_s).error_m / high.error_m);
            let finer = libm::pow(allowed_m / high.error_m, 1.0 / SURE_FALL);
            let shortfall = if fall > LEAST_FALL {
                Shortfall::Step(STEP_MARGIN * finer * self.grid().step_s)
            } else {
                Shortfall::Noise
            };
            (high, high, Some(shortfall))
        } else {
            let found = residual.lowest(residual.left_by(low), high, allowed_m, PRECISION);
            let allowed_m = LOOSER * allowed_m;
            let mut low = residual.left_by(0.5 * found.omega_rad_s);
            // This ends: a cut-off near zero leaves the whole motion, far more than any tolerance.
            while low.error_m <= allowed_m {
                low = residual.left_by(0.5 * low.omega_rad_s);
            }
            (found, residual.lowest(low, found, allowed_m, LOOSER_PRECISION), None)
        };
        Cutoff {
            omega_rad_s: found.omega_rad_s,
            looser_rad_s: looser.omega_rad_s,
            tip_error_m: found.error_m,
            shortfall,
        }
    }
}

impl Residual {
    /// The residual of a motion, and two cut-offs in rad/s that bracket the lowest one that leaves at most
    /// `allowed_m`; the upper one may leave more if it is the highest possible.
    fn bracketed(spectrum: &TipSpectrum, allowed_m: f64) -> (Self, f64, f64) {
        let omegas = &spectrum.omegas_rad_s;
        let bins = spectrum.acceleration_m_s2.iter().zip(omegas);
        let mut displacement_m: Vec<_> = bins.map(|(a, omega)| -a / (omega * omega)).collect();
        displacement_m[0] = Complex64::ZERO;
        // The amplitudes from a bin on move the tip at most by their sum, and at some time by their root
        // mean square.
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
        // Eight samples or more per cycle of the highest frequency: the peak between them is larger by some
        // tenths of a percent.
        let pair = FourierPair::new(fast_length(8 * top));
        let highest = omegas[omegas.len() - 1] / ROLL_OFF;
        let high = omegas[enough.min(omegas.len() - 1)].min(highest);
        let low = (omegas[too_low] / ROLL_OFF).max(0.5 * omegas[1]).min(high);
        let omegas_rad_s = omegas[..top].to_vec();
        (Self { omegas_rad_s, displacement_m, pair, left_out_m }, low, high)
    }

    /// The displacement that a cut-off leaves out.
    fn left_by(&self, omega_rad_s: f64) -> Left {
        let bins = self.displacement_m.iter().zip(&self.omegas_rad_s);
        let left: Vec<_> = bins.map(|(d, omega)| d * (1.0 - weight(*omega, omega_rad_s))).collect();
        let error_m = largest(&self.pair.samples(left)) + self.left_out_m;
        Left { omega_rad_s, error_m }
    }

    /// The lowest cut-off in a bracket that leaves at most `allowed_m`, to the relative precision `precision`;
    /// `high` leaves no more.
    ///
    /// The error falls about as a power of the cut-off, so that the next trial lies on the power law through
    /// both ends. If that left more than half of the bracket, the following trial halves it.
    fn lowest(&self, mut low: Left, mut high: Left, allowed_m: f64, precision: f64) -> Left {
        let ratio = |low: Left, high: Left| libm::log(high.omega_rad_s / low.omega_rad_s);
        let mut is_power_law = true;
        while high.omega_rad_s > (1.0 + precision) * low.omega_rad_s {
            let width = ratio(low, high);
            let fall = libm::log(low.error_m / high.error_m);
            let share = libm::log(allowed_m / high.error_m) / fall;
            let share = if is_power_law && share.is_finite() { share } else { 0.5 };
            // No closer to an end than needed to close the bracket.
            let least = 0.9 * precision;
            let below = (share * width).min(width - least).max(least.min(0.5 * width));
            let tried = self.left_by(high.omega_rad_s * libm::exp(-below));
            if tried.error_m <= allowed_m {
                high = tried;
            } else {
                low = tried;
            }
            is_power_law = !is_power_law || ratio(low, high) <= 0.5 * width;
        }
        high
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::motion::{MotionColumns, Profile};

    const TRAVEL_M: f64 = 0.5;
    const STEP_S: f64 = 0.01;

    fn septic() -> TipMotion {
        TipMotion::new(Profile::Septic.sampled(TRAVEL_M, STEP_S, 100, [0, 0])).unwrap()
    }

    /// What a cut-off leaves out of a motion, largest over times four to a step, by plain sums over all
    /// samples and frequencies of a period eight times as long.
    fn left_out_m(motion: &TipMotion, cutoff_rad_s: f64) -> f64 {
        let samples = motion.samples().forcing_m_s2();
        let len = 8 * samples.len();
        let spacing = TAU / (len as f64 * STEP_S);
        let wave = |omega: f64, time_s: f64| Complex64::from_polar(1.0, omega * time_s);
        let amplitudes: Vec<(f64, Complex64)> = (1..len / 2)
            .map(|k| {
                let omega = spacing * k as f64;
                let terms = samples.iter().enumerate();
                let sum: Complex64 = terms.map(|(n, a)| a * wave(-omega, n as f64 * STEP_S)).sum();
                let share = ((omega / cutoff_rad_s - 1.0) / 0.5).clamp(0.0, 1.0);
                let left = 0.5 * (1.0 - (PI * share).cos());
                (omega, -sum * 2.0 * left / (len as f64 * omega * omega))
            })
            .collect();
        let at = |time_s: f64| -> f64 {
            amplitudes.iter().map(|(omega, d)| (d * wave(*omega, time_s)).re).sum()
        };
        (0..4 * len).map(|k| at(0.25 * STEP_S * k as f64).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_cut_off_is_the_lowest_that_keeps_the_tip_within_its_tolerance_at_all_times() {
        let motion = septic();
        for tolerance in [1e-3, 1e-5, 1e-7] {
            let found = motion.cutoff(tolerance);
            assert_eq!(found.shortfall, None);
            let allowed_m = tolerance * TRAVEL_M;
            let left_m = left_out_m(&motion, found.omega_rad_s);
            assert!(
                left_m <= 1.005 * allowed_m,
                "{tolerance}: {left_m} {found:?} {}",
                motion.travel_m()
            );
            assert!((found.tip_error_m / left_m - 1.0).abs() < 0.05, "{tolerance}: {found:?}");
            let lower_m = left_out_m(&motion, 0.98 * found.omega_rad_s);
            assert!(lower_m > 0.98 * allowed_m, "{tolerance}: a lower one leaves {lower_m}");
            let looser_m = left_out_m(&motion, found.looser_rad_s);
            assert!(looser_m <= 1.005 * LOOSER * allowed_m, "{tolerance}: {looser_m}");
            assert!(left_out_m(&motion, 0.95 * found.looser_rad_s) > 0.98 * LOOSER * allowed_m);
        }
    }

    #[test]
    fn a_step_that_is_too_long_is_named_with_one_that_does() {
        let motion = |profile: Profile, steps: usize| {
            let step_s = 1.0 / steps as f64;
            TipMotion::new(profile.sampled(TRAVEL_M, step_s, steps, [0, 0])).unwrap()
        };
        let mut suggested = 0;
        for profile in Profile::ALL {
            for steps in [6, 10, 12, 20, 25, 40, 50, 60, 100] {
                let found = motion(profile, steps).cutoff(1e-6);
                let Some(shortfall) = found.shortfall else { continue };
                assert!(found.tip_error_m > 1e-6 * TRAVEL_M);
                let Shortfall::Step(step_s) = shortfall else {
                    panic!("{profile}, {steps}: {found:?}")
                };
                let enough = (1..1_000_000).find(|steps| 1.0 / *steps as f64 <= step_s).unwrap();
                let again = motion(profile, enough).cutoff(1e-6);
                assert_eq!(again.shortfall, None, "{profile}, {steps} steps: {again:?}");
                suggested += 1;
            }
        }
        assert!(suggested > 30, "{suggested} suggestions");
    }

    #[test]
    fn digits_too_few_for_the_tolerance_are_named() {
        let [time_s, displacement_m] = [0, 1].map(|column| -> Vec<f64> {
            let rounded = |k: i32| {
                let s = (f64::from(k) / 500.0).clamp(0.0, 1.0);
                let d = TRAVEL_M * s.powi(4) * (35.0 - 84.0 * s + 70.0 * s * s - 20.0 * s.powi(3));
                [0.002 * f64::from(k), (1e4 * d).round() / 1e4][column]
            };
            (-50..=550).map(rounded).collect()
        });
        let displacement_m = Some(displacement_m);
        let columns = MotionColumns { time_s, displacement_m, ..Default::default() };
        let motion = TipMotion::new(columns).unwrap();
        assert_eq!(motion.cutoff(1e-6).shortfall, Some(Shortfall::Noise));
        assert_eq!(motion.cutoff(1e-3).shortfall, None);
    }
}
