//! The frequency below which the link is rigid to the last digit.

#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use super::condensation::Inertia;
use super::element::Element;
use super::mesh::Mesh;
use crate::link::Taper;
use crate::numeric::Scalar;

/// What bending may add to a rigid link's motion, as a share of it, so that it is lost in the
/// rounding of any sum.
const NEGLIGIBLE: f64 = 1.0 / (1_u128 << 70) as f64;

impl Mesh {
    /// 1/λ in s², for the recursion. Where λ is so small that the link is rigid to the last digit,
    /// as at rest, that of the largest such λ: finite, and with the same answers.
    #[inline(always)]
    pub fn per_lambda<S: Scalar>(&self, lambda: S) -> S {
        let least = lambda.lift(self.rigid_lambda).size();
        // Not by one reciprocal of the larger: of a link next to rigid its square is no number.
        let of_rigid = lambda.lift(1.0 / self.rigid_lambda);
        S::choose(least, lambda.size(), of_rigid, lambda.reciprocal())
    }

    /// The mesh, all inertia placed, with the λ up to which it is rigid: at which all inertia, a
    /// length L from the axis, would bend all elements, one after the other, by a negligible angle.
    ///
    /// ```text
    /// λ Σ(|A_vv| L² + 2 |A_vφ| L + |A_φφ|) Σ l/EI = 2⁻⁷⁰
    /// ```
    pub(super) fn with_rigid_limit(mut self) -> Self {
        let flexibility = |element: &Element| {
            let Taper { inner, outer } = element.bending_stiffness_n_m2;
            element.length_m / inner.min(outer)
        };
        let beam = self.relative_elements().iter().map(|element| Inertia {
            vv: element.m_uu.m11,
            vp: element.m_uu.m12,
            pp: element.m_uu.m22,
        });
        let lumped = (0..self.nodes_m().len()).filter_map(|node| self.lumped_inertia(node));
        let length_m = self.length_m();
        let moved =
            |a: Inertia<f64>| (a.vv.abs() * length_m + 2.0 * a.vp.abs()) * length_m + a.pp.abs();
        let inertia: f64 = beam.chain(lumped).chain([self.tip_inertia()]).map(moved).sum();
        let slowness_s2 = inertia * self.elements().iter().map(flexibility).sum::<f64>();
        // Without any inertia nothing bends at any λ.
        self.rigid_lambda = if slowness_s2 > 0.0 { NEGLIGIBLE / slowness_s2 } else { 1.0 };
        self
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use crate::beam::undamped::mesh;
    use crate::beam::{NodalTransfer, hub_response, nodal_transfer};

    /// The transfers at rest are those of the lowest frequencies, to the last digits; and what bends
    /// there at all is kept: the lags, which are per λ.
    #[test]
    fn a_link_at_rest_answers_as_one_that_hardly_moves() {
        let mesh = mesh(17);
        let NodalTransfer { tip, lags_s2, moments_kg_m } = nodal_transfer(&mesh, Complex64::ZERO);
        assert!(tip.lag_s2.re > 1e-4 || tip.lag_s2.re < -1e-4, "{}", tip.lag_s2);
        for lambda in [1e-300, 0.9 * mesh.rigid_lambda, 1.1 * mesh.rigid_lambda, 1e-18] {
            let slow = nodal_transfer(&mesh, lambda.into());
            let close = |a: &[Complex64], b: &[Complex64]| {
                a.iter().zip(b).all(|(a, b)| (a - b).norm() <= 1e-14 * b.norm())
            };
            assert!(close(&slow.lags_s2, &lags_s2), "λ = {lambda}");
            assert!(close(&slow.moments_kg_m, &moments_kg_m), "λ = {lambda}");
            let numbers = [slow.tip.inertia_kg_m, slow.tip.angle_rad_m, slow.tip.lag_s2];
            assert!(close(&numbers, &[tip.inertia_kg_m, tip.angle_rad_m, tip.lag_s2]));
        }
        // As slow as that, it bends by less than any digit of its length.
        let bent_m = hub_response(&mesh, mesh.rigid_lambda).tip_deflection_m.abs();
        assert!(bent_m < 1e-3 * f64::EPSILON * mesh.length_m() && bent_m > 0.0, "{bent_m:e} m");
    }
}
