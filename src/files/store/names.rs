//! Names of a run's files and columns, for writing and reading; the choice of its tables, with their nodes, rows and
//! digits.

use std::ffi::OsStr;
use std::num::NonZeroUsize;

use crate::beam::{nearest_node, node_at};
use crate::csv::Digits;
use crate::inverse::{NodalTable, Solution};
use crate::link::{Arm, Link, ParameterError};
use crate::numeric::{ThinnedGrid, TimeGrid};
use crate::response::Played;

/// Last file of a run: it exists only in a whole run.
pub const SUMMARY: &str = "summary.json";

/// The page that `flexlink report` makes of a run; a later run removes it with the other files.
pub const REPORT: &str = "report.html";

/// Names for a link on a hub, for an arm and for a link on a carriage; empty without such a file or column.
type Name = [&'static str; 3];

/// Lists of names in the order of [`Name`].
type Names = [&'static [&'static str]; 3];

/// The joints of a run, as the names of its files and columns show them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// A link on a hub.
    Hub,
    /// An arm of several links.
    Arm,
    /// A link on a carriage.
    Carriage,
    /// A link on a hub with its output inboard of the tip.
    HubStation,
    /// A link on a carriage with its output inboard of the tip.
    CarriageStation,
}

impl Form {
    const ALL: [Self; 5] =
        [Self::Hub, Self::Arm, Self::Carriage, Self::HubStation, Self::CarriageStation];

    /// The form of the names of these links.
    pub(super) fn of<'a>(links: impl IntoIterator<Item = &'a Link>) -> Self {
        let mut links = links.into_iter();
        let (Some(link), None) = (links.next(), links.next()) else { return Self::Arm };
        match (link.joint().slides(), link.has_station()) {
            (false, false) => Self::Hub,
            (true, false) => Self::Carriage,
            (false, true) => Self::HubStation,
            (true, true) => Self::CarriageStation,
        }
    }

    /// Place of the form's names in a [`Name`].
    const fn place(self) -> usize {
        match self {
            Self::Hub | Self::HubStation => 0,
            Self::Arm => 1,
            Self::Carriage | Self::CarriageStation => 2,
        }
    }

    /// The name of a file in this form, from its name where the output is the tip.
    fn file(self, name: Name) -> &'static str {
        let name = pick(name, self);
        match (self, name) {
            (Self::HubStation | Self::CarriageStation, "tip.csv") => "output.csv",
            (Self::HubStation | Self::CarriageStation, "tip_error.csv") => "output_error.csv",
            _ => name,
        }
    }
}

/// A table over time with columns for each joint.
#[derive(Debug)]
pub(super) struct JointFile {
    file: Name,
    /// Columns of a joint, `#` its number from 1. Columns without `#` are those of the whole arm.
    columns: &'static [Name],
    /// Whether the columns of all joints have the decimals of their common peak.
    pub(super) shares_decimals: bool,
}

impl JointFile {
    const fn new(file: Name, columns: &'static [Name]) -> Self {
        Self { file, columns, shares_decimals: false }
    }

    /// Name of the file in this form.
    pub(super) fn name(&self, form: Form) -> &'static str {
        form.file(self.file)
    }

    /// Name of a joint's column; empty if there is no such column.
    pub(super) fn column(&self, form: Form, joint: usize, column: usize) -> String {
        let name = pick(self.columns[column], form).replace('#', &(joint + 1).to_string());
        match form {
            Form::HubStation | Form::CarriageStation => name.replace("tip_", "output_"),
            _ => name,
        }
    }

    /// Names of all columns of these joints.
    pub(super) fn columns(&self, form: Form, of: &[usize]) -> Vec<String> {
        let is_of_whole = !self.columns[0][1].contains('#');
        let of = of.iter().filter(|joint| **joint == 0 || !is_of_whole);
        let columns = of.flat_map(|joint| {
            (0..self.columns.len()).map(move |column| self.column(form, *joint, column))
        });
        columns.filter(|name| !name.is_empty()).collect()
    }
}

const fn pick<T: Copy>(of: [T; 3], form: Form) -> T {
    of[form.place()]
}

pub(super) static TORQUE: JointFile = JointFile {
    file: ["torque.csv", "torques.csv", "force.csv"],
    columns: &[["torque_n_m", "torque#_n_m", "force_n"]],
    shares_decimals: true,
};
pub(super) static RIGID_TORQUE: JointFile = JointFile {
    file: ["rigid_torque.csv", "rigid_torques.csv", "rigid_force.csv"],
    columns: &[["rigid_torque_n_m", "rigid_torque#_n_m", "rigid_force_n"]],
    shares_decimals: true,
};
/// Beginning of the names of columns for rigid links, which only a solution has.
pub(super) const RIGID: &str = "rigid_";
/// Column of the moment at the root of a link on a carriage, which only a solution has.
pub(super) const ROOT_MOMENT: &str = "root_moment_n_m";
/// Angles of the hub or of the joints. A simulation writes the first three columns.
pub(super) static ANGLE: JointFile = JointFile::new(
    ["hub_angle.csv", "joint_angles.csv", "carriage.csv"],
    &[
        ["hub_angle_rad", "joint#_rad", "carriage_m"],
        ["hub_rate_rad_s", "joint#_rate_rad_s", "carriage_velocity_m_s"],
        ["hub_acceleration_rad_s2", "joint#_acceleration_rad_s2", "carriage_acceleration_m_s2"],
        ["rigid_hub_angle_rad", "rigid_joint#_rad", "rigid_carriage_m"],
        ["", "", ROOT_MOMENT],
    ],
);
/// Files of the carriage of an arm, besides those of its joints.
pub(super) static OF_CARRIAGE: [&JointFile; 3] = [&TORQUE, &RIGID_TORQUE, &ANGLE];
/// Motors of joints with a drive. The last columns are of those with the motor's constants.
pub(super) static MOTOR: JointFile = JointFile::new(
    ["motor.csv"; 3],
    &[
        ["motor_torque_n_m", "motor#_torque_n_m", "motor_torque_n_m"],
        ["motor_angle_rad", "motor#_angle_rad", "motor_angle_rad"],
        ["motor_rate_rad_s", "motor#_rate_rad_s", "motor_rate_rad_s"],
        ["motor_power_w", "motor#_power_w", "motor_power_w"],
        ["motor_current_a", "motor#_current_a", "motor_current_a"],
        ["motor_voltage_v", "motor#_voltage_v", "motor_voltage_v"],
    ],
);
/// Chords of an arm's links. A simulation writes the first column.
pub(super) static CHORD: JointFile = JointFile::new(
    ["", "chord_angles.csv", ""],
    &[
        ["", "angle#_rad", ""],
        ["", "rate#_rad_s", ""],
        ["", "acceleration#_rad_s2", ""],
        ["", "length#_m", ""],
    ],
);
/// Forces on the inner ends of an arm's links.
pub(super) static FORCE: JointFile =
    JointFile::new(["", "reactions.csv", ""], &[["", "force#_x_n", ""], ["", "force#_y_n", ""]]);
/// Motion of the tip: along the arc of a link, or in the plane.
pub(super) static TIP: JointFile = JointFile::new(
    ["tip.csv"; 3],
    &[
        ["tip_displacement_m", "x_m", "tip_displacement_m"],
        ["tip_velocity_m_s", "y_m", "tip_velocity_m_s"],
        ["tip_acceleration_m_s2", "velocity_x_m_s", "tip_acceleration_m_s2"],
        ["", "velocity_y_m_s", ""],
        ["", "acceleration_x_m_s2", ""],
        ["", "acceleration_y_m_s2", ""],
    ],
);
/// The wanted tip of a simulation and the distance from it, at the target's times.
pub(super) static TIP_ERROR: JointFile = JointFile::new(
    ["tip_error.csv"; 3],
    &[
        ["wanted_displacement_m", "wanted_x_m", "wanted_displacement_m"],
        ["tip_error_m", "wanted_y_m", "tip_error_m"],
        ["", "tip_error_m", ""],
    ],
);

/// A table over time with columns for each node: `v7_m` of a link, `x2_7_m` of the second link of an arm.
#[derive(Debug)]
pub(super) struct NodalFile {
    file: Name,
    /// First letters of a node's columns.
    letters: Names,
    pub(super) unit: &'static str,
}

impl NodalFile {
    /// Name of the file in this form.
    pub(super) const fn name(&self, form: Form) -> &'static str {
        pick(self.file, form)
    }

    /// Letters of a node's columns.
    pub(super) const fn letters(&self, form: Form) -> &'static [&'static str] {
        pick(self.letters, form)
    }

    /// Name of a column of a node.
    pub(super) fn column(&self, form: Form, link: usize, letter: usize, node: usize) -> String {
        let (letter, unit) = (self.letters(form)[letter], self.unit);
        let link = pick(LINK_OF_NODE, form).replace('#', &(link + 1).to_string());
        format!("{letter}{link}{node}_{unit}")
    }
}

/// Number of the link in the column of a node.
const LINK_OF_NODE: Name = ["", "#_", ""];

/// Displacements of a link's nodes, places of an arm's.
pub(super) static PLACES: NodalFile = NodalFile {
    file: ["nodal_displacements.csv", "nodal_positions.csv", "nodal_displacements.csv"],
    letters: [&["v"], &["x", "y"], &["v"]],
    unit: "m",
};
/// Deflections from the hub's tangent line, of an arm's links from their chords.
pub(super) static DEFLECTIONS: NodalFile =
    NodalFile { file: ["nodal_deflections.csv"; 3], letters: [&["w"]; 3], unit: "m" };
pub(super) static MOMENTS: NodalFile =
    NodalFile { file: ["bending_moments.csv"; 3], letters: [&["m"]; 3], unit: "n_m" };

/// Distances of the nodes along the link, or along each link.
pub(super) const NODES: &str = "nodes.csv";
const NODE_COLUMNS: Names =
    [&["node", "x_m", "segment"], &["link", "node", "x_m", "name"], &["node", "x_m", "segment"]];

/// Columns of [`NODES`].
pub(super) const fn node_columns(form: Form) -> &'static [&'static str] {
    pick(NODE_COLUMNS, form)
}

/// Files of a solution in the order of its summary.
const SOLVED: [Name; 11] = [
    TORQUE.file,
    RIGID_TORQUE.file,
    ANGLE.file,
    CHORD.file,
    TIP.file,
    MOTOR.file,
    FORCE.file,
    [NODES; 3],
    PLACES.file,
    DEFLECTIONS.file,
    MOMENTS.file,
];

/// Files of a simulation in the order of its summary.
const PLAYED: [Name; 7] =
    [TORQUE.file, TIP.file, ANGLE.file, CHORD.file, PLACES.file, [NODES; 3], TIP_ERROR.file];

/// Names in a list in this form.
fn names_in(list: &'static [Name], form: Form) -> impl Iterator<Item = &'static str> {
    list.iter().map(move |name| form.file(*name)).filter(|name| !name.is_empty())
}

/// Files of a solution in this form.
pub(super) fn solved_files(form: Form) -> impl Iterator<Item = &'static str> {
    names_in(&SOLVED, form)
}

/// Files of a simulation, with a target or without, summary.json last.
pub(super) fn played_files(arm: &Arm, has_target: bool) -> Vec<&'static str> {
    let form = Form::of(arm.links().iter().map(|own| &own.link));
    let target = TIP_ERROR.name(form);
    let files = names_in(&PLAYED, form).filter(|name| has_target || *name != target);
    let of_carriage = [&TORQUE, &ANGLE].into_iter().filter(|_| arm.carriage().is_some());
    let of_carriage = of_carriage.map(|file| file.name(Form::Carriage));
    files.chain(of_carriage).chain([SUMMARY]).collect()
}

/// Possible files in a run's folder besides summary.json. A run removes those of an earlier run that it does not
/// write itself, so that a folder holds one run.
pub(super) fn result_files() -> Vec<&'static str> {
    let mut names = vec![REPORT];
    for list in [&SOLVED[..], &PLAYED] {
        Form::ALL.into_iter().flat_map(|form| names_in(list, form)).for_each(|name| {
            if !names.contains(&name) {
                names.push(name);
            }
        });
    }
    names
}

/// True if a run may write, or remove, a file of this name in its folder.
pub fn is_result_file(name: &OsStr) -> bool {
    result_files().iter().chain([&SUMMARY]).any(|file| name == *file)
}

/// Choice of the results of a solution or a simulation to write, and their digits.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOutputs {
    /// Nodes of the nodal tables; `None`: all.
    pub nodes: Option<Vec<usize>>,
    /// Distances from the axis in m of nodes of the nodal tables, besides `nodes`. Distances beyond a link do not
    /// count.
    pub stations_m: Vec<f64>,
    /// Number of samples per row of the nodal tables.
    pub every: NonZeroUsize,
    /// Whether a solution has `nodal_deflections.csv`: deflection w from the hub's tangent line.
    pub deflections: bool,
    /// Whether a solution has `bending_moments.csv`.
    pub moments: bool,
    /// Whether a solution has a small folder for later comparison: torque, hub or joint angles, tip, displacements of
    /// three nodes. Tables have every fifth row, counted from the motion's first sample.
    pub golden: bool,
    /// Digits of all numbers.
    pub digits: Digits,
}

/// Rows of a golden folder.
const GOLDEN_EVERY: NonZeroUsize = NonZeroUsize::new(5).unwrap();

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
    /// Names of the files of a solution, summary.json last.
    pub(super) fn files(&self, arm: &Arm) -> Vec<&'static str> {
        let links = || arm.links().iter().map(|own| &own.link);
        let (form, has_drive) = (Form::of(links()), links().any(|link| link.drive().is_some()));
        let is_written = |name: &&str| match *name {
            name if name == MOTOR.name(form) => has_drive,
            name if name == DEFLECTIONS.name(form) => self.deflections,
            name if name == MOMENTS.name(form) => self.moments,
            _ => true,
        };
        let files = solved_files(form).filter(is_written);
        let of_carriage = OF_CARRIAGE.iter().filter(|_| arm.carriage().is_some());
        let of_carriage = of_carriage.map(|file| file.name(Form::Carriage));
        let of_carriage = of_carriage.filter(|name| self.has(name, Form::Carriage));
        let files = files.filter(|name| self.has(name, form));
        files.chain(of_carriage).chain([SUMMARY]).collect()
    }

    /// False for a file without a name in this form, and for one that a golden folder lacks.
    pub(super) fn has(&self, name: &str, form: Form) -> bool {
        let left_out = [&RIGID_TORQUE, &MOTOR, &CHORD, &FORCE];
        !name.is_empty() && (!self.golden || left_out.iter().all(|file| file.name(form) != name))
    }

    /// The rows of tables over time.
    pub fn rows(&self, grid: &TimeGrid) -> ThinnedGrid {
        if self.golden { grid.multiples(GOLDEN_EVERY) } else { grid.thinned(NonZeroUsize::MIN) }
    }

    /// The rows of tables at nodes.
    pub(super) fn nodal_rows(&self, grid: &TimeGrid) -> ThinnedGrid {
        if self.golden { self.rows(grid) } else { grid.thinned(self.every) }
    }

    /// The deflections of a link's nodal tables, computed on request.
    ///
    /// # Errors
    /// [`ParameterError`] if a node is not one of the mesh.
    pub(super) fn deflections<'a>(
        &self,
        solution: &'a Solution,
    ) -> Result<NodalTable<'a>, ParameterError> {
        let nodes = self.nodes_of(solution.links[0].mesh().nodes_m());
        solution.deflections_at(&nodes, self.nodal_rows(&solution.grid))
    }

    /// The nodes to write: the list and the stations, three for a golden folder, or all.
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

    /// Memory in bytes of the nodal table of a simulation.
    pub fn simulation_bytes(&self, played: &Played) -> usize {
        let nodes = played.nodes_m().into_iter().map(|nodes_m| self.nodes_of(nodes_m).len());
        size_of::<f64>()
            * played.tip.len()
            * nodes.sum::<usize>()
            * played.grid.len.div_ceil(self.every.get())
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
