#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use pulp::{Arch, Simd, WithSimd};

/// Largest absolute value, what is not a number left out; 0 of nothing.
pub fn largest(values: &[f64]) -> f64 {
    Arch::new().dispatch(Largest(values))
}

/// Largest absolute difference of two histories, sample by sample as far as both go.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| largest.max((a - b).abs()))
}

struct Largest<'a>(&'a [f64]);

impl WithSimd for Largest<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        // Sixteen at a time, as vectors compare; the largest does not depend on their order.
        let (sixteens, rest) = self.0.as_chunks::<16>();
        let mut found = [0.0; 16];
        for sixteen in sixteens {
            for (found, value) in found.iter_mut().zip(sixteen) {
                *found = larger(*found, *value);
            }
        }
        for half in [8, 4, 2, 1] {
            for k in 0..half {
                found[k] = larger(found[k], found[k + half]);
            }
        }
        rest.iter().fold(found[0], |found, value| larger(found, *value))
    }
}

#[inline(always)]
fn larger(largest: f64, value: f64) -> f64 {
    if value.abs() > largest { value.abs() } else { largest }
}
