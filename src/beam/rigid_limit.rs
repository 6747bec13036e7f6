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

/// Largest `K_d/λ` in kg or kg m²: a number, with room for what is added to it.
const STIFFEST: f64 = 1e280;

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
    ///
    /// An element so stiff beside the others that `K_d/λ` would be infinite there keeps a stiffness at
    /// which it is a number: it does not bend by any digit either way.
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
        let most = STIFFEST * self.rigid_lambda;
        for element in &mut self.relative {
            let largest = element.k_d.m11.max(element.k_d.m22);
            if largest > most {
                element.k_d *= most / largest;
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use crate::beam::undamped::mesh;
    use crate::beam::{Mesh, NodalTransfer, nodal_transfer};
    use crate::link::{
        Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };

    /// The transfers at rest are those of the lowest frequencies, to the last digits; and what bends
    /// there at all is kept: the lags, which are per λ.
    #[test]
    fn a_link_at_rest_answers_as_one_that_hardly_moves() {
        let mesh = mesh(17);
        let NodalTransfer { tip, lags_s2, moments_kg_m } = nodal_transfer(&mesh, Complex64::ZERO);
        assert!(tip.lag_s2.re > 1e-4 || tip.lag_s2.re < -1e-4, "{}", tip.lag_s2);
        let rigid = mesh.rigid_lambda;
        let turned = Complex64::new(1.0, -0.04);
        for lambda in [1.1 * rigid, -1.1 * rigid, 1e-18, -1e-18]
            .map(Complex64::from)
            .into_iter()
            .chain([0.5 * rigid, 1.1 * rigid, 1e-18].map(|lambda| lambda * turned))
        {
            let slow = nodal_transfer(&mesh, lambda);
            let close = |a: &[Complex64], b: &[Complex64]| {
                a.iter().zip(b).all(|(a, b)| (a - b).norm() <= 1e-14 * b.norm())
            };
            assert!(close(&slow.lags_s2, &lags_s2), "λ = {lambda}");
            assert!(close(&slow.moments_kg_m, &moments_kg_m), "λ = {lambda}");
            let numbers = [slow.tip.inertia_kg_m, slow.tip.angle_rad_m, slow.tip.lag_s2];
            assert!(close(&numbers, &[tip.inertia_kg_m, tip.angle_rad_m, tip.lag_s2]));
        }
    }

    /// As slow as that, no node bends by any digit of its way, wherever the inertia is.
    #[test]
    fn a_link_at_its_rigid_limit_bends_by_no_digit() {
        let light = Payload::default();
        let heavy = Payload { mass_kg: 1e6, ..light };
        let turning = Payload { inertia_kg_m2: 1e6, ..light };
        let behind = Payload { mass_kg: 1e6, offset_m: -1.5, ..light };
        let mass = LumpedMass { at_m: 1.5, mass_kg: 1e6, inertia_kg_m2: 1e6 };
        for (payload, masses) in [
            (light, vec![]),
            (heavy, vec![]),
            (turning, vec![]),
            (behind, vec![]),
            (light, vec![LumpedMass { at_m: 0.75, ..mass }]),
        ] {
            let link = Link::new(LinkParts { masses, payload, ..uniform() }).unwrap();
            let mesh = Mesh::on(&link, 10);
            let transfer = nodal_transfer(&mesh, mesh.rigid_lambda.into());
            let bent = transfer.lags_s2.iter().map(|lag| lag.norm() * mesh.rigid_lambda);
            let most = bent.fold(0.0, f64::max);
            assert!(most < 1e-4 * f64::EPSILON && most > 0.0, "{payload:?}: {most:e}");
        }
    }

    #[test]
    fn a_link_at_rest_is_rigid_however_soft_or_stiff() {
        for bending_stiffness in [1e-280, 1.0, 1e280, 1e305] {
            let bending_stiffness_n_m2 = Taper::constant(bending_stiffness);
            let segments = vec![Segment { bending_stiffness_n_m2, ..uniform_segment() }];
            let link = Link::new(LinkParts { segments, ..uniform() }).unwrap();
            let mesh = Mesh::on(&link, 3);
            let at_rest = nodal_transfer(&mesh, Complex64::ZERO).tip;
            let rigid = link.rigid_inertia_kg_m2() / mesh.length_m();
            let off = (at_rest.inertia_kg_m.re / rigid - 1.0).abs();
            assert!(off < 1e-14, "EI = {bending_stiffness} N m²: {off:e}");
        }
    }
}
