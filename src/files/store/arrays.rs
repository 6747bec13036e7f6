//! Named arrays as bytes for other programs: NumPy's `.npz` and MATLAB's `.mat` of level 5.

use std::io::{self, Write};

/// An array or a text with the name that a reader finds it by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedArray<'a> {
    /// Its name. In MATLAB it must be an identifier of at most 63 letters, digits and `_`.
    pub name: &'a str,
    /// Its content.
    pub values: Values<'a>,
}

/// Content of a [`NamedArray`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Values<'a> {
    /// One number: without dimensions in NumPy, 1×1 in MATLAB.
    Number(f64),
    /// A vector: of one dimension in NumPy, a column in MATLAB.
    Vector(&'a [f64]),
    /// A matrix, column after column.
    Matrix {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
        /// All `rows × columns` numbers: the first column, then the second one.
        by_column: &'a [f64],
    },
    /// One text.
    Text(&'a str),
    /// Texts: a vector of strings in NumPy, a column of cells in MATLAB.
    Texts(&'a [&'a str]),
}

impl Values<'_> {
    /// Dimensions in NumPy.
    fn shape(&self) -> Vec<usize> {
        match *self {
            Self::Number(_) | Self::Text(_) => Vec::new(),
            Self::Vector(values) => vec![values.len()],
            Self::Texts(texts) => vec![texts.len()],
            Self::Matrix { rows, columns, .. } => vec![rows, columns],
        }
    }

    /// The numbers column after column; empty for texts.
    fn numbers(&self) -> &[f64] {
        match self {
            Self::Number(value) => std::slice::from_ref(value),
            Self::Vector(values) | Self::Matrix { by_column: values, .. } => values,
            Self::Text(_) | Self::Texts(_) => &[],
        }
    }

    /// The texts; empty for numbers.
    fn texts(&self) -> &[&str] {
        match self {
            Self::Text(text) => std::slice::from_ref(text),
            Self::Texts(texts) => texts,
            _ => &[],
        }
    }

    fn is_text(&self) -> bool {
        matches!(self, Self::Text(_) | Self::Texts(_))
    }

    /// Refuses a matrix with another number of values than its dimensions have.
    fn check(&self) -> io::Result<()> {
        match *self {
            Self::Matrix { rows, columns, by_column } if rows * columns != by_column.len() => {
                let found = by_column.len();
                let message = format!(
                    "a matrix of {rows} × {columns} has {found} values, but must have {}",
                    rows * columns
                );
                Err(io::Error::new(io::ErrorKind::InvalidInput, message))
            }
            _ => Ok(()),
        }
    }
}

/// Largest size in bytes of an array or a file that both formats can state.
const LARGEST: usize = i32::MAX as usize;

/// A size in bytes, as the formats have it.
fn size(bytes: usize) -> io::Result<u32> {
    u32::try_from(bytes).ok().filter(|_| bytes <= LARGEST).ok_or_else(|| {
        let message = format!("{bytes} bytes are too many for the format, which has at most 2 GiB");
        io::Error::new(io::ErrorKind::InvalidInput, message)
    })
}

/// Writes arrays as NumPy's `.npz`: a zip archive without compression, one `.npy` file an array. `numpy.load` reads it.
///
/// ```
/// use flexlink::store::{NamedArray, Values, npz};
/// let by_column = &[1.0, 3.0, 2.0, 4.0];
/// let a = NamedArray { name: "A", values: Values::Matrix { rows: 2, columns: 2, by_column } };
/// let mut file = Vec::new();
/// npz(&[a], &mut file)?;
/// assert!(file.starts_with(b"PK"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Errors of `out`; a matrix with another number of values than its dimensions have; more than 2 GiB.
pub fn npz(arrays: &[NamedArray<'_>], out: &mut (impl Write + ?Sized)) -> io::Result<()> {
    // Version 2.0, names in UTF-8, no compression, 1 January 1980.
    let fixed: [u16; 5] = [20, 1 << 11, 0, 0, 0x21];
    let (mut directory, mut offset) = (Vec::new(), 0);
    for NamedArray { name, values } in arrays {
        values.check()?;
        let (name, content) = (format!("{name}.npy"), npy(values));
        let length = size(content.len())?;
        let name_length = u16::try_from(name.len()).map_err(io::Error::other)?;
        let mut common: Vec<u8> = fixed.iter().flat_map(|field| field.to_le_bytes()).collect();
        for field in [crc32fast::hash(&content), length, length] {
            common.extend(field.to_le_bytes());
        }
        common.extend(name_length.to_le_bytes());
        common.extend(0_u16.to_le_bytes()); // no extra fields
        out.write_all(&[b"PK\x03\x04", &common[..], name.as_bytes()].concat())?;
        out.write_all(&content)?;
        // Made by version 2.0; no comment, first disk, no attributes.
        directory.extend([b"PK\x01\x02\x14\x00", &common[..], &[0; 10]].concat());
        directory.extend(size(offset)?.to_le_bytes());
        directory.extend(name.as_bytes());
        offset += 4 + common.len() + name.len() + content.len();
    }
    let count = u16::try_from(arrays.len()).map_err(io::Error::other)?.to_le_bytes();
    let ends = [size(directory.len())?, size(offset)?].map(u32::to_le_bytes).concat();
    out.write_all(&directory)?;
    out.write_all(&[b"PK\x05\x06\0\0\0\0", &count[..], &count, &ends, &[0; 2]].concat())
}

/// An array as NumPy's `.npy` of version 1.
fn npy(values: &Values<'_>) -> Vec<u8> {
    let letters = values.texts().iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    let kind = if values.is_text() { format!("<U{letters}") } else { "<f8".to_owned() };
    let shape = match values.shape()[..] {
        [] => String::new(),
        [length] => format!("{length},"),
        ref lengths => lengths.iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
    };
    let by_column = if values.shape().len() > 1 { "True" } else { "False" };
    let mut head =
        format!("{{'descr': '{kind}', 'fortran_order': {by_column}, 'shape': ({shape}), }}");
    // With the ten bytes before it and its line end, a multiple of 64.
    let blanks = (64 - (10 + head.len() + 1) % 64) % 64;
    head.extend(std::iter::repeat_n(' ', blanks));
    head.push('\n');
    let length = u16::try_from(head.len()).unwrap_or(u16::MAX).to_le_bytes();
    let mut bytes = [b"\x93NUMPY\x01\x00", &length[..], head.as_bytes()].concat();
    bytes.extend(values.numbers().iter().flat_map(|value| value.to_le_bytes()));
    for text in values.texts() {
        let padding = std::iter::repeat_n('\0', letters - text.chars().count());
        bytes.extend(text.chars().chain(padding).flat_map(|c| u32::from(c).to_le_bytes()));
    }
    bytes
}

/// Types of data and classes of arrays in a `.mat` file.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const CELL_CLASS: u32 = 1;
const CHAR_CLASS: u32 = 4;
const DOUBLE_CLASS: u32 = 6;

/// Length of the text at the head of a `.mat` file.
const HEAD: usize = 116;

/// Writes arrays as a `.mat` file of level 5, without compression. MATLAB, Octave and `scipy.io.loadmat` read it.
/// `about` is the text at its head, of which the first 95 letters in ASCII are kept.
///
/// # Errors
/// Errors of `out`; a matrix with another number of values than its dimensions have; more than 2 GiB.
pub fn mat(
    about: &str,
    arrays: &[NamedArray<'_>],
    out: &mut (impl Write + ?Sized),
) -> io::Result<()> {
    // MATLAB recognises the file by the first words.
    let about = about.chars().filter(char::is_ascii);
    let mut head: String = "MATLAB 5.0 MAT-file, ".chars().chain(about).take(HEAD).collect();
    head.extend(std::iter::repeat_n(' ', HEAD - head.len()));
    // No data of subsystems, version 1.0, little-endian.
    out.write_all(&[head.as_bytes(), &[0; 8], b"\x00\x01IM"].concat())?;
    arrays.iter().try_for_each(|NamedArray { name, values }| {
        values.check()?;
        out.write_all(&matrix(name, values)?)
    })
}

/// One array with its tag.
fn matrix(name: &str, values: &Values<'_>) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    let (class, [rows, columns]) = match *values {
        Values::Texts(texts) => (CELL_CLASS, [texts.len(), 1]),
        Values::Text(text) => (CHAR_CLASS, [1, text.encode_utf16().count()]),
        Values::Matrix { rows, columns, .. } => (DOUBLE_CLASS, [rows, columns]),
        Values::Number(_) | Values::Vector(_) => (DOUBLE_CLASS, [values.numbers().len(), 1]),
    };
    let rows_and_columns = [size(rows)?, size(columns)?].map(u32::to_le_bytes).concat();
    element(&mut content, UINT32, &[class.to_le_bytes(), [0; 4]].concat())?;
    element(&mut content, INT32, &rows_and_columns)?;
    element(&mut content, INT8, name.as_bytes())?;
    match *values {
        Values::Texts(texts) => {
            for text in texts {
                content.extend(matrix("", &Values::Text(text))?);
            }
        }
        Values::Text(text) => {
            let letters: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            element(&mut content, UINT16, &letters)?;
        }
        _ => {
            let numbers = values.numbers().iter().flat_map(|value| value.to_le_bytes());
            element(&mut content, DOUBLE, &numbers.collect::<Vec<_>>())?;
        }
    }
    Ok([&MATRIX.to_le_bytes()[..], &size(content.len())?.to_le_bytes(), &content].concat())
}

/// Appends data with their tag: up to four bytes inside the tag, others after it, up to a multiple of eight.
fn element(content: &mut Vec<u8>, kind: u32, data: &[u8]) -> io::Result<()> {
    let length = size(data.len())?;
    let is_small = (1..=4).contains(&length);
    if is_small {
        content.extend((length << 16 | kind).to_le_bytes());
    } else {
        content.extend([kind, length].map(u32::to_le_bytes).concat());
    }
    content.extend(data);
    let whole = if is_small { 4 } else { 8 };
    content.extend(std::iter::repeat_n(0, data.len().next_multiple_of(whole) - data.len()));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BY_COLUMN: [f64; 4] = [1.0, 3.0, 2.0, -0.5];
    const MATRIX: Values = Values::Matrix { rows: 2, columns: 2, by_column: &BY_COLUMN };
    const NAMES: Values = Values::Texts(&["θ", "tip"]);

    fn bytes(hex: &str) -> Vec<u8> {
        let pairs = (0..hex.len() / 2).map(|k| u8::from_str_radix(&hex[2 * k..2 * k + 2], 16));
        pairs.collect::<Result<_, _>>().unwrap()
    }

    /// Bytes that numpy.savez (2.x) writes for these arrays.
    #[test]
    fn members_of_an_archive_are_those_that_numpy_writes() {
        let head = |text: &str| {
            [&b"\x93NUMPY\x01\x00\x76\x00"[..], format!("{text:<117}\n").as_bytes()].concat()
        };
        let numpys = [
            (
                MATRIX,
                "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 2), }",
                "000000000000f03f00000000000008400000000000000040000000000000e0bf",
            ),
            (
                NAMES,
                "{'descr': '<U3', 'fortran_order': False, 'shape': (2,), }",
                "b80300000000000000000000740000006900000070000000",
            ),
            (
                Values::Number(0.25),
                "{'descr': '<f8', 'fortran_order': False, 'shape': (), }",
                "000000000000d03f",
            ),
            (
                Values::Text("µ"),
                "{'descr': '<U1', 'fortran_order': False, 'shape': (), }",
                "b5000000",
            ),
        ];
        for (values, text, data) in numpys {
            assert_eq!(npy(&values), [head(text), bytes(data)].concat(), "{text}");
        }
    }

    /// Bytes that scipy.io.savemat (1.x) writes for these arrays; MATLAB writes letters as 16 bits, `SciPy` as UTF-8.
    #[test]
    fn numbers_of_a_mat_file_are_those_that_scipy_writes() {
        let arrays = [
            NamedArray { name: "A", values: MATRIX },
            NamedArray { name: "gain", values: Values::Number(0.25) },
            NamedArray { name: "step_s", values: Values::Vector(&[1.0, 2.0]) },
        ];
        let mut file = Vec::new();
        mat("µ about", &arrays, &mut file).unwrap();
        assert_eq!(&file[..29], b"MATLAB 5.0 MAT-file,  about  ");
        assert_eq!(file[124..128], *b"\x00\x01IM");
        let scipys = "\
            0e00000050000000060000000800000006000000000000000500000008000000020000000200000001000100\
            410000000900000020000000000000000000f03f00000000000008400000000000000040000000000000e0bf\
            0e00000038000000060000000800000006000000000000000500000008000000010000000100000001000400\
            6761696e0900000008000000000000000000d03f\
            0e0000004800000006000000080000000600000000000000050000000800000002000000010000000100000006\
            000000737465705f7300000900000010000000000000000000f03f0000000000000040";
        assert_eq!(file[128..], bytes(scipys));
    }

    #[test]
    fn a_matrix_with_other_dimensions_than_its_values_is_refused() {
        let values = Values::Matrix { rows: 2, columns: 3, by_column: &BY_COLUMN };
        let arrays = [NamedArray { name: "B", values }];
        let must = "a matrix of 2 × 3 has 4 values, but must have 6";
        assert_eq!(npz(&arrays, &mut Vec::new()).unwrap_err().to_string(), must);
        assert_eq!(mat("", &arrays, &mut Vec::new()).unwrap_err().to_string(), must);
    }
}
