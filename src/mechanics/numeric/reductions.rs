//! Sums, largest values and rounding.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// Partial sums of a scalar product.
const PARTS: usize = 8;

/// Largest absolute value, ignoring NaN; 0 for an empty slice.
pub fn largest(values: &[f64]) -> f64 {
    Arch::new().dispatch(Largest(values))
}

/// Smallest and largest value, ignoring NaN; `[∞, −∞]` for an empty slice.
pub(crate) fn extremes(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(*value), high.max(*value)]
    })
}

struct Largest<'a>(&'a [f64]);

impl WithSimd for Largest<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        // Sixteen at a time, in vectors; the largest does not depend on their order.
        let (sixteens, rest) = self.0.as_chunks::<16>();
        let mut found = [0.0; 16];
        for sixteen in sixteens {
            for (found, value) in found.iter_mut().zip(sixteen) {
                *found = larger(*found, *value);
            }
        }
        found.iter().chain(rest).fold(0.0, |found, value| larger(found, *value))
    }
}

#[inline(always)]
fn larger(largest: f64, value: f64) -> f64 {
    if value.abs() > largest { value.abs() } else { largest }
}

/// Scalar product of two slices, from eight partial sums: in a single sum each addition would wait for the one before
/// it. The order does not depend on the processor.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    Arch::new().dispatch(Dot(a, b))
}

struct Dot<'a>(&'a [f64], &'a [f64]);

impl WithSimd for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let ((a, rest_a), (b, rest_b)) = (self.0.as_chunks::<PARTS>(), self.1.as_chunks::<PARTS>());
        let mut sums = [0.0; PARTS];
        for (a, b) in a.iter().zip(b) {
            for k in 0..PARTS {
                sums[k] += a[k] * b[k];
            }
        }
        let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
        sums.iter().sum::<f64>() + rest
    }
}

/// Largest absolute difference of two histories over their common samples.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}

/// Relative change: `change` over the larger of the sizes before and after; 0 if both sizes are 0 or infinite, 1 if
/// only one is infinite.
pub(crate) fn relative_change(change: f64, [before, after]: [f64; 2]) -> f64 {
    let share = change / before.max(after);
    match (before.is_finite(), after.is_finite()) {
        (true, true) if !share.is_nan() => share,
        (true, true) | (false, false) => 0.0,
        _ => 1.0,
    }
}

/// Absolute value |z|, with the same bits on every processor.
pub fn magnitude(z: Complex64) -> f64 {
    libm::hypot(z.re, z.im)
}

/// Rounds to `digits` ≥ 1 significant digits; 12 hide the round-off of arithmetic.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_product_is_summed_once_however_many_there_are() {
        for len in 0..30_u32 {
            let values: Vec<f64> = (1..=len).map(f64::from).collect();
            let squares = f64::from(len * (len + 1) * (2 * len + 1)) / 6.0;
            assert_eq!(dot(&values, &values).to_bits(), squares.to_bits());
        }
    }

    #[test]
    fn the_last_digits_of_arithmetic_are_gone() {
        for (value, digits, expected) in [
            (4.671_999_999_999_999, 12, "4.672"),
            (0.1 + 0.2, 12, "0.3"),
            (-0.553_210_7, 4, "-0.5532"),
            (1234.0, 2, "1200"),
            (0.0, 3, "0"),
            (f64::NAN, 3, "NaN"),
        ] {
            assert_eq!(rounded(value, digits).to_string(), expected);
        }
    }
}
