//! Apparent inertia, and the 2×2 system that passes it from an element's outer to its inner end.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use nalgebra::Matrix2;

use crate::numeric::{Scalar, Size};

/// Symmetric 2×2 apparent inertia A on (v, φ) of the part outboard of a node: kg, kg m, kg m².
///
/// It is minus the dynamic stiffness over the squared frequency.
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
    /// Moment in N m for a motion with accelerations (v, φ).
    #[inline(always)]
    pub fn moment(&self, v: S, phi: S) -> S {
        self.vp * v + self.pp * phi
    }

    /// Effort per acceleration of a joint that moves its node by (v, φ) per unit of its position.
    #[inline(always)]
    pub fn along(&self, [v, phi]: [f64; 2]) -> S {
        self.pp * (phi * phi) + (self.vp * (phi + phi) + self.vv * v) * v
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Inertia<f64>) -> Self {
        Self { vv: self.vv + other.vv, vp: self.vp + other.vp, pp: self.pp + other.pp }
    }
}

impl Inertia<f64> {
    /// A rigid body whose centre of mass lies `offset` outboard: kg, kg m², m.
    pub fn rigid(mass: f64, inertia: f64, offset: f64) -> Self {
        Self { vv: mass, vp: mass * offset, pp: inertia + mass * offset * offset }
    }

    /// Matrix on (v, φ).
    pub fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.vv, self.vp, self.vp, self.pp)
    }

    /// Converts to numbers of the kind of `like`.
    #[inline(always)]
    pub(super) fn lift<S: Scalar>(self, like: S) -> Inertia<S> {
        Inertia { vv: like.lift(self.vv), vp: like.lift(self.vp), pp: like.lift(self.pp) }
    }
}

/// Deformation of an element per motion (v, φ) of its inner end: `d = G u_i`.
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

/// Solves `P G = Bᵀ` by LDLᵀ, except for the last step; eliminates the larger of the two diagonal entries first.
///
/// The comparison uses one unit: φ counts as φl. Without this choice the error near a resonance of the outboard part
/// would grow with |G|² instead of |G|.
#[inline(always)]
pub(super) fn eliminate<S: Scalar>(
    p: &Inertia<S>,
    l: f64,
    b: &[[S; 2]; 2],
) -> ([S; 2], Eliminated<S>) {
    let order = Order { v: p.vv.size() * (l * l), phi: p.pp.size() };
    let [first, other] = order.of([p.vv, p.pp]);
    let per_first = first.reciprocal();
    let multiplier = p.vp * per_first;
    let second = other - multiplier * p.vp;
    let per_second = second.reciprocal();
    let [v, phi] = [order.reduced(multiplier, b[0]), order.reduced(multiplier, b[1])];
    let scaled = [[v[0] * per_first, v[1] * per_second], [phi[0] * per_first, phi[1] * per_second]];
    ([first, second], Eliminated { order, multiplier, reduced: [v, phi], scaled })
}

/// `P G = Bᵀ` after `P = L D Lᵀ`, without the last step, which few callers need.
///
/// The rows are those of B, for the motion (v, φ) of the inner end; each contains first the unknown eliminated first,
/// then the other.
#[derive(Clone, Copy)]
pub(super) struct Eliminated<S: Scalar> {
    order: Order<S>,
    /// The entry of L below its diagonal.
    multiplier: S,
    /// `(L⁻¹ Bᵀ)ᵀ`.
    reduced: [[S; 2]; 2],
    /// `(D⁻¹ L⁻¹ Bᵀ)ᵀ`.
    scaled: [[S; 2]; 2],
}

impl<S: Scalar> Eliminated<S> {
    /// `B G = (L⁻¹ Bᵀ)ᵀ D⁻¹ (L⁻¹ Bᵀ)`, symmetric.
    #[inline(always)]
    pub(super) fn inertia(&self) -> Inertia<S> {
        let ([v, phi], [v_scaled, phi_scaled]) = (self.reduced, self.scaled);
        Inertia { vv: dot(v, v_scaled), vp: dot(v, phi_scaled), pp: dot(phi, phi_scaled) }
    }

    /// `tᵀ G = (L⁻¹ t)ᵀ D⁻¹ (L⁻¹ Bᵀ)` for the motion (v, φ) of the inner end.
    #[inline(always)]
    pub(super) fn along(&self, t: [S; 2]) -> [S; 2] {
        let reduced = self.order.reduced(self.multiplier, t);
        [dot(reduced, self.scaled[0]), dot(reduced, self.scaled[1])]
    }

    /// `P⁻¹ s` for a force s on (v, φ), from the two pivots of the elimination.
    #[inline(always)]
    pub(super) fn solved(&self, pivots: [S; 2], s: [S; 2]) -> [S; 2] {
        let [first, second] = self.order.reduced(self.multiplier, s);
        let second = second * pivots[1].reciprocal();
        self.order.of([first * pivots[0].reciprocal() - self.multiplier * second, second])
    }

    /// The gain G, by the last step: subtracts the second unknown's share from the first.
    #[inline(always)]
    pub(super) fn gain(&self) -> Gain<S> {
        let [[v_first, v_second], [phi_first, phi_second]] = self.scaled;
        let [vv, pv] = self.order.of([v_first - self.multiplier * v_second, v_second]);
        let [vp, pp] = self.order.of([phi_first - self.multiplier * phi_second, phi_second]);
        Gain { vv, vp, pv, pp }
    }

    /// Upper bound of |G|, with φ counted as φL for the link's length L in m: the sum of the sizes of all terms in the
    /// last step. `one` is the size of 1.
    #[inline(always)]
    pub(super) fn size(&self, one: S::Size, length_m: f64) -> S::Size {
        let [first, second] = self.order.of_sizes([one, one * length_m]);
        let second = second + self.multiplier.size() * first;
        let [v, phi] = self.scaled;
        let v = v[0].size() * first + v[1].size() * second;
        let phi = phi[0].size() * first + phi[1].size() * second;
        v + phi * (1.0 / length_m)
    }
}

#[inline(always)]
fn dot<S: Scalar>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// Sizes of the diagonal entries; the larger one is eliminated first.
#[derive(Clone, Copy)]
struct Order<S: Scalar> {
    v: S::Size,
    phi: S::Size,
}

impl<S: Scalar> Order<S> {
    /// Permutes (v, φ) to the order of elimination, or back.
    #[inline(always)]
    fn of(&self, [v, phi]: [S; 2]) -> [S; 2] {
        [S::choose(self.v, self.phi, v, phi), S::choose(self.v, self.phi, phi, v)]
    }

    /// Permutes the sizes of (v, φ) to the order of elimination.
    #[inline(always)]
    fn of_sizes(&self, [v, phi]: [S::Size; 2]) -> [S::Size; 2] {
        [Size::choose(self.v, self.phi, v, phi), Size::choose(self.v, self.phi, phi, v)]
    }

    /// `L⁻¹` times a vector on (v, φ).
    #[inline(always)]
    fn reduced(&self, multiplier: S, vector: [S; 2]) -> [S; 2] {
        let [first, second] = self.of(vector);
        [first, second - multiplier * first]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Result of an elimination in a unit of length with `per_metre` units to the metre, for a link of 1.5 m and an
    /// element of 0.3 m: entries of G with φ counted as φL, residual, and size.
    fn solved([vv, vp, pp]: [f64; 3], b: [[f64; 2]; 2], per_metre: f64) -> ([f64; 4], f64, f64) {
        let unit = [1.0, per_metre];
        let p = Inertia { vv, vp: vp * per_metre, pp: pp * per_metre * per_metre };
        let b = [0, 1].map(|i| [0, 1].map(|j| b[i][j] * unit[i] * unit[j]));
        let (_, eliminated) = eliminate(&p, 0.3 * per_metre, &b);
        let gain = eliminated.gain();
        let [(d_v, d_phi), (e_v, e_phi)] = [(gain.vv, gain.pv), (gain.vp, gain.pp)];
        let residuals = [
            p.vv * d_v + p.vp * d_phi - b[0][0],
            (p.vp * d_v + p.pp * d_phi - b[0][1]) / per_metre,
            (p.vv * e_v + p.vp * e_phi - b[1][0]) / per_metre,
            (p.vp * e_v + p.pp * e_phi - b[1][1]) / (per_metre * per_metre),
        ];
        let length = 1.5 * per_metre;
        let entries = [gain.vv, gain.vp / length, gain.pv * length, gain.pp];
        (
            entries,
            residuals.map(f64::abs).into_iter().fold(0.0, f64::max),
            eliminated.size(1.0, length),
        )
    }

    #[test]
    fn no_entry_of_a_gain_exceeds_its_size_and_the_size_has_no_unit() {
        let b = [[1.0, 0.2], [0.3, -0.4]];
        // v first, φ first, both diagonal entries too small to use alone, and nearly singular.
        for p in [[4.0, 0.5, 0.1], [1.0, 0.5, 7.0], [1e-3, 0.4, 1e-5], [1.0, 0.3, 0.090_000_1]] {
            let (_, _, metres) = solved(p, b, 1.0);
            for per_metre in [1.0, 1e3, 1e-3] {
                let (entries, residual, size) = solved(p, b, per_metre);
                let largest = entries.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                assert!(residual < 1e-15 * (1.0 + size), "{residual:e} of {p:?}");
                assert!(largest <= size && size < 3e3 * largest, "{size} of {entries:?}");
                assert!((size / metres - 1.0).abs() < 1e-8, "{size} is not {metres}");
            }
        }
    }

    #[test]
    fn products_of_a_gain_are_the_same_with_its_last_step_and_without() {
        for p in [[4.0, 0.5, 0.1], [1.0, 0.5, 7.0]] {
            let p = Inertia { vv: p[0], vp: p[1], pp: p[2] };
            let b = [[1.0, 0.2], [0.3, -0.4]];
            let (pivots, eliminated) = eliminate(&p, 0.3, &b);
            assert!((pivots[0] * pivots[1] / (p.vv * p.pp - p.vp * p.vp) - 1.0).abs() < 1e-15);
            let Gain { vv, vp, pv, pp } = eliminated.gain();
            let close = |a: f64, b: f64| (a - b).abs() < 1e-15 * (1.0 + b.abs());
            let inertia = eliminated.inertia();
            assert!(close(inertia.vv, b[0][0] * vv + b[0][1] * pv), "{inertia:?}");
            assert!(close(inertia.vp, b[0][0] * vp + b[0][1] * pp), "{inertia:?}");
            assert!(close(inertia.vp, b[1][0] * vv + b[1][1] * pv), "{inertia:?}");
            assert!(close(inertia.pp, b[1][0] * vp + b[1][1] * pp), "{inertia:?}");
            let along = eliminated.along([0.7, -2.0]);
            assert!(close(along[0], 0.7 * vv - 2.0 * pv), "{along:?}");
            assert!(close(along[1], 0.7 * vp - 2.0 * pp), "{along:?}");
            let solved = eliminated.solved(pivots, [0.7, -2.0]);
            assert!(close(p.vv * solved[0] + p.vp * solved[1], 0.7), "{solved:?}");
            assert!(close(p.vp * solved[0] + p.pp * solved[1], -2.0), "{solved:?}");
        }
    }
}
