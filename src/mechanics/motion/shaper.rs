//! Input shapers, and the law of a travel over time: a profile, shaped.

use std::f64::consts::PI;
use std::fmt;

use num_complex::Complex64;

use super::profile::Profile;
use crate::numeric::{CubicSpline, SplineEnds, magnitude};

/// Vibration that the robust shapers allow at their worst, over that of an unshaped command.
pub const ALLOWED: f64 = 0.05;

/// Steps of a shaper's duration that are round-off.
const ROUND_OFF: f64 = 1e-9;

/// Kind of an input shaper for one mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shaping {
    /// Zero vibration: two impulses, half a period long.
    Zv,
    /// Zero vibration and derivative: three impulses, a period long.
    Zvd,
    /// Extra-insensitive: three impulses, a period long, with [`ALLOWED`] vibration at the mode and zeros beside it.
    Ei,
    /// Two humps of [`ALLOWED`] vibration, and three zeros: four impulses, one and a half periods long.
    TwoHump,
}

impl Shaping {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Zv, Self::Zvd, Self::Ei, Self::TwoHump];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Zv => "zv",
            Self::Zvd => "zvd",
            Self::Ei => "ei",
            Self::TwoHump => "2hump",
        }
    }

    /// Shares of the impulses for an undamped mode and this allowed vibration.
    ///
    /// W. E. Singhose, W. P. Seering, N. C. Singer, J. Mechanical Design 116(2), 1994 (EI); W. E. Singhose, S. Derezinski,
    /// N. C. Singer, J. Guidance, Control, and Dynamics 19(2), 1996 (two humps).
    fn undamped(self, allowed: f64) -> Vec<f64> {
        match self {
            Self::Zv => vec![0.5, 0.5],
            Self::Zvd => vec![0.25, 0.5, 0.25],
            Self::Ei => {
                let outer = 0.25 * (1.0 + allowed);
                vec![outer, 0.5 * (1.0 - allowed), outer]
            }
            Self::TwoHump => {
                let square = allowed * allowed;
                let x = libm::cbrt(square * ((1.0 - square).sqrt() + 1.0));
                let outer = (3.0 * x * x + 2.0 * x + 3.0 * square) / (16.0 * x);
                vec![outer, 0.5 - outer, 0.5 - outer, outer]
            }
        }
    }
}

impl fmt::Display for Shaping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// An input shaper: replaces a command by a sum of its delayed shares, so that modes do not ring after it.
///
/// The shares are not negative and add up to 1; the first has no delay. The default is the shaper of one impulse, which
/// changes nothing.
///
/// ```
/// use flexlink::motion::{Shaper, Shaping};
///
/// let mode_rad_s = 18.4;
/// let shaper = Shaper::new(Shaping::Zv, mode_rad_s, 0.005).expect("a mode that vibrates");
/// assert!(shaper.residual(mode_rad_s, 0.005) < 1e-15);
/// // Off by 5 %, some vibration is left: cos(π/2 · 1.05) without damping.
/// assert!((shaper.residual(1.05 * mode_rad_s, 0.005) - 0.0785).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Shaper {
    /// Delay in s and share of each impulse, by their delays.
    impulses: Vec<(f64, f64)>,
}

impl Default for Shaper {
    fn default() -> Self {
        Self { impulses: vec![(0.0, 1.0)] }
    }
}

impl Shaper {
    /// The shaper for a mode of this undamped frequency in rad/s and damping ratio. `None` unless the mode vibrates.
    ///
    /// The impulses are half a damped period apart, their shares fall by `K = e^{−πζ/√(1−ζ²)}` from one to the next. The
    /// zeros of the shaper thus lie at the mode's rate of decay ζω, at each frequency where the undamped shaper has one.
    /// The vibration that EI allows at the mode, and two humps beside it, is [`ALLOWED`] with damping, too.
    pub fn new(shaping: Shaping, omega_rad_s: f64, ratio: f64) -> Option<Self> {
        if !(omega_rad_s > 0.0 && omega_rad_s.is_finite() && (0.0..1.0).contains(&ratio)) {
            return None;
        }
        let root = (1.0 - ratio * ratio).sqrt();
        let half_period_s = PI / (omega_rad_s * root);
        let falls = |steps: usize| libm::exp(-PI * ratio / root * steps as f64);
        let shares = |allowed| {
            let undamped = shaping.undamped(allowed).into_iter().enumerate();
            let shares: Vec<f64> = undamped.map(|(k, own)| own * falls(k)).collect();
            let sum: f64 = shares.iter().sum();
            // Vibration left at the mode or the humps, over that of the undamped shaper.
            let left = falls(shares.len() - 1) / sum;
            (shares.into_iter().map(|own| own / sum).collect::<Vec<_>>(), left)
        };
        // The shares depend weakly on the allowed vibration: each step adds digits.
        let allowed = (0..60).fold(ALLOWED, |allowed, _| (ALLOWED / shares(allowed).1).min(1.0));
        let delayed = shares(allowed).0.into_iter().enumerate();
        Some(Self { impulses: delayed.map(|(k, own)| (k as f64 * half_period_s, own)).collect() })
    }

    /// The shaper for the modes of both: each impulse of one, shaped by the other.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let both = self.impulses.iter().flat_map(|(delay_s, share)| {
            other.impulses.iter().map(move |(more_s, part)| (delay_s + more_s, share * part))
        });
        let mut impulses: Vec<_> = both.collect();
        impulses.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { impulses }
    }

    /// Delay in s and share of each impulse.
    pub fn impulses(&self) -> &[(f64, f64)] {
        &self.impulses
    }

    /// Time in s by which a shaped command lasts longer.
    pub fn duration_s(&self) -> f64 {
        self.impulses.last().map_or(0.0, |(delay_s, _)| *delay_s)
    }

    /// Vibration that this shaper leaves in a mode: its amplitude after the last impulse, over the amplitude after a
    /// single impulse. The mode has this undamped frequency in rad/s and damping ratio.
    ///
    /// Without damping it is `|cos(πr/2)|` for ZV and `cos²(πr/2)` for ZVD, r being the frequency over that of the
    /// shaper.
    pub fn residual(&self, omega_rad_s: f64, ratio: f64) -> f64 {
        let decay_per_s = ratio * omega_rad_s;
        let damped_rad_s = omega_rad_s * (1.0 - ratio * ratio).max(0.0).sqrt();
        let last_s = self.duration_s();
        let rings = self.impulses.iter().map(|(delay_s, share)| {
            let (size, phase) = (decay_per_s * (delay_s - last_s), damped_rad_s * delay_s);
            Complex64::new(libm::cos(phase), libm::sin(phase)) * (share * libm::exp(size))
        });
        magnitude(rings.sum())
    }

    /// A function of time in s, shaped, at a time.
    pub fn shaped(&self, command: impl Fn(f64) -> f64, time_s: f64) -> f64 {
        self.impulses.iter().map(|(delay_s, share)| share * command(time_s - delay_s)).sum()
    }

    /// Samples of a command from rest to rest, shaped: as many, and those of the rest until the shaper ends. A cubic
    /// spline through them gives the command between them.
    ///
    /// # Panics
    /// With fewer than 4 samples.
    pub fn shaped_samples(&self, samples: &[f64], step_s: f64) -> Vec<f64> {
        let spline = CubicSpline::uniform(samples, SplineEnds::Clamped);
        let last = samples.len() - 1;
        let command = |time_s: f64| spline.value((time_s / step_s).clamp(0.0, last as f64));
        let all = last + more_steps(self.duration_s(), step_s);
        (0..=all).map(|k| self.shaped(command, k as f64 * step_s)).collect()
    }
}

/// Whole steps of at least this duration.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
fn more_steps(duration_s: f64, step_s: f64) -> usize {
    (duration_s / step_s - ROUND_OFF).ceil() as usize
}

/// Law of a travel over time: a profile, shaped.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    profile: Profile,
    /// Delay in steps and share of each impulse.
    impulses: Vec<(f64, f64)>,
    /// Steps by which each move lasts longer than the profile.
    more_steps: usize,
}

impl From<Profile> for Law {
    fn from(profile: Profile) -> Self {
        Self::shaped(profile, &Shaper::default(), 1.0)
    }
}

impl Law {
    /// A profile with a shaper, sampled at a step in s.
    pub fn shaped(profile: Profile, shaper: &Shaper, step_s: f64) -> Self {
        let impulses = shaper.impulses.iter().map(|(delay_s, share)| (delay_s / step_s, *share));
        let more_steps = more_steps(shaper.duration_s(), step_s);
        Self { profile, impulses: impulses.collect(), more_steps }
    }

    /// The profile.
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// Steps by which each move from stop to stop lasts longer than the profile.
    pub fn more_steps(&self) -> usize {
        self.more_steps
    }

    /// Places of a move after its start, at each step: `steps` for the profile, and more for the shaper.
    pub(super) fn places_m(
        &self,
        from_m: f64,
        to_m: f64,
        steps: usize,
    ) -> impl Iterator<Item = f64> {
        let all = steps + self.more_steps;
        (1..=all).map(move |k| {
            // From the nearer end, so that both ends are met exactly.
            let is_first = 2 * k <= all;
            let near = self.impulses.iter().map(|(delay, share)| {
                let own = k as f64 - delay;
                let own = if is_first { own } else { steps as f64 - own };
                share * self.profile.share((own / steps as f64).clamp(0.0, 1.0))
            });
            let near_m = (to_m - from_m) * near.sum::<f64>();
            if is_first { from_m + near_m } else { to_m - near_m }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OMEGA_RAD_S: f64 = 18.4;

    fn shaper(shaping: Shaping, ratio: f64) -> Shaper {
        Shaper::new(shaping, OMEGA_RAD_S, ratio).unwrap()
    }

    #[test]
    fn vibrations_of_two_impulses_and_three_have_closed_forms() {
        for k in 0..200 {
            let r = 0.01 * f64::from(k);
            let cos = libm::cos(0.5 * PI * r).abs();
            let left = |shaping| shaper(shaping, 0.0).residual(r * OMEGA_RAD_S, 0.0);
            assert!((left(Shaping::Zv) - cos).abs() < 1e-14, "{r}");
            assert!((left(Shaping::Zvd) - cos * cos).abs() < 1e-14, "{r}");
        }
    }

    #[test]
    fn durations_and_widths_without_damping_are_the_published_ones() {
        let widths = [(Shaping::Zv, 0.5, 3.2, 6.4), (Shaping::Zvd, 1.0, 14.4, 20.5)];
        let more = [(Shaping::Ei, 1.0, 20.0, 24.7), (Shaping::TwoHump, 1.5, 36.2, 40.3)];
        for (shaping, periods, of_5, of_10) in widths.into_iter().chain(more) {
            let shaper = shaper(shaping, 0.0);
            let found = shaper.duration_s() * OMEGA_RAD_S / (2.0 * PI);
            assert!((found - periods).abs() < 1e-14, "{shaping}: {found}");
            for (most, width) in [(0.05, of_5), (0.1, of_10)] {
                // The humps of 5 % touch their bound.
                let is_in = |off: f64| {
                    let left = |r: f64| shaper.residual(r * OMEGA_RAD_S, 0.0);
                    left(1.0 + off).max(left(1.0 - off)) <= most + 1e-12
                };
                let first_out = (1..1000).map(|k| 1e-3 * f64::from(k)).find(|off| !is_in(*off));
                let found = 100.0 * first_out.unwrap();
                assert!((found - width).abs() < 0.2, "{shaping}, {most}: {found} %");
            }
        }
    }

    #[test]
    fn with_damping_a_mode_keeps_nothing_or_what_is_allowed() {
        for ratio in [0.0, 0.005, 0.05, 0.2] {
            for shaping in Shaping::ALL {
                let shaper = shaper(shaping, ratio);
                let sum: f64 = shaper.impulses().iter().map(|own| own.1).sum();
                assert!((sum - 1.0).abs() < 1e-14 && shaper.impulses().iter().all(|o| o.1 > 0.0));
                // Modes of the same rate of decay.
                let left = |off: f64| {
                    let (decay, root) = (ratio * OMEGA_RAD_S, (1.0 - ratio * ratio).sqrt());
                    let damped = (1.0 + off) * OMEGA_RAD_S * root;
                    let omega = libm::hypot(damped, decay);
                    shaper.residual(omega, decay / omega)
                };
                let at_mode = left(0.0);
                let highest = (0..400).map(|k| left(1e-3 * f64::from(k))).enumerate();
                let hump =
                    highest.take_while(|(k, _)| *k < 350).map(|own| own.1).fold(0.0, f64::max);
                match shaping {
                    Shaping::Ei => assert!((at_mode - ALLOWED).abs() < 1e-12, "{ratio}"),
                    Shaping::TwoHump => {
                        assert!((hump - ALLOWED).abs() < 1e-5, "{ratio}: {hump}");
                        assert!(at_mode < 1e-14, "{ratio}: {at_mode}");
                    }
                    _ => assert!(at_mode < 1e-14, "{shaping}, {ratio}: {at_mode}"),
                }
            }
        }
        // Published for 5 % allowed at the same damping ratio in place of the same decay: within a point.
        let published = [0.35490, 0.44807, 0.19703];
        for ((_, found), share) in shaper(Shaping::Ei, 0.1).impulses().iter().zip(published) {
            assert!((found - share).abs() < 0.01, "{found} {share}");
        }
        assert_eq!(Shaper::new(Shaping::Zv, OMEGA_RAD_S, 1.0), None);
        assert_eq!(Shaper::new(Shaping::Zv, 0.0, 0.1), None);
    }

    #[test]
    fn an_oscillator_rests_after_a_shaped_base_motion() {
        // x'' + 2ζω x' + ω² x = ω² y + 2ζω y' with both modes shaped, by Duhamel's integral of the complex amplitude.
        let modes = [(OMEGA_RAD_S, 0.02), (47.0, 0.05)];
        let both = modes.map(|(omega, ratio)| Shaper::new(Shaping::Zv, omega, ratio).unwrap());
        let shaper = both[0].and(&both[1]);
        let duration_s = 0.44;
        let command = |time_s: f64| Profile::MinJerk.share((time_s / duration_s).clamp(0.0, 1.0));
        let end_s = duration_s + shaper.duration_s();
        let all = 80_000_u32;
        let step_s = end_s / f64::from(all);
        for (omega, ratio) in modes {
            let decay = Complex64::new(ratio, (1.0 - ratio * ratio).sqrt()) * omega;
            // The displacement less its end, so that the integral ends with the motion.
            let amplitude = |place: &dyn Fn(f64) -> f64| {
                let parts = (0..=all).map(|k| {
                    let time_s = f64::from(k) * step_s;
                    let weight = match k {
                        _ if k == 0 || k == all => 1.0,
                        _ if k % 2 == 1 => 4.0,
                        _ => 2.0,
                    };
                    let phase = decay.im * time_s;
                    let turned = Complex64::new(libm::cos(phase), libm::sin(phase));
                    let grown = libm::exp(decay.re * (time_s - end_s));
                    turned * (weight * step_s / 3.0 * grown * (place(time_s) - 1.0))
                });
                let start = libm::exp(-decay.re * end_s);
                // By parts: ∫ y' e^{st} = −∫ (y − 1) s e^{st} − [(y − 1) e^{st}] at the start.
                magnitude(Complex64::new(start, 0.0) - decay * parts.sum::<Complex64>())
            };
            let unshaped = amplitude(&command);
            let shaped = amplitude(&|time_s| shaper.shaped(command, time_s));
            assert!(shaped < 1e-9 && unshaped > 1e-3, "{omega}: {shaped} of {unshaped}");
        }
    }

    #[test]
    fn samples_are_shaped_as_the_function_through_them() {
        let (step_s, shaper) = (1e-3, shaper(Shaping::TwoHump, 0.01));
        let command = |time_s: f64| Profile::Septic.share((time_s / 0.4).clamp(0.0, 1.0));
        let samples: Vec<f64> = (0..=400).map(|k| command(f64::from(k) * step_s)).collect();
        let shaped = shaper.shaped_samples(&samples, step_s);
        let law = Law::shaped(Profile::Septic, &shaper, step_s);
        assert_eq!(shaped.len(), samples.len() + law.more_steps());
        let places: Vec<f64> = [0.0].into_iter().chain(law.places_m(0.0, 1.0, 400)).collect();
        assert_eq!(places.len(), shaped.len());
        assert_eq!((places.first(), places.last()), (Some(&0.0), Some(&1.0)), "met exactly");
        for (k, (shaped, place)) in (0..).zip(shaped.iter().zip(&places)) {
            let exact = shaper.shaped(command, f64::from(k) * step_s);
            assert!((place - exact).abs() < 1e-14, "{k}");
            assert!((shaped - exact).abs() < 1e-9, "{k}: {shaped} {exact}");
        }
    }
}
