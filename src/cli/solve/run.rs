//! One run of `solve`: computes and writes, prints nothing.

use std::path::Path;

use flexlink::csv::InputFile;
use flexlink::inverse::{Resources, Solution, invert_with};
use flexlink::motion::TipMotion;
use flexlink::report::{Figures, page};
use flexlink::result::{Exceeded, Metrics, Remark};
use flexlink::spec::Specification;
use flexlink::store::{Durability, Findings, OutputFolder, RunInputs, Summary};
use flexlink::verify::Verification;

use super::options::SolveOptions;
use crate::cli::inputs::remarks;
use crate::cli::verify::measured;
use crate::terminal::text::memory_text;
use crate::terminal::{Failure, StageBar, console, memory};

/// From so many bytes of memory on, a run says how much it takes.
const LARGE: usize = 1 << 29;

/// What is solved.
pub(crate) struct Problem {
    link_file: InputFile,
    motion_file: InputFile,
    specification: Specification,
    motion: TipMotion,
}

/// What came of it.
pub(crate) struct Solved {
    pub(crate) solution: Solution,
    pub(crate) metrics: Metrics,
    pub(crate) exceeded: Vec<Exceeded>,
    pub(crate) verification: Option<Verification>,
    pub(crate) remarks: Vec<Remark>,
    pub(crate) summary: Summary,
    /// How many files were written.
    pub(crate) files: usize,
}

/// Where the results go.
pub(crate) struct Destination<'a> {
    pub(crate) folder: &'a Path,
    pub(crate) durability: Durability,
    /// Whether a page is written with them.
    pub(crate) page: WithPage,
    /// Told of how far the work is.
    pub(crate) stages: &'a StageBar,
}

/// Whether a run's page is written with its results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WithPage {
    Yes,
    No,
}

impl Problem {
    /// Reads the link from its file, and then the motion.
    pub(crate) fn read(
        options: &SolveOptions,
        link_file: InputFile,
        motion_file: impl FnOnce() -> Result<InputFile, Failure>,
    ) -> Result<Self, Failure> {
        let specification = options.specification(&link_file)?;
        let motion_file = motion_file()?;
        let motion = options.motion_of(&motion_file, &specification.link)?;
        Ok(Self { link_file, motion_file, specification, motion })
    }

    /// Solves it, and writes the results.
    pub(crate) fn solve(
        &self,
        options: &SolveOptions,
        to: &Destination,
    ) -> Result<Solved, Failure> {
        let Self { link_file, motion_file, specification, motion } = self;
        let Specification { link, mesh, analysis, limits, .. } = specification;
        let analysis = &options.analysis(analysis);
        let memory_bytes = memory::available();
        let resources = Resources { memory_bytes, watch: to.stages, ..Resources::default() };
        let solution = invert_with(link, mesh, motion, analysis, &resources)?;
        options.nodes.check(solution.mesh())?;
        let measure = || measured(specification, &solution, options.digits);
        if options.verify {
            to.stages.at("verifying");
        }
        let verification = options.verify.then(measure).transpose()?;

        let remarks = remarks(&specification.remarks, &solution);
        let outputs = options.outputs();
        let inputs = RunInputs::of_solve(link_file, motion_file, options.arguments());
        let metrics = Metrics::of(&solution);
        let exceeded = limits.exceeded(&metrics);
        let findings = Findings {
            exceeded: &exceeded,
            verification: verification.as_ref(),
            remarks: &remarks,
        };
        let summary = Summary::of_solution(inputs, &solution, &metrics, &findings, &outputs);
        let files = outputs.file_names(link).len();
        let deflections = outputs.deflections(&solution);
        memory::check_nodes(deflections.bytes(), memory_bytes)?;
        if deflections.bytes() >= LARGE {
            to.stages.say(&memory_text(deflections.bytes(), deflections.blocks()));
        }
        // Made of what is in memory, before the folder is locked: with the results it is one run.
        let page = match to.page {
            WithPage::No => None,
            WithPage::Yes => {
                to.stages.at("drawing");
                let bytes = outputs.page_bytes(&deflections);
                let hint = "leave --report out, or use --nodes or --every";
                memory::check("the page", bytes, memory_bytes, hint)?;
                let run = outputs.stored((&solution, &deflections), &summary)?;
                Some(page(&run, &Figures::of(&run)))
            }
        };
        let on_wait = |folder: &Path| to.stages.above(|| console::waiting(folder));
        let folder = OutputFolder::stage(to.folder, &on_wait)?.with(to.durability);
        let told = (&summary, page.as_deref());
        outputs.write(folder, (&solution, deflections), told, to.stages)?;
        Ok(Solved { solution, metrics, exceeded, verification, remarks, summary, files })
    }
}
