use nalgebra::{SMatrix, SVector, Vector3};
use num_complex::Complex64;

use super::measurement::{Measured, Observable};
use super::response::Response;
use crate::numeric::magnitude;

/// Smallest ratio of both shoulders of a dip to its bottom: 6 dB.
const DEPTH: f64 = 2.0;

/// Number of samples on each side of a dip's bottom for a zero, if its flanks have no more.
const LEAST_REACH: usize = 3;

/// Largest damping ratio of a zero that appears as a dip.
const MOST_DAMPED: f64 = 0.2;

impl Response {
    /// Zeros from the dips, the lowest with the number `first`. Every closed loop around the hub has the zeros of
    /// torque → hub angle, whatever the controller, but its poles are not the link's. Around a dip a quotient of two
    /// polynomials of order 2 in the frequency is fitted to the samples, with differences relative to each. The zero is
    /// the magnitude of the numerator's root. Its uncertainty follows from that of the samples.
    pub fn zeros(&self, first: usize) -> Vec<Measured> {
        let mut samples: Vec<_> = self.samples().collect();
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Deeper than five uncertainties up and down can make a plateau; 12 dB always suffice.
        let reach = (5.0 * self.uncertainty().unwrap_or(0.0)).min(0.6);
        let depth = DEPTH.max((1.0 + reach) / (1.0 - reach));
        let bottoms = 1..samples.len().saturating_sub(1);
        let bottoms = bottoms.filter_map(|k| Dip::at(&samples, k, depth));
        let roots = bottoms.filter_map(|dip| dip.root(self.uncertainty()));
        let zero = |(k, (value, uncertainty))| Measured {
            observable: Observable::Zero { zero: first + k },
            value,
            uncertainty,
        };
        roots.enumerate().map(zero).collect()
    }
}

/// The samples around a minimum of the gain: frequency in Hz, value.
struct Dip<'a> {
    bottom_hz: f64,
    around: &'a [(f64, Complex64)],
}

impl<'a> Dip<'a> {
    /// The dip with its bottom at this sample, if it has this depth.
    fn at(samples: &'a [(f64, Complex64)], bottom: usize, depth: f64) -> Option<Self> {
        let gain = |k: usize| magnitude(samples[k].1);
        let least = gain(bottom);
        // Of equal bottoms the last one counts.
        let left = (0..bottom).rev().map(gain).take_while(|gain| *gain >= least);
        let right = (bottom + 1..samples.len()).map(gain).take_while(|gain| *gain > least);
        let shoulder = left.fold(least, f64::max).min(right.fold(least, f64::max));
        if shoulder < depth * least {
            return None;
        }
        // Farther up the flanks the poles beside the dip distort the response.
        let most = (least * shoulder).sqrt();
        let near = |k: &usize| gain(*k) <= most;
        let left = (0..bottom).rev().take_while(near).count().max(LEAST_REACH);
        let right = (bottom + 1..samples.len()).take_while(near).count().max(LEAST_REACH);
        let last = (bottom + right).min(samples.len() - 1);
        let around = &samples[bottom.saturating_sub(left)..=last];
        Some(Self { bottom_hz: samples[bottom].0, around })
    }

    /// Frequency of the zero in Hz and its uncertainty; `None` if the phase does not rise as at a zero of a link.
    fn root(&self, uncertainty: Option<f64>) -> Option<(f64, Option<f64>)> {
        let (lowest, highest) = (self.around.first()?.0, self.around.last()?.0);
        let width = highest - lowest;
        // Numerator minus value times denominator, over the value: `(c + bx + ax²)/G − dx − ex² = 1`.
        let powers = |x: Complex64| Vector3::new(Complex64::from(1.0), x, x * x);
        let row = |(hertz, value): &(f64, Complex64)| {
            let x = Complex64::from((hertz - self.bottom_hz) / width);
            let [zeroth, first, second] = powers(x).map(|power| power / value).into();
            SVector::from([zeroth, first, second, -x, -x * x])
        };
        let mut normal = SMatrix::<Complex64, 5, 5>::zeros();
        let mut right = SVector::<Complex64, 5>::zeros();
        for row in self.around.iter().map(row) {
            normal += row.conjugate() * row.transpose();
            right += row.conjugate();
        }
        let inverse = normal.try_inverse()?;
        let [c, b, a, ..] = (inverse * right).data.0[0];
        let inverse = inverse.fixed_view::<3, 3>(0, 0);
        // The smaller root, in a form without cancellation.
        let root_of = (b * b - 4.0 * a * c).sqrt();
        let signed = if (b.conj() * root_of).re < 0.0 { -root_of } else { root_of };
        let x = -2.0 * c / (b + signed);
        let zero = Complex64::from(self.bottom_hz) + x * width;
        let slope = magnitude(b + 2.0 * a * x) / width;
        // Variance of the numerator at the zero, `φᵀ C φ̄` with the covariance C of its coefficients.
        let at_zero = powers(x).conjugate();
        let spread = at_zero.dotc(&(inverse * at_zero)).re.sqrt() / slope;
        let uncertainty_hz = uncertainty.map(|own| own * spread);
        let is_inside = zero.re > lowest && zero.re < highest;
        let least_hz = -2.0 * uncertainty_hz.unwrap_or(0.01 * width);
        let is_zero = zero.im > least_hz && zero.im < MOST_DAMPED * zero.re;
        (is_inside && is_zero).then(|| (magnitude(zero), uncertainty_hz))
    }
}
