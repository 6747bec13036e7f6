//! Images: contributions of the motion in all other periods to a signal that decays as a power of time.
//!
//! A Fourier transform of period P adds the tails of all periods. A signal whose response to the motion has a kernel
//! h(s) → `Σ_m S_m/s^{2m+1}` far from it, such as a deflection under hysteretic damping, therefore also contains
//!
//! ```text
//! Σ_m S_m Q_m(t),   Q_m(t) = ∫ a(τ) K_m(t − τ) dτ,   K_m(s) = Σ_{k≠0} (s + kP)^{−(2m+1)}.
//! ```
//!
//! The `Q_m` depend only on the motion and the period, the `S_m` on the link.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::PI;
use std::sync::OnceLock;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::spectrum::TipSpectrum;
use crate::numeric::largest;

/// Number of terms: 1/s, 1/s³ and 1/s⁵.
pub(crate) const TAIL_TERMS: usize = 3;

/// One number for each term: `S_m` of a signal, or `Q_m` at a time.
pub(crate) type TailTerms = [f64; TAIL_TERMS];

/// Distance in periods up to which images are summed one by one; a power series covers those beyond.
const NEAR_PERIODS: i32 = 2;

/// Periods of the near images, without and with the motion's period.
const NEAR: [i32; 4] = [-2, -1, 1, 2];
const NEAR_AND_OWN: [i32; 5] = [-2, -1, 0, 1, 2];

/// Number of odd powers in the power series.
const POWERS: usize = 8;

/// Number of samples in one parallel task.
const BLOCK: usize = 4096;

/// The images of a motion in all other periods.
pub(crate) struct Images {
    step_s: f64,
    samples: usize,
    seam: usize,
    /// Times of the period; its samples from the seam on precede the others.
    span: Span,
    /// Samples around the seam, with the terms of the motion in all periods, including the motion's.
    around_seam: Vec<(usize, TailTerms)>,
    /// Chebyshev series of each `Q_m` over the period.
    series: [Vec<f64>; TAIL_TERMS],
    /// `Q_m` and its derivatives at all samples of the period, each computed on first use.
    histories: [OnceLock<Vec<TailTerms>>; 3],
}

/// Properties of a motion that determine its images.
struct Source {
    period_s: f64,
    /// Chebyshev points in s over the time of the acceleration, and the velocity in m/s gained around each. They
    /// replace the acceleration exactly, because the kernel is a polynomial over the motion.
    points_s: [f64; POINTS],
    gains_m_s: [f64; POINTS],
    /// Σ_{k>2} k^{−n} for n = 2, 4, ….
    beyond: [f64; POWERS + TAIL_TERMS],
}

impl Images {
    pub(super) fn new(spectrum: &TipSpectrum, forcing_m_s2: &[f64]) -> Self {
        let motion = Source::new(spectrum, forcing_m_s2);
        let (step_s, samples, seam) = (spectrum.step_s, spectrum.pair.len(), spectrum.seam);
        let places = spectrum.around_seam().0.into_iter();
        let around_seam =
            places.map(|(k, time_s)| (k, motion.terms(time_s, &NEAR_AND_OWN))).collect();
        let until_s = seam as f64 * step_s;
        let span = Span { from_s: until_s - samples as f64 * step_s, until_s };
        let cosines = Cosines::new();
        let at = |point: usize| motion.terms(span.at(cosines.of(1, point)), &NEAR);
        let values: Vec<TailTerms> = (0..POINTS).map(at).collect();
        let series = std::array::from_fn(|m| {
            let values: Vec<f64> = values.iter().map(|terms| terms[m]).collect();
            trimmed(cosines.series(&values))
        });
        let histories = [(); 3].map(|()| OnceLock::new());
        Self { step_s, samples, seam, span, around_seam, series, histories }
    }

    /// The `order`-th derivative of `Q_m` at every sample of the period.
    ///
    /// # Panics
    /// Beyond the second derivative.
    pub(crate) fn history(&self, order: usize) -> &[TailTerms] {
        // Computed outside the lock: a thread that waits for its blocks may take up another case, which would wait for
        // this lock. Cases that begin together each compute it.
        let kept = &self.histories[order];
        kept.get().unwrap_or_else(|| {
            let computed = self.computed(order);
            kept.get_or_init(|| computed)
        })
    }

    fn computed(&self, order: usize) -> Vec<TailTerms> {
        let series = self.series.each_ref().map(|series| {
            (0..order).fold(series.clone(), |series, _| self.span.derivative(&series))
        });
        let mut history = vec![[0.0; TAIL_TERMS]; self.samples];
        history.par_chunks_mut(BLOCK).enumerate().for_each(|(block, terms)| {
            let first = block * BLOCK;
            let series = &series;
            Arch::new().dispatch(Evaluation { images: self, series, first, terms });
        });
        history
    }

    /// A signal of a period around the seam, minus its tail and the tails of the images, in the signal's unit: the
    /// error of the finite period.
    ///
    /// # Panics
    /// If `signal` has not one sample for each of the period.
    pub(crate) fn residuals_at_seam(&self, signal: &[f64], tail: &TailTerms) -> Vec<f64> {
        assert_eq!(signal.len(), self.samples, "samples of the period");
        let around = self.around_seam.iter();
        around.map(|(k, terms)| signal[*k] - tail_sum(tail, terms)).collect()
    }
}

/// Evaluates the series at the samples of a period from `first` on.
struct Evaluation<'a> {
    images: &'a Images,
    series: &'a [Vec<f64>; TAIL_TERMS],
    first: usize,
    terms: &'a mut [TailTerms],
}

impl WithSimd for Evaluation<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { images, series, first, terms } = self;
        for (m, series) in series.iter().enumerate() {
            for (group, terms) in terms.chunks_mut(SIDE_BY_SIDE).enumerate() {
                let from = first + group * SIDE_BY_SIDE;
                let places = std::array::from_fn(|k| {
                    let k = from + k;
                    let steps =
                        k as f64 - if k < images.seam { 0.0 } else { images.samples as f64 };
                    images.span.scaled(steps * images.step_s)
                });
                for (terms, value) in terms.iter_mut().zip(clenshaw(series, places)) {
                    terms[m] = value;
                }
            }
        }
    }
}

/// `Σ_m S_m Q_m`.
pub(crate) fn tail_sum(tail: &TailTerms, terms: &TailTerms) -> f64 {
    tail[0] * terms[0] + tail[1] * terms[1] + tail[2] * terms[2]
}

impl Source {
    /// The images of a motion. `forcing_m_s2` are its samples from 0 s on, without a roll-off: the part that a roll-off
    /// removes has no moments, and rings near the motion, where the kernel does not hold.
    fn new(spectrum: &TipSpectrum, forcing_m_s2: &[f64]) -> Self {
        let (period_s, step_s) = (spectrum.period_s(), spectrum.step_s);
        let time_s = |k: usize| k as f64 * step_s;
        let counting = || forcing_m_s2.iter().enumerate().filter(|(_, a)| **a != 0.0);
        let times = || counting().map(|(k, _)| time_s(k));
        let span = Span {
            from_s: times().fold(f64::MAX, f64::min) - step_s,
            until_s: times().fold(f64::MIN, f64::max) + step_s,
        };
        let mut moments = [0.0; POINTS];
        for (k, acceleration) in counting() {
            let x = span.scaled(time_s(k));
            let (mut before, mut this) = (x, 1.0);
            for moment in &mut moments {
                *moment += acceleration * step_s * this;
                (before, this) = (this, 2.0 * x * this - before);
            }
        }
        moments[0] *= 0.5;
        let cosines = Cosines::new();
        let gains_m_s = std::array::from_fn(|point| {
            let sum: f64 = (0..POINTS).map(|j| moments[j] * cosines.of(j, point)).sum();
            2.0 / POINTS as f64 * sum
        });
        let points_s = std::array::from_fn(|point| span.at(cosines.of(1, point)));
        let mut exponent = 0;
        let beyond = std::array::from_fn(|_| {
            exponent += 2;
            beyond_near(exponent)
        });
        Self { period_s, points_s, gains_m_s, beyond }
    }

    /// `Q_m` at a time in s, from the images `near` and all beyond the near ones.
    fn terms(&self, time_s: f64, near: &[i32]) -> TailTerms {
        let mut terms = [0.0; TAIL_TERMS];
        for (at_s, gain) in self.points_s.iter().zip(&self.gains_m_s) {
            let kernel = self.kernel(time_s - at_s, near);
            for (term, kernel) in terms.iter_mut().zip(kernel) {
                *term += gain * kernel;
            }
        }
        terms
    }

    /// `K_m(s)` in `1/s^{2m+1}`.
    fn kernel(&self, away_s: f64, near: &[i32]) -> TailTerms {
        let mut kernel = [0.0; TAIL_TERMS];
        for image in near {
            let inverse = (away_s + f64::from(*image) * self.period_s).recip();
            let mut power = inverse;
            for term in &mut kernel {
                *term += power;
                power *= inverse * inverse;
            }
        }
        // The images beyond, in pairs: (s + kP)^{−q} + (s − kP)^{−q} = −2 (kP)^{−q} Σ_{j odd} C(q + j − 1, j) (s/kP)^j
        let share = away_s / self.period_s;
        let mut unit = self.period_s.recip();
        for (m, term) in kernel.iter_mut().enumerate() {
            let q = (2 * m + 1) as f64;
            let (mut sum, mut binomial, mut power) = (0.0, q, share);
            for n in 0..POWERS {
                sum += binomial * power * self.beyond[m + n];
                let j = (2 * n + 1) as f64;
                binomial *= (q + j) * (q + j + 1.0) / ((j + 1.0) * (j + 2.0));
                power *= share * share;
            }
            *term -= 2.0 * sum * unit;
            unit /= self.period_s * self.period_s;
        }
        kernel
    }
}

/// Σ_{k>2} k^{−n} for even n.
fn beyond_near(n: i32) -> f64 {
    const SUMMED: i32 = 64;
    let rest = f64::from(SUMMED) + 0.5;
    let sum: f64 = (NEAR_PERIODS + 1..=SUMMED).map(|k| f64::from(k).powi(-n)).sum();
    sum + rest.powi(1 - n) / f64::from(n - 1)
}

/// Number of Chebyshev points.
const POINTS: usize = 48;

/// Share of the largest coefficient below which coefficients are cut off: the images are a small part of a signal.
const ROUNDING: f64 = 1e-11;

/// Number of times in one evaluation of a series.
const SIDE_BY_SIDE: usize = 16;

/// A span of time, in s.
#[derive(Clone, Copy)]
struct Span {
    from_s: f64,
    until_s: f64,
}

impl Span {
    /// Time at x in −1 … 1.
    fn at(&self, x: f64) -> f64 {
        0.5 * (self.from_s + self.until_s) + 0.5 * (self.until_s - self.from_s) * x
    }

    /// x of a time, in −1 … 1.
    #[inline(always)]
    fn scaled(&self, time_s: f64) -> f64 {
        (2.0 * time_s - self.from_s - self.until_s) / (self.until_s - self.from_s)
    }

    /// Chebyshev series of the time derivative of a Chebyshev series.
    fn derivative(&self, series: &[f64]) -> Vec<f64> {
        let mut derived = vec![0.0; series.len() + 1];
        for j in (0..series.len() - 1).rev() {
            derived[j] = derived[j + 2] + 2.0 * (j + 1) as f64 * series[j + 1];
        }
        derived[0] *= 0.5;
        derived.truncate(series.len());
        let per_second = 2.0 / (self.until_s - self.from_s);
        derived.iter().map(|value| value * per_second).collect()
    }
}

/// Values of all Chebyshev polynomials below [`POINTS`] at the Chebyshev points.
struct Cosines([f64; 4 * POINTS]);

impl Cosines {
    fn new() -> Self {
        Self(std::array::from_fn(|k| libm::cos(PI * k as f64 / (2 * POINTS) as f64)))
    }

    /// `T_j` at point `point`.
    fn of(&self, j: usize, point: usize) -> f64 {
        self.0[j * (2 * point + 1) % (4 * POINTS)]
    }

    /// The series through values at the points.
    fn series(&self, values: &[f64]) -> Vec<f64> {
        let coefficient = |j: usize| {
            let sum: f64 =
                values.iter().enumerate().map(|(point, value)| value * self.of(j, point)).sum();
            (if j == 0 { 1.0 } else { 2.0 }) / POINTS as f64 * sum
        };
        (0..POINTS).map(coefficient).collect()
    }
}

/// A series without the negligible coefficients at its end.
fn trimmed(mut series: Vec<f64>) -> Vec<f64> {
    let least = ROUNDING * largest(&series);
    let counts = |c: &f64| c.abs() > least;
    series.truncate(series.iter().rposition(counts).map_or(1, |last| last + 1));
    series
}

/// Values of a Chebyshev series at x in −1 … 1, by Clenshaw's recurrence.
#[inline(always)]
fn clenshaw(series: &[f64], x: [f64; SIDE_BY_SIDE]) -> [f64; SIDE_BY_SIDE] {
    let (mut above, mut this) = ([0.0; SIDE_BY_SIDE], [0.0; SIDE_BY_SIDE]);
    for coefficient in series[1..].iter().rev() {
        for k in 0..SIDE_BY_SIDE {
            (above[k], this[k]) = (this[k], 2.0 * x[k] * this[k] - above[k] + coefficient);
        }
    }
    std::array::from_fn(|k| x[k] * this[k] - above[k] + series[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Cutoff, Profile, TipMotion};

    #[test]
    fn images_add_up_to_a_direct_sum_over_many_periods() {
        const MOST: i32 = 2000;
        let motion = TipMotion::new(Profile::Septic.sampled(0.5, 0.01, 100, [0, 0])).unwrap();
        for (len, seam) in [(300, 200), (150, 130), (3000, 1500)] {
            let period = motion.over_period(len, seam, Cutoff::ALL);
            let images = period.images();
            let period_s = len as f64 * 0.01;
            let direct = |time_s: f64, q: i32| -> f64 {
                let samples = motion.samples().forcing_m_s2().iter().enumerate();
                let of_sample = |(k, a): (usize, &f64)| {
                    let away_s = time_s - 0.01 * k as f64;
                    let image = |m: i32| (away_s + f64::from(m) * period_s).powi(-q);
                    let both: f64 = (1..=MOST).map(|m| image(m) + image(-m)).sum();
                    // For 1/s the images beyond add up to −2s/P² Σ 1/m².
                    let beyond = 2.0 * away_s / (period_s * period_s * (f64::from(MOST) + 0.5));
                    0.01 * a * (both - if q == 1 { beyond } else { 0.0 })
                };
                samples.map(of_sample).sum()
            };
            let history = images.history(0);
            for k in [0, 50, seam - 1, seam, len - 7] {
                let time_s = 0.01 * (k as f64 - if k < seam { 0.0 } else { len as f64 });
                for (m, (found, power)) in history[k].iter().zip([1, 3, 5]).enumerate() {
                    let exact = direct(time_s, power);
                    let scale = largest(&history.iter().map(|t| t[m]).collect::<Vec<_>>());
                    let off = (found - exact).abs() / scale;
                    assert!(off < 1e-6, "{len}: sample {k}, term {m}: {found} for {exact}");
                }
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_history() {
        let motion = TipMotion::new(Profile::Septic.sampled(0.5, 0.01, 100, [0, 0])).unwrap();
        let period = motion.over_period(300, 200, Cutoff::ALL);
        let images = period.images();
        for order in [1, 2] {
            let (before, derived) = (images.history(order - 1), images.history(order));
            for m in 0..TAIL_TERMS {
                let scale = largest(&derived.iter().map(|t| t[m]).collect::<Vec<_>>());
                for k in 1..199 {
                    let slope = (before[k + 1][m] - before[k - 1][m]) / 0.02;
                    assert!((slope - derived[k][m]).abs() < 2e-3 * scale, "order {order}, {k}");
                }
            }
        }
    }
}
