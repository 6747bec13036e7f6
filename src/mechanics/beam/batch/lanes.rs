//! Several numbers at a time: the same operation on each lane, and no operation across lanes.
//!
//! Each product and sum is rounded by itself, without fused multiply-add, so that every instruction set gives the same
//! bits.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Deref, Mul, Neg, Sub};

use pulp::Simd;

use crate::numeric::{Scalar, Size};

/// Largest number of lanes in any instruction set: two vectors of eight.
pub(super) const MOST_LANES: usize = 16;

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
    pub(super) fn of_vectors(simd: S, values: [S::f64s; 2]) -> Self {
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
    pub(super) fn select(a: Self, b: Self, large: Self, otherwise: Self) -> Self {
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
