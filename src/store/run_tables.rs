//! The CSV files of all commands: every file's name, every column's name and unit, once, for writing and
//! reading.

use std::ffi::OsStr;
use std::io::{self, Write};
use std::num::NonZeroUsize;

use rayon::prelude::*;

use super::folder::{FolderError, OutputFolder};
use super::summary::Summary;
use crate::beam::{Mesh, nearest_node, node_at};
use crate::csv::{Column, ColumnGroup, Digits, group, write_csv, write_nodal};
use crate::inverse::{NodalTable, Solution, Watch};
use crate::link::{Link, ParameterError};
use crate::numeric::{ThinnedGrid, TimeGrid};

/// Written last: where it exists, the run is whole.
pub const SUMMARY: &str = "summary.json";

/// The page that `flexlink report` makes of a run; a later run removes it with the other files.
pub const REPORT: &str = "report.html";

/// Files that a run may leave in its folder besides summary.json. A run removes those of an earlier run
/// that it does not write itself, so that a folder holds one run.
pub(super) const RESULT_FILES: [&str; 17] = [
    TORQUE.0,
    RIGID_TORQUE.0,
    HUB_ANGLE,
    TIP.0,
    MOTOR.0,
    NODES.0,
    DISPLACEMENTS.file,
    DEFLECTIONS.file,
    MOMENTS.file,
    REPORT,
    TORQUES,
    RIGID_TORQUES,
    JOINT_ANGLES,
    CHORD_ANGLES,
    REACTIONS,
    POSITIONS,
    TIP_ERROR,
];

/// A file over time and its columns beside the time.
type Histories<const N: usize> = (&'static str, [&'static str; N]);

pub(super) const TORQUE: Histories<1> = ("torque.csv", ["torque_n_m"]);
pub(super) const RIGID_TORQUE: Histories<1> = ("rigid_torque.csv", ["rigid_torque_n_m"]);
pub(super) const TIP: Histories<3> =
    ("tip.csv", ["tip_displacement_m", "tip_velocity_m_s", "tip_acceleration_m_s2"]);
/// The motor of a link with a drive.
pub(super) const MOTOR: Histories<4> =
    ("motor.csv", ["motor_torque_n_m", "motor_angle_rad", "motor_rate_rad_s", "motor_power_w"]);
/// The wanted tip of a simulation with its error, at the target's times.
pub(super) const TIP_ERROR: &str = "tip_error.csv";
/// Columns of the wanted tip of a link, and of an arm.
pub(super) const WANTED: [&str; 1] = ["wanted_displacement_m"];
pub(super) const WANTED_PLACE: [&str; 2] = ["wanted_x_m", "wanted_y_m"];
pub(super) const ERROR: &str = "tip_error_m";
pub(super) const HUB_ANGLE: &str = "hub_angle.csv";
/// Columns of the hub, of a simulation and of a solution.
pub(super) const PLAYED_HUB: [&str; 3] =
    ["hub_angle_rad", "hub_rate_rad_s", "hub_acceleration_rad_s2"];
pub(super) const SOLVED_HUB: [&str; 4] =
    [PLAYED_HUB[0], PLAYED_HUB[1], PLAYED_HUB[2], "rigid_hub_angle_rad"];
/// Files of an arm's run alone.
pub(super) const TORQUES: &str = "torques.csv";
pub(super) const RIGID_TORQUES: &str = "rigid_torques.csv";
pub(super) const JOINT_ANGLES: &str = "joint_angles.csv";
pub(super) const CHORD_ANGLES: &str = "chord_angles.csv";
pub(super) const REACTIONS: &str = "reactions.csv";
pub(super) const POSITIONS: &str = "nodal_positions.csv";
const OF_ARMS: [&str; 6] =
    [TORQUES, RIGID_TORQUES, JOINT_ANGLES, CHORD_ANGLES, REACTIONS, POSITIONS];
pub(super) const NODES: Histories<3> = ("nodes.csv", ["node", "x_m", "segment"]);
/// Columns of nodes.csv of an arm.
pub(super) const ARM_NODES: [&str; 4] = ["link", "node", "x_m", "name"];

/// A table over time with a column for every node: `v7_m`.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodalFile {
    pub(super) file: &'static str,
    pub(super) letter: &'static str,
    pub(super) unit: &'static str,
}

impl NodalFile {
    const fn new(file: &'static str, letter: &'static str, unit: &'static str) -> Self {
        Self { file, letter, unit }
    }

    /// Name of the column of a node.
    pub(super) fn column(self, node: usize) -> String {
        format!("{}{node}_{}", self.letter, self.unit)
    }
}

pub(super) const DISPLACEMENTS: NodalFile = NodalFile::new("nodal_displacements.csv", "v", "m");
pub(super) const DEFLECTIONS: NodalFile = NodalFile::new("nodal_deflections.csv", "w", "m");
pub(super) const MOMENTS: NodalFile = NodalFile::new("bending_moments.csv", "m", "n_m");

/// True if a run may write, or remove, a file of this name in its folder.
pub fn is_result_file(name: &OsStr) -> bool {
    RESULT_FILES.iter().chain([&SUMMARY]).any(|file| name == *file)
}

/// Which results of a solution or a simulation to write, and with which digits.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOutputs {
    /// Nodes of the nodal tables; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// Distances from the axis in m of nodes of the nodal tables, besides `nodes`; those beyond a link are left out.
    pub stations_m: Vec<f64>,
    /// The nodal tables have a row for every so many samples.
    pub every: NonZeroUsize,
    /// Whether a solution has `nodal_deflections.csv`: deflection w from the hub's tangent line.
    pub deflections: bool,
    /// Whether a solution has `bending_moments.csv`.
    pub moments: bool,
    /// Whether to write a small folder to compare with later: torque, hub or joint angles, tip and displacements alone,
    /// of three nodes, and every fifth row of all tables, counted from the motion's first sample.
    pub golden: bool,
    /// Digits of all numbers.
    pub digits: Digits,
}

/// Rows of a golden folder.
const GOLDEN_EVERY: NonZeroUsize = NonZeroUsize::new(5).unwrap();

/// Files of a solution that a golden folder has not.
const NOT_GOLDEN: [&str; 5] = [RIGID_TORQUE.0, MOTOR.0, RIGID_TORQUES, CHORD_ANGLES, REACTIONS];

impl Default for RunOutputs {
    /// Every node, every sample, no table on demand.
    fn default() -> Self {
        Self {
            nodes: None,
            stations_m: Vec::new(),
            every: NonZeroUsize::MIN,
            deflections: false,
            moments: false,
            golden: false,
            digits: Digits::default(),
        }
    }
}

impl RunOutputs {
    /// Names of the files of a link, summary.json last.
    pub fn file_names(&self, link: &Link) -> Vec<&'static str> {
        let is_written = |name: &&str| match *name {
            REPORT | TIP_ERROR => false,
            name if OF_ARMS.contains(&name) => false,
            name if name == MOTOR.0 => link.drive().is_some(),
            name if name == DEFLECTIONS.file => self.deflections,
            name if name == MOMENTS.file => self.moments,
            _ => true,
        };
        let files = RESULT_FILES.into_iter().filter(is_written);
        files.filter(|name| self.has(name)).chain([SUMMARY]).collect()
    }

    /// True unless the folder is a golden one, which has not this file.
    pub(super) fn has(&self, name: &str) -> bool {
        !(self.golden && NOT_GOLDEN.contains(&name))
    }

    /// The rows of tables over time.
    pub fn rows(&self, grid: &TimeGrid) -> ThinnedGrid {
        if self.golden { grid.multiples(GOLDEN_EVERY) } else { grid.thinned(NonZeroUsize::MIN) }
    }

    /// The rows of tables at nodes.
    pub(super) fn nodal_rows(&self, grid: &TimeGrid) -> ThinnedGrid {
        if self.golden { self.rows(grid) } else { grid.thinned(self.every) }
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
        // The nodal tables take longest; threads that they leave idle write the others.
        let (nodal, others) = rayon::join(
            || self.write_nodal(&folder, deflections, watch),
            || self.write_histories(&folder, solution),
        );
        others.and(nodal)?;
        if let Some(page) = page {
            folder.file(REPORT, |out| out.write_all(page.as_bytes()))?;
        }
        finish(folder, (solution.link(), solution.mesh()), summary)
    }

    /// The deflections of the nodal tables, computed on request.
    ///
    /// # Errors
    /// [`ParameterError`] if a node is not one of the mesh.
    pub fn deflections<'a>(
        &self,
        solution: &'a Solution,
    ) -> Result<NodalTable<'a>, ParameterError> {
        let nodes = self.nodes_of(solution.mesh().nodes_m());
        solution.deflections_at(&nodes, self.nodal_rows(&solution.grid))
    }

    /// Tables over the whole grid, several at a time.
    fn write_histories(
        &self,
        folder: &OutputFolder,
        solution: &Solution,
    ) -> Result<(), FolderError> {
        let time = self.rows(&solution.grid);
        let Solution { tip, hub_angle_rad, hub_rate_rad_s, rigid_hub_angle_rad, .. } = solution;
        let hub_acceleration_rad_s2 = solution.hub_acceleration_rad_s2();
        let hub = [hub_angle_rad, hub_rate_rad_s, &hub_acceleration_rad_s2, rigid_hub_angle_rad];
        let tip = [&tip.displacement_m, &tip.velocity_m_s, &tip.acceleration_m_s2];
        let motor = solution
            .motor
            .as_ref()
            .map(|motor| [&motor.torque_n_m, &motor.angle_rad, &motor.rate_rad_s, &motor.power_w]);
        let mut tables = vec![
            (TORQUE.0, groups(TORQUE.1, [&solution.torque_n_m])),
            (RIGID_TORQUE.0, groups(RIGID_TORQUE.1, [&solution.rigid_torque_n_m])),
            (HUB_ANGLE, groups(SOLVED_HUB, hub)),
            (TIP.0, groups(TIP.1, tip)),
        ];
        tables.extend(motor.map(|motor| (MOTOR.0, groups(MOTOR.1, motor))));
        let write = |(name, groups): &(_, Vec<_>)| {
            folder.file(name, |out| write_rows(out, &time, groups, self.digits))
        };
        tables.retain(|(name, _)| self.has(name));
        // Collected first, so that of two errors always the same one is returned.
        let written: Vec<_> = tables.par_iter().map(write).collect();
        written.into_iter().collect()
    }

    /// Tables at the nodes, one after the other, because each may take much memory.
    fn write_nodal(
        &self,
        folder: &OutputFolder,
        deflections: NodalTable,
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        let write = |NodalFile { file, letter, unit }, table: &NodalTable| {
            folder.file(file, |out| write_nodal(out, table, (letter, unit), self.digits, watch))
        };
        if self.deflections {
            write(DEFLECTIONS, &deflections)?;
        }
        let moments = self.moments.then(|| deflections.moments());
        write(DISPLACEMENTS, &deflections.with_rotation())?;
        moments.map_or(Ok(()), |moments| write(MOMENTS, &moments))
    }

    /// The nodes to write of those at these distances: the list and the stations, three of a golden folder, or all.
    pub(super) fn nodes_of(&self, nodes_m: &[f64]) -> Vec<usize> {
        if self.golden {
            return nodes_at_thirds(nodes_m);
        }
        let mut nodes = match &self.nodes {
            Some(list) => list.clone(),
            None if self.stations_m.is_empty() => return (0..nodes_m.len()).collect(),
            None => Vec::new(),
        };
        for node in self.stations_m.iter().filter_map(|at_m| node_at(nodes_m, *at_m)) {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        nodes
    }
}

/// The nodes nearest to a third and two thirds of the length from the root, and the tip.
fn nodes_at_thirds(nodes_m: &[f64]) -> Vec<usize> {
    let last = nodes_m.len() - 1;
    let at_m = |thirds: f64| nodes_m[0] + thirds / 3.0 * (nodes_m[last] - nodes_m[0]);
    let inner = |thirds: f64| nearest_node(&nodes_m[..last], at_m(thirds));
    let mut nodes = vec![inner(1.0), inner(2.0), last];
    nodes.dedup();
    nodes
}

/// Writes those rows of columns over the whole grid that are at these times.
pub(super) fn write_rows(
    out: &mut (dyn Write + Send),
    times: &ThinnedGrid,
    groups: &[ColumnGroup],
    digits: Digits,
) -> io::Result<()> {
    let taken = groups.iter().flat_map(|group| &group.columns).map(|own| times.taken(own.values));
    let taken: Vec<_> = taken.collect();
    let mut values = taken.iter();
    let groups = groups.iter().map(|group| {
        let columns = group.columns.iter().zip(values.by_ref());
        let columns = columns.map(|(own, values)| Column { name: own.name.clone(), values });
        ColumnGroup { columns: columns.collect() }
    });
    write_csv(out, times, &groups.collect::<Vec<_>>(), digits)
}

/// Writes the files that every run has, and gives all files their names.
pub(super) fn finish(
    folder: OutputFolder,
    (link, mesh): (&Link, &Mesh),
    summary: &Summary,
) -> Result<(), FolderError> {
    folder.file(NODES.0, |out| write_nodes(out, link, mesh))?;
    folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
    folder.commit(SUMMARY, &RESULT_FILES)
}

/// Columns that each have decimals for their own peak.
pub(super) fn groups<'a, const N: usize>(
    names: [&str; N],
    columns: [&'a Vec<f64>; N],
) -> Vec<ColumnGroup<'a>> {
    names.into_iter().zip(columns).map(|(name, values)| group([(name, &values[..])])).collect()
}

/// `nodes.csv`: every node of the mesh with the segment that ends there (node 0: begins there), by name,
/// or by number if it has none. Positions have all digits: a run that is read back has its mesh from
/// them.
fn write_nodes(out: &mut (dyn Write + Send), link: &Link, mesh: &Mesh) -> io::Result<()> {
    let format = Digits::Full.for_peak(mesh.length_m());
    let mut table = csv::Writer::from_writer(out);
    table.write_record(NODES.1)?;
    for (node, x_m) in mesh.nodes_m().iter().enumerate() {
        let index = mesh.element_segments()[node.saturating_sub(1)];
        let name = link.segments()[index].name.clone().unwrap_or_else(|| index.to_string());
        let mut position = Vec::new();
        format.write(&mut position, *x_m);
        table.write_record([node.to_string().as_bytes(), &position, name.as_bytes()])?;
    }
    table.flush()
}
