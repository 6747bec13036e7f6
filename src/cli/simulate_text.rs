//! The short summary that `simulate` prints.

use std::fmt::Write as _;

use flexlink::link::{Damping, Link};
use flexlink::response::{Interpolation, Play, Simulation};
use flexlink::result::{PlayedMetrics, TipError};

use super::number::significant;
use super::solve_text::damping_line;

/// The summary, lines of at most 80 columns.
pub(crate) fn simulate_text(
    link: &Link,
    play: &Play,
    simulation: &Simulation,
    metrics: &PlayedMetrics,
    tip_error: Option<&TipError>,
    written: &str,
) -> String {
    let mut text = String::new();
    if !link.title().is_empty() {
        text += link.title();
        text.push('\n');
    }
    for (label, content) in [
        ("link", link_line(link, simulation)),
        ("damping", played_damping(link, simulation)),
        ("torque", torque_line(play, metrics)),
        ("feedback", feedback_line(play)),
        ("modes", modes_line(simulation)),
        ("tip", tip_line(metrics)),
        ("hub", hub_line(metrics)),
        ("after", residual_line(simulation)),
        ("error", tip_error.map_or(String::new(), error_line)),
        ("written", written.to_owned()),
    ] {
        if !content.is_empty() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{label:<8} {content}");
        }
    }
    text
}

fn link_line(link: &Link, simulation: &Simulation) -> String {
    format!(
        "{} m, {} elements, rigid inertia {} kg m²",
        significant(link.length_m(), 4),
        simulation.mesh.elements().len(),
        significant(link.rigid_inertia_kg_m2(), 4)
    )
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
        Interpolation::Cubic => "cubic",
        Interpolation::Linear => "straight",
    };
    format!(
        "{} … {} s at {} s, {between} between; peak {} N m",
        significant(grid.time_s(0), 4),
        significant(grid.time_s(grid.len - 1), 4),
        significant(grid.step_s, 3),
        significant(metrics.peak_torque_n_m.value, 4)
    )
}

fn feedback_line(play: &Play) -> String {
    play.feedback.map_or(String::new(), |feedback| {
        format!(
            "{} N m/rad, {} N m s/rad around the reference",
            feedback.stiffness_n_m_rad(),
            feedback.damping_n_m_s_rad()
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
        "moves by up to {} m, ends {} m away; deflects by up to {} m",
        significant(metrics.farthest_m, 4),
        significant(metrics.travel_m, 4),
        significant(metrics.peak_deflection_m.value, 4)
    )
}

fn hub_line(metrics: &PlayedMetrics) -> String {
    format!(
        "turns by up to {} rad; peaks {} rad/s, {} W",
        significant(metrics.peak_hub_angle_rad.value, 4),
        significant(metrics.peak_hub_rate_rad_s.value, 4),
        significant(metrics.peak_power_w.value, 4)
    )
}

fn residual_line(simulation: &Simulation) -> String {
    let residual = &simulation.residual;
    let Some(frequency_hz) = residual.frequency_hz else {
        return format!("vibrates by {:.1e} m", residual.amplitude_m);
    };
    let decay = residual.decay_s.map_or("does not decay".to_owned(), |decay_s| {
        format!("1 % of it after {} s", significant(decay_s, 3))
    });
    format!(
        "vibrates by {} m, {:.1e} of the way, at {} Hz; {decay}",
        significant(residual.amplitude_m, 3),
        residual.share,
        significant(frequency_hz, 4)
    )
}

fn error_line(error: &TipError) -> String {
    format!(
        "tip strays by up to {:.3e} m at {} s, {:.2e} of the way",
        error.worst_m,
        significant(error.time_s, 3),
        error.share
    )
}
