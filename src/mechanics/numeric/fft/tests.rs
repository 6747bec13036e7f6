use realfft::RealFftPlanner;
use twofloat::TwoFloat;

use num_complex::Complex64;
use pulp::bytemuck::cast_slice;
use pulp::{Arch, Simd, WithSimd};

use super::transform::{Forward, Inverse, Plan, Scratch};
use super::{FourierPair, TAU, fast_length};

/// Patternless numbers between −1 and 1.
fn noise(len: usize) -> Vec<f64> {
    let mut state = len as u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (state >> 12) as f64 / 2f64.powi(51) - 1.0
    };
    (0..len).map(|_| next()).collect()
}

/// Amplitudes of a real signal of `len` samples.
fn spectrum(len: usize) -> Vec<Complex64> {
    let parts = noise(len + 2);
    let mut amplitudes: Vec<_> =
        parts.chunks_exact(2).map(|z| Complex64::new(z[0], z[1])).collect();
    (amplitudes[0].im, amplitudes[len / 2].im) = (0.0, 0.0);
    amplitudes
}

fn forward_with(samples: &[f64], scratch: &mut Scratch) -> Vec<Complex64> {
    let (plan, scale) = (&Plan::new(samples.len() / 2), 1.0);
    let mut found = vec![Complex64::ZERO; samples.len() / 2 + 1];
    let amplitudes = &mut found[..];
    Arch::new().dispatch(Forward { plan, samples, scale, scratch, amplitudes });
    found
}

fn forward(samples: &[f64]) -> Vec<Complex64> {
    forward_with(samples, &mut Scratch::default())
}

fn inverse_with(amplitudes: &[Complex64], len: usize, scratch: &mut Scratch) -> Vec<f64> {
    let mut found = vec![f64::NAN; len];
    let (plan, samples) = (&Plan::new(len / 2), &mut found[..]);
    Arch::new().dispatch(Inverse { plan, amplitudes, scratch, samples });
    found
}

fn inverse(amplitudes: &[Complex64], len: usize) -> Vec<f64> {
    inverse_with(amplitudes, len, &mut Scratch::default())
}

/// Root mean square of the differences, relative to the root mean square of `expected`.
fn error(found: &[f64], expected: &[f64]) -> f64 {
    let square = |x: f64| x * x;
    let differences: f64 = found.iter().zip(expected).map(|(a, b)| square(a - b)).sum();
    (differences / expected.iter().map(|x| square(*x)).sum::<f64>()).sqrt()
}

/// Largest difference, relative to the root mean square of `expected`.
fn largest_error(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let rms = (expected.iter().map(|x| x * x).sum::<f64>() / expected.len() as f64).sqrt();
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / rms
}

fn flat(amplitudes: &[Complex64]) -> &[f64] {
    cast_slice(amplitudes)
}

/// Cosines and sines of all multiples of a turn's N-th part.
fn turns(len: usize) -> Vec<(f64, f64)> {
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / len as f64;
    (0..len).map(|k| (libm::cos(angle(k)), libm::sin(angle(k)))).collect()
}

/// The definition of the forward transform, summed with 106 bits.
fn direct_forward(samples: &[f64]) -> Vec<Complex64> {
    let len = samples.len();
    let turns = turns(len);
    let sum = |k: usize, part: fn((f64, f64)) -> f64| {
        let terms = samples.iter().enumerate();
        let zero = TwoFloat::from(0.0);
        let sum = terms.fold(zero, |s, (j, x)| s + TwoFloat::new_mul(*x, part(turns[j * k % len])));
        f64::from(sum)
    };
    (0..=len / 2).map(|k| Complex64::new(sum(k, |t| t.0), -sum(k, |t| t.1))).collect()
}

/// The definition of the inverse transform, summed with 106 bits.
fn direct_inverse(amplitudes: &[Complex64], len: usize) -> Vec<f64> {
    let turns = turns(len);
    let term = |j: usize, k: usize| {
        let (cos, sin) = turns[j * k % len];
        let weight = if k == 0 || k == len / 2 { 1.0 } else { 2.0 };
        let re = TwoFloat::new_mul(weight * amplitudes[k].re, cos);
        re - TwoFloat::new_mul(weight * amplitudes[k].im, sin)
    };
    let sum = |j| (0..=len / 2).fold(TwoFloat::from(0.0), |s, k| s + term(j, k));
    (0..len).map(|j| f64::from(sum(j))).collect()
}

fn reference_forward(samples: &[f64]) -> Vec<Complex64> {
    let fft = RealFftPlanner::new().plan_fft_forward(samples.len());
    let mut amplitudes = fft.make_output_vec();
    fft.process(&mut samples.to_vec(), &mut amplitudes).unwrap();
    amplitudes
}

fn reference_inverse(amplitudes: &[Complex64], len: usize) -> Vec<f64> {
    let mut samples = vec![0.0; len];
    let fft = RealFftPlanner::new().plan_fft_inverse(len);
    fft.process(&mut amplitudes.to_vec(), &mut samples).unwrap();
    samples
}

/// Allowed rounding error: 1e-15 for each doubling of the length.
fn tolerance(len: usize) -> f64 {
    1e-15 * (len as f64).log2().max(1.0)
}

#[test]
fn every_even_length_up_to_400_is_the_definition() {
    for len in (2..=400).step_by(2) {
        let (samples, amplitudes) = (noise(len), spectrum(len));
        let found = forward(&samples);
        let away = largest_error(flat(&found), flat(&direct_forward(&samples)));
        assert!(away < tolerance(len), "forward {len}: {away:e}");
        assert!(found[0].im == 0.0 && found[len / 2].im == 0.0, "ends of {len}");
        let away = largest_error(&inverse(&amplitudes, len), &direct_inverse(&amplitudes, len));
        assert!(away < tolerance(len), "inverse {len}: {away:e}");
    }
}

#[test]
fn long_transforms_are_those_of_rustfft() {
    for len in [2048, 2250, 5000, 13_824, 16_384, 46_656, 65_536, 109_350, 1 << 20] {
        let (samples, amplitudes) = (noise(len), spectrum(len));
        let away = largest_error(flat(&forward(&samples)), flat(&reference_forward(&samples)));
        assert!(away < tolerance(len), "forward {len}: {away:e}");
        let expected = reference_inverse(&amplitudes, len);
        let away = largest_error(&inverse(&amplitudes, len), &expected);
        assert!(away < tolerance(len), "inverse {len}: {away:e}");
    }
}

#[test]
fn rounding_is_no_worse_than_that_of_rustfft() {
    for len in [1024, 1080, 2048, 3072] {
        let (samples, amplitudes) = (noise(len), spectrum(len));
        let exact = direct_forward(&samples);
        let own = error(flat(&forward(&samples)), flat(&exact));
        let other = error(flat(&reference_forward(&samples)), flat(&exact));
        assert!(own < 1.05 * other, "forward {len}: {own:e}, rustfft {other:e}");
        let exact = direct_inverse(&amplitudes, len);
        let own = error(&inverse(&amplitudes, len), &exact);
        let other = error(&reference_inverse(&amplitudes, len), &exact);
        assert!(own < 1.05 * other, "inverse {len}: {own:e}, rustfft {other:e}");
    }
}

#[test]
fn missing_amplitudes_are_zero_however_many_are_missing() {
    for len in [2, 6, 30, 64, 2048, 2250, 13_824, 65_536] {
        let amplitudes = spectrum(len);
        let mut scratch = Scratch::default();
        for given in [0, 1, 2, 17, len / 16, len / 9, len / 4, len / 2, len / 2 + 1] {
            let given = given.min(len / 2 + 1);
            let mut padded = amplitudes[..given].to_vec();
            padded.resize(len / 2 + 1, Complex64::ZERO);
            let expected = inverse(&padded, len);
            // A full spectrum leaves numbers in the scratch, which must not matter.
            inverse_with(&amplitudes, len, &mut scratch);
            let found = inverse_with(&amplitudes[..given], len, &mut scratch);
            assert!(found == expected, "{given} amplitudes of {len} samples");
        }
    }
}

#[test]
fn a_scratch_serves_transforms_of_any_length_in_turn() {
    let mut scratch = Scratch::default();
    for len in [4096, 30, 2250, 2, 4096] {
        let (samples, amplitudes) = (noise(len), spectrum(len));
        assert_eq!(forward_with(&samples, &mut scratch), forward(&samples));
        let found = inverse_with(&amplitudes, len, &mut scratch);
        assert_eq!(found, inverse(&amplitudes, len));
    }
}

/// All bits of both transforms on the vectors of `S`.
fn bits<S: Simd>(simd: S, len: usize) -> Vec<u64> {
    let (samples, amplitudes) = (noise(len), spectrum(len));
    let (plan, scratch) = (&Plan::new(len / 2), &mut Scratch::default());
    let mut found = vec![Complex64::ZERO; len / 2 + 1];
    let out = &mut found;
    Forward { plan, samples: &samples, scale: 0.1, scratch, amplitudes: out }.with_simd(simd);
    let mut bits: Vec<_> = flat(&found).iter().map(|x| x.to_bits()).collect();
    for amplitudes in [&amplitudes[..], &amplitudes[..len / 20]] {
        let mut samples = vec![0.0; len];
        Inverse { plan, amplitudes, scratch, samples: &mut samples }.with_simd(simd);
        bits.extend(samples.iter().map(|x| x.to_bits()));
    }
    bits
}

#[test]
fn every_width_of_vectors_gives_the_same_bits() {
    for len in [2, 50, 512, 2048, 2250, 13_824, 2 * 7 * 11 * 13] {
        let scalar = bits(pulp::Scalar, len);
        #[cfg(target_arch = "x86_64")]
        {
            let v3 = pulp::x86::V3::try_new().map(|v3| bits(v3, len));
            assert!(v3.is_none_or(|v3| v3 == scalar), "four lanes at {len}");
            let v4 = pulp::x86::V4::try_new().map(|v4| bits(v4, len));
            assert!(v4.is_none_or(|v4| v4 == scalar), "eight lanes at {len}");
        }
    }
}

#[test]
fn amplitudes_are_those_of_a_direct_sum_with_a_negative_exponent() {
    let x = [0.3, -1.0, 2.0, 0.7, 0.1, -0.4];
    let found = FourierPair::new(6).amplitudes(x);
    for (k, found) in found.iter().enumerate() {
        let direct: Complex64 = x
            .iter()
            .enumerate()
            .map(|(j, x)| Complex64::cis(-TAU * (j * k) as f64 / 6.0) * x / 6.0)
            .sum();
        assert!((found - direct).norm() < 1e-15);
    }
}

#[test]
fn samples_undo_amplitudes_and_missing_amplitudes_are_zero() {
    let pair = FourierPair::new(60);
    let x: Vec<f64> = (0..60).map(|j| (0.1 * f64::from(j)).sin()).collect();
    let back = pair.samples(pair.amplitudes(x.clone()));
    assert!(x.iter().zip(&back).all(|(x, y)| (x - y).abs() < 1e-15));
    let few = pair.amplitudes(&x[..40]);
    assert_eq!(few, pair.amplitudes([&x[..40], &[0.0; 20]].concat()));
    assert_eq!(pair.amplitudes([&x[..], &[3.0]].concat()), pair.amplitudes(&x));
    assert_eq!(pair.samples([&few[..], &[Complex64::ONE]].concat()), pair.samples(&few));
    let mean = pair.samples(vec![Complex64::new(2.5, 7.0)]);
    assert!(mean.iter().all(|x| (x - 2.5).abs() < 1e-15));
}

#[test]
fn fast_lengths_are_the_least_even_numbers_of_small_factors() {
    let smooth = |mut n: usize| {
        let even = n.is_multiple_of(2);
        for p in [2, 3, 5] {
            while n.is_multiple_of(p) {
                n /= p;
            }
        }
        even && n == 1
    };
    for len in 1..3000 {
        let expected = (len..2 * len + 2).find(|&n| smooth(n)).unwrap();
        assert_eq!(fast_length(len), expected, "length {len}");
    }
}

/// A half length with a large prime factor is transformed by a chirp: compared with passes over the whole circle.
#[test]
fn a_length_with_a_large_prime_factor_has_the_same_transform() {
    for len in [2 * 151, 2 * 1009, 6 * 401] {
        let x = noise(len);
        let pair = FourierPair::new(len);
        assert!(matches!(&*pair.0, super::Method::Chirp(_)), "{len}");
        let plan = Plan::new(len / 2);
        let mut amplitudes = vec![Complex64::ZERO; len / 2 + 1];
        let scale = 1.0 / len as f64;
        let scratch = &mut Scratch::default();
        let (samples, found) = (&x[..], &mut amplitudes[..]);
        Arch::new().dispatch(Forward { plan: &plan, samples, scale, scratch, amplitudes: found });
        let found = pair.amplitudes(&x);
        for (a, b) in found.iter().zip(&amplitudes) {
            assert!((a - b).norm() < 1e-15, "{len}: {a} and {b}");
        }
        let back = pair.samples(&found);
        assert!(x.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-13), "{len}");
        let few = pair.samples(&found[..40]);
        let mut whole = found.clone();
        whole[40..].fill(Complex64::ZERO);
        assert_eq!(few, pair.samples(&whole));
    }
}
