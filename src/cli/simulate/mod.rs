mod inputs;
mod text;

use std::path::PathBuf;

use clap::Args;

use flexlink::csv::Digits;
use flexlink::response::{PlayError, simulate};
use flexlink::result::PlayedMetrics;
use flexlink::spec::Specification;
use flexlink::store::{OutputFolder, SimulateOutputs, SimulationInputs, SimulationSummary};

use super::args::{NodeArgs, PrintArgs, SyncArgs, ThreadArgs, WarningArgs, digits_arguments};
use super::files::keep;
use super::inputs::LinkArgs;
use crate::terminal::{Failure, console, memory, threads};
use inputs::PlayArgs;
use text::simulate_text;

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
        threads::start(self.threads.threads)?;
        keep(&self.output, &[&[&*self.link.link], &self.play.paths()[..]].concat())?;
        let (link_file, specification) = self.link.load()?;
        let Specification { link, mesh, .. } = &specification;
        let read = self.play.read(link)?;

        let play = self.play.play(&read);
        let simulation =
            simulate(link, mesh, &play).map_err(|error| self.play.refused(&error, &read))?;
        self.nodes.check(&simulation.mesh)?;
        let tip_error = self.play.tip_error(&simulation, &read)?;

        let outputs = self.outputs();
        memory::check_nodes(outputs.nodal_bytes(&simulation), play.memory_bytes)?;
        let inputs = SimulationInputs {
            link_file: &link_file,
            torque_file: &read.torque_file,
            target_file: read.target_file.as_ref(),
            reference_file: read.reference_file.as_ref(),
            link,
            play: &play,
            arguments: &self.arguments(),
        };
        let metrics = PlayedMetrics::of(&simulation);
        let names = SimulateOutputs::file_names();
        let written = format!("{} files in {}", names.len(), self.output.display());
        let tip_error = tip_error.as_ref();
        let error = PlayError::of(&simulation, link, &play)
            .map_err(|error| self.play.refused(&error, &read))?;
        let errors = (error.as_ref(), tip_error);
        let summary = SimulationSummary::new(&inputs, &simulation, &metrics, errors, names);
        outputs.write(
            OutputFolder::stage(&self.output, &console::waiting)?.with(self.sync.durability()),
            link,
            &simulation,
            &summary,
        )?;

        let coarse = error.and_then(|error| error.warning());
        let warnings: Vec<_> = simulation.warnings.iter().copied().chain(coarse).collect();
        for warning in &warnings {
            console::warning(warning, warning.hint());
        }
        let late = tip_error.and_then(|error| error.late);
        if let Some(late) = late {
            console::warning(late, late.hint());
        }
        match (self.print.quiet, self.print.json) {
            (true, _) => {}
            (_, true) => console::print_bytes(summary.to_json().as_bytes())?,
            _ => {
                let lines = simulate_text(link, &play, &simulation, &metrics, errors, &written);
                console::print(&lines)?;
            }
        }
        self.warnings.refuse(warnings.len() + usize::from(late.is_some()))
    }

    fn outputs(&self) -> SimulateOutputs {
        SimulateOutputs {
            nodes: self.nodes.list.clone(),
            every: self.nodes.every,
            digits: self.digits,
        }
    }

    /// The arguments that shape the results, for the record.
    fn arguments(&self) -> Vec<String> {
        let (nodes, digits) = (self.nodes.arguments(), digits_arguments(self.digits));
        [self.link.changes.arguments(), self.play.arguments(), nodes, digits].concat()
    }
}
