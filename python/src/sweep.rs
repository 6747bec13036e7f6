//! `sweep`: many cases in parallel, as the columns of the command's table, and the work of one: its link or arm, its
//! solution, and the folder of its results.

use std::sync::atomic::AtomicBool;

use flexlink::cli::options::common::option;
use flexlink::cli::options::inputs::{Wanted, are_read_alike, scale_arguments};
use flexlink::cli::problem::{Problem, Solved};
use flexlink::cli::solve::run::SolveOptions;
use flexlink::cli::sweep::tally::{Tally, of_limit};
use flexlink::cli::terminal::memory;
use flexlink::inverse::Resources;
use flexlink::link::Arm;
use flexlink::motion::{Motion, MotionScale, Periods};
use flexlink::spec::{LinkDocument, Specification};
use flexlink::store::{OutputFolder, RunInputs, Simulated};
use flexlink::sweep::{CaseNumbers, PlayedCase, SolvedCase, SweepKind, in_order};
use rayon::ThreadPoolBuilder;

use crate::arrays::unlike;
use crate::keywords::{self, solve_options, take};
use crate::link::{Link, Source};
use crate::motion::Call;
use crate::played::{Table, take_table};
use crate::prelude::*;
use crate::samples::{Samples, meshed};
use crate::solution::Solution;
use crate::threads::{interruptible, started};
use crate::wording::in_python;

/// Solves many cases in parallel, and returns the columns of the table that ``flexlink sweep`` writes, as a dictionary. It
/// has the values of each key that cases change, then arrays of numbers, with not a number where a case has none. The list
/// ``warnings`` has the kinds of each case; the list ``error`` has the reason why a case has no numbers, or None. Python's
/// filters receive each kind of warning once, with the number of cases and the first of them.
///
/// A case is a dictionary of changes as those of :meth:`Link.changed`; ``distance*`` and ``duration*`` scale the motion.
/// Values that are all numbers are an array, not a number where a case does not change the key; others are a list, with
/// None there. The motion is passed as to ``solve``. Cases run on ``threads``, by default as many as cores; Ctrl-C ends
/// the sweep after the cases at work.
///
/// With ``torque`` every case plays this table instead, as ``flexlink sweep --torque``: a file, a dictionary of its columns
/// ``time`` and ``torque``, of an arm ``torque1``, ``torque2``, …, or the result of :func:`solve`, :func:`simulate`,
/// :func:`learn` or of ``table``. The columns say how far the tip strays from the motion. ``feedback`` is a pair of gains, or
/// one for each joint, around ``reference``, such a table or result; ``hold`` is ``"cubic"``, ``"linear"`` or ``"zero"``.
/// ``input`` is the quantity to play, ``"torque"``, ``"hub_angle"``, ``"force"``, ``"carriage"`` or ``"voltage"``, and ``column``
/// its column.
///
/// ``outputs`` is a folder for the files of each case, as ``write`` writes them, in subfolders ``1``, ``2``, … with as many
/// digits as the number of cases has. ``moments``, ``stations`` and the keywords of ``write`` choose what is written.
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
/// >>> rig = link.changed({"damping": {"model": "rayleigh", "alpha": 0.1, "beta": 0.002}})
/// >>> solution = flexlink.solve(rig, **motion)
/// >>> played = flexlink.sweep(rig, cases[:2], torque=solution, **motion)
/// >>> (played["tip_error_share"] < 1e-4).tolist()  # the torque is that of the first link
/// [True, False]
#[pyfunction]
#[pyo3(signature = (link, cases, time, *, threads=None, outputs=None, **keywords))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    link: &Link,
    cases: Vec<Bound<'py, PyDict>>,
    time: &Any<'py>,
    threads: Option<Any<'py>>,
    outputs: Option<PathBuf>,
    keywords: Option<Keywords<'py>>,
) -> Dictionary<'py> {
    // Loads NumPy before the work that Ctrl-C may end.
    drop(PyArray1::<f64>::from_vec(py, Vec::new()));
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let number = |threads: Any<'py>| {
        let number = threads.extract().ok().filter(|number| (1..=256).contains(number));
        number.ok_or_else(|| unlike("threads", &threads, "must be a whole number from 1 to 256"))
    };
    let threads: Option<usize> = threads.map(number).transpose()?;
    let varied = varied(py, &cases)?;
    let cases = cases.iter().map(Case::read).collect::<PyResult<Vec<Case>>>()?;
    let played = take_table(&keywords, (&link.specification.arm, link.kind()))?;
    let call = Call::take(time, &keywords, link.links())?;
    let mut shared = Shared::of(link, (call, played), (outputs, cases.len()))?;
    let rows = interruptible(py, |stop| all_rows(&mut shared, &cases, threads, stop))?;
    table(varied, shared.kind, rows)
}

/// The values of each key that cases change, in the order of their first use.
fn varied<'py>(py: Python<'py>, cases: &[Bound<'py, PyDict>]) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    for case in cases {
        for key in case.keys() {
            if table.contains(&key)? {
                continue;
            }
            let values = cases.iter().map(|case| case.get_item(&key));
            let values = values.collect::<PyResult<Vec<Option<Any<'_>>>>>()?;
            let number = |value: &Option<Any<'_>>| match value {
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

/// The rows of all cases, or of the finished ones when `stop` turned true.
fn all_rows(
    shared: &mut Shared,
    cases: &[Case],
    threads: Option<usize>,
    stop: &AtomicBool,
) -> Fails<Vec<Row>> {
    let pool = started(ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)))?;
    let at_once = pool.current_num_threads().min(cases.len()).max(1);
    shared.memory_bytes = memory::available().map(|bytes| bytes / at_once);
    let shared = &*shared;
    pool.install(|| {
        let mut rows = Vec::with_capacity(cases.len());
        let keep = |_, row: Fails<Row>| row.map(|row| rows.push(row));
        in_order(0..cases.len(), stop, |k| shared.row(k, &cases[k]), keep)?;
        Ok(rows)
    })
}

/// Adds the columns of numbers, warnings and errors to the `varied` values.
fn table(table: Bound<'_, PyDict>, kind: SweepKind, rows: Vec<Row>) -> Dictionary<'_> {
    let py = table.py();
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
    warn(py, &tally.warnings(|case| format!("cases[{}]", case - 1)))?;
    Ok(table)
}

/// Factors on the motion among the changes of a case.
const DISTANCE: &str = "distance*";
const DURATION: &str = "duration*";

/// The changes of one case.
struct Case {
    link: Vec<String>,
    scale: MotionScale,
}

impl Case {
    fn read(case: &Bound<'_, PyDict>) -> PyResult<Self> {
        let changes = case.copy()?;
        let factor = |name: &str| take(&changes, name)?.map_or(Ok(1.0), |factor| factor.extract());
        let scale = MotionScale { distance: factor(DISTANCE)?, duration: factor(DURATION)? };
        Ok(Self { link: keywords::changes(Some(&changes))?, scale })
    }
}

/// Result of a case: its numbers and its warnings, or its error.
type Row = Fails<(CaseNumbers, Vec<Notice>)>;

/// Options of the results' files.
const WRITTEN: [&str; 7] =
    ["--nodes", "--stations", "--every", "--deflections", "--moments", "--digits", "--golden"];

/// Those of a solution alone.
const OF_SOLUTION: [&str; 3] = ["--deflections", "--moments", "--golden"];

/// Common data of all cases.
struct Shared {
    source: Source,
    document: LinkDocument,
    /// The keywords of the call as options.
    arguments: Vec<String>,
    options: SolveOptions,
    /// The folder of the cases' folders, and the number of cases.
    outputs: (Option<PathBuf>, usize),
    samples: Arc<Samples>,
    /// The wanted motion of the unchanged link or arm.
    wanted: Wanted,
    /// The unchanged link or arm.
    arm: Arm,
    /// The periods of one link's motion, which most cases share.
    periods: Option<Arc<Periods>>,
    /// The table that every case plays.
    played: Option<Table>,
    kind: SweepKind,
    /// Memory in bytes for each of the cases that run at the same time, set at their start.
    memory_bytes: Option<usize>,
}

impl Shared {
    /// Reads the motion of a call. Refuses options for results without a folder for them.
    fn of(
        link: &Link,
        (call, played): (Call<'_>, Option<Table>),
        outputs: (Option<PathBuf>, usize),
    ) -> Fails<Self> {
        let options = solve_options(&call.arguments)?;
        let mut names = call.arguments.iter().filter_map(|own| own.split('=').next());
        if outputs.0.is_none()
            && let Some(option) = names.find(|name| WRITTEN.contains(name))
        {
            let must = "must come with outputs: the table of a sweep holds no histories";
            let hint = "outputs=FOLDER writes the results of each case into a separate folder";
            return Err(usage(&format!("{option} without outputs, but {must}"), Some(hint)));
        }
        let arm = &link.specification.arm;
        if let Some(name) = names.find(|name| played.is_some() && OF_SOLUTION.contains(name)) {
            return Err(usage(&format!("{name} has no effect on a played torque"), None));
        }
        drop(names);
        let (wanted, _) = call.wanted(link, &options.motion)?;
        let periods = match (call.motion, wanted.motion.tip()) {
            (Some(motion), _) => Some(Arc::clone(&motion.periods)),
            (None, tip) => tip.map(|tip| Arc::new(Periods::of(tip))),
        };
        Ok(Self {
            source: link.source.clone(),
            document: link.source.document()?,
            arguments: call.arguments,
            options,
            outputs,
            samples: call.samples,
            wanted,
            arm: arm.clone(),
            periods,
            kind: played.as_ref().map_or_else(|| SweepKind::of_arm(arm), |own| own.args.kind(arm)),
            played,
            memory_bytes: None,
        })
    }

    /// Folder of a case, from 0.
    fn folder_of(&self, number: usize) -> Option<PathBuf> {
        let (folder, cases) = &self.outputs;
        let width = cases.to_string().len();
        folder.as_ref().map(|folder| folder.join(format!("{:0width$}", number + 1)))
    }

    /// The options of a case whose motion is scaled, for the record: both factors in one.
    fn arguments_of(&self, case: &Case) -> Vec<String> {
        let own = self.options.motion.scale.scale();
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

    /// The row of a case, from 0. Failed writing of results ends the sweep.
    fn row(&self, number: usize, case: &Case) -> Fails<Row> {
        match self.outcome(number, case) {
            Err(failure) if matches!(failure.exit, Exit::CannotWrite) => Err(failure),
            row => Ok(row),
        }
    }

    fn outcome(&self, number: usize, case: &Case) -> Row {
        let overrides = self.source.overrides(&case.link)?;
        let specification = self.document.specification(&self.source.file.shown, &overrides)?;
        let wanted = self.wanted_of(&specification, case)?;
        let folder = self.folder_of(number);
        let mut specification = meshed(specification, &self.options)?;
        if folder.is_none() && self.arm.links().len() == 1 {
            specification.analysis = specification.analysis.without_tables();
        }
        if let Some(table) = &self.played {
            return self.play(table, (&specification, &wanted.motion), (folder, case));
        }
        let problem = Problem::of(&self.source.file, specification, wanted);
        let (memory_bytes, periods) = (self.memory_bytes, self.periods.as_deref());
        let resources = Resources { memory_bytes, periods, ..Resources::default() };
        let source = self.source.changed(case.link.clone());
        let inputs = (source, Arc::clone(&self.samples), self.arguments_of(case));
        let run = Solution::of(problem, &resources, inputs)?;
        let Solved { solution, metrics, exceeded, .. } = &run.solved;
        let numbers = self.kind.solved(&SolvedCase::of(solution, metrics));
        let own = solution.warnings.iter().map(Notice::from);
        let limits = exceeded.iter().map(|own| of_limit(own, &solution.arm));
        let notices = own.chain(limits).collect();
        if let Some(folder) = folder {
            run.write_into(&folder, Vec::new())?;
        }
        Ok((numbers, notices))
    }

    /// Plays the table on a case.
    fn play(
        &self,
        Table { args, driven, arguments }: &Table,
        (specification, motion): (&Specification, &Motion),
        (folder, case): (Option<PathBuf>, &Case),
    ) -> Row {
        let of_case = (&self.source.file, specification, motion);
        args.played(driven, of_case, self.memory_bytes, |run, tip_error| {
            let Simulated { played, metrics, .. } = run.result;
            let numbers = self.kind.played(&PlayedCase { simulation: played, metrics, tip_error });
            if let Some(folder) = folder {
                self.options.nodes.check(&played.nodes_m())?;
                let outputs = self.options.outputs();
                memory::check_nodes(outputs.simulation_bytes(played), self.memory_bytes)?;
                let changes = case.link.iter().flat_map(|change| option("--set", change));
                let arguments = changes.chain(self.arguments_of(case)).chain(arguments.clone());
                let inputs = RunInputs::of_arguments(arguments.collect());
                run.write(inputs, &outputs, || Ok(OutputFolder::stage(&folder, &|_| {})?))?;
            }
            Ok((numbers, run.notices(|limit| of_limit(limit, run.arm))))
        })
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
        let read =
            (!is_alike).then(|| self.samples.wanted(arm, &self.options.motion)).transpose()?;
        let wanted = read.as_ref().map_or(&self.wanted, |(wanted, _)| wanted);
        wanted.of_case(case.scale)
    }
}
