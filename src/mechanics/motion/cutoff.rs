//! Search for the lowest cut-off of a motion.

use num_complex::Complex64;

use super::recording::UNCERTAIN;
use super::samples::Ends;
use super::spectrum::{Cutoff, InputBand, LOOSER, ROLL_OFF, Shortfall, TipSpectrum, weight};
use super::tip_motion::TipMotion;
use crate::numeric::{FourierPair, fast_length, largest};

/// Largest tolerance of the search.
const LARGEST_TOLERANCE: f64 = 0.1;

/// Smallest and largest exponent assumed for the fall of the tip's error beyond the band of uncertain samples. It is 2
/// for an acceleration that jumps; the smoothest motions fall faster than any power.
const FALLS: (f64, f64) = (2.0, 6.0);
const USUAL_FALL: f64 = 3.0;

/// Factor that eases the distance within which uncertain samples are followed, and the factor by which easing must
/// lower the cut-off to count. The error of a motion falls with the square of the frequency or faster; noise hardly
/// falls.
const EASED: f64 = 1.5;
const LOWERED: f64 = 1.5;

/// Error of the tip relative to its travel, from which on the fall is measured.
const COARSE: f64 = 0.1;

/// Relative precision of the cut-off, and of the cut-off for the looser tolerance.
const PRECISION: f64 = 1e-3;
const LOOSER_PRECISION: f64 = 2e-2;

/// Share of the tolerated error above the highest frequency that the search transforms; every computed error includes
/// it.
const ABOVE_TRANSFORM: f64 = 1e-2;

/// Exponent in the fall of the tip's error with frequency below which a finer step does not help. Samples with rounded
/// digits have 0.4 to 1.5, samples of an acceleration that jumps 2.
const LEAST_FALL: f64 = 1.7;

/// Exponent assumed beyond the Nyquist frequency for the suggestion of a step: the value of an acceleration that jumps.
/// Near the Nyquist frequency the error falls faster.
const SURE_FALL: f64 = 2.0;

/// Factor on the step that follows from [`SURE_FALL`].
const STEP_MARGIN: f64 = 0.6;

/// A cut-off, and the largest displacement in m, at any time, that it removes.
#[derive(Clone, Copy)]
struct Left {
    omega_rad_s: f64,
    error_m: f64,
}

/// Largest displacement in m that a cut-off in rad/s may remove.
type Allowed<'a> = &'a dyn Fn(f64) -> f64;

/// Displacement of a motion over frequency, for computing the part above a cut-off.
struct Residual {
    omegas_rad_s: Vec<f64>,
    /// Amplitudes of the displacement in m, without the negligible ones at the end.
    displacement_m: Vec<Complex64>,
    pair: FourierPair,
    /// Sum of the negligible amplitudes, for both signs of the frequency, in m.
    left_out_m: f64,
}

impl TipMotion {
    /// The lowest cut-off whose tip error is at most `tolerance` times the travel at all times; a tolerance of 0 or
    /// below keeps all frequencies, and one above 0.1 counts as 0.1. It depends only on the motion, not on a link.
    /// Uncertain samples are followed only as closely as their errors justify; a cut-off in the recording takes
    /// precedence.
    ///
    /// If even the highest cut-off has a larger error, the result is this cut-off with the reason.
    pub fn cutoff(&self, tolerance: f64) -> Cutoff {
        let chosen_rad_s = self.recording().lowpass_rad_s;
        if tolerance <= 0.0 && chosen_rad_s.is_none() {
            return self.all_frequencies();
        }
        let tolerance = tolerance.min(LARGEST_TOLERANCE);
        // A period of four times the motion: a shorter rest would change a low cut-off.
        let moves = |a: &f64| *a != 0.0;
        let forcing = self.samples().forcing_m_s2();
        let first = forcing.iter().position(moves).unwrap_or(0);
        let last = forcing.iter().rposition(moves).unwrap_or(0);
        let given = self.grid().len;
        let (len, seam) = self.cycles().map_or_else(
            || {
                let len = fast_length(given.max(4 * (last + 1 - first)));
                (len, given.midpoint(len))
            },
            |len| (len, len),
        );
        let period = self.over_period(len, seam, Cutoff::ALL);
        let travel_m = period.histories.largest_travel_m();
        let wanted_m = tolerance.max(0.0) * travel_m;
        let noise = self.uncertain(tolerance, travel_m);
        let most_m = LARGEST_TOLERANCE * travel_m;
        let allowed_m = |omega_rad_s: f64| {
            noise.map_or(wanted_m, |noise| wanted_m.max(noise.followed_m(omega_rad_s)).min(most_m))
        };
        let found = match chosen_rad_s {
            Some(omega_rad_s) => chosen(&period.spectrum, omega_rad_s),
            None => self.above_noise(&period.spectrum, wanted_m, &allowed_m),
        };
        let input = noise.map(|noise| {
            let (residual, ..) = Residual::bracketed(&period.spectrum, found.tip_error_m);
            let coarse = residual.looser(residual.left_by(found.omega_rad_s), COARSE * travel_m);
            let octaves = libm::log2(found.omega_rad_s / coarse.omega_rad_s);
            let fall = libm::log2(coarse.error_m / found.tip_error_m) / octaves;
            let fall = match self.ends() {
                Ends::Periodic => fall.max(FALLS.0), // a cycle of few harmonics has no others
                // Over less than an octave the fall is unknown: assume a jerk that jumps.
                _ if octaves > 1.0 => fall.clamp(FALLS.0, FALLS.1),
                _ => USUAL_FALL,
            };
            let followed_m = allowed_m(found.omega_rad_s);
            InputBand {
                noise,
                sets_band: followed_m > wanted_m,
                followed_m,
                wanted_m: wanted_m.max(UNCERTAIN * travel_m),
                fall,
            }
        });
        Cutoff { input, ..found }
    }

    /// Keeps all frequencies of the samples, with the samples' uncertainty.
    fn all_frequencies(&self) -> Cutoff {
        let input = self.uncertain(0.0, self.farthest_m()).map(|noise| InputBand {
            noise,
            sets_band: true,
            followed_m: 0.0,
            wanted_m: 0.0,
            fall: FALLS.0,
        });
        Cutoff { input, ..Cutoff::ALL }
    }

    /// The lowest cut-off that removes at most `allowed_m`. If this exceeds `wanted_m`, a much lower cut-off that
    /// removes little more is better, because the frequencies between them are noise.
    fn above_noise(&self, spectrum: &TipSpectrum, wanted_m: f64, allowed_m: Allowed<'_>) -> Cutoff {
        let found = self.lowest(spectrum, allowed_m);
        if allowed_m(found.omega_rad_s) <= wanted_m {
            return found;
        }
        let eased = self.lowest(spectrum, &|omega_rad_s| EASED * allowed_m(omega_rad_s));
        if LOWERED * eased.omega_rad_s < found.omega_rad_s { eased } else { found }
    }

    /// The lowest cut-off that removes at most `allowed_m`, or the highest one with the reason why it removes more.
    fn lowest(&self, spectrum: &TipSpectrum, allowed_m: Allowed<'_>) -> Cutoff {
        let omegas = &spectrum.omegas_rad_s;
        let least_m = allowed_m(omegas[omegas.len() - 1] / ROLL_OFF);
        let (residual, low, high) = Residual::bracketed(spectrum, least_m);
        let high = residual.left_by(high);
        let (found, looser, shortfall) = if high.error_m > allowed_m(high.omega_rad_s) {
            let fall = libm::log2(residual.left_by(0.5 * high.omega_rad_s).error_m / high.error_m);
            let finer = libm::pow(least_m / high.error_m, 1.0 / SURE_FALL);
            let shortfall = if fall > LEAST_FALL {
                Shortfall::Step(STEP_MARGIN * finer * self.grid().step_s)
            } else {
                Shortfall::Noise
            };
            (high, high, Some(shortfall))
        } else {
            let low = residual.too_low(residual.left_by(low), allowed_m);
            let found = residual.lowest(low, high, allowed_m, PRECISION);
            let missed_m = residual.missed_m(omegas[omegas.len() - 1] / ROLL_OFF);
            let looser_m = LOOSER * allowed_m(found.omega_rad_s) + (LOOSER - 1.0) * missed_m;
            (found, residual.looser(found, looser_m), None)
        };
        found.cutoff(looser, shortfall)
    }
}

impl Left {
    /// The cut-off of exact samples, beside the one for the looser tolerance.
    fn cutoff(self, looser: Self, shortfall: Option<Shortfall>) -> Cutoff {
        Cutoff {
            omega_rad_s: self.omega_rad_s,
            looser_rad_s: looser.omega_rad_s,
            tip_error_m: self.error_m,
            shortfall,
            input: None,
        }
    }
}

/// The chosen cut-off, limited to the frequencies of the samples.
fn chosen(spectrum: &TipSpectrum, omega_rad_s: f64) -> Cutoff {
    let omegas = &spectrum.omegas_rad_s;
    let omega_rad_s = omega_rad_s.clamp(omegas[1], omegas[omegas.len() - 1] / ROLL_OFF);
    // Transforms all frequencies, because the error of the cut-off is not known yet.
    let (residual, ..) = Residual::bracketed(spectrum, f64::MIN_POSITIVE);
    let found = residual.left_by(omega_rad_s);
    found.cutoff(residual.looser(found, LOOSER * found.error_m), None)
}

impl Residual {
    /// The residual of a motion, and two cut-offs in rad/s that bracket the lowest one that removes at most
    /// `allowed_m`. The upper one may remove more if it is the highest possible.
    fn bracketed(spectrum: &TipSpectrum, allowed_m: f64) -> (Self, f64, f64) {
        let omegas = &spectrum.omegas_rad_s;
        let bins = spectrum.acceleration_m_s2.iter().zip(omegas);
        let mut displacement_m: Vec<_> = bins.map(|(a, omega)| -a / (omega * omega)).collect();
        displacement_m[0] = Complex64::ZERO;
        // The amplitudes from a bin on move the tip at most by their sum, and at some time by their root mean square.
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
        // At least eight samples per cycle of the highest frequency: the true peak is larger by some tenths of a
        // percent.
        let pair = FourierPair::new(fast_length(8 * top));
        let highest = omegas[omegas.len() - 1] / ROLL_OFF;
        let high = omegas[enough.min(omegas.len() - 1)].min(highest);
        let low = (omegas[too_low] / ROLL_OFF).max(0.5 * omegas[1]).min(high);
        let omegas_rad_s = omegas[..top].to_vec();
        (Self { omegas_rad_s, displacement_m, pair, left_out_m }, low, high)
    }

    /// The displacement that a cut-off removes.
    fn left_by(&self, omega_rad_s: f64) -> Left {
        let bins = self.displacement_m.iter().zip(&self.omegas_rad_s);
        let left: Vec<_> = bins.map(|(d, omega)| d * (1.0 - weight(*omega, omega_rad_s))).collect();
        let error_m = largest(&self.pair.samples(left)) + self.left_out_m;
        Left { omega_rad_s, error_m }
    }

    /// Displacement in m beyond the highest cut-off that the samples do not hold: they have no frequencies above Nyquist's,
    /// and those of a displacement that has kinks fall steeply below it. The error falls up to there as it does an octave
    /// lower.
    fn missed_m(&self, highest_rad_s: f64) -> f64 {
        let [quarter, half, whole] =
            [0.25, 0.5, 1.0].map(|share| self.left_by(share * highest_rad_s).error_m);
        let fall = (quarter / half).max(libm::exp2(FALLS.0));
        (half / fall - whole).max(0.0)
    }

    /// The lowest cut-off that removes at most `allowed_m`; `from` removes no more.
    fn looser(&self, from: Left, allowed_m: f64) -> Left {
        let low = self.too_low(self.left_by(0.5 * from.omega_rad_s), &|_| allowed_m);
        self.lowest(low, from, &|_| allowed_m, LOOSER_PRECISION)
    }

    /// A cut-off that removes more than allowed: `low` or one lower by octaves.
    fn too_low(&self, mut low: Left, allowed_m: Allowed<'_>) -> Left {
        // This ends: a cut-off near zero removes the whole motion, far more than any tolerance.
        while low.error_m <= allowed_m(low.omega_rad_s) && low.omega_rad_s > 0.0 {
            low = self.left_by(0.5 * low.omega_rad_s);
        }
        low
    }

    /// The lowest cut-off in a bracket that removes no more than allowed, to the relative precision `precision`; `high`
    /// removes no more than allowed.
    ///
    /// The error falls about as a power of the cut-off, so that the next trial lies on the power law through both ends.
    /// If more than half of the bracket remains, the next trial halves it.
    fn lowest(
        &self,
        mut low: Left,
        mut high: Left,
        allowed_m: Allowed<'_>,
        precision: f64,
    ) -> Left {
        let ratio = |low: Left, high: Left| libm::log(high.omega_rad_s / low.omega_rad_s);
        let mut is_power_law = true;
        while high.omega_rad_s > (1.0 + precision) * low.omega_rad_s {
            let width = ratio(low, high);
            let fall = libm::log(low.error_m / high.error_m);
            let share = libm::log(allowed_m(high.omega_rad_s) / high.error_m) / fall;
            let share = if is_power_law && share.is_finite() { share } else { 0.5 };
            // No closer to an end than closing the bracket needs.
            let least = 0.9 * precision;
            let below = (share * width).min(width - least).max(least.min(0.5 * width));
            let tried = self.left_by(high.omega_rad_s * libm::exp(-below));
            if tried.error_m <= allowed_m(tried.omega_rad_s) {
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

    /// Displacement that a cut-off removes from a motion, largest over times four to a step, by plain sums over all
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
            // Near the highest frequency the samples miss some of the motion.
            if found.omega_rad_s > 0.5 * PI / STEP_S / ROLL_OFF {
                continue;
            }
            let looser_m = left_out_m(&motion, found.looser_rad_s);
            assert!(looser_m <= 1.005 * LOOSER * allowed_m, "{tolerance}: {looser_m}");
            assert!(left_out_m(&motion, 0.95 * found.looser_rad_s) > 0.98 * LOOSER * allowed_m);
        }
    }

    /// A displacement with kinks, sampled so that the cut-off lies near the highest frequency: the error of the looser
    /// cut-off, measured on samples sixteen times as dense, is twice that of the cut-off.
    #[test]
    fn the_looser_cut_off_counts_what_the_samples_do_not_hold() {
        let sampled = |often: usize| {
            let steps = 50 * often;
            let at = |k: usize| (k as f64 / steps as f64 - 0.5).clamp(0.0, 1.0);
            let columns = MotionColumns {
                time_s: (0..=2 * steps).map(|k| k as f64 / steps as f64).collect(),
                displacement_m: Some(
                    (0..=2 * steps).map(|k| TRAVEL_M * Profile::BangBang.share(at(k))).collect(),
                ),
                ..Default::default()
            };
            TipMotion::new(columns).unwrap()
        };
        let (coarse, dense) = (sampled(1), sampled(16));
        let found = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5].map(|tolerance| coarse.cutoff(tolerance));
        let near = found.iter().rfind(|own| own.shortfall.is_none()).unwrap();
        let (given, len) = (dense.grid().len, 4 * dense.grid().len);
        let period = dense.over_period(len, given.midpoint(len), Cutoff::ALL);
        let (residual, ..) = Residual::bracketed(&period.spectrum, f64::MIN_POSITIVE);
        let [own, looser] =
            [near.omega_rad_s, near.looser_rad_s].map(|omega| residual.left_by(omega).error_m);
        assert!(own > 1.3 * near.tip_error_m, "{own} {near:?}");
        assert!((1.5..3.0).contains(&(looser / own)), "{looser} {own} {near:?}");
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
