//! `fit`: the measured link or arm.

use flexlink::cli::fit::{Problem, check_output};
use flexlink::cli::options::common::option;
use flexlink::cli::terminal::console;
use flexlink::csv::InputFile;
use flexlink::fit::{FitOutcome, Replaced};
use flexlink::store::{NamedBy, NewFile, fit_json, fit_record};

use crate::keywords::take;
use crate::link::Link;
use crate::prelude::*;
use crate::samples::path_of;
use crate::threads::until_pressed;

/// A link or an arm fitted to measurements.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Fit {
    /// Name of the link file in messages.
    shown: String,
    outcome: FitOutcome,
    /// The link file with the fitted values.
    text: String,
    /// The record in JSON.
    record: String,
    warnings: Vec<Notice>,
}

/// Fits free values of a link or an arm to measurements in a file, as ``flexlink fit``. ``free`` lists paths as for
/// changes, ``"hub.inertia"`` or with bounds ``"hub.inertia=0.01:1"``.
#[pyfunction]
#[pyo3(signature = (link, measured, free))]
pub(crate) fn fit(
    py: Python<'_>,
    link: &Link,
    measured: PathBuf,
    free: Vec<String>,
) -> PyResult<Fit> {
    let fit = until_pressed(py, || fitted(link, &measured, &free))?;
    warn(py, &fit.warnings)?;
    Ok(fit)
}

/// Takes the keyword `fit`, the record of a fit: its file, or that of its object. True for a file.
pub(crate) fn take_fit(keywords: &Keywords<'_>) -> Raises<Option<(InputFile, bool)>> {
    let Some(fit) = take(keywords, "fit")? else { return Ok(None) };
    if let Ok(fit) = fit.cast::<Fit>() {
        let (shown, name) = ("fit".to_owned(), "fit".to_owned());
        let bytes = fit.get().record.clone().into_bytes();
        return Ok(Some((InputFile { shown, name, bytes }, false)));
    }
    let Some(path) = path_of(&fit)? else {
        let must = "must be a Fit, or the path of its record";
        return Err(PyTypeError::new_err(format!("fit = {}, but {must}", fit.get_type())).into());
    };
    Ok(Some((InputFile::read(&path).map_err(Failure::from)?, true)))
}

fn fitted(link: &Link, measured: &Path, free: &[String]) -> Fails<Fit> {
    let source = &link.source;
    let (unfitted, changes) = ((source.file.clone(), source.described()?), source.overrides(&[])?);
    let sets = source.changes.iter().flat_map(|change| option("--set", change));
    let arguments = sets.chain(free.iter().flat_map(|path| option("--free", path))).collect();
    let (problem, ..) = Problem::read(unfitted, changes, free, measured, arguments)?;
    let outcome = problem.fit(&|_| {})?;
    let (text, replaced): (String, Vec<Replaced>) = problem.fitted(&outcome)?;
    let record = fit_json(&problem.inputs, &replaced, &outcome);
    let warnings = outcome.warnings();
    Ok(Fit { shown: source.file.shown.clone(), outcome, text, record, warnings })
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
    fn record<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        loaded(py, &self.record)
    }

    /// True if the data fit the link and determine all free values.
    #[getter]
    fn is_believed(&self) -> bool {
        self.outcome.misfit.is_none()
    }

    /// Warnings, which Python's filters received, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Any<'py>>> {
        objects(py, &self.warnings)
    }

    /// The text of the link file with the fitted values, comments and all else kept.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Writes the fitted link file ``NAME.toml``, and its record ``NAME.json`` beside it. Refused if the fit is not
    /// credible.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Raises<()> {
        Ok(py.detach(|| self.write_to(&path))?)
    }

    fn __repr__(&self) -> String {
        let is_believed = if self.is_believed() { "True" } else { "False" };
        format!("Fit(rms_misfit={:.3e}, is_believed={is_believed})", self.outcome.rms_misfit)
    }
}

impl Fit {
    fn write_to(&self, path: &Path) -> Fails<()> {
        if let Some(misfit) = &self.outcome.misfit {
            return Err(usage(&format!("{}: {misfit}", self.shown), None));
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
