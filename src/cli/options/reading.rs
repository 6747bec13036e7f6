//! Options for the reading of a measured table, and remarks on it.

use clap::Args;

use crate::csv::{ColumnChoice, ColumnScale, Decimal, Delimiter, Reading, TableFormat, UnitName};

use super::common::option;
use crate::cli::terminal::console;

const READING: &str = "Reading a measured MOTION or TORQUE";

/// How MOTION, or the TORQUE of `simulate`, is to be read. The file decides where an option is absent.
#[derive(Debug, Args)]
pub struct ReadArgs {
    /// Column of each quantity, by its number from 1 or by its heading: time=1,displacement=3 or displacement=pos;
    /// for an arm's path x, y, angle1, angle2, … A table without headings needs the
    /// time, too.
    #[arg(long, help_heading = READING, value_name = "QUANTITY=COLUMN", value_delimiter = ',')]
    columns: Vec<ColumnChoice>,

    /// Unit of the times, such as ms.
    #[arg(long, help_heading = READING, value_name = "UNIT")]
    time_unit: Option<UnitName>,

    /// Unit of the motion or the torque, such as mm, deg or 'N cm'. For an arm's path, a length is the unit of x and
    /// y, an angle that of all directions.
    #[arg(long, help_heading = READING, value_name = "UNIT")]
    unit: Option<UnitName>,

    /// Multiply the numbers of a quantity's column, before their unit: counts to metres,
    /// displacement=1.5e-6.
    #[arg(long, help_heading = READING, value_name = "QUANTITY=FACTOR", value_delimiter = ',')]
    scale: Vec<ColumnScale>,

    /// Leave out the first N lines.
    #[arg(long, help_heading = READING, value_name = "N", default_value_t, hide_default_value = true)]
    skip: usize,

    /// Sign between the fields: `,`, `;`, tab or blanks.
    #[arg(long, help_heading = READING, value_name = "SIGN")]
    delimiter: Option<Delimiter>,

    /// Sign before decimals: point or comma.
    #[arg(long, help_heading = READING, value_name = "SIGN")]
    decimal: Option<Decimal>,
}

impl ReadArgs {
    /// The options for a table.
    pub(crate) fn format(&self) -> TableFormat {
        TableFormat {
            skip: self.skip,
            delimiter: self.delimiter,
            decimal: self.decimal,
            columns: self.columns.clone(),
            scales: self.scale.clone(),
            time_unit: self.time_unit.clone(),
            unit: self.unit.clone(),
            drop_outliers: false,
        }
    }

    /// Arguments for the record.
    pub fn arguments(&self) -> Vec<String> {
        let columns = self.columns.iter().flat_map(|choice| option("--columns", choice));
        let time_unit = self.time_unit.iter().flat_map(|unit| option("--time-unit", unit));
        let unit = self.unit.iter().flat_map(|unit| option("--unit", unit));
        let scale = self.scale.iter().flat_map(|scale| option("--scale", scale));
        let skip = (self.skip != 0).then(|| option("--skip", self.skip));
        let delimiter = self.delimiter.iter().flat_map(|sign| option("--delimiter", sign));
        let decimal = self.decimal.iter().flat_map(|sign| option("--decimal", sign));
        let columns = columns.chain(time_unit).chain(unit).chain(scale);
        columns.chain(skip.into_iter().flatten()).chain(delimiter).chain(decimal).collect()
    }
}

/// Prints deviations of a table from the standard form, and its unread columns.
pub(crate) fn tell(shown: &str, reading: &Reading) {
    if let Some(note) = reading.note() {
        console::note(&format!("{shown}: {note}"));
    }
    for (remark, hint) in reading.remarks() {
        console::remark(&format!("{shown}: {remark}"), hint);
    }
}
