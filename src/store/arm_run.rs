//! The files of an arm's run, and its summary.

use serde_json::{Map, Value, json};

use super::folder::{FolderError, OutputFolder};
use super::run_tables::{
    ARM_NODES, CHORD_ANGLES, DEFLECTIONS, JOINT_ANGLES, MOMENTS, MOTOR, NODES, POSITIONS,
    REACTIONS, REPORT, RESULT_FILES, RIGID_TORQUES, RunOutputs, SUMMARY, TIP, TORQUES, write_rows,
};
use super::summary::{LinkRecord, RunInputs, Summary};
use crate::csv::{Column, ColumnGroup, Digits};
use crate::inverse::{ArmSolution, MotorHistories};
use crate::link::Arm;
use crate::motion::Prescribed;
use crate::result::{Exceeded, JointMetrics, Limits, Metrics, Notice, Remark};
use crate::verify::Verification;

/// A run of an arm: its solution, and what is known of it beside its numbers.
#[derive(Debug, Clone, Copy)]
pub struct ArmRun<'a> {
    /// The solution.
    pub solution: &'a ArmSolution,
    /// Its numbers.
    pub metrics: &'a Metrics,
    /// Limits of each joint.
    pub limits: &'a [Limits],
    /// Those that it exceeds.
    pub exceeded: &'a [Exceeded],
    /// Checks of the answer, if it was verified.
    pub verification: Option<&'a Verification>,
    /// Remarks on the arm.
    pub remarks: &'a [Remark],
}

/// A table over time: columns in groups of one unit.
pub(super) type Table<'a> = Vec<ColumnGroup<'a>>;

/// A table at nodes.
type NodalTable<'a> = Vec<Column<'a>>;

/// Names of the columns that are read back, of a joint by its number from 1, of a node of a link.
pub(super) fn torque(joint: usize) -> String {
    format!("torque{joint}_n_m")
}

pub(super) fn rigid_torque(joint: usize) -> String {
    format!("rigid_torque{joint}_n_m")
}

pub(super) fn joint_angle(joint: usize) -> String {
    format!("joint{joint}_rad")
}

pub(super) fn joint_rate(joint: usize) -> String {
    format!("joint{joint}_rate_rad_s")
}

pub(super) fn rigid_joint_angle(joint: usize) -> String {
    format!("rigid_joint{joint}_rad")
}

pub(super) fn motor_torque(joint: usize) -> String {
    format!("motor{joint}_torque_n_m")
}

pub(super) fn motor_rate(joint: usize) -> String {
    format!("motor{joint}_rate_rad_s")
}

pub(super) fn position(axis: &str, link: usize, node: usize) -> String {
    format!("{axis}{link}_{node}_m")
}

pub(super) fn moment(link: usize, node: usize) -> String {
    format!("m{link}_{node}_n_m")
}

/// Columns of one quantity, one for each joint or link.
pub(super) fn each<'a>(
    name: impl Fn(usize) -> String,
    columns: impl Iterator<Item = &'a Vec<f64>>,
) -> ColumnGroup<'a> {
    let named = |(number, values): (usize, &'a Vec<f64>)| Column { name: name(number + 1), values };
    ColumnGroup { columns: columns.enumerate().map(named).collect() }
}

/// One column, with decimals for its own peak.
pub(super) fn one(name: String, values: &[f64]) -> ColumnGroup<'_> {
    ColumnGroup { columns: vec![Column { name, values }] }
}

/// Names of the files of an arm's run, summary.json last.
fn file_names(outputs: &RunOutputs, solution: &ArmSolution) -> Vec<&'static str> {
    let has_motor = solution.joints.iter().any(|joint| joint.motor.is_some());
    let on_demand = [
        (MOTOR.0, has_motor),
        (DEFLECTIONS.file, outputs.deflections),
        (MOMENTS.file, outputs.moments),
    ];
    [TORQUES, RIGID_TORQUES, JOINT_ANGLES, CHORD_ANGLES, TIP.0, REACTIONS, NODES.0, POSITIONS]
        .into_iter()
        .chain(on_demand.into_iter().filter_map(|(name, is_there)| is_there.then_some(name)))
        .filter(|name| outputs.has(name))
        .chain([SUMMARY])
        .collect()
}

impl RunOutputs {
    /// Number of the files of an arm's run.
    pub fn arm_files(&self, solution: &ArmSolution) -> usize {
        file_names(self, solution).len()
    }

    /// Writes the files of an arm's solution, and the `page` of the run if there is one, into `folder`: all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write_arm(
        &self,
        folder: OutputFolder,
        solution: &ArmSolution,
        (summary, page): (&Summary, Option<&str>),
    ) -> Result<(), FolderError> {
        let times = self.rows(&solution.grid);
        for (name, table) in Self::histories(solution) {
            if self.has(name) {
                folder.file(name, |out| write_rows(out, &times, &table, self.digits))?;
            }
        }
        let times = self.nodal_rows(&solution.grid);
        for (name, columns) in self.nodal(solution) {
            let table = [ColumnGroup { columns }];
            folder.file(name, |out| write_rows(out, &times, &table, self.digits))?;
        }
        folder.file(NODES.0, |out| {
            write_nodes(out, &solution.arm, solution.links.iter().map(|link| &link.nodes_m))
        })?;
        if let Some(page) = page {
            folder.file(REPORT, |out| out.write_all(page.as_bytes()))?;
        }
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &RESULT_FILES)
    }

    /// The tables over the whole window.
    fn histories(solution: &ArmSolution) -> Vec<(&'static str, Table<'_>)> {
        let (joints, links) = (&solution.joints, &solution.links);
        let torques = joints.iter().map(|joint| &joint.torque_n_m);
        let rigid = joints.iter().map(|joint| &joint.rigid_torque_n_m);
        let mut angles = Table::new();
        let mut chords = Table::new();
        let mut reactions = Table::new();
        let mut motors = Table::new();
        for (number, (joint, link)) in (1..).zip(joints.iter().zip(links)) {
            let [angle, rate, acceleration] = &joint.angle;
            angles.push(one(joint_angle(number), angle));
            angles.push(one(joint_rate(number), rate));
            angles.push(one(format!("joint{number}_acceleration_rad_s2"), acceleration));
            angles.push(one(rigid_joint_angle(number), &joint.rigid_angle_rad));
            let [angle, rate, acceleration] = &link.chord;
            chords.push(one(format!("angle{number}_rad"), angle));
            chords.push(one(format!("rate{number}_rad_s"), rate));
            chords.push(one(format!("acceleration{number}_rad_s2"), acceleration));
            chords.push(one(format!("length{number}_m"), &link.chord_length_m));
            let [x, y] = &joint.force_n;
            reactions.push(one(format!("force{number}_x_n"), x));
            reactions.push(one(format!("force{number}_y_n"), y));
            if let Some(motor) = &joint.motor {
                let MotorHistories { torque_n_m, angle_rad, rate_rad_s, power_w } = motor;
                motors.push(one(motor_torque(number), torque_n_m));
                motors.push(one(format!("motor{number}_angle_rad"), angle_rad));
                motors.push(one(motor_rate(number), rate_rad_s));
                motors.push(one(format!("motor{number}_power_w"), power_w));
            }
        }
        let mut tables = vec![
            (TORQUES, vec![each(torque, torques)]),
            (RIGID_TORQUES, vec![each(rigid_torque, rigid)]),
            (JOINT_ANGLES, angles),
            (CHORD_ANGLES, chords),
            (REACTIONS, reactions),
            (TIP.0, tip_table(&solution.tip)),
        ];
        if !motors.is_empty() {
            tables.push((MOTOR.0, motors));
        }
        tables
    }

    /// The tables at the nodes, over the whole window.
    fn nodal<'a>(&self, solution: &'a ArmSolution) -> Vec<(&'static str, NodalTable<'a>)> {
        let mut tables = vec![(POSITIONS, Vec::new())];
        if self.deflections {
            tables.push((DEFLECTIONS.file, Vec::new()));
        }
        if self.moments {
            tables.push((MOMENTS.file, Vec::new()));
        }
        for (name, columns) in &mut tables {
            for (number, link) in (1..).zip(&solution.links) {
                // A link that has fewer nodes than another has not all of a list.
                let is_there = |node: &usize| *node < link.nodes_m.len();
                for node in self.nodes_of(&link.nodes_m).into_iter().filter(is_there) {
                    match *name {
                        POSITIONS => {
                            for (axis, values) in ["x", "y"].iter().zip(&link.positions_m[node]) {
                                columns.push(Column { name: position(axis, number, node), values });
                            }
                        }
                        name if name == DEFLECTIONS.file => {
                            let name = format!("w{number}_{node}_m");
                            columns.push(Column { name, values: &link.deflections_m[node] });
                        }
                        _ => {
                            let values = &link.moments_n_m[node];
                            columns.push(Column { name: moment(number, node), values });
                        }
                    }
                }
            }
        }
        tables
    }
}

/// Columns of the tip's motion.
pub(super) fn tip_table(tip: &[[Vec<f64>; 3]; 2]) -> Table<'_> {
    let orders = ["", "velocity_", "acceleration_"].into_iter().zip(["m", "m_s", "m_s2"]);
    let columns = orders.enumerate().flat_map(|(order, (word, unit))| {
        let of = |axis: usize| one(format!("{word}{}_{unit}", ["x", "y"][axis]), &tip[axis][order]);
        [of(0), of(1)]
    });
    columns.collect()
}

/// `nodes.csv`: every node of every link with its distance from the link's joint.
pub(super) fn write_nodes<'a>(
    out: &mut (dyn std::io::Write + Send),
    arm: &Arm,
    nodes_m: impl Iterator<Item = &'a Vec<f64>>,
) -> std::io::Result<()> {
    let format = Digits::Full.for_peak(arm.length_m());
    let mut table = csv::Writer::from_writer(out);
    table.write_record(ARM_NODES)?;
    for (number, (nodes_m, own)) in (1..).zip(nodes_m.zip(arm.links())) {
        for (node, x_m) in nodes_m.iter().enumerate() {
            let mut position = Vec::new();
            format.write(&mut position, *x_m);
            let (number, node) = (number.to_string(), node.to_string());
            let name = own.name.as_deref().unwrap_or_default();
            table.write_record([number.as_bytes(), node.as_bytes(), &position, name.as_bytes()])?;
        }
    }
    table.flush()
}

/// The arm and its links, in SI.
pub(super) fn arm_record(arm: &Arm, elements: impl IntoIterator<Item = usize>) -> Value {
    let links = arm.links().iter().zip(elements).map(|(own, elements)| {
        json!({
            "name": own.name,
            "elements": elements,
            "link": LinkRecord::of_parts(&own.link),
            "drive": own.link.drive(),
        })
    });
    json!({
        "length_m": arm.length_m(),
        "gravity_m_s2": arm.gravity_m_s2(),
        "elbow": arm.elbow(),
        "links": links.collect::<Vec<Value>>(),
    })
}

/// The numbers of a joint, its angles at the ends among them.
fn joint_record(joint: &JointMetrics) -> Map<String, Value> {
    let mut record = joint.by_name();
    let [start_rad, end_rad] = joint.end_angles_rad;
    record.insert("start_angle_rad".to_owned(), start_rad.into());
    record.insert("end_angle_rad".to_owned(), end_rad.into());
    record
}

impl Summary {
    /// The summary of an arm's solution.
    pub fn of_arm(inputs: RunInputs, run: &ArmRun<'_>, outputs: &RunOutputs) -> Self {
        let ArmRun { solution, metrics, limits: given, exceeded, verification, remarks } = *run;
        let arm = &solution.arm;
        let limits = exceeded.iter().map(Notice::from);
        let (grid, path) = (&solution.grid, &solution.path);
        let (first, last) = path.moving_samples();
        let iteration = solution.findings.iteration;
        let mut values = json!({
            "arm": arm_record(arm, solution.elements()),
            "motion": {
                "given": match path.prescribed() {
                    Prescribed::Tip => "tip",
                    Prescribed::Angles => "angles",
                },
                "moves_from_s": path.grid().time_s(first),
                "moves_until_s": path.grid().time_s(last),
                "peak_velocity_m_s": metrics.peak_tip_velocity_m_s.value,
                "peak_acceleration_m_s2": metrics.peak_tip_acceleration_m_s2.value,
            },
            "analysis": {
                "tolerance": solution.analysis.tolerance(),
                "tip_tolerance": solution.analysis.tip_tolerance(),
                "step_s": grid.step_s,
                "window_start_s": grid.time_s(0),
                "window_end_s": grid.end_s(),
                "period_s": solution.period_s,
                "cutoff_hz": solution.cutoff_hz,
                "first_zero_per_s": solution.first_zero_per_s,
            },
            "results": {
                "farthest_m": solution.way_m,
                "joints": metrics.joints.iter().map(joint_record).collect::<Vec<_>>(),
            },
            "errors": { "tip": solution.expected_tip_error(), "joints": solution.errors },
            "second_order": {
                "order": solution.findings.order,
                "iterations": iteration.iterations,
                "contraction": iteration.contraction,
                "largest_slopes":
                    solution.links.iter().map(|link| link.largest_slope).collect::<Vec<f64>>(),
                "torque_change": iteration.second_order_change,
                "left_out": solution.findings.left_out.flatten(),
                "fallback": solution.findings.fallback,
            },
        });
        let given: Vec<Option<Value>> = given.iter().map(Limits::stored).collect();
        if given.iter().any(Option::is_some) {
            values["limits"] = json!(given);
        }
        Self {
            values,
            verification: Some(verification.map(|own| own.checks.clone())),
            warnings: solution.warnings.iter().map(Notice::from).chain(limits).collect(),
            remarks: Some(remarks.iter().map(Notice::from).collect()),
            files: file_names(outputs, solution).into_iter().map(str::to_owned).collect(),
            ..Self::titled("solve", inputs, arm.title())
        }
    }
}
