//! All modes of a mesh at once, by dense algebra.

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use super::basis::ModalBasis;
use super::shape::{Mode, Shape};
use crate::beam::Mesh;
use crate::numeric::SymmetricEigen;

/// Most elements whose modes are all computed: the work grows with the cube of their number, and
/// is a matter of seconds here.
pub const MOST_ELEMENTS_OF_ALL_MODES: usize = 500;

/// Eigenvalues below this share of the largest, times their number, are those of motions without
/// mass.
const ROUND_OFF: f64 = f64::EPSILON;

/// Why not all modes of a mesh are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum AllModesError {
    /// A mesh too large.
    #[error(
        "the mesh has {elements} elements, but all modes are computed of at most \
         {MOST_ELEMENTS_OF_ALL_MODES}: dense algebra grows with the cube of their number"
    )]
    TooManyElements {
        /// Elements of the mesh.
        elements: usize,
    },
    /// Numbers beyond double precision.
    #[error("the modes of the mesh are not finite numbers, but must be")]
    NotFinite,
}

/// The link in the deformations d of its elements, the rotation eliminated.
struct Deformations {
    /// Lower Cholesky factors of the stiffness blocks, `K_d = C Cᵀ`.
    factors: Vec<Matrix2<f64>>,
    /// Rotary inertia that each deformation couples to the hub's rotation, `m_e`.
    coupling: Vec<Vector2<f64>>,
    /// Rigid inertia I about the axis.
    inertia_kg_m2: f64,
    /// `C⁻¹ (M − m mᵀ/I) C⁻ᵀ`, of which the eigenvalues are 1/ω²: rows of the lower triangle, in a
    /// square.
    flexibility: Vec<f64>,
}

impl ModalBasis {
    /// The rigid rotation and every flexible mode of the mesh.
    ///
    /// Solved for 1/ω² in the elements' own deformations, where stiffness is block diagonal: so
    /// the low modes are exact to round-off, and of the high ones that on which responses depend.
    ///
    /// # Errors
    /// [`AllModesError`], beyond [`MOST_ELEMENTS_OF_ALL_MODES`] for one.
    pub fn complete(mesh: &Mesh) -> Result<Self, AllModesError> {
        let elements = mesh.elements().len();
        if elements > MOST_ELEMENTS_OF_ALL_MODES {
            return Err(AllModesError::TooManyElements { elements });
        }
        let mut link = Deformations::of(mesh);
        let flexibility = std::mem::take(&mut link.flexibility);
        let eigen =
            SymmetricEigen::new(2 * elements, flexibility).ok_or(AllModesError::NotFinite)?;
        let values = &eigen.values;
        let largest = values.iter().fold(0.0_f64, |m, value| m.max(*value));
        let massless = ROUND_OFF * values.len() as f64 * largest;
        let modes = (0..values.len()).rev().filter(|k| values[*k] > massless).map(|k| Mode {
            omega_rad_s: values[k].sqrt().recip(),
            shape: link.shape(mesh, eigen.vector(k)),
        });
        Ok(Self { rigid: Self::rigid(mesh), modes: modes.collect() })
    }
}

impl Deformations {
    /// Mass in deformations: element e moves all that is outboard of it rigidly.
    ///
    /// ```text
    /// M_ee = M_dd + C_j,   M_ef = B_eᵀ R(x_e − x_f)  for f inboard of e,   B = M_ud + Rᵀ C_j
    /// ```
    ///
    /// with `C_j` the rigid inertia of all outboard of the element's outer node.
    fn of(mesh: &Mesh) -> Self {
        let root = mesh.nodes_m()[0];
        let elements = mesh.relative_elements();
        let count = elements.len();
        let mut outer = mesh.tip_inertia().matrix();
        let mut own = vec![Matrix2::zeros(); count];
        let mut carried = vec![Matrix2::zeros(); count];
        for (k, element) in elements.iter().enumerate().rev() {
            let r = rigid_transfer(element.length_m);
            own[k] = element.m_dd + outer;
            carried[k] = element.m_ud + r.transpose() * outer;
            outer = element.m_uu + r.transpose() * outer * r;
            if let Some(lumped) = mesh.lumped_inertia(k) {
                outer += lumped.matrix();
            }
        }
        let axis = Vector2::new(root, 1.0);
        let inertia_kg_m2 = mesh.hub_inertia_kg_m2() + axis.dot(&(outer * axis));
        let nodes_m = mesh.nodes_m();
        let coupling: Vec<Vector2<f64>> =
            (0..count).map(|e| carried[e].transpose() * Vector2::new(nodes_m[e], 1.0)).collect();
        let factors: Vec<Matrix2<f64>> = elements.iter().map(|e| cholesky(&e.k_d)).collect();
        let size = 2 * count;
        let mut flexibility = vec![0.0; size * size];
        for e in 0..count {
            for f in 0..=e {
                let rigid = coupling[e] * coupling[f].transpose() / inertia_kg_m2;
                let mass = if e == f {
                    own[e]
                } else {
                    carried[e].transpose() * rigid_transfer(nodes_m[e] - nodes_m[f + 1])
                };
                let block = scaled(&factors[e], &(mass - rigid), &factors[f]);
                for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    flexibility[(2 * e + row) * size + 2 * f + column] = block[(row, column)];
                }
            }
        }
        Self { factors, coupling, inertia_kg_m2, flexibility }
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
    let forward = |c: &Matrix2<f64>, v: Vector2<f64>| {
        let first = v[0] / c.m11;
        Vector2::new(first, (v[1] - c.m21 * first) / c.m22)
    };
    let rows = Matrix2::from_columns(&[
        forward(a, x.column(0).into_owned()),
        forward(a, x.column(1).into_owned()),
    ]);
    let transposed = rows.transpose();
    let columns = Matrix2::from_columns(&[
        forward(b, transposed.column(0).into_owned()),
        forward(b, transposed.column(1).into_owned()),
    ]);
    columns.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};

    fn mesh(elements: usize, hub_kg_m2: f64) -> Mesh {
        let segment = |length_m, stiffness: f64| Segment {
            name: None,
            length_m,
            bending_stiffness_n_m2: Taper { inner: stiffness, outer: 0.7 * stiffness },
            mass_per_length_kg_m: Taper { inner: 0.9, outer: 0.6 },
            cross_section: None,
        };
        let link = Link::new(LinkParts {
            title: String::new(),
            segments: vec![segment(0.2, 50.0), segment(1.3, 5.0)],
            hub: Hub { inertia_kg_m2: hub_kg_m2, radius_m: 0.05, ..Hub::default() },
            masses: vec![LumpedMass { at_m: 0.8, mass_kg: 0.3, inertia_kg_m2: 0.01 }],
            payload: Payload { mass_kg: 0.2, inertia_kg_m2: 0.002, offset_m: 0.03 },
            damping: Damping::None,
            drive: None,
        })
        .unwrap();
        let plan = MeshPlan::new(&link, &[None; 2], Some(ElementCount::Total(elements)), 1e-6);
        Mesh::new(&link, &plan.unwrap())
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
                // Absolute in 1/ω²: what responses depend on.
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
