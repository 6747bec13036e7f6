#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;

use super::condensation::{Inertia, condense, condense_stretches};
use super::mesh::Mesh;
use super::pivoted::pivoted_transfer;
use crate::numeric::{Scalar, Size};

/// Largest gain |G| that the recursion is trusted with: it loses about ε·|G| of its digits.
///
/// Above it a frequency lies on a resonance of what is outboard of some node. With damping that
/// does not occur; without it, at a few frequencies in a thousand.
const LARGEST_GAIN: f64 = 1e4;

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
    /// What no gain exceeds on the way, φ counted as φL: |G|, and the motion of nodes within
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

/// Transfers from the tip at one λ, per unit of tip motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipTransfer<S = Complex64> {
    /// `T/a_tip = (A_0[φφ] + I_H)/(L + e_tip)` in kg m (Bayo 1987, eq 20).
    pub inertia_kg_m: S,
    /// Moment at the root, node 0, per tip acceleration in kg m: what the hub exerts on the link.
    pub root_inertia_kg_m: S,
    /// `θ/v_tip = 1/(L + e_tip)` in rad/m (eq 21).
    pub angle_rad_m: S,
    /// `e_tip/(λ (L + e_tip))` in s²: deflection of the tip.
    pub lag_s2: S,
}

impl<S> TipTransfer<S> {
    /// The same with each number changed.
    #[inline(always)]
    pub(super) fn map<T>(self, change: impl Fn(S) -> T) -> TipTransfer<T> {
        TipTransfer {
            inertia_kg_m: change(self.inertia_kg_m),
            root_inertia_kg_m: change(self.root_inertia_kg_m),
            angle_rad_m: change(self.angle_rad_m),
            lag_s2: change(self.lag_s2),
        }
    }
}

/// Response to a unit hub angle by the recursion alone, for the roots that modes and zeros are.
#[inline(always)]
pub fn hub_response<S: Scalar>(mesh: &Mesh, lambda: S) -> HubResponse<S> {
    let (nodes_m, length_m) = (mesh.nodes_m(), mesh.length_m());
    let (zero, one) = (lambda.lift(0.0), lambda.lift(1.0).size());
    let per_lambda_s2 = mesh.per_lambda(lambda);
    // Tip displacement per motion (v, φ) of the node, less its rigid part (1, L − x).
    let (mut e_v, mut e_phi) = (zero, zero);
    let mut largest_gain = zero.size();
    let (root, within_stretches) = condense_stretches(
        mesh,
        lambda,
        #[inline(always)]
        |outer_node, stretch_m, step| {
            let rigid = [e_v, e_v * stretch_m + e_phi];
            let bent = step.eliminated.along([e_v + 1.0, e_phi + (length_m - nodes_m[outer_node])]);
            [e_v, e_phi] = [rigid[0] + bent[0], rigid[1] + bent[1]];
            largest_gain = largest_gain.larger(step.eliminated.size(one, length_m));
        },
    );
    let largest_gain = largest_gain.larger(within_stretches);
    let tip_deflection_m = e_v * nodes_m[0] + e_phi;
    HubResponse::at_axis(mesh, per_lambda_s2, Reached { root, tip_deflection_m, largest_gain })
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

/// Transfers from the tip to torque and hub angle.
///
/// Time in the number of elements; nothing is singular at λ = 0, where the link is rigid.
pub fn tip_transfer(mesh: &Mesh, lambda: Complex64) -> TipTransfer {
    let (tip, largest_gain) = untested_tip_transfer(mesh, lambda);
    if is_trusted(largest_gain) { tip } else { pivoted_transfer(mesh, lambda).tip }
}

/// The same by the recursion alone, with what no gain exceeds.
pub(super) fn untested_tip_transfer(mesh: &Mesh, lambda: Complex64) -> (TipTransfer, f64) {
    if is_real(lambda) {
        let hub = hub_response(mesh, lambda.re);
        (hub.per_tip(mesh).map(Complex64::from), hub.largest_gain)
    } else {
        let hub = hub_response(mesh, lambda);
        (hub.per_tip(mesh), hub.largest_gain)
    }
}

/// Whether λ is a real number, as it is without damping and at rest; the recursion then runs over
/// real numbers, which takes a third of the time.
pub(super) fn is_real(lambda: Complex64) -> bool {
    lambda.im == 0.0
}

/// Whether the recursion has kept its digits.
pub(super) fn is_trusted(largest_gain: f64) -> bool {
    largest_gain <= LARGEST_GAIN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::nodal_transfer;
    use crate::beam::undamped::{Units, even_mesh, mesh, mesh_in};
    use crate::numeric::Wide;

    #[test]
    fn undamped_transfers_keep_their_digits_at_resonances_of_the_outboard_part() {
        let (large, small) = (2.0_f64.powi(20), 2.0_f64.powi(-20));
        let si = Units { length: 1.0, mass: 1.0 };
        let lengths = [large, small].map(|length| Units { length, ..si });
        let masses = [large, small].map(|mass| Units { mass, ..si });
        let mut flagged = 0;
        for (elements, units) in [(10, si), (100, si)]
            .into_iter()
            .chain([lengths, masses].as_flattened().iter().map(|units| (10, *units)))
        {
            let name = format!("{elements} elements, {units:?}");
            flagged += flagged_of_600_that_keep_their_digits(&mesh_in(elements, units), &name);
        }
        assert!(flagged > 3, "no resonance of the outboard part was met: {flagged}");
    }

    #[test]
    fn undamped_transfers_keep_their_digits_at_resonances_of_stretches() {
        let mut flagged = 0;
        for elements in [8, 10, 15, 100, 1000] {
            let name = format!("{elements} equal elements");
            flagged += flagged_of_600_that_keep_their_digits(&even_mesh(elements), &name);
        }
        assert!(flagged > 3, "no resonance of a stretch was met: {flagged}");
    }

    fn flagged_of_600_that_keep_their_digits(mesh: &Mesh, name: &str) -> usize {
        let at_rest = tip_transfer(mesh, Complex64::ZERO).inertia_kg_m.re;
        let mut flagged = 0;
        for k in 1..600 {
            let lambda = (0.670_123 * f64::from(k)).powi(2);
            let wide = Wide::from(lambda);
            let root = condense(mesh, wide, |_, _| {});
            let exact = (root.about(mesh.nodes_m()[0]) + mesh.hub_inertia_kg_m2())
                / tip_displacement_m(mesh, wide);
            let plain = hub_response(mesh, lambda).largest_gain;
            flagged += usize::from(!is_trusted(plain));
            let found = tip_transfer(mesh, lambda.into()).inertia_kg_m.re;
            let error = (found - exact.nearest()).abs() / (exact.size() + 0.3 * at_rest);
            let bound = if is_trusted(plain) { 1e-11 } else { 1e-12 };
            assert!(error < bound, "{name}, λ = {lambda}: {error:e}");
        }
        flagged
    }

    #[test]
    fn the_pivoted_recursion_agrees_with_the_plain_one_at_every_node() {
        let mesh = mesh(30);
        for omega in [0.5, 7.0, 40.0, 333.0] {
            let lambda = Complex64::from(omega * omega) / Complex64::new(1.0, 0.04);
            let (plain, pivoted) = (nodal_transfer(&mesh, lambda), pivoted_transfer(&mesh, lambda));
            let close = |a: &[Complex64], b: &[Complex64]| {
                let peak = a.iter().fold(0.0_f64, |m, x| m.max(x.norm()));
                a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-11 * peak)
            };
            assert!(close(&plain.lags_s2, &pivoted.lags_s2), "deflections at {omega} rad/s");
            assert!(close(&plain.moments_kg_m, &pivoted.moments_kg_m), "moments at {omega} rad/s");
            let numbers = |tip: TipTransfer| {
                [tip.inertia_kg_m, tip.root_inertia_kg_m, tip.angle_rad_m, tip.lag_s2]
            };
            for (a, b) in numbers(plain.tip).into_iter().zip(numbers(pivoted.tip)) {
                assert!((a / b - 1.0).norm() < 1e-11, "at {omega} rad/s: {a} is not {b}");
            }
        }
    }

    #[test]
    fn the_rigid_limit_is_exact_at_zero_frequency() {
        let mesh = mesh(17);
        let transfer = nodal_transfer(&mesh, Complex64::ZERO);
        let rigid = transfer.tip.inertia_kg_m * mesh.length_m();
        let expected = {
            let beam = |x: f64| (0.9 - 0.2 * (x - 0.05) / 1.5) * x * x;
            let n = 30_000;
            let h = 1.5 / f64::from(n);
            let integral: f64 = (0..n).map(|k| beam(0.05 + (f64::from(k) + 0.5) * h) * h).sum();
            0.1 + integral + 0.1 * 0.64 + 1e-3 + 0.05 * 1.55 * 1.55
        };
        assert!((rigid.re / expected - 1.0).abs() < 1e-8);
        assert!((transfer.tip.angle_rad_m.re - 1.0 / 1.55).abs() < 1e-15);
        let hub_moment = transfer.moments_kg_m[0].re + 0.1 / 1.55;
        assert!(hub_moment < transfer.tip.inertia_kg_m.re, "the root lies outboard of the axis");
    }
}
