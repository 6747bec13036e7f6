//! `fit`: the measured link or arm.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;

use flexlink::cli::fit::{Problem, Unfitted, check_output};
use flexlink::cli::options::common::option;
use flexlink::cli::terminal::{Failure, console};
use flexlink::fit::{FitOutcome, Replaced};
use flexlink::store::{NamedBy, NewFile, fit_json, fit_record};

use crate::arm::Arm;
use crate::interrupt::until_pressed;
use crate::link::{Link, Source, described_by};
use crate::messages::{Raised, objects, usage, warn};

/// A link or an arm fitted to measurements.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Fit {
    source: Source,
    outcome: FitOutcome,
    /// The link file with the fitted values.
    text: String,
    /// The record in JSON.
    record: String,
}

/// Fits free values of a link or an arm to measurements in a file, as ``flexlink fit``. ``free`` lists paths as for
/// changes, ``"hub.inertia"`` or with bounds ``"hub.inertia=0.01:1"``.
#[pyfunction]
#[pyo3(signature = (link, measured, free))]
pub(crate) fn fit(
    py: Python<'_>,
    link: &Bound<'_, PyAny>,
    measured: PathBuf,
    free: Vec<String>,
) -> PyResult<Fit> {
    let source = match link.cast::<Arm>() {
        Ok(arm) => &arm.get().source,
        Err(_) => &described_by::<Link>(link)?.get().source,
    };
    let fit = until_pressed(py, || fitted(source, &measured, &free))?;
    warn(py, &fit.outcome.warnings())?;
    Ok(fit)
}

fn fitted(source: &Source, measured: &Path, free: &[String]) -> Result<Fit, Failure> {
    let (link, own) = (source.file.clone(), source.described()?);
    let unfitted = Unfitted { link, own, changes: source.overrides(&[])? };
    let sets = source.changes.iter().flat_map(|change| option("--set", change));
    let arguments = sets.chain(free.iter().flat_map(|path| option("--free", path))).collect();
    let (problem, ..) = Problem::read(unfitted, free, measured, arguments)?;
    let outcome = problem.fit(&|_| {})?;
    let (text, replaced): (String, Vec<Replaced>) = problem.fitted(&outcome)?;
    let record = fit_json(&problem.inputs, &replaced, &outcome);
    Ok(Fit { source: source.clone(), outcome, text, record })
}

#[pymethods]
impl Fit {
    /// The fitted values by path: the factor on the file's value.
    #[getter]
    fn factors(&self) -> Vec<(String, f64)> {
        self.outcome.values.iter().map(|value| (value.path.clone(), value.factor)).collect()
    }

    /// Content of the record of ``flexlink fit``: values with their standard errors and intervals, residuals, and the
    /// values that the data do not determine.
    #[getter]
    fn record<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (&self.record,))
    }

    /// True if the data fit the link and determine all free values.
    #[getter]
    fn is_believed(&self) -> bool {
        self.outcome.misfit.is_none()
    }

    /// Warnings, which Python's filters received, too.
    #[getter(warnings)]
    fn warning_objects<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        objects(py, &self.outcome.warnings())
    }

    /// The text of the link file with the fitted values, comments and all else kept.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Writes the fitted link file ``NAME.toml``, and its record ``NAME.json`` beside it. Refused if the fit is not
    /// credible.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Result<(), Raised> {
        Ok(py.detach(|| self.write_to(&path))?)
    }

    fn __repr__(&self) -> String {
        format!("Fit(rms_misfit={:.3e}, is_believed={})", self.outcome.rms_misfit, {
            if self.is_believed() { "True" } else { "False" }
        })
    }
}

impl Fit {
    fn write_to(&self, path: &Path) -> Result<(), Failure> {
        if let Some(misfit) = &self.outcome.misfit {
            return Err(usage(&format!("{}: {misfit}", self.source.file.shown), None));
        }
        check_output(path)?;
        let record = fit_record(path);
        let record = record.as_deref().map(|record| (record, &self.record, NamedBy::Program));
        let files = [(path, &self.text, NamedBy::User)].into_iter().chain(record);
        let files =
            files.map(|(path, text, named_by)| NewFile { path, bytes: text.as_bytes(), named_by });
        console::deliver_all(&files.collect::<Vec<_>>())
    }
}
