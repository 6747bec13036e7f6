#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;
use std::sync::Arc;

use pulp::{Arch, Simd, WithSimd};

use super::solution::Solution;
use crate::motion::{TAIL_TERMS, TailTerms};
use crate::numeric::{PANEL, Sampling};

/// Bytes of a cache line of the processor, and of the widest vectors.
const LINE: usize = 64;

/// The samples that rows are computed from, panel by panel of [`PANEL`] nodes.
pub(super) struct PanelSamples {
    /// Those of all panels, after up to seven numbers that are not used.
    numbers: Vec<f64>,
    /// Index of the first sample, which begins a cache line.
    first: usize,
    /// Samples of a panel.
    pub(super) len: usize,
}

impl PanelSamples {
    /// Zeros for so many panels.
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

/// How the rows of a nodal table are computed from samples.
pub(super) struct RowPlan<'a> {
    pub(super) solution: &'a Solution,
    /// Numbers of the nodes, one a column.
    pub(super) nodes: Vec<usize>,
    /// Every how many samples there is a row.
    pub(super) every: usize,
    pub(super) sampling: Sampling,
    /// Distances x in m from the axis where the rigid rotation xθ is added.
    pub(super) arms_m: Option<Vec<f64>>,
    /// The slow tail of each node's deflection, where damping causes one.
    pub(super) tails: Option<Vec<TailTerms>>,
}

/// Some rows of a [`NodalTable`](super::NodalTable).
pub struct NodalBlock<'a> {
    pub(super) plan: &'a RowPlan<'a>,
    pub(super) rows: Range<usize>,
    pub(super) samples: Arc<PanelSamples>,
}

impl RowPlan<'_> {
    /// Panels of [`PANEL`] nodes; the last may have fewer.
    pub(super) fn panels(&self) -> usize {
        self.nodes.len().div_ceil(PANEL)
    }
}

impl NodalBlock<'_> {
    /// Numbers of these rows in the table.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// Writes some of the rows into `values`, one after the other.
    ///
    /// # Panics
    /// If the block does not hold the rows, or `values` has not their size.
    pub fn write_rows(&self, rows: Range<usize>, values: &mut [f64]) {
        let width = self.plan.nodes.len();
        assert_eq!(values.len(), rows.len() * width, "{rows:?} of {width} nodes");
        assert!(self.rows.start <= rows.start && rows.end <= self.rows.end, "{rows:?}");
        Arch::new().dispatch(WriteRows { block: self, range: rows, values });
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
            plan.solution.period.images().history(0)
        });
        for row in rows.start..rows.end {
            let mut sum = plan.sampling.row(&self.rows, samples, row);
            if let Some(images) = images {
                let sample = plan.solution.grid.in_period(row * plan.every, images.len());
                for (tail, image) in tails.iter().zip(&images[sample]) {
                    for channel in 0..PANEL {
                        sum[channel] -= tail[channel] * image;
                    }
                }
            }
            if plan.arms_m.is_some() {
                let angle_rad = plan.solution.hub_angle_rad[row * plan.every];
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
