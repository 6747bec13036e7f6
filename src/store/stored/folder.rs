//! Files in the folder of a run.

use std::path::Path;

use super::super::summary::A_RUN;
use crate::csv::{InputError, InputFile, Place, TableError, quoted};
use crate::numeric::is_hidden;

/// The folder of one run.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunFolder<'a> {
    path: &'a Path,
}

impl<'a> RunFolder<'a> {
    pub(super) fn new(path: &'a Path) -> Self {
        Self { path }
    }

    /// Reads a file that every run has.
    pub(super) fn file(&self, name: &str) -> Result<InputFile, TableError> {
        if !self.has(name) {
            return Err(self.refuse(name, "nothing", &format!("must be there: {A_RUN}")));
        }
        let path = self.path.join(name);
        // A pipe in a folder, unlike one that a command line names, may have no end.
        if !path.is_file() && !path.is_dir() {
            return Err(self.refuse(name, "a device or a pipe", "must be a file"));
        }
        InputFile::read(&path).map_err(|error| unreadable(&error))
    }

    /// Reads a file that some runs have.
    pub(super) fn optional(&self, name: &str) -> Result<Option<InputFile>, TableError> {
        self.has(name).then(|| self.file(name)).transpose()
    }

    /// Refuses a folder in which one of the files is missing that its summary names.
    pub(super) fn check_named(&self, names: &[String]) -> Result<(), TableError> {
        let shown = self.path.display().to_string();
        check_names("files", names, Place { file: &shown, line: None })?;
        for name in names {
            if !self.has(name) {
                return Err(self.refuse(name, "nothing", "must be there: summary.json names it"));
            }
        }
        Ok(())
    }

    fn has(&self, name: &str) -> bool {
        self.path.join(name).exists()
    }

    fn refuse(&self, subject: &str, found: &str, must: &str) -> TableError {
        let shown = self.path.display().to_string();
        Place { file: &shown, line: None }.refuse(subject, found, must)
    }
}

/// Bytes of the longest file name.
const LONGEST_NAME: usize = 255;

/// Refuses names that lead into a folder.
pub(super) fn check_names(subject: &str, names: &[String], place: Place) -> Result<(), TableError> {
    let leads = |name: &String| Path::new(name).file_name().is_none_or(|own| own != name.as_str());
    let is_short = |name: &String| name.len() <= LONGEST_NAME;
    let is_visible = |name: &String| !name.contains(is_hidden);
    match names.iter().find(|name| leads(name) || !is_visible(name) || !is_short(name)) {
        Some(name) => {
            let must = "must be names, without folders or control characters";
            Err(place.refuse(subject, quoted(name), must))
        }
        None => Ok(()),
    }
}

/// The error of a file that cannot be read, as that of one that is refused.
pub(super) fn unreadable(error: &InputError) -> TableError {
    let text = error.to_string();
    let (file, message) = text.split_once(": ").unwrap_or(("", &text));
    Place { file, line: None }
        .refuse_whole(message.to_owned())
        .with_hint(error.hint().map(str::to_owned))
}
