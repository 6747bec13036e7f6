//! Names that most files use.

pub(crate) use std::path::{Path, PathBuf};
pub(crate) use std::sync::Arc;

pub(crate) use flexlink::cli::terminal::{Exit, Failure};
pub(crate) use flexlink::result::Notice;
pub(crate) use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
pub(crate) use pyo3::exceptions::PyTypeError;
pub(crate) use pyo3::prelude::*;
pub(crate) use pyo3::types::{IntoPyDict as _, PyBool, PyDict, PyList, PyTuple};

pub(crate) use crate::messages::{Raised, loaded, objects, usage, warn};

/// Further keywords of a call.
pub(crate) type Keywords<'py> = Bound<'py, PyDict>;

/// A result, or the exception in its place.
pub(crate) type Raises<T> = Result<T, Raised>;

/// A result, or the command's failure in its place.
pub(crate) type Fails<T> = Result<T, Failure>;

/// An object of Python.
pub(crate) type Any<'py> = Bound<'py, PyAny>;

/// A dictionary of Python.
pub(crate) type Dictionary<'py> = Raises<Bound<'py, PyDict>>;

/// An array with a row for each sample and a column for each node.
pub(crate) type Table<'py> = Raises<Bound<'py, PyArray2<f64>>>;

/// An array over time, node and axis.
pub(crate) type PairsOverTime<'py> = Raises<Bound<'py, PyArray3<f64>>>;

/// A function of Python and the arguments with which it makes an object again.
pub(crate) type Reduced<'py> = PyResult<(Any<'py>, Bound<'py, PyTuple>)>;
