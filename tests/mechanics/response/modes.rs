//! Which modes answer, what stands for the others, and what all of them together weigh and store.

use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;

use faer::Mat;
use faer::linalg::solvers::Solve;
use flexlink::beam::nodal_transfer;
use flexlink::link::{Damping, Hub, Link, LumpedMass, Payload, Taper};
use flexlink::modal::natural_frequencies;
use flexlink::response::{Play, Played, Torque};
use num_complex::Complex64;

use super::assembly::Assembly;
use super::{difference, link, peak, plan_of, played, smooth, solved, times, torque_of};
use crate::common::apart;

/// A link with bodies on it, hub radius included.
fn loaded(damping: Damping) -> Link {
    link(|parts| {
        parts.hub = Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.0 };
        parts.masses = vec![LumpedMass { at_m: 0.8, mass_kg: 0.2, inertia_kg_m2: 1e-3 }];
        parts.payload = Payload { mass_kg: 0.1, inertia_kg_m2: 2e-4, offset_m: 0.02 };
        parts.damping = damping;
    })
}

/// A pulse sin⁸ so long in s: its spectrum ends at a few times 1/duration.
fn pulse(duration_s: f64, steps: u32) -> Torque {
    let time_s = times(duration_s / f64::from(steps), steps);
    let torque = time_s.iter().map(|t| (PI * t / duration_s).sin().powi(8)).collect();
    Torque::new(&time_s, torque).unwrap()
}

/// Order 4, as the natural frequencies: nothing else tells the meshes apart, and 4000 elements
/// cost no digit. Measured: 7e-6 with 10 elements to 1.5e-9 with 80, orders 3.98 to 4.14.
#[test]
fn eight_of_eight_thousand_modes_answer_as_those_of_coarser_meshes_tend_to() {
    let link = loaded(Damping::Modal { ratios: vec![0.02] });
    let torque = pulse(0.8, 400);
    let play = Play { until_s: Some(1.6), ..Play::of(&torque) };
    let fine = played(&link, &plan_of(&link, 4000), &play);
    assert_eq!(
        (fine.modes().unwrap().selection.modes, fine.modes().unwrap().selection.of),
        (8, 8000)
    );
    let errors = [10, 20, 40, 80].map(|elements| {
        let found = played(&link, &plan_of(&link, elements), &play);
        assert_eq!(
            (found.modes().unwrap().selection.modes, found.modes().unwrap().selection.of),
            (8, 2 * elements)
        );
        let tip = difference(&found.tip[0].displacement_m, &fine.tip[0].displacement_m);
        tip.max(difference(&found.hub().angle_rad, &fine.hub().angle_rad))
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.8..4.3).contains(&order), "order {order}: {errors:?}");
    }
    assert!(errors[3] < 5e-9, "{errors:?}");
}

/// Deflections of all nodes over time, one row a node.
fn deflections(found: &Played) -> Vec<Vec<f64>> {
    let nodes: Vec<usize> = (0..found.mesh().nodes_m().len()).collect();
    let displaced = found.displacements_m(&nodes, NonZeroUsize::MIN).unwrap().samples;
    let bent = |(v, x_m): (&Vec<f64>, &f64)| -> Vec<f64> {
        v.iter().zip(&found.hub().angle_rad).map(|(v, theta)| v - x_m * theta).collect()
    };
    displaced.iter().zip(found.mesh().nodes_m()).map(bent).collect()
}

/// Six modes and the residual one bend every node as the recursion at λ = 0 does. Inertia's own
/// share falls with the square of the duration: from two durations it is taken out. Measured: 4e-10
/// of the tip's deflection.
#[test]
fn a_slow_torque_bends_the_link_statically() {
    let link = loaded(Damping::None);
    let plan = plan_of(&link, 12);
    let [fast, slow] = [400.0, 800.0].map(|duration_s| {
        let found = played(&link, &plan, &Play::of(&pulse(duration_s, 400)));
        assert_eq!(
            (found.modes().unwrap().selection.modes, found.modes().unwrap().selection.of),
            (6, 24)
        );
        (deflections(&found), found)
    });
    let statics = nodal_transfer(slow.1.mesh(), Complex64::ZERO);
    let flexibilities: Vec<f64> = statics
        .deflections_s2
        .iter()
        // w = −lag a_tip, T = inertia · a_tip.
        .map(|lag| -(lag / statics.tip.inertia_kg_m).re)
        .collect();
    let (torque, peak_m) = (pulse(800.0, 400), flexibilities[flexibilities.len() - 1].abs());
    for (node, flexibility) in flexibilities.iter().enumerate() {
        let mut worst = 0.0_f64;
        for (k, t) in torque.torque_n_m().iter().enumerate() {
            let limit = (4.0 * slow.0[node][k] - fast.0[node][k]) / 3.0;
            worst = worst.max((limit - flexibility * t).abs() / peak_m);
        }
        assert!(worst < 2e-9, "node {node}: {worst:e}");
    }
}

#[test]
fn nodes_move_between_hub_and_tip() {
    let link = loaded(Damping::Modal { ratios: vec![0.02] });
    let torque = pulse(0.5, 250);
    let play = Play { initial_tip_m: 0.31, ..Play::of(&torque) };
    let found = played(&link, &plan_of(&link, 9), &play);
    let last = found.mesh().nodes_m().len() - 1;
    let every = found.displacements_m(&[last, 0, 4], NonZeroUsize::MIN).unwrap();
    let root: Vec<f64> = found.hub().angle_rad.iter().map(|theta| 0.05 * theta).collect();
    assert!(difference(&every.samples[0], &found.tip[0].displacement_m) < 2e-15);
    assert!(difference(&every.samples[1], &root) < 2e-15);
    // At rest on a straight line through the axis.
    assert!((found.tip[0].displacement_m[0] - 0.31).abs() < 1e-16);
    assert!((every.samples[2][0] - 0.31 * found.mesh().nodes_m()[4] / 1.55).abs() < 1e-16);
    let thinned = found.displacements_m(&[4], NonZeroUsize::new(7).unwrap()).unwrap();
    assert_eq!(thinned.samples[0].len(), thinned.grid.len());
    let picked: Vec<f64> = every.samples[2].iter().step_by(7).copied().collect();
    assert_eq!(thinned.samples[0], picked);
    // Where the tip starts changes nothing else.
    let from_zero = played(&link, &plan_of(&link, 9), &Play::of(&torque));
    let moved: Vec<f64> = found.tip[0].displacement_m.iter().map(|v| v - 0.31).collect();
    assert!(difference(&moved, &from_zero.tip[0].displacement_m) < 1e-14);
    assert_eq!(found.tip[0].velocity_m_s, from_zero.tip[0].velocity_m_s);
}

/// Work ∫ T θ̇ dt of the motor in J up to every sample but the first and last four, in which it does
/// none: trapezoids, corrected by the slopes at their ends.
fn work_j(found: &Played) -> Vec<f64> {
    let power =
        found.hub().torque_n_m.iter().zip(&found.hub().rate_rad_s).map(|(t, rate)| t * rate);
    let power: Vec<f64> = power.collect();
    let step_s = found.grid.step_s;
    let mut sum = 0.0;
    let slopes = rates(&power, step_s);
    let inner = power[3..power.len() - 4].windows(2).zip(slopes);
    let work = inner.map(|(pair, slope)| {
        sum += 0.5 * step_s * (pair[0] + pair[1]);
        sum - step_s * step_s / 12.0 * slope
    });
    work.collect()
}

/// Rates of samples by central differences of order 8; none for the first and last four.
fn rates(samples: &[f64], step_s: f64) -> Vec<f64> {
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let at = |k: usize| -> f64 {
        let pairs = WEIGHTS.iter().zip(1..);
        pairs.map(|(w, d)| w * (samples[k + d] - samples[k - d])).sum::<f64>() / step_s
    };
    (4..samples.len() - 4).map(at).collect()
}

/// Four masses on a beam without any: rates and displacements of the nodes say all of its energy,
/// for the slopes between them follow. Measured: 2.6e-10, the differences' own error.
#[test]
fn the_work_of_the_torque_is_the_energy_of_an_undamped_link() {
    let link = link(|parts| {
        for segment in &mut parts.segments {
            segment.mass_per_length_kg_m = Taper::constant(0.0);
        }
        parts.masses = [0.4, 0.8, 1.2]
            .map(|at_m| LumpedMass { at_m, mass_kg: 0.3, inertia_kg_m2: 0.0 })
            .to_vec();
        parts.payload.mass_kg = 0.2;
    });
    let torque = pulse(0.25, 500);
    let play = Play { until_s: Some(0.4), ..Play::of(&torque) };
    let found = played(&link, &plan_of(&link, 5), &play);
    let nodes_m = found.mesh().nodes_m();
    let [mass, stiffness] = Assembly::of_link(&link, nodes_m).mass_and_stiffness();
    // Unknowns are (θ, v_1, φ_1, …): θ and all v first, then the slopes.
    let size = mass.nrows();
    let shown: Vec<usize> = std::iter::once(0).chain((1..size).step_by(2)).collect();
    let slopes: Vec<usize> = (2..size).step_by(2).collect();
    let block = |m: &Mat<f64>, rows: &[usize], columns: &[usize]| {
        Mat::from_fn(rows.len(), columns.len(), |r, c| m[(rows[r], columns[c])])
    };
    let across = block(&stiffness, &slopes, &shown);
    let follow = block(&stiffness, &slopes, &slopes).partial_piv_lu().solve(&across);
    let condensed = block(&stiffness, &shown, &shown) - across.transpose() * follow;
    let mass = block(&mass, &shown, &shown);

    let nodes: Vec<usize> = (1..nodes_m.len()).collect();
    let mut motion = vec![found.hub().angle_rad.clone()];
    motion.extend(found.displacements_m(&nodes, NonZeroUsize::MIN).unwrap().samples);
    let rate: Vec<Vec<f64>> =
        motion.iter().map(|samples| rates(samples, found.grid.step_s)).collect();
    let energy = |matrix: &Mat<f64>, of: &[Vec<f64>], k: usize| {
        let x = Mat::from_fn(of.len(), 1, |row, _| of[row][k]);
        0.5 * (x.transpose() * matrix * &x)[(0, 0)]
    };
    let inner = 4..found.grid.len - 4;
    let strain: Vec<f64> = inner.map(|k| energy(&condensed, &motion, k)).collect();
    let stored: Vec<f64> =
        strain.iter().enumerate().map(|(k, strain)| strain + energy(&mass, &rate, k)).collect();
    assert!(peak(&strain) > 0.5 * peak(&stored), "both kinds of energy matter");
    let error = difference(&stored, &work_j(&found));
    assert!(error < 1e-9, "{error:e}");
}

/// The whole beam, from rest to rest: what the motor puts in it takes out again, or friction does.
#[test]
fn only_a_damped_link_keeps_work() {
    let kept = |law: Damping, friction: f64| {
        let link = link(|parts| {
            parts.damping = law;
            parts.hub.viscous_friction_n_m_s_rad = friction;
        });
        let plan = plan_of(&link, 10);
        let torque = torque_of(&solved(&link, &plan, &smooth(880), 1e-10));
        let found = played(&link, &plan, &Play::of(&torque));
        let work = work_j(&found);
        let rubbed = found.hub().rate_rad_s.iter().map(|rate| friction * rate * rate);
        let rubbed: f64 = rubbed.sum::<f64>() * found.grid.step_s;
        (work[work.len() - 1] / peak(&work), rubbed / peak(&work))
    };
    let (undamped, _) = kept(Damping::None, 0.0);
    assert!(undamped.abs() < 1e-11, "{undamped:e}");
    let (left, rubbed) = kept(Damping::None, 0.05);
    assert!((left - rubbed).abs() < 1e-11 && left > 0.04, "{left} in all, {rubbed} in the joint");
    let (damped, _) = kept(Damping::Modal { ratios: vec![0.02] }, 0.0);
    assert!((0.05..0.2).contains(&damped), "{damped}");
}

#[test]
fn modes_are_kept_to_four_times_the_band_or_forty_times_the_first_frequency() {
    let link = loaded(Damping::None);
    for (duration_s, few) in [(8.0, true), (0.01, false)] {
        let found = played(&link, &plan_of(&link, 60), &Play::of(&pulse(duration_s, 400)));
        let all = natural_frequencies(found.mesh(), 120);
        let (kept, band_hz) = (
            found.modes().unwrap().selection.modes,
            found.modes().unwrap().selection.torque_band_hz,
        );
        let first_hz = all[0] / TAU;
        assert_eq!(10.0 * first_hz > band_hz, few, "{:?}", found.modes().unwrap().selection);
        let reach_hz = 4.0 * band_hz.max(10.0 * first_hz);
        assert_eq!(kept, all.iter().filter(|omega| **omega / TAU < reach_hz).count());
        assert!(
            (found.modes().unwrap().selection.highest_hz * TAU / all[kept - 1] - 1.0).abs() < 1e-14
        );
        assert_eq!(found.modes().unwrap().selection.of, all.len());
    }
}

#[test]
fn a_hysteretic_link_has_its_vibration_behind_it_before_the_next_period_begins() {
    let link = link(|parts| parts.damping = Damping::Hysteretic { ratio: 0.05 });
    let tip_m = |until_s: f64| {
        let torque = super::torque(0.01, 40, |t| (PI * t / 0.4).sin().powi(2));
        let play = Play { until_s: Some(until_s), ..Play::of(&torque) };
        let found = played(&link, &plan_of(&link, 10), &play);
        let mut net_n_m = torque.torque_n_m().to_vec();
        net_n_m.resize(found.grid.len, 0.0);
        found.modes().unwrap().hysteretic_tip_m(0.05, &net_n_m)
    };
    let (once, thrice) = (tip_m(8.0), tip_m(24.0));
    let bent = apart(&once, &thrice);
    assert!(bent < 1e-3 * once[40], "{bent:e} m of {} m", once[40]);
}

/// What the integrals of few samples miss is told, of the loss as of the work; of fewer than eight
/// nothing can be.
#[test]
fn the_energy_of_few_samples_balances_within_the_error_that_is_told() {
    for (ratio, friction) in [(0.0, 0.0), (0.1, 0.0), (0.0, 0.5), (0.1, 0.5)] {
        let link = link(|parts| {
            parts.damping = Damping::Modal { ratios: vec![ratio] };
            parts.hub.viscous_friction_n_m_s_rad = friction;
        });
        for steps in [4, 5, 6, 7, 8, 20, 50] {
            let found = played(&link, &plan_of(&link, 10), &Play::of(&pulse(0.8, steps)));
            let account = found.energy(3);
            let told = account.quadrature_error_j;
            if steps < 7 {
                assert_eq!(told.to_bits(), 0.0_f64.to_bits());
                continue;
            }
            for at in account.balances {
                let off = (at.work_j - at.kinetic_j - at.strain_j - at.dissipated_j).abs();
                assert!(
                    off <= told,
                    "{ratio}, {friction}, {steps} steps: {off:e} J, not {told:e} J"
                );
            }
        }
    }
}
