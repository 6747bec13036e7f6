use std::io::{self, Write};

use super::csv_table::group;
use super::csv_table::write_timed;
use super::number::Digits;
use crate::motion::MotionColumns;

/// Writes a trajectory as `solve` reads it: time in s and, where they are given, acceleration,
/// velocity and displacement in SI.
///
/// # Errors
/// Those of `out`.
pub fn write_trajectory(
    out: &mut (impl Write + Send),
    columns: &MotionColumns,
    digits: Digits,
) -> io::Result<()> {
    let given = [
        ("acceleration", &columns.acceleration_m_s2),
        ("velocity", &columns.velocity_m_s),
        ("displacement", &columns.displacement_m),
    ];
    let groups: Vec<_> = given
        .into_iter()
        .filter_map(|(name, values)| Some(group([(name, values.as_ref()?)])))
        .collect();
    let time_s = &columns.time_s;
    write_timed(out, "time", &|k| time_s[k], time_s.len(), &groups, digits)
}
