//! The work of one case of a sweep: its link or arm, its solution, and the folder of its results.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::options::inputs::{Wanted, scale_arguments};
use flexlink::cli::problem::{Problem as Solvable, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::sweep::tally::of_limit;
use flexlink::cli::terminal::{Exit, Failure};
use flexlink::csv::InputFile;
use flexlink::inverse::Resources;
use flexlink::link::Arm as LibraryArm;
use flexlink::motion::{MotionScale, Periods};
use flexlink::result::Notice;
use flexlink::spec::{LinkDocument, Specification};
use flexlink::sweep::{CaseNumbers, SolvedCase, SweepKind};

use crate::arm::{Arm, GivenPath};
use crate::keywords::{self, solve_options};
use crate::link::{Link, Source};
use crate::messages::usage;
use crate::motion::{Given as GivenTip, Motion};
use crate::solved::SolvedRun;

/// Factors on the motion among the changes of a case.
const DISTANCE: &str = "distance*";
const DURATION: &str = "duration*";

/// The changes of one case.
pub(crate) struct Case {
    link: Vec<String>,
    scale: MotionScale,
}

impl Case {
    pub(crate) fn read(given: &Bound<'_, PyDict>) -> PyResult<Self> {
        let given = given.copy()?;
        let take = |name: &str| -> PyResult<f64> {
            let Some(factor) = given.get_item(name)? else { return Ok(1.0) };
            given.del_item(name)?;
            factor.extract()
        };
        let scale = MotionScale { distance: take(DISTANCE)?, duration: take(DURATION)? };
        Ok(Self { link: keywords::changes(Some(&given))?, scale })
    }
}

/// Result of a case: its numbers and its warnings, or its error.
pub(crate) type Row = Result<(CaseNumbers, Vec<Notice>), Failure>;

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
    pub(crate) fn of(
        arguments: Vec<String>,
        folder: Option<PathBuf>,
        cases: usize,
    ) -> Result<Self, Failure> {
        let options = solve_options(&arguments)?;
        let names = arguments.iter().filter_map(|own| own.split('=').next());
        if folder.is_none()
            && let Some(option) = names.into_iter().find(|name| WRITTEN.contains(name))
        {
            let must = "must be given with outputs: the table of a sweep holds no histories";
            let hint = "outputs=FOLDER writes the results of each case into a folder of its own";
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
        let mut given = self.arguments.iter();
        while let Some(argument) = given.next() {
            if !argument.starts_with("--scale-d") {
                kept.push(argument.clone());
            } else if !argument.contains('=') {
                given.next();
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
    of_all: OfAll,
    pub(crate) kind: SweepKind,
    /// Memory in bytes for each of the cases that run at the same time, set at their start.
    pub(crate) memory_bytes: Option<usize>,
}

/// The motion of all cases.
struct OfAll {
    given: Given,
    /// The arm without changes, and its motion.
    arm: LibraryArm,
    wanted: Wanted,
    /// The periods of a tip's motion, which most cases share.
    periods: Option<Arc<Periods>>,
}

/// The motion of a call.
enum Given {
    Tip(Arc<GivenTip>),
    Path(Box<GivenPath>),
}

impl Given {
    fn wanted(&self, arm: &LibraryArm, options: &SolveOptions) -> Result<Wanted, Failure> {
        match self {
            Self::Tip(given) => Ok(given.motion(arm, options)?.0),
            Self::Path(given) => given.path(arm, options),
        }
    }

    /// Its file, if it has one.
    fn file(&self) -> Option<&InputFile> {
        match self {
            Self::Tip(given) => given.file(),
            Self::Path(given) => given.file(),
        }
    }
}

impl Shared {
    pub(crate) fn of_link(
        link: &Link,
        (given, read): (Arc<GivenTip>, Option<&Motion>),
        outputs: Outputs,
    ) -> Result<Self, Failure> {
        let own = link.specification.link();
        let arm = link.specification.arm.clone();
        let (wanted, periods) = if let Some(read) = read {
            read.refuse_other(own)?;
            (read.wanted(), Some(Arc::clone(&read.periods)))
        } else {
            let (wanted, _) = given.motion(&arm, &outputs.options)?;
            let periods = wanted.motion.tip().map(|tip| Arc::new(Periods::of(tip)));
            (wanted, periods)
        };
        let given = Given::Tip(given);
        Self::of(&link.source, outputs, OfAll { given, arm, wanted, periods })
    }

    pub(crate) fn of_arm(arm: &Arm, given: GivenPath, outputs: Outputs) -> Result<Self, Failure> {
        let wanted = given.path(&arm.specification.arm, &outputs.options)?;
        let (given, own) = (Given::Path(Box::new(given)), arm.specification.arm.clone());
        Self::of(&arm.source, outputs, OfAll { given, arm: own, wanted, periods: None })
    }

    fn of(source: &Source, outputs: Outputs, of_all: OfAll) -> Result<Self, Failure> {
        let document = source.document()?;
        let links: Vec<_> = of_all.arm.links().iter().map(|own| &own.link).collect();
        let kind = SweepKind::of_links(&links);
        Ok(Self { source: source.clone(), document, outputs, of_all, kind, memory_bytes: None })
    }

    /// The row of a case, from 0. Failed writing of results ends the sweep.
    pub(crate) fn row(&self, number: usize, case: &Case) -> Result<Row, Failure> {
        match self.outcome(number, case) {
            Err(failure) if matches!(failure.exit, Exit::CannotWrite) => Err(failure),
            row => Ok(row),
        }
    }

    fn outcome(&self, number: usize, case: &Case) -> Row {
        let overrides = self.source.overrides(&case.link)?;
        let folder = self.outputs.folder_of(number);
        let specification = self.document.specification(&self.source.file.shown, &overrides)?;
        let problem = self.case_problem(specification, case, folder.is_some())?;
        let motion_file = self.of_all.given.file();
        let periods = self.of_all.periods.as_deref();
        let resources =
            Resources { memory_bytes: self.memory_bytes, periods, ..Resources::default() };
        let arguments = self.outputs.arguments_of(case);
        let source = self.source.changed(case.link.clone());
        let run = SolvedRun::of(problem, &resources, (source, arguments))?;
        let Solved { solution, metrics, exceeded, .. } = &run.solved;
        let numbers = self.kind.solved(&SolvedCase::of(solution, metrics));
        let own = solution.warnings.iter().map(Notice::from);
        let notices = own.chain(exceeded.iter().map(of_limit)).collect();
        if let Some(folder) = folder {
            run.write_into(&folder, motion_file, Vec::new())?;
        }
        Ok((numbers, notices))
    }

    /// The problem of a case.
    fn case_problem(
        &self,
        mut specification: Specification,
        case: &Case,
        has_tables: bool,
    ) -> Result<Solvable, Failure> {
        let OfAll { given, arm, wanted, .. } = &self.of_all;
        let [links, must] = [&specification.arm, arm].map(|arm| arm.links().len());
        if links != must {
            let must = format!("must be {must}, as many as without the changes");
            return Err(usage(&format!("links = {links}, but {must}"), None));
        }
        let options = &self.outputs.options;
        // Angles are arcs of the link's length. A case may vary this length and the start angle.
        let is_alike = specification.arm.lengths_m() == arm.lengths_m()
            && specification.link().gravity().is_none();
        let wanted =
            if is_alike { wanted.clone() } else { given.wanted(&specification.arm, options)? };
        let wanted = wanted
            .scaled(case.scale)
            .map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
        let analysis = specification.analysis;
        specification.analysis = if has_tables || links > 1 {
            options.analysis(&analysis)
        } else {
            analysis.without_tables()
        };
        options.nodes.meshes(&specification.arm, &mut specification.meshes)?;
        Ok(Solvable::of(&self.source.file, specification, wanted))
    }
}
