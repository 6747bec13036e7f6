//! Equal elements in a row, condensed by doubling: 2ᵏ of them for the price of about k.
//!
//! A stretch of equal elements is its own mirror image. So where two of them are joined, the node
//! between moves either even (its slope is zero) or odd (its deflection is zero) as the ends do, and
//! takes one scalar pivot for each. What is left is the apparent inertia between the ends: the
//! answers of the recursion over single elements, but for what the nodes in between do. For
//! that, see `walk.rs`.
//!
//! Coordinates, in m, of a stretch of length ℓ from end 1 to end 2, slopes counted as φℓ:
//!
//! ```text
//! even:  w = v_1 + v_2    translation     φ = ℓ(φ_1 − φ_2)/2        bent to a bow
//! odd:   ψ = v_2 − v_1    rotation        γ = ℓ(φ_1 + φ_2)/2 − ψ    bent to an S
//! ```
//!
//! Stiffness acts on φ and γ alone, with 4κ and 12κ of κ = EI/(ℓ³λ) at any ℓ: Hermite cubics are exact
//! where no inertia acts. So it is not summed up, and no digit of the inertia is lost to it at
//! low frequency. For the same reason the node between is counted from where it would be without
//! inertia: even by its deflection q, odd by its slope times ℓ/2, r. With φ′ = φ/4, ψ′ = ψ/2 and
//! γ′ = γ/8 of the whole, its halves move by
//!
//! ```text
//! even:  w = w + φ′ + q    φ = φ′          ψ = φ′ + q    γ = −q
//! odd:   w = −ψ′           φ = 3γ′ − r     ψ = ψ′        γ = γ′ + r
//! ```
//!
//! and no stiffness couples q or r to the ends: it stands in their pivots alone, as 12κ and 16κ of a
//! half.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Mul, Sub};

use super::condensation::{Inertia, Outboard, Step};
use super::element::RelativeElement;
use crate::numeric::{Scalar, Size};

/// Apparent inertia between the ends of a row of equal elements, in kg, over numbers M: those of λ,
/// or real ones of a single element.
#[derive(Clone, Copy)]
pub(super) struct Stretch<S, M = S> {
    /// Length ℓ in m.
    pub(super) length_m: f64,
    /// Stiffness over λ in the pivot of q: 12κ in kg.
    shift: S,
    /// The same in that of r: 16κ in kg.
    turn: S,
    /// Inertia on (w, φ).
    even: Inertia<M>,
    /// Inertia on (ψ, γ).
    odd: Inertia<M>,
}

impl<S: Scalar> Stretch<S, f64> {
    /// One element that is alike from end to end.
    #[inline(always)]
    pub(super) fn of(element: &RelativeElement, per_lambda: S) -> Self {
        let (stiffness, mass) = (element.k_d.m11, element.m_uu.m11);
        Self {
            length_m: element.length_m,
            shift: per_lambda * stiffness,
            turn: per_lambda * (stiffness * (4.0 / 3.0)),
            even: Inertia { vv: mass / 4.0, vp: mass / 12.0, pp: mass / 30.0 },
            odd: Inertia { vv: mass / 12.0, vp: mass / -60.0, pp: mass / 210.0 },
        }
    }
}

impl<S, M> Stretch<S, M>
where
    S: Scalar + Add<M, Output = S> + Mul<M, Output = S>,
    M: Copy + Add<Output = M> + Sub<Output = M> + Mul<f64, Output = M>,
{
    /// The stretch and its equal, joined, and what the motion of the node between them per motion of
    /// the ends does not exceed.
    #[inline(always)]
    pub(super) fn doubled(&self) -> (Stretch<S>, S::Size) {
        let Self { length_m, shift, turn, even: a, odd: b } = *self;
        let [rigid, bent, sheared] = [a.vv + b.vv, a.vv + a.vp, b.vv - b.vp];
        let bow = Node {
            pivot: shift + ((b.vp - b.pp) - (a.vv + sheared)),
            rigid: a.vv,
            bent: bent + sheared,
        };
        let bend = Node {
            pivot: turn + (a.pp + b.pp) * -1.0,
            rigid: a.vp + b.vp,
            bent: b.pp - a.pp * 3.0,
        };
        let ((bow, bow_gain), (bend, bend_gain)) = (bow.condensed(), bend.condensed());
        let even = Inertia {
            vv: (bow.vv + a.vv) * 2.0,
            vp: (bow.vp + bent) * 0.5,
            pp: (bow.pp + (rigid + a.vp * 2.0 + a.pp)) * 0.125,
        };
        let odd = Inertia {
            vv: (bend.vv + rigid) * 0.5,
            vp: (bend.vp + (b.vp - a.vp * 3.0)) * 0.125,
            pp: (bend.pp + (a.pp * 9.0 + b.pp)) * 0.031_25,
        };
        let (length_m, shift, turn) = (2.0 * length_m, shift * 0.125, turn * 0.125);
        (Stretch { length_m, shift, turn, even, odd }, bow_gain.larger(bend_gain))
    }
}

/// The node between two equal stretches as it moves even, or odd: its pivot, stiffness less inertia,
/// and the inertia that couples it to the rigid and the bent motion of the ends, in kg.
#[derive(Clone, Copy)]
struct Node<S, M> {
    pivot: S,
    rigid: M,
    bent: M,
}

impl<S, M> Node<S, M>
where
    S: Scalar + Mul<M, Output = S>,
    M: Copy,
{
    /// What condensing the node adds to the inertia of the ends, and how far it moves.
    #[inline(always)]
    fn condensed(&self) -> (Inertia<S>, S::Size) {
        let per_pivot = self.pivot.reciprocal();
        let (rigid, bent) = (per_pivot * self.rigid, per_pivot * self.bent);
        let added = Inertia { vv: rigid * self.rigid, vp: bent * self.rigid, pp: bent * self.bent };
        (added, rigid.size() + bent.size())
    }
}

impl<S: Scalar> Stretch<S> {
    /// The recursion's step over the stretch, `a` being the apparent inertia at its outer end.
    ///
    /// In relative coordinates,
    ///
    /// ```text
    /// w = 2v + φl + d_v    φ = −l d_φ/2    ψ = φl + d_v    γ = l d_φ/2 − d_v
    /// ```
    #[inline(always)]
    pub(super) fn condense(&self, a: Inertia<S>) -> Step<S> {
        let Self { length_m: l, shift, turn, even, odd } = *self;
        // Rᵀ A, of which the first row is A's own.
        let (ra_pv, ra_pp) = (a.vv * l + a.vp, a.vp * l + a.pp);
        let (twice, rigid) = (even.vv + even.vv, even.vv + odd.vv);
        let (sheared, cross) = (rigid - odd.vp, odd.vp - even.vp);
        Outboard {
            pivot_block: Inertia {
                vv: (shift + (odd.vp - odd.pp) - sheared) - a.vv,
                vp: (odd.pp - cross - shift) * (0.5 * l) - a.vp,
                pp: (turn - (even.pp + odd.pp)) * (0.25 * l * l) - a.pp,
            },
            b: [
                [a.vv + twice, a.vp - even.vp * l],
                [ra_pv + sheared * l, ra_pp + cross * (0.5 * l * l)],
            ],
            carried: Inertia {
                vv: a.vv + (twice + twice),
                vp: ra_pv + twice * l,
                pp: ra_pv * l + ra_pp + rigid * (l * l),
            },
        }
        .condensed(l)
    }
}

#[cfg(test)]
mod tests {
    use crate::beam::condensation::condense;
    use crate::beam::{Mesh, MeshPlan, hub_response, tip_displacement_m};
    use crate::link::{
        Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform,
    };
    use crate::numeric::{Scalar, Wide};

    /// Two rows, a mass between them, and a payload, of numbers that no division rounds.
    fn mesh(counts: [usize; 2]) -> Mesh {
        let segment = |count: usize, bending_stiffness: f64| Segment {
            name: None,
            length_m: 0.125 * count as f64,
            bending_stiffness_n_m2: Taper::constant(bending_stiffness),
            mass_per_length_kg_m: Taper::constant(3360.0),
        };
        let at_m = 0.125 * (counts[0] + 1) as f64;
        let masses = vec![LumpedMass { at_m, mass_kg: 100.0, inertia_kg_m2: 2.0 }];
        let payload = Payload { mass_kg: 50.0, inertia_kg_m2: 1.0, offset_m: 0.125 };
        let link = Link::new(LinkParts {
            segments: vec![segment(counts[0], 6000.0), segment(counts[1], 3000.0)],
            hub: Hub { radius_m: 0.125, inertia_kg_m2: 30.0, viscous_friction_n_m_s_rad: 0.0 },
            masses,
            payload,
            damping: Damping::None,
            ..uniform()
        });
        let (link, own) = (link.unwrap(), counts.map(Some));
        Mesh::new(&link, &MeshPlan::new(&link, &own, None, 1e-6).unwrap())
    }

    #[test]
    fn stretches_answer_as_their_elements_one_by_one() {
        for counts in [[4, 1], [5, 2], [6, 3], [7, 6], [11, 7], [17, 29], [40, 64]] {
            let mesh = mesh(counts);
            for k in 0..400 {
                // Past the first modes of a single element, and as many zeros.
                let lambda = Wide::from(1.07_f64.powi(k) * if k % 2 == 0 { 1e-3 } else { -1e-3 });
                let hub = hub_response(&mesh, lambda);
                let root = condense(&mesh, lambda, |_, _| {});
                let inertia = root.about(mesh.nodes_m()[0]) + mesh.hub_inertia_kg_m2();
                let tip_m = tip_displacement_m(&mesh, lambda);
                let off = |found: Wide, expected: Wide, size: f64| {
                    (found - expected).size() / (expected.size() + size)
                };
                let inertia = off(hub.inertia_kg_m2, inertia, 30.0);
                let tip = off(hub.tip_displacement_m(&mesh), tip_m, mesh.length_m());
                let bound = 1e-29 * (1.0 + hub.largest_gain);
                let at = lambda.nearest();
                assert!(inertia < bound, "{counts:?}, λ = {at:e}: inertia off by {inertia:e}");
                assert!(tip < bound, "{counts:?}, λ = {at:e}: tip off by {tip:e}");
            }
        }
    }
}
