//! Summary from `simulate`.

use super::lines::{
    LABEL, damping_line, four, gravity_line, joint_line, labelled, link_line, size_line, turned,
};
use crate::link::{Arm, ArmLink, Damping, Joint, Link};
use crate::numeric::{TimeGrid, largest};
use crate::response::{
    Input, Interpolation, ModalPlay, Play, PlayError, Played, PlayedBy, PlayedModelError,
};
use crate::result::{
    ChannelComparison, Comparison, FollowedTarget, NoFit, PlayedJoint, PlayedMetrics,
};
use crate::store::{PlayedRun, Simulated};
use crate::text::{instant, plain, significant};

/// The summary of a simulation; `written` names its files.
pub(crate) fn simulate_text(run: &PlayedRun<'_>, written: String) -> String {
    let PlayedRun { arm, play, result, .. } = *run;
    let Simulated { played, metrics, comparison, .. } = result;
    let (size, damping, gravity) = match arm.links() {
        [ArmLink { link, .. }] => (
            ("link", link_line(link, played.mesh())),
            played_damping(link, played, play),
            weight_line(link, played),
        ),
        _ => (("arm", size_line(arm)), arm_damping_line(arm), gravity_line(arm)),
    };
    let before = [
        size,
        ("damping", damping),
        ("gravity", gravity),
        ("input", played_angles(arm, play)),
        ("torque", played_torque(arm, play, metrics)),
        ("feedback", feedback_line(arm, play)),
        played_by(played, play),
        ("tip", tip_line(metrics, play.cycle_turn_rad.is_some())),
    ];
    let is_held = arm.has_weight() && play.cycle_turn_rad.is_none();
    let joints = metrics.joints.iter().zip(arm.joints());
    let joints = joints.flat_map(|(own, joint)| joint_lines(&joint, own, is_held));
    let after = [
        ("after", residual_line(played)),
        ("decay", decay_line(played, play)),
        ("error", tip_error_line(result)),
        ("errors", simulation_errors(result, play)),
        ("model", model_line(played)),
        ("measured", comparison.as_ref().map(measured_text).unwrap_or_default()),
        ("written", written),
    ];
    let joint = arm.joint();
    let own = |(label, line): (&str, String)| match label {
        // Sizes have their own units, folders their own names.
        "link" | "written" => (label.to_owned(), line),
        label => (joint.worded(label), joint.worded(&line)),
    };
    let lines = before.map(own).into_iter().chain(joints).chain(after.map(own));
    labelled(arm, lines)
}

/// The lines of a hub, or the numbered ones of an arm's joint, which a torque holds at the start if it `is_held`.
fn joint_lines(kind: &Joint, joint: &PlayedJoint, is_held: bool) -> Vec<(String, String)> {
    let line = |label, start: &str| {
        joint_line(label, start, (kind, joint.joint), |own| own.played_by(joint))
    };
    let turns = turned(joint.joint.map(|_| joint.end_angles_rad), joint.peak_hub_angle_rad);
    let turns = kind.worded(&turns);
    let Some(number) = joint.joint else {
        let lines = [("hub", line("hub", &turns)), ("bending", line("bending", ""))];
        return lines.map(|(label, line)| (kind.worded(label), line)).to_vec();
    };
    let holding_n_m = joint.holding_torque_n_m.unwrap_or_default();
    let [peak, holding] = four([joint.peak_torque_n_m.value, holding_n_m]);
    let holding =
        if is_held { format!("; {holding} N m hold it where it starts") } else { String::new() };
    let effort = kind.worded(&format!("peak {peak} N m{holding}"));
    let text = format!("{effort}\n{:LABEL$}{}", "", line("hub", &turns));
    let label = if kind.slides() { "carriage".into() } else { format!("joint {}", number + 1) };
    vec![(label, text)]
}

/// Viscous substitute for damping without an equation in time.
fn arm_damping_line(arm: &Arm) -> String {
    if arm.links().iter().any(|own| is_hysteretic(&own.link)) {
        "hysteretic, played as viscous in every mode of a link clamped at its joint".to_owned()
    } else {
        String::new()
    }
}

fn is_hysteretic(link: &Link) -> bool {
    matches!(link.damping(), Damping::Hysteretic { ratio } if *ratio > 0.0)
}

/// A line for the compared times, then one for each channel.
fn measured_text(comparison: &Comparison) -> String {
    let Comparison { samples, left_out, .. } = comparison;
    let [from, until] = four([comparison.from_s, comparison.until_s]);
    let left_out = match left_out {
        0 => String::new(),
        1 => "; 1 outside the simulation is left out".to_owned(),
        number => format!("; {number} outside the simulation are left out"),
    };
    let head = format!("{samples} times, {from} … {until} s{left_out}");
    let labels = ["channel", "rms difference", "share", "delay", "gain", "left"].map(str::to_owned);
    let rows = comparison.channels.iter().map(|channel| channel_row(channel, comparison));
    std::iter::once(head).chain([row(labels)]).chain(rows).collect::<Vec<_>>().join("\n")
}

/// Share of the recording about its mean, of the longest delay, or of the largest torque, below which the text omits
/// a number.
const NOTHING: f64 = 1e-6;

fn channel_row(channel: &ChannelComparison, comparison: &Comparison) -> String {
    let name = channel.channel.name();
    // Smaller values are round-off.
    let least = NOTHING * channel.recorded_deviation;
    let is_more = channel.rms >= least;
    let rms = significant(if is_more { channel.rms } else { least }, if is_more { 3 } else { 1 });
    let rms = format!("{}{rms} {}", if is_more { "" } else { "<" }, channel.channel.unit());
    let percent = |share: f64| {
        let is_more = share >= NOTHING;
        if is_more {
            format!("{} %", significant(100.0 * share, 2))
        } else {
            "<0.0001 %".to_owned()
        }
    };
    let share = channel.share.map_or("-".to_owned(), percent);
    let Some(fit) = channel.fit else {
        let longest = || significant(comparison.longest_delay_s, 2);
        let why = match channel.no_fit {
            Some(NoFit::ConstantRecording) => "recording is constant".to_owned(),
            Some(NoFit::ConstantSimulation) => "simulation is constant".to_owned(),
            Some(NoFit::LongestDelay) | None => format!("no delay within ±{} s", longest()),
        };
        return format!("{name:<15}{rms:>16}{share:>10}  {why}");
    };
    let is_none = fit.delay_s.abs() < NOTHING * comparison.longest_delay_s;
    let delay = if is_none { "0".to_owned() } else { significant(fit.delay_s, 3) };
    let delay = format!("{delay} s");
    row([name, rms, share, delay, significant(fit.gain, 5), percent(fit.left)])
}

fn row([name, rms, share, delay, gain, left]: [String; 6]) -> String {
    format!("{name:<15}{rms:>16}{share:>10}{delay:>14}{gain:>10}{left:>11}")
}

/// The damping law, and its substitute if it has no equation in time.
fn played_damping(link: &Link, played: &Played, play: &Play<'_>) -> String {
    let modes = match play.input {
        Input::Torques(_) => "mode",
        Input::Angles(_) => "held mode",
    };
    let bare = &played.links[0];
    let as_viscous = format!(", played as viscous in every {modes}");
    damping_line(link, &bare.law, &bare.natural_frequencies_rad_s)
        + if is_hysteretic(link) { &as_viscous } else { "" }
}

/// The played torque, with its peak for one link; the peaks of an arm are in the lines of its joints.
fn played_torque(arm: &Arm, play: &Play<'_>, metrics: &PlayedMetrics) -> String {
    let peak = format!("peak {} N m", significant(metrics.hub().peak_torque_n_m.value, 4));
    match play.input {
        Input::Angles(_) => arm.pick(peak + ", as the hub's motion takes it", String::new()),
        Input::Torques(_) => {
            let (times, between) = (times(&play.input.grid()), between(play.interpolation));
            let of = if play.is_under_voltage { "voltage " } else { "" };
            format!("{of}{times}, {between}{}", arm.pick(format!("; {peak}"), String::new()))
        }
    }
}

/// Course of a torque between its samples.
fn between(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Cubic => "cubic spline",
        Interpolation::Linear => "straight lines",
        Interpolation::Zero => "held from sample to sample",
    }
}

/// Times of the played samples.
fn times(grid: &TimeGrid) -> String {
    let [start, end] = [grid.time_s(0), grid.end_s()].map(|time_s| instant(time_s, 4));
    format!("{start} … {end} s at {} s", significant(grid.step_s, 3))
}

/// The motion of the hub or of the joints, if it is the input.
fn played_angles(arm: &Arm, play: &Play<'_>) -> String {
    let angles = arm.carriage().map_or("joint angles", |_| "joint angles and carriage");
    let angle = arm.pick("hub angle", angles);
    match play.input {
        Input::Torques(_) => String::new(),
        Input::Angles(_) => format!("{angle}, {}, quintic spline", times(&play.input.grid())),
    }
}

/// The different gains of the feedback, the inner joint first.
fn feedback_line(arm: &Arm, play: &Play<'_>) -> String {
    let gains = play.feedback.iter().zip(arm.joints()).map(|(own, joint)| {
        let [kp, kd] = four([own.stiffness_n_m_rad(), own.damping_n_m_s_rad()]);
        joint.worded(&format!("{kp} N m/rad, {kd} N m s/rad"))
    });
    let mut gains: Vec<String> = gains.collect();
    gains.dedup();
    if gains.is_empty() {
        return String::new();
    }
    gains.join(&format!(";\n{:LABEL$}", "")) + " around the reference"
}

/// Gravity, and the torque that holds a link with weight before it moves.
fn weight_line(link: &Link, played: &Played) -> String {
    let acting = link.gravity().filter(|own| own.acts());
    let (Some(gravity), hub) = (acting, played.hub()) else { return String::new() };
    let [along_x, along_y] = gravity.acceleration_m_s2.map(plain);
    // Only round-off holds a link that hangs straight.
    let Some(holding_n_m) = hub.holding_n_m else { return format!("{along_x}, {along_y} m/s²") };
    let is_held = holding_n_m.abs() > NOTHING * largest(&hub.torque_n_m);
    let holding_n_m = if is_held { holding_n_m } else { 0.0 };
    let is_turned = hub.angle_rad[0].abs() > NOTHING * largest(&hub.angle_rad);
    let [angle, held] = four([if is_turned { hub.angle_rad[0] } else { 0.0 }, holding_n_m]);
    format!("{along_x}, {along_y} m/s²; at first {held} N m hold the hub at {angle} rad")
}

/// Input of the simulation: its label and its text.
fn played_by(played: &Played, play: &Play<'_>) -> (&'static str, String) {
    match &played.by {
        PlayedBy::Modes(modes) => ("modes", modes_line(modes, play)),
        PlayedBy::Elastica(bent) => {
            let (angles, steps) = (bent.angles, bent.steps);
            let slides = played.links[0].mesh.joint().slides();
            let has_carriage = slides || played.joints.len() > played.links.len();
            let what = if has_carriage { "coordinates" } else { "angles" };
            let line = format!("all terms: {angles} {what}, {steps} steps from sample to sample");
            ("order", line)
        }
    }
}

fn modes_line(modes: &ModalPlay, play: &Play<'_>) -> String {
    let selection = &modes.selection;
    let [highest, band] = four([selection.highest_hz, selection.torque_band_hz]);
    let (modes, of) = (selection.modes, selection.of);
    let input = match play.input {
        Input::Torques(_) => "torque",
        Input::Angles(_) => "hub",
    };
    format!("{modes} of {of}, to {highest} Hz ({input} band to {band} Hz)")
}

fn tip_line(metrics: &PlayedMetrics, is_cycle: bool) -> String {
    let [farthest, travel] = four([metrics.farthest_m, metrics.travel_m]);
    if is_cycle {
        return format!("moves by up to {farthest} m");
    }
    let velocity = significant(metrics.final_tip_velocity_m_s, 2);
    let travel = format!("moves by up to {farthest} m, by {travel} m in all;");
    match metrics.final_tip_m.map(four) {
        None => format!("{travel} ends with {velocity} m/s"),
        Some([x, y]) => format!("{travel}\n{:LABEL$}ends with {velocity} m/s at {x}, {y} m", ""),
    }
}

/// The vibration after the torque. For a tip that has hardly moved, its share of the travel is meaningless.
fn residual_line(played: &Played) -> String {
    let Some(residual) = played.modes().and_then(|modes| modes.residual) else {
        return String::new();
    };
    let vibration = format!("vibrates by {} m", significant(residual.amplitude_m, 3));
    let share = (residual.share < 1.0).then(|| significant(residual.share, 2));
    let share = share.map(|share| format!(", {share} of its peak displacement"));
    let frequency = residual.frequency_hz.map(|hertz| significant(hertz, 4));
    let frequency = frequency.map(|hertz| format!(", at {hertz} Hz"));
    vibration + &share.unwrap_or_default() + &frequency.unwrap_or_default()
}

/// Time until the vibration dies down; empty without vibration.
fn decay_line(played: &Played, play: &Play<'_>) -> String {
    let input = match play.input {
        Input::Torques(_) => "torque",
        Input::Angles(_) => "recording",
    };
    let Some(residual) = played.modes().and_then(|modes| modes.residual) else {
        return String::new();
    };
    match residual.decay_s {
        Some(decay_s) if decay_s > 0.0 => {
            format!("to 1 % of that {} s after the {input}'s end", significant(decay_s, 3))
        }
        Some(_) => String::new(),
        None => "none to be seen".into(),
    }
}

/// The errors of the simulation itself.
fn simulation_errors(
    Simulated { error, played, metrics, .. }: &Simulated,
    play: &Play<'_>,
) -> String {
    if metrics.joints.len() > 1 {
        let [tip_m, joint_rad] = played.change();
        let [tip, joint, energy] =
            [tip_m, joint_rad, played.imbalance()].map(|number| significant(number, 2));
        return format!(
            "tip {tip} m, joints {joint} rad (half the step, finer polynomials);\n         energy {energy} of the largest"
        );
    }
    let measured = error.as_ref().map(|PlayError { tip, hub_angle }| match (&played.by, play.input) {
        (PlayedBy::Elastica(_), _) => {
            format!(
                "refinement {tip:.1e} of the tip's travel, {hub_angle:.1e} of the hub's peak angle"
            )
        }
        (_, Input::Torques(_)) => {
            format!(
                "mesh {tip:.1e} (of the tip's travel), {hub_angle:.1e} (of the hub's peak angle)"
            )
        }
        (_, Input::Angles(_)) => format!("mesh {tip:.1e} (of the tip's travel)"),
    });
    let unknown = "mesh not known: the damping cannot be on halved elements";
    measured.unwrap_or_else(|| unknown.to_owned())
}

/// Error of the linear model.
fn model_line(played: &Played) -> String {
    let Some(ModalPlay { model_error, .. }) = played.modes() else { return String::new() };
    let PlayedModelError { tip, deflection } = model_error;
    format!("off by {tip:.1e} of the tip's travel, {deflection:.1e} of the peak deflection")
}

fn tip_error_line(run: &Simulated) -> String {
    let Some(FollowedTarget { tip_error: error, .. }) = &run.target else { return String::new() };
    let worst = significant(error.worst_m, 4);
    let (time, share) = (instant(error.time_s, 3), significant(error.share, 3));
    format!("tip strays by up to {worst} m at {time} s, {share} of its travel")
}
