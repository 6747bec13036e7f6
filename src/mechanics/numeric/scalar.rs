//! Kinds of numbers in the recursion.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Mul, Sub};

use num_complex::Complex64;

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
