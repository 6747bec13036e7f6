//! Tables of a quantity at some nodes over time.
//!
//! The decimals depend on the peak, which must be known before the first row is written. An upper bound of each row
//! replaces a second computation of all rows, which would take a fifth longer.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::analysis::{Stage, Unwatched, Watch};
use super::histories::SlowTails;
use super::solution::{LinkSpectra, Shape, Solution};
use super::spectra::DrivenModel;
use crate::beam::{Checkpoints, NodalHistories, NodalQuantity};
use crate::link::ParameterError;
use crate::motion::{Ends, TAIL_TERMS, TailTerms};
use crate::numeric::{PANEL, Sampling, ThinnedGrid, Transforms, largest};
use crate::system::end_if_stopped;

/// Bytes of the processor's cache line, and of its widest vectors.
const LINE: usize = 64;

/// Rows of a part; each part has one bound.
const PART_ROWS: usize = 512;

/// Rows of a part that one thread computes at a time.
const ROWS_AT_ONCE: usize = 64;

/// Factor of all bounds, far above the rounding of a sum.
const ROUNDING: f64 = 1.0 + 1e-12;

/// The samples behind the rows, panel by panel of [`PANEL`] nodes.
struct PanelSamples {
    /// Samples of all panels, after up to seven unused numbers.
    numbers: Vec<f64>,
    /// Index of the first sample, which begins a cache line.
    first: usize,
    /// Samples of a panel.
    pub(super) len: usize,
}

impl PanelSamples {
    /// Zeros for `panels` panels.
    pub(super) fn zeros(panels: usize, len: usize) -> Self {
        // Aligned, because a vector that crosses two lines takes 1.5 times as long to read.
        let most = LINE / size_of::<f64>() - 1;
        let numbers = vec![0.0; most + panels * len * PANEL];
        let first = numbers.as_ptr().align_offset(LINE).min(most);
        Self { numbers, first, len }
    }

    /// The samples of all panels, one panel after the other.
    pub(super) fn samples(&self) -> &[[f64; PANEL]] {
        self.numbers[self.first..].as_chunks().0
    }

    fn samples_mut(&mut self) -> &mut [[f64; PANEL]] {
        self.numbers[self.first..].as_chunks_mut().0
    }
}

/// Computation of a nodal table's rows from samples.
struct RowPlan<'a> {
    pub(super) solution: &'a Solution,
    pub(super) spectra: &'a LinkSpectra,
    /// Numbers of the nodes, one a column.
    pub(super) nodes: Vec<usize>,
    /// Times of the rows.
    pub(super) times: ThinnedGrid,
    pub(super) sampling: Sampling,
    /// Distances x in m from the axis, for a table with the rigid rotation xθ.
    pub(super) arms_m: Option<Vec<f64>>,
    /// θ in rad.
    pub(super) turned_rad: Cow<'a, [f64]>,
    /// The slow tail of each node's deflection, where damping causes one.
    pub(super) tails: Option<Vec<TailTerms>>,
}

/// Some rows of a [`NodalTable`](super::NodalTable).
pub(crate) struct NodalBlock<'a> {
    plan: &'a RowPlan<'a>,
    pub(super) rows: Range<usize>,
    samples: Arc<PanelSamples>,
}

impl RowPlan<'_> {
    /// Panels of [`PANEL`] nodes; the last may have fewer.
    fn panels(&self) -> usize {
        self.nodes.len().div_ceil(PANEL)
    }

    /// Upper bound of the subtracted images of the motion in other periods.
    fn largest_images(&self) -> f64 {
        let Some(tails) = &self.tails else { return 0.0 };
        let history = self.spectra.period.images().history(0);
        let most =
            |all: &[TailTerms], m: usize| all.iter().fold(0.0, |most: f64, t| most.max(t[m].abs()));
        (0..TAIL_TERMS).map(|m| most(tails, m) * most(history, m)).sum()
    }
}

/// Some rows and an upper bound of their absolute values.
pub(super) struct Part {
    pub(super) rows: Range<usize>,
    pub(super) bound: f64,
}

impl NodalBlock<'_> {
    /// Numbers of these rows in the table.
    pub(crate) fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// Writes some of the rows into `values`, one after the other.
    ///
    /// # Panics
    /// If the block lacks the rows, or `values` has another size.
    pub(crate) fn write_rows(&self, rows: Range<usize>, values: &mut [f64]) {
        end_if_stopped();
        let width = self.plan.nodes.len();
        assert_eq!(values.len(), rows.len() * width, "{rows:?} of {width} nodes");
        assert!(self.rows.start <= rows.start && rows.end <= self.rows.end, "{rows:?}");
        Arch::new().dispatch(WriteRows { block: self, range: rows, values });
    }

    /// Largest absolute value of some rows.
    pub(super) fn peak_of(&self, rows: &Range<usize>) -> f64 {
        let width = self.plan.nodes.len();
        let starts = rows.clone().into_par_iter().step_by(ROWS_AT_ONCE);
        let peaks = starts.map(|start| {
            let rows = start..rows.end.min(start + ROWS_AT_ONCE);
            let mut values = vec![0.0; rows.len() * width];
            self.write_rows(rows, &mut values);
            largest(&values)
        });
        peaks.reduce(|| 0.0, f64::max)
    }

    /// All rows in parts. A row is a weighted sum of samples, less the images, and the rigid rotation
    /// times an arm.
    pub(super) fn parts(&self) -> Vec<Part> {
        let RowPlan { turned_rad, sampling, times, arms_m, .. } = self.plan;
        let farthest_m = arms_m.as_deref().map(largest);
        let images = self.plan.largest_images();
        let bound = |rows: &Range<usize>| {
            let bending = sampling.gain() * self.largest_sample(rows) + images;
            let rotation = farthest_m.map_or(0.0, |arm_m| {
                let angles = &turned_rad[times.index(rows.start)..];
                let samples = (rows.len() - 1) * times.every() + 1;
                arm_m * largest(&angles[..samples])
            });
            (bending + rotation) * ROUNDING
        };
        let parts = self.rows.clone().into_par_iter().step_by(PART_ROWS).map(|start| {
            let rows = start..self.rows.end.min(start + PART_ROWS);
            Part { bound: bound(&rows), rows }
        });
        parts.collect()
    }

    /// The largest of all nodes' samples behind these rows.
    fn largest_sample(&self, rows: &Range<usize>) -> f64 {
        let taken = self.plan.sampling.taken(&self.rows, rows);
        let panels = self.samples.samples().chunks(self.samples.len.max(1));
        let of_panel = |panel: &[[f64; PANEL]]| largest(panel[taken.clone()].as_flattened());
        panels.map(of_panel).fold(0.0, f64::max)
    }

    /// Writes the columns from `column` on.
    #[inline(always)]
    fn write_panel(
        &self,
        rows: &Range<usize>,
        samples: &[[f64; PANEL]],
        column: usize,
        values: &mut [f64],
    ) {
        let plan = self.plan;
        let width = plan.nodes.len();
        let columns = column..width.min(column + PANEL);
        let mut arms_m = [0.0; PANEL];
        if let Some(all) = &plan.arms_m {
            arms_m[..columns.len()].copy_from_slice(&all[columns.clone()]);
        }
        let mut tails = [[0.0; PANEL]; TAIL_TERMS];
        let images = plan.tails.as_ref().map(|all| {
            for (channel, tail) in all[columns.clone()].iter().enumerate() {
                for (row, s) in tails.iter_mut().zip(tail) {
                    row[channel] = *s;
                }
            }
            plan.spectra.period.images().history(0)
        });
        for row in rows.start..rows.end {
            let mut sum = plan.sampling.row(&self.rows, samples, row);
            if let Some(images) = images {
                let sample = plan.solution.grid.in_period(plan.times.index(row), images.len());
                for (tail, image) in tails.iter().zip(&images[sample]) {
                    for channel in 0..PANEL {
                        sum[channel] -= tail[channel] * image;
                    }
                }
            }
            if plan.arms_m.is_some() {
                let angle_rad = plan.turned_rad[plan.times.index(row)];
                for channel in 0..PANEL {
                    sum[channel] += arms_m[channel] * angle_rad;
                }
            }
            let values = &mut values[(row - rows.start) * width..][columns.start..columns.end];
            match values.first_chunk_mut() {
                Some(whole) => *whole = sum,
                None => values.copy_from_slice(&sum[..columns.len()]),
            }
        }
    }
}

/// [`NodalBlock::write_rows`] for the vectors of this processor.
struct WriteRows<'a> {
    block: &'a NodalBlock<'a>,
    range: Range<usize>,
    values: &'a mut [f64],
}

impl WithSimd for WriteRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let PanelSamples { len, .. } = *self.block.samples;
        let samples = self.block.samples.samples();
        for panel in 0..self.block.plan.panels() {
            let samples = &samples[panel * len..][..len];
            self.block.write_panel(&self.range, samples, panel * PANEL, self.values);
        }
    }
}

/// Bytes of amplitudes in memory at a time, unless [`MOST_NODE_BLOCKS`] requires more.
const SPECTRA_BYTES: usize = 1 << 27;

/// Most groups of nodes, solved one after the other: the checkpoints between more groups would take more memory than
/// the amplitudes.
const MOST_NODE_BLOCKS: usize = 32;

/// Bytes of samples in memory at a time, unless [`MOST_ROW_BLOCKS`] requires more.
const SAMPLE_BYTES: usize = 1 << 30;

/// Most blocks of rows, computed one after the other; each solves and transforms all nodes again.
const MOST_ROW_BLOCKS: usize = 8;

/// A quantity at some nodes over time: one row a sample, one value a node.
///
/// Computes rows in blocks, on request, within [`NodalTable::bytes`] of memory.
pub struct NodalTable<'a> {
    plan: RowPlan<'a>,
    quantity: NodalQuantity,
    /// Rows of a block.
    block: usize,
    /// Samples of the only block, if there is one block.
    whole: OnceLock<Arc<PanelSamples>>,
}

impl Solution {
    /// Deflection w in m from the hub's tangent line at `nodes`, every `every`-th sample.
    ///
    /// # Errors
    /// [`ParameterError`] if the mesh lacks a node, and for an arm, whose links have [shapes](Self::shapes).
    pub fn deflections(
        &self,
        nodes: &[usize],
        every: NonZeroUsize,
    ) -> Result<NodalTable<'_>, ParameterError> {
        self.deflections_at(nodes, self.grid.thinned(every))
    }

    /// [`Self::deflections`] at these times of the grid.
    pub(crate) fn deflections_at(
        &self,
        nodes: &[usize],
        times: ThinnedGrid,
    ) -> Result<NodalTable<'_>, ParameterError> {
        NodalTable::new(self, nodes, times, NodalQuantity::Deflection)
    }

    /// Total displacement `v = xθ + w` in m (Bayo 1987, eq 1) at `nodes`, every `every`-th sample.
    ///
    /// # Errors
    /// [`ParameterError`] if the mesh lacks a node.
    pub fn displacements(
        &self,
        nodes: &[usize],
        every: NonZeroUsize,
    ) -> Result<NodalTable<'_>, ParameterError> {
        Ok(self.deflections(nodes, every)?.with_rotation())
    }

    /// Bending moment in N m at `nodes`, every `every`-th sample. The part of the link towards the hub exerts it on the
    /// part towards the tip, positive like the torque: `EI w'' = −m`. A lumped inertia at a node counts as outer.
    ///
    /// # Errors
    /// [`ParameterError`] if the mesh lacks a node.
    pub fn moments(
        &self,
        nodes: &[usize],
        every: NonZeroUsize,
    ) -> Result<NodalTable<'_>, ParameterError> {
        NodalTable::new(self, nodes, self.grid.thinned(every), NodalQuantity::Moment)
    }
}

impl<'a> NodalTable<'a> {
    fn new(
        solution: &'a Solution,
        nodes: &[usize],
        times: ThinnedGrid,
        quantity: NodalQuantity,
    ) -> Result<Self, ParameterError> {
        let Some(spectra) = &solution.spectra else {
            let must = "must be one: those of an arm have their shapes in the solution";
            return Err(ParameterError::new("links", solution.links.len(), "", must));
        };
        solution.links[0].mesh().check_nodes(nodes)?;
        Ok(Self::of((solution, spectra), nodes, times, quantity))
    }

    fn of(
        (solution, spectra): (&'a Solution, &'a LinkSpectra),
        nodes: &[usize],
        times: ThinnedGrid,
        quantity: NodalQuantity,
    ) -> Self {
        let (pair, model) = (&spectra.period.spectrum.pair, &*solution.links[0].model);
        let first = solution.grid.in_period(times.index(0), pair.len());
        let sampling = Sampling::new(pair, solution.band.frequencies, first, times.every());
        let tails = match quantity {
            NodalQuantity::Deflection if spectra.shape.is_none() => {
                SlowTails::of(model, solution.first_zero_per_s)
                    .filter(|_| solution.motion.ends() != Ends::Periodic)
            }
            _ => None,
        };
        let tails = tails.map(|tails| tails.nodal_tails(model, nodes));
        let nodes = nodes.to_vec();
        // Displacements count along the hub's tangent line or, for a bent link, along the chord.
        let turned_rad = if spectra.shape.is_none() {
            Cow::Borrowed(&solution.joints[0].angle_rad[..])
        } else {
            let length_m = solution.links[0].mesh().rigid_tip();
            solution.tip[0].displacement_m.iter().map(|m| m / length_m).collect()
        };
        let arms_m = None;
        let plan = RowPlan { solution, spectra, nodes, times, sampling, arms_m, turned_rad, tails };
        let mut table = Self { plan, quantity, block: 1, whole: OnceLock::new() };
        let fewest = table.len().div_ceil(MOST_ROW_BLOCKS).max(1);
        table.block = table.len().max(1);
        while table.block > fewest && table.sample_bytes() > SAMPLE_BYTES {
            table.block = table.block.div_ceil(2).max(fewest);
        }
        table
    }

    /// Turns deflections into total displacements: adds the rigid rotation.
    #[must_use]
    pub(crate) fn with_rotation(self) -> Self {
        let mesh = self.plan.solution.links[0].mesh();
        let arms_m = self.nodes().iter().map(|node| mesh.rigid(*node)[0]).collect();
        // A bent link turns along its chord and needs other samples.
        let whole = if self.plan.spectra.shape.is_some() { OnceLock::new() } else { self.whole };
        Self { plan: RowPlan { arms_m: Some(arms_m), ..self.plan }, whole, ..self }
    }

    /// The bending moments at the same nodes and times.
    pub(crate) fn moments(&self) -> Self {
        let RowPlan { solution, spectra, nodes, times, .. } = &self.plan;
        Self::of((solution, spectra), nodes, *times, NodalQuantity::Moment)
    }

    /// Sets the number of rows of a block.
    #[cfg(test)]
    pub(crate) fn in_blocks_of(self, rows: usize) -> Self {
        Self { block: rows, ..self }
    }

    /// Numbers of the nodes, one a column.
    pub fn nodes(&self) -> &[usize] {
        &self.plan.nodes
    }

    /// Times of the rows.
    pub fn grid(&self) -> ThinnedGrid {
        self.plan.times
    }

    /// Number of rows.
    fn len(&self) -> usize {
        self.grid().len()
    }

    fn sample_bytes(&self) -> usize {
        let samples = self.plan.sampling.samples_for(&(0..self.block));
        samples * self.plan.panels() * size_of::<[f64; PANEL]>()
    }

    /// Approximate memory in bytes of the rows: amplitudes and samples of a block, and the transforms of each thread.
    pub fn bytes(&self) -> usize {
        let nodes = self.nodes().len().min(self.nodes_at_once());
        let threads = rayon::current_num_threads().min(self.plan.panels());
        let transforms = threads * self.plan.sampling.transform_bytes();
        let further = self.nodes().len().div_ceil(self.nodes_at_once()).saturating_sub(1);
        let checkpoints = Checkpoints::bytes(further) * self.plan.solution.band.frequencies;
        self.sample_bytes() + nodes * self.spectrum_bytes() + checkpoints + transforms
    }

    /// Number of blocks of rows: one if its samples fit the memory.
    pub fn blocks(&self) -> usize {
        self.len().div_ceil(self.block)
    }

    /// Solves and transforms a block of rows, numbered from 0; keeps an only block for further calls.
    ///
    /// # Panics
    /// If there is no such block.
    pub(crate) fn block(&self, number: usize, watch: &dyn Watch) -> NodalBlock<'_> {
        assert!(number < self.blocks(), "block {number} of {}", self.blocks());
        let start = number * self.block;
        let rows = start..self.len().min(start + self.block);
        let samples = || Arc::new(self.samples(&rows, self.nodes_at_once(), watch));
        let samples =
            if self.blocks() == 1 { self.whole.get_or_init(samples).clone() } else { samples() };
        NodalBlock { plan: &self.plan, rows, samples }
    }

    /// Largest absolute value of all rows without NaN, or a smaller sufficient one.
    ///
    /// `is_enough` receives the largest value so far and a bound of the block's other rows, infinite or NaN where the
    /// bound is unknown. If it returns true, the search skips these rows.
    pub fn peak(&self, watch: &dyn Watch, is_enough: impl Fn(f64, f64) -> bool) -> f64 {
        (0..self.blocks()).fold(0.0, |mut found, number| {
            let block = self.block(number, watch);
            let mut parts = block.parts();
            parts.sort_by(|a, b| b.bound.total_cmp(&a.bound));
            for part in parts {
                if is_enough(found, part.bound) {
                    break;
                }
                found = f64::max(found, block.peak_of(&part.rows));
            }
            found
        })
    }

    fn spectrum_bytes(&self) -> usize {
        size_of::<Complex64>() * self.plan.solution.band.frequencies
    }

    /// Number of nodes solved at a time: whole panels, at least one.
    fn nodes_at_once(&self) -> usize {
        let fitting = SPECTRA_BYTES / self.spectrum_bytes() / PANEL;
        let fewest = self.plan.panels().div_ceil(MOST_NODE_BLOCKS);
        fitting.max(fewest).max(1) * PANEL
    }

    /// The samples behind `rows`, solved in groups of nodes.
    fn samples(
        &self,
        rows: &Range<usize>,
        nodes_at_once: usize,
        watch: &dyn Watch,
    ) -> PanelSamples {
        let RowPlan { solution, spectra, nodes: all, sampling, .. } = &self.plan;
        let len = sampling.samples_for(rows);
        let mut samples = PanelSamples::zeros(self.plan.panels(), len);
        let driven = DrivenModel { watch, ..spectra.driven(&*solution.links[0].model) };
        let groups: Vec<&[usize]> = all.chunks(nodes_at_once).collect();
        let mut checkpoints = driven.checkpoints(groups.iter().skip(1).copied());
        // The first group takes a pass through the whole mesh, the others together one more.
        let (first_pass, passes) = (groups.len(), (2 * groups.len()).saturating_sub(1));
        let blocks = samples.samples_mut().chunks_mut((nodes_at_once / PANEL * len).max(1));
        for (number, (nodes, samples)) in groups.iter().zip(blocks).enumerate() {
            let (done, share) =
                if number == 0 { (0, first_pass) } else { (first_pass + number - 1, 1) };
            driven.begin(passes, done);
            let advance = |bins| watch.advance(share * bins);
            let spectra = match &spectra.shape {
                Some(shape) => {
                    advance(solution.band.frequencies);
                    self.spectra_of(shape, nodes)
                }
                None => driven.nodal_spectra_from(&mut checkpoints, nodes, self.quantity, advance),
            };
            watch.begin(Stage::Transform, all.len());
            watch.advance(number * nodes_at_once);
            let panels = samples.par_chunks_mut(len).zip(spectra.par_chunks(PANEL));
            panels.for_each_init(Transforms::default, |transforms, (panel, spectra)| {
                let advance = |nodes| {
                    end_if_stopped();
                    watch.advance(nodes);
                };
                sampling.write_samples(rows, spectra, panel, transforms, advance);
            });
        }
        samples
    }

    /// Amplitudes at some nodes of a bent link.
    fn spectra_of(&self, shape: &Shape, nodes: &[usize]) -> Vec<Vec<Complex64>> {
        let histories = match self.quantity {
            NodalQuantity::Moment => &shape.moments_n_m,
            NodalQuantity::Deflection if self.plan.arms_m.is_some() => &shape.arcs_m,
            NodalQuantity::Deflection => &shape.deflections_m,
        };
        let pair = &self.plan.spectra.period.spectrum.pair;
        nodes.par_iter().map(|node| pair.amplitudes(&histories[*node])).collect()
    }

    /// The whole table, node by node.
    pub fn histories(&self) -> NodalHistories {
        let mut samples = vec![Vec::with_capacity(self.len()); self.nodes().len()];
        for number in 0..self.blocks() {
            let block = self.block(number, &Unwatched);
            let mut row = vec![0.0; self.nodes().len()];
            for k in block.rows() {
                block.write_rows(k..k + 1, &mut row);
                samples.iter_mut().zip(&row).for_each(|(history, value)| history.push(*value));
            }
        }
        NodalHistories { nodes: self.nodes().to_vec(), grid: self.grid(), samples }
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;

    use super::*;
    use crate::inverse::Unwatched;
    use crate::inverse::tests::solution;

    #[test]
    fn rows_made_in_blocks_have_the_bits_of_those_made_at_once() {
        for (steps, is_narrow) in [(100, false), (4000, true)] {
            let solution = solution(steps);
            let nodes: Vec<usize> = (0..solution.links[0].mesh().nodes_m().len()).rev().collect();
            assert_eq!(nodes.len(), 2 * PANEL + 9, "two full panels and another");
            for every in [1, 7] {
                let whole =
                    solution.displacements(&nodes, NonZeroUsize::new(every).unwrap()).unwrap();
                assert_eq!(whole.blocks(), 1);
                let samples = whole.plan.sampling.samples_for(&(0..whole.len()));
                assert_eq!(is_narrow, samples != whole.len(), "{samples} samples");
                let blocked =
                    solution.displacements(&nodes, NonZeroUsize::new(every).unwrap()).unwrap();
                let rows = blocked.len() / 3 + 1;
                let blocked = blocked.in_blocks_of(rows);
                assert_eq!(blocked.blocks(), 3);
                assert!(blocked.histories() == whole.histories());
            }
        }
    }

    #[test]
    fn nodes_solved_for_in_groups_have_the_bits_of_all_at_once() {
        let solution = solution(100);
        let nodes: Vec<usize> = (0..solution.links[0].mesh().nodes_m().len()).collect();
        for table in [
            solution.deflections(&nodes, NonZeroUsize::MIN).unwrap(),
            solution.moments(&nodes, NonZeroUsize::MIN).unwrap(),
        ] {
            let rows = 0..table.len();
            let samples = |at_once| table.samples(&rows, at_once, &Unwatched);
            assert!(samples(PANEL).samples() == samples(3 * PANEL).samples());
        }
    }

    #[test]
    fn a_table_takes_as_many_bytes_as_it_says() {
        for steps in [100, 4000] {
            let solution = solution(steps);
            for nodes in [&[3][..], &[0, 1, 2, 3, 4, 5, 6, 7, 8], &[5; 40]] {
                for (every, rows) in [(1, 80), (1, 13), (7, 13)] {
                    let table = solution
                        .moments(nodes, NonZeroUsize::new(every).unwrap())
                        .unwrap()
                        .in_blocks_of(rows);
                    let samples = table.block(0, &Unwatched).samples;
                    let bytes = size_of_val(samples.samples());
                    assert_eq!(table.sample_bytes(), bytes, "{nodes:?}, {rows} rows, {every}");
                    let amplitudes = table
                        .plan
                        .spectra
                        .driven(&*solution.links[0].model)
                        .nodal_spectra(nodes, table.quantity);
                    let bytes =
                        bytes + amplitudes.iter().map(|row| size_of_val(&row[..])).sum::<usize>();
                    let transforms = table.bytes() - bytes;
                    let of_one = table.plan.sampling.transform_bytes();
                    assert!(transforms <= rayon::current_num_threads() * of_one);
                    assert!(transforms >= of_one, "one thread at least");
                }
            }
        }
    }

    #[test]
    fn as_many_whole_panels_are_solved_for_at_once_as_their_memory_allows() {
        let solution = solution(4000);
        let table = solution.deflections(&[1], NonZeroUsize::MIN).unwrap();
        let panel = PANEL * table.spectrum_bytes();
        assert_eq!(table.nodes_at_once() % PANEL, 0);
        let bytes = table.nodes_at_once() * table.spectrum_bytes();
        assert!(bytes <= SPECTRA_BYTES && bytes + panel > SPECTRA_BYTES, "{bytes} and {panel}");
        let many = solution.moments(&vec![1; 4_000_000], NonZeroUsize::MIN).unwrap();
        assert_eq!(many.nodes().len().div_ceil(many.nodes_at_once()), MOST_NODE_BLOCKS);
        assert!(many.blocks() == MOST_ROW_BLOCKS && many.sample_bytes() > SAMPLE_BYTES);
    }

    #[test]
    fn each_thread_has_transforms_of_its_own_as_long_as_there_are_panels_for_it() {
        let solution = solution(100);
        let table = solution.deflections(&[1; 3 * PANEL], NonZeroUsize::MIN).unwrap();
        let of_one = table.plan.sampling.transform_bytes();
        let bytes = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| table.bytes())
        };
        assert_eq!(
            [2, 3, 4].map(|threads| bytes(threads) - bytes(1)),
            [of_one, 2 * of_one, 2 * of_one]
        );
    }

    #[test]
    fn no_value_exceeds_the_bound_of_its_part_and_no_bound_is_far_above() {
        for (steps, every) in [(100, 1), (4000, 1), (4000, 7)] {
            let solution = solution(steps);
            let nodes: Vec<usize> = (0..solution.links[0].mesh().nodes_m().len()).collect();
            for table in [
                solution.deflections(&nodes, NonZeroUsize::new(every).unwrap()).unwrap(),
                solution.displacements(&nodes, NonZeroUsize::new(every).unwrap()).unwrap(),
                solution
                    .displacements(&nodes, NonZeroUsize::new(every).unwrap())
                    .unwrap()
                    .in_blocks_of(333),
                solution.moments(&nodes[3..9], NonZeroUsize::new(every).unwrap()).unwrap(),
            ] {
                let (mut peak, mut highest) = (0.0_f64, 0.0_f64);
                for number in 0..table.blocks() {
                    let block = table.block(number, &Unwatched);
                    let mut next = block.rows.start;
                    for Part { rows, bound } in block.parts() {
                        let found = block.peak_of(&rows);
                        assert!(found <= bound, "{found} in {rows:?} above {bound}");
                        assert_eq!(rows.start, next);
                        next = rows.end;
                        (peak, highest) = (peak.max(found), highest.max(bound));
                    }
                    assert_eq!(next, block.rows.end);
                }
                assert!(highest < 3.0 * peak, "{highest} above {peak}");
            }
        }
    }

    #[test]
    fn the_peak_is_that_of_all_rows_unless_less_will_do() {
        let solution = solution(4000);
        let nodes: Vec<usize> = (0..solution.links[0].mesh().nodes_m().len()).collect();
        for table in [
            solution.displacements(&nodes, NonZeroUsize::MIN).unwrap(),
            solution.deflections(&nodes, NonZeroUsize::new(3).unwrap()).unwrap().in_blocks_of(200),
            solution.moments(&[], NonZeroUsize::MIN).unwrap(),
        ] {
            let all = table.histories().samples.iter().fold(0.0, |m, x| f64::max(m, largest(x)));
            let exact = table.peak(&Unwatched, |found, bound| found >= bound);
            assert_eq!(exact.to_bits(), f64::to_bits(all));
            let near = table.peak(&Unwatched, |found, bound| 4.0 * found >= bound);
            assert!((0.25 * all..=all).contains(&near), "{near} of {all}");
        }
    }

    #[test]
    fn a_bound_takes_the_very_first_and_last_row_of_its_part_in() {
        let mut spiked = solution(4000);
        let nodes: Vec<usize> = (0..spiked.links[0].mesh().nodes_m().len()).collect();
        for (row, every) in [(0, 1), (511, 1), (512, 1), (511, 7), (512, 7)] {
            spiked.joints[0].angle_rad.fill(0.0);
            spiked.joints[0].angle_rad[row * every] = -1e6;
            let table = spiked.displacements(&nodes, NonZeroUsize::new(every).unwrap()).unwrap();
            let block = table.block(0, &Unwatched);
            let mut above = 0;
            for Part { rows, bound } in block.parts() {
                let found = block.peak_of(&rows);
                assert!(found <= bound, "row {row}, every {every}: {found} above {bound}");
                above += usize::from(found > 1e5);
            }
            assert_eq!(above, 1, "row {row}, every {every}");
        }
    }
}
