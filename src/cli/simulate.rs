//! `simulate`: a torque played on a link.

use std::path::{Path, PathBuf};

use clap::Args;

use flexlink::csv::{Digits, InputFile, read_hub_reference, read_motion_table, read_torque_table};
use flexlink::link::{Link, ParameterError};
use flexlink::motion::TipTarget;
use flexlink::numeric::plain;
use flexlink::response::{
    Feedback, HubReference, Interpolation, Play, PlayError, Simulation, SimulationError, Torque,
    simulate,
};
use flexlink::result::{PlayedMetrics, TargetError, TipError};
use flexlink::spec::Specification;
use flexlink::store::{RunInputs, SimulateOutputs, Summary};

use super::args::{NodeArgs, SyncArgs, digits_arguments, finite, option};
use super::inputs::LinkArgs;
use crate::terminal::files::keep;
use crate::terminal::text::simulate_text;
use crate::terminal::{Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink simulate link.toml out/torque.csv \\
      --target out/tip.csv --set 'payload.mass=\"50 g\"'
  flexlink simulate link.toml out/rigid_torque.csv \\
      --column rigid_torque_n_m --until 10
  flexlink simulate link.toml out/torque.csv \\
      --feedback 20,2 --reference out/hub_angle.csv

One of the files may be `-`, standard input.";

const LONG_ABOUT: &str = "\
Play a torque on a link: direct dynamics.

Writes torque.csv (the torque as played, feedback included), tip.csv, hub_angle.csv, \
nodal_displacements.csv, nodes.csv and summary.json into a folder, all or none of them, and prints \
a short summary. The link is at rest before the torque's first sample; after the last one it is \
free. Each mode is integrated exactly in time, so that the answer does not depend on the Fourier \
transform of solve. A hysteretic link has no equation in time: its ratio is taken as the viscous \
ratio of every mode. The torque acts at the hub, on the whole link: [drive] and analysis.modes have \
no part in it.";

/// Play a torque on a link: direct dynamics.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE)]
pub(crate) struct Simulate {
    #[command(flatten)]
    link: LinkArgs,

    #[command(flatten)]
    play: PlayArgs,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "simulated")]
    output: PathBuf,

    #[command(flatten)]
    nodes: NodeArgs,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "10")]
    digits: Digits,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    sync: SyncArgs,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        keep(&self.output, &[&[&*self.link.link], &self.play.paths()[..]].concat())?;
        let (link_file, specification) = self.link.load()?;
        let link = &specification.link;
        let read = self.play.read(link)?;
        let play = self.play.play(&read);
        let played = self.played(&specification, &read, &play)?;
        let inputs = RunInputs::of_simulate(
            [&link_file, &read.torque_file],
            [read.target_file.as_ref(), read.reference_file.as_ref()],
            self.arguments(),
        );
        let summary = self.write(inputs, (link, &play), &played)?;
        let warnings = self.tell((link, &play), &played, &summary)?;
        self.warnings.refuse(warnings)
    }

    /// Plays the torque, and measures the error of the tip and of the simulation itself.
    fn played(
        &self,
        specification: &Specification,
        read: &Inputs,
        play: &Play,
    ) -> Result<Played, Failure> {
        let Specification { link, mesh, .. } = specification;
        let refused = |error| self.play.refused(&error, read);
        let simulation = simulate(link, mesh, play).map_err(refused)?;
        self.nodes.check(&simulation.mesh)?;
        let tip_error = self.play.tip_error(&simulation, read)?;
        memory::check_nodes(
            self.nodes.of_simulation(self.digits).nodal_bytes(&simulation),
            play.memory_bytes,
        )?;
        let error = PlayError::of(&simulation, link, play).map_err(refused)?;
        Ok(Played { metrics: PlayedMetrics::of(&simulation), simulation, error, tip_error })
    }

    /// Writes all tables and summary.json.
    fn write(
        &self,
        inputs: RunInputs,
        (link, play): (&Link, &Play),
        played: &Played,
    ) -> Result<Summary, Failure> {
        let Played { simulation, metrics, .. } = played;
        let errors = played.errors();
        let summary = Summary::of_simulation(inputs, (link, play), simulation, metrics, errors);
        let folder = self.sync.stage(&self.output)?;
        self.nodes.of_simulation(self.digits).write(folder, link, simulation, &summary)?;
        Ok(summary)
    }

    /// Prints warnings and the summary; returns the number of warnings.
    fn tell(
        &self,
        (link, play): (&Link, &Play),
        played: &Played,
        summary: &Summary,
    ) -> Result<usize, Failure> {
        let Played { simulation, metrics, error, tip_error } = played;
        let coarse = error.as_ref().and_then(PlayError::warning);
        let warnings: Vec<_> = simulation.warnings.iter().copied().chain(coarse).collect();
        for warning in &warnings {
            console::warning(warning, warning.hint());
        }
        let late = tip_error.and_then(|error| error.late);
        if let Some(late) = late {
            console::warning(late, late.hint());
        }
        let text = || {
            let files = SimulateOutputs::file_names().len();
            let written = format!("{files} files in {}", self.output.display());
            simulate_text(link, play, simulation, metrics, played.errors(), &written)
        };
        self.print.print(|| summary.to_json(), text)?;
        Ok(warnings.len() + usize::from(late.is_some()))
    }

    /// The arguments that shape the results, for the record.
    fn arguments(&self) -> Vec<String> {
        let (nodes, digits) = (self.nodes.arguments(), digits_arguments(self.digits));
        [self.link.changes.arguments(), self.play.arguments(), nodes, digits].concat()
    }
}

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

/// What came of a torque that was played.
struct Played {
    simulation: Simulation,
    metrics: PlayedMetrics,
    error: Option<PlayError>,
    tip_error: Option<TipError>,
}

impl Played {
    fn errors(&self) -> (Option<&PlayError>, Option<&TipError>) {
        (self.error.as_ref(), self.tip_error.as_ref())
    }
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
        let torque_file = InputFile::read(&self.torque)?;
        let target_file = self.target.as_deref().map(InputFile::read).transpose()?;
        let reference_file = self.reference.as_deref().map(InputFile::read).transpose()?;
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
        let refused = |error: ParameterError| {
            Failure::new(Exit::Usage, &format!("--feedback: {error}"), None)
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
            SimulationError::OtherTimes { .. } => {
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
