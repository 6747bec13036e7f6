//! Transfers from the tip to the nodes at many frequencies, one group of nodes after another.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use super::complex_lanes::{ComplexLanes, LambdaLanes};
use super::lanes::RealLanes;
use crate::beam::inertia::Inertia;
use crate::beam::mesh::Mesh;
use crate::beam::recursion::{Checkpoint, NodalQuantity, NodalRecursion};
use crate::beam::transfer::{is_real, is_trusted, nodal_transfer, per_tip, response_between};
use crate::link::ParameterError;

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
        nodes.extend([0, mesh.elements().len()]);
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes, rows: vec![], per_tip: vec![], alone: vec![], keeps }
    }

    /// Upper bound of memory in bytes for each λ, with this number of further groups.
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
    use super::super::hub::tests::{bits, lambdas};
    use super::*;
    use crate::beam::NodalTransfer;
    use crate::beam::test_links::mesh;

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
