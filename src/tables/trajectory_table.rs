use std::io::{self, Write};

use super::number::Digits;
use super::time_format::time_format;
use crate::motion::MotionColumns;

/// Writes a trajectory as `solve` reads it: time in s and, where they are given, acceleration,
/// velocity and displacement in SI.
///
/// # Errors
/// Those of `out`.
pub fn write_trajectory(
    out: &mut impl Write,
    columns: &MotionColumns,
    digits: Digits,
) -> io::Result<()> {
    let given = [
        ("acceleration", &columns.acceleration_m_s2),
        ("velocity", &columns.velocity_m_s),
        ("displacement", &columns.displacement_m),
    ];
    let given: Vec<_> =
        given.into_iter().filter_map(|(name, values)| Some((name, values.as_ref()?))).collect();
    let names: Vec<&str> = given.iter().map(|(name, _)| *name).collect();
    let formats: Vec<_> =
        given.iter().map(|(_, values)| digits.for_peak(crate::numeric::largest(values))).collect();
    let time_s = &columns.time_s;
    let time = time_format(|k| time_s[k], time_s.len());
    let mut text = format!("time,{}\n", names.join(",")).into_bytes();
    for (k, time_s) in time_s.iter().enumerate() {
        time.write(&mut text, *time_s);
        for ((_, values), format) in given.iter().zip(&formats) {
            text.push(b',');
            format.write(&mut text, values[k]);
        }
        text.push(b'\n');
    }
    out.write_all(&text)
}
