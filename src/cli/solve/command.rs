use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::ArgPredicate;

use flexlink::csv::InputFile;
use flexlink::numeric::TimeGrid;
use flexlink::store::{REPORT, Summary};

use super::arm::{ArmProblem, SolvedRun};
use super::problem::OneOrSeveral;
use super::run::{Page, SolveOptions, Solved};
use crate::cli::arm::SolvedArm;
use crate::cli::verify::{refuse_failed, warn};
use crate::options::common::SyncArgs;
use crate::options::inputs::{LINK, MOTION};
use crate::terminal::files::keep;
use crate::terminal::text::{arm_text, rows_text, solve_text, verify_text};
use crate::terminal::{Ending, Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console};

const EXAMPLE: &str = "\
Example:
  flexlink solve link.toml motion.csv -o out
  flexlink solve link.toml motion.csv \\
      --set 'segments.*.EI*=4' --nodes 0,5,10 --every 10
  flexlink solve link.toml lab.csv \\
      --columns time=1,displacement=3 --unit mm
  flexlink solve --repeat out

`flexlink help files` describes LINK, MOTION and measured tables; one of them \
may be `-`, standard input. An arm of several links and its path: docs/arms.md.";

const USAGE: &str = "\
flexlink solve [OPTIONS] <LINK> <MOTION>
       flexlink solve --repeat <DIR> [LINK [MOTION]]";

/// Compute the hub torque for a tip motion.
///
/// Writes torque.csv, rigid_torque.csv, hub_angle.csv, nodal_displacements.csv, tip.csv, nodes.csv and
/// summary.json into a folder, all or none of them, and prints a short summary.
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
    pub(super) output: Option<PathBuf>,

    /// Repeat the run whose results are in this folder, and compare every file byte for byte; exit
    /// code 1 if one differs. LINK and MOTION that are not given are searched for in the working
    /// folder, in DIR and in the folders above it. The new results are kept only with -o.
    #[arg(long, value_name = "DIR")]
    #[arg(conflicts_with_all = ["ChangeArgs", "ResampleArgs", "ScaleArgs", "NodeArgs", "ReadArgs"])]
    #[arg(conflicts_with_all = ["deflections", "moments", "golden", "digits", "verify"])]
    #[arg(conflicts_with_all = ["report", "strict", "json"])]
    repeat: Option<PathBuf>,

    #[command(flatten)]
    options: SolveOptions,

    /// Also write report.html, the page that `flexlink report` makes.
    #[arg(long, conflicts_with = "golden")]
    report: bool,

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
        let (problem, output) = self.load()?;
        let problem = match problem {
            OneOrSeveral::One(problem) => problem,
            OneOrSeveral::Several(_) if self.report && self.options.nodes.list.is_some() => {
                let message =
                    "--report draws an arm with all its nodes, but --nodes leaves some out";
                return Err(Failure::new(Exit::Usage, &message, Some("leave one of them out")));
            }
            OneOrSeveral::Several(problem) => return self.run_arm(&problem, output),
        };
        let stages = self.print.stages();
        let solved = problem.solve(&stages)?;
        let folder = (output, self.sync.durability());
        let summary = problem.write(&solved, folder, self.page(), &stages)?;
        drop(stages);
        self.tell(&solved, &summary, output)?;
        self.judge(&solved)
    }

    fn page(&self) -> Page {
        if self.report { Page::Written } else { Page::Left }
    }

    /// How many rows and files are written, and where.
    fn written(&self, grid: &TimeGrid, files: usize, output: &Path) -> String {
        let rows = self.options.outputs().rows(grid);
        format!("{}; {files} files in {}", rows_text(&rows), output.display())
    }

    /// The line that says where the page is; empty without one.
    fn page_line(&self, output: &Path) -> String {
        let line = || format!("written  {}\n", output.join(REPORT).display());
        if self.report { line() } else { String::new() }
    }

    /// Solves an arm of several links, writes and tells.
    fn run_arm(&self, problem: &ArmProblem<'_>, output: &Path) -> Result<Ending, Failure> {
        let stages = self.print.stages();
        let solved = problem.solve(&stages)?;
        let folder = (output, self.sync.durability());
        let summary = problem.write(&solved, folder, self.page(), &stages)?;
        drop(stages);
        let SolvedRun { solved, verification } = &solved;
        ArmProblem::warn(solved, self.strict);
        let SolvedArm { solution, metrics, exceeded, .. } = solved;
        let checks = || verification.as_ref().map(verify_text).unwrap_or_default();
        let text = || {
            let written = self.written(&solution.grid, problem.files(solved), output);
            arm_text(solution, metrics, written) + &checks() + &self.page_line(output)
        };
        self.print.print(|| summary.to_json(), text)?;
        verification.as_ref().map_or(Ok(()), refuse_failed)?;
        if let Some((joint, limit)) = exceeded.first().filter(|_| self.strict) {
            let message = format!("joint {}: {limit}", joint + 1);
            return Err(Failure::new(Exit::NotSolvable, &message, Some(limit.hint())));
        }
        self.warnings.refuse(solution.warnings.len() + exceeded.len())?;
        Ok(Ending::Done)
    }

    /// Reads the problem; returns it with the folder of the results.
    fn load(&self) -> Result<(OneOrSeveral<'_>, &Path), Failure> {
        let (Some(link), Some(motion), Some(output)) = (&self.link, &self.motion, &self.output)
        else {
            // The parser requires them.
            return Err(Failure::new(Exit::Usage, &"nothing to solve", None));
        };
        keep(output, &[link, motion])?;
        let motion_file = || Ok(InputFile::read(motion)?);
        let problem = OneOrSeveral::read(&self.options, InputFile::read_toml(link)?, motion_file)?;
        Ok((problem, output))
    }

    /// Prints remarks, warnings and the summary.
    fn tell(&self, solved: &Solved, summary: &Summary, output: &Path) -> Result<(), Failure> {
        let Solved { solution, metrics, exceeded, verification, remarks, .. } = solved;
        console::remarks(remarks);
        warn(solution);
        // With --strict the first is an error, printed at the end.
        let limits = exceeded.iter().skip(usize::from(self.strict));
        console::warnings(limits.map(|limit| (limit, limit.hint())));
        let text = || {
            let files = self.options.outputs().file_names(solution.link()).len();
            let written = self.written(&solution.grid, files, output);
            let checks = verification.as_ref().map(verify_text).unwrap_or_default();
            solve_text(solution, metrics, written) + &checks + &self.page_line(output)
        };
        self.print.print(|| summary.to_json(), text)
    }

    /// Returns an error if a check is out of its bound, or for limits and warnings where the options say
    /// so.
    fn judge(&self, solved: &Solved) -> Result<Ending, Failure> {
        solved.verification.as_ref().map_or(Ok(()), refuse_failed)?;
        if let Some(limit) = solved.exceeded.first().filter(|_| self.strict) {
            return Err(Failure::new(Exit::NotSolvable, limit, Some(limit.hint())));
        }
        self.warnings.refuse(solved.solution.warnings.len() + solved.exceeded.len())?;
        Ok(Ending::Done)
    }
}
