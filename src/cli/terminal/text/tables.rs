//! Output of `modes`, `verify` and `trajectory --fit-limit`.

use std::f64::consts::TAU;

use super::lines::{four, gravity_line, link_line, size_line, title};
use crate::link::{Arm, Joint};
use crate::response::SettledModes;
use crate::result::{Check, Fit, LimitedValue, LinkZeros, ModesResult, Reached, Setting};
use crate::text::{digits_beyond, given, significant};
use crate::verify::Verification;

/// Modes of a link or an arm with free and with held joints, and zeros of its links.
pub(crate) fn modes_text(arm: &Arm, found: &ModesResult) -> String {
    let link = &arm.links()[0].link;
    let list = |values: &[f64]| {
        values.iter().map(|own| significant(*own, 4)).collect::<Vec<_>>().join(", ")
    };
    let meshes = arm.pick(&found.meshes[..], &[]).iter();
    let mut lines: Vec<String> = meshes.map(|mesh| link_line(link, mesh)).collect();
    let slides = link.joint().slides();
    match &found.setting {
        Setting::Weightless => {
            let without = if link.drive().is_some() { ", without the rotor" } else { "" };
            lines.push(link.joint().worded(&format!("hub free{without}")));
        }
        Setting::Straight { angle_rad, outward_m_s2, .. } => {
            let [angle, pull] = four([*angle_rad, outward_m_s2.abs()]);
            let towards = if *outward_m_s2 < 0.0 { "inward" } else { "outward" };
            lines.push(format!(
                "at {angle} rad gravity pulls by {pull} m/s² {towards} along the link"
            ));
            let swing = if slides { "" } else { "; mode 0 is the swing of the whole link" };
            lines.push(link.joint().worded(&format!("hub free{swing}")));
        }
        Setting::AtRest { directions_rad, tip_m, holding_torques_n_m } => {
            let (size, directions) = (size_line(arm), list(directions_rad));
            lines.push(format!("arm of {size}; the links point to {directions} rad"));
            lines.push(format!("the tip rests at {} m", list(tip_m)));
            lines.extend(arm.carriage().map(|_| "the carriage is held at 0".to_owned()));
            if arm.has_weight() {
                let (gravity, torques) = (gravity_line(arm), list(holding_torques_n_m));
                lines.push(format!("gravity {gravity}; {torques} N m hold the joints at rest"));
            }
            let swings = arm.links().len();
            lines.push(format!("joints free; the first {swings} are swings of the whole arm"));
        }
    }
    // The swing of one link is mode 0.
    let is_straight = matches!(found.setting, Setting::Straight { .. });
    let first = usize::from(slides || !is_straight);
    lines.extend(mode_rows(arm, found, &found.free, first));
    if found.setting == Setting::Weightless || slides {
        let rows = found.zeros.iter().flat_map(|zeros| zero_rows(zeros, &link.joint()));
        lines.extend(rows.map(|line| arm.of_output(line)));
    }
    lines.push(link.joint().worded(&joints_held(arm)));
    lines.extend(mode_rows(arm, found, &found.held, 1));
    if matches!(found.setting, Setting::AtRest { .. }) {
        for (number, zeros) in found.zeros.iter().enumerate() {
            lines.push(format!("{}, from its joint to its tip", arm.name_of(number)));
            lines.extend(zero_rows(zeros, &link.joint()));
        }
    }
    title(arm.title()) + &lines.join("\n") + "\n"
}

/// A heading, then a row for each zero, and a line for each blocked frequency: no torque moves the tip there.
fn zero_rows(found: &LinkZeros, joint: &Joint) -> Vec<String> {
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
        lines.push(joint.worded(&format!("at {hertz} Hz no torque moves the tip{error}")));
    }
    lines
}

/// Restraint of a link's hub, or of an arm's rotors.
fn joints_held(arm: &Arm) -> String {
    let springs = arm.joint_stiffnesses_n_m_rad();
    let [rotors, joints] = arm.pick(["rotor", "joint"], ["rotors", "joints"]);
    let spring = arm.pick("spring", "springs");
    if arm.alone().is_some_and(|link| link.drive().is_none()) {
        return "hub held".into();
    }
    if springs.iter().all(|own| own.is_infinite()) {
        return format!("{rotors} held, stiff {joints}");
    }
    let each = springs
        .iter()
        .map(|own| if own.is_finite() { significant(*own, 4) } else { "stiff".into() });
    let each = each.collect::<Vec<_>>().join(", ");
    format!("{rotors} held, joint {spring} {each} N m/rad")
}

/// A mode that does not vibrate, in words; `what` is a link or an arm.
fn unsteady(number: &str, square_per_s2: f64, what: &str) -> Option<String> {
    if square_per_s2 == 0.0 {
        return Some(format!("{number:<6} neutral: the {what} stays where it is turned"));
    }
    let time = significant(square_per_s2.abs().sqrt().recip(), 4);
    let falls = format!("{number:<6} not stable: it leaves the pose as e^(t/{time} s)");
    (square_per_s2 < 0.0).then_some(falls)
}

const MESH_ERROR: &str = "mesh error";

/// A heading, then a row for each mode: for a link with its period, for an arm with the turn of each joint, unless all
/// are 0.
fn mode_rows(arm: &Arm, found: &ModesResult, own: &SettledModes, first: usize) -> Vec<String> {
    let is_straight = matches!(found.setting, Setting::Straight { .. });
    let any_turns = own.modes.iter().flat_map(|mode| &mode.joints).any(|turn| *turn != 0.0);
    let row = |[number, omega, hertz, period, damping, error]: [&str; 6], joints: &str| {
        let (period, joints) = arm.pick((format!(" {period:>13}"), ""), (String::new(), joints));
        let row = format!("{number:<6} {omega:>13} {hertz:>15}{period} {damping:>10} {error:>11}");
        (row + if any_turns { joints } else { "" }).trim_end().to_owned()
    };
    let damping = if is_straight { "" } else { "damping" };
    let heading = ["mode", "omega [rad/s]", "frequency [Hz]", "period [s]", damping, MESH_ERROR];
    let modes = own.modes.iter().zip(&own.errors).enumerate().map(|(k, (mode, error))| {
        let (number, square) = ((first + k).to_string(), mode.square_per_s2);
        unsteady(&number, square, arm.pick("link", "arm")).unwrap_or_else(|| {
            let omega = square.sqrt();
            let [omega, hertz, period] =
                [omega, omega / TAU, TAU / omega].map(|x| significant(x, 8));
            let damping = match mode.damping_ratio {
                Some(ratio) => significant(ratio, 4),
                None if is_straight => String::new(),
                None => "none".to_owned(),
            };
            let turns = mode.joints.iter().map(|own| format!(" {own:>6.3}"));
            let turns = turns.collect::<Vec<_>>().concat();
            row([&number, &omega, &hertz, &period, &damping, &share(*error)], &turns)
        })
    });
    std::iter::once(row(heading, "  joints")).chain(modes).collect()
}

/// A relative error, or a bound below the accuracy of the iterations. Empty if unknown.
fn share(error: f64) -> String {
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
    let longest = verification.checks.iter().map(|check| check.what.chars().count()).max();
    let width = longest.unwrap_or_default().max(34);
    let found = verification.checks.iter().filter_map(|check| Some(number_text(check)?.len()));
    let found = found.max().unwrap_or_default().max(9);
    let header = format!("{:<width$} {:>found$}   {:>9}   of", "check", "found", "at most");
    let lines = verification.checks.iter().map(|check| check_line(check, [width, found]));
    std::iter::once(header).chain(lines).map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// Size below which numbers are round-off, which differs between machines.
const ROUND_OFF: f64 = 1e-9;

/// The number of a check; `None` for a check that was not made.
fn number_text(check: &Check) -> Option<String> {
    let (found, bound) = check.found.zip(check.bound)?;
    Some(if found <= ROUND_OFF {
        format!("< {ROUND_OFF:.0e}")
    } else if found >= bound && check.passes {
        format!("< {bound:.1e}")
    } else {
        format!("{found:.0$e}", digits_beyond(found, bound) - 1)
    })
}

/// A line of the table, whose columns of checks and numbers have these widths.
fn check_line(check: &Check, [width, of_found]: [usize; 2]) -> String {
    let what = &check.what;
    match number_text(check).zip(check.bound) {
        Some((found, bound)) => {
            let verdict = if check.passes { "" } else { "  FAILS" };
            format!("{what:<width$} {found:>of_found$}   {bound:>9.1e}   {}{verdict}", check.of)
        }
        None => format!("{what:<width$} not made: {}", check.reason.as_deref().unwrap_or_default()),
    }
}

/// Result of the search for a duration, or for a quiet one, with the number of trials and the kept limits.
pub(crate) fn found_text(fit: &Fit, values: &[LimitedValue], is_quiet: bool) -> String {
    let arm = &fit.solution.arm;
    let each = values.iter().map(|value| {
        let LimitedValue { joint, key, limit, unit, .. } = *value;
        let text = arm.worded(&format!("{}{key}={} {unit}", of_joint(joint), given(limit)));
        let own = text
            .strip_prefix("carriage ")
            .filter(|own| own.split_once('=').is_some_and(|(key, _)| is_limit_of_carriage(key)));
        own.map(str::to_owned).unwrap_or(text)
    });
    let within = each.collect::<Vec<_>>().join(", ");
    if is_quiet {
        let within = if within.is_empty() { within } else { format!(" within {within}") };
        return format!("the shortest quiet duration{within}");
    }
    if fit.is_shortest() {
        return format!("the shortest duration within {within}");
    }
    let (tried, shorter) = (fit.shorter_tried, fit.shorter());
    format!("within {within}; {tried} of the {shorter} shorter durations were tried, none fits")
}

/// True for the key of a limit that only a carriage has.
pub(crate) fn is_limit_of_carriage(key: &str) -> bool {
    key.ends_with("force") || key.starts_with("carriage_")
}

fn of_joint(joint: Option<usize>) -> String {
    joint.map_or(String::new(), |joint| format!("joint {} ", joint + 1))
}

/// The limit closest to its value, and the distance.
pub(crate) fn binding_text(fit: &Fit) -> String {
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
    let binds = format!("; {of}limits.{key} binds: {found} {unit} of {limit} {unit}, {error}");
    fit.solution.arm.worded(&binds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_checks_stand_below_each_other() {
        let check = |what: &str, found, bound| Check {
            name: what.to_owned(),
            what: what.to_owned(),
            of: "its peak".to_owned(),
            found: Some(found),
            bound: Some(bound),
            reason: None,
            passes: found <= bound,
            hint: "",
        };
        let long = "a limit with a name of more than thirty-four letters";
        let checks = vec![check("tip", 1.000_004e-3, 1e-3), check(long, 0.5, 1.0)];
        let text = verify_text(&Verification { checks });
        let ends = |line: &str, text: &str| line.find(text).unwrap() + text.len();
        let lines: Vec<&str> = text.lines().collect();
        let [header, tip, limit] = lines[..] else { panic!("{text}") };
        assert_eq!(ends(header, "found"), ends(tip, "1.00000e-3"), "{text}");
        assert_eq!(ends(header, "found"), ends(limit, "5.0e-1"), "{text}");
        assert_eq!(ends(header, "at most"), ends(limit, "1.0e0"), "{text}");
    }
}
