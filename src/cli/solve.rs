use std::path::PathBuf;

use clap::Args;

use flexlink::spec::Specification;
use flexlink::tables::InputFile;

use super::args::{LINK, MOTION, PrintArgs, SyncArgs, ThreadArgs};
use super::console;
use super::exit::{Exit, Failure};
use super::files::keep;
use super::progress::StageBar;
use super::report::write_page;
use super::solve_options::SolveOptions;
use super::solve_run::{Destination, Problem, Solved};
use super::solve_text::solve_text;
use super::verify::refuse_failed;
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

/// Compute the hub torque for a tip motion.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE)]
pub(crate) struct Solve {
    #[arg(value_name = "LINK", help = LINK)]
    link: PathBuf,

    #[arg(value_name = "MOTION", help = MOTION)]
    motion: PathBuf,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    output: PathBuf,

    #[command(flatten)]
    options: SolveOptions,

    #[arg(long, help = "Also write report.html, the page that `flexlink report` makes")]
    report: bool,

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

impl Solve {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.apply()?;
        keep(&self.output, &[&self.link, &self.motion])?;
        let motion_file = || Ok(InputFile::read(&self.motion)?);
        let problem = Problem::read(&self.options, InputFile::read(&self.link)?, motion_file)?;

        let stages = if self.print.quiet { StageBar::hidden() } else { StageBar::new() };
        let to = Destination {
            folder: &self.output,
            durability: self.sync.durability(),
            stages: &stages,
        };
        let solved = problem.solve(&self.options, &to)?;
        drop(stages);
        self.tell(&problem, &solved)?;
        if self.report {
            let page = write_page(&self.output)?;
            if !self.print.quiet && !self.print.json {
                console::print(&page)?;
            }
        }
        if let Some(verification) = &solved.verification {
            refuse_failed(verification)?;
        }
        match solved.exceeded.first().filter(|_| self.strict) {
            Some(limit) => Err(Failure::new(Exit::NotSolvable, limit, Some(limit.hint()))),
            None => Ok(()),
        }
    }

    fn tell(&self, problem: &Problem, solved: &Solved) -> Result<(), Failure> {
        let Solved { solution, metrics, exceeded, verification, summary, files } = solved;
        for warning in &solution.warnings {
            console::warning(warning, warning.hint());
        }
        // With --strict the first is an error, told at the end.
        for limit in exceeded.iter().skip(usize::from(self.strict)) {
            console::warning(limit, limit.hint());
        }
        match (self.print.quiet, self.print.json) {
            (true, _) => Ok(()),
            (_, true) => console::print_bytes(summary.to_json().as_bytes()),
            _ => {
                let written = format!("{files} files in {}", self.output.display());
                let Specification { link, .. } = &problem.specification;
                let text = solve_text(link, &problem.motion, solution, metrics, &written);
                let checks = verification.as_ref().map(verify_text).unwrap_or_default();
                console::print(&(text + &checks))
            }
        }
    }
}
