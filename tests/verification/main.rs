//! What `verify` measures, and that it finds what is wrong.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod dense;

use std::f64::consts::PI;

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::{Analysis, DenseLink, Dynamics, KeptModes, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};
use flexlink::motion::{MotionColumns, TipMotion};
use flexlink::response::{Play, Torque, simulate};
use flexlink::verification::{Answer, Outcome, Verification, verify};

/// A tapered link with hub radius, friction, a lumped mass and a payload.
fn link(stiffness_n_m2: f64, damping: Damping) -> Link {
    Link::new(LinkParts {
        title: String::new(),
        segments: vec![Segment {
            name: None,
            length_m: 1.4,
            bending_stiffness_n_m2: Taper { inner: stiffness_n_m2, outer: 0.6 * stiffness_n_m2 },
            mass_per_length_kg_m: Taper { inner: 0.9, outer: 0.7 },
            cross_section: None,
        }],
        hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.1, viscous_friction_n_m_s_rad: 0.05 },
        masses: vec![LumpedMass { at_m: 0.8, mass_kg: 0.1, inertia_kg_m2: 0.0 }],
        payload: Payload { mass_kg: 0.1, inertia_kg_m2: 0.0, offset_m: 0.0 },
        damping,
        drive: None,
    })
    .unwrap()
}

/// Tip velocity that rises and falls as sin⁶, 0.5 m far.
fn smooth(duration_s: f64, steps: u32) -> TipMotion {
    let phase = |k: u32| PI * f64::from(k) / f64::from(steps);
    let peak = 3.2 * 6.0 * PI * 0.5 / duration_s.powi(2);
    let acceleration = |k: u32| peak * phase(k).sin().powi(5) * phase(k).cos();
    let columns = MotionColumns {
        time_s: (0..=steps).map(|k| duration_s * phase(k) / PI).collect(),
        acceleration_m_s2: Some((0..=steps).map(acceleration).collect()),
        ..Default::default()
    };
    TipMotion::new(columns).unwrap()
}

/// A run that can be spoiled before it is verified.
struct Run {
    link: Link,
    plan: MeshPlan,
    motion: TipMotion,
    analysis: Analysis,
    solution: Solution,
}

impl Run {
    fn new(damping: Damping, elements: usize, motion: TipMotion, analysis: Analysis) -> Self {
        let link = link(6.0, damping);
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(elements)), 1e-6);
        let plan = plan.unwrap();
        let solution = invert(&link, &plan, &motion, &analysis).unwrap();
        Self { link, plan, motion, analysis, solution }
    }

    fn usual() -> Self {
        Self::new(Damping::Hysteretic { ratio: 0.02 }, 24, smooth(0.88, 880), Analysis::default())
    }

    fn verified(&self, written_torque_n_m: &[f64]) -> Verification {
        let Self { link, plan, motion, analysis, solution } = self;
        let answer = Answer { link, plan, motion, analysis, solution, written_torque_n_m };
        verify(&answer).unwrap()
    }

    fn as_computed(&self) -> Verification {
        self.verified(&self.solution.torque_n_m)
    }
}

fn failed(verification: &Verification) -> Vec<&'static str> {
    verification.failed().map(|check| check.name).collect()
}

fn found(verification: &Verification, name: &str) -> f64 {
    let check = verification.checks.iter().find(|check| check.name == name).unwrap();
    match check.outcome {
        Outcome::Measured { found, .. } => found,
        Outcome::NotMeasured { .. } => panic!("{name} was not measured"),
    }
}

#[test]
fn a_right_answer_passes_under_every_law() {
    for damping in [
        Damping::None,
        Damping::Hysteretic { ratio: 0.02 },
        Damping::Rayleigh { alpha_per_s: 0.1, beta_s: 2e-4 },
        Damping::Modal { ratios: vec![0.01, 0.03] },
    ] {
        let is_hysteretic = matches!(damping, Damping::Hysteretic { .. });
        let verification =
            Run::new(damping.clone(), 24, smooth(0.88, 880), Analysis::default()).as_computed();
        assert_eq!(failed(&verification), [""; 0], "{damping:?}: {verification:?}");
        let names: Vec<&str> = verification.checks.iter().map(|check| check.name).collect();
        assert_eq!(names.contains(&"tip_error_viscous"), is_hysteretic);
        for name in
            ["tip_error", "mesh_halving", "step_halving", "wrap_around", "dense_transfer", "energy"]
        {
            assert!(names.contains(&name), "{damping:?} lacks {name}");
        }
        assert!(found(&verification, "dense_transfer") < 1e-10, "{damping:?}");
        assert!(found(&verification, "energy") < 1e-7, "{damping:?}");
    }
}

#[test]
fn a_hysteretic_torque_strays_on_a_viscous_link_as_the_laws_differ() {
    let run = Run::usual();
    let verification = run.as_computed();
    let (own, viscous) =
        (found(&verification, "tip_error"), found(&verification, "tip_error_viscous"));
    assert!(own < 1e-4 && viscous < 1e-4, "{own:e} and {viscous:e}");
    // Without the prediction the tip is 0.1 to 1 % of its way off.
    let Run { link, plan, solution, .. } = &run;
    let time_s: Vec<f64> = (0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect();
    let torque = Torque::new(&time_s, solution.torque_n_m.clone()).unwrap();
    let tip_m = simulate(link, plan, &Play::of(&torque)).unwrap().tip.displacement_m;
    let pairs = tip_m.iter().zip(&solution.tip.displacement_m);
    let strays = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / 0.5;
    assert!((1e-3..1e-2).contains(&strays), "{strays:e}");
}

#[test]
fn a_torque_that_is_written_wrong_is_found() {
    let run = Run::usual();
    let torque = &run.solution.torque_n_m;
    let larger: Vec<f64> = torque.iter().map(|t| 1.001 * t).collect();
    assert_eq!(failed(&run.verified(&larger)), ["tip_error", "tip_error_viscous"]);
    let mut late = vec![0.0];
    late.extend(&torque[..torque.len() - 1]);
    assert_eq!(failed(&run.verified(&late)), ["tip_error", "tip_error_viscous"]);
    let coarse: Vec<f64> = torque.iter().map(|t| (t * 20.0).round() / 20.0).collect();
    assert!(failed(&run.verified(&coarse)).contains(&"tip_error"));
}

#[test]
fn a_cut_lead_is_found_at_the_edge_and_at_the_tip() {
    let analysis = Analysis::new(1e-6, Some(0.1), None).unwrap();
    let run = Run::new(Damping::Hysteretic { ratio: 0.02 }, 24, smooth(0.88, 880), analysis);
    let failed = failed(&run.as_computed());
    assert_eq!(failed, ["tip_error", "tip_error_viscous", "wrap_around"]);
}

#[test]
fn a_coarse_mesh_and_a_coarse_step_are_found() {
    let law = Damping::Hysteretic { ratio: 0.02 };
    let coarse_mesh = Run::new(law.clone(), 2, smooth(0.25, 250), Analysis::default());
    assert!(failed(&coarse_mesh.as_computed()).contains(&"mesh_halving"));
    let coarse_step = Run::new(law, 24, smooth(0.88, 8), Analysis::default());
    assert!(failed(&coarse_step.as_computed()).contains(&"step_halving"));
}

#[test]
fn a_reduction_to_too_few_modes_is_found_and_the_dense_system_is_not_asked() {
    let analysis = Analysis::default().keeping_modes(1).unwrap();
    let law = Damping::Hysteretic { ratio: 0.02 };
    let verification = Run::new(law, 24, smooth(0.88, 880), analysis).as_computed();
    assert!(failed(&verification).contains(&"truncation"));
    let dense = verification.checks.iter().find(|check| check.name == "dense_transfer").unwrap();
    let reason = Outcome::NotMeasured { reason: "the link is reduced to few modes".into() };
    assert_eq!(dense.outcome, reason);
}

/// The laws part by far more than a wrong torque at large ratios: what is predicted of them does not.
#[test]
fn a_torque_off_by_half_a_percent_is_found_under_either_law_at_every_ratio() {
    for ratio in [0.001, 0.02, 0.1, 0.3] {
        let law = Damping::Hysteretic { ratio };
        let run = Run::new(law, 24, smooth(0.88, 880), Analysis::default());
        let right = run.as_computed();
        assert_eq!(failed(&right), [] as [&str; 0], "ratio {ratio}: {right:?}");
        let torque = &run.solution.torque_n_m;
        let larger: Vec<f64> = torque.iter().map(|t| 1.005 * t).collect();
        let wrong = run.verified(&larger);
        assert_eq!(failed(&wrong), ["tip_error", "tip_error_viscous"], "ratio {ratio}: {wrong:?}");
    }
}

#[test]
fn more_bending_than_three_tenths_of_the_length_is_found() {
    let bent = |duration_s| {
        let law = Damping::Hysteretic { ratio: 0.02 };
        let run = Run::new(law, 24, smooth(duration_s, 880), Analysis::default());
        let deflections = run.solution.tip_deflection_m();
        let share = deflections.iter().fold(0.0_f64, |m, w| m.max(w.abs())) / 1.5;
        (share, failed(&run.as_computed()).contains(&"tip_deflection"))
    };
    let (small, large) = (bent(0.88), bent(0.5));
    assert!(small.0 < 0.3 && !small.1, "{small:?}");
    assert!(large.0 > 0.3 && large.1, "{large:?}");
}

#[test]
fn the_dense_system_of_another_link_is_told_from_this_one() {
    let dynamics = |stiffness| {
        let link = link(stiffness, Damping::Modal { ratios: vec![0.02] });
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(10)), 1e-6).unwrap();
        let mesh = flexlink::beam::Mesh::new(&link, &plan);
        Dynamics::new(&link, mesh, KeptModes::All).unwrap()
    };
    let (own, other) = (dynamics(6.0), dynamics(6.001));
    let difference = |dense: &Dynamics| {
        let dense = DenseLink::assemble(dense).unwrap();
        let frequencies = [5.0, 20.0, 70.0, 150.0];
        let relative = frequencies.map(|omega| {
            let exact = own.tip_transfer(omega).inertia_kg_m;
            (dense.torque_per_tip_acceleration_kg_m(omega) - exact).norm() / exact.norm()
        });
        relative.into_iter().fold(0.0, f64::max)
    };
    assert!(difference(&own) < 1e-10, "{:e}", difference(&own));
    assert!(difference(&other) > 1e-5, "{:e}", difference(&other));
}
