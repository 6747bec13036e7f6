//! Transfers at many frequencies, as many at a time as the processor's vectors hold.
//!
//! Each λ is answered alone: neither the width of the vectors nor what stands beside it in the list
//! changes a bit.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use super::hub_response::{HubResponse, Reached};
use super::mesh::Mesh;
use super::pivoted::pivoted_transfer;
use super::tip_transfers::TipTransfers;
use super::transfer::{Way, is_real, is_trusted};
use super::walk::{NodalQuantity, Walk, nodal_transfer};
use crate::numeric::{ComplexLanes, LambdaLanes, RealLanes};

/// Transfers from the tip to torque and hub angle, one for each λ: [`tip_transfer`] of many.
///
/// [`tip_transfer`]: super::tip_transfer
pub fn tip_transfers(mesh: &Mesh, lambdas: &[Complex64]) -> TipTransfers {
    let mut found = Arch::new().dispatch(Tip { mesh, lambdas, way: Way::of });
    let by_stretches = |k: &usize| Way::of(lambdas[*k]) == Way::Stretches;
    let again: Vec<usize> = found.lost().filter(by_stretches).collect();
    let by_elements = Arch::new().dispatch(Tip {
        mesh,
        lambdas: &again.iter().map(|k| lambdas[*k]).collect::<Vec<_>>(),
        way: |_| Way::Elements,
    });
    for ((k, tip), gain) in
        again.into_iter().zip(by_elements.transfers.iter()).zip(by_elements.gains)
    {
        found.transfers.set(k, tip);
        found.gains[k] = gain;
    }
    for k in found.lost().collect::<Vec<_>>() {
        found.transfers.set(k, pivoted_transfer(mesh, lambdas[k]).tip);
    }
    found.transfers
}

/// Transfers from the tip to some nodes, a row for each of `nodes`, in it a value for each λ:
/// what [`nodal_transfer`] gives of many, `e_i/(λ (L + e_tip))` in s² or moments in kg m.
///
/// Columns of `rows` beyond the last λ are left alone.
///
/// # Panics
/// If a node is not one of the mesh, or a row is shorter than `lambdas`.
///
/// [`nodal_transfer`]: super::nodal_transfer
pub fn nodal_transfers(
    mesh: &Mesh,
    lambdas: &[Complex64],
    nodes: &[usize],
    quantity: NodalQuantity,
    rows: &mut [&mut [Complex64]],
) {
    let nodal = Nodal { mesh, lambdas, nodes, quantity, rows };
    for column in Arch::new().dispatch(nodal) {
        let transfer = nodal_transfer(mesh, lambdas[column]);
        for (row, node) in rows.iter_mut().zip(nodes) {
            row[column] = transfer.values(quantity)[*node];
        }
    }
}

struct Tip<'a> {
    mesh: &'a Mesh,
    lambdas: &'a [Complex64],
    way: fn(Complex64) -> Way,
}

/// Transfers by the recursion alone, and what no gain exceeds at each.
struct Untested {
    transfers: TipTransfers,
    gains: Vec<f64>,
}

impl WithSimd for Tip<'_> {
    type Output = Untested;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { mesh, lambdas, way } = self;
        let mut found = Untested::with_capacity(lambdas.len());
        // So that each has the bits that it has alone.
        for alike in lambdas.chunk_by(|a, b| way(*a) == way(*b)) {
            // Each by its name, so that the loops ask no more.
            match way(alike[0]) {
                Way::RealElements => {
                    found.extend::<S, RealLanes<S>>(simd, mesh, alike, Way::RealElements);
                }
                Way::Elements => {
                    found.extend::<S, ComplexLanes<S>>(simd, mesh, alike, Way::Elements);
                }
                Way::Stretches => {
                    found.extend::<S, ComplexLanes<S>>(simd, mesh, alike, Way::Stretches);
                }
            }
        }
        found
    }
}

impl Untested {
    fn with_capacity(len: usize) -> Self {
        Self { transfers: TipTransfers::with_capacity(len), gains: Vec::with_capacity(len) }
    }

    /// Which of them the recursion is not trusted with.
    fn lost(&self) -> impl Iterator<Item = usize> {
        let gains = self.gains.iter().enumerate();
        gains.filter(|(_, gain)| !is_trusted(**gain)).map(|(k, _)| k)
    }

    /// Those at further λ that go one way.
    #[inline(always)]
    fn extend<S: Simd, L: LambdaLanes<S>>(
        &mut self,
        simd: S,
        mesh: &Mesh,
        lambdas: &[Complex64],
        way: Way,
    ) {
        let Self { transfers, gains } = self;
        for lambdas in lambdas.chunks(L::LEN) {
            let (tip, gain) = way.untested(mesh, L::load_numbers(simd, lambdas));
            let len = lambdas.len();
            gains.extend(gain.complex().numbers()[..len].iter().map(|gain| gain.re));
            transfers.inertia_kg_m.extend_from_slice(&tip.inertia_kg_m.complex().numbers()[..len]);
            transfers
                .root_inertia_kg_m
                .extend_from_slice(&tip.root_inertia_kg_m.complex().numbers()[..len]);
            transfers.angle_rad_m.extend_from_slice(&tip.angle_rad_m.complex().numbers()[..len]);
            transfers.lag_s2.extend_from_slice(&tip.lag_s2.complex().numbers()[..len]);
        }
    }
}

struct Nodal<'a, 'b> {
    mesh: &'a Mesh,
    lambdas: &'a [Complex64],
    nodes: &'a [usize],
    quantity: NodalQuantity,
    rows: &'a mut [&'b mut [Complex64]],
}

impl WithSimd for Nodal<'_, '_> {
    /// Columns that must be answered alone.
    type Output = Vec<usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let lambdas = self.lambdas;
        if lambdas.iter().all(|lambda| is_real(*lambda)) {
            return untested_nodes::<S, RealLanes<S>>(simd, self);
        }
        let mut alone = untested_nodes::<S, ComplexLanes<S>>(simd, self);
        // A real λ among others has the bits that it has alone.
        alone.extend((0..lambdas.len()).filter(|k| is_real(lambdas[*k])));
        alone
    }
}

/// Fills the rows by the recursion alone; returns the columns that it is not trusted with.
#[inline(always)]
fn untested_nodes<S: Simd, L: LambdaLanes<S>>(simd: S, asked: Nodal) -> Vec<usize> {
    let Nodal { mesh, lambdas, nodes, quantity, rows } = asked;
    let mut lost = vec![];
    let mut walk = Walk::new(mesh, L::load_numbers(simd, lambdas), quantity);
    for (block, lambdas) in lambdas.chunks(L::LEN).enumerate() {
        let (columns, len) = (block * L::LEN, lambdas.len());
        let lambda = L::load_numbers(simd, lambdas);
        let per_lambda_s2 = mesh.per_lambda(lambda);
        let (root, largest_gain) = walk.inward(mesh, lambda);
        let tip_deflection_m = walk.outward(mesh, lambda, quantity);
        let reached = Reached { root, tip_deflection_m, largest_gain };
        let hub = HubResponse::at_axis(mesh, per_lambda_s2, reached);
        let per_tip = hub.per_tip_of(quantity, &hub.per_tip(mesh));
        for (row, node) in rows.iter_mut().zip(nodes) {
            (walk.values[*node] * per_tip).complex().store(&mut row[columns..columns + len]);
        }
        let gains = largest_gain.complex().numbers();
        lost.extend((0..len).filter(|k| !is_trusted(gains[*k].re)).map(|k| columns + k));
    }
    lost
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::undamped::{even_mesh, mesh};
    use crate::beam::{NodalTransfer, TipTransfer, nodal_transfer, tip_transfer};

    /// Undamped ones with resonances of the outboard part among them, damped ones to far beyond what a
    /// mesh resolves, and lightly damped ones.
    fn lambdas() -> Vec<Complex64> {
        let squares = (0..600).map(|k| (0.670_123 * f64::from(k)).powi(2));
        let damped = |k: u32| Complex64::from(f64::from(k * k)) / Complex64::new(1.0, 0.04);
        // At one the link is rigid to the last digit.
        let slow = [Complex64::new(1e-30, -1e-32)];
        let far = (0..90).map(|k| Complex64::new(1.0, -0.04) * (1e4 * 1.4_f64.powi(k)));
        let light = |k: u32| Complex64::new(1.0, -0.002) * f64::from(k * k);
        let damped = (0..50).map(damped).chain(slow).chain(far);
        squares.map(Complex64::from).chain(damped).chain((1..30).map(light)).collect()
    }

    fn bits(z: Complex64) -> [u64; 2] {
        [z.re.to_bits(), z.im.to_bits()]
    }

    fn tip_bits(tip: &TipTransfer) -> [[u64; 2]; 4] {
        [tip.inertia_kg_m, tip.root_inertia_kg_m, tip.angle_rad_m, tip.lag_s2].map(bits)
    }

    #[test]
    fn every_tip_transfer_of_many_has_the_bits_of_the_one_alone() {
        for mesh in [mesh(10), even_mesh(11), even_mesh(16), even_mesh(37)] {
            every_tip_transfer_has_its_bits_alone(&mesh);
        }
    }

    fn every_tip_transfer_has_its_bits_alone(mesh: &Mesh) {
        let lambdas = lambdas();
        let asked = || Tip { mesh, lambdas: &lambdas, way: Way::of };
        let narrow = asked().with_simd(pulp::Scalar);
        for way in [Way::RealElements, Way::Stretches] {
            let lost = narrow.lost().filter(|k| Way::of(lambdas[*k]) == way).count();
            assert!(lost > 0, "{way:?} is trusted with all");
        }
        let wide = Arch::new().dispatch(asked());
        for ((lambda, wide), narrow) in lambdas.iter().zip(wide.gains).zip(&narrow.gains) {
            let (_, alone) = Way::of(*lambda).untested_alone(mesh, *lambda);
            assert_eq!([wide, *narrow].map(f64::to_bits), [alone.to_bits(); 2], "λ = {lambda}");
        }
        for block in [1, 7, 64, lambdas.len()] {
            let blocks = lambdas.chunks(block).map(|lambdas| tip_transfers(mesh, lambdas));
            let wide: Vec<TipTransfer> =
                blocks.flat_map(|all| all.iter().collect::<Vec<_>>()).collect();
            let narrow = narrow.transfers.iter().zip(&narrow.gains);
            for ((lambda, wide), (narrow, gain)) in lambdas.iter().zip(wide).zip(narrow) {
                let alone = tip_bits(&tip_transfer(mesh, *lambda));
                assert_eq!(tip_bits(&wide), alone, "λ = {lambda} in blocks of {block}");
                assert!(!is_trusted(*gain) || tip_bits(&narrow) == alone, "λ = {lambda}");
            }
        }
    }

    #[test]
    fn every_nodal_transfer_of_many_has_the_bits_of_the_one_alone() {
        let (mesh, lambdas) = (mesh(10), lambdas());
        let nodes = [3, 0, 10, 7];
        let alone: Vec<_> = lambdas.iter().map(|lambda| nodal_transfer(&mesh, *lambda)).collect();
        for quantity in [NodalQuantity::Deflection, NodalQuantity::Moment] {
            let value = |transfer: &NodalTransfer, node: usize| match quantity {
                NodalQuantity::Deflection => transfer.lags_s2[node],
                NodalQuantity::Moment => transfer.moments_kg_m[node],
            };
            for block in [1, 7, 64, lambdas.len()] {
                for (lambdas, alone) in lambdas.chunks(block).zip(alone.chunks(block)) {
                    let mut table = vec![vec![Complex64::ZERO; lambdas.len()]; nodes.len()];
                    let mut rows: Vec<_> = table.iter_mut().map(Vec::as_mut_slice).collect();
                    nodal_transfers(&mesh, lambdas, &nodes, quantity, &mut rows);
                    for (node, row) in nodes.iter().zip(&table) {
                        for (found, alone) in row.iter().zip(alone) {
                            assert_eq!(bits(*found), bits(value(alone, *node)), "node {node}");
                        }
                    }
                }
            }
        }
    }
}
