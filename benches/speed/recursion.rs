//! The recursion from tip to hub and from hub to tip, on one core. An element of the throughput is one
//! degree of freedom at one frequency.

use criterion::{BenchmarkId, Criterion, Throughput};
use flexlink::beam::{Mesh, NodalQuantity, nodal_transfer, nodal_transfers, tip_transfers};
use num_complex::Complex64;

use super::inputs::{lambdas, mesh};

const FREQUENCIES: u32 = 1024;
/// Frequencies solved at a time, as the program does.
const BLOCK: usize = 64;

pub(crate) fn bench(criterion: &mut Criterion) {
    let damped = lambdas(FREQUENCIES, 0.02);
    let undamped = lambdas(FREQUENCIES, 0.0);
    let mut group = criterion.benchmark_group("recursion");
    for elements in [10, 100, 1000] {
        let mesh = mesh(elements);
        let nodes: Vec<usize> = (0..=elements).collect();
        let per_frequency = 2 * elements as u64 + 1;
        group.throughput(Throughput::Elements(per_frequency * u64::from(FREQUENCIES)));
        group.bench_function(BenchmarkId::new("torque", elements), |bencher| {
            bencher.iter(|| torque(&mesh, &damped));
        });
        group.bench_function(BenchmarkId::new("deflections", elements), |bencher| {
            bencher.iter(|| nodal(&mesh, &damped, &nodes, NodalQuantity::Deflection));
        });
        if elements == 100 {
            group.bench_function(BenchmarkId::new("moments", elements), |bencher| {
                bencher.iter(|| nodal(&mesh, &damped, &nodes, NodalQuantity::Moment));
            });
            // With the few frequencies that hit a resonance of an outer part, which are solved again.
            group.bench_function(BenchmarkId::new("torque undamped", elements), |bencher| {
                bencher.iter(|| torque(&mesh, &undamped));
            });
            group.bench_function(BenchmarkId::new("deflections undamped", elements), |bencher| {
                bencher.iter(|| nodal(&mesh, &undamped, &nodes, NodalQuantity::Deflection));
            });
            group.bench_function(BenchmarkId::new("one by one", elements), |bencher| {
                bencher.iter(|| {
                    damped
                        .iter()
                        .map(|l| nodal_transfer(&mesh, *l).deflections_s2[1])
                        .sum::<Complex64>()
                });
            });
        }
    }
    group.finish();
}

fn torque(mesh: &Mesh, lambdas: &[Complex64]) -> Complex64 {
    lambdas.chunks(BLOCK).map(|lambdas| tip_transfers(mesh, lambdas)[0].inertia_kg_m).sum()
}

fn nodal(
    mesh: &Mesh,
    lambdas: &[Complex64],
    nodes: &[usize],
    quantity: NodalQuantity,
) -> Vec<Vec<Complex64>> {
    let mut table = vec![vec![Complex64::ZERO; BLOCK]; nodes.len()];
    for lambdas in lambdas.chunks(BLOCK) {
        let mut rows: Vec<_> = table.iter_mut().map(Vec::as_mut_slice).collect();
        nodal_transfers(mesh, lambdas, nodes, quantity, &mut rows).unwrap();
    }
    table
}
