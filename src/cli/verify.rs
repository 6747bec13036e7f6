//! `verify`: the answer of `solve` measured by other means.

use std::path::PathBuf;

use clap::Args;

use crate::csv::{Digits, InputFile};
use crate::inverse::Analysis;
use crate::store::verification_json;
use crate::verify::Verification;

use super::problem::Problem;
use crate::cli::options::inputs::{LinkArgs, MOTION, MotionArgs};
use crate::cli::options::reading::TableName;
use crate::cli::terminal::files::read_once;
use crate::cli::terminal::text::verify_text;
use crate::cli::terminal::{Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, memory};

const EXAMPLE: &str = "\
Example:
  flexlink verify link.toml motion.csv

One of LINK and MOTION may be `-`, standard input. An arm of several links and its path: docs/arms.md.";

/// Check the torque of `solve` by independent methods.
///
/// Prints a table. Each line compares an error with its bound: the tip when the torque is played as it is written,
/// with the damping law of the link; the same with viscous damping, less the predicted difference; the solved tip;
/// the torque of hub and motor with the step halved; the quantity that halved elements change most; the quantity that
/// is largest at the window's edge; the transfer of the paper's dense system; the balance of energy. Further lines
/// hold the deflection of the tip, which must be small, and every limit of the link file. Exit code 4 if a number is
/// out of its bound.
#[derive(Debug, Args)]
#[command(about = "Check the torque of `solve` by independent methods", after_help = EXAMPLE)]
#[command(mut_arg("json", |json| json.help("Print the checks as JSON instead of the table")))]
pub(crate) struct Verify {
    #[command(flatten)]
    link: LinkArgs,

    #[arg(value_name = "MOTION", help = MOTION)]
    motion: PathBuf,

    #[command(flatten)]
    how: MotionArgs,

    /// Digits of the torque that is played: the last one is 10^-N of its peak, or `full`.
    #[arg(long, value_name = "N", default_value = "10")]
    digits: Digits,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

impl Verify {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        read_once(&[&self.link.link, &self.motion])?;
        let (file, specification) = self.link.load()?;
        let motion = InputFile::read(&self.motion)?;
        self.how.read.check(&[TableName::Motion])?;
        let problem = Problem::read((&file, specification), &motion, &self.how)?;
        let stages = self.print.stages();
        let solved = problem.solve(Analysis::clone, memory::available(), &stages)?;
        let verification = solved.verified(problem.plans(), self.digits, &stages)?;
        drop(stages);
        let warnings = solved.tell();
        self.print.print(|| verification_json(&verification), || verify_text(&verification))?;
        refuse_failed(&verification)?;
        self.warnings.refuse(warnings)
    }
}

/// Returns an error if a check is out of its bound.
pub(crate) fn refuse_failed(verification: &Verification) -> Result<(), Failure> {
    let failed: Vec<&str> = verification.failed().map(|check| check.what.as_str()).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let message = format!("out of bounds: {}", failed.join("; "));
    let hint = verification.failed().next().map(|check| check.hint);
    Err(Failure::new(Exit::NotSolvable, &message, hint))
}
