//! Transfers from the tip at one λ: by the plain recursion where it keeps its digits, otherwise with pivoting.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use nalgebra::Vector2;
use num_complex::Complex64;

use super::mesh::Mesh;
use super::pivoted::{PivotedScalar, driven_motion};
use super::recursion::{Checkpoint, HubResponse, NodalQuantity, NodalRecursion, hub_response};
use crate::numeric::Scalar;

/// Largest gain |G| at which the recursion is trusted: it loses about ε·|G| of its digits.
///
/// A frequency with a larger gain lies on a resonance of the part outboard of some node: no frequency with damping, a
/// few in a thousand without.
const LARGEST_GAIN: f64 = 1e4;

/// Transfers from the tip at one λ, per unit of tip motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipTransfer<S = Complex64> {
    /// `T/a_tip = (A_0[φφ] + I_H)/(L + e_tip)` in kg m (Bayo 1987, eq 20).
    pub inertia_kg_m: S,
    /// Moment at the root, node 0, per tip acceleration in kg m: the moment of the hub on the link.
    pub root_inertia_kg_m: S,
    /// `θ/v_tip = 1/(L + e_tip)` in rad/m (eq 21).
    pub angle_rad_m: S,
    /// `e_tip/(λ (L + e_tip))` in s²: tip deflection per tip acceleration.
    pub deflection_s2: S,
}

/// Transfers from the tip to every node at one λ, per unit of tip motion.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalTransfer {
    /// Transfers to torque, hub angle and tip.
    pub tip: TipTransfer,
    /// Deflection of nodes 0 … n per tip acceleration, `e_i/(λ (L + e_tip))`, in s² (eq 21).
    pub deflections_s2: Vec<Complex64>,
    /// Moment of the inner on the outer part of the link at nodes 0 … n, per tip acceleration, in kg m; the inertia
    /// lumped at a node belongs to the outer part.
    pub moments_kg_m: Vec<Complex64>,
}

impl<S: Scalar> TipTransfer<S> {
    /// Divides a response per hub angle by the tip's displacement.
    #[inline(always)]
    pub(super) fn of(hub: &HubResponse<S>, mesh: &Mesh) -> Self {
        let angle_rad_m = hub.tip_displacement_m(mesh).reciprocal();
        Self {
            inertia_kg_m: hub.inertia_kg_m2 * angle_rad_m,
            root_inertia_kg_m: hub.root_inertia_kg_m2 * angle_rad_m,
            angle_rad_m,
            deflection_s2: hub.tip_deflection_m * hub.per_lambda_s2 * angle_rad_m,
        }
    }
}

impl TipTransfer {
    /// True if the tip's motion is only rounding: `|L + e_tip|` is below `(64 + 2n) ε L` on n elements, somewhat above
    /// the values measured at blocked frequencies. The transfers are then meaningless.
    pub fn is_blocked(&self, mesh: &Mesh) -> bool {
        let rounding = (64.0 + 2.0 * mesh.elements().len() as f64) * f64::EPSILON;
        self.angle_rad_m.norm_sqr() * (rounding * mesh.rigid_tip()).powi(2) > 1.0
    }
}

impl NodalTransfer {
    /// One quantity at nodes 0 … n.
    pub fn values(&self, quantity: NodalQuantity) -> &[Complex64] {
        match quantity {
            NodalQuantity::Deflection => &self.deflections_s2,
            NodalQuantity::Moment => &self.moments_kg_m,
        }
    }
}

/// Factor from values per hub angle to values per unit of tip motion: deflections in s², moments in
/// kg m.
#[inline(always)]
pub(super) fn per_tip<S: Scalar>(hub: &HubResponse<S>, mesh: &Mesh, quantity: NodalQuantity) -> S {
    let angle_rad_m = hub.tip_displacement_m(mesh).reciprocal();
    match quantity {
        NodalQuantity::Deflection => hub.per_lambda_s2 * angle_rad_m,
        NodalQuantity::Moment => angle_rad_m,
    }
}

/// Transfers from the tip to torque and hub angle.
///
/// The time is linear in the number of elements. λ = 0, where the link is rigid, is not singular.
pub fn tip_transfer(mesh: &Mesh, lambda: Complex64) -> TipTransfer {
    let by_recursion =
        if is_real(lambda) { recursed(mesh, lambda.re) } else { recursed(mesh, lambda) };
    by_recursion.unwrap_or_else(|| pivoted_transfer(mesh, lambda).tip)
}

/// Transfers from the tip to torque and hub angle by the recursion; `None` where it loses its digits.
fn recursed<S>(mesh: &Mesh, lambda: S) -> Option<TipTransfer>
where
    S: Scalar<Size = f64> + Into<Complex64>,
{
    let hub = hub_response(mesh, lambda);
    is_trusted(hub.largest_gain).then(|| complex(TipTransfer::of(&hub, mesh)))
}

/// Transfers from the tip to every node, per unit of tip motion.
pub fn nodal_transfer(mesh: &Mesh, lambda: Complex64) -> NodalTransfer {
    let by_recursion = if is_real(lambda) {
        recursed_nodes(mesh, lambda.re)
    } else {
        recursed_nodes(mesh, lambda)
    };
    by_recursion.unwrap_or_else(|| pivoted_transfer(mesh, lambda))
}

/// Transfers from the tip to every node by the recursion; `None` where it loses its digits.
fn recursed_nodes<S>(mesh: &Mesh, lambda: S) -> Option<NodalTransfer>
where
    S: Scalar<Size = f64> + Into<Complex64>,
{
    let elements = mesh.elements().len();
    let mut nodes = vec![0, mesh.output(), elements];
    nodes.dedup();
    let mut ends = Checkpoint::of_mesh(mesh, lambda, &nodes);
    let mut nodes = NodalRecursion::new(&(0..elements), lambda, NodalQuantity::Moment);
    let gain = nodes.run(mesh, lambda, NodalQuantity::Deflection, &mut ends);
    if !is_trusted(gain) {
        return None;
    }
    let hub = response_between(mesh, lambda, &ends, gain);
    let times = |factor: S, values: &[S]| values.iter().map(|x| (*x * factor).into()).collect();
    let deflections_s2 = times(per_tip(&hub, mesh, NodalQuantity::Deflection), nodes.values());
    nodes.outward(mesh, NodalQuantity::Moment, &mut ends);
    let moments_kg_m = times(per_tip(&hub, mesh, NodalQuantity::Moment), nodes.values());
    Some(NodalTransfer { tip: complex(TipTransfer::of(&hub, mesh)), deflections_s2, moments_kg_m })
}

/// Response at the hub after both passes between root and tip, with the output among the ends; `gain` is their bound of
/// |G|.
#[inline(always)]
pub(super) fn response_between<S: Scalar>(
    mesh: &Mesh,
    lambda: S,
    ends: &[Checkpoint<S>],
    gain: S::Size,
) -> HubResponse<S> {
    let of_output = |end: &&Checkpoint<S>| end.node == mesh.output();
    let output = ends.iter().find(of_output).unwrap_or(&ends[ends.len() - 1]);
    let [tip_deflection_m, _] = output.deflection;
    HubResponse::at_axis(mesh, lambda, (ends[0].inertia, gain), tip_deflection_m)
}

fn complex<S: Into<Complex64>>(tip: TipTransfer<S>) -> TipTransfer {
    TipTransfer {
        inertia_kg_m: tip.inertia_kg_m.into(),
        root_inertia_kg_m: tip.root_inertia_kg_m.into(),
        angle_rad_m: tip.angle_rad_m.into(),
        deflection_s2: tip.deflection_s2.into(),
    }
}

/// Transfers from the tip to every node at λ ≠ 0, also where a part of the link resonates.
///
/// Infinite or NaN only if no pivot remains, as at a zero of torque → tip on the real axis.
pub(super) fn pivoted_transfer(mesh: &Mesh, lambda: Complex64) -> NodalTransfer {
    if is_real(lambda) { driven_transfer(mesh, lambda.re) } else { driven_transfer(mesh, lambda) }
}

fn driven_transfer<S: PivotedScalar + Into<Complex64>>(mesh: &Mesh, lambda: S) -> NodalTransfer {
    let motion = driven_motion(mesh, lambda);
    let output = mesh.output();
    let tip_displacement =
        motion.theta * S::from_real(mesh.rigid_tip()) + motion.deflections[output][0];
    let deflection = |e: &Vector2<S>| (e[0] / (lambda * tip_displacement)).into();
    let moment = |q: &Vector2<S>| (q[1] / tip_displacement).into();
    NodalTransfer {
        tip: TipTransfer {
            inertia_kg_m: (motion.torque / tip_displacement).into(),
            root_inertia_kg_m: moment(&motion.reactions[0]),
            angle_rad_m: (motion.theta / tip_displacement).into(),
            deflection_s2: deflection(&motion.deflections[output]),
        },
        deflections_s2: motion.deflections.iter().map(deflection).collect(),
        moments_kg_m: motion.reactions.iter().map(moment).collect(),
    }
}

/// True if λ is real, as without damping or at rest; the real recursion takes a third of the time.
pub(super) fn is_real(lambda: Complex64) -> bool {
    lambda.im == 0.0
}

/// True if the recursion has kept its digits.
pub(super) fn is_trusted(largest_gain: f64) -> bool {
    largest_gain <= LARGEST_GAIN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::test_links::{Units, mesh, mesh_in};
    use crate::beam::{condense, tip_displacement_m};
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
    fn damped_transfers_keep_their_digits() {
        for elements in [2, 10, 100] {
            let mesh = mesh(elements);
            let at_rest = tip_transfer(&mesh, Complex64::ZERO).inertia_kg_m.re;
            let resolved = mesh.resolved_frequency_rad_s().powi(2);
            let squares = (0..300).map(|k| 1.096_f64.powi(k));
            for omega_2 in squares.take_while(|omega_2| *omega_2 < resolved) {
                for twice_the_ratio in [1.0 / 64.0, -0.04] {
                    let lambda = Complex64::new(omega_2, twice_the_ratio * omega_2);
                    let gain = hub_response(&mesh, lambda).largest_gain;
                    let exact = exact_inertia(&mesh, Wide::from(lambda)).nearest();
                    let found = tip_transfer(&mesh, lambda);
                    let rigid_per_tip = found.angle_rad_m.norm() * mesh.length_m();
                    let bound = 160.0 * f64::EPSILON * (1.0 + gain.max(rigid_per_tip));
                    let error = (found.inertia_kg_m - exact).norm();
                    let relative = error / (exact.norm() + 0.3 * at_rest);
                    assert!(relative < bound, "{elements}, λ = {lambda}: {relative:e}");
                }
            }
        }
    }

    /// `T/a_tip` with more digits.
    fn exact_inertia<S: Scalar>(mesh: &Mesh, lambda: S) -> S {
        let root = condense(mesh, lambda, |_, _| {});
        let hub = root.along(mesh.rigid(0)) + mesh.joint().inertia();
        hub * tip_displacement_m(mesh, lambda).reciprocal()
    }

    fn flagged_of_600_that_keep_their_digits(mesh: &Mesh, name: &str) -> usize {
        let at_rest = tip_transfer(mesh, Complex64::ZERO).inertia_kg_m.re;
        let mut flagged = 0;
        for k in 1..600 {
            let lambda = (0.670_123 * f64::from(k)).powi(2);
            let exact = exact_inertia(mesh, Wide::from(lambda));
            let plain = hub_response(mesh, lambda).largest_gain;
            flagged += usize::from(!is_trusted(plain));
            let found = tip_transfer(mesh, lambda.into()).inertia_kg_m.re;
            let error = (found - exact.nearest().re).abs() / (exact.size() + 0.3 * at_rest);
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
            assert!(
                close(&plain.deflections_s2, &pivoted.deflections_s2),
                "deflections at {omega} rad/s"
            );
            assert!(close(&plain.moments_kg_m, &pivoted.moments_kg_m), "moments at {omega} rad/s");
            let numbers = |tip: TipTransfer| {
                [tip.inertia_kg_m, tip.root_inertia_kg_m, tip.angle_rad_m, tip.deflection_s2]
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

    #[test]
    fn a_tip_is_blocked_within_rounding_of_its_length_in_any_units() {
        for exponent in [-20, 0, 20] {
            let mesh = mesh_in(10, Units { length: 2.0_f64.powi(exponent), mass: 1.0 });
            let at_rest = tip_transfer(&mesh, Complex64::ZERO);
            let moved = |epsilons: f64| {
                let moved_m = Complex64::from(epsilons * f64::EPSILON * mesh.length_m());
                TipTransfer { angle_rad_m: moved_m.inv(), ..at_rest }
            };
            let is_blocked = [1e9, 85.0, 83.0, 0.1].map(|all| moved(all).is_blocked(&mesh));
            assert_eq!(is_blocked, [false, false, true, true], "length 2^{exponent}");
        }
    }
}
