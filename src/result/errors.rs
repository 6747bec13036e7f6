//! Modes and zeros of a link, errors of a mesh in these and in transfers.

use thiserror::Error;

use crate::beam::Mesh;
use crate::text::significant;

/// Relative error above which the user is warned.
const COARSE: f64 = 1e-2;

/// Relative errors of values `found` on a mesh, measured on elements of half the length; NaN if these
/// have no such value.
pub fn mesh_errors(mesh: &Mesh, found: &[f64], on_halves: &[f64]) -> Vec<f64> {
    let halves = on_halves.iter().copied().chain(std::iter::repeat(f64::NAN));
    let per_change = mesh.error_per_change();
    let error = |(found, half): (&f64, f64)| per_change * (found / half - 1.0).abs();
    found.iter().zip(halves).map(error).collect()
}

/// Warning of a mesh that is too coarse for some values.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CoarseMesh {
    /// Natural frequencies or zeros.
    #[error(
        "from {what} {first} on the mesh is wrong by more than 1 %, at the worst by {worst:.1e} \
         (elements halved)"
    )]
    Numbered {
        /// Name of the values.
        what: &'static str,
        /// Number of the first that is, from 1.
        first: usize,
        /// Largest relative error of all.
        worst: f64,
    },
    /// Transfers over frequency.
    #[error(
        "{}, at the worst by {worst:.1e} at {} Hz (elements halved)",
        match below_hz {
            Some(below_hz) => format!(
                "above {} Hz the mesh is wrong by more than 1 %",
                significant(*below_hz, 4)
            ),
            None => "at all frequencies the mesh is wrong by more than 1 %".into(),
        },
        significant(*at_hz, 4)
    )]
    Band {
        /// Highest frequency in Hz up to which all errors are small; none if the first is not.
        below_hz: Option<f64>,
        /// Largest relative error.
        worst: f64,
        /// Its frequency in Hz.
        at_hz: f64,
    },
}

impl CoarseMesh {
    /// A warning, if one of the `errors` of a numbered list is large.
    pub fn of(what: &'static str, errors: &[f64]) -> Option<Self> {
        let first = 1 + errors.iter().position(|error| *error > COARSE)?;
        let worst = errors.iter().copied().fold(0.0, f64::max);
        Some(Self::Numbered { what, first, worst })
    }

    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        "coarse_mesh"
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "more elements, or mesh.elements = \"auto\""
    }
}

/// The mesh error of transfers over a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandMeshError {
    /// Largest relative error of a transfer.
    pub worst: f64,
    /// Its frequency in Hz.
    pub at_hz: f64,
    /// A warning, if the error is large.
    pub warning: Option<CoarseMesh>,
}

impl BandMeshError {
    /// From pairs of a frequency in Hz, ascending, and the relative error there; none without frequencies.
    pub fn of_errors(errors: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let errors: Vec<_> = errors.into_iter().collect();
        let larger = |known: (f64, f64), own: (f64, f64)| if own.1 > known.1 { own } else { known };
        let (at_hz, worst) = errors.iter().copied().reduce(larger)?;
        let warning = errors.iter().position(|(_, error)| *error > COARSE).map(|first| {
            let below_hz = first.checked_sub(1).map(|last| errors[last].0);
            CoarseMesh::Band { below_hz, worst, at_hz }
        });
        Some(Self { worst, at_hz, warning })
    }
}

/// Modes and zeros of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesResult {
    /// Natural frequencies in rad/s, the rigid rotation left out.
    pub omega_rad_s: Vec<f64>,
    /// Damping ratio of each mode, the hub's friction counted; NaN where it does not vibrate.
    pub damping_ratios: Vec<f64>,
    /// Relative errors that the mesh causes in the natural frequencies; NaN where unknown, as below.
    pub mesh_errors: Vec<f64>,
    /// Zeros of torque → tip.
    pub zeros: LinkZeros,
    /// Distance of each node from the axis in m.
    pub nodes_m: Vec<f64>,
    /// Mass-normalised displacement of each node in 1/√kg, one list a mode.
    pub shapes: Vec<Vec<f64>>,
    /// Modes with the hub held, or the rotor where the link has a drive.
    pub held: HeldModes,
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

/// The modes of a link while its hub is held, or the rotor of its drive.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldModes {
    /// Stiffness of the joint between rotor and hub in N m/rad; infinite for a stiff joint and without a drive.
    pub joint_stiffness_n_m_rad: f64,
    /// Natural frequencies in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// Damping ratio of each mode, as of the free hub.
    pub damping_ratios: Vec<f64>,
    /// Relative errors that the mesh causes in the frequencies.
    pub mesh_errors: Vec<f64>,
}

/// Modes of a link in a pose, with the weight that pulls along it.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseModes {
    /// Direction of the link in rad, counterclockwise from x.
    pub angle_rad: f64,
    /// Gravity outward along the link in m/s².
    pub outward_m_s2: f64,
    /// With the hub free; the first is the link's swing.
    pub free: PoseSquares,
    /// With the rotor held.
    pub held: PoseSquares,
}

/// Natural frequencies by their squares.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSquares {
    /// ω² in 1/s², ascending; below 0 that of a link that leaves its pose.
    pub squares_per_s2: Vec<f64>,
    /// Relative errors that the mesh causes in ω.
    pub mesh_errors: Vec<f64>,
}

impl PoseSquares {
    /// From those found on a mesh and on elements of half the length.
    pub fn of(mesh: &Mesh, squares_per_s2: Vec<f64>, on_halves: &[f64]) -> Self {
        let [own, halves] = [&squares_per_s2[..], on_halves]
            .map(|squares| squares.iter().map(|square| square.abs().sqrt()).collect::<Vec<f64>>());
        Self { mesh_errors: mesh_errors(mesh, &own, &halves), squares_per_s2 }
    }

    /// The same with a swing that nothing drives: exactly 0, where dense algebra leaves round-off.
    #[must_use]
    pub fn with_neutral_swing(mut self) -> Self {
        let swing = self.squares_per_s2.first_mut().into_iter().chain(self.mesh_errors.first_mut());
        swing.for_each(|value| *value = 0.0);
        self
    }
}

impl LinkZeros {
    /// Time in s before the motion at which the torque is 1 % of that at its start, with this zero alone:
    /// ln(100)/z.
    pub fn leads_s(&self) -> Vec<f64> {
        self.zeros_per_s.iter().map(|zero| libm::log(100.0) / zero).collect()
    }

    /// Warnings of errors that the mesh causes.
    pub fn warnings(&self) -> impl Iterator<Item = CoarseMesh> {
        let lists = [("zero", &self.mesh_errors), ("blocked frequency", &self.blocked_mesh_errors)];
        lists.into_iter().filter_map(|(what, errors)| CoarseMesh::of(what, errors))
    }
}

impl ModesResult {
    /// Warnings of errors that the mesh causes.
    pub fn warnings(&self) -> Vec<CoarseMesh> {
        let free = CoarseMesh::of("mode", &self.mesh_errors);
        let held = CoarseMesh::of("held mode", &self.held.mesh_errors);
        free.into_iter().chain(self.zeros.warnings()).chain(held).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Link, uniform};

    #[test]
    fn what_the_halves_do_not_have_has_no_error() {
        let mesh = Mesh::on(&Link::new(uniform()).unwrap(), 4);
        let errors = mesh_errors(&mesh, &[1.015, 2.0], &[1.0]);
        assert!((errors[0] - 0.016).abs() < 1e-15 && errors[1].is_nan());
        assert_eq!(CoarseMesh::of("mode", &[0.01, f64::NAN]), None);
        let found = CoarseMesh::of("mode", &[1e-3, 0.02, f64::NAN, 0.05, 0.04]).unwrap();
        let expected = "from mode 2 on the mesh is wrong by more than 1 %, at the worst by 5.0e-2 (elements halved)";
        assert_eq!(found.to_string(), expected);
    }

    #[test]
    fn a_band_is_right_up_to_the_last_frequency_before_the_first_that_is_wrong() {
        let told = |errors: &[(f64, f64)]| {
            let error = BandMeshError::of_errors(errors.iter().copied()).unwrap();
            error.warning.map(|warning| warning.to_string())
        };
        assert_eq!(BandMeshError::of_errors([]), None);
        assert_eq!(told(&[(1.0, 1e-3), (2.0, 9e-3)]), None);
        let wrong = "the mesh is wrong by more than 1 %, at the worst by";
        assert_eq!(
            told(&[(1.0, 1e-3), (2.0, 2e-3), (3.0, 0.03), (4.0, 1e-3), (5.0, 0.015)]),
            Some(format!("above 2.000 Hz {wrong} 3.0e-2 at 3.000 Hz (elements halved)"))
        );
        assert_eq!(
            told(&[(1.0, 0.03), (2.0, 1e-3)]),
            Some(format!("at all frequencies {wrong} 3.0e-2 at 1.000 Hz (elements halved)"))
        );
    }
}
