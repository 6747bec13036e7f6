//! The short summary that `simulate` prints.

use flexlink::link::{Damping, Link};
use flexlink::numeric::significant;
use flexlink::response::{Interpolation, Play, PlayError, Simulation};
use flexlink::result::{PlayedMetrics, TipError};

use super::lines::{damping_line, hub_line, labelled, link_line, ratios_line};

/// The summary, lines of at most 80 columns.
pub(crate) fn simulate_text(
    link: &Link,
    play: &Play,
    simulation: &Simulation,
    metrics: &PlayedMetrics,
    (error, tip_error): (Option<&PlayError>, Option<&TipError>),
    written: &str,
) -> String {
    let lines = [
        ("link", link_line(link, &simulation.mesh)),
        ("damping", played_damping(link, simulation)),
        ("ratios", ratios_line(&simulation.law, &simulation.natural_frequencies_rad_s)),
        ("torque", torque_line(play, metrics)),
        ("feedback", feedback_line(play)),
        ("modes", modes_line(simulation)),
        ("tip", tip_line(metrics)),
        (
            "hub",
            hub_line(metrics.peak_hub_angle_rad, metrics.peak_hub_rate_rad_s, metrics.peak_power_w),
        ),
        ("bending", bending_line(metrics)),
        ("after", residual_line(simulation)),
        ("decay", decay_line(simulation)),
        ("error", tip_error.map_or(String::new(), error_line)),
        ("errors", errors_line(error)),
        ("written", written.to_owned()),
    ];
    labelled(link, &lines)
}

/// The law, and what is played in its place where it has no equation in time.
fn played_damping(link: &Link, simulation: &Simulation) -> String {
    let line = damping_line(link, &simulation.law);
    match link.damping() {
        Damping::Hysteretic { ratio } if *ratio > 0.0 => {
            format!("{line}, played as viscous in every mode")
        }
        _ => line,
    }
}

fn torque_line(play: &Play, metrics: &PlayedMetrics) -> String {
    let grid = play.torque.grid();
    let between = match play.interpolation {
        Interpolation::Cubic => "cubic spline",
        Interpolation::Linear => "straight lines",
    };
    format!(
        "{} … {} s at {} s, {between}; peak {} N m",
        significant(grid.time_s(0), 4),
        significant(grid.end_s(), 4),
        significant(grid.step_s, 3),
        significant(metrics.peak_torque_n_m.value, 4)
    )
}

fn feedback_line(play: &Play) -> String {
    play.feedback.map_or(String::new(), |feedback| {
        format!(
            "{} N m/rad, {} N m s/rad around the reference",
            significant(feedback.stiffness_n_m_rad(), 4),
            significant(feedback.damping_n_m_s_rad(), 4)
        )
    })
}

fn modes_line(simulation: &Simulation) -> String {
    let selection = &simulation.selection;
    format!(
        "{} of {}, to {} Hz (torque band to {} Hz)",
        selection.modes,
        selection.of,
        significant(selection.highest_hz, 4),
        significant(selection.torque_band_hz, 4)
    )
}

fn tip_line(metrics: &PlayedMetrics) -> String {
    format!(
        "moves by up to {} m, by {} m in all; ends with {} m/s",
        significant(metrics.farthest_m, 4),
        significant(metrics.travel_m, 4),
        significant(metrics.final_tip_velocity_m_s, 2)
    )
}

fn bending_line(metrics: &PlayedMetrics) -> String {
    format!("tip deflects by up to {} m", significant(metrics.peak_deflection_m.value, 4))
}

/// What vibrates after the torque. A share of a way that the tip had hardly begun says nothing.
fn residual_line(simulation: &Simulation) -> String {
    let residual = &simulation.residual;
    let share = if residual.share < 1.0 {
        format!(", {} of the way", significant(residual.share, 2))
    } else {
        String::new()
    };
    let frequency = residual
        .frequency_hz
        .map_or(String::new(), |hertz| format!(", at {} Hz", significant(hertz, 4)));
    format!("vibrates by {} m{share}{frequency}", significant(residual.amplitude_m, 3))
}

/// How long that takes to die down; empty where nothing vibrates.
fn decay_line(simulation: &Simulation) -> String {
    match simulation.residual.decay_s {
        Some(decay_s) if decay_s > 0.0 => {
            format!("to 1 % of that {} s after the torque's end", significant(decay_s, 3))
        }
        Some(_) => String::new(),
        None => "none to be seen".into(),
    }
}

/// What the simulation is worth.
fn errors_line(error: Option<&PlayError>) -> String {
    let Some(PlayError { tip, hub_angle }) = error else {
        return "mesh not known: the damping cannot be on halved elements".into();
    };
    format!("mesh {tip:.1e} (of the tip's way), {hub_angle:.1e} (of the hub's peak angle)")
}

fn error_line(error: &TipError) -> String {
    format!(
        "tip strays by up to {} m at {} s, {} of the way",
        significant(error.worst_m, 4),
        significant(error.time_s, 3),
        significant(error.share, 3)
    )
}
