use super::play::{Driving, Play};
use super::simulation::Simulation;
use super::stepper::Stepper;
use crate::numeric::{FourierPair, angular_frequency, fast_length};

/// Vibration has died down when it stays below this share of its amplitude.
const DECAYED: f64 = 0.01;

/// Vibration below this share of the tip's way is round-off.
const ROUND_OFF: f64 = 1e-12;

/// Periods of the first mode that are watched at a time, and how often they are.
const PERIODS: f64 = 4.0;
const WATCHES: usize = 100;

/// Most samples that are watched.
const LONGEST: usize = 1 << 19;

/// Zeros beside the vibration, in lengths of it, so that its frequency is read between bins.
const ZEROS: usize = 3;

/// What the tip does after the torque's last sample beside turning with the rigid link; with
/// feedback, beside standing where the reference ends.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ResidualVibration {
    /// Largest excursion in m.
    pub amplitude_m: f64,
    /// The same over the tip's largest displacement from where it started.
    pub share: f64,
    /// Frequency of its strongest part in Hz; none where nothing vibrates, or where the step is too
    /// long to tell.
    pub frequency_hz: Option<f64>,
    /// Time in s from the torque's last sample until it stays below 1 % of its amplitude; none
    /// where it does not within 400 periods of the first mode.
    pub decay_s: Option<f64>,
}

impl ResidualVibration {
    /// Goes on from the last sample until the vibration has died down.
    pub(super) fn of(
        simulation: &Simulation,
        play: &Play,
        driving: &Driving,
        mut stepper: Stepper,
    ) -> Self {
        let step_s = simulation.grid.step_s;
        let reading = Reading::new(simulation, play);
        let first = simulation.driven - 1;
        let mut vibration: Vec<f64> = (first..simulation.grid.len)
            .map(|sample| reading.of(simulation.state(sample).0))
            .collect();
        let period_s = simulation.equations.first_period_s().unwrap_or(step_s);
        let watch = ((PERIODS * period_s / step_s).ceil() as usize).clamp(16, LONGEST / 8);
        for _ in 0..WATCHES {
            let amplitude = largest(&vibration);
            let recent = &vibration[vibration.len().saturating_sub(watch)..];
            let has_died = recent.len() == watch && largest(recent) <= DECAYED * amplitude;
            if has_died || vibration.len() > LONGEST {
                break;
            }
            for _ in 0..watch {
                stepper.advance(&driving.after(usize::MAX));
                vibration.push(reading.of(&stepper.coordinates()));
            }
        }
        let measured = Self::measured(&vibration, step_s, simulation.tip.farthest_m(), watch);
        // Fewer than two steps to a period show another frequency than the link's.
        let is_seen = |_: &f64| period_s > 2.0 * step_s;
        Self { frequency_hz: measured.frequency_hz.filter(is_seen), ..measured }
    }

    fn measured(vibration: &[f64], step_s: f64, way_m: f64, watch: usize) -> Self {
        let amplitude_m = largest(vibration);
        let share = if way_m > 0.0 { amplitude_m / way_m } else { 0.0 };
        if share <= ROUND_OFF {
            return Self { amplitude_m, share, frequency_hz: None, decay_s: Some(0.0) };
        }
        let stays = |x: &f64| x.abs() > DECAYED * amplitude_m;
        let last = vibration.iter().rposition(stays).unwrap_or(0);
        let has_died = last + watch <= vibration.len();
        Self {
            amplitude_m,
            share,
            frequency_hz: strongest_hz(&vibration[..=last], step_s),
            decay_s: has_died.then_some((last + 1) as f64 * step_s),
        }
    }
}

/// Reads the vibration of the tip off modal coordinates.
struct Reading {
    tips: Vec<f64>,
    /// Where the tip will stand.
    goal_m: f64,
}

impl Reading {
    fn new(simulation: &Simulation, play: &Play) -> Self {
        let mut tips = simulation.equations.tips(&simulation.mesh);
        let held = play.feedback.filter(|feedback| feedback.stiffness_n_m_rad() > 0.0);
        let goal_m = held.map_or(0.0, |feedback| feedback.turn_rad() * simulation.mesh.length_m());
        if held.is_none() {
            // Turning with the rigid link is no vibration.
            tips[0] = 0.0;
        }
        Self { tips, goal_m }
    }

    fn of(&self, coordinates: &[f64]) -> f64 {
        let tip: f64 = coordinates.iter().zip(&self.tips).map(|(q, tip)| q * tip).sum();
        tip - self.goal_m
    }
}

fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Frequency of the strongest part: the highest point of the spectrum under a Hann window, by a
/// parabola through the logarithms around it.
fn strongest_hz(vibration: &[f64], step_s: f64) -> Option<f64> {
    let len = vibration.len();
    if len < 8 {
        return None;
    }
    let padded = fast_length((1 + ZEROS) * len);
    let window = |k: usize| (std::f64::consts::PI * (k as f64 + 0.5) / len as f64).sin().powi(2);
    // The mean under the window, so that none of it is left to outshine a decaying vibration.
    let weights: f64 = (0..len).map(window).sum();
    let mean = vibration.iter().enumerate().map(|(k, x)| window(k) * x).sum::<f64>() / weights;
    let mut samples: Vec<f64> =
        vibration.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    samples.resize(padded, 0.0);
    let sizes: Vec<f64> =
        FourierPair::new(padded).amplitudes(samples).iter().map(|x| x.norm()).collect();
    let peak = (1..sizes.len() - 1).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]))?;
    if sizes[peak - 1..=peak + 1].contains(&0.0) {
        return None;
    }
    let [before, at, after] = [-1, 0, 1].map(|k| sizes[peak.saturating_add_signed(k)].ln());
    let offset = 0.5 * (before - after) / (before - 2.0 * at + after);
    let spacing = angular_frequency(1, padded, step_s) / std::f64::consts::TAU;
    Some((peak as f64 + offset) * spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vibration_that_decays_within_few_periods_has_its_own_frequency() {
        for (rate_per_s, hertz) in [(0.25, 0.37), (0.5, 0.8), (0.02, 0.1)] {
            let decaying = |k: i32| {
                let t = 0.5 * f64::from(k);
                (-rate_per_s * t).exp() * (std::f64::consts::TAU * hertz * t).cos()
            };
            let vibration: Vec<f64> = (0..40).map(decaying).collect();
            let found = strongest_hz(&vibration, 0.5).unwrap();
            assert!((found / hertz - 1.0).abs() < 0.03, "{found} Hz is not {hertz} Hz");
        }
    }
}
