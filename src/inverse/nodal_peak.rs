//! The peak of a nodal table, from as few of its rows as possible: it decides the decimals before the
//! first row is written, and computing every row twice takes a fifth longer.

use std::ops::Range;

use rayon::prelude::*;

use super::analysis::Watch;
use super::nodal_rows::{NodalBlock, RowPlan};
use super::nodal_table::NodalTable;
use crate::motion::{TAIL_TERMS, TailTerms};
use crate::numeric::{PANEL, largest};

/// Rows of a part, which has one bound.
const PART_ROWS: usize = 512;

/// Rows of a part that one thread computes at a time.
const ROWS_AT_ONCE: usize = 64;

/// Factor of all bounds, far above the rounding of a sum.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Some rows and an upper bound of their absolute values.
struct Part {
    rows: Range<usize>,
    bound: f64,
}

impl NodalTable<'_> {
    /// Largest absolute value of all rows, NaN left out, or a smaller value of them that is enough.
    ///
    /// `is_enough` gets the largest value found and a bound of the rows not computed, infinite or NaN
    /// if there is none; if it returns true, these rows of the block are not computed.
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
}

impl RowPlan<'_> {
    /// Upper bound of what the images of the motion in other periods subtract from a value.
    fn largest_images(&self) -> f64 {
        let Some(tails) = &self.tails else { return 0.0 };
        let history = self.solution.period.images().history(0);
        let most =
            |all: &[TailTerms], m: usize| all.iter().fold(0.0, |most: f64, t| most.max(t[m].abs()));
        (0..TAIL_TERMS).map(|m| most(tails, m) * most(history, m)).sum()
    }
}

impl NodalBlock<'_> {
    fn peak_of(&self, rows: &Range<usize>) -> f64 {
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
    fn parts(&self) -> Vec<Part> {
        let RowPlan { solution, sampling, every, arms_m, .. } = self.plan;
        let farthest_m = arms_m.as_deref().map(largest);
        let images = self.plan.largest_images();
        let bound = |rows: &Range<usize>| {
            let bending = sampling.gain() * self.largest_sample(rows) + images;
            let rotation = farthest_m.map_or(0.0, |arm_m| {
                let angles = &solution.hub_angle_rad[rows.start * every..];
                let samples = (rows.len() - 1) * every + 1;
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

    /// The largest of all nodes' samples that these rows are computed from.
    fn largest_sample(&self, rows: &Range<usize>) -> f64 {
        let taken = self.plan.sampling.taken(&self.rows, rows);
        let panels = self.samples.samples().chunks(self.samples.len.max(1));
        let of_panel = |panel: &[[f64; PANEL]]| largest(panel[taken.clone()].as_flattened());
        panels.map(of_panel).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inverse::Unwatched;
    use crate::inverse::tests::solution;

    #[test]
    fn no_value_exceeds_the_bound_of_its_part_and_no_bound_is_far_above() {
        for (steps, every) in [(100, 1), (4000, 1), (4000, 7)] {
            let solution = solution(steps);
            let nodes: Vec<usize> = (0..solution.mesh().nodes_m().len()).collect();
            for table in [
                solution.deflections(&nodes, every),
                solution.displacements(&nodes, every),
                solution.displacements(&nodes, every).in_blocks_of(333),
                solution.moments(&nodes[3..9], every),
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
        let nodes: Vec<usize> = (0..solution.mesh().nodes_m().len()).collect();
        for table in [
            solution.displacements(&nodes, 1),
            solution.deflections(&nodes, 3).in_blocks_of(200),
            solution.moments(&[], 1),
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
        let nodes: Vec<usize> = (0..spiked.mesh().nodes_m().len()).collect();
        for (row, every) in [(0, 1), (511, 1), (512, 1), (511, 7), (512, 7)] {
            spiked.hub_angle_rad.fill(0.0);
            spiked.hub_angle_rad[row * every] = -1e6;
            let table = spiked.displacements(&nodes, every);
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
