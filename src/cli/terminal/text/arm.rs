//! The summary that `solve` prints.

use crate::inverse::Solution;
use crate::link::Arm;
use crate::motion::{ArmPath, Ends, Motion, Prescribed};
use crate::result::{JointMetrics, Metrics};
use crate::text::{instant, plain, significant, visible};

use super::layout::LABEL;
use super::runs::{four, joint_lines, labelled, link_lines, order_line, solution_errors};

/// The summary of a solution; `written` names its files.
pub(crate) fn solve_text(solution: &Solution, metrics: &Metrics, written: String) -> String {
    let before = match &solution.motion {
        Motion::Tip(motion) => link_lines((solution, motion), metrics),
        Motion::Path(path) => arm_lines(solution, path),
    };
    let joints = metrics.joints.iter().flat_map(|joint| match joint.joint {
        None => joint_lines(joint).map(|(label, line)| (label.to_owned(), line)).to_vec(),
        Some(number) => vec![(numbered("joint", number), below_each_other(joint))],
    });
    let end = [("errors", solution_errors(solution)), ("written", written)];
    let end = end.map(|(label, line)| (label.to_owned(), line));
    labelled(solution.arm.title(), before.into_iter().chain(joints).chain(end))
}

fn numbered(what: &str, number: usize) -> String {
    format!("{what} {}", number + 1)
}

/// The lines of an arm's joint. All but the motor's contain their subject.
fn below_each_other(joint: &JointMetrics) -> String {
    let lines = joint_lines(joint).into_iter().filter(|(_, line)| !line.is_empty());
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
    let [step, travel, period] =
        four([grid.step_s, solution.tip_travel_m(), grid.len as f64 * grid.step_s]);
    let times = match path.ends() {
        Ends::Periodic => format!("one cycle of {period} s"),
        _ => {
            let [from, to] = [grid.time_s(0), grid.end_s()].map(|time_s| instant(time_s, 4));
            format!("{from} … {to} s")
        }
    };
    let cutoff = solution.band.cutoff_hz.map_or("all frequencies".to_owned(), |hertz| {
        format!("up to {} Hz", significant(hertz, 4))
    });
    format!("{what}, {times} at {step} s; the tip moves by {travel} m;\n         {cutoff}")
}
