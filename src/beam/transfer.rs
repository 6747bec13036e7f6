//! Transfers at one λ, and how far the recursion is trusted with them.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use num_complex::Complex64;

use super::hub_response::{hub_response, hub_response_by_stretches};
use super::mesh::Mesh;
use super::pivoted::pivoted_transfer;
use super::tip_transfers::TipTransfer;
use crate::numeric::{Scalar, Size};

/// Largest gain |G| that the recursion is trusted with: it loses about ε·|G| of its digits.
///
/// Element by element, a frequency above it lies on a resonance of what is outboard of some node:
/// with damping none does, without it a few in a thousand. By stretches more counts as a gain, see
/// [`Way::untested`].
const LARGEST_GAIN: f64 = 1e4;

/// Least `|Im λ/Re λ|`, twice the damping ratio, at which the recursion goes by stretches.
const DAMPED: f64 = 1.0 / 64.0;

/// Transfers from the tip to torque and hub angle.
///
/// Time in the number of elements; of equal elements in a row, in the logarithm of their number from
/// a damping ratio of 1/128 on, where the answer keeps its digits. Nothing is singular at λ = 0, where
/// the link is rigid.
pub fn tip_transfer(mesh: &Mesh, lambda: Complex64) -> TipTransfer {
    let (mut tip, mut largest_gain) = Way::of(lambda).untested_alone(mesh, lambda);
    if !is_trusted(largest_gain) && Way::of(lambda) == Way::Stretches {
        (tip, largest_gain) = Way::Elements.untested_alone(mesh, lambda);
    }
    if is_trusted(largest_gain) { tip } else { pivoted_transfer(mesh, lambda).tip }
}

/// How the recursion goes from tip to hub.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// Element by element, over real numbers, which takes a third of the time.
    RealElements,
    /// Element by element.
    Elements,
    /// By stretches of equal elements.
    ///
    /// A stretch resonates between its own ends, and doubling it takes that resonance off again.
    /// Up to 4000 times ε·|G| is lost where no damping bounds it, some 100 times with [`DAMPED`].
    Stretches,
}

impl Way {
    /// The one that λ is asked for by first.
    pub(super) fn of(lambda: Complex64) -> Self {
        if is_real(lambda) {
            Self::RealElements
        } else if lambda.im.abs() < DAMPED * lambda.re.abs() {
            Self::Elements
        } else {
            Self::Stretches
        }
    }

    /// Transfers by the recursion alone, and what no gain exceeds.
    ///
    /// By stretches, a hundredth of `L/|L + e_tip|` counts as a gain, too: where next to none of the
    /// hub's motion reaches the tip, that sum is rounding sooner than element by element.
    #[inline(always)]
    pub(super) fn untested<S: Scalar>(self, mesh: &Mesh, lambda: S) -> (TipTransfer<S>, S::Size) {
        if self == Self::Stretches {
            let hub = hub_response_by_stretches(mesh, lambda);
            let tip = hub.per_tip(mesh);
            let rigid_per_tip = tip.angle_rad_m.size() * mesh.length_m();
            (tip, hub.largest_gain.larger(rigid_per_tip * 0.01))
        } else {
            let hub = hub_response(mesh, lambda);
            (hub.per_tip(mesh), hub.largest_gain)
        }
    }

    /// The same at one λ.
    pub(super) fn untested_alone(self, mesh: &Mesh, lambda: Complex64) -> (TipTransfer, f64) {
        if self == Self::RealElements {
            let (tip, largest_gain) = self.untested(mesh, lambda.re);
            (tip.map(Complex64::from), largest_gain)
        } else {
            self.untested(mesh, lambda)
        }
    }
}

/// Whether λ is a real number, as it is without damping and at rest.
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
    use crate::beam::condensation::condense;
    use crate::beam::nodal_transfer;
    use crate::beam::tip_displacement_m;
    use crate::beam::undamped::{Units, even_mesh, mesh, mesh_in};
    use crate::link::{Hub, Link, LinkParts, Payload, uniform};
    use crate::numeric::{Wide, WideComplex};

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
    fn stretches_that_are_trusted_with_damped_motions_keep_their_digits() {
        for elements in [2, 3, 4, 7, 8, 16, 37, 64, 128, 1000] {
            let links = [without_hub(), with_heavy_payload()];
            let [without_hub, heavy] = links.map(|link| Mesh::on(&link, elements));
            for mesh in [without_hub, heavy, even_mesh(elements)] {
                let at_rest = tip_transfer(&mesh, Complex64::ZERO).inertia_kg_m.re;
                let mut trusted = 0;
                for omega_2 in resonances_of_stretches(&mesh) {
                    for damping in [DAMPED, -0.04] {
                        let lambda = Complex64::new(omega_2, damping * omega_2);
                        assert_eq!(Way::of(lambda), Way::Stretches);
                        let (found, gain) = Way::Stretches.untested_alone(&mesh, lambda);
                        if is_trusted(gain) {
                            trusted += 1;
                            let exact = exact_inertia(&mesh, WideComplex::from(lambda)).nearest();
                            let error = (found.inertia_kg_m - exact).norm();
                            let rigid_per_tip = found.angle_rad_m.norm() * mesh.length_m();
                            let bound = 160.0 * f64::EPSILON * (1.0 + gain.max(rigid_per_tip));
                            let relative = error / (exact.norm() + 0.3 * at_rest);
                            assert!(relative < bound, "{elements}, λ = {lambda}: {relative:e}");
                        }
                    }
                }
                assert!(trusted > 300, "{elements} elements: trusted with {trusted}");
            }
        }
    }

    fn without_hub() -> Link {
        let hub = Hub { inertia_kg_m2: 0.0, radius_m: 0.0, viscous_friction_n_m_s_rad: 0.0 };
        Link::new(LinkParts { hub, ..uniform() }).unwrap()
    }

    fn with_heavy_payload() -> Link {
        let payload = Payload { mass_kg: 5.2, inertia_kg_m2: 0.0, offset_m: 0.0 };
        Link::new(LinkParts { payload, ..uniform() }).unwrap()
    }

    /// Squared frequencies from 1 1/s² to far beyond any mesh, a stretch's own resonances among them.
    fn resonances_of_stretches(mesh: &Mesh) -> Vec<f64> {
        let gain = |lambda: f64| hub_response_by_stretches(mesh, lambda).largest_gain;
        let grid: Vec<f64> = (0..300).map(|k| 1.096_f64.powi(k)).collect();
        let peaks = grid.windows(3).filter(|w| gain(w[1]) > gain(w[0]).max(gain(w[2]))).map(|w| {
            let (mut low, mut high) = (w[0], w[2]);
            for _ in 0..80 {
                let third = (high - low) / 3.0;
                if gain(low + third) < gain(high - third) {
                    low += third;
                } else {
                    high -= third;
                }
            }
            low
        });
        let peaks: Vec<f64> = peaks.collect();
        [grid, peaks].concat()
    }

    #[test]
    fn where_stretches_are_not_trusted_the_elements_are_asked_one_by_one() {
        let mesh = even_mesh(64);
        let mut by_elements = 0;
        for k in 0..400 {
            // Beyond what the mesh resolves, where next to nothing of the hub's motion is left.
            let lambda = Complex64::new(1.0, -0.04) * (1e6 * 1.05_f64.powi(k));
            let (_, gain) = Way::Stretches.untested_alone(&mesh, lambda);
            let (expected, gain_of_elements) = Way::Elements.untested_alone(&mesh, lambda);
            if !is_trusted(gain) && is_trusted(gain_of_elements) {
                by_elements += 1;
                assert_eq!(tip_transfer(&mesh, lambda), expected, "λ = {lambda}");
            }
        }
        assert!(by_elements > 10, "stretches were trusted with nearly all: {by_elements}");
    }

    /// `T/a_tip` element by element, over numbers with more digits.
    fn exact_inertia<S: Scalar>(mesh: &Mesh, lambda: S) -> S {
        let root = condense(mesh, lambda, |_, _| {});
        let hub = root.about(mesh.nodes_m()[0]) + mesh.hub_inertia_kg_m2();
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
