use flexlink::{beam::*, link::*, modal::*};
use num_complex::Complex64;
fn link(stiff: bool, payload: Payload) -> Link {
    let seg = |l, ei| Segment {
        name: None,
        length_m: l,
        bending_stiffness_n_m2: Taper::constant(ei),
        mass_per_length_kg_m: Taper::constant(0.8),
    };
    Link::new(LinkParts {
        title: String::new(),
        segments: if stiff {
            vec![seg(0.15, 50.0), seg(1.35, 5.0)]
        } else {
            vec![seg(1.5, 5.0)]
        },
        hub: Hub {
            inertia_kg_m2: 0.1,
            ..Hub::default()
        },
        masses: vec![],
        payload,
        damping: Damping::None,
    })
    .unwrap()
}
fn main() {
    let l = link(true, Payload::default());
    for (a, b) in [(1, 9), (10, 90)] {
        let m = Mesh::new(
            &l,
            &MeshPlan::new(&l, &[Some(a), Some(b)], None, 1e-6).unwrap(),
        );
        println!(
            "{:?}",
            natural_frequencies(&m, 5)
                .iter()
                .map(|w| std::f64::consts::TAU / w)
                .collect::<Vec<_>>()
        );
        println!("{:?}", torque_zeros(&m, 3));
    }
    let l = link(false, Payload::default());
    for n in [10, 100, 1000, 4000] {
        let m = Mesh::new(&l, &MeshPlan::new(&l, &[Some(n)], None, 1e-6).unwrap());
        println!("n={n}");
        for f in [0.5, 1., 2., 5., 10., 20.] {
            let w: f64 = std::f64::consts::TAU * f;
            println!(
                "{f} {:.10}",
                tip_transfer(&m, Complex64::from(w * w) / Complex64::new(1., 0.04)).inertia_kg_m
            );
        }
        println!("{:?}", torque_zeros(&m, 3));
        // flagged frequencies
        let mut worst = (0.0, 0.0);
        for k in 1..4000 {
            let w = k as f64 * 0.1;
            let h = hub_response(&m, w * w);
            if h.largest_gain > worst.0 {
                worst = (h.largest_gain, w);
            }
        }
        println!("worst gain {worst:?}");
    }
    for eps in [0.001, 0.01, 0.1] {
        let l = link(
            false,
            Payload {
                mass_kg: 0.0,
                inertia_kg_m2: eps * 0.8 * 1.5f64.powi(3),
                offset_m: 0.0,
            },
        );
        let m = Mesh::new(&l, &MeshPlan::new(&l, &[Some(200)], None, 1e-6).unwrap());
        println!(
            "{:?}",
            real_frequency_zeros(&m, 400.0)
                .iter()
                .map(|w| (w * (0.8f64 / 5.0).sqrt()).sqrt() * 1.5)
                .collect::<Vec<_>>()
        );
    }
}
