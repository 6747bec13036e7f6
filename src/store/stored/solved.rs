//! A run of `solve` while it is still in memory: what reading its folder back would give.

use super::super::file_names::SUMMARY;
use super::super::run_tables::{OptionalTable, SolveOutputs};
use super::super::summary::Summary;
use super::summary::StoredSummary;
use crate::beam::NodalHistories;
use crate::csv::{InputFile, Place, TableError, time_format};
use crate::inverse::{NodalTable, Solution};
use crate::numeric::ThinnedGrid;
use crate::result::{StoredNodes, StoredResult, StoredRun, StoredSolution};

/// Copies of the histories of the nodes that a page holds at a time, besides those kept.
const COPIES: usize = 4;

impl SolveOutputs {
    /// Memory in bytes that a page of the run takes, about.
    pub fn page_bytes(&self, deflections: &NodalTable) -> usize {
        size_of::<f64>() * COPIES * deflections.nodes().len() * deflections.grid().len()
    }

    /// What reading back the files of a run gives, made of the run itself, with all digits.
    ///
    /// # Errors
    /// [`TableError`] for a summary that cannot be read back.
    pub fn stored(
        &self,
        (solution, deflections): (&Solution, &NodalTable),
        summary: &Summary,
    ) -> Result<StoredResult, TableError> {
        let bytes = summary.to_json().into_bytes();
        let file = InputFile { shown: SUMMARY.to_owned(), name: SUMMARY.to_owned(), bytes };
        let mut told = StoredSummary::read(&file)?;
        let place = Place { file: SUMMARY, line: None };
        let reading = |key: &str| {
            let missing = || place.refuse(format!("results.{key}"), "nothing", "must be there");
            told.results.get(key).ok_or_else(missing)
        };
        let grid = &solution.grid;
        let moving = told.motion.as_ref();
        let moving = moving.ok_or_else(|| place.refuse("motion", "nothing", "must be there"))?;
        let solved = StoredSolution {
            rigid_torque_n_m: solution.rigid_torque_n_m.clone(),
            rigid_hub_angle_rad: solution.rigid_hub_angle_rad.clone(),
            motor_torque_n_m: solution.motor.as_ref().map(|motor| motor.torque_n_m.clone()),
            moving_s: (moving.moves_from_s, moving.moves_until_s),
            lead_s: reading("lead_s")?,
            lag_s: reading("lag_s")?,
        };
        let moments = || solution.moments(deflections.nodes(), self.every).histories();
        let has_moments = self.optional.contains(&OptionalTable::BendingMoments);
        Ok(StoredResult::Run(Box::new(StoredRun {
            origin: told.origin(),
            link: solution.link().clone(),
            mesh: solution.mesh().clone(),
            kept_modes: told.analysis.as_ref().and_then(|analysis| analysis.modes),
            times_s: times_s(&grid.thinned(1)),
            torque_n_m: solution.torque_n_m.clone(),
            hub_angle_rad: solution.hub_angle_rad.clone(),
            tip: solution.tip.clone(),
            solved: Some(solved),
            deflections_m: Some(in_order(deflections.histories())),
            moments_n_m: has_moments.then(|| in_order(moments())),
            readings: told.take_readings(),
            checks: told.take_checks(),
            warnings: told.take_warnings(),
            remarks: told.take_remarks(),
        })))
    }
}

/// Histories with the nodes ascending, as a table is read back.
fn in_order(histories: NodalHistories) -> StoredNodes {
    let NodalHistories { nodes, grid, samples } = histories;
    let mut pairs: Vec<(usize, Vec<f64>)> = nodes.into_iter().zip(samples).collect();
    pairs.sort_by_key(|(node, _)| *node);
    let (nodes, histories) = pairs.into_iter().unzip();
    StoredNodes { nodes, times_s: times_s(&grid), histories }
}

/// Times in s as tables tell them, rounded.
fn times_s(grid: &ThinnedGrid) -> Vec<f64> {
    let format = time_format(|k| grid.time_s(k), grid.len());
    let told = |k: usize| {
        let mut text = Vec::new();
        format.write(&mut text, grid.time_s(k));
        std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok())
    };
    (0..grid.len()).map(|k| told(k).unwrap_or(grid.time_s(k))).collect()
}
