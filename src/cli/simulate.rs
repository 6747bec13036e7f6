//! `simulate`: a torque played on a link.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use flexlink::csv::{
    Digits, InputFile, TableFormat, read_hub_reference_as, read_motion_table_as,
    read_torque_table_as,
};
use flexlink::motion::TipTarget;
use flexlink::response::{
    Feedback, HubReference, Interpolation, Play, PlayError, Simulation, SimulationError, Torque,
    simulate,
};
use flexlink::result::{PlayedMetrics, TargetError, TipError};
use flexlink::spec::Specification;
use flexlink::store::{RunInputs, RunOutputs, Summary};
use flexlink::text::plain;

use crate::options::common::{NodeArgs, SyncArgs, digits_arguments, finite, option};
use crate::options::inputs::LinkArgs;
use crate::options::read::{ReadArgs, tell};
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
  flexlink simulate link.toml lab.csv \\
      --columns time=1,torque=3 --unit 'N cm' --skip 5

One of the files may be `-`, standard input.";

/// The torque between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    Zero,
    Linear,
    Cubic,
}

/// Play a torque on a link: direct dynamics.
///
/// Writes torque.csv (the torque as played, feedback included), tip.csv, hub_angle.csv,
/// nodal_displacements.csv, nodes.csv and summary.json into a folder, all or none of them, and prints a
/// short summary. The link is at rest before the torque's first sample; after the last one it is free. Each
/// mode is integrated exactly in time, so the answer does not depend on the Fourier transform of
/// solve. A hysteretic link has no equation in time: its ratio is taken as the viscous ratio of every mode.
/// The torque acts at the hub, on the whole link: [drive] and analysis.modes are not used.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Simulate {
    #[command(flatten)]
    link: LinkArgs,

    /// Torque at the hub (CSV): `time` and `torque`.
    #[arg(value_name = "TORQUE")]
    torque: PathBuf,

    /// Column of TORQUE to play [default: `torque`].
    #[arg(long, value_name = "NAME")]
    column: Option<String>,

    /// Time in s at which the simulation ends; after the last sample of TORQUE no torque acts
    /// [default: the end of TORQUE or of the target, whichever is later].
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    until: Option<f64>,

    /// The torque between the samples of TORQUE: a cubic spline, straight lines, or each sample held until
    /// the next one, as a converter plays a table.
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Hold::Cubic)]
    hold: Hold,

    /// The same as --hold linear.
    #[arg(long, conflicts_with = "hold")]
    linear: bool,

    /// Tip motion to compare with (CSV): `time` and `displacement`, as `tip.csv` of solve. The
    /// link starts at its first displacement.
    #[arg(long, value_name = "FILE")]
    target: Option<PathBuf>,

    /// Feedback at the hub around the reference: gains in N m/rad and N m s/rad.
    #[arg(long, value_name = "KP,KD", requires = "reference")]
    #[arg(value_parser = gains, allow_hyphen_values = true)]
    feedback: Option<(f64, f64)>,

    /// Hub angle that the feedback follows (CSV), as `hub_angle.csv` of solve, at the times of TORQUE.
    /// The link starts at its first angle.
    #[arg(long, value_name = "FILE", requires = "feedback")]
    reference: Option<PathBuf>,

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

    #[command(flatten)]
    read: ReadArgs,
}

/// The inputs, read.
struct Inputs {
    link_file: InputFile,
    specification: Specification,
    torque_file: InputFile,
    torque: Torque,
    target: Option<(InputFile, TipTarget)>,
    reference_file: Option<InputFile>,
    feedback: Option<Feedback>,
    initial_tip_m: f64,
}

/// The simulation, and its errors.
struct Played<'a> {
    play: Play<'a>,
    simulation: Simulation,
    metrics: PlayedMetrics,
    error: Option<PlayError>,
    tip_error: Option<TipError>,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let inputs = self.load()?;
        let played = self.compute(&inputs)?;
        let summary = self.write(&inputs, &played)?;
        let warnings = self.tell(&inputs, &played, &summary)?;
        self.warnings.refuse(warnings)
    }

    /// Reads all files; every error names its file.
    fn load(&self) -> Result<Inputs, Failure> {
        let others = [&self.target, &self.reference].into_iter().flatten();
        let files = [&self.link.link, &self.torque].into_iter().chain(others);
        keep(&self.output, &files.map(PathBuf::as_path).collect::<Vec<_>>())?;
        let (link_file, specification) = self.link.load()?;
        let length_m = specification.link.length_m();
        let torque_file = InputFile::read(&self.torque)?;
        let read = |path: &Option<PathBuf>| path.as_deref().map(InputFile::read).transpose();
        let (target_file, reference_file) = (read(&self.target)?, read(&self.reference)?);
        let column = self.column.as_deref();
        let InputFile { shown, bytes, .. } = &torque_file;
        let (torque, reading) = read_torque_table_as(shown, bytes, column, &self.read.format())?;
        tell(shown, &reading);
        // The options are those of TORQUE.
        let form = TableFormat::default();
        let target = |file: InputFile| -> Result<_, Failure> {
            let table = read_motion_table_as(&file.shown, &file.bytes, length_m, &form)?;
            let reading = table.reading().clone();
            let target = table.into_target()?;
            tell(&file.shown, &reading);
            Ok((file, target))
        };
        let target = target_file.map(target).transpose()?;
        let reference = |file: &InputFile| -> Result<HubReference, Failure> {
            let (reference, reading) = read_hub_reference_as(&file.shown, &file.bytes, &form)?;
            tell(&file.shown, &reading);
            Ok(reference)
        };
        let reference = reference_file.as_ref().map(reference).transpose()?;
        // A link at rest is straight: the hub points to its tip.
        let pointed = |reference: &HubReference| reference.angle_rad()[0] * length_m;
        let initial_tip_m = match &target {
            Some((_, target)) => target.start_m(),
            None => reference.as_ref().map(pointed).unwrap_or_default(),
        };
        let feedback = self.feedback.zip(reference);
        let feedback = feedback.map(|((kp, kd), reference)| Feedback::new(kp, kd, reference));
        let feedback = feedback
            .transpose()
            .map_err(|error| Failure::new(Exit::Usage, &format!("--feedback: {error}"), None))?;
        Ok(Inputs {
            link_file,
            specification,
            torque_file,
            torque,
            target,
            reference_file,
            feedback,
            initial_tip_m,
        })
    }

    /// Plays the torque until the time of the command line, else as long as torque and target last.
    /// Computes the errors of the tip and of the simulation itself.
    fn compute<'a>(&self, inputs: &'a Inputs) -> Result<Played<'a>, Failure> {
        let Specification { link, mesh, .. } = &inputs.specification;
        let torque_s = inputs.torque.grid().end_s();
        let both_s = inputs.target.as_ref().map(|(_, target)| target.grid().end_s().max(torque_s));
        let play = Play {
            torque: &inputs.torque,
            interpolation: match self.hold {
                Hold::Cubic if self.linear => Interpolation::Linear,
                Hold::Cubic => Interpolation::Cubic,
                Hold::Linear => Interpolation::Linear,
                Hold::Zero => Interpolation::Zero,
            },
            until_s: self.until.or(both_s),
            feedback: inputs.feedback.as_ref(),
            initial_tip_m: inputs.initial_tip_m,
            memory_bytes: memory::available(),
        };
        let refused = |error| self.refused(&error, inputs);
        let simulation = simulate(link, mesh, &play).map_err(refused)?;
        self.nodes.check(&simulation.mesh)?;
        let tip_error = self.tip_error(&simulation, inputs)?;
        let bytes = self.nodes.outputs(self.digits).simulation_bytes(&simulation);
        memory::check_nodes(bytes, play.memory_bytes)?;
        let error = PlayError::of(&simulation, link, &play).map_err(refused)?;
        Ok(Played { metrics: PlayedMetrics::of(&simulation), play, simulation, error, tip_error })
    }

    /// The failure of a simulation, with the file or option that causes it.
    fn refused(&self, error: &SimulationError, inputs: &Inputs) -> Failure {
        let (exit, place) = match error {
            SimulationError::NoTorque => (Exit::InputRefused, shown(&inputs.torque_file)),
            SimulationError::OtherTimes { .. } => {
                (Exit::InputRefused, inputs.reference_file.as_ref().map(shown).unwrap_or_default())
            }
            // The target is longer than the torque.
            SimulationError::TooLong { until_s, samples, limit } if self.until.is_none() => {
                let place = inputs.target_shown();
                let found =
                    format!("the end = {} s, {samples:.3e} steps of the torque", plain(*until_s));
                let message = format!("{place}{found}, but must be at most {limit} steps");
                return Failure::new(Exit::InputRefused, &message, error.hint());
            }
            // The message begins with the option's name.
            SimulationError::TooLong { .. } | SimulationError::EndsEarly { .. } => {
                (Exit::Usage, "--".to_owned())
            }
            SimulationError::Plan(_)
            | SimulationError::Damping(_)
            | SimulationError::MasslessHub
            | SimulationError::TooMuchMemory { .. }
            | SimulationError::NotFinite { .. } => (Exit::NotSolvable, String::new()),
        };
        Failure::new(exit, &format!("{place}{error}"), error.hint())
    }

    /// The largest distance of the tip from the target, if there is one.
    fn tip_error(
        &self,
        simulation: &Simulation,
        inputs: &Inputs,
    ) -> Result<Option<TipError>, Failure> {
        let Some((_, target)) = &inputs.target else { return Ok(None) };
        TipError::of(simulation, target).map(Some).map_err(|error| {
            let (exit, place) = match (error, self.until) {
                (TargetError::EndsLate { .. }, Some(until)) => {
                    (Exit::Usage, format!("--until {}: ", plain(until)))
                }
                _ => (Exit::InputRefused, inputs.target_shown()),
            };
            Failure::new(exit, &format!("{place}{error}"), error.hint())
        })
    }

    /// Writes all tables and summary.json.
    fn write(&self, inputs: &Inputs, played: &Played) -> Result<Summary, Failure> {
        let link = &inputs.specification.link;
        let target_file = inputs.target.as_ref().map(|(file, _)| file);
        let record = RunInputs::of_simulate(
            [&inputs.link_file, &inputs.torque_file],
            [target_file, inputs.reference_file.as_ref()],
            self.arguments(),
        );
        let Played { play, simulation, metrics, .. } = played;
        let errors = played.errors();
        let summary = Summary::of_simulation(record, (link, play), simulation, metrics, errors);
        let folder = self.sync.stage(&self.output)?;
        self.nodes.outputs(self.digits).write_simulation(folder, link, simulation, &summary)?;
        Ok(summary)
    }

    /// The arguments that shape the results, for the record.
    fn arguments(&self) -> Vec<String> {
        let column = self.column.iter().map(|column| option("--column", column));
        let until = self.until.map(|until| option("--until", until));
        let linear = self.linear.then(|| vec!["--linear".to_owned()]);
        let hold = self.hold.to_possible_value().filter(|_| self.hold != Hold::Cubic);
        let hold = hold.map(|hold| option("--hold", hold.get_name()));
        let feedback = self.feedback.map(|(kp, kd)| option("--feedback", format!("{kp},{kd}")));
        let played =
            column.chain(until).chain(hold).chain(linear).chain(feedback).flatten().collect();
        let (nodes, digits) = (self.nodes.arguments(), digits_arguments(self.digits));
        [self.link.changes.arguments(), played, nodes, digits, self.read.arguments()].concat()
    }

    /// Prints warnings and the summary; returns the number of warnings.
    fn tell(&self, inputs: &Inputs, played: &Played, summary: &Summary) -> Result<usize, Failure> {
        let Played { play, simulation, metrics, error, tip_error } = played;
        let coarse = error.as_ref().and_then(PlayError::warning);
        let warnings: Vec<_> = simulation.warnings.iter().copied().chain(coarse).collect();
        console::warnings(warnings.iter().map(|warning| (warning, warning.hint())));
        let late = tip_error.and_then(|error| error.late);
        console::warnings(late.map(|late| (late, late.hint())));
        let text = || {
            let files = RunOutputs::simulation_file_names().len();
            let written = format!("{files} files in {}", self.output.display());
            let link = &inputs.specification.link;
            simulate_text(link, play, simulation, metrics, played.errors(), written)
        };
        self.print.print(|| summary.to_json(), text)?;
        Ok(warnings.len() + usize::from(late.is_some()))
    }
}

impl Inputs {
    /// The name of the target's file, as a message begins with it.
    fn target_shown(&self) -> String {
        self.target.as_ref().map(|(file, _)| shown(file)).unwrap_or_default()
    }
}

impl Played<'_> {
    fn errors(&self) -> (Option<&PlayError>, Option<&TipError>) {
        (self.error.as_ref(), self.tip_error.as_ref())
    }
}

/// The file's name, as a message begins with it.
fn shown(file: &InputFile) -> String {
    format!("{}: ", file.shown)
}

/// Two gains, separated by a comma.
fn gains(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let pair = text.split_once(',').and_then(|(kp, kd)| Some((number(kp)?, number(kd)?)));
    pair.ok_or_else(|| "must be two numbers, KP,KD".into())
}
