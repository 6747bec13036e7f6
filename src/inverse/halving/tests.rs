use std::f64::consts::{PI, TAU};

use super::change::{FEWEST_INTERVALS, change_n_m, interpolated_change_n_m};
use super::sampled::SampledChange;
use crate::beam::Mesh;
use crate::inverse::dynamics::{Dynamics, KeptModes};
use crate::inverse::spectra::Forcing;
use crate::link::{
    Damping, Hub, Link, LinkParts, Payload, Segment, Taper, uniform, uniform_segment,
};
use crate::motion::{MotionColumns, Profile, TipMotion, TipSpectrum};
use crate::numeric::{largest, largest_difference};

/// A link on two meshes, and what a motion asks of it.
struct Halved {
    coarse: Dynamics,
    fine: Dynamics,
    friction_n_m_s_rad: f64,
    spectrum: TipSpectrum,
}

/// Changes of the torque in N m where elements are halved.
struct Changes {
    found: Vec<f64>,
    /// From few bins, where these sufficed.
    interpolated: Option<Vec<f64>>,
    /// With every frequency solved for.
    exact: Vec<f64>,
}

impl Halved {
    fn new(parts: LinkParts, elements: usize, motion: &TipMotion, period: usize) -> Self {
        let link = Link::new(parts).unwrap();
        let coarse = Dynamics::new(&link, Mesh::on(&link, elements), KeptModes::All).unwrap();
        Self {
            fine: coarse.refined().unwrap(),
            coarse,
            friction_n_m_s_rad: link.hub().viscous_friction_n_m_s_rad,
            spectrum: motion.spectrum(period, period - 1000),
        }
    }

    fn forcings(&self) -> [Forcing<'_>; 2] {
        [&self.coarse, &self.fine].map(|dynamics| Forcing {
            dynamics,
            friction_n_m_s_rad: self.friction_n_m_s_rad,
            spectrum: &self.spectrum,
        })
    }

    fn changes(&self) -> Changes {
        let [from, to] = self.forcings();
        let torque = from.hub_spectra().unwrap().torque_n_m;
        let finer = to.hub_spectra().unwrap().torque_n_m;
        let exact: Vec<_> = finer.iter().zip(&torque).map(|(to, from)| to - from).collect();
        Changes {
            found: change_n_m(from, to, &torque).unwrap(),
            interpolated: interpolated_change_n_m(from, to, torque.len()),
            exact: self.spectrum.pair.samples(exact),
        }
    }
}

impl Changes {
    /// How far what is found is from what is, over the latter.
    fn wrong(&self) -> f64 {
        largest_difference(&self.found, &self.exact) / largest(&self.exact)
    }
}

fn smooth(damping: Damping, payload: Payload, travel_m: f64) -> Changes {
    let hub = Hub { viscous_friction_n_m_s_rad: 0.1, ..uniform().hub };
    let motion = Profile::Septic.sampled(travel_m, 0.000_25, 4800, [15_000, 8_000]);
    let parts = LinkParts { hub, payload, damping, ..uniform() };
    Halved::new(parts, 10, &TipMotion::new(motion).unwrap(), 32_000).changes()
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
        let halved = Halved::new(link, 20, &tone(cycles, steps), 8192);
        let wrong = halved.changes().wrong();
        assert!(wrong < 1e-3, "{cycles} cycles: {wrong:e}");
    }
}

#[test]
fn an_interpolation_is_off_by_less_than_half_of_what_it_may_be() {
    // Links whose error would be taken for less without the neighbours' on these intervals.
    const INTERVALS: usize = 72;
    for stiffness in [20.0, 0.317_677, 0.256_678] {
        let halved = Halved::new(of_stiffness(stiffness, 0.1), 20, &tone(94.0, 813), 8192);
        let exact = halved.changes().exact;
        let [from, to] = halved.forcings();
        let mut few = SampledChange::new(from, to, INTERVALS);
        let before = halved.spectrum.pair.samples(few.amplitudes_n_m());
        let off = largest_difference(&before, &exact) / few.doubled().wrong_n_m;
        assert!(off < 0.5, "EI = {stiffness} N m²: {off}");
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
        let halved = Halved::new(of_stiffness(stiffness, 0.1), 400, &motion, 16_384);
        let wrong = halved.changes().wrong();
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
