//! The summary that `solve` prints of an arm.

use std::fmt::Write as _;

use flexlink::elastica::SecondOrder;
use flexlink::inverse::ArmSolution;
use flexlink::motion::Prescribed;
use flexlink::result::{ArmMetrics, JointMetrics};
use flexlink::text::{plain, significant, visible};

use super::runs::{four, timing_line};

/// The summary of an arm's solution; `written` says where its files are.
pub(crate) fn arm_text(solution: &ArmSolution, metrics: &ArmMetrics, written: &str) -> String {
    let mut text = String::new();
    let arm = &solution.arm;
    if !arm.title().is_empty() {
        let _ = writeln!(text, "{}", visible(arm.title()));
    }
    let mut line = |label: &str, content: String| {
        if !content.is_empty() {
            let _ = writeln!(text, "{label:<8} {content}");
        }
    };
    line("arm", format!("{} links, {} m", arm.links().len(), significant(arm.length_m(), 4)));
    for (number, elements) in solution.elements().into_iter().enumerate() {
        line(&format!("link {}", number + 1), link_line(solution, number, elements));
    }
    line("gravity", gravity_line(solution));
    line("path", path_line(solution));
    line("order", order_line(solution));
    for (number, joint) in metrics.joints.iter().enumerate() {
        line(&format!("joint {}", number + 1), joint_text(joint));
    }
    line("errors", errors_line(solution));
    line("window", window_line(solution));
    line("written", written.to_owned());
    text
}

fn link_line(solution: &ArmSolution, number: usize, elements: usize) -> String {
    let own = &solution.arm.links()[number];
    let name = own.name.as_deref().map(|name| format!("{}, ", visible(name))).unwrap_or_default();
    let [length, mass] = four([own.link.length_m(), own.link.mass_kg()]);
    let damping = match own.link.damping().name() {
        "none" => "no",
        name => name,
    };
    format!("{name}{length} m, {mass} kg, {elements} elements, {damping} damping")
}

fn gravity_line(solution: &ArmSolution) -> String {
    if !solution.arm.has_weight() {
        return String::new();
    }
    let [along_x, along_y] = solution.arm.gravity_m_s2().map(plain);
    format!("{along_x}, {along_y} m/s²")
}

fn path_line(solution: &ArmSolution) -> String {
    let grid = solution.path.grid();
    let what = match solution.path.prescribed() {
        Prescribed::Tip => "of the tip",
        Prescribed::Angles => "as angles of the links",
    };
    let [from, to, step, way] = four([grid.time_s(0), grid.end_s(), grid.step_s, solution.way_m]);
    let cutoff = solution.cutoff_hz.map_or("all frequencies".to_owned(), |hertz| {
        format!("up to {} Hz", significant(hertz, 4))
    });
    format!("{what}, {from} … {to} s at {step} s; the tip moves by {way} m;\n         {cutoff}")
}

fn order_line(solution: &ArmSolution) -> String {
    let findings = &solution.findings;
    let slopes: Vec<String> =
        solution.links.iter().map(|link| significant(link.largest_slope, 3)).collect();
    let slopes = format!("largest slopes {}", slopes.join(", "));
    let name = match findings.order {
        SecondOrder::None => return format!("none: linear; {slopes}"),
        SecondOrder::First => "first",
        SecondOrder::Full => "full",
    };
    let iteration = &findings.iteration;
    let change = significant(100.0 * iteration.second_order_change, 2);
    let contraction = iteration.contraction.map_or("none".into(), |own| significant(own, 2));
    format!(
        "{name}: {change} % of a torque; {slopes};\n         {} iterations, contraction {contraction}",
        iteration.iterations
    )
}

fn joint_text(joint: &JointMetrics) -> String {
    let [peak, rms, rigid] =
        four([joint.peak_torque_n_m, joint.rms_torque_n_m, joint.peak_rigid_torque_n_m]);
    let [start, end, rate, power] = four([
        joint.start_angle_rad,
        joint.end_angle_rad,
        joint.peak_rate_rad_s,
        joint.peak_power_w,
    ]);
    let [deflection, moment] = four([joint.peak_deflection_m, joint.peak_root_moment_n_m]);
    let mut text = format!(
        "peak {peak} N m, rms {rms} N m; the rigid arm {rigid} N m\n         {}\n         turns from {start} to {end} rad; peaks {rate} rad/s, {power} W\n         its link bends by \
         {deflection} m; {moment} N m at its root",
        timing_line(joint.lead_s, joint.lag_s)
    );
    let motor = joint.peak_motor_torque_n_m.zip(joint.peak_motor_rate_rad_s);
    if let Some((torque, rate)) = motor {
        let [torque, rate] = four([torque, rate]);
        let _ = write!(text, "\n         its motor peaks {torque} N m, {rate} rad/s");
    }
    text
}

fn errors_line(solution: &ArmSolution) -> String {
    let shown = |error: f64| significant(error, 2);
    let [mesh, window] = [solution.worst(|own| own.mesh), solution.worst(|own| own.window)];
    let mut parts = vec![
        format!("tip {}", shown(solution.tip_error)),
        format!("mesh {}", shown(mesh)),
        format!("window {}", shown(window)),
    ];
    let optional = |kind: &dyn Fn(&flexlink::inverse::QuantityErrors) -> Option<f64>| {
        let is_there = solution.errors.iter().any(|own| kind(&own.torque).is_some());
        is_there.then(|| solution.worst(|own| kind(own).unwrap_or(0.0)))
    };
    parts.extend(optional(&|own| own.iteration).map(|e| format!("iteration {}", shown(e))));
    parts.extend(optional(&|own| own.input).map(|e| format!("input {}", shown(e))));
    parts.extend(optional(&|own| own.step).map(|e| format!("step {}", shown(e))));
    let of = if solution.arm.has_weight() { "range" } else { "peak" };
    format!("{},\n         of each {of}, the worst of all joints", parts.join(", "))
}

fn window_line(solution: &ArmSolution) -> String {
    let grid = &solution.grid;
    let [from, to] = four([grid.time_s(0), grid.end_s()]);
    format!("{from} … {to} s, {} rows", grid.len)
}
