use std::path::{Path, PathBuf};

use clap::Args;

use flexlink::link::Link;
use flexlink::motion::TipTarget;
use flexlink::response::{Feedback, Interpolation, Play, Simulation, simulate};
use flexlink::result::{PlayedMetrics, TipError};
use flexlink::spec::Specification;
use flexlink::tables::{
    Digits, InputFile, OutputFolder, SimulateOutputs, SimulationInputs, SimulationSummary,
    read_hub_reference, read_motion_table, read_torque_table,
};

use super::args::{LinkArgs, NodeArgs, PrintArgs, ThreadArgs};
use super::console;
use super::exit::{Exit, Failure};
use super::simulate_text::simulate_text;

const EXAMPLE: &str = "\
Example:
  flexlink simulate link.toml out/torque.csv --target out/tip.csv
  flexlink simulate link.toml out/rigid_torque.csv --column rigid_torque_n_m --until 4.5
  flexlink simulate link.toml out/torque.csv --set 'payload.mass=\"50 g\"' --target out/tip.csv \\
      --feedback 20,2 --reference out/hub_angle.csv

`-` reads TORQUE from standard input.";

const LONG_ABOUT: &str = "\
Play a torque on a link: direct dynamics.

Writes tip.csv, hub_angle.csv, nodal_displacements.csv, nodes.csv and summary.json into a folder, \
all or none of them, and prints a short summary. The link is at rest before the torque's first \
sample; after the last one it is free. Each mode is integrated exactly in time, so that the answer \
does not depend on the Fourier transform of solve. A hysteretic link has no equation in time: its \
ratio is taken as the viscous ratio of every mode.";

/// Play a torque on a link: direct dynamics.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE)]
pub(crate) struct Simulate {
    #[command(flatten)]
    link: LinkArgs,

    /// Torque at the hub (CSV): `time` and `torque`.
    #[arg(value_name = "TORQUE")]
    torque: PathBuf,

    /// Column of TORQUE to play [default: `torque`].
    #[arg(long, value_name = "NAME")]
    column: Option<String>,

    /// Go on until this time in s, free of torque [default: to the end of TORQUE, and of the
    /// target].
    #[arg(long, value_name = "T")]
    until: Option<f64>,

    /// Take the torque as straight between its samples, not as a cubic spline.
    #[arg(long)]
    linear: bool,

    /// Tip motion to compare with (CSV): `time` and `displacement`, as tip.csv of solve. The link
    /// starts where it does.
    #[arg(long, value_name = "FILE")]
    target: Option<PathBuf>,

    /// Feedback at the hub around the reference: gains in N m/rad and N m s/rad.
    #[arg(long, value_name = "KP,KD", requires = "reference", value_parser = gains)]
    feedback: Option<(f64, f64)>,

    /// Hub angle that feedback holds to (CSV), hub_angle.csv of solve.
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
    print: PrintArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// Input files beside the link.
struct Files {
    torque: InputFile,
    target: Option<InputFile>,
    reference: Option<InputFile>,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.apply()?;
        self.keep_inputs()?;
        let (link_file, specification) = self.link.load()?;
        let Specification { link, mesh, .. } = &specification;
        let files = self.files()?;
        let torque =
            read_torque_table(&files.torque.shown, &files.torque.bytes, self.column.as_deref())?;
        let target = self.target(&files, link)?;
        let feedback = self.feedback(&files)?;
        let play = Play {
            torque: &torque,
            interpolation: if self.linear { Interpolation::Linear } else { Interpolation::Cubic },
            until_s: self.end_s(torque.grid().end_s(), target.as_ref()),
            feedback: feedback.as_ref(),
            initial_tip_m: target.as_ref().map_or(0.0, TipTarget::start_m),
        };
        let simulation = simulate(link, mesh, &play)?;
        self.nodes.check(&simulation.mesh)?;
        let tip_error = self.tip_error(&simulation, target.as_ref())?;

        let outputs = SimulateOutputs {
            nodes: self.nodes.list.clone(),
            every: self.nodes.every,
            torque: feedback.is_some(),
            digits: self.digits,
        };
        let inputs = SimulationInputs {
            link_file: &link_file,
            torque_file: &files.torque,
            target_file: files.target.as_ref(),
            reference_file: files.reference.as_ref(),
            link,
            play: &play,
            changes: &self.changes(),
        };
        let metrics = PlayedMetrics::of(&simulation);
        let names = outputs.file_names();
        let written = format!("{} files in {}", names.len(), self.output.display());
        let summary =
            SimulationSummary::new(&inputs, &simulation, &metrics, tip_error.as_ref(), names);
        outputs.write(OutputFolder::stage(&self.output)?, link, &simulation, &summary)?;

        for warning in &simulation.warnings {
            console::warning(warning, warning.hint());
        }
        match (self.print.quiet, self.print.json) {
            (true, _) => Ok(()),
            (_, true) => console::print(&summary.to_json()),
            _ => console::print(&simulate_text(
                link,
                &play,
                &simulation,
                &metrics,
                tip_error.as_ref(),
                &written,
            )),
        }
    }

    /// Refuses to write over the files that are read.
    fn keep_inputs(&self) -> Result<(), Failure> {
        let Ok(output) = self.output.canonicalize() else { return Ok(()) };
        let inputs = [Some(&self.torque), self.target.as_ref(), self.reference.as_ref()];
        let folder = |file: &&PathBuf| -> Option<PathBuf> {
            file.canonicalize().ok()?.parent().map(Path::to_owned)
        };
        match inputs.into_iter().flatten().find(|file| folder(file).as_ref() == Some(&output)) {
            None => Ok(()),
            Some(file) => {
                let message = format!(
                    "--output = {}, but must be another folder than that of {}",
                    self.output.display(),
                    file.display()
                );
                let hint = "a folder holds one run: the results would replace those read";
                Err(Failure::new(Exit::Usage, &message, Some(hint)))
            }
        }
    }

    fn files(&self) -> Result<Files, Failure> {
        let read = |path: &PathBuf| InputFile::read(path);
        Ok(Files {
            torque: read(&self.torque)?,
            target: self.target.as_ref().map(read).transpose()?,
            reference: self.reference.as_ref().map(read).transpose()?,
        })
    }

    fn target(&self, files: &Files, link: &Link) -> Result<Option<TipTarget>, Failure> {
        let Some(file) = &files.target else { return Ok(None) };
        let table = read_motion_table(&file.shown, &file.bytes, link.length_m())?;
        Ok(Some(table.into_target()?))
    }

    fn feedback(&self, files: &Files) -> Result<Option<Feedback>, Failure> {
        let (Some((kp, kd)), Some(file)) = (self.feedback, &files.reference) else {
            return Ok(None);
        };
        let reference = read_hub_reference(&file.shown, &file.bytes)?;
        let refused = |error: flexlink::response::FeedbackError| {
            let message = format!("--feedback: {error}");
            Failure::new(Exit::Usage, &message, error.hint())
        };
        Feedback::new(kp, kd, reference).map(Some).map_err(refused)
    }

    /// Until when to go on: as asked for, else as long as torque and target last.
    fn end_s(&self, torque_s: f64, target: Option<&TipTarget>) -> Option<f64> {
        self.until.or_else(|| target.map(|target| target.grid().end_s().max(torque_s)))
    }

    fn tip_error(
        &self,
        simulation: &Simulation,
        target: Option<&TipTarget>,
    ) -> Result<Option<TipError>, Failure> {
        let Some(target) = target else { return Ok(None) };
        let error = TipError::of(simulation, target);
        error.map(Some).map_err(|error| Failure::new(Exit::InputRefused, &error, None))
    }

    /// The arguments that changed the inputs, for the record.
    fn changes(&self) -> Vec<String> {
        let sets = self.link.changes.iter().map(|change| format!("--set {change}"));
        let column = self.column.iter().map(|column| format!("--column {column}"));
        let linear = self.linear.then(|| "--linear".to_owned());
        let until = self.until.map(|until| format!("--until {until}"));
        sets.chain(column).chain(until).chain(linear).collect()
    }
}

/// Two gains, separated by a comma.
fn gains(text: &str) -> Result<(f64, f64), String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let pair = text.split_once(',').and_then(|(kp, kd)| Some((number(kp)?, number(kd)?)));
    pair.ok_or_else(|| "must be two numbers, KP,KD".into())
}
