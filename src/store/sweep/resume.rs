//! A sweep that goes on where an interrupted run ended.

use std::fs;
use std::path::Path;

use super::super::folder::FolderError;
use super::file::SweepFile;
use super::identity::SweepIdentity;
use super::record::part_of;
use super::rows::SweepRows;
use crate::csv::{Place, TableError};

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
    /// Goes on with the rows that an interrupted run left, or begins if it left none.
    ///
    /// # Errors
    /// The outer ones as [`SweepFile::begin`]; the inner ones for rows of another sweep.
    pub fn resume(
        path: &Path,
        identity: SweepIdentity,
        header: &str,
    ) -> Result<Result<Resumed, TableError>, FolderError> {
        let anew =
            |identity: SweepIdentity| Ok(Ok(Resumed::Anew(Self::begin(path, identity, header)?)));
        let part = part_of(path);
        let is_part = part.exists();
        // The file of a finished shard names its sweep; the table of a finished sweep does not.
        if !is_part && (identity.shard().of() == 1 || !path.exists()) {
            return anew(identity);
        }
        let shown = if is_part { part.as_path() } else { path };
        let file = is_part.then(|| Self::open(path, identity.clone())).transpose()?;
        let read = fs::read(shown).map_err(|cause| FolderError::of_file(shown, cause))?;
        let line_ends = read.split(|byte| *byte == b'\n').count() - 1;
        if is_part && line_ends < 2 {
            // The run was killed before it had written the first two lines.
            drop(file);
            return anew(identity);
        }
        let there = SweepRows::read(&shown.display().to_string(), &read)
            .and_then(|there| check_same(&there, &identity, header).map(|()| there));
        let there = match there {
            Ok(there) => there,
            Err(error) => {
                let hint = "remove the file, or leave --resume out to begin anew";
                return Ok(Err(error.with_hint(hint.to_owned())));
            }
        };
        match file {
            Some(file) => {
                // Without a row that was cut off in writing.
                let whole = read.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
                file.file.set_len(whole as u64).map_err(|cause| file.error(cause))?;
                Ok(Ok(Resumed::At(file, there)))
            }
            None if there.len() == identity.rows() => Ok(Ok(Resumed::Complete(there))),
            None => anew(identity),
        }
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
}

/// Refuses rows of another sweep, or of another share of it.
fn check_same(there: &SweepRows, own: &SweepIdentity, header: &str) -> Result<(), TableError> {
    there.check_same(own, header.trim_end(), "this sweep has it")?;
    let (found, must) = (there.identity.shard(), own.shard());
    if found == must {
        return Ok(());
    }
    let place = Place { file: &there.name, line: Some(1) };
    Err(place.refuse("shard", found.to_string(), format!("must be {must}")))
}

#[cfg(test)]
mod tests {
    use super::super::super::folder::Durability;
    use super::super::identity::identity_of;
    use super::*;
    use crate::csv::{checked_header, checked_rows};

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
}
