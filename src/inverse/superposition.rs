use num_complex::Complex64;

use super::dynamics::Dynamics;
use super::error::InversionError;
use crate::beam::{Mesh, NodalTransfer, TipTransfer};
use crate::modal::{AllModesError, MOST_ELEMENTS_OF_ALL_MODES, ModalBasis, Shape};

/// Modes, and what their sum needs of them.
#[derive(Debug, Clone)]
pub(super) struct Superposition {
    rigid: Share,
    modes: Vec<(f64, Share)>,
    /// Static answer of what the modes leave over, per torque; none where that is left out.
    residual: Option<Share>,
}

/// What one shape adds to the link's answer, per torque at the hub.
#[derive(Debug, Clone)]
struct Share {
    /// Hub angle p, which the torque acts on.
    hub_angle: f64,
    tip: f64,
    /// Deflections from the hub's tangent line.
    deflections: Vec<f64>,
    /// Moments that its acceleration needs.
    moments: Vec<f64>,
}

impl Share {
    fn of(mesh: &Mesh, shape: &Shape) -> Self {
        Self {
            hub_angle: shape.hub_angle,
            tip: shape.tip_displacement(mesh),
            deflections: shape.deflections.iter().map(|w| w[0]).collect(),
            moments: shape.moments(mesh),
        }
    }

    fn tip_deflection(&self) -> f64 {
        self.deflections[self.deflections.len() - 1]
    }
}

impl Superposition {
    /// Every mode of the mesh; what they lose to round-off, and motions without mass, answer
    /// statically.
    pub(super) fn of_all(mesh: &Mesh) -> Result<Self, InversionError> {
        let basis = ModalBasis::complete(mesh).map_err(|error| match error {
            AllModesError::TooManyElements { elements } => {
                InversionError::TooManyElements { elements, limit: MOST_ELEMENTS_OF_ALL_MODES }
            }
            AllModesError::NotFinite => InversionError::NotFinite { frequency_hz: 0.0 },
        })?;
        let residual = Share::of(mesh, &basis.static_residual(mesh));
        Ok(Self { residual: Some(residual), ..Self::of(mesh, &basis) })
    }

    /// The rigid rotation and the first `count` flexible modes.
    pub(super) fn of_first(mesh: &Mesh, count: usize) -> Result<Self, InversionError> {
        let basis = ModalBasis::lowest(mesh, count);
        let found = basis.modes.len();
        if found < count {
            return Err(InversionError::NotSoManyModes { asked: count, found });
        }
        Ok(Self::of(mesh, &basis))
    }

    fn of(mesh: &Mesh, basis: &ModalBasis) -> Self {
        let share = |shape: &Shape| Share::of(mesh, shape);
        Self {
            rigid: share(&basis.rigid),
            modes: basis.modes.iter().map(|m| (m.omega_rad_s, share(&m.shape))).collect(),
            residual: None,
        }
    }

    /// Each mode's coordinate per torque, times κ: `p_k/(ω_k² − λ)`, or `p_k/(ω_k² − ω² + 2iζω_kω)`.
    fn coordinates<'a>(
        &'a self,
        dynamics: &'a Dynamics,
        omega_rad_s: f64,
    ) -> impl Iterator<Item = (Complex64, &'a Share)> {
        let modes = self.modes.iter().enumerate().map(move |(k, (mode_rad_s, share))| {
            let at = |omega| dynamics.law().modal_denominator(k + 1, *mode_rad_s, omega);
            let exact = at(omega_rad_s);
            // Exactly on a pole of an undamped mode nothing is finite, and a hair beside it all is.
            let is_pole = exact == Complex64::ZERO;
            let beside = if is_pole { at(omega_rad_s * (1.0 + 4.0 * f64::EPSILON)) } else { exact };
            (share.hub_angle / beside, share)
        });
        modes.chain(self.residual.iter().map(|share| (Complex64::ONE, share)))
    }

    /// Per torque: acceleration of the tip `φ₀p₀ − λ Σ φ_k q_k`, and so on for what `of` reads.
    fn acceleration(
        &self,
        lambda: Complex64,
        coordinates: &[(Complex64, &Share)],
        of: impl Fn(&Share) -> f64,
    ) -> Complex64 {
        let bending: Complex64 = coordinates.iter().map(|(q, share)| q * of(share)).sum();
        self.rigid.hub_angle * of(&self.rigid) - lambda * bending
    }

    pub(super) fn tip_transfer(&self, dynamics: &Dynamics, omega_rad_s: f64) -> TipTransfer {
        let coordinates: Vec<_> = self.coordinates(dynamics, omega_rad_s).collect();
        self.tip_of(dynamics, omega_rad_s, &coordinates)
    }

    fn tip_of(
        &self,
        dynamics: &Dynamics,
        omega_rad_s: f64,
        coordinates: &[(Complex64, &Share)],
    ) -> TipTransfer {
        let lambda = dynamics.law().lambda(omega_rad_s);
        let inertia_kg_m = self.acceleration(lambda, coordinates, |share| share.tip).inv();
        let deflection: Complex64 = coordinates.iter().map(|(q, s)| q * s.tip_deflection()).sum();
        let deflection_s2 = -deflection * inertia_kg_m;
        TipTransfer {
            inertia_kg_m,
            root_inertia_kg_m: self.acceleration(lambda, coordinates, |share| share.moments[0])
                * inertia_kg_m,
            angle_rad_m: (1.0 - lambda * deflection_s2) / dynamics.mesh().length_m(),
            deflection_s2,
        }
    }

    pub(super) fn nodal_transfer(&self, dynamics: &Dynamics, omega_rad_s: f64) -> NodalTransfer {
        let coordinates: Vec<_> = self.coordinates(dynamics, omega_rad_s).collect();
        let tip = self.tip_of(dynamics, omega_rad_s, &coordinates);
        let lambda = dynamics.law().lambda(omega_rad_s);
        let nodes = self.rigid.moments.len();
        let mut deflections_s2 = vec![Complex64::ZERO; nodes];
        let rigid = self.rigid.hub_angle * tip.inertia_kg_m;
        let mut moments_kg_m: Vec<Complex64> =
            self.rigid.moments.iter().map(|m| rigid * *m).collect();
        for (q, share) in &coordinates {
            let lag = -q * tip.inertia_kg_m;
            let acceleration = lambda * lag;
            for node in 0..nodes {
                deflections_s2[node] += lag * share.deflections[node];
                moments_kg_m[node] += acceleration * share.moments[node];
            }
        }
        NodalTransfer { tip, deflections_s2, moments_kg_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inverse::KeptModes;
    use crate::link::{Link, uniform};

    #[test]
    fn an_undamped_link_at_its_own_frequency_takes_no_torque_and_moves_in_its_mode() {
        let link = Link::new(uniform()).unwrap();
        let mesh = Mesh::on(&link, 8);
        let dynamics = Dynamics::new(&link, mesh.clone(), KeptModes::First(3)).unwrap();
        let stored = Superposition::of_first(&mesh, 3).unwrap().modes;
        let modes = ModalBasis::lowest(&mesh, 3).modes;
        for (k, ((omega, _), mode)) in stored.iter().zip(&modes).enumerate() {
            // To the last bit, where its share of the sum is infinite.
            assert_eq!(dynamics.law().modal_denominator(k + 1, *omega, *omega), Complex64::ZERO);
            let found = dynamics.tip_transfer(*omega);
            assert!(found.inertia_kg_m.norm() < 1e-12, "mode {}: {found:?}", k + 1);
            let angle_rad_m = mode.shape.hub_angle / mode.shape.tip_displacement(&mesh);
            let off = (found.angle_rad_m / angle_rad_m - 1.0).norm();
            assert!(off < 1e-10, "mode {}: {off:e}", k + 1);
        }
    }
}
