use nalgebra::Vector2;

use super::frequencies::natural_frequencies;
use super::shape::{Mode, Shape, mode};
use crate::beam::{Gain, Mesh, condense};

/// Share of the static shape below which the residual is round-off.
const NOTHING_LEFT: f64 = 1e-10;

/// Largest relative difference between twice the strain energy of a residual shape and the work of its
/// unit torque; for round-off the two are unrelated.
const ENERGY_TOLERANCE: f64 = 1e-3;

/// The rigid rotation and flexible modes of the link on its free hub, mass-normalised.
///
/// In these coordinates a torque T at the hub drives each mode by itself:
///
/// ```text
/// q̈ + 2ζω q̇ + ω² q = p T,    p the mode's hub angle            (Bayo 1987, eqs 11 and 12)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ModalBasis {
    /// Rotation of the rigid link: θ = 1/√I.
    pub rigid: Shape,
    /// Flexible modes, ascending.
    pub modes: Vec<Mode>,
}

impl ModalBasis {
    /// The rigid rotation and the first `count` flexible modes, fewer where the mesh has fewer.
    pub fn lowest(mesh: &Mesh, count: usize) -> Self {
        let rigid = Self::rigid(mesh);
        let mut modes: Vec<Mode> = Vec::new();
        for omega_rad_s in natural_frequencies(mesh, count) {
            let found = mode(mesh, omega_rad_s).shape;
            // The recursion gives neighbours the less precisely, the closer they lie, and leaves a
            // little of slow heavy motions in fast ones.
            let known = modes.iter().map(|mode| &mode.shape).chain([&rigid]);
            let own = known.fold(found, |shape, known| {
                let share = known.mass_product(mesh, &shape);
                shape.less(share, known)
            });
            modes.push(Mode { omega_rad_s, shape: own.mass_normalised(mesh) });
        }
        Self { rigid, modes }
    }

    pub(super) fn rigid(mesh: &Mesh) -> Shape {
        Shape::rigid(mesh).mass_normalised(mesh)
    }

    /// What a constant unit torque bends the freely turning link to, less the part of these modes:
    /// the static residual of the modes left out, in m and rad per N m.
    ///
    /// ```text
    /// Σ φ_k p_k/ω_k²  over the modes left out
    /// ```
    pub fn static_residual(&self, mesh: &Mesh) -> Shape {
        self.left_over(static_shape(mesh, &self.rigid))
    }

    /// What these modes leave over of the whole link's static shape.
    fn left_over(&self, all: Shape) -> Shape {
        self.modes.iter().fold(all, |rest, Mode { omega_rad_s, shape }| {
            rest.less(shape.hub_angle / omega_rad_s.powi(2), shape)
        })
    }

    /// The static residual made a mode of its own, at the frequency that its stiffness and mass
    /// give it: with it a truncated basis answers slow torques as the whole link does, and stays
    /// orthogonal. None where the residual is round-off or moves no mass.
    pub fn residual_mode(&self, mesh: &Mesh) -> Option<Mode> {
        let all = static_shape(mesh, &self.rigid);
        let rest = self.left_over(all.clone());
        let (whole, mass) = (all.mass_product(mesh, &all), rest.mass_product(mesh, &rest));
        let (strain, work) = (rest.stiffness_product(mesh, &rest), rest.hub_angle);
        let is_round_off = (strain - work).abs() > ENERGY_TOLERANCE * strain;
        if is_round_off || mass <= NOTHING_LEFT * NOTHING_LEFT * whole {
            return None;
        }
        let omega_rad_s = (strain / mass).sqrt();
        Some(Mode { omega_rad_s, shape: rest.mass_normalised(mesh) })
    }
}

/// What a constant unit torque bends the freely turning link to, relative to its rigid motion, in
/// m and rad per N m: the recursion at rest, made orthogonal to the rigid rotation.
fn static_shape(mesh: &Mesh, rigid: &Shape) -> Shape {
    let zero = Gain { vv: 0.0, vp: 0.0, pv: 0.0, pp: 0.0 };
    let mut gains = vec![zero; mesh.elements().len()];
    condense(mesh, 0.0, |index, step| gains[index] = step.gain());
    let per_lambda = mesh.per_lambda(0.0);
    let mut deflections: Vec<Vector2<f64>> = vec![Vector2::zeros()];
    for ((element, gain), x_m) in mesh.elements().iter().zip(&gains).zip(mesh.nodes_m()) {
        let e = deflections[deflections.len() - 1];
        // Per λ, which leaves what a constant acceleration bends.
        let d = Vector2::new(gain.vv * x_m + gain.vp, gain.pv * x_m + gain.pp) * per_lambda;
        deflections.push(Vector2::new(e[0] + element.length_m * e[1], e[1]) + d);
    }
    // Inertia bends the link backwards; a unit torque turns it by 1/I = θ² of the rigid mode.
    let bent = Shape { hub_angle: 0.0, deflections }.scaled(-rigid.hub_angle.powi(2));
    let share = rigid.mass_product(mesh, &bent);
    bent.less(share, rigid)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{
        Hub, Link, LinkParts, LumpedMass, Payload, Segment, uniform, uniform_segment,
    };

    /// Two like spans between three bodies so heavy that each span vibrates by itself: every mode
    /// comes twice but for a share of span over body.
    fn twins(body_kg: f64) -> Mesh {
        let inertia_kg_m2 = 10.0 * body_kg;
        let link = Link::new(LinkParts {
            segments: vec![Segment { length_m: 2.0, ..uniform_segment() }],
            hub: Hub { inertia_kg_m2, ..Hub::default() },
            masses: vec![LumpedMass { at_m: 1.0, mass_kg: body_kg, inertia_kg_m2 }],
            payload: Payload { mass_kg: body_kg, inertia_kg_m2, offset_m: 0.0 },
            ..uniform()
        })
        .unwrap();
        Mesh::on(&link, 24)
    }

    #[test]
    fn nearly_equal_modes_are_all_found_and_orthogonal() {
        let mut gaps = Vec::new();
        for body_kg in [1e2, 1e4, 1e6] {
            let mesh = twins(body_kg);
            let (lowest, all) =
                (ModalBasis::lowest(&mesh, 16), ModalBasis::complete(&mesh).unwrap());
            // Clamped at both ends: cos b cosh b = 1. Four slow modes are those of the bodies.
            let exact = 4.730_040_744_862_704_f64.powi(2) * (5.0_f64 / 0.8).sqrt();
            let pair: Vec<f64> = lowest
                .modes
                .iter()
                .map(|mode| mode.omega_rad_s)
                .filter(|omega| (omega / exact - 1.0).abs() < 0.05)
                .collect();
            assert_eq!(pair.len(), 2, "bodies of {body_kg} kg: {pair:?}");
            gaps.push(pair[1] / pair[0] - 1.0);
            for (k, a) in lowest.modes.iter().enumerate() {
                let counted = all.modes[k].omega_rad_s;
                let share = (lowest.modes[0].omega_rad_s / a.omega_rad_s).powi(2);
                let error = (counted / a.omega_rad_s - 1.0).abs() * share;
                assert!(error < 1e-12, "mode {} at {body_kg} kg: {error:e}", k + 1);
                for b in &lowest.modes[..k] {
                    let product = a.shape.mass_product(&mesh, &b.shape).abs();
                    assert!(product < 1e-9, "mode {} at {body_kg} kg: {product:e}", k + 1);
                }
            }
        }
        assert!(gaps[2] < 1e-4 && gaps[2] > 0.0, "{gaps:?}");
    }
}
