//! A run to look at, as it is read back from its folder.

use crate::beam::{Mesh, MeshPlan};
use crate::inverse::{Analysis, Solution, invert};
use crate::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};
use crate::motion::{Profile, TipMotion};
use crate::result::{
    Metrics, Origin, StoredInput, StoredNodes, StoredRun, StoredSolution, StoredWarning,
};

/// The paper's first example with a small mass and a payload, its title full of traps.
pub(super) fn link(viscous_friction_n_m_s_rad: f64) -> Link {
    let segment = |name: &str, length_m, stiffness| Segment {
        name: Some(name.to_owned()),
        length_m,
        bending_stiffness_n_m2: Taper::constant(stiffness),
        mass_per_length_kg_m: Taper::constant(0.8),
        cross_section: None,
    };
    Link::new(LinkParts {
        title: "</script><script>alert(1)</script> & \"link\"".to_owned(),
        segments: vec![segment("root", 0.15, 50.0), segment("<b>beam", 1.35, 5.0)],
        hub: Hub { inertia_kg_m2: 0.1, viscous_friction_n_m_s_rad, ..Hub::default() },
        masses: vec![LumpedMass { at_m: 0.75, mass_kg: 0.05, inertia_kg_m2: 0.0 }],
        payload: Payload { mass_kg: 0.05, ..Payload::default() },
        damping: Damping::Hysteretic { ratio: 0.02 },
        drive: None,
    })
    .unwrap()
}

/// Its solution for a sine of 0.88 s.
pub(super) fn solution() -> Solution {
    let link = link(0.0);
    let plan = MeshPlan::new(&link, &[Some(1), Some(9)], None, 1e-6).unwrap();
    let motion = TipMotion::new(Profile::Sine.sampled(0.5, 0.002, 440, [50, 50])).unwrap();
    invert(&link, &plan, &motion, &Analysis::default()).unwrap()
}

/// The same as it is read back from its folder.
pub(super) fn run() -> StoredRun {
    let (link, solution) = (link(0.0), solution());
    let metrics = Metrics::of(&solution);
    let mesh: Mesh = solution.mesh().clone();
    let all: Vec<usize> = (0..mesh.nodes_m().len()).collect();
    let times = |len: usize| (0..len).map(|k| solution.grid.time_s(k)).collect::<Vec<f64>>();
    let times_s = times(solution.grid.len);
    StoredRun {
        origin: Origin {
            command: "solve".to_owned(),
            version: "0.1.0".to_owned(),
            title: link.title().to_owned(),
            inputs: vec![StoredInput {
                role: "link".to_owned(),
                name: "<i>link.toml".to_owned(),
                sha256: "0".repeat(64),
            }],
            arguments: vec!["--set".to_owned(), "title=<u>".to_owned()],
        },
        kept_modes: None,
        torque_n_m: solution.torque_n_m.clone(),
        hub_angle_rad: solution.hub_angle_rad.clone(),
        tip: solution.tip.clone(),
        solved: Some(StoredSolution {
            rigid_torque_n_m: solution.rigid_torque_n_m.clone(),
            rigid_hub_angle_rad: solution.rigid_hub_angle_rad.clone(),
            motor_torque_n_m: None,
            moving_s: (
                solution.grid.time_s(solution.moving.0),
                solution.grid.time_s(solution.moving.1),
            ),
            lead_s: metrics.lead_s,
            lag_s: metrics.lag_s,
        }),
        deflections_m: Some(StoredNodes {
            nodes: all.clone(),
            times_s: times_s.clone(),
            histories: solution.deflections(&all, 1).histories().samples,
        }),
        moments_n_m: None,
        readings: vec![("peak_torque_n_m".to_owned(), metrics.peak_torque_n_m.value)],
        checks: vec![],
        remarks: vec![StoredWarning {
            message: "a density of <b>".to_owned(),
            hint: "another unit".to_owned(),
        }],
        warnings: vec![StoredWarning {
            message: "<em>bent".to_owned(),
            hint: "less & slower".to_owned(),
        }],
        times_s,
        link,
        mesh,
    }
}
