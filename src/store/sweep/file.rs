//! The file of a sweep while its rows come.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use super::super::folder::{Durability, FolderAction, FolderError, folder_of};
use super::super::lock::lock;
use super::super::unfinished::{Removal, Unfinished};
use super::identity::SweepIdentity;
use super::record::{part_of, write_sweep};
use crate::csv::{checked_header, checked_rows, without_checks};

/// The file of a sweep while its rows come: `sweep.csv.part` beside `sweep.csv`.
///
/// It holds whole rows at every moment, so that an interrupted sweep can go on; it takes its own
/// name when the last row is there. Its first line is its [`SweepIdentity`], which shards keep.
#[derive(Debug)]
pub struct SweepFile {
    path: PathBuf,
    part: PathBuf,
    // Locked: no other run writes the part while this one goes on.
    pub(super) file: File,
    identity: SweepIdentity,
    /// Until the first row is there: then the part is kept, however the program ends.
    unfinished: Option<Unfinished>,
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
        // The lock is held until the part is gone, so that no other run goes on with it.
        fs::remove_file(&self.part).map_err(|cause| self.error(cause))
    }

    /// The file that holds the rows until they are complete.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Opens the part of a table for this run alone.
    pub(super) fn open(table: &Path, identity: SweepIdentity) -> Result<Self, FolderError> {
        let part = part_of(table);
        let folder = folder_of(table);
        fs::create_dir_all(folder).map_err(|cause| FolderError {
            folder: folder.to_owned(),
            action: FolderAction::Create,
            cause,
        })?;
        if table.is_dir() || table.file_name().is_none() {
            return Err(FolderError::of_file(table, io::Error::other("a folder is no file")));
        }
        // Who may write beside the table must not have another file cut off by this.
        if part.is_symlink() {
            return Err(FolderError::of_file(&part, io::Error::other("it is a symbolic link")));
        }
        let refused = |cause| FolderError::of_file(&part, cause);
        let file = OpenOptions::new().create(true).append(true).open(&part).map_err(refused)?;
        lock(&file, &part).map_err(|cause| match cause.kind() {
            io::ErrorKind::WouldBlock => refused(io::Error::other("another run is writing it")),
            _ => refused(cause),
        })?;
        Ok(Self { path: table.to_owned(), part, file, identity, unfinished: None })
    }

    pub(super) fn error(&self, cause: io::Error) -> FolderError {
        FolderError::of_file(&self.part, cause)
    }
}

impl Drop for SweepFile {
    fn drop(&mut self) {
        self.keep();
    }
}

#[cfg(test)]
mod tests {
    use super::super::identity::identity_of;
    use super::*;

    fn identity() -> SweepIdentity {
        identity_of("link", &[], "x=1,2", "1/1")
    }

    #[test]
    fn a_folder_is_no_file_for_a_sweep() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("..")] {
            let error = SweepFile::open(&path, identity()).unwrap_err();
            assert!(error.to_string().ends_with("a folder is no file"), "{error}");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn two_runs_do_not_write_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.csv");
        let first = SweepFile::begin(&path, identity(), "x,warnings,error\n").unwrap();
        let second = SweepFile::begin(&path, identity(), "x,warnings,error\n").unwrap_err();
        assert!(second.to_string().ends_with("sweep.csv.part: another run is writing it"));
        let text = fs::read_to_string(part_of(&path)).unwrap();
        assert!(
            text.ends_with(&checked_header("x,warnings,error\n")),
            "the first run's rows are untouched"
        );
        drop(first);
        assert!(SweepFile::begin(&path, identity(), "x,warnings,error\n").is_ok());
    }
}
