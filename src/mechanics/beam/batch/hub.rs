//! The recursion from tip to hub at many λ: transfers from the tip to the hub, and values for searches of modes and
//! zeros.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pivots are counted in lanes of floating-point numbers"
)]

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use super::complex_lanes::{ComplexLanes, LambdaLanes};
use super::lanes::RealLanes;
use crate::beam::mesh::Mesh;
use crate::beam::recursion::{condense, hub_response, tip_displacement_m};
use crate::beam::transfer::{TipTransfer, is_real, is_trusted, pivoted_transfer};
use crate::numeric::{SECTIONS, Scalar};

/// Transfers from the tip to torque and hub angle, one for each λ, with the bits of [`tip_transfer`].
///
/// [`tip_transfer`]: crate::beam::tip_transfer
pub fn tip_transfers(mesh: &Mesh, lambdas: &[Complex64]) -> Vec<TipTransfer> {
    let Recursed { mut transfers, gains } = Arch::new().dispatch(Tip { mesh, lambdas });
    for (k, gain) in gains.into_iter().enumerate() {
        if !is_trusted(gain) {
            transfers[k] = pivoted_transfer(mesh, lambdas[k]).tip;
        }
    }
    transfers
}

struct Tip<'a> {
    mesh: &'a Mesh,
    lambdas: &'a [Complex64],
}

/// Transfers by the recursion alone, and an upper bound of |G| at each λ.
struct Recursed {
    transfers: Vec<TipTransfer>,
    gains: Vec<f64>,
}

impl WithSimd for Tip<'_> {
    type Output = Recursed;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let len = self.lambdas.len();
        let mut recursed =
            Recursed { transfers: Vec::with_capacity(len), gains: Vec::with_capacity(len) };
        for alike in self.lambdas.chunk_by(|a, b| is_real(*a) == is_real(*b)) {
            if is_real(alike[0]) {
                recursed.extend::<S, RealLanes<S>>(simd, self.mesh, alike);
            } else {
                recursed.extend::<S, ComplexLanes<S>>(simd, self.mesh, alike);
            }
        }
        recursed
    }
}

impl Recursed {
    /// Appends the transfers at further λ, either all real or all complex.
    #[inline(always)]
    fn extend<S: Simd, L: LambdaLanes<S>>(&mut self, simd: S, mesh: &Mesh, lambdas: &[Complex64]) {
        for lambdas in lambdas.chunks(L::LEN) {
            let hub = hub_response(mesh, L::load_numbers(simd, lambdas));
            let tip = TipTransfer::of(&hub, mesh);
            let gains = hub.largest_gain.complex().numbers();
            let inertia_kg_m = tip.inertia_kg_m.complex().numbers();
            let root_inertia_kg_m = tip.root_inertia_kg_m.complex().numbers();
            let angle_rad_m = tip.angle_rad_m.complex().numbers();
            let deflection_s2 = tip.deflection_s2.complex().numbers();
            for lane in 0..lambdas.len() {
                self.gains.push(gains[lane].re);
                self.transfers.push(TipTransfer {
                    inertia_kg_m: inertia_kg_m[lane],
                    root_inertia_kg_m: root_inertia_kg_m[lane],
                    angle_rad_m: angle_rad_m[lane],
                    deflection_s2: deflection_s2[lane],
                });
            }
        }
    }
}

/// Negative pivots of the dynamic stiffness, at one λ > 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Pivots {
    /// Number of negative pivots outboard of the hub: modes below √λ of the link clamped at its hub.
    pub negative: usize,
    /// `λ (A_0[φφ] + I_H)` of the hub in N m: minus the pivot of a free hub.
    pub hub_n_m: f64,
}

/// Negative pivots at each λ.
pub(crate) fn pivots(mesh: &Mesh, lambdas: &[f64; SECTIONS]) -> [Pivots; SECTIONS] {
    Arch::new().dispatch(Counted { mesh, lambdas })
}

/// Tip displacement per hub angle, `L + e_tip`, in m at each λ, accurate also where it is small.
pub(crate) fn tip_displacements_m(mesh: &Mesh, lambdas: &[f64; SECTIONS]) -> [f64; SECTIONS] {
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
pub(in crate::mechanics::beam::batch) mod tests {
    use super::*;
    use crate::beam::test_links::mesh;
    use crate::beam::tip_transfer;

    /// Undamped λ, some at resonances of the outboard part; damped λ far beyond the mesh's resolution; lightly damped
    /// λ.
    pub(in crate::mechanics::beam::batch) fn lambdas() -> Vec<Complex64> {
        let squares = (0..600).map(|k| (0.670_123 * f64::from(k)).powi(2));
        let damped = |k: u32| Complex64::from(f64::from(k * k)) / Complex64::new(1.0, 0.04);
        // At this λ the link is rigid to the last digit.
        let slow = [Complex64::new(1e-30, -1e-32)];
        let far = (0..90).map(|k| Complex64::new(1.0, -0.04) * (1e4 * 1.4_f64.powi(k)));
        let light = |k: u32| Complex64::new(1.0, -0.002) * f64::from(k * k);
        let damped = (0..50).map(damped).chain(slow).chain(far);
        squares.map(Complex64::from).chain(damped).chain((1..30).map(light)).collect()
    }

    pub(in crate::mechanics::beam::batch) fn bits(z: Complex64) -> [u64; 2] {
        [z.re.to_bits(), z.im.to_bits()]
    }

    fn tip_bits(tip: &TipTransfer) -> [[u64; 2]; 4] {
        [tip.inertia_kg_m, tip.root_inertia_kg_m, tip.angle_rad_m, tip.deflection_s2].map(bits)
    }

    #[test]
    fn every_tip_transfer_of_many_has_the_bits_of_the_one_alone() {
        let (mesh, lambdas) = (mesh(10), lambdas());
        let narrow = Tip { mesh: &mesh, lambdas: &lambdas }.with_simd(pulp::Scalar);
        let wide = Arch::new().dispatch(Tip { mesh: &mesh, lambdas: &lambdas });
        assert!(
            narrow.gains.iter().any(|gain| !is_trusted(*gain)),
            "the recursion loses no digits"
        );
        assert!(wide.gains == narrow.gains);
        for block in [1, 7, 64, lambdas.len()] {
            let wide = lambdas.chunks(block).flat_map(|lambdas| tip_transfers(&mesh, lambdas));
            let narrow = narrow.transfers.iter().zip(&narrow.gains);
            for ((lambda, wide), (narrow, gain)) in lambdas.iter().zip(wide).zip(narrow) {
                let alone = tip_bits(&tip_transfer(&mesh, *lambda));
                assert_eq!(tip_bits(&wide), alone, "λ = {lambda} in blocks of {block}");
                assert!(!is_trusted(*gain) || tip_bits(narrow) == alone, "λ = {lambda}");
            }
        }
    }

    /// Real λ of both signs, across many modes and zeros.
    fn real_lambdas() -> [f64; SECTIONS] {
        let mut size = 1e-2;
        let mut lambdas = std::array::from_fn(|k| {
            size *= 3.0;
            if k % 3 == 0 { -size } else { size }
        });
        // At this λ the link is rigid to the last digit.
        lambdas[0] = -1e-30;
        lambdas
    }

    #[test]
    fn each_of_sixteen_has_the_bits_of_the_one_alone_on_all_vectors() {
        let (mesh, lambdas) = (mesh(10), real_lambdas());
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
