use crate::beam::{Element, Inertia, Mesh};
use crate::link::Taper;

/// Round-off in a body's resistance to its second motion, as a share.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// True if zeros of torque → tip may leave the real axis, because of a lumped rotary inertia outboard of the hub, an
/// offset payload, or a beam with shear and rotary inertia. With point masses on slender beams they stay there.
pub(super) fn zeros_may_leave_the_real_axis(mesh: &Mesh) -> bool {
    let lumped = (0..mesh.elements().len()).filter_map(|node| mesh.lumped_inertia(node));
    mesh.tip_inertia().pp > 0.0 || lumped.into_iter().any(|body| body.pp > 0.0) || mesh.has_shear()
}

/// Number of flexible modes of the link on its free hub.
pub(crate) fn flexible_modes(mesh: &Mesh) -> usize {
    (outboard_degrees_of_freedom(mesh) + usize::from(hub_moves_mass(mesh))).saturating_sub(1)
}

/// Degrees of freedom outboard of the hub that move mass: the number of modes of the mesh with a clamped hub.
pub(super) fn outboard_degrees_of_freedom(mesh: &Mesh) -> usize {
    let elements = mesh.elements();
    let last = elements.len();
    let at_node = |node: usize| {
        let beam = has_mass(&elements[node - 1]) || elements.get(node).is_some_and(has_mass);
        let body = if node == last { Some(mesh.tip_inertia()) } else { mesh.lumped_inertia(node) };
        if beam { 2 } else { body.as_ref().map_or(0, rank) }
    };
    (1..=last).map(at_node).sum()
}

/// True if the hub's rotation alone moves mass, which adds a mode unless the hub is clamped.
pub(crate) fn hub_moves_mass(mesh: &Mesh) -> bool {
    // The root only turns: its mass counts if the hub's radius gives it an arm.
    let root = mesh.lumped_inertia(0).is_some_and(|body| body.about(mesh.nodes_m()[0]) > 0.0);
    mesh.hub_inertia_kg_m2() > 0.0 || root || has_mass(&mesh.elements()[0])
}

fn has_mass(element: &Element) -> bool {
    let Taper { inner, outer } = element.mass_per_length_kg_m;
    inner > 0.0 || outer > 0.0
}

/// Number of motions of a body that move mass: a point beyond its node turns and shifts as one.
fn rank(body: &Inertia<f64>) -> usize {
    let (both, coupled) = (body.vv * body.pp, body.vp * body.vp);
    match (body.vv > 0.0, body.pp > 0.0) {
        (true, true) if both - coupled > ROUND_OFF * both => 2,
        (false, false) => 0,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{
        Hub, Link, LinkParts, LumpedMass, Payload, Segment, uniform, uniform_segment,
    };
    use crate::modal::{ModalBasis, natural_frequencies};

    /// A link of twenty elements with these bodies and this mass per length.
    fn mesh(beam: Taper, hub: Hub, masses: Vec<LumpedMass>, payload: Payload) -> Mesh {
        meshed(20, beam, hub, masses, payload)
    }

    fn meshed(
        elements: usize,
        beam: Taper,
        hub: Hub,
        masses: Vec<LumpedMass>,
        payload: Payload,
    ) -> Mesh {
        let link = Link::new(LinkParts {
            segments: vec![Segment { mass_per_length_kg_m: beam, ..uniform_segment() }],
            hub,
            masses,
            payload,
            ..uniform()
        })
        .unwrap();
        let plan =
            MeshPlan::new(&link, &[None], Some(ElementCount::Total(elements)), 1e-6).unwrap();
        Mesh::new(&link, &plan).unwrap()
    }

    const NOTHING: Taper = Taper { inner: 0.0, outer: 0.0 };
    const HUB: Hub = Hub { inertia_kg_m2: 0.1, radius_m: 0.0, viscous_friction_n_m_s_rad: 0.0 };

    fn body(at_m: f64, mass_kg: f64, inertia_kg_m2: f64) -> LumpedMass {
        LumpedMass { at_m, mass_kg, inertia_kg_m2 }
    }

    #[test]
    fn a_beam_without_mass_has_a_mode_for_each_motion_of_its_bodies_that_moves_mass() {
        let tip = |mass_kg, inertia_kg_m2, offset_m| Payload { mass_kg, inertia_kg_m2, offset_m };
        let (point, block) = (tip(0.4, 0.0, 0.0), tip(0.4, 0.01, 0.0));
        for (masses, payload, modes) in [
            (vec![], Payload::default(), 0),
            (vec![], point, 1),
            (vec![], block, 2),
            (vec![], tip(0.4, 0.01, 0.1), 2),
            (vec![body(0.75, 0.3, 0.0)], Payload::default(), 1),
            (vec![body(0.75, 0.3, 0.02)], Payload::default(), 2),
            (vec![body(0.75, 0.0, 0.02)], Payload::default(), 1),
            (vec![body(0.75, 0.3, 0.02)], block, 4),
            (vec![body(0.75, 0.3, 0.0)], point, 2),
        ] {
            let mesh = mesh(NOTHING, HUB, masses, payload);
            assert_eq!(flexible_modes(&mesh), modes, "{mesh:?}");
            assert_eq!(natural_frequencies(&mesh, 9).len(), modes, "{mesh:?}");
            let all = ModalBasis::complete(&mesh).unwrap().modes.len();
            assert_eq!(all, modes, "{mesh:?}");
        }
    }

    #[test]
    fn a_point_beyond_the_tip_moves_in_one_way_whatever_the_rounding() {
        for k in 1..200 {
            let (mass_kg, offset_m) = (0.013 * f64::from(k), 0.3 - 0.007 * f64::from(k));
            let payload = Payload { mass_kg, inertia_kg_m2: 0.0, offset_m };
            let mesh = mesh(NOTHING, HUB, vec![], payload);
            assert_eq!(flexible_modes(&mesh), 1, "{payload:?}");
            assert_eq!(natural_frequencies(&mesh, 9).len(), 1, "{payload:?}");
        }
    }

    #[test]
    fn a_beam_with_mass_at_one_end_alone_has_mass() {
        for beam in [Taper { inner: 0.8, outer: 0.0 }, Taper { inner: 0.0, outer: 0.8 }] {
            // One element tapers to exactly zero, the last of twenty only up to rounding.
            for elements in [1, 20] {
                let mesh = meshed(elements, beam, HUB, vec![], Payload::default());
                assert_eq!(flexible_modes(&mesh), 2 * elements, "{beam:?}");
                assert_eq!(natural_frequencies(&mesh, 99).len(), 2 * elements, "{beam:?}");
            }
        }
    }

    #[test]
    fn a_body_at_the_root_moves_with_the_hub_if_it_has_an_arm_or_an_inertia() {
        for (radius_m, inertia_kg_m2, moves) in
            [(0.0, 0.0, false), (0.0, 0.01, true), (0.2, 0.0, true), (0.2, 0.01, true)]
        {
            let hub = Hub { inertia_kg_m2: 0.0, radius_m, ..HUB };
            let masses = vec![body(radius_m, 0.3, inertia_kg_m2)];
            let mesh = mesh(NOTHING, hub, masses, Payload { mass_kg: 0.4, ..Payload::default() });
            assert_eq!(hub_moves_mass(&mesh), moves, "radius {radius_m} m, {inertia_kg_m2} kg m²");
            assert_eq!(flexible_modes(&mesh), usize::from(moves));
        }
    }

    #[test]
    fn points_of_mass_resist_no_rotation_and_bodies_and_offsets_do() {
        let carries = |inertia_kg_m2: f64, payload: Payload| {
            let masses = vec![body(0.75, 0.3, inertia_kg_m2)];
            zeros_may_leave_the_real_axis(&mesh(Taper::constant(0.8), HUB, masses, payload))
        };
        let point = Payload { mass_kg: 0.4, ..Payload::default() };
        assert!(!carries(0.0, point) && carries(1e-3, point));
        assert!(carries(0.0, Payload { inertia_kg_m2: 1e-3, ..point }));
        assert!(carries(0.0, Payload { offset_m: 0.1, ..point }));
    }
}
