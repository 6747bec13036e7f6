//! `sweep`: many cases in parallel, as the columns of the command's table.

use std::sync::atomic::AtomicBool;

use rayon::ThreadPoolBuilder;

use flexlink::cli::sweep::tally::Tally;
use flexlink::cli::terminal::memory;
use flexlink::sweep::{SweepKind, in_order};

use crate::arrays::unlike;
use crate::link::Link;
use crate::messages::in_python;
use crate::motion::Call;
use crate::prelude::*;
use crate::sweep_work::{Case, Outputs, Row, Shared};
use crate::threads::{interruptible, started};

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
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let number = |threads: Any<'py>| {
        let number = threads.extract().ok().filter(|number| (1..=256).contains(number));
        number.ok_or_else(|| unlike("threads", &threads, "must be a whole number from 1 to 256"))
    };
    let threads: Option<usize> = threads.map(number).transpose()?;
    let varied = varied(py, &cases)?;
    let cases = cases.iter().map(Case::read).collect::<PyResult<Vec<Case>>>()?;
    let mut call = Call::take(time, &keywords, link.links())?;
    let outputs = Outputs::of(std::mem::take(&mut call.arguments), outputs, cases.len())?;
    let mut shared = Shared::of(link, call, outputs)?;
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
