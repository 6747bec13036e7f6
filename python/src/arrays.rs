//! Columns of numbers and other arguments of a call in, arrays out.

use std::num::NonZeroUsize;

use numpy::ndarray::ArrayView1;
use numpy::{PyArrayDescrMethods as _, PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::PyClass;
use pyo3::pyclass::boolean_struct::True;

use flexlink::beam::NodalHistories;
use flexlink::cli::terminal::memory;
use flexlink::link::ParameterError;
use flexlink::numeric::TimeGrid;
use flexlink::text::excerpt;

use crate::prelude::*;
use crate::threads::until_pressed;

/// The numbers of a column: an array of one dimension, or its equivalent for NumPy. Converts whole numbers and other
/// widths; refuses complex numbers, texts and objects.
pub(crate) fn column(name: &str, values: &Any<'_>) -> PyResult<Vec<f64>> {
    doubles(&line(name, values)?)
}

/// The numbers of a column of places, rounded to decimals: floats of few digits have the decimals of the largest
/// number.
pub(crate) fn places(name: &str, values: &Any<'_>) -> PyResult<Vec<f64>> {
    let array = line(name, values)?;
    if !is_short(&array) || array.is_empty() {
        return doubles(&array);
    }
    let numpy = values.py().import("numpy")?;
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
    values: &Any<'_>,
    (rows, count): (usize, usize),
) -> PyResult<Vec<Vec<f64>>> {
    let must = format!("the shape ({rows}, {count})");
    let array = numbers(name, values, (&must, |shape| shape == [rows, count]))?;
    let numbers = doubles(&array.call_method0("ravel")?.cast_into()?)?;
    let column = |k: usize| numbers.iter().skip(k).step_by(count).copied().collect();
    Ok((0..count).map(column).collect())
}

/// An array of real numbers of one dimension.
fn line<'py>(name: &str, values: &Any<'py>) -> Raises<Bound<'py, PyUntypedArray>> {
    numbers(name, values, ("one dimension", |shape| shape.len() == 1))
}

/// An array of real numbers of a shape.
fn numbers<'py>(
    name: &str,
    values: &Any<'py>,
    (must, has_shape): (&str, impl FnOnce(&[usize]) -> bool),
) -> Raises<Bound<'py, PyUntypedArray>> {
    let array = values.py().import("numpy")?.call_method1("asarray", (values,))?;
    let array = array.cast_into::<PyUntypedArray>().map_err(PyErr::from)?;
    let dtype = array.dtype();
    if !matches!(dtype.kind(), b'f' | b'i' | b'u') {
        let message = format!("{name}: dtype = {dtype}, but must be real numbers");
        return Err(PyTypeError::new_err(message).into());
    }
    if !has_shape(array.shape()) {
        let shape = array.getattr("shape")?;
        let message = format!("{name}: shape = {shape}, but must have {must}");
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
    let numbers = texts.as_ref().unwrap_or(array.as_any());
    let array = numbers.call_method1("astype", ("float64",))?.cast_into::<PyArray1<f64>>()?;
    Ok(array.readonly().as_array().to_vec())
}

/// One value for all links or joints, or one for each.
#[derive(FromPyObject)]
pub(crate) enum OneOrEach<T> {
    One(T),
    Each(Vec<T>),
}

impl<T> OneOrEach<T> {
    pub(crate) fn list(self) -> Vec<T> {
        match self {
            Self::One(value) => vec![value],
            Self::Each(values) => values,
        }
    }
}

/// Gains of feedback in a call: a pair for all joints, or one for each.
pub(crate) fn gains(value: &Any<'_>) -> Raises<Vec<(f64, f64)>> {
    let pairs = value.extract::<OneOrEach<[f64; 2]>>().map_err(|_| {
        let must = "must be (stiffness, damping), or a list of one for each joint";
        usage(&format!("feedback = something else, but {must}"), None)
    })?;
    Ok(pairs.list().into_iter().map(Into::into).collect())
}

/// Nodes in a call, by default all.
pub(crate) type Nodes = Option<Numbers>;

/// Numbers of nodes.
pub(crate) struct Numbers(Vec<usize>);

/// The nodes of a call. Refuses arrays that exceed the memory: their columns are computed one by one,
/// and then put into rows.
pub(crate) fn checked(nodes: Nodes, all: usize, samples: usize) -> Raises<Vec<usize>> {
    let nodes = nodes.map_or_else(|| (0..all).collect(), |numbers| numbers.0);
    let bytes = samples.saturating_mul(nodes.len()).saturating_mul(3 * size_of::<f64>());
    memory::check("the motion of the nodes", bytes, None, "fewer nodes, or a larger every")?;
    Ok(nodes)
}

/// Histories of nodes, all by default, of every `every`-th sample of a grid, until Ctrl-C.
pub(crate) fn nodal<'py>(
    py: Python<'py>,
    (grid, all): (&TimeGrid, usize),
    (nodes, every): (Nodes, Every),
    find: impl FnOnce(&[usize]) -> Result<NodalHistories, ParameterError> + Send,
) -> Table<'py> {
    let samples = grid.thinned(every.0).len();
    let nodes = checked(nodes, all, samples)?;
    let histories = until_pressed(py, || Ok(find(&nodes)?))?;
    Ok(rows(py, &histories.samples, samples)?)
}

impl<'py> FromPyObject<'_, 'py> for Numbers {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let must = "must be the numbers of nodes, whole ones from 0 on";
        let whole = |number: PyResult<Any<'_>>| -> PyResult<usize> {
            let number = number?;
            number.extract().map_err(|_| unlike("nodes", &number, must))
        };
        let numbers = value.try_iter().map_err(|_| unlike("nodes", &value, must))?;
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

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let refused = |_| unlike("every", &value, "must be a whole number above 0");
        value.extract().map(Self).map_err(refused)
    }
}

/// Refusal of an unsuitable argument.
pub(crate) fn unlike(name: &str, value: &Any<'_>, must: &str) -> PyErr {
    let shown = value.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
    Raised::from(usage(&format!("{name} = {}, but {must}", excerpt(&shown)), None)).into()
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

/// Times of a grid in s.
pub(crate) fn times(grid: &TimeGrid) -> Vec<f64> {
    (0..grid.len).map(|k| grid.time_s(k)).collect()
}

/// Histories of equal length as an array of a row for each sample and a column for each history.
pub(crate) fn rows<'py>(
    py: Python<'py>,
    histories: &[impl AsRef<[f64]>],
    samples: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    joined(py, histories, samples).reshape([histories.len(), samples])?.transpose()
}

/// Pairs of histories, x and y of nodes or of links, as an array over time, node and axis.
pub(crate) fn pairs<'py>(
    py: Python<'py>,
    axes: &[impl AsRef<[f64]>],
    samples: usize,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let all = joined(py, axes, samples).reshape([axes.len() / 2, 2, samples])?;
    all.permute(Some([2, 0, 1]))
}

/// Histories one after the other, each in one piece, so that a column of an array is a view of it.
fn joined<'py>(
    py: Python<'py>,
    histories: &[impl AsRef<[f64]>],
    samples: usize,
) -> Bound<'py, PyArray1<f64>> {
    let mut numbers = Vec::with_capacity(samples * histories.len());
    for own in histories {
        numbers.extend_from_slice(&own.as_ref()[..samples]);
    }
    PyArray1::from_vec(py, numbers)
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
