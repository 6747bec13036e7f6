use std::ops::Range;
use std::sync::{Arc, OnceLock};

use num_complex::Complex64;
use rayon::prelude::*;

use super::nodal_block::{Held, NodalBlock};
use super::slow_tail::Series;
use super::solution::Solution;
use super::spectra::Forcing;
use super::watch::{Stage, Unwatched, Watch};
use crate::beam::{NodalHistories, NodalQuantity};
use crate::motion::TailTerms;
use crate::numeric::{CHANNELS, Room, Sampling, ThinnedGrid};

/// Amplitudes that are held at a time; nodes beyond are solved in further blocks.
const SPECTRA_BYTES: usize = 1 << 27;

/// Samples that are held at a time; rows beyond are transformed in further blocks.
const HELD_BYTES: usize = 1 << 30;

/// A quantity at some nodes over time, made row by row: one row a sample, one value a node.
///
/// Nothing is computed before a row is asked for; no more is held of it than [`NodalTable::bytes`].
pub struct NodalTable<'a> {
    pub(super) solution: &'a Solution,
    quantity: NodalQuantity,
    pub(super) nodes: Vec<usize>,
    pub(super) every: usize,
    pub(super) sampling: Sampling,
    /// Distances x in m from the axis where the rigid rotation xθ is added.
    pub(super) arms_m: Option<Vec<f64>>,
    /// The slow tail of each node's deflection, where damping leaves one.
    pub(super) tails: Option<Vec<TailTerms>>,
    /// Rows of a block.
    block: usize,
    /// The only block, where there is one.
    whole: OnceLock<Arc<Held>>,
}

impl Solution {
    /// Deflection w in m from the hub's tangent line at `nodes`, every `every`-th sample.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or `every` is 0.
    pub fn deflections(&self, nodes: &[usize], every: usize) -> NodalTable<'_> {
        NodalTable::new(self, nodes, every, NodalQuantity::Deflection)
    }

    /// Total displacement `v = xθ + w` in m (Bayo 1987, eq 1) at `nodes`, every `every`-th sample.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or `every` is 0.
    pub fn displacements(&self, nodes: &[usize], every: usize) -> NodalTable<'_> {
        self.deflections(nodes, every).with_rotation()
    }

    /// Bending moment in N m at `nodes`, every `every`-th sample: what the part of the link towards
    /// the hub exerts on the part towards the tip, positive as the torque is, so that
    /// `EI w'' = −m`. A lumped inertia at a node counts as outer.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or `every` is 0.
    pub fn moments(&self, nodes: &[usize], every: usize) -> NodalTable<'_> {
        NodalTable::new(self, nodes, every, NodalQuantity::Moment)
    }
}

impl<'a> NodalTable<'a> {
    fn new(solution: &'a Solution, nodes: &[usize], every: usize, quantity: NodalQuantity) -> Self {
        let last = solution.mesh().nodes_m().len() - 1;
        assert!(nodes.iter().all(|node| *node <= last), "nodes {nodes:?} of 0 … {last}");
        let pair = &solution.spectrum.pair;
        let first = solution.grid.first.rem_euclid(pair.len() as i64) as usize;
        let sampling = Sampling::new(pair, solution.band.frequencies, first, every);
        let series = match quantity {
            NodalQuantity::Deflection => Series::of(&*solution.model, solution.first_zero_per_s),
            NodalQuantity::Moment => None,
        };
        let tails = series.map(|series| series.nodal_tails(&*solution.model, nodes));
        let mut table = Self {
            solution,
            quantity,
            nodes: nodes.to_vec(),
            every,
            sampling,
            arms_m: None,
            tails,
            block: 1,
            whole: OnceLock::new(),
        };
        // Halved until they fit: the samples held grow no faster than the rows.
        table.block = table.len().max(1);
        while table.block > 1 && table.held_bytes() > HELD_BYTES {
            table.block = table.block.div_ceil(2);
        }
        table
    }

    /// The total displacement, where these are deflections: the rigid rotation is added.
    #[must_use]
    pub fn with_rotation(self) -> Self {
        let nodes_m = self.solution.mesh().nodes_m();
        let arms_m = self.nodes.iter().map(|node| nodes_m[*node]).collect();
        Self { arms_m: Some(arms_m), ..self }
    }

    /// The same table, made in blocks of so many rows.
    #[cfg(test)]
    pub(crate) fn in_blocks_of(self, rows: usize) -> Self {
        Self { block: rows, ..self }
    }

    /// Numbers of the nodes, one a column.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Times of the rows.
    pub fn grid(&self) -> ThinnedGrid {
        self.solution.grid.thinned(self.every)
    }

    /// Number of rows.
    fn len(&self) -> usize {
        self.grid().len()
    }

    /// Panels of [`CHANNELS`] nodes, the last maybe not full.
    pub(super) fn panels(&self) -> usize {
        self.nodes.len().div_ceil(CHANNELS)
    }

    fn held_bytes(&self) -> usize {
        let rows = 0..self.block;
        self.sampling.held(&rows) * self.panels() * size_of::<[f64; CHANNELS]>()
    }

    /// Memory in bytes that making the rows takes, about: amplitudes and samples of a block, and what
    /// each thread transforms.
    pub fn bytes(&self) -> usize {
        let nodes = self.nodes.len().min(self.nodes_at_once());
        let rooms = rayon::current_num_threads().min(self.panels()) * self.sampling.room_bytes();
        self.held_bytes() + nodes * self.spectrum_bytes() + rooms
    }

    /// Blocks that the rows are made in, one after the other; one wherever memory allows.
    pub fn blocks(&self) -> usize {
        self.len().div_ceil(self.block)
    }

    /// Makes the rows of a block, numbered from 0, unless they are there.
    ///
    /// # Panics
    /// If there is no such block.
    pub fn block(&self, number: usize, watch: &dyn Watch) -> NodalBlock<'_> {
        assert!(number < self.blocks(), "block {number} of {}", self.blocks());
        let start = number * self.block;
        let rows = start..self.len().min(start + self.block);
        let held = if self.blocks() == 1 {
            self.whole.get_or_init(|| Arc::new(self.hold(&rows, watch))).clone()
        } else {
            Arc::new(self.hold(&rows, watch))
        };
        NodalBlock { table: self, rows, held }
    }

    fn spectrum_bytes(&self) -> usize {
        size_of::<Complex64>() * self.solution.band.frequencies
    }

    /// Nodes that are solved for at a time: whole panels, one at least.
    fn nodes_at_once(&self) -> usize {
        (SPECTRA_BYTES / self.spectrum_bytes() / CHANNELS).max(1) * CHANNELS
    }

    fn hold(&self, rows: &Range<usize>, watch: &dyn Watch) -> Held {
        let len = self.sampling.held(rows);
        let mut held = Held::zeros(self.panels(), len);
        let forcing = Forcing { watch, ..self.solution.forcing() };
        let nodes_at_once = self.nodes_at_once();
        let panels_at_once = nodes_at_once / CHANNELS;
        let blocks = held.samples_mut().chunks_mut((panels_at_once * len).max(1));
        for (number, (nodes, samples)) in self.nodes.chunks(nodes_at_once).zip(blocks).enumerate() {
            forcing.begin(self.nodes.len().div_ceil(nodes_at_once), number);
            let spectra = forcing.nodal_spectra(nodes, self.quantity);
            watch.begin(Stage::Transform, self.nodes.len());
            watch.advance(number * nodes_at_once);
            let panels = samples.par_chunks_mut(len).zip(spectra.par_chunks(CHANNELS));
            panels.for_each_init(Room::default, |room, (panel, spectra)| {
                self.sampling.hold(rows, spectra, panel, room, |nodes| watch.advance(nodes));
            });
        }
        held
    }

    /// All of it, node by node.
    pub fn histories(&self) -> NodalHistories {
        let mut samples = vec![Vec::with_capacity(self.len()); self.nodes.len()];
        for number in 0..self.blocks() {
            let block = self.block(number, &Unwatched);
            let mut row = vec![0.0; self.nodes.len()];
            for k in block.rows() {
                block.write_rows(k..k + 1, &mut row);
                samples.iter_mut().zip(&row).for_each(|(history, value)| history.push(*value));
            }
        }
        NodalHistories { nodes: self.nodes.clone(), grid: self.grid(), samples }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inverse::tests::solution;

    #[test]
    fn rows_made_in_blocks_have_the_bits_of_those_made_at_once() {
        for (steps, is_narrow) in [(100, false), (4000, true)] {
            let solution = solution(steps);
            let nodes: Vec<usize> = (0..solution.mesh().nodes_m().len()).rev().collect();
            assert_eq!(nodes.len(), 2 * CHANNELS + 9, "two full panels and another");
            for every in [1, 7] {
                let whole = solution.displacements(&nodes, every);
                assert_eq!(whole.blocks(), 1);
                let held = whole.sampling.held(&(0..whole.len()));
                assert_eq!(is_narrow, held != whole.len(), "{held} samples held");
                let blocked = solution.displacements(&nodes, every);
                let rows = blocked.len() / 3 + 1;
                let blocked = blocked.in_blocks_of(rows);
                assert_eq!(blocked.blocks(), 3);
                assert!(blocked.histories() == whole.histories());
            }
        }
    }

    #[test]
    fn a_table_holds_as_many_bytes_as_it_says() {
        for steps in [100, 4000] {
            let solution = solution(steps);
            for nodes in [&[3][..], &[0, 1, 2, 3, 4, 5, 6, 7, 8], &[5; 40]] {
                for (every, rows) in [(1, 80), (1, 13), (7, 13)] {
                    let table = solution.moments(nodes, every).in_blocks_of(rows);
                    let held = table.block(0, &Unwatched).held;
                    let bytes = size_of_val(held.samples());
                    assert_eq!(table.held_bytes(), bytes, "{nodes:?}, {rows} rows, {every}");
                    let amplitudes = solution.forcing().nodal_spectra(nodes, table.quantity);
                    let bytes =
                        bytes + amplitudes.iter().map(|row| size_of_val(&row[..])).sum::<usize>();
                    let rooms = table.bytes() - bytes;
                    assert!(rooms <= rayon::current_num_threads() * table.sampling.room_bytes());
                    assert!(rooms >= table.sampling.room_bytes(), "one thread at least");
                }
            }
        }
    }

    #[test]
    fn as_many_whole_panels_are_solved_for_at_once_as_their_memory_allows() {
        let solution = solution(4000);
        let table = solution.deflections(&[1], 1);
        let panel = CHANNELS * table.spectrum_bytes();
        assert_eq!(table.nodes_at_once() % CHANNELS, 0);
        let bytes = table.nodes_at_once() * table.spectrum_bytes();
        assert!(bytes <= SPECTRA_BYTES && bytes + panel > SPECTRA_BYTES, "{bytes} and {panel}");
    }

    #[test]
    fn each_thread_takes_a_room_of_its_own_as_long_as_there_are_panels_for_it() {
        let solution = solution(100);
        let table = solution.deflections(&[1; 3 * CHANNELS], 1);
        let room = table.sampling.room_bytes();
        let bytes = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| table.bytes())
        };
        assert_eq!([2, 3, 4].map(|threads| bytes(threads) - bytes(1)), [room, 2 * room, 2 * room]);
    }
}
