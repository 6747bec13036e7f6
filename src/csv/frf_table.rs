use std::io::{self, Write};

use num_complex::Complex64;

use super::number::Digits;
use super::plain_table::{PlainColumn, write_plain};
use crate::model::FrequencyResponse;
use crate::numeric::magnitude;

/// One of the transfers of a row.
type Transfer = fn(&FrequencyResponse) -> Complex64;

/// One of the numbers that a transfer is written as.
type Part = fn(Complex64) -> f64;

/// Writes the frequency response of a link: frequency, then real and imaginary part, magnitude and
/// phase of each transfer, and what the mesh makes them wrong by. A transfer that is infinite, at a
/// pole of an undamped link, leaves its fields empty.
///
/// # Errors
/// Those of `out`.
pub fn write_frequency_response(
    out: &mut (impl Write + ?Sized),
    rows: &[FrequencyResponse],
    mesh_errors: Option<&[f64]>,
    digits: Digits,
) -> io::Result<()> {
    let frequencies = rows.iter().map(|row| row.frequency_hz).collect();
    let mut columns = vec![PlainColumn::of_values("frequency_hz", frequencies)];
    let transfers: [(&str, Transfer); 3] = [
        ("torque_per_tip_acceleration_kg_m", |row| row.torque_per_tip_acceleration_kg_m),
        ("hub_angle_per_tip_displacement_rad_m", |row| row.hub_angle_per_tip_displacement_rad_m),
        ("tip_displacement_per_torque_1_n", |row| row.tip_displacement_per_torque_1_n),
    ];
    let parts: [(&str, Part); 4] = [
        ("real", |x| x.re),
        ("imag", |x| x.im),
        ("magnitude", magnitude),
        // Half a turn is +π, whatever the sign of a zero.
        ("phase_rad", |x| libm::atan2(x.im + 0.0, x.re)),
    ];
    for (name, transfer) in transfers {
        for (part, of) in parts {
            let finite = |row| Some(transfer(row)).filter(|x| x.is_finite());
            let cells = rows.iter().map(|row| finite(row).map_or(f64::NAN, of)).collect();
            columns.push(PlainColumn::of_values(&format!("{name}_{part}"), cells));
        }
    }
    columns.push(PlainColumn::values("mesh_error", mesh_errors.unwrap_or_default()));
    write_plain(out, &columns, digits)
}
