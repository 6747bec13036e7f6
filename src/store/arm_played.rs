//! The files of an arm's simulation, and its summary.

use std::num::NonZeroUsize;

use serde_json::json;

use super::arm_run::{
    Table, arm_record, each, joint_angle, one, position, tip_table, torque, write_nodes,
};
use super::folder::{FolderError, OutputFolder};
use super::run_summary::tip_numbers;
use super::run_tables::{
    CHORD_ANGLES, JOINT_ANGLES, NODES, POSITIONS, RESULT_FILES, RunOutputs, SUMMARY, TIP, TORQUES,
};
use super::summary::{RunInputs, Summary};
use crate::csv::{Column, ColumnGroup, write_csv};
use crate::link::Arm;
use crate::response::{ArmPlay, ArmPlayWarning, PlayedArm};
use crate::result::{ArmPlayMetrics, StoredWarning, TipError};

/// A simulation of an arm, and what is known of it beside its numbers.
#[derive(Debug, Clone, Copy)]
pub struct PlayedRun<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// What was played.
    pub play: &'a ArmPlay<'a>,
    /// The motion.
    pub played: &'a PlayedArm,
    /// Its numbers.
    pub metrics: &'a ArmPlayMetrics,
    /// The tip against a target, if there is one.
    pub tip_error: Option<&'a TipError>,
    /// What the user must know.
    pub warnings: &'a [ArmPlayWarning],
    /// Nodes of each link: distances in m from its joint.
    pub nodes_m: &'a [Vec<f64>],
}

/// Names of the files, summary.json last.
const FILES: [&str; 7] = [TORQUES, JOINT_ANGLES, CHORD_ANGLES, TIP.0, NODES.0, POSITIONS, SUMMARY];

impl PlayedRun<'_> {
    /// Number of the files that [`RunOutputs::write_played`] writes.
    pub const FILES: usize = FILES.len();
}

impl RunOutputs {
    /// Writes the files of an arm's simulation into `folder`: all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write_played(
        &self,
        folder: OutputFolder,
        run: &PlayedRun<'_>,
        summary: &Summary,
    ) -> Result<(), FolderError> {
        let played = run.played;
        let mut angles = Table::new();
        for (number, [angle, rate, acceleration]) in (1..).zip(&played.joints) {
            angles.push(one(joint_angle(number), angle));
            angles.push(one(format!("joint{number}_rate_rad_s"), rate));
            angles.push(one(format!("joint{number}_acceleration_rad_s2"), acceleration));
        }
        let chords = (1..).zip(&played.chords_rad);
        let chords = chords.map(|(number, angle)| one(format!("angle{number}_rad"), angle));
        let all = played.grid.thinned(NonZeroUsize::MIN);
        for (name, table) in [
            (TORQUES, vec![each(torque, played.torques_n_m.iter())]),
            (JOINT_ANGLES, angles),
            (CHORD_ANGLES, chords.collect()),
            (TIP.0, tip_table(&played.tip)),
        ] {
            folder.file(name, |out| write_csv(out, &all, &table, self.digits))?;
        }
        let positions = played.positions_m(run.nodes_m, self.every);
        let mut columns = Vec::new();
        for (number, link) in (1..).zip(&positions) {
            for (node, place) in link.iter().enumerate() {
                let both = ["x", "y"]
                    .iter()
                    .zip(place)
                    .map(|(axis, values)| Column { name: position(axis, number, node), values });
                columns.extend(both);
            }
        }
        let thinned = played.grid.thinned(self.every);
        let nodal = vec![ColumnGroup { columns }];
        folder.file(POSITIONS, |out| write_csv(out, &thinned, &nodal, self.digits))?;
        folder.file(NODES.0, |out| write_nodes(out, run.arm, run.nodes_m.iter()))?;
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }
}

impl Summary {
    /// The summary of an arm's simulation.
    pub fn of_played_arm(inputs: RunInputs, run: &PlayedRun<'_>) -> Self {
        let PlayedRun { arm, play, played, metrics, tip_error, .. } = *run;
        let gains = play.feedback.iter().map(|own| {
            json!({
                "stiffness_n_m_rad": own.stiffness_n_m_rad(),
                "damping_n_m_s_rad": own.damping_n_m_s_rad(),
            })
        });
        let [tip_m, joint_rad] = played.change;
        let grid = &played.grid;
        let values = json!({
            "arm": arm_record(arm, run.nodes_m.iter().map(|nodes| nodes.len() - 1)),
            "torque": {
                "samples": grid.len,
                "start_s": grid.time_s(0),
                "end_s": grid.end_s(),
                "step_s": grid.step_s,
                "interpolation": play.interpolation,
            },
            "feedback": gains.collect::<Vec<_>>(),
            "elastica": { "angles": played.angles, "steps_per_sample": played.steps },
            "results": metrics,
            "errors": {
                "refinement": { "tip_m": tip_m, "joints_rad": joint_rad },
                "energy": played.imbalance(),
            },
            "tip_error": tip_error.map(tip_numbers),
        });
        let warning = |w: &ArmPlayWarning| StoredWarning::new(w.kind(), w, w.hint());
        let late = tip_error.and_then(|error| error.late);
        let late = late.map(|late| StoredWarning::new(late.kind(), &late, late.hint()));
        Self {
            values,
            warnings: run.warnings.iter().map(warning).chain(late).collect(),
            files: FILES.map(str::to_owned).into(),
            ..Self::titled("simulate", inputs, arm.title())
        }
    }
}
