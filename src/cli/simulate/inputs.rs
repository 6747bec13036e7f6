//! What `simulate` plays: its arguments, the files they name, and why these are refused.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::args::{finite, option};
use crate::terminal::{Exit, Failure, memory};
use flexlink::csv::{InputFile, read_hub_reference, read_motion_table, read_torque_table};
use flexlink::link::Link;
use flexlink::motion::TipTarget;
use flexlink::numeric::plain;
use flexlink::response::{
    Feedback, FeedbackError, HubReference, Interpolation, Play, Simulation, SimulationError, Torque,
};
use flexlink::result::{TargetError, TipError};

/// What to play on the link, and what to compare with.
#[derive(Debug, Args)]
pub(crate) struct PlayArgs {
    /// Torque at the hub (CSV): `time` and `torque`.
    #[arg(value_name = "TORQUE")]
    torque: PathBuf,

    /// Column of TORQUE to play [default: `torque`].
    #[arg(long, value_name = "NAME")]
    column: Option<String>,

    /// Go on until this time in s, free of torque [default: to the end of TORQUE, and of the
    /// target].
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    until: Option<f64>,

    /// Take the torque as straight between its samples, not as a cubic spline.
    #[arg(long)]
    linear: bool,

    /// Tip motion to compare with (CSV): `time` and `displacement`, as `tip.csv` of solve. The
    /// link starts where it does.
    #[arg(long, value_name = "FILE")]
    target: Option<PathBuf>,

    /// Feedback at the hub around the reference: gains in N m/rad and N m s/rad.
    #[arg(long, value_name = "KP,KD", requires = "reference")]
    #[arg(value_parser = gains, allow_hyphen_values = true)]
    feedback: Option<(f64, f64)>,

    /// Hub angle that feedback holds to (CSV), as `hub_angle.csv` of solve, at the times of TORQUE.
    /// The link starts at its first angle.
    #[arg(long, value_name = "FILE", requires = "feedback")]
    reference: Option<PathBuf>,
}

/// The inputs beside the link, read.
pub(crate) struct Inputs {
    pub(crate) torque_file: InputFile,
    pub(crate) target_file: Option<InputFile>,
    pub(crate) reference_file: Option<InputFile>,
    torque: Torque,
    target: Option<TipTarget>,
    feedback: Option<Feedback>,
    initial_tip_m: f64,
}

impl PlayArgs {
    /// Reads all files; every refusal names its file.
    pub(crate) fn read(&self, link: &Link) -> Result<Inputs, Failure> {
        let read = |path: &PathBuf| InputFile::read(path);
        let torque_file = read(&self.torque)?;
        let target_file = self.target.as_ref().map(read).transpose()?;
        let reference_file = self.reference.as_ref().map(read).transpose()?;
        let torque =
            read_torque_table(&torque_file.shown, &torque_file.bytes, self.column.as_deref())?;
        let target = target_file.as_ref().map(|file| read_target(file, link)).transpose()?;
        let reference = reference_file
            .as_ref()
            .map(|file| read_hub_reference(&file.shown, &file.bytes))
            .transpose()?;
        // A link at rest is straight: its tip stands where the hub points.
        let pointed = |reference: &HubReference| reference.angle_rad()[0] * link.length_m();
        let initial_tip_m =
            target.as_ref().map(TipTarget::start_m).or(reference.as_ref().map(pointed));
        Ok(Inputs {
            torque_file,
            target_file,
            reference_file,
            torque,
            target,
            feedback: reference.map(|reference| self.feedback(reference)).transpose()?.flatten(),
            initial_tip_m: initial_tip_m.unwrap_or_default(),
        })
    }

    fn feedback(&self, reference: HubReference) -> Result<Option<Feedback>, Failure> {
        let Some((kp, kd)) = self.feedback else { return Ok(None) };
        let refused = |error: FeedbackError| {
            Failure::new(Exit::Usage, &format!("--feedback: {error}"), error.hint())
        };
        Feedback::new(kp, kd, reference).map(Some).map_err(refused)
    }

    /// What is played, until asked for, else as long as torque and target last.
    pub(crate) fn play<'a>(&self, inputs: &'a Inputs) -> Play<'a> {
        let torque_s = inputs.torque.grid().end_s();
        let both_s = inputs.target.as_ref().map(|target| target.grid().end_s().max(torque_s));
        Play {
            torque: &inputs.torque,
            interpolation: if self.linear { Interpolation::Linear } else { Interpolation::Cubic },
            until_s: self.until.or(both_s),
            feedback: inputs.feedback.as_ref(),
            initial_tip_m: inputs.initial_tip_m,
            memory_bytes: memory::available(),
        }
    }

    /// Why these inputs are not played, in words of the command line.
    pub(crate) fn refused(&self, error: &SimulationError, inputs: &Inputs) -> Failure {
        let (exit, place) = match error {
            SimulationError::NoTorque => (Exit::InputRefused, shown(Some(&inputs.torque_file))),
            SimulationError::Feedback(_) => {
                (Exit::InputRefused, shown(inputs.reference_file.as_ref()))
            }
            // Longer than the torque for the target's sake.
            SimulationError::TooLong { until_s, samples, limit } if self.until.is_none() => {
                let place = shown(inputs.target_file.as_ref());
                let found =
                    format!("the end = {} s, {samples:.3e} steps of the torque", plain(*until_s));
                let message = format!("{place}{found}, but must be at most {limit} steps");
                return Failure::new(Exit::InputRefused, &message, error.hint());
            }
            // The message begins with the option's name.
            SimulationError::TooLong { .. } | SimulationError::EndsEarly { .. } => {
                (Exit::Usage, "--".to_owned())
            }
            SimulationError::Damping(_)
            | SimulationError::MasslessHub
            | SimulationError::TooMuchMemory { .. }
            | SimulationError::NotFinite { .. } => (Exit::NotSolvable, String::new()),
        };
        Failure::new(exit, &format!("{place}{error}"), error.hint())
    }

    /// How far the tip strays from the target, if there is one.
    pub(crate) fn tip_error(
        &self,
        simulation: &Simulation,
        inputs: &Inputs,
    ) -> Result<Option<TipError>, Failure> {
        let Some(target) = &inputs.target else { return Ok(None) };
        let error = TipError::of(simulation, target);
        error.map(Some).map_err(|error| {
            let (exit, place) = match (error, self.until) {
                (TargetError::EndsLate { .. }, Some(until)) => {
                    (Exit::Usage, format!("--until {}: ", plain(until)))
                }
                _ => (Exit::InputRefused, shown(inputs.target_file.as_ref())),
            };
            Failure::new(exit, &format!("{place}{error}"), error.hint())
        })
    }

    /// The files that are read.
    pub(crate) fn paths(&self) -> Vec<&Path> {
        let others = [&self.target, &self.reference].into_iter().flatten();
        std::iter::once(&self.torque).chain(others).map(PathBuf::as_path).collect()
    }

    /// The arguments that name no file, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let column = self.column.iter().map(|column| option("--column", column));
        let until = self.until.map(|until| option("--until", until));
        let linear = self.linear.then(|| vec!["--linear".to_owned()]);
        let feedback = self.feedback.map(|(kp, kd)| option("--feedback", format!("{kp},{kd}")));
        column.chain(until).chain(linear).chain(feedback).flatten().collect()
    }
}

fn read_target(file: &InputFile, link: &Link) -> Result<TipTarget, Failure> {
    let table = read_motion_table(&file.shown, &file.bytes, link.length_m())?;
    Ok(table.into_target()?)
}

/// The file's name, as a message begins with it.
fn shown(file: Option<&InputFile>) -> String {
    file.map_or(String::new(), |file| format!("{}: ", file.shown))
}

/// Two gains, separated by a comma.
fn gains(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let pair = text.split_once(',').and_then(|(kp, kd)| Some((number(kp)?, number(kd)?)));
    pair.ok_or_else(|| "must be two numbers, KP,KD".into())
}
