//! Names of the files of a run.

use std::ffi::OsStr;

/// Files that a run may leave in its folder besides summary.json. A run removes those of an earlier run
/// that it does not write itself, so that a folder holds one run.
pub(super) const RESULT_FILES: [&str; 10] = [
    "torque.csv",
    "rigid_torque.csv",
    "hub_angle.csv",
    "tip.csv",
    MOTOR,
    "nodes.csv",
    "nodal_displacements.csv",
    "nodal_deflections.csv",
    "bending_moments.csv",
    REPORT,
];

/// The motor of a link with a drive.
pub(super) const MOTOR: &str = "motor.csv";

/// The page that `flexlink report` makes of a run; a later run removes it with the other files.
pub const REPORT: &str = "report.html";

/// Written last: where it exists, the run is whole.
pub const SUMMARY: &str = "summary.json";

/// True if a run may write, or remove, a file of this name in its folder.
pub fn is_result_file(name: &OsStr) -> bool {
    RESULT_FILES.iter().chain([&SUMMARY]).any(|file| name == *file)
}
