//! Keys that describe the table of a measurement, as the options of the reader do.

use super::error::Fault;
use super::measured_values::Hertz;
use super::value::{Si, Time};

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

/// A measurement whose samples are in a table: the keys of the table, and all others.
#[derive(Debug, serde::Deserialize)]
pub(super) struct Tabled<T>(pub(super) RawTable, pub(super) T);

/// Keys about the table of any measurement.
#[derive(Debug, Default, serde::Deserialize)]
#[serde(default)]
pub(super) struct RawTable {
    skip: usize,
    columns: Vec<String>,
    scale: Vec<String>,
    delimiter: Option<String>,
    decimal: Option<String>,
    time_unit: Option<String>,
    unit: Option<String>,
    sample_rate: Option<Hertz>,
    resample: Option<Time>,
}

impl RawTable {
    /// Converts the keys; refuses those that have no meaning for a measurement, for the reason `why`.
    pub(super) fn convert(
        self,
        path: &str,
        (useless, why): (&[&str], &str),
    ) -> Result<TableKeys, Fault> {
        let given = [
            ("scale", !self.scale.is_empty()),
            ("time_unit", self.time_unit.is_some()),
            ("unit", self.unit.is_some()),
            ("sample_rate", self.sample_rate.is_some()),
            ("resample", self.resample.is_some()),
        ];
        let mut useless = given.iter().filter(|(key, is_given)| *is_given && useless.contains(key));
        if let Some((key, _)) = useless.next() {
            return Err(Fault::on(format!("{path}.{key}"), format!("has no meaning {why}")));
        }
        Ok(TableKeys {
            skip: self.skip,
            columns: self.columns,
            scale: self.scale,
            delimiter: self.delimiter,
            decimal: self.decimal,
            time_unit: self.time_unit,
            unit: self.unit,
            sample_rate_hz: self.sample_rate.map(|Hertz(rate)| rate),
            resample_s: self.resample.map(Si::si),
        })
    }
}
