use std::f64::consts::PI;

use num_complex::Complex64;

use super::spectrum::TipSpectrum;
use super::tip_motion::TipMotion;
use crate::numeric::{FourierPair, fast_length, largest};

/// The roll-off ends at so many times the cut-off.
const ROLL_OFF: f64 = 1.5;

/// The cut-off is found to this share of itself, and that of a looser tolerance to this one.
const PRECISION: f64 = 1e-3;
const LOOSER_PRECISION: f64 = 2e-2;

/// Factor on the tolerance by which the torque must not be changed much.
pub const LOOSER: f64 = 2.0;

/// Share of the tolerated error that may lie above the highest frequency that the search transforms; it
/// is added to every error found.
const ABOVE_TRANSFORM: f64 = 1e-2;

/// Fall of the tip's error with frequency, as a power, below which a finer step does not help: the
/// samples hold noise or rounding. Those of rounded digits fall by 0.4 to 1.5, those of an acceleration
/// that jumps by 2.
const LEAST_FALL: f64 = 1.7;

/// Fall beyond the Nyquist frequency that a step is suggested by: near it the fall is steeper than beyond,
/// where it is 2 if the acceleration jumps.
const SURE_FALL: f64 = 2.0;

/// Factor on the step that this fall gives.
const STEP_MARGIN: f64 = 0.6;

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
    /// The same in rad/s for [`LOOSER`] times the tolerance.
    pub looser_rad_s: f64,
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
    pub const ALL: Self = Self {
        omega_rad_s: f64::INFINITY,
        looser_rad_s: f64::INFINITY,
        tip_error_m: 0.0,
        shortfall: None,
    };

    /// Whether every frequency is kept.
    pub fn keeps_all(&self) -> bool {
        self.omega_rad_s.is_infinite()
    }

    /// Factor on the amplitude at ω ≥ 0: 1 up to the cut-off, then a raised cosine over half of it.
    pub fn weight(&self, omega_rad_s: f64) -> f64 {
        weight(omega_rad_s, self.omega_rad_s)
    }

    /// Factor on an amplitude that has this weight, with which it has that of the looser tolerance.
    pub fn weight_of_looser(&self, omega_rad_s: f64) -> f64 {
        let own = self.weight(omega_rad_s);
        if own > 0.0 { weight(omega_rad_s, self.looser_rad_s) / own } else { 0.0 }
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

/// A cut-off, and the largest displacement in m, at any time, of what it leaves out.
#[derive(Clone, Copy)]
struct Left {
    omega_rad_s: f64,
    error_m: f64,
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
        // Four times as long as it moves: with less rest around it, a low cut-off would be another.
        let moves = |a: &f64| *a != 0.0;
        let forcing = self.forcing_m_s2();
        let first = forcing.iter().position(moves).unwrap_or(0);
        let last = forcing.iter().rposition(moves).unwrap_or(0);
        let len = fast_length(self.grid().len.max(4 * (last + 1 - first)));
        let spectrum = self.spectrum(len, self.grid().len.midpoint(len));
        let allowed_m = tolerance * self.histories(&spectrum).way_m();
        let (residual, low, high) = Residual::bracketed(&spectrum, allowed_m);
        let high = residual.left_by(high);
        if high.error_m > allowed_m {
            let fall = libm::log2(residual.left_by(0.5 * high.omega_rad_s).error_m / high.error_m);
            let finer = libm::pow(allowed_m / high.error_m, 1.0 / SURE_FALL);
            let shortfall = if fall > LEAST_FALL {
                Shortfall::Step(STEP_MARGIN * finer * self.grid().step_s)
            } else {
                Shortfall::Noise
            };
            return Cutoff {
                omega_rad_s: high.omega_rad_s,
                looser_rad_s: high.omega_rad_s,
                tip_error_m: high.error_m,
                shortfall: Some(shortfall),
            };
        }
        let found = residual.lowest(residual.left_by(low), high, allowed_m, PRECISION);
        let allowed_m = LOOSER * allowed_m;
        let mut low = residual.left_by(0.5 * found.omega_rad_s);
        // Ends: a tolerance is far below what a cut-off near zero leaves, the whole motion.
        while low.error_m <= allowed_m {
            low = residual.left_by(0.5 * low.omega_rad_s);
        }
        let looser = residual.lowest(low, found, allowed_m, LOOSER_PRECISION);
        Cutoff {
            omega_rad_s: found.omega_rad_s,
            looser_rad_s: looser.omega_rad_s,
            tip_error_m: found.error_m,
            shortfall: None,
        }
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
        // Eight samples a cycle of the highest frequency, and mostly more: between them the tip is farther
        // by some tenths of a percent.
        let pair = FourierPair::new(fast_length(8 * top));
        let highest = omegas[omegas.len() - 1] / ROLL_OFF;
        let high = omegas[enough.min(omegas.len() - 1)].min(highest);
        let low = (omegas[too_low] / ROLL_OFF).max(0.5 * omegas[1]).min(high);
        let omegas_rad_s = omegas[..top].to_vec();
        (Self { omegas_rad_s, displacement_m, pair, left_out_m }, low, high)
    }

    /// What a cut-off leaves out.
    fn left_by(&self, omega_rad_s: f64) -> Left {
        let bins = self.displacement_m.iter().zip(&self.omegas_rad_s);
        let left: Vec<_> = bins.map(|(d, omega)| d * (1.0 - weight(*omega, omega_rad_s))).collect();
        let error_m = largest(&self.pair.samples(left)) + self.left_out_m;
        Left { omega_rad_s, error_m }
    }

    /// The lowest cut-off between two that leaves no more than `allowed_m`, as the higher one does; found to
    /// the share `precision` of itself.
    ///
    /// The error falls about as a power of the cut-off, so that the next one tried lies on the power law
    /// through both ends. If that left more than half of the bracket, the next one halves it.
    fn lowest(&self, mut low: Left, mut high: Left, allowed_m: f64, precision: f64) -> Left {
        let ratio = |low: Left, high: Left| libm::log(high.omega_rad_s / low.omega_rad_s);
        let mut is_power_law = true;
        while high.omega_rad_s > (1.0 + precision) * low.omega_rad_s {
            let width = ratio(low, high);
            let fall = libm::log(low.error_m / high.error_m);
            let share = libm::log(allowed_m / high.error_m) / fall;
            let share = if is_power_law && share.is_finite() { share } else { 0.5 };
            // No closer to an end than what closes the bracket.
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
    use std::f64::consts::TAU;

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
        let samples = motion.forcing_m_s2();
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
