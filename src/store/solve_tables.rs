//! The files of `solve`: every column's name and unit, once.

use rayon::prelude::*;

use super::folder::{FolderError, OutputFolder};
use super::histories::{MOTOR, REPORT, RESULT_FILES, SUMMARY, tip_groups, write_nodes};
use super::summary::Summary;
use crate::csv::{ColumnGroup, Digits, group, write_csv, write_nodal};
use crate::inverse::{MotorHistories, NodalTable, Solution, Watch};
use crate::link::Link;

/// Which results to write, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveOutputs {
    /// Nodes of the nodal tables; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// Every how many samples the nodal tables have a row, at least 1.
    pub every: usize,
    /// Tables beyond those that are always written.
    pub optional: Vec<OptionalTable>,
    /// Digits of all numbers.
    pub digits: Digits,
}

/// A table that is written on demand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionalTable {
    /// `nodal_deflections.csv`: deflection w from the hub's tangent line.
    NodalDeflections,
    /// `bending_moments.csv`.
    BendingMoments,
}

impl OptionalTable {
    fn file_name(self) -> &'static str {
        match self {
            Self::NodalDeflections => "nodal_deflections.csv",
            Self::BendingMoments => "bending_moments.csv",
        }
    }
}

impl SolveOutputs {
    /// Names of the files that will be written of a link, summary.json last.
    pub fn file_names(&self, link: &Link) -> Vec<&'static str> {
        let optional = [OptionalTable::NodalDeflections, OptionalTable::BendingMoments];
        let wanted = |name: &&str| {
            let table = optional.into_iter().find(|table| table.file_name() == *name);
            let is_driven = *name != MOTOR || link.drive().is_some();
            is_driven && *name != REPORT && table.is_none_or(|table| self.optional.contains(&table))
        };
        RESULT_FILES.into_iter().filter(wanted).chain([SUMMARY]).collect()
    }

    /// Writes the files of a solution into `folder` and gives them their names, all or none, the
    /// `page` of the run among them, where there is one; its deflections are those of
    /// [`Self::deflections`], and `watch` gets the progress of the nodal tables.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(
        &self,
        folder: OutputFolder,
        link: &Link,
        (solution, deflections): (&Solution, NodalTable),
        (summary, page): (&Summary, Option<&str>),
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        // Alone, because these histories are made for their table only, and then dropped.
        if let Some(motor) = solution.motor() {
            let (time, groups) = (solution.grid.thinned(1), motor_groups(&motor));
            folder.file(MOTOR, |out| write_csv(out, &time, &groups, self.digits))?;
        }
        // The nodal tables take longest, and what they leave of the threads serves the others.
        let (nodal, others) = rayon::join(
            || self.write_nodal(&folder, (solution, deflections), watch),
            || self.write_histories(&folder, solution),
        );
        others.and(nodal)?;
        folder.file("nodes.csv", |out| write_nodes(out, link, solution.mesh()))?;
        if let Some(page) = page {
            folder.file(REPORT, |out| out.write_all(page.as_bytes()))?;
        }
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }

    /// Plans the nodal tables: their deflections, of which nothing is computed yet.
    ///
    /// # Panics
    /// If a node asked for is not one of the mesh.
    pub fn deflections<'a>(&self, solution: &'a Solution) -> NodalTable<'a> {
        let every_node = || (0..solution.mesh().nodes_m().len()).collect();
        solution.deflections(&self.nodes.clone().unwrap_or_else(every_node), self.every)
    }

    /// Tables over the whole grid, several at a time.
    fn write_histories(
        &self,
        folder: &OutputFolder,
        solution: &Solution,
    ) -> Result<(), FolderError> {
        let time = solution.grid.thinned(1);
        let tables = histories(solution);
        let write = |(name, groups): &(_, Vec<_>)| {
            folder.file(name, |out| write_csv(out, &time, groups, self.digits))
        };
        // All of them, so that of two that fail the error is always the same one.
        let written: Vec<_> = tables.par_iter().map(write).collect();
        written.into_iter().collect()
    }

    /// Tables at the nodes, one after the other: each may take much memory.
    fn write_nodal(
        &self,
        folder: &OutputFolder,
        (solution, deflections): (&Solution, NodalTable),
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        let nodes = deflections.nodes().to_vec();
        let file = |name: &str, heading, table: &NodalTable| {
            folder.file(name, |out| write_nodal(out, table, heading, self.digits, watch))
        };
        if self.optional.contains(&OptionalTable::NodalDeflections) {
            file(OptionalTable::NodalDeflections.file_name(), ("w", "m"), &deflections)?;
        }
        file("nodal_displacements.csv", ("v", "m"), &deflections.with_rotation())?;
        if self.optional.contains(&OptionalTable::BendingMoments) {
            let moments = solution.moments(&nodes, self.every);
            file(OptionalTable::BendingMoments.file_name(), ("m", "n_m"), &moments)?;
        }
        Ok(())
    }
}

/// Tables over the whole grid; columns of one unit share a group.
fn histories(solution: &Solution) -> [(&'static str, Vec<ColumnGroup<'_>>); 4] {
    let Solution { tip, .. } = solution;
    [
        ("torque.csv", vec![group([("torque_n_m", &solution.torque_n_m)])]),
        ("rigid_torque.csv", vec![group([("rigid_torque_n_m", &solution.rigid_torque_n_m)])]),
        ("hub_angle.csv", hub_groups(solution)),
        ("tip.csv", tip_groups(tip)),
    ]
}

fn hub_groups(solution: &Solution) -> Vec<ColumnGroup<'_>> {
    vec![
        group([("hub_angle_rad", &solution.hub_angle_rad)]),
        group([("hub_rate_rad_s", &solution.hub_rate_rad_s)]),
        group([("hub_acceleration_rad_s2", solution.hub_acceleration_rad_s2())]),
        group([("rigid_hub_angle_rad", &solution.rigid_hub_angle_rad)]),
    ]
}

fn motor_groups(motor: &MotorHistories) -> Vec<ColumnGroup<'_>> {
    vec![
        group([("motor_torque_n_m", &motor.torque_n_m)]),
        group([("motor_angle_rad", &motor.angle_rad)]),
        group([("motor_rate_rad_s", &motor.rate_rad_s)]),
        group([("motor_power_w", &motor.power_w)]),
    ]
}
