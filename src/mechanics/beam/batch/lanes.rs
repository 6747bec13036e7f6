//! Several numbers at a time: the same operation on each lane, and no operation across lanes.
//!
//! Each product and sum is rounded by itself, without fused multiply-add, so that every instruction set gives the same
//! bits.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Deref, Mul, Neg, Sub};

use num_complex::Complex64;
use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use crate::numeric::{Scalar, Size};

/// Largest number of lanes in any instruction set: two vectors of eight.
const MOST_LANES: usize = 16;

/// One number for each lane, aligned to a line of the cache. A function with such an array on its stack
/// aligns all its vectors there, which saves a tenth of its time.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes<T>(pub(super) [T; MOST_LANES]);

impl<T> Deref for Lanes<T> {
    type Target = [T; MOST_LANES];

    #[inline(always)]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

/// Evaluates an expression for both vectors, of index `K`. It is a macro because the compiler need not inline a
/// closure.
macro_rules! both {
    ($k:ident => $vector:expr) => {
        [
            {
                const $k: usize = 0;
                $vector
            },
            {
                const $k: usize = 1;
                $vector
            },
        ]
    };
}

/// Real numbers in two vectors: the processor works on one while the other waits for a quotient.
#[derive(Debug, Clone, Copy)]
pub(super) struct RealLanes<S: Simd> {
    simd: S,
    values: [S::f64s; 2],
}

impl<S: Simd> RealLanes<S> {
    /// Number of lanes.
    pub(super) const LEN: usize = 2 * S::F64_LANES;

    #[inline(always)]
    fn splat(simd: S, x: f64) -> Self {
        Self { simd, values: [simd.splat_f64s(x); 2] }
    }

    /// Loads the first [`Self::LEN`] of `numbers`.
    ///
    /// # Panics
    /// If there are fewer.
    #[inline(always)]
    pub(super) fn load(simd: S, numbers: &[f64]) -> Self {
        let (vectors, _) = S::as_simd_f64s(numbers);
        Self { simd, values: [vectors[0], vectors[1]] }
    }

    #[inline(always)]
    fn of_vectors(simd: S, values: [S::f64s; 2]) -> Self {
        Self { simd, values }
    }

    #[inline(always)]
    pub(super) fn vectors(self) -> (S, [S::f64s; 2]) {
        (self.simd, self.values)
    }

    /// The numbers in order, as [`Self::load`] read them; entries from [`Self::LEN`] on are meaningless.
    #[inline(always)]
    pub(super) fn lanes(self) -> Lanes<f64> {
        let mut lanes = Lanes([0.0; MOST_LANES]);
        let (vectors, _) = S::as_mut_simd_f64s(&mut lanes.0);
        vectors[..2].copy_from_slice(&self.values);
        lanes
    }

    #[inline(always)]
    fn select(a: Self, b: Self, large: Self, otherwise: Self) -> Self {
        let simd = a.simd;
        let values = both!(K => {
            let is_large = simd.greater_than_or_equal_f64s(a.values[K], b.values[K]);
            simd.select_f64s(is_large, large.values[K], otherwise.values[K])
        });
        Self { simd, values }
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        // Masks out the sign, by instructions that are inlined in every build.
        let mask = self.simd.splat_f64s(f64::from_bits(!(1 << 63)));
        Self { values: both!(K => self.simd.and_f64s(self.values[K], mask)), ..self }
    }
}

macro_rules! real_arithmetic {
    ($($name:ident $method:ident $instruction:ident),*) => {$(
        impl<S: Simd> $name for RealLanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let values = both!(K => self.simd.$instruction(self.values[K], other.values[K]));
                Self { values, ..self }
            }
        }

        impl<S: Simd> $name<f64> for RealLanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                $name::$method(self, Self::splat(self.simd, other))
            }
        }
    )*};
}

real_arithmetic!(Add add add_f64s, Sub sub sub_f64s, Mul mul mul_f64s);

impl<S: Simd> Neg for RealLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // A difference, because the vectors' negation is not always inlined.
        Self::splat(self.simd, -0.0) - self
    }
}

impl<S: Simd> Size for RealLanes<S> {
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        let simd = self.simd;
        let values = both!(K => {
            let (a, b) = (self.values[K], other.values[K]);
            let larger = simd.select_f64s(simd.greater_than_or_equal_f64s(a, b), a, b);
            simd.select_f64s(simd.equal_f64s(a, a), larger, a)
        });
        Self { simd, values }
    }

    #[inline(always)]
    fn choose(a: Self, b: Self, large: Self, otherwise: Self) -> Self {
        Self::select(a, b, large, otherwise)
    }
}

impl<S: Simd> Scalar for RealLanes<S> {
    type Size = Self;

    #[inline(always)]
    fn lift(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        let one = self.simd.splat_f64s(1.0);
        Self { values: both!(K => self.simd.div_f64s(one, self.values[K])), ..self }
    }

    #[inline(always)]
    fn size(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn choose(a: Self, b: Self, large: Self, otherwise: Self) -> Self {
        Self::select(a, b, large, otherwise)
    }
}

/// Complex numbers as two vectors of real parts and two of imaginary parts.
///
/// Loading distributes the numbers over the lanes in the fastest way; storing restores their order.
#[derive(Debug, Clone, Copy)]
pub(super) struct ComplexLanes<S: Simd> {
    re: RealLanes<S>,
    im: RealLanes<S>,
}

impl<S: Simd> ComplexLanes<S> {
    /// Number of lanes.
    pub(super) const LEN: usize = RealLanes::<S>::LEN;

    /// Loads the first [`Self::LEN`] of `numbers`; pads fewer with the last one, not with zeros.
    #[inline(always)]
    pub(super) fn load(simd: S, numbers: &[Complex64]) -> Self {
        if numbers.len() >= Self::LEN {
            return Self::load_all(simd, numbers);
        }
        let last = numbers.last().copied().unwrap_or_default();
        let mut padded = Lanes([last; MOST_LANES]);
        padded.0[..numbers.len()].copy_from_slice(numbers);
        Self::load_all(simd, &*padded)
    }

    #[inline(always)]
    fn load_all(simd: S, numbers: &[Complex64]) -> Self {
        let (vectors, _) = S::as_simd_f64s(cast_slice(numbers));
        let [re_a, im_a] = simd.deinterleave_shfl_f64s([vectors[0], vectors[1]]);
        let [re_b, im_b] = simd.deinterleave_shfl_f64s([vectors[2], vectors[3]]);
        Self {
            re: RealLanes::of_vectors(simd, [re_a, re_b]),
            im: RealLanes::of_vectors(simd, [im_a, im_b]),
        }
    }

    /// The numbers in order; entries from [`Self::LEN`] on are meaningless.
    #[inline(always)]
    pub(super) fn numbers(self) -> Lanes<Complex64> {
        let mut numbers = Lanes([Complex64::ZERO; MOST_LANES]);
        self.store_all(&mut numbers.0);
        numbers
    }

    /// Writes the first numbers into all places of `numbers`, at most [`Self::LEN`].
    #[inline(always)]
    pub(super) fn store(self, numbers: &mut [Complex64]) {
        if numbers.len() >= Self::LEN {
            self.store_all(numbers);
        } else {
            numbers.copy_from_slice(&self.numbers()[..numbers.len()]);
        }
    }

    #[inline(always)]
    fn store_all(self, numbers: &mut [Complex64]) {
        let (vectors, _) = S::as_mut_simd_f64s(cast_slice_mut(numbers));
        let (simd, [re_a, re_b]) = self.re.vectors();
        let (_, [im_a, im_b]) = self.im.vectors();
        let [first, second] = simd.interleave_shfl_f64s([re_a, im_a]);
        let [third, fourth] = simd.interleave_shfl_f64s([re_b, im_b]);
        (vectors[0], vectors[1], vectors[2], vectors[3]) = (first, second, third, fourth);
    }
}

/// Lanes of the recursion at complex λ: complex lanes, or real ones where all λ are real.
pub(super) trait LambdaLanes<S: Simd>: Scalar<Size = RealLanes<S>> {
    /// Number of lanes.
    const LEN: usize;

    /// True if the lanes are real: all imaginary parts are 0.
    const IS_REAL: bool;

    /// Loads the first [`Self::LEN`] of `numbers` like [`ComplexLanes::load`].
    fn load_numbers(simd: S, numbers: &[Complex64]) -> Self;

    /// Converts to complex lanes in the order of [`Self::load_numbers`].
    fn complex(self) -> ComplexLanes<S>;
}

impl<S: Simd> LambdaLanes<S> for ComplexLanes<S> {
    const LEN: usize = RealLanes::<S>::LEN;
    const IS_REAL: bool = false;

    #[inline(always)]
    fn load_numbers(simd: S, numbers: &[Complex64]) -> Self {
        Self::load(simd, numbers)
    }

    #[inline(always)]
    fn complex(self) -> Self {
        self
    }
}

impl<S: Simd> LambdaLanes<S> for RealLanes<S> {
    const LEN: usize = Self::LEN;
    const IS_REAL: bool = true;

    #[inline(always)]
    fn load_numbers(simd: S, numbers: &[Complex64]) -> Self {
        ComplexLanes::load(simd, numbers).re
    }

    #[inline(always)]
    fn complex(self) -> ComplexLanes<S> {
        ComplexLanes { re: self, im: self.lift(0.0) }
    }
}

impl<S: Simd> Add for ComplexLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl<S: Simd> Sub for ComplexLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl<S: Simd> Mul for ComplexLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl<S: Simd> Add<f64> for ComplexLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self { re: self.re + other, im: self.im }
    }
}

impl<S: Simd> Mul<f64> for ComplexLanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self { re: self.re * other, im: self.im * other }
    }
}

impl<S: Simd> Scalar for ComplexLanes<S> {
    type Size = RealLanes<S>;

    #[inline(always)]
    fn lift(self, x: f64) -> Self {
        Self { re: self.re.lift(x), im: self.im.lift(0.0) }
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        let scale = (self.re * self.re + self.im * self.im).reciprocal();
        Self { re: self.re * scale, im: -(self.im * scale) }
    }

    #[inline(always)]
    fn size(self) -> RealLanes<S> {
        self.re.abs() + self.im.abs()
    }

    #[inline(always)]
    fn choose(a: RealLanes<S>, b: RealLanes<S>, large: Self, otherwise: Self) -> Self {
        Self {
            re: RealLanes::select(a, b, large.re, otherwise.re),
            im: RealLanes::select(a, b, large.im, otherwise.im),
        }
    }
}

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;
    use crate::numeric::Size;

    /// Numbers of every size and sign, and a NaN.
    fn numbers() -> Vec<Complex64> {
        let wave = |k: i32, turn: f64| (f64::from(k) * turn).sin() * 10f64.powi(k % 13 - 6);
        let mut numbers: Vec<_> =
            (0..61).map(|k| Complex64::new(wave(k, 1.7), wave(k + 5, 0.9))).collect();
        numbers[7].im = f64::NAN;
        numbers[8] = Complex64::ZERO;
        numbers
    }

    /// Every operation of a scalar on two numbers.
    fn operations<T: Scalar>(a: T, b: T) -> [T; 7] {
        let chosen = T::choose(a.size(), b.size() * 0.8, a, b);
        [a + b, a - b, a * b, a + 0.3, a * 0.3, a.reciprocal(), chosen]
    }

    struct OnLanes<'a>(&'a [Complex64]);

    impl WithSimd for OnLanes<'_> {
        type Output = (Vec<[Complex64; 7]>, Vec<f64>);

        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let (mut found, mut larger) = (vec![], vec![]);
            for numbers in self.0.chunks(ComplexLanes::<S>::LEN) {
                let a = ComplexLanes::load(simd, numbers);
                let results = operations(a, a * a + 0.1);
                let mut columns = [[Complex64::ZERO; MOST_LANES]; 7];
                for (column, result) in columns.iter_mut().zip(results) {
                    result.store(column);
                }
                let sizes = a.re.larger(a.im).complex().numbers();
                for lane in 0..numbers.len() {
                    found.push(columns.map(|column| column[lane]));
                    larger.push(sizes[lane].re);
                }
            }
            (found, larger)
        }
    }

    fn bits(z: Complex64) -> [u64; 2] {
        // NaNs may differ in their bits.
        [z.re, z.im].map(|x| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() })
    }

    #[test]
    fn a_lane_has_the_bits_of_the_number_alone_on_the_widest_and_the_narrowest_vectors() {
        let numbers = numbers();
        for (found, larger) in
            [Arch::new().dispatch(OnLanes(&numbers)), OnLanes(&numbers).with_simd(pulp::Scalar)]
        {
            assert_eq!(found.len(), numbers.len());
            for ((z, found), larger) in numbers.iter().zip(found).zip(larger) {
                let alone = operations(*z, *z * *z + 0.1);
                assert_eq!(found.map(bits), alone.map(bits), "at {z}");
                assert_eq!(bits(larger.into()), bits(z.re.larger(z.im).into()), "at {z}");
            }
        }
    }
}
