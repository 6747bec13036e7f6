use num_complex::Complex64;

use super::link_on_mesh::{KeptModes, LinkOnMesh, Model, ModelError};
use crate::beam::{
    Checkpoints, LoadedMotion, Loads, Mesh, NodalQuantity, NodalTransfer, TipTransfer,
};
use crate::modal::{ModalBasis, Shape};

/// A link as the sum of its modes, for damping laws with a ratio for each mode, and for a reduction to few modes.
///
/// ```text
/// x/T = φ₀p₀/(−ω²) + Σ φ_k p_k/(ω_k² − ω² + 2iζ_kω_kω)            (Bayo 1987, eqs 11 and 12)
/// ```
#[derive(Debug, Clone)]
pub(super) struct Superposition {
    link: LinkOnMesh,
    kept: KeptModes,
    rigid: Share,
    /// Natural frequency in rad/s and share of each flexible mode kept.
    modes: Vec<(f64, Share)>,
    /// Static response, per torque, of the motions outside the modes; only if all modes are kept.
    residual: Option<Share>,
}

/// Contribution of one shape to the link's response, per torque at the hub.
#[derive(Debug, Clone)]
struct Share {
    /// Hub angle p; the torque acts on it.
    hub_angle: f64,
    tip: f64,
    tip_deflection: f64,
    /// Deflections from the hub's tangent line.
    deflections: Vec<f64>,
    /// Slopes from the hub's tangent line.
    slopes: Vec<f64>,
    /// Force along the normal for the shape as acceleration.
    force: f64,
    /// Moments for the shape as acceleration.
    moments: Vec<f64>,
}

impl Share {
    fn of(mesh: &Mesh, shape: &Shape) -> Self {
        Self {
            hub_angle: shape.hub_angle,
            tip: shape.tip_displacement(mesh),
            tip_deflection: shape.deflections[mesh.output()][0],
            deflections: shape.deflections.iter().map(|w| w[0]).collect(),
            slopes: shape.deflections.iter().map(|w| w[1]).collect(),
            force: shape.force(mesh),
            moments: shape.moments(mesh),
        }
    }

    /// Work of loads along the shape, including the inertia loads of an accelerated axis, with the factor `mass`.
    fn work(&self, mesh: &Mesh, loads: &Loads<Complex64>, mass: Complex64) -> Complex64 {
        let nodes = loads.nodal.iter().enumerate().map(|(k, [force, moment])| {
            let [v, phi] = mesh.rigid(k).map(|part| part * self.hub_angle);
            force * (self.deflections[k] + v) + moment * (self.slopes[k] + phi)
        });
        nodes.sum::<Complex64>() - mass * loads.axis_m_s2 * self.force
    }
}

impl Superposition {
    /// Computes the modes of a link. All modes come with a static response for their round-off and for motions without
    /// mass; a reduction has the rigid rotation and the first flexible modes.
    ///
    /// # Errors
    /// [`ModelError`]: more modes than there are, or a mesh too large for all of them.
    pub(super) fn new(link: LinkOnMesh, kept: KeptModes) -> Result<Self, ModelError> {
        let mesh = link.mesh();
        let share = |shape: &Shape| Share::of(mesh, shape);
        let (basis, residual) = match kept {
            KeptModes::All => {
                let basis = ModalBasis::complete(mesh)?;
                let residual = share(&basis.static_residual(mesh));
                (basis, Some(residual))
            }
            KeptModes::First(count) => {
                let basis = ModalBasis::lowest(mesh, count);
                let found = basis.modes.len();
                if found < count {
                    return Err(ModelError::NotSoManyModes { asked: count, found });
                }
                (basis, None)
            }
        };
        let rigid = share(&basis.rigid);
        let modes = basis.modes.iter().map(|m| (m.omega_rad_s, share(&m.shape))).collect();
        Ok(Self { link, kept, rigid, modes, residual })
    }

    /// Denominator of a mode's share. On a pole of an undamped mode nothing is finite, so it is evaluated slightly
    /// beside the pole.
    fn denominator(&self, k: usize, mode_rad_s: f64, omega_rad_s: f64) -> Complex64 {
        let at = |omega| self.law().modal_denominator(k + 1, mode_rad_s, omega);
        let exact = at(omega_rad_s);
        let is_pole = exact == Complex64::ZERO;
        if is_pole { at(omega_rad_s * (1.0 + 4.0 * f64::EPSILON)) } else { exact }
    }

    /// Each mode's coordinate per torque, times κ: `p_k/(ω_k² − λ)`, or `p_k/(ω_k² − ω² + 2iζω_kω)`.
    fn coordinates(&self, omega_rad_s: f64) -> Vec<(Complex64, &Share)> {
        let modes = self.modes.iter().enumerate().map(|(k, (mode_rad_s, share))| {
            (share.hub_angle / self.denominator(k, *mode_rad_s, omega_rad_s), share)
        });
        modes.chain(self.residual.iter().map(|share| (Complex64::ONE, share))).collect()
    }

    /// Acceleration of the tip per torque, `φ₀p₀ − λ Σ φ_k q_k`, or of another quantity that `of` reads.
    fn acceleration(
        &self,
        lambda: Complex64,
        coordinates: &[(Complex64, &Share)],
        of: impl Fn(&Share) -> f64,
    ) -> Complex64 {
        let bending: Complex64 = coordinates.iter().map(|(q, share)| q * of(share)).sum();
        self.rigid.hub_angle * of(&self.rigid) - lambda * bending
    }

    fn tip_of(&self, omega_rad_s: f64, coordinates: &[(Complex64, &Share)]) -> TipTransfer {
        let lambda = self.law().lambda(omega_rad_s);
        let inertia_kg_m = self.acceleration(lambda, coordinates, |share| share.tip).inv();
        let deflection: Complex64 = coordinates.iter().map(|(q, s)| q * s.tip_deflection).sum();
        let deflection_s2 = -deflection * inertia_kg_m;
        TipTransfer {
            inertia_kg_m,
            root_inertia_kg_m: self.acceleration(lambda, coordinates, |share| share.moments[0])
                * inertia_kg_m,
            angle_rad_m: (1.0 - lambda * deflection_s2) / self.mesh().rigid_tip(),
            deflection_s2,
        }
    }

    /// One quantity per tip motion as a function of the node, from the coordinates and the tip transfer at ω.
    fn nodal_value(
        &self,
        omega_rad_s: f64,
        coordinates: &[(Complex64, &Share)],
        tip: &TipTransfer,
        quantity: NodalQuantity,
    ) -> impl Fn(usize) -> Complex64 {
        let lambda = self.law().lambda(omega_rad_s);
        let rigid = self.rigid.hub_angle * tip.inertia_kg_m;
        let weight = |q: &Complex64| {
            let lag = -q * tip.inertia_kg_m;
            match quantity {
                NodalQuantity::Deflection => lag,
                NodalQuantity::Moment => lambda * lag,
            }
        };
        let shares: Vec<_> = coordinates.iter().map(|(q, share)| (weight(q), *share)).collect();
        move |node| match quantity {
            NodalQuantity::Deflection => {
                let terms = shares.iter().map(|(weight, share)| weight * share.deflections[node]);
                terms.fold(Complex64::ZERO, |sum, term| sum + term)
            }
            NodalQuantity::Moment => {
                let terms = shares.iter().map(|(weight, share)| weight * share.moments[node]);
                terms.fold(rigid * self.rigid.moments[node], |sum, term| sum + term)
            }
        }
    }
}

impl Model for Superposition {
    fn on_mesh(&self) -> &LinkOnMesh {
        &self.link
    }

    fn kept_modes(&self) -> KeptModes {
        self.kept
    }

    fn root_damping_kg_m(&self, omega_rad_s: f64) -> Complex64 {
        if !self.law().is_modal() {
            return Complex64::ZERO;
        }
        let coordinates = self.coordinates(omega_rad_s);
        let of_mode = |((mode_rad_s, _), (q, share)): (&(f64, Share), &(Complex64, &Share))| {
            let undamped = mode_rad_s * mode_rad_s - omega_rad_s * omega_rad_s;
            // Damping takes the second term of the modal load `p = q (ω_k² − ω²) + q 2iζω_kω`.
            (share.hub_angle - q * undamped) * share.moments[0]
        };
        let damped: Complex64 = self.modes.iter().zip(&coordinates).map(of_mode).sum();
        let inertia_kg_m = self.tip_of(omega_rad_s, &coordinates).inertia_kg_m;
        damped * inertia_kg_m
    }

    fn tip_transfer(&self, omega_rad_s: f64) -> TipTransfer {
        self.tip_of(omega_rad_s, &self.coordinates(omega_rad_s))
    }

    fn nodal_transfer(&self, omega_rad_s: f64) -> NodalTransfer {
        let coordinates = self.coordinates(omega_rad_s);
        let tip = self.tip_of(omega_rad_s, &coordinates);
        let at_nodes = |quantity| -> Vec<Complex64> {
            let value = self.nodal_value(omega_rad_s, &coordinates, &tip, quantity);
            (0..self.rigid.moments.len()).map(value).collect()
        };
        NodalTransfer {
            tip,
            deflections_s2: at_nodes(NodalQuantity::Deflection),
            moments_kg_m: at_nodes(NodalQuantity::Moment),
        }
    }

    /// The tip is on the chord if torque and loads accelerate it like the chord. Loads on motions without mass, which
    /// are no modes, bend nothing here.
    fn loaded_motion(&self, omega_rad_s: f64, loads: &Loads<Complex64>) -> LoadedMotion<Complex64> {
        let (mesh, lambda) = (self.mesh(), self.law().lambda(omega_rad_s));
        assert!(loads.nodal.len() == mesh.nodes_m().len(), "a load for each node");
        let [mass, stiffness] = self.law().factors(omega_rad_s);
        let per_torque = self.coordinates(omega_rad_s);
        let modes = self.modes.iter().enumerate().map(|(k, (mode_rad_s, share))| {
            let square = self.denominator(k, *mode_rad_s, omega_rad_s);
            (share.work(mesh, loads, mass) / square, share)
        });
        let of_loads: Vec<(Complex64, &Share)> = modes.collect();
        let tip_of = |coordinates: &[(Complex64, &Share)]| -> Complex64 {
            coordinates.iter().map(|(q, share)| q * share.tip).sum()
        };
        let turned = self.rigid.work(mesh, loads, mass) * self.rigid.tip;
        let wanted = loads.chord_rad_s2 * mesh.rigid_tip() * mass;
        let left = wanted - turned + lambda * tip_of(&of_loads);
        let torque_n_m = left / self.acceleration(lambda, &per_torque, |share| share.tip);
        let compliance = stiffness.inv();
        let all: Vec<(Complex64, &Share)> = of_loads
            .into_iter()
            .chain(per_torque.into_iter().map(|(q, share)| (q * torque_n_m, share)))
            .map(|(q, share)| (q * compliance, share))
            .collect();
        let sum = |of: &dyn Fn(&Share) -> f64| -> Complex64 {
            all.iter().map(|(q, share)| q * of(share)).sum()
        };
        let hub_slope_rad = -sum(&|share: &Share| share.tip_deflection) / mesh.rigid_tip();
        let deflections = (0..mesh.nodes_m().len()).map(|k| {
            let [w, slope] = [sum(&|share| share.deflections[k]), sum(&|share| share.slopes[k])];
            let [v, phi] = mesh.rigid(k).map(|part| hub_slope_rad * part);
            [w + v, slope + phi]
        });
        LoadedMotion { torque_n_m, hub_slope_rad, deflections: deflections.collect() }
    }

    fn nodal_transfers(
        &self,
        omegas_rad_s: &[f64],
        nodes: &[usize],
        quantity: NodalQuantity,
        rows: &mut [&mut [Complex64]],
        _: &mut Checkpoints,
    ) {
        for (column, omega) in omegas_rad_s.iter().enumerate() {
            let coordinates = self.coordinates(*omega);
            let tip = self.tip_of(*omega, &coordinates);
            let value = self.nodal_value(*omega, &coordinates, &tip, quantity);
            for (row, node) in rows.iter_mut().zip(nodes) {
                row[column] = value(*node);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Link, uniform};

    #[test]
    fn an_undamped_link_at_its_own_frequency_takes_no_torque_and_moves_in_its_mode() {
        let link = Link::new(uniform()).unwrap();
        let mesh = Mesh::on(&link, 8);
        let on_mesh = LinkOnMesh::new(&link, mesh.clone()).unwrap();
        let model = Superposition::new(on_mesh, KeptModes::First(3)).unwrap();
        let modes = ModalBasis::lowest(&mesh, 3).modes;
        for (k, ((omega, _), mode)) in model.modes.iter().zip(&modes).enumerate() {
            // Exactly on the natural frequency, where the mode's share is infinite.
            assert_eq!(model.law().modal_denominator(k + 1, *omega, *omega), Complex64::ZERO);
            let found = model.tip_transfer(*omega);
            assert!(found.inertia_kg_m.norm() < 1e-12, "mode {}: {found:?}", k + 1);
            let angle_rad_m = mode.shape.hub_angle / mode.shape.tip_displacement(&mesh);
            let off = (found.angle_rad_m / angle_rad_m - 1.0).norm();
            assert!(off < 1e-10, "mode {}: {off:e}", k + 1);
        }
    }
}
