//! `solve`: link and motion in, torque out; with `--repeat`, the repetition of a run.

mod notes;
mod repeat;
pub mod run;
pub mod table;
pub mod write_args;

use std::path::PathBuf;

use clap::Args;
use clap::builder::ArgPredicate;

use crate::cli::options::common::SyncArgs;
use crate::cli::options::inputs::{LINK, MOTION};
use crate::cli::problem::Solved;
use crate::cli::terminal::files::{keep, read_once};
use crate::cli::terminal::text::{rows_text, solve_text, verify_text};
use crate::cli::terminal::{Ending, Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console};
use crate::cli::verify::refuse_failed;
use crate::csv::InputFile;
use crate::numeric::TimeGrid;
use crate::result::Notice;
use crate::store::{REPORT, Summary};
use crate::text::shown_path;
use run::{Page, Run, SolveOptions, SolvedRun};
use table::WrittenTable;
use write_args::WriteArgs;

const EXAMPLE: &str = "\
Example:
  flexlink solve link.toml motion.csv -o out
  flexlink solve link.toml motion.csv \\
      --set 'segments.*.EI*=4' --nodes 0,5,10 --every 10
  flexlink solve link.toml lab.csv \\
      --columns time=1,displacement=3 --unit mm
  flexlink solve link.toml motion.csv --write move.h \\
      --with position,effort --cycle '2 ms' --window 1%
  flexlink solve --repeat out

`flexlink help files` describes LINK, MOTION and measured tables; one of them \
may be `-`, standard input. An arm of several links and its path: docs/arms.md.";

const USAGE: &str = "\
flexlink solve [OPTIONS] <LINK> <MOTION>
       flexlink solve --repeat <DIR> [LINK [MOTION]]";

/// Compute the torque at the hub, or the force on the carriage, for a tip motion.
///
/// Writes torque.csv, rigid_torque.csv, hub_angle.csv, nodal_displacements.csv, tip.csv, nodes.csv and
/// summary.json into a folder, all or none of them, and prints a short summary. A carriage has force.csv,
/// rigid_force.csv and carriage.csv.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE, override_usage = USAGE)]
pub(crate) struct Solve {
    #[arg(value_name = "LINK", help = LINK, required_unless_present = "repeat")]
    pub(super) link: Option<PathBuf>,

    #[arg(value_name = "MOTION", help = MOTION, required_unless_present = "repeat")]
    pub(super) motion: Option<PathBuf>,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    #[arg(default_value_if("repeat", ArgPredicate::IsPresent, None))]
    #[arg(default_value_if("write", ArgPredicate::IsPresent, None))]
    pub(super) output: Option<PathBuf>,

    /// Repeat the run whose results are in this folder, and compare every file byte for byte; exit
    /// code 1 if one differs. Without LINK and MOTION it searches for
    /// them in the working folder, in DIR and in the folders above it. Only -o keeps the new results.
    #[arg(long, value_name = "DIR")]
    #[arg(conflicts_with_all = ["ChangeArgs", "SampleArgs", "ScaleArgs", "NodeArgs", "ReadArgs"])]
    #[arg(conflicts_with_all = ["deflections", "moments", "golden", "digits", "verify"])]
    #[arg(conflicts_with_all = ["report", "strict", "json", "write"])]
    repeat: Option<PathBuf>,

    #[command(flatten)]
    options: SolveOptions,

    /// Also write report.html, the page that `flexlink report` makes.
    #[arg(long, conflicts_with = "golden")]
    report: bool,

    #[command(flatten)]
    table: WriteArgs,

    /// Fail with exit code 4 if a limit of the link file is exceeded; the results are written.
    #[arg(long)]
    strict: bool,

    #[command(flatten)]
    pub(super) warnings: WarningArgs,

    #[command(flatten)]
    pub(super) sync: SyncArgs,

    #[command(flatten)]
    pub(super) print: PrintArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

impl Solve {
    pub(crate) fn run(self) -> Result<Ending, Failure> {
        self.threads.start()?;
        if let Some(run) = &self.repeat {
            return self.repeat(run);
        }
        self.check()?;
        let output = self.output.as_deref();
        let run = self.load()?;
        let chosen = run.problem.specification.arm.pick(None, self.options.nodes.chosen());
        if let Some(option) = chosen.filter(|_| self.report) {
            let message =
                format!("--report draws an arm with all its nodes, but {option} leaves some out");
            return Err(Failure::new(Exit::Usage, &message, Some("leave one of them out")));
        }
        let (ends, step_s) = run.problem.ends_and_step_s();
        self.table.check_motion(ends, step_s)?;
        let stages = self.print.stages();
        let solved = run.solve(&stages)?;
        let solution = &solved.solved.solution;
        let table = self.table.table(solution, run.problem.plans(), &stages)?;
        let mut summary = self.table.recorded_in(run.summary(&solved), table.as_ref());
        match output {
            Some(output) => {
                let folder = (output, self.sync.durability());
                run.write((&solved, &summary), folder, self.page(), &stages)?;
            }
            None => summary = summary.without_files(),
        }
        drop(stages);
        let warned = self.deliver(table.as_ref(), &summary)?;
        let warned = warned + solved.solved.tell();
        self.tell(&solved, &summary, table.as_ref())?;
        self.judge(&solved, warned)
    }

    /// Refuses contradictory options.
    fn check(&self) -> Result<(), Failure> {
        let refuse = |message: &str, hint| Err(Failure::new(Exit::Usage, &message, Some(hint)));
        let report = self.report.then_some("--report");
        let shapes = report.or_else(|| self.options.shapes_results());
        if let Some(option) = shapes.filter(|_| self.output.is_none()) {
            let message = format!("{option} has no effect on the table of --write");
            let hint = match option {
                "--every" => {
                    "write the nodal tables that it thins with -o DIR; --resample STEP sets the table's step"
                }
                _ => "write the results, too, with -o DIR",
            };
            return refuse(&message, hint);
        }
        if self.print.json && self.table.is_printed() {
            let message = "--json cannot print: standard output has the table of --write -";
            return refuse(message, "write the table into a file: --write FILE");
        }
        Ok(())
    }

    /// Writes the torque table, if there is one; returns the number of warnings.
    fn deliver(&self, table: Option<&WrittenTable>, summary: &Summary) -> Result<usize, Failure> {
        table.map_or(Ok(0), |table| self.table.deliver(table, summary, self.options.digits))
    }

    /// Prints the summary to standard output. If the table goes there, prints only the remarks on it and its
    /// `checks`, to standard error.
    fn print(
        &self,
        summary: &Summary,
        text: impl FnOnce() -> String,
        table: Option<(&WrittenTable, &str)>,
    ) -> Result<(), Failure> {
        let (of_table, checks) = match table {
            Some((table, checks)) => (self.table.text(table), checks),
            None => (String::new(), ""),
        };
        if !self.table.is_printed() {
            return self.print.print(|| summary.to_json(), || text() + &of_table);
        }
        if !self.print.quiet {
            checks.lines().chain(of_table.lines()).for_each(console::plain);
        }
        Ok(())
    }

    fn page(&self) -> Page {
        if self.report { Page::Written } else { Page::Left }
    }

    /// Numbers of written rows and files, and their folder; empty without a folder.
    fn written(&self, grid: &TimeGrid, summary: &Summary) -> String {
        let Some(output) = &self.output else { return String::new() };
        let rows = self.options.outputs().rows(grid);
        let (rows, files) = (rows_text(&rows), summary.file_count());
        format!("{rows}; {files} files in {}", shown_path(output))
    }

    /// The line with the name of the page; empty without one.
    fn page_line(&self) -> String {
        let output = self.output.as_ref().filter(|_| self.report);
        let line = |output: &PathBuf| format!("written  {}\n", shown_path(&output.join(REPORT)));
        output.map(line).unwrap_or_default()
    }

    /// Reads the problem.
    fn load(&self) -> Result<Run<'_>, Failure> {
        let (Some(link), Some(motion)) = (&self.link, &self.motion) else {
            // The parser requires them.
            return Err(Failure::new(Exit::Usage, &"nothing to solve", None));
        };
        let (inputs, output) = ([link.as_path(), motion.as_path()], self.output.as_deref());
        output.map_or_else(|| read_once(&inputs), |output| keep(output, &inputs))?;
        self.table.check(&inputs, output)?;
        let motion_file = || Ok(InputFile::read(motion)?);
        Run::read(&self.options, InputFile::read_toml(link)?, motion_file)
    }

    /// Prints the limits and the summary.
    fn tell(
        &self,
        SolvedRun { solved, verification, .. }: &SolvedRun,
        summary: &Summary,
        table: Option<&WrittenTable>,
    ) -> Result<(), Failure> {
        let Solved { solution, metrics, exceeded, .. } = solved;
        // With --strict the first is an error, printed at the end.
        let limits = exceeded.iter().skip(usize::from(self.strict));
        console::warnings(limits.map(|own| Notice::from(own).worded(&solution.arm)));
        let checks = verification.as_ref().map(verify_text).unwrap_or_default();
        let text = || {
            let written = self.written(&solution.grid, summary);
            let nodes = self.options.nodes.text(&solution.nodes_m());
            solve_text(solution, metrics, written) + &nodes + &checks + &self.page_line()
        };
        self.print(summary, text, table.map(|table| (table, &*checks)))
    }

    /// Returns an error if a check is out of its bound, or if the options forbid the exceeded limits or this number
    /// of warnings.
    fn judge(&self, run: &SolvedRun, warned: usize) -> Result<Ending, Failure> {
        run.verification.as_ref().map_or(Ok(()), refuse_failed)?;
        let exceeded = &run.solved.exceeded;
        if let Some(limit) = exceeded.first().filter(|_| self.strict) {
            let limit = Notice::from(limit).worded(&run.solved.solution.arm);
            return Err(Failure::new(Exit::NotSolvable, &limit.message, Some(&limit.hint)));
        }
        self.warnings.refuse(exceeded.len() + warned)?;
        Ok(Ending::Done)
    }
}
