//! What halved elements change of the torque, found from as few frequencies as that takes.
//!
//! Torque per tip acceleration is a smooth function of frequency: its poles are the zeros of torque
//! → tip, which lie on the axis of real exponents, away from all frequencies. Between its zeros, the
//! natural frequencies, it follows the bending wave, whose phase grows with √ω. So the change that
//! halved elements make is solved for at few frequencies, evenly spaced in √ω, and interpolated
//! between them by quintics. At first there are no fewer intervals than the finer mesh has modes in
//! the band, of which each turns the wave by half a turn. Whether they suffice is measured: twice as
//! many are solved for, until what those before said of the new ones is right.
//!
//! ```text
//! wrong = 2 Σ_k |â_k| max |interpolated − solved|,   of the three solved frequencies nearest to ω_k
//! ```
//!
//! tells how far the interpolation from half as many frequencies may be off at any time: three,
//! because a wave's error vanishes somewhere. It must stay within four hundredths of the largest
//! change; from the frequencies as they are, quintics err by a fortieth of that or less, so that the
//! change is known to a thousandth of itself.
//!
//! Rotary inertia on the link, or a reduction to few modes, brings zeros of torque → tip near the
//! axis of frequencies: there every frequency is solved for.

use num_complex::Complex64;

use super::dynamics::KeptModes;
use super::error::InversionError;
use super::spectra::Forcing;
use crate::modal::{carries_rotary_inertia, modes_below};
use crate::numeric::{Scalar, largest, quintic, scale_by_quintics, whole};

/// Intervals that the first quintics span at least.
const FEWEST_INTERVALS: usize = 36;

/// What the interpolation from half as many frequencies may be wrong by, over the largest change.
const WRONG: f64 = 4e-2;

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
    let change: Vec<_> = finer.iter().zip(torque_n_m).map(|(to, from)| to - from).collect();
    Ok(pair.samples(change))
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
    let fewest = modes_below(to.dynamics.mesh(), to.last_rad_s()).max(FEWEST_INTERVALS);
    if !pays(fewest) {
        return None;
    }
    let mut change = SampledChange::new(from, to, fewest);
    while pays(change.intervals()) {
        let Estimate { wrong_n_m, change_n_m } = change.doubled();
        // No change is larger than its amplitudes add up to, which is faster found.
        if wrong_n_m <= WRONG * change_n_m {
            let samples = to.spectrum.pair.samples(change.amplitudes_n_m());
            if wrong_n_m <= WRONG * largest(&samples) {
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
    /// Where each bin stands: √ω in √(rad/s).
    roots: Vec<f64>,
    /// Acceleration that the mass feels at each bin, in m/s².
    felt_m_s2: Vec<Complex64>,
    samples_kg_m: Vec<Complex64>,
}

/// What amplitudes add up to over the band, each taken from the solved frequency nearest to it.
struct Estimate {
    /// How far the change from half as many samples may be off at any time.
    wrong_n_m: f64,
    /// The change itself.
    change_n_m: f64,
}

impl<'a> SampledChange<'a> {
    fn new(from: Forcing<'a>, to: Forcing<'a>, intervals: usize) -> Self {
        let (omegas, last_rad_s) = (to.omegas_rad_s(), to.last_rad_s());
        let roots = omegas.iter().map(|omega| omega.sqrt()).collect();
        let felt_m_s2 = (0..omegas.len()).map(|bin| to.felt_acceleration(bin)).collect();
        let mut change = Self { from, to, last_rad_s, roots, felt_m_s2, samples_kg_m: vec![] };
        change.samples_kg_m = change.solved(0..=intervals, intervals);
        change
    }

    fn intervals(&self) -> usize {
        self.samples_kg_m.len() - 1
    }

    /// The change at samples of these numbers, where there are so many intervals.
    fn solved(&self, numbers: impl Iterator<Item = usize>, intervals: usize) -> Vec<Complex64> {
        let omega = |number: usize| {
            let root = number as f64 / intervals as f64;
            self.last_rad_s * (root * root)
        };
        let omegas: Vec<f64> = numbers.map(omega).collect();
        let from = self.from.apparent_inertias_kg_m(&omegas);
        let to = self.to.apparent_inertias_kg_m(&omegas);
        to.iter().zip(&from).map(|(to, from)| to - from).collect()
    }

    /// Solves for twice as many samples, and tells how far off the interpolation between those
    /// before was.
    fn doubled(&mut self) -> Estimate {
        let (before, intervals) = (&self.samples_kg_m, 2 * self.intervals());
        let between = self.solved((1..intervals).step_by(2), intervals);
        let mut samples = Vec::with_capacity(intervals + 1);
        let mut estimate = Estimate { wrong_n_m: 0.0, change_n_m: 0.0 };
        let off = |k: usize| (between[k] - quintic(before, k as f64 + 0.5)).size();
        let off: Vec<f64> = (0..between.len()).map(off).collect();
        let places = self.places(before.len() - 1);
        let mut felt = self.felt_m_s2.iter();
        // Of the bins between two samples the one between these is the nearest.
        for near in places.chunk_by(|a, b| whole(*a) == whole(*b)) {
            let k = whole(near[0]).min(between.len() - 1);
            let sum: f64 = felt.by_ref().take(near.len()).map(|felt| 2.0 * felt.size()).sum();
            let neighbours = &off[k.saturating_sub(1)..off.len().min(k + 2)];
            estimate.wrong_n_m += sum * largest(neighbours);
            estimate.change_n_m += sum * between[k].size();
        }
        for (before, between) in before.iter().zip(&between) {
            samples.extend([before, between]);
        }
        samples.extend(before.last());
        self.samples_kg_m = samples;
        estimate
    }

    /// The places of all bins among the samples of so many intervals.
    fn places(&self, intervals: usize) -> Vec<f64> {
        let per_root = intervals as f64 / self.last_rad_s.sqrt();
        self.roots.iter().map(|root| root * per_root).collect()
    }

    /// The change at all bins.
    fn amplitudes_n_m(&self) -> Vec<Complex64> {
        let mut amplitudes = self.felt_m_s2.clone();
        scale_by_quintics(&self.samples_kg_m, &self.places(self.intervals()), &mut amplitudes);
        amplitudes
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::beam::Mesh;
    use crate::inverse::dynamics::Dynamics;
    use crate::link::{
        Damping, Hub, Link, LinkParts, Payload, Segment, Taper, uniform, uniform_segment,
    };
    use crate::motion::{MotionColumns, Profile, TipMotion};
    use crate::numeric::largest_difference;

    /// Changes of the torque in N m where elements are halved.
    struct Changes {
        found: Vec<f64>,
        /// From few bins, where these sufficed.
        interpolated: Option<Vec<f64>>,
        /// With every frequency solved for.
        exact: Vec<f64>,
    }

    impl Changes {
        /// How far what is found is from what is, over the latter.
        fn wrong(&self) -> f64 {
            largest_difference(&self.found, &self.exact) / largest(&self.exact)
        }
    }

    fn changes(parts: LinkParts, elements: usize, motion: &TipMotion, period: usize) -> Changes {
        let link = Link::new(parts).unwrap();
        let coarse = Dynamics::new(&link, Mesh::on(&link, elements), KeptModes::All).unwrap();
        let fine = coarse.refined().unwrap();
        let spectrum = motion.spectrum(period, period - 1000);
        let friction_n_m_s_rad = link.hub().viscous_friction_n_m_s_rad;
        let from = Forcing { dynamics: &coarse, friction_n_m_s_rad, spectrum: &spectrum };
        let to = Forcing { dynamics: &fine, ..from };
        let torque = from.hub_spectra().unwrap().torque_n_m;
        let found = change_n_m(from, to, &torque).unwrap();
        let interpolated = interpolated_change_n_m(from, to, torque.len());
        let finer = to.hub_spectra().unwrap().torque_n_m;
        let exact: Vec<_> = finer.iter().zip(&torque).map(|(to, from)| to - from).collect();
        Changes { found, interpolated, exact: spectrum.pair.samples(exact) }
    }

    fn smooth(damping: Damping, payload: Payload, travel_m: f64) -> Changes {
        let hub = Hub { viscous_friction_n_m_s_rad: 0.1, ..uniform().hub };
        let motion = Profile::Septic.sampled(travel_m, 0.000_25, 4800, [15_000, 8_000]);
        let parts = LinkParts { hub, payload, damping, ..uniform() };
        changes(parts, 10, &TipMotion::new(motion).unwrap(), 32_000)
    }

    /// The uniform link of another stiffness, without damping.
    fn of_stiffness(bending_stiffness_n_m2: f64, hub_inertia_kg_m2: f64) -> LinkParts {
        let bending_stiffness_n_m2 = Taper::constant(bending_stiffness_n_m2);
        let segment = Segment { bending_stiffness_n_m2, ..uniform_segment() };
        let hub = Hub { inertia_kg_m2: hub_inertia_kg_m2, ..Hub::default() };
        LinkParts { segments: vec![segment], hub, damping: Damping::None, ..uniform() }
    }

    /// An acceleration of so many cycles of a sine in so many steps of 0.25 ms, rest around it.
    fn tone(cycles: f64, steps: u32) -> TipMotion {
        let all = steps + 40;
        let phase = |k: u32| TAU * cycles * f64::from(k - 20) / f64::from(steps);
        let acceleration = |k| if (20..20 + steps).contains(&k) { phase(k).sin() } else { 0.0 };
        TipMotion::new(MotionColumns {
            time_s: (0..=all).map(|k| 0.000_25 * f64::from(k)).collect(),
            acceleration_m_s2: Some((0..=all).map(acceleration).collect()),
            ..MotionColumns::default()
        })
        .unwrap()
    }

    /// Without damping the error of an interpolated wave vanishes at some frequencies; a motion that
    /// holds little else must not take them for all.
    #[test]
    fn the_change_under_few_frequencies_is_found_to_a_thousandth_of_itself() {
        for (stiffness, hub_inertia, cycles, steps) in [
            (1.045_065, 0.1, 36.0, 1772),
            (13.323_534, 0.0, 94.0, 813),
            (1.181_964, 0.0, 94.0, 813),
            (1.021_025, 0.0, 36.0, 1772),
        ] {
            let link = of_stiffness(stiffness, hub_inertia);
            let wrong = changes(link, 20, &tone(cycles, steps), 8192).wrong();
            assert!(wrong < 1e-3, "{cycles} cycles: {wrong:e}");
        }
    }

    /// Two turns of the wave from each frequency to the next would look as none.
    #[test]
    fn the_change_over_many_waves_is_found_to_a_thousandth_of_itself() {
        let step_s = 1e-4;
        for turns in [1.8, 2.0, 2.1] {
            let waves = TAU * turns * FEWEST_INTERVALS as f64;
            let stiffness = 0.8 * (1.5_f64 / waves).powi(4) * (PI / step_s).powi(2);
            let motion = Profile::BangBang.sampled(0.5, step_s, 3000, [0, 0]);
            let motion = TipMotion::new(motion).unwrap();
            let wrong = changes(of_stiffness(stiffness, 0.1), 400, &motion, 16_384).wrong();
            assert!(wrong < 1e-3, "{turns} turns: {wrong:e}");
        }
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
                let changes = smooth(damping.clone(), payload, 0.5);
                let wrong = changes.wrong();
                assert!(wrong < 1e-3, "{damping:?}, {payload:?}: {wrong:e}");
                assert_eq!(changes.interpolated.is_some(), suffices, "{damping:?}, {payload:?}");
            }
        }
    }

    #[test]
    fn a_motion_of_another_size_changes_the_torque_in_proportion() {
        let hysteretic = Damping::Hysteretic { ratio: 0.02 };
        let of = |travel_m| smooth(hysteretic.clone(), Payload::default(), travel_m).interpolated;
        let one = of(0.5).unwrap();
        for factor in [2.0_f64.powi(-14), 2.0_f64.powi(14)] {
            let scaled: Vec<f64> = one.iter().map(|torque| torque * factor).collect();
            assert!(of(0.5 * factor).unwrap() == scaled, "{factor} times the way");
        }
    }
}
