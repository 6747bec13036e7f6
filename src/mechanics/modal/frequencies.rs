//! Natural frequencies of a link whose hub is free, held by a spring or clamped, by counting the modes below a
//! frequency; the number of modes of a mesh; the zeros of torque → tip.

use std::cmp::Ordering;

use super::shape::Shape;
use crate::beam::{
    Element, Inertia, Mesh, Pivots, driven_motion, hub_response, pivots, tip_displacement_m,
    tip_displacements_m,
};
use crate::link::{Link, Taper};
use crate::numeric::{SECTIONS, geometric_scan, next_places, root};
use crate::system::end_if_stopped;

/// Number of natural frequencies in the report of a solution or a simulation.
pub const REPORTED_MODES: usize = 5;

/// Largest relative error of a frequency that comes from counting alone.
const LOST_DIGITS: f64 = 1e-8;

/// Relative change of a frequency by the last Newton step that counts as round-off.
const SETTLED: f64 = 1e-13;

/// Upper limit of searches, an angular frequency in rad/s far above any link's.
const SEARCH_LIMIT_RAD_S: f64 = 1e15;

/// A torsional spring between hub and ground, its stiffness k in N m/rad.
///
/// k = 0 is a free hub, k = ∞ a clamped one. One count and one search serve a free, a sprung and a clamped hub.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct HubSpring(pub(super) f64);

impl HubSpring {
    /// No spring: the hub is free to turn.
    pub(super) const FREE: Self = Self(0.0);
    /// A rigid spring: the hub is clamped.
    pub(super) const CLAMPED: Self = Self(f64::INFINITY);

    /// Number of modes below each ω > 0, including the rigid rotation of a free hub.
    ///
    /// By Sylvester's law of inertia it equals the number of negative pivots of the dynamic stiffness (Wittrick and
    /// Williams). Each element has two pivots, those of its block `K_d/λ − (M_dd + A)`; the hub has one,
    /// `k − λ(A_0[φφ] + I_H)`. The count misses no mode, however close two modes lie. For k = ∞ the hub's pivot is
    /// never negative: the count is that of the clamped link.
    pub(super) fn modes_below(
        self,
        mesh: &Mesh,
        omegas_rad_s: &[f64; SECTIONS],
    ) -> [usize; SECTIONS] {
        end_if_stopped();
        finite_pivots(mesh, omegas_rad_s)
            .map(|Pivots { negative, hub_n_m }| negative + usize::from(hub_n_m > self.0))
    }

    /// Two frequencies in rad/s, below and above mode number `sought`: fewer than `sought` modes lie below the first,
    /// at least `sought` below the second. Both are `from_rad_s` times a power of two. `None` if the search passes
    /// [`SEARCH_LIMIT_RAD_S`].
    fn bracket(self, mesh: &Mesh, sought: usize, from_rad_s: f64) -> Option<(f64, f64)> {
        let (before, above) = self.crossing(mesh, sought, geometric_scan(from_rad_s, 2.0), true)?;
        if let Some(below) = before {
            return Some((below, above));
        }
        // The mode lies below `from_rad_s`.
        let (before, below) =
            self.crossing(mesh, sought, geometric_scan(from_rad_s, 0.5), false)?;
        before.map(|above| (below, above))
    }

    /// The first frequency of a scan above mode number `sought`, or below it if `is_above` is false. Returns the
    /// frequency before it (`None` at the start of the scan), then the frequency itself.
    fn crossing(
        self,
        mesh: &Mesh,
        sought: usize,
        mut scan: impl Iterator<Item = f64>,
        is_above: bool,
    ) -> Option<(Option<f64>, f64)> {
        let mut before = None;
        loop {
            let places = next_places(&mut scan);
            for (place, modes) in places.into_iter().zip(self.modes_below(mesh, &places)) {
                if (modes >= sought) == is_above {
                    return Some((before, place)).filter(|_| place <= SEARCH_LIMIT_RAD_S);
                }
                before = Some(place);
            }
            if places[0] > SEARCH_LIMIT_RAD_S {
                return None;
            }
        }
    }

    /// The first `count` natural frequencies in rad/s, ascending, without the rigid rotation.
    fn natural_frequencies(self, mesh: &Mesh, count: usize) -> Vec<f64> {
        // The rigid rotation of a free hub is its first mode, at ω = 0.
        let rigid = usize::from(self == Self::FREE);
        let count = count.min(self.modes(mesh).saturating_sub(rigid));
        let mut frequencies: Vec<f64> = Vec::with_capacity(count);
        while frequencies.len() < count {
            let sought = rigid + frequencies.len() + 1;
            let from = frequencies.last().copied().unwrap_or(1.0);
            let Some((below, above)) = self.bracket(mesh, sought, from) else { break };
            let surplus = |places: &_| self.surplus_n_m(mesh, places, sought);
            // Only the signs of the values at the ends are known.
            frequencies.push(root((below, f64::NEG_INFINITY), (above, f64::INFINITY), surplus));
        }
        frequencies.into_iter().map(|omega| self.polish(mesh, omega)).collect()
    }

    /// A function of ω in N m, negative below mode number `sought` and positive above it. It is minus the hub's pivot
    /// between the modes of the clamped link next to the sought one, where this pivot has poles, and infinite beyond
    /// them.
    fn surplus_n_m(
        self,
        mesh: &Mesh,
        omegas_rad_s: &[f64; SECTIONS],
        sought: usize,
    ) -> [f64; SECTIONS] {
        finite_pivots(mesh, omegas_rad_s).map(|Pivots { negative, hub_n_m }| {
            // Minus the difference, so that zero is −0: `root` reads the sign, and zero counts as below.
            let surplus_n_m = -(self.0 - hub_n_m);
            match (negative + 1).cmp(&sought) {
                Ordering::Greater => f64::INFINITY,
                // NaN counts as below, too.
                Ordering::Equal if !surplus_n_m.is_nan() => surplus_n_m,
                _ => f64::NEG_INFINITY,
            }
        })
    }

    /// Restores the digits that counting loses where an outboard part of a fine mesh resonates near a mode.
    ///
    /// Each of the two steps is Rayleigh's quotient, a Newton step on the hub's dynamic stiffness. A mode that hardly
    /// moves the hub is next to a pole of this stiffness. The steps then do not settle, and the function returns
    /// `omega_rad_s`, the frequency from counting.
    fn polish(self, mesh: &Mesh, omega_rad_s: f64) -> f64 {
        let first = self.rayleigh_quotient(mesh, omega_rad_s);
        let second = self.rayleigh_quotient(mesh, first);
        let shift = |from: f64, to: f64| (to / from - 1.0).abs();
        let has_settled = shift(first, second) < SETTLED && shift(omega_rad_s, first) < LOST_DIGITS;
        if has_settled { second } else { omega_rad_s }
    }

    /// Frequency ω in rad/s at which the shape u that a torque at the hub excites at `omega_rad_s` would vibrate
    /// freely. d are the deformations of its elements, θ is its hub angle.
    ///
    /// ```text
    /// ω² = (Σ dᵀ K_d d + k θ²) / (uᵀ M u)
    /// ```
    fn rayleigh_quotient(self, mesh: &Mesh, omega_rad_s: f64) -> f64 {
        let motion = driven_motion(mesh, omega_rad_s * omega_rad_s);
        let elements = mesh.relative_elements().iter().zip(&motion.deformations);
        let bending: f64 = elements.map(|(element, d)| d.dot(&(element.k_d * d))).sum();
        let shape = Shape::of(&motion);
        // A clamped hub does not turn; ∞ · 0 would be NaN.
        let spring = if self == Self::CLAMPED { 0.0 } else { self.0 * shape.hub_angle.powi(2) };
        ((bending + spring) / shape.mass_product(mesh, &shape)).sqrt()
    }

    /// Number of modes of the mesh, including the rigid rotation of a free hub. Unless the hub is clamped, its rotation
    /// adds a mode if it moves mass.
    fn modes(self, mesh: &Mesh) -> usize {
        let hub = self != Self::CLAMPED && hub_moves_mass(mesh);
        outboard_degrees_of_freedom(mesh) + usize::from(hub)
    }
}

/// Negative pivots at each ω > 0, or up to 12 ε above it: on a pole of the apparent inertia no number is finite, but
/// slightly beside it all are.
fn finite_pivots(mesh: &Mesh, omegas_rad_s: &[f64; SECTIONS]) -> [Pivots; SECTIONS] {
    let mut finite = [Pivots { negative: 0, hub_n_m: f64::NAN }; SECTIONS];
    // Numbers beyond double precision stay infinite, so the attempts are few.
    for attempt in 0..4 {
        let factor = 1.0 + 4.0 * f64::from(attempt) * f64::EPSILON;
        let counts = pivots(mesh, &omegas_rad_s.map(|omega| (omega * factor).powi(2)));
        let open = finite.iter_mut().zip(counts).filter(|(place, _)| place.hub_n_m.is_nan());
        open.filter(|(_, now)| now.hub_n_m.is_finite()).for_each(|(place, now)| *place = now);
        if finite.iter().all(|place| place.hub_n_m.is_finite()) {
            break;
        }
    }
    finite
}

/// Number of modes below `omega_rad_s` > 0 of the link on its free hub, including the rigid rotation.
pub fn modes_below(mesh: &Mesh, omega_rad_s: f64) -> usize {
    HubSpring::FREE.modes_below(mesh, &[omega_rad_s; SECTIONS])[0]
}

/// The first `count` natural frequencies in rad/s, ascending, without the rigid rotation.
///
/// They are undamped, with a torque-free hub: the vibrations after the motor lets go. Fewer than `count` if the mesh
/// has fewer.
pub fn natural_frequencies(mesh: &Mesh, count: usize) -> Vec<f64> {
    HubSpring::FREE.natural_frequencies(mesh, count)
}

/// The first `count` natural frequencies in rad/s, ascending, of the link with a locked rotor.
///
/// The joint of a drive is then a spring of `joint_stiffness_n_m_rad` between hub and ground; an infinite one clamps
/// the hub, and one of 0 or below leaves it free. Undamped. The k-th frequency lies below the k-th of
/// [`natural_frequencies`] and above the one before it. Fewer than `count` if the mesh has fewer.
pub fn held_frequencies(mesh: &Mesh, joint_stiffness_n_m_rad: f64, count: usize) -> Vec<f64> {
    HubSpring(joint_stiffness_n_m_rad.max(0.0)).natural_frequencies(mesh, count)
}

/// Weights a and b of [`second_order_share`] for the change of the torque of a prescribed tip motion, rounded up from
/// random links.
pub(crate) const TORQUE_WEIGHTS: [f64; 2] = [0.7, 0.35];

/// Weights a and b of [`second_order_share`] for the change of the deflections under a prescribed torque. The tip of a link
/// on a carriage moves by 0.3 to 1.5 times (d/L)² of its deflection d.
pub(crate) fn deflection_weights(link: &Link) -> [f64; 2] {
    if link.joint().slides() { [1.5, 0.0] } else { [0.3, 0.1] }
}

/// Estimated change by the second-order terms, which a linear link neglects, as a share up to 1. Returns it as a
/// function of the deflection d in m and of the weights [a, b], [`TORQUE_WEIGHTS`] or [`deflection_weights`].
///
/// ```text
/// a (d/l)² + s/(1 + s),    s = b (1 + 8 r/l) (Ω/ω₁)²
/// ```
///
/// d is the tip's largest deflection from the hub's tangent line, estimated from that of an output inboard of it, l the length that bends, r the hub's radius, Ω the
/// hub's largest rate `rate_rad_s`, and ω₁ the first natural frequency of the link clamped at the hub. s stands
/// for the relative growth of ω₁² by centrifugal forces: for a uniform cantilever that turns in its plane, ω₁² grows by
/// `0.19 (1 + 8 r/l) Ω²` (R. Southwell's coefficients).
pub(crate) fn second_order_share(
    mesh: &Mesh,
    link: &Link,
    rate_rad_s: f64,
) -> impl Fn(f64, [f64; 2]) -> f64 + use<> {
    let (radius_m, tip_per_output) = (link.hub().radius_m, link.tip_per_output());
    let length_m = link.length_m() - radius_m;
    let clamped = held_frequencies(mesh, f64::INFINITY, 1).first().copied();
    // A link that slides does not turn.
    let [_, slope] = link.joint().rigid(length_m);
    let rate_ratio = clamped.map_or(0.0, |clamped| slope * rate_rad_s / clamped);
    move |deflection_m, [a, b]| {
        let s = b * (1.0 + 8.0 * radius_m / length_m) * rate_ratio.powi(2);
        let by_deflection = a * (tip_per_output * deflection_m / length_m).powi(2);
        // s/(1 + s) in a form that is 1 for an infinite rate.
        (by_deflection + 1.0 - (1.0 + s).recip()).min(1.0)
    }
}

/// Largest share of a product of inertias that is round-off: below it a body resists only one motion.
const ROUND_OFF: f64 = 8.0 * f64::EPSILON;

/// True if zeros of torque → tip may leave the real axis. A lumped rotary inertia outboard of the hub, an offset
/// payload, a beam with shear and rotary inertia, or an output inboard of the tip can move them; with point masses on
/// slender beams they stay real.
fn zeros_may_leave_the_real_axis(mesh: &Mesh) -> bool {
    let lumped = (0..mesh.elements().len()).filter_map(|node| mesh.lumped_inertia(node));
    let is_inboard = mesh.output() < mesh.elements().len();
    is_inboard
        || mesh.tip_inertia().pp > 0.0
        || lumped.into_iter().any(|body| body.pp > 0.0)
        || mesh.has_shear()
}

/// Number of flexible modes of the link on its free hub.
pub(crate) fn flexible_modes(mesh: &Mesh) -> usize {
    (outboard_degrees_of_freedom(mesh) + usize::from(hub_moves_mass(mesh))).saturating_sub(1)
}

/// Degrees of freedom outboard of the hub that move mass: the number of modes of the mesh with a clamped hub.
fn outboard_degrees_of_freedom(mesh: &Mesh) -> usize {
    let elements = mesh.elements();
    let last = elements.len();
    let at_node = |node: usize| {
        let beam = has_mass(&elements[node - 1]) || elements.get(node).is_some_and(has_mass);
        let body = if node == last { Some(mesh.tip_inertia()) } else { mesh.lumped_inertia(node) };
        if elements[node - 1].is_spring() {
            // The node only turns.
            return usize::from(beam || body.is_some_and(|body| body.pp > 0.0));
        }
        if beam { 2 } else { body.as_ref().map_or(0, rank) }
    };
    (1..=last).map(at_node).sum()
}

/// True if the hub's rotation alone moves mass, which adds a mode unless the hub is clamped.
pub(crate) fn hub_moves_mass(mesh: &Mesh) -> bool {
    // The root only turns with the hub: a mass on it counts if the hub's radius is its lever arm. A spring turns alone.
    let root = mesh.springs();
    let [v, phi] = mesh.rigid(root);
    let unit = [v, if root == 0 { phi } else { 0.0 }];
    let lumped = mesh.lumped_inertia(root).is_some_and(|body| body.along(unit) > 0.0);
    let beam = has_mass(&mesh.elements()[root]) && (unit[0] != 0.0 || unit[1] != 0.0);
    mesh.joint().inertia() > 0.0 || lumped || beam
}

fn has_mass(element: &Element) -> bool {
    let Taper { inner, outer } = element.mass_per_length_kg_m;
    inner > 0.0 || outer > 0.0
}

/// Number of independent motions of a body that move mass, the rank of its inertia matrix. For a point mass beyond its
/// node it is 1: shifting and turning the node move the mass alike.
fn rank(body: &Inertia<f64>) -> usize {
    let (diagonal, coupling) = (body.vv * body.pp, body.vp * body.vp);
    match (body.vv > 0.0, body.pp > 0.0) {
        (true, true) if diagonal - coupling > ROUND_OFF * diagonal => 2,
        (false, false) => 0,
        _ => 1,
    }
}

/// Number of zeros in the report of a solution.
pub const REPORTED_ZEROS: usize = 3;

/// Ratio of neighbouring points in the scan for zeros; neighbouring zeros of a uniform link are a factor 5.4, 2.5, 1.9,
/// … apart.
const SCAN_RATIO: f64 = 1.02;

/// Start of the scan as a share of the first clamped mode.
const SCAN_START: f64 = 0.01;

/// End of the scan as a multiple of its start.
pub(super) const SCAN_RANGE: f64 = 1e8;

/// Relative change on halved elements below which a zero of a beam with shear belongs to the link. Zeros of the mesh
/// alone change by a factor of about two.
const SETTLED_ZERO: f64 = 0.2;

/// Start of the scan for real zeros as a share of a lower bound of the first zero. A mesh of few elements may have
/// other zeros, which reduce the sum slightly.
const NEAR: f64 = 0.5;

/// End of the scan for real zeros as a multiple of its start.
const NEAR_RANGE: f64 = 1e6;

/// The first `count` real zeros z of torque → tip in 1/s, ascending: the transfer vanishes at ±z.
///
/// They are the roots of `L + e_tip` at λ = −z². The torque for a tip motion must start early: it grows as e^{z₁t}
/// before the motion and decays as e^{−z₁t} after it. Fewer than `count` if the mesh has fewer. Rotary inertia on the
/// link or at the tip can move zeros off the real axis in pairs ±a ± ib; the list excludes such pairs. A beam with
/// shear has few real zeros: faster than its cut-off it decays without a wave. Further zeros of its mesh vanish when
/// the elements are halved.
pub fn torque_zeros(mesh: &Mesh, count: usize) -> Vec<f64> {
    if outboard_degrees_of_freedom(mesh) == 0 {
        return Vec::new();
    }
    let near = start_near_real_zeros(mesh).map(|start| (start, start * NEAR_RANGE));
    let scan = near.or_else(|| scan_start(mesh).map(|start| (start, start * SCAN_RANGE)));
    let Some((start, limit)) = scan else { return Vec::new() };
    let all =
        |mesh: &Mesh| changes(start, limit, count, |exponents| displacements_m(mesh, exponents));
    let mut zeros = all(mesh);
    if mesh.has_shear() && !zeros.is_empty() {
        let finer = all(&mesh.refined());
        zeros.retain(|zero| finer.iter().any(|finer| (zero / finer - 1.0).abs() < SETTLED_ZERO));
    }
    zeros
}

/// Tip displacement per hub angle, `L + e_tip`, in m where both grow as e^{zt}.
fn displacements_m(mesh: &Mesh, exponents_per_s: &[f64; SECTIONS]) -> [f64; SECTIONS] {
    tip_displacements_m(mesh, &exponents_per_s.map(|z| -z * z))
}

/// Zeros of torque → tip at real frequencies below `limit_rad_s`, in rad/s, ascending.
///
/// Rotary inertia at the tip or on the link, or an offset payload, causes them: at such a frequency no torque moves the
/// tip, and the torque of the inversion grows as 1/ξ. They are the roots of `L + e_tip` at λ = ω². The sum's sign also
/// flips at every mode of the link clamped at the hub; the pivots count these modes below ω, so that only the zeros
/// remain as changes of parity.
pub fn real_frequency_zeros(mesh: &Mesh, limit_rad_s: f64) -> Vec<f64> {
    if !zeros_may_leave_the_real_axis(mesh) || outboard_degrees_of_freedom(mesh) == 0 {
        // Point masses keep all zeros off the real frequencies; without mass there are no zeros.
        return Vec::new();
    }
    let Some(start) = scan_start(mesh) else { return Vec::new() };
    let limit_rad_s = limit_rad_s.min(SEARCH_LIMIT_RAD_S);
    let unflipped = |places: &[f64; SECTIONS]| {
        let displacements = tip_displacements_m(mesh, &places.map(|omega| omega * omega));
        let modes = HubSpring::CLAMPED.modes_below(mesh, places);
        let unflip =
            |k: usize| if modes[k] % 2 == 1 { -displacements[k] } else { displacements[k] };
        std::array::from_fn(unflip)
    };
    changes(start, limit_rad_s, usize::MAX, unflipped)
}

/// The first `count` places, from `start` up to `limit`, at which a function changes its sign; `values`
/// evaluates it at sixteen places.
pub(super) fn changes(
    start: f64,
    limit: f64,
    count: usize,
    values: impl Fn(&[f64; SECTIONS]) -> [f64; SECTIONS],
) -> Vec<f64> {
    let mut scan = geometric_scan(start, SCAN_RATIO);
    let mut crossings = Vec::new();
    let mut previous: Option<(f64, f64)> = None;
    loop {
        let places = next_places(&mut scan);
        for now in places.into_iter().zip(values(&places)) {
            if now.0 > limit || crossings.len() == count {
                return crossings;
            }
            let is_other =
                |then: &(f64, f64)| then.1.is_sign_negative() != now.1.is_sign_negative();
            if let Some(before) = previous.filter(is_other) {
                crossings.push(root(before, now, &values));
            }
            previous = Some(now);
        }
    }
}

/// Start of the scan for zeros of torque → tip in 1/s, if point masses leave them all real. These zeros and the modes
/// of the clamped link determine how far inertia bends the tip at rest:
///
/// ```text
/// L + e_tip = L ∏ (1 + λ/z_k²)/(1 − λ/ω_k²),   at rest  e_tip/(λL) = Σ 1/z_k² + Σ 1/ω_k² > 1/z₁²
/// ```
fn start_near_real_zeros(mesh: &Mesh) -> Option<f64> {
    if zeros_may_leave_the_real_axis(mesh) {
        return None;
    }
    let rest = hub_response(mesh, 0.0);
    let lag_m_s2 = rest.tip_deflection_m * rest.per_lambda_s2;
    let start = NEAR * (mesh.rigid_tip() / lag_m_s2).sqrt();
    let is_below = tip_displacement_m(mesh, -start * start) > 0.0;
    Some(start).filter(|start| start.is_finite() && is_below)
}

/// Start of other scans for zeros in 1/s: far below the first mode of the link clamped at its hub, where no zero is
/// near. `None` if the search for that mode fails.
pub(super) fn scan_start(mesh: &Mesh) -> Option<f64> {
    let first = HubSpring::CLAMPED.bracket(mesh, 1, 1.0)?.0;
    Some(SCAN_START * first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan, condense};
    use crate::link::{Hub, Link, LinkParts, Payload, Segment, Taper, uniform, uniform_segment};
    use crate::numeric::Wide;

    fn massless(hub_kg_m2: f64, payload_kg: f64) -> Mesh {
        let link = Link::new(LinkParts {
            segments: vec![Segment {
                mass_per_length_kg_m: Taper::constant(0.0),
                ..uniform_segment()
            }],
            hub: Hub { inertia_kg_m2: hub_kg_m2, ..Hub::default() },
            payload: Payload { mass_kg: payload_kg, ..Payload::default() },
            ..uniform()
        })
        .unwrap();
        Mesh::on(&link, 10)
    }

    #[test]
    fn a_massless_beam_between_two_bodies_has_their_one_mode() {
        // A spring 3EI/L³ at the tip, and the free hub as a mass I_H/L².
        let frequencies = natural_frequencies(&massless(0.1, 0.1), 5);
        let stiffness = 3.0 * 5.0 / 1.5_f64.powi(3);
        let (hub, tip) = (0.1 / 1.5_f64.powi(2), 0.1);
        let exact = (stiffness * (1.0 / hub + 1.0 / tip)).sqrt();
        assert_eq!(frequencies.len(), 1);
        assert!((frequencies[0] / exact - 1.0).abs() < 1e-12, "{} is not {exact}", frequencies[0]);
        assert_eq!(natural_frequencies(&massless(0.0, 1.0), 5), Vec::<f64>::new());
    }

    #[test]
    fn a_massless_beam_behind_a_joint_has_a_mode_a_body_that_moves() {
        let (beam, joint) = (3.0 * 5.0 / 1.5_f64.powi(3), 20.0);
        let check = |frequencies: &[f64], squares: &[f64]| {
            assert_eq!(frequencies.len(), squares.len(), "{frequencies:?}");
            for (omega, square) in frequencies.iter().zip(squares) {
                assert!((omega * omega / square - 1.0).abs() < 1e-12, "{omega} is not √{square}");
            }
        };
        // A clamped hub moves no mass; a sprung hub without inertia is one more spring in series.
        for hub in [0.0, 0.1] {
            let clamped = held_frequencies(&massless(hub, 0.4), f64::INFINITY, 5);
            check(&clamped, &[beam / 0.4]);
        }
        let series = 1.0 / (1.0 / beam + 1.5_f64.powi(2) / joint);
        check(&held_frequencies(&massless(0.0, 0.4), joint, 5), &[series / 0.4]);
        // With inertia there are two masses and two springs, with the hub's referred to the tip.
        let (m, hub, k) = (0.4, 0.1 / 1.5_f64.powi(2), joint / 1.5_f64.powi(2));
        let (half, product) = (0.5 * (beam / m + (beam + k) / hub), beam * k / (m * hub));
        let root = (half * half - product).sqrt();
        let exact = [product / (half + root), half + root];
        check(&held_frequencies(&massless(0.1, 0.4), joint, 5), &exact);
        // A hub alone swings on the joint.
        check(&held_frequencies(&massless(0.1, 0.0), joint, 5), &[joint / 0.1]);
        check(&held_frequencies(&massless(0.1, 0.0), f64::INFINITY, 5), &[]);
    }

    /// Modes below √λ of the free link, counted in 106 bits.
    fn counted_in_106_bits(mesh: &Mesh, lambda: Wide) -> usize {
        let mut negative = 0;
        let root = condense(mesh, lambda, |_, step| {
            negative += step.pivots.iter().filter(|p| p.nearest().re < 0.0).count();
        });
        let hub = root.along(mesh.rigid(0)) + mesh.joint().inertia();
        negative + usize::from(hub.nearest().re > 0.0)
    }

    #[test]
    fn natural_frequencies_have_thirteen_digits_on_every_mesh() {
        let link = Link::new(LinkParts {
            segments: vec![Segment {
                bending_stiffness_n_m2: Taper { inner: 9.0, outer: 4.0 },
                mass_per_length_kg_m: Taper { inner: 0.9, outer: 0.7 },
                ..uniform_segment()
            }],
            hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.05, ..Hub::default() },
            payload: Payload { mass_kg: 0.1, inertia_kg_m2: 1e-3, offset_m: 0.02 },
            ..uniform()
        })
        .unwrap();
        for elements in [2, 10, 100, 1000, 4000] {
            let count = Some(ElementCount::Total(elements));
            let mesh =
                Mesh::new(&link, &MeshPlan::new(&link, &[None], count, 1e-6).unwrap()).unwrap();
            for (k, omega) in natural_frequencies(&mesh, 10).into_iter().enumerate() {
                let beside = |share: f64| {
                    let omega = Wide::from(omega) * (Wide::from(1.0) + share);
                    counted_in_106_bits(&mesh, omega * omega)
                };
                let counts = (beside(-1e-13), beside(1e-13));
                assert_eq!(counts, (k + 1, k + 2), "mode {} of {elements} elements", k + 1);
            }
        }
    }

    #[test]
    fn a_joint_without_stiffness_holds_no_hub() {
        let mesh = massless(0.1, 0.4);
        for stiffness in [0.0, -1.0, f64::NAN] {
            assert_eq!(held_frequencies(&mesh, stiffness, 2), natural_frequencies(&mesh, 2));
        }
    }
}

#[cfg(test)]
mod tests_of_inertia {
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

#[cfg(test)]
mod tests_of_zeros {
    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{
        Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper, uniform, uniform_segment,
    };
    use crate::modal::modes_below;
    use crate::numeric::Wide;

    #[test]
    fn a_search_from_anywhere_ends_a_power_of_two_from_there_around_the_mode() {
        let link = Link::new(uniform()).unwrap();
        let mesh = Mesh::on(&link, 4);
        let below = |omega: f64| HubSpring::CLAMPED.modes_below(&mesh, &[omega; SECTIONS])[0];
        for from_rad_s in [1e-9, 0.3, 1.0, 7.0, 300.0, 1e9] {
            for sought in [1, 3] {
                let (low, high) = HubSpring::CLAMPED.bracket(&mesh, sought, from_rad_s).unwrap();
                assert!(below(low) < sought && below(high) >= sought, "from {from_rad_s} rad/s");
                assert!((high / low - 2.0).abs() < 1e-15, "{low} and {high}");
                let octaves = (high / from_rad_s).log2();
                assert!((octaves - octaves.round()).abs() < 1e-9, "{octaves} from {from_rad_s}");
            }
        }
        assert_eq!(HubSpring::CLAMPED.bracket(&mesh, 9, 1.0), None, "eight modes are all");
    }

    /// The near scan finds the same zeros as the scan from far below, and begins next to them.
    #[test]
    fn real_zeros_are_sought_from_little_below_the_first() {
        let segment = |length_m, bending_stiffness, mass_per_length| Segment {
            length_m,
            bending_stiffness_n_m2: bending_stiffness,
            mass_per_length_kg_m: mass_per_length,
            ..uniform_segment()
        };
        let constant = Taper::constant;
        let taper = |inner, outer| Taper { inner, outer };
        let point = |at_m, mass_kg| LumpedMass { at_m, mass_kg, inertia_kg_m2: 0.0 };
        for segments in [
            vec![segment(1.5, constant(5.0), constant(0.8))],
            vec![segment(1.5, taper(9.0, 0.01), taper(0.1, 2.0))],
            vec![
                segment(0.3, constant(1e-3), constant(9.0)),
                segment(1.2, constant(5.0), constant(0.1)),
            ],
            vec![
                segment(1.2, constant(5.0), constant(0.1)),
                segment(0.3, constant(1e-3), constant(9.0)),
            ],
            vec![
                segment(0.7, constant(5.0), constant(0.0)),
                segment(0.8, constant(5.0), constant(0.8)),
            ],
        ] {
            for (radius_m, payload_kg, masses) in [
                (0.0, 0.0, vec![]),
                (0.4, 0.1, vec![point(1.0, 3.0)]),
                (0.0, 10.0, vec![point(0.1, 100.0)]),
            ] {
                let link = Link::new(LinkParts {
                    segments: segments.clone(),
                    hub: Hub { radius_m, ..uniform().hub },
                    payload: Payload { mass_kg: payload_kg, ..Payload::default() },
                    masses,
                    ..uniform()
                })
                .unwrap();
                for elements in [5, 7, 10, 40] {
                    let own = vec![None; segments.len()];
                    let total = Some(ElementCount::Total(elements));
                    let mesh = Mesh::new(&link, &MeshPlan::new(&link, &own, total, 1e-6).unwrap())
                        .unwrap();
                    let start = start_near_real_zeros(&mesh).unwrap();
                    let far = scan_start(&mesh).unwrap();
                    let displacements = |exponents: &_| displacements_m(&mesh, exponents);
                    let exact = changes(far, far * SCAN_RANGE, 2, displacements);
                    let found = torque_zeros(&mesh, 2);
                    let off = exact.iter().zip(&found).map(|(a, b)| (a / b - 1.0).abs());
                    assert_eq!(found.len(), exact.len(), "{segments:?}, {elements} elements");
                    let off = off.fold(0.0, f64::max);
                    assert!(off < 1e-11, "{found:?} are not {exact:?}");
                    assert!(
                        start < 0.51 * found[0] && start > 10.0 * far,
                        "{far}, {start}, {found:?}"
                    );
                }
            }
        }
    }

    /// The tip moves by less than 1e-13 of L around the last of these zeros.
    #[test]
    fn high_zeros_have_their_digits_where_the_tip_hardly_moves() {
        let link = Link::new(uniform()).unwrap();
        for elements in [10, 40, 400] {
            let mesh = Mesh::on(&link, elements);
            let zeros = torque_zeros(&mesh, 10);
            assert_eq!(zeros.len(), 10, "{elements} elements");
            for (k, zero) in zeros.into_iter().enumerate() {
                // In 106 bits.
                let is_negative = |share: f64| {
                    let z = Wide::from(zero) * (Wide::from(1.0) + share);
                    tip_displacement_m(&mesh, z * z * -1.0).nearest().re < 0.0
                };
                let sides = (is_negative(-1e-11), is_negative(1e-11));
                assert_eq!(sides, (k % 2 == 1, k % 2 == 0), "zero {k} of {elements} elements");
            }
        }
    }

    /// A body of 3 kg on a massless beam with 3EI/L³ = 3 N/m: it vibrates at exactly 1 rad/s behind a clamped hub, and
    /// at √(1 + 3) rad/s on a free hub of 1 kg m².
    #[test]
    fn modes_are_counted_where_what_the_hub_feels_is_infinite() {
        let segment = Segment {
            length_m: 1.0,
            bending_stiffness_n_m2: Taper::constant(1.0),
            mass_per_length_kg_m: Taper::constant(0.0),
            ..uniform_segment()
        };
        let parts = LinkParts {
            segments: vec![segment],
            hub: Hub { inertia_kg_m2: 1.0, ..Hub::default() },
            payload: Payload { mass_kg: 3.0, ..Payload::default() },
            ..uniform()
        };
        let link = Link::new(parts).unwrap();
        let mesh = Mesh::on(&link, 1);
        for (omega_rad_s, modes) in [(0.5, 1), (1.0, 1), (1.5, 1), (1.999_999, 1), (2.000_001, 2)] {
            assert_eq!(modes_below(&mesh, omega_rad_s), modes, "below {omega_rad_s} rad/s");
        }
    }
}
