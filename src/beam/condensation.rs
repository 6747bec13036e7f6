#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use nalgebra::Matrix2;

use super::element::RelativeElement;
use super::elimination::{Eliminated, Gain, eliminate};
use super::mesh::Mesh;
use super::stretch::Stretch;
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

/// What the recursion passes on at one element.
#[derive(Clone, Copy)]
pub struct Step<S: Scalar> {
    /// The element's gain, as the elimination leaves it.
    pub(super) eliminated: Eliminated<S>,
    /// Pivots of `K_d/λ − (M_dd + A_j)`; their signs count modes where λ is real and positive.
    pub pivots: [S; 2],
    /// Apparent inertia at the element's inner node, what is lumped there included.
    pub inner: Inertia<S>,
}

impl<S: Scalar> Step<S> {
    /// The element's gain.
    #[inline(always)]
    pub fn gain(&self) -> Gain<S> {
        self.eliminated.gain()
    }
}

/// Runs the recursion from tip to hub at λ, element by element, and shows every element's [`Step`] to
/// `visit`, the outermost element first. Returns the apparent inertia at the link's root, node 0.
///
/// λ is the squared frequency over the relative complex stiffness: ω²/(1 + 2iξ) for the hysteretic
/// law, ω² without damping, −σ² for the zeros of torque → tip. With `B = M_ud + Rᵀ A_j`:
///
/// ```text
/// G   = (K_d/λ − (M_dd + A_j))⁻¹ Bᵀ
/// A_i = M_uu + Rᵀ A_j R + B G + lumped mass at i            (Bayo 1987, eqs 15-17, condensed)
/// ```
#[inline(always)]
pub fn condense<S: Scalar>(
    mesh: &Mesh,
    lambda: S,
    mut visit: impl FnMut(usize, &Step<S>),
) -> Inertia<S> {
    let per_lambda = mesh.per_lambda(lambda);
    let mut outer = mesh.tip_inertia().lift(per_lambda);
    for (index, element) in mesh.relative_elements().iter().enumerate().rev() {
        let mut step = condense_element(element, per_lambda, outer);
        if let Some(lumped) = mesh.lumped_inertia(index) {
            step.inner = step.inner.plus(lumped);
        }
        visit(index, &step);
        outer = step.inner;
    }
    outer
}

/// The same by stretches of 2ᵏ equal elements, of which a row has as many as its number of elements
/// has binary ones, in time that grows with k: `visit` gets the number of a stretch's outer node, its
/// length in m, and its [`Step`].
///
/// Returns, besides, what no gain within a stretch exceeds.
#[inline(always)]
pub(super) fn condense_stretches<S: Scalar>(
    mesh: &Mesh,
    lambda: S,
    mut visit: impl FnMut(usize, f64, &Step<S>),
) -> (Inertia<S>, S::Size) {
    let per_lambda = mesh.per_lambda(lambda);
    let mut largest_gain = lambda.lift(0.0).size();
    let mut outer = mesh.tip_inertia().lift(per_lambda);
    for row in mesh.rows().iter().rev() {
        let (element, count) = (&mesh.relative_elements()[row.start], row.len());
        let mut outer_node = row.end;
        if count % 2 == 1 {
            let step = condense_element(element, per_lambda, outer);
            visit(outer_node, element.length_m, &step);
            outer = step.inner;
            outer_node -= 1;
        }
        if count > 1 {
            let (mut stretch, mut gain) = Stretch::of(element, per_lambda).doubled();
            let mut elements = 2;
            loop {
                largest_gain = largest_gain.larger(gain);
                if count & elements != 0 {
                    let step = stretch.condense(outer);
                    visit(outer_node, stretch.length_m, &step);
                    outer = step.inner;
                    outer_node -= elements;
                }
                elements *= 2;
                if elements > count {
                    break;
                }
                (stretch, gain) = stretch.doubled();
            }
        }
        if let Some(lumped) = mesh.lumped_inertia(row.start) {
            outer = outer.plus(lumped);
        }
    }
    (outer, largest_gain)
}

#[inline(always)]
fn condense_element<S: Scalar>(element: &RelativeElement, per_lambda: S, a: Inertia<S>) -> Step<S> {
    let RelativeElement { length_m: l, k_d, m_dd, m_ud, m_uu } = element;
    let l = *l;
    // Rᵀ A, of which the first row is A's own.
    let (ra_pv, ra_pp) = (a.vv * l + a.vp, a.vp * l + a.pp);
    let b = [[a.vv + m_ud.m11, a.vp + m_ud.m12], [ra_pv + m_ud.m21, ra_pp + m_ud.m22]];
    Outboard {
        pivot_block: Inertia {
            vv: per_lambda * k_d.m11 - (a.vv + m_dd.m11),
            vp: per_lambda * k_d.m12 - (a.vp + m_dd.m12),
            pp: per_lambda * k_d.m22 - (a.pp + m_dd.m22),
        },
        b,
        carried: Inertia {
            vv: a.vv + m_uu.m11,
            vp: ra_pv + m_uu.m12,
            pp: ra_pv * l + ra_pp + m_uu.m22,
        },
    }
    .condensed(l)
}

/// A stretch and all that is outboard of it, before its outer end is condensed.
pub(super) struct Outboard<S> {
    /// `K_d/λ − (M_dd + A_j)`.
    pub(super) pivot_block: Inertia<S>,
    /// `M_ud + Rᵀ A_j`.
    pub(super) b: [[S; 2]; 2],
    /// `M_uu + Rᵀ A_j R`.
    pub(super) carried: Inertia<S>,
}

impl<S: Scalar> Outboard<S> {
    /// Condenses the outer end of a stretch of this length in m.
    #[inline(always)]
    pub(super) fn condensed(&self, length_m: f64) -> Step<S> {
        let (pivots, eliminated) = eliminate(&self.pivot_block, length_m, &self.b);
        let (bg, carried) = (eliminated.inertia(), self.carried);
        let inner =
            Inertia { vv: bg.vv + carried.vv, vp: bg.vp + carried.vp, pp: bg.pp + carried.pp };
        Step { eliminated, pivots, inner }
    }
}
