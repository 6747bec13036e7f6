//! One run of `solve`: options, load, compute, write.

use std::path::Path;

use clap::{Args, Parser};

use crate::csv::{Digits, InputFile};
use crate::inverse::Analysis;
use crate::page::{Figures, page};
use crate::store::{
    Durability, OutputFolder, RunInputs, RunOutputs, RunTables, StoredResult, Summary,
};
use crate::verify::Verification;

use crate::cli::options::common::{NodeArgs, digits_arguments};
use crate::cli::options::inputs::{ChangeArgs, MotionArgs, specification};
use crate::cli::options::reading::TableName;
use crate::cli::problem::{Problem, Solved};
use crate::cli::terminal::text::memory_text;
use crate::cli::terminal::{Failure, StageBar, console, memory};

/// The arguments that shape the results beside the files; a run records them.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct SolveOptions {
    #[command(flatten)]
    pub changes: ChangeArgs,

    #[command(flatten)]
    pub motion: MotionArgs,

    #[command(flatten)]
    pub nodes: NodeArgs,

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
    pub digits: Digits,

    /// Check the answer by independent methods, as `flexlink verify` does, and keep the table in summary.json; exit
    /// code 4 if a number is out of its bound, but the results are written.
    #[arg(long)]
    pub(super) verify: bool,
}

/// The arguments of a record, read as those of the command line are.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
pub(super) struct Recorded {
    #[command(flatten)]
    options: SolveOptions,
}

impl SolveOptions {
    /// The analysis of a link file, for all tables.
    pub fn analysis(&self, analysis: &Analysis) -> Analysis {
        if self.moments { analysis.with_moments() } else { *analysis }
    }

    /// The first option of the command line that shapes only the tables of the results.
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
    pub fn outputs(&self) -> RunOutputs {
        let Self { deflections, moments, golden, .. } = *self;
        RunOutputs { deflections, moments, golden, ..self.nodes.outputs(self.digits) }
    }

    /// Parses the arguments of a record.
    pub fn recorded(arguments: &[String]) -> Result<Self, clap::Error> {
        Recorded::try_parse_from(arguments).map(|recorded| recorded.options)
    }

    /// The arguments, for the record.
    pub fn arguments(&self) -> Vec<String> {
        let flag = |on: bool, name: &str| on.then(|| name.to_owned());
        [
            self.changes.arguments(),
            self.motion.arguments(),
            self.nodes.arguments(),
            Vec::from_iter(flag(self.deflections, "--deflections")),
            Vec::from_iter(flag(self.moments, "--moments")),
            Vec::from_iter(flag(self.golden, "--golden")),
            digits_arguments(self.digits),
            Vec::from_iter(flag(self.verify, "--verify")),
        ]
        .concat()
    }
}

/// Memory in bytes above which a run states its need.
const LARGE: usize = 1 << 29;

/// A run: its options, its files, and their problem.
pub(super) struct Run<'a> {
    options: &'a SolveOptions,
    link_file: InputFile,
    motion_file: InputFile,
    pub(super) problem: Problem,
}

/// A solution, with its checks if `--verify` asks for them.
pub(super) struct SolvedRun {
    pub(super) solved: Solved,
    pub(super) verification: Option<Verification>,
    /// Memory in bytes that was free before.
    memory_bytes: Option<usize>,
}

/// Whether a run writes a page with its results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Page {
    Written,
    Left,
}

impl<'a> Run<'a> {
    /// Reads the link or the arm from its file, and then the motion.
    pub(super) fn read(
        options: &'a SolveOptions,
        link_file: InputFile,
        motion_file: impl FnOnce() -> Result<InputFile, Failure>,
    ) -> Result<Self, Failure> {
        let changes = options.changes.overrides()?;
        let specification = options.nodes.meshed(specification(&link_file, &changes)?)?;
        let motion_file = motion_file()?;
        options.motion.read.check(&[TableName::Motion])?;
        let problem = Problem::read((&link_file, specification), &motion_file, &options.motion)?;
        Ok(Self { options, link_file, motion_file, problem })
    }

    /// Computes the solution, and verifies it if the options say so.
    pub(super) fn solve(&self, stages: &StageBar) -> Result<SolvedRun, Failure> {
        let memory_bytes = memory::available();
        let analysis = |analysis: &Analysis| self.options.analysis(analysis);
        let solved = self.problem.solve(analysis, memory_bytes, stages)?;
        self.options.nodes.check(&solved.solution.nodes_m())?;
        let verify = || solved.verified(self.problem.plans(), self.options.digits, stages);
        let verification = self.options.verify.then(verify).transpose()?;
        Ok(SolvedRun { solved, verification, memory_bytes })
    }

    /// The record of the run.
    pub(super) fn summary(&self, SolvedRun { solved, verification, .. }: &SolvedRun) -> Summary {
        let Self { link_file, motion_file, .. } = self;
        let inputs = RunInputs::of_solve(link_file, motion_file, self.options.arguments());
        solved.summary(inputs, verification.as_ref(), &self.options.outputs())
    }

    /// Writes the results into a folder.
    pub(super) fn write(
        &self,
        (run, summary): (&SolvedRun, &Summary),
        (folder, durability): (&Path, Durability),
        page: Page,
        stages: &StageBar,
    ) -> Result<(), Failure> {
        let outputs = self.options.outputs();
        let tables = RunTables::of_solution(&run.solved.solution, &outputs)?;
        memory::check_nodes(tables.nodal_bytes(), run.memory_bytes)?;
        if let Some(deflections) = tables.on_request().filter(|table| table.bytes() >= LARGE) {
            stages.say(&memory_text(deflections.bytes(), deflections.blocks()));
        }
        let page_bytes = tables.on_request().map_or(0, |table| outputs.page_bytes(table));
        // Drawn from memory before the lock of the folder: the page belongs to the same run.
        let drawn = (page == Page::Written).then(|| -> Result<String, Failure> {
            stages.at("drawing");
            let hint = "leave --report out, or use --nodes or --every";
            memory::check("the page", page_bytes, run.memory_bytes, hint)?;
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
