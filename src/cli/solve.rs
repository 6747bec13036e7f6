use std::path::PathBuf;

use clap::Args;

use flexlink::inverse::invert;
use flexlink::link::Drive;
use flexlink::result::Metrics;
use flexlink::spec::Specification;
use flexlink::tables::{Digits, OptionalTable, OutputFolder, RunInputs, SolveOutputs, Summary};

use super::args::{LinkArgs, MotionArgs, NodeArgs, PrintArgs, SyncArgs, ThreadArgs};
use super::console;
use super::exit::{Exit, Failure};
use super::files::keep;
use super::memory::check_nodal_memory;
use super::progress::StageBar;
use super::report::write_page;
use super::solve_text::{memory_text, solve_text};
use super::verify::{measured, refuse_failed};
use super::verify_text::verify_text;

const EXAMPLE: &str = "\
Example:
  flexlink solve link.toml motion.csv -o out
  flexlink solve link.toml motion.csv \\
      --set 'segments.*.EI*=4' --nodes 0,5,10 --every 10

LINK and MOTION are described in the README; one of them may be `-`, standard input.";

const LONG_ABOUT: &str = "\
Compute the hub torque for a tip motion.

Writes torque.csv, rigid_torque.csv, hub_angle.csv, nodal_displacements.csv, tip.csv, nodes.csv \
and summary.json into a folder, all or none of them, and prints a short summary.";

/// Memory in bytes from which on it is said before the work begins.
const LARGE: usize = 1 << 29;

/// Compute the hub torque for a tip motion.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE)]
pub(crate) struct Solve {
    #[command(flatten)]
    link: LinkArgs,

    #[command(flatten)]
    motion: MotionArgs,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    output: PathBuf,

    #[command(flatten)]
    nodes: NodeArgs,

    #[command(flatten)]
    also: OptionalArgs,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "10")]
    digits: Digits,

    /// Measure the answer by other means, as `flexlink verify` does, and keep the table in
    /// summary.json; exit code 4 if a number is out of its bound, the results are written.
    #[arg(long)]
    verify: bool,

    /// Fail with exit code 4 if a limit of the link file is exceeded; the results are written.
    #[arg(long)]
    strict: bool,

    #[command(flatten)]
    sync: SyncArgs,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// What is written beyond what always is.
#[derive(Debug, Args)]
struct OptionalArgs {
    #[arg(long, help = "Also write nodal_deflections.csv: deflection from the hub's tangent line")]
    deflections: bool,

    #[arg(long, help = "Also write bending_moments.csv")]
    moments: bool,

    #[arg(long, help = "Also write report.html, the page that `flexlink report` makes")]
    report: bool,
}

impl Solve {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.apply()?;
        keep(&self.output, &[&self.link.link, self.motion.path()])?;
        let (link_file, specification) = self.link.load()?;
        let Specification { link, mesh, analysis, drive, limits } = &specification;
        let (motion_file, motion) = self.motion.load(link)?;

        let stages = if self.print.quiet { StageBar::hidden() } else { StageBar::new() };
        let solution = invert(link, mesh, &motion, analysis)?;
        self.nodes.check(solution.mesh())?;
        let measure = || measured(&specification, &motion, &solution, self.digits);
        let verification = self.verify.then(measure).transpose()?;

        let outputs = self.outputs(*drive);
        let inputs = RunInputs {
            link_file: &link_file,
            motion_file: &motion_file,
            link,
            motion: &motion,
            analysis,
            drive: drive.as_ref(),
            changes: &self.changes(),
            verification: verification.as_ref(),
        };
        let metrics = Metrics::of(&solution);
        let exceeded = limits.exceeded(&metrics);
        let files = outputs.file_names();
        let summary = Summary::new(&inputs, &solution, &metrics, &exceeded, files.clone());
        let deflections = outputs.deflections(&solution);
        check_nodal_memory(deflections.bytes())?;
        if deflections.bytes() >= LARGE && !self.print.quiet {
            stages.say(&memory_text(deflections.bytes(), deflections.blocks()));
        }
        let folder = OutputFolder::stage(&self.output)?.with(self.sync.durability());
        outputs.write(folder, link, (&solution, deflections), &summary, &stages)?;
        drop(stages);

        for warning in &solution.warnings {
            console::warning(warning, warning.hint());
        }
        // With --strict the first is an error, told at the end.
        for limit in exceeded.iter().skip(usize::from(self.strict)) {
            console::warning(limit, limit.hint());
        }
        let written = format!("{} files in {}", files.len(), self.output.display());
        match (self.print.quiet, self.print.json) {
            (true, _) => {}
            (_, true) => console::print_bytes(summary.to_json().as_bytes())?,
            _ => {
                let text = solve_text(link, &motion, &solution, &metrics, &written);
                let checks = verification.as_ref().map(verify_text).unwrap_or_default();
                console::print(&(text + &checks))?;
            }
        }
        if self.also.report {
            let page = write_page(&self.output)?;
            if !self.print.quiet && !self.print.json {
                console::print(&page)?;
            }
        }
        if let Some(verification) = &verification {
            refuse_failed(verification)?;
        }
        match exceeded.first().filter(|_| self.strict) {
            Some(limit) => Err(Failure::new(Exit::NotSolvable, limit, Some(limit.hint()))),
            None => Ok(()),
        }
    }

    fn outputs(&self, drive: Option<Drive>) -> SolveOutputs {
        let optional = [
            (self.also.deflections, OptionalTable::NodalDeflections),
            (self.also.moments, OptionalTable::BendingMoments),
        ];
        SolveOutputs {
            nodes: self.nodes.list.clone(),
            every: self.nodes.every,
            optional: optional.into_iter().filter(|(on, _)| *on).map(|(_, table)| table).collect(),
            drive,
            digits: self.digits,
        }
    }

    /// The arguments that changed the inputs, for the record.
    fn changes(&self) -> Vec<String> {
        self.link.record().chain(self.motion.change()).collect()
    }
}
