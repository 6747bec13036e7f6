//! The table of a sweep: its rows from cases, or joined from shards.

use std::path::{Path, PathBuf};

use crate::csv::{checked_header, checked_rows};
use crate::store::{
    Durability, LeftRows, NamedBy, Resumed, SweepFile, SweepIdentity, SweepRows, SweptCase,
    merge_shards, write_sweep,
};

use super::tally::Tally;
use crate::cli::terminal::console::{self, Reader, is_standard_output};
use crate::cli::terminal::files::{keep_files, keep_record, read_once};
use crate::cli::terminal::{Exit, Failure};
use crate::text::counted;

/// Destination of the rows of a sweep.
pub(crate) enum TableOutput {
    /// A file that is whole at the end.
    InFile(Box<SweepFile>),
    /// Standard output; each row of a shard has a checksum.
    Printed { is_shard: bool },
}

/// A table, open for its rows.
pub(crate) enum OpenedTable {
    /// Destination of its rows, rows of an earlier run, and the number of printed warnings.
    Unfinished(TableOutput, Option<SweepRows>, usize),
    /// An earlier run has written all its rows.
    Complete(SweepRows),
}

/// Reason for the end of a sweep before its last row.
pub(crate) enum EarlyEnd {
    /// The reader of standard output has gone, and needs no more rows.
    ReaderGone,
    /// A case or its row cannot be written, or its options are wrong.
    Failed(Failure),
}

impl From<Failure> for EarlyEnd {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

impl TableOutput {
    /// Begins a table, or continues that of an interrupted run.
    pub(crate) fn open(
        path: &Path,
        identity: SweepIdentity,
        header: &str,
        resume: bool,
    ) -> Result<OpenedTable, Failure> {
        if is_standard_output(path) {
            if resume {
                let message = "--resume = standard output, but must have a file to go on with";
                return Err(Failure::new(Exit::Usage, &message, None));
            }
            let is_shard = identity.shard().of() > 1;
            let first = identity.line() + &checked_header(header);
            console::print_bytes(if is_shard { &first } else { header }.as_bytes())?;
            return Ok(OpenedTable::Unfinished(Self::Printed { is_shard }, None, 0));
        }
        let in_file = |file, rows, warnings| {
            OpenedTable::Unfinished(Self::InFile(Box::new(file)), rows, warnings)
        };
        if resume {
            return Ok(match SweepFile::resume(path, identity, header)?? {
                Resumed::Anew(file) => in_file(file, None, 0),
                Resumed::At(file, rows) => in_file(file, Some(rows), 0),
                Resumed::Complete(rows) => OpenedTable::Complete(rows),
            });
        }
        let (file, left) = SweepFile::begin(path, identity, header)?;
        let warnings = left.map_or(0, |left| warn_of_left(&left, file.part()));
        Ok(in_file(file, None, warnings))
    }

    /// Whether standard output has the rows, so that nothing else may go there.
    pub(crate) fn is_printed(&self) -> bool {
        !matches!(self, Self::InFile(_))
    }

    pub(crate) fn append(&mut self, row: &str) -> Result<(), EarlyEnd> {
        let printed = match self {
            Self::InFile(file) => return Ok(file.append(row).map_err(Failure::from)?),
            Self::Printed { is_shard: true } => console::print_part(checked_rows(row).as_bytes())?,
            Self::Printed { is_shard: false } => console::print_part(row.as_bytes())?,
        };
        match printed {
            Reader::There => Ok(()),
            Reader::Gone => Err(EarlyEnd::ReaderGone),
        }
    }

    pub(crate) fn finish(self, named_by: NamedBy, durability: Durability) -> Result<(), Failure> {
        match self {
            Self::InFile(file) => Ok(file.finish(named_by, durability, &console::waiting)?),
            Self::Printed { .. } => Ok(()),
        }
    }

    /// Removes the file of a sweep that failed before its first row.
    pub(crate) fn discard(self) {
        if let Self::InFile(file) = self {
            file.discard();
        }
    }

    /// The failure of a sweep that stopped after `there` of `all` rows.
    pub(crate) fn interrupted(&self, there: usize, all: usize) -> Failure {
        let message = format!("interrupted after {there} of {all} cases");
        let Self::InFile(file) = self else {
            return Failure::new(Exit::Interrupted, &message, None);
        };
        let message = format!("{message}, which are in {}", file.part().display());
        let hint = "the same command with --resume goes on";
        Failure::new(Exit::Interrupted, &message, Some(hint))
    }
}

/// Warns of overwritten rows; returns the number of warnings.
fn warn_of_left(left: &LeftRows, part: &Path) -> usize {
    let (rows, hint) = match *left {
        LeftRows::Own(rows) => (rows, "use --resume to keep the rows of an interrupted sweep"),
        LeftRows::Other(rows) => (rows, "use another -o to keep rows of another sweep"),
    };
    let (part, rows) = (part.display(), counted(rows, "row"));
    let message = format!("{part} held {rows} of an interrupted sweep, which begins anew");
    console::warning(message, hint);
    1
}

/// Joins the shards in these files to one table, and counts its cases.
pub(crate) fn merge(
    shards: &[PathBuf],
    output: &Path,
    named_by: NamedBy,
) -> Result<Tally, Failure> {
    let inputs: Vec<&Path> = shards.iter().map(PathBuf::as_path).collect();
    read_once(&inputs)?;
    keep_files(output, &inputs)?;
    keep_record(output)?;
    let read = inputs.iter().map(|path| SweepRows::of_shard(path));
    let shards: Vec<SweepRows> = read.collect::<Result<_, _>>()?;
    let table = merge_shards(&shards)?;
    if is_standard_output(output) {
        console::print_bytes(table.as_bytes())?;
    } else {
        let whole = shards[0].identity().whole();
        let (table, durability) = (table.as_bytes(), Durability::default());
        write_sweep(output, named_by, table, &whole, durability, &console::waiting)?;
    }
    let mut cases: Vec<SweptCase> = shards.iter().flat_map(SweepRows::cases).collect();
    cases.sort_by_key(|case| case.number);
    Ok(Tally::of_cases(cases.into_iter(), |_| Vec::new()))
}
