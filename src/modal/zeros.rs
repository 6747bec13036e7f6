use super::frequencies::HubSpring;
use super::inertia::{carries_rotary_inertia, outboard_degrees_of_freedom};
use crate::beam::{Mesh, tip_displacements_m};
use crate::numeric::{SECTIONS, geometric_scan, next_places, section};

/// Zeros that a solution reports.
pub const REPORTED_ZEROS: usize = 3;

/// Neighbouring points of the scan for zeros are this factor apart; neighbouring zeros of a
/// uniform link are a factor 5.4, 2.5, 1.9, … apart.
const SCAN_RATIO: f64 = 1.02;

/// The scan begins at this share of the first clamped mode.
const SCAN_START: f64 = 0.01;

/// The scan ends this factor above where it begins.
const SCAN_RANGE: f64 = 1e8;

/// The first `count` real zeros z of torque → tip in 1/s, ascending: the transfer vanishes at ±z.
///
/// They are the roots of `L + e_tip` at λ = −z². The torque that moves the tip grows as e^{z₁t}
/// before the motion and decays as e^{−z₁t} after it; that is why it must start early. Fewer than
/// `count` where the mesh has fewer. Rotary inertia on the link or at the tip can move zeros off
/// the real axis in pairs ±a ± ib; those are not among them.
pub fn torque_zeros(mesh: &Mesh, count: usize) -> Vec<f64> {
    let Some(start) = scan_start(mesh) else { return Vec::new() };
    let are_negative = |places: &[f64; SECTIONS]| {
        tip_displacements_m(mesh, &places.map(|z| -z * z)).map(f64::is_sign_negative)
    };
    changes(start, start * SCAN_RANGE, count, are_negative)
}

/// Zeros of torque → tip at real frequencies below `limit_rad_s`, in rad/s, ascending.
///
/// Rotary inertia at the tip or on the link, or an offset payload, causes them: at such a frequency
/// no torque moves the tip, and the torque that the inversion asks for grows as 1/ξ. They are the
/// roots of `L + e_tip` at λ = ω². Its sign flips at every mode of the link clamped at the hub too;
/// the number of these below ω is known from the pivots, so that only the zeros remain as changes
/// of parity.
pub fn real_frequency_zeros(mesh: &Mesh, limit_rad_s: f64) -> Vec<f64> {
    if !carries_rotary_inertia(mesh) {
        // Points of mass keep all zeros off the real frequencies.
        return Vec::new();
    }
    let Some(start) = scan_start(mesh) else { return Vec::new() };
    let are_odd = |places: &[f64; SECTIONS]| {
        let displacements = tip_displacements_m(mesh, &places.map(|omega| omega * omega));
        let modes = HubSpring::CLAMPED.modes_below(mesh, places);
        let is_odd = |k: usize| displacements[k].is_sign_negative() != (modes[k] % 2 == 1);
        std::array::from_fn(is_odd)
    };
    changes(start, limit_rad_s, usize::MAX, are_odd)
}

/// The first `count` places, from `start` up to `limit`, at which a property changes that is told of
/// sixteen places at a time.
fn changes(
    start: f64,
    limit: f64,
    count: usize,
    has: impl Fn(&[f64; SECTIONS]) -> [bool; SECTIONS],
) -> Vec<f64> {
    let mut scan = geometric_scan(start, SCAN_RATIO);
    let mut found = Vec::new();
    let mut previous: Option<(f64, bool)> = None;
    loop {
        let places = next_places(&mut scan);
        for (place, now) in places.into_iter().zip(has(&places)) {
            if place > limit || found.len() == count {
                return found;
            }
            if let Some((before, _)) = previous.filter(|(_, then)| *then != now) {
                found.push(section(before, place, |places| has(places).map(|x| x == now)));
            }
            previous = Some((place, now));
        }
    }
}

/// Where scans for zeros begin, in 1/s: far below the first mode of the link clamped at its hub,
/// which no zero is near. None where no mass is left to vibrate.
fn scan_start(mesh: &Mesh) -> Option<f64> {
    if outboard_degrees_of_freedom(mesh) == 0 {
        return None;
    }
    let first = HubSpring::CLAMPED.bracket(mesh, 1, 1.0)?.0;
    Some(SCAN_START * first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Hub, Link, LinkParts, Payload, Segment, Taper, uniform, uniform_segment};
    use crate::modal::modes_below;

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

    /// A body of 3 kg on a beam without mass and 3EI/L³ = 3 N/m: behind a held hub it swings at
    /// 1 rad/s, exactly, and on a free one of 1 kg m² at √(1 + 3) rad/s.
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
