//! The summaries that `solve` and `simulate` print of an arm, and its modes.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use flexlink::elastica::SecondOrder;
use flexlink::inverse::{ArmSolution, QuantityErrors};
use flexlink::link::{Arm, Damping};
use flexlink::motion::Prescribed;
use flexlink::response::{ArmModes, Interpolation, PoseMode, SettledModes};
use flexlink::result::{JointMetrics, LinkZeros, Metrics, PlayedJoint};
use flexlink::store::PlayedRun;
use flexlink::text::{plain, significant, visible};

use super::layout::in_columns;
use super::played::tip_error_line;
use super::runs::{four, timing_text};
use super::tables::{MESH_ERROR, share, unsteady, zero_rows};

/// The summary of an arm's solution; `written` says where its files are.
pub(crate) fn arm_text(solution: &ArmSolution, metrics: &Metrics, written: String) -> String {
    let mut text = String::new();
    let arm = &solution.arm;
    text += &title(arm);
    let mut line = |label: &str, content: String| {
        if !content.is_empty() {
            let _ = writeln!(text, "{label:<8} {content}");
        }
    };
    line("arm", size_line(arm));
    for (number, elements) in solution.elements().into_iter().enumerate() {
        line(&format!("link {}", number + 1), link_line(solution, number, elements));
    }
    line("gravity", gravity_line(arm));
    line("path", path_line(solution));
    line("order", order_line(solution));
    for (number, joint) in metrics.joints.iter().enumerate() {
        line(&format!("joint {}", number + 1), joint_text(joint));
    }
    line("errors", errors_line(solution));
    line("written", written);
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

fn title(arm: &Arm) -> String {
    if arm.title().is_empty() { String::new() } else { format!("{}\n", visible(arm.title())) }
}

fn size_line(arm: &Arm) -> String {
    format!("{} links, {} m", arm.links().len(), significant(arm.length_m(), 4))
}

/// Gravity in the plane of an arm.
fn gravity_line(arm: &Arm) -> String {
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
    let fallback = findings.fallback.map_or("", |_| "; all terms do not converge");
    format!(
        "{name}: {change} % of a torque; {slopes};\n         {} iterations, contraction {contraction}{fallback}",
        iteration.iterations
    )
}

fn joint_text(joint: &JointMetrics) -> String {
    let [peak, rms, rigid] = four([
        joint.peak_torque_n_m.value,
        joint.rms_torque_n_m,
        joint.peak_rigid_torque_n_m.value,
    ]);
    let [start, end] = four(joint.end_angles_rad);
    let [rate, power, deflection, moment] = four([
        joint.peak_hub_rate_rad_s.value,
        joint.peak_power_w.value,
        joint.peak_deflection_m.value,
        joint.peak_root_moment_n_m.value,
    ]);
    let mut text = format!(
        "peak {peak} N m, rms {rms} N m; the rigid arm {rigid} N m;\n         {}\n         turns from {start} to {end} rad; peaks {rate} rad/s, {power} W\n         its link bends by \
         {deflection} m; {moment} N m at its root",
        timing_text(joint)
    );
    if let Some(motor) = &joint.motor {
        let [torque, rate] = four([motor.peak_torque_n_m.value, motor.peak_rate_rad_s.value]);
        let _ = write!(text, "\n         its motor peaks {torque} N m, {rate} rad/s");
    }
    text
}

fn errors_line(solution: &ArmSolution) -> String {
    type Kind = fn(&QuantityErrors) -> Option<f64>;
    let kinds: [(&str, Kind); 5] = [
        ("mesh", |own| Some(own.mesh)),
        ("window", |own| Some(own.window)),
        ("step", |own| own.step),
        ("iteration", |own| own.iteration),
        ("input", |own| own.input),
    ];
    let worst = kinds.into_iter().filter_map(|(name, kind)| {
        let is_there = solution.errors.iter().any(|own| kind(&own.torque).is_some());
        let error = is_there.then(|| solution.worst(|own| kind(own).unwrap_or(0.0)))?;
        Some((name.to_owned(), significant(error, 2)))
    });
    let tip = ("tip".to_owned(), significant(solution.expected_tip_error(), 2));
    let of = if solution.arm.has_weight() { "range" } else { "peak" };
    let end = format!("of each {of}, worst of all joints");
    in_columns(std::iter::once(tip).chain(worst), &end)
}

/// Modes of an arm in a pose, joints free and held, and zeros of its links.
pub(crate) fn arm_modes_text(arm: &Arm, found: &ArmModes, zeros: &[LinkZeros]) -> String {
    let list = |values: &[f64]| {
        values.iter().map(|own| significant(*own, 4)).collect::<Vec<_>>().join(", ")
    };
    let directions = list(&found.directions_rad);
    let mut lines = vec![
        format!("arm of {}; the links point to {directions} rad", size_line(arm)),
        format!("the tip rests at {} m", list(&found.tip_m)),
    ];
    if arm.has_weight() {
        let torques = list(&found.holding_torques_n_m);
        lines.push(format!("gravity {}; {torques} N m hold the joints at rest", gravity_line(arm)));
    }
    let swings = arm.links().len();
    lines.push(format!("joints free; the first {swings} are swings of the whole arm"));
    lines.extend(arm_mode_rows(&found.free));
    lines.push(rotors_held(&found.joint_stiffnesses_n_m_rad));
    lines.extend(arm_mode_rows(&found.held));
    for (number, own) in zeros.iter().enumerate() {
        lines.push(format!("{}, from its joint to its tip", arm.name_of(number)));
        lines.extend(zero_rows(own));
    }
    title(arm) + &lines.join("\n") + "\n"
}

fn rotors_held(joint_stiffnesses_n_m_rad: &[f64]) -> String {
    if joint_stiffnesses_n_m_rad.iter().all(|own| own.is_infinite()) {
        return "rotors held, stiff joints".into();
    }
    let springs = joint_stiffnesses_n_m_rad
        .iter()
        .map(|own| if own.is_finite() { significant(*own, 4) } else { "stiff".into() });
    format!("rotors held, joint springs {} N m/rad", springs.collect::<Vec<_>>().join(", "))
}

/// A heading, then a row a mode with how far each joint turns, where any does.
fn arm_mode_rows(found: &SettledModes) -> Vec<String> {
    let turns = |mode: &PoseMode| mode.joints.iter().any(|own| *own != 0.0);
    let any_turns = found.modes.iter().any(turns);
    let joints = |mode: &PoseMode| {
        let parts = mode.joints.iter().map(|own| format!(" {own:>6.3}"));
        if any_turns { parts.collect() } else { String::new() }
    };
    let row = |[number, omega, hertz, damping, error]: [&str; 5]| {
        format!("{number:<6} {omega:>13} {hertz:>15} {damping:>10} {error:>11}")
    };
    let heading = row(["mode", "omega [rad/s]", "frequency [Hz]", "damping", MESH_ERROR]);
    let heading = heading + if any_turns { "  joints" } else { "" };
    let modes = found.modes.iter().zip(&found.errors).enumerate().map(|(k, (mode, error))| {
        let (number, square) = ((k + 1).to_string(), mode.square_per_s2);
        unsteady(&number, square, "arm").unwrap_or_else(|| {
            let omega = square.sqrt();
            let [omega, hertz] = [omega, omega / TAU].map(|x| significant(x, 8));
            let damping = mode.damping_ratio.map_or(String::new(), |own| significant(own, 4));
            row([&number, &omega, &hertz, &damping, &share(*error)]) + &joints(mode)
        })
    });
    std::iter::once(heading).chain(modes).collect()
}

/// The summary of an arm's simulation; `written` says where its files are.
pub(crate) fn played_arm_text(run: &PlayedRun<'_>, written: &str) -> String {
    let mut text = title(run.arm);
    let mut line = |label: &str, content: String| {
        if !content.is_empty() {
            let _ = writeln!(text, "{label:<8} {content}");
        }
    };
    line("arm", size_line(run.arm));
    line("damping", damping_line(run));
    line("gravity", gravity_line(run.arm));
    line("torques", torques_line(run));
    line("feedback", feedback_line(run));
    for (number, joint) in run.metrics.joints.iter().enumerate() {
        line(&format!("joint {}", number + 1), played_joint_text(joint, run.arm.has_weight()));
    }
    let [x, y] = four(run.metrics.final_tip_m.unwrap_or_default());
    let way = significant(run.metrics.farthest_m, 4);
    line("tip", format!("moves by {way} m from where it starts; ends at {x}, {y} m"));
    line("error", run.target.map(|target| tip_error_line(&target.tip_error)).unwrap_or_default());
    line("errors", played_errors_line(run));
    line("written", written.to_owned());
    text
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
    let grid = &run.played.grid;
    let [from, to, step] = four([grid.time_s(0), grid.end_s(), grid.step_s]);
    let between = match run.play.interpolation {
        Interpolation::Cubic => "cubic spline",
        Interpolation::Linear => "straight lines",
        Interpolation::Zero => "held from sample to sample",
    };
    format!("{from} … {to} s at {step} s, {between}")
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
    let [start, end] = four(joint.end_angles_rad);
    let [rate, power] = four([joint.peak_hub_rate_rad_s.value, joint.peak_power_w.value]);
    let holding =
        if has_weight { format!("; {holding} N m hold it where it starts") } else { String::new() };
    format!(
        "peak {peak} N m{holding}\n         turns from {start} to {end} rad; \
         peaks {rate} rad/s, {power} W"
    )
}

fn played_errors_line(run: &PlayedRun<'_>) -> String {
    let [tip_m, joint_rad] = run.played.change;
    let [tip, joint, energy] =
        [tip_m, joint_rad, run.played.imbalance()].map(|own| significant(own, 2));
    format!(
        "tip {tip} m, joints {joint} rad (half the step, finer polynomials);\n         energy {energy} of the largest"
    )
}
