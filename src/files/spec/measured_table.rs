//! Keys that describe the table of a measurement, as the options of the reader do.

/// Description of a table in the file that names it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableKeys {
    /// Number of lines to skip at the beginning.
    pub skip: usize,
    /// Columns of the quantities, as for `--columns`.
    pub columns: Vec<String>,
    /// Factors on the numbers of columns, as for `--scale`.
    pub scale: Vec<String>,
    /// Delimiter of the fields, as for `--delimiter`.
    pub delimiter: Option<String>,
    /// Decimal sign, as for `--decimal`.
    pub decimal: Option<String>,
    /// Unit of the times, as for `--time-unit`.
    pub time_unit: Option<String>,
    /// Unit of the columns of its dimension, as for `--unit`.
    pub unit: Option<String>,
    /// Samples in a second, of a table without times.
    pub sample_rate_hz: Option<f64>,
    /// Step in s of uniform times.
    pub resample_s: Option<f64>,
}
