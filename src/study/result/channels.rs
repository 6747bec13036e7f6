//! Recorded histories of a link in motion, and a simulation beside them, channel by channel.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::link::MOST_LINKS;
use crate::numeric::{SplineEnds, TimeCurve, rounded};
use crate::response::Played;

/// Why a recording is not compared with a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ComparisonError {
    /// A recording of nothing.
    #[error("the recording has no channel, but must have one or more")]
    NoChannel,
    /// A channel without a sample for each time.
    #[error("{} = {samples} samples, but must be as many as there are times, {times}", channel.name())]
    Uneven {
        /// The channel.
        channel: SimulatedChannel,
        /// Its samples.
        samples: usize,
        /// Times of the recording.
        times: usize,
    },
    /// A channel that the simulation does not have.
    #[error("{} = a channel of the recording, but the simulation has {joints} joint(s)", channel.name())]
    Absent {
        /// The channel.
        channel: SimulatedChannel,
        /// Joints of the simulation.
        joints: usize,
    },
    /// Too few times within the simulation.
    #[error(
        "{found} of the times lie within the simulation, {} to {} s, but at least {FEWEST} must",
        rounded(*start_s, 12),
        rounded(*end_s, 12)
    )]
    NoOverlap {
        /// Times within the simulation.
        found: usize,
        /// First time of the simulation in s.
        start_s: f64,
        /// Last time of the simulation in s.
        end_s: f64,
    },
}

impl ComparisonError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::NoChannel => "record what a simulation has: hub angle, tip, torque",
            Self::Absent { joints: 1, .. } => "a hub has hub_angle, hub_rate and torque",
            Self::Absent { .. } => {
                "the joints of an arm have joint1, joint1_rate, torque1, joint2, …"
            }
            Self::Uneven { .. } => "write a sample of every channel at each time",
            Self::NoOverlap { .. } => {
                "count time from the same instant in both, or simulate longer with --until"
            }
        }
    }
}

/// Fewest times that recording and simulation share.
const FEWEST: usize = 8;

/// Largest delay, in periods of a link's first mode and in durations that recording and simulation share.
const OF_PERIOD: f64 = 0.25;
const OF_RECORD: f64 = 0.1;

/// Delays on each side of 0 that the search tries before it improves the best one.
const TRIED: i32 = 64;

/// A simulation beside a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// First compared time in s.
    pub from_s: f64,
    /// Last compared time in s.
    pub until_s: f64,
    /// Number of compared times.
    pub samples: usize,
    /// Number of times of the recording outside the simulation.
    pub left_out: usize,
    /// Longest delay in s, to both sides, that the search tried.
    pub longest_delay_s: f64,
    /// One for each channel of the recording.
    pub channels: Vec<ChannelComparison>,
}

/// One channel of a simulation beside its recording; differences are recorded less simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChannelComparison {
    /// The channel.
    pub channel: SimulatedChannel,
    /// Root mean square of the difference, in the channel's SI unit.
    pub rms: f64,
    /// Root mean square of the recording about its mean; the zero of an absolute sensor does not count.
    pub recorded_deviation: f64,
    /// Root mean square of the simulation at the same times about its mean.
    pub simulated_deviation: f64,
    /// `rms` over `recorded_deviation`; absent if the recording is constant.
    pub share: Option<f64>,
    /// Delay, gain and offset, if the fit succeeds.
    pub fit: Option<ChannelFit>,
    /// Reason of a failed fit; absent beside a fit.
    pub no_fit: Option<NoFit>,
}

/// Reason for a channel without delay, gain and offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoFit {
    /// The recording is constant.
    ConstantRecording,
    /// The simulation is constant.
    ConstantSimulation,
    /// The best delay is the longest of the search.
    LongestDelay,
}

/// Least squares of `recording(t) = gain · simulation(t − delay) + offset`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ChannelFit {
    /// Lag of the recording behind the simulation in s.
    pub delay_s: f64,
    /// Recording over simulation.
    pub gain: f64,
    /// Recording less the scaled, delayed simulation, in the channel's SI unit.
    pub offset: f64,
    /// Root mean square of the remaining difference, over that of the recording about its mean.
    pub left: f64,
}

impl Comparison {
    /// Compares at the recording's times; a cubic spline interpolates the simulation.
    ///
    /// Link or arm rest before the simulation's first sample. The search covers delays up to a quarter of the longest
    /// period of a link's first mode, where the next wave would fit as well, and up to a tenth of the duration.
    ///
    /// # Errors
    /// [`ComparisonError`]: a recording without channel, with a channel that the simulation does not have, or with too few
    /// times within the simulation.
    pub fn of(simulation: &Played, recording: &ChannelRecording) -> Result<Self, ComparisonError> {
        let times = recording.time_s.len();
        if recording.channels.is_empty() {
            return Err(ComparisonError::NoChannel);
        }
        if let Some((channel, samples)) =
            recording.channels.iter().find(|(_, samples)| samples.len() != times)
        {
            let (channel, samples) = (*channel, samples.len());
            return Err(ComparisonError::Uneven { channel, samples, times });
        }
        let grid = &simulation.grid;
        let (start_s, end_s) = (grid.time_s(0), grid.end_s());
        // A time within a millionth of a step of the last sample counts as that sample.
        let near_s = 1e-6 * grid.step_s;
        let first = recording.time_s.partition_point(|t| *t < start_s - near_s);
        let behind = recording.time_s.partition_point(|t| *t <= end_s + near_s);
        let found = behind.saturating_sub(first);
        if found < FEWEST {
            return Err(ComparisonError::NoOverlap { found, start_s, end_s });
        }
        let time_s = &recording.time_s[first..behind];
        let (from_s, until_s) = (time_s[0], time_s[found - 1]);
        let period_s = simulation.first_period_s().unwrap_or(f64::INFINITY);
        let longest_delay_s = (OF_PERIOD * period_s).min(OF_RECORD * (until_s - from_s));
        let compared = |(channel, recorded): &(SimulatedChannel, Vec<f64>)| {
            let joints = simulation.joints.len();
            let absent = ComparisonError::Absent { channel: *channel, joints };
            let samples = channel.of(simulation).ok_or(absent)?;
            let simulated = TimeCurve::new(*grid, &samples, SplineEnds::NotAKnot);
            let pair = Pair { simulated, time_s, recorded: &recorded[first..behind] };
            Ok(pair.compared(*channel, longest_delay_s))
        };
        let channels = recording.channels.iter().map(compared);
        Ok(Self {
            from_s,
            until_s,
            samples: found,
            left_out: times - found,
            longest_delay_s,
            channels: channels.collect::<Result<_, _>>()?,
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

/// A recorded channel and the simulated one.
struct Pair<'a> {
    simulated: TimeCurve,
    time_s: &'a [f64],
    recorded: &'a [f64],
}

/// One step of the iteration.
struct Tried {
    fit: ChannelFit,
    /// Change of the delay in s for the next step.
    change_s: f64,
}

impl Pair<'_> {
    fn compared(&self, channel: SimulatedChannel, longest_s: f64) -> ChannelComparison {
        let simulated: Vec<f64> = self.time_s.iter().map(|t| self.simulated.value(*t)).collect();
        let difference = self.recorded.iter().zip(&simulated).map(|(a, b)| a - b);
        let rms = root_mean_square(difference);
        let recorded_deviation = deviation(self.recorded);
        let simulated_deviation = deviation(&simulated);
        let fit = if recorded_deviation == 0.0 {
            Err(NoFit::ConstantRecording)
        } else if simulated_deviation == 0.0 {
            Err(NoFit::ConstantSimulation)
        } else {
            self.fitted(recorded_deviation, longest_s)
        };
        ChannelComparison {
            channel,
            rms,
            recorded_deviation,
            simulated_deviation,
            share: (recorded_deviation > 0.0).then(|| rms / recorded_deviation),
            fit: fit.ok(),
            no_fit: fit.err(),
        }
    }

    /// The best of delays on a grid, improved by Gauss and Newton's iteration.
    fn fitted(&self, recorded_deviation: f64, longest_s: f64) -> Result<ChannelFit, NoFit> {
        let spacing_s = longest_s / f64::from(TRIED);
        let at = |delay_s: f64| self.tried(delay_s, recorded_deviation, longest_s);
        let delays = (-TRIED..=TRIED).map(|k| f64::from(k) * spacing_s);
        let smaller = |a: &Tried, b: &Tried| a.fit.left.total_cmp(&b.fit.left);
        let best = delays.filter_map(at).min_by(smaller);
        // Without a best delay the simulation is constant for every delay.
        let mut best = best.ok_or(NoFit::ConstantSimulation)?;
        for _ in 0..MOST_STEPS {
            let change_s = best.change_s.clamp(-spacing_s, spacing_s);
            // Halves the change until it improves the fit: noise and kinks mislead the derivative.
            let mut halved = (0..HALVINGS).map(|k| change_s * 0.5_f64.powi(k));
            let better = halved.find_map(|by| {
                at(best.fit.delay_s + by).filter(|tried| tried.fit.left < best.fit.left)
            });
            match better {
                Some(tried) => best = tried,
                None => break,
            }
            if best.change_s.abs() < SETTLED * self.simulated.grid().step_s {
                break;
            }
        }
        let is_within = best.fit.delay_s.abs() < longest_s - 0.5 * spacing_s;
        if is_within { Ok(best.fit) } else { Err(NoFit::LongestDelay) }
    }

    /// Gain and offset at a delay, by least squares with the linearised change of the delay.
    ///
    /// Leaves out the last samples for every delay, since the delayed simulation may have ended there.
    fn tried(&self, delay_s: f64, recorded_deviation: f64, longest_s: f64) -> Option<Tried> {
        let end_s = self.simulated.grid().end_s();
        let count = self.time_s.partition_point(|t| *t + longest_s <= end_s).max(FEWEST / 2);
        let rows = || {
            let pairs = self.time_s[..count].iter().zip(self.recorded);
            let at = |t: f64| [self.simulated.value(t), self.simulated.rate(t)];
            pairs.map(move |(t, y)| (at(t - delay_s), *y))
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
        let left = (squares / count as f64).sqrt() / recorded_deviation;
        let fit = ChannelFit { delay_s, gain, offset, left };
        Some(Tried { fit, change_s: if change_s.is_finite() { change_s } else { 0.0 } })
    }
}

/// Most steps of the iteration, most halvings of a step, and the largest change of a settled delay in steps of the
/// simulation.
const MOST_STEPS: usize = 30;
const HALVINGS: i32 = 6;
const SETTLED: f64 = 1e-6;

fn root_mean_square(samples: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = samples.len() as f64;
    (samples.map(|x| x * x).sum::<f64>() / count).sqrt()
}

/// Root mean square about the mean; 0 of equal samples, whose mean may round to another number.
fn deviation(samples: &[f64]) -> f64 {
    if samples.iter().all(|x| x.to_bits() == samples[0].to_bits()) {
        return 0.0;
    }
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    root_mean_square(samples.iter().map(|x| x - mean))
}

/// A quantity that is both recorded and simulated. Joints count from 0, and from 1 in names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum SimulatedChannel {
    /// Hub angle of one link in rad.
    HubAngle,
    /// Hub rate of one link in rad/s.
    HubRate,
    /// Displacement of one link's tip in m.
    Tip,
    /// Velocity of one link's tip in m/s.
    Velocity,
    /// Acceleration of one link's tip in m/s².
    Acceleration,
    /// Deflection of one link's tip from the hub's tangent line in m.
    TipDeflection,
    /// Torque at the hub of one link in N m.
    Torque,
    /// Position of the carriage of a link or an arm in m.
    Carriage,
    /// Velocity of this carriage in m/s.
    CarriageVelocity,
    /// Force on this carriage in N.
    Force,
    /// x of an arm's tip in m.
    TipX,
    /// y of an arm's tip in m.
    TipY,
    /// Angle of an arm's joint in rad.
    JointAngle(usize),
    /// Rate of an arm's joint in rad/s.
    JointRate(usize),
    /// Torque of an arm's joint in N m.
    JointTorque(usize),
}

/// A name without channel.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0} is no channel of a simulation")]
pub struct UnknownChannel(String);

impl SimulatedChannel {
    /// All channels of one link and of arms.
    fn all() -> impl Iterator<Item = Self> {
        let of_link = [
            Self::HubAngle,
            Self::HubRate,
            Self::Tip,
            Self::Velocity,
            Self::Acceleration,
            Self::TipDeflection,
            Self::Torque,
            Self::Carriage,
            Self::CarriageVelocity,
            Self::Force,
        ];
        let of_joint =
            |joint| [Self::JointAngle(joint), Self::JointRate(joint), Self::JointTorque(joint)];
        of_link
            .into_iter()
            .chain([Self::TipX, Self::TipY])
            .chain((0..MOST_LINKS).flat_map(of_joint))
    }

    /// The channel of this name.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        Self::all().find(|channel| channel.name() == name)
    }

    /// Number of the joint, from 0, for a quantity of an arm's joint.
    pub(crate) fn joint(self) -> Option<usize> {
        match self {
            Self::JointAngle(joint) | Self::JointRate(joint) | Self::JointTorque(joint) => {
                Some(joint)
            }
            _ => None,
        }
    }

    /// The name, as in summary.json.
    pub fn name(self) -> String {
        let name = match self {
            Self::HubAngle => "hub_angle",
            Self::HubRate => "hub_rate",
            Self::Tip => "tip",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::TipDeflection => "tip_deflection",
            Self::Torque => "torque",
            Self::Carriage => "carriage",
            Self::CarriageVelocity => "carriage_velocity",
            Self::Force => "force",
            Self::TipX => "x",
            Self::TipY => "y",
            Self::JointAngle(joint) => return format!("joint{}", joint + 1),
            Self::JointRate(joint) => return format!("joint{}_rate", joint + 1),
            Self::JointTorque(joint) => return format!("torque{}", joint + 1),
        };
        name.to_owned()
    }

    /// The SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::HubAngle | Self::JointAngle(_) => "rad",
            Self::HubRate | Self::JointRate(_) => "rad/s",
            Self::Tip | Self::TipDeflection | Self::TipX | Self::TipY | Self::Carriage => "m",
            Self::Velocity | Self::CarriageVelocity => "m/s",
            Self::Force => "N",
            Self::Acceleration => "m/s²",
            Self::Torque | Self::JointTorque(_) => "N m",
        }
    }

    /// Samples of a simulation, if it has this channel.
    pub(super) fn of(self, played: &Played) -> Option<Vec<f64>> {
        let (is_link, links) = (played.joints.len() == 1, played.links.len());
        let is_of_carriage = matches!(self, Self::Carriage | Self::CarriageVelocity | Self::Force);
        let is_of_arm = self.joint().is_some() || matches!(self, Self::TipX | Self::TipY);
        let is_own = is_of_carriage || is_link != is_of_arm;
        // The carriage of an arm is the joint after those of its links.
        let after = if is_of_carriage && !is_link { links } else { 0 };
        let joint = self.joint().unwrap_or(after);
        let joint = played.joints.get(joint).filter(|_| is_own)?;
        let tip = &played.tip[usize::from(self == Self::TipY)];
        Some(match self {
            Self::HubAngle | Self::Carriage | Self::JointAngle(_) => joint.angle_rad.clone(),
            Self::HubRate | Self::CarriageVelocity | Self::JointRate(_) => joint.rate_rad_s.clone(),
            Self::Tip | Self::TipX | Self::TipY => tip.displacement_m.clone(),
            Self::Velocity => tip.velocity_m_s.clone(),
            Self::Acceleration => tip.acceleration_m_s2.clone(),
            Self::TipDeflection => played.tip_deflection_m(),
            Self::Torque | Self::Force | Self::JointTorque(_) => joint.torque_n_m.clone(),
        })
    }
}

impl From<SimulatedChannel> for String {
    fn from(channel: SimulatedChannel) -> Self {
        channel.name()
    }
}

impl TryFrom<String> for SimulatedChannel {
    type Error = UnknownChannel;

    fn try_from(name: String) -> Result<Self, UnknownChannel> {
        Self::of_name(&name).ok_or(UnknownChannel(name))
    }
}

/// A recording of some channels in SI. Times increase; they need not be uniform.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelRecording {
    /// Times in s.
    pub time_s: Vec<f64>,
    /// As many samples of each channel as there are times.
    pub channels: Vec<(SimulatedChannel, Vec<f64>)>,
}
