//! The summary that `solve` prints.

use std::f64::consts::TAU;

use crate::elastica::{Iteration, SecondOrder};
use crate::inverse::{LinkMotion, Quantity, QuantityErrors, Solution};
use crate::link::Joint;
use crate::modal::{REPORTED_MODES, REPORTED_ZEROS};
use crate::motion::{ArmPath, Ends, Motion, Prescribed, TipMotion};
use crate::result::{JointMetrics, Metrics};
use crate::text::{after, before, instant, plain, significant, visible};

use super::lines::{
    COLUMNS, LABEL, damping_line, four, gravity_line, in_columns, joint_line, labelled, link_line,
    list, size_line, turned, wrapped,
};

/// The summary of a solution; `written` names its files.
pub(crate) fn solve_text(solution: &Solution, metrics: &Metrics, written: String) -> String {
    let before = match &solution.motion {
        Motion::Tip(motion) => link_lines((solution, motion), metrics),
        Motion::Path(path) => arm_lines(solution, path),
    };
    let joints =
        metrics.joints.iter().zip(solution.arm.joints()).flat_map(|(metrics, joint)| match metrics
            .joint
        {
            None => {
                let lines = joint_lines(&joint, metrics);
                lines.map(|(label, line)| (joint.worded(label), line)).to_vec()
            }
            Some(number) => {
                vec![(solution.arm.name_of_joint(number), below_each_other(&joint, metrics))]
            }
        });
    let end = [("errors", solution_errors(solution)), ("written", written)];
    let end = end.map(|(label, line)| (label.to_owned(), line));
    let lines = before.into_iter().chain(joints).chain(end);
    labelled(&solution.arm, lines)
}

fn numbered(what: &str, number: usize) -> String {
    format!("{what} {}", number + 1)
}

/// The lines of an arm's joint. All but the motor's contain their subject.
fn below_each_other(joint: &Joint, metrics: &JointMetrics) -> String {
    let lines = joint_lines(joint, metrics).into_iter().filter(|(_, line)| !line.is_empty());
    let lines = lines.map(|(label, line)| match label {
        "motor" => format!("motor {line}"),
        _ => line,
    });
    lines.collect::<Vec<_>>().join(&format!("\n{:LABEL$}", ""))
}

fn arm_lines(solution: &Solution, path: &ArmPath) -> Vec<(String, String)> {
    let arm = &solution.arm;
    let links = (0..solution.links.len())
        .map(|number| (numbered("link", number), arm_link_line(solution, number)));
    let fallback = solution.second_order.and_then(|terms| terms.fallback);
    let fallback = fallback.map_or("", |_| "; all terms do not converge");
    let motion = [
        ("gravity", gravity_line(arm)),
        ("path", path_line(solution, path)),
        ("order", order_line(solution) + fallback),
    ];
    let motion = motion.map(|(label, line)| (label.to_owned(), line));
    [("arm".to_owned(), size_line(arm))].into_iter().chain(links).chain(motion).collect()
}

fn arm_link_line(solution: &Solution, number: usize) -> String {
    let own = &solution.arm.links()[number];
    let elements = solution.links[number].mesh().elements().len();
    let name = own.name.as_deref().map(|name| format!("{}, ", visible(name))).unwrap_or_default();
    let [length, mass] = four([own.link.length_m(), own.link.mass_kg()]);
    let damping = match own.link.damping().name() {
        "none" => "no",
        name => name,
    };
    format!("{name}{length} m, {mass} kg, {elements} elements, {damping} damping")
}

fn path_line(solution: &Solution, path: &ArmPath) -> String {
    let grid = path.grid();
    let what = match path.prescribed() {
        Prescribed::Tip => "of the tip",
        Prescribed::Angles => "as angles of the links",
    };
    let [step, travel, period] =
        four([grid.step_s, solution.tip_travel_m(), grid.len as f64 * grid.step_s]);
    let times = if path.ends() == Ends::Periodic {
        format!("one cycle of {period} s")
    } else {
        let [from, to] = [grid.time_s(0), grid.end_s()].map(|time_s| instant(time_s, 4));
        format!("{from} … {to} s")
    };
    let cutoff = solution.band.cutoff_hz.map_or("all frequencies".to_owned(), |hertz| {
        format!("up to {} Hz", significant(hertz, 4))
    });
    let (sampled, moves) =
        (format!("{what}, {times} at {step} s;"), format!("the tip moves by {travel} m;"));
    let width = LABEL + sampled.chars().count() + 1 + moves.chars().count();
    let [before, after] = if width > COLUMNS { ["\n         ", " "] } else { [" ", "\n         "] };
    format!("{sampled}{before}{moves}{after}{cutoff}")
}

/// The lines of a link's solution before those of its hub.
pub(super) fn link_lines(
    (solution, motion): (&Solution, &TipMotion),
    metrics: &Metrics,
) -> Vec<(String, String)> {
    let (link, law) = (solution.links[0].link(), solution.links[0].law());
    let frequencies = solution.links[0].natural_frequencies_rad_s(REPORTED_MODES);
    let lines = [
        ("link", link_line(link, solution.links[0].mesh())),
        ("damping", damping_line(link, law, &frequencies)),
        ("gravity", gravity_of_link(solution)),
        ("order", order_line(solution)),
        ("modes", modes_line(&solution.links[0], &frequencies)),
        ("motion", motion_line((solution, motion), metrics)),
    ];
    lines.map(|(label, line)| (label.to_owned(), line)).to_vec()
}

/// Lines of a joint, its link and its motor.
pub(super) fn joint_lines(joint: &Joint, metrics: &JointMetrics) -> [(&'static str, String); 5] {
    let turns = turned(metrics.joint.map(|_| metrics.end_angles_rad), metrics.peak_hub_angle_rad);
    let turns = joint.worded(&turns);
    let line =
        |label, start| joint_line(label, start, (joint, metrics.joint), |own| (own.of)(metrics));
    [
        ("torque", line("torque", "")),
        ("timing", joint.worded(&timing_text(metrics))),
        ("hub", line("hub", &turns)),
        ("motor", line("motor", "")),
        ("bending", line("bending", "")),
    ]
}

/// Gravity, and the direction of the link at tip displacement 0.
fn gravity_of_link(solution: &Solution) -> String {
    let Some(gravity) = solution.links[0].link().gravity() else { return String::new() };
    let [along_x, along_y] = gravity.acceleration_m_s2.map(plain);
    if let Some(direction_rad) = solution.links[0].link().direction_rad() {
        let [direction] = four([direction_rad]);
        return format!("{along_x}, {along_y} m/s²; the link points to {direction} rad");
    }
    if solution.arm.joint().slides() {
        return format!("{along_x}, {along_y} m/s²");
    }
    let start_rad = solution.hub().rigid_angle_rad[0];
    let last_rad = solution.hub().rigid_angle_rad[solution.grid.len - 1];
    let [start, last] = four([start_rad, last_rad]);
    format!("{along_x}, {along_y} m/s²; the link moves from {start} to {last} rad")
}

/// Terms of second order and their effect: order of the terms, largest slope of each link, largest change of a
/// torque, over its peak or range, number of iterations and their contraction.
pub(super) fn order_line(solution: &Solution) -> String {
    let Some(found) = &solution.second_order else { return String::new() };
    let Iteration { iterations, contraction, second_order_change: change, .. } = found.iteration;
    let slopes: Vec<_> = solution.links.iter().filter_map(|link| link.largest_slope).collect();
    let slopes = format!("{} {}", solution.arm.pick("slope", "slopes"), list(&slopes, 3));
    let name = match found.order {
        SecondOrder::None => return format!("none: linear; largest {slopes}"),
        SecondOrder::First => "first",
        SecondOrder::Full => "full",
    };
    let change = significant(100.0 * change, 2);
    let contraction = contraction.map_or("none".into(), |factor| significant(factor, 2));
    let parts = [
        solution.arm.joint().worded(&format!("{name}: {change} % of torque")),
        slopes,
        format!("{iterations} iterations"),
        format!("contraction {contraction}"),
    ];
    wrapped(parts.into_iter(), "")
}

/// The first natural frequencies with a free hub, and the zeros of torque → tip, up to the end of the line.
fn modes_line(link: &LinkMotion, frequencies_rad_s: &[f64]) -> String {
    let zeros_per_s = link.zeros_per_s(REPORTED_ZEROS);
    let hertz: Vec<f64> = frequencies_rad_s.iter().map(|omega| omega / TAU).collect();
    let zeros: Vec<String> =
        zeros_per_s.iter().map(|zero| format!("±{}", significant(*zero, 4))).collect();
    let is_without = link.link().has_weight() && !link.reports_weight();
    let without = if is_without { "; without gravity" } else { "" };
    let first = |most: usize| {
        let [modes, zeros] =
            [list(&hertz[..most.min(hertz.len())], 4), zeros[..most.min(zeros.len())].join(" ")];
        let or_none =
            |list: String, unit| if list.is_empty() { "none".into() } else { list + unit };
        format!("{}; zeros {}{without}", or_none(modes, " Hz"), or_none(zeros, " 1/s"))
    };
    let fits = |line: &String| LABEL + line.chars().count() <= COLUMNS;
    (2..=REPORTED_MODES).rev().map(first).find(fits).unwrap_or_else(|| first(1))
}

/// Velocity over its peak below which it is shown as rest.
const ROUND_OFF: f64 = 1e-9;

fn motion_line((solution, motion): (&Solution, &TipMotion), metrics: &Metrics) -> String {
    let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
    let farthest_m = solution.tip_travel_m();
    let [travel, farthest, duration] =
        [motion.travel_m(), farthest_m, grid.time_s(until) - grid.time_s(from)]
            .map(|number| significant(number, 3));
    if motion.ends() == Ends::Periodic {
        return with_peaks(&cycle_line(motion, farthest_m), solution, metrics);
    }
    let is_there_and_back = motion.travel_m().abs() <= 1e-6 * farthest_m;
    let travel =
        if is_there_and_back { format!("{farthest} m and back") } else { format!("{travel} m") };
    let step = significant(grid.step_s, 3);
    if motion.ends() == Ends::Moving {
        let peak_m_s = metrics.peak_tip_velocity_m_s.value;
        let rest =
            |velocity: f64| if velocity.abs() < ROUND_OFF * peak_m_s { 0.0 } else { velocity };
        let [before, after] =
            motion.end_velocities_m_s().map(|velocity| significant(rest(velocity), 3));
        let ends = with_peaks(&format!("from {before} to {after} m/s"), solution, metrics);
        return format!(
            "{travel}, {duration} s of it at changing velocity, at {step} s;\n{:LABEL$}{ends}",
            ""
        );
    }
    with_peaks(&format!("{travel} in {duration} s at {step} s"), solution, metrics)
}

/// A cycle: its travel or its largest displacement, and its period.
fn cycle_line(motion: &TipMotion, farthest_m: f64) -> String {
    let (grid, travel_m) = (motion.grid(), motion.travel_m());
    let [farthest, travel, period] = four([farthest_m, travel_m, grid.len as f64 * grid.step_s]);
    let step = significant(grid.step_s, 3);
    if travel_m == 0.0 {
        format!("cycle of {farthest} m in {period} s at {step} s")
    } else {
        format!("cycle that leads on by {travel} m in {period} s at {step} s")
    }
}

/// A motion, its largest velocity and acceleration, and its cut-off.
fn with_peaks(motion: &str, solution: &Solution, metrics: &Metrics) -> String {
    let velocity_m_s = metrics.peak_tip_velocity_m_s.value;
    let acceleration_m_s2 = metrics.peak_tip_acceleration_m_s2.value;
    let [velocity, acceleration] =
        [velocity_m_s, acceleration_m_s2].map(|number| significant(number, 3));
    let cutoff = match solution.band.cutoff_hz {
        None => "whole band".to_owned(),
        Some(cutoff_hz) => format!("to {} Hz", significant(cutoff_hz, 3)),
    };
    let peaks = [format!("{motion}; peaks {velocity} m/s"), format!("{acceleration} m/s²"), cutoff];
    wrapped(peaks.into_iter(), "")
}

pub(super) fn timing_text(metrics: &JointMetrics) -> String {
    let times_s = metrics.lead_s.zip(metrics.lag_s);
    times_s.map_or("one cycle, which the torque repeats".to_owned(), timing_line)
}

/// Times when the torque exceeds 2 % of its peak. A slow motion begins and ends with less.
fn timing_line((lead_s, lag_s): (f64, f64)) -> String {
    let (start, end) = (before(lead_s, 3), after(lag_s, 3));
    if lead_s >= 0.0 && lag_s >= 0.0 {
        return format!("starts {start} the motion, ends {end} it (2 % level)");
    }
    format!("starts {start} the motion begins, ends {end} it ends")
}

/// One kind of error of a quantity, if measured.
type Kind = fn(QuantityErrors) -> Option<f64>;

/// The kind of error that is also printed for the torque, if another quantity is worse.
const INPUT: &str = "input";

/// A kind of error that a cycle lacks, because it is not cut out of a longer one.
const WINDOW: &str = "window";

/// The errors of the tip, then the worst error of each kind, with its quantity unless it is the torque, and its joint
/// if there are several.
pub(super) fn solution_errors(solution: &Solution) -> String {
    let errors: Vec<_> = solution.joints.iter().map(|joint| joint.errors).collect();
    let is_cycle = solution.motion.ends() == Ends::Periodic;
    // The tip of one link is exact if the solution uses all frequencies of its samples.
    let has_error = solution.arm.pick(solution.band.cutoff_hz.is_some(), true);
    let of = if solution.arm.has_weight() { "of the range" } else { "of the peak" };
    let kinds: [(&str, Kind); 6] = [
        ("mesh", |errors| Some(errors.mesh)),
        (WINDOW, |errors| Some(errors.window)),
        ("step", |errors| errors.step),
        ("iteration", |errors| errors.iteration),
        ("modes left out", |errors| errors.modes),
        (INPUT, |errors| errors.input),
    ];
    let worst = kinds.iter().filter_map(|(name, kind)| {
        let is_measured = errors.iter().any(|own| kind(own.torque).is_some());
        let joints =
            errors.iter().enumerate().filter(|_| is_measured && !(is_cycle && *name == WINDOW));
        let worst = joints.map(|(joint, own)| {
            let (quantity, error) = own.of_kind(|own| kind(own).unwrap_or(0.0)).worst();
            (joint, own.torque.input, quantity, error)
        });
        let (joint, of_torque, quantity, error) = worst
            .reduce(|worst, own| if own.3 > worst.3 || own.3.is_nan() { own } else { worst })?;
        let of_joint = solution.arm.pick(None, Some(solution.arm.name_of_joint(joint)));
        let other = (quantity != Quantity::Torque).then(|| {
            let joint = solution.arm.joints().nth(joint).unwrap_or(solution.arm.joint());
            joint.worded(quantity.name())
        });
        let of = match (other, of_joint) {
            (Some(own), None) => Some(own.replace("acceleration", "accel.")),
            (Some(own), Some(joint)) if !own.starts_with(&joint) => {
                Some(format!("{} of {joint}", own.trim_start_matches("hub ")))
            }
            (own, joint) => own.or(joint),
        };
        let of = of.map_or_else(String::new, |of| format!(" ({of})"));
        // The input affects derivatives most, but its effect on the torque is also needed.
        let torque = of_torque.filter(|_| *name == INPUT && quantity != Quantity::Torque);
        let torque = torque.map(|share| format!("{share:.1e} and ")).unwrap_or_default();
        Some((format!("{name}{of}"), format!("{torque}{error:.1e}")))
    });
    let share = |name: &str, share: f64| (name.to_owned(), format!("{share:.1e}"));
    let tip = has_error.then(|| share("tip", solution.expected_tip_error()));
    let model = errors.iter().find_map(|own| own.torque.model).map(|error| share("model", error));
    let tip_model = solution.tip_model_error.map(|strays| share("model (tip)", strays));
    in_columns(tip.into_iter().chain(worst).chain(model).chain(tip_model), of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torque_that_acts_within_the_motion_alone_is_told_so() {
        let expected = [
            ((0.305, 0.319), "starts 0.305 s before the motion, ends 0.319 s after it (2 % level)"),
            ((-19.3, -20.1), "starts 19.3 s after the motion begins, ends 20.1 s before it ends"),
            (
                (-0.0193, 0.25),
                "starts 0.0193 s after the motion begins, ends 0.250 s after it ends",
            ),
            (
                (0.1, -0.0201),
                "starts 0.100 s before the motion begins, ends 0.0201 s before it ends",
            ),
        ];
        for (times_s, text) in expected {
            assert_eq!(timing_line(times_s), text);
            assert!(LABEL + text.chars().count() <= COLUMNS, "{text}");
        }
    }
}
