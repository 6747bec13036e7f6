//! Inputs of `simulate`, and targets for comparison.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::csv::{
    InputFile, Reading, TableFormat, read_hub_reference_as, read_recording, read_recording_as,
    read_target, read_torque_table_as,
};
use crate::link::{Link, ParameterError};
use crate::motion::TipTarget;
use crate::response::{Feedback, HubReference, Input, Interpolation, Play, State, Torque};
use crate::result::ChannelRecording;
use crate::store::read_state;

use super::common::{angle_rad, finite, option, refuse_for_arms};
use super::reading::{ReadArgs, tell};
use crate::cli::terminal::{Exit, Failure, memory};

/// What moves the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum InputKind {
    Torque,
    HubAngle,
}

/// The torque between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    Zero,
    Linear,
    Cubic,
}

/// What a torque is between its samples.
#[derive(Debug, Args)]
pub(crate) struct HoldArgs {
    /// The torque between the samples of TORQUE: a cubic spline, straight lines, or each sample held until
    /// the next one, as a converter plays a table.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Hold::Cubic)]
    hold: Hold,

    /// The same as --hold linear.
    #[arg(long, conflicts_with = "hold")]
    linear: bool,
}

impl HoldArgs {
    /// Interpolation of the torque between its samples.
    pub(crate) fn interpolation(&self) -> Interpolation {
        match self.hold {
            Hold::Cubic if self.linear => Interpolation::Linear,
            Hold::Cubic => Interpolation::Cubic,
            Hold::Linear => Interpolation::Linear,
            Hold::Zero => Interpolation::Zero,
        }
    }

    /// Refuses times off a uniform step for a held torque, because a spline that makes them uniform rings at its steps.
    pub(crate) fn refuse_jitter(&self, file: &InputFile, reading: &Reading) -> Result<(), Failure> {
        if reading.jitter().is_none() || self.interpolation() == Interpolation::Cubic {
            return Ok(());
        }
        let must = "must be uniform for --hold zero or linear";
        let message = format!("{}: times = off a uniform step, but {must}", file.shown);
        let hint = "write times with more decimals, or --hold cubic";
        Err(Failure::new(Exit::InputRefused, &message, Some(hint)))
    }

    /// Arguments for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let linear = self.linear.then(|| vec!["--linear".to_owned()]);
        let hold = self.hold.to_possible_value().filter(|_| self.hold != Hold::Cubic);
        let hold = hold.map(|hold| option("--hold", hold.get_name()));
        hold.into_iter().chain(linear).flatten().collect()
    }
}

/// What is played and compared.
#[derive(Debug, Args)]
pub(crate) struct PlayArgs {
    /// Torque at the hub (CSV): `time` and `torque`; with --input hub-angle `time` and `hub_angle`.
    #[arg(value_name = "TORQUE")]
    pub(crate) file: PathBuf,

    /// What TORQUE holds: the torque, or the hub angle: the hub follows it exactly, and the torque is
    /// computed. The hub rests before the first sample and turns on at its rate after the last.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = InputKind::Torque)]
    input: InputKind,

    /// Column of TORQUE to play [default: `torque`].
    #[arg(long, value_name = "NAME")]
    column: Option<String>,

    /// Time in s at which the simulation ends; after the last sample of TORQUE no torque acts, or with
    /// gravity the last one
    /// [default: the end of TORQUE or of the target, whichever is later].
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    pub(crate) until: Option<f64>,

    #[command(flatten)]
    pub(super) hold: HoldArgs,

    /// Tip motion to compare with (CSV): `time` and `displacement`, as `tip.csv` of solve. The
    /// link starts at its first displacement, but with --input hub-angle where its hub points to.
    #[arg(long, value_name = "FILE")]
    pub(super) target: Option<PathBuf>,

    /// Recording to compare with, channel by channel (CSV): `time` and any of `hub_angle`, `hub_rate`, `tip`,
    /// `velocity`, `acceleration`, `tip_deflection` and `torque`, at times of its own.
    #[arg(long, value_name = "FILE")]
    measured: Option<PathBuf>,

    /// Start from the state that --save-state of an earlier run wrote, not at rest.
    #[arg(long, value_name = "FILE")]
    pub(super) state: Option<PathBuf>,

    /// TORQUE is one cycle of a torque, or of a hub angle, that repeats, its first row a step after the last
    /// one: play the motion that repeats with it, to which the link settles.
    #[arg(long, conflicts_with = "state")]
    periodic: bool,

    /// Write the state at the end of the simulation (JSON), from which another one goes on: angles along the
    /// link, deflections and their rates.
    #[arg(long, value_name = "FILE")]
    pub(crate) save_state: Option<PathBuf>,

    /// Feedback at the hub around the reference: gains in N m/rad and N m s/rad; of an arm for all joints, or
    /// a pair for each.
    #[arg(long, value_name = "KP,KD", requires = "reference")]
    #[arg(value_parser = gains, allow_hyphen_values = true)]
    pub(super) feedback: Option<Gains>,

    /// Hub angle that the feedback follows (CSV), as `hub_angle.csv` of solve, or the joints of an arm, as its
    /// `joint_angles.csv`, at the times of TORQUE. The link starts at its first angle.
    #[arg(long, value_name = "FILE", requires = "feedback")]
    pub(super) reference: Option<PathBuf>,

    /// Directions of all links of an arm, from joint to joint, in which it starts at rest, in rad or with
    /// units, as in '30 deg,75 deg' [default: the first row of the reference, or of the target of two links].
    #[arg(long, value_name = "ANGLES", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(value_delimiter = ',', conflicts_with = "state")]
    pub(super) at: Option<Vec<f64>>,
}

/// Pairs of gains.
type Gains = Vec<(f64, f64)>;

/// Input that moves the link, as read.
enum Moving {
    Torque(Torque),
    HubAngle(HubReference),
}

/// Files of a simulation besides the link's, as read.
pub(crate) struct Playing {
    pub(crate) file: InputFile,
    moving: Moving,
    interpolation: Interpolation,
    pub(crate) target: Option<(InputFile, TipTarget)>,
    pub(crate) measured: Option<(InputFile, ChannelRecording)>,
    pub(crate) reference_file: Option<InputFile>,
    pub(crate) state: Option<(InputFile, State)>,
    feedback: Option<Feedback>,
    initial_tip_m: f64,
    is_periodic: bool,
}

impl PlayArgs {
    /// All files, for the check that no output replaces one.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let others = [&self.target, &self.measured, &self.reference, &self.state];
        let others = others.into_iter().flatten();
        [&self.file].into_iter().chain(others).map(PathBuf::as_path)
    }

    /// Reads all files for a link; every error names its file.
    pub(crate) fn load(&self, link: &Link, read: &ReadArgs) -> Result<Playing, Failure> {
        let length_m = link.length_m();
        self.check()?;
        self.refuse_for_links()?;
        let file = InputFile::read(&self.file)?;
        let open = |path: &Option<PathBuf>| path.as_deref().map(InputFile::read).transpose();
        let [target, measured, reference_file] =
            [open(&self.target)?, open(&self.measured)?, open(&self.reference)?];
        let InputFile { shown, bytes, .. } = &file;
        let (moving, reading) = match self.input {
            InputKind::Torque => {
                let column = self.column.as_deref();
                let (torque, reading) = read_torque_table_as(shown, bytes, column, &read.format())?;
                (Moving::Torque(torque), reading)
            }
            InputKind::HubAngle => {
                let (hub, reading) = read_hub_reference_as(shown, bytes, &read.format())?;
                (Moving::HubAngle(hub), reading)
            }
        };
        self.hold.refuse_jitter(&file, &reading)?;
        tell(shown, &reading);
        // The options of reading apply to TORQUE.
        let target = target.map(|file| -> Result<_, Failure> {
            let (target, reading) =
                read_target(&file.shown, &file.bytes, length_m, link.gravity())?;
            tell(&file.shown, &reading);
            Ok((file, target))
        });
        let target = target.transpose()?;
        let measured = measured.map(|file| -> Result<_, Failure> {
            let (recording, reading) = if file.bytes == *bytes {
                // The options assign the columns of this table.
                read_recording_as(&file.shown, &file.bytes, &read.format())?
            } else {
                read_recording(&file.shown, &file.bytes)?
            };
            tell(&file.shown, &reading);
            Ok((file, recording))
        });
        let measured = measured.transpose()?;
        let reference = reference_file.as_ref().map(|file| -> Result<HubReference, Failure> {
            let form = TableFormat::default();
            let (reference, reading) = read_hub_reference_as(&file.shown, &file.bytes, &form)?;
            tell(&file.shown, &reading);
            Ok(reference)
        });
        let reference = reference.transpose()?;
        let initial_tip_m =
            initial_tip_m(link, target.as_ref().map(|(_, own)| own), reference.as_ref());
        let state = open(&self.state)?.map(|file| -> Result<_, Failure> {
            let state = read_state(&file.shown, &file.bytes)?;
            Ok((file, state))
        });
        let state = state.transpose()?;
        let feedback = self.feedback.as_deref().and_then(<[_]>::first).copied().zip(reference);
        let feedback = feedback.map(|((kp, kd), reference)| Feedback::new(kp, kd, reference));
        let feedback = feedback.transpose().map_err(|error| Self::gains_refused(&error))?;
        let interpolation = self.hold.interpolation();
        Ok(Playing {
            file,
            moving,
            interpolation,
            target,
            measured,
            reference_file,
            state,
            feedback,
            initial_tip_m,
            is_periodic: self.periodic,
        })
    }

    /// Failure for impossible gains of a feedback.
    pub(super) fn gains_refused(error: &ParameterError) -> Failure {
        Failure::new(Exit::Usage, &format!("--feedback: {error}"), None)
    }

    /// Refuses options of a single link.
    pub(super) fn refuse_for_arms(&self) -> Result<(), Failure> {
        let given = [
            ("--input", self.input != InputKind::Torque),
            ("--column", self.column.is_some()),
            ("--measured", self.measured.is_some()),
            ("--periodic", self.periodic),
        ];
        let option = given.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name);
        refuse_for_arms(option.map(str::to_owned))
    }

    /// Refuses options of an arm.
    fn refuse_for_links(&self) -> Result<(), Failure> {
        let refused = |option: &str, must| {
            Err(Failure::new(Exit::Usage, &format!("{option}, but {must}"), None))
        };
        match &self.feedback {
            _ if self.at.is_some() => refused(
                "--at = directions of chords",
                "must not be given for one link, whose start_angle says it",
            ),
            Some(gains) if gains.len() > 1 => {
                refused("--feedback = several pairs", "must be one, KP,KD, for one link")
            }
            _ => Ok(()),
        }
    }

    /// Refuses options of a torque for a hub angle.
    fn check(&self) -> Result<(), Failure> {
        if self.input == InputKind::Torque {
            return Ok(());
        }
        let given = [
            ("--column", self.column.is_some()),
            ("--hold", self.hold.hold != Hold::Cubic),
            ("--linear", self.hold.linear),
            ("--feedback", self.feedback.is_some()),
        ];
        let Some((name, _)) = given.into_iter().find(|(_, is_given)| *is_given) else {
            return Ok(());
        };
        let message = format!("--input = hub-angle, but must be torque with {name}");
        let hint = match name {
            "--column" => "--columns hub_angle=COLUMN chooses the column of the hub angle",
            "--feedback" => "a hub that moves as prescribed needs no feedback",
            _ => "the hub angle is a smooth curve through its samples",
        };
        Err(Failure::new(Exit::Usage, &message, Some(hint)))
    }

    /// Arguments for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let input = (self.input == InputKind::HubAngle).then(|| option("--input", "hub-angle"));
        let column = self.column.iter().map(|column| option("--column", column));
        let until = self.until.map(|until| option("--until", until));
        let hold = Some(self.hold.arguments());
        let feedback = self.feedback.as_ref().map(|pairs| {
            let pairs: Vec<String> = pairs.iter().map(|(kp, kd)| format!("{kp},{kd}")).collect();
            option("--feedback", pairs.join(","))
        });
        let at = self
            .at
            .as_ref()
            .map(|at| option("--at", at.iter().map(f64::to_string).collect::<Vec<_>>().join(",")));
        let periodic = self.periodic.then(|| vec!["--periodic".to_owned()]);
        let input = input.into_iter().chain(column).chain(until).chain(periodic);
        input.chain(hold).chain(feedback).chain(at).flatten().collect()
    }
}

impl Playing {
    /// The simulation up to a time, or else until input and target end.
    pub(crate) fn play(&self, until_s: Option<f64>, is_large: bool) -> Play<'_> {
        let input = match &self.moving {
            Moving::Torque(torque) => Input::Torque(torque),
            Moving::HubAngle(hub) => Input::HubAngle(hub),
        };
        let end_s = input.grid().end_s();
        let both_s = self.target.as_ref().map(|(_, target)| target.grid().end_s().max(end_s));
        Play {
            input,
            interpolation: self.interpolation,
            until_s: until_s.or(both_s),
            feedback: self.feedback.as_ref(),
            initial_tip_m: self.initial_tip_m,
            memory_bytes: memory::available(),
            is_large,
            cycle_turn_rad: self.is_periodic.then_some(0.0),
            state: self.state.as_ref().map(|(_, state)| state),
            start_angle_rad: self.target.as_ref().and_then(|(_, target)| target.start_angle_rad()),
        }
    }
}

/// Displacement of the tip at the start in m: that of the target, else the direction of the hub's reference.
pub fn initial_tip_m(
    link: &Link,
    target: Option<&TipTarget>,
    reference: Option<&HubReference>,
) -> f64 {
    match (target, reference) {
        (Some(target), _) => target.start_m(),
        // Without weight a link at rest is straight: the hub points to its tip.
        (None, Some(reference)) if !link.has_weight() => {
            let from_rad = link.gravity().and_then(|gravity| gravity.start_angle_rad);
            (reference.angle_rad()[0] - from_rad.unwrap_or(0.0)) * link.length_m()
        }
        _ => 0.0,
    }
}

/// Pairs of gains, separated by commas.
fn gains(text: &str) -> Result<Gains, String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse::<f64>().ok()).collect();
    let pairs = numbers.filter(|numbers| numbers.len().is_multiple_of(2));
    let pairs = pairs.map(|numbers| numbers.chunks(2).map(|pair| (pair[0], pair[1])).collect());
    pairs.ok_or_else(|| "must be two numbers, KP,KD, or a pair for each joint of an arm".into())
}
