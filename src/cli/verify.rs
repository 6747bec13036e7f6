//! `verify`: the answer of `solve` measured by other means.

use std::path::PathBuf;

use clap::Args;

use flexlink::csv::{Digits, InputFile};
use flexlink::inverse::{Resources, Solution, invert_with};
use flexlink::motion::TipMotion;
use flexlink::spec::{Described, Specification};
use flexlink::store::verification_json;
use flexlink::verify::{Answer, Verification, VerificationError, verify};

use super::arm::{ArmAndPath, SolvedArm};
use crate::options::common::refuse_for_arms;
use crate::options::inputs::{LinkArgs, MOTION, ResampleArgs, ScaleArgs, described, remarks};
use crate::options::reading::{ReadArgs, tell};
use crate::terminal::files::read_once;
use crate::terminal::text::verify_text;
use crate::terminal::{Exit, Failure, PrintArgs, ThreadArgs, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink verify link.toml motion.csv

One of LINK and MOTION may be `-`, standard input. An arm of several links and its path: docs/arms.md.";

/// Measure the torque of `solve` by other means: is the answer right?
///
/// Prints a table. Each line holds an error against its bound: the tip when the torque is played as it is
/// written, with the link's own damping law; the same with viscous damping, less what is predicted for it;
/// the tip that is solved; the torque of hub and motor with the step halved; the quantity that halved
/// elements change most; the quantity that is largest at the window's edge; the transfer of the paper's
/// dense system; the balance of energy. Two more kinds of lines: the deflection of the tip, which must be
/// small, and every limit of the link file. Exit code 4 if a number is out of its bound.
#[derive(Debug, Args)]
#[command(about = "Measure the torque of `solve` by other means", after_help = EXAMPLE)]
#[command(mut_arg("json", |json| json.help("Print the checks as JSON instead of the table")))]
pub(crate) struct Verify {
    #[command(flatten)]
    link: LinkArgs,

    #[arg(value_name = "MOTION", help = MOTION)]
    motion: PathBuf,

    #[command(flatten)]
    resample: ResampleArgs,

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

    #[command(flatten)]
    read: ReadArgs,
}

/// One link and its motion, or an arm and its path.
enum Loaded {
    Link(Box<(Specification, TipMotion)>),
    Arm(Box<ArmAndPath>),
}

impl Verify {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        let (specification, motion) = match self.load()? {
            Loaded::Link(loaded) => *loaded,
            Loaded::Arm(arm) => return self.run_arm(&arm),
        };
        let (solution, verification) = self.compute(&specification, &motion)?;
        console::remarks(remarks(&specification.remarks, &solution));
        warn(&solution);
        self.print.print(|| verification_json(&verification), || verify_text(&verification))?;
        refuse_failed(&verification)?;
        self.warnings.refuse(solution.warnings.len())
    }

    /// Solves and checks an arm.
    fn run_arm(&self, arm: &ArmAndPath) -> Result<(), Failure> {
        let stages = self.print.stages();
        stages.at("solving");
        let SolvedArm { solution, remarks, .. } = arm.solve(memory::available())?;
        let verification = arm.verified(&solution, self.digits, &stages);
        drop(stages);
        console::remarks(&remarks);
        console::warnings(&solution.warnings);
        self.print.print(|| verification_json(&verification), || verify_text(&verification))?;
        refuse_failed(&verification)?;
        self.warnings.refuse(solution.warnings.len())
    }

    fn load(&self) -> Result<Loaded, Failure> {
        read_once(&[&self.link.link, &self.motion])?;
        let file = InputFile::read_toml(&self.link.link)?;
        let specification = match described(&file, &self.link.changes.overrides()?)? {
            Described::Link(specification) => specification,
            Described::Arm(arm) => {
                let options = [self.resample.of_one_link(), self.scale.of_one_link()];
                refuse_for_arms(options.concat())?;
                let path = InputFile::read(&self.motion)?;
                let how = (&self.read, &self.resample, &self.scale);
                let arm = ArmAndPath::read((&file, arm), &path, how)?;
                return Ok(Loaded::Arm(Box::new(arm)));
            }
        };
        let file = InputFile::read(&self.motion)?;
        let link = &specification.link;
        let (motion, reading) = self.resample.motion_of(&file, link, &self.read)?;
        tell(&file.shown, &reading);
        let motion = self.scale.scaled(motion)?;
        Ok(Loaded::Link(Box::new((*specification, motion))))
    }

    fn compute(
        &self,
        specification: &Specification,
        motion: &TipMotion,
    ) -> Result<(Solution, Verification), Failure> {
        let Specification { link, mesh, analysis, .. } = specification;
        let stages = self.print.stages();
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, watch: &stages, ..Resources::default() };
        let solution = invert_with(link, mesh, motion, analysis, &resources)?;
        stages.at("verifying");
        let verification = verified(specification, &solution, self.digits)?;
        Ok((solution, verification))
    }
}

/// Prints the warnings of a solution.
pub(crate) fn warn(solution: &Solution) {
    console::warnings(&solution.warnings);
}

/// Checks a solution whose torque is written with so many digits.
pub(crate) fn verified(
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
