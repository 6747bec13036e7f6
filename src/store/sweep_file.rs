use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use super::folder::{Durability, FolderError};
use super::sweep_identity::SweepIdentity;
use super::sweep_part::{error, open_part, part_of};
use super::sweep_record::write_sweep;
use super::sweep_rows::SweepRows;
use super::unfinished::{Removal, Unfinished};
use crate::csv::{Place, TableError, checked_header, checked_rows, quoted, without_checks};

/// The file of a sweep while its rows come: `sweep.csv.part` beside `sweep.csv`.
///
/// It holds whole rows at every moment, so that an interrupted sweep can go on; it takes its own
/// name when the last row is there. Its first line is its [`SweepIdentity`], which shards keep.
#[derive(Debug)]
pub struct SweepFile {
    path: PathBuf,
    part: PathBuf,
    file: File,
    identity: SweepIdentity,
    /// Until the first row is there: then the part is kept, however the program ends.
    unfinished: Option<Unfinished>,
}

/// A sweep that goes on where an earlier run ended.
#[derive(Debug)]
pub enum Resumed {
    /// From the first row on: there is nothing to go on with.
    Anew(SweepFile),
    /// With the file, and the rows that it holds.
    At(SweepFile, SweepRows),
    /// With nothing to do: the shard is complete.
    Complete(SweepRows),
}

/// How many rows an interrupted run left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftRows {
    /// Rows of the same sweep: [`SweepFile::resume`] goes on with them.
    Own(usize),
    /// Rows that [`SweepFile::resume`] refuses.
    Other(usize),
}

impl SweepFile {
    /// Begins the file at `path`; what an interrupted run left beside it is overwritten.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be written, or another run is writing it.
    pub fn begin(path: &Path, identity: SweepIdentity, header: &str) -> Result<Self, FolderError> {
        let (unfinished, mut file) = Unfinished::make(Removal::File, || {
            let file = Self::open(path, identity)?;
            file.file.set_len(0).map_err(|cause| file.error(cause))?;
            Ok((file.part.clone(), file))
        })?;
        file.unfinished = Some(unfinished);
        let first = file.identity.line() + &checked_header(header);
        file.write(&first)?;
        Ok(file)
    }

    /// Goes on with what an interrupted run left, or begins where it left nothing.
    ///
    /// # Errors
    /// The outer ones as [`SweepFile::begin`]; the inner ones for what is there of another sweep.
    pub fn resume(
        path: &Path,
        identity: SweepIdentity,
        header: &str,
    ) -> Result<Result<Resumed, TableError>, FolderError> {
        let refused = |error: TableError| {
            error.with_hint("remove the file, or leave --resume out to begin anew".to_owned())
        };
        let part = part_of(path);
        // A finished shard tells what it is; a finished sweep does not.
        let shown = if part.exists() { part } else { path.to_owned() };
        let is_part = shown != path;
        if !is_part && identity.shard().of() == 1 || !shown.exists() {
            return Ok(Ok(Resumed::Anew(Self::begin(path, identity, header)?)));
        }
        let mut file = if is_part { Some(Self::open(path, identity.clone())?) } else { None };
        let read = fs::read(&shown).map_err(|cause| error(&shown, cause))?;
        let name = shown.display().to_string();
        // Ended before its first two lines were there.
        let headless = read
            .split_inclusive(|byte| *byte == b'\n')
            .nth(1)
            .is_none_or(|header| !header.ends_with(b"\n"));
        if is_part && headless {
            drop(file);
            return Ok(Ok(Resumed::Anew(Self::begin(path, identity, header)?)));
        }
        let there = match SweepRows::read(&name, &read) {
            Ok(there) => there,
            Err(error) => return Ok(Err(refused(error))),
        };
        if let Err(error) = check_same(&there, &identity, header) {
            return Ok(Err(refused(error)));
        }
        Ok(Ok(match file.take() {
            Some(mut file) => {
                file.cut_after(&read)?;
                Resumed::At(file, there)
            }
            None if there.len() == identity.rows() => Resumed::Complete(there),
            None => Resumed::Anew(Self::begin(path, identity, header)?),
        }))
    }

    /// Whole rows that an interrupted run left for the file at `path`, if there are any.
    pub fn left(path: &Path, identity: &SweepIdentity, header: &str) -> Option<LeftRows> {
        let bytes = fs::read(part_of(path)).unwrap_or_default();
        let lines = bytes.split(|byte| *byte == b'\n').count() - 1;
        let is_of_a_sweep = bytes.starts_with(b"# flexlink ");
        let rows = Some(lines.saturating_sub(2)).filter(|rows| is_of_a_sweep && *rows > 0)?;
        let there = SweepRows::read("", &bytes);
        let is_own = there.and_then(|there| check_same(&there, identity, header)).is_ok();
        Some(if is_own { LeftRows::Own(rows) } else { LeftRows::Other(rows) })
    }

    /// Appends whole rows, at once: a case may have taken hours.
    ///
    /// # Errors
    /// [`FolderError`] if they cannot be written.
    pub fn append(&mut self, rows: &str) -> Result<(), FolderError> {
        self.write(&checked_rows(rows))?;
        self.keep();
        Ok(())
    }

    fn keep(&mut self) {
        if let Some(part) = self.unfinished.take() {
            part.keep();
        }
    }

    fn write(&mut self, text: &str) -> Result<(), FolderError> {
        self.file.write_all(text.as_bytes()).map_err(|cause| self.error(cause))
    }

    /// Gives the file its own name, and lays its record beside it; of a whole sweep only the table is
    /// left. If another run writes into its folder for more than a second, `on_wait` is called once.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be written.
    pub fn finish(
        self,
        durability: Durability,
        on_wait: &dyn Fn(&Path),
    ) -> Result<(), FolderError> {
        let rows = fs::read(&self.part).map_err(|cause| self.error(cause))?;
        let table = if self.identity.shard().of() > 1 {
            rows
        } else {
            let first = rows.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1);
            without_checks(&String::from_utf8_lossy(&rows[first..])).into_bytes()
        };
        write_sweep(&self.path, &table, &self.identity, durability, on_wait)?;
        // The lock is held until the part is gone: no other run may take what is no part any more.
        fs::remove_file(&self.part).map_err(|cause| self.error(cause))
    }

    /// The file that holds the rows until they are complete.
    pub fn part(&self) -> &Path {
        &self.part
    }

    fn open(path: &Path, identity: SweepIdentity) -> Result<Self, FolderError> {
        let (part, file) = open_part(path)?;
        Ok(Self { path: path.to_owned(), part, file, identity, unfinished: None })
    }

    /// Cuts off a row that was not written to its end.
    fn cut_after(&mut self, read: &[u8]) -> Result<(), FolderError> {
        let whole = read.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        self.file.set_len(whole as u64).map_err(|cause| self.error(cause))
    }

    fn error(&self, cause: io::Error) -> FolderError {
        error(&self.part, cause)
    }
}

impl Drop for SweepFile {
    fn drop(&mut self) {
        self.keep();
    }
}

/// Refuses rows of another sweep, or of another share of it.
fn check_same(there: &SweepRows, own: &SweepIdentity, header: &str) -> Result<(), TableError> {
    let place = Place { file: &there.name, line: Some(1) };
    there.identity.check_same(own, place, "this sweep has it")?;
    let (found, must) = (there.identity.shard(), own.shard());
    if found != must {
        return Err(place.refuse("shard", found.to_string(), format!("must be {must}")));
    }
    if there.header != header.trim_end() {
        let must = format!("must be {}", quoted(header.trim_end()));
        return Err(Place { line: Some(2), ..place }.refuse(
            "columns",
            quoted(&there.header),
            must,
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::sweep_identity::identity_of;
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
        let mut file = SweepFile::begin(&path, identity("1,2,3", "1/1"), HEADER).unwrap();
        file.append("1,,\n").unwrap();
        file.append("2,").unwrap();
        drop(file);
        assert!(!path.exists());
        let left = |values| SweepFile::left(&path, &identity(values, "1/1"), HEADER);
        assert_eq!(left("1,2,3"), Some(LeftRows::Own(1)));
        assert_eq!(left("1,2,4"), Some(LeftRows::Other(1)));

        let (mut file, rows) = resumed(&path, identity("1,2,3", "1/1"));
        assert_eq!(rows, 1, "the second row was cut off in writing");
        file.append("2,,\n3,,\n").unwrap();
        file.finish(Durability::InMemory, &|_| {}).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "x,warnings,error\n1,,\n2,,\n3,,\n");
        assert!(!part_of(&path).exists() && path.with_extension("json").exists());
    }

    #[test]
    fn a_finished_shard_keeps_its_first_line_and_is_not_done_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.csv");
        let own = identity("1,2,3", "2/2");
        let mut file = SweepFile::begin(&path, own.clone(), HEADER).unwrap();
        file.append("2,,\n").unwrap();
        file.finish(Durability::InMemory, &|_| {}).unwrap();
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
        // Killed before the first line was written to its end.
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
        let mut file = SweepFile::begin(&path, identity("1,2,3", "1/1"), HEADER).unwrap();
        file.append("1,,\n3,,\n").unwrap();
        drop(file);
        let (error, hint) = refusal(&path, identity("1,2,3", "1/1"));
        let words = "sweep.csv.part:4: x = \"3\", but must be \"2\", the value of case 2";
        assert!(error.ends_with(words), "{error}");
        assert_eq!(hint, "remove the file, or leave --resume out to begin anew");
    }

    #[test]
    fn two_runs_do_not_write_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        let first = SweepFile::begin(&path, identity("1,2", "1/1"), HEADER).unwrap();
        let second = SweepFile::begin(&path, identity("1,2", "1/1"), HEADER).unwrap_err();
        assert!(second.to_string().ends_with("sweep.csv.part: another run is writing it"));
        let text = fs::read_to_string(part_of(&path)).unwrap();
        assert!(text.ends_with(&checked_header(HEADER)), "the first run's rows are untouched");
        drop(first);
        assert!(SweepFile::begin(&path, identity("1,2", "1/1"), HEADER).is_ok());
    }
}
