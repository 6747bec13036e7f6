//! The recursion from hub to tip, for deflections and moments at the nodes.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::Range;

use super::inertia::{Gain, Inertia};
use super::inward::condense_part;
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

/// A node at which a pass begins, ends or is taken up again.
#[derive(Clone, Copy)]
pub(super) struct Checkpoint<S: Scalar> {
    pub(super) node: usize,
    /// Apparent inertia of all that is outboard, which the pass from tip to hub carries.
    pub(super) inertia: Inertia<S>,
    /// Deflection and slope (e, e') per hub angle, which the pass from hub to tip carries.
    pub(super) deflection: [S; 2],
}

impl<S: Scalar> Checkpoint<S> {
    /// Those of the whole mesh at some nodes, the root first and the tip last: at the tip the inertia is
    /// known, at the root the deflection. `like` is of the kind of number that λ will be.
    pub(super) fn of_mesh(mesh: &Mesh, like: S, nodes: &[usize]) -> Vec<Self> {
        let (inertia, deflection) = (mesh.tip_inertia().lift(like), [like.lift(0.0); 2]);
        nodes.iter().map(|node| Self { node: *node, inertia, deflection }).collect()
    }
}

/// One quantity at the nodes between two checkpoints per unit of hub angle, and the memory of the two
/// passes that compute it.
pub(super) struct NodalRecursion<S: Scalar> {
    first: usize,
    gains: Vec<Gain<S>>,
    /// Apparent inertia at the nodes; empty unless moments are wanted.
    inertias: Vec<Inertia<S>>,
    /// The quantity at the nodes per hub angle: deflections in m, or moments in kg m².
    values: Vec<S>,
}

impl<S: Scalar> NodalRecursion<S> {
    /// Memory for the nodes at the ends of `elements`; `like` is of the kind of number that λ will be.
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

    /// The quantity at the nodes, from the innermost on.
    pub(super) fn values(&self) -> &[S] {
        &self.values
    }

    /// The quantity at a node.
    #[inline(always)]
    pub(super) fn value(&self, node: usize) -> S {
        self.values[node - self.first]
    }

    /// Both passes, from the inertia at the last checkpoint and the deflection at the first: computes the
    /// values, and the rest of all checkpoints. Returns an upper bound of |G|.
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

    /// From tip to hub; returns an upper bound of |G|.
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

    /// From hub to tip.
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

    /// Sets the quantity at a node, whose displacement and slope it returns.
    #[inline(always)]
    fn set(
        &mut self,
        node: usize,
        mesh: &Mesh,
        quantity: NodalQuantity,
        [v, phi]: [S; 2],
    ) -> (S, S) {
        let (u_v, u_phi) = (v + mesh.nodes_m()[node], phi + 1.0);
        self.values[node - self.first] = match quantity {
            NodalQuantity::Deflection => v,
            NodalQuantity::Moment => self.inertias[node - self.first].moment(u_v, u_phi),
        };
        (u_v, u_phi)
    }
}
