//! Trajectories from text; the throughput is in bytes.

use std::fmt::Write as _;

use criterion::{Criterion, Throughput};
use flexlink::csv::read_motion_table;

use super::inputs::waves;

const ROWS: usize = 65_536;

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("reader");
    let samples = waves(ROWS);
    let mut full = String::from("time,acceleration\n");
    let mut short = full.clone();
    for (k, sample) in samples.iter().enumerate() {
        let time = 1e-3 * k as f64;
        writeln!(full, "{time:.3},{sample:.17e}").unwrap();
        writeln!(short, "{time:.3},{sample:.9}").unwrap();
    }
    for (name, text) in [("17 digits", full), ("9 decimals", short)] {
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| read_motion_table("motion.csv", text.as_bytes(), 1.5).unwrap());
        });
    }
    group.finish();
}
