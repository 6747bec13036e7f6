//! A link, and its file or keywords.

use std::path::{Path, PathBuf};

use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use flexlink::cli::options::inputs::specification;
use flexlink::cli::terminal::{Exit, Failure};
use flexlink::csv::InputFile;
use flexlink::spec::{LinkDocument, Override, Specification};

use crate::keywords;
use crate::messages::{Raised, usage};

/// Name of keywords in errors.
const KEYWORDS: &str = "keywords";

/// The text that describes a link or an arm, and its changes.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub(crate) file: InputFile,
    /// True for a file, false for keywords, because a run keeps no record of keywords.
    pub(crate) is_file: bool,
    /// As `--set` reads them.
    pub(crate) changes: Vec<String>,
}

/// A text that describes a link or an arm in a pickle.
pub(crate) type PickledSource = (String, String, Vec<u8>, bool, Vec<String>);

impl Source {
    pub(crate) fn read(path: &Path, changes: Vec<String>) -> Result<Self, Failure> {
        Ok(Self { file: InputFile::read_toml(path)?, is_file: true, changes })
    }

    pub(crate) fn of_keywords(keys: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (shown, name) = (KEYWORDS.to_owned(), KEYWORDS.to_owned());
        let bytes = keywords::document(keys)?.into_bytes();
        let file = InputFile { shown, name, bytes };
        Ok(Self { file, is_file: false, changes: Vec::new() })
    }

    /// The source with further changes.
    pub(crate) fn changed(&self, more: Vec<String>) -> Self {
        let changes = self.changes.iter().cloned().chain(more).collect();
        Self { changes, ..self.clone() }
    }

    /// The changes, followed by those of a case.
    pub(crate) fn overrides(&self, more: &[String]) -> Result<Vec<Override>, Failure> {
        let read = |change: &String| {
            change.parse().map_err(|error: flexlink::spec::SpecError| usage(&error, error.hint()))
        };
        self.changes.iter().chain(more).map(read).collect()
    }

    pub(crate) fn document(&self) -> Result<LinkDocument, Failure> {
        Ok(LinkDocument::read(&self.file.shown, self.file.text()?)?)
    }

    pub(crate) fn described(&self) -> Result<Specification, Failure> {
        let found = specification(&self.file, &self.overrides(&[])?);
        found.map_err(|failure| if self.is_file { failure } else { without_line(failure) })
    }

    /// The arguments for `unpickled`.
    pub(crate) fn pickled(&self) -> PickledSource {
        let InputFile { shown, name, bytes } = self.file.clone();
        (shown, name, bytes, self.is_file, self.changes.clone())
    }

    pub(crate) fn unpickled((shown, name, bytes, is_file, changes): PickledSource) -> Self {
        Self { file: InputFile { shown, name, bytes }, is_file, changes }
    }
}

/// A message on keywords without the number of their line.
fn without_line(failure: Failure) -> Failure {
    let message = failure.message.strip_prefix(KEYWORDS).and_then(|rest| {
        let (line, message) = rest.strip_prefix(':')?.split_once(": ")?;
        line.parse::<u64>().ok().map(|_| message.to_owned())
    });
    Failure { message: message.unwrap_or(failure.message), ..failure }
}

/// A flexible link with its hub, payload and damping, as a link file describes it (`flexlink help files`).
///
/// From a file by :meth:`Link.read`, or from keywords that are the keys of such a file. Numbers are SI, texts have units.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     title="strip",
/// ...     segments=[{"length": "1.5 m", "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1},
/// ...     damping={"ratio": 0.02},
/// ... )
/// >>> link
/// Link('strip', length=1.5)
/// >>> stiff = link.changed({"segments.*.EI*": 4, "payload.mass": "50 g"})
/// >>> round(stiff.rigid_inertia - link.rigid_inertia, 9)  # 0.05 kg at 1.5 m
/// 0.1125
#[pyclass(frozen, module = "flexlink")]
pub(crate) struct Link {
    pub(crate) source: Source,
    pub(crate) specification: Specification,
}

impl Link {
    pub(crate) fn of(source: Source) -> Result<Self, Failure> {
        let specification = source.described()?;
        if specification.arm.links().len() == 1 {
            return Ok(Self { source, specification });
        }
        let message =
            format!("{}: an arm of several links, but must be one link", source.file.shown);
        let hint = Some("flexlink.Arm.read reads arms");
        Err(Failure::new(Exit::InputRefused, &message, hint))
    }
}

#[pymethods]
impl Link {
    #[new]
    #[pyo3(signature = (**keys))]
    fn new(py: Python<'_>, keys: Option<Bound<'_, PyDict>>) -> Result<Self, Raised> {
        let keys = keys.unwrap_or_else(|| PyDict::new(py));
        Ok(Self::of(Source::of_keywords(&keys)?)?)
    }

    /// Reads a link file, with changes as those of ``--set``: ``{"payload.mass": 0.2, "segments.*.EI*": 4}``; a key that
    /// ends in ``*`` multiplies the value of the file.
    #[staticmethod]
    #[pyo3(signature = (path, changes=None))]
    fn read(path: PathBuf, changes: Option<&Bound<'_, PyDict>>) -> Result<Self, Raised> {
        Ok(Self::of(Source::read(&path, keywords::changes(changes)?)?)?)
    }

    /// The same link with further changes.
    fn changed(&self, changes: &Bound<'_, PyDict>) -> Result<Self, Raised> {
        Ok(Self::of(self.source.changed(keywords::changes(Some(changes))?))?)
    }

    #[getter]
    fn title(&self) -> &str {
        self.specification.link().title()
    }

    /// Distance of the tip from the axis in m.
    #[getter]
    fn length(&self) -> f64 {
        self.specification.link().length_m()
    }

    /// Inertia about the axis in kg m² of the rigid link.
    #[getter]
    fn rigid_inertia(&self) -> f64 {
        self.specification.link().rigid_inertia_kg_m2()
    }

    fn __repr__(&self) -> String {
        format!("Link({}, length={:?})", python_text(self.title()), self.length())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let unpickle = slf.get_type().getattr("_unpickled")?;
        Ok((unpickle, slf.get().source.pickled().into_pyobject(slf.py())?))
    }

    #[staticmethod]
    #[pyo3(signature = (*source))]
    fn _unpickled(source: &Bound<'_, PyTuple>) -> Result<Self, Raised> {
        Ok(Self::of(Source::unpickled(source.extract()?))?)
    }
}

/// An object of a class, or an error with its actual kind.
pub(crate) fn described_by<'a, 'py, T: PyTypeInfo>(
    given: &'a Bound<'py, PyAny>,
) -> PyResult<&'a Bound<'py, T>> {
    Ok(given.cast::<T>()?)
}

/// A text in quotes in Python's form.
pub(crate) fn python_text(text: &str) -> String {
    format!("'{}'", text.replace('\\', "\\\\").replace('\'', "\\'"))
}
