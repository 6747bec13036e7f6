//! What the motor does behind a gear and an elastic joint, and limits on what the link does.

use std::f64::consts::TAU;

use super::{Smooth, link, plan_of, solved};
use crate::common::peak;
use flexlink::inverse::{Analysis, InversionError, Solution, invert};
use flexlink::link::{Damping, Drive, Taper};
use flexlink::motion::Profile;
use flexlink::result::{JointMetrics, Limits, Metrics, Peak};
use flexlink::text::significant;

const STIFF: Drive = Drive::DIRECT;

fn close(found: &[f64], expected: impl Iterator<Item = f64>, tolerance: f64) {
    let expected: Vec<f64> = expected.collect();
    assert_eq!(found.len(), expected.len());
    let peak = peak(&expected);
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
    let motor = solution.hub().motor.as_ref().unwrap();
    assert_eq!(motor.torque_n_m, solution.hub().torque_n_m);
    assert_eq!(motor.angle_rad, solution.hub().angle_rad);
    assert_eq!(motor.rate_rad_s, solution.hub().rate_rad_s);
    let metrics = *Metrics::of(&solution).hub();
    let motor = metrics.motor.unwrap();
    assert_eq!(motor.peaks.peak_torque_n_m, metrics.peak_torque_n_m);
    assert_eq!((motor.peaks.peak_rate_rad_s, motor.peaks.peak_power_w), hub_peaks(&metrics));
    assert!((motor.rms_torque_n_m / metrics.rms_torque_n_m - 1.0).abs() < 1e-15);
}

/// A stiff link that begins and ends at rest turns at (A/ω)(1 − cos ωt) with the torque J A sin ωt. Their product has
/// the mean square (J A²/ω)² · 5/8 over the period, and acts while the torque exceeds 2 % of its peak.
#[test]
fn the_rms_power_of_a_stiff_link_is_that_of_a_sine() {
    let stiff = link(|parts| parts.segments[0].bending_stiffness_n_m2 = Taper::constant(1e9));
    let (travel_m, samples) = (0.5, 4000);
    let motion = Profile::Sine.motion(travel_m, 0.88, samples).unwrap();
    let solution = solved(&stiff, 4, &motion);
    let metrics = *Metrics::of(&solution).hub();
    let omega = TAU / 0.88;
    // Travel of the arc in radians: A (2π/ω)/ω.
    let amplitude = travel_m / stiff.length_m() * omega * omega / TAU;
    let outside = 2.0 * 0.02_f64.asin() / TAU;
    let power = stiff.rigid_inertia_kg_m2() * amplitude * amplitude / omega;
    let expected = power * (0.625 / (1.0 - outside)).sqrt();
    assert!((metrics.rms_power_w / expected - 1.0).abs() < 1e-3, "{metrics:?} {expected}");
}

fn hub_peaks(metrics: &JointMetrics) -> (Peak, Peak) {
    (metrics.peak_hub_rate_rad_s, metrics.peak_power_w)
}

#[test]
fn a_link_without_a_drive_has_no_motor() {
    let solution = solved(&link(|_| ()), 10, &Smooth::SHORT.motion());
    assert!(solution.hub().motor.is_none() && Metrics::of(&solution).hub().motor.is_none());
}

#[test]
fn a_motor_that_leaves_double_precision_is_an_error() {
    // A torque of 1e98 N m in 3 ms on a spring of 1e-30 N m/rad, before a rotor of 1e30 kg m².
    let drive = Drive {
        joint_stiffness_n_m_rad: 1e-30,
        rotor_inertia_kg_m2: 1e30,
        gear_ratio: 1e6,
        ..Drive::DIRECT
    };
    let far = Smooth { travel_m: 1e92, duration_s: 3e-3, ..Smooth::SHORT }.motion();
    let driven = link(|parts| parts.drive = Some(drive));
    let error = invert(&driven, &plan_of(&driven, 10), &far, &Analysis::default());
    let Err(InversionError::MotorNotFinite { history }) = error else {
        panic!("{:?}", error.err());
    };
    assert_eq!(history, "power");
}

#[test]
fn a_gear_trades_torque_for_angle_and_keeps_the_power() {
    let solution = driven(Drive { gear_ratio: 50.0, ..STIFF });
    let motor = solution.hub().motor.as_ref().unwrap();
    close(&motor.torque_n_m, solution.hub().torque_n_m.iter().map(|t| t / 50.0), 1e-14);
    close(&motor.angle_rad, solution.hub().angle_rad.iter().map(|a| 50.0 * a), 1e-14);
    let power = solution.hub().torque_n_m.iter().zip(&solution.hub().rate_rad_s);
    close(&motor.power_w, power.map(|(t, rate)| t * rate), 1e-12);
}

/// Friction and the slow tails of hysteretic damping included.
#[test]
fn the_joint_twists_by_torque_over_stiffness_and_the_rotor_takes_its_share() {
    let drive = Drive {
        joint_stiffness_n_m_rad: 20.0,
        rotor_inertia_kg_m2: 0.003,
        gear_ratio: 5.0,
        ..Drive::DIRECT
    };
    let driven = link(|parts| {
        parts.drive = Some(drive);
        parts.damping = Damping::Hysteretic { ratio: 0.02 };
        parts.hub.viscous_friction_n_m_s_rad = 5.0;
    });
    let solution = solved(&driven, 10, &Smooth::SHORT.motion());
    let motor = solution.hub().motor.as_ref().unwrap();
    let twisted = solution.hub().angle_rad.iter().zip(&solution.hub().torque_n_m);
    close(&motor.angle_rad, twisted.map(|(a, t)| 5.0 * (a + t / 20.0)), 1e-12);
    // Central differences of the angle, written apart from the spectra.
    let step_s = solution.grid.step_s;
    let rates = motor.angle_rad.windows(3).map(|a| (a[2] - a[0]) / (2.0 * step_s));
    close(&motor.rate_rad_s[1..motor.rate_rad_s.len() - 1], rates, 2e-3);
    let torques = motor
        .angle_rad
        .windows(3)
        .zip(&solution.hub().torque_n_m[1..])
        .map(|(a, t)| t / 5.0 + 0.003 * (a[2] - 2.0 * a[1] + a[0]) / (step_s * step_s));
    close(&motor.torque_n_m[1..motor.torque_n_m.len() - 1], torques, 2e-3);
}

#[test]
fn only_exceeded_limits_are_told_with_their_numbers() {
    let solution = solved(&link(|_| ()), 10, &Smooth::SHORT.motion());
    let found = Metrics::of(&solution);
    let metrics = found.hub();
    let torque = metrics.peak_torque_n_m.value;
    let limits = Limits::new([
        ("torque", 0.5 * torque),
        ("hub_rate", 2.0 * metrics.peak_hub_rate_rad_s.value),
        ("power", 0.9 * metrics.peak_power_w.value),
    ]);
    let limits = limits.unwrap();
    let exceeded = found.exceeded(&[limits]);
    let keys: Vec<&str> = exceeded.iter().map(|limit| limit.0.key).collect();
    assert_eq!(keys, ["torque", "power"]);
    let message = exceeded[0].to_string();
    let expected = format!(
        "limits.torque = {} N m is exceeded at the hub: {} N m",
        significant(0.5 * torque, 6),
        significant(torque, 5)
    );
    assert_eq!(message, expected);
}

/// A drive with losses and constants, whose losses change sign by a small rate.
const LOSSY: Drive = Drive {
    rotor_inertia_kg_m2: 0.002,
    gear_ratio: 5.0,
    efficiency: 0.8,
    coulomb_friction_n_m: 0.3,
    friction_rate_rad_s: Some(1e-3),
    torque_constant_n_m_a: Some(0.05),
    resistance_ohm: Some(1.5),
    ..STIFF
};

/// A hub that turns far faster than the friction's rate has all of the losses: (T + τ)/η while the power flows to the
/// joint, η (T + τ) while it flows back. The gear's losses and the friction's heat are the motor's work less the joint's.
#[test]
fn losses_of_friction_and_gear_are_the_motors_work_less_the_joints() {
    let solution = driven(LOSSY);
    let (hub, step_s) = (solution.hub(), solution.grid.step_s);
    let motor = hub.motor.as_ref().unwrap();
    let ideal = driven(Drive { coulomb_friction_n_m: 0.0, efficiency: 1.0, ..LOSSY });
    let ideal = &ideal.hub().motor.as_ref().unwrap().torque_n_m;
    let (mut phases, mut heat_j, mut work_j) = ([0, 0], 0.0, 0.0);
    for (k, own) in ideal.iter().enumerate() {
        let (torque, rate) = (hub.torque_n_m[k], hub.rate_rad_s[k]);
        let motor_n_m = motor.torque_n_m[k];
        // The ideal motor turns the same joint and the same rotor.
        work_j += step_s * (motor_n_m - own) * motor.rate_rad_s[k];
        if rate.abs() < 0.02 {
            heat_j += step_s * (motor_n_m - own) * motor.rate_rad_s[k];
            continue;
        }
        let loaded = torque + 0.3 * rate.signum();
        let (is_braking, factor) = if loaded * rate > 0.0 { (0, 1.25) } else { (1, 0.8) };
        phases[is_braking] += 1;
        let expected = own + (factor * loaded - torque) / 5.0;
        assert!((motor_n_m - expected).abs() < 1e-12, "{k}: {motor_n_m} is not {expected}");
        heat_j += step_s * (0.3 * rate.abs() + (factor - 1.0) * loaded * rate);
        let (current_a, voltage_v) = (motor_n_m / 0.05, 30.0 * motor_n_m + 0.25 * rate);
        assert!((motor.current_a.as_ref().unwrap()[k] - current_a).abs() < 1e-12 * current_a.abs());
        assert!((motor.voltage_v.as_ref().unwrap()[k] - voltage_v).abs() < 1e-9);
    }
    assert!(phases.iter().all(|samples| *samples > 20), "it drives and brakes: {phases:?}");
    assert!(work_j > 0.05 && (work_j / heat_j - 1.0).abs() < 1e-9, "{work_j} {heat_j}");
    let metrics = Metrics::of(&solution).hub().motor.unwrap();
    let current_a = metrics.peaks.peak_current_a.unwrap().value;
    assert!((current_a / (metrics.peaks.peak_torque_n_m.value / 0.05) - 1.0).abs() < 1e-12);
    assert!(metrics.peaks.peak_voltage_v.unwrap().value >= peak(motor.voltage_v.as_ref().unwrap()));
}

/// On a mesh of two elements the torque is off by more than rounding: the written error of the motor's torque must
/// cover the change on a fine mesh.
#[test]
fn the_error_of_a_motor_with_losses_covers_its_change_on_a_finer_mesh() {
    let lossy = Drive { friction_rate_rad_s: Some(0.05), ..LOSSY };
    let on = |elements| {
        solved(&link(|parts| parts.drive = Some(lossy)), elements, &Smooth::SHORT.motion())
    };
    let (coarse, fine) = (on(4), on(64));
    let lead = usize::try_from(coarse.grid.first - fine.grid.first).unwrap_or(0);
    let late = usize::try_from(fine.grid.first - coarse.grid.first).unwrap_or(0);
    let of = |solution: &Solution, from: usize| {
        solution.hub().motor.as_ref().unwrap().torque_n_m[from..].to_vec()
    };
    let pairs = of(&coarse, late).into_iter().zip(of(&fine, lead));
    let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = peak(&of(&fine, 0));
    let errors = coarse.hub().errors;
    let (lossy, linear) = (errors.motor_torque.unwrap().mesh, errors.motor_rate.unwrap().mesh);
    assert!(apart / size <= 1.1 * lossy, "{} of {lossy}", apart / size);
    assert!(apart / size > 0.05 * lossy && lossy > linear, "{} of {lossy}", apart / size);
}

#[test]
fn without_friction_and_with_an_ideal_gear_no_bit_changes() {
    let plain = Drive { rotor_inertia_kg_m2: 0.002, gear_ratio: 5.0, ..STIFF };
    let (own, plain) = (driven(Drive { friction_rate_rad_s: Some(1e-3), ..plain }), driven(plain));
    assert_eq!(own.hub(), plain.hub());
}

#[test]
fn limits_of_current_and_voltage_need_the_motors_constants() {
    let refused = |key: &str, drive: Drive| {
        let limits = Limits::new([(key, 2.0)]).unwrap();
        limits.check(Some(&drive)).map_err(|error| error.to_string())
    };
    let current = Drive { resistance_ohm: None, ..LOSSY };
    assert!(refused("motor_current", current).is_ok() && refused("motor_voltage", LOSSY).is_ok());
    assert_eq!(
        refused("motor_voltage", current).unwrap_err(),
        "limits.motor_voltage = 2 V, but must come with drive.torque_constant and drive.resistance"
    );
    assert_eq!(
        refused("motor_current", STIFF).unwrap_err(),
        "limits.motor_current = 2 A, but must come with drive.torque_constant"
    );
    let found = Metrics::of(&driven(LOSSY));
    let exceeded = found.exceeded(&[Limits::new([("motor_current", 1e-3)]).unwrap()]);
    assert_eq!(exceeded[0].0.key, "motor_current");
}
