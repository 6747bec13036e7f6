//! A real Fourier transform whose bits do not depend on the processor or the operating system.
//!
//! The usual libraries (rustfft, and realfft over it) take the factors `e^{2πi k/N}` from the system's sine and cosine,
//! and choose algorithm and rounding by processor. Here the order of operations depends on the length alone, every
//! product and every sum is rounded, and sines come from `libm`. The width of the processor's vectors only sets how
//! many columns are transformed at a time.
//!
//! [`FourierPair`] is the interface. `transform` computes a real transform by a complex one of half the length, split
//! into rows and columns; `passes` has the butterflies along a row or a column, `vector` eight complex numbers side by
//! side. A length with a large prime factor takes a chirp. The tests compare the transforms with their definition in
//! 106 bits, and with realfft.

mod passes;
#[cfg(test)]
mod tests;
mod transform;
mod vector;

pub(crate) use transform::Scratch;

use std::borrow::Cow;
use std::f64::consts::TAU;
use std::sync::Arc;

use num_complex::Complex64;
use pulp::Arch;

use passes::cis;
use transform::{Forward, Inverse, Plan};

use crate::system::end_if_stopped;

/// Fourier pair on an even number N of real samples.
///
/// ```text
/// X_k = (1/N) Σ_j x_j e^{−2πi jk/N}    k = 0 … N/2
/// x_j = Σ_k X_k e^{+2πi jk/N}          k = −N/2 + 1 … N/2, X_{−k} = conj X_k
/// ```
/// so that `X_k` is the complex amplitude of `e^{+iω_k t}` with `ω_k = 2πk/P` (Bayo 1987, eq 13).
#[derive(Debug, Clone)]
pub struct FourierPair(Arc<Method>);

/// Method of transformation, chosen by the length.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "it is always behind an Arc")]
enum Method {
    Passes(Plan),
    Chirp(Chirp),
}

/// Largest prime factor of N/2 that is transformed by passes. Their time grows with the factor, that of a chirp does
/// not.
const LARGEST_FACTOR: usize = 150;

/// Transform of any length N as a convolution with the chirp w, in time N log N (Bluestein, IEEE Trans. Audio and
/// Electroacoustics 18(4), 1970). From `jk = (j² + k² − (k − j)²)/2` follows
///
/// ```text
/// Σ_j x_j e^{−2πi jk/N} = w̄_k Σ_j (x_j w̄_j) w_{k−j},   w_j = e^{πi j²/N}
/// ```
#[derive(Debug)]
struct Chirp {
    /// w of the N samples.
    turns: Vec<Complex64>,
    /// The Fourier pair for the convolution, at least twice as long.
    pair: FourierPair,
    /// Amplitudes of the real and of the imaginary part of w, from −N + 1 to N − 1.
    kernel: [Vec<Complex64>; 2],
}

impl Chirp {
    fn new(len: usize) -> Self {
        let turn = |j: usize| cis(j * j % (2 * len), 2 * len);
        let turns: Vec<Complex64> =
            (0..len).map(turn).map(|[re, im]| Complex64::new(re, im)).collect();
        let pair = FourierPair::fast(2 * len);
        let amplitudes = |part: fn(&Complex64) -> f64| {
            let mut samples = vec![0.0; pair.len()];
            for (j, turn) in turns.iter().enumerate() {
                samples[j] = part(turn);
                // w_{−j} = w_j, and the samples repeat with the period of the pair.
                samples[(pair.len() - j) % pair.len()] = part(turn);
            }
            pair.amplitudes(samples)
        };
        let kernel = [amplitudes(|turn| turn.re), amplitudes(|turn| turn.im)];
        Self { turns, pair, kernel }
    }

    /// `Σ_j x_j e^{−2πi jk/N}` for k < `count`, without the factor 1/N.
    fn transform(&self, values: impl Iterator<Item = Complex64>, count: usize) -> Vec<Complex64> {
        // The pair transforms real samples, so that real and imaginary parts are convolved one by one.
        let factors: Vec<Complex64> =
            values.zip(&self.turns).map(|(value, turn)| value * turn.conj()).collect();
        let amplitudes = |part: fn(&Complex64) -> f64| {
            self.pair.amplitudes(factors.iter().map(part).collect::<Vec<f64>>())
        };
        let spectra = [amplitudes(|factor| factor.re), amplitudes(|factor| factor.im)];
        // Both amplitudes of a product are over the length of the pair, their convolution needs it once.
        let scale = self.pair.len() as f64;
        // The real parts with one part of the kernel, plus or minus the imaginary parts with the other.
        let convolution = |kernel_of_re: usize, kernel_of_im: usize, sign: f64| {
            let re = spectra[0].iter().zip(&self.kernel[kernel_of_re]);
            let im = spectra[1].iter().zip(&self.kernel[kernel_of_im]);
            let products = re.zip(im).map(|((a, b), (c, d))| (a * b + c * d * sign) * scale);
            self.pair.samples(products.collect::<Vec<_>>())
        };
        let (real, imaginary) = (convolution(0, 1, -1.0), convolution(1, 0, 1.0));
        let sums = real.into_iter().zip(imaginary).zip(&self.turns).take(count);
        sums.map(|((re, im), turn)| Complex64::new(re, im) * turn.conj()).collect()
    }

    /// Amplitudes of samples, times `scale`.
    fn amplitudes(&self, samples: &[f64], scale: f64) -> Vec<Complex64> {
        let values = samples.iter().map(|sample| Complex64::from(*sample));
        let mut amplitudes = self.transform(values, samples.len() / 2 + 1);
        for amplitude in &mut amplitudes {
            *amplitude *= scale;
        }
        // Real samples have real amplitudes at zero and at the Nyquist frequency.
        for end in [0, samples.len() / 2] {
            amplitudes[end].im = 0.0;
        }
        amplitudes
    }

    /// Writes the samples of amplitudes, `Re Σ_k X_k e^{+2πi jk/N}` over k = 0 … N/2. The factor 2 stands for `X_{−k}`.
    /// Since the transform has the other sign, it receives the conjugate of each amplitude: the conjugate of the sum
    /// has the same real part.
    fn samples(&self, amplitudes: &[Complex64], samples: &mut [f64]) {
        let last = samples.len() / 2;
        let values = amplitudes.iter().enumerate().map(|(k, amplitude)| match k {
            0 => amplitude.re.into(),
            k if k == last => amplitude.re.into(),
            _ => 2.0 * amplitude.conj(),
        });
        let sums = self.transform(values, samples.len());
        samples.iter_mut().zip(sums).for_each(|(sample, sum)| *sample = sum.re);
    }
}

/// Largest prime factor of a number.
fn largest_factor(mut number: usize) -> usize {
    let (mut factor, mut largest) = (2, 1);
    while factor * factor <= number {
        while number.is_multiple_of(factor) {
            (number, largest) = (number / factor, factor);
        }
        factor += 1;
    }
    largest.max(number)
}

impl FourierPair {
    /// Plans the pair for N ≥ `len` samples, N being the next length that is fast to transform.
    pub fn fast(len: usize) -> Self {
        Self::new(fast_length(len))
    }

    /// Plans the pair for `len` samples, an even number above 0. Lengths from [`fast_length`] are fast; others take up
    /// to about ten times as long.
    ///
    /// # Panics
    /// If `len` is odd or zero.
    pub(crate) fn new(len: usize) -> Self {
        assert!(len > 0 && len.is_multiple_of(2), "a Fourier pair needs an even length, not {len}");
        Self(Arc::new(if largest_factor(len / 2) > LARGEST_FACTOR {
            Method::Chirp(Chirp::new(len))
        } else {
            Method::Passes(Plan::new(len / 2))
        }))
    }

    /// Number N of samples.
    pub fn len(&self) -> usize {
        match &*self.0 {
            Method::Passes(plan) => 2 * plan.points,
            Method::Chirp(chirp) => chirp.turns.len(),
        }
    }

    /// Always false: a pair has at least two samples.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Amplitudes `X_0 … X_{N/2}` of N samples; pads missing samples with zeros and ignores further ones.
    pub fn amplitudes(&self, samples: impl AsRef<[f64]>) -> Vec<Complex64> {
        end_if_stopped();
        let scale = 1.0 / self.len() as f64;
        let mut samples = Cow::Borrowed(samples.as_ref());
        if samples.len() != self.len() {
            samples.to_mut().resize(self.len(), 0.0);
        }
        let samples = &samples[..self.len()];
        let plan = match &*self.0 {
            Method::Passes(plan) => plan,
            Method::Chirp(chirp) => return chirp.amplitudes(samples, scale),
        };
        let mut all = vec![Complex64::ZERO; self.len() / 2 + 1];
        let (scratch, amplitudes) = (&mut Scratch::default(), &mut all[..]);
        Arch::new().dispatch(Forward { plan, samples, scale, scratch, amplitudes });
        all
    }

    /// The N samples of the amplitudes `X_0 …`; missing amplitudes count as zero, and those beyond `X_{N/2}` are
    /// ignored.
    ///
    /// Uses only the real parts at zero and at the Nyquist frequency: no real signal has an imaginary part there.
    pub fn samples(&self, amplitudes: impl AsRef<[Complex64]>) -> Vec<f64> {
        let mut samples = vec![0.0; self.len()];
        let amplitudes = amplitudes.as_ref();
        let amplitudes = &amplitudes[..amplitudes.len().min(self.len() / 2 + 1)];
        self.write_samples(amplitudes, &mut Scratch::default(), &mut samples);
        samples
    }

    /// Writes the result of [`Self::samples`] into `samples`; `scratch` is working memory, reusable across calls.
    ///
    /// # Panics
    /// With more than N/2 + 1 amplitudes, or unless `samples` has N places.
    pub(crate) fn write_samples(
        &self,
        amplitudes: &[Complex64],
        scratch: &mut Scratch,
        samples: &mut [f64],
    ) {
        end_if_stopped();
        let (len, bins) = (self.len(), self.len() / 2 + 1);
        assert!(amplitudes.len() <= bins, "{} amplitudes for {bins} bins", amplitudes.len());
        assert_eq!(samples.len(), len, "samples of a Fourier pair");
        match &*self.0 {
            Method::Passes(plan) => {
                Arch::new().dispatch(Inverse { plan, amplitudes, scratch, samples });
            }
            Method::Chirp(chirp) => chirp.samples(amplitudes, samples),
        }
    }
}

/// Angular frequency of bin `k` in rad/s for N samples at `step_s`.
pub(crate) fn angular_frequency(k: usize, len: usize, step_s: f64) -> f64 {
    TAU * k as f64 / (len as f64 * step_s)
}

/// Least even number of the form 2ᵃ 3ᵇ 5ᶜ that is at least `len`: fast to transform.
pub(crate) fn fast_length(len: usize) -> usize {
    let mut best = len.max(2).next_power_of_two();
    let mut fives = 1;
    while fives < best {
        let mut odd = fives;
        while odd < best {
            // The least power of two that lifts `odd` to `len`: at least 2, so that the length is even.
            let twos = len.div_ceil(odd).next_power_of_two().max(2);
            best = best.min(odd * twos);
            odd *= 3;
        }
        fives *= 5;
    }
    best
}
