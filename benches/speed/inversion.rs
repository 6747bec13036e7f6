//! Whole inversions of a motion of 1 s on all cores, the mesh measured. An element of the
//! throughput is one element of the link.

use criterion::{BenchmarkId, Criterion, Throughput};
use flexlink::inverse::{Analysis, invert};

use super::inputs::{damped_link, motion, plan};

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("inversion");
    let (link, motion, analysis) = (damped_link(), motion(), Analysis::default());
    for elements in [10, 100, 1000] {
        let plan = plan(&link, elements);
        group.throughput(Throughput::Elements(elements as u64));
        group.bench_function(BenchmarkId::new("torque", elements), |bencher| {
            bencher.iter(|| invert(&link, &plan, &motion, &analysis).unwrap());
        });
    }
    group.finish();
}
