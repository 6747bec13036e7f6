//! Transfers from the tip at many frequencies, as many at a time as the processor's vectors hold.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use super::complex_lanes::{ComplexLanes, LambdaLanes};
use super::lanes::RealLanes;
use crate::beam::inertia::Inertia;
use crate::beam::inward::hub_response;
use crate::beam::mesh::Mesh;
use crate::beam::outward::{Checkpoint, NodalQuantity, NodalRecursion};
use crate::beam::transfer::{
    TipTransfer, is_real, is_trusted, nodal_transfer, per_tip, pivoted_transfer, response_between,
};

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

/// Where the recursion at many λ is taken up again, so that nodes can be solved for after others
/// without a pass through the whole mesh.
#[derive(Debug, Clone)]
pub struct Checkpoints {
    /// Numbers of the nodes, ascending: the root, those between, and the tip.
    nodes: Vec<usize>,
    /// For each node `A_vv`, `A_vφ`, `A_φφ`, deflection and slope per hub angle, a row of numbers for
    /// all λ each.
    rows: Vec<Complex64>,
    /// Factors from values per hub angle to values per tip motion; none before the first pass.
    per_tip: Vec<Complex64>,
    /// Columns in which the recursion loses its digits, or whose λ is real among complex ones.
    alone: Vec<usize>,
}

/// Rows of numbers for each checkpoint.
const ROWS: usize = 5;

impl Checkpoints {
    /// Those for a first group of nodes and these further ones.
    pub fn of<'a>(mesh: &Mesh, further: impl IntoIterator<Item = &'a [usize]>) -> Self {
        let ends = further.into_iter().filter_map(ends_of).flatten();
        let mut nodes: Vec<usize> = ends.chain([0, mesh.elements().len()]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes, rows: vec![], per_tip: vec![], alone: vec![] }
    }

    /// Memory in bytes that so many further groups take at each λ, at most.
    pub const fn bytes(further: usize) -> usize {
        if further == 0 { 0 } else { 2 * (further + 1) * ROWS * size_of::<Complex64>() }
    }

    fn row(&mut self, checkpoint: usize, row: usize) -> &mut [Complex64] {
        let len = self.per_tip.len();
        &mut self.rows[(checkpoint * ROWS + row) * len..][..len]
    }

    fn keep<S: Simd, L: LambdaLanes<S>>(
        &mut self,
        columns: &Range<usize>,
        checkpoints: &[Checkpoint<L>],
        per_tip: L,
    ) {
        for (k, Checkpoint { inertia, deflection: [v, phi], .. }) in checkpoints.iter().enumerate()
        {
            let numbers: [L; ROWS] = [inertia.vv, inertia.vp, inertia.pp, *v, *phi];
            for (row, numbers) in numbers.into_iter().enumerate() {
                numbers.complex().store(&mut self.row(k, row)[columns.clone()]);
            }
        }
        per_tip.complex().store(&mut self.per_tip[columns.clone()]);
    }

    /// The checkpoint at a node.
    ///
    /// # Panics
    /// If there is none.
    fn at<S: Simd, L: LambdaLanes<S>>(
        &mut self,
        simd: S,
        columns: &Range<usize>,
        node: usize,
    ) -> Checkpoint<L> {
        let k = self.nodes.binary_search(&node).expect("an end of a group of nodes");
        let mut row = |row| L::load_numbers(simd, &self.row(k, row)[columns.clone()]);
        let inertia = Inertia { vv: row(0), vp: row(1), pp: row(2) };
        Checkpoint { node, inertia, deflection: [row(3), row(4)] }
    }
}

/// The first and the last node in the order of the mesh.
fn ends_of(nodes: &[usize]) -> Option<[usize; 2]> {
    Some([*nodes.iter().min()?, *nodes.iter().max()?])
}

/// Transfers from the tip to some nodes, `e_i/(λ (L + e_tip))` in s² or moments in kg m: a row for each
/// of `nodes`, in it a value for each λ, with the bits of [`nodal_transfer`].
///
/// Columns of `rows` beyond the last λ are left alone. The first call with `checkpoints` passes through
/// the whole mesh; each further one, for the same λ and quantity and for a further group of nodes, from
/// the first to the last of them.
///
/// # Panics
/// If a node is not one of the mesh, a row is shorter than `lambdas`, or the checkpoints do not know the
/// group of a further call.
pub fn nodal_transfers(
    mesh: &Mesh,
    lambdas: &[Complex64],
    nodes: &[usize],
    quantity: NodalQuantity,
    rows: &mut [&mut [Complex64]],
    checkpoints: &mut Checkpoints,
) {
    Arch::new().dispatch(Nodal { mesh, lambdas, nodes, quantity, rows, checkpoints });
    for column in &checkpoints.alone {
        let transfer = nodal_transfer(mesh, lambdas[*column]);
        for (row, node) in rows.iter_mut().zip(nodes) {
            row[*column] = transfer.values(quantity)[*node];
        }
    }
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

struct Nodal<'a, 'b> {
    mesh: &'a Mesh,
    lambdas: &'a [Complex64],
    nodes: &'a [usize],
    quantity: NodalQuantity,
    rows: &'a mut [&'b mut [Complex64]],
    checkpoints: &'a mut Checkpoints,
}

impl WithSimd for Nodal<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.lambdas.iter().all(|lambda| is_real(*lambda)) {
            recursed_nodes::<S, RealLanes<S>>(simd, self);
        } else {
            recursed_nodes::<S, ComplexLanes<S>>(simd, self);
        }
    }
}

/// Fills the rows by the recursion alone.
#[inline(always)]
fn recursed_nodes<S: Simd, L: LambdaLanes<S>>(simd: S, nodal: Nodal) {
    let Nodal { mesh, lambdas, nodes, quantity, rows, checkpoints: kept } = nodal;
    let is_first = kept.per_tip.is_empty();
    let whole = Some([0, mesh.elements().len()]);
    let Some(ends) = (if is_first { whole } else { ends_of(nodes) }) else { return };
    let like = L::load_numbers(simd, lambdas);
    let mut checkpoints = if is_first {
        kept.per_tip = vec![Complex64::ZERO; lambdas.len()];
        if kept.nodes.len() > 2 {
            kept.rows = vec![Complex64::ZERO; lambdas.len() * kept.nodes.len() * ROWS];
        }
        // A real λ among complex ones has the bits of the recursion over real numbers.
        let is_other = |k: &usize| !L::IS_REAL && is_real(lambdas[*k]);
        kept.alone.extend((0..lambdas.len()).filter(is_other));
        Checkpoint::of_mesh(mesh, like, &kept.nodes)
    } else {
        vec![]
    };
    let mut recursion = NodalRecursion::new(&(ends[0]..ends[1]), like, quantity);
    for (block, lambdas) in lambdas.chunks(L::LEN).enumerate() {
        let columns = block * L::LEN..block * L::LEN + lambdas.len();
        let lambda = L::load_numbers(simd, lambdas);
        if !is_first {
            checkpoints = ends.map(|node| kept.at(simd, &columns, node)).into();
        }
        let gain = recursion.run(mesh, lambda, quantity, &mut checkpoints);
        let per_tip = if is_first {
            let hub = response_between(mesh, lambda, &checkpoints, gain);
            let gains = gain.complex().numbers();
            let is_lost = |k: &usize| !is_trusted(gains[*k].re);
            let lost = (0..lambdas.len()).filter(is_lost).map(|k| columns.start + k);
            kept.alone.extend(lost);
            let per_tip = per_tip(&hub, mesh, quantity);
            if !kept.rows.is_empty() {
                kept.keep(&columns, &checkpoints, per_tip);
            }
            per_tip
        } else {
            L::load_numbers(simd, &kept.per_tip[columns.clone()])
        };
        for (row, node) in rows.iter_mut().zip(nodes) {
            (recursion.value(*node) * per_tip).complex().store(&mut row[columns.clone()]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::test_links::{Units, mesh, mesh_in};
    use crate::beam::{NodalTransfer, tip_transfer};

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
    fn every_nodal_transfer_of_many_has_the_bits_of_the_one_alone() {
        let (mesh, lambdas) = (mesh(10), lambdas());
        let nodes = [3, 0, 10, 7];
        let alone: Vec<_> = lambdas.iter().map(|lambda| nodal_transfer(&mesh, *lambda)).collect();
        for quantity in [NodalQuantity::Deflection, NodalQuantity::Moment] {
            let value = |transfer: &NodalTransfer, node: usize| match quantity {
                NodalQuantity::Deflection => transfer.deflections_s2[node],
                NodalQuantity::Moment => transfer.moments_kg_m[node],
            };
            for block in [1, 7, 64, lambdas.len()] {
                for (lambdas, alone) in lambdas.chunks(block).zip(alone.chunks(block)) {
                    let mut table = vec![vec![Complex64::ZERO; lambdas.len()]; nodes.len()];
                    let mut rows: Vec<_> = table.iter_mut().map(Vec::as_mut_slice).collect();
                    let checkpoints = &mut Checkpoints::of(&mesh, []);
                    nodal_transfers(&mesh, lambdas, &nodes, quantity, &mut rows, checkpoints);
                    for (node, row) in nodes.iter().zip(&table) {
                        for (found, alone) in row.iter().zip(alone) {
                            assert_eq!(bits(*found), bits(value(alone, *node)), "node {node}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn nodes_in_groups_one_after_the_other_have_the_bits_of_all_at_once() {
        let (mesh, lambdas) = (mesh(40), lambdas());
        let ascending: Vec<usize> = (0..=40).collect();
        let (descending, mixed) = (ascending.iter().rev().copied().collect(), vec![7, 40, 7, 0, 3]);
        for quantity in [NodalQuantity::Deflection, NodalQuantity::Moment] {
            for nodes in [&ascending, &descending, &mixed] {
                let table = |group: usize| {
                    let groups: Vec<&[usize]> = nodes.chunks(group).collect();
                    let further = groups.iter().skip(1).copied();
                    let checkpoints = &mut Checkpoints::of(&mesh, further);
                    let mut table = vec![vec![Complex64::ZERO; lambdas.len()]; nodes.len()];
                    for (nodes, table) in groups.into_iter().zip(table.chunks_mut(group)) {
                        let rows: &mut Vec<_> =
                            &mut table.iter_mut().map(Vec::as_mut_slice).collect();
                        nodal_transfers(&mesh, &lambdas, nodes, quantity, rows, checkpoints);
                    }
                    table.concat().into_iter().map(bits).collect::<Vec<_>>()
                };
                let at_once = table(nodes.len());
                for group in [1, 2, 16] {
                    assert!(table(group) == at_once, "{quantity:?} in groups of {group}");
                }
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
