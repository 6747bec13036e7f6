//! What halved elements change of the torque, found from as few frequencies as that takes.
//!
//! Torque per tip acceleration is a smooth function of frequency: its poles are the zeros of torque
//! → tip, which lie on the axis of real exponents, away from all frequencies. Between its zeros, the
//! natural frequencies, it follows the bending wave, whose phase grows with √ω. So the change that
//! halved elements make is solved for at few frequencies, evenly spaced in √ω, and interpolated
//! between them by cubics. Whether they suffice is measured: twice as many are solved for, until
//! what those before said of the new ones is right.
//!
//! ```text
//! bound = 2 Σ_k |â_k| |interpolated − solved|,   at the solved frequency nearest to ω_k
//! ```
//!
//! is then the most that the interpolation from half as many frequencies is wrong by at any time.
//! It must stay within a hundredth of the largest change; from the frequencies as they are, cubics
//! err by a sixteenth of that, so that the change is known to better than a thousandth of itself.
//!
//! Rotary inertia on the link, or a reduction to few modes, brings zeros of torque → tip near the
//! axis of frequencies: there every frequency is solved for.

use num_complex::Complex64;

use super::dynamics::KeptModes;
use super::error::InversionError;
use super::spectra::Forcing;
use crate::modal::carries_rotary_inertia;
use crate::numeric::{Scalar, largest};

/// Intervals that the first cubics span.
const FEWEST_INTERVALS: usize = 31;

/// What the interpolation from half as many frequencies may be wrong by, over the largest change.
const WRONG: f64 = 1e-2;

/// Change of the torque in N m over the period from a mesh to another, `torque_n_m` being the
/// amplitudes on the former.
///
/// # Errors
/// [`InversionError::NotFinite`] on the latter.
pub(super) fn change_n_m(
    from: Forcing<'_>,
    to: Forcing<'_>,
    torque_n_m: &[Complex64],
) -> Result<Vec<f64>, InversionError> {
    let pair = &to.spectrum.pair;
    if let Some(samples) = interpolated_change_n_m(from, to, torque_n_m.len()) {
        return Ok(samples);
    }
    let finer = to.hub_spectra()?.torque_n_m;
    Ok(pair.samples(finer.iter().zip(torque_n_m).map(|(to, from)| to - from).collect()))
}

/// The change from few of the bins; none where these do not suffice.
fn interpolated_change_n_m(from: Forcing<'_>, to: Forcing<'_>, bins: usize) -> Option<Vec<f64>> {
    let dynamics = from.dynamics;
    let is_smooth =
        dynamics.kept_modes() == KeptModes::All && !carries_rotary_inertia(dynamics.mesh());
    // Two meshes are solved at every sample: with half as many samples as bins all is won.
    let pays = |intervals: usize| 2 * intervals < bins / 2;
    if !is_smooth || !pays(FEWEST_INTERVALS) {
        return None;
    }
    let mut change = SampledChange::new(from, to);
    while pays(change.intervals()) {
        let Interpolated { amplitudes_n_m, bound_n_m } = change.doubled();
        // No change is larger than the sum of its amplitudes, which is faster found.
        let sum: f64 = amplitudes_n_m.iter().map(|d| 2.0 * d.size()).sum();
        if bound_n_m <= WRONG * sum {
            let samples = to.spectrum.pair.samples(amplitudes_n_m);
            if bound_n_m <= WRONG * largest(&samples) {
                return Some(samples);
            }
        }
    }
    None
}

/// Change of torque per felt acceleration in kg m, evenly sampled in √ω from zero to the end of the
/// band.
struct SampledChange<'a> {
    from: Forcing<'a>,
    to: Forcing<'a>,
    last_rad_s: f64,
    samples_kg_m: Vec<Complex64>,
}

/// Amplitudes of the change of torque, and how far those from half as many samples may be off at
/// any time.
struct Interpolated {
    amplitudes_n_m: Vec<Complex64>,
    bound_n_m: f64,
}

impl<'a> SampledChange<'a> {
    fn new(from: Forcing<'a>, to: Forcing<'a>) -> Self {
        let omegas = to.omegas_rad_s();
        let last_rad_s = omegas[omegas.len() - 1];
        let mut change = Self { from, to, last_rad_s, samples_kg_m: vec![] };
        change.samples_kg_m = change.solved((0..=FEWEST_INTERVALS).collect(), FEWEST_INTERVALS);
        change
    }

    fn intervals(&self) -> usize {
        self.samples_kg_m.len() - 1
    }

    /// The change at samples of these numbers, where there are so many intervals.
    fn solved(&self, numbers: Vec<usize>, intervals: usize) -> Vec<Complex64> {
        let omega = |number: usize| {
            let root = number as f64 / intervals as f64;
            self.last_rad_s * (root * root)
        };
        let omegas: Vec<f64> = numbers.into_iter().map(omega).collect();
        let from = self.from.apparent_inertias_kg_m(&omegas);
        let to = self.to.apparent_inertias_kg_m(&omegas);
        to.iter().zip(&from).map(|(to, from)| to - from).collect()
    }

    /// Solves for twice as many samples and interpolates between them.
    fn doubled(&mut self) -> Interpolated {
        let (before, intervals) = (&self.samples_kg_m, 2 * self.intervals());
        let between = self.solved((1..intervals).step_by(2).collect(), intervals);
        let mut wrong = Vec::with_capacity(between.len());
        let mut samples = Vec::with_capacity(intervals + 1);
        for (k, solved) in between.iter().enumerate() {
            wrong.push((*solved - cubic(before, k as f64 + 0.5)).size());
            samples.extend([before[k], *solved]);
        }
        samples.extend(before.last());
        self.samples_kg_m = samples;
        self.interpolated(&wrong)
    }

    /// The change at all bins; `wrong` tells of every other sample how far off the interpolation
    /// between its neighbours was.
    fn interpolated(&self, wrong: &[f64]) -> Interpolated {
        let per_root = self.intervals() as f64 / self.last_rad_s.sqrt();
        let mut bound_n_m = 0.0;
        let amplitude = |(bin, omega): (usize, &f64)| {
            let place = omega.sqrt() * per_root;
            let felt = self.to.felt_acceleration(bin);
            bound_n_m += 2.0 * felt.size() * wrong[(whole(place) / 2).min(wrong.len() - 1)];
            felt * cubic(&self.samples_kg_m, place)
        };
        let amplitudes_n_m = self.to.omegas_rad_s().iter().enumerate().map(amplitude).collect();
        Interpolated { amplitudes_n_m, bound_n_m }
    }
}

/// The cubic through the four samples around a place, which is counted in samples.
fn cubic(samples: &[Complex64], place: f64) -> Complex64 {
    let first = whole(place).saturating_sub(1).min(samples.len() - 4);
    let around = &samples[first..first + 4];
    let t = place - first as f64;
    let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
    let outer = around[0] * (t2 * t3 * t1 * (-1.0 / 6.0)) + around[3] * (t * t1 * t2 * (1.0 / 6.0));
    let inner = around[1] * (t * t2 * t3 * 0.5) + around[2] * (t * t1 * t3 * -0.5);
    outer + inner
}

/// The sample at or before a place.
fn whole(place: f64) -> usize {
    place as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{Mesh, MeshPlan};
    use crate::inverse::dynamics::Dynamics;
    use crate::link::{Damping, Hub, Link, LinkParts, Payload, Segment, Taper};
    use crate::motion::{Profile, TipMotion};
    use crate::numeric::largest_difference;

    /// Changes of the torque in N m between 10 and 20 elements.
    struct Changes {
        found: Vec<f64>,
        /// From few bins, where these sufficed.
        interpolated: Option<Vec<f64>>,
        /// With every frequency solved for.
        exact: Vec<f64>,
    }

    fn changes(damping: Damping, payload: Payload) -> Changes {
        let link = Link::new(LinkParts {
            title: String::new(),
            segments: vec![Segment {
                name: None,
                length_m: 1.5,
                bending_stiffness_n_m2: Taper::constant(5.0),
                mass_per_length_kg_m: Taper::constant(0.8),
            }],
            hub: Hub { inertia_kg_m2: 0.1, viscous_friction_n_m_s_rad: 0.1, ..Hub::default() },
            masses: vec![],
            payload,
            damping,
        })
        .unwrap();
        let mesh = Mesh::new(&link, &MeshPlan::new(&link, &[Some(10)], None, 1e-6).unwrap());
        let coarse = Dynamics::new(&link, mesh, KeptModes::All).unwrap();
        let fine = coarse.refined().unwrap();
        let rests = [15_000, 8_000];
        let motion = TipMotion::new(Profile::Septic.sampled(0.5, 0.000_25, 4800, rests)).unwrap();
        let spectrum = motion.spectrum(32_000, 31_000);
        let from = Forcing { dynamics: &coarse, friction_n_m_s_rad: 0.1, spectrum: &spectrum };
        let to = Forcing { dynamics: &fine, ..from };
        let torque = from.hub_spectra().unwrap().torque_n_m;
        let found = change_n_m(from, to, &torque).unwrap();
        let interpolated = interpolated_change_n_m(from, to, torque.len());
        let finer = to.hub_spectra().unwrap().torque_n_m;
        let exact = finer.iter().zip(&torque).map(|(to, from)| to - from).collect();
        Changes { found, interpolated, exact: spectrum.pair.samples(exact) }
    }

    #[test]
    fn the_change_is_found_to_a_thousandth_of_itself() {
        let dampings = [
            Damping::None,
            Damping::Hysteretic { ratio: 0.02 },
            Damping::Rayleigh { alpha_per_s: 0.5, beta_s: 1e-4 },
        ];
        let point = Payload { mass_kg: 0.05, ..Payload::default() };
        // With next to no damping this one has a pole far narrower than the samples are apart.
        let block = Payload { inertia_kg_m2: 0.001, ..point };
        for damping in dampings {
            for (payload, suffices) in [(Payload::default(), true), (point, true), (block, false)] {
                let Changes { found, interpolated, exact } = changes(damping.clone(), payload);
                let wrong = largest_difference(&found, &exact) / largest(&exact);
                assert!(wrong < 1e-3, "{damping:?}, {payload:?}: {wrong:e}");
                assert_eq!(interpolated.is_some(), suffices, "{damping:?}, {payload:?}");
            }
        }
    }

    #[test]
    fn a_cubic_is_interpolated_as_it_is() {
        let value = |t: f64| Complex64::new(t * t * t - 2.0 * t, 3.0 - t * t);
        let samples: Vec<Complex64> = (0..7).map(|k| value(f64::from(k))).collect();
        for place in [0.0, 0.3, 1.0, 2.7, 5.5, 6.0] {
            assert!((cubic(&samples, place) - value(place)).norm() < 1e-13, "at {place}");
        }
    }
}
