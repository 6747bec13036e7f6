//! Modes and zeros of a link, with the errors that its mesh causes.

use super::errors::CoarseMesh;

/// Modes and zeros of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesResult {
    /// Natural frequencies in rad/s, the rigid rotation left out.
    pub omega_rad_s: Vec<f64>,
    /// Damping ratio of each mode.
    pub damping_ratios: Vec<f64>,
    /// Relative errors that the mesh causes in the natural frequencies; NaN where unknown, as below.
    pub mesh_errors: Vec<f64>,
    /// Zeros ±z of torque → tip in 1/s.
    pub zeros_per_s: Vec<f64>,
    /// Relative errors that the mesh causes in them.
    pub zero_mesh_errors: Vec<f64>,
    /// Zeros at real frequencies in Hz: no torque moves the tip there.
    pub blocked_hz: Vec<f64>,
    /// Relative errors that the mesh causes in them.
    pub blocked_mesh_errors: Vec<f64>,
    /// Distance of each node from the axis in m.
    pub nodes_m: Vec<f64>,
    /// Mass-normalised displacement of each node in 1/√kg, one list a mode.
    pub shapes: Vec<Vec<f64>>,
    /// Modes with the rotor held, where the link has a drive.
    pub held: Option<HeldModes>,
}

/// The modes of a link while the motor holds the rotor.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldModes {
    /// Stiffness of the joint between rotor and hub in N m/rad; infinite for a stiff joint.
    pub joint_stiffness_n_m_rad: f64,
    /// Natural frequencies in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// Relative errors that the mesh causes in them.
    pub mesh_errors: Vec<f64>,
}

impl ModesResult {
    /// Time in s before the motion at which the torque is 1 % of that at its start, with this zero alone:
    /// ln(100)/z.
    pub fn leads_s(&self) -> Vec<f64> {
        self.zeros_per_s.iter().map(|zero| libm::log(100.0) / zero).collect()
    }

    /// Warnings of errors that the mesh causes.
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
}
