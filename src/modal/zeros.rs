use super::frequencies::HubSpring;
use super::inertia::{carries_rotary_inertia, outboard_degrees_of_freedom};
use crate::beam::{Mesh, hub_response};
use crate::numeric::{bisect, geometric_scan};

/// Neighbouring points of the scan for zeros are this factor apart; neighbouring zeros of a
/// uniform link are a factor 5.4, 2.5, 1.9, … apart.
const SCAN_RATIO: f64 = 1.02;

/// The scan begins at this share of the first clamped mode.
const SCAN_START: f64 = 0.01;

/// Fastest rate that is searched for a clamped mode, in 1/s: no link of this world comes near.
const SEARCH_LIMIT_PER_S: f64 = 1e15;

/// The scan ends this factor above where it begins.
const SCAN_RANGE: f64 = 1e8;

/// The first `count` real zeros z of torque → tip in 1/s, ascending: the transfer vanishes at ±z.
///
/// They are the roots of `L + e_tip` at λ = −z². The torque that moves the tip grows as e^{z₁t}
/// before the motion and decays as e^{−z₁t} after it; that is why it must start early. Fewer than
/// `count` where the mesh has fewer. Rotary inertia on the link or at the tip can move zeros off
/// the real axis in pairs ±a ± ib; those are not among them.
pub fn torque_zeros(mesh: &Mesh, count: usize) -> Vec<f64> {
    let tip = |z: f64| hub_response(mesh, -z * z).tip_displacement_m(mesh, -z * z);
    let Some(start) = scan_start(mesh) else { return Vec::new() };
    let mut zeros = Vec::with_capacity(count);
    let mut previous = (start, tip(start));
    for z in geometric_scan(start * SCAN_RATIO, start * SCAN_RANGE, SCAN_RATIO) {
        if zeros.len() == count {
            break;
        }
        let value = tip(z);
        if value.is_sign_negative() != previous.1.is_sign_negative() {
            let negative = value.is_sign_negative();
            zeros.push(bisect(previous.0, z, |z| tip(z).is_sign_negative() == negative));
        }
        previous = (z, value);
    }
    zeros
}

/// Zeros of torque → tip at real frequencies below `limit_rad_s`, in rad/s, ascending.
///
/// Rotary inertia at the tip or on the link, or an offset payload, causes them: at such a frequency no torque moves the tip,
/// and the torque that the inversion asks for grows as 1/ξ. They are the roots of `L + e_tip` at
/// λ = ω². Its sign flips at every mode of the link clamped at the hub too; the number of these
/// below ω is known from the pivots, so that only the zeros remain as changes of parity.
pub fn real_frequency_zeros(mesh: &Mesh, limit_rad_s: f64) -> Vec<f64> {
    if !carries_rotary_inertia(mesh) {
        // Points of mass keep all zeros off the real frequencies.
        return Vec::new();
    }
    let is_odd = |omega: f64| {
        let lambda = omega * omega;
        let displacement = hub_response(mesh, lambda).tip_displacement_m(mesh, lambda);
        displacement.is_sign_negative() != (HubSpring::CLAMPED.modes_below(mesh, omega) % 2 == 1)
    };
    let Some(start) = scan_start(mesh) else { return Vec::new() };
    let mut zeros = Vec::new();
    let mut previous = (start, is_odd(start));
    for omega in geometric_scan(start * SCAN_RATIO, limit_rad_s, SCAN_RATIO) {
        let odd = is_odd(omega);
        if odd != previous.1 {
            zeros.push(bisect(previous.0, omega, |w| is_odd(w) == odd));
        }
        previous = (omega, odd);
    }
    zeros
}

/// Where scans for zeros begin, in 1/s: far below the first mode of the link clamped at its hub,
/// which no zero is near. None where no mass is left to vibrate.
fn scan_start(mesh: &Mesh) -> Option<f64> {
    if outboard_degrees_of_freedom(mesh) == 0 {
        return None;
    }
    let mut first = 1.0;
    while HubSpring::CLAMPED.modes_below(mesh, first) == 0 {
        first *= 2.0;
        if first > SEARCH_LIMIT_PER_S {
            return None;
        }
    }
    while HubSpring::CLAMPED.modes_below(mesh, first) > 0 {
        first *= 0.5;
    }
    Some(SCAN_START * first)
}
