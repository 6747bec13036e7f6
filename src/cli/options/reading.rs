//! The options of a table of instruments, and the tables of a command that they may name.

use std::fmt;
use std::str::FromStr;

use clap::{Arg, Args};

use super::common::{option, seconds};
use crate::cli::terminal::{Exit, Failure, console};
use crate::csv::{
    ColumnChoice, ColumnScale, Decimal, Delimiter, Reading, SampleRate, TableFormat, UnitName,
};

const READING: &str = "Reading a measured table";

/// A table that a command reads. The first one of a command takes the options without a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableName {
    Motion,
    Torque,
    Target,
    Reference,
    Measured,
    Applied,
}

impl TableName {
    const ALL: [Self; 6] =
        [Self::Motion, Self::Torque, Self::Target, Self::Reference, Self::Measured, Self::Applied];

    /// The refusal of an option for this table by a command that reads others.
    fn unread(self, tables: &[Self]) -> Failure {
        let words: Vec<&str> = tables.iter().map(|own| own.word()).collect();
        let message = format!(
            "{} is no table of this command, which reads {}",
            self.word(),
            words.join(", ")
        );
        let hint =
            "a name before an option of reading is that of a table: --columns measured:tip=pos";
        Failure::new(Exit::Usage, &message, Some(hint))
    }

    fn word(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Torque => "torque",
            Self::Target => "target",
            Self::Reference => "reference",
            Self::Measured => "measured",
            Self::Applied => "applied",
        }
    }
}

impl TableName {
    /// A text whose options of reading are for this table, unless they name another one.
    fn named(self, text: &str) -> String {
        let options = ReadArgs::augment_args(clap::Command::new(""));
        options.get_arguments().filter_map(Arg::get_long).fold(text.to_owned(), |text, option| {
            let option = format!("--{option} ");
            let mut parts = text.split(&option);
            let first = parts.next().unwrap_or_default().to_owned();
            parts.fold(first, |text, part| match split_table(part) {
                (None, _) => format!("{text}{option}{}:{part}", self.word()),
                _ => text + &option + part,
            })
        })
    }

    /// The refusal of this table where it is not the first one of a command: options of hints name it.
    pub(crate) fn refused(self, failure: Failure) -> Failure {
        Failure { hint: failure.hint.map(|hint| self.named(&hint)), ..failure }
    }

    /// Prints deviations of this table where it is not the first one of a command.
    pub(crate) fn tell(self, shown: &str, reading: &Reading) {
        tell_with(shown, reading, |hint| self.named(hint));
    }
}

/// A value for a table by its name, `measured:ms`, or without one for the first table.
#[derive(Debug, Clone)]
struct Named<T> {
    table: Option<TableName>,
    value: T,
}

/// The table before a colon, and the text of its value.
fn split_table(text: &str) -> (Option<TableName>, &str) {
    let named = text.split_once(':').and_then(|(word, value)| {
        let table = TableName::ALL.into_iter().find(|table| table.word() == word.trim())?;
        Some((Some(table), value.trim_start()))
    });
    named.unwrap_or((None, text))
}

impl<T: FromStr> FromStr for Named<T>
where
    T::Err: fmt::Display,
{
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (table, value) = split_table(text);
        let value = value.parse().map_err(|error: T::Err| error.to_string())?;
        Ok(Self { table, value })
    }
}

impl<T: fmt::Display> fmt::Display for Named<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(table) = self.table {
            write!(f, "{}:", table.word())?;
        }
        write!(f, "{}", self.value)
    }
}

/// Values divided by commas. The name of a table holds up to the next name.
#[derive(Debug, Clone)]
struct List<T>(Vec<Named<T>>);

impl<T: FromStr> FromStr for List<T>
where
    T::Err: fmt::Display,
{
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut of = None;
        let each = text.split(',').map(|text| {
            let Named { table, value } = text.parse()?;
            of = table.or(of);
            Ok(Named { table: of, value })
        });
        each.collect::<Result<_, String>>().map(Self)
    }
}

/// How a command reads its tables. The file decides where an option is absent.
///
/// An option is for the first table of the command; `--columns measured:tip=pos` is for another one.
#[derive(Debug, Default, Args)]
pub struct ReadArgs {
    /// Make the times of a table uniform by a cubic spline, at this step in s or with its unit, as in '10 ms'. Rows without
    /// a value and rows that repeat a time are left out and counted. This option and the next ones are for the first table
    /// of the command; with the name of another one before the value for that: 'measured:10 ms'.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]STEP", allow_hyphen_values = true)]
    resample: Vec<Named<Step>>,

    /// Column of each quantity, by its number from 1 or by its heading: time=1,displacement=3 or displacement=pos;
    /// for an arm's path x, y, angle1, angle2, … A table without headings needs the time, too.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]QUANTITY=COLUMN")]
    columns: Vec<List<ColumnChoice>>,

    /// Unit of the times, such as ms.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]UNIT")]
    time_unit: Vec<Named<UnitName>>,

    /// Samples in a second of a table without times, in Hz or with its unit, as in '1 kHz'.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]RATE", allow_hyphen_values = true)]
    sample_rate: Vec<Named<SampleRate>>,

    /// Unit of the motion or the torque, such as mm, deg or 'N cm'. For an arm's path, a length is the unit of x and
    /// y, an angle that of all directions.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]UNIT")]
    unit: Vec<Named<UnitName>>,

    /// Multiply the numbers of a quantity's column, before their unit: counts to metres,
    /// displacement=1.5e-6.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]QUANTITY=FACTOR")]
    scale: Vec<List<ColumnScale>>,

    /// Leave out the first N lines.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]N")]
    skip: Vec<Named<usize>>,

    /// Sign between the fields: `,`, `;`, tab or blanks.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]SIGN")]
    delimiter: Vec<Named<Delimiter>>,

    /// Sign before decimals: point or comma.
    #[arg(long, help_heading = READING, value_name = "[TABLE:]SIGN")]
    decimal: Vec<Named<Decimal>>,
}

/// A time as written, and in s.
#[derive(Debug, Clone)]
struct Step {
    text: String,
    step_s: f64,
}

impl FromStr for Step {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        seconds(text).map(|step_s| Self { text: text.to_owned(), step_s })
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// An option with its table and its value.
type Given = (&'static str, Option<TableName>, String);

/// The last value for a table.
fn last<T: Clone>(values: &[Named<T>], is_of: impl Fn(Option<TableName>) -> bool) -> Option<T> {
    values.iter().rfind(|own| is_of(own.table)).map(|own| own.value.clone())
}

/// The values of a list for a table.
fn all<T: Clone>(lists: &[List<T>], is_of: impl Fn(Option<TableName>) -> bool) -> Vec<T> {
    let each = lists.iter().flat_map(|List(values)| values);
    each.filter(|own| is_of(own.table)).map(|own| own.value.clone()).collect()
}

impl ReadArgs {
    /// The options for a table of a command whose `first` table takes the options without a name.
    pub fn format(&self, table: TableName, first: TableName) -> TableFormat {
        let is_of = |own: Option<TableName>| own.unwrap_or(first) == table;
        TableFormat {
            resample_s: last(&self.resample, is_of).map(|own| own.step_s),
            skip: last(&self.skip, is_of).unwrap_or_default(),
            delimiter: last(&self.delimiter, is_of),
            decimal: last(&self.decimal, is_of),
            columns: all(&self.columns, is_of),
            scales: all(&self.scale, is_of),
            time_unit: last(&self.time_unit, is_of),
            unit: last(&self.unit, is_of),
            sample_rate: last(&self.sample_rate, is_of),
            ..TableFormat::default()
        }
    }

    /// Refuses options for tables that a command does not read, and two values for one table. The first of `tables` takes
    /// the options without a name.
    pub fn check(&self, tables: &[TableName]) -> Result<(), Failure> {
        let given = self.given();
        let of = |table: Option<TableName>| table.or(tables.first().copied());
        for (number, (option, table, _)) in given.iter().enumerate() {
            if let Some(table) = table.filter(|table| !tables.contains(table)) {
                return Err(table.unread(tables));
            }
            let is_list = ["--columns", "--scale"].contains(option);
            let is_same = |own: &Given| own.0 == *option && of(own.1) == of(*table);
            if !is_list && given[..number].iter().any(is_same) {
                let message = format!("{option} has two values for one table, but must have one");
                return Err(Failure::new(Exit::Usage, &message, None));
            }
        }
        Ok(())
    }

    /// Options for a table of a command whose `first` table takes those without a name.
    pub fn options_of(&self, table: TableName, first: TableName) -> Vec<&'static str> {
        let of_table = |own: &Given| own.1.unwrap_or(first) == table;
        self.given().into_iter().filter(of_table).map(|(option, ..)| option).collect()
    }

    /// Arguments for the record.
    pub fn arguments(&self) -> Vec<String> {
        // Reading from line 1 is the default.
        let is_told = |own: &Given| !(own.0 == "--skip" && own.2 == "0");
        let told = self.given().into_iter().filter(is_told);
        told.flat_map(|(name, _, value)| option(name, value)).collect()
    }

    /// All options with their tables and values.
    fn given(&self) -> Vec<Given> {
        fn each<'a, T: fmt::Display + 'a>(
            option: &'static str,
            values: impl IntoIterator<Item = &'a Named<T>>,
        ) -> Vec<Given> {
            values.into_iter().map(|own| (option, own.table, own.to_string())).collect()
        }
        [
            each("--resample", &self.resample),
            each("--columns", self.columns.iter().flat_map(|List(own)| own)),
            each("--time-unit", &self.time_unit),
            each("--sample-rate", &self.sample_rate),
            each("--unit", &self.unit),
            each("--scale", self.scale.iter().flat_map(|List(own)| own)),
            each("--skip", &self.skip),
            each("--delimiter", &self.delimiter),
            each("--decimal", &self.decimal),
        ]
        .concat()
    }
}

/// Prints deviations of a table from the standard form, and its unread columns.
pub(crate) fn tell(shown: &str, reading: &Reading) {
    tell_with(shown, reading, str::to_owned);
}

fn tell_with(shown: &str, reading: &Reading, hinted: impl Fn(&str) -> String) {
    if let Some(note) = reading.note() {
        console::note(&format!("{shown}: {note}"));
    }
    for (remark, hint) in reading.remarks() {
        console::remark(&format!("{shown}: {remark}"), &hinted(hint));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, clap::Parser)]
    #[command(no_binary_name = true)]
    struct Parsed {
        #[command(flatten)]
        read: ReadArgs,
    }

    fn parsed(words: &str) -> ReadArgs {
        <Parsed as clap::Parser>::try_parse_from(words.split(' ')).unwrap().read
    }

    #[test]
    fn options_go_to_their_tables_and_are_recorded() {
        let read = parsed(
            "--columns time=1,torque=2,measured:time=3,tip=4 --unit measured:mm --skip 2 --skip target:3 \
             --resample measured:5ms",
        );
        let choices = |format: TableFormat| {
            format.columns.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
        };
        let format = |table| read.format(table, TableName::Torque);
        let first = format(TableName::Torque);
        assert_eq!((first.skip, first.unit.is_none()), (2, true));
        assert_eq!(choices(first), "time=1,torque=2");
        let measured = format(TableName::Measured);
        assert_eq!((measured.skip, measured.unit.is_some()), (0, true));
        assert_eq!(measured.resample_s, Some(0.005));
        assert_eq!(choices(measured), "time=3,tip=4");
        assert_eq!(format(TableName::Target).skip, 3);
        assert_eq!(parsed(&read.arguments().join(" ")).arguments(), read.arguments());
        assert!(read.check(&[TableName::Torque, TableName::Measured]).is_err());
    }

    #[test]
    fn a_hint_names_the_table_behind_every_option_of_reading_and_no_other() {
        let hint =
            "--resample STEP, --skip 2 or --columns torque:time=1; --column NAME; --drop-outliers";
        let named = "--resample measured:STEP, --skip measured:2 or --columns torque:time=1; --column NAME; \
                     --drop-outliers";
        assert_eq!(TableName::Measured.named(hint), named);
    }
}
