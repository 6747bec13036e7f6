//! Record of a run of `solve` for its repetition: the files that it read, and its files against those of the
//! repetition.

use std::env;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Component, Path, PathBuf};

use tempfile::Builder;

use super::folder::FolderError;
use super::json::unreadable;
use super::lock::Unfinished;
use super::names::{REPORT, SUMMARY, result_files};
use super::read_tables::{RunFolder, check_names};
use super::summary::Summary;
use crate::csv::{InputError, InputFile, Place, TableError, quoted};
use crate::result::{Origin, Repeated, RepeatedFile, line_difference};
use crate::text::{excerpt, path_in_shell};

/// Bytes in one read.
const CHUNK: usize = 1 << 16;

/// Record in summary.json that suffices to run `solve` again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunRecord {
    /// Origin of the run, with its arguments.
    pub origin: Origin,
    /// Name of summary.json in messages.
    pub shown: String,
    /// The arguments of its torque table; empty without one.
    pub table_arguments: Vec<String>,
    folder: PathBuf,
    /// Names of the written files.
    files: Vec<String>,
}

impl RunRecord {
    /// Reads the record in a folder.
    ///
    /// # Errors
    /// [`TableError`] for a folder without a run of `solve`, or a damaged record.
    pub fn read(folder: &Path) -> Result<Self, TableError> {
        let hint =
            "--repeat takes the folder of a run of `solve`, or of a case of `sweep --outputs`";
        let file = RunFolder(folder).file(SUMMARY);
        let file = file.map_err(|error| error.or_hint(hint.to_owned()))?;
        let place = Place { file: &file.shown, line: None };
        let summary = Summary::read(&file)?;
        if summary.command != "solve" {
            let refused = place.refuse("command", quoted(&summary.command), "must be \"solve\"");
            return Err(refused.or_hint(hint.to_owned()));
        }
        let origin = summary.origin();
        check_names("files", &summary.files, place)?;
        let inputs: Vec<String> = origin.inputs.iter().map(|input| input.name.clone()).collect();
        check_names("inputs", &inputs, place)?;
        let table_arguments = summary.table_arguments();
        let (folder, files) = (folder.to_owned(), summary.files);
        Ok(Self { origin, shown: file.shown.clone(), table_arguments, folder, files })
    }

    /// Finds an input file of the run, its `link` or `motion`, and its path. It is the file `given`, or a file of the
    /// recorded name in the current folder, in the run's folder or in the one above it. The file must have the
    /// recorded bytes and name.
    ///
    /// # Errors
    /// [`TableError`] if there is no such file, or its bytes differ.
    pub fn input(
        &self,
        role: &str,
        given: Option<&Path>,
    ) -> Result<(PathBuf, InputFile), TableError> {
        let Some(input) = self.origin.inputs.iter().find(|input| input.role == role) else {
            let hint = "a program wrote this run without input files: it must run it again itself";
            let error = self.place().refuse_whole(&format!("inputs.{role} is missing"));
            return Err(error.with_hint(hint.to_owned()));
        };
        let candidates = match given {
            Some(path) => vec![path.to_owned()],
            None => self.candidates(role, &input.name)?,
        };
        let mut others = Vec::new();
        for path in candidates {
            let mut file = match InputFile::read(&path) {
                Ok(file) => file,
                Err(error) if given.is_some() => return Err(unreadable(&error)),
                // Another folder may have the right file.
                Err(error) => {
                    others.push(error.to_string());
                    continue;
                }
            };
            let sha256 = file.sha256();
            if sha256 == input.sha256 {
                file.name.clone_from(&input.name);
                return Ok((path, file));
            }
            others.push(format!("{} has SHA-256 {sha256}", file.shown));
        }
        // 64 digits, unless someone has changed the record.
        let sha256 = input.sha256.as_str();
        let expected = if sha256.len() == 64 { sha256.into() } else { excerpt(sha256) };
        let message = format!("{}, but must have SHA-256 {expected}", others.join(", "));
        let (role, give) = (role.to_uppercase(), self.give());
        let hint = format!("{role} has changed since the run, or is another file; {give}");
        Err(self.place().refuse_whole(&message).with_hint(hint))
    }

    /// Compares the files of the run with those of its repetition in another folder, without its page and files that
    /// no run writes.
    ///
    /// # Errors
    /// [`InputError`] for an unreadable file.
    pub fn compare(&self, repetition: &Path) -> Result<Vec<RepeatedFile>, InputError> {
        let known = result_files().into_iter().filter(|name| *name != REPORT).chain([SUMMARY]);
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

    /// Path of summary.json.
    pub fn path(&self) -> PathBuf {
        self.folder.join(SUMMARY)
    }

    /// Paths of a file of this name in all possible folders.
    fn candidates(&self, role: &str, name: &str) -> Result<Vec<PathBuf>, TableError> {
        let what = format!("inputs.{role}");
        if name == "-" {
            let must = "must be given again";
            return Err(self.place().refuse(what, "standard input", must).with_hint(self.give()));
        }
        // The current folder has no name.
        let real = |folder: &Path| Path::new(".").join(folder).canonicalize().ok();
        let mut folders: Vec<PathBuf> = Vec::new();
        for folder in [PathBuf::new(), self.folder.clone(), above(&self.folder)] {
            let own = real(&folder);
            if own.is_none() || !folders.iter().any(|other| real(other) == own) {
                folders.push(folder);
            }
        }
        let found = folders.iter().map(|folder| folder.join(name)).filter(|path| path.is_file());
        let found: Vec<PathBuf> = found.collect();
        if found.is_empty() {
            let shown = folders.iter().map(|folder| match folder.display().to_string() {
                unnamed if unnamed.is_empty() => ".".to_owned(),
                shown => shown,
            });
            let shown = shown.collect::<Vec<_>>().join(", ");
            let must = format!("must be in one of the folders {shown}");
            return Err(self.place().refuse(what, quoted(name), must).with_hint(self.give()));
        }
        Ok(found)
    }

    fn place(&self) -> Place<'_> {
        Place { file: &self.shown, line: None }
    }

    /// Advice for a missing input.
    fn give(&self) -> String {
        let folder = path_in_shell(&self.folder.display().to_string());
        format!("name both: flexlink solve --repeat {folder} LINK MOTION, one of them may be `-`")
    }
}

/// The folder that contains a folder.
fn above(folder: &Path) -> PathBuf {
    match folder.components().next_back() {
        Some(Component::Normal(_)) => folder.parent().map(Path::to_owned).unwrap_or_default(),
        _ => folder.join(".."),
    }
}

/// A temporary folder for a run, readable by its user alone. Its drop or the end of the program removes it; if a run
/// is killed, the system removes it some day.
#[derive(Debug)]
pub struct TemporaryFolder(Unfinished);

impl TemporaryFolder {
    /// Creates it in the system's folder for temporary files.
    ///
    /// # Errors
    /// [`FolderError`] if it cannot be created.
    pub fn new() -> Result<Self, FolderError> {
        let base = env::temp_dir();
        let mut builder = Builder::new();
        builder.prefix("flexlink-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = Unfinished::make(
            |path| std::fs::remove_dir_all(path),
            || Ok((builder.tempdir_in(&base)?.keep(), ())),
        );
        let refused = |cause| FolderError::of_folder(&base, cause);
        folder.map(|(folder, ())| Self(folder)).map_err(refused)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
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

/// A file in a folder, if it exists.
fn opened(path: &Path) -> Result<Option<BufReader<File>>, InputError> {
    let refused = |cause| InputError::new(path.display().to_string(), cause);
    match path.metadata() {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound && !path.is_symlink() => Ok(None),
        Err(cause) => Err(refused(cause)),
        // Anything but a file may be endless.
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
