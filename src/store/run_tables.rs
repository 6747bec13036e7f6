//! The files of `solve` and `simulate`: every column's name and unit, once.

use std::io::{self, Write};

use rayon::prelude::*;

use super::file_names::{MOTOR, REPORT, RESULT_FILES, SUMMARY};
use super::folder::{FolderError, OutputFolder};
use super::summary::Summary;
use crate::beam::Mesh;
use crate::csv::{Column, ColumnGroup, Digits, group, write_csv, write_nodal};
use crate::inverse::{MotorHistories, NodalTable, Solution, Watch};
use crate::link::Link;
use crate::motion::TipMotionHistories;
use crate::response::Simulation;

/// Which results of an inversion to write, and with which digits.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveOutputs {
    /// Nodes of the nodal tables; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// The nodal tables have a row for every so many samples, at least 1.
    pub every: usize,
    /// Tables that are written on demand.
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
    /// Names of the files of a link, summary.json last.
    pub fn file_names(&self, link: &Link) -> Vec<&'static str> {
        let optional = [OptionalTable::NodalDeflections, OptionalTable::BendingMoments];
        let wanted = |name: &&str| {
            let table = optional.into_iter().find(|table| table.file_name() == *name);
            let is_driven = *name != MOTOR || link.drive().is_some();
            is_driven && *name != REPORT && table.is_none_or(|table| self.optional.contains(&table))
        };
        RESULT_FILES.into_iter().filter(wanted).chain([SUMMARY]).collect()
    }

    /// Writes the files of a solution, and the `page` of the run if there is one, into `folder`: all or
    /// none. The deflections are those of [`Self::deflections`]; `watch` gets the progress of the nodal
    /// tables.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(
        &self,
        folder: OutputFolder,
        (solution, deflections): (&Solution, NodalTable),
        (summary, page): (&Summary, Option<&str>),
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        if let Some(motor) = &solution.motor {
            let (time, groups) = (solution.grid.thinned(1), motor_groups(motor));
            folder.file(MOTOR, |out| write_csv(out, &time, &groups, self.digits))?;
        }
        // The nodal tables take longest; threads that they leave idle write the others.
        let (nodal, others) = rayon::join(
            || self.write_nodal(&folder, (solution, deflections), watch),
            || self.write_histories(&folder, solution),
        );
        others.and(nodal)?;
        folder.file("nodes.csv", |out| write_nodes(out, solution.link(), solution.mesh()))?;
        if let Some(page) = page {
            folder.file(REPORT, |out| out.write_all(page.as_bytes()))?;
        }
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }

    /// The deflections of the nodal tables, computed when their rows are asked for.
    ///
    /// # Panics
    /// If a node is not one of the mesh.
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
        let hub_acceleration_rad_s2 = solution.hub_acceleration_rad_s2();
        let tables = histories(solution, &hub_acceleration_rad_s2);
        let write = |(name, groups): &(_, Vec<_>)| {
            folder.file(name, |out| write_csv(out, &time, groups, self.digits))
        };
        // Collected first, so that of two errors always the same one is returned.
        let written: Vec<_> = tables.par_iter().map(write).collect();
        written.into_iter().collect()
    }

    /// Tables at the nodes, one after the other, because each may take much memory.
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
fn histories<'a>(
    solution: &'a Solution,
    hub_acceleration_rad_s2: &'a Vec<f64>,
) -> [(&'static str, Vec<ColumnGroup<'a>>); 4] {
    let Solution { tip, .. } = solution;
    [
        ("torque.csv", vec![group([("torque_n_m", &solution.torque_n_m)])]),
        ("rigid_torque.csv", vec![group([("rigid_torque_n_m", &solution.rigid_torque_n_m)])]),
        ("hub_angle.csv", hub_groups(solution, hub_acceleration_rad_s2)),
        ("tip.csv", tip_groups(tip)),
    ]
}

fn hub_groups<'a>(
    solution: &'a Solution,
    acceleration_rad_s2: &'a Vec<f64>,
) -> Vec<ColumnGroup<'a>> {
    vec![
        group([("hub_angle_rad", &solution.hub_angle_rad)]),
        group([("hub_rate_rad_s", &solution.hub_rate_rad_s)]),
        group([("hub_acceleration_rad_s2", acceleration_rad_s2)]),
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

/// Which results of a simulation to write, and with which digits.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulateOutputs {
    /// Nodes of the nodal table; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// The nodal table has a row for every so many samples, at least 1.
    pub every: usize,
    /// Digits of all numbers.
    pub digits: Digits,
}

impl SimulateOutputs {
    /// Names of the files, summary.json last.
    pub fn file_names() -> Vec<&'static str> {
        vec![
            "torque.csv",
            "tip.csv",
            "hub_angle.csv",
            "nodal_displacements.csv",
            "nodes.csv",
            SUMMARY,
        ]
    }

    /// Memory in bytes of the nodal table.
    pub fn nodal_bytes(&self, simulation: &Simulation) -> usize {
        let nodes = self.nodes.as_ref().map_or(simulation.mesh.nodes_m().len(), Vec::len);
        size_of::<f64>() * nodes * simulation.grid.len.div_ceil(self.every)
    }

    /// Writes the files of a simulation into `folder`: all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    ///
    /// # Panics
    /// If a node is not one of the mesh.
    pub fn write(
        &self,
        folder: OutputFolder,
        link: &Link,
        simulation: &Simulation,
        summary: &Summary,
    ) -> Result<(), FolderError> {
        let all = simulation.grid.thinned(1);
        let hub = vec![
            group([("hub_angle_rad", &simulation.hub_angle_rad)]),
            group([("hub_rate_rad_s", &simulation.hub_rate_rad_s)]),
            group([("hub_acceleration_rad_s2", &simulation.hub_acceleration_rad_s2)]),
        ];
        let tip = tip_groups(&simulation.tip);
        let torque = [group([("torque_n_m", &simulation.torque_n_m)])];
        folder.file("torque.csv", |out| write_csv(out, &all, &torque, self.digits))?;
        folder.file("tip.csv", |out| write_csv(out, &all, &tip, self.digits))?;
        folder.file("hub_angle.csv", |out| write_csv(out, &all, &hub, self.digits))?;
        folder.file("nodes.csv", |out| write_nodes(out, link, &simulation.mesh))?;
        let every_node = || (0..simulation.mesh.nodes_m().len()).collect();
        let nodes: Vec<usize> = self.nodes.clone().unwrap_or_else(every_node);
        let histories = simulation.displacements_m(&nodes, self.every);
        let named = histories.nodes.iter().zip(&histories.samples);
        let columns = named.map(|(node, values)| Column { name: format!("v{node}_m"), values });
        let groups = [ColumnGroup { columns: columns.collect() }];
        let name = "nodal_displacements.csv";
        folder.file(name, |out| write_csv(out, &histories.grid, &groups, self.digits))?;
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }
}

/// Columns of tip.csv.
fn tip_groups(tip: &TipMotionHistories) -> Vec<ColumnGroup<'_>> {
    vec![
        group([("tip_displacement_m", &tip.displacement_m)]),
        group([("tip_velocity_m_s", &tip.velocity_m_s)]),
        group([("tip_acceleration_m_s2", &tip.acceleration_m_s2)]),
    ]
}

/// `nodes.csv`: every node of the mesh with the segment that ends there (node 0: begins there), by name,
/// or by number if it has none. Positions have all digits: a run that is read back has its mesh from
/// them.
fn write_nodes(out: &mut (dyn Write + Send), link: &Link, mesh: &Mesh) -> io::Result<()> {
    let format = Digits::Full.for_peak(mesh.length_m());
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["node", "x_m", "segment"])?;
    for (node, x_m) in mesh.nodes_m().iter().enumerate() {
        let index = mesh.element_segments()[node.saturating_sub(1)];
        let name = link.segments()[index].name.clone().unwrap_or_else(|| index.to_string());
        let mut position = Vec::new();
        format.write(&mut position, *x_m);
        table.write_record([node.to_string().as_bytes(), &position, name.as_bytes()])?;
    }
    table.flush()
}
