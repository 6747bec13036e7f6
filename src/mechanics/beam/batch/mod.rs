//! The recursion at several λ at a time, one for each lane of the processor's vectors.
//!
//! Neither the width of the vectors nor the neighbours in the list change a bit of any λ. The plain versions are
//! [`tip_transfer`], [`nodal_transfer`], [`condense`] and [`tip_displacement_m`], and the tests compare both bit by
//! bit.
//!
//! [`tip_transfer`]: super::tip_transfer
//! [`nodal_transfer`]: super::nodal_transfer
//! [`condense`]: super::condense
//! [`tip_displacement_m`]: super::tip_displacement_m

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pivots are counted in lanes of floating-point numbers"
)]

mod lanes;

use std::ops::Range;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use crate::beam::inertia::Inertia;
use crate::beam::mesh::Mesh;
use crate::beam::recursion::{
    Checkpoint, NodalQuantity, NodalRecursion, condense, hub_response, tip_displacement_m,
};
use crate::beam::transfer::{
    TipTransfer, is_real, is_trusted, nodal_transfer, per_tip, pivoted_transfer, response_between,
};
use crate::link::ParameterError;
use crate::numeric::{SECTIONS, Scalar};
use lanes::{ComplexLanes, LambdaLanes, RealLanes};

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
            let at_axis = root.along(mesh.rigid(0)) + mesh.joint().inertia();
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

/// State of the recursion at some nodes and at many λ. The recursion continues from it, so that a further group of
/// nodes needs no pass through the whole mesh.
///
/// Only this crate can construct it.
#[derive(Debug, Clone)]
pub struct Checkpoints {
    /// Numbers of the nodes, ascending: the root, intermediate nodes and the tip.
    nodes: Vec<usize>,
    /// Rows `A_vv`, `A_vφ`, `A_φφ`, deflection and slope per hub angle for each node, with a number for each λ.
    rows: Vec<Complex64>,
    /// Factors from values per hub angle to values per tip motion; empty before the first pass.
    per_tip: Vec<Complex64>,
    /// Columns solved one by one: the recursion loses its digits there, or λ is real among complex ones.
    alone: Vec<usize>,
    /// True if there are further groups of nodes.
    keeps: bool,
}

/// Number of rows for each checkpoint.
const ROWS: usize = 5;

impl Checkpoints {
    /// Checkpoints for a first group of nodes and these further groups.
    pub fn of<'a>(mesh: &Mesh, further: impl IntoIterator<Item = &'a [usize]>) -> Self {
        let mut nodes: Vec<usize> = further.into_iter().filter_map(ends_of).flatten().collect();
        let keeps = !nodes.is_empty();
        nodes.extend([0, mesh.output(), mesh.elements().len()]);
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes, rows: vec![], per_tip: vec![], alone: vec![], keeps }
    }

    /// Upper bound of memory in bytes for each λ, with this number of further groups.
    pub const fn bytes(further: usize) -> usize {
        if further == 0 { 0 } else { (2 * further + 3) * ROWS * size_of::<Complex64>() }
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

    /// Checkpoint at a node.
    ///
    /// # Panics
    /// If the node has no checkpoint.
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

/// First and last node in the order of the mesh.
fn ends_of(nodes: &[usize]) -> Option<[usize; 2]> {
    Some([*nodes.iter().min()?, *nodes.iter().max()?])
}

/// Transfers from the tip to some nodes, `e_i/(λ (L + e_tip))` in s² or moments in kg m, with the bits of
/// [`nodal_transfer`]: a row for each of `nodes` with a value for each λ.
///
/// Columns of `rows` beyond the last λ stay unchanged.
///
/// # Errors
/// [`ParameterError`] if the mesh lacks a node, or a row is shorter than `lambdas`.
pub fn nodal_transfers(
    mesh: &Mesh,
    lambdas: &[Complex64],
    nodes: &[usize],
    quantity: NodalQuantity,
    rows: &mut [&mut [Complex64]],
) -> Result<(), ParameterError> {
    mesh.check_nodes(nodes)?;
    if let Some(row) = rows.iter().find(|row| row.len() < lambdas.len()) {
        let must = format!("must have a place for each of {}", lambdas.len());
        return Err(ParameterError::new("a row", row.len(), "values", must));
    }
    nodal_transfers_from(mesh, lambdas, nodes, quantity, rows, &mut Checkpoints::of(mesh, []));
    Ok(())
}

/// [`nodal_transfers`] for nodes in groups. The first call with `checkpoints` passes through the whole mesh. Each
/// further call, with the same λ and quantity, passes only from the first to the last node of its group.
///
/// # Panics
/// If the mesh lacks a node, a row is shorter than `lambdas`, or the group of a further call is not in the checkpoints.
pub(crate) fn nodal_transfers_from(
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
        if kept.keeps {
            kept.rows = vec![Complex64::ZERO; lambdas.len() * kept.nodes.len() * ROWS];
        }
        // A real λ among complex ones gets the bits of the real recursion.
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
            if kept.keeps {
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
    use crate::beam::test_links::mesh;
    use crate::beam::{NodalTransfer, tip_transfer};

    /// Undamped λ, some at resonances of the outboard part; damped λ far beyond the mesh's resolution; lightly damped
    /// λ.
    fn lambdas() -> Vec<Complex64> {
        let squares = (0..600).map(|k| (0.670_123 * f64::from(k)).powi(2));
        let damped = |k: u32| Complex64::from(f64::from(k * k)) / Complex64::new(1.0, 0.04);
        // At this λ the link is rigid to the last digit.
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
                    nodal_transfers_from(&mesh, lambdas, &nodes, quantity, &mut rows, checkpoints);
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
        let mesh = mesh(20);
        let (real, others): (Vec<_>, Vec<_>) =
            lambdas().into_iter().step_by(5).partition(|lambda| is_real(*lambda));
        let others = others.into_iter().chain([real[3]]).collect();
        let ascending: Vec<usize> = (0..=20).collect();
        let (descending, mixed) = (ascending.iter().rev().copied().collect(), vec![7, 3, 20, 0]);
        for quantity in [NodalQuantity::Deflection, NodalQuantity::Moment] {
            for (lambdas, nodes) in [&real, &others]
                .into_iter()
                .flat_map(|lambdas| [&ascending, &descending, &mixed].map(|nodes| (lambdas, nodes)))
            {
                let table = |group: usize| {
                    let groups: Vec<&[usize]> = nodes.chunks(group).collect();
                    let further = groups.iter().skip(1).copied();
                    let checkpoints = &mut Checkpoints::of(&mesh, further);
                    let mut table = vec![vec![Complex64::ZERO; lambdas.len()]; nodes.len()];
                    for (nodes, table) in groups.into_iter().zip(table.chunks_mut(group)) {
                        let rows: &mut Vec<_> =
                            &mut table.iter_mut().map(Vec::as_mut_slice).collect();
                        nodal_transfers_from(&mesh, lambdas, nodes, quantity, rows, checkpoints);
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
}
