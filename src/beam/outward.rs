//! The recursion from hub to tip, for deflections and moments at the nodes.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use super::inertia::{Gain, Inertia};
use super::inward::{HubResponse, condense};
use super::mesh::Mesh;
use crate::numeric::{Scalar, Size, ThinnedGrid};

/// A quantity at the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodalQuantity {
    /// Deflection from the hub's tangent line.
    Deflection,
    /// Moment of the inner on the outer part.
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

/// One quantity at all nodes per unit of hub angle, and the memory of the two passes that compute it.
pub(super) struct NodalRecursion<S: Scalar> {
    gains: Vec<Gain<S>>,
    /// Apparent inertia at nodes 0 … n; empty unless moments are wanted.
    inertias: Vec<Inertia<S>>,
    /// The quantity at nodes 0 … n per hub angle: deflections in m, or moments in kg m².
    pub(super) values: Vec<S>,
}

impl<S: Scalar> NodalRecursion<S> {
    /// Memory for a mesh; `like` is of the kind of number that λ will be.
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

    /// Both passes: fills `values` with the quantity, and returns the response at the hub.
    #[inline(always)]
    pub(super) fn run(
        &mut self,
        mesh: &Mesh,
        lambda: S,
        quantity: NodalQuantity,
    ) -> HubResponse<S> {
        let reached = self.inward(mesh, lambda);
        let tip_deflection_m = self.outward(mesh, lambda, quantity);
        HubResponse::at_axis(mesh, lambda, reached, tip_deflection_m)
    }

    /// From tip to hub; returns the apparent inertia at the root and an upper bound of |G|.
    #[inline(always)]
    fn inward(&mut self, mesh: &Mesh, lambda: S) -> (Inertia<S>, S::Size) {
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
