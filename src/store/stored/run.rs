//! A run of `solve` or `simulate`: read from its folder, or taken from memory before it is written.

use super::super::file_names::{MOTOR, SUMMARY};
use super::super::json::newer;
use super::super::run_tables::{OptionalTable, SolveOutputs};
use super::super::summary::Summary;
use super::folder::RunFolder;
use super::tables::{Heading, ONE_RUN, Table, deflections, is_same_time, read_mesh, read_nodal};
use crate::beam::{Mesh, NodalHistories};
use crate::csv::{InputFile, Place, TableError, time_format};
use crate::inverse::{NodalTable, Solution};
use crate::motion::TipMotionHistories;
use crate::numeric::ThinnedGrid;
use crate::result::{StoredNodes, StoredResult, StoredRun, StoredSolution};

const V_M: Heading = Heading { letter: "v", unit: "m" };
const W_M: Heading = Heading { letter: "w", unit: "m" };
const M_N_M: Heading = Heading { letter: "m", unit: "n_m" };

const MOTOR_COLUMNS: [&str; 4] =
    ["motor_torque_n_m", "motor_angle_rad", "motor_rate_rad_s", "motor_power_w"];

/// Reads all that a run has left.
pub(super) fn read_run(folder: RunFolder) -> Result<StoredRun, TableError> {
    let file = folder.file(SUMMARY)?;
    let summary = Summary::read(&file)?;
    gathered(folder, &file, &summary).map_err(|error| newer(error, &summary.flexlink))
}

fn gathered(
    folder: RunFolder,
    summary_file: &InputFile,
    summary: &Summary,
) -> Result<StoredRun, TableError> {
    folder.check_named(&summary.files)?;
    let place = Place { file: &summary_file.shown, line: None };
    let link = summary.link().map_err(|error| place.refuse_whole(format!("link.{error}")))?;
    let mesh = read_mesh(&folder.file("nodes.csv")?, &link)?;

    let mut torque = Table::of(&folder.file("torque.csv")?, &["torque_n_m"])?;
    torque.check_even()?;
    check_window(&torque, summary)?;
    let histories = Histories { folder, times_s: torque.times_s() };
    let is_solved = summary.command == "solve";
    let mut hub = histories.hub(is_solved)?;
    let tip = histories.tip()?;
    let solved = is_solved.then(|| histories.solution(summary, &mut hub, place)).transpose()?;
    let hub_angle_rad = hub.take("hub_angle_rad");
    let deflections_m = histories.deflections(&mesh, &hub_angle_rad)?;
    let moments_n_m = histories.nodal("bending_moments.csv", M_N_M, &mesh)?;
    Ok(StoredRun {
        origin: summary.origin(),
        kept_modes: summary.analysis.as_ref().and_then(|analysis| analysis.modes),
        torque_n_m: torque.take("torque_n_m"),
        times_s: torque.take("time_s"),
        link,
        mesh,
        hub_angle_rad,
        tip,
        solved,
        deflections_m,
        moments_n_m,
        readings: summary.readings(),
        checks: summary.checks(),
        warnings: summary.warnings.clone(),
        remarks: summary.remarks.clone().unwrap_or_default(),
    })
}

/// Refuses a torque over other times than those of the summary.
fn check_window(torque: &Table, summary: &Summary) -> Result<(), TableError> {
    let Some((start_s, end_s)) = summary.window_s() else { return Ok(()) };
    let times_s = torque.times_s();
    let last = times_s.len() - 1;
    for (row, expected_s) in [(0, start_s), (last, end_s)] {
        if !is_same_time(times_s[row], expected_s, times_s) {
            let must = format!("must be {expected_s} s as in summary.json: {ONE_RUN}");
            let found = format!("{} s", times_s[row]);
            return Err(torque.refuse(Some(row), "time_s", &found, &must));
        }
    }
    Ok(())
}

/// The tables of a folder, all over the times of its torque.csv.
#[derive(Debug, Clone, Copy)]
struct Histories<'a> {
    folder: RunFolder<'a>,
    times_s: &'a [f64],
}

impl Histories<'_> {
    fn table(&self, name: &str, columns: &[&str]) -> Result<Table, TableError> {
        let table = Table::of(&self.folder.file(name)?, columns)?;
        table.check_times(self.times_s, 1, "torque.csv")?;
        Ok(table)
    }

    fn hub(&self, is_solved: bool) -> Result<Table, TableError> {
        let own = ["hub_angle_rad", "hub_rate_rad_s", "hub_acceleration_rad_s2"];
        let rigid = is_solved.then_some("rigid_hub_angle_rad");
        let columns: Vec<&str> = own.into_iter().chain(rigid).collect();
        self.table("hub_angle.csv", &columns)
    }

    fn tip(&self) -> Result<TipMotionHistories, TableError> {
        let columns = ["tip_displacement_m", "tip_velocity_m_s", "tip_acceleration_m_s2"];
        let mut tip = self.table("tip.csv", &columns)?;
        let [displacement_m, velocity_m_s, acceleration_m_s2] = columns.map(|name| tip.take(name));
        Ok(TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 })
    }

    fn solution(
        &self,
        summary: &Summary,
        hub: &mut Table,
        place: Place,
    ) -> Result<StoredSolution, TableError> {
        let mut rigid = self.table("rigid_torque.csv", &["rigid_torque_n_m"])?;
        let motor =
            self.folder.optional(MOTOR)?.map(|_| self.table(MOTOR, &MOTOR_COLUMNS)).transpose()?;
        let (moving_s, lead_s, lag_s) = timing(summary, place)?;
        Ok(StoredSolution {
            rigid_torque_n_m: rigid.take("rigid_torque_n_m"),
            rigid_hub_angle_rad: hub.take("rigid_hub_angle_rad"),
            motor_torque_n_m: motor.map(|mut motor| motor.take(MOTOR_COLUMNS[0])),
            moving_s,
            lead_s,
            lag_s,
        })
    }

    fn nodal(
        &self,
        name: &str,
        heading: Heading,
        mesh: &Mesh,
    ) -> Result<Option<StoredNodes>, TableError> {
        let file = self.folder.optional(name)?;
        file.map(|file| read_nodal(&file, heading, mesh, self.times_s)).transpose()
    }

    /// Deflections as they are written, or else by the displacements.
    fn deflections(
        &self,
        mesh: &Mesh,
        hub_angle_rad: &[f64],
    ) -> Result<Option<StoredNodes>, TableError> {
        let written = self.nodal("nodal_deflections.csv", W_M, mesh)?;
        let displacements = self.nodal("nodal_displacements.csv", V_M, mesh)?;
        Ok(written.or_else(|| Some(deflections(displacements?, mesh, hub_angle_rad, self.times_s))))
    }
}

/// From a summary of `solve`, in s: start and end of the tip's motion, lead and lag of the torque.
fn timing(summary: &Summary, place: Place) -> Result<((f64, f64), f64, f64), TableError> {
    let missing = |key: &str| place.refuse(key, "nothing", "must be there");
    let result =
        |key: &str| summary.results.get(key).ok_or_else(|| missing(&format!("results.{key}")));
    let motion = summary.motion.as_ref().ok_or_else(|| missing("motion"))?;
    Ok(((motion.moves_from_s, motion.moves_until_s), result("lead_s")?, result("lag_s")?))
}

/// Copies of the nodes' histories that making a page holds at a time.
const COPIES: usize = 4;

impl SolveOutputs {
    /// Approximate memory in bytes that making a page of the run takes.
    pub fn page_bytes(&self, deflections: &NodalTable) -> usize {
        size_of::<f64>() * COPIES * deflections.nodes().len() * deflections.grid().len()
    }

    /// The run as reading back its files gives it, but with all digits.
    ///
    /// # Errors
    /// [`TableError`] for a summary that is not one of `solve`.
    pub fn stored(
        &self,
        (solution, deflections): (&Solution, &NodalTable),
        summary: &Summary,
    ) -> Result<StoredResult, TableError> {
        let (moving_s, lead_s, lag_s) = timing(summary, Place { file: SUMMARY, line: None })?;
        let solved = StoredSolution {
            rigid_torque_n_m: solution.rigid_torque_n_m.clone(),
            rigid_hub_angle_rad: solution.rigid_hub_angle_rad.clone(),
            motor_torque_n_m: solution.motor.as_ref().map(|motor| motor.torque_n_m.clone()),
            moving_s,
            lead_s,
            lag_s,
        };
        let moments = || solution.moments(deflections.nodes(), self.every).histories();
        let has_moments = self.optional.contains(&OptionalTable::BendingMoments);
        Ok(StoredResult::Run(Box::new(StoredRun {
            origin: summary.origin(),
            link: solution.link().clone(),
            mesh: solution.mesh().clone(),
            kept_modes: summary.analysis.as_ref().and_then(|analysis| analysis.modes),
            times_s: times_s(&solution.grid.thinned(1)),
            torque_n_m: solution.torque_n_m.clone(),
            hub_angle_rad: solution.hub_angle_rad.clone(),
            tip: solution.tip.clone(),
            solved: Some(solved),
            deflections_m: Some(in_order(deflections.histories())),
            moments_n_m: has_moments.then(|| in_order(moments())),
            readings: summary.readings(),
            checks: summary.checks(),
            warnings: summary.warnings.clone(),
            remarks: summary.remarks.clone().unwrap_or_default(),
        })))
    }
}

/// Histories with the nodes ascending, as a table is read.
fn in_order(histories: NodalHistories) -> StoredNodes {
    let NodalHistories { nodes, grid, samples } = histories;
    let mut pairs: Vec<(usize, Vec<f64>)> = nodes.into_iter().zip(samples).collect();
    pairs.sort_by_key(|(node, _)| *node);
    let (nodes, histories) = pairs.into_iter().unzip();
    StoredNodes { nodes, times_s: times_s(&grid), histories }
}

/// Times in s rounded as in tables.
fn times_s(grid: &ThinnedGrid) -> Vec<f64> {
    let format = time_format(|k| grid.time_s(k), grid.len());
    let written = |k: usize| {
        let mut text = Vec::new();
        format.write(&mut text, grid.time_s(k));
        std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok())
    };
    (0..grid.len()).map(|k| written(k).unwrap_or(grid.time_s(k))).collect()
}
