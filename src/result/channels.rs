//! A simulation beside a recording, channel by channel.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::numeric::{CubicSpline, SplineEnds, rounded};
use crate::response::Simulation;

/// A quantity that is both recorded and simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Hub angle in rad.
    HubAngle,
    /// Hub rate in rad/s.
    HubRate,
    /// Displacement of the tip in m.
    Tip,
    /// Velocity of the tip in m/s.
    Velocity,
    /// Acceleration of the tip in m/s².
    Acceleration,
    /// Deflection of the tip from the hub's tangent line in m.
    TipDeflection,
    /// Torque at the hub in N m.
    Torque,
}

impl Channel {
    /// The name, as in summary.json.
    pub fn name(self) -> &'static str {
        match self {
            Self::HubAngle => "hub_angle",
            Self::HubRate => "hub_rate",
            Self::Tip => "tip",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::TipDeflection => "tip_deflection",
            Self::Torque => "torque",
        }
    }

    /// The SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::HubAngle => "rad",
            Self::HubRate => "rad/s",
            Self::Tip | Self::TipDeflection => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s²",
            Self::Torque => "N m",
        }
    }

    /// Samples of a simulation.
    fn of(self, simulation: &Simulation) -> Vec<f64> {
        match self {
            Self::HubAngle => simulation.hub_angle_rad.clone(),
            Self::HubRate => simulation.hub_rate_rad_s.clone(),
            Self::Tip => simulation.tip.displacement_m.clone(),
            Self::Velocity => simulation.tip.velocity_m_s.clone(),
            Self::Acceleration => simulation.tip.acceleration_m_s2.clone(),
            Self::TipDeflection => simulation.tip_deflection_m(),
            Self::Torque => simulation.torque_n_m.clone(),
        }
    }
}

/// A recording of some channels in SI. Times increase; they need not be uniform.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Times in s.
    pub time_s: Vec<f64>,
    /// As many samples of each channel as there are times.
    pub channels: Vec<(Channel, Vec<f64>)>,
}

/// Why a recording is not compared with a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "{found} of the times lie within the simulation, {} to {} s, but {FEWEST} or more must",
    rounded(*start_s, 12),
    rounded(*end_s, 12)
)]
pub struct NoOverlap {
    /// Times within the simulation.
    pub found: usize,
    /// First time of the simulation in s.
    pub start_s: f64,
    /// Last time of the simulation in s.
    pub end_s: f64,
}

impl NoOverlap {
    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "both must count time from the same instant; --until simulates longer"
    }
}

/// Fewest times that recording and simulation share.
const FEWEST: usize = 8;

/// Largest delay, in periods of the first mode and in durations that recording and simulation share.
const OF_PERIOD: f64 = 0.25;
const OF_RECORD: f64 = 0.1;

/// Delays on each side of 0 that are tried before the best of them is improved.
const TRIED: i32 = 64;

/// A simulation beside a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// First time in s that is compared.
    pub from_s: f64,
    /// Last time in s that is compared.
    pub until_s: f64,
    /// Times of the recording that are compared.
    pub samples: usize,
    /// Times of the recording outside the simulation, left out.
    pub left_out: usize,
    /// Delays up to this one in s were searched, to both sides.
    pub longest_delay_s: f64,
    /// One for each channel of the recording.
    pub channels: Vec<ChannelComparison>,
}

/// One channel of a simulation beside its recording; differences are recorded less simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChannelComparison {
    /// The channel.
    pub channel: Channel,
    /// Root mean square of the difference, in the channel's SI unit.
    pub rms: f64,
    /// Root mean square of the recording.
    pub recorded_rms: f64,
    /// Root mean square of the simulation at the same times.
    pub simulated_rms: f64,
    /// That of the difference over that of the recording; none where the recording is zero.
    pub share: Option<f64>,
    /// None where recording or simulation stands still, and where the best delay is the longest.
    pub fit: Option<ChannelFit>,
}

/// Least squares of `recording(t) = gain · simulation(t − delay) + offset`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    /// By how much the recording lags the simulation in s.
    pub delay_s: f64,
    /// Recording over simulation.
    pub gain: f64,
    /// What the recording has more, in the channel's SI unit.
    pub offset: f64,
    /// Root mean square of the difference that is left, over that of the recording.
    pub left: f64,
}

impl Comparison {
    /// Compares at the recording's times; a cubic spline interpolates the simulation.
    ///
    /// The link rests before the simulation's first sample. Delays are searched up to a quarter of the
    /// first mode's period, where the next wave would fit as well, and up to a tenth of the duration.
    ///
    /// # Errors
    /// [`NoOverlap`].
    pub fn of(simulation: &Simulation, measured: &Measured) -> Result<Self, NoOverlap> {
        let grid = &simulation.grid;
        let (start_s, end_s) = (grid.time_s(0), grid.end_s());
        // A millionth of a step beside the last sample is that sample.
        let near_s = 1e-6 * grid.step_s;
        let first = measured.time_s.partition_point(|t| *t < start_s - near_s);
        let behind = measured.time_s.partition_point(|t| *t <= end_s + near_s);
        let found = behind.saturating_sub(first);
        if found < FEWEST {
            return Err(NoOverlap { found, start_s, end_s });
        }
        let time_s = &measured.time_s[first..behind];
        let (from_s, until_s) = (time_s[0], time_s[found - 1]);
        let period_s = simulation.first_period_s().unwrap_or(f64::INFINITY);
        let longest_delay_s = (OF_PERIOD * period_s).min(OF_RECORD * (until_s - from_s));
        let compared = |(channel, recorded): &(Channel, Vec<f64>)| {
            let own = Own {
                spline: CubicSpline::uniform(&channel.of(simulation), SplineEnds::NotAKnot),
                start_s,
                step_s: grid.step_s,
                last: (grid.len - 1) as f64,
            };
            let pair = Pair { own, time_s, recorded: &recorded[first..behind] };
            pair.compared(*channel, longest_delay_s)
        };
        Ok(Self {
            from_s,
            until_s,
            samples: found,
            left_out: measured.time_s.len() - found,
            longest_delay_s,
            channels: measured.channels.iter().map(compared).collect(),
        })
    }

    /// All numbers by name.
    pub fn readings(&self) -> impl Iterator<Item = (String, f64)> {
        self.channels.iter().flat_map(|channel| {
            let name = channel.channel.name();
            let fit = |of: fn(&ChannelFit) -> f64| channel.fit.as_ref().map(of);
            let numbers = [
                ("rms", Some(channel.rms)),
                ("share", channel.share),
                ("delay_s", fit(|fit| fit.delay_s)),
                ("gain", fit(|fit| fit.gain)),
                ("left", fit(|fit| fit.left)),
            ];
            let given = numbers.into_iter().filter_map(|(what, number)| Some((what, number?)));
            given.map(move |(what, number)| (format!("measured_{name}_{what}"), number))
        })
    }
}

/// A channel of the simulation over time.
struct Own {
    spline: CubicSpline,
    start_s: f64,
    step_s: f64,
    last: f64,
}

impl Own {
    /// Value and rate at a time, those of its ends beyond them.
    fn at(&self, time_s: f64) -> [f64; 2] {
        let x = (time_s - self.start_s) / self.step_s;
        let within = x.clamp(0.0, self.last);
        let is_within = within.to_bits() == x.to_bits();
        let rate = if is_within { self.spline.slope(x) / self.step_s } else { 0.0 };
        [self.spline.value(within), rate]
    }
}

/// A recorded channel and the simulated one.
struct Pair<'a> {
    own: Own,
    time_s: &'a [f64],
    recorded: &'a [f64],
}

/// One step of the iteration.
struct Tried {
    fit: ChannelFit,
    /// What the delay is to be changed by in s.
    change_s: f64,
}

impl Pair<'_> {
    fn compared(&self, channel: Channel, longest_s: f64) -> ChannelComparison {
        let simulated: Vec<f64> = self.time_s.iter().map(|t| self.own.at(*t)[0]).collect();
        let difference = self.recorded.iter().zip(&simulated).map(|(a, b)| a - b);
        let rms = root_mean_square(difference);
        let recorded_rms = root_mean_square(self.recorded.iter().copied());
        let moves = |samples: &[f64]| samples.iter().any(|x| x.to_bits() != samples[0].to_bits());
        let both_move = moves(self.recorded) && moves(&simulated);
        ChannelComparison {
            channel,
            rms,
            recorded_rms,
            simulated_rms: root_mean_square(simulated.iter().copied()),
            share: (recorded_rms > 0.0).then(|| rms / recorded_rms),
            fit: if both_move { self.fitted(recorded_rms, longest_s) } else { None },
        }
    }

    /// The best of delays on a grid, improved by Gauss and Newton's iteration.
    fn fitted(&self, recorded_rms: f64, longest_s: f64) -> Option<ChannelFit> {
        let spacing_s = longest_s / f64::from(TRIED);
        let at = |delay_s: f64| self.tried(delay_s, recorded_rms, longest_s);
        let delays = (-TRIED..=TRIED).map(|k| f64::from(k) * spacing_s);
        let smaller = |a: &Tried, b: &Tried| a.fit.left.total_cmp(&b.fit.left);
        let mut best = delays.filter_map(at).min_by(smaller)?;
        for _ in 0..MOST_STEPS {
            let change_s = best.change_s.clamp(-spacing_s, spacing_s);
            // Halved until it improves: noise and kinks mislead the derivative.
            let mut halved = (0..HALVINGS).map(|k| change_s * 0.5_f64.powi(k));
            let better = halved.find_map(|by| {
                at(best.fit.delay_s + by).filter(|tried| tried.fit.left < best.fit.left)
            });
            match better {
                Some(tried) => best = tried,
                None => break,
            }
            if best.change_s.abs() < SETTLED * self.own.step_s {
                break;
            }
        }
        (best.fit.delay_s.abs() < longest_s - 0.5 * spacing_s).then_some(best.fit)
    }

    /// Gain and offset at a delay, by least squares with the linearised change of the delay.
    ///
    /// The last samples, at which the delayed simulation may have ended, are left out for every delay.
    fn tried(&self, delay_s: f64, recorded_rms: f64, longest_s: f64) -> Option<Tried> {
        let end_s = self.own.start_s + self.own.last * self.own.step_s;
        let count = self.time_s.partition_point(|t| *t + longest_s <= end_s).max(FEWEST / 2);
        let rows = || {
            let pairs = self.time_s[..count].iter().zip(self.recorded);
            pairs.map(|(t, y)| (self.own.at(t - delay_s), *y))
        };
        let mut mean = [0.0; 3];
        for ([v, rate], y) in rows() {
            mean = [mean[0] + v, mean[1] + rate, mean[2] + y];
        }
        let mean = mean.map(|sum| sum / count as f64);
        let mut normal = Matrix3::zeros();
        for ([v, rate], y) in rows() {
            let row = Vector3::new(v - mean[0], rate - mean[1], y - mean[2]);
            normal += row * row.transpose();
        }
        let [vv, vr, vy, rr, ry] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2)].map(|at| normal[at]);
        if vv <= 0.0 {
            return None;
        }
        let gain = vy / vv;
        let mut squares = 0.0;
        for ([v, _], y) in rows() {
            squares += (y - mean[2] - gain * (v - mean[0])).powi(2);
        }
        // y = g v(t − d − δ) + o, about g v − g δ v̇ + o.
        let own = rr - vr * vr / vv;
        let change_s = if own > 0.0 { -(ry - gain * vr) / (own * gain) } else { 0.0 };
        let offset = mean[2] - gain * mean[0];
        let left = (squares / count as f64).sqrt() / recorded_rms;
        let fit = ChannelFit { delay_s, gain, offset, left };
        Some(Tried { fit, change_s: if change_s.is_finite() { change_s } else { 0.0 } })
    }
}

/// Most steps of the iteration, most halvings of a step, and the change of the delay in steps of the
/// simulation at which it has settled.
const MOST_STEPS: usize = 30;
const HALVINGS: i32 = 6;
const SETTLED: f64 = 1e-6;

fn root_mean_square(samples: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = samples.len() as f64;
    (samples.map(|x| x * x).sum::<f64>() / count).sqrt()
}
