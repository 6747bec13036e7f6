//! Rows of a nodal table: computed from samples, and bounded from above. The peak decides the decimals before
//! the first row is written; computing every row twice would take a fifth longer.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::solution::{LinkSpectra, Solution};
use crate::motion::{TAIL_TERMS, TailTerms};
use crate::numeric::{PANEL, Sampling, ThinnedGrid, largest};
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
pub(super) struct PanelSamples {
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

    pub(super) fn samples_mut(&mut self) -> &mut [[f64; PANEL]] {
        self.numbers[self.first..].as_chunks_mut().0
    }
}

/// Computation of a nodal table's rows from samples.
pub(super) struct RowPlan<'a> {
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
    pub(super) plan: &'a RowPlan<'a>,
    pub(super) rows: Range<usize>,
    pub(super) samples: Arc<PanelSamples>,
}

impl RowPlan<'_> {
    /// Panels of [`PANEL`] nodes; the last may have fewer.
    pub(super) fn panels(&self) -> usize {
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

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;

    use super::*;
    use crate::inverse::Unwatched;
    use crate::inverse::tests::solution;

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
