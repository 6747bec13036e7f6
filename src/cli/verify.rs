//! `verify`: the answer of `solve` measured by other means.

use std::path::PathBuf;
use std::slice::from_ref;

use clap::Args;

use flexlink::beam::MeshPlan;
use flexlink::csv::{Digits, InputFile};
use flexlink::inverse::{Resources, Solution, invert_with};
use flexlink::result::Limits;
use flexlink::spec::{ArmSpecification, Described, Specification};
use flexlink::store::verification_json;
use flexlink::verify::{Answer, AnySolution, Verification, VerificationError, verify};

use super::arm::{ArmAndPath, SolvedArm};
use crate::options::common::refuse_for_arms;
use crate::options::inputs::{LinkArgs, MOTION, ResampleArgs, ScaleArgs, described, remarks};
use crate::options::reading::{ReadArgs, tell};
use crate::terminal::files::read_once;
use crate::terminal::text::verify_text;
use crate::terminal::{
    Exit, Failure, PrintArgs, StageBar, ThreadArgs, WarningArgs, console, memory,
};

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

impl Verify {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.threads.start()?;
        read_once(&[&self.link.link, &self.motion])?;
        let file = InputFile::read_toml(&self.link.link)?;
        let (verification, warnings) = match described(&file, &self.link.changes.overrides()?)? {
            Described::Link(specification) => self.of_link(&specification)?,
            Described::Arm(arm) => self.of_arm(&file, arm)?,
        };
        self.print.print(|| verification_json(&verification), || verify_text(&verification))?;
        refuse_failed(&verification)?;
        self.warnings.refuse(warnings)
    }

    /// The checks of a link, and the number of its warnings.
    fn of_link(&self, specification: &Specification) -> Result<(Verification, usize), Failure> {
        let Specification { link, mesh, analysis, limits, .. } = specification;
        let file = InputFile::read(&self.motion)?;
        let (motion, reading) = self.resample.motion_of(&file, link, &self.read)?;
        tell(&file.shown, &reading);
        let motion = self.scale.scaled(motion)?;
        let stages = self.print.stages();
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, watch: &stages, ..Resources::default() };
        let solution = invert_with(link, mesh, &motion, analysis, &resources)?;
        let plans = (from_ref(mesh), from_ref(limits));
        let verification = verified(AnySolution::Link(&solution), plans, self.digits, &stages)?;
        drop(stages);
        console::remarks(remarks(&specification.remarks, &solution));
        warn(&solution);
        Ok((verification, solution.warnings.len()))
    }

    /// The checks of an arm, and the number of its warnings.
    fn of_arm(
        &self,
        file: &InputFile,
        arm: Box<ArmSpecification>,
    ) -> Result<(Verification, usize), Failure> {
        refuse_for_arms([self.resample.of_one_link(), self.scale.of_one_link()].concat())?;
        let path = InputFile::read(&self.motion)?;
        let how = (&self.read, &self.resample, &self.scale);
        let arm = ArmAndPath::read((file, arm), &path, how)?;
        let stages = self.print.stages();
        stages.at("solving");
        let SolvedArm { solution, limits, remarks, .. } = arm.solve(memory::available())?;
        let plans = (arm.plans(), &limits[..]);
        let verification = verified(AnySolution::Arm(&solution), plans, self.digits, &stages)?;
        drop(stages);
        console::remarks(&remarks);
        console::warnings(&solution.warnings);
        Ok((verification, solution.warnings.len()))
    }
}

/// Prints the warnings of a solution.
pub(crate) fn warn(solution: &Solution) {
    console::warnings(&solution.warnings);
}

/// Checks a solution whose torques are written with this many digits.
pub(crate) fn verified(
    solution: AnySolution<'_>,
    (plans, limits): (&[MeshPlan], &[Limits]),
    digits: Digits,
    stages: &StageBar,
) -> Result<Verification, VerificationError> {
    stages.at("verifying");
    let torques = solution.torques();
    let written = torques.whole_n_m().iter().map(|torque_n_m| digits.as_written(torque_n_m));
    // Less memory is free than before the inversion: the solution stays.
    let memory_bytes = memory::available();
    let written_torques_n_m = &written.collect::<Vec<_>>();
    verify(&Answer { solution, plans, limits, memory_bytes, written_torques_n_m })
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
