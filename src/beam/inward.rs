//! The recursion from tip to hub: every element condensed in turn, at one λ.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;

use super::element::RelativeElement;
use super::inertia::{Eliminated, Gain, Inertia, eliminate};
use super::mesh::Mesh;
use crate::numeric::{Scalar, Size};

/// Result of the recursion at one element.
#[derive(Clone, Copy)]
pub struct Step<S: Scalar> {
    /// The element's gain, as the elimination leaves it.
    pub(super) eliminated: Eliminated<S>,
    /// Pivots of `K_d/λ − (M_dd + A_j)`; their signs count modes where λ is real and positive.
    pub pivots: [S; 2],
    /// Apparent inertia at the element's inner node, the inertia lumped there included.
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
    visit: impl FnMut(usize, &Step<S>),
) -> Inertia<S> {
    let elements = 0..mesh.elements().len();
    let per_lambda = mesh.per_lambda(lambda);
    let tip = mesh.tip_inertia().lift(per_lambda);
    condense_part(mesh, per_lambda, elements, tip, visit)
}

/// [`condense`] over some elements: from the apparent inertia at the outermost node to that at the
/// innermost.
#[inline(always)]
pub(super) fn condense_part<S: Scalar>(
    mesh: &Mesh,
    per_lambda: S,
    elements: Range<usize>,
    outermost: Inertia<S>,
    mut visit: impl FnMut(usize, &Step<S>),
) -> Inertia<S> {
    let (first, mut outer) = (elements.start, outermost);
    for (index, element) in mesh.relative_elements()[elements].iter().enumerate().rev() {
        let index = first + index;
        let mut step = condense_element(element, per_lambda, outer);
        if let Some(lumped) = mesh.lumped_inertia(index) {
            step.inner = step.inner.plus(lumped);
        }
        visit(index, &step);
        outer = step.inner;
    }
    outer
}

/// The step over one element, `a` being the apparent inertia at its outer end.
#[inline(always)]
fn condense_element<S: Scalar>(element: &RelativeElement, per_lambda: S, a: Inertia<S>) -> Step<S> {
    let RelativeElement { length_m: l, k_d, m_dd, m_ud, m_uu } = element;
    let l = *l;
    // Rᵀ A, of which the first row is A's own.
    let (ra_pv, ra_pp) = (a.vv * l + a.vp, a.vp * l + a.pp);
    let b = [[a.vv + m_ud.m11, a.vp + m_ud.m12], [ra_pv + m_ud.m21, ra_pp + m_ud.m22]];
    let pivot_block = Inertia {
        vv: per_lambda * k_d.m11 - (a.vv + m_dd.m11),
        vp: per_lambda * k_d.m12 - (a.vp + m_dd.m12),
        pp: per_lambda * k_d.m22 - (a.pp + m_dd.m22),
    };
    let (pivots, eliminated) = eliminate(&pivot_block, l, &b);
    let bg = eliminated.inertia();
    let inner = Inertia {
        vv: bg.vv + (a.vv + m_uu.m11),
        vp: bg.vp + (ra_pv + m_uu.m12),
        pp: bg.pp + (ra_pv * l + ra_pp + m_uu.m22),
    };
    Step { eliminated, pivots, inner }
}

/// Motion of the tip and moment at the axis per unit of hub angle, at one λ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HubResponse<S: Scalar> {
    /// Apparent rotary inertia about the axis, the hub's included, in kg m²: torque per angular
    /// acceleration.
    pub inertia_kg_m2: S,
    /// The link's own part of it that acts at the root, node 0, in kg m².
    pub root_inertia_kg_m2: S,
    /// Tip deflection `e_tip` per hub angle in m: the tip moves by `L + e_tip`.
    pub tip_deflection_m: S,
    /// 1/λ in s², as [`Mesh::per_lambda`] has it.
    pub per_lambda_s2: S,
    /// Upper bound of |G| over all elements, φ counted as φL.
    pub largest_gain: S::Size,
}

impl<S: Scalar> HubResponse<S> {
    /// The apparent inertia at the root and the tip's deflection, seen from the axis.
    #[inline(always)]
    pub(super) fn at_axis(
        mesh: &Mesh,
        lambda: S,
        (root, largest_gain): (Inertia<S>, S::Size),
        tip_deflection_m: S,
    ) -> Self {
        let root_m = mesh.nodes_m()[0];
        Self {
            inertia_kg_m2: root.about(root_m) + mesh.hub_inertia_kg_m2(),
            root_inertia_kg_m2: root.vp * root_m + root.pp,
            tip_deflection_m,
            per_lambda_s2: mesh.per_lambda(lambda),
            largest_gain,
        }
    }

    /// Tip displacement per hub angle, `v_tip/θ = L + e_tip`, in m.
    #[inline(always)]
    pub fn tip_displacement_m(&self, mesh: &Mesh) -> S {
        self.tip_deflection_m + mesh.length_m()
    }
}

/// Response to a unit hub angle by the recursion alone: the tip's deflection is carried inward from
/// node to node beside the apparent inertia.
#[inline(always)]
pub fn hub_response<S: Scalar>(mesh: &Mesh, lambda: S) -> HubResponse<S> {
    let (one, link_m) = (lambda.lift(1.0).size(), mesh.length_m());
    // Tip displacement per motion (v, φ) of the node, less its rigid part (1, L − x).
    let [mut e_v, mut e_phi] = [lambda.lift(0.0); 2];
    let mut largest_gain = lambda.lift(0.0).size();
    let root = condense(
        mesh,
        lambda,
        #[inline(always)]
        |index, step| {
            let rigid = [e_v, e_v * mesh.relative_elements()[index].length_m + e_phi];
            let arm_m = link_m - mesh.nodes_m()[index + 1];
            let bent = step.eliminated.along([e_v + 1.0, e_phi + arm_m]);
            [e_v, e_phi] = [rigid[0] + bent[0], rigid[1] + bent[1]];
            largest_gain = largest_gain.larger(step.eliminated.size(one, link_m));
        },
    );
    let tip_deflection_m = e_v * mesh.nodes_m()[0] + e_phi;
    HubResponse::at_axis(mesh, lambda, (root, largest_gain), tip_deflection_m)
}

/// Tip displacement per hub angle, `v_tip/θ = L + e_tip`, in m, where it is small beside L, too.
///
/// Where both grow as e^{zt} the tip hardly moves, and less the larger z: as a sum, `L + e_tip` would
/// be rounding. So the whole displacement is carried from tip to hub.
#[inline(always)]
pub fn tip_displacement_m<S: Scalar>(mesh: &Mesh, lambda: S) -> S {
    // Tip displacement per motion (v, φ) of the node.
    let (mut t_v, mut t_phi) = (lambda.lift(1.0), lambda.lift(0.0));
    condense(
        mesh,
        lambda,
        #[inline(always)]
        |index, step| {
            let rigid = [t_v, t_v * mesh.relative_elements()[index].length_m + t_phi];
            let bent = step.eliminated.along([t_v, t_phi]);
            [t_v, t_phi] = [rigid[0] + bent[0], rigid[1] + bent[1]];
        },
    );
    t_v * mesh.nodes_m()[0] + t_phi
}
