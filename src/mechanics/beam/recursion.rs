//! The recursion at one λ. From tip to hub it condenses each element; from hub to tip it computes deflections and
//! moments at the nodes.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;

use super::element::RelativeElement;
use super::inertia::{Eliminated, Gain, Inertia, eliminate};
use super::mesh::Mesh;
use crate::numeric::{Scalar, Size, ThinnedGrid};

/// Result of the recursion at one element.
#[derive(Clone, Copy)]
pub struct Step<S: Scalar> {
    /// The eliminated system of the element; yields its gain.
    pub(super) eliminated: Eliminated<S>,
    /// Pivots of `K_d/λ − (M_dd + A_j)`; for real, positive λ their signs count modes.
    pub pivots: [S; 2],
    /// Apparent inertia at the element's inner node, including the inertia lumped there.
    pub inner: Inertia<S>,
}

impl<S: Scalar> Step<S> {
    /// Gain of the element.
    #[inline(always)]
    pub fn gain(&self) -> Gain<S> {
        self.eliminated.gain()
    }
}

/// Runs the recursion from tip to hub at λ and passes every element's [`Step`] to `visit`, the outermost element first.
/// Returns the apparent inertia at the link's root, node 0.
///
/// λ is the squared frequency over the relative complex stiffness: ω²/(1 + 2iξ) for the hysteretic law, ω² without
/// damping, −σ² for the zeros of torque → tip. With `B = M_ud + Rᵀ A_j`:
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

/// [`condense`] over some elements: from the apparent inertia at their outermost node to the one at their innermost.
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

/// The step over one element with the apparent inertia `a` at its outer end.
#[inline(always)]
fn condense_element<S: Scalar>(element: &RelativeElement, per_lambda: S, a: Inertia<S>) -> Step<S> {
    let RelativeElement { length_m: l, k_d, m_dd, m_ud, m_uu } = element;
    let l = *l;
    // Rᵀ A, whose first row is the first row of A.
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
    /// Apparent rotary inertia about the axis including the hub, in kg m²: torque per angular acceleration.
    pub inertia_kg_m2: S,
    /// Part of it from the link at the root, node 0, in kg m².
    pub root_inertia_kg_m2: S,
    /// Tip deflection `e_tip` per hub angle in m: the tip moves by `L + e_tip`.
    pub tip_deflection_m: S,
    /// 1/λ in s², from [`Mesh::per_lambda`].
    pub per_lambda_s2: S,
    /// Upper bound of |G| over all elements, with φ counted as φL.
    pub largest_gain: S::Size,
}

impl<S: Scalar> HubResponse<S> {
    /// Response about the axis, from the apparent inertia at the root and the tip's deflection.
    #[inline(always)]
    pub(super) fn at_axis(
        mesh: &Mesh,
        lambda: S,
        (root, largest_gain): (Inertia<S>, S::Size),
        tip_deflection_m: S,
    ) -> Self {
        let [v, phi] = mesh.rigid(0);
        Self {
            inertia_kg_m2: root.along([v, phi]) + mesh.joint().inertia(),
            root_inertia_kg_m2: root.vp * v + root.pp * phi,
            tip_deflection_m,
            per_lambda_s2: mesh.per_lambda(lambda),
            largest_gain,
        }
    }

    /// Tip displacement per hub angle, `v_tip/θ = L + e_tip`, in m.
    #[inline(always)]
    pub fn tip_displacement_m(&self, mesh: &Mesh) -> S {
        self.tip_deflection_m + mesh.rigid_tip()
    }
}

/// Response to a unit hub angle by the recursion alone. It carries the output's deflection inward from node to node,
/// beside the apparent inertia; the output is the tip, or a station on the link.
#[inline(always)]
pub fn hub_response<S: Scalar>(mesh: &Mesh, lambda: S) -> HubResponse<S> {
    let (one, link_m, output) = (lambda.lift(1.0).size(), mesh.length_m(), mesh.output());
    // Tip displacement per motion (v, φ) of the node, without its rigid part (1, L − x).
    let [mut e_v, mut e_phi] = [lambda.lift(0.0); 2];
    let mut largest_gain = lambda.lift(0.0).size();
    let root = condense(
        mesh,
        lambda,
        #[inline(always)]
        |index, step| {
            largest_gain = largest_gain.larger(step.eliminated.size(one, link_m));
            if index >= output {
                return;
            }
            let rigid = [e_v, e_v * mesh.relative_elements()[index].length_m + e_phi];
            let arm_m = mesh.output_m() - mesh.nodes_m()[index + 1];
            let bent = step.eliminated.along([e_v + 1.0, e_phi + arm_m]);
            [e_v, e_phi] = [rigid[0] + bent[0], rigid[1] + bent[1]];
        },
    );
    let [v, phi] = mesh.rigid(0);
    let tip_deflection_m = e_v * v + e_phi * phi;
    HubResponse::at_axis(mesh, lambda, (root, largest_gain), tip_deflection_m)
}

/// Tip displacement per hub angle, `v_tip/θ = L + e_tip`, in m, accurate also where it is small beside L.
///
/// Where both terms grow as e^{zt} the tip hardly moves, and less for larger z: the sum `L + e_tip` would be rounding.
/// So the recursion carries the whole displacement from tip to hub.
#[inline(always)]
pub fn tip_displacement_m<S: Scalar>(mesh: &Mesh, lambda: S) -> S {
    // Tip displacement per motion (v, φ) of the node.
    let (mut t_v, mut t_phi) = (lambda.lift(1.0), lambda.lift(0.0));
    condense(
        mesh,
        lambda,
        #[inline(always)]
        |index, step| {
            if index >= mesh.output() {
                return;
            }
            let rigid = [t_v, t_v * mesh.relative_elements()[index].length_m + t_phi];
            let bent = step.eliminated.along([t_v, t_phi]);
            [t_v, t_phi] = [rigid[0] + bent[0], rigid[1] + bent[1]];
        },
    );
    let [v, phi] = mesh.rigid(0);
    t_v * v + t_phi * phi
}

/// A quantity at the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodalQuantity {
    /// Deflection from the hub's tangent line.
    Deflection,
    /// Moment of the inner part on the outer part.
    Moment,
}

/// Histories of one quantity at some nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalHistories {
    /// Numbers of the nodes.
    pub nodes: Vec<usize>,
    /// Times of the samples.
    pub grid: ThinnedGrid,
    /// Samples of each node.
    pub samples: Vec<Vec<f64>>,
}

/// A node at which a pass begins, ends or resumes.
#[derive(Clone, Copy)]
pub(super) struct Checkpoint<S: Scalar> {
    pub(super) node: usize,
    /// Apparent inertia of the outboard part, from the pass from tip to hub.
    pub(super) inertia: Inertia<S>,
    /// Deflection and slope (e, e') per hub angle, from the pass from hub to tip.
    pub(super) deflection: [S; 2],
}

impl<S: Scalar> Checkpoint<S> {
    /// Checkpoints of the whole mesh at some nodes, the root first and the tip last: the inertia is known at the tip,
    /// the deflection at the root. `like` has the kind of number of λ.
    pub(super) fn of_mesh(mesh: &Mesh, like: S, nodes: &[usize]) -> Vec<Self> {
        let (inertia, deflection) = (mesh.tip_inertia().lift(like), [like.lift(0.0); 2]);
        nodes.iter().map(|node| Self { node: *node, inertia, deflection }).collect()
    }
}

/// One quantity at the nodes between two checkpoints per unit of hub angle, with the memory of the two passes.
pub(super) struct NodalRecursion<S: Scalar> {
    first: usize,
    gains: Vec<Gain<S>>,
    /// Apparent inertia at the nodes; empty unless the quantity is the moment.
    inertias: Vec<Inertia<S>>,
    /// The quantity at the nodes per hub angle: deflections in m, or moments in kg m².
    values: Vec<S>,
}

impl<S: Scalar> NodalRecursion<S> {
    /// Memory for the nodes at the ends of `elements`; `like` has the kind of number of λ.
    pub(super) fn new(elements: &Range<usize>, like: S, quantity: NodalQuantity) -> Self {
        let (zero, nodes) = (like.lift(0.0), elements.len() + 1);
        let inertias = match quantity {
            NodalQuantity::Deflection => vec![],
            NodalQuantity::Moment => vec![Inertia { vv: zero, vp: zero, pp: zero }; nodes],
        };
        Self {
            first: elements.start,
            gains: vec![Gain { vv: zero, vp: zero, pv: zero, pp: zero }; elements.len()],
            inertias,
            values: vec![zero; nodes],
        }
    }

    /// The quantity at all nodes, from the innermost on.
    pub(super) fn values(&self) -> &[S] {
        &self.values
    }

    /// The quantity at one node.
    #[inline(always)]
    pub(super) fn value(&self, node: usize) -> S {
        self.values[node - self.first]
    }

    /// Runs both passes, from the inertia at the last checkpoint and the deflection at the first; computes the values
    /// and completes all checkpoints. Returns an upper bound of |G|.
    #[inline(always)]
    pub(super) fn run(
        &mut self,
        mesh: &Mesh,
        lambda: S,
        quantity: NodalQuantity,
        checkpoints: &mut [Checkpoint<S>],
    ) -> S::Size {
        let largest_gain = self.inward(mesh, lambda, checkpoints);
        self.outward(mesh, quantity, checkpoints);
        largest_gain
    }

    /// Pass from tip to hub; returns an upper bound of |G|.
    #[inline(always)]
    fn inward(&mut self, mesh: &Mesh, lambda: S, checkpoints: &mut [Checkpoint<S>]) -> S::Size {
        let (one, per_lambda) = (lambda.lift(1.0).size(), mesh.per_lambda(lambda));
        let mut largest_gain = lambda.lift(0.0).size();
        let last = checkpoints.len() - 1;
        if let Some(outermost) = self.inertias.last_mut() {
            *outermost = checkpoints[last].inertia;
        }
        for k in (0..last).rev() {
            let (elements, outer) =
                (checkpoints[k].node..checkpoints[k + 1].node, checkpoints[k + 1].inertia);
            checkpoints[k].inertia = condense_part(
                mesh,
                per_lambda,
                elements,
                outer,
                #[inline(always)]
                |element, step| {
                    self.gains[element - self.first] = step.gain();
                    if let Some(inertia) = self.inertias.get_mut(element - self.first) {
                        *inertia = step.inner;
                    }
                    largest_gain = largest_gain.larger(step.eliminated.size(one, mesh.length_m()));
                },
            );
        }
        largest_gain
    }

    /// Pass from hub to tip.
    ///
    /// ```text
    /// e_0 = 0,  e_j = R e_i + G (e_i + (x_i, 1)ᵀ θ)                              for θ = 1
    /// ```
    #[inline(always)]
    pub(super) fn outward(
        &mut self,
        mesh: &Mesh,
        quantity: NodalQuantity,
        checkpoints: &mut [Checkpoint<S>],
    ) {
        let last = checkpoints.len() - 1;
        for k in 0..last {
            let [mut v, mut phi] = checkpoints[k].deflection;
            for element in checkpoints[k].node..checkpoints[k + 1].node {
                let (u_v, u_phi) = self.set(element, mesh, quantity, [v, phi]);
                let Gain { vv, vp, pv, pp } = self.gains[element - self.first];
                let (d_v, d_phi) = (vv * u_v + vp * u_phi, pv * u_v + pp * u_phi);
                (v, phi) = (v + phi * mesh.elements()[element].length_m + d_v, phi + d_phi);
            }
            checkpoints[k + 1].deflection = [v, phi];
        }
        let Checkpoint { node, deflection, .. } = checkpoints[last];
        self.set(node, mesh, quantity, deflection);
    }

    /// Sets the quantity at a node; returns the node's displacement and slope.
    #[inline(always)]
    fn set(
        &mut self,
        node: usize,
        mesh: &Mesh,
        quantity: NodalQuantity,
        [v, phi]: [S; 2],
    ) -> (S, S) {
        let rigid = mesh.rigid(node);
        let (u_v, u_phi) = (v + rigid[0], phi + rigid[1]);
        self.values[node - self.first] = match quantity {
            NodalQuantity::Deflection => v,
            NodalQuantity::Moment => self.inertias[node - self.first].moment(u_v, u_phi),
        };
        (u_v, u_phi)
    }
}
