//! The summary that `solve` prints of an arm.

use flexlink::inverse::ArmSolution;
use flexlink::link::Arm;
use flexlink::motion::Prescribed;
use flexlink::result::Metrics;
use flexlink::text::{instant, plain, significant, visible};

use super::layout::LABEL;
use super::runs::{errors_text, four, joint_lines, labelled, order_text};

/// The summary of an arm's solution; `written` says where its files are.
pub(crate) fn arm_text(solution: &ArmSolution, metrics: &Metrics, written: String) -> String {
    let arm = &solution.arm;
    let numbered = |what: &str, number: usize| format!("{what} {}", number + 1);
    let links = solution.elements().into_iter().enumerate().map(|(number, elements)| {
        (numbered("link", number), arm_link_line(solution, number, elements))
    });
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
    let lines = lines.chain([
        own("gravity", gravity_line(arm)),
        own("path", path_line(solution)),
        own("order", order_line(solution)),
    ]);
    let of = if arm.has_weight() { "of the range" } else { "of the peak" };
    let tip = Some(solution.expected_tip_error());
    let errors = errors_text(&solution.errors, (tip, None), (false, of));
    let end = [own("errors", errors), own("written", written)];
    labelled(arm.title(), lines.chain(joints).chain(end))
}

fn arm_link_line(solution: &ArmSolution, number: usize, elements: usize) -> String {
    let own = &solution.arm.links()[number];
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

fn path_line(solution: &ArmSolution) -> String {
    let grid = solution.path.grid();
    let what = match solution.path.prescribed() {
        Prescribed::Tip => "of the tip",
        Prescribed::Angles => "as angles of the links",
    };
    let [from, to] = [grid.time_s(0), grid.end_s()].map(|time_s| instant(time_s, 4));
    let [step, way] = four([grid.step_s, solution.way_m]);
    let cutoff = solution.cutoff_hz.map_or("all frequencies".to_owned(), |hertz| {
        format!("up to {} Hz", significant(hertz, 4))
    });
    format!("{what}, {from} … {to} s at {step} s; the tip moves by {way} m;\n         {cutoff}")
}

fn order_line(solution: &ArmSolution) -> String {
    let (findings, iteration) = (&solution.findings, &solution.findings.iteration);
    let slopes: Vec<f64> = solution.links.iter().map(|link| link.largest_slope).collect();
    let iterated = (iteration.second_order_change, iteration.iterations, iteration.contraction);
    let fallback = findings.fallback.map_or("", |_| "; all terms do not converge");
    order_text(findings.order, &slopes, iterated) + fallback
}
