//! The summary that `simulate` prints of an arm.

use std::fmt::Write as _;

use flexlink::link::Damping;
use flexlink::response::Interpolation;
use flexlink::result::PlayedJoint;
use flexlink::store::PlayedRun;
use flexlink::text::{plain, significant};

use super::arm::{gravity_line, size_line, title};
use super::played::tip_error_line;
use super::runs::four;

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
        line(&format!("joint {}", number + 1), joint_text(joint, run.arm.has_weight()));
    }
    let [way, x, y] =
        four([run.metrics.way_m, run.metrics.final_tip_m[0], run.metrics.final_tip_m[1]]);
    line("tip", format!("moves by {way} m from where it starts; ends at {x}, {y} m"));
    line("error", run.tip_error.map(tip_error_line).unwrap_or_default());
    line("errors", errors_line(run));
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

fn joint_text(joint: &PlayedJoint, has_weight: bool) -> String {
    let [peak, holding] = four([joint.peak_torque_n_m, joint.holding_torque_n_m]);
    let [start, end, rate, power] = four([
        joint.start_angle_rad,
        joint.end_angle_rad,
        joint.peak_rate_rad_s,
        joint.peak_power_w,
    ]);
    let holding =
        if has_weight { format!("; {holding} N m hold it where it starts") } else { String::new() };
    format!(
        "peak {peak} N m{holding}\n         turns from {start} to {end} rad; \
         peaks {rate} rad/s, {power} W"
    )
}

fn errors_line(run: &PlayedRun<'_>) -> String {
    let [tip_m, joint_rad] = run.played.change;
    let [tip, joint, energy] =
        [tip_m, joint_rad, run.played.imbalance()].map(|own| significant(own, 2));
    format!(
        "tip {tip} m, joints {joint} rad (half the step, finer polynomials);\n         energy {energy} of the largest"
    )
}
