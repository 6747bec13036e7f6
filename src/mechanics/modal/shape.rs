use nalgebra::Vector2;

use crate::beam::{DrivenMotion, Mesh, driven_motion};

/// A motion of the whole link: hub angle, and deflection from the hub's tangent line.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Hub angle θ.
    pub hub_angle: f64,
    /// Deflection and slope (w, w'; with shear, the section's rotation) of nodes 0 … n from the hub's tangent line.
    pub deflections: Vec<Vector2<f64>>,
}

/// One mode of the link on its free hub.
///
/// Mass-normalised, ∫ (m̄ v² + ρI ψ²) dx + Σ (m v² + J φ²) + `I_H` θ² = 1 with consistent mass, so that v
/// has the unit 1/√kg. The tip's displacement is positive.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Natural frequency in rad/s.
    pub omega_rad_s: f64,
    /// The shape, θ in 1/(m √kg) and w in 1/√kg.
    pub shape: Shape,
}

/// Shape at a natural frequency `omega_rad_s` > 0, from the recursion at λ = ω².
pub fn mode(mesh: &Mesh, omega_rad_s: f64) -> Mode {
    let motion = driven_motion(mesh, omega_rad_s * omega_rad_s);
    Mode { omega_rad_s, shape: Shape::of(&motion).mass_normalised(mesh) }
}

impl Shape {
    /// Shape of a motion at real λ.
    pub(super) fn of(motion: &DrivenMotion<f64>) -> Self {
        Self { hub_angle: motion.theta, deflections: motion.deflections.clone() }
    }

    /// Rotation of the rigid link by a unit angle.
    pub(super) fn rigid(mesh: &Mesh) -> Self {
        Self { hub_angle: 1.0, deflections: vec![Vector2::zeros(); mesh.nodes_m().len()] }
    }

    /// Total displacements `v = w + xθ` of all nodes (Bayo 1987, eq 1).
    pub fn displacements(&self, mesh: &Mesh) -> Vec<f64> {
        (0..self.deflections.len()).map(|node| self.displacement(mesh, node)).collect()
    }

    /// Total displacement `v = w + xθ` of a node (Bayo 1987, eq 1).
    pub(crate) fn displacement(&self, mesh: &Mesh, node: usize) -> f64 {
        self.total(mesh, node)[0]
    }

    /// Total displacement of the output: the tip, or a station on the link.
    pub(crate) fn tip_displacement(&self, mesh: &Mesh) -> f64 {
        self.displacement(mesh, mesh.output())
    }

    /// Total displacement and slope (v, φ) of a node.
    pub(crate) fn total(&self, mesh: &Mesh, node: usize) -> Vector2<f64> {
        self.deflections[node] + Vector2::from(mesh.rigid(node)) * self.hub_angle
    }

    /// Deformation of an element: motion of its outer end relative to its inner end's tangent.
    fn deformation(&self, mesh: &Mesh, element: usize) -> Vector2<f64> {
        let (inner, outer) = (self.deflections[element], self.deflections[element + 1]);
        let length_m = mesh.relative_elements()[element].length_m;
        Vector2::new(outer[0] - inner[0] - length_m * inner[1], outer[1] - inner[1])
    }

    /// `∫ m̄ v v' dx + Σ (m v v' + J φ φ') + I_H θ θ'`, element by element in relative coordinates.
    pub(crate) fn mass_product(&self, mesh: &Mesh, other: &Self) -> f64 {
        let elements = mesh.relative_elements().iter().enumerate().map(|(k, element)| {
            let (u, d) = (self.total(mesh, k), self.deformation(mesh, k));
            let (v, e) = (other.total(mesh, k), other.deformation(mesh, k));
            u.dot(&(element.m_uu * v))
                + u.dot(&(element.m_ud * e))
                + v.dot(&(element.m_ud * d))
                + d.dot(&(element.m_dd * e))
        });
        let last = self.deflections.len() - 1;
        let lumped = (0..last).filter_map(|node| Some((mesh.lumped_inertia(node)?, node)));
        let bodies = lumped.chain([(mesh.tip_inertia(), last)]).map(|(inertia, node)| {
            self.total(mesh, node).dot(&(inertia.matrix() * other.total(mesh, node)))
        });
        let hub = mesh.joint().inertia() * self.hub_angle * other.hub_angle;
        hub + elements.sum::<f64>() + bodies.sum::<f64>()
    }

    /// `∫ EI w₁'' w₂'' dx` for two shapes; for equal shapes it is twice the strain energy.
    pub(crate) fn stiffness_product(&self, mesh: &Mesh, other: &Self) -> f64 {
        let elements = mesh.relative_elements().iter().enumerate();
        let products = elements.map(|(k, element)| {
            self.deformation(mesh, k).dot(&(element.k_d * other.deformation(mesh, k)))
        });
        products.sum()
    }

    /// Moment at nodes 0 … n that accelerates the part outboard, including the node's lump, by this shape:
    /// `∫ m̄ v (x − x_i) dx + …`.
    pub(crate) fn moments(&self, mesh: &Mesh) -> Vec<f64> {
        let last = self.deflections.len() - 1;
        let mut moments = vec![0.0; last + 1];
        moments[last] = (mesh.tip_inertia().matrix() * self.total(mesh, last))[1];
        self.inward(mesh, |node, _, inner| moments[node] = self.with_lump(mesh, node, inner)[1]);
        moments
    }

    /// Force along the normal that accelerates the whole link, with a carriage, by this shape: `∫ m̄ v dx + Σ m v`.
    pub(crate) fn force(&self, mesh: &Mesh) -> f64 {
        let mut at_root = Vector2::zeros();
        self.inward(mesh, |node, _, inner| at_root = self.with_lump(mesh, node, inner));
        at_root[0] + mesh.joint().position([1.0, 0.0]) * mesh.joint().inertia() * self.hub_angle
    }

    /// Shear force at the inner and the outer end of each element that accelerates the part outboard by this shape:
    /// `∫ m̄ v dx + …`.
    pub(super) fn shear_forces(&self, mesh: &Mesh) -> Vec<[f64; 2]> {
        let mut forces = vec![[0.0; 2]; self.deflections.len() - 1];
        self.inward(mesh, |node, outer, inner| forces[node] = [inner[0], outer[0]]);
        forces
    }

    /// Passes force and moment at the outer and the inner end of each element to `each`, from the tip inward.
    fn inward(&self, mesh: &Mesh, mut each: impl FnMut(usize, Vector2<f64>, Vector2<f64>)) {
        let last = self.deflections.len() - 1;
        let mut outer = mesh.tip_inertia().matrix() * self.total(mesh, last);
        for (node, element) in mesh.relative_elements().iter().enumerate().rev() {
            let (u, d) = (self.total(mesh, node), self.deformation(mesh, node));
            let carried = Vector2::new(outer[0], outer[1] + element.length_m * outer[0]);
            let inner = element.m_uu * u + element.m_ud * d + carried;
            each(node, outer, inner);
            outer = self.with_lump(mesh, node, inner);
        }
    }

    /// Force and moment, including the inertia lumped at a node.
    fn with_lump(&self, mesh: &Mesh, node: usize, inner: Vector2<f64>) -> Vector2<f64> {
        let lump = mesh.lumped_inertia(node).map(|own| own.matrix() * self.total(mesh, node));
        lump.map_or(inner, |lump| inner + lump)
    }

    /// `Σ factor · shape`, of at least one shape.
    pub(crate) fn sum(factors: &[f64], shapes: &[Self]) -> Self {
        let nothing = shapes[0].clone().scaled(0.0);
        let terms = factors.iter().zip(shapes);
        terms.fold(nothing, |sum, (factor, shape)| sum.less(-factor, shape))
    }

    /// The shape times a factor.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.hub_angle *= factor;
        for w in &mut self.deflections {
            *w *= factor;
        }
        self
    }

    /// The shape minus `factor` times another.
    pub(crate) fn less(mut self, factor: f64, other: &Self) -> Self {
        self.hub_angle -= factor * other.hub_angle;
        for (w, other) in self.deflections.iter_mut().zip(&other.deflections) {
            *w -= factor * other;
        }
        self
    }

    /// The shape scaled to unit modal mass and positive tip displacement.
    pub(super) fn mass_normalised(self, mesh: &Mesh) -> Self {
        let scale = self.mass_product(mesh, &self).sqrt().recip();
        let sign = if self.tip_displacement(mesh) < 0.0 { -1.0 } else { 1.0 };
        self.scaled(sign * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Hub, Link, LinkParts, LumpedMass, Payload, uniform};
    use crate::modal::natural_frequencies;

    fn mesh(elements: usize, hub: Hub, masses: Vec<LumpedMass>, payload: Payload) -> Mesh {
        let link = Link::new(LinkParts { hub, masses, payload, ..uniform() }).unwrap();
        Mesh::on(&link, elements)
    }

    #[test]
    fn a_pinned_free_link_swings_in_its_closed_form() {
        let mesh = mesh(100, Hub::default(), vec![], Payload::default());
        let b = 3.926_602_312_047_919_f64;
        let omega = natural_frequencies(&mesh, 1)[0];
        let shape = mode(&mesh, omega).shape;
        // v = sin(bx/L)/sin b + sinh(bx/L)/sinh b has the norm ∫v² dx = L.
        let norm = (0.8_f64 * 1.5).sqrt();
        for (node, x) in mesh.nodes_m().iter().enumerate() {
            let v = shape.displacement(&mesh, node);
            let s = b * x / 1.5;
            let exact = (s.sin() / b.sin() + s.sinh() / b.sinh()) / norm;
            assert!((v - exact).abs() < 1e-8, "at {x} m: {v} is not {exact}");
        }
        let slope = b / 1.5 * (1.0 / b.sin() + 1.0 / b.sinh()) / norm;
        assert!((shape.hub_angle - slope).abs() < 1e-7, "{} is not {slope}", shape.hub_angle);
    }

    #[test]
    fn shapes_of_different_modes_are_orthogonal_and_of_unit_mass() {
        let hub = Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.0 };
        let masses = vec![LumpedMass { at_m: 0.8, mass_kg: 0.3, inertia_kg_m2: 0.0 }];
        let payload = Payload { mass_kg: 0.2, inertia_kg_m2: 0.0, offset_m: 0.0 };
        let mesh = mesh(600, hub, masses, payload);
        let shapes: Vec<Shape> =
            natural_frequencies(&mesh, 4).iter().map(|w| mode(&mesh, *w).shape).collect();
        // Simpson's rule on nodes 0, 2, 4, … would need a node pattern undisturbed by the mass; the trapezoid on all
        // nodes is exact to 1e-4 here.
        let x = mesh.nodes_m();
        let mass = x.iter().position(|x| (x - 0.8).abs() < 1e-9).unwrap();
        for (i, a) in shapes.iter().enumerate() {
            for (j, b) in shapes.iter().enumerate() {
                let product = |k: usize| a.displacement(&mesh, k) * b.displacement(&mesh, k);
                let beam: f64 = (1..x.len())
                    .map(|k| 0.8 * 0.5 * (x[k] - x[k - 1]) * (product(k) + product(k - 1)))
                    .sum();
                let bodies = 0.1 * a.hub_angle * b.hub_angle
                    + 0.3 * product(mass)
                    + 0.2 * product(x.len() - 1);
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((beam + bodies - expected).abs() < 1e-4, "modes {i} and {j}");
            }
        }
        assert!(shapes.iter().all(|s| s.tip_displacement(&mesh) > 0.0), "the tip leads");
    }
}
