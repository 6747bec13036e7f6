//! The work of one case of a sweep: its link or arm, its solution, and the folder of its results.

use flexlink::cli::options::inputs::{Wanted, are_read_alike, scale_arguments};
use flexlink::cli::problem::{Problem, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::sweep::tally::of_limit;
use flexlink::inverse::Resources;
use flexlink::link::Arm;
use flexlink::motion::{MotionScale, Periods};
use flexlink::spec::{LinkDocument, Specification};
use flexlink::sweep::{CaseNumbers, SolvedCase, SweepKind};

use crate::keywords::{solve_options, take};
use crate::link::{Link, Source};
use crate::motion::Call;
use crate::prelude::*;
use crate::samples::{Samples, meshed};
use crate::solution::Solution;
use crate::toml;

/// Factors on the motion among the changes of a case.
const DISTANCE: &str = "distance*";
const DURATION: &str = "duration*";

/// The changes of one case.
pub(crate) struct Case {
    link: Vec<String>,
    scale: MotionScale,
}

impl Case {
    pub(crate) fn read(case: &Bound<'_, PyDict>) -> PyResult<Self> {
        let changes = case.copy()?;
        let factor = |name: &str| take(&changes, name)?.map_or(Ok(1.0), |factor| factor.extract());
        let scale = MotionScale { distance: factor(DISTANCE)?, duration: factor(DURATION)? };
        Ok(Self { link: toml::changes(Some(&changes))?, scale })
    }
}

/// Result of a case: its numbers and its warnings, or its error.
pub(crate) type Row = Fails<(CaseNumbers, Vec<Notice>)>;

/// The keywords of the call as options, and the folder of the cases' folders.
pub(crate) struct Outputs {
    arguments: Vec<String>,
    options: SolveOptions,
    folder: Option<PathBuf>,
    cases: usize,
}

/// Options of the results' files.
const WRITTEN: [&str; 7] =
    ["--nodes", "--stations", "--every", "--deflections", "--moments", "--digits", "--golden"];

impl Outputs {
    /// Refuses options for results without a folder for them.
    pub(crate) fn of(arguments: Vec<String>, folder: Option<PathBuf>, cases: usize) -> Fails<Self> {
        let options = solve_options(&arguments)?;
        let names = arguments.iter().filter_map(|own| own.split('=').next());
        if folder.is_none()
            && let Some(option) = names.into_iter().find(|name| WRITTEN.contains(name))
        {
            let must = "must come with outputs: the table of a sweep holds no histories";
            let hint = "outputs=FOLDER writes the results of each case into a separate folder";
            return Err(usage(&format!("{option} without outputs, but {must}"), Some(hint)));
        }
        Ok(Self { arguments, options, folder, cases })
    }

    /// Folder of a case, from 0.
    fn folder_of(&self, number: usize) -> Option<PathBuf> {
        let width = self.cases.to_string().len();
        self.folder.as_ref().map(|folder| folder.join(format!("{:0width$}", number + 1)))
    }

    /// The options of a case whose motion is scaled, for the record: both factors in one.
    fn arguments_of(&self, case: &Case) -> Vec<String> {
        let own = self.options.scale.scale();
        let scale = MotionScale {
            distance: own.distance * case.scale.distance,
            duration: own.duration * case.scale.duration,
        };
        let mut kept = Vec::new();
        let mut all = self.arguments.iter();
        while let Some(argument) = all.next() {
            if !argument.starts_with("--scale-d") {
                kept.push(argument.clone());
            } else if !argument.contains('=') {
                all.next();
            }
        }
        kept.into_iter().chain(scale_arguments(scale)).collect()
    }
}

/// Common data of all cases.
pub(crate) struct Shared {
    source: Source,
    document: LinkDocument,
    outputs: Outputs,
    samples: Arc<Samples>,
    /// The wanted motion of the unchanged link or arm.
    wanted: Wanted,
    /// The unchanged link or arm.
    arm: Arm,
    /// The periods of one link's motion, which most cases share.
    periods: Option<Arc<Periods>>,
    pub(crate) kind: SweepKind,
    /// Memory in bytes for each of the cases that run at the same time, set at their start.
    pub(crate) memory_bytes: Option<usize>,
}

impl Shared {
    /// Reads the motion of a call.
    pub(crate) fn of(link: &Link, call: Call<'_>, outputs: Outputs) -> Fails<Self> {
        let (wanted, _) = call.wanted(link, &outputs.options)?;
        let periods = match (call.motion, wanted.motion.tip()) {
            (Some(motion), _) => Some(Arc::clone(&motion.periods)),
            (None, tip) => tip.map(|tip| Arc::new(Periods::of(tip))),
        };
        let links = link.specification.arm.links().iter().map(|own| &own.link);
        Ok(Self {
            source: link.source.clone(),
            document: link.source.document()?,
            outputs,
            samples: call.samples,
            wanted,
            arm: link.specification.arm.clone(),
            periods,
            kind: SweepKind::of_links(&links.collect::<Vec<_>>()),
            memory_bytes: None,
        })
    }

    /// The row of a case, from 0. Failed writing of results ends the sweep.
    pub(crate) fn row(&self, number: usize, case: &Case) -> Fails<Row> {
        match self.outcome(number, case) {
            Err(failure) if matches!(failure.exit, Exit::CannotWrite) => Err(failure),
            row => Ok(row),
        }
    }

    fn outcome(&self, number: usize, case: &Case) -> Row {
        let overrides = self.source.overrides(&case.link)?;
        let specification = self.document.specification(&self.source.file.shown, &overrides)?;
        let wanted = self.wanted_of(&specification, case)?;
        let (folder, options) = (self.outputs.folder_of(number), &self.outputs.options);
        let mut specification = meshed(specification, options)?;
        if folder.is_none() && self.arm.links().len() == 1 {
            specification.analysis = specification.analysis.without_tables();
        }
        let problem = Problem::of(&self.source.file, specification, wanted);
        let (memory_bytes, periods) = (self.memory_bytes, self.periods.as_deref());
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let source = self.source.changed(case.link.clone());
        let inputs = (source, Arc::clone(&self.samples), self.outputs.arguments_of(case));
        let run = Solution::of(problem, &resources, inputs)?;
        let Solved { solution, metrics, exceeded, .. } = &run.solved;
        let numbers = self.kind.solved(&SolvedCase::of(solution, metrics));
        let own = solution.warnings.iter().map(Notice::from);
        let notices = own.chain(exceeded.iter().map(of_limit)).collect();
        if let Some(folder) = folder {
            run.write_into(&folder, Vec::new())?;
        }
        Ok((numbers, notices))
    }

    /// The motion of a case.
    fn wanted_of(&self, specification: &Specification, case: &Case) -> Fails<Wanted> {
        let arm = &specification.arm;
        let (count, links) = (arm.links().len(), self.arm.links().len());
        if count != links {
            let must = format!("must be {links}, as many as without the changes");
            return Err(usage(&format!("links = {count}, but {must}"), None));
        }
        // Angles are arcs of a link's length. A case may vary this length and the start angle.
        let is_alike = are_read_alike(arm, &self.arm);
        let options = &self.outputs.options;
        let read = (!is_alike).then(|| self.samples.wanted(arm, options)).transpose()?;
        let wanted = read.as_ref().map_or(&self.wanted, |(wanted, _)| wanted);
        wanted.of_case(case.scale)
    }
}
