//! The files of a run held against those of its repetition.

use std::env;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use tempfile::Builder;

use super::super::file_names::{REPORT, RESULT_FILES, SUMMARY};
use super::super::folder::{FolderAction, FolderError};
use super::super::unfinished::{Removal, Unfinished};
use super::record::RunRecord;
use crate::csv::InputError;
use crate::result::{Repeated, RepeatedFile, line_difference};

/// A folder for a run whose files nobody keeps, readable by nobody else. It is removed when it is dropped
/// or the program is ended; if a run is killed, the system removes it some day.
#[derive(Debug)]
pub struct TemporaryFolder(Unfinished);

impl TemporaryFolder {
    /// Creates it where the system keeps such folders.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be created.
    pub fn new() -> Result<Self, FolderError> {
        let base = env::temp_dir();
        let mut builder = Builder::new();
        builder.prefix("flexlink-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = Unfinished::make(Removal::FolderWithFiles, || {
            Ok((builder.tempdir_in(&base)?.keep(), ()))
        });
        let enter = |cause| FolderError { folder: base, action: FolderAction::Enter, cause };
        folder.map(|(folder, ())| Self(folder)).map_err(enter)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 16;

impl RunRecord {
    /// Holds the files of the run against those of its repetition in another folder; what no run
    /// writes, and the page of a run, is left out.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read.
    pub fn compare(&self, repetition: &Path) -> Result<Vec<RepeatedFile>, InputError> {
        let known = RESULT_FILES.into_iter().filter(|name| *name != REPORT).chain([SUMMARY]);
        let is_there = |name: &&str| {
            let folders = [&*self.folder, repetition];
            folders.iter().any(|folder| folder.join(name).symlink_metadata().is_ok())
        };
        let unnamed = |name: &&str| !self.files.iter().any(|file| file == name);
        let unnamed = known.filter(is_there).filter(unnamed);
        let names = self.files.iter().map(String::as_str).chain(unnamed);
        let compared = |name: &str| {
            let (run, repetition) = (self.folder.join(name), repetition.join(name));
            Ok(RepeatedFile { name: name.to_owned(), outcome: compared(&run, &repetition)? })
        };
        names.map(compared).collect()
    }
}

fn compared(run: &Path, repetition: &Path) -> Result<Repeated, InputError> {
    let Some(own) = opened(run)? else { return Ok(Repeated::Missing) };
    let Some(other) = opened(repetition)? else { return Ok(Repeated::Extra) };
    let difference = line_difference(own, other).map_err(|cause| {
        let shown = format!("{} or {}", run.display(), repetition.display());
        InputError::new(shown, cause)
    })?;
    Ok(difference.map_or(Repeated::Same, Repeated::Differs))
}

/// A file in a folder, if it is there.
fn opened(path: &Path) -> Result<Option<BufReader<File>>, InputError> {
    let refused = |cause| InputError::new(path.display().to_string(), cause);
    match path.metadata() {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound && !path.is_symlink() => Ok(None),
        Err(cause) => Err(refused(cause)),
        // It may have no end.
        Ok(found) if !found.is_file() => Err(refused(io::Error::other("it is no file"))),
        Ok(_) => {
            let file = File::open(path).map_err(refused)?;
            Ok(Some(BufReader::with_capacity(CHUNK, file)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_temporary_folder_goes_with_all_that_is_in_it() {
        let folder = TemporaryFolder::new().unwrap();
        let path = folder.path().to_owned();
        fs::write(path.join("torque.csv"), "0").unwrap();
        drop(folder);
        assert!(!path.exists());
    }

    #[cfg(unix)]
    #[test]
    fn nobody_else_can_read_what_is_in_a_temporary_folder() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = TemporaryFolder::new().unwrap();
        let mode = folder.path().metadata().unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o700);
    }
}
