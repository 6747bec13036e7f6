//! The folder of a run, read back.

use super::super::file_names::{MOTOR, SUMMARY};
use super::folder::RunFolder;
use super::mesh::read_mesh;
use super::nodal::{Heading, deflections, read_nodal};
use super::numbers::{Numbers, ONE_RUN, is_same_time};
use super::summary::StoredSummary;
use crate::beam::Mesh;
use crate::csv::{InputFile, Place, TableError};
use crate::motion::TipMotionHistories;
use crate::result::{StoredNodes, StoredRun, StoredSolution};

const V_M: Heading = Heading { letter: "v", unit: "m" };
const W_M: Heading = Heading { letter: "w", unit: "m" };
const M_N_M: Heading = Heading { letter: "m", unit: "n_m" };

const MOTOR_COLUMNS: [&str; 4] =
    ["motor_torque_n_m", "motor_angle_rad", "motor_rate_rad_s", "motor_power_w"];

/// Reads all that a run has left.
pub(super) fn read_run(folder: RunFolder) -> Result<StoredRun, TableError> {
    let file = folder.file(SUMMARY)?;
    let mut summary = StoredSummary::read(&file)?;
    gathered(folder, &file, &mut summary).map_err(|error| summary.told(error))
}

fn gathered(
    folder: RunFolder,
    summary_file: &InputFile,
    summary: &mut StoredSummary,
) -> Result<StoredRun, TableError> {
    folder.check_named(&summary.files)?;
    let link = summary.link.clone().into_link(summary.title.clone(), summary.drive.clone());
    let place = Place { file: &summary_file.shown, line: None };
    let link = link.map_err(|error| place.refuse_whole(format!("link.{error}")))?;
    let mesh = read_mesh(&folder.file("nodes.csv")?, &link)?;

    let mut torque = Numbers::of(&folder.file("torque.csv")?, &["torque_n_m"])?;
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
        readings: summary.take_readings(),
        checks: summary.take_checks(),
        warnings: summary.take_warnings(),
        remarks: summary.take_remarks(),
    })
}

/// Refuses a torque over other times than those that the summary tells.
fn check_window(torque: &Numbers, summary: &StoredSummary) -> Result<(), TableError> {
    let solved = summary.analysis.as_ref().map(|w| (w.start_s, w.end_s));
    let played = summary.torque.as_ref().map(|played| (played.start_s, played.simulated_until_s));
    let Some((start_s, end_s)) = solved.or(played) else { return Ok(()) };
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
    fn table(&self, name: &str, columns: &[&str]) -> Result<Numbers, TableError> {
        let table = Numbers::of(&self.folder.file(name)?, columns)?;
        table.check_times(self.times_s, 1, "torque.csv")?;
        Ok(table)
    }

    fn hub(&self, is_solved: bool) -> Result<Numbers, TableError> {
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
        summary: &StoredSummary,
        hub: &mut Numbers,
        place: Place,
    ) -> Result<StoredSolution, TableError> {
        let mut rigid = self.table("rigid_torque.csv", &["rigid_torque_n_m"])?;
        let motor =
            self.folder.optional(MOTOR)?.map(|_| self.table(MOTOR, &MOTOR_COLUMNS)).transpose()?;
        let missing = |key: &str| place.refuse(key, "nothing", "must be there");
        let reading = |key: &str| {
            let found = summary.results.get(key);
            found.ok_or_else(|| missing(&format!("results.{key}")))
        };
        let moving = summary.motion.as_ref().ok_or_else(|| missing("motion"))?;
        Ok(StoredSolution {
            rigid_torque_n_m: rigid.take("rigid_torque_n_m"),
            rigid_hub_angle_rad: hub.take("rigid_hub_angle_rad"),
            motor_torque_n_m: motor.map(|mut motor| motor.take(MOTOR_COLUMNS[0])),
            moving_s: (moving.moves_from_s, moving.moves_until_s),
            lead_s: reading("lead_s")?,
            lag_s: reading("lag_s")?,
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
