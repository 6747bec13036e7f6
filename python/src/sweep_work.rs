//! The work of one case of a sweep: its link or arm, its solution, and the folder of its results.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;

use flexlink::cli::options::common::refuse_for_arms;
use flexlink::cli::options::inputs::scale_arguments;
use flexlink::cli::problem::{Problem as Solvable, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::sweep::tally::of_limit;
use flexlink::cli::terminal::{Exit, Failure};
use flexlink::csv::{InputFile, PathTable};
use flexlink::inverse::Resources;
use flexlink::motion::{MotionScale, Periods, TipMotion};
use flexlink::result::Notice;
use flexlink::spec::{LinkDocument, Specification};
use flexlink::sweep::{CaseNumbers, SolvedCase, SweepKind};

use crate::arm::{Arm, GivenPath};
use crate::keywords::{self, solve_options};
use crate::link::{Link, Source};
use crate::messages::usage;
use crate::motion::{Given, MOTION, Motion};
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
    problem: Problem,
    pub(crate) kind: SweepKind,
    /// Memory in bytes for each of the cases that run at the same time, set at their start.
    pub(crate) memory_bytes: Option<usize>,
}

/// The problem of each case.
enum Problem {
    Link(Box<OfLink>),
    Arm { given: Box<GivenPath>, path: Box<PathTable>, links: usize },
}

/// A motion as given, the motion of the unchanged link, and the periods that most cases share.
struct OfLink {
    given: Arc<Given>,
    length_m: f64,
    motion: TipMotion,
    periods: Arc<Periods>,
}

impl Shared {
    pub(crate) fn of_link(
        link: &Link,
        (given, read): (Arc<Given>, Option<&Motion>),
        outputs: Outputs,
    ) -> Result<Self, Failure> {
        let own = link.specification.link();
        let (motion, periods) = if let Some(read) = read {
            read.refuse_other(own)?;
            (read.tip.clone(), Arc::clone(&read.periods))
        } else {
            let (motion, _) = given.motion(own, &outputs.options)?;
            let periods = Arc::new(Periods::of(&motion));
            (motion, periods)
        };
        let kind = SweepKind::of_links(&[own]);
        let problem =
            Problem::Link(Box::new(OfLink { given, length_m: own.length_m(), motion, periods }));
        Self::of(&link.source, outputs, problem, kind)
    }

    /// Refuses a distance that cases scale, too: a path goes from place to place.
    pub(crate) fn of_arm(
        arm: &Arm,
        given: GivenPath,
        (outputs, cases): (Outputs, &[Case]),
    ) -> Result<Self, Failure> {
        let SolveOptions { resample, scale, .. } = &outputs.options;
        refuse_for_arms([resample.of_one_link(), scale.of_one_link()].concat())?;
        let is_scaled = |case: &Case| case.scale.distance.total_cmp(&1.0).is_ne();
        if let Some(number) = cases.iter().position(is_scaled) {
            let message =
                format!("cases[{number}]: {DISTANCE} is for one link, and the arm has several");
            let hint = "duration* scales the times of a path, which goes from place to place";
            return Err(usage(&message, Some(hint)));
        }
        let path = given.table(&outputs.options)?;
        let arm_of = &arm.specification.arm;
        path.path(&arm_of.lengths_m())?;
        let joints = arm_of.links().len();
        let kind =
            SweepKind::of_links(&arm_of.links().iter().map(|own| &own.link).collect::<Vec<_>>());
        let problem = Problem::Arm { given: Box::new(given), path: Box::new(path), links: joints };
        Self::of(&arm.source, outputs, problem, kind)
    }

    fn of(
        source: &Source,
        outputs: Outputs,
        problem: Problem,
        kind: SweepKind,
    ) -> Result<Self, Failure> {
        let document = source.document()?;
        Ok(Self { source: source.clone(), document, outputs, problem, kind, memory_bytes: None })
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
        let (problem, motion_file) = if specification.arm.links().len() == 1 {
            self.link_problem(specification, case, folder.is_some())?
        } else {
            self.arm_problem(specification, case)?
        };
        let periods = match &self.problem {
            Problem::Link(of) => Some(&*of.periods),
            Problem::Arm { .. } => None,
        };
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

    /// The problem of a case, and the file of its motion, if it has one.
    fn link_problem(
        &self,
        mut specification: Specification,
        case: &Case,
        has_tables: bool,
    ) -> Result<(Solvable, Option<&InputFile>), Failure> {
        let Problem::Link(of) = &self.problem else {
            return Err(usage(&"one link, but must be an arm as without the changes", None));
        };
        let OfLink { given, length_m, motion, .. } = &**of;
        let options = &self.outputs.options;
        let (link, analysis) = (specification.link(), &specification.analysis);
        // Angles are arcs of the link's length. A case may vary this length and the start angle.
        let is_alike = link.length_m().total_cmp(length_m).is_eq() && link.gravity().is_none();
        let motion = if is_alike { motion.clone() } else { given.motion(link, options)?.0 };
        let motion = motion
            .scaled(case.scale)
            .map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
        specification.analysis =
            if has_tables { options.analysis(analysis) } else { analysis.without_tables() };
        options.nodes.meshes(&specification.arm, &mut specification.meshes)?;
        Ok((Solvable::of_link(MOTION, specification, motion), given.file()))
    }

    /// The problem of a case of an arm, and the file of its path, if it has one.
    fn arm_problem(
        &self,
        mut specification: Specification,
        case: &Case,
    ) -> Result<(Solvable, Option<&InputFile>), Failure> {
        let Problem::Arm { given, path, links } = &self.problem else {
            return Err(usage(&"an arm, but must be one link as without the changes", None));
        };
        let found = specification.arm.links().len();
        if found != *links {
            let must = format!("must be {links}, as many as without the changes");
            return Err(usage(&format!("links = {found}, but {must}"), None));
        }
        let path = path
            .slowed(case.scale.duration)
            .map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
        let nodes = &self.outputs.options.nodes;
        nodes.meshes(&specification.arm, &mut specification.meshes)?;
        Ok((Solvable::of_arm(&self.source.file, specification, path)?, given.file()))
    }
}
