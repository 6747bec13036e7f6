//! Eight complex numbers side by side, and vectors of them.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Mul, Sub};

use pulp::Simd;

/// Eight complex numbers: whole vectors on every processor, whole lines of its cache.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Eight {
    pub(super) re: [f64; 8],
    pub(super) im: [f64; 8],
}

impl Eight {
    pub(super) const ZERO: Self = Self { re: [0.0; 8], im: [0.0; 8] };

    /// Vector number `at`, below [`Vector::PER_EIGHT`].
    #[inline(always)]
    pub(super) fn vector<S: Simd>(&self, simd: S, at: usize) -> Vector<S> {
        let (re, im) = (S::as_simd_f64s(&self.re).0, S::as_simd_f64s(&self.im).0);
        Vector { simd, re: re[at], im: im[at] }
    }

    /// Sets the vector number `at`.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, at: usize, vector: Vector<S>) {
        S::as_mut_simd_f64s(&mut self.re).0[at] = vector.re;
        S::as_mut_simd_f64s(&mut self.im).0[at] = vector.im;
    }

    /// Reads real and imaginary parts that alternate.
    #[inline(always)]
    pub(super) fn of_pairs(numbers: &[f64; 16]) -> Self {
        let mut eight = Self::ZERO;
        for (k, [re, im]) in numbers.as_chunks().0.iter().enumerate() {
            (eight.re[k], eight.im[k]) = (*re, *im);
        }
        eight
    }

    /// Reads like [`Self::of_pairs`], from the last number to the first.
    #[inline(always)]
    pub(super) fn of_pairs_backwards(numbers: &[f64; 16]) -> Self {
        let mut eight = Self::ZERO;
        for (k, [re, im]) in numbers.as_chunks().0.iter().rev().enumerate() {
            (eight.re[k], eight.im[k]) = (*re, *im);
        }
        eight
    }

    /// Writes the first `count` numbers, at most eight, each real part followed by its imaginary part.
    #[inline(always)]
    pub(super) fn write_pairs(&self, numbers: &mut [f64], count: usize) {
        let mut pairs = [0.0; 16];
        for (k, pair) in pairs.as_chunks_mut().0.iter_mut().enumerate() {
            *pair = [self.re[k], self.im[k]];
        }
        if count < 8 {
            numbers[..2 * count].copy_from_slice(&pairs[..2 * count]);
        } else if let Some(numbers) = numbers.first_chunk_mut() {
            *numbers = pairs;
        }
    }
}

/// Row k of the result is column k of `rows`.
#[inline(always)]
pub(super) fn transposed(rows: &[[f64; 8]; 8]) -> [[f64; 8]; 8] {
    let mut columns = [[0.0; 8]; 8];
    for (j, row) in rows.iter().enumerate() {
        for (column, x) in columns.iter_mut().zip(row) {
            column[j] = *x;
        }
    }
    columns
}

/// One vector of complex numbers.
#[derive(Clone, Copy)]
pub(super) struct Vector<S: Simd> {
    pub(super) re: S::f64s,
    pub(super) im: S::f64s,
    simd: S,
}

impl<S: Simd> Vector<S> {
    /// Number of vectors in an [`Eight`].
    pub(super) const PER_EIGHT: usize = 8 / S::F64_LANES;

    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        Self::splat(simd, [0.0; 2])
    }

    #[inline(always)]
    pub(super) fn splat(simd: S, [re, im]: [f64; 2]) -> Self {
        Self { simd, re: simd.splat_f64s(re), im: simd.splat_f64s(im) }
    }

    /// Real and imaginary parts exchanged.
    #[inline(always)]
    pub(super) fn exchanged(self) -> Self {
        Self { re: self.im, im: self.re, ..self }
    }

    #[inline(always)]
    pub(super) fn conjugate(self) -> Self {
        Self { im: self.simd.neg_f64s(self.im), ..self }
    }

    #[inline(always)]
    pub(super) fn plus_i_times(self, other: Self) -> Self {
        let simd = self.simd;
        Self { simd, re: simd.sub_f64s(self.re, other.im), im: simd.add_f64s(self.im, other.re) }
    }

    #[inline(always)]
    pub(super) fn minus_i_times(self, other: Self) -> Self {
        let simd = self.simd;
        Self { simd, re: simd.add_f64s(self.re, other.im), im: simd.sub_f64s(self.im, other.re) }
    }
}

impl<S: Simd> Add for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let simd = self.simd;
        Self { simd, re: simd.add_f64s(self.re, other.re), im: simd.add_f64s(self.im, other.im) }
    }
}

impl<S: Simd> Sub for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let simd = self.simd;
        Self { simd, re: simd.sub_f64s(self.re, other.re), im: simd.sub_f64s(self.im, other.im) }
    }
}

impl<S: Simd> Mul for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let simd = self.simd;
        Self {
            simd,
            re: simd.sub_f64s(simd.mul_f64s(self.re, other.re), simd.mul_f64s(self.im, other.im)),
            im: simd.add_f64s(simd.mul_f64s(self.re, other.im), simd.mul_f64s(self.im, other.re)),
        }
    }
}

impl<S: Simd> Mul<f64> for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        let simd = self.simd;
        let other = simd.splat_f64s(other);
        Self { simd, re: simd.mul_f64s(self.re, other), im: simd.mul_f64s(self.im, other) }
    }
}
