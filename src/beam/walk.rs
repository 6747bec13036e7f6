//! The way back from hub to tip, for what the nodes do.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;

use super::condensation::{Inertia, condense};
use super::elimination::Gain;
use super::hub_response::{HubResponse, Reached};
use super::mesh::Mesh;
use super::pivoted::pivoted_transfer;
use super::tip_transfers::TipTransfer;
use super::transfer::{is_real, is_trusted};
use crate::numeric::{Scalar, Size};

/// Transfers from the tip to every node at one λ, per unit of tip motion.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalTransfer {
    /// Torque, hub angle and tip.
    pub tip: TipTransfer,
    /// Deflection `e_i/(λ (L + e_tip))` of nodes 0 … n in s² (eq 21).
    pub lags_s2: Vec<Complex64>,
    /// Moment in kg m per tip acceleration that the inner part of the link exerts on the outer
    /// part at nodes 0 … n; what is lumped at the node counts as outer.
    pub moments_kg_m: Vec<Complex64>,
}

impl NodalTransfer {
    /// Those of a quantity, at nodes 0 … n.
    pub fn values(&self, quantity: NodalQuantity) -> &[Complex64] {
        match quantity {
            NodalQuantity::Deflection => &self.lags_s2,
            NodalQuantity::Moment => &self.moments_kg_m,
        }
    }
}

/// A quantity at the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodalQuantity {
    /// Deflection from the hub's tangent line.
    Deflection,
    /// Moment of the inner on the outer part.
    Moment,
}

/// What the recursion leaves at the elements and nodes, for the way back.
pub(super) struct Walk<S: Scalar> {
    gains: Vec<Gain<S>>,
    /// Empty unless moments are asked for.
    inertias: Vec<Inertia<S>>,
    /// The quantity at nodes 0 … n per hub angle: deflections in m, or moments in kg m².
    pub(super) values: Vec<S>,
}

impl<S: Scalar> Walk<S> {
    /// Room for a mesh; `like` is of the kind of number that λ will be.
    pub(super) fn new(mesh: &Mesh, like: S, quantity: NodalQuantity) -> Self {
        let zero = like.lift(0.0);
        let inertias = match quantity {
            NodalQuantity::Deflection => vec![],
            NodalQuantity::Moment => vec![mesh.tip_inertia().lift(like); mesh.nodes_m().len()],
        };
        Self {
            gains: vec![Gain { vv: zero, vp: zero, pv: zero, pp: zero }; mesh.elements().len()],
            inertias,
            values: vec![zero; mesh.nodes_m().len()],
        }
    }

    /// From tip to hub; returns the apparent inertia at the root and what no gain exceeds.
    #[inline(always)]
    pub(super) fn inward(&mut self, mesh: &Mesh, lambda: S) -> (Inertia<S>, S::Size) {
        let one = lambda.lift(1.0).size();
        let mut largest_gain = lambda.lift(0.0).size();
        let root = condense(
            mesh,
            lambda,
            #[inline(always)]
            |index, step| {
                self.gains[index] = step.gain();
                // The tip's own inertia is there from the start.
                if let Some(inertia) = self.inertias.get_mut(index) {
                    *inertia = step.inner;
                }
                largest_gain = largest_gain.larger(step.eliminated.size(one, mesh.length_m()));
            },
        );
        (root, largest_gain)
    }

    /// From hub to tip; fills `values` and returns the tip's deflection in m, both per unit of hub
    /// angle; `like` is of the kind of number that λ is.
    ///
    /// ```text
    /// e_0 = 0,  e_j = R e_i + G (e_i + (x_i, 1)ᵀ θ)                              for θ = 1
    /// ```
    #[inline(always)]
    pub(super) fn outward(&mut self, mesh: &Mesh, like: S, quantity: NodalQuantity) -> S {
        let nodes_m = mesh.nodes_m();
        let (mut v, mut phi) = (like.lift(0.0), like.lift(0.0));
        for (node, x_m) in nodes_m.iter().enumerate() {
            let (u_v, u_phi) = (v + *x_m, phi + 1.0);
            self.values[node] = match quantity {
                NodalQuantity::Deflection => v,
                NodalQuantity::Moment => self.inertias[node].moment(u_v, u_phi),
            };
            if let (Some(Gain { vv, vp, pv, pp }), Some(element)) =
                (self.gains.get(node), mesh.elements().get(node))
            {
                let d_v = *vv * u_v + *vp * u_phi;
                let d_phi = *pv * u_v + *pp * u_phi;
                (v, phi) = (v + phi * element.length_m + d_v, phi + d_phi);
            }
        }
        v
    }
}

impl<S: Scalar> HubResponse<S> {
    /// What the values of a walk are multiplied by, so that they are per unit of tip motion:
    /// deflections in s², moments in kg m.
    #[inline(always)]
    pub(super) fn per_tip_of(&self, quantity: NodalQuantity, tip: &TipTransfer<S>) -> S {
        match quantity {
            NodalQuantity::Deflection => self.per_lambda_s2 * tip.angle_rad_m,
            NodalQuantity::Moment => tip.angle_rad_m,
        }
    }
}

/// Transfers from the tip to every node: the recursion, then the walk from hub to tip, all divided
/// by `L + e_tip`.
pub fn nodal_transfer(mesh: &Mesh, lambda: Complex64) -> NodalTransfer {
    let walked = if is_real(lambda) { walked(mesh, lambda.re) } else { walked(mesh, lambda) };
    walked.unwrap_or_else(|| pivoted_transfer(mesh, lambda))
}

/// The same by the recursion alone; none where it has not kept its digits.
fn walked<S: Scalar<Size = f64> + Into<Complex64>>(
    mesh: &Mesh,
    lambda: S,
) -> Option<NodalTransfer> {
    let mut walk = Walk::new(mesh, lambda, NodalQuantity::Moment);
    let per_lambda_s2 = mesh.per_lambda(lambda);
    let (root, largest_gain) = walk.inward(mesh, lambda);
    if !is_trusted(largest_gain) {
        return None;
    }
    let tip_deflection_m = walk.outward(mesh, lambda, NodalQuantity::Deflection);
    let reached = Reached { root, tip_deflection_m, largest_gain };
    let hub = HubResponse::at_axis(mesh, per_lambda_s2, reached);
    let tip = hub.per_tip(mesh);
    let times = |factor: S, values: &[S]| values.iter().map(|x| (*x * factor).into()).collect();
    let lags_s2 = times(hub.per_tip_of(NodalQuantity::Deflection, &tip), &walk.values);
    walk.outward(mesh, lambda, NodalQuantity::Moment);
    let moments_kg_m = times(hub.per_tip_of(NodalQuantity::Moment, &tip), &walk.values);
    Some(NodalTransfer { tip: tip.map(Into::into), lags_s2, moments_kg_m })
}
