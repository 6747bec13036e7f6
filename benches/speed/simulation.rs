//! Direct dynamics of 1000 elements over 65 536 samples. An element of the throughput is one sample
//! of hub and tip, or of one node.

use std::num::NonZeroUsize;

use criterion::{Criterion, Throughput};
use flexlink::response::{Play, Torque, simulate};

use super::inputs::{damped_link, plan, waves};

const ELEMENTS: usize = 1000;
const SAMPLES: usize = 65_536;
/// Every so many samples of every node are kept.
const EVERY: NonZeroUsize = NonZeroUsize::MIN.saturating_add(15);

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation");
    group.sample_size(10);
    let link = damped_link();
    let plans = [plan(&link, ELEMENTS)];
    let arm = link.into();
    let time_s: Vec<f64> = (0..SAMPLES).map(|k| 1e-3 * k as f64).collect();
    let torque = Torque::new(&time_s, waves(SAMPLES)).unwrap();
    let play = Play::of(&torque);
    group.throughput(Throughput::Elements(SAMPLES as u64));
    group.bench_function("hub and tip", |bencher| {
        bencher.iter(|| simulate(&arm, &plans, &play, &|_| {}).unwrap());
    });
    let simulation = simulate(&arm, &plans, &play, &|_| {}).unwrap();
    let nodes: Vec<usize> = (0..=ELEMENTS).collect();
    group.throughput(Throughput::Elements(((ELEMENTS + 1) * SAMPLES / EVERY.get()) as u64));
    group.bench_function("displacements of all nodes", |bencher| {
        bencher.iter(|| simulation.displacements_m(&nodes, EVERY));
    });
    group.finish();
}
