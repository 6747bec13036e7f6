//! The files of `modes` and `frf`: every column's name and unit, once.

use std::f64::consts::TAU;
use std::io::{self, Write};

use num_complex::Complex64;
use serde_json::{Map, json};

use super::folder::{FolderError, OutputFolder};
use super::json::json as as_text;
use crate::csv::{Digits, write_columns};
use crate::model::FrequencyResponse;
use crate::numeric::magnitude;
use crate::result::{ModesResult, PoseModes, PoseSquares};

/// Names of all files that `modes` may write.
const OWNED: [&str; 4] = [MODES, SHAPES, HELD, ZEROS];
const MODES: &str = "modes.csv";
const SHAPES: &str = "mode_shapes.csv";
const HELD: &str = "held_modes.csv";
const ZEROS: &str = "zeros.csv";

impl ModesResult {
    /// Writes modes.csv, `mode_shapes.csv` and zeros.csv, for a link with a drive also `held_modes.csv`:
    /// all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(&self, folder: OutputFolder, digits: Digits) -> Result<(), FolderError> {
        let own = [("damping_ratio", &self.damping_ratios[..]), ("mesh_error", &self.mesh_errors)];
        folder.file(MODES, |out| write_modes(out, &self.omega_rad_s, &own, digits))?;
        let names: Vec<String> = (1..=self.shapes.len()).map(|k| format!("mode_{k}")).collect();
        let shapes = names.iter().zip(&self.shapes).map(|(name, shape)| (&name[..], &shape[..]));
        let shapes: Vec<_> = [("x_m", &self.nodes_m[..])].into_iter().chain(shapes).collect();
        folder.file(SHAPES, |out| write_columns(out, None, &shapes, digits))?;
        if let Some(held) = &self.held {
            let own = [("mesh_error", &held.mesh_errors[..])];
            folder.file(HELD, |out| write_modes(out, &held.omega_rad_s, &own, digits))?;
        }
        let zeros = [
            ("zero_per_s", &self.zeros_per_s[..]),
            ("lead_to_1_percent_s", &self.leads_s()),
            ("blocked_frequency_hz", &self.blocked_hz),
            ("mesh_error", &self.zero_mesh_errors),
            ("blocked_mesh_error", &self.blocked_mesh_errors),
        ];
        folder.file(ZEROS, |out| write_columns(out, None, &zeros, digits))?;
        folder.commit(ZEROS, &OWNED)
    }
}

/// Writes number, angular frequency, frequency and period of each mode, then the columns `own`.
fn write_modes(
    out: &mut (dyn Write + Send),
    omega_rad_s: &[f64],
    own: &[(&str, &[f64])],
    digits: Digits,
) -> io::Result<()> {
    let hertz: Vec<f64> = omega_rad_s.iter().map(|omega| omega / TAU).collect();
    let periods: Vec<f64> = hertz.iter().map(|hertz| hertz.recip()).collect();
    let common =
        [("omega_rad_s", omega_rad_s), ("frequency_hz", &hertz[..]), ("period_s", &periods[..])];
    write_columns(out, Some("mode"), &[&common[..], own].concat(), digits)
}

/// One of the transfers of a row.
type Transfer = fn(&FrequencyResponse) -> Complex64;

/// One of the numbers that a transfer is written as.
type Part = fn(Complex64) -> f64;

/// The columns of a frequency response: frequency, then real and imaginary part, magnitude and phase of
/// each transfer, and the relative error that the mesh causes in them. An infinite transfer, at a pole of
/// an undamped link, is NaN.
fn columns(rows: &[FrequencyResponse], mesh_errors: Option<&[f64]>) -> Vec<(String, Vec<f64>)> {
    let frequencies = rows.iter().map(|row| row.frequency_hz).collect();
    let mut columns: Vec<(String, Vec<f64>)> = vec![("frequency_hz".to_owned(), frequencies)];
    let transfers: [(&str, Transfer); 3] = [
        ("torque_per_tip_acceleration_kg_m", |row| row.torque_per_tip_acceleration_kg_m),
        ("hub_angle_per_tip_displacement_rad_m", |row| row.hub_angle_per_tip_displacement_rad_m),
        ("tip_displacement_per_torque_1_n", |row| row.tip_displacement_per_torque_1_n),
    ];
    let parts: [(&str, Part); 4] = [
        ("real", |x| x.re),
        ("imag", |x| x.im),
        ("magnitude", magnitude),
        // Adding 0 removes the sign of a zero: half a turn is always +π.
        ("phase_rad", |x| libm::atan2(x.im + 0.0, x.re)),
    ];
    for (name, transfer) in transfers {
        for (part, of) in parts {
            let finite = |row| Some(transfer(row)).filter(|x| x.is_finite());
            let cells = rows.iter().map(|row| finite(row).map_or(f64::NAN, of)).collect();
            columns.push((format!("{name}_{part}"), cells));
        }
    }
    columns.push(("mesh_error".to_owned(), mesh_errors.unwrap_or_default().to_vec()));
    columns
}

/// Writes the frequency response of a link as CSV; fields of what is not known are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_frequency_response(
    out: &mut (dyn Write + Send),
    rows: &[FrequencyResponse],
    mesh_errors: Option<&[f64]>,
    digits: Digits,
) -> io::Result<()> {
    let columns = columns(rows, mesh_errors);
    let columns: Vec<_> = columns.iter().map(|(name, values)| (&name[..], &values[..])).collect();
    write_columns(out, None, &columns, digits)
}

/// The frequency response of a link as JSON: a list for each column of the CSV, all digits; what is not
/// known is null.
pub fn frequency_response_json(rows: &[FrequencyResponse], mesh_errors: Option<&[f64]>) -> String {
    let lists = columns(rows, mesh_errors).into_iter().map(|(name, list)| (name, json!(list)));
    as_text(&lists.collect::<Map<_, _>>())
}

/// Modes of a link in a pose as JSON. What leaves the pose has a growth rate, and null as its frequency.
pub fn pose_modes_json(pose: &PoseModes) -> String {
    let list = |found: &PoseSquares| {
        let squares = found.squares_per_s2.iter();
        let hertz = squares.clone().map(|square| (*square >= 0.0).then(|| square.sqrt() / TAU));
        let growth = squares.map(|square| (*square < 0.0).then(|| (-square).sqrt()));
        json!({
            "frequency_hz": hertz.collect::<Vec<_>>(),
            "growth_per_s": growth.collect::<Vec<_>>(),
            "mesh_error": found.mesh_errors,
        })
    };
    as_text(&json!({
        "angle_rad": pose.angle_rad,
        "outward_m_s2": pose.outward_m_s2,
        "free": list(&pose.free),
        "held": list(&pose.held),
    }))
}

/// Modes and zeros as JSON; what is not known is null, as is the stiffness of a stiff joint.
pub fn modes_json(result: &ModesResult) -> String {
    let hertz = |omegas: &[f64]| omegas.iter().map(|omega| omega / TAU).collect::<Vec<f64>>();
    let held = result.held.as_ref().map(|held| {
        json!({
            "joint_stiffness_n_m_rad": held.joint_stiffness_n_m_rad,
            "frequency_hz": hertz(&held.omega_rad_s),
            "mesh_error": held.mesh_errors,
        })
    });
    as_text(&json!({
        "frequency_hz": hertz(&result.omega_rad_s),
        "damping_ratio": result.damping_ratios,
        "mesh_error": result.mesh_errors,
        "zero_per_s": result.zeros_per_s,
        "zero_mesh_error": result.zero_mesh_errors,
        "blocked_hz": result.blocked_hz,
        "blocked_mesh_error": result.blocked_mesh_errors,
        "x_m": result.nodes_m,
        "shapes": result.shapes,
        "held": held,
    }))
}
