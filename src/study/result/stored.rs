//! The content of a result folder, read back, and the differences of a repetition from its run.

use std::fmt::Display;
use std::io::{self, BufRead, Read as _};

use serde::{Deserialize, Serialize};

use super::errors::CoarseMesh;
use super::limits::{Check, Exceeded, Limits};
use super::remark::Remark;
use super::tip_error::{LateTarget, StoredTarget};
use crate::beam::Mesh;
use crate::compare::Table;
use crate::elastica::SecondOrder;
use crate::inverse::SolutionWarning;
use crate::link::{Arm, Link};
use crate::modal::ThickLink;
use crate::motion::{Prescribed, TipMotionHistories};
use crate::numeric::largest;
use crate::response::SimulationWarning;

/// The content of a run's folder. All histories have as many values as `times_s`, except those of nodes.
#[derive(Debug, Clone)]
pub struct StoredRun {
    /// Command, version, files and arguments of the run.
    pub origin: Origin,
    /// Name of its folder.
    pub name: String,
    /// Times of all histories in s, evenly spaced.
    pub times_s: Vec<f64>,
    /// The joints, the inner one first.
    pub joints: Vec<StoredJoint>,
    /// The carriage of an arm.
    pub carriage: Option<StoredCarriage>,
    /// The links, the inner one first.
    pub links: Vec<StoredLink>,
    /// The motion of a single link along its arc.
    pub arc: Option<StoredArc>,
    /// Times of the nodes' places in s, some or all of those of the run; empty for a single link.
    pub nodal_times_s: Vec<f64>,
    /// x and y of the tip in m; empty for a single link.
    pub tip_m: [Vec<f64>; 2],
    /// The wanted tip of a simulation, if it had one.
    pub target: Option<StoredTarget>,
    /// Quantity that the path of an arm prescribes; absent for a simulation or a single link.
    pub prescribed: Option<Prescribed>,
    /// Times in s of the start and end of the wanted motion; absent for a simulation.
    pub moving_s: Option<(f64, f64)>,
    /// Gravity along x and y in m/s²: 0 in a horizontal plane.
    pub gravity_m_s2: [f64; 2],
    /// Numbers of the summary by name with the unit at its end: `farthest_m`. Numbers of an arm's joints are in
    /// `joints`.
    pub readings: Vec<(String, f64)>,
    /// Checks of the answer; empty without verification.
    pub checks: Vec<Check>,
    /// Warnings.
    pub warnings: Vec<Notice>,
    /// Remarks on unusual values.
    pub remarks: Vec<Notice>,
}

/// The motion of a single link, whose places are distances along the arc of a straight link.
#[derive(Debug, Clone)]
pub struct StoredArc {
    /// The mesh of the answer.
    pub mesh: Mesh,
    /// Second-order terms that the solver counted; all of them in a simulation of the elastica.
    pub second_order: SecondOrder,
    /// Number of flexible modes in a reduced link; absent if the link keeps all modes.
    pub kept_modes: Option<usize>,
    /// Direction of the chord in rad where the tip's displacement is 0: hub angles are absolute with gravity.
    pub origin_rad: f64,
    /// Motion of the tip.
    pub tip: TipMotionHistories,
}

/// One joint: histories, and its numbers in the summary.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredJoint {
    /// Torque in N m that turns its link, and the link before the other way.
    pub torque_n_m: Vec<f64>,
    /// Angle in rad of its link's root against the tip of the link before, of the first joint against x.
    pub angle_rad: Vec<f64>,
    /// Rate of the joint angle in rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Acceleration of the joint angle in rad/s².
    pub acceleration_rad_s2: Vec<f64>,
    /// Torque in N m that the rigid link or arm would need; absent for a simulation.
    pub rigid_torque_n_m: Option<Vec<f64>>,
    /// Angle in rad of the rigid link's or arm's joint; absent for a simulation.
    pub rigid_angle_rad: Option<Vec<f64>>,
    /// Its motor, if it has a drive.
    pub motor: Option<StoredMotor>,
    /// Its numbers by name with the unit at its end: `peak_torque_n_m`.
    pub readings: Vec<(String, f64)>,
    /// Errors of each quantity, such as `torque`, by kind, such as `mesh`.
    pub errors: Vec<(String, Vec<(String, f64)>)>,
    /// Its limits in the file.
    pub limits: Limits,
}

impl StoredJoint {
    /// Its number of this name, if the summary has it.
    pub fn reading(&self, name: &str) -> Option<f64> {
        self.readings.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
    }
}

/// The carriage of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredCarriage {
    /// Its force in N and its place in m, in place of a torque and an angle.
    pub joint: StoredJoint,
    /// Direction of its rail along x and y, of length 1.
    pub axis: [f64; 2],
}

impl StoredRun {
    /// Place of the first joint in m at a sample, which a carriage moves.
    pub fn base_m(&self, sample: usize) -> [f64; 2] {
        let carriage = self.carriage.as_ref();
        carriage.map_or([0.0; 2], |own| own.axis.map(|part| part * own.joint.angle_rad[sample]))
    }
}

/// One link.
#[derive(Debug, Clone)]
pub struct StoredLink {
    /// Its name, or its number without a name.
    pub name: String,
    /// The link, of an arm with the next joint's body as its payload.
    pub link: Link,
    /// Distance of the nodes from its joint in m, the tip's last.
    pub nodes_m: Vec<f64>,
    /// x and y of the nodes in m, at `nodal_times_s` of the arm; empty for a single link.
    pub positions_m: Vec<[Vec<f64>; 2]>,
    /// Deflection w in m from the tangent line of a single link's hub, of an arm's link from its chord, if the folder has it
    /// for all or some nodes.
    pub deflections_m: Option<StoredNodes>,
    /// Bending moment in N m, if the folder has it.
    pub moments_n_m: Option<StoredNodes>,
}

/// Origin of a result: command, version and inputs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The command: `solve`, `simulate` or `sweep`.
    pub command: String,
    /// Version of the program that made it.
    pub version: String,
    /// Title of the link.
    pub title: String,
    /// Input files in the order of the command line.
    pub inputs: Vec<StoredInput>,
    /// Arguments that shaped the results beside the files, as the program takes them: `--set`,
    /// `payload.mass=0`.
    pub arguments: Vec<String>,
}

/// An input file of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredInput {
    /// Its role: `link`, `motion`, `torque`, `target`, `reference`.
    pub role: String,
    /// Its name without folders.
    pub name: String,
    /// Its SHA-256 in hexadecimal digits.
    pub sha256: String,
}

/// A motor, on its own side of the gear.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredMotor {
    /// Torque in N m.
    pub torque_n_m: Vec<f64>,
    /// Rate of the rotor in rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Current in A, if the drive has its torque constant.
    pub current_a: Option<Vec<f64>>,
    /// Voltage in V, if the drive has its resistance, too.
    pub voltage_v: Option<Vec<f64>>,
}

/// A quantity at some nodes over time.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredNodes {
    /// Numbers of the nodes, ascending.
    pub nodes: Vec<usize>,
    /// Times in s, some or all of those of the run.
    pub times_s: Vec<f64>,
    /// One history a node.
    pub histories: Vec<Vec<f64>>,
}

impl StoredNodes {
    /// Largest absolute value of all histories.
    pub fn peak(&self) -> f64 {
        self.histories.iter().map(|history| largest(history)).fold(0.0, f64::max)
    }
}

/// A warning or remark in words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Notice {
    /// Its kind: `short lead`.
    pub kind: String,
    /// Its text.
    pub message: String,
    /// Remedy.
    pub hint: String,
}

impl Notice {
    /// A warning of a kind, with its text and a remedy.
    pub fn new(kind: &str, message: impl Display, hint: &str) -> Self {
        Self { kind: kind.to_owned(), message: message.to_string(), hint: hint.to_owned() }
    }

    /// The notice in the words of an arm's first joint.
    #[must_use]
    pub fn worded(self, arm: &Arm) -> Self {
        let [message, hint] = [&self.message, &self.hint].map(|text| arm.worded(text));
        Self { message, hint, ..self }
    }
}

macro_rules! notices {
    ($($of:ty),*) => {
        $(impl From<&$of> for Notice {
            fn from(own: &$of) -> Self {
                Self::new(own.kind(), own, own.hint())
            }
        }

        impl From<$of> for Notice {
            fn from(own: $of) -> Self {
                Self::from(&own)
            }
        })*
    };
}

// Every remark or warning for the user becomes a notice here.
notices!(CoarseMesh, Exceeded, LateTarget, Remark);
notices!(SimulationWarning, SolutionWarning, ThickLink);

/// The table of a sweep.
#[derive(Debug, Clone)]
pub struct StoredSweep {
    /// Name of the file.
    pub name: String,
    /// Command, version, files and arguments of the sweep; absent for a table without record.
    pub origin: Option<Origin>,
    /// The link of the first case, or the links of its arm; empty for a table without record.
    pub links: Vec<Link>,
    /// The limits of the first case: of each joint, then of an arm's carriage; empty for a table without record.
    pub limits: Vec<Limits>,
    /// SI units of the varied values, in the first columns of the table; empty for a key without unit.
    pub units: Vec<String>,
    /// The whole table: a row for each case.
    pub table: Table,
}

/// Longest line in bytes; a longer one counts as several.
const LONGEST_LINE: u64 = 1 << 24;

/// One file of a run, or of its repetition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RepeatedFile {
    /// Its name.
    pub name: String,
    /// The result.
    pub outcome: Repeated,
}

/// The result for a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Repeated {
    /// The run and its repetition have the same bytes.
    Same,
    /// Both have the file, with other bytes.
    Differs(LineDifference),
    /// The run lacks the file.
    Missing,
    /// Only the run has it.
    Extra,
}

/// Where two texts differ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LineDifference {
    /// Number of the first line that differs, from 1.
    pub line: u64,
    /// The run's line with its line end; absent after the end of the run's text.
    pub run: Option<Vec<u8>>,
    /// The repetition's line; absent after the end of its text.
    pub repetition: Option<Vec<u8>>,
    /// Number of lines that differ from the line of the same number.
    pub differing: u64,
    /// Number of lines of the longer text.
    pub lines: u64,
}

/// Compares the texts of a run and of its repetition line by line. Returns nothing if all bytes are the
/// same.
///
/// ```
/// use flexlink::result::line_difference;
/// let found = line_difference(&b"a\nb\nc\n"[..], &b"a\nB\n"[..])?.unwrap();
/// assert_eq!((found.line, found.differing, found.lines), (2, 2, 3));
/// assert_eq!(found.run.as_deref(), Some(&b"b\n"[..]));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Those of the readers.
pub fn line_difference(
    mut run: impl BufRead,
    mut repetition: impl BufRead,
) -> io::Result<Option<LineDifference>> {
    let mut found: Option<LineDifference> = None;
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for line in 1.. {
        read_line(&mut run, &mut a)?;
        read_line(&mut repetition, &mut b)?;
        if a.is_empty() && b.is_empty() {
            break;
        }
        if let Some(found) = &mut found {
            found.differing += u64::from(a != b);
            found.lines = line;
        } else if a != b {
            let some = |text: &[u8]| (!text.is_empty()).then(|| text.to_vec());
            let (run, repetition) = (some(&a), some(&b));
            found = Some(LineDifference { line, run, repetition, differing: 1, lines: line });
        }
    }
    Ok(found)
}

/// Reads the next line with its end; nothing if the text has ended.
fn read_line(text: &mut impl BufRead, line: &mut Vec<u8>) -> io::Result<usize> {
    line.clear();
    text.take(LONGEST_LINE).read_until(b'\n', line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(run: &str, repetition: &str) -> Option<LineDifference> {
        line_difference(run.as_bytes(), repetition.as_bytes()).unwrap()
    }

    #[test]
    fn the_same_bytes_have_no_difference() {
        for text in ["", "a", "a\n", "a\n\nb\r\n"] {
            assert_eq!(difference(text, text), None);
        }
    }

    #[test]
    fn the_first_line_that_differs_is_told_and_all_are_counted() {
        let found = difference("a\nb\nc\nd\n", "a\nB\nc\nD\n").unwrap();
        assert_eq!((found.line, found.differing, found.lines), (2, 2, 4));
        assert_eq!(found.run.as_deref(), Some(&b"b\n"[..]));
        assert_eq!(found.repetition.as_deref(), Some(&b"B\n"[..]));
    }

    #[test]
    fn a_text_that_ends_early_or_without_a_line_end_differs() {
        let found = difference("a\n", "a\nb\nc\n").unwrap();
        assert_eq!((found.line, found.differing, found.lines), (2, 2, 3));
        assert_eq!((found.run, found.repetition.as_deref()), (None, Some(&b"b\n"[..])));
        let found = difference("a\nb\n", "a\nb").unwrap();
        assert_eq!((found.line, found.differing, found.lines), (2, 1, 2));
        let found = difference("a\r\n", "a\n").unwrap();
        assert_eq!(found.line, 1);
    }
}
