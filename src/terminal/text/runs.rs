//! The summaries that `solve` and `simulate` print.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use flexlink::beam::Mesh;
use flexlink::inverse::{Quantity, QuantityErrors, Solution};
use flexlink::link::{Damping, Link};
use flexlink::modal::{DampingLaw, REPORTED_MODES, REPORTED_ZEROS};
use flexlink::response::{Input, Interpolation, Play, PlayError, Simulation};
use flexlink::result::{
    ChannelComparison, Comparison, Metrics, MotorMetrics, Peak, PlayedMetrics, TipError,
};
use flexlink::store::PlayFindings;
use flexlink::text::{gigabytes, significant, visible};

/// The note about memory before it is taken.
pub(crate) fn memory_text(bytes: usize, blocks: usize) -> String {
    let gigabytes = gigabytes(bytes);
    let more = if blocks > 1 {
        format!("; the rows are made in {blocks} blocks, each transformed anew")
    } else {
        String::new()
    };
    format!("the motion of the nodes takes about {gigabytes} of memory{more}")
}

/// The summary of a solution; `written` says where its files are.
pub(crate) fn solve_text(solution: &Solution, metrics: &Metrics, written: String) -> String {
    let (link, law) = (solution.link(), solution.law());
    let frequencies = solution.natural_frequencies_rad_s(REPORTED_MODES);
    let periods: Vec<f64> = frequencies.iter().map(|omega| TAU / omega).collect();
    let zeros = solution.zeros_per_s(REPORTED_ZEROS);
    let hub = [metrics.peak_hub_angle_rad, metrics.peak_hub_rate_rad_s, metrics.peak_power_w];
    labelled(
        link,
        [
            ("link", link_line(link, solution.mesh())),
            ("damping", damping_line(link, law)),
            ("ratios", ratios_line(law, &frequencies)),
            ("periods", list(&periods, 5, " s")),
            ("zeros", list(&zeros, 4, " 1/s (real, ±)")),
            ("motion", motion_line(solution, metrics)),
            ("torque", acting(metrics.peak_torque_n_m, metrics.rms_torque_n_m)),
            ("rigid", rigid_line(metrics)),
            ("timing", timing_line(metrics.lead_s, metrics.lag_s)),
            ("hub", hub_line(&hub)),
            ("motor", metrics.motor.as_ref().map(motor_line).unwrap_or_default()),
            ("bending", bending_line(metrics)),
            ("band", band_line(solution)),
            ("errors", solution_errors(solution)),
            ("window", window_line(solution)),
            ("written", written),
        ],
    )
}

/// The summary of a torque or a hub motion that was played; `written` says where its files are.
pub(crate) fn simulate_text(
    link: &Link,
    play: &Play,
    simulation: &Simulation,
    metrics: &PlayedMetrics,
    &PlayFindings { error, tip_error, comparison }: &PlayFindings,
    written: String,
) -> String {
    let hub = [metrics.peak_hub_angle_rad, metrics.peak_hub_rate_rad_s, metrics.peak_power_w];
    labelled(
        link,
        [
            ("link", link_line(link, &simulation.mesh)),
            ("damping", played_damping(link, simulation, play)),
            ("ratios", ratios_line(&simulation.law, &simulation.natural_frequencies_rad_s)),
            ("input", played_hub(play)),
            ("torque", played_torque(play, metrics)),
            ("feedback", feedback_line(play)),
            ("modes", modes_line(simulation, play)),
            ("tip", tip_line(metrics)),
            ("hub", hub_line(&hub)),
            ("bending", deflection(metrics.peak_deflection_m)),
            ("after", residual_line(simulation)),
            ("decay", decay_line(simulation, play)),
            ("error", tip_error.map(tip_error_line).unwrap_or_default()),
            ("errors", simulation_errors(error)),
            ("measured", comparison.map(measured_text).unwrap_or_default()),
            ("written", written),
        ],
    )
}

/// A line for the times that are compared, then one for each channel.
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

fn channel_row(channel: &ChannelComparison, comparison: &Comparison) -> String {
    let name = channel.channel.name().to_owned();
    let rms = format!("{} {}", significant(channel.rms, 3), channel.channel.unit());
    let percent = |share: f64| format!("{} %", significant(100.0 * share, 2));
    let share = channel.share.map_or("-".to_owned(), percent);
    let Some(fit) = channel.fit else {
        let why = if channel.recorded_rms == 0.0 {
            "recorded at rest".to_owned()
        } else if channel.simulated_rms == 0.0 {
            "simulated at rest".to_owned()
        } else {
            let longest = significant(comparison.longest_delay_s, 2);
            format!("no delay within ±{longest} s")
        };
        return format!("{name:<15}{rms:>16}{share:>10}  {why}");
    };
    let delay = format!("{} s", significant(fit.delay_s, 3));
    row([name, rms, share, delay, format!("{:.4}", fit.gain), percent(fit.left)])
}

fn row([name, rms, share, delay, gain, left]: [String; 6]) -> String {
    format!("{name:<15}{rms:>16}{share:>10}{delay:>14}{gain:>10}{left:>11}")
}

/// The link's title, then a line for each label that has content.
fn labelled<'a>(link: &Link, lines: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let mut text = title(link);
    for (label, content) in lines.into_iter().filter(|(_, content)| !content.is_empty()) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{label:<8} {content}");
    }
    text
}

/// The link's title on a line of its own, if it has one.
pub(super) fn title(link: &Link) -> String {
    if link.title().is_empty() { String::new() } else { format!("{}\n", visible(link.title())) }
}

/// Each number with four significant digits.
fn four<const N: usize>(numbers: [f64; N]) -> [String; N] {
    numbers.map(|number| significant(number, 4))
}

/// Length, mesh and rigid inertia.
pub(super) fn link_line(link: &Link, mesh: &Mesh) -> String {
    let [length, inertia] = four([link.length_m(), link.rigid_inertia_kg_m2()]);
    let elements = mesh.elements().len();
    format!("{length} m, {elements} elements, rigid inertia {inertia} kg m²")
}

/// The damping law in words.
fn damping_line(link: &Link, law: &DampingLaw) -> String {
    match (link.damping(), law) {
        (Damping::None | Damping::Hysteretic { ratio: 0.0 }, _) => "none".into(),
        (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
            let [alpha, beta] = [*alpha_per_s, *beta_s].map(|number| significant(number, 3));
            format!("rayleigh, alpha {alpha} 1/s, beta {beta} s")
        }
        (Damping::Hysteretic { ratio }, _) => format!("hysteretic, ratio {ratio}"),
        (Damping::Modal { ratios }, _) if ratios.len() == 1 => {
            format!("modal, ratio {}", ratios[0])
        }
        (damping, _) => format!("{}, all modes of the mesh", damping.name()),
    }
}

/// The law, and what is played in its place where it has no equation in time.
fn played_damping(link: &Link, simulation: &Simulation, play: &Play) -> String {
    let is_hysteretic = matches!(link.damping(), Damping::Hysteretic { ratio } if *ratio > 0.0);
    let modes = match play.input {
        Input::Torque(_) => "mode",
        Input::HubAngle(_) => "mode of the held link",
    };
    let as_viscous = format!(", played as viscous in every {modes}");
    damping_line(link, &simulation.law) + if is_hysteretic { &as_viscous } else { "" }
}

/// Damping ratios of the modes, where they are not all one; empty otherwise.
fn ratios_line(law: &DampingLaw, frequencies_rad_s: &[f64]) -> String {
    let ratios = law.modal_ratios(frequencies_rad_s);
    let are_one = ratios.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits());
    if are_one { String::new() } else { list(&ratios, 2, "") }
}

/// Several numbers with `digits` significant digits each, and their unit.
fn list(values: &[f64], digits: usize, unit: &str) -> String {
    if values.is_empty() {
        return "none".into();
    }
    values.iter().map(|value| significant(*value, digits)).collect::<Vec<_>>().join(" ") + unit
}

fn motion_line(solution: &Solution, metrics: &Metrics) -> String {
    let motion = &solution.motion;
    let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
    let farthest_m = solution.tip.largest_travel_m();
    let [travel, farthest, duration] =
        four([motion.travel_m(), farthest_m, grid.time_s(until) - grid.time_s(from)]);
    let is_there_and_back = motion.travel_m().abs() <= 1e-6 * farthest_m;
    let travel =
        if is_there_and_back { format!("{farthest} m and back") } else { format!("{travel} m") };
    let velocity_m_s = metrics.peak_tip_velocity_m_s.value;
    let acceleration_m_s2 = metrics.peak_tip_acceleration_m_s2.value;
    let [step, velocity, acceleration] =
        [grid.step_s, velocity_m_s, acceleration_m_s2].map(|number| significant(number, 3));
    format!("{travel} in {duration} s at {step} s; peaks {velocity} m/s, {acceleration} m/s²")
}

/// The torque of hub or motor.
fn acting(peak_n_m: Peak, rms_n_m: f64) -> String {
    let peak = significant(peak_n_m.value, 4);
    let [time, rms] = [peak_n_m.time_s, rms_n_m].map(|number| significant(number, 3));
    format!("peak {peak} N m at {time} s, rms {rms} N m")
}

fn rigid_line(metrics: &Metrics) -> String {
    let peak = significant(metrics.peak_rigid_torque_n_m.value, 4);
    let ratio = significant(metrics.torque_ratio, 3);
    format!("peak {peak} N m for a rigid link, ratio {ratio}")
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

/// The largest angle, rate and power of the hub.
fn hub_line([angle_rad, rate_rad_s, power_w]: &[Peak; 3]) -> String {
    let [angle, rate, power] = four([angle_rad.value, rate_rad_s.value, power_w.value]);
    format!("turns by up to {angle} rad; peaks {rate} rad/s, {power} W")
}

/// Torque, rate and power of the motor, on its own side of the gear.
fn motor_line(motor: &MotorMetrics) -> String {
    let [rate, power] = four([motor.peak_rate_rad_s.value, motor.peak_power_w.value]);
    acting(motor.peak_torque_n_m, motor.rms_torque_n_m) + &format!("; {rate} rad/s, {power} W")
}

fn deflection(peak_m: Peak) -> String {
    format!("tip deflects by up to {} m", significant(peak_m.value, 4))
}

fn bending_line(metrics: &Metrics) -> String {
    let moment = significant(metrics.peak_root_moment_n_m.value, 4);
    deflection(metrics.peak_deflection_m) + &format!(", root moment up to {moment} N m")
}

fn band_line(solution: &Solution) -> String {
    let Some(cutoff_hz) = solution.band.cutoff_hz else {
        return "every frequency of the samples".into();
    };
    let (cutoff, error) = (significant(cutoff_hz, 3), solution.accuracy.tip);
    format!("to {cutoff} Hz; largest tip error {error:.1e} of the tip's travel")
}

/// One kind of error of a quantity, where it was measured.
type Kind = fn(QuantityErrors) -> Option<f64>;

/// The kind of error that is printed for the torque, too, if another quantity is worse.
const INPUT: &str = "input";

/// The worst error of each kind, and of which quantity it is, where that is not the torque.
fn solution_errors(solution: &Solution) -> String {
    let errors = &solution.accuracy;
    let kinds: [(&str, Kind); 5] = [
        ("mesh", |errors| Some(errors.mesh)),
        ("window", |errors| Some(errors.window)),
        ("step", |errors| errors.step),
        ("modes left out", |errors| errors.modes),
        (INPUT, |errors| errors.input),
    ];
    let worst = kinds.iter().filter_map(|(name, kind)| {
        kind(errors.errors.torque)?;
        let (quantity, error) = errors.of_kind(|e| kind(e).unwrap_or(0.0)).worst();
        let of = match quantity {
            Quantity::Torque => String::new(),
            other => format!(" ({})", other.name()),
        };
        // The input moves derivatives most; of the torque it must be known as well.
        let torque = errors.errors.torque.input;
        let torque = torque.filter(|_| *name == INPUT && quantity != Quantity::Torque);
        let torque = torque.map(|share| format!("{share:.1e} and ")).unwrap_or_default();
        Some(format!("{name} {torque}{error:.1e}{of}"))
    });
    wrapped(worst, " of the peak")
}

/// Columns of a line, and of the label that it begins with.
const COLUMNS: usize = 80;
const LABEL: usize = 9;

/// Items with commas between them and an end, on as many lines as 80 columns take.
fn wrapped(items: impl Iterator<Item = String>, end: &str) -> String {
    let (mut text, mut column) = (String::new(), LABEL);
    for item in items {
        let width = item.chars().count();
        if !text.is_empty() && column + 2 + width + end.len() > COLUMNS {
            text += ",\n";
            text += &" ".repeat(LABEL);
            column = LABEL;
        } else if !text.is_empty() {
            text += ", ";
            column += 2;
        }
        text += &item;
        column += width;
    }
    text + end
}

fn window_line(solution: &Solution) -> String {
    let (grid, band) = (&solution.grid, &solution.band);
    let (rows, frequencies) = (grid.len, band.frequencies);
    let [start, end] = four([grid.time_s(0), grid.end_s()]);
    let highest = significant(band.highest_hz, 3);
    format!("{start} … {end} s, {rows} rows; {frequencies} frequencies to {highest} Hz")
}

fn played_torque(play: &Play, metrics: &PlayedMetrics) -> String {
    let peak = significant(metrics.peak_torque_n_m.value, 4);
    if let Input::HubAngle(_) = play.input {
        return format!("peak {peak} N m, as the hub's motion takes it");
    }
    let between = match play.interpolation {
        Interpolation::Cubic => "cubic spline",
        Interpolation::Linear => "straight lines",
        Interpolation::Zero => "held from sample to sample",
    };
    format!("{}, {between}; peak {peak} N m", times(play))
}

/// Times of the samples that are played.
fn times(play: &Play) -> String {
    let grid = play.input.grid();
    let [start, end] = four([grid.time_s(0), grid.end_s()]);
    format!("{start} … {end} s at {} s", significant(grid.step_s, 3))
}

/// The hub's motion, where that is played.
fn played_hub(play: &Play) -> String {
    match play.input {
        Input::Torque(_) => String::new(),
        Input::HubAngle(_) => format!("hub angle, {}, quintic spline", times(play)),
    }
}

fn feedback_line(play: &Play) -> String {
    let Some(feedback) = play.feedback else { return String::new() };
    let [kp, kd] = four([feedback.stiffness_n_m_rad(), feedback.damping_n_m_s_rad()]);
    format!("{kp} N m/rad, {kd} N m s/rad around the reference")
}

fn modes_line(simulation: &Simulation, play: &Play) -> String {
    let selection = &simulation.selection;
    let [highest, band] = four([selection.highest_hz, selection.torque_band_hz]);
    let (modes, of) = (selection.modes, selection.of);
    let input = match play.input {
        Input::Torque(_) => "torque",
        Input::HubAngle(_) => "hub",
    };
    format!("{modes} of {of}, to {highest} Hz ({input} band to {band} Hz)")
}

fn tip_line(metrics: &PlayedMetrics) -> String {
    let [farthest, travel] = four([metrics.farthest_m, metrics.travel_m]);
    let velocity = significant(metrics.final_tip_velocity_m_s, 2);
    format!("moves by up to {farthest} m, by {travel} m in all; ends with {velocity} m/s")
}

/// The vibration after the torque. A share of a travel that the tip had hardly begun says nothing.
fn residual_line(simulation: &Simulation) -> String {
    let residual = &simulation.residual;
    let vibration = format!("vibrates by {} m", significant(residual.amplitude_m, 3));
    let share = (residual.share < 1.0).then(|| significant(residual.share, 2));
    let share = share.map(|share| format!(", {share} of its travel"));
    let frequency = residual.frequency_hz.map(|hertz| significant(hertz, 4));
    let frequency = frequency.map(|hertz| format!(", at {hertz} Hz"));
    vibration + &share.unwrap_or_default() + &frequency.unwrap_or_default()
}

/// How long that takes to die down; empty where nothing vibrates.
fn decay_line(simulation: &Simulation, play: &Play) -> String {
    let input = match play.input {
        Input::Torque(_) => "torque",
        Input::HubAngle(_) => "recording",
    };
    match simulation.residual.decay_s {
        Some(decay_s) if decay_s > 0.0 => {
            format!("to 1 % of that {} s after the {input}'s end", significant(decay_s, 3))
        }
        Some(_) => String::new(),
        None => "none to be seen".into(),
    }
}

/// The errors of the simulation itself.
fn simulation_errors(error: Option<&PlayError>) -> String {
    let Some(PlayError { tip, hub_angle }) = error else {
        return "mesh not known: the damping cannot be on halved elements".into();
    };
    format!("mesh {tip:.1e} (of the tip's travel), {hub_angle:.1e} (of the hub's peak angle)")
}

fn tip_error_line(error: &TipError) -> String {
    let worst = significant(error.worst_m, 4);
    let [time, share] = [error.time_s, error.share].map(|number| significant(number, 3));
    format!("tip strays by up to {worst} m at {time} s, {share} of its travel")
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
