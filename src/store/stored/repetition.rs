//! The files of a run held against those of its repetition.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use super::super::histories::{REPORT, RESULT_FILES, SUMMARY};
use super::record::RunRecord;
use crate::csv::InputError;
use crate::result::{Repeated, RepeatedFile, line_difference};

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
