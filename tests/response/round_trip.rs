//! probe
use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::{Analysis, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment, Taper};
use flexlink::motion::{MotionColumns, TipMotion};
use flexlink::response::{Interpolation, Play, Torque, simulate};

#[test]
fn probe() {
    let laws = [
        Damping::None,
        Damping::Rayleigh { alpha_per_s: 0.2, beta_s: 1e-3 },
        Damping::Modal { ratios: vec![0.02] },
        Damping::Hysteretic { ratio: 0.02 },
    ];
    let time_s: Vec<f64> = (0..=880).map(|k| 0.001 * f64::from(k)).collect();
    let sine = time_s.iter().map(|t| 4.06 * (std::f64::consts::TAU * t / 0.88).sin()).collect();
    let columns = MotionColumns { time_s, acceleration_m_s2: Some(sine), ..Default::default() };
    let motion = TipMotion::new(columns).unwrap();
    for law in laws {
        for friction in [0.0, 0.05] {
            let link = Link::new(LinkParts {
                title: String::new(),
                segments: vec![
                    Segment {
                        name: None,
                        length_m: 0.15,
                        bending_stiffness_n_m2: Taper::constant(50.0),
                        mass_per_length_kg_m: Taper::constant(0.8),
                    },
                    Segment {
                        name: None,
                        length_m: 1.35,
                        bending_stiffness_n_m2: Taper::constant(5.0),
                        mass_per_length_kg_m: Taper::constant(0.8),
                    },
                ],
                hub: Hub {
                    inertia_kg_m2: 0.1,
                    viscous_friction_n_m_s_rad: friction,
                    ..Hub::default()
                },
                masses: vec![],
                payload: Payload::default(),
                damping: law.clone(),
            })
            .unwrap();
            let plan = MeshPlan::new(&link, &[Some(1), Some(9)], None, 1e-6).unwrap();
            let _ = ElementCount::Auto;
            for tolerance in [1e-6, 1e-9, 1e-12] {
                let analysis = Analysis::new(tolerance, None, None).unwrap();
                let s = invert(&link, &plan, &motion, &analysis).unwrap();
                let t: Vec<f64> = (0..s.grid.len).map(|k| s.grid.time_s(k)).collect();
                let torque = Torque::new(&t, s.torque_n_m.clone()).unwrap();
                for interpolation in [Interpolation::Cubic, Interpolation::Linear] {
                    let start = std::time::Instant::now();
                    let play = Play { interpolation, ..Play::of(&torque) };
                    let found = simulate(&link, &plan, &play).unwrap();
                    let travel = motion.travel_m();
                    let err = found
                        .tip
                        .displacement_m
                        .iter()
                        .zip(&s.tip.displacement_m)
                        .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
                        / travel;
                    println!(
                        "{:?} b {friction} tol {tolerance:e} {interpolation:?}: err {err:.2e} edge {:.1e} rows {} modes {:?} residual {:?} {:?}",
                        law,
                        s.accuracy.edge_error,
                        s.grid.len,
                        found.selection,
                        found.residual,
                        start.elapsed()
                    );
                }
            }
        }
    }
}
