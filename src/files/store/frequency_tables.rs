//! The files of `modes` and `frf`: every column's name and unit, once.

use std::f64::consts::TAU;
use std::io::{self, Write};

use num_complex::Complex64;
use serde_json::{Map, Value, json};

use super::folder::{FolderError, OutputFolder};
use super::json::json as as_text;
use crate::beam::Mesh;
use crate::csv::{Digits, write_columns};
use crate::link::Link;
use crate::modal::Shape;
use crate::model::FrequencyResponse;
use crate::numeric::magnitude;
use crate::response::{ArmResponses, ArmShapes, PoseMode, SettledModes};
use crate::result::{LinkZeros, ModesResult, Setting};

/// Names of all files that `modes` may write.
const OWNED: [&str; 4] = [MODES, SHAPES, HELD, ZEROS];
const MODES: &str = "modes.csv";
const SHAPES: &str = "mode_shapes.csv";
const HELD: &str = "held_modes.csv";
const ZEROS: &str = "zeros.csv";

/// A number of a node in a shape.
type OfNode = fn(&Mesh, &Shape, usize) -> f64;

/// A number of a mode, from the mode and its mesh error.
type ModeNumber = fn(&PoseMode, f64) -> f64;

/// Columns of a mode. A mode that leaves the pose has a growth rate and no frequency (NaN).
const NUMBERS: [(&str, ModeNumber); 6] = [
    ("omega_rad_s", |mode, _| mode.square_per_s2.sqrt()),
    ("frequency_hz", |mode, _| mode.square_per_s2.sqrt() / TAU),
    ("period_s", |mode, _| (mode.square_per_s2.sqrt() / TAU).recip()),
    (
        GROWTH,
        |mode, _| {
            if mode.square_per_s2 < 0.0 { (-mode.square_per_s2).sqrt() } else { f64::NAN }
        },
    ),
    (DAMPING, |mode, _| mode.damping_ratio.unwrap_or(f64::NAN)),
    ("mesh_error", |_, error| error),
];
const GROWTH: &str = "growth_per_s";
const DAMPING: &str = "damping_ratio";

/// The columns of modes. Without gravity nothing grows, and for a straight link in a pose the program computes no
/// damping.
fn columns_of(setting: &Setting, own: &SettledModes) -> Vec<(String, Vec<f64>)> {
    let numbers = NUMBERS.iter().filter(|(name, _)| match setting {
        Setting::Weightless => *name != GROWTH,
        Setting::Straight { .. } => *name != DAMPING,
        Setting::AtRest { .. } => true,
    });
    let column = |of: &ModeNumber| {
        own.modes.iter().zip(&own.errors).map(|(mode, error)| of(mode, *error)).collect()
    };
    numbers.map(|(name, of)| ((*name).to_owned(), column(of))).collect()
}

impl ModesResult {
    /// Writes modes.csv, `mode_shapes.csv`, `held_modes.csv` and zeros.csv: all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(&self, folder: OutputFolder, digits: Digits) -> Result<(), FolderError> {
        folder.file(MODES, |out| self.write_list(out, &self.free, digits))?;
        folder.file(HELD, |out| self.write_list(out, &self.held, digits))?;
        folder.file(SHAPES, |out| match &self.shapes {
            Some(shapes) => write_shapes(out, shapes, digits),
            None => self.write_level_shapes(out, digits),
        })?;
        folder.file(ZEROS, |out| self.write_zeros(out, digits))?;
        folder.commit(ZEROS, &OWNED)
    }

    /// Writes a row for each mode; in a pose, with the turn of each joint.
    fn write_list(
        &self,
        out: &mut (dyn Write + Send),
        own: &SettledModes,
        digits: Digits,
    ) -> io::Result<()> {
        let numbers: Vec<f64> = (1..=own.modes.len()).map(|mode| mode as f64).collect();
        let mut columns = columns_of(&self.setting, own);
        for joint in 0..own.modes.first().map_or(0, |mode| mode.joints.len()) {
            let turns = own.modes.iter().map(|mode| mode.joints[joint]).collect();
            columns.push((format!("joint{}", joint + 1), turns));
        }
        write_columns(out, Some(("mode", &numbers)), &borrowed(&columns), digits)
    }

    /// Writes a row for each node of a link without gravity: its displacement across the link in each mode with the hub
    /// free, and the part of it that moves rigidly with the hub; the slope of the link; the same with the hub held.
    fn write_level_shapes(&self, out: &mut (dyn Write + Send), digits: Digits) -> io::Result<()> {
        let Some(mesh) = self.meshes.first() else { return Ok(()) };
        let mut columns = vec![("x_m".to_owned(), mesh.nodes_m().to_vec())];
        let displacement: OfNode = |mesh, shape, node| shape.displacement(mesh, node);
        let others: [(&str, OfNode); 2] = [
            ("_rigid", |mesh, shape, node| mesh.rigid(node)[0] * shape.hub_angle),
            ("_slope", |mesh, shape, node| shape.total(mesh, node)[1]),
        ];
        for (name, own, parts) in [
            ("mode", &self.free, &[("", displacement)][..]),
            ("mode", &self.free, &others),
            ("held", &self.held, &[("", displacement), others[0], others[1]]),
        ] {
            for (number, mode) in (1..).zip(&own.modes) {
                let Some(shape) = &mode.of_link else { continue };
                columns.extend(parts.iter().map(|(part, of)| {
                    let values = (0..mesh.nodes_m().len()).map(|node| of(mesh, shape, node));
                    (format!("{name}_{number}{part}"), values.collect())
                }));
            }
        }
        write_columns(out, None, &borrowed(&columns), digits)
    }

    /// Writes the zeros of all links, one link after the other; in a pose, with the number of the link.
    fn write_zeros(&self, out: &mut (dyn Write + Send), digits: Digits) -> io::Result<()> {
        let most = |own: &LinkZeros| own.zeros_per_s.len().max(own.blocked_hz.len());
        let links = of_links(self.zeros.iter().map(most));
        let mut columns = zero_columns(&LinkZeros::default());
        for own in &self.zeros {
            for (whole, (_, mut values)) in columns.iter_mut().zip(zero_columns(own)) {
                values.resize(most(own), f64::NAN);
                whole.1.append(&mut values);
            }
        }
        let links = (self.setting != Setting::Weightless).then_some(("link", &links[..]));
        write_columns(out, links, &borrowed(&columns), digits)
    }
}

/// Borrowed columns for writing.
fn borrowed<S: AsRef<str>>(columns: &[(S, Vec<f64>)]) -> Vec<(&str, &[f64])> {
    columns.iter().map(|(name, values)| (name.as_ref(), &values[..])).collect()
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

/// Writes a row for each node of each link: its place at rest, its motion in the modes with free joints, the turn of the
/// link in them, and both in the modes with held rotors.
fn write_shapes(
    out: &mut (dyn Write + Send),
    shapes: &ArmShapes,
    digits: Digits,
) -> io::Result<()> {
    let nodes_m: Vec<f64> = shapes.nodes_m.iter().flatten().copied().collect();
    let links = of_links(shapes.nodes_m.iter().map(Vec::len));
    let mut columns = vec![("x_m".to_owned(), nodes_m)];
    for (axis, letter) in ["x", "y"].into_iter().enumerate() {
        let values = shapes.rest_m.iter().flatten().map(|place| place[axis]);
        columns.push((format!("rest_{letter}_m"), values.collect()));
    }
    for (name, own, parts) in [
        ("mode", &shapes.free, &["x", "y"][..]),
        ("mode", &shapes.free, &["slope"]),
        ("held", &shapes.held, &["x", "y", "slope"]),
    ] {
        for (mode, moved) in (1..).zip(own) {
            columns.extend(parts.iter().map(|part| {
                let number = ["x", "y", "slope"].iter().position(|own| own == part).unwrap_or(0);
                let values = moved.iter().flatten().map(|own| own[number]);
                (format!("{name}_{mode}_{part}"), values.collect())
            }));
        }
    }
    write_columns(out, Some(("link", &links)), &borrowed(&columns), digits)
}

/// The number of the link, from 1, of each row, from the number of rows of each link.
fn of_links(rows: impl Iterator<Item = usize>) -> Vec<f64> {
    (1_u8..).zip(rows).flat_map(|(link, rows)| vec![f64::from(link); rows]).collect()
}

/// One of the transfers of a row.
type Transfer = fn(&FrequencyResponse) -> Complex64;

/// One of the numbers of a transfer.
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

/// The columns of a link's frequency response: frequency, then each transfer, and their relative error due to the
/// mesh. Of a carriage they are force, position and tip per force.
pub fn link_response(
    link: &Link,
    rows: &[FrequencyResponse],
    mesh_errors: Option<&[f64]>,
) -> ResponseColumns {
    let frequencies = rows.iter().map(|row| row.frequency_hz).collect();
    let mut columns = vec![("frequency_hz".to_owned(), frequencies)];
    let transfers: [([&str; 2], Transfer); 3] = [
        (["torque_per_tip_acceleration_kg_m", "force_per_tip_acceleration_kg"], |row| {
            row.torque_per_tip_acceleration_kg_m
        }),
        (["hub_angle_per_tip_displacement_rad_m", "carriage_per_tip_displacement"], |row| {
            row.hub_angle_per_tip_displacement_rad_m
        }),
        (["tip_displacement_per_torque_1_n", "tip_displacement_per_force_m_n"], |row| {
            row.tip_displacement_per_torque_1_n
        }),
    ];
    for (names, transfer) in transfers {
        let name = names[usize::from(link.joint().slides())];
        let name =
            if link.has_station() { name.replace("tip_", "output_") } else { name.to_owned() };
        columns.extend(parts_of(&name, rows.iter().map(transfer)));
    }
    columns.push(("mesh_error".to_owned(), mesh_errors.unwrap_or_default().to_vec()));
    columns
}

/// The columns of an arm's frequency response: frequency; for each joint's torque the displacement of the tip along x
/// and y in 1/N and the angle of each joint in rad/(N m); relative error.
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

/// Writes a frequency response as CSV; fields of unknown values are empty.
///
/// # Errors
/// Errors of `out`.
pub fn write_frequency_response(
    out: &mut (dyn Write + Send),
    columns: &ResponseColumns,
    digits: Digits,
) -> io::Result<()> {
    write_columns(out, None, &borrowed(columns), digits)
}

/// A frequency response as JSON: a list for each column of the CSV, all digits; unknown values are null.
pub fn frequency_response_json(columns: ResponseColumns) -> String {
    as_text(&columns.into_iter().map(|(name, list)| (name, json!(list))).collect::<Map<_, _>>())
}

/// Modes and zeros as JSON; unknown values and the stiffness of a stiff joint are null.
pub fn modes_json(found: &ModesResult) -> String {
    let list = |own: &SettledModes| -> Map<String, Value> {
        let mut columns = columns_of(&found.setting, own);
        columns.retain(|(name, _)| !["omega_rad_s", "period_s"].contains(&&**name));
        columns.into_iter().map(|(name, values)| (name, json!(values))).collect()
    };
    let with_joints = |own: &SettledModes| {
        let joints: Vec<_> = own.modes.iter().map(|mode| &mode.joints).collect();
        let mut list = list(own);
        list.insert("joints".to_owned(), json!(joints));
        list
    };
    let of_link = |own: &LinkZeros| {
        let values = [
            ("zero_per_s", &own.zeros_per_s),
            ("zero_mesh_error", &own.mesh_errors),
            ("blocked_hz", &own.blocked_hz),
            ("blocked_mesh_error", &own.blocked_mesh_errors),
        ];
        values.map(|(name, list)| (name.to_owned(), json!(list)))
    };
    let (free, held) = (&found.free, &found.held);
    as_text(&match &found.setting {
        Setting::Weightless => {
            let mut all = list(free);
            all.extend(found.zeros.iter().flat_map(of_link));
            all.extend(found.meshes.iter().map(|mesh| ("x_m".into(), json!(mesh.nodes_m()))));
            all.insert("shapes".into(), json!(found.displacements()));
            let stiffness =
                ("joint_stiffness_n_m_rad".into(), json!(found.joint_stiffnesses_n_m_rad[0]));
            all.insert("held".into(), std::iter::once(stiffness).chain(list(held)).collect());
            Value::Object(all)
        }
        Setting::Straight { is_kept, angle_rad, outward_m_s2 } => {
            let mut all = json!({
                "angle_rad": angle_rad,
                "outward_m_s2": outward_m_s2,
                "free": list(free),
                "held": list(held),
            });
            let zeros = found.zeros.iter().filter(|_| *is_kept).flat_map(of_link);
            zeros.for_each(|(key, numbers)| all[key] = numbers);
            all
        }
        Setting::AtRest { directions_rad, tip_m, holding_torques_n_m } => json!({
            "angle_rad": directions_rad,
            "tip_m": tip_m,
            "holding_torque_n_m": holding_torques_n_m,
            "joint_stiffness_n_m_rad": found.joint_stiffnesses_n_m_rad,
            "free": with_joints(free),
            "held": with_joints(held),
            "links": found.zeros.iter().map(|own| Map::from_iter(of_link(own))).collect::<Vec<_>>(),
        }),
    })
}
