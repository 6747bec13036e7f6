#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use nalgebra::Matrix2;

use super::element::RelativeElement;
use super::mesh::Mesh;
use crate::numeric::{Scalar, Size};

/// Symmetric 2×2 apparent inertia A on (v, φ): kg, kg m, kg m².
///
/// Minus the dynamic stiffness over the squared frequency of all that lies outboard of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia<S> {
    /// Force per acceleration in kg.
    pub vv: S,
    /// Force per angular acceleration, and moment per acceleration, in kg m.
    pub vp: S,
    /// Moment per angular acceleration in kg m².
    pub pp: S,
}

impl<S: Scalar> Inertia<S> {
    /// Moment in N m that a motion with accelerations (v, φ) needs.
    #[inline(always)]
    pub fn moment(&self, v: S, phi: S) -> S {
        self.vp * v + self.pp * phi
    }

    /// Rotary inertia about an axis that lies `arm` inboard, kg m².
    #[inline(always)]
    pub fn about(&self, arm: f64) -> S {
        self.pp + (self.vp + self.vp + self.vv * arm) * arm
    }

    #[inline(always)]
    fn plus(self, other: Inertia<f64>) -> Self {
        Self { vv: self.vv + other.vv, vp: self.vp + other.vp, pp: self.pp + other.pp }
    }
}

impl Inertia<f64> {
    /// A rigid body whose centre of mass lies `offset` outboard: kg, kg m², m.
    pub fn rigid(mass: f64, inertia: f64, offset: f64) -> Self {
        Self { vv: mass, vp: mass * offset, pp: inertia + mass * offset * offset }
    }

    /// As a matrix on (v, φ).
    pub fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.vv, self.vp, self.vp, self.pp)
    }

    /// As an inertia over numbers of the kind of `like`.
    #[inline(always)]
    pub(super) fn lift<S: Scalar>(self, like: S) -> Inertia<S> {
        Inertia { vv: like.lift(self.vv), vp: like.lift(self.vp), pp: like.lift(self.pp) }
    }
}

/// Deformation of an element per λ and per motion of its inner end: `d = λ Γ u_i`.
///
/// `Γ = (K_d − λ(M_dd + A_j))⁻¹ Bᵀ` stays finite at λ = 0, where `G = λΓ` vanishes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain<S> {
    /// `d_v` per `v_i`.
    pub vv: S,
    /// `d_v` per `φ_i`.
    pub vp: S,
    /// `d_φ` per `v_i`.
    pub pv: S,
    /// `d_φ` per `φ_i`.
    pub pp: S,
}

impl<S: Scalar> Gain<S> {
    /// Size of the largest entry, φ counted as φL with the length L in m.
    #[inline(always)]
    pub(super) fn size(&self, length_m: f64) -> S::Size {
        let v = self.vv.size().larger(self.vp.size() * (1.0 / length_m));
        let phi = (self.pv.size() * length_m).larger(self.pp.size());
        v.larger(phi)
    }
}

/// What the recursion passes on at one element.
#[derive(Debug, Clone, Copy)]
pub struct Step<S> {
    /// The element's gain.
    pub gain: Gain<S>,
    /// Pivots of `K_d − λ(M_dd + A_j)`; their signs count modes where λ is real.
    pub pivots: [S; 2],
    /// Apparent inertia at the element's inner node, what is lumped there included.
    pub inner: Inertia<S>,
}

/// Runs the recursion from tip to hub at λ and shows every element's [`Step`] to `visit`, the
/// outermost element first. Returns the apparent inertia at the link's root, node 0.
///
/// λ is the squared frequency over the relative complex stiffness: ω²/(1 + 2iξ) for the hysteretic
/// law, ω² without damping, −σ² for the zeros of torque → tip. With `B = M_ud + Rᵀ A_j`:
///
/// ```text
/// Γ   = (K_d − λ(M_dd + A_j))⁻¹ Bᵀ
/// A_i = M_uu + Rᵀ A_j R + λ B Γ + lumped mass at i          (Bayo 1987, eqs 15-17, condensed)
/// ```
#[inline(always)]
pub fn condense<S: Scalar>(
    mesh: &Mesh,
    lambda: S,
    mut visit: impl FnMut(usize, &Step<S>),
) -> Inertia<S> {
    let mut outer = mesh.tip_inertia().lift(lambda);
    for (index, element) in mesh.relative_elements().iter().enumerate().rev() {
        let mut step = condense_element(element, lambda, outer);
        if let Some(lumped) = mesh.lumped_inertia(index) {
            step.inner = step.inner.plus(lumped);
        }
        visit(index, &step);
        outer = step.inner;
    }
    outer
}

#[inline(always)]
fn condense_element<S: Scalar>(element: &RelativeElement, lambda: S, a: Inertia<S>) -> Step<S> {
    let RelativeElement { length_m: l, k_d, m_dd, m_ud, m_uu } = element;
    let l = *l;
    // Rᵀ A, of which the first row is A's own.
    let (ra_pv, ra_pp) = (a.vv * l + a.vp, a.vp * l + a.pp);
    let b = [[a.vv + m_ud.m11, a.vp + m_ud.m12], [ra_pv + m_ud.m21, ra_pp + m_ud.m22]];
    let negative = -lambda;
    let pivot_block = Inertia {
        vv: negative * (a.vv + m_dd.m11) + k_d.m11,
        vp: negative * (a.vp + m_dd.m12) + k_d.m12,
        pp: negative * (a.pp + m_dd.m22) + k_d.m22,
    };
    let (pivots, gain) = solve_symmetric(&pivot_block, l, &b);
    // λ B Γ is symmetric; its upper triangle suffices.
    let bg_vv = b[0][0] * gain.vv + b[0][1] * gain.pv;
    let bg_vp = b[0][0] * gain.vp + b[0][1] * gain.pp;
    let bg_pp = b[1][0] * gain.vp + b[1][1] * gain.pp;
    let inner = Inertia {
        vv: lambda * bg_vv + (a.vv + m_uu.m11),
        vp: lambda * bg_vp + (ra_pv + m_uu.m12),
        pp: lambda * bg_pp + (ra_pv * l + ra_pp + m_uu.m22),
    };
    Step { gain, pivots, inner }
}

/// Solves `P Γ = Bᵀ` by LDLᵀ, the larger of the two diagonal entries first.
///
/// The entries are compared in one unit: φ counts as φl. Without this choice the error near a
/// resonance of the outboard part would grow with |G|² instead of |G|.
#[inline(always)]
fn solve_symmetric<S: Scalar>(p: &Inertia<S>, l: f64, b: &[[S; 2]; 2]) -> ([S; 2], Gain<S>) {
    let order = Order { v: p.vv.size() * l * l, phi: p.pp.size() };
    let first = order.first(p.vv, p.pp);
    let per_first = first.reciprocal();
    let multiplier = p.vp * per_first;
    let second = order.second(p.vv, p.pp) - multiplier * p.vp;
    let factors = Factors { per_first, multiplier, per_second: second.reciprocal() };
    let (vv, pv) = factors.solve(&order, b[0]);
    let (vp, pp) = factors.solve(&order, b[1]);
    ([first, second], Gain { vv, vp, pv, pp })
}

/// Sizes of the diagonal entries; the larger one is eliminated first.
struct Order<S: Scalar> {
    v: S::Size,
    phi: S::Size,
}

impl<S: Scalar> Order<S> {
    #[inline(always)]
    fn first(&self, v: S, phi: S) -> S {
        S::choose(self.v, self.phi, v, phi)
    }

    #[inline(always)]
    fn second(&self, v: S, phi: S) -> S {
        S::choose(self.v, self.phi, phi, v)
    }
}

/// What LDLᵀ leaves for the right-hand sides.
struct Factors<S> {
    per_first: S,
    multiplier: S,
    per_second: S,
}

impl<S: Scalar> Factors<S> {
    /// The solution (v, φ) for a right-hand side.
    #[inline(always)]
    fn solve(&self, order: &Order<S>, [v, phi]: [S; 2]) -> (S, S) {
        let (right, left) = (order.first(v, phi), order.second(v, phi));
        let second = (left - self.multiplier * right) * self.per_second;
        let first = right * self.per_first - self.multiplier * second;
        (order.first(first, second), order.second(first, second))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_has_no_unit() {
        // Each entry in turn is the largest: of d over u, lengths in m.
        let entries = [[4.0, 1.0, 1.0, 1.0], [1.0, 6.0, 1.0, 1.0], [1.0, 1.0, 3.0, 1.0], [1.0; 4]];
        for [vv, vp, pv, pp] in entries {
            let metres = Gain { vv, vp, pv, pp };
            for per_metre in [1.0, 1e3, 1e-3] {
                let there = Gain { vv, vp: vp * per_metre, pv: pv / per_metre, pp };
                let (found, expected) = (there.size(1.5 * per_metre), metres.size(1.5));
                assert!((found / expected - 1.0).abs() < 1e-14, "{found} is not {expected}");
            }
        }
        let sizes = entries.map(|[vv, vp, pv, pp]| Gain { vv, vp, pv, pp }.size(1.5));
        assert_eq!(sizes.map(f64::to_bits), [4.0_f64, 4.0, 4.5, 1.5].map(f64::to_bits));
    }
}
