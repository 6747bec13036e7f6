use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::ArgPredicate;

use flexlink::csv::InputFile;
use flexlink::store::REPORT;

use super::options::SolveOptions;
use super::repeat::Repetition;
use super::run::{Destination, Problem, Solved, WithPage};
use crate::cli::args::SyncArgs;
use crate::cli::inputs::{LINK, MOTION};
use crate::cli::verify::refuse_failed;
use crate::terminal::files::keep;
use crate::terminal::text::{solve_text, verify_text};
use crate::terminal::{Ending, Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console};

const EXAMPLE: &str = "\
Example:
  flexlink solve link.toml motion.csv -o out
  flexlink solve link.toml motion.csv \\
      --set 'segments.*.EI*=4' --nodes 0,5,10 --every 10
  flexlink solve --repeat out

LINK and MOTION are described in the README; one of them may be `-`, standard input.";

const LONG_ABOUT: &str = "\
Compute the hub torque for a tip motion.

Writes torque.csv, rigid_torque.csv, hub_angle.csv, nodal_displacements.csv, tip.csv, nodes.csv \
and summary.json into a folder, all or none of them, and prints a short summary.";

const USAGE: &str = "\
flexlink solve [OPTIONS] <LINK> <MOTION>
       flexlink solve --repeat <DIR> [LINK [MOTION]]";

/// Compute the hub torque for a tip motion.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE, override_usage = USAGE)]
pub(crate) struct Solve {
    #[arg(value_name = "LINK", help = LINK, required_unless_present = "repeat")]
    link: Option<PathBuf>,

    #[arg(value_name = "MOTION", help = MOTION, required_unless_present = "repeat")]
    motion: Option<PathBuf>,

    /// Folder for the results.
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    #[arg(default_value_if("repeat", ArgPredicate::IsPresent, None))]
    output: Option<PathBuf>,

    /// Run again what left its results in this folder, and compare every file byte for byte; exit
    /// code 1 if one differs. LINK and MOTION, where they are not given, are looked for here, in the
    /// folder and above it; the new results are kept where -o names another folder.
    #[arg(long, value_name = "DIR")]
    #[arg(conflicts_with_all = ["ChangeArgs", "ResampleArgs", "ScaleArgs", "NodeArgs"])]
    #[arg(conflicts_with_all = ["deflections", "moments", "digits", "verify"])]
    #[arg(conflicts_with_all = ["report", "strict", "json"])]
    repeat: Option<PathBuf>,

    #[command(flatten)]
    options: SolveOptions,

    #[arg(long, help = "Also write report.html, the page that `flexlink report` makes")]
    report: bool,

    /// Fail with exit code 4 if a limit of the link file is exceeded; the results are written.
    #[arg(long)]
    strict: bool,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    sync: SyncArgs,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

impl Solve {
    pub(crate) fn run(self) -> Result<Ending, Failure> {
        self.threads.start()?;
        if let Some(run) = &self.repeat {
            return self.repetition(run).run();
        }
        let (Some(link), Some(motion), Some(output)) = (&self.link, &self.motion, &self.output)
        else {
            // The parser asks for them.
            return Err(Failure::new(Exit::Usage, &"nothing to solve", None));
        };
        keep(output, &[link, motion])?;
        let motion_file = || Ok(InputFile::read(motion)?);
        let problem = Problem::read(&self.options, InputFile::read_toml(link)?, motion_file)?;
        let solved = self.solve(&problem, output)?;
        self.tell(&solved, output)?;
        self.judge(&solved)
    }

    /// The run to repeat, with the options that hold for it.
    fn repetition<'a>(&'a self, run: &'a Path) -> Repetition<'a> {
        Repetition {
            run,
            link: self.link.as_deref(),
            motion: self.motion.as_deref(),
            output: self.output.as_deref(),
            durability: self.sync.durability(),
            print: &self.print,
            warnings: &self.warnings,
        }
    }

    /// Solves the problem and writes the results.
    fn solve(&self, problem: &Problem, folder: &Path) -> Result<Solved, Failure> {
        let page = if self.report { WithPage::Yes } else { WithPage::No };
        let (durability, stages) = (self.sync.durability(), &self.print.stages());
        problem.solve(&self.options, &Destination { folder, durability, page, stages })
    }

    /// Prints remarks, warnings and the summary.
    fn tell(&self, solved: &Solved, output: &Path) -> Result<(), Failure> {
        let Solved { solution, metrics, exceeded, verification, remarks, summary, files } = solved;
        console::remarks(remarks);
        for warning in &solution.warnings {
            console::warning(warning, warning.hint());
        }
        // With --strict the first is an error, printed at the end.
        for limit in exceeded.iter().skip(usize::from(self.strict)) {
            console::warning(limit, limit.hint());
        }
        let text = || {
            let written = format!("{files} files in {}", output.display());
            let summary = solve_text(solution, metrics, &written);
            let checks = verification.as_ref().map(verify_text).unwrap_or_default();
            let page = format!("written  {}\n", output.join(REPORT).display());
            summary + &checks + if self.report { &page } else { "" }
        };
        self.print.print(|| summary.to_json(), text)
    }

    /// Fails if a check is out of its bound, or for limits and warnings where the options say so.
    fn judge(&self, solved: &Solved) -> Result<Ending, Failure> {
        solved.verification.as_ref().map_or(Ok(()), refuse_failed)?;
        if let Some(limit) = solved.exceeded.first().filter(|_| self.strict) {
            return Err(Failure::new(Exit::NotSolvable, limit, Some(limit.hint())));
        }
        self.warnings.refuse(solved.solution.warnings.len() + solved.exceeded.len())?;
        Ok(Ending::Done)
    }
}
