//! How strongly a profile excites a mode, and the durations at which it does not.

use super::profile::Profile;
use crate::numeric::GaussRule;

/// Pieces of half the duration, between whose ends every profile is smooth, and Gauss points of each.
const PIECES: usize = 6;
const POINTS: usize = 32;

/// Distance of the phases among which zeros are sought, and number of halvings of this distance.
const SCAN: f64 = 0.1;
const BISECTIONS: usize = 50;

/// Amplitude below which a minimum is a double zero.
const DOUBLE: f64 = 1e-12;

/// Excitation of a mode by a profile over the phase x = ωT, T being the duration: `|A(ω)|/ω` over the distance, with
/// `A(ω) = ∫ a e^{−iωt} dt` of the acceleration. It is the vibration that the motion leaves in an undamped mode whose
/// frequency ω changes, over the relative change of the mode's stiffness.
#[derive(Debug, Clone)]
pub struct Excitation {
    /// Places s after the middle over the duration, and displacements from the middle there times Gauss weights.
    points: Vec<[f64; 2]>,
}

impl Excitation {
    /// That of a profile.
    pub fn of(profile: Profile) -> Self {
        let rule = GaussRule::new(POINTS);
        let width = 0.5 / PIECES as f64;
        let pieces = (0..PIECES).map(|piece| (piece as f64 + 0.5) * width);
        let points = pieces.flat_map(|middle| {
            rule.places.iter().zip(&rule.weights).map(move |(place, weight)| {
                let s = middle + 0.5 * width * place;
                [s, weight * width * (0.5 - profile.first_half(0.5 - s))]
            })
        });
        Self { points: points.collect() }
    }

    /// The excitation at a phase.
    ///
    /// # Examples
    /// ```
    /// use flexlink::motion::{Excitation, Profile};
    /// // A slow mode follows, one of 4 half periods in the sine's duration stays at rest.
    /// let sine = Excitation::of(Profile::Sine);
    /// assert!((sine.at(0.0) - 1.0).abs() < 1e-12 && sine.at(4.0 * std::f64::consts::PI) < 1e-12);
    /// ```
    pub fn at(&self, phase: f64) -> f64 {
        self.spectrum(phase).0.abs()
    }

    /// Phases without excitation, ascending, up to `most`.
    pub fn quiet_phases(&self, most: f64) -> impl Iterator<Item = f64> {
        // Simple zeros change the sign of the amplitude, double ones that of its slope alone.
        let places = (1..).map(|k| SCAN * f64::from(k)).take_while(move |x| *x < most);
        places.filter_map(move |low| {
            let of = |x: f64| self.spectrum(x);
            let (before, after) = (of(low), of(low + SCAN));
            let crosses = |a: f64, b: f64| a.is_sign_negative() != b.is_sign_negative();
            if crosses(before.0, after.0) {
                return Some(bisected(low, |x| crosses(before.0, of(x).0)));
            }
            let turns = crosses(before.1, after.1);
            let turn = turns.then(|| bisected(low, |x| crosses(before.1, of(x).1)))?;
            (of(turn).0.abs() < DOUBLE).then_some(turn)
        })
    }

    /// `∫ v cos(xs) ds` of the velocity over the share s of the duration, from the middle, and its derivative. By parts,
    /// with the displacement h from the middle, it is `cos(x/2) + 2x ∫ h sin(xs) ds` over the second half.
    fn spectrum(&self, x: f64) -> (f64, f64) {
        let (mut sum, mut slope) = (0.0, 0.0);
        for [s, h] in &self.points {
            let (sin, cos) = (libm::sin(x * s), libm::cos(x * s));
            sum += h * sin;
            slope += h * (sin + x * s * cos);
        }
        let ends = [libm::cos(0.5 * x), -0.5 * libm::sin(0.5 * x)];
        (ends[0] + 2.0 * x * sum, ends[1] + 2.0 * slope)
    }
}

/// The place in (low, low + [`SCAN`]) from which on `is_beyond` holds.
fn bisected(low: f64, is_beyond: impl Fn(f64) -> bool) -> f64 {
    let (low, high) = (0..BISECTIONS).fold((low, low + SCAN), |(low, high), _| {
        let middle = 0.5 * (low + high);
        if is_beyond(middle) { (low, middle) } else { (middle, high) }
    });
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn quiet_phases_are_the_zeros_of_the_closed_spectra() {
        let phases =
            |profile: Profile| Excitation::of(profile).quiet_phases(31.0).collect::<Vec<f64>>();
        // Zeros of the velocity's transform: a sine, half a period of a cosine, and products of two boxes.
        let known: [(Profile, &[f64]); 4] = [
            (Profile::Sine, &[4.0, 6.0, 8.0]),
            (Profile::Versine, &[3.0, 5.0, 7.0, 9.0]),
            (Profile::Trapezoid, &[3.0, 6.0, 9.0]),
            (Profile::BangBang, &[4.0, 8.0]),
        ];
        for (profile, in_pi) in known {
            let found = phases(profile);
            assert_eq!(found.len(), in_pi.len(), "{profile}: {found:?}");
            for (found, known) in found.iter().zip(in_pi) {
                assert!((found - known * PI).abs() < 1e-6, "{profile}: {found}");
            }
        }
        for profile in Profile::ALL {
            let (own, found) = (Excitation::of(profile), phases(profile));
            assert!(found.iter().all(|x| own.at(*x) < 1e-12), "{profile}: {found:?}");
        }
        let first = phases(Profile::MinJerk)[0];
        assert!((first - 11.5269).abs() < 1e-3, "{first}");
    }

    #[test]
    fn amplitudes_are_the_integrals_of_the_accelerations() {
        let steps = 24_000_u32;
        let step = f64::from(steps).recip();
        for profile in [Profile::Sine, Profile::MinJerk, Profile::Septic, Profile::SCurve] {
            let samples = profile.sampled(1.0, step, 24_000, [0, 0]).acceleration_m_s2.unwrap();
            for x in [0.5, 3.0, 17.0, 60.0] {
                // About the middle the acceleration is odd.
                let part = |(k, a): (u32, &f64)| a * libm::sin(x * (f64::from(k) * step - 0.5));
                let integral = step * (0..).zip(&samples).map(part).sum::<f64>();
                let off = (integral / x).abs() - Excitation::of(profile).at(x);
                assert!(off.abs() < 1e-7, "{profile} at {x}: {off:e}");
            }
        }
    }
}
