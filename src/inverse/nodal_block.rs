#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;
use std::sync::Arc;

use pulp::{Arch, Simd, WithSimd};

use super::nodal_table::NodalTable;
use crate::motion::TAIL_TERMS;
use crate::numeric::CHANNELS;

/// Bytes of a line of the processors' caches, and of the widest vectors.
const LINE: usize = 64;

/// Samples that rows are made of, panel by panel of [`CHANNELS`] nodes.
pub(super) struct Held {
    /// Those of all panels, with some spare ones before them.
    numbers: Vec<f64>,
    /// Number of the first of them, which begins a line of cache.
    first: usize,
    /// Samples of a panel.
    pub(super) len: usize,
}

impl Held {
    /// Zeros for so many panels.
    pub(super) fn zeros(panels: usize, len: usize) -> Self {
        // No vector of them lies across two lines, which takes half as long again to read.
        let most = LINE / size_of::<f64>() - 1;
        let numbers = vec![0.0; most + panels * len * CHANNELS];
        let first = numbers.as_ptr().align_offset(LINE).min(most);
        Self { numbers, first, len }
    }

    /// The samples of all panels, one panel after the other.
    pub(super) fn samples(&self) -> &[[f64; CHANNELS]] {
        self.numbers[self.first..].as_chunks().0
    }

    pub(super) fn samples_mut(&mut self) -> &mut [[f64; CHANNELS]] {
        self.numbers[self.first..].as_chunks_mut().0
    }
}

/// Some rows of a [`NodalTable`], ready to be written.
pub struct NodalBlock<'a> {
    pub(super) table: &'a NodalTable<'a>,
    pub(super) rows: Range<usize>,
    pub(super) held: Arc<Held>,
}

impl NodalBlock<'_> {
    /// Which rows these are.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// Writes some of the rows into `values`, one after the other.
    ///
    /// # Panics
    /// If the block does not hold the rows, or `values` has not their size.
    pub fn write_rows(&self, rows: Range<usize>, values: &mut [f64]) {
        let width = self.table.nodes.len();
        assert_eq!(values.len(), rows.len() * width, "{rows:?} of {width} nodes");
        assert!(self.rows.start <= rows.start && rows.end <= self.rows.end, "{rows:?}");
        Arch::new().dispatch(WriteRows { block: self, range: rows, values });
    }

    /// Writes the columns from `column` on.
    #[inline(always)]
    fn write_panel(
        &self,
        rows: &Range<usize>,
        held: &[[f64; CHANNELS]],
        column: usize,
        values: &mut [f64],
    ) {
        let table = self.table;
        let width = table.nodes.len();
        let columns = column..width.min(column + CHANNELS);
        let mut arms_m = [0.0; CHANNELS];
        if let Some(all) = &table.arms_m {
            arms_m[..columns.len()].copy_from_slice(&all[columns.clone()]);
        }
        let mut tails = [[0.0; CHANNELS]; TAIL_TERMS];
        let images = table.tails.as_ref().map(|all| {
            for (channel, tail) in all[columns.clone()].iter().enumerate() {
                for (row, s) in tails.iter_mut().zip(tail) {
                    row[channel] = *s;
                }
            }
            table.solution.period.images().history(0)
        });
        for row in rows.start..rows.end {
            let mut sum = table.sampling.row(&self.rows, held, row);
            if let Some(images) = images {
                let sample = table.solution.grid.in_period(row * table.every, images.len());
                for (tail, image) in tails.iter().zip(&images[sample]) {
                    for channel in 0..CHANNELS {
                        sum[channel] -= tail[channel] * image;
                    }
                }
            }
            if table.arms_m.is_some() {
                let angle_rad = table.solution.hub_angle_rad[row * table.every];
                for channel in 0..CHANNELS {
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

/// The work of [`NodalBlock::write_rows`], for the processor's own vectors.
struct WriteRows<'a> {
    block: &'a NodalBlock<'a>,
    range: Range<usize>,
    values: &'a mut [f64],
}

impl WithSimd for WriteRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (samples, len) = (self.block.held.samples(), self.block.held.len);
        for panel in 0..self.block.table.panels() {
            let held = &samples[panel * len..][..len];
            self.block.write_panel(&self.range, held, panel * CHANNELS, self.values);
        }
    }
}
