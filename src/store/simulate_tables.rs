//! The files of `simulate`: every column's name and unit, once.

use super::folder::{FolderError, OutputFolder};
use super::histories::{RESULT_FILES, SUMMARY, nodal_group, tip_groups, write_nodes};
use super::simulation_summary::SimulationSummary;
use crate::csv::{Digits, group, write_csv};
use crate::link::Link;
use crate::response::Simulation;

/// Which results of a simulation to write, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulateOutputs {
    /// Nodes of the nodal table; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// Every how many samples the nodal table has a row, at least 1.
    pub every: usize,
    /// Digits of all numbers.
    pub digits: Digits,
}

impl SimulateOutputs {
    /// Names of the files that will be written, summary.json last.
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

    /// Memory in bytes that the motion of the nodes takes while it is written.
    pub fn nodal_bytes(&self, simulation: &Simulation) -> usize {
        let nodes = self.nodes.as_ref().map_or(simulation.mesh.nodes_m().len(), Vec::len);
        size_of::<f64>() * nodes * simulation.grid.len.div_ceil(self.every)
    }

    /// Writes the files of a simulation into `folder` and gives them their names, all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    ///
    /// # Panics
    /// If a node asked for is not one of the mesh.
    pub fn write(
        &self,
        folder: OutputFolder,
        link: &Link,
        simulation: &Simulation,
        summary: &SimulationSummary,
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
        let groups = [nodal_group("v", "m", &histories)];
        let name = "nodal_displacements.csv";
        folder.file(name, |out| write_csv(out, &histories.grid, &groups, self.digits))?;
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }
}
