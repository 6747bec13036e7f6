//! What the motor does behind a gear and an elastic joint, and limits on what the link does.

use super::{Smooth, link, solved};
use flexlink::inverse::Solution;
use flexlink::link::Drive;
use flexlink::result::{Limits, Metrics};

const STIFF: Drive =
    Drive { joint_stiffness_n_m_rad: f64::INFINITY, rotor_inertia_kg_m2: 0.0, gear_ratio: 1.0 };

fn close(found: &[f64], expected: impl Iterator<Item = f64>, tolerance: f64) {
    let expected: Vec<f64> = expected.collect();
    assert_eq!(found.len(), expected.len());
    let peak = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance * peak, "{found} is not {expected}");
    }
}

fn driven(drive: Drive) -> Solution {
    solved(&link(|parts| parts.drive = Some(drive)), 10, &Smooth::SHORT.motion())
}

#[test]
fn a_stiff_light_drive_without_a_gear_is_the_hub_itself() {
    let solution = driven(STIFF);
    let motor = solution.motor().unwrap();
    assert_eq!(motor.torque_n_m, solution.torque_n_m);
    assert_eq!(motor.angle_rad, solution.hub_angle_rad);
    assert_eq!(motor.rate_rad_s, solution.hub_rate_rad_s);
}

#[test]
fn a_gear_trades_torque_for_angle_and_keeps_the_power() {
    let solution = driven(Drive { gear_ratio: 50.0, ..STIFF });
    let motor = solution.motor().unwrap();
    close(&motor.torque_n_m, solution.torque_n_m.iter().map(|t| t / 50.0), 1e-14);
    close(&motor.angle_rad, solution.hub_angle_rad.iter().map(|a| 50.0 * a), 1e-14);
    let power = solution.torque_n_m.iter().zip(&solution.hub_rate_rad_s);
    close(&motor.power_w, power.map(|(t, rate)| t * rate), 1e-12);
}

#[test]
fn the_joint_twists_by_torque_over_stiffness_and_the_rotor_takes_its_share() {
    let solution = driven(Drive {
        joint_stiffness_n_m_rad: 20.0,
        rotor_inertia_kg_m2: 0.003,
        gear_ratio: 5.0,
    });
    let motor = solution.motor().unwrap();
    let twisted = solution.hub_angle_rad.iter().zip(&solution.torque_n_m);
    close(&motor.angle_rad, twisted.map(|(a, t)| 5.0 * (a + t / 20.0)), 1e-12);
    // Central differences of the angle, written apart from the spectra.
    let step_s = solution.grid.step_s;
    let rates = motor.angle_rad.windows(3).map(|a| (a[2] - a[0]) / (2.0 * step_s));
    close(&motor.rate_rad_s[1..motor.rate_rad_s.len() - 1], rates, 2e-3);
    let torques = motor
        .angle_rad
        .windows(3)
        .zip(&solution.torque_n_m[1..])
        .map(|(a, t)| t / 5.0 + 0.003 * (a[2] - 2.0 * a[1] + a[0]) / (step_s * step_s));
    close(&motor.torque_n_m[1..motor.torque_n_m.len() - 1], torques, 2e-3);
}

#[test]
fn only_exceeded_limits_are_told_with_their_numbers() {
    let solution = solved(&link(|_| ()), 10, &Smooth::SHORT.motion());
    let metrics = Metrics::of(&solution);
    let torque = metrics.peak_torque_n_m.value;
    let limits = Limits {
        torque_n_m: Some(0.5 * torque),
        hub_rate_rad_s: Some(2.0 * metrics.peak_hub_rate_rad_s.value),
        power_w: Some(0.9 * metrics.peak_power_w.value),
        ..Limits::default()
    };
    let exceeded = limits.exceeded(&metrics);
    let keys: Vec<&str> = exceeded.iter().map(|limit| limit.key).collect();
    assert_eq!(keys, ["torque", "power"]);
    let message = exceeded[0].to_string();
    let expected = format!("limits.torque = {} N m is exceeded: {torque:.4e} N m", 0.5 * torque);
    assert_eq!(message, expected);
}
