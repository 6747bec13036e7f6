//! The Fourier pair, one sequence at a time on one core. An element of the throughput is one sample.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput};
use flexlink::numeric::FourierPair;

use super::inputs::waves;

/// Powers of two as in the cases, and the lengths between that padding comes to.
const LENGTHS: [usize; 6] = [2048, 8640, 16_384, 65_536, 98_304, 1 << 20];
/// Amplitudes of a narrow band.
const BAND: usize = 2172;

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("transform");
    for len in LENGTHS {
        let pair = FourierPair::fast(len);
        let samples = waves(len);
        let amplitudes = pair.amplitudes(samples.clone());
        group.throughput(Throughput::Elements(len as u64));
        group.bench_function(BenchmarkId::new("amplitudes", len), |bencher| {
            bencher.iter_batched(
                || samples.clone(),
                |samples| pair.amplitudes(samples),
                BatchSize::LargeInput,
            );
        });
        group.bench_function(BenchmarkId::new("samples", len), |bencher| {
            bencher.iter_batched(
                || amplitudes.clone(),
                |amplitudes| pair.samples(amplitudes),
                BatchSize::LargeInput,
            );
        });
        if amplitudes.len() > 2 * BAND {
            group.bench_function(BenchmarkId::new("samples of a narrow band", len), |bencher| {
                bencher.iter_batched(
                    || amplitudes[..BAND].to_vec(),
                    |amplitudes| pair.samples(amplitudes),
                    BatchSize::LargeInput,
                );
            });
        }
    }
    group.finish();
}
