//! Equal elements in a row, condensed by doubling: 2ᵏ of them for the price of about k.
//!
//! A stretch of equal elements is its own mirror image. So where two of them are joined, the node
//! between moves either even (its slope is zero) or odd (its deflection is zero), as the ends do, and
//! takes one scalar pivot for each. What is left is the apparent inertia between the ends. It answers
//! as the elements one by one do, and tells nothing of the nodes in between: for those, see `walk.rs`.
//! And it keeps its digits only with some damping, see [`Way::Stretches`].
//!
//! Coordinates, in m, of a stretch of length l from end 1 to end 2, by letters of this file alone:
//!
//! ```text
//! even:  s = v_1 + v_2    translation     χ = l(φ_1 − φ_2)/2        bent to a bow
//! odd:   ψ = v_2 − v_1    rotation        γ = l(φ_1 + φ_2)/2 − ψ    bent to an S
//! ```
//!
//! Stiffness acts on χ and γ alone, with 4k and 12k of k = EI/(l³λ) at any l: Hermite cubics are exact
//! where no inertia acts. So it is not summed up, and no digit of the inertia is lost to it at
//! low frequency. For the same reason the node between is counted from where it would be without
//! inertia: even by its deflection δ, odd by its slope times half the length, ρ. With χ′ = χ/4,
//! ψ′ = ψ/2 and γ′ = γ/8 of the whole, its halves move by
//!
//! ```text
//! even:  s = s + χ′ + δ    χ = χ′          ψ = χ′ + δ    γ = −δ
//! odd:   s = −ψ′           χ = 3γ′ − ρ     ψ = ψ′        γ = γ′ + ρ
//! ```
//!
//! (those of the inner half, the outer one mirrors them), and no stiffness couples δ or ρ to the ends:
//! it stands in their pivots alone, as 12k and 16k of a half.
//!
//! [`Way::Stretches`]: super::transfer::Way::Stretches

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::ops::{Add, Mul, Sub};

use super::condensation::{Inertia, Outboard, Step};
use super::element::RelativeElement;
use crate::numeric::{Scalar, Size};

/// Apparent inertia between the ends of a row of equal elements, in kg, over numbers M: those of λ,
/// or real ones of a single element.
#[derive(Clone, Copy)]
pub(super) struct Stretch<S, M = S> {
    /// Length l in m.
    pub(super) length_m: f64,
    /// Stiffness over λ of the node between two of these, against δ: 12k in kg.
    k_even: S,
    /// The same against ρ: 16k in kg.
    k_odd: S,
    /// Inertia on (s, χ).
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
            k_even: per_lambda * stiffness,
            k_odd: per_lambda * (stiffness * (4.0 / 3.0)),
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
    /// The stretch and its equal, joined, and what the motion of the node between them does not exceed
    /// per motion of the ends.
    #[inline(always)]
    pub(super) fn doubled(&self) -> (Stretch<S>, S::Size) {
        let Self { length_m, k_even, k_odd, even: a, odd: b } = *self;
        // Of a half: moved sideways and turned by as much, moved and bowed, turned and bent.
        let [turned, bowed, bent] = [a.vv + b.vv, a.vv + a.vp, b.vv - b.vp];
        let (even_node, even_gain) = Node {
            pivot: k_even + ((b.vp - b.pp) - (a.vv + bent)),
            to_rigid: a.vv,
            to_bent: bowed + bent,
        }
        .condensed();
        let (odd_node, odd_gain) = Node {
            pivot: k_odd + (a.pp + b.pp) * -1.0,
            to_rigid: a.vp + b.vp,
            to_bent: b.pp - a.pp * 3.0,
        }
        .condensed();
        let even = Inertia {
            vv: (even_node.vv + a.vv) * 2.0,
            vp: (even_node.vp + bowed) * 0.5,
            pp: (even_node.pp + (turned + a.vp * 2.0 + a.pp)) * 0.125,
        };
        let odd = Inertia {
            vv: (odd_node.vv + turned) * 0.5,
            vp: (odd_node.vp + (b.vp - a.vp * 3.0)) * 0.125,
            pp: (odd_node.pp + (a.pp * 9.0 + b.pp)) * 0.031_25,
        };
        let (length_m, k_even, k_odd) = (2.0 * length_m, k_even * 0.125, k_odd * 0.125);
        (Stretch { length_m, k_even, k_odd, even, odd }, even_gain.larger(odd_gain))
    }
}

/// The node between two equal stretches as it moves even, or odd: its pivot, stiffness less inertia,
/// and the inertia that couples it to the rigid and the bent motion of the ends, in kg.
#[derive(Clone, Copy)]
struct Node<S, M> {
    pivot: S,
    to_rigid: M,
    to_bent: M,
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
        let Self { to_rigid, to_bent, .. } = *self;
        // The node's motion per rigid and per bent motion of the ends.
        let (rigid, bent) = (per_pivot * to_rigid, per_pivot * to_bent);
        let added = Inertia { vv: rigid * to_rigid, vp: bent * to_rigid, pp: bent * to_bent };
        (added, rigid.size() + bent.size())
    }
}

impl<S: Scalar> Stretch<S> {
    /// The recursion's step over the stretch, `a` being the apparent inertia at its outer end.
    ///
    /// In relative coordinates,
    ///
    /// ```text
    /// s = 2v + φl + d_v    χ = −l d_φ/2    ψ = φl + d_v    γ = l d_φ/2 − d_v
    /// ```
    #[inline(always)]
    pub(super) fn condense(&self, a: Inertia<S>) -> Step<S> {
        let Self { length_m: l, k_even, k_odd, even, odd } = *self;
        // Rᵀ A, of which the first row is A's own.
        let (ra_pv, ra_pp) = (a.vv * l + a.vp, a.vp * l + a.pp);
        let (twice, turned) = (even.vv + even.vv, even.vv + odd.vv);
        let (bent, cross) = (turned - odd.vp, odd.vp - even.vp);
        Outboard {
            pivot_block: Inertia {
                vv: (k_even + (odd.vp - odd.pp) - bent) - a.vv,
                vp: (odd.pp - cross - k_even) * (0.5 * l) - a.vp,
                pp: (k_odd - (even.pp + odd.pp)) * (0.25 * l * l) - a.pp,
            },
            b: [
                [a.vv + twice, a.vp - even.vp * l],
                [ra_pv + bent * l, ra_pp + cross * (0.5 * l * l)],
            ],
            carried: Inertia {
                vv: a.vv + (twice + twice),
                vp: ra_pv + twice * l,
                pp: ra_pv * l + ra_pp + turned * (l * l),
            },
        }
        .condensed(l)
    }
}

#[cfg(test)]
mod tests {
    use crate::beam::condensation::condense;
    use crate::beam::hub_response::hub_response_by_stretches;
    use crate::beam::{Mesh, MeshPlan, tip_displacement_m};
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
            cross_section: None,
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
                let hub = hub_response_by_stretches(&mesh, lambda);
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
