//! The summary that `solve` prints, and those of arms.

use flexlink::inverse::Solution;
use flexlink::link::{Arm, Damping};
use flexlink::motion::{ArmPath, Motion, Prescribed};
use flexlink::result::{Metrics, PlayedJoint};
use flexlink::store::PlayedRun;
use flexlink::text::{instant, plain, significant, visible};

use super::layout::LABEL;
use super::played::{between, times, tip_error_line, tip_line};
use super::runs::{
    four, hub_line, joint_lines, labelled, link_text, order_line, solution_errors, turned,
};

/// The summary of a solution; `written` says what was written where.
pub(crate) fn solve_text(solution: &Solution, metrics: &Metrics, written: String) -> String {
    match &solution.motion {
        Motion::Tip(motion) => link_text((solution, motion), metrics, written),
        Motion::Path(path) => arm_text((solution, path), metrics, written),
    }
}

fn arm_text((solution, path): (&Solution, &ArmPath), metrics: &Metrics, written: String) -> String {
    let arm = &solution.arm;
    let numbered = |what: &str, number: usize| format!("{what} {}", number + 1);
    let links = (0..solution.links.len())
        .map(|number| (numbered("link", number), arm_link_line(solution, number)));
    let joints = metrics.joints.iter().enumerate().map(|(number, joint)| {
        let lines = joint_lines(joint).into_iter().filter(|(_, line)| !line.is_empty());
        // The other lines say what they are of.
        let lines = lines.map(|(label, line)| match label {
            "motor" => format!("motor {line}"),
            _ => line,
        });
        let lines: Vec<String> = lines.collect();
        (numbered("joint", number), lines.join(&format!("\n{:LABEL$}", "")))
    });
    let own = |label: &str, line: String| (label.to_owned(), line);
    let lines = [own("arm", size_line(arm))].into_iter().chain(links);
    let fallback = solution.second_order.and_then(|found| found.fallback);
    let fallback = fallback.map_or("", |_| "; all terms do not converge");
    let lines = lines.chain([
        own("gravity", gravity_line(arm)),
        own("path", path_line(solution, path)),
        own("order", order_line(solution) + fallback),
    ]);
    let end = [own("errors", solution_errors(solution)), own("written", written)];
    labelled(arm.title(), lines.chain(joints).chain(end))
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

pub(super) fn size_line(arm: &Arm) -> String {
    format!("{} links, {} m", arm.links().len(), significant(arm.length_m(), 4))
}

/// Gravity in the plane of an arm.
pub(super) fn gravity_line(arm: &Arm) -> String {
    if !arm.has_weight() {
        return String::new();
    }
    let [along_x, along_y] = arm.gravity_m_s2().map(plain);
    format!("{along_x}, {along_y} m/s²")
}

fn path_line(solution: &Solution, path: &ArmPath) -> String {
    let grid = path.grid();
    let what = match path.prescribed() {
        Prescribed::Tip => "of the tip",
        Prescribed::Angles => "as angles of the links",
    };
    let [from, to] = [grid.time_s(0), grid.end_s()].map(|time_s| instant(time_s, 4));
    let [step, way] = four([grid.step_s, solution.tip_travel_m()]);
    let cutoff = solution.band.cutoff_hz.map_or("all frequencies".to_owned(), |hertz| {
        format!("up to {} Hz", significant(hertz, 4))
    });
    format!("{what}, {from} … {to} s at {step} s; the tip moves by {way} m;\n         {cutoff}")
}

/// The summary of an arm's simulation; `written` says where its files are.
pub(crate) fn played_arm_text(run: &PlayedRun<'_>, written: &str) -> String {
    let own = |label: &str, line: String| (label.to_owned(), line);
    let joints = run.metrics.joints.iter().enumerate().map(|(number, joint)| {
        let line = played_joint_text(joint, run.arm.has_weight());
        (format!("joint {}", number + 1), line)
    });
    let lines = [
        own("arm", size_line(run.arm)),
        own("damping", damping_line(run)),
        own("gravity", gravity_line(run.arm)),
        own("torques", torques_line(run)),
        own("feedback", feedback_line(run)),
    ];
    let error = run.target.map(|target| tip_error_line(&target.tip_error));
    let end = [
        own("tip", tip_line(run.metrics, false)),
        own("error", error.unwrap_or_default()),
        own("errors", played_errors_line(run)),
        own("written", written.to_owned()),
    ];
    labelled(run.arm.title(), lines.into_iter().chain(joints).chain(end))
}

/// What is played in place of damping that has no equation in time.
fn damping_line(run: &PlayedRun<'_>) -> String {
    let is_hysteretic =
        |damping: &Damping| matches!(damping, Damping::Hysteretic { ratio } if *ratio > 0.0);
    if run.arm.links().iter().any(|own| is_hysteretic(own.link.damping())) {
        "hysteretic, played as viscous in every mode of a link clamped at its joint".to_owned()
    } else {
        String::new()
    }
}

fn torques_line(run: &PlayedRun<'_>) -> String {
    format!("{}, {}", times(&run.played.grid), between(run.play.interpolation))
}

fn feedback_line(run: &PlayedRun<'_>) -> String {
    let gains = run.play.feedback.iter().map(|own| {
        let [kp, kd] = [own.stiffness_n_m_rad(), own.damping_n_m_s_rad()].map(plain);
        format!("{kp} N m/rad, {kd} N m s/rad")
    });
    let mut gains: Vec<String> = gains.collect();
    gains.dedup();
    gains.join("; ")
}

fn played_joint_text(joint: &PlayedJoint, has_weight: bool) -> String {
    let holding_n_m = joint.holding_torque_n_m.unwrap_or_default();
    let [peak, holding] = four([joint.peak_torque_n_m.value, holding_n_m]);
    let holding =
        if has_weight { format!("; {holding} N m hold it where it starts") } else { String::new() };
    let turns = turned(Some(joint.end_angles_rad), joint.peak_hub_angle_rad);
    let turns = hub_line(&turns, [joint.peak_hub_rate_rad_s, joint.peak_power_w]);
    format!("peak {peak} N m{holding}\n{:LABEL$}{turns}", "")
}

fn played_errors_line(run: &PlayedRun<'_>) -> String {
    let [tip_m, joint_rad] = run.played.change;
    let [tip, joint, energy] =
        [tip_m, joint_rad, run.played.imbalance()].map(|own| significant(own, 2));
    format!(
        "tip {tip} m, joints {joint} rad (half the step, finer polynomials);\n         energy {energy} of the largest"
    )
}
