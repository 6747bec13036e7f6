//! Transfers from the tip to the hub at many frequencies, as many at a time as the processor's vectors
//! hold.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use super::complex_lanes::{ComplexLanes, LambdaLanes};
use super::lanes::RealLanes;
use crate::beam::mesh::Mesh;
use crate::beam::recursion::hub_response;
use crate::beam::transfer::{TipTransfer, is_real, is_trusted, pivoted_transfer};

/// [`TipTransfer`]s at many λ: each quantity by itself, a value for each λ.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipTransfers {
    /// `T/a_tip` in kg m.
    pub inertia_kg_m: Vec<Complex64>,
    /// Moment at the root per tip acceleration in kg m.
    pub root_inertia_kg_m: Vec<Complex64>,
    /// `θ/v_tip` in rad/m.
    pub angle_rad_m: Vec<Complex64>,
    /// Deflection of the tip per tip motion and λ in s².
    pub deflection_s2: Vec<Complex64>,
}

impl TipTransfers {
    fn with_capacity(len: usize) -> Self {
        let [inertia_kg_m, root_inertia_kg_m, angle_rad_m, deflection_s2] =
            [(); 4].map(|()| Vec::with_capacity(len));
        Self { inertia_kg_m, root_inertia_kg_m, angle_rad_m, deflection_s2 }
    }

    /// Those at each λ.
    pub fn iter(&self) -> impl Iterator<Item = TipTransfer> {
        (0..self.inertia_kg_m.len()).map(|k| TipTransfer {
            inertia_kg_m: self.inertia_kg_m[k],
            root_inertia_kg_m: self.root_inertia_kg_m[k],
            angle_rad_m: self.angle_rad_m[k],
            deflection_s2: self.deflection_s2[k],
        })
    }

    fn set(&mut self, k: usize, tip: TipTransfer) {
        self.inertia_kg_m[k] = tip.inertia_kg_m;
        self.root_inertia_kg_m[k] = tip.root_inertia_kg_m;
        self.angle_rad_m[k] = tip.angle_rad_m;
        self.deflection_s2[k] = tip.deflection_s2;
    }

    /// Index of the first λ at which the tip moves by rounding alone: `|L + e_tip|` is below
    /// `(64 + 2n) ε L` on n elements, somewhat more than measured at blocked frequencies. The transfers
    /// there are meaningless.
    pub fn first_blocked(&self, mesh: &Mesh) -> Option<usize> {
        let rounding = (64.0 + 2.0 * mesh.elements().len() as f64) * f64::EPSILON;
        let square_m2 = (rounding * mesh.length_m()).powi(2);
        self.angle_rad_m.iter().position(|angle| angle.norm_sqr() * square_m2 > 1.0)
    }
}

impl FromIterator<TipTransfer> for TipTransfers {
    fn from_iter<I: IntoIterator<Item = TipTransfer>>(all: I) -> Self {
        let mut transfers = Self::default();
        for tip in all {
            transfers.inertia_kg_m.push(tip.inertia_kg_m);
            transfers.root_inertia_kg_m.push(tip.root_inertia_kg_m);
            transfers.angle_rad_m.push(tip.angle_rad_m);
            transfers.deflection_s2.push(tip.deflection_s2);
        }
        transfers
    }
}

/// Transfers from the tip to torque and hub angle, one for each λ, with the bits of [`tip_transfer`].
///
/// [`tip_transfer`]: crate::beam::tip_transfer
pub fn tip_transfers(mesh: &Mesh, lambdas: &[Complex64]) -> TipTransfers {
    let Recursed { mut transfers, gains } = Arch::new().dispatch(Tip { mesh, lambdas });
    for (k, gain) in gains.into_iter().enumerate() {
        if !is_trusted(gain) {
            transfers.set(k, pivoted_transfer(mesh, lambdas[k]).tip);
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
    transfers: TipTransfers,
    gains: Vec<f64>,
}

impl WithSimd for Tip<'_> {
    type Output = Recursed;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let len = self.lambdas.len();
        let mut recursed = Recursed {
            transfers: TipTransfers::with_capacity(len),
            gains: Vec::with_capacity(len),
        };
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
    /// Appends the transfers at further λ, all of them real or all complex.
    #[inline(always)]
    fn extend<S: Simd, L: LambdaLanes<S>>(&mut self, simd: S, mesh: &Mesh, lambdas: &[Complex64]) {
        let Self { transfers, gains } = self;
        for lambdas in lambdas.chunks(L::LEN) {
            let hub = hub_response(mesh, L::load_numbers(simd, lambdas));
            let (tip, len) = (TipTransfer::of(&hub, mesh), lambdas.len());
            gains.extend(hub.largest_gain.complex().numbers()[..len].iter().map(|gain| gain.re));
            append(&mut transfers.inertia_kg_m, tip.inertia_kg_m, len);
            append(&mut transfers.root_inertia_kg_m, tip.root_inertia_kg_m, len);
            append(&mut transfers.angle_rad_m, tip.angle_rad_m, len);
            append(&mut transfers.deflection_s2, tip.deflection_s2, len);
        }
    }
}

/// Appends the numbers of the first `len` lanes.
#[inline(always)]
fn append<S: Simd, L: LambdaLanes<S>>(values: &mut Vec<Complex64>, lanes: L, len: usize) {
    values.extend_from_slice(&lanes.complex().numbers()[..len]);
}

#[cfg(test)]
pub(in crate::beam::batch) mod tests {
    use super::*;
    use crate::beam::test_links::{Units, mesh, mesh_in};
    use crate::beam::tip_transfer;

    /// Undamped ones with resonances of the outboard part among them, damped ones to far beyond what a
    /// mesh resolves, and lightly damped ones.
    pub(in crate::beam::batch) fn lambdas() -> Vec<Complex64> {
        let squares = (0..600).map(|k| (0.670_123 * f64::from(k)).powi(2));
        let damped = |k: u32| Complex64::from(f64::from(k * k)) / Complex64::new(1.0, 0.04);
        // At one the link is rigid to the last digit.
        let slow = [Complex64::new(1e-30, -1e-32)];
        let far = (0..90).map(|k| Complex64::new(1.0, -0.04) * (1e4 * 1.4_f64.powi(k)));
        let light = |k: u32| Complex64::new(1.0, -0.002) * f64::from(k * k);
        let damped = (0..50).map(damped).chain(slow).chain(far);
        squares.map(Complex64::from).chain(damped).chain((1..30).map(light)).collect()
    }

    pub(in crate::beam::batch) fn bits(z: Complex64) -> [u64; 2] {
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
            let blocks = lambdas.chunks(block).map(|lambdas| tip_transfers(&mesh, lambdas));
            let wide: Vec<TipTransfer> =
                blocks.flat_map(|all| all.iter().collect::<Vec<_>>()).collect();
            let narrow = narrow.transfers.iter().zip(&narrow.gains);
            for ((lambda, wide), (narrow, gain)) in lambdas.iter().zip(wide).zip(narrow) {
                let alone = tip_bits(&tip_transfer(&mesh, *lambda));
                assert_eq!(tip_bits(&wide), alone, "λ = {lambda} in blocks of {block}");
                assert!(!is_trusted(*gain) || tip_bits(&narrow) == alone, "λ = {lambda}");
            }
        }
    }

    #[test]
    fn a_tip_is_blocked_within_rounding_of_its_length_in_any_units() {
        for exponent in [-20, 0, 20] {
            let mesh = mesh_in(10, Units { length: 2.0_f64.powi(exponent), mass: 1.0 });
            let at_rest = tip_transfer(&mesh, Complex64::ZERO);
            let moved = |epsilons: f64| {
                let moved_m = Complex64::from(epsilons * f64::EPSILON * mesh.length_m());
                TipTransfer { angle_rad_m: moved_m.inv(), ..at_rest }
            };
            let first = |all: &[f64]| {
                let all: TipTransfers = all.iter().map(|epsilons| moved(*epsilons)).collect();
                all.first_blocked(&mesh)
            };
            assert_eq!(first(&[1e9, 85.0, 83.0, 0.1]), Some(2), "length 2^{exponent}");
            assert_eq!(first(&[1e9, 85.0]), None, "length 2^{exponent}");
        }
    }
}
