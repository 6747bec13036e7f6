//! "The paper's own H": the program's element matrices, assembled (Bayo 1987, eqs 15-17).

use faer::c64;
use flexlink::beam::{Mesh, MeshPlan, nodal_transfer, tip_transfer};
use flexlink::link::{Hub, Link, LinkParts, Segment};

use super::assembly::{Assembly, Load};

/// The paper's link of n equal elements, the first one ten times stiffer than the others.
fn bayo(elements: usize) -> Mesh {
    let segment = |count: usize, stiffness: f64| {
        Segment::uniform(1.5 * count as f64 / elements as f64, stiffness, 0.8)
    };
    let link = Link::new(LinkParts {
        segments: vec![segment(1, 50.0), segment(elements - 1, 5.0)],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        ..LinkParts::default()
    })
    .expect("a valid link");
    let plan = MeshPlan::new(&link, &[Some(1), Some(elements - 1)], None, 1e-6);
    Mesh::new(&link, &plan.expect("a valid plan")).expect("a plan of the link")
}

#[test]
fn the_recursion_solves_the_papers_system() {
    for elements in [2, 5, 10] {
        let mesh = bayo(elements);
        let assembly = Assembly::of_mesh(&mesh);
        for omega in [2.0, 7.0, 12.0, 34.0, 71.0, 160.0, 400.0_f64] {
            let lambda = c64::from(omega * omega) / c64::new(1.0, 0.04);
            let a = assembly.accelerations(lambda, Load::HubTorque);
            let (tip, theta) = (a[2 * elements], a[1]);
            let found = nodal_transfer(&mesh, lambda);
            let close = |found: c64, dense: c64, size: f64, what: &str| {
                assert!(
                    (found - dense).norm() < 1e-10 * size,
                    "{elements} elements, {omega} rad/s: {what} {found} is not {dense}"
                );
            };
            for found in [found.tip, tip_transfer(&mesh, lambda)] {
                close(found.inertia_kg_m * tip, c64::ONE, 1.0, "torque");
                close(found.angle_rad_m * tip, theta, theta.norm(), "hub angle");
                let root = c64::ONE - theta * mesh.joint().inertia();
                close(found.root_inertia_kg_m * tip, root, 1.0, "moment at the root");
                close(found.deflection_s2 * lambda * tip, tip - theta * 1.5, tip.norm(), "lag");
            }
            for (node, lag) in found.deflections_s2.iter().enumerate() {
                let deflection = a[2 * node] - theta * mesh.nodes_m()[node];
                close(lag * lambda * tip, deflection, tip.norm(), "deflection");
            }
        }
    }
}
