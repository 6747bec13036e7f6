//! One run of `solve`: options, load, compute, write.

use std::path::Path;
use std::slice::from_ref;

use clap::{Args, Parser};

use flexlink::beam::MeshPlan;
use flexlink::csv::{Digits, InputFile};
use flexlink::inverse::{Analysis, InversionError, Resources, Solution, invert_with};
use flexlink::link::Link;
use flexlink::motion::TipMotion;
use flexlink::report::{Figures, page};
use flexlink::result::{Exceeded, Metrics, Remark, StoredResult};
use flexlink::spec::{Described, Specification};
use flexlink::store::{
    Durability, Findings, OutputFolder, RunInputs, RunOutputs, RunTables, Summary,
};
use flexlink::text::gigabytes;
use flexlink::verify::{AnySolution, Verification};

use crate::cli::verify::verified;
use crate::options::common::refuse_for_arms;
use crate::options::common::{NodeArgs, digits_arguments};
use crate::options::inputs::{ChangeArgs, ResampleArgs, ScaleArgs, described, remarks};
use crate::options::reading::{ReadArgs, tell};
use crate::terminal::text::memory_text;
use crate::terminal::{Exit, Failure, StageBar, console, memory};

/// Most memory in bytes of an inversion whose times are probably in another unit.
const DOUBTED_BYTES: usize = 3_000_000_000;

/// The arguments that shape the results beside the files; a run records them.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub(crate) struct SolveOptions {
    #[command(flatten)]
    pub(crate) changes: ChangeArgs,

    #[command(flatten)]
    pub(crate) resample: ResampleArgs,

    #[command(flatten)]
    pub(crate) scale: ScaleArgs,

    #[command(flatten)]
    pub(crate) nodes: NodeArgs,

    #[arg(long, help = "Also write nodal_deflections.csv: deflection from the hub's tangent line")]
    deflections: bool,

    #[arg(long, help = "Also write bending_moments.csv")]
    moments: bool,

    /// Write a small folder to compare with later runs (docs/golden.md): torque, hub or joint angles, tip
    /// and three nodes, every fifth row.
    #[arg(long, conflicts_with_all = ["list", "stations_m", "every", "deflections", "moments"])]
    pub(super) golden: bool,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "10")]
    pub(super) digits: Digits,

    /// Measure the answer by other means, as `flexlink verify` does, and keep the table in
    /// summary.json; exit code 4 if a number is out of its bound, the results are written.
    #[arg(long)]
    pub(super) verify: bool,

    #[command(flatten)]
    pub(crate) read: ReadArgs,
}

/// The arguments of a record, read as those of the command line are.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
pub(super) struct Recorded {
    #[command(flatten)]
    options: SolveOptions,
}

impl SolveOptions {
    /// Refuses what is known for one link alone.
    pub(crate) fn refuse_for_arms(&self) -> Result<(), Failure> {
        refuse_for_arms([self.resample.of_one_link(), self.scale.of_one_link()].concat())
    }

    /// What a link file, or that of an arm, describes, with the changes.
    pub(super) fn described(&self, file: &InputFile) -> Result<Described, Failure> {
        self.nodes.meshed(described(file, &self.changes.overrides()?)?)
    }

    /// The motion of a link's tip in a file, scaled. Tells what was guessed of the file.
    pub(crate) fn motion_of(&self, file: &InputFile, link: &Link) -> Result<TipMotion, Failure> {
        let (motion, reading) = self.resample.motion_of(file, link, &self.read)?;
        tell(&file.shown, &reading);
        self.scale.scaled(motion)
    }

    /// The analysis of a link file, for all tables.
    pub(crate) fn analysis(&self, analysis: &Analysis) -> Analysis {
        if self.moments { analysis.with_moments() } else { *analysis }
    }

    /// The first option given that shapes the tables of the results alone.
    pub(super) fn shapes_results(&self) -> Option<&'static str> {
        let given = [
            (self.golden, "--golden"),
            (self.deflections, "--deflections"),
            (self.moments, "--moments"),
            (self.nodes.every.get() != 1, "--every"),
        ];
        let given = given.into_iter().find(|(is_given, _)| *is_given).map(|(_, option)| option);
        given.or(self.nodes.chosen())
    }

    /// The tables to write.
    pub(crate) fn outputs(&self) -> RunOutputs {
        let Self { deflections, moments, golden, .. } = *self;
        RunOutputs { deflections, moments, golden, ..self.nodes.outputs(self.digits) }
    }

    /// Parses the arguments of a record.
    pub(crate) fn recorded(arguments: &[String]) -> Result<Self, clap::Error> {
        Recorded::try_parse_from(arguments).map(|recorded| recorded.options)
    }

    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let flag = |on: bool, name: &str| on.then(|| name.to_owned());
        [
            self.changes.arguments(),
            self.resample.arguments(),
            self.scale.arguments(),
            self.nodes.arguments(),
            Vec::from_iter(flag(self.deflections, "--deflections")),
            Vec::from_iter(flag(self.moments, "--moments")),
            Vec::from_iter(flag(self.golden, "--golden")),
            digits_arguments(self.digits),
            Vec::from_iter(flag(self.verify, "--verify")),
            self.read.arguments(),
        ]
        .concat()
    }
}

/// From so many bytes of memory on, a run says how much it takes.
const LARGE: usize = 1 << 29;

/// The inputs of a run.
pub(super) struct Problem<'a> {
    options: &'a SolveOptions,
    link_file: InputFile,
    motion_file: InputFile,
    specification: Specification,
    motion: TipMotion,
}

/// The solution, and what follows from it.
pub(super) struct Solved {
    pub(super) solution: Solution,
    pub(super) metrics: Metrics,
    pub(super) exceeded: Vec<Exceeded>,
    pub(super) verification: Option<Verification>,
    pub(super) remarks: Vec<Remark>,
    /// Memory in bytes that was free before.
    memory_bytes: Option<usize>,
}

/// Whether a run's page is written with its results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Page {
    Written,
    Left,
}

impl<'a> Problem<'a> {
    /// Reads the motion of a link.
    pub(super) fn read(
        options: &'a SolveOptions,
        link_file: InputFile,
        specification: Specification,
        motion_file: InputFile,
    ) -> Result<Self, Failure> {
        let motion = options.motion_of(&motion_file, &specification.link)?;
        Ok(Self { options, link_file, motion_file, specification, motion })
    }

    /// The motion of the tip.
    pub(super) fn motion(&self) -> &TipMotion {
        &self.motion
    }

    /// The plan of the link's mesh.
    pub(super) fn plans(&self) -> &[MeshPlan] {
        from_ref(&self.specification.mesh)
    }

    /// Computes the solution, and verifies it if the options ask for that.
    pub(super) fn solve(&self, stages: &StageBar) -> Result<Solved, Failure> {
        let Specification { link, mesh, analysis, limits, .. } = &self.specification;
        let memory_bytes = memory::available();
        let analysis = self.options.analysis(analysis);
        // Times in another unit make the work large or impossible: they are told before it.
        let duration = Remark::on_duration(&self.motion);
        stages.above(|| console::remarks(&duration));
        let most = memory_bytes.unwrap_or(usize::MAX);
        let allowed = duration.as_ref().map_or(most, |_| most.min(DOUBTED_BYTES));
        let allowed = (allowed < usize::MAX).then_some(allowed);
        let resources = Resources { memory_bytes: allowed, watch: stages, ..Resources::default() };
        let solution =
            invert_with(link, mesh, &self.motion, &analysis, &resources).map_err(|error| {
                let hint = duration.as_ref().map(|remark| remark.hint().to_owned());
                if let InversionError::TooMuchMemory { bytes, allowed: DOUBTED_BYTES } = error {
                    return Failure::new(Exit::InputRefused, &self.doubted(bytes), hint.as_deref());
                }
                let failure = Failure::from(error);
                Failure { hint: hint.or(failure.hint), ..failure }
            })?;
        self.options.nodes.check(solution.mesh())?;
        let verify = || {
            let plans = (self.plans(), from_ref(limits));
            verified(AnySolution::Link(&solution), plans, self.options.digits, stages)
        };
        let verification = self.options.verify.then(verify).transpose()?;
        let metrics = Metrics::of(&solution);
        let exceeded = metrics.exceeded(&[*limits]);
        let remarks = remarks(&self.specification.remarks, &solution);
        Ok(Solved { solution, metrics, exceeded, verification, remarks, memory_bytes })
    }

    /// A refusal of times that are probably in another unit, where the inversion would need so much memory.
    fn doubted(&self, bytes: usize) -> String {
        let (needed, most) = (gigabytes(bytes), gigabytes(DOUBTED_BYTES));
        let found =
            format!("{}: time = such that {needed} of memory is needed", self.motion_file.shown);
        format!("{found}, but must need at most {most} where its unit is doubtful")
    }

    /// The record of the run.
    pub(super) fn summary(&self, solved: &Solved) -> Summary {
        let Solved { solution, metrics, exceeded, .. } = solved;
        let Self { link_file, motion_file, .. } = self;
        let inputs = RunInputs::of_solve(link_file, motion_file, self.options.arguments());
        let verification = solved.verification.as_ref();
        let limits = from_ref(&self.specification.limits);
        let findings = Findings { limits, exceeded, verification, remarks: &solved.remarks };
        Summary::of_solution(inputs, solution, metrics, &findings, &self.options.outputs())
    }

    /// Writes the results into a folder.
    pub(super) fn write(
        &self,
        (solved, summary): (&Solved, &Summary),
        (folder, durability): (&Path, Durability),
        page: Page,
        stages: &StageBar,
    ) -> Result<(), Failure> {
        let Solved { solution, memory_bytes, .. } = solved;
        let outputs = self.options.outputs();
        let deflections = outputs.deflections(solution)?;
        memory::check_nodes(deflections.bytes(), *memory_bytes)?;
        if deflections.bytes() >= LARGE {
            stages.say(&memory_text(deflections.bytes(), deflections.blocks()));
        }
        let bytes = outputs.page_bytes(&deflections);
        let tables = RunTables::of_solution(solution, deflections);
        // Drawn from memory before the folder is locked: the page belongs to the same run.
        let drawn = (page == Page::Written).then(|| -> Result<String, Failure> {
            stages.at("drawing");
            let hint = "leave --report out, or use --nodes or --every";
            memory::check("the page", bytes, *memory_bytes, hint)?;
            let run = StoredResult::Runs(vec![outputs.stored(&tables, summary)?]);
            Ok(self::page(&run, &Figures::of(&run)))
        });
        let drawn = drawn.transpose()?;
        let on_wait = |folder: &Path| stages.above(|| console::waiting(folder));
        let folder = OutputFolder::stage(folder, &on_wait)?.with(durability);
        outputs.write(folder, tables, (summary, drawn.as_deref()), stages)?;
        Ok(())
    }
}
