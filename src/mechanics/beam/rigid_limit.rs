//! The frequency below which the link is rigid to the last digit.

use super::element::{Element, RelativeElement};
use super::inertia::Inertia;
use crate::link::Taper;

/// Ratio of bending to rigid motion below which rounding of any sum hides it.
const NEGLIGIBLE: f64 = 1.0 / (1_u128 << 70) as f64;

/// Largest `K_d/λ` in kg or kg m²: finite, with room for further terms.
const STIFFEST: f64 = 1e280;

/// λ in 1/s² up to which a link of length L is rigid: all inertia, placed at the distance L from the axis, bends all
/// elements in series by a negligible angle.
///
/// ```text
/// λ Σ(|A_vv| L² + 2 |A_vφ| L + |A_φφ|) Σ(l/EI + l/(κGA L²)) = 2⁻⁷⁰
/// ```
pub(super) fn rigid_lambda<'a>(
    (elements, relative): (&[Element], &[RelativeElement]),
    bodies: impl Iterator<Item = &'a Inertia<f64>>,
    length_m: f64,
) -> f64 {
    let flexibility = |element: &Element| {
        let Taper { inner, outer } = element.bending_stiffness_n_m2;
        let shear = element.timoshenko.map_or(0.0, |own| {
            let Taper { inner, outer } = own.shear_stiffness_n;
            element.length_m / (inner.min(outer) * length_m.powi(2))
        });
        element.length_m / inner.min(outer) + shear
    };
    let beam = relative.iter().map(|element| {
        let mass = element.m_uu;
        Inertia { vv: mass.m11, vp: mass.m12, pp: mass.m22 }
    });
    let about_axis =
        |a: Inertia<f64>| (a.vv.abs() * length_m + 2.0 * a.vp.abs()) * length_m + a.pp.abs();
    let inertia: f64 = beam.chain(bodies.copied()).map(about_axis).sum();
    let slowness_s2 = inertia * elements.iter().map(flexibility).sum::<f64>();
    // Without any inertia nothing bends at any λ.
    if slowness_s2 > 0.0 { NEGLIGIBLE / slowness_s2 } else { 1.0 }
}

/// Lowers the stiffness of elements whose `K_d/λ` would overflow at the rigid limit: beside the others they do not bend
/// by any digit either way.
pub(super) fn limit_stiffness(elements: &mut [RelativeElement], rigid_lambda: f64) {
    let most = STIFFEST * rigid_lambda;
    for element in elements {
        let largest = element.k_d.m11.max(element.k_d.m22);
        if largest > most {
            element.k_d *= most / largest;
        }
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use crate::beam::test_links::mesh;
    use crate::beam::{Mesh, NodalTransfer, nodal_transfer};
    use crate::link::{
        Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };

    /// The transfers at rest equal those of the lowest frequencies to the last digits, also the lags, which are per λ.
    #[test]
    fn a_link_at_rest_answers_as_one_that_hardly_moves() {
        let mesh = mesh(17);
        let NodalTransfer { tip, deflections_s2, moments_kg_m } =
            nodal_transfer(&mesh, Complex64::ZERO);
        assert!(
            tip.deflection_s2.re > 1e-4 || tip.deflection_s2.re < -1e-4,
            "{}",
            tip.deflection_s2
        );
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
            assert!(close(&slow.deflections_s2, &deflections_s2), "λ = {lambda}");
            assert!(close(&slow.moments_kg_m, &moments_kg_m), "λ = {lambda}");
            let numbers = [slow.tip.inertia_kg_m, slow.tip.angle_rad_m, slow.tip.deflection_s2];
            assert!(close(&numbers, &[tip.inertia_kg_m, tip.angle_rad_m, tip.deflection_s2]));
        }
    }

    /// At the rigid limit no node bends by any digit of its travel, wherever the inertia is.
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
            let bent = transfer.deflections_s2.iter().map(|lag| lag.norm() * mesh.rigid_lambda);
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
