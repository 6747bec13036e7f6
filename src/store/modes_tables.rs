//! The files of `modes`: every column's name and unit, once.

use std::f64::consts::TAU;

use super::folder::{FolderError, OutputFolder};
use crate::csv::{Digits, PlainColumn, write_plain};
use crate::result::CoarseMesh;

/// What is known of the modes and zeros of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesResult {
    /// Natural frequencies in rad/s, the rigid rotation left out.
    pub omega_rad_s: Vec<f64>,
    /// Damping ratio that the law gives each mode.
    pub damping_ratios: Vec<f64>,
    /// Relative errors that the mesh causes in the natural frequencies; NaN where not known, as below.
    pub mesh_errors: Vec<f64>,
    /// Zeros ±z of torque → tip in 1/s.
    pub zeros_per_s: Vec<f64>,
    /// Relative errors that the mesh causes in these.
    pub zero_mesh_errors: Vec<f64>,
    /// Zeros at real frequencies, in Hz: there no torque moves the tip.
    pub blocked_hz: Vec<f64>,
    /// Relative errors that the mesh causes in these.
    pub blocked_mesh_errors: Vec<f64>,
    /// Distance of each node from the axis in m.
    pub nodes_m: Vec<f64>,
    /// Mass-normalised displacement of each node in 1/√kg, one list a mode.
    pub shapes: Vec<Vec<f64>>,
    /// Modes with the rotor held, where the link has a drive.
    pub held: Option<HeldModes>,
}

/// The modes of a link while the motor holds the rotor of its drive still.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldModes {
    /// Stiffness of the joint between rotor and hub in N m/rad; infinite for a stiff joint.
    pub joint_stiffness_n_m_rad: f64,
    /// Natural frequencies in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// Relative errors that the mesh causes in these.
    pub mesh_errors: Vec<f64>,
}

/// Names of all files that `modes` may write.
const OWNED: [&str; 4] = [MODES, SHAPES, HELD, ZEROS];

const MODES: &str = "modes.csv";
const SHAPES: &str = "mode_shapes.csv";
const HELD: &str = "held_modes.csv";
const ZEROS: &str = "zeros.csv";

impl ModesResult {
    /// How long before the motion the torque is still 1 % of what it is at its start, in s, were
    /// there but this zero: ln(100)/z.
    pub fn leads_s(&self) -> Vec<f64> {
        self.zeros_per_s.iter().map(|zero| libm::log(100.0) / zero).collect()
    }

    /// What there is to warn of.
    pub fn warnings(&self) -> Vec<CoarseMesh> {
        let held = self.held.as_ref().map_or(&[][..], |held| &held.mesh_errors);
        let lists = [
            ("mode", &self.mesh_errors[..]),
            ("zero", &self.zero_mesh_errors),
            ("blocked frequency", &self.blocked_mesh_errors),
            ("mode with the rotor held", held),
        ];
        lists.into_iter().filter_map(|(what, errors)| CoarseMesh::of(what, errors)).collect()
    }

    /// Writes modes.csv, `mode_shapes.csv` and zeros.csv, of a link with a drive also
    /// `held_modes.csv`; all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(&self, folder: OutputFolder, digits: Digits) -> Result<(), FolderError> {
        let mut modes = frequency_columns(&self.omega_rad_s);
        modes.push(PlainColumn::values("damping_ratio", &self.damping_ratios));
        modes.push(PlainColumn::values("mesh_error", &self.mesh_errors));
        folder.file(MODES, |out| write_plain(out, &modes, digits))?;
        let mut shapes = vec![PlainColumn::values("x_m", &self.nodes_m)];
        let named = self.shapes.iter().enumerate();
        shapes
            .extend(named.map(|(k, shape)| PlainColumn::values(&format!("mode_{}", k + 1), shape)));
        folder.file(SHAPES, |out| write_plain(out, &shapes, digits))?;
        if let Some(held) = &self.held {
            let mut modes = frequency_columns(&held.omega_rad_s);
            modes.push(PlainColumn::values("mesh_error", &held.mesh_errors));
            folder.file(HELD, |out| write_plain(out, &modes, digits))?;
        }
        let zeros = [
            PlainColumn::values("zero_per_s", &self.zeros_per_s),
            PlainColumn::values("lead_to_1_percent_s", &self.leads_s()),
            PlainColumn::values("blocked_frequency_hz", &self.blocked_hz),
            PlainColumn::values("mesh_error", &self.zero_mesh_errors),
            PlainColumn::values("blocked_mesh_error", &self.blocked_mesh_errors),
        ];
        folder.file(ZEROS, |out| write_plain(out, &zeros, digits))?;
        folder.commit(ZEROS, &OWNED)
    }
}

/// Number, angular frequency, frequency and period of each mode.
fn frequency_columns(omega_rad_s: &[f64]) -> Vec<PlainColumn> {
    let numbers: Vec<usize> = (1..=omega_rad_s.len()).collect();
    let hertz: Vec<f64> = omega_rad_s.iter().map(|omega| omega / TAU).collect();
    let periods: Vec<f64> = hertz.iter().map(|hertz| hertz.recip()).collect();
    vec![
        PlainColumn::counts("mode", &numbers),
        PlainColumn::values("omega_rad_s", omega_rad_s),
        PlainColumn::values("frequency_hz", &hertz),
        PlainColumn::values("period_s", &periods),
    ]
}
