//! The page and the figures of a result.

use flexlink::cli::terminal::console;
use flexlink::page::{Figures, page};
use flexlink::store::read_results;
use pyo3::types::PyBytes;

use crate::prelude::*;
use crate::threads::until_pressed;

/// A result as a page with figures: one HTML file that needs nothing else.
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Page {
    html: String,
    figures: Figures,
}

/// The page of results in files and folders, as ``flexlink report``.
#[pyfunction]
pub(crate) fn page_of_files(py: Python<'_>, results: Vec<PathBuf>) -> Raises<Page> {
    until_pressed(py, || {
        let Some((first, beside)) = results.split_first() else {
            return Err(usage(&"no result", None));
        };
        let result = read_results(first, beside)?;
        let figures = Figures::of(&result);
        Ok(Page { html: page(&result, &figures), figures })
    })
}

#[pymethods]
impl Page {
    /// The page.
    #[getter]
    fn html(&self) -> &str {
        &self.html
    }

    /// The figures as SVG, by name.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = self.figures.drawn.iter();
        files.map(|own| (own.id.to_string(), self.figures.svg_file(own))).into_py_dict(py)
    }

    /// A figure as PNG, by name.
    fn png<'py>(&self, py: Python<'py>, figure: &str) -> Raises<Bound<'py, PyBytes>> {
        let Some(own) = self.figures.drawn.iter().find(|own| own.id == figure) else {
            let names: Vec<&str> = self.figures.drawn.iter().map(|own| &*own.id).collect();
            let must = format!("must be one of {}", names.join(", "));
            return Err(usage(&format!("figure = {figure:?}, but {must}"), None).into());
        };
        let refused =
            |why| Failure::new(Exit::CannotWrite, &format!("{figure}: not drawn: {why}"), None);
        let png = py.detach(|| self.figures.png_file(own).map_err(refused))?;
        Ok(PyBytes::new(py, &png))
    }

    /// Writes the page.
    fn write(&self, py: Python<'_>, path: PathBuf) -> Raises<()> {
        Ok(py.detach(|| console::deliver(Some(&path), self.html.as_bytes()))?)
    }

    fn __repr__(&self) -> String {
        format!("Page(figures={})", self.figures.drawn.len())
    }
}
