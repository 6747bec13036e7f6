use super::frequencies::{
    HubSpring, SEARCH_LIMIT_RAD_S, outboard_degrees_of_freedom, zeros_may_leave_the_real_axis,
};
use crate::beam::{Mesh, hub_response, tip_displacement_m, tip_displacements_m};
use crate::numeric::{SECTIONS, geometric_scan, next_places, root};

/// Number of zeros in the report of a solution.
pub const REPORTED_ZEROS: usize = 3;

/// Ratio of neighbouring points in the scan for zeros; neighbouring zeros of a uniform link are a factor 5.4, 2.5, 1.9,
/// … apart.
const SCAN_RATIO: f64 = 1.02;

/// Start of the scan as a share of the first clamped mode.
const SCAN_START: f64 = 0.01;

/// End of the scan as a multiple of its start.
const SCAN_RANGE: f64 = 1e8;

/// Relative change on halved elements below which a zero of a beam with shear belongs to the link. Zeros of the mesh
/// alone change by a factor of about two.
const SETTLED: f64 = 0.2;

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
    let mut found = all(mesh);
    if mesh.has_shear() && !found.is_empty() {
        let finer = all(&mesh.refined());
        found.retain(|zero| finer.iter().any(|finer| (zero / finer - 1.0).abs() < SETTLED));
    }
    found
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
fn changes(
    start: f64,
    limit: f64,
    count: usize,
    values: impl Fn(&[f64; SECTIONS]) -> [f64; SECTIONS],
) -> Vec<f64> {
    let mut scan = geometric_scan(start, SCAN_RATIO);
    let mut found = Vec::new();
    let mut previous: Option<(f64, f64)> = None;
    loop {
        let places = next_places(&mut scan);
        for now in places.into_iter().zip(values(&places)) {
            if now.0 > limit || found.len() == count {
                return found;
            }
            let is_other =
                |then: &(f64, f64)| then.1.is_sign_negative() != now.1.is_sign_negative();
            if let Some(before) = previous.filter(is_other) {
                found.push(root(before, now, &values));
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
    let start = NEAR * (mesh.length_m() / lag_m_s2).sqrt();
    let is_below = tip_displacement_m(mesh, -start * start) > 0.0;
    Some(start).filter(|start| start.is_finite() && is_below)
}

/// Start of other scans for zeros in 1/s: far below the first mode of the link clamped at its hub, where no zero is
/// near. `None` if the search for that mode fails.
fn scan_start(mesh: &Mesh) -> Option<f64> {
    let first = HubSpring::CLAMPED.bracket(mesh, 1, 1.0)?.0;
    Some(SCAN_START * first)
}

#[cfg(test)]
mod tests {
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
