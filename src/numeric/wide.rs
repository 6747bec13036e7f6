//! A scalar for tests: twice the digits, to tell how many the same recursion loses.

use std::ops::{Add, Div, Mul, Sub};

use num_complex::Complex64;
use twofloat::TwoFloat;

use super::Scalar;

/// A number of 106 bits, to measure how many digits the same recursion loses in 53.
#[derive(Clone, Copy)]
pub(crate) struct Wide(TwoFloat);

impl Wide {
    /// The nearest number of 53 bits.
    pub(crate) fn nearest(self) -> f64 {
        self.0.hi()
    }
}

impl From<f64> for Wide {
    fn from(value: f64) -> Self {
        Self(value.into())
    }
}

impl Div for Wide {
    type Output = Self;
    /// The crate's quotient has 53 good bits; one correction by its residual makes it 106.
    fn div(self, other: Self) -> Self {
        let quotient = self.0 / other.0;
        Self(quotient + (self.0 - quotient * other.0) / other.0)
    }
}

macro_rules! arithmetic {
    ($($name:ident $method:ident $sign:tt),*) => {$(
        impl $name for Wide {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0 $sign other.0)
            }
        }

        impl $name<f64> for Wide {
            type Output = Self;
            fn $method(self, other: f64) -> Self {
                Self(self.0 $sign other)
            }
        }
    )*};
}

arithmetic!(Add add +, Sub sub -, Mul mul *);

impl Scalar for Wide {
    type Size = f64;

    fn lift(self, x: f64) -> Self {
        x.into()
    }

    fn reciprocal(self) -> Self {
        Self::from(1.0) / self
    }

    fn size(self) -> f64 {
        self.0.hi().abs()
    }

    fn choose(a: f64, b: f64, large: Self, otherwise: Self) -> Self {
        if a >= b { large } else { otherwise }
    }
}

/// The same with an imaginary part, for links with damping.
#[derive(Clone, Copy)]
pub(crate) struct WideComplex {
    pub(crate) re: Wide,
    pub(crate) im: Wide,
}

impl From<Complex64> for WideComplex {
    fn from(value: Complex64) -> Self {
        Self { re: value.re.into(), im: value.im.into() }
    }
}

impl WideComplex {
    /// The nearest number of 53 bits.
    pub(crate) fn nearest(self) -> Complex64 {
        Complex64::new(self.re.nearest(), self.im.nearest())
    }
}

impl Add for WideComplex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for WideComplex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for WideComplex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let re = self.re * other.re - self.im * other.im;
        Self { re, im: self.re * other.im + self.im * other.re }
    }
}

impl Add<f64> for WideComplex {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        Self { re: self.re + other, ..self }
    }
}

impl Mul<f64> for WideComplex {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        Self { re: self.re * other, im: self.im * other }
    }
}

impl Scalar for WideComplex {
    type Size = f64;

    fn lift(self, x: f64) -> Self {
        Complex64::from(x).into()
    }

    fn reciprocal(self) -> Self {
        let per_norm = (self.re * self.re + self.im * self.im).reciprocal();
        Self { re: self.re * per_norm, im: self.im * per_norm * -1.0 }
    }

    fn size(self) -> f64 {
        self.re.size().max(self.im.size())
    }

    fn choose(a: f64, b: f64, large: Self, otherwise: Self) -> Self {
        if a >= b { large } else { otherwise }
    }
}

#[test]
fn a_wide_quotient_has_more_than_a_hundred_bits() {
    let third = Wide::from(1.0) / Wide::from(3.0);
    assert!((third * 3.0 - 1.0).size() < 1e-31);
}

#[test]
fn a_wide_complex_quotient_has_more_than_a_hundred_bits() {
    let three = WideComplex::from(Complex64::new(3.0, -7.0));
    let one = three * three.reciprocal() + -1.0;
    assert!(one.size() < 1e-31);
}
