//! What `modes`, `verify` and `trajectory --fit-limit` print.

use std::f64::consts::TAU;

use flexlink::beam::Mesh;
use flexlink::link::Link;
use flexlink::result::{
    Check, Fit, LimitedValue, LinkZeros, ModesResult, PoseModes, PoseSquares, Reached,
};
use flexlink::text::{digits_beyond, given, significant};
use flexlink::verify::Verification;

use super::runs::{link_line, title};

/// Modes, zeros and the modes with the hub or the rotor held.
pub(crate) fn modes_text(link: &Link, mesh: &Mesh, result: &ModesResult) -> String {
    let mut lines = vec![link_line(link, mesh)];
    let without = if link.drive().is_some() { ", without the rotor" } else { "" };
    lines.push(format!("hub free{without}"));
    lines.extend(mode_rows(&result.omega_rad_s, &result.damping_ratios, &result.mesh_errors));
    lines.extend(zero_rows(&result.zeros));
    lines.push(hub_held(link));
    let held = &result.held;
    lines.extend(mode_rows(&held.omega_rad_s, &held.damping_ratios, &held.mesh_errors));
    title(link.title()) + &lines.join("\n") + "\n"
}

/// A heading, then a row a zero, and a line for each frequency at which no torque moves the tip.
pub(super) fn zero_rows(found: &LinkZeros) -> Vec<String> {
    let mut lines = vec![row(["zero", "±[1/s]", "lead to 1 % [s]", "", "", MESH_ERROR])];
    let zeros = found.zeros_per_s.iter().zip(found.leads_s()).zip(&found.mesh_errors);
    for (number, ((zero, lead), error)) in (1..).zip(zeros) {
        let [zero, lead] = [significant(*zero, 8), significant(lead, 4)];
        lines.push(row([&format!("{number}"), &zero, &lead, "", "", &share(*error)]));
    }
    for (hertz, error) in found.blocked_hz.iter().zip(&found.blocked_mesh_errors) {
        let hertz = significant(*hertz, 8);
        let error = share(*error);
        let error = if error.is_empty() { error } else { format!(" (mesh error {error})") };
        lines.push(format!("at {hertz} Hz no torque moves the tip{error}"));
    }
    lines
}

/// Modes in a pose, hub free and held.
pub(crate) fn pose_text(link: &Link, mesh: &Mesh, pose: &PoseModes) -> String {
    let [angle, pull] = [pose.angle_rad, pose.outward_m_s2.abs()].map(|x| significant(x, 4));
    let towards = if pose.outward_m_s2 < 0.0 { "inward" } else { "outward" };
    let mut lines = vec![
        link_line(link, mesh),
        format!("at {angle} rad gravity pulls by {pull} m/s² {towards} along the link"),
        "hub free; mode 0 is the swing of the whole link".to_owned(),
    ];
    lines.extend(pose_rows(0, &pose.free));
    lines.push(hub_held(link));
    lines.extend(pose_rows(1, &pose.held));
    title(link.title()) + &lines.join("\n") + "\n"
}

/// What holds the hub.
fn hub_held(link: &Link) -> String {
    match link.drive().map(|drive| drive.joint_stiffness_n_m_rad) {
        None => "hub held".into(),
        Some(stiffness) if stiffness.is_finite() => {
            format!("rotor held, joint spring {} N m/rad", significant(stiffness, 4))
        }
        Some(_) => "rotor held, stiff joint".into(),
    }
}

fn pose_rows(first: usize, found: &PoseSquares) -> Vec<String> {
    let heading = row(["mode", "omega [rad/s]", "frequency [Hz]", "period [s]", "", MESH_ERROR]);
    let modes = found.squares_per_s2.iter().zip(&found.mesh_errors).enumerate();
    let modes = modes.map(|(k, (square, error))| {
        let (number, size) = ((first + k).to_string(), square.abs().sqrt());
        unsteady(&number, *square, "link").unwrap_or_else(|| {
            let [omega, hertz, period] = [size, size / TAU, TAU / size].map(|x| significant(x, 8));
            row([&number, &omega, &hertz, &period, "", &share(*error)])
        })
    });
    std::iter::once(heading).chain(modes).collect()
}

/// A mode that does not vibrate, in words; `what` is a link or an arm.
pub(super) fn unsteady(number: &str, square_per_s2: f64, what: &str) -> Option<String> {
    if square_per_s2 == 0.0 {
        return Some(format!("{number:<6} neutral: the {what} stays where it is turned"));
    }
    let time = significant(square_per_s2.abs().sqrt().recip(), 4);
    let falls = format!("{number:<6} not stable: it leaves the pose as e^(t/{time} s)");
    (square_per_s2 < 0.0).then_some(falls)
}

pub(super) const MESH_ERROR: &str = "mesh error";

/// A heading, then a row a mode, with its damping ratio where it vibrates.
fn mode_rows(omega_rad_s: &[f64], damping_ratios: &[f64], mesh_errors: &[f64]) -> Vec<String> {
    let heading = ["mode", "omega [rad/s]", "frequency [Hz]", "period [s]", "damping", MESH_ERROR];
    let modes = omega_rad_s.iter().zip(mesh_errors).enumerate().map(|(mode, (omega, error))| {
        let [omega, hertz, period] = [*omega, omega / TAU, TAU / omega].map(|x| significant(x, 8));
        let ratio = damping_ratios[mode];
        let ratio = if ratio.is_nan() { "none".to_owned() } else { significant(ratio, 4) };
        row([&format!("{}", mode + 1), &omega, &hertz, &period, &ratio, &share(*error)])
    });
    std::iter::once(row(heading)).chain(modes).collect()
}

/// A relative error; below what the iterations leave open, a bound. Empty where it is not known.
pub(super) fn share(error: f64) -> String {
    const KNOWN_TO: f64 = 1e-12;
    match error {
        _ if error.is_nan() => String::new(),
        _ if error < KNOWN_TO => format!("< {KNOWN_TO:e}"),
        _ => format!("{error:.1e}"),
    }
}

fn row([number, a, b, c, d, e]: [&str; 6]) -> String {
    format!("{number:<6} {a:>13} {b:>15} {c:>13} {d:>10} {e:>11}").trim_end().to_owned()
}

/// A line for each check.
pub(crate) fn verify_text(verification: &Verification) -> String {
    let header = format!("{:<34} {:>9}   {:>9}   of", "check", "found", "at most");
    let lines = verification.checks.iter().map(check_line);
    std::iter::once(header).chain(lines).map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// Numbers below it are round-off, another one on every machine.
const ROUND_OFF: f64 = 1e-9;

fn check_line(check: &Check) -> String {
    let what = &check.what;
    match check.found.zip(check.bound) {
        Some((found, bound)) => {
            let verdict = if check.passes { "" } else { "  FAILS" };
            let found = if found <= ROUND_OFF {
                format!("< {ROUND_OFF:.0e}")
            } else if found >= bound && check.passes {
                format!("< {bound:.1e}")
            } else {
                // The column has no place for more decimals.
                format!("{found:.0$e}", digits_beyond(found, bound) - 1)
            };
            format!("{what:<34} {found:>9}   {bound:>9.1e}   {}{verdict}", check.of)
        }
        None => format!("{what:<34} not made: {}", check.reason.as_deref().unwrap_or_default()),
    }
}

/// How a duration was found among those that were tried, with all limits that it is within.
pub(crate) fn found_text<S>(fit: &Fit<S>, values: &[LimitedValue]) -> String {
    let each = values.iter().map(|value| {
        let LimitedValue { joint, key, limit, unit, .. } = *value;
        format!("{}{key}={} {unit}", of_joint(joint), given(limit))
    });
    let within = each.collect::<Vec<_>>().join(", ");
    if fit.is_shortest() {
        return format!("the shortest duration within {within}");
    }
    let (tried, shorter) = (fit.shorter_tried, fit.shorter());
    format!("within {within}; {tried} of the {shorter} shorter durations were tried, none fits")
}

fn of_joint(joint: Option<usize>) -> String {
    joint.map_or(String::new(), |joint| format!("joint {} ", joint + 1))
}

/// Which limit a motion comes closest to, and by how much.
pub(crate) fn binding_text<S>(fit: &Fit<S>) -> String {
    if fit.has_fewest_steps() {
        return "; no limit binds: the profile has no fewer steps".to_owned();
    }
    if let Some(error) = &fit.unsolved {
        return format!("; no limit binds: with a step less, {error}");
    }
    let Some(binding) = fit.binding else { return String::new() };
    let below = 100.0 * (1.0 - binding.share());
    let below = if below < 0.01 { "less than 0.01".to_owned() } else { format!("{below:.2}") };
    let Reached { value, error } = binding;
    let (key, unit) = (value.key, value.unit);
    let (found, limit) = (significant(value.found, 5), given(value.limit));
    let error = format!("{below} % below it with its error of {error:.1e} added");
    let of = of_joint(value.joint);
    format!("; {of}limits.{key} binds: {found} {unit} of {limit} {unit}, {error}")
}
