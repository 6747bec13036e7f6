//! The recursion with row pivoting, for frequencies at which the outboard part resonates.
//!
//! There the apparent inertia A has a pole and the plain recursion no digits. What stays finite is
//! the set of pairs (motion u, reaction q = A u) that the outboard part admits: a plane in four
//! dimensions. It is carried inward as u = U c, q = Q c with two free coefficients c, and after
//! every element the two rows of U and Q that span the plane best are made the new coefficients.
//! A resonance is then nothing special: u is small beside q.

use nalgebra::{Matrix2, Vector2};
use num_complex::Complex64;

use super::element::RelativeElement;
use super::mesh::Mesh;
use super::transfer::TipTransfer;
use super::walk::NodalTransfer;

type Block = Matrix2<Complex64>;

/// Motions `U c` and reactions `Q c` that the part outboard of a node admits.
#[derive(Clone, Copy)]
struct Plane {
    motion: Block,
    reaction: Block,
}

/// What the way back from hub to tip needs of one element.
struct Passage {
    /// Inner coefficients per outer ones: `c_i = change · c_j`.
    change: Block,
    /// Deformation `d = D c_j`.
    deformation: Block,
    /// Reaction at the inner node over `c_i`.
    reaction: Block,
}

/// A motion of the whole link at one λ under a torque at the hub alone, its size arbitrary.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenMotion {
    /// Hub angle θ.
    pub theta: Complex64,
    /// Torque at the hub over −ω².
    pub torque: Complex64,
    /// Deflection and slope (e, e') of nodes 0 … n from the hub's tangent line.
    pub deflections: Vec<Vector2<Complex64>>,
    /// Deformation of every element: motion of its outer end seen from its inner end's tangent.
    /// Not found from the deflections, of which it is a tiny difference on fine meshes.
    pub deformations: Vec<Vector2<Complex64>>,
    /// Reaction (force, moment) over −ω² of what lies outboard of nodes 0 … n.
    pub reactions: Vec<Vector2<Complex64>>,
}

/// The motion that a torque at the hub drives at λ, also where the link or a part of it resonates.
pub fn driven_motion(mesh: &Mesh, lambda: Complex64) -> DrivenMotion {
    let mut plane =
        Plane { motion: Block::identity(), reaction: complex(&mesh.tip_inertia().matrix()) };
    let tip_reaction = plane.reaction;
    let mut passages = Vec::with_capacity(mesh.elements().len());
    for (index, element) in mesh.relative_elements().iter().enumerate().rev() {
        let (deformation, mut inner) = pass(element, lambda, &plane);
        if let Some(lumped) = mesh.lumped_inertia(index) {
            inner.reaction += complex(&lumped.matrix()) * inner.motion;
        }
        let (change, renewed) = renew(&inner, mesh);
        passages.push(Passage { change, deformation, reaction: renewed.reaction });
        plane = renewed;
    }
    // The root sits on the hub's radius: v_0 = x_0 φ_0 leaves one coefficient, its size free.
    let root_m = mesh.nodes_m()[0];
    let held = plane.motion.row(0) - plane.motion.row(1) * Complex64::from(root_m);
    let mut c = Vector2::new(-held[1], held[0]).unscale(held.norm());
    let theta = (plane.motion * c)[1];
    let at_root = plane.reaction * c;
    let torque = at_root[1] + at_root[0] * root_m + theta * mesh.hub_inertia_kg_m2();

    let mut e = Vector2::zeros();
    let mut deflections = vec![e];
    let mut deformations = Vec::with_capacity(passages.len());
    let mut reactions = Vec::with_capacity(passages.len() + 1);
    for (passage, element) in passages.iter().rev().zip(mesh.elements()) {
        reactions.push(passage.reaction * c);
        c = solve(&passage.change, &c);
        let deformation = passage.deformation * c;
        e = rigid_transfer(element.length_m) * e + deformation;
        deformations.push(deformation);
        deflections.push(e);
    }
    reactions.push(tip_reaction * c);
    DrivenMotion { theta, torque, deflections, deformations, reactions }
}

/// Transfers from the tip to every node at λ ≠ 0, also where a part of the link resonates.
///
/// Not finite only where no pivot is left at all, as at a zero of torque → tip on the real axis.
pub(super) fn pivoted_transfer(mesh: &Mesh, lambda: Complex64) -> NodalTransfer {
    let motion = driven_motion(mesh, lambda);
    let last = motion.deflections.len() - 1;
    let tip_displacement = motion.theta * mesh.length_m() + motion.deflections[last][0];
    let lag = |e: &Vector2<Complex64>| e[0] / (lambda * tip_displacement);
    let moment = |q: &Vector2<Complex64>| q[1] / tip_displacement;
    NodalTransfer {
        tip: TipTransfer {
            inertia_kg_m: motion.torque / tip_displacement,
            root_inertia_kg_m: moment(&motion.reactions[0]),
            angle_rad_m: motion.theta / tip_displacement,
            lag_s2: lag(&motion.deflections[last]),
        },
        lags_s2: motion.deflections.iter().map(lag).collect(),
        moments_kg_m: motion.reactions.iter().map(moment).collect(),
    }
}

/// Carries the plane from the outer node of an element to its inner node; returns the element's
/// deformation over the outer coefficients and the inner plane.
///
/// ```text
/// (K_d − λ(M_dd − M_udᵀ R⁻¹)) D = λ(M_udᵀ R⁻¹ U_j + Q_j)
/// U_i = R⁻¹(U_j − D),   Q_i = M_uu U_i + M_ud D + Rᵀ Q_j
/// ```
fn pass(element: &RelativeElement, lambda: Complex64, outer: &Plane) -> (Block, Plane) {
    let back = rigid_transfer(-element.length_m);
    let m_ud = complex(&element.m_ud);
    let through = m_ud.transpose() * back;
    let matrix = complex(&element.k_d) - (complex(&element.m_dd) - through) * lambda;
    let right = (through * outer.motion + outer.reaction) * lambda;
    let deformation = Block::from_columns(&[
        solve(&matrix, &right.column(0).into()),
        solve(&matrix, &right.column(1).into()),
    ]);
    let motion = back * (outer.motion - deformation);
    let reaction = complex(&element.m_uu) * motion
        + m_ud * deformation
        + rigid_transfer(element.length_m).transpose() * outer.reaction;
    (deformation, Plane { motion, reaction })
}

/// Makes the two rows that span the plane best its new coefficients.
fn renew(plane: &Plane, mesh: &Mesh) -> (Block, Plane) {
    let (length_m, mass_kg) = (mesh.length_m(), mesh.reference_mass_kg());
    // One unit for all four rows, so that their sizes can be compared.
    let rows = [
        plane.motion.row(0).into_owned(),
        plane.motion.row(1) * Complex64::from(length_m),
        plane.reaction.row(0) / Complex64::from(mass_kg),
        plane.reaction.row(1) / Complex64::from(mass_kg * length_m),
    ];
    let pairs = (0..4).flat_map(|a| (a + 1..4).map(move |b| Block::from_rows(&[rows[a], rows[b]])));
    let change = pairs
        .max_by(|a, b| a.determinant().norm().total_cmp(&b.determinant().norm()))
        .unwrap_or_else(Block::identity);
    // X̂ · change = X, row by row.
    let transposed = change.transpose();
    let express = |x: &Block| {
        let row = |k: usize| solve(&transposed, &x.row(k).transpose()).transpose();
        Block::from_rows(&[row(0), row(1)])
    };
    (change, Plane { motion: express(&plane.motion), reaction: express(&plane.reaction) })
}

/// `R = [[1, l], [0, 1]]`.
fn rigid_transfer(length_m: f64) -> Block {
    complex(&Matrix2::new(1.0, length_m, 0.0, 1.0))
}

fn complex(real: &Matrix2<f64>) -> Block {
    real.map(Complex64::from)
}

/// Gaussian elimination with partial pivoting; not a number where the matrix is singular, which
/// the caller's check of the result finds.
fn solve(matrix: &Block, right: &Vector2<Complex64>) -> Vector2<Complex64> {
    let nothing = || Vector2::repeat(Complex64::new(f64::NAN, f64::NAN));
    matrix.lu().solve(right).unwrap_or_else(nothing)
}
