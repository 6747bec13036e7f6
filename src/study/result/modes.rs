//! Modes of a link or an arm, and zeros of its links.

use super::errors::{CoarseMesh, Refined};
use super::stored::Notice;
use crate::beam::Mesh;
use crate::link::Arm;
use crate::response::{ArmShapes, SettledModes};

/// Modes of a link or an arm, and zeros of its links.
#[derive(Debug, Clone)]
pub struct ModesResult {
    /// Directions of the links, and the gravity that counts.
    pub setting: Setting,
    /// Modes with all joints free. In poses the first ones, one for each joint, are swings.
    pub free: SettledModes,
    /// Modes with the hub of a link held, or the rotor of each joint with a drive.
    pub held: SettledModes,
    /// Stiffness of each joint between rotor and hub in N m/rad, infinite where it is stiff or has no drive.
    pub joint_stiffnesses_n_m_rad: Vec<f64>,
    /// Zeros of each link without gravity; empty if not wanted.
    pub zeros: Vec<LinkZeros>,
    /// Mesh of each link; empty if only the modes of an arm are wanted.
    pub meshes: Vec<Mesh>,
    /// Shapes in the plane, if wanted in a pose.
    pub shapes: Option<ArmShapes>,
}

/// Directions of vibrating links.
#[derive(Debug, Clone, PartialEq)]
pub enum Setting {
    /// One link without gravity, in any direction.
    Weightless,
    /// One straight link, with the weight that pulls along it.
    Straight {
        /// True if it keeps this direction, on a carriage: the zeros are then those with the weight.
        is_kept: bool,
        /// Direction of the link in rad, counterclockwise from x.
        angle_rad: f64,
        /// Gravity outward along the link in m/s².
        outward_m_s2: f64,
    },
    /// Links at rest, bent by their weight.
    AtRest {
        /// Direction of each link's chord in rad, counterclockwise from x.
        directions_rad: Vec<f64>,
        /// x and y of the tip in m.
        tip_m: [f64; 2],
        /// Torque in N m that holds each joint.
        holding_torques_n_m: Vec<f64>,
    },
}

/// Zeros of one link's torque → tip.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinkZeros {
    /// Zeros ±z in 1/s.
    pub zeros_per_s: Vec<f64>,
    /// Relative errors that the mesh causes in them; NaN where unknown.
    pub mesh_errors: Vec<f64>,
    /// Zeros at real frequencies in Hz: no torque moves the tip there.
    pub blocked_hz: Vec<f64>,
    /// Relative errors that the mesh causes in them.
    pub blocked_mesh_errors: Vec<f64>,
}

impl LinkZeros {
    /// Time in s from 1 % of the torque to its value at the start of the motion, with this zero alone: ln(100)/z.
    pub fn leads_s(&self) -> Vec<f64> {
        self.zeros_per_s.iter().map(|zero| libm::log(100.0) / zero).collect()
    }

    /// Warnings of errors that the mesh causes.
    fn warnings(&self) -> impl Iterator<Item = CoarseMesh> {
        let lists = [("zero", &self.mesh_errors), ("blocked frequency", &self.blocked_mesh_errors)];
        lists.into_iter().filter_map(|(what, own)| CoarseMesh::of(what, own, Refined::Elements))
    }
}

impl ModesResult {
    /// Mass-normalised displacements in 1/√kg of the nodes of a straight link in each mode with the hub free.
    pub fn displacements(&self) -> Vec<Vec<f64>> {
        let modes = self.free.modes.iter().filter_map(|mode| mode.of_link.as_ref());
        self.meshes
            .iter()
            .flat_map(|mesh| modes.clone().map(|own| own.displacements(mesh)))
            .collect()
    }

    /// Warnings of errors that the mesh, or the order of the polynomials, causes. Those of zeros name the link of an arm.
    pub fn warnings(&self, arm: &Arm) -> Vec<Notice> {
        let (held, by) = match self.setting {
            Setting::Weightless => ("held mode", Refined::Elements),
            Setting::Straight { .. } => ("mode with the hub held", Refined::Elements),
            Setting::AtRest { .. } => ("mode with the rotors held", Refined::Orders),
        };
        let zeros = self.zeros.iter().enumerate().flat_map(|(link, own)| {
            own.warnings().map(Notice::from).map(move |own| match &self.zeros[..] {
                [_] => own,
                _ => Notice { message: format!("{}: {}", arm.name_of(link), own.message), ..own },
            })
        });
        let of = |what, own: &SettledModes| CoarseMesh::of(what, &own.errors, by).map(Notice::from);
        of("mode", &self.free).into_iter().chain(zeros).chain(of(held, &self.held)).collect()
    }
}
