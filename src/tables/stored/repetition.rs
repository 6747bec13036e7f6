//! The files of a run held against those of its repetition.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::super::histories::{REPORT, RESULT_FILES, SUMMARY};
use super::super::input::InputError;
use super::record::RunRecord;
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
            [&*self.folder, repetition].iter().any(|folder| folder.join(name).exists())
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
    if !run.exists() {
        return Ok(Repeated::Missing);
    }
    if !repetition.exists() {
        return Ok(Repeated::Extra);
    }
    let refused = |cause| InputError::new(run.display().to_string(), cause);
    let open = |path| File::open(path).map(|file| BufReader::with_capacity(CHUNK, file));
    let (run, repetition) = (open(run).map_err(refused)?, open(repetition).map_err(refused)?);
    let difference = line_difference(run, repetition).map_err(refused)?;
    Ok(difference.map_or(Repeated::Same, Repeated::Differs))
}
