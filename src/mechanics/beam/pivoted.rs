//! The recursion with row pivoting, for frequencies at which the outboard part resonates.
//!
//! There the apparent inertia A has a pole, and the plain recursion loses all digits. The set of possible pairs (motion
//! u, reaction q = A u) of the outboard part stays finite: a plane in four dimensions. The recursion carries it inward
//! as u = U c, q = Q c with two free coefficients c. After every element the new coefficients are the two rows of U and
//! Q with the largest determinant. At a resonance u is then small beside q, and no matrix is singular.

use nalgebra::{ComplexField, Matrix2, Vector2};
use num_complex::Complex64;

use super::element::RelativeElement;
use super::mesh::Mesh;

/// Numbers of the recursion with pivoting: complex ones, and real ones for modes.
pub(crate) trait PivotedScalar: ComplexField<RealField = f64> + Copy {}

impl PivotedScalar for f64 {}
impl PivotedScalar for Complex64 {}

type Block<S> = Matrix2<S>;

/// Possible motions `U c` and reactions `Q c` of the part outboard of a node, for any c.
#[derive(Clone, Copy)]
struct Admitted<S> {
    motion: Block<S>,
    reaction: Block<S>,
}

/// Data of one element for the pass from hub to tip.
struct ElementMotion<S> {
    /// Inner coefficients per outer ones: `c_i = change · c_j`.
    change: Block<S>,
    /// Deformation `d = D c_j`.
    deformation: Block<S>,
    /// Reaction at the inner node over `c_i`.
    reaction: Block<S>,
}

/// Motion of the whole link at one λ under a torque at the hub only, of arbitrary size.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DrivenMotion<S> {
    /// Hub angle θ.
    pub theta: S,
    /// Torque at the hub over −ω².
    pub torque: S,
    /// Deflection and slope (e, e') of nodes 0 … n from the hub's tangent line.
    pub deflections: Vec<Vector2<S>>,
    /// Deformation of every element: motion of its outer end relative to its inner end's tangent. On fine meshes the
    /// difference of the deflections would be too small to keep its digits.
    pub deformations: Vec<Vector2<S>>,
    /// Reaction (force, moment) over −ω² of the parts outboard of nodes 0 … n.
    pub reactions: Vec<Vector2<S>>,
}

/// Motion due to a torque at the hub at λ, also where the link or a part of it resonates.
pub(crate) fn driven_motion<S: PivotedScalar>(mesh: &Mesh, lambda: S) -> DrivenMotion<S> {
    let mut outer = Admitted {
        motion: Block::<S>::identity(),
        reaction: lifted::<S>(&mesh.tip_inertia().matrix()),
    };
    let tip_reaction = outer.reaction;
    let (length_m, mass_kg) = (mesh.length_m(), mesh.reference_mass_kg());
    let mut motions = Vec::with_capacity(mesh.elements().len());
    for (index, element) in mesh.relative_elements().iter().enumerate().rev() {
        let (deformation, mut inner) = pass(element, lambda, &outer);
        if let Some(lumped) = mesh.lumped_inertia(index) {
            inner.reaction += lifted::<S>(&lumped.matrix()) * inner.motion;
        }
        let (change, renewed) = renew(&inner, length_m, mass_kg);
        motions.push(ElementMotion { change, deformation, reaction: renewed.reaction });
        outer = renewed;
    }
    // The joint moves the root along its unit motion, which leaves one coefficient of free size.
    let [v, phi] = mesh.rigid(0).map(S::from_real);
    let held = outer.motion.row(0) * phi - outer.motion.row(1) * v;
    let mut c = Vector2::new(-held[1], held[0]).unscale(held.norm_squared().sqrt());
    let theta = mesh.joint().position((outer.motion * c).into());
    let at_root = outer.reaction * c;
    let torque = at_root[1] * phi + at_root[0] * v + theta * S::from_real(mesh.joint().inertia());

    let mut e = Vector2::zeros();
    let mut deflections = vec![e];
    let mut deformations = Vec::with_capacity(motions.len());
    let mut reactions = Vec::with_capacity(motions.len() + 1);
    for (motion, element) in motions.iter().rev().zip(mesh.elements()) {
        reactions.push(motion.reaction * c);
        c = Elimination::of(&motion.change).solve(&c);
        let deformation = motion.deformation * c;
        e = rigid_transfer::<S>(element.length_m) * e + deformation;
        deformations.push(deformation);
        deflections.push(e);
    }
    reactions.push(tip_reaction * c);
    DrivenMotion { theta, torque, deflections, deformations, reactions }
}

/// Carries the plane from the outer node of an element to its inner node; returns the element's
/// deformation over the outer coefficients and the inner plane.
///
/// ```text
/// (K_d − λ(M_dd − M_udᵀ R⁻¹)) D = λ(M_udᵀ R⁻¹ U_j + Q_j)
/// U_i = R⁻¹(U_j − D),   Q_i = M_uu U_i + M_ud D + Rᵀ Q_j
/// ```
fn pass<S: PivotedScalar>(
    element: &RelativeElement,
    lambda: S,
    outer: &Admitted<S>,
) -> (Block<S>, Admitted<S>) {
    let back = rigid_transfer::<S>(-element.length_m);
    let m_ud = lifted::<S>(&element.m_ud);
    let through = m_ud.transpose() * back;
    let matrix = lifted::<S>(&element.k_d) - (lifted::<S>(&element.m_dd) - through) * lambda;
    let right = (through * outer.motion + outer.reaction) * lambda;
    let deformation = Elimination::of(&matrix).solve_columns(&right);
    let motion = back * (outer.motion - deformation);
    let reaction = lifted::<S>(&element.m_uu) * motion
        + m_ud * deformation
        + rigid_transfer::<S>(element.length_m).transpose() * outer.reaction;
    (deformation, Admitted { motion, reaction })
}

/// Makes the two rows of U and Q with the largest determinant the new coefficients.
fn renew<S: PivotedScalar>(
    admitted: &Admitted<S>,
    length_m: f64,
    mass_kg: f64,
) -> (Block<S>, Admitted<S>) {
    // One unit for all four rows, so that their sizes are comparable.
    let rows = [
        admitted.motion.row(0).into_owned(),
        admitted.motion.row(1) * S::from_real(length_m),
        admitted.reaction.row(0) * S::from_real(1.0 / mass_kg),
        admitted.reaction.row(1) * S::from_real(1.0 / (mass_kg * length_m)),
    ];
    let (mut change, mut largest) = (Block::identity(), f64::NEG_INFINITY);
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        let pair = Block::from_rows(&[rows[a], rows[b]]);
        let size = pair.determinant().modulus_squared();
        if size >= largest {
            (change, largest) = (pair, size);
        }
    }
    // X̂ · change = X, row by row.
    let elimination = Elimination::of(&change.transpose());
    let express = |x: &Block<S>| elimination.solve_columns(&x.transpose()).transpose();
    (change, Admitted { motion: express(&admitted.motion), reaction: express(&admitted.reaction) })
}

/// `R = [[1, l], [0, 1]]`.
fn rigid_transfer<S: PivotedScalar>(length_m: f64) -> Block<S> {
    lifted::<S>(&Matrix2::new(1.0, length_m, 0.0, 1.0))
}

fn lifted<S: PivotedScalar>(real: &Matrix2<f64>) -> Block<S> {
    real.map(S::from_real)
}

/// Gaussian elimination of a 2×2 matrix with partial pivoting. For a singular matrix the solutions are not finite; the
/// caller checks for it.
struct Elimination<S> {
    /// Row of the first pivot.
    first: usize,
    per_pivot: S,
    beside_pivot: S,
    multiplier: S,
    per_second: S,
}

impl<S: PivotedScalar> Elimination<S> {
    fn of(matrix: &Block<S>) -> Self {
        let is_first = matrix[(0, 0)].norm1() >= matrix[(1, 0)].norm1();
        let (first, second) = if is_first { (0, 1) } else { (1, 0) };
        let per_pivot = matrix[(first, 0)].recip();
        let multiplier = matrix[(second, 0)] * per_pivot;
        let beside_pivot = matrix[(first, 1)];
        let per_second = (matrix[(second, 1)] - multiplier * beside_pivot).recip();
        Self { first, per_pivot, beside_pivot, multiplier, per_second }
    }

    fn solve(&self, right: &Vector2<S>) -> Vector2<S> {
        let (first, second) = (right[self.first], right[1 - self.first]);
        let y = (second - self.multiplier * first) * self.per_second;
        Vector2::new((first - self.beside_pivot * y) * self.per_pivot, y)
    }

    fn solve_columns(&self, right: &Block<S>) -> Block<S> {
        Block::from_columns(&[
            self.solve(&right.column(0).into()),
            self.solve(&right.column(1).into()),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::transfer::pivoted_transfer;
    use crate::link::{Hub, Link, LinkParts, Taper, uniform, uniform_segment};

    /// A uniform link with scaled lengths and masses; the stiffness scales so that times stay the same.
    fn mesh(lengths: f64, masses: f64) -> Mesh {
        let mut segment = uniform_segment();
        segment.length_m *= lengths;
        segment.bending_stiffness_n_m2 = Taper::constant(5.0 * masses * lengths.powi(3));
        segment.mass_per_length_kg_m = Taper::constant(0.8 * masses / lengths);
        let hub = Hub { inertia_kg_m2: 0.1 * masses * lengths.powi(2), ..Hub::default() };
        let link = Link::new(LinkParts { segments: vec![segment], hub, ..uniform() }).unwrap();
        Mesh::on(&link, 12)
    }

    /// Units that are powers of two keep every digit; only other lengths could choose other pivots.
    #[test]
    fn a_transfer_is_the_same_in_all_units() {
        let one = mesh(1.0, 1.0);
        for omega in [0.3, 4.0, 11.0, 33.9, 120.0, 700.0_f64] {
            for lambda in
                [Complex64::from(omega.powi(2)), Complex64::new(1.0, -0.04) * omega.powi(2)]
            {
                let expected = pivoted_transfer(&one, lambda);
                for power in [-40, -12, 12, 40] {
                    let unit = 2.0_f64.powi(power);
                    let heavy = pivoted_transfer(&mesh(1.0, unit), lambda);
                    assert!(
                        heavy.deflections_s2 == expected.deflections_s2,
                        "{lambda}: masses times {unit}"
                    );
                    let moments = expected.moments_kg_m.iter().map(|moment| moment * unit);
                    assert!(heavy.moments_kg_m.iter().copied().eq(moments), "{lambda}, {unit}");
                    let long = pivoted_transfer(&mesh(unit, 1.0), lambda);
                    let off =
                        (long.tip.inertia_kg_m / (expected.tip.inertia_kg_m * unit) - 1.0).norm();
                    assert!(off < 1e-11, "{lambda}: {off:e} with lengths times {unit}");
                }
            }
        }
    }

    #[test]
    fn the_first_entry_of_a_matrix_may_be_next_to_nothing() {
        for tiny in [0.0, 1e-30, -1e-18] {
            for matrix in [Matrix2::new(tiny, 2.0, 3.0, 1.0), Matrix2::new(3.0, 1.0, tiny, 2.0)] {
                let exact = Vector2::new(1.0, 2.0);
                let found = Elimination::of(&matrix).solve(&(matrix * exact));
                assert!((found - exact).norm() < 1e-15, "{found} of {matrix}");
            }
        }
    }
}
