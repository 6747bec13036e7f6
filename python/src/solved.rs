//! A solution with its inputs: its record, and the files of `flexlink solve`.

use std::path::Path;

use flexlink::cli::options::inputs::remarks;
use flexlink::cli::problem::{Problem, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::terminal::{Failure, memory};
use flexlink::csv::InputFile;
use flexlink::inverse::{Resources, Solution, Unwatched};
use flexlink::result::{Notice, Remark};
use flexlink::store::{Findings, OutputFolder, RunInputs, RunOutputs, RunTables, Summary};

use crate::keywords::solve_options;
use crate::link::Source;

/// A solution of a link or an arm, with its file and the keywords of the call as options.
pub(crate) struct SolvedRun {
    pub(crate) source: Source,
    pub(crate) keywords: Vec<String>,
    pub(crate) solved: Solved,
    pub(crate) warnings: Vec<Notice>,
    of_file: Vec<Remark>,
}

impl SolvedRun {
    /// Solves a problem.
    pub(crate) fn of(
        problem: Problem,
        resources: &Resources,
        (source, keywords): (Source, Vec<String>),
    ) -> Result<Self, Failure> {
        let solved = problem.solved_within(resources)?;
        let limits = solved.exceeded.iter().map(Notice::from);
        let warnings = solved.solution.warnings.iter().map(Notice::from).chain(limits).collect();
        let of_file = problem.specification.remarks;
        Ok(Self { source, keywords, solved, warnings, of_file })
    }

    pub(crate) fn solution(&self) -> &Solution {
        &self.solved.solution
    }

    /// Remarks on unusual input.
    pub(crate) fn remarks(&self) -> Vec<Remark> {
        remarks(&self.of_file, self.solution(), None)
    }

    /// The options of the call and of writing.
    pub(crate) fn options(&self, more: Vec<String>) -> Result<SolveOptions, Failure> {
        let changes = self.source.changes.iter();
        let changes = changes.flat_map(|change| ["--set".to_owned(), change.clone()]);
        solve_options(&changes.chain(self.keywords.clone()).chain(more).collect::<Vec<_>>())
    }

    /// The summary that the command would record. For inputs without files it has only the arguments.
    fn record(
        &self,
        motion: Option<&InputFile>,
        (options, outputs): (&SolveOptions, &RunOutputs),
    ) -> Summary {
        let inputs = match motion {
            Some(motion) if self.source.is_file => {
                RunInputs::of_solve(&self.source.file, motion, options.arguments())
            }
            _ => RunInputs::of_arguments(options.arguments()),
        };
        let Solved { solution, metrics, .. } = &self.solved;
        let remarks = self.remarks();
        let findings = Findings { remarks: &remarks, ..self.solved.findings(None) };
        Summary::of_solution(inputs, solution, metrics, &findings, outputs)
    }

    /// The content of summary.json.
    pub(crate) fn summary(&self, motion: Option<&InputFile>) -> Result<String, Failure> {
        let options = self.options(Vec::new())?;
        Ok(self.record(motion, (&options, &options.outputs())).to_json())
    }

    pub(crate) fn write_into(
        &self,
        folder: &Path,
        motion: Option<&InputFile>,
        more: Vec<String>,
    ) -> Result<(), Failure> {
        let options = self.options(more)?;
        let (solution, outputs) = (self.solution(), options.outputs());
        options.nodes.check(&solution.nodes_m())?;
        let tables = RunTables::of_solution(solution, &outputs)?;
        memory::check_nodes(tables.nodal_bytes(), memory::available())?;
        let summary = self.record(motion, (&options, &outputs));
        let folder = OutputFolder::stage(folder, &|_| {})?;
        Ok(outputs.write(folder, tables, (&summary, None), &Unwatched)?)
    }
}
