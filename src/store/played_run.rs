//! The files of simulations, of a link and of an arm, and the summary of an arm's.

use std::num::NonZeroUsize;

use serde_json::{Value, json};

use super::arm_run::{
    Table, arm_record, each, joint_angle, one, position, tip_table, torque, write_nodes,
};
use super::folder::{FolderError, OutputFolder};
use super::run_summary::{played_results, tip_numbers};
use super::run_tables::{
    CHORD_ANGLES, DISPLACEMENTS, ERROR, HUB_ANGLE, JOINT_ANGLES, NODES, PLAYED_HUB, POSITIONS,
    RESULT_FILES, RunOutputs, SUMMARY, TIP, TIP_ERROR, TORQUE, TORQUES, WANTED, WANTED_PLACE,
    finish, groups,
};
use super::summary::{RunInputs, Summary};
use crate::csv::{Column, ColumnGroup, group, write_csv};
use crate::link::{Arm, Link};
use crate::response::{ArmPlay, ArmPlayWarning, PlayedArm, Simulation};
use crate::result::{FollowedTarget, Limits, Notice, PlayedMetrics};

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
    pub metrics: &'a PlayedMetrics,
    /// Limits of each joint.
    pub limits: &'a [Limits],
    /// The tip beside its target, if there is one.
    pub target: Option<&'a FollowedTarget>,
    /// What the user must know.
    pub warnings: &'a [ArmPlayWarning],
    /// Nodes of each link: distances in m from its joint.
    pub nodes_m: &'a [Vec<f64>],
}

/// Names of the files that every simulation has beside summary.json.
const FILES: [&str; 6] = [TORQUES, JOINT_ANGLES, CHORD_ANGLES, TIP.0, NODES.0, POSITIONS];

impl PlayedRun<'_> {
    /// Names of the files that [`RunOutputs::write_played`] writes, summary.json last.
    pub fn file_names(&self) -> Vec<&'static str> {
        FILES.into_iter().chain(self.target.map(|_| TIP_ERROR)).chain([SUMMARY]).collect()
    }
}

impl RunOutputs {
    /// Names of the files of a simulation, with a target or without, summary.json last.
    pub fn simulation_file_names(target: Option<&FollowedTarget>) -> Vec<&'static str> {
        let compared = target.map(|_| TIP_ERROR);
        let all = [TORQUE.0, TIP.0, HUB_ANGLE, DISPLACEMENTS.file, NODES.0].into_iter();
        all.chain(compared).chain([SUMMARY]).collect()
    }

    /// Writes the wanted tip of a simulation and its error.
    fn write_target(
        &self,
        folder: &OutputFolder,
        target: &FollowedTarget,
        wanted: &[&str],
    ) -> Result<(), FolderError> {
        let FollowedTarget { grid, wanted_m, error_m, .. } = target;
        let columns = wanted.iter().zip(wanted_m).chain([(&ERROR, error_m)]);
        let columns = columns.map(|(name, values)| group([(*name, &values[..])]));
        let (time, columns) = (grid.thinned(NonZeroUsize::MIN), columns.collect::<Vec<_>>());
        folder.file(TIP_ERROR, |out| write_csv(out, &time, &columns, self.digits))
    }

    /// Memory in bytes of the nodal table of a simulation.
    pub fn simulation_bytes(&self, simulation: &Simulation) -> usize {
        size_of::<f64>()
            * self.nodes_of(simulation.mesh.nodes_m()).len()
            * simulation.grid.len.div_ceil(self.every.get())
    }

    /// Writes the files of a simulation into `folder`: all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written: the nodal table, if the mesh has not all
    /// of its nodes.
    pub fn write_simulation(
        &self,
        folder: OutputFolder,
        (link, simulation): (&Link, &Simulation),
        (target, summary): (Option<&FollowedTarget>, &Summary),
    ) -> Result<(), FolderError> {
        let Simulation { tip, hub_angle_rad, hub_rate_rad_s, .. } = simulation;
        let hub = [hub_angle_rad, hub_rate_rad_s, &simulation.hub_acceleration_rad_s2];
        let tip = [&tip.displacement_m, &tip.velocity_m_s, &tip.acceleration_m_s2];
        let nodes = self.nodes_of(simulation.mesh.nodes_m());
        let nodal = simulation.displacements_m(&nodes, self.every);
        let nodal = nodal.map_err(|error| folder.refused(DISPLACEMENTS.file, error))?;
        let named = nodal.nodes.iter().map(|node| DISPLACEMENTS.column(*node)).zip(&nodal.samples);
        let columns = named.map(|(name, values)| Column { name, values });
        let displacements = vec![ColumnGroup { columns: columns.collect() }];
        let all = simulation.grid.thinned(NonZeroUsize::MIN);
        for (name, time, groups) in [
            (TORQUE.0, &all, groups(TORQUE.1, [&simulation.torque_n_m])),
            (TIP.0, &all, groups(TIP.1, tip)),
            (HUB_ANGLE, &all, groups(PLAYED_HUB, hub)),
            (DISPLACEMENTS.file, &nodal.grid, displacements),
        ] {
            folder.file(name, |out| write_csv(out, time, &groups, self.digits))?;
        }
        target.map_or(Ok(()), |target| self.write_target(&folder, target, &WANTED))?;
        finish(folder, (link, &simulation.mesh), summary)
    }

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
        run.target.map_or(Ok(()), |target| self.write_target(&folder, target, &WANTED_PLACE))?;
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }
}

impl Summary {
    /// The summary of an arm's simulation.
    pub fn of_played_arm(inputs: RunInputs, run: &PlayedRun<'_>) -> Self {
        let PlayedRun { arm, play, played, metrics, target, .. } = *run;
        let tip_error = target.map(|target| &target.tip_error);
        let gains = play.feedback.iter().map(|own| {
            json!({
                "stiffness_n_m_rad": own.stiffness_n_m_rad(),
                "damping_n_m_s_rad": own.damping_n_m_s_rad(),
            })
        });
        let [tip_m, joint_rad] = played.change;
        let grid = &played.grid;
        let mut values = json!({
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
            "results": played_results(metrics),
            "errors": {
                "refinement": { "tip_m": tip_m, "joints_rad": joint_rad },
                "energy": played.imbalance(),
            },
            "tip_error": tip_error.map(tip_numbers),
        });
        let limits: Vec<Option<Value>> = run.limits.iter().map(Limits::stored).collect();
        if limits.iter().any(Option::is_some) {
            values["limits"] = json!(limits);
        }
        let exceeded = metrics.exceeded(run.limits);
        let exceeded = exceeded.iter().map(Notice::from);
        let late = tip_error.and_then(|error| error.late);
        let late = late.map(Notice::from);
        Self {
            values,
            warnings: run.warnings.iter().map(Notice::from).chain(late).chain(exceeded).collect(),
            files: run.file_names().into_iter().map(str::to_owned).collect(),
            ..Self::titled("simulate", inputs, arm.title())
        }
    }
}
