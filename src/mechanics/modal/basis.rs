//! The first modes of a mesh by the recursion, or all modes by dense algebra.

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use super::frequencies::natural_frequencies;
use super::shape::{Mode, Shape, mode};
use crate::beam::{Gain, Mesh, condense};
use crate::numeric::SymmetricEigen;

/// Share of the static shape below which the residual is round-off.
const NOTHING_LEFT: f64 = 1e-10;

/// Largest relative difference between twice the strain energy of a residual shape and the work of its unit torque. In
/// round-off the two are unrelated.
const ENERGY_TOLERANCE: f64 = 1e-3;

/// The rigid rotation and flexible modes of the link on its free hub, mass-normalised.
///
/// In these coordinates a torque T at the hub drives each mode independently:
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
    /// The rigid rotation and the first `count` flexible modes, or all if the mesh has fewer.
    pub fn lowest(mesh: &Mesh, count: usize) -> Self {
        let rigid = Self::rigid(mesh);
        let mut modes: Vec<Mode> = Vec::new();
        for omega_rad_s in natural_frequencies(mesh, count) {
            let excited = mode(mesh, omega_rad_s).shape;
            // The recursion separates close neighbours less precisely, and leaves a little of slow heavy motions in
            // fast ones.
            let known = modes.iter().map(|mode| &mode.shape).chain([&rigid]);
            let separate = known.fold(excited, |shape, known| {
                let share = known.mass_product(mesh, &shape);
                shape.less(share, known)
            });
            modes.push(Mode { omega_rad_s, shape: separate.mass_normalised(mesh) });
        }
        Self { rigid, modes }
    }

    pub(super) fn rigid(mesh: &Mesh) -> Shape {
        Shape::rigid(mesh).mass_normalised(mesh)
    }

    /// Static residual: the shape of the freely turning link under a constant unit torque, less the part of these
    /// modes, in m and rad per N m.
    ///
    /// ```text
    /// Σ φ_k p_k/ω_k²  over all other modes
    /// ```
    pub(crate) fn static_residual(&self, mesh: &Mesh) -> Shape {
        self.left_over(static_shape(mesh, &self.rigid))
    }

    /// Subtracts these modes from the link's static shape.
    fn left_over(&self, all: Shape) -> Shape {
        self.modes.iter().fold(all, |rest, Mode { omega_rad_s, shape }| {
            rest.less(shape.hub_angle / omega_rad_s.powi(2), shape)
        })
    }

    /// The static residual as a mode, at the frequency from its stiffness and mass: with it a truncated, orthogonal
    /// basis answers slow torques as the whole link does. `None` if the residual is round-off or moves no mass.
    pub(crate) fn residual_mode(&self, mesh: &Mesh) -> Option<Mode> {
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

    /// The rigid rotation and every flexible mode of the mesh.
    ///
    /// Solves for 1/ω² in the deformations of the elements, where stiffness is block diagonal: the low modes are exact
    /// to round-off, and the high ones as far as responses depend on them.
    ///
    /// # Errors
    /// [`AllModesError`], for example beyond [`MOST_ELEMENTS_OF_ALL_MODES`].
    pub fn complete(mesh: &Mesh) -> Result<Self, AllModesError> {
        let elements = mesh.elements().len();
        if elements > MOST_ELEMENTS_OF_ALL_MODES {
            return Err(AllModesError::TooManyElements { elements });
        }
        let (link, flexibility) = Deformations::of(mesh);
        let eigen =
            SymmetricEigen::new(2 * elements, flexibility).ok_or(AllModesError::NotFinite)?;
        let values = &eigen.values;
        let largest = values.iter().fold(0.0_f64, |m, value| m.max(*value));
        // Eigenvalues of motions without mass are round-off.
        let massless = f64::EPSILON * values.len() as f64 * largest;
        let modes = (0..values.len()).rev().filter(|k| values[*k] > massless).map(|k| Mode {
            omega_rad_s: values[k].sqrt().recip(),
            shape: link.shape(mesh, eigen.vector(k)),
        });
        Ok(Self { rigid: Self::rigid(mesh), modes: modes.collect() })
    }
}

/// Shape of the freely turning link under a constant unit torque, relative to its rigid motion, in m and rad per N m:
/// the recursion at rest, made orthogonal to the rigid rotation.
fn static_shape(mesh: &Mesh, rigid: &Shape) -> Shape {
    let zero = Gain { vv: 0.0, vp: 0.0, pv: 0.0, pp: 0.0 };
    let mut gains = vec![zero; mesh.elements().len()];
    condense(mesh, 0.0, |index, step| gains[index] = step.gain());
    let per_lambda = mesh.per_lambda(0.0);
    let mut deflections: Vec<Vector2<f64>> = vec![Vector2::zeros()];
    for (node, (element, gain)) in mesh.elements().iter().zip(&gains).enumerate() {
        let (e, [v, phi]) = (deflections[node], mesh.rigid(node));
        // Per λ: the bending due to a constant acceleration.
        let d = Vector2::new(gain.vv * v + gain.vp * phi, gain.pv * v + gain.pp * phi) * per_lambda;
        deflections.push(Vector2::new(e[0] + element.length_m * e[1], e[1]) + d);
    }
    // Inertia bends the link backwards; a unit torque turns it by 1/I = θ² of the rigid mode.
    let bent = Shape { hub_angle: 0.0, deflections }.scaled(-rigid.hub_angle.powi(2));
    let share = rigid.mass_product(mesh, &bent);
    bent.less(share, rigid)
}

/// Largest number of elements for all modes: the work grows with the cube of the number, and takes seconds here.
pub const MOST_ELEMENTS_OF_ALL_MODES: usize = 500;

/// Reason why the modes of a mesh cannot all be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum AllModesError {
    /// The mesh is too large.
    #[error(
        "the mesh has {elements} elements, but all modes are computed of at most \
         {MOST_ELEMENTS_OF_ALL_MODES}: dense algebra grows with the cube of their number"
    )]
    TooManyElements {
        /// Number of elements of the mesh.
        elements: usize,
    },
    /// Numbers exceed double precision.
    #[error("the modes of the mesh are not finite numbers, but must be")]
    NotFinite,
}

/// The link in terms of the deformations d of its elements, without the rotation.
struct Deformations {
    /// Lower Cholesky factors of the stiffness blocks, `K_d = C Cᵀ`.
    factors: Vec<Matrix2<f64>>,
    /// Rotary inertia `m_e` that couples each deformation to the hub's rotation.
    coupling: Vec<Vector2<f64>>,
    /// Rigid inertia I about the axis.
    inertia_kg_m2: f64,
}

impl Deformations {
    /// The link, and the matrix `C⁻¹ (M − m mᵀ/I) C⁻ᵀ` with the eigenvalues 1/ω²: rows of the lower triangle, in a
    /// square. Element e moves the part outboard of it rigidly.
    ///
    /// ```text
    /// M_ee = M_dd + C_j,   M_ef = B_eᵀ R(x_e − x_f)  for f inboard of e,   B = M_ud + Rᵀ C_j
    /// ```
    ///
    /// with `C_j` the rigid inertia outboard of the element's outer node.
    fn of(mesh: &Mesh) -> (Self, Vec<f64>) {
        let elements = mesh.relative_elements();
        let count = elements.len();
        let mut outer = mesh.tip_inertia().matrix();
        let mut moved = vec![Matrix2::zeros(); count];
        let mut carried = vec![Matrix2::zeros(); count];
        for (k, element) in elements.iter().enumerate().rev() {
            let r = rigid_transfer(element.length_m);
            moved[k] = element.m_dd + outer;
            carried[k] = element.m_ud + r.transpose() * outer;
            outer = element.m_uu + r.transpose() * outer * r;
            if let Some(lumped) = mesh.lumped_inertia(k) {
                outer += lumped.matrix();
            }
        }
        let unit = Vector2::from(mesh.rigid(0));
        let inertia_kg_m2 = mesh.joint().inertia() + unit.dot(&(outer * unit));
        let nodes_m = mesh.nodes_m();
        let coupling: Vec<Vector2<f64>> =
            (0..count).map(|e| carried[e].transpose() * Vector2::from(mesh.rigid(e))).collect();
        let factors: Vec<Matrix2<f64>> = elements.iter().map(|e| cholesky(&e.k_d)).collect();
        let size = 2 * count;
        let mut flexibility = vec![0.0; size * size];
        for e in 0..count {
            for f in 0..=e {
                let rigid = coupling[e] * coupling[f].transpose() / inertia_kg_m2;
                let mass = if e == f {
                    moved[e]
                } else {
                    carried[e].transpose() * rigid_transfer(nodes_m[e] - nodes_m[f + 1])
                };
                let block = scaled(&factors[e], &(mass - rigid), &factors[f]);
                for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    flexibility[(2 * e + row) * size + 2 * f + column] = block[(row, column)];
                }
            }
        }
        (Self { factors, coupling, inertia_kg_m2 }, flexibility)
    }

    /// Mass-normalised shape of an eigenvector y: `d = C⁻ᵀ y`, orthogonal to the rigid rotation.
    fn shape(&self, mesh: &Mesh, vector: &[f64]) -> Shape {
        let mut deflections: Vec<Vector2<f64>> = vec![Vector2::zeros()];
        let mut turned = 0.0;
        for (k, element) in mesh.relative_elements().iter().enumerate() {
            let (a, b) = (vector[2 * k], vector[2 * k + 1]);
            let c = &self.factors[k];
            let phi = b / c.m22;
            let d = Vector2::new((a - c.m21 * phi) / c.m11, phi);
            turned += self.coupling[k].dot(&d);
            let inner = deflections[k];
            deflections.push(rigid_transfer(element.length_m) * inner + d);
        }
        let shape = Shape { hub_angle: -turned / self.inertia_kg_m2, deflections };
        shape.mass_normalised(mesh)
    }
}

/// `R = [[1, l], [0, 1]]`.
fn rigid_transfer(length_m: f64) -> Matrix2<f64> {
    Matrix2::new(1.0, length_m, 0.0, 1.0)
}

/// Lower factor C of a positive definite matrix, `C Cᵀ`.
fn cholesky(k: &Matrix2<f64>) -> Matrix2<f64> {
    let first = k.m11.sqrt();
    let below = k.m21 / first;
    Matrix2::new(first, 0.0, below, (k.m22 - below * below).sqrt())
}

/// `A⁻¹ X B⁻ᵀ` for lower factors A and B.
fn scaled(a: &Matrix2<f64>, x: &Matrix2<f64>, b: &Matrix2<f64>) -> Matrix2<f64> {
    solved(b, &solved(a, x).transpose()).transpose()
}

/// `C⁻¹ X` for a lower factor C.
fn solved(c: &Matrix2<f64>, x: &Matrix2<f64>) -> Matrix2<f64> {
    let first = x.row(0) / c.m11;
    let second = (x.row(1) - first * c.m21) / c.m22;
    Matrix2::from_rows(&[first, second])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{
        Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };

    /// Two equal spans between three bodies so heavy that each span vibrates by itself: every mode comes twice, up to
    /// the mass ratio of span and body.
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
            // Clamped at both ends: cos b cosh b = 1. Four slow modes belong to the bodies.
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

    fn mesh(elements: usize, hub_kg_m2: f64) -> Mesh {
        let segment = |length_m, stiffness: f64| Segment {
            length_m,
            bending_stiffness_n_m2: Taper { inner: stiffness, outer: 0.7 * stiffness },
            mass_per_length_kg_m: Taper { inner: 0.9, outer: 0.6 },
            ..uniform_segment()
        };
        let link = Link::new(LinkParts {
            segments: vec![segment(0.2, 50.0), segment(1.3, 5.0)],
            hub: Hub { inertia_kg_m2: hub_kg_m2, radius_m: 0.05, ..Hub::default() },
            masses: vec![LumpedMass { at_m: 0.8, mass_kg: 0.3, inertia_kg_m2: 0.01 }],
            payload: Payload { mass_kg: 0.2, inertia_kg_m2: 0.002, offset_m: 0.03 },
            ..uniform()
        })
        .unwrap();
        let plan = MeshPlan::new(&link, &[None; 2], Some(ElementCount::Total(elements)), 1e-6);
        Mesh::new(&link, &plan.unwrap()).unwrap()
    }

    #[test]
    fn all_modes_are_those_that_counting_finds() {
        for (elements, hub_kg_m2) in [(6, 0.1), (40, 0.0), (120, 0.1)] {
            let mesh = mesh(elements, hub_kg_m2);
            let all = ModalBasis::complete(&mesh).unwrap();
            let counted = ModalBasis::lowest(&mesh, 2 * elements);
            assert_eq!(all.modes.len(), 2 * elements);
            assert_eq!(counted.modes.len(), 2 * elements);
            let first = counted.modes[0].omega_rad_s;
            for (k, (a, b)) in all.modes.iter().zip(&counted.modes).enumerate() {
                // Absolute in 1/ω², the quantity in responses.
                let per_squared = |omega: f64| (first / omega).powi(2);
                let error = per_squared(a.omega_rad_s) - per_squared(b.omega_rad_s);
                assert!(error.abs() < 1e-13, "mode {} of {elements}: {error:e}", k + 1);
                if k < 12 {
                    let tip = a.shape.tip_displacement(&mesh) / b.shape.tip_displacement(&mesh);
                    assert!((tip - 1.0).abs() < 1e-8, "mode {} of {elements}: {tip}", k + 1);
                }
            }
        }
    }

    #[test]
    fn modes_are_orthogonal_in_mass_and_stiffness() {
        let mesh = mesh(30, 0.1);
        let basis = ModalBasis::complete(&mesh).unwrap();
        for (i, a) in basis.modes.iter().enumerate().take(20) {
            assert!(a.shape.mass_product(&mesh, &basis.rigid).abs() < 1e-12, "mode {}", i + 1);
            for (j, b) in basis.modes.iter().enumerate().take(20) {
                let unit = if i == j { 1.0 } else { 0.0 };
                let mass = a.shape.mass_product(&mesh, &b.shape);
                assert!((mass - unit).abs() < 1e-11, "modes {} and {}: {mass}", i + 1, j + 1);
                let stiffness = a.shape.stiffness_product(&mesh, &b.shape);
                let scale = a.omega_rad_s * b.omega_rad_s;
                assert!((stiffness / scale - unit).abs() < 1e-9, "modes {} and {}", i + 1, j + 1);
            }
        }
    }

    #[test]
    fn all_modes_together_leave_no_static_residual() {
        let mesh = mesh(30, 0.1);
        let tip = |count| {
            let basis = ModalBasis::lowest(&mesh, count);
            basis.static_residual(&mesh).tip_displacement(&mesh)
        };
        let all = ModalBasis::complete(&mesh).unwrap();
        let rest = all.static_residual(&mesh).tip_displacement(&mesh);
        assert!(rest.abs() < 1e-12 * tip(0).abs(), "{rest:e} of {:e}", tip(0));
        assert!(tip(3).abs() > 1e-6 * tip(0).abs(), "three modes are not all");
        assert!(all.residual_mode(&mesh).is_none());
        let few = ModalBasis::lowest(&mesh, 3);
        let residual = few.residual_mode(&mesh).unwrap();
        assert!(residual.omega_rad_s > few.modes[2].omega_rad_s);
        let statics = residual.shape.hub_angle / residual.omega_rad_s.powi(2);
        let statics = statics * residual.shape.tip_displacement(&mesh);
        assert!((statics / tip(3) - 1.0).abs() < 1e-9, "the residual mode has its stiffness");
    }

    #[test]
    fn a_mesh_too_large_is_refused_with_its_size() {
        let error = ModalBasis::complete(&mesh(501, 0.1)).unwrap_err();
        assert_eq!(error, AllModesError::TooManyElements { elements: 501 });
    }
}
