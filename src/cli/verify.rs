//! `verify`: the answer of `solve` measured by other means.

use clap::Args;

use flexlink::csv::{Digits, InputFile};
use flexlink::inverse::{Resources, Solution, invert_with};
use flexlink::spec::Specification;
use flexlink::store::verification_json;
use flexlink::verify::{Answer, Verification, VerificationError, verify};

use super::inputs::remarks;
use super::inputs::{LinkArgs, MotionArgs, ScaleArgs};
use crate::terminal::files::read_once;
use crate::terminal::text::verify_text;
use crate::terminal::{Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink verify link.toml motion.csv

One of LINK and MOTION may be `-`, standard input.";

const LONG_ABOUT: &str = "\
Measure the torque of `solve` by other means: is the answer right?

Prints a table, each line a number against what it may be: the tip under the torque as it is \
written, with the link's own damping law and, against what is predicted of it, with viscous damping \
in its place; the tip that is solved; the torque with the step halved, the motor's too; the quantity \
that halved elements change most, and the one that the window's edge does; the transfer of the paper's \
dense system; the balance of energy; the deflection of the tip, which must be small; every limit of \
the link file. Exit code 4 if one is out of its bound.";

/// Measure the torque of `solve` by other means.
#[derive(Debug, Args)]
#[command(long_about = LONG_ABOUT, after_help = EXAMPLE)]
#[command(mut_arg("json", |json| json.help("Print the checks as JSON instead of the table")))]
pub(crate) struct Verify {
    #[command(flatten)]
    link: LinkArgs,

    #[command(flatten)]
    motion: MotionArgs,

    #[command(flatten)]
    scale: ScaleArgs,

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
        read_once(&[&self.link.link, &self.motion.motion])?;
        let (_, specification) = self.link.load()?;
        let Specification { link, mesh, analysis, .. } = &specification;
        let motion_file = InputFile::read(&self.motion.motion)?;
        let motion = self.scale.scaled(self.motion.resample.motion_of(&motion_file, link)?)?;
        let stages = self.print.stages();
        let resources =
            Resources { memory_bytes: memory::available(), watch: &stages, ..Resources::default() };
        let solution = invert_with(link, mesh, &motion, analysis, &resources)?;
        stages.at("verifying");
        let verification = measured(&specification, &solution, self.digits)?;
        drop(stages);
        console::remarks(&remarks(&specification.remarks, &solution));
        for warning in &solution.warnings {
            console::warning(warning, warning.hint());
        }
        self.print.print(|| verification_json(&verification), || verify_text(&verification))?;
        refuse_failed(&verification)?;
        self.warnings.refuse(solution.warnings.len())
    }
}

/// Measures a solution whose torque is written with so many digits.
pub(crate) fn measured(
    specification: &Specification,
    solution: &Solution,
    digits: Digits,
) -> Result<Verification, VerificationError> {
    verify(&Answer {
        plan: &specification.mesh,
        limits: &specification.limits,
        solution,
        // Less than before the inversion: the solution stays.
        memory_bytes: memory::available(),
        written_torque_n_m: &digits.as_written(&solution.torque_n_m),
    })
}

/// Ends the program if a check is out of its bound.
pub(crate) fn refuse_failed(verification: &Verification) -> Result<(), Failure> {
    let failed: Vec<&str> = verification.failed().map(|check| check.what.as_str()).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let message = format!("out of bounds: {}", failed.join("; "));
    let hint = verification.failed().next().map(|check| check.hint);
    Err(Failure::new(Exit::NotSolvable, &message, hint))
}
