//! Where the rows of a sweep go: a file that is whole at the end, or standard output.

use std::path::Path;

use flexlink::csv::{checked_header, checked_rows};
use flexlink::store::{Durability, LeftRows, Resumed, SweepFile, SweepIdentity, SweepRows};

use crate::terminal::console::{self, Reader, is_standard_output};
use crate::terminal::{Exit, Failure};

/// The rows of a sweep as they come.
pub(crate) enum Rows {
    InFile(Box<SweepFile>),
    Printed,
    /// With what tells a shard from a table.
    PrintedShard,
}

/// A few words on standard output, where the table is not.
pub(crate) fn report(text: &str, output: &Path, quiet: bool) -> Result<(), Failure> {
    if quiet || is_standard_output(output) {
        return Ok(());
    }
    console::print(&format!("{text}\n"))
}

/// A number of things, in singular or plural.
pub(crate) fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Warns of rows that were overwritten; returns how many warnings it printed.
fn warn_of_left(left: &LeftRows, part: &Path) -> usize {
    let (rows, hint) = match *left {
        LeftRows::Own(rows) => (rows, "--resume would have gone on with them"),
        LeftRows::Other(rows) => (rows, "they were of another sweep: another -o keeps them"),
    };
    let (part, rows) = (part.display(), counted(rows, "row"));
    let message = format!("{part} held {rows} of an interrupted sweep, begun anew");
    console::warning(message, hint);
    1
}

/// A table that was begun.
pub(crate) enum Begun {
    /// Where its rows go, and those that are there from an earlier run.
    To(Rows, Option<SweepRows>),
    /// Where its rows go from the first on, and how many warnings were printed of what was there.
    Anew(Rows, usize),
    /// All its rows are there.
    Complete(SweepRows),
}

/// Why no more rows are taken.
pub(crate) enum NoMore {
    /// Who read them has gone away, and needs no more.
    ReaderGone,
    /// They cannot be written.
    Failed(Failure),
}

fn print_row(row: &str) -> Result<(), NoMore> {
    match console::print_part(row.as_bytes()) {
        Ok(Reader::There) => Ok(()),
        Ok(Reader::Gone) => Err(NoMore::ReaderGone),
        Err(failure) => Err(NoMore::Failed(failure)),
    }
}

impl Rows {
    /// Begins a table, or goes on with what an interrupted run left of it.
    pub(crate) fn begin(
        path: &Path,
        identity: SweepIdentity,
        header: &str,
        resume: bool,
    ) -> Result<Begun, Failure> {
        if is_standard_output(path) {
            if resume {
                let message = "--resume = standard output, but must have a file to go on with";
                return Err(Failure::new(Exit::Usage, &message, None));
            }
            let is_shard = identity.shard().of() > 1;
            let first = identity.line() + &checked_header(header);
            console::print_bytes(if is_shard { &first } else { header }.as_bytes())?;
            let rows = if is_shard { Self::PrintedShard } else { Self::Printed };
            return Ok(Begun::To(rows, None));
        }
        if resume {
            return Ok(match SweepFile::resume(path, identity, header)?? {
                Resumed::Anew(file) => Begun::To(Self::InFile(Box::new(file)), None),
                Resumed::At(file, rows) => Begun::To(Self::InFile(Box::new(file)), Some(rows)),
                Resumed::Complete(rows) => Begun::Complete(rows),
            });
        }
        let left = SweepFile::left(path, &identity, header);
        let file = SweepFile::begin(path, identity, header)?;
        let warnings = left.map_or(0, |left| warn_of_left(&left, file.part()));
        Ok(Begun::Anew(Self::InFile(Box::new(file)), warnings))
    }

    /// Whether they are printed, so that nothing else may be.
    pub(crate) fn are_printed(&self) -> bool {
        matches!(self, Self::Printed | Self::PrintedShard)
    }

    pub(crate) fn append(&mut self, row: &str) -> Result<(), NoMore> {
        match self {
            Self::InFile(file) => file.append(row).map_err(|error| NoMore::Failed(error.into())),
            Self::Printed => print_row(row),
            Self::PrintedShard => print_row(&checked_rows(row)),
        }
    }

    pub(crate) fn finish(self, durability: Durability) -> Result<(), Failure> {
        match self {
            Self::InFile(file) => Ok(file.finish(durability, &console::waiting)?),
            Self::Printed | Self::PrintedShard => Ok(()),
        }
    }

    /// What to tell of a sweep that was stopped after `there` of `all` rows.
    pub(crate) fn interrupted(&self, there: usize, all: usize) -> Failure {
        let message = format!("interrupted after {there} of {all} cases");
        match self {
            Self::InFile(file) => {
                let message = format!("{message}, which are in {}", file.part().display());
                let hint = "the same command with --resume goes on";
                Failure::new(Exit::Interrupted, &message, Some(hint))
            }
            Self::Printed | Self::PrintedShard => Failure::new(Exit::Interrupted, &message, None),
        }
    }
}
