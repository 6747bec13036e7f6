//! The short summary that `solve` prints.

use flexlink::inverse::{Quantity, QuantityErrors, Solution};
use flexlink::modal::{REPORTED_MODES, REPORTED_ZEROS};
use flexlink::numeric::{gigabytes, significant};
use flexlink::result::{Metrics, MotorMetrics};

use super::lines::list;
use super::lines::{damping_line, hub_line, labelled, link_line, ratios_line};

/// What is said of the memory before it is taken.
pub(crate) fn memory_text(bytes: usize, blocks: usize) -> String {
    let gigabytes = gigabytes(bytes);
    let more = if blocks > 1 {
        format!("; the rows are made in {blocks} blocks, each transformed anew")
    } else {
        String::new()
    };
    format!("the motion of the nodes takes about {gigabytes} of memory{more}")
}

/// The summary, lines of at most 80 columns.
pub(crate) fn solve_text(solution: &Solution, metrics: &Metrics, written: &str) -> String {
    let link = solution.link();
    let frequencies = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let zeros = solution.zeros_per_s(REPORTED_ZEROS);
    let lines = [
        ("link", link_line(link, solution.mesh())),
        ("damping", damping_line(link, solution.law())),
        ("ratios", ratios_line(solution.law(), &frequencies)),
        ("periods", with_unit(&list(&periods(&frequencies), 5), "s")),
        ("zeros", with_unit(&list(&zeros, 4), "1/s (real, ±)")),
        ("motion", motion_line(solution, metrics)),
        ("torque", torque_line(metrics)),
        ("rigid", rigid_line(metrics)),
        ("timing", timing_line(metrics.lead_s, metrics.lag_s)),
        (
            "hub",
            hub_line(metrics.peak_hub_angle_rad, metrics.peak_hub_rate_rad_s, metrics.peak_power_w),
        ),
        ("motor", metrics.motor.as_ref().map(motor_line).unwrap_or_default()),
        ("bending", bending_line(metrics)),
        ("band", band_line(solution)),
        ("errors", errors_line(solution)),
        ("window", window_line(solution)),
        ("written", written.to_owned()),
    ];
    labelled(link, &lines)
}

/// Numbers and their unit, or "none" alone.
fn with_unit(numbers: &str, unit: &str) -> String {
    if numbers == "none" { numbers.to_owned() } else { format!("{numbers} {unit}") }
}

fn periods(frequencies_rad_s: &[f64]) -> Vec<f64> {
    frequencies_rad_s.iter().map(|omega| std::f64::consts::TAU / omega).collect()
}

fn motion_line(solution: &Solution, metrics: &Metrics) -> String {
    let motion = &solution.motion;
    let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
    let farthest_m = solution.tip.largest_travel_m();
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

fn timing_line(lead_s: f64, lag_s: f64) -> String {
    let [from, to] = [lead_s, lag_s].map(|time_s| significant(time_s.abs(), 3));
    if lead_s >= 0.0 && lag_s >= 0.0 {
        return format!("from {from} s before to {to} s after the tip's motion (2 % level)");
    }
    // A slow motion begins and ends with less torque than that.
    let begins = if lead_s < 0.0 { "after" } else { "before" };
    let ends = if lag_s < 0.0 { "before" } else { "after" };
    format!("{from} s {begins} the tip starts to {to} s {ends} it stops (2 % level)")
}

/// What the motor does, on its own side of the gear.
fn motor_line(motor: &MotorMetrics) -> String {
    format!(
        "peak {} N m at {} s, rms {} N m; {} rad/s, {} W",
        significant(motor.peak_torque_n_m.value, 4),
        significant(motor.peak_torque_n_m.time_s, 3),
        significant(motor.rms_torque_n_m, 3),
        significant(motor.peak_rate_rad_s.value, 4),
        significant(motor.peak_power_w.value, 4)
    )
}

fn bending_line(metrics: &Metrics) -> String {
    format!(
        "tip deflects by up to {} m, root moment up to {} N m",
        significant(metrics.peak_deflection_m.value, 4),
        significant(metrics.peak_root_moment_n_m.value, 4)
    )
}

fn band_line(solution: &Solution) -> String {
    match solution.band.cutoff_hz {
        Some(cutoff_hz) => format!(
            "to {} Hz; the tip within {:.1e} of its way of the motion asked for",
            significant(cutoff_hz, 3),
            solution.accuracy.tip
        ),
        None => "every frequency of the samples".into(),
    }
}

/// Columns of a line, and of the label that it begins with.
const COLUMNS: usize = 80;
const LABEL: usize = 9;

/// One kind of error of a quantity, where it was measured.
type Kind = fn(QuantityErrors) -> Option<f64>;

/// The worst error of each kind, and of which quantity it is, where that is not the torque.
fn errors_line(solution: &Solution) -> String {
    let errors = &solution.accuracy;
    let kinds: [(&str, Kind); 4] = [
        ("mesh", |errors| Some(errors.mesh)),
        ("window", |errors| Some(errors.window)),
        ("step", |errors| errors.step),
        ("modes left out", |errors| errors.modes),
    ];
    let worst = kinds.iter().filter_map(|(name, kind)| {
        kind(errors.errors.torque)?;
        let (quantity, error) = errors.of_kind(|e| kind(e).unwrap_or(0.0)).worst();
        let of = match quantity {
            Quantity::Torque => String::new(),
            other => format!(" ({})", other.name()),
        };
        Some(format!("{name} {error:.1e}{of}"))
    });
    wrapped(worst, " of the peak")
}

/// Items with commas between them and an end, on as many lines as 80 columns take.
fn wrapped(items: impl Iterator<Item = String>, end: &str) -> String {
    let (mut text, mut column) = (String::new(), LABEL);
    for item in items {
        let width = item.chars().count() + end.len().max(1);
        if column > LABEL {
            text.push(',');
            if column + 2 + width > COLUMNS {
                text.push('\n');
                text.push_str(&" ".repeat(LABEL));
                column = LABEL;
            } else {
                text.push(' ');
                column += 2;
            }
        }
        column += item.chars().count();
        text.push_str(&item);
    }
    text + end
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torque_that_acts_within_the_motion_alone_is_told_so() {
        let expected = [
            ((0.305, 0.319), "from 0.305 s before to 0.319 s after the tip's motion (2 % level)"),
            ((-19.3, -20.1), "19.3 s after the tip starts to 20.1 s before it stops (2 % level)"),
            (
                (-0.0193, 0.25),
                "0.0193 s after the tip starts to 0.250 s after it stops (2 % level)",
            ),
            (
                (0.1, -0.0201),
                "0.100 s before the tip starts to 0.0201 s before it stops (2 % level)",
            ),
        ];
        for ((lead_s, lag_s), text) in expected {
            assert_eq!(timing_line(lead_s, lag_s), text);
            assert!(LABEL + text.chars().count() <= COLUMNS, "{text}");
        }
    }

    #[test]
    fn much_memory_is_told_with_what_becomes_slower() {
        let one = "the motion of the nodes takes about 0.54 GB of memory";
        assert_eq!(memory_text(540_000_000, 1), one);
        let many = "about 1.1 GB of memory; the rows are made in 3 blocks, each transformed anew";
        assert!(memory_text(1_100_000_000, 3).ends_with(many));
    }
}
