//! Columns and files that the results of several commands share.

use std::ffi::OsStr;
use std::io::{self, Write};

use crate::beam::{Mesh, NodalHistories};
use crate::csv::{Column, ColumnGroup, Digits, group};
use crate::link::Link;
use crate::motion::TipMotionHistories;

/// Names of all files that a run may leave in its folder, summary.json left out. What an earlier
/// run left and this one does not write goes, so that a folder holds one run.
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

/// Written for a link with a drive.
pub(super) const MOTOR: &str = "motor.csv";

/// The page that `flexlink report` makes of a run: beside another run it would show old numbers.
pub const REPORT: &str = "report.html";

/// Written last: who sees it, sees a whole run.
pub const SUMMARY: &str = "summary.json";

/// Whether a run may write, or remove, a file of this name in its folder.
pub fn is_result_file(name: &OsStr) -> bool {
    RESULT_FILES.iter().chain([&SUMMARY]).any(|file| name == *file)
}

/// Columns of tip.csv.
pub(super) fn tip_groups(tip: &TipMotionHistories) -> Vec<ColumnGroup<'_>> {
    vec![
        group([("tip_displacement_m", &tip.displacement_m)]),
        group([("tip_velocity_m_s", &tip.velocity_m_s)]),
        group([("tip_acceleration_m_s2", &tip.acceleration_m_s2)]),
    ]
}

/// One column a node: `v7_m`.
pub(super) fn nodal_group<'a>(
    letter: &str,
    unit: &str,
    histories: &'a NodalHistories,
) -> ColumnGroup<'a> {
    let columns = histories
        .nodes
        .iter()
        .zip(&histories.samples)
        .map(|(node, values)| Column { name: format!("{letter}{node}_{unit}"), values });
    ColumnGroup { columns: columns.collect() }
}

/// `nodes.csv`: every node of the mesh with the segment that ends there (node 0: begins there),
/// by name, or by number where it has none. Places have all their digits: the mesh is made of them
/// again where a run is read back.
pub(super) fn write_nodes(
    out: &mut (dyn Write + Send),
    link: &Link,
    mesh: &Mesh,
) -> io::Result<()> {
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
