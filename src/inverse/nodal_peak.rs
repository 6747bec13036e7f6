//! The peak of a table, sought where it may be.

use std::ops::Range;

use rayon::prelude::*;

use super::nodal_block::NodalBlock;
use super::nodal_table::NodalTable;
use super::watch::Watch;
use crate::motion::{TAIL_TERMS, TailTerms};
use crate::numeric::largest;

/// Rows that are looked through at a time by one thread.
const ROWS_AT_ONCE: usize = 64;

/// Parts of so many rows that are looked through before it is asked whether that is enough: a count
/// that does not depend on the threads.
const PARTS_AT_ONCE: usize = 8;

/// Samples held of which the largest is known.
const TILE: usize = 16;

/// What the bounds are raised by: far more than all rounding of a sum, far less than matters.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Some rows and what none of their values exceeds.
struct Part {
    rows: Range<usize>,
    bound: f64,
}

impl NodalTable<'_> {
    /// What no value loses to the images of the motion in other periods.
    fn largest_images(&self) -> f64 {
        let Some(tails) = &self.tails else { return 0.0 };
        let history = self.solution.period.images().history(0);
        let most =
            |all: &[TailTerms], m: usize| all.iter().fold(0.0, |most: f64, t| most.max(t[m].abs()));
        (0..TAIL_TERMS).map(|m| most(tails, m) * most(history, m)).sum()
    }

    /// Largest absolute value of all, NaN left out, or a smaller one of them that will do.
    ///
    /// `will_do` is asked whether a value that was found is good enough where no other exceeds a
    /// bound, which may be infinite or NaN: most rows then need not be made.
    pub fn peak(&self, watch: &dyn Watch, will_do: impl Fn(f64, f64) -> bool) -> f64 {
        (0..self.blocks()).fold(0.0, |mut found, number| {
            let block = self.block(number, watch);
            let mut parts = block.parts();
            parts.sort_by(|a, b| b.bound.total_cmp(&a.bound));
            for parts in parts.chunks(PARTS_AT_ONCE) {
                if will_do(found, parts[0].bound) {
                    break;
                }
                let peaks = parts.par_iter().map(|part| block.peak_of(&part.rows));
                found = f64::max(found, peaks.reduce(|| 0.0, f64::max));
            }
            found
        })
    }
}

impl NodalBlock<'_> {
    fn peak_of(&self, rows: &Range<usize>) -> f64 {
        let mut values = vec![0.0; rows.len() * self.table.nodes.len()];
        self.write_rows(rows.clone(), &mut values);
        largest(&values)
    }

    /// All rows, each part with a bound: a row is a weighted sum of the samples held and the rigid
    /// rotation times an arm.
    fn parts(&self) -> Vec<Part> {
        let NodalTable { solution, sampling, every, arms_m, .. } = self.table;
        let tiles = self.largest_of_tiles();
        let farthest_m = arms_m.as_deref().map(largest);
        let images = self.table.largest_images();
        let bound = |rows: &Range<usize>| {
            let held = sampling.taken(&self.rows, rows);
            let tiles = &tiles[held.start / TILE..held.end.div_ceil(TILE)];
            let bending = sampling.gain() * largest(tiles) + images;
            let rotation = farthest_m.map_or(0.0, |arm_m| {
                let angles = &solution.hub_angle_rad[rows.start * every..];
                let samples = (rows.len() - 1) * every + 1;
                arm_m * largest(&angles[..samples])
            });
            (bending + rotation) * ROUNDING
        };
        let starts = self.rows.clone().step_by(ROWS_AT_ONCE);
        let parts = starts.map(|start| {
            let rows = start..self.rows.end.min(start + ROWS_AT_ONCE);
            Part { bound: bound(&rows), rows }
        });
        parts.collect()
    }

    /// The largest of so many samples held at a time, all nodes together.
    fn largest_of_tiles(&self) -> Vec<f64> {
        let (held, len) = (self.held.samples(), self.held.len);
        let of_tile = |tile: usize| {
            let (start, end) = (tile * TILE, len.min((tile + 1) * TILE));
            let panels = (0..self.table.panels()).map(|panel| panel * len);
            let of_panel = |first: usize| largest(held[first + start..first + end].as_flattened());
            panels.map(of_panel).fold(0.0, f64::max)
        };
        (0..len.div_ceil(TILE)).into_par_iter().with_min_len(8).map(of_tile).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inverse::Unwatched;
    use crate::inverse::nodal_block::Held;
    use crate::inverse::tests::solution;
    use crate::numeric::CHANNELS;

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
        for (row, every) in [(0, 1), (63, 1), (64, 1), (127, 7), (128, 7)] {
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

    #[test]
    fn every_sample_held_counts_in_its_own_tile_and_no_other() {
        let solution = solution(4000);
        let table = solution.moments(&[0; CHANNELS + 3], 1);
        let (panels, len) = (table.panels(), 3 * TILE + 5);
        for (panel, sample) in [(0, 0), (1, 15), (0, 16), (1, 47), (0, 48), (1, 52)] {
            let mut held = Held::zeros(panels, len);
            held.samples_mut()[panel * len + sample][2] = -7.0;
            let held = std::sync::Arc::new(held);
            let tiles = NodalBlock { table: &table, rows: 0..9, held }.largest_of_tiles();
            let expected: Vec<f64> =
                (0..4).map(|tile| if tile == sample / TILE { 7.0 } else { 0.0 }).collect();
            assert_eq!(tiles, expected, "sample {sample} of panel {panel}");
        }
    }
}
