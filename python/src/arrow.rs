//! Columns of numbers as a stream of Arrow's C data interface, without a copy.
//!
//! The structures are those of <https://arrow.apache.org/docs/format/CDataInterface.html>, which does not change.
#![expect(unsafe_code, reason = "the interface hands out pointers")]
#![expect(clippy::cast_possible_wrap, reason = "lengths stay far below 2^63")]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use numpy::PyUntypedArrayMethods as _;
use pyo3::types::PyCapsule;

use crate::prelude::*;

/// Names and units of columns, and their numbers.
type Columns<'py> = Vec<(String, String, Bound<'py, PyArray1<f64>>)>;

const NAME: &CStr = c"arrow_array_stream";
const DOUBLES: &CStr = c"g";
const ROWS: &CStr = c"+s";

/// Description of a column or of a table.
#[repr(C)]
struct Schema {
    format: *const c_char,
    name: *const c_char,
    metadata: *const c_char,
    flags: i64,
    n_children: i64,
    children: *mut *mut Schema,
    dictionary: *mut Schema,
    release: Option<unsafe extern "C" fn(*mut Schema)>,
    private_data: *mut c_void,
}

/// Numbers of a column, or the columns of a table.
#[repr(C)]
struct Array {
    length: i64,
    null_count: i64,
    offset: i64,
    n_buffers: i64,
    n_children: i64,
    buffers: *mut *const c_void,
    children: *mut *mut Array,
    dictionary: *mut Array,
    release: Option<unsafe extern "C" fn(*mut Array)>,
    private_data: *mut c_void,
}

/// Tables one after the other, here one.
#[repr(C)]
struct Stream {
    get_schema: unsafe extern "C" fn(*mut Stream, *mut Schema) -> c_int,
    get_next: unsafe extern "C" fn(*mut Stream, *mut Array) -> c_int,
    get_last_error: unsafe extern "C" fn(*mut Stream) -> *const c_char,
    release: Option<unsafe extern "C" fn(*mut Stream)>,
    private_data: *mut c_void,
}

// SAFETY: the stream owns what its pointers lead to, and the references to NumPy's arrays can be dropped in any thread.
unsafe impl Send for Stream {}

/// A column that keeps its NumPy array alive.
struct Column {
    name: CString,
    metadata: Vec<u8>,
    numbers: *const c_void,
    len: usize,
    /// Counted apart from Python's references, because a reader's thread may lack Python's lock.
    owner: Arc<Py<PyAny>>,
}

/// The columns of a stream, and whether it has handed them out.
struct Table {
    columns: Vec<Column>,
    is_done: bool,
}

/// Content of a [`Schema`].
struct SchemaData {
    name: CString,
    metadata: Vec<u8>,
    children: Vec<*mut Schema>,
}

/// Content of an [`Array`].
struct ArrayData {
    buffers: Vec<*const c_void>,
    children: Vec<*mut Array>,
    _owner: Option<Arc<Py<PyAny>>>,
}

/// Columns of equal length as a capsule with a stream of one table. Numbers stay where they are if they lie side by side
/// in memory.
#[pyfunction]
pub(crate) fn arrow_stream<'py>(
    py: Python<'py>,
    columns: Columns<'py>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let numpy = py.import("numpy")?;
    let column = |(name, unit, array): (String, String, Bound<'py, PyArray1<f64>>)| {
        let array = numpy.call_method1("ascontiguousarray", (array,))?;
        let array = array.cast_into::<PyArray1<f64>>()?;
        Ok(Column {
            name: CString::new(name)?,
            metadata: if unit.is_empty() { Vec::new() } else { metadata("unit", &unit) },
            numbers: array.data().cast_const().cast(),
            len: array.len(),
            owner: Arc::new(array.into_any().unbind()),
        })
    };
    let columns = columns.into_iter().map(column).collect::<PyResult<Vec<Column>>>()?;
    let stream = Stream {
        get_schema,
        get_next,
        get_last_error,
        release: Some(release_stream),
        private_data: Box::into_raw(Box::new(Table { columns, is_done: false })).cast(),
    };
    PyCapsule::new_with_value_and_destructor(py, stream, NAME, |mut stream, _| {
        // A reader takes the stream by a copy of it, and then marks it as released.
        if let Some(release) = stream.release {
            // SAFETY: the stream is whole until its release.
            unsafe { release(&raw mut stream) };
        }
    })
}

/// A key and its value in the form of a schema's metadata.
fn metadata(key: &str, value: &str) -> Vec<u8> {
    let size = |len: usize| i32::try_from(len).unwrap_or_default().to_ne_bytes();
    let text = |text: &str| [&size(text.len())[..], text.as_bytes()].concat();
    [&size(1)[..], &text(key), &text(value)].concat()
}

fn schema(format: &'static CStr, (name, metadata): (CString, Vec<u8>), of: Vec<Schema>) -> Schema {
    let children = of.into_iter().map(|own| Box::into_raw(Box::new(own))).collect();
    let mut data = Box::new(SchemaData { name, metadata, children });
    Schema {
        format: format.as_ptr(),
        name: data.name.as_ptr(),
        metadata: match &data.metadata[..] {
            [] => null_mut(),
            some => some.as_ptr().cast(),
        },
        flags: 0,
        n_children: data.children.len() as i64,
        children: data.children.as_mut_ptr(),
        dictionary: null_mut(),
        release: Some(release_schema),
        private_data: Box::into_raw(data).cast(),
    }
}

/// The array of a column with its numbers, or of a table with its columns. Neither has missing values.
fn array(len: usize, numbers: Option<&Column>, of: Vec<Array>) -> Array {
    let children = of.into_iter().map(|own| Box::into_raw(Box::new(own))).collect();
    let valid = std::iter::once(null::<c_void>());
    let buffers = valid.chain(numbers.map(|own| own.numbers)).collect();
    let owner = numbers.map(|own| Arc::clone(&own.owner));
    let mut data = Box::new(ArrayData { buffers, children, _owner: owner });
    Array {
        length: len as i64,
        null_count: 0,
        offset: 0,
        n_buffers: data.buffers.len() as i64,
        n_children: data.children.len() as i64,
        buffers: data.buffers.as_mut_ptr(),
        children: data.children.as_mut_ptr(),
        dictionary: null_mut(),
        release: Some(release_array),
        private_data: Box::into_raw(data).cast(),
    }
}

/// # Safety
/// `stream` is a whole [`Stream`] of [`arrow_stream`], `out` memory for a schema.
unsafe extern "C" fn get_schema(stream: *mut Stream, out: *mut Schema) -> c_int {
    // SAFETY: as the caller promises.
    let Table { columns, .. } = unsafe { &*(*stream).private_data.cast::<Table>() };
    let column =
        |own: &Column| schema(DOUBLES, (own.name.clone(), own.metadata.clone()), Vec::new());
    let table =
        schema(ROWS, (CString::default(), Vec::new()), columns.iter().map(column).collect());
    // SAFETY: as the caller promises.
    unsafe { out.write(table) };
    0
}

/// # Safety
/// `stream` is a whole [`Stream`] of [`arrow_stream`], `out` memory for an array.
unsafe extern "C" fn get_next(stream: *mut Stream, out: *mut Array) -> c_int {
    // SAFETY: as the caller promises.
    let Table { columns, is_done } = unsafe { &mut *(*stream).private_data.cast::<Table>() };
    let rest = if *is_done { &[][..] } else { &columns[..] };
    let len = rest.first().map_or(0, |own| own.len);
    let rows = rest.iter().map(|own| array(own.len, Some(own), Vec::new())).collect();
    let mut table = array(len, None, rows);
    if *is_done {
        // An array without a release is the end.
        // SAFETY: the array is whole, and the function frees its content.
        unsafe { release_array(&raw mut table) };
    }
    *is_done = true;
    // SAFETY: as the caller promises.
    unsafe { out.write(table) };
    0
}

/// # Safety
/// Any pointer.
unsafe extern "C" fn get_last_error(_stream: *mut Stream) -> *const c_char {
    null_mut()
}

/// # Safety
/// `stream` is a whole [`Stream`] of [`arrow_stream`].
unsafe extern "C" fn release_stream(stream: *mut Stream) {
    // SAFETY: as the caller promises; the content was boxed.
    unsafe {
        drop(Box::from_raw((*stream).private_data.cast::<Table>()));
        (*stream).release = None;
    }
}

/// # Safety
/// `own` is a whole schema of [`schema`].
unsafe extern "C" fn release_schema(own: *mut Schema) {
    // SAFETY: as the caller promises; content and children were boxed. A reader that takes a child marks it as released.
    unsafe {
        for child in Box::from_raw((*own).private_data.cast::<SchemaData>()).children {
            let mut child = Box::from_raw(child);
            if let Some(release) = child.release {
                release(&raw mut *child);
            }
        }
        (*own).release = None;
    }
}

/// # Safety
/// `own` is a whole array of [`array`].
unsafe extern "C" fn release_array(own: *mut Array) {
    // SAFETY: as the caller promises; content and children were boxed. A reader that takes a child marks it as released.
    unsafe {
        for child in Box::from_raw((*own).private_data.cast::<ArrayData>()).children {
            let mut child = Box::from_raw(child);
            if let Some(release) = child.release {
                release(&raw mut *child);
            }
        }
        (*own).release = None;
    }
}
