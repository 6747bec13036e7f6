//! Response of the link to a motion of its hub, by the recursion alone.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use super::condensation::{Inertia, Step, condense, condense_stretches};
use super::mesh::Mesh;
use super::tip_transfers::TipTransfer;
use crate::numeric::{Scalar, Size};

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
    /// What no gain exceeds on the way: |G|, φ counted as φL, and the motion of nodes within
    /// stretches of equal elements per motion of the stretches' ends.
    pub largest_gain: S::Size,
}

impl<S: Scalar> HubResponse<S> {
    /// What the recursion leaves, seen from the axis.
    #[inline(always)]
    pub(super) fn at_axis(mesh: &Mesh, per_lambda_s2: S, reached: Reached<S>) -> Self {
        let Reached { root, tip_deflection_m, largest_gain } = reached;
        let root_m = mesh.nodes_m()[0];
        Self {
            inertia_kg_m2: root.about(root_m) + mesh.hub_inertia_kg_m2(),
            root_inertia_kg_m2: root.vp * root_m + root.pp,
            tip_deflection_m,
            per_lambda_s2,
            largest_gain,
        }
    }

    /// Tip displacement per hub angle, `v_tip/θ = L + e_tip`, in m.
    #[inline(always)]
    pub fn tip_displacement_m(&self, mesh: &Mesh) -> S {
        self.tip_deflection_m + mesh.length_m()
    }

    /// The same per unit of tip motion.
    #[inline(always)]
    pub(super) fn per_tip(&self, mesh: &Mesh) -> TipTransfer<S> {
        let angle_rad_m = self.tip_displacement_m(mesh).reciprocal();
        TipTransfer {
            inertia_kg_m: self.inertia_kg_m2 * angle_rad_m,
            root_inertia_kg_m: self.root_inertia_kg_m2 * angle_rad_m,
            angle_rad_m,
            lag_s2: self.tip_deflection_m * self.per_lambda_s2 * angle_rad_m,
        }
    }
}

/// What the recursion leaves at the root and the tip, per unit of hub angle.
#[derive(Clone, Copy)]
pub(super) struct Reached<S: Scalar> {
    /// Apparent inertia at the root.
    pub(super) root: Inertia<S>,
    /// Deflection of the tip in m.
    pub(super) tip_deflection_m: S,
    /// What no gain exceeds.
    pub(super) largest_gain: S::Size,
}

/// Response to a unit hub angle by the recursion alone, for the roots that modes and zeros are.
#[inline(always)]
pub fn hub_response<S: Scalar>(mesh: &Mesh, lambda: S) -> HubResponse<S> {
    let mut tip = TipDeflection::new(mesh, lambda);
    let root = condense(
        mesh,
        lambda,
        #[inline(always)]
        |index, step| {
            tip.carry_over(index + 1, mesh.relative_elements()[index].length_m, step);
        },
    );
    HubResponse::at_axis(mesh, mesh.per_lambda(lambda), tip.reached(root))
}

/// The same by stretches of equal elements, for λ that are damped (`transfer.rs` tells why).
#[inline(always)]
pub(super) fn hub_response_by_stretches<S: Scalar>(mesh: &Mesh, lambda: S) -> HubResponse<S> {
    let mut tip = TipDeflection::new(mesh, lambda);
    let (root, within_stretches) = condense_stretches(
        mesh,
        lambda,
        #[inline(always)]
        |outer_node, length_m, step| tip.carry_over(outer_node, length_m, step),
    );
    tip.largest_gain = tip.largest_gain.larger(within_stretches);
    HubResponse::at_axis(mesh, mesh.per_lambda(lambda), tip.reached(root))
}

/// Deflection of the tip, carried inward from node to node.
struct TipDeflection<'a, S: Scalar> {
    mesh: &'a Mesh,
    one: S::Size,
    /// Tip displacement per motion (v, φ) of the node, less its rigid part (1, L − x).
    e: [S; 2],
    /// What no gain so far exceeds.
    largest_gain: S::Size,
}

impl<'a, S: Scalar> TipDeflection<'a, S> {
    /// At the tip; `like` is of the kind of number that λ is.
    #[inline(always)]
    fn new(mesh: &'a Mesh, like: S) -> Self {
        let (zero, one) = (like.lift(0.0), like.lift(1.0).size());
        Self { mesh, one, e: [zero; 2], largest_gain: zero.size() }
    }

    /// From this node over the element or stretch inboard of it, of this length in m.
    #[inline(always)]
    fn carry_over(&mut self, outer_node: usize, length_m: f64, step: &Step<S>) {
        let ([e_v, e_phi], link_m) = (self.e, self.mesh.length_m());
        let rigid = [e_v, e_v * length_m + e_phi];
        let arm_m = link_m - self.mesh.nodes_m()[outer_node];
        let bent = step.eliminated.along([e_v + 1.0, e_phi + arm_m]);
        self.e = [rigid[0] + bent[0], rigid[1] + bent[1]];
        self.largest_gain = self.largest_gain.larger(step.eliminated.size(self.one, link_m));
    }

    #[inline(always)]
    fn reached(&self, root: Inertia<S>) -> Reached<S> {
        let tip_deflection_m = self.e[0] * self.mesh.nodes_m()[0] + self.e[1];
        Reached { root, tip_deflection_m, largest_gain: self.largest_gain }
    }
}

/// Tip displacement per hub angle, `v_tip/θ = L + e_tip`, in m, where it is small beside L, too.
///
/// Where both grow as e^{zt} the tip hardly moves, and less the larger z: as a sum, `L + e_tip` would
/// be rounding. What is carried here from tip to hub is the displacement itself, all of it.
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
