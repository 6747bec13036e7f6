//! `compare` of files and folders.

use flexlink::cli::compare::{Compare, Compared};
use flexlink::store::comparison_json;

use crate::keywords::{arguments, parsed};
use crate::prelude::*;
use crate::threads::until_pressed;

/// Differences of tables beyond their tolerances.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Comparison(Compared);

/// Compares two files or folders as ``flexlink compare``.
#[pyfunction]
#[pyo3(signature = (expected, actual, **keywords))]
pub(crate) fn compare_files(
    py: Python<'_>,
    expected: PathBuf,
    actual: PathBuf,
    keywords: Option<Keywords<'_>>,
) -> Raises<Comparison> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let paths = [expected, actual].map(|path| path.display().to_string());
    let words = [arguments(&keywords, &[])?, vec!["--".to_owned()], paths.to_vec()].concat();
    let compare: Compare = parsed(&words, &[], &[])?;
    let compared = until_pressed(py, || compare.compared())?;
    warn(py, &compared.warnings)?;
    Ok(Comparison(compared))
}

#[pymethods]
impl Comparison {
    /// True if nothing differs beyond its tolerance.
    #[getter]
    fn is_equal(&self) -> bool {
        self.0.comparison.is_equal()
    }

    /// Every file, as in the command's JSON: its ``outcome``, and its columns with their peak, the allowed difference and the
    /// worst one.
    #[getter]
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        self.summary(py)?.get_item("files")
    }

    /// The JSON of the command: ``equal``, ``files``, ``not_compared``, and with ``bless`` what was ``blessed``.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        let Compared { comparison, changes, .. } = &self.0;
        loaded(py, &comparison_json(comparison, changes.as_ref()))
    }

    /// Warnings, which Python's filters received, too.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Any<'py>>> {
        objects(py, &self.0.warnings)
    }

    fn __repr__(&self) -> String {
        let files = &self.0.comparison.files;
        let different = files.iter().filter(|file| !file.is_equal()).count();
        format!("Comparison(files={}, different={different})", files.len())
    }
}
