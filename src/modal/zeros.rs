use crate::beam::{Mesh, condense, hub_response};
use crate::numeric::{bisect, geometric_scan};

/// Neighbouring points of the scan for zeros are this factor apart; neighbouring zeros of a
/// uniform link are a factor 5.4, 2.5, 1.9, … apart.
const SCAN_RATIO: f64 = 1.02;

/// The scan ends this factor above where it begins.
const SCAN_RANGE: f64 = 1e7;

/// The first `count` zeros z of torque → tip in 1/s, ascending: the transfer vanishes at ±z.
///
/// They are the roots of `L + e_tip` at λ = −z². The torque that moves the tip grows as e^{z₁t}
/// before the motion and decays as e^{−z₁t} after it; that is why it must start early. Fewer than
/// `count` where the mesh has fewer.
pub fn torque_zeros(mesh: &Mesh, count: usize) -> Vec<f64> {
    let tip = |z: f64| hub_response(mesh, -z * z).tip_displacement_m(mesh, -z * z);
    let start = 0.1 * slowest_rate(mesh);
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
/// A payload's rotary inertia or offset causes them: at such a frequency no torque moves the tip,
/// and the torque that the inversion asks for grows as 1/ξ. They are the roots of `L + e_tip` at
/// λ = ω². Its sign flips at every mode of the link clamped at the hub too; the number of these
/// below ω is known from the pivots, so that only the zeros remain as changes of parity.
pub fn real_frequency_zeros(mesh: &Mesh, limit_rad_s: f64) -> Vec<f64> {
    let tip = mesh.tip_inertia();
    if tip.pp == 0.0 {
        // A point payload keeps all zeros off the real frequencies.
        return Vec::new();
    }
    let is_odd = |omega: f64| {
        let lambda = omega * omega;
        let mut clamped_modes = 0;
        condense(mesh, lambda, |_, step| {
            clamped_modes += step.pivots.iter().filter(|p| **p < 0.0).count();
        });
        let displacement = hub_response(mesh, lambda).tip_displacement_m(mesh, lambda);
        displacement.is_sign_negative() != (clamped_modes % 2 == 1)
    };
    let start = 0.1 * slowest_rate(mesh);
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

/// A rate in 1/s below every clamped mode and every zero: `(L + e_tip)/L = 1 + λ/rate² + O(λ²)`.
fn slowest_rate(mesh: &Mesh) -> f64 {
    let static_lag = hub_response(mesh, 0.0).lag_m_s2 / mesh.length_m();
    if static_lag == 0.0 { 1.0 } else { static_lag.abs().recip().sqrt() }
}
