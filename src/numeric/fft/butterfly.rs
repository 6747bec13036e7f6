//! Transforms of a few points, `y_k = Σ_j x_j e^{+2πi jk/R}`, written out.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::FRAC_1_SQRT_2;

use pulp::Simd;

use super::eight::Vector;

/// A transform of `R` points. A type and no function: of these the compiler inlines every call.
pub(super) trait Butterfly<const R: usize> {
    fn of<S: Simd>(points: [Vector<S>; R]) -> [Vector<S>; R];
}

pub(super) struct Two;

impl Butterfly<2> for Two {
    #[inline(always)]
    fn of<S: Simd>([a, b]: [Vector<S>; 2]) -> [Vector<S>; 2] {
        [a + b, a - b]
    }
}

pub(super) struct Three;

impl Butterfly<3> for Three {
    #[inline(always)]
    fn of<S: Simd>([a, b, c]: [Vector<S>; 3]) -> [Vector<S>; 3] {
        const SIN_60: f64 = 0.866_025_403_784_438_6;
        let (sum, turned) = (b + c, (b - c) * SIN_60);
        let middle = a - sum * 0.5;
        [a + sum, middle.plus_i_times(turned), middle.minus_i_times(turned)]
    }
}

pub(super) struct Four;

impl Butterfly<4> for Four {
    #[inline(always)]
    fn of<S: Simd>([a, b, c, d]: [Vector<S>; 4]) -> [Vector<S>; 4] {
        let ([even, even_1], [odd, odd_1]) = (Two::of([a, c]), Two::of([b, d]));
        [even + odd, even_1.plus_i_times(odd_1), even - odd, even_1.minus_i_times(odd_1)]
    }
}

pub(super) struct Five;

impl Butterfly<5> for Five {
    #[inline(always)]
    fn of<S: Simd>([a, b, c, d, e]: [Vector<S>; 5]) -> [Vector<S>; 5] {
        const COS_72: f64 = 0.309_016_994_374_947_45;
        const COS_144: f64 = -0.809_016_994_374_947_5;
        const SIN_72: f64 = 0.951_056_516_295_153_5;
        const SIN_144: f64 = 0.587_785_252_292_473_1;
        let ([outer, outer_1], [inner, inner_1]) = (Two::of([b, e]), Two::of([c, d]));
        let first = a + (outer * COS_72 + inner * COS_144);
        let second = a + (outer * COS_144 + inner * COS_72);
        let first_turned = outer_1 * SIN_72 + inner_1 * SIN_144;
        let second_turned = outer_1 * SIN_144 - inner_1 * SIN_72;
        [
            a + (outer + inner),
            first.plus_i_times(first_turned),
            second.plus_i_times(second_turned),
            second.minus_i_times(second_turned),
            first.minus_i_times(first_turned),
        ]
    }
}

pub(super) struct Eight;

impl Butterfly<8> for Eight {
    #[inline(always)]
    fn of<S: Simd>([a, b, c, d, e, f, g, h]: [Vector<S>; 8]) -> [Vector<S>; 8] {
        let [even, even_1, even_2, even_3] = Four::of([a, c, e, g]);
        let [odd, odd_1, odd_2, odd_3] = Four::of([b, d, f, h]);
        // Turned by 45 degrees, and by 135 degrees backwards.
        let odd_1 = odd_1.plus_i_times(odd_1) * FRAC_1_SQRT_2;
        let odd_3 = odd_3.minus_i_times(odd_3) * FRAC_1_SQRT_2;
        [
            even + odd,
            even_1 + odd_1,
            even_2.plus_i_times(odd_2),
            even_3 - odd_3,
            even - odd,
            even_1 - odd_1,
            even_2.minus_i_times(odd_2),
            even_3 + odd_3,
        ]
    }
}
