//! Files of a sweep: its table, its record, its rows while they come, its shards.

mod identity;
mod record;
mod rows;
mod table;

pub use identity::{SweepIdentity, SweepInputs};
pub use record::{ForeignRecord, sweep_files, write_sweep};
pub(super) use record::{is_sweep, read_sweep};
pub use rows::{SweepRows, SweptCase, merge_shards};
pub use table::{sweep_header, sweep_row};

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

use super::files::{NamedBy, followed};
use super::folder::{Durability, FolderError, TAKEN, create, folder_of};
use super::lock::lock;
use crate::csv::{Place, TableError, checked_header, checked_rows, without_checks};
use identity::PREFIX;
use record::part_of;

/// The file of a growing sweep: `sweep.csv.part` beside `sweep.csv`.
///
/// It holds whole rows at every moment, so that an interrupted sweep can go on. With the last row it takes its final
/// name. Its first line is its [`SweepIdentity`], which shards keep.
#[derive(Debug)]
pub struct SweepFile {
    path: PathBuf,
    part: PathBuf,
    // Locked until the end, so that no other run writes the part or the table.
    file: File,
    identity: SweepIdentity,
}

/// A sweep that continues an earlier run.
#[derive(Debug)]
pub enum Resumed {
    /// Start at the first row, because there is nothing to continue.
    Anew(SweepFile),
    /// Continuation of the file and its rows.
    At(SweepFile, SweepRows),
    /// Nothing to do: the shard is complete.
    Complete(SweepRows),
}

/// Number of overwritten rows of an interrupted run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftRows {
    /// Rows of the same sweep: [`SweepFile::resume`] continues them.
    Own(usize),
    /// Rows that [`SweepFile::resume`] refuses.
    Other(usize),
}

impl SweepFile {
    /// Begins the file at `path`, and counts the rows of an interrupted run that it overwrites.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be written, or another run is writing it.
    pub fn begin(
        path: &Path,
        identity: SweepIdentity,
        header: &str,
    ) -> Result<(Self, Option<LeftRows>), FolderError> {
        let mut file = Self::open(path, identity)?;
        let left = left(&file.read()?, &file.identity, header);
        Ok((file.begun(header)?, left))
    }

    /// Continues the rows of an interrupted run; without rows it begins anew.
    ///
    /// # Errors
    /// The outer ones as [`SweepFile::begin`]; the inner ones for rows of another sweep.
    pub fn resume(
        path: &Path,
        identity: SweepIdentity,
        header: &str,
    ) -> Result<Result<Resumed, TableError>, FolderError> {
        let hint = "remove the file, or leave --resume out to begin anew";
        let rows = |path: &Path, bytes: &[u8], own: &SweepIdentity| {
            let there = own_rows(&path.display().to_string(), bytes, own, header);
            there.map_err(|error| error.with_hint(hint.to_owned()))
        };
        // The file of a finished shard names its sweep; the table of a finished sweep does not.
        if identity.shard().of() > 1 && path.exists() && !part_of(path).exists() {
            let bytes = fs::read(path).map_err(|cause| FolderError::of_file(path, cause))?;
            match rows(path, &bytes, &identity) {
                Ok(there) if there.len() < identity.rows() => {}
                there => return Ok(there.map(Resumed::Complete)),
            }
        }
        let mut file = Self::open(path, identity)?;
        let bytes = file.read()?;
        if line_ends(&bytes) < 2 {
            // No run has finished the first two lines.
            return Ok(Ok(Resumed::Anew(file.begun(header)?)));
        }
        let there = match rows(&file.part, &bytes, &file.identity) {
            Ok(there) => there,
            Err(error) => return Ok(Err(error)),
        };
        // Drops a row that an interruption cut off.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        file.file.set_len(whole as u64).map_err(|cause| file.error(cause))?;
        Ok(Ok(Resumed::At(file, there)))
    }

    /// Appends whole rows, at once: a case may have taken hours.
    ///
    /// # Errors
    /// [`FolderError`] if they cannot be written.
    pub fn append(&mut self, rows: &str) -> Result<(), FolderError> {
        self.write(&checked_rows(rows))
    }

    /// Writes the table under its name, and its record beside it, then removes the part. The table of a whole sweep
    /// has neither first line nor checks.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be written.
    pub fn finish(
        mut self,
        named_by: NamedBy,
        durability: Durability,
        on_wait: &dyn Fn(&Path),
    ) -> Result<(), FolderError> {
        let mut table = self.read()?;
        if self.identity.shard().of() == 1 {
            let first = table.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1);
            table = without_checks(&String::from_utf8_lossy(&table[first..])).into_bytes();
        }
        write_sweep(&self.path, named_by, &table, &self.identity, durability, on_wait)?;
        // The lock lasts until the part is gone, so that no other run continues it.
        fs::remove_file(&self.part).map_err(|cause| self.error(cause))
    }

    /// Removes the file of a sweep that ended before its first row.
    pub fn discard(self) {
        // An undeletable file holds no row: the next run writes over it.
        let _ = fs::remove_file(&self.part);
    }

    /// The file that holds the rows until they are complete.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Opens the part of a table for this run alone.
    fn open(table: &Path, identity: SweepIdentity) -> Result<Self, FolderError> {
        let part = part_of(table);
        create(folder_of(table))?;
        if table.is_dir() || table.file_name().is_none() {
            return Err(FolderError::of_file(table, io::Error::other(TAKEN)));
        }
        // Links in a circle take no table; the sweep reports them before the first case.
        followed(table).map_err(|cause| FolderError::of_file(table, cause))?;
        let refused = |cause| FolderError::of_file(&part, cause);
        // A link beside the table must not let this run cut off another file.
        if part.is_symlink() {
            return Err(refused(io::Error::other("it is a symbolic link")));
        }
        let opened = OpenOptions::new().create(true).read(true).append(true).open(&part);
        let file = opened.map_err(refused)?;
        lock(&file, &part).map_err(|cause| match cause.kind() {
            io::ErrorKind::WouldBlock => refused(io::Error::other("another run is writing it")),
            _ => refused(cause),
        })?;
        Ok(Self { path: table.to_owned(), part, file, identity })
    }

    /// The file with its first two lines and no row.
    fn begun(mut self, header: &str) -> Result<Self, FolderError> {
        self.file.set_len(0).map_err(|cause| self.error(cause))?;
        self.write(&(self.identity.line() + &checked_header(header)))?;
        Ok(self)
    }

    fn read(&mut self) -> Result<Vec<u8>, FolderError> {
        let mut bytes = Vec::new();
        let read = self.file.rewind().and_then(|()| self.file.read_to_end(&mut bytes));
        read.map(|_| bytes).map_err(|cause| self.error(cause))
    }

    fn write(&mut self, text: &str) -> Result<(), FolderError> {
        self.file.write_all(text.as_bytes()).map_err(|cause| self.error(cause))
    }

    fn error(&self, cause: io::Error) -> FolderError {
        FolderError::of_file(&self.part, cause)
    }
}

/// Whole rows of an interrupted run, if there are any.
fn left(bytes: &[u8], own: &SweepIdentity, header: &str) -> Option<LeftRows> {
    let rows = line_ends(bytes).saturating_sub(2);
    if rows == 0 || !bytes.starts_with(PREFIX.as_bytes()) {
        return None;
    }
    let is_own = own_rows("", bytes, own, header).is_ok();
    Some(if is_own { LeftRows::Own(rows) } else { LeftRows::Other(rows) })
}

fn line_ends(bytes: &[u8]) -> usize {
    bytes.split(|byte| *byte == b'\n').count() - 1
}

/// Reads the rows of the sweep `own`; refuses those of another sweep, or of another share of it.
fn own_rows(
    shown: &str,
    bytes: &[u8],
    own: &SweepIdentity,
    header: &str,
) -> Result<SweepRows, TableError> {
    let there = SweepRows::read(shown, bytes)?;
    there.check_same(own, header.trim_end(), "this sweep has it")?;
    let (found, must) = (there.identity().shard(), own.shard());
    if found == must {
        return Ok(there);
    }
    let place = Place { file: shown, line: Some(1) };
    Err(place.refuse("shard", found.to_string(), format!("must be {must}")))
}

#[cfg(test)]
mod tests {
    use super::identity::identity_of;
    use super::*;

    const HEADER: &str = "x,warnings,error\n";

    fn identity(values: &str, shard: &str) -> SweepIdentity {
        identity_of("link", &[], &format!("x={values}"), shard)
    }

    #[track_caller]
    fn resumed(path: &Path, identity: SweepIdentity) -> (SweepFile, usize) {
        match SweepFile::resume(path, identity, HEADER).unwrap().unwrap() {
            Resumed::At(file, rows) => (file, rows.len()),
            Resumed::Anew(file) => (file, 0),
            Resumed::Complete(_) => panic!("complete"),
        }
    }

    #[track_caller]
    fn refusal(path: &Path, identity: SweepIdentity) -> (String, String) {
        let error = SweepFile::resume(path, identity, HEADER).unwrap().unwrap_err();
        (error.to_string(), error.hint().unwrap().to_owned())
    }

    #[test]
    fn rows_stay_aside_until_the_last_and_go_on_after_an_interruption() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/sweep.csv");
        let (mut file, _) = SweepFile::begin(&path, identity("1,2,3", "1/1"), HEADER).unwrap();
        file.append("1,,\n").unwrap();
        file.append("2,").unwrap();
        drop(file);
        assert!(!path.exists());
        let bytes = fs::read(part_of(&path)).unwrap();
        let left = |values| left(&bytes, &identity(values, "1/1"), HEADER);
        assert_eq!(left("1,2,3"), Some(LeftRows::Own(1)));
        assert_eq!(left("1,2,4"), Some(LeftRows::Other(1)));

        let (mut file, rows) = resumed(&path, identity("1,2,3", "1/1"));
        assert_eq!(rows, 1, "the second row was cut off in writing");
        file.append("2,,\n3,,\n").unwrap();
        file.finish(NamedBy::User, Durability::InMemory, &|_| {}).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "x,warnings,error\n1,,\n2,,\n3,,\n");
        assert!(!part_of(&path).exists() && path.with_extension("json").exists());
    }

    #[test]
    fn a_finished_shard_keeps_its_first_line_and_is_not_done_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.csv");
        let own = identity("1,2,3", "2/2");
        let (mut file, _) = SweepFile::begin(&path, own.clone(), HEADER).unwrap();
        file.append("2,,\n").unwrap();
        file.finish(NamedBy::User, Durability::InMemory, &|_| {}).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let (header, rows) = (checked_header(HEADER), checked_rows("2,,\n"));
        assert_eq!(text, format!("{}{header}{rows}", own.line()));
        assert!(matches!(SweepFile::resume(&path, own, HEADER), Ok(Ok(Resumed::Complete(_)))));
        let (error, _) = refusal(&path, identity("1,2,4", "2/2"));
        let words =
            "s.csv:1: inputs.vary = \"x=1,2,3\", but must be \"x=1,2,4\" as this sweep has it";
        assert!(error.ends_with(words), "{error}");
        let (error, _) = refusal(&path, identity("1,2,3", "1/2"));
        assert!(error.ends_with("s.csv:1: shard = 2/2, but must be 1/2"), "{error}");
    }

    #[test]
    fn an_unfinished_sweep_is_not_mixed_with_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        drop(SweepFile::begin(&path, identity("1,2,3", "1/1"), HEADER).unwrap());
        let (error, hint) = refusal(&path, identity("1,2", "1/1"));
        assert!(error.contains("sweep.csv.part:1: inputs.vary = \"x=1,2,3\""), "{error}");
        assert_eq!(hint, "remove the file, or leave --resume out to begin anew");
        // Killed during the first line.
        fs::write(part_of(&path), "# flexl").unwrap();
        let (_, rows) = resumed(&path, identity("1,2", "1/1"));
        assert_eq!(rows, 0);
        let begun = fs::read_to_string(part_of(&path)).unwrap();
        assert_eq!(begun, identity("1,2", "1/1").line() + &checked_header(HEADER));
    }

    #[test]
    fn rows_that_were_changed_are_not_gone_on_with() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        let (mut file, _) = SweepFile::begin(&path, identity("1,2,3", "1/1"), HEADER).unwrap();
        file.append("1,,\n3,,\n").unwrap();
        drop(file);
        let (error, hint) = refusal(&path, identity("1,2,3", "1/1"));
        let words = "sweep.csv.part:4: x = \"3\", but must be \"2\", the value of case 2";
        assert!(error.ends_with(words), "{error}");
        assert_eq!(hint, "remove the file, or leave --resume out to begin anew");
    }

    #[test]
    fn a_folder_is_no_file_for_a_sweep() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("..")] {
            let error = SweepFile::open(&path, identity("1,2", "1/1")).unwrap_err();
            assert!(error.to_string().ends_with(TAKEN), "{error}");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn two_runs_do_not_write_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        let (first, _) = SweepFile::begin(&path, identity("1,2", "1/1"), HEADER).unwrap();
        let second = SweepFile::begin(&path, identity("1,2", "1/1"), HEADER).unwrap_err();
        assert!(second.to_string().ends_with("sweep.csv.part: another run is writing it"));
        let text = fs::read_to_string(part_of(&path)).unwrap();
        assert!(text.ends_with(&checked_header(HEADER)), "the first run's rows are untouched");
        drop(first);
        assert!(SweepFile::begin(&path, identity("1,2", "1/1"), HEADER).is_ok());
    }
}
