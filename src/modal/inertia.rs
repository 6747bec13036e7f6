use crate::beam::{Element, Inertia, Mesh};
use crate::link::Taper;

/// Whether anything but the beam itself resists rotation outboard of the hub: a lumped rotary
/// inertia or an offset payload.
pub fn carries_rotary_inertia(mesh: &Mesh) -> bool {
    let lumped = (0..mesh.elements().len()).filter_map(|node| mesh.lumped_inertia(node));
    mesh.tip_inertia().pp > 0.0 || lumped.into_iter().any(|body| body.pp > 0.0)
}

/// Number of flexible modes of the link on its free hub.
pub fn flexible_modes(mesh: &Mesh) -> usize {
    (outboard_degrees_of_freedom(mesh) + usize::from(hub_moves_mass(mesh))).saturating_sub(1)
}

/// Degrees of freedom outboard of the hub that move any mass: as many modes the mesh has while the
/// hub is clamped.
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

/// Whether the hub's rotation moves any mass of its own: one mode more where it is not clamped.
pub fn hub_moves_mass(mesh: &Mesh) -> bool {
    // The root only turns: its mass counts if the hub's radius gives it an arm.
    let root = mesh.lumped_inertia(0).is_some_and(|body| body.about(mesh.nodes_m()[0]) > 0.0);
    mesh.hub_inertia_kg_m2() > 0.0 || root || has_mass(&mesh.elements()[0])
}

fn has_mass(element: &Element) -> bool {
    let Taper { inner, outer } = element.mass_per_length_kg_m;
    inner > 0.0 || outer > 0.0
}

fn rank(body: &Inertia<f64>) -> usize {
    match (body.vv > 0.0, body.pp > 0.0) {
        (true, true) if body.vv * body.pp > body.vp * body.vp => 2,
        (false, false) => 0,
        _ => 1,
    }
}
