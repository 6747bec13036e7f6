use crate::beam::Mesh;
use crate::modal::{DampingLaw, ModalBasis, Mode, Shape};

/// One modal coordinate: `q̈ + c q̇ + ω² q = p u`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coordinate {
    /// ω² in rad²/s²; 0 for the rigid rotation.
    pub(super) square: f64,
    /// c = 2ζω in 1/s.
    pub(super) rate_per_s: f64,
    /// p, the shape's hub angle.
    pub(super) hub_angle: f64,
}

/// Friction and feedback, which act at the hub in proportion to its motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(clippy::struct_field_names, reason = "units")]
pub(super) struct HubReaction {
    /// Torque per hub angle in N m/rad.
    pub(super) stiffness_n_m_rad: f64,
    /// Torque per hub rate in N m s/rad, friction included.
    pub(super) damping_n_m_s_rad: f64,
    /// Torque of the hub's friction per hub rate in N m s/rad.
    pub(super) friction_n_m_s_rad: f64,
}

impl HubReaction {
    /// True without friction and feedback: the modes are not coupled.
    pub(super) fn is_none(&self) -> bool {
        self.stiffness_n_m_rad == 0.0 && self.damping_n_m_s_rad == 0.0
    }

    /// Torque in N m that opposes a motion.
    pub(super) fn torque_n_m(&self, hub_angle: f64, hub_rate: f64) -> f64 {
        self.stiffness_n_m_rad * hub_angle + self.damping_n_m_s_rad * hub_rate
    }
}

/// The link in modal coordinates (Bayo 1987, eqs 11 and 12): rigid rotation first.
///
/// ```text
/// q̈ + diag(2ζω) q̇ + diag(ω²) q + p (k pᵀq + d pᵀq̇) = p u
/// ```
#[derive(Debug, Clone)]
pub(super) struct Equations {
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) shapes: Vec<Shape>,
    pub(super) reaction: HubReaction,
}

impl Equations {
    /// The rigid rotation, the modes of a basis, and the residual mode of those left out.
    pub(super) fn new(
        mesh: &Mesh,
        law: &DampingLaw,
        basis: ModalBasis,
        reaction: HubReaction,
    ) -> Self {
        let rest = basis.residual_mode(mesh);
        let rigid = Coordinate {
            square: 0.0,
            rate_per_s: law.mass_rate_per_s(),
            hub_angle: basis.rigid.hub_angle,
        };
        let (mut coordinates, mut shapes) = (vec![rigid], vec![basis.rigid]);
        for (k, Mode { omega_rad_s, shape }) in basis.modes.into_iter().chain(rest).enumerate() {
            coordinates.push(Coordinate {
                square: omega_rad_s * omega_rad_s,
                rate_per_s: 2.0 * law.modal_ratio(k + 1, omega_rad_s) * omega_rad_s,
                hub_angle: shape.hub_angle,
            });
            shapes.push(shape);
        }
        Self { coordinates, shapes, reaction }
    }

    /// Displacement of the tip per coordinate.
    pub(super) fn tips(&self, mesh: &Mesh) -> Vec<f64> {
        self.shapes.iter().map(|shape| shape.tip_displacement(mesh)).collect()
    }

    /// Period of the first flexible mode in s.
    pub(super) fn first_period_s(&self) -> Option<f64> {
        self.coordinates.get(1).map(|mode| std::f64::consts::TAU / mode.square.sqrt())
    }

    /// Hub angle of coordinates, or hub rate of their rates.
    pub(super) fn hub(&self, q: &[f64]) -> f64 {
        q.iter().zip(&self.coordinates).map(|(q, c)| q * c.hub_angle).sum()
    }

    /// Accelerations of the coordinates under the torque `u`.
    pub(super) fn accelerations(&self, q: &[f64], rate: &[f64], u: f64) -> Vec<f64> {
        let net = u - self.reaction.torque_n_m(self.hub(q), self.hub(rate));
        let own = |k: usize| {
            let Coordinate { square, rate_per_s, hub_angle } = self.coordinates[k];
            hub_angle * net - rate_per_s * rate[k] - square * q[k]
        };
        (0..q.len()).map(own).collect()
    }
}
