//! The paper's own solve: assembled matrices and a factorisation with pivoting.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use super::dynamics::Dynamics;
use crate::beam::{Inertia, Mesh};
use crate::modal::{ModalBasis, Shape};

/// Most elements that are assembled and factorised: the work grows with the cube of their number.
pub const MOST_ELEMENTS_OF_DENSE_SOLVE: usize = 200;

/// What an estimate of round-off is taken times.
const CAUTION: f64 = 100.0;

/// The link's dense matrices on θ and (v, φ) of nodes 1 … n, with its damping law.
///
/// ```text
/// H x = e_h T,   H = M − K*/ω²  (+ C/(iω) of modal damping)      (Bayo 1987, eqs 15-17)
/// ```
#[derive(Debug, Clone)]
pub struct DenseLink<'a> {
    dynamics: &'a Dynamics,
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// Mass times each mode and its 2ζω, of a modal law.
    modes: Vec<(DVector<f64>, f64)>,
}

impl<'a> DenseLink<'a> {
    /// Assembles the link; none beyond [`MOST_ELEMENTS_OF_DENSE_SOLVE`].
    pub fn assemble(dynamics: &'a Dynamics) -> Option<Self> {
        let mesh = dynamics.mesh();
        let count = mesh.elements().len();
        if count > MOST_ELEMENTS_OF_DENSE_SOLVE {
            return None;
        }
        let (mut mass, mut stiffness) = (free(count), free(count));
        for (k, element) in mesh.elements().iter().enumerate() {
            let (m, s) = (element.mass(), element.stiffness());
            for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
                mass[(2 * k + row, 2 * k + column)] += m[(row, column)];
                stiffness[(2 * k + row, 2 * k + column)] += s[(row, column)];
            }
        }
        let lumped = (0..count).filter_map(|k| mesh.lumped_inertia(k).map(|body| (k, body)));
        for (node, Inertia { vv, vp, pp }) in lumped.chain([(count, mesh.tip_inertia())]) {
            let at = 2 * node;
            mass[(at, at)] += vv;
            mass[(at, at + 1)] += vp;
            mass[(at + 1, at)] += vp;
            mass[(at + 1, at + 1)] += pp;
        }
        let mut mass = held(mesh, mass);
        mass[(0, 0)] += mesh.hub_inertia_kg_m2();
        let stiffness = held(mesh, stiffness);
        let mut link = Self { dynamics, mass, stiffness, modes: Vec::new() };
        link.modes = link.damped_modes()?;
        Some(link)
    }

    /// Mass times each mode and its 2ζω: `C = Σ 2ζω (M φ)(M φ)ᵀ`.
    fn damped_modes(&self) -> Option<Vec<(DVector<f64>, f64)>> {
        let (mesh, law) = (self.dynamics.mesh(), self.dynamics.law());
        if !law.is_modal() {
            return Some(Vec::new());
        }
        let basis = ModalBasis::complete(mesh).ok()?;
        let damped = basis.modes.iter().enumerate().map(|(k, mode)| {
            let rate = 2.0 * law.modal_ratio(k + 1, mode.omega_rad_s) * mode.omega_rad_s;
            (&self.mass * column(mesh, &mode.shape), rate)
        });
        Some(damped.collect())
    }

    /// `T/a_tip` in kg m at ω > 0, as [`Dynamics::tip_transfer`] gives it by other means.
    pub fn torque_per_tip_acceleration_kg_m(&self, omega_rad_s: f64) -> Complex64 {
        let law = self.dynamics.law();
        let size = self.mass.nrows();
        let per_lambda = law.lambda(omega_rad_s).inv();
        let mut h = DMatrix::from_fn(size, size, |row, column| {
            Complex64::from(self.mass[(row, column)]) - per_lambda * self.stiffness[(row, column)]
        });
        for (mode, rate) in &self.modes {
            // iωC/(−ω²)
            let factor = Complex64::new(0.0, -rate / omega_rad_s);
            for row in 0..size {
                for column in 0..size {
                    h[(row, column)] += factor * (mode[row] * mode[column]);
                }
            }
        }
        let mut load = DVector::zeros(size);
        load[0] = Complex64::ONE;
        // Displacement of the tip: the last but one. At a pole it moves without a torque.
        let acceleration = h.lu().solve(&load);
        acceleration.map_or(Complex64::ZERO, |acceleration| acceleration[size - 2].inv())
    }

    /// Relative error that round-off may cause at ω: K annihilates rigid motion only up to ε times
    /// its largest entry, and what is left is divided by ω² and by the rigid inertia.
    pub fn round_off(&self, omega_rad_s: f64) -> f64 {
        let mesh = self.dynamics.mesh();
        let rigid = column(mesh, &ModalBasis::lowest(mesh, 0).rigid);
        let largest = (1..self.mass.nrows())
            .step_by(2)
            .map(|row| self.stiffness[(row, row)] * rigid[row].powi(2));
        let largest = largest.fold(0.0, f64::max);
        let sum = (mesh.elements().len() as f64).sqrt();
        CAUTION * f64::EPSILON * sum * largest / omega_rad_s.powi(2)
    }
}

/// A matrix on (v, φ) of all nodes.
fn free(elements: usize) -> DMatrix<f64> {
    DMatrix::zeros(2 * elements + 2, 2 * elements + 2)
}

/// A matrix on (v, φ) of all nodes, held at the hub: the root sits on it, `v_0 = x_0 θ`, `φ_0 = θ`.
///
/// Without a product of two matrices, in which nalgebra would use what the processor has.
fn held(mesh: &Mesh, mut free: DMatrix<f64>) -> DMatrix<f64> {
    let root_m = mesh.nodes_m()[0];
    for k in 0..free.ncols() {
        free[(1, k)] += root_m * free[(0, k)];
    }
    for k in 0..free.nrows() {
        free[(k, 1)] += root_m * free[(k, 0)];
    }
    free.remove_row(0).remove_column(0)
}

/// A shape on θ and (v, φ) of nodes 1 … n.
fn column(mesh: &Mesh, shape: &Shape) -> DVector<f64> {
    let size = 2 * mesh.nodes_m().len() - 1;
    DVector::from_fn(size, |row, _| {
        if row % 2 == 1 {
            shape.displacement(mesh, row.div_ceil(2))
        } else {
            // The root has no slope of its own: θ alone.
            shape.deflections[row / 2][1] + shape.hub_angle
        }
    })
}
