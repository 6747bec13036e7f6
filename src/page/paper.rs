//! Figures of the paper that a page shows again.

use std::f64::consts::PI;

use super::view::View;
use crate::link::Damping;
use crate::numeric::largest;

/// Number of the example of Bayo (1987) that a solution corresponds to: the link of the paper, and its motion of 0.5 m
/// in 0.88 s with a period of a sine as acceleration.
fn example(view: &View) -> Option<usize> {
    let run = view.link?;
    let (from, until) = view.first().moving_s?;
    let (link, tip) = (run.link, &run.arc.tip);
    let (hub, payload) = (link.hub(), link.payload());
    let is_bare = [
        payload.mass_kg,
        payload.inertia_kg_m2,
        payload.offset_m,
        hub.radius_m,
        hub.viscous_friction_n_m_s_rad,
    ]
    .iter()
    .all(|part| *part == 0.0)
        && link.segments().iter().all(|segment| segment.timoshenko.is_none())
        && link.masses().is_empty()
        && link.drive().is_none()
        && link.gravity().is_none();
    let Damping::Hysteretic { ratio } = link.damping() else { return None };
    let travel_m = tip.displacement_m.last()? - tip.displacement_m.first()?;
    let mut numbers = vec![hub.inertia_kg_m2, *ratio, until - from, travel_m.abs()];
    for segment in link.segments() {
        let (stiffness, mass) = (segment.bending_stiffness_n_m2, segment.mass_per_length_kg_m);
        let ends = [stiffness.inner, stiffness.outer, mass.inner, mass.outer];
        numbers.extend([segment.length_m].into_iter().chain(ends));
    }
    let peak = largest(&tip.acceleration_m_s2) / (PI / 0.88_f64.powi(2));
    let is_printed = |ei: f64| {
        let (root, beam) = ([0.15, 10.0 * ei, 10.0 * ei, 0.8, 0.8], [1.35, ei, ei, 0.8, 0.8]);
        let printed = [&[0.1, 0.02, 0.88, 0.5][..], &root, &beam].concat();
        let is_close = |(number, printed): (&f64, &f64)| (number / printed - 1.0).abs() < 1e-3;
        numbers.len() == printed.len() && numbers.iter().zip(&printed).all(is_close)
    };
    [5.0, 20.0].into_iter().position(|ei| is_bare && (peak - 1.0).abs() < 1e-2 && is_printed(ei))
}

/// Citation of the corresponding figure in the paper's first or second example; empty for other links and motions.
pub(super) fn cited(view: &View, figures: [Option<u8>; 2]) -> String {
    let figure = example(view).and_then(|number| figures[number]);
    figure.map_or(String::new(), |figure| format!(" (Bayo 1987, figure {figure})"))
}
