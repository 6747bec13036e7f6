//! The files of `modes` and `frf`: every column's name and unit, once.

use std::f64::consts::TAU;
use std::io::{self, Write};

use num_complex::Complex64;
use serde_json::{Map, Value, json};

use super::folder::{FolderError, OutputFolder};
use super::json::json as as_text;
use crate::csv::{Digits, write_columns};
use crate::model::FrequencyResponse;
use crate::numeric::magnitude;
use crate::response::{ArmModes, ArmResponses, ArmShapes, SettledModes};
use crate::result::{LinkZeros, ModesResult, PoseModes, PoseSquares};

/// Names of all files that `modes` may write.
const OWNED: [&str; 4] = [MODES, SHAPES, HELD, ZEROS];
const MODES: &str = "modes.csv";
const SHAPES: &str = "mode_shapes.csv";
const HELD: &str = "held_modes.csv";
const ZEROS: &str = "zeros.csv";

impl ModesResult {
    /// Writes modes.csv, `mode_shapes.csv`, `held_modes.csv` and zeros.csv: all or none.
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
        let held = &self.held;
        let own = [("damping_ratio", &held.damping_ratios[..]), ("mesh_error", &held.mesh_errors)];
        folder.file(HELD, |out| write_modes(out, &self.held.omega_rad_s, &own, digits))?;
        let zeros = zero_columns(&self.zeros);
        let zeros: Vec<_> = zeros.iter().map(|(name, values)| (*name, &values[..])).collect();
        folder.file(ZEROS, |out| write_columns(out, None, &zeros, digits))?;
        folder.commit(ZEROS, &OWNED)
    }
}

/// The columns of a link's zeros.
fn zero_columns(zeros: &LinkZeros) -> [(&'static str, Vec<f64>); 5] {
    [
        ("zero_per_s", zeros.zeros_per_s.clone()),
        ("lead_to_1_percent_s", zeros.leads_s()),
        ("blocked_frequency_hz", zeros.blocked_hz.clone()),
        ("mesh_error", zeros.mesh_errors.clone()),
        ("blocked_mesh_error", zeros.blocked_mesh_errors.clone()),
    ]
}

/// Writes modes.csv, `held_modes.csv` and `mode_shapes.csv` of an arm in a pose, and zeros.csv of its links: all or none.
///
/// # Errors
/// [`FolderError`] names the file that cannot be written.
pub fn write_arm_modes(
    folder: OutputFolder,
    (modes, shapes, zeros): (&ArmModes, &ArmShapes, &[LinkZeros]),
    digits: Digits,
) -> Result<(), FolderError> {
    folder.file(MODES, |out| write_settled(out, &modes.free, digits))?;
    folder.file(HELD, |out| write_settled(out, &modes.held, digits))?;
    folder.file(SHAPES, |out| write_shapes(out, shapes, digits))?;
    folder.file(ZEROS, |out| write_zeros(out, zeros, digits))?;
    folder.commit(ZEROS, &OWNED)
}

/// Writes modes of an arm. What leaves the pose has a growth rate alone, what stays where it is turned no period.
fn write_settled(
    out: &mut (dyn Write + Send),
    found: &SettledModes,
    digits: Digits,
) -> io::Result<()> {
    let column = |of: &dyn Fn(usize) -> f64| (0..found.modes.len()).map(of).collect::<Vec<f64>>();
    let square = |k: usize| found.modes[k].square_per_s2;
    let omega_rad_s = column(&|k| square(k).sqrt());
    let growth = column(&|k| if square(k) < 0.0 { (-square(k)).sqrt() } else { f64::NAN });
    let ratios = column(&|k| found.modes[k].damping_ratio.unwrap_or(f64::NAN));
    let joints = found.modes.first().map_or(0, |mode| mode.joints.len());
    let joints: Vec<_> = (0..joints)
        .map(|joint| (format!("joint{}", joint + 1), column(&|k| found.modes[k].joints[joint])))
        .collect();
    let turns = joints.iter().map(|(name, values)| (&name[..], &values[..]));
    let own =
        [("growth_per_s", &growth[..]), ("damping_ratio", &ratios), ("mesh_error", &found.errors)];
    let own: Vec<_> = own.into_iter().chain(turns).collect();
    write_modes(out, &omega_rad_s, &own, digits)
}

/// Writes a row for each node of each link: where it is at rest, and how the modes with free joints move it.
fn write_shapes(
    out: &mut (dyn Write + Send),
    shapes: &ArmShapes,
    digits: Digits,
) -> io::Result<()> {
    let nodes_m: Vec<f64> = shapes.nodes_m.iter().flatten().copied().collect();
    let links = of_links(shapes.nodes_m.iter().map(Vec::len));
    let mut columns = vec![("x_m".to_owned(), nodes_m)];
    let mut both = |name: &dyn Fn(&str) -> String, places: &[Vec<[f64; 2]>]| {
        for (axis, letter) in ["x", "y"].into_iter().enumerate() {
            let values = places.iter().flatten().map(|place| place[axis]);
            columns.push((name(letter), values.collect()));
        }
    };
    both(&|axis| format!("rest_{axis}_m"), &shapes.rest_m);
    for (mode, moved) in (1..).zip(&shapes.free) {
        both(&|axis| format!("mode_{mode}_{axis}"), moved);
    }
    let columns: Vec<_> = columns.iter().map(|(name, values)| (&name[..], &values[..])).collect();
    write_columns(out, Some(("link", &links)), &columns, digits)
}

/// Writes the zeros of one link after those of the other.
fn write_zeros(
    out: &mut (dyn Write + Send),
    zeros: &[LinkZeros],
    digits: Digits,
) -> io::Result<()> {
    let most = |own: &LinkZeros| own.zeros_per_s.len().max(own.blocked_hz.len());
    let links = of_links(zeros.iter().map(most));
    let mut columns = zero_columns(&LinkZeros::default());
    for own in zeros {
        for (whole, (_, mut values)) in columns.iter_mut().zip(zero_columns(own)) {
            values.resize(most(own), f64::NAN);
            whole.1.append(&mut values);
        }
    }
    let columns: Vec<_> = columns.iter().map(|(name, values)| (*name, &values[..])).collect();
    write_columns(out, Some(("link", &links)), &columns, digits)
}

/// The number of the link, from 1, of each row, from the number of rows of each link.
fn of_links(rows: impl Iterator<Item = usize>) -> Vec<f64> {
    (1_u8..).zip(rows).flat_map(|(link, rows)| vec![f64::from(link); rows]).collect()
}

/// Writes number, angular frequency, frequency and period of each mode, then the columns `own`.
fn write_modes(
    out: &mut (dyn Write + Send),
    omega_rad_s: &[f64],
    own: &[(&str, &[f64])],
    digits: Digits,
) -> io::Result<()> {
    let numbers: Vec<f64> = (1..=omega_rad_s.len()).map(|mode| mode as f64).collect();
    let hertz: Vec<f64> = omega_rad_s.iter().map(|omega| omega / TAU).collect();
    let periods: Vec<f64> = hertz.iter().map(|hertz| hertz.recip()).collect();
    let common =
        [("omega_rad_s", omega_rad_s), ("frequency_hz", &hertz[..]), ("period_s", &periods[..])];
    write_columns(out, Some(("mode", &numbers)), &[&common[..], own].concat(), digits)
}

/// One of the transfers of a row.
type Transfer = fn(&FrequencyResponse) -> Complex64;

/// One of the numbers that a transfer is written as.
type Part = fn(Complex64) -> f64;

/// The columns of a frequency response, each with its heading.
pub type ResponseColumns = Vec<(String, Vec<f64>)>;

/// Real and imaginary part, magnitude and phase of a transfer. An infinite one, at a pole of an undamped link, is NaN.
fn parts_of(name: &str, transfer: impl Iterator<Item = Complex64>) -> ResponseColumns {
    let finite: Vec<_> = transfer.map(|x| Some(x).filter(|x| x.is_finite())).collect();
    let parts: [(&str, Part); 4] = [
        ("real", |x| x.re),
        ("imag", |x| x.im),
        ("magnitude", magnitude),
        // Adding 0 removes the sign of a zero: half a turn is always +π.
        ("phase_rad", |x| libm::atan2(x.im + 0.0, x.re)),
    ];
    let cells = |of: Part| finite.iter().map(|x| x.map_or(f64::NAN, of)).collect();
    parts.map(|(part, of)| (format!("{name}_{part}"), cells(of))).into()
}

/// The columns of a link's frequency response: frequency, then each transfer, and the relative error that the mesh causes
/// in them.
pub fn link_response(rows: &[FrequencyResponse], mesh_errors: Option<&[f64]>) -> ResponseColumns {
    let frequencies = rows.iter().map(|row| row.frequency_hz).collect();
    let mut columns = vec![("frequency_hz".to_owned(), frequencies)];
    let transfers: [(&str, Transfer); 3] = [
        ("torque_per_tip_acceleration_kg_m", |row| row.torque_per_tip_acceleration_kg_m),
        ("hub_angle_per_tip_displacement_rad_m", |row| row.hub_angle_per_tip_displacement_rad_m),
        ("tip_displacement_per_torque_1_n", |row| row.tip_displacement_per_torque_1_n),
    ];
    for (name, transfer) in transfers {
        columns.extend(parts_of(name, rows.iter().map(transfer)));
    }
    columns.push(("mesh_error".to_owned(), mesh_errors.unwrap_or_default().to_vec()));
    columns
}

/// The columns of an arm's frequency response: frequency, then for the torque of each joint the displacement of the tip
/// along x and y in 1/N and the angle of each joint in rad/(N m), and the relative error.
pub fn arm_response(found: &ArmResponses) -> ResponseColumns {
    let rows = &found.rows;
    let frequencies = rows.iter().map(|row| row.frequency_hz).collect();
    let mut columns = vec![("frequency_hz".to_owned(), frequencies)];
    let joints = rows.first().map_or(0, |row| row.torques.len());
    for torque in 0..joints {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let name = format!("tip_{name}_per_torque{}_1_n", torque + 1);
            columns.extend(parts_of(&name, rows.iter().map(|row| row.torques[torque].tip_m[axis])));
        }
        for joint in 0..joints {
            let name = format!("joint{}_per_torque{}_rad_n_m", joint + 1, torque + 1);
            let angles = rows.iter().map(|row| row.torques[torque].joints_rad[joint]);
            columns.extend(parts_of(&name, angles));
        }
    }
    columns.push(("mesh_error".to_owned(), found.errors.clone()));
    columns
}

/// Writes a frequency response as CSV; fields of what is not known are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_frequency_response(
    out: &mut (dyn Write + Send),
    columns: &ResponseColumns,
    digits: Digits,
) -> io::Result<()> {
    let columns: Vec<_> = columns.iter().map(|(name, values)| (&name[..], &values[..])).collect();
    write_columns(out, None, &columns, digits)
}

/// A frequency response as JSON: a list for each column of the CSV, all digits; what is not known is null.
pub fn frequency_response_json(columns: ResponseColumns) -> String {
    as_text(&columns.into_iter().map(|(name, list)| (name, json!(list))).collect::<Map<_, _>>())
}

/// Frequencies in Hz of squares ω² in 1/s², and growth rates in 1/s of those below 0; null where there is none.
fn rates(squares_per_s2: impl Iterator<Item = f64> + Clone) -> [Value; 2] {
    let hertz = squares_per_s2.clone().map(|square| (square >= 0.0).then(|| square.sqrt() / TAU));
    let growth = squares_per_s2.map(|square| (square < 0.0).then(|| (-square).sqrt()));
    [json!(hertz.collect::<Vec<_>>()), json!(growth.collect::<Vec<_>>())]
}

/// Modes of an arm in a pose and zeros of its links as JSON; what is not known is null, as is the stiffness of a stiff joint.
pub fn arm_modes_json(found: &ArmModes, zeros: &[LinkZeros]) -> String {
    let list = |own: &SettledModes| {
        let [hertz, growth] = rates(own.modes.iter().map(|mode| mode.square_per_s2));
        let ratios: Vec<_> = own.modes.iter().map(|mode| mode.damping_ratio).collect();
        let joints: Vec<_> = own.modes.iter().map(|mode| &mode.joints).collect();
        json!({
            "frequency_hz": hertz,
            "growth_per_s": growth,
            "damping_ratio": ratios,
            "mesh_error": own.errors,
            "joints": joints,
        })
    };
    let of_link = |own: &LinkZeros| {
        json!({
            "zero_per_s": own.zeros_per_s,
            "zero_mesh_error": own.mesh_errors,
            "blocked_hz": own.blocked_hz,
            "blocked_mesh_error": own.blocked_mesh_errors,
        })
    };
    as_text(&json!({
        "angle_rad": found.directions_rad,
        "tip_m": found.tip_m,
        "holding_torque_n_m": found.holding_torques_n_m,
        "joint_stiffness_n_m_rad": found.joint_stiffnesses_n_m_rad,
        "free": list(&found.free),
        "held": list(&found.held),
        "links": zeros.iter().map(of_link).collect::<Vec<_>>(),
    }))
}

/// Modes of a link in a pose as JSON. What leaves the pose has a growth rate, and null as its frequency.
pub fn pose_modes_json(pose: &PoseModes) -> String {
    let list = |found: &PoseSquares| {
        let [hertz, growth] = rates(found.squares_per_s2.iter().copied());
        json!({
            "frequency_hz": hertz,
            "growth_per_s": growth,
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
    let held = json!({
        "joint_stiffness_n_m_rad": result.held.joint_stiffness_n_m_rad,
        "frequency_hz": hertz(&result.held.omega_rad_s),
        "damping_ratio": result.held.damping_ratios,
        "mesh_error": result.held.mesh_errors,
    });
    as_text(&json!({
        "frequency_hz": hertz(&result.omega_rad_s),
        "damping_ratio": result.damping_ratios,
        "mesh_error": result.mesh_errors,
        "zero_per_s": result.zeros.zeros_per_s,
        "zero_mesh_error": result.zeros.mesh_errors,
        "blocked_hz": result.zeros.blocked_hz,
        "blocked_mesh_error": result.zeros.blocked_mesh_errors,
        "x_m": result.nodes_m,
        "shapes": result.shapes,
        "held": held,
    }))
}
