//! Analytic motions.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use std::fmt;

use super::error::MotionError;
use super::samples::MotionColumns;
use super::tip_motion::TipMotion;

/// Shape of a tip motion from rest to rest, over the share u of its duration.
///
/// All are symmetric: the tip loses after the middle the velocity gained before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// One period of a sine acceleration: `d = u − sin(2πu)/2π`.
    Sine,
    /// Harmonic, with jumps of the acceleration at both ends: `d = (1 − cos πu)/2`.
    Versine,
    /// Least jerk, a polynomial of fifth degree: `d = 10u³ − 15u⁴ + 6u⁵`.
    MinJerk,
    /// Polynomial of seventh degree, whose jerk starts and ends at zero:
    /// `d = 35u⁴ − 84u⁵ + 70u⁶ − 20u⁷`.
    Septic,
    /// Constant acceleration, velocity and deceleration, a third of the time each.
    Trapezoid,
    /// Trapezoid with linear ramps of the acceleration (limited jerk), each a twelfth of the time.
    SCurve,
    /// Full acceleration for half of the time, then full deceleration.
    BangBang,
    /// Velocity as a Gaussian bell, with six standard deviations to each end.
    Gaussian,
}

impl Profile {
    /// All profiles.
    pub const ALL: [Self; 8] = [
        Self::Sine,
        Self::Versine,
        Self::MinJerk,
        Self::Septic,
        Self::Trapezoid,
        Self::SCurve,
        Self::BangBang,
        Self::Gaussian,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sine => "sine",
            Self::Versine => "versine",
            Self::MinJerk => "min-jerk",
            Self::Septic => "septic",
            Self::Trapezoid => "trapezoid",
            Self::SCurve => "s-curve",
            Self::BangBang => "bang-bang",
            Self::Gaussian => "gaussian",
        }
    }

    /// Acceleration at u in [0, 1/2], up to a factor.
    fn acceleration(self, u: f64) -> f64 {
        match self {
            Self::Sine => libm::sin(TAU * u),
            Self::Versine => libm::cos(PI * u),
            Self::MinJerk => u * (1.0 - 3.0 * u + 2.0 * u * u),
            Self::Septic => u * u * (1.0 - u).powi(2) * (1.0 - 2.0 * u),
            Self::Trapezoid if u > 1.0 / 3.0 => 0.0,
            Self::Trapezoid | Self::BangBang => 1.0,
            // Rises in the first twelfth, falls in the fourth.
            Self::SCurve => (12.0 * u).min(4.0 - 12.0 * u).clamp(0.0, 1.0),
            Self::Gaussian => {
                let s = 12.0 * (u - 0.5);
                -s * libm::exp(-0.5 * s * s)
            }
        }
    }

    /// True if the acceleration begins or ends with a jump.
    pub(super) fn jumps_at_its_ends(self) -> bool {
        matches!(self, Self::Versine | Self::Trapezoid | Self::BangBang)
    }

    /// Share of the distance at the share u of the duration, both in [0, 1]: the integral of the velocity in closed
    /// form.
    ///
    /// ```
    /// use flexlink::motion::Profile;
    /// assert_eq!([0.0, 0.5, 1.0].map(|u| Profile::Septic.share(u)), [0.0, 0.5, 1.0]);
    /// ```
    pub fn share(self, u: f64) -> f64 {
        if u > 0.5 { 1.0 - self.first_half(1.0 - u) } else { self.first_half(u) }
    }

    /// The share at u in [0, 1/2].
    pub(super) fn first_half(self, u: f64) -> f64 {
        match self {
            Self::Sine => u - libm::sin(TAU * u) / TAU,
            Self::Versine => libm::sin(0.5 * PI * u).powi(2),
            Self::MinJerk => u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u),
            Self::Septic => u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3)),
            Self::Trapezoid if u < 1.0 / 3.0 => 2.25 * u * u,
            Self::SCurve if u < 1.0 / 12.0 => 12.0 * u.powi(3),
            Self::SCurve if u < 0.25 => 3.0 * u * u - 0.25 * u + 1.0 / 144.0,
            Self::SCurve if u < 1.0 / 3.0 => 1.5 * u - 0.25 + 12.0 * (1.0 / 3.0 - u).powi(3),
            Self::Trapezoid | Self::SCurve => 1.5 * u - 0.25,
            Self::BangBang => 2.0 * u * u,
            Self::Gaussian => {
                // The bell minus its height at the ends, so that the velocity starts at zero.
                let bell = |s: f64| {
                    (0.5 * PI).sqrt() * libm::erf(s * FRAC_1_SQRT_2) - libm::exp(-18.0) * s
                };
                0.5 - 0.5 * bell(6.0 - 12.0 * u) / bell(6.0)
            }
        }
    }

    /// The motion over `distance_m` in `duration_s`, sampled at `steps` + 1 times.
    ///
    /// # Errors
    /// [`MotionError`] for fewer than three steps, or a distance or duration without a motion.
    pub fn motion(
        self,
        distance_m: f64,
        duration_s: f64,
        steps: usize,
    ) -> Result<TipMotion, MotionError> {
        TipMotion::new(self.sampled(distance_m, duration_s / steps as f64, steps, [0, 0]))
    }

    /// Samples of the motion at `steps` + 1 times from `rest[0]` steps after 0 s on, at rest for `rest[0]` steps before
    /// and `rest[1]` after it.
    ///
    /// Accelerations are antisymmetric about the middle to the last bit, so that the samples end at rest, and scaled so
    /// that [`TipMotion`] adds them up to `distance_m`. A jump falls on a sample: at the ends the sample has the inner
    /// value, in the middle zero. [`TipMotion::new`] refuses fewer than three steps, which contain no motion.
    pub fn sampled(
        self,
        distance_m: f64,
        step_s: f64,
        steps: usize,
        rest: [usize; 2],
    ) -> MotionColumns {
        let at = |k: usize| match (2 * k).cmp(&steps) {
            std::cmp::Ordering::Less => self.acceleration(k as f64 / steps as f64),
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => -self.acceleration((steps - k) as f64 / steps as f64),
        };
        // ∫v dt = −∫ t a dt, from rest to rest, about the middle.
        let middle = 0.5 * steps as f64;
        let travel: f64 = (0..=steps).map(|k| (middle - k as f64) * at(k)).sum();
        let scale = distance_m / (travel * step_s * step_s);
        let samples = rest[0] + steps + 1 + rest[1];
        let acceleration = |k: usize| match k.checked_sub(rest[0]) {
            Some(own) if own <= steps => scale * at(own),
            _ => 0.0,
        };
        MotionColumns {
            time_s: (0..samples).map(|k| k as f64 * step_s).collect(),
            acceleration_m_s2: Some((0..samples).map(acceleration).collect()),
            ..MotionColumns::default()
        }
    }
}

impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::TipMotion;

    #[test]
    fn every_profile_ends_at_rest_where_it_should() {
        for profile in Profile::ALL {
            for (steps, rest) in [(200, [0, 0]), (201, [7, 0]), (4, [0, 9])] {
                let motion = TipMotion::new(profile.sampled(-0.4, 2e-3, steps, rest)).unwrap();
                assert_eq!(motion.corrected(), None, "{profile}, {steps} steps");
                let error = motion.travel_m() + 0.4;
                assert!(error.abs() < 1e-14, "{profile}, {steps} steps: {error:e}");
            }
        }
    }

    #[test]
    fn shares_are_the_second_integrals_of_the_accelerations() {
        let steps = 24_000_u32;
        let step = f64::from(steps).recip();
        for profile in Profile::ALL {
            let share = |k: u32| profile.share(f64::from(k) * step);
            assert!(share(0).abs() < 1e-16 && (share(steps) - 1.0).abs() < 1e-16, "{profile}");
            let columns = profile.sampled(1.0, step, 24_000, [0, 0]);
            let samples = columns.acceleration_m_s2.unwrap();
            let (mut rate, mut sum) = (0.0, 0.0);
            for (k, pair) in (1..).zip(samples.windows(2)) {
                sum += step * (rate + step * (pair[0] / 3.0 + pair[1] / 6.0));
                rate += 0.5 * step * (pair[0] + pair[1]);
                // Trapezoidal sums of the accelerations: error of second order, or of first order at jumps.
                let jumps = [Profile::Versine, Profile::Trapezoid, Profile::BangBang];
                let most = if jumps.contains(&profile) { 4.0 * step } else { 1e-7 };
                let off = sum - share(k);
                assert!(off.abs() < most, "{profile} at {k}: {off:e}");
            }
        }
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        for steps in 0..3 {
            assert!(Profile::Sine.motion(0.5, 0.88, steps).is_err(), "{steps} steps passed");
        }
        for (distance_m, duration_s) in [(0.0, 1.0), (0.5, 0.0), (f64::NAN, 1.0), (0.5, -1.0)] {
            let refused = Profile::Sine.motion(distance_m, duration_s, 100);
            assert!(refused.is_err(), "{distance_m} m in {duration_s} s passed");
        }
        let motion = Profile::Sine.motion(0.5, 0.88, 220).unwrap();
        assert!((motion.grid().time_s(220) - 0.88).abs() < 1e-12);
    }

    #[test]
    fn accelerations_are_the_second_derivatives_of_the_formulas() {
        type Formula = fn(f64) -> f64;
        let formulas: [(Profile, Formula); 4] = [
            (Profile::Sine, |u| TAU * (TAU * u).sin()),
            (Profile::MinJerk, |u| 60.0 * u - 180.0 * u * u + 120.0 * u.powi(3)),
            (Profile::Septic, |u| {
                420.0 * u.powi(2) - 1680.0 * u.powi(3) + 2100.0 * u.powi(4) - 840.0 * u.powi(5)
            }),
            (Profile::SCurve, |u| {
                // Full acceleration for a quarter of the time, on average; the speed is 3/2.
                let half = if u <= 0.5 { u } else { 1.0 - u };
                let peak = 6.0 * (12.0 * half).min(4.0 - 12.0 * half).clamp(0.0, 1.0);
                if u <= 0.5 { peak } else { -peak }
            }),
        ];
        let steps = 2400_u32;
        for (profile, exact) in formulas {
            let columns = profile.sampled(1.0, 1.0 / f64::from(steps), 2400, [0, 0]);
            let samples = columns.acceleration_m_s2.unwrap();
            for (k, found) in (0..).zip(&samples) {
                let exact = exact(f64::from(k) / f64::from(steps));
                assert!((found - exact).abs() < 1e-4, "{profile} at {k}: {found} is not {exact}");
            }
        }
    }
}
