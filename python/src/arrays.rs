//! Columns of numbers in, samples out.

use std::num::NonZeroUsize;

use numpy::ndarray::ArrayView1;
use numpy::{
    PyArray1, PyArray2, PyArrayDescrMethods as _, PyArrayMethods as _, PyUntypedArray,
    PyUntypedArrayMethods as _,
};
use pyo3::PyClass;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::pyclass::boolean_struct::True;
use pyo3::types::PyDict;

use flexlink::cli::terminal::memory;
use flexlink::text::excerpt;

use crate::messages::{Raised, usage};

/// The numbers of a column: an array of one dimension, or its equivalent for NumPy. Converts whole numbers and other
/// widths; refuses complex numbers, texts and objects.
pub(crate) fn column(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = numbers(name, given, ("one dimension", |shape| shape.len() == 1))?;
    doubles(&array)
}

/// The numbers of a column of places, rounded to decimals: floats of few digits have the decimals of the largest
/// number.
pub(crate) fn places(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = numbers(name, given, ("one dimension", |shape| shape.len() == 1))?;
    if !is_short(&array) || array.is_empty() {
        return doubles(&array);
    }
    let numpy = given.py().import("numpy")?;
    let largest = numpy.call_method1("abs", (&array,))?.call_method0("max")?;
    // Distance of one number of this type from the next.
    let step: f64 = numpy.call_method1("spacing", (largest,))?.call_method0("item")?.extract()?;
    let decimals = (-step.log10()).floor();
    if !decimals.is_finite() {
        return doubles(&array);
    }
    #[expect(clippy::cast_possible_truncation, reason = "a whole number below 50")]
    let rounded =
        array.call_method1("astype", ("float64",))?.call_method1("round", (decimals as i32,))?;
    doubles(&rounded.cast_into()?)
}

/// The columns of an array with `rows` rows and `count` columns.
pub(crate) fn columns(
    name: &str,
    given: &Bound<'_, PyAny>,
    (rows, count): (usize, usize),
) -> PyResult<Vec<Vec<f64>>> {
    let must = format!("the shape ({rows}, {count})");
    let array = numbers(name, given, (&must, |shape| shape == [rows, count]))?;
    let numbers = doubles(&array.call_method0("ravel")?.cast_into()?)?;
    let column = |k: usize| numbers.iter().skip(k).step_by(count).copied().collect();
    Ok((0..count).map(column).collect())
}

/// An array of real numbers of a shape.
fn numbers<'py>(
    name: &str,
    given: &Bound<'py, PyAny>,
    (must, has_shape): (&str, impl FnOnce(&[usize]) -> bool),
) -> Result<Bound<'py, PyUntypedArray>, Raised> {
    let array = given.py().import("numpy")?.call_method1("asarray", (given,))?;
    let array = array.cast_into::<PyUntypedArray>().map_err(PyErr::from)?;
    let kind = array.dtype().kind();
    if !matches!(kind, b'f' | b'i' | b'u') {
        let found = array.dtype();
        let must = "must be real numbers";
        let message = format!("{name}: dtype = {found}, but {must}");
        return Err(PyTypeError::new_err(message).into());
    }
    if !has_shape(array.shape()) {
        let found = array.getattr("shape")?;
        let message = format!("{name}: shape = {found}, but must have {must}");
        return Err(usage(&message, None).into());
    }
    Ok(array)
}

/// True for floats of half or single precision.
fn is_short(array: &Bound<'_, PyUntypedArray>) -> bool {
    array.dtype().kind() == b'f' && array.dtype().itemsize() < size_of::<f64>()
}

/// The numbers of an array of one dimension. Each short float has the value of the shortest text that reads back to
/// it: 0.1 is 0.1.
fn doubles(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<f64>> {
    let texts = is_short(array).then(|| array.call_method1("astype", ("str",))).transpose()?;
    let given = texts.as_ref().unwrap_or(array.as_any());
    let array = given.call_method1("astype", ("float64",))?.cast_into::<PyArray1<f64>>()?;
    Ok(array.readonly().as_array().to_vec())
}

/// Numbers of nodes in a call.
pub(crate) struct Nodes(Vec<usize>);

impl Nodes {
    /// The nodes of a call, or all.
    pub(crate) fn or_all(given: Option<Self>, all: usize) -> Vec<usize> {
        given.map_or_else(|| (0..all).collect(), |own| own.0)
    }
}

impl<'py> FromPyObject<'_, 'py> for Nodes {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let must = "must be the numbers of nodes, whole ones from 0 on";
        let whole = |number: PyResult<Bound<'_, PyAny>>| -> PyResult<usize> {
            let number = number?;
            number.extract().map_err(|_| unlike("nodes", &number, must))
        };
        let numbers = given.try_iter().map_err(|_| unlike("nodes", &given, must))?;
        numbers.map(whole).collect::<PyResult<_>>().map(Self)
    }
}

/// Stride of the samples in a call.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Every(pub(crate) NonZeroUsize);

impl Every {
    pub(crate) const ALL: Self = Self(NonZeroUsize::MIN);
}

impl<'py> FromPyObject<'_, 'py> for Every {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let found =
            given.extract().map_err(|_| unlike("every", &given, "must be a whole number above 0"));
        found.map(Self)
    }
}

/// Refusal of an unsuitable argument.
pub(crate) fn unlike(name: &str, found: &Bound<'_, PyAny>, must: &str) -> PyErr {
    let shown = found.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
    Raised::from(usage(&format!("{name} = {}, but {must}", excerpt(&shown)), None)).into()
}

/// Refuses an array that exceeds the memory. Its columns are computed one by one, and then put into rows.
pub(crate) fn check_rows(samples: usize, columns: usize) -> Result<(), Raised> {
    let bytes = samples.saturating_mul(columns).saturating_mul(3 * size_of::<f64>());
    Ok(memory::check("the motion of the nodes", bytes, None, "fewer nodes, or a larger every")?)
}

/// Samples of an object, as an array without a copy. The array keeps the object alive and is read-only.
pub(crate) fn view<'py, T>(
    owner: &Bound<'py, T>,
    of: impl for<'a> FnOnce(&'a T) -> &'a [f64],
) -> Bound<'py, PyArray1<f64>>
where
    T: PyClass<Frozen = True> + Sync,
{
    let samples = ArrayView1::from(of(owner.get()));
    // SAFETY: the samples are part of a frozen object. The array keeps this object alive, so the samples stay where
    // they are as long as the array. Nothing writes to them, as the array becomes read-only before anybody has it.
    #[expect(unsafe_code, reason = "NumPy cannot borrow otherwise")]
    let array = unsafe { PyArray1::borrow_from_array(&samples, owner.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    array
}

/// Histories of equal length as an array of a row for each sample and a column for each history.
pub(crate) fn rows<'py>(
    py: Python<'py>,
    histories: &[impl AsRef<[f64]>],
    samples: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut numbers = Vec::with_capacity(samples * histories.len());
    numbers.extend((0..samples).flat_map(|k| histories.iter().map(move |own| own.as_ref()[k])));
    PyArray1::from_vec(py, numbers).reshape([samples, histories.len()])
}

/// Columns as a dictionary of arrays.
pub(crate) fn dictionary(
    py: Python<'_>,
    columns: impl IntoIterator<Item = (impl AsRef<str>, Vec<f64>)>,
) -> PyResult<Bound<'_, PyDict>> {
    let table = PyDict::new(py);
    for (name, values) in columns {
        table.set_item(name.as_ref(), PyArray1::from_vec(py, values))?;
    }
    Ok(table)
}

/// Attributes of an object as a `pandas.DataFrame` over its time: `torque` of several joints as `torque1`, `torque2`, …, the
/// place of a tip as `tip_x`, `tip_y`.
pub(crate) fn frame<'py>(
    of: &Bound<'py, impl PyClass>,
    names: &[&str],
) -> PyResult<Bound<'py, PyAny>> {
    let (py, of) = (of.py(), of.as_any());
    let index = PyDict::new(py);
    let time = py.import("pandas")?.call_method1("Index", (of.getattr("time")?,))?;
    index.set_item("index", time.call_method1("rename", ("time",))?)?;
    let columns = PyDict::new(py);
    for name in names {
        let array = of.getattr(*name)?;
        let Ok(array) = array.cast::<PyArray2<f64>>() else {
            columns.set_item(name, array)?;
            continue;
        };
        for (k, column) in array.call_method0("transpose")?.try_iter()?.enumerate() {
            let number = (k + 1).to_string();
            let suffix = if *name == "tip" { ["_x", "_y"][k] } else { &number };
            columns.set_item(format!("{name}{suffix}"), column?)?;
        }
    }
    py.import("pandas")?.call_method("DataFrame", (columns,), Some(&index))
}
