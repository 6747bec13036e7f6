//! Kinds of numbers in the recursion; sums, largest values and rounding.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Mul, Sub};

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// Number of the recursion: real for modes and zeros, complex for a damped response, several lanes for a spectrum.
///
/// Every kind rounds alike: a lane has the bits of the single number.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Measure of size: one real number, or one for each lane.
    type Size: Size;

    /// `x` as a number of the kind of `self`.
    #[must_use]
    fn lift(self, x: f64) -> Self;

    /// `1/self`; for a complex number, its conjugate times `1/|self|²`.
    #[must_use]
    fn reciprocal(self) -> Self;

    /// Cheap measure of size within a factor √2 of the modulus, for the choice of pivots.
    fn size(self) -> Self::Size;

    /// `large` where `a ≥ b`, `otherwise` elsewhere.
    #[must_use]
    fn choose(a: Self::Size, b: Self::Size, large: Self, otherwise: Self) -> Self;
}

/// Sizes of the numbers of one kind.
pub trait Size: Copy + Add<Output = Self> + Mul<Output = Self> + Mul<f64, Output = Self> {
    /// The larger of two sizes; NaN wins, so that a breakdown always shows.
    #[must_use]
    fn larger(self, other: Self) -> Self;

    /// `large` where `a ≥ b`, `otherwise` elsewhere.
    #[must_use]
    fn choose(a: Self, b: Self, large: Self, otherwise: Self) -> Self;
}

impl Size for f64 {
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self >= other || self.is_nan() { self } else { other }
    }

    #[inline(always)]
    fn choose(a: f64, b: f64, large: f64, otherwise: f64) -> f64 {
        if a >= b { large } else { otherwise }
    }
}

impl Scalar for f64 {
    type Size = f64;

    #[inline(always)]
    fn lift(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn size(self) -> f64 {
        self.abs()
    }

    #[inline(always)]
    fn choose(a: f64, b: f64, large: Self, otherwise: Self) -> Self {
        if a >= b { large } else { otherwise }
    }
}

impl Scalar for Complex64 {
    type Size = f64;

    #[inline(always)]
    fn lift(self, x: f64) -> Self {
        x.into()
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        let scale = (self.re * self.re + self.im * self.im).reciprocal();
        Self::new(self.re * scale, -(self.im * scale))
    }

    #[inline(always)]
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }

    #[inline(always)]
    fn choose(a: f64, b: f64, large: Self, otherwise: Self) -> Self {
        if a >= b { large } else { otherwise }
    }
}

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
pub(crate) mod wide {
    use std::ops::{Add, Mul, Sub};

    use num_complex::Complex64;
    use twofloat::TwoFloat;

    use super::Scalar as _;

    /// Complex number with parts of 106 bits, to measure how many digits the recursion loses in 53.
    #[derive(Clone, Copy)]
    pub(crate) struct Wide {
        re: TwoFloat,
        im: TwoFloat,
    }

    impl Wide {
        /// The nearest number of 53 bits.
        pub(crate) fn nearest(self) -> Complex64 {
            Complex64::new(self.re.hi(), self.im.hi())
        }
    }

    impl From<f64> for Wide {
        fn from(value: f64) -> Self {
            Complex64::from(value).into()
        }
    }

    impl From<Complex64> for Wide {
        fn from(value: Complex64) -> Self {
            Self { re: value.re.into(), im: value.im.into() }
        }
    }

    impl Add for Wide {
        type Output = Self;
        fn add(self, other: Self) -> Self {
            Self { re: self.re + other.re, im: self.im + other.im }
        }
    }

    impl Sub for Wide {
        type Output = Self;
        fn sub(self, other: Self) -> Self {
            Self { re: self.re - other.re, im: self.im - other.im }
        }
    }

    impl Mul for Wide {
        type Output = Self;
        fn mul(self, other: Self) -> Self {
            let re = self.re * other.re - self.im * other.im;
            Self { re, im: self.re * other.im + self.im * other.re }
        }
    }

    impl Add<f64> for Wide {
        type Output = Self;
        fn add(self, other: f64) -> Self {
            Self { re: self.re + other, ..self }
        }
    }

    impl Mul<f64> for Wide {
        type Output = Self;
        fn mul(self, other: f64) -> Self {
            Self { re: self.re * other, im: self.im * other }
        }
    }

    impl super::Scalar for Wide {
        type Size = f64;

        fn lift(self, x: f64) -> Self {
            x.into()
        }

        fn reciprocal(self) -> Self {
            let square = self.re * self.re + self.im * self.im;
            let quotient = TwoFloat::from(1.0) / square;
            // The crate's quotient has 53 good bits; one correction by its residual makes it 106.
            let scale = quotient + (TwoFloat::from(1.0) - quotient * square) / square;
            Self { re: self.re * scale, im: self.im * scale * -1.0 }
        }

        fn size(self) -> f64 {
            self.re.hi().abs().max(self.im.hi().abs())
        }

        fn choose(a: f64, b: f64, large: Self, otherwise: Self) -> Self {
            if a >= b { large } else { otherwise }
        }
    }

    #[test]
    fn a_wide_quotient_has_more_than_a_hundred_bits() {
        for three in [Complex64::from(3.0), Complex64::new(3.0, -7.0)] {
            let three = Wide::from(three);
            let one = three * three.reciprocal() + -1.0;
            assert!(one.size() < 1e-31);
        }
    }
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
