//! Numbers as text: singly on one core, and as a table on all. An element of the throughput is one
//! number.

use std::num::NonZeroUsize;

use criterion::{Criterion, Throughput};
use flexlink::csv::{Column, ColumnGroup, Digits, NumberFormat, write_csv};
use flexlink::numeric::{ThinnedGrid, TimeGrid};

use super::inputs::waves;

const NUMBERS: usize = 65_536;
const COLUMNS: usize = 100;
const ROWS: usize = 8192;

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("formatter");
    let numbers = waves(NUMBERS);
    group.throughput(Throughput::Elements(NUMBERS as u64));
    let mut text = Vec::with_capacity(32 * NUMBERS);
    for (name, format) in [
        ("11 decimals", NumberFormat::Fixed(11)),
        ("4 decimals", NumberFormat::Fixed(4)),
        ("shortest", NumberFormat::Shortest),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                text.clear();
                for number in &numbers {
                    format.write(&mut text, *number);
                }
                text.len()
            });
        });
    }

    let columns: Vec<Vec<f64>> = (0..COLUMNS).map(|k| waves(ROWS + k).split_off(k)).collect();
    let grid =
        TimeGrid { origin_s: 0.0, step_s: 1e-3, first: 0, len: ROWS }.thinned(NonZeroUsize::MIN);
    group.throughput(Throughput::Elements(((COLUMNS + 1) * ROWS) as u64));
    group.bench_function("table", |bencher| bencher.iter(|| table(&grid, &columns)));
    group.finish();
}

fn table(grid: &ThinnedGrid, columns: &[Vec<f64>]) {
    let named = columns.iter().enumerate();
    let columns = named.map(|(k, values)| Column { name: format!("v{k}_m"), values }).collect();
    let group = ColumnGroup { columns };
    write_csv(&mut std::io::sink(), grid, &[group], Digits::default()).unwrap();
}
