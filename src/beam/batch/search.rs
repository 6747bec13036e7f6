//! The recursion at sixteen real λ in the time of about two, for searches of modes and zeros.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pivots are counted in lanes of floating-point numbers"
)]

use pulp::{Arch, Simd, WithSimd};

use super::lanes::RealLanes;
use crate::beam::mesh::Mesh;
use crate::beam::recursion::{condense, tip_displacement_m};
use crate::numeric::{SECTIONS, Scalar};

/// Negative pivots of the dynamic stiffness, at one λ > 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pivots {
    /// Their number outboard of the hub: modes below √λ of the link clamped at its hub.
    pub negative: usize,
    /// `λ (A_0[φφ] + I_H)` of the hub in N m: minus its own pivot, where it is free.
    pub hub_n_m: f64,
}

/// Negative pivots at each λ.
pub fn pivots(mesh: &Mesh, lambdas: &[f64; SECTIONS]) -> [Pivots; SECTIONS] {
    Arch::new().dispatch(Counted { mesh, lambdas })
}

/// Tip displacement per hub angle, `L + e_tip`, in m at each λ, however small.
pub fn tip_displacements_m(mesh: &Mesh, lambdas: &[f64; SECTIONS]) -> [f64; SECTIONS] {
    Arch::new().dispatch(Displaced { mesh, lambdas })
}

struct Counted<'a> {
    mesh: &'a Mesh,
    lambdas: &'a [f64; SECTIONS],
}

impl WithSimd for Counted<'_> {
    type Output = [Pivots; SECTIONS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { mesh, lambdas } = self;
        let mut found = [Pivots::default(); SECTIONS];
        let blocks = lambdas.chunks(RealLanes::<S>::LEN);
        for (found, lambdas) in found.chunks_mut(RealLanes::<S>::LEN).zip(blocks) {
            let lambda = RealLanes::load(simd, lambdas);
            let (zero, one) = (lambda.lift(0.0), lambda.lift(1.0));
            let mut negative = zero;
            let root = condense(
                mesh,
                lambda,
                #[inline(always)]
                |_, step| {
                    for pivot in step.pivots {
                        negative = negative + Scalar::choose(pivot, zero, zero, one);
                    }
                },
            );
            let at_axis = root.about(mesh.nodes_m()[0]) + mesh.hub_inertia_kg_m2();
            let (negative, hub) = (negative.lanes(), (lambda * at_axis).lanes());
            for (lane, found) in found.iter_mut().enumerate() {
                *found = Pivots { negative: negative[lane] as usize, hub_n_m: hub[lane] };
            }
        }
        found
    }
}

struct Displaced<'a> {
    mesh: &'a Mesh,
    lambdas: &'a [f64; SECTIONS],
}

impl WithSimd for Displaced<'_> {
    type Output = [f64; SECTIONS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { mesh, lambdas } = self;
        let mut found = [0.0; SECTIONS];
        let blocks = lambdas.chunks(RealLanes::<S>::LEN);
        for (found, lambdas) in found.chunks_mut(RealLanes::<S>::LEN).zip(blocks) {
            let lambda = RealLanes::load(simd, lambdas);
            let displacement = tip_displacement_m(mesh, lambda);
            found.copy_from_slice(&displacement.lanes()[..found.len()]);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::test_links::mesh;

    /// λ on both sides of zero, among many modes and zeros.
    fn lambdas() -> [f64; SECTIONS] {
        let mut size = 1e-2;
        let mut lambdas = std::array::from_fn(|k| {
            size *= 3.0;
            if k % 3 == 0 { -size } else { size }
        });
        // There the link is rigid to the last digit.
        lambdas[0] = -1e-30;
        lambdas
    }

    #[test]
    fn each_of_sixteen_has_the_bits_of_the_one_alone_on_all_vectors() {
        let (mesh, lambdas) = (mesh(10), lambdas());
        let narrow = Counted { mesh: &mesh, lambdas: &lambdas }.with_simd(pulp::Scalar);
        assert_eq!(pivots(&mesh, &lambdas), narrow);
        assert!(narrow.iter().any(|found| found.negative > 3));
        let narrow = Displaced { mesh: &mesh, lambdas: &lambdas }.with_simd(pulp::Scalar);
        let wide = tip_displacements_m(&mesh, &lambdas);
        for ((lambda, wide), narrow) in lambdas.iter().zip(wide).zip(narrow) {
            let alone = tip_displacement_m(&mesh, *lambda);
            assert_eq!([wide, narrow].map(f64::to_bits), [alone.to_bits(); 2], "λ = {lambda}");
        }
    }
}
