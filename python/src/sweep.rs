//! `sweep`: many cases in parallel, as the columns of the command's table.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};

use flexlink::csv::PathTable;
use flexlink::inverse::{Resources, invert_with};
use flexlink::motion::{MotionScale, Periods, TipMotion};
use flexlink::result::Metrics;
use flexlink::spec::{ArmSpecification, Described, LinkDocument, Specification};
use flexlink::sweep::{ArmCase, CaseNumbers, SolvedCase, SweepKind, in_order};

use crate::arm::{Arm, GivenPath};
use crate::cli::arm::ArmAndPath;
use crate::cli::solve::run::SolveOptions;
use crate::cli::sweep::tally::{Notice, Tally};
use crate::keywords::{self, solve_options};
use crate::link::{Link, Source, described_by};
use crate::messages::{in_python, notice, usage, warn};
use crate::motion::{Call, Given, Motion};
use crate::pool;
use crate::terminal::{Exit, Failure, memory};

/// Between two looks whether Ctrl-C was pressed.
const LOOK: Duration = Duration::from_millis(50);

/// Factors on the motion among the changes of a case.
const DISTANCE: &str = "distance*";
const DURATION: &str = "duration*";

/// The changes of one case.
struct Case {
    link: Vec<String>,
    scale: MotionScale,
}

impl Case {
    fn read(given: &Bound<'_, PyDict>) -> PyResult<Self> {
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

/// What came of a case: its numbers, and its warnings; or why it has none.
type Row = Result<(CaseNumbers, Vec<Notice>), Failure>;

/// All that the cases share.
struct Shared {
    source: Source,
    document: LinkDocument,
    options: SolveOptions,
    problem: Problem,
    kind: SweepKind,
    /// Memory in bytes that each of the cases solved at the same time may take.
    memory_bytes: Option<usize>,
}

/// What is solved in each case.
enum Problem {
    Link(Box<OfLink>),
    Arm(Box<PathTable>),
}

/// A motion as it was given, that of the link as it is, and its periods, which most cases have.
struct OfLink {
    given: Arc<Given>,
    length_m: f64,
    motion: TipMotion,
    periods: Arc<Periods>,
}

impl Shared {
    fn of_link(
        link: &Link,
        (given, read): (Arc<Given>, Option<&Motion>),
        options: SolveOptions,
    ) -> Result<Self, Failure> {
        let own = &link.specification.link;
        let (motion, periods) = if let Some(read) = read {
            read.refuse_other(own)?;
            (read.tip.clone(), Arc::clone(&read.periods))
        } else {
            let (motion, _) = given.motion(own, &options)?;
            let periods = Arc::new(Periods::of(&motion));
            (motion, periods)
        };
        let kind = if own.drive().is_some() { SweepKind::Driven } else { SweepKind::Solved };
        let problem =
            Problem::Link(Box::new(OfLink { given, length_m: own.length_m(), motion, periods }));
        Self::of(&link.source, options, problem, kind)
    }

    fn of_arm(arm: &Arm, given: &GivenPath, options: SolveOptions) -> Result<Self, Failure> {
        options.refuse_for_arms()?;
        let path = given.table(&options)?;
        let arm_of = &arm.specification.arm;
        path.path(&arm_of.lengths_m())?;
        let joints = arm_of.links().len();
        let is_driven = arm_of.links().iter().any(|own| own.link.drive().is_some());
        let kind =
            if is_driven { SweepKind::DrivenArm { joints } } else { SweepKind::Arm { joints } };
        Self::of(&arm.source, options, Problem::Arm(Box::new(path)), kind)
    }

    fn of(
        source: &Source,
        options: SolveOptions,
        problem: Problem,
        kind: SweepKind,
    ) -> Result<Self, Failure> {
        let document = source.document()?;
        let memory_bytes = memory::available().map(|bytes| bytes / rayon::current_num_threads());
        Ok(Self { source: source.clone(), document, options, problem, kind, memory_bytes })
    }

    fn row(&self, case: &Case) -> Row {
        let overrides = self.source.overrides(&case.link)?;
        match self.document.described(&self.source.file.shown, &overrides)? {
            Described::Link(specification) => self.solve(&specification, case),
            Described::Arm(specification) => self.solve_arm(specification, case),
        }
    }

    fn solve(&self, specification: &Specification, case: &Case) -> Row {
        let Problem::Link(of) = &self.problem else {
            return Err(usage(&"one link, but must be an arm as without the changes", None));
        };
        let OfLink { given, length_m, motion, periods } = &**of;
        let Specification { link, mesh, analysis, limits, .. } = specification;
        // Angles are arcs of the link's length, which may be what is varied, as may its start angle.
        let is_alike = link.length_m().total_cmp(length_m).is_eq() && link.gravity().is_none();
        let motion = if is_alike { motion.clone() } else { given.motion(link, &self.options)?.0 };
        let motion = motion
            .scaled(case.scale)
            .map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
        let resources = Resources {
            memory_bytes: self.memory_bytes,
            periods: Some(periods),
            ..Resources::default()
        };
        let solution = invert_with(link, mesh, &motion, analysis, &resources)?;
        let metrics = Metrics::of(&solution);
        let first_rad_s = solution.natural_frequencies_rad_s(1).first().copied();
        let found = SolvedCase { solution: &solution, metrics: &metrics, first_rad_s };
        let exceeded = limits.exceeded(&metrics);
        let limits = exceeded.iter().map(Notice::of_limit);
        let own = solution.warnings.iter().map(|own| Notice::new(own.kind(), own, own.hint()));
        Ok((self.kind.solved(&found), own.chain(limits).collect()))
    }

    fn solve_arm(&self, specification: Box<ArmSpecification>, case: &Case) -> Row {
        let Problem::Arm(path) = &self.problem else {
            return Err(usage(&"an arm, but must be one link as without the changes", None));
        };
        let path = path
            .slowed(case.scale.duration)
            .map_err(|error| Failure::new(Exit::InputRefused, &error, error.hint()))?;
        let solved =
            ArmAndPath::of((&self.source.file, specification), path)?.solve(self.memory_bytes)?;
        let (solution, metrics) = (&solved.solution, &solved.metrics);
        let limits = solved.exceeded.iter().map(Notice::of_joint);
        let own = solution.warnings.iter().map(|own| Notice::new(own.kind(), own, own.hint()));
        Ok((self.kind.of_arm(&ArmCase { solution, metrics }), own.chain(limits).collect()))
    }
}

/// Solves many cases in parallel, and returns the columns of the table that ``flexlink sweep`` writes, as a dictionary:
/// the values of each key that cases change, then arrays of numbers, not a number where a case has none, and the lists
/// ``warnings``, the kinds of each case, and ``error``, why it has no numbers, or None. Each kind of warning is given to
/// Python's filters once, with the number of cases and the first of them.
///
/// A case is a dictionary of changes as those of :meth:`Link.changed`; ``distance*`` and ``duration*`` scale the motion.
/// Values that are all numbers are an array, not a number where a case does not change the key; others are a list, with
/// None there.
/// The motion is given as to ``solve``. Cases run on ``threads``, by default as many as cores; Ctrl-C ends the sweep after
/// the cases at work.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"ratio": 0.02},
/// ... )
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.004)
/// >>> cases = [{"segments.*.EI*": factor} for factor in (1, 4, 16)]
/// >>> table = flexlink.sweep(link, cases, **motion)
/// >>> bool((table["period_1_s"][:-1] / table["period_1_s"][1:] - 2 < 1e-6).all())  # four times as stiff, half the period
/// True
/// >>> table["segments.*.EI*"], table["error"]
/// (array([ 1.,  4., 16.]), [None, None, None])
#[pyfunction]
#[pyo3(signature = (link, cases, time, *, threads=None, **keywords))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    link: &Bound<'py, PyAny>,
    cases: Vec<Bound<'py, PyDict>>,
    time: &Bound<'py, PyAny>,
    threads: Option<usize>,
    keywords: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyDict>> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let varied = varied(py, &cases)?;
    let cases = cases.iter().map(Case::read).collect::<PyResult<Vec<Case>>>()?;
    if threads == Some(0) {
        return Err(PyValueError::new_err("threads = 0, but must be above 0"));
    }
    let shared = if let Ok(arm) = link.cast::<Arm>() {
        let arm = arm.get();
        let given = GivenPath::take(time, &keywords, arm.specification.arm.links().len())?;
        Shared::of_arm(arm, &given, solve_options(&keywords::arguments(&keywords)?)?)?
    } else {
        let link = described_by::<Link>(link)?.get();
        let Call { given, arguments, motion } = Call::take(time, &keywords)?;
        Shared::of_link(link, (given, motion), solve_options(&arguments)?)?
    };
    let rows = py.detach(|| interruptible(|stop| all_rows(&shared, &cases, threads, stop)))?;
    table(varied, shared.kind, rows)
}

/// The values of each key that cases change, in the order in which the keys come.
fn varied<'py>(py: Python<'py>, cases: &[Bound<'py, PyDict>]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for case in cases {
        for key in case.keys() {
            if table.contains(&key)? {
                continue;
            }
            let values = cases.iter().map(|case| case.get_item(&key));
            let values = values.collect::<PyResult<Vec<Option<Bound<'_, PyAny>>>>>()?;
            let number = |value: &Option<Bound<'_, PyAny>>| match value {
                None => Some(f64::NAN),
                Some(value) if value.is_instance_of::<PyBool>() => None,
                Some(value) => value.extract().ok(),
            };
            match values.iter().map(number).collect() {
                Some(numbers) => table.set_item(key, PyArray1::<f64>::from_vec(py, numbers))?,
                None => table.set_item(key, values)?,
            }
        }
    }
    Ok(table)
}

/// The rows of all cases, or of those that were done when `stop` turned true.
fn all_rows(
    shared: &Shared,
    cases: &[Case],
    threads: Option<usize>,
    stop: &AtomicBool,
) -> Result<Vec<Row>, Failure> {
    let work = || {
        let mut rows = Vec::with_capacity(cases.len());
        in_order(
            0..cases.len(),
            stop,
            |k| shared.row(&cases[k]),
            |_, row| {
                rows.push(row);
                Ok::<(), Failure>(())
            },
        )?;
        Ok(rows)
    };
    match threads {
        Some(threads) => pool::started(threads)?.install(work),
        None => pool::install(work),
    }
}

/// Does work in a thread while this one asks Python whether Ctrl-C was pressed; `stop` is then true, and the work ends.
fn interruptible<T: Send>(
    work: impl FnOnce(&AtomicBool) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let (done, is_done) = channel();
    thread::scope(|scope| {
        scope.spawn(|| done.send(work(&stop)));
        let mut pressed = None;
        loop {
            match is_done.recv_timeout(LOOK) {
                Ok(found) => return pressed.map_or_else(|| Ok(found?), Err),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(error) = Python::attach(check_signals) {
                        stop.store(true, Ordering::Relaxed);
                        pressed = Some(error);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(pyo3::exceptions::PyRuntimeError::new_err(
                        "the sweep has panicked",
                    ));
                }
            }
        }
    })
}

fn check_signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}

/// Adds the columns of numbers, warnings and errors to those of the `varied` values.
fn table(
    varied: Bound<'_, PyDict>,
    kind: SweepKind,
    rows: Vec<Row>,
) -> PyResult<Bound<'_, PyDict>> {
    let (py, table) = (varied.py(), varied);
    let (names, mut tally) = (kind.names(), Tally::default());
    let mut columns = vec![Vec::with_capacity(rows.len()); names.len()];
    let (mut warnings, mut errors) = (Vec::new(), Vec::new());
    for (row, case) in rows.into_iter().zip(1..) {
        let (numbers, notices, error) = match row {
            Ok((numbers, notices)) => (numbers, notices, None),
            Err(failure) => {
                (vec![None; names.len()], Vec::new(), Some(in_python(&failure.message)))
            }
        };
        warnings.push(notices.iter().map(|own| own.kind.clone()).collect::<Vec<_>>());
        tally.add(case, error.as_ref(), notices, &[]);
        for (column, number) in columns.iter_mut().zip(numbers) {
            column.push(number.unwrap_or(f64::NAN));
        }
        errors.push(error);
    }
    for (name, column) in names.into_iter().zip(columns) {
        table.set_item(name, PyArray1::from_vec(py, column))?;
    }
    table.set_item("warnings", warnings)?;
    table.set_item("error", errors)?;
    let told = tally.warnings(|case| format!("cases[{}]", case - 1));
    let told = told.iter().map(|own| notice(&own.kind, &own.words, own.hint));
    warn(py, &told.collect::<Vec<_>>())?;
    Ok(table)
}
