//! Damping mode by mode, and links reduced to few modes.

use std::num::NonZeroUsize;

use super::{Smooth, link, plan_of, refused, solved, torque_difference, whole_band};
use crate::common::{difference, mesh_of};
use flexlink::inverse::{Analysis, InversionError, Solution, invert};
use flexlink::link::{Damping, Link, LumpedMass, Payload};
use flexlink::modal::{DampingError, ModalBasis};
use flexlink::model::{KeptModes, ModelError, model_of};

/// A link with all that a link can have.
fn loaded(damping: Damping) -> Link {
    link(|parts| {
        parts.hub.radius_m = 0.05;
        parts.hub.viscous_friction_n_m_s_rad = 0.03;
        parts.masses = vec![LumpedMass { at_m: 0.8, mass_kg: 0.2, inertia_kg_m2: 1e-3 }];
        parts.payload = Payload { mass_kg: 0.1, inertia_kg_m2: 0.0, offset_m: 0.0 };
        parts.damping = damping;
    })
}

fn keeping(modes: usize) -> Analysis {
    whole_band(Analysis::default()).keeping_modes(modes).unwrap()
}

fn assert_same(found: &Solution, expected: &Solution, tolerance: f64) {
    let nodes: Vec<usize> = (0..expected.links[0].mesh().nodes_m().len()).collect();
    let bent = |solution: &Solution| {
        solution.deflections(&nodes, NonZeroUsize::MIN).unwrap().histories().samples.concat()
    };
    let stressed = |solution: &Solution| {
        solution.moments(&nodes, NonZeroUsize::MIN).unwrap().histories().samples.concat()
    };
    for (what, error) in [
        ("torque", difference(&found.hub().torque_n_m, &expected.hub().torque_n_m)),
        ("hub angle", difference(&found.hub().angle_rad, &expected.hub().angle_rad)),
        (
            "root moment",
            difference(&found.links[0].root_moment_n_m, &expected.links[0].root_moment_n_m),
        ),
        ("deflections", difference(&bent(found), &bent(expected))),
        ("moments", difference(&stressed(found), &stressed(expected))),
    ] {
        assert!(error < tolerance, "{what}: {error:e}");
    }
}

#[test]
fn all_modes_together_are_the_whole_link() {
    let laws = [
        Damping::None,
        Damping::Hysteretic { ratio: 0.03 },
        Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 1e-3 },
    ];
    for law in laws {
        let link = loaded(law);
        let motion = Smooth::MOVE.motion();
        let whole = solved(&link, 8, &motion);
        let summed = invert(&link, &plan_of(&link, 8), &motion, &keeping(16)).unwrap();
        assert_same(&summed, &whole, 1e-9);
        assert!(summed.hub().errors.torque.modes.unwrap() < 1e-9);
        assert_eq!(whole.hub().errors.torque.modes, None);
    }
}

#[test]
fn a_series_through_two_modes_is_stiffness_damping_where_rayleigh_is() {
    let beta_s = 2e-3;
    let rayleigh = loaded(Damping::Rayleigh { alpha_per_s: 0.0, beta_s });
    let motion = Smooth::MOVE.motion();
    let expected = solved(&rayleigh, 8, &motion);
    let frequencies = expected.links[0].natural_frequencies_rad_s(5);
    let ratios = [0, 2].map(|mode| 0.5 * beta_s * frequencies[mode]).to_vec();
    let series = loaded(Damping::Caughey { modes: vec![1, 3], ratios });
    assert_same(&solved(&series, 8, &motion), &expected, 1e-8);
}

#[test]
fn modal_damping_of_no_ratio_is_none() {
    let motion = Smooth::MOVE.motion();
    let undamped = solved(&loaded(Damping::None), 8, &motion);
    let modal = solved(&loaded(Damping::Modal { ratios: vec![0.0] }), 8, &motion);
    assert_same(&modal, &undamped, 1e-9);
}

#[test]
fn the_last_ratio_of_a_list_holds_for_all_higher_modes() {
    let motion = Smooth::MOVE.motion();
    let ratios = |list: &[f64]| Damping::Modal { ratios: list.to_vec() };
    let short = solved(&loaded(ratios(&[0.01, 0.05])), 8, &motion);
    let long = solved(&loaded(ratios(&[0.01, 0.05, 0.05, 0.05])), 8, &motion);
    assert_same(&short, &long, 1e-13);
    let other = solved(&loaded(ratios(&[0.05, 0.01])), 8, &motion);
    assert!(torque_difference(&other, &short, 0) > 1e-3);
}

#[test]
fn a_reduction_tells_what_it_costs() {
    let link = loaded(Damping::Hysteretic { ratio: 0.02 });
    let motion = Smooth::MOVE.motion();
    let plan = plan_of(&link, 12);
    let whole = solved(&link, 12, &motion);
    let mut before = f64::INFINITY;
    for modes in [2, 4, 8] {
        let reduced = invert(&link, &plan, &motion, &keeping(modes)).unwrap();
        let told = reduced.hub().errors.torque.modes.unwrap();
        let found = torque_difference(&whole, &reduced, 0);
        assert!((found - told).abs() < 1e-5 + 0.01 * told, "{modes} modes: {told}");
        assert!(told < before, "{modes} modes cost {told}, fewer {before}");
        before = told;
    }
    assert!(before < 0.05 && before > 1e-7, "{before}");
}

#[test]
fn what_modes_cannot_do_is_refused() {
    let motion = Smooth::MOVE.motion();
    let link = loaded(Damping::Modal { ratios: vec![0.02] });
    let error = refused(&link, &plan_of(&link, 251), &motion, &whole_band(Analysis::default()));
    let too_many = ModelError::TooManyElements { elements: 251, limit: 250 };
    assert_eq!(error, InversionError::Model(too_many));
    let error = refused(&link, &plan_of(&link, 3), &motion, &keeping(7));
    assert_eq!(error, InversionError::Model(ModelError::NotSoManyModes { asked: 7, found: 6 }));
    let series = loaded(Damping::Caughey { modes: vec![1, 2, 3], ratios: vec![0.02; 3] });
    let error = refused(&series, &plan_of(&series, 8), &motion, &whole_band(Analysis::default()));
    let InversionError::Model(ModelError::Damping(error)) = error else { panic!("{error}") };
    let DampingError::NegativeRatio { mode, ratio, modes, .. } = error else {
        panic!("{error}");
    };
    assert!(mode > 3 && ratio < 0.0 && modes == 16, "mode {mode} of {modes}: {ratio}");
}

#[test]
fn an_undamped_link_needs_no_torque_at_its_natural_frequencies_and_all_is_finite_there() {
    let link = loaded(Damping::Modal { ratios: vec![0.0] });
    let mesh = mesh_of(&link, 8);
    let modes = ModalBasis::complete(&mesh).unwrap().modes;
    let model = model_of(&link, mesh, KeptModes::All).unwrap();
    for mode in &modes[..5] {
        let at = |omega: f64| model.tip_transfer(omega);
        let (exact, beside) = (at(mode.omega_rad_s), at(mode.omega_rad_s * (1.0 + 1e-9)));
        assert!(exact.inertia_kg_m.norm() < 1e-9 * at(0.0).inertia_kg_m.norm(), "{exact:?}");
        assert!((exact.angle_rad_m / beside.angle_rad_m - 1.0).norm() < 1e-6, "{exact:?}");
        assert!((exact.deflection_s2 / beside.deflection_s2 - 1.0).norm() < 1e-6, "{exact:?}");
    }
}

#[test]
fn ratios_of_nothing_are_no_damping_under_every_law() {
    for damping in [
        Damping::RayleighThroughModes { modes: [1, 2], ratios: [0.0, 0.0] },
        Damping::Caughey { modes: vec![1, 2], ratios: vec![0.0, 0.0] },
    ] {
        let motion = Smooth::SHORT.motion();
        let (none, found) = (loaded(Damping::None), loaded(damping));
        assert_same(&solved(&found, 8, &motion), &solved(&none, 8, &motion), 1e-9);
    }
}

#[test]
fn a_solution_tells_the_zeros_of_its_mesh() {
    let solution = solved(&link(|_| ()), 200, &Smooth::SHORT.motion());
    let found = solution.links[0].zeros_per_s(3);
    assert_eq!(found.len(), 3);
    for (z, unit) in found.iter().zip([11.186_642_72, 60.451_695_86, 149.277_767_6]) {
        let exact = unit * (5.0 / 0.8_f64).sqrt() / 2.25;
        assert!((z / exact - 1.0).abs() < 1e-6, "{z} is not {exact}");
    }
}
