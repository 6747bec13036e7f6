//! The short summary that `solve` prints.

use std::fmt::Write as _;

use flexlink::inverse::Solution;
use flexlink::link::{Damping, Link};
use flexlink::modal::DampingLaw;
use flexlink::motion::TipMotion;
use flexlink::result::Metrics;

use super::number::{list, significant};

/// The summary, lines of at most 80 columns.
pub(crate) fn solve_text(
    link: &Link,
    motion: &TipMotion,
    solution: &Solution,
    metrics: &Metrics,
    written: &str,
) -> String {
    let mut text = String::new();
    if !link.title().is_empty() {
        text += link.title();
        text.push('\n');
    }
    for (label, content) in [
        ("link", link_line(link, solution)),
        ("damping", damping_line(link, solution.law())),
        ("ratios", ratios_line(solution.law(), &solution.natural_frequencies_rad_s)),
        ("periods", with_unit(&list(&periods(solution), 5), "s")),
        ("zeros", with_unit(&list(&solution.zeros_per_s, 4), "1/s (real, ±)")),
        ("motion", motion_line(motion, solution, metrics)),
        ("torque", torque_line(metrics)),
        ("rigid", rigid_line(metrics)),
        ("timing", timing_line(metrics)),
        ("hub", hub_line(metrics)),
        ("bending", bending_line(metrics)),
        ("errors", errors_line(solution)),
        ("window", window_line(solution)),
        ("written", written.to_owned()),
    ] {
        if content.is_empty() {
            continue;
        }
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{label:<8} {content}");
    }
    text
}

/// Numbers and their unit, or "none" alone.
fn with_unit(numbers: &str, unit: &str) -> String {
    if numbers == "none" { numbers.to_owned() } else { format!("{numbers} {unit}") }
}

fn periods(solution: &Solution) -> Vec<f64> {
    let frequencies = &solution.natural_frequencies_rad_s;
    frequencies.iter().map(|omega| std::f64::consts::TAU / omega).collect()
}

fn link_line(link: &Link, solution: &Solution) -> String {
    format!(
        "{} m, {} elements, rigid inertia {} kg m²",
        significant(link.length_m(), 4),
        solution.mesh().elements().len(),
        significant(link.rigid_inertia_kg_m2(), 4)
    )
}

pub(crate) fn damping_line(link: &Link, law: &DampingLaw) -> String {
    match (link.damping(), law) {
        (Damping::None | Damping::Hysteretic { ratio: 0.0 }, _) => "none".into(),
        (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
            let (alpha, beta) = (significant(*alpha_per_s, 3), significant(*beta_s, 3));
            format!("rayleigh, alpha {alpha} 1/s, beta {beta} s")
        }
        (Damping::Hysteretic { ratio }, _) => format!("hysteretic, ratio {ratio}"),
        (Damping::Modal { ratios }, _) if ratios.len() == 1 => {
            format!("modal, ratio {}", ratios[0])
        }
        (damping, _) => format!("{}, all modes of the mesh", damping.name()),
    }
}

/// Damping ratios of the modes, where they are not all one; empty otherwise.
pub(crate) fn ratios_line(law: &DampingLaw, frequencies_rad_s: &[f64]) -> String {
    let ratios = law.modal_ratios(frequencies_rad_s);
    let first = ratios.first().map_or(0, |ratio| ratio.to_bits());
    let are_one = ratios.iter().all(|ratio| ratio.to_bits() == first);
    if are_one { String::new() } else { list(&ratios, 2) }
}

fn motion_line(motion: &TipMotion, solution: &Solution, metrics: &Metrics) -> String {
    let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
    let farthest_m = solution.tip.farthest_m();
    let way = if motion.travel_m().abs() > 1e-6 * farthest_m {
        format!("{} m", significant(motion.travel_m(), 4))
    } else {
        format!("{} m and back", significant(farthest_m, 4))
    };
    format!(
        "{way} in {} s at {} s; peaks {} m/s, {} m/s²",
        significant(grid.time_s(until) - grid.time_s(from), 4),
        significant(grid.step_s, 3),
        significant(metrics.peak_tip_velocity_m_s.value, 3),
        significant(metrics.peak_tip_acceleration_m_s2.value, 3)
    )
}

fn torque_line(metrics: &Metrics) -> String {
    format!(
        "peak {} N m at {} s, rms {} N m",
        significant(metrics.peak_torque_n_m.value, 4),
        significant(metrics.peak_torque_n_m.time_s, 3),
        significant(metrics.rms_torque_n_m, 3)
    )
}

fn rigid_line(metrics: &Metrics) -> String {
    format!(
        "peak {} N m for a rigid link, ratio {}",
        significant(metrics.peak_rigid_torque_n_m.value, 4),
        significant(metrics.torque_ratio, 3)
    )
}

fn timing_line(metrics: &Metrics) -> String {
    format!(
        "from {} s before to {} s after the tip's motion (2 % level)",
        significant(metrics.lead_s, 3),
        significant(metrics.lag_s, 3)
    )
}

fn hub_line(metrics: &Metrics) -> String {
    format!(
        "turns by up to {} rad; peaks {} rad/s, {} W",
        significant(metrics.peak_hub_angle_rad.value, 4),
        significant(metrics.peak_hub_rate_rad_s.value, 4),
        significant(metrics.peak_power_w.value, 4)
    )
}

fn bending_line(metrics: &Metrics) -> String {
    format!(
        "tip deflects by up to {} m, root moment up to {} N m",
        significant(metrics.peak_deflection_m.value, 4),
        significant(metrics.peak_root_moment_n_m.value, 4)
    )
}

fn errors_line(solution: &Solution) -> String {
    let accuracy = &solution.accuracy;
    let truncation = accuracy
        .truncation_error
        .map_or(String::new(), |error| format!(", modes left out {error:.1e}"));
    format!(
        "mesh {:.1e}, edge {:.1e}{truncation} (of the peak torque)",
        accuracy.mesh_error, accuracy.edge_error
    )
}

fn window_line(solution: &Solution) -> String {
    let (grid, band) = (&solution.grid, &solution.band);
    format!(
        "{} … {} s, {} rows; {} frequencies to {} Hz",
        significant(grid.time_s(0), 4),
        significant(grid.time_s(grid.len - 1), 4),
        grid.len,
        band.frequencies,
        significant(band.highest_hz, 3)
    )
}
