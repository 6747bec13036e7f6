//! Summary from `simulate`.

use crate::link::{Damping, Link};
use crate::numeric::{TimeGrid, largest};
use crate::response::{
    Input, Interpolation, ModalPlay, Play, PlayError, Played, PlayedModelError, Simulation,
};
use crate::result::{ChannelComparison, Comparison, NoFit, PlayedMetrics, TipError};
use crate::store::PlayFindings;
use crate::text::{instant, plain, significant};

use super::layout::LABEL;
use super::runs::{damping_line, deflection, four, hub_line, labelled, link_line, turned};

/// Summary of a played torque or hub motion; `written` describes its files.
pub(crate) fn simulate_text(
    link: &Link,
    play: &Play,
    simulation: &Simulation,
    metrics: &PlayedMetrics,
    &PlayFindings { error, target, comparison, .. }: &PlayFindings,
    written: String,
) -> String {
    let own = metrics.hub();
    let turns = turned(None, own.peak_hub_angle_rad);
    labelled(
        link.title(),
        [
            ("link", link_line(link, &simulation.mesh)),
            ("damping", played_damping(link, simulation, play)),
            ("gravity", weight_line(link, simulation)),
            ("input", played_hub(play)),
            ("torque", played_torque(play, metrics)),
            ("feedback", feedback_line(play)),
            played_by(simulation, play),
            ("tip", tip_line(metrics, play.cycle_turn_rad.is_some())),
            ("hub", hub_line(&turns, [own.peak_hub_rate_rad_s, own.peak_power_w])),
            ("bending", own.peak_deflection_m.map(deflection).unwrap_or_default()),
            ("after", residual_line(simulation)),
            ("decay", decay_line(simulation, play)),
            ("error", target.map(|target| tip_error_line(&target.tip_error)).unwrap_or_default()),
            ("errors", simulation_errors(error, simulation, play)),
            ("model", model_line(simulation)),
            ("measured", comparison.map(measured_text).unwrap_or_default()),
            ("written", written),
        ],
    )
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

/// Share of the recording about its mean, of the longest delay, or of the largest torque, below which no number is
/// printed.
const NOTHING: f64 = 1e-6;

fn channel_row(channel: &ChannelComparison, comparison: &Comparison) -> String {
    let name = channel.channel.name().to_owned();
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

/// The law, and its substitute if it has no equation in time.
fn played_damping(link: &Link, simulation: &Simulation, play: &Play) -> String {
    let is_hysteretic = matches!(link.damping(), Damping::Hysteretic { ratio } if *ratio > 0.0);
    let modes = match play.input {
        Input::Torque(_) => "mode",
        Input::HubAngle(_) => "held mode",
    };
    let as_viscous = format!(", played as viscous in every {modes}");
    damping_line(link, &simulation.law, &simulation.natural_frequencies_rad_s)
        + if is_hysteretic { &as_viscous } else { "" }
}

fn played_torque(play: &Play, metrics: &PlayedMetrics) -> String {
    let peak = significant(metrics.hub().peak_torque_n_m.value, 4);
    if let Input::HubAngle(_) = play.input {
        return format!("peak {peak} N m, as the hub's motion takes it");
    }
    let (times, between) = (times(&play.input.grid()), between(play.interpolation));
    format!("{times}, {between}; peak {peak} N m")
}

/// Course of a torque between its samples.
pub(super) fn between(interpolation: Interpolation) -> &'static str {
    match interpolation {
        Interpolation::Cubic => "cubic spline",
        Interpolation::Linear => "straight lines",
        Interpolation::Zero => "held from sample to sample",
    }
}

/// Times of the played samples.
pub(super) fn times(grid: &TimeGrid) -> String {
    let [start, end] = [grid.time_s(0), grid.end_s()].map(|time_s| instant(time_s, 4));
    format!("{start} … {end} s at {} s", significant(grid.step_s, 3))
}

/// The hub's motion, if it is the input.
fn played_hub(play: &Play) -> String {
    match play.input {
        Input::Torque(_) => String::new(),
        Input::HubAngle(_) => format!("hub angle, {}, quintic spline", times(&play.input.grid())),
    }
}

fn feedback_line(play: &Play) -> String {
    let Some(feedback) = play.feedback else { return String::new() };
    let [kp, kd] = four([feedback.stiffness_n_m_rad(), feedback.damping_n_m_s_rad()]);
    format!("{kp} N m/rad, {kd} N m s/rad around the reference")
}

/// Torque that holds a link with weight before it moves.
fn weight_line(link: &Link, simulation: &Simulation) -> String {
    let acting = link.gravity().filter(|own| own.acts());
    let (Some(gravity), Played::Elastica(bent)) = (acting, &simulation.played) else {
        return String::new();
    };
    let [along_x, along_y] = gravity.acceleration_m_s2.map(plain);
    // For a link that hangs straight the holding torque is round-off.
    let is_held = bent.holding_n_m.abs() > NOTHING * largest(&simulation.torque_n_m);
    let holding_n_m = if is_held { bent.holding_n_m } else { 0.0 };
    let [angle, held] = four([simulation.hub_angle_rad[0], holding_n_m]);
    format!("{along_x}, {along_y} m/s²; at first {held} N m hold the hub at {angle} rad")
}

/// Method of the simulation.
fn played_by(simulation: &Simulation, play: &Play) -> (&'static str, String) {
    match &simulation.played {
        Played::Modes(modes) => ("modes", modes_line(modes, play)),
        Played::Elastica(bent) => {
            let (angles, steps) = (bent.angles, bent.steps);
            let line = format!("all terms: {angles} angles, {steps} steps from sample to sample");
            ("order", line)
        }
    }
}

fn modes_line(modes: &ModalPlay, play: &Play) -> String {
    let selection = &modes.selection;
    let [highest, band] = four([selection.highest_hz, selection.torque_band_hz]);
    let (modes, of) = (selection.modes, selection.of);
    let input = match play.input {
        Input::Torque(_) => "torque",
        Input::HubAngle(_) => "hub",
    };
    format!("{modes} of {of}, to {highest} Hz ({input} band to {band} Hz)")
}

pub(super) fn tip_line(metrics: &PlayedMetrics, is_cycle: bool) -> String {
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

/// The vibration after the torque. A share of the travel is omitted if the tip had hardly begun to move.
fn residual_line(simulation: &Simulation) -> String {
    let Some(residual) = simulation.modes().and_then(|modes| modes.residual) else {
        return String::new();
    };
    let vibration = format!("vibrates by {} m", significant(residual.amplitude_m, 3));
    let share = (residual.share < 1.0).then(|| significant(residual.share, 2));
    let share = share.map(|share| format!(", {share} of its peak displacement"));
    let frequency = residual.frequency_hz.map(|hertz| significant(hertz, 4));
    let frequency = frequency.map(|hertz| format!(", at {hertz} Hz"));
    vibration + &share.unwrap_or_default() + &frequency.unwrap_or_default()
}

/// Decay time of the vibration; empty without a vibration.
fn decay_line(simulation: &Simulation, play: &Play) -> String {
    let input = match play.input {
        Input::Torque(_) => "torque",
        Input::HubAngle(_) => "recording",
    };
    let Some(residual) = simulation.modes().and_then(|modes| modes.residual) else {
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

/// Errors of the simulation.
fn simulation_errors(error: Option<&PlayError>, simulation: &Simulation, play: &Play) -> String {
    let measured = error.map(|PlayError { tip, hub_angle }| match (&simulation.played, play.input) {
        (Played::Elastica(_), _) => {
            format!("refinement {tip:.1e} of the tip's travel, {hub_angle:.1e} of the hub's peak angle")
        }
        (_, Input::Torque(_)) => {
            format!("mesh {tip:.1e} (of the tip's travel), {hub_angle:.1e} (of the hub's peak angle)")
        }
        (_, Input::HubAngle(_)) => format!("mesh {tip:.1e} (of the tip's travel)"),
    });
    let unknown = "mesh not known: the damping cannot be on halved elements";
    measured.unwrap_or_else(|| unknown.to_owned())
}

/// Error of the linear model.
fn model_line(simulation: &Simulation) -> String {
    let Some(ModalPlay { model_error, .. }) = simulation.modes() else { return String::new() };
    let PlayedModelError { tip, deflection } = model_error;
    format!("off by {tip:.1e} of the tip's travel, {deflection:.1e} of the peak deflection")
}

pub(super) fn tip_error_line(error: &TipError) -> String {
    let worst = significant(error.worst_m, 4);
    let (time, share) = (instant(error.time_s, 3), significant(error.share, 3));
    format!("tip strays by up to {worst} m at {time} s, {share} of its travel")
}
