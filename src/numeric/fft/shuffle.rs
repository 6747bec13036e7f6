//! Moving numbers between lanes: no arithmetic, so no bit depends on how it is done.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use pulp::Simd;
#[cfg(target_arch = "x86_64")]
use pulp::{
    cast,
    x86::{V3, V4},
};

use super::eight::Eight;

/// The instructions there are for it; without any, number by number.
#[derive(Clone, Copy)]
pub(super) struct Shuffle {
    #[cfg(target_arch = "x86_64")]
    v3: Option<V3>,
    #[cfg(target_arch = "x86_64")]
    v4: Option<V4>,
}

impl Shuffle {
    /// Those that go with the vectors of `S`.
    #[inline(always)]
    pub(super) fn of<S: Simd>() -> Self {
        Self {
            #[cfg(target_arch = "x86_64")]
            v3: if S::F64_LANES == 4 { V3::try_new() } else { None },
            #[cfg(target_arch = "x86_64")]
            v4: if S::F64_LANES == 8 { V4::try_new() } else { None },
        }
    }

    /// Row k of the result is column k of `rows`.
    #[inline(always)]
    pub(super) fn transpose(self, rows: &[[f64; 8]; 8]) -> [[f64; 8]; 8] {
        #[cfg(target_arch = "x86_64")]
        if let Some(v4) = self.v4 {
            return v4_transpose(v4, rows);
        } else if let Some(v3) = self.v3 {
            return v3_transpose(v3, rows);
        }
        let mut columns = [[0.0; 8]; 8];
        for (j, row) in rows.iter().enumerate() {
            for (column, x) in columns.iter_mut().zip(row) {
                column[j] = *x;
            }
        }
        columns
    }

    /// Real and imaginary parts of numbers that stand one after another.
    #[inline(always)]
    pub(super) fn apart(self, numbers: &[f64; 16]) -> Eight {
        #[cfg(target_arch = "x86_64")]
        if let Some(v4) = self.v4 {
            let [re, im] = [[0, 2, 4, 6, 8, 10, 12, 14], [1, 3, 5, 7, 9, 11, 13, 15]];
            return Eight { re: v4_pick(v4, numbers, re), im: v4_pick(v4, numbers, im) };
        } else if let Some(v3) = self.v3 {
            return v3_apart::<0b11_01_10_00>(v3, numbers, [0, 1]);
        }
        let mut eight = Eight::ZERO;
        for (k, [re, im]) in numbers.as_chunks().0.iter().enumerate() {
            (eight.re[k], eight.im[k]) = (*re, *im);
        }
        eight
    }

    /// The same from the last number to the first.
    #[inline(always)]
    pub(super) fn apart_backwards(self, numbers: &[f64; 16]) -> Eight {
        #[cfg(target_arch = "x86_64")]
        if let Some(v4) = self.v4 {
            let [re, im] = [[14, 12, 10, 8, 6, 4, 2, 0], [15, 13, 11, 9, 7, 5, 3, 1]];
            return Eight { re: v4_pick(v4, numbers, re), im: v4_pick(v4, numbers, im) };
        } else if let Some(v3) = self.v3 {
            return v3_apart::<0b00_10_01_11>(v3, numbers, [1, 0]);
        }
        let mut eight = Eight::ZERO;
        for (k, [re, im]) in numbers.as_chunks().0.iter().rev().enumerate() {
            (eight.re[k], eight.im[k]) = (*re, *im);
        }
        eight
    }

    /// Writes the first `count` of the eight, real and imaginary part in turn; all where there are
    /// more.
    #[inline(always)]
    pub(super) fn write(self, eight: &Eight, numbers: &mut [f64], count: usize) {
        if count < 8 {
            numbers[..2 * count].copy_from_slice(&self.together(eight)[..2 * count]);
        } else if let Some(numbers) = numbers.first_chunk_mut() {
            *numbers = self.together(eight);
        }
    }

    /// Each real part followed by its imaginary part.
    #[inline(always)]
    fn together(self, eight: &Eight) -> [f64; 16] {
        #[cfg(target_arch = "x86_64")]
        if let Some(v4) = self.v4 {
            let parts: [f64; 16] = cast([eight.re, eight.im]);
            let low = v4_pick(v4, &parts, [0, 8, 1, 9, 2, 10, 3, 11]);
            return cast([low, v4_pick(v4, &parts, [4, 12, 5, 13, 6, 14, 7, 15])]);
        } else if let Some(v3) = self.v3 {
            return v3_together(v3, eight);
        }
        let mut numbers = [0.0; 16];
        for (k, number) in numbers.as_chunks_mut().0.iter_mut().enumerate() {
            *number = [eight.re[k], eight.im[k]];
        }
        numbers
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn v4_pick(v4: V4, numbers: &[f64; 16], at: [u64; 8]) -> [f64; 8] {
    let [low, high]: [[f64; 8]; 2] = cast(*numbers);
    cast(v4.avx512f._mm512_permutex2var_pd(cast(low), cast(at), cast(high)))
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn v4_transpose(v4: V4, rows: &[[f64; 8]; 8]) -> [[f64; 8]; 8] {
    // Of quarters of vectors, two numbers each: 0 and 2 of both, or 1 and 3.
    const EVEN: i32 = 0b10_00_10_00;
    const ODD: i32 = 0b11_01_11_01;
    let v4 = v4.avx512f;
    let mut columns = [[0.0; 8]; 8];
    let mut fours = [cast(columns[0]); 8];
    for half in [0, 4] {
        let row = |k: usize| cast(rows[half + k]);
        let (even_01, odd_01) =
            (v4._mm512_unpacklo_pd(row(0), row(1)), v4._mm512_unpackhi_pd(row(0), row(1)));
        let (even_23, odd_23) =
            (v4._mm512_unpacklo_pd(row(2), row(3)), v4._mm512_unpackhi_pd(row(2), row(3)));
        fours[half] = v4._mm512_shuffle_f64x2::<EVEN>(even_01, even_23);
        fours[half + 1] = v4._mm512_shuffle_f64x2::<EVEN>(odd_01, odd_23);
        fours[half + 2] = v4._mm512_shuffle_f64x2::<ODD>(even_01, even_23);
        fours[half + 3] = v4._mm512_shuffle_f64x2::<ODD>(odd_01, odd_23);
    }
    for k in 0..4 {
        columns[k] = cast(v4._mm512_shuffle_f64x2::<EVEN>(fours[k], fours[k + 4]));
        columns[k + 4] = cast(v4._mm512_shuffle_f64x2::<ODD>(fours[k], fours[k + 4]));
    }
    columns
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn v3_transpose(v3: V3, rows: &[[f64; 8]; 8]) -> [[f64; 8]; 8] {
    let v3 = v3.avx;
    let mut columns = [[[0.0; 4]; 2]; 8];
    for (i, half) in [0, 4].into_iter().enumerate() {
        for j in 0..2 {
            let row = |k: usize| {
                let halves: [[f64; 4]; 2] = cast(rows[half + k]);
                cast(halves[j])
            };
            let (even_01, odd_01) =
                (v3._mm256_unpacklo_pd(row(0), row(1)), v3._mm256_unpackhi_pd(row(0), row(1)));
            let (even_23, odd_23) =
                (v3._mm256_unpacklo_pd(row(2), row(3)), v3._mm256_unpackhi_pd(row(2), row(3)));
            columns[4 * j][i] = cast(v3._mm256_permute2f128_pd::<0x20>(even_01, even_23));
            columns[4 * j + 1][i] = cast(v3._mm256_permute2f128_pd::<0x20>(odd_01, odd_23));
            columns[4 * j + 2][i] = cast(v3._mm256_permute2f128_pd::<0x31>(even_01, even_23));
            columns[4 * j + 3][i] = cast(v3._mm256_permute2f128_pd::<0x31>(odd_01, odd_23));
        }
    }
    cast(columns)
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn v3_apart<const ORDER: i32>(v3: V3, numbers: &[f64; 16], halves: [usize; 2]) -> Eight {
    let quarters: [[f64; 4]; 4] = cast(*numbers);
    let (mut re, mut im) = ([[0.0; 4]; 2], [[0.0; 4]; 2]);
    for k in 0..2 {
        let (low, high) = (cast(quarters[2 * halves[k]]), cast(quarters[2 * halves[k] + 1]));
        let (reals, imaginaries) =
            (v3.avx._mm256_unpacklo_pd(low, high), v3.avx._mm256_unpackhi_pd(low, high));
        re[k] = cast(v3.avx2._mm256_permute4x64_pd::<ORDER>(reals));
        im[k] = cast(v3.avx2._mm256_permute4x64_pd::<ORDER>(imaginaries));
    }
    Eight { re: cast(re), im: cast(im) }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn v3_together(v3: V3, eight: &Eight) -> [f64; 16] {
    let v3 = v3.avx;
    let (re, im): ([[f64; 4]; 2], [[f64; 4]; 2]) = (cast(eight.re), cast(eight.im));
    let mut numbers = [[0.0; 4]; 4];
    for k in 0..2 {
        let (even, odd) = (
            v3._mm256_unpacklo_pd(cast(re[k]), cast(im[k])),
            v3._mm256_unpackhi_pd(cast(re[k]), cast(im[k])),
        );
        numbers[2 * k] = cast(v3._mm256_permute2f128_pd::<0x20>(even, odd));
        numbers[2 * k + 1] = cast(v3._mm256_permute2f128_pd::<0x31>(even, odd));
    }
    cast(numbers)
}
