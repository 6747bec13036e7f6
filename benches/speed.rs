//! Times of the work behind the commands, in one alternating run: `cargo bench`.
//!
//! Medians of a few rounds, and ratios to the first row: only these compare between machines.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "a bench prints and may stop")]

use std::time::{Duration, Instant};

use flexlink::beam::{
    ElementCount, Mesh, MeshPlan, NodalQuantity, nodal_transfer, nodal_transfers, tip_transfer,
    tip_transfers,
};
use flexlink::inverse::{Analysis, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment, Taper};
use flexlink::motion::{MotionColumns, TipMotion};
use flexlink::response::{Play, Torque, simulate};
use flexlink::tables::{Column, ColumnGroup, Digits, write_csv};
use num_complex::Complex64;

const ROUNDS: usize = 5;
const ELEMENTS: usize = 1000;
const SAMPLES: usize = 65_536;
const STEP_S: f64 = 1e-3;

/// A row of the table and the work that it times.
type Row<'a> = (&'a str, Box<dyn FnMut() + 'a>);

fn main() {
    let link = link();
    let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(ELEMENTS)), 1e-6).unwrap();
    let motion = motion();
    let analysis = Analysis::default();
    let torque = torque();
    let play = Play::of(&torque);
    let nodes: Vec<usize> = (0..=ELEMENTS).collect();
    let simulation = simulate(&link, &plan, &play).unwrap();
    let moved = simulation.displacements_m(&nodes, 1);
    let plan_of_100 = MeshPlan::new(&link, &[None], Some(ElementCount::Total(100)), 1e-6).unwrap();
    let mesh = Mesh::new(&link, &plan_of_100);
    let lambdas = lambdas();
    println!("{ELEMENTS} elements, {SAMPLES} samples, {} modes", simulation.selection.modes);
    print_medians(&mut [
        (
            "solve: torque of a 1 s motion, mesh measured",
            Box::new(|| drop(invert(&link, &plan, &motion, &analysis).unwrap())),
        ),
        ("simulate: hub and tip", Box::new(|| drop(simulate(&link, &plan, &play).unwrap()))),
        (
            "simulate: displacements of all nodes",
            Box::new(|| drop(simulation.displacements_m(&nodes, 1))),
        ),
        (
            "simulate: their table as text",
            Box::new(|| {
                let columns = moved.nodes.iter().zip(&moved.samples);
                let columns = columns.map(|(k, values)| Column { name: format!("v{k}_m"), values });
                let group = ColumnGroup { columns: columns.collect() };
                let mut out = std::io::sink();
                write_csv(&mut out, &moved.grid, &[group], Digits::default()).unwrap();
            }),
        ),
        (
            "tip transfers of 100 elements x 8192, one by one",
            Box::new(|| drop(lambdas.iter().map(|l| tip_transfer(&mesh, *l)).collect::<Vec<_>>())),
        ),
        (
            "tip transfers of 100 elements x 8192, in lanes",
            Box::new(|| {
                drop(lambdas.chunks(64).map(|l| tip_transfers(&mesh, l)).collect::<Vec<_>>());
            }),
        ),
        (
            "nodal transfers of the same, one by one",
            Box::new(|| {
                drop(lambdas.iter().map(|l| nodal_transfer(&mesh, *l)).collect::<Vec<_>>());
            }),
        ),
        (
            "deflections of the same, in lanes",
            Box::new(|| all_nodes(&mesh, &lambdas, NodalQuantity::Deflection)),
        ),
        (
            "moments of the same, in lanes",
            Box::new(|| all_nodes(&mesh, &lambdas, NodalQuantity::Moment)),
        ),
    ]);
}

/// Transfers to every node on one core, 64 frequencies at a time as the program does.
fn all_nodes(mesh: &Mesh, lambdas: &[Complex64], quantity: NodalQuantity) {
    let nodes: Vec<usize> = (0..mesh.nodes_m().len()).collect();
    let mut table = vec![vec![Complex64::ZERO; 64]; nodes.len()];
    for lambdas in lambdas.chunks(64) {
        let mut rows: Vec<_> = table.iter_mut().map(Vec::as_mut_slice).collect();
        nodal_transfers(mesh, lambdas, &nodes, quantity, &mut rows);
    }
}

/// Of 8192 frequencies up to 130 Hz with hysteretic damping.
fn lambdas() -> Vec<Complex64> {
    let square = |k: u32| Complex64::from((0.1 * f64::from(k)).powi(2));
    (0..8192).map(|k| square(k) / Complex64::new(1.0, 0.04)).collect()
}

fn print_medians(rows: &mut [Row]) {
    let mut times = vec![Vec::with_capacity(ROUNDS); rows.len()];
    for _ in 0..ROUNDS {
        for ((_, work), times) in rows.iter_mut().zip(&mut times) {
            let start = Instant::now();
            work();
            times.push(start.elapsed());
        }
    }
    let median = |times: &mut Vec<Duration>| {
        times.sort();
        times[times.len() / 2].as_secs_f64()
    };
    let medians: Vec<f64> = times.iter_mut().map(median).collect();
    for ((name, _), seconds) in rows.iter().zip(&medians) {
        println!("{name:<48} {seconds:>8.3} s {:>7.2}", seconds / medians[0]);
    }
}

/// Bayo's link without its stiff root.
fn link() -> Link {
    Link::new(LinkParts {
        title: String::new(),
        segments: vec![Segment {
            name: None,
            length_m: 1.5,
            bending_stiffness_n_m2: Taper::constant(5.0),
            mass_per_length_kg_m: Taper::constant(0.8),
        }],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        masses: vec![],
        payload: Payload::default(),
        damping: Damping::Hysteretic { ratio: 0.02 },
    })
    .unwrap()
}

/// One period of a sine acceleration over 1 s.
fn motion() -> TipMotion {
    let time_s: Vec<f64> = (0..=1000).map(|k| STEP_S * f64::from(k)).collect();
    let sine = time_s.iter().map(|t| 3.0 * (std::f64::consts::TAU * t).sin()).collect();
    let columns = MotionColumns { time_s, acceleration_m_s2: Some(sine), ..Default::default() };
    TipMotion::new(columns).unwrap()
}

/// A torque as long as the samples, made of two sines.
fn torque() -> Torque {
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| STEP_S * k as f64).collect();
    let waves = |t: &f64| (2.0 * t).sin() + 0.3 * (11.0 * t).sin();
    let torque_n_m = time_s.iter().map(waves).collect();
    Torque::new(&time_s, torque_n_m).unwrap()
}
