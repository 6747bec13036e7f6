use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile, TempPath};

use super::folder_error::{FolderAction, FolderError};

/// A folder that receives all files of a run, or none.
///
/// Every file is written aside, under a name that begins with a dot, and takes its own name only in
/// [`commit`](Self::commit). Dropped without it, the folder is left as it was found.
#[derive(Debug)]
pub struct OutputFolder {
    dir: PathBuf,
    staged: Vec<(OsString, TempPath)>,
    /// Folders that were not there before, the innermost first.
    created: Vec<PathBuf>,
}

impl OutputFolder {
    /// Opens `dir` for a run's files, creating it and the folders above it where they are missing.
    ///
    /// # Errors
    /// [`FolderError`] if the folder cannot be created.
    pub fn stage(dir: &Path) -> Result<Self, FolderError> {
        let missing = dir.ancestors().take_while(|dir| {
            let named = !dir.as_os_str().is_empty();
            named && !dir.exists()
        });
        let folder = Self {
            dir: dir.to_owned(),
            staged: Vec::new(),
            created: missing.map(Path::to_owned).collect(),
        };
        fs::create_dir_all(dir).map_err(|cause| folder.error(FolderAction::Create, cause))?;
        Ok(folder)
    }

    /// Writes one file aside; `write` receives a buffered writer.
    ///
    /// # Errors
    /// [`FolderError`] if the file cannot be created or `write` fails.
    pub fn file(
        &mut self,
        name: impl AsRef<OsStr>,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<(), FolderError> {
        let name = name.as_ref();
        let path = write_aside(&self.dir, name, write)
            .map_err(|cause| self.error(FolderAction::Write(lossy(name)), cause))?;
        self.staged.push((name.to_owned(), path));
        Ok(())
    }

    /// Gives all files their names, the file `last` after all others.
    ///
    /// `owned` are the names that this program may write: those which an earlier run left and this
    /// one does not write are removed, so that a folder holds one run. An earlier file `last` goes
    /// first of all: who sees it, sees a whole run.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be removed or written; no file `last` is
    /// there then.
    pub fn commit(mut self, last: impl AsRef<OsStr>, owned: &[&str]) -> Result<(), FolderError> {
        let last = last.as_ref();
        self.remove(last)?;
        for name in owned.iter().map(OsStr::new) {
            if self.staged.iter().all(|(staged, _)| staged != name) {
                self.remove(name)?;
            }
        }
        let mut staged = std::mem::take(&mut self.staged);
        staged.sort_by_key(|(name, _)| name == last);
        for (name, path) in staged {
            path.persist(self.dir.join(&name))
                .map_err(|refused| self.error(FolderAction::Write(lossy(&name)), refused.error))?;
        }
        self.created.clear();
        Ok(())
    }

    /// Gives all files their names in the place of those that have them: at no moment is a name
    /// without a whole file, and each keeps the permissions of the one before it.
    ///
    /// # Errors
    /// [`FolderError`] names the first file that cannot be written; where a folder has its name, no
    /// file is changed.
    pub fn replace(mut self) -> Result<(), FolderError> {
        let in_the_way = self.staged.iter().find(|(name, _)| self.dir.join(name).is_dir());
        if let Some((name, _)) = in_the_way {
            let cause = io::Error::other("a folder has this name");
            return Err(self.error(FolderAction::Write(lossy(name)), cause));
        }
        for (name, path) in std::mem::take(&mut self.staged) {
            let target = self.dir.join(&name);
            // On a file system without permissions there are none to keep.
            let _ = fs::metadata(&target).map(|old| fs::set_permissions(&path, old.permissions()));
            path.persist(target)
                .map_err(|refused| self.error(FolderAction::Write(lossy(&name)), refused.error))?;
        }
        self.created.clear();
        Ok(())
    }

    fn remove(&self, name: &OsStr) -> Result<(), FolderError> {
        match fs::remove_file(self.dir.join(name)) {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => {
                Err(self.error(FolderAction::Remove(lossy(name)), cause))
            }
            _ => Ok(()),
        }
    }

    fn error(&self, action: FolderAction, cause: io::Error) -> FolderError {
        FolderError { folder: self.dir.clone(), action, cause }
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // The files first: a folder goes only when it is empty.
        self.staged.clear();
        for dir in &self.created {
            // Someone else's file may be there by now; then the folder stays, rightly.
            let _ = fs::remove_dir(dir);
        }
    }
}

/// A name as a message tells it.
fn lossy(name: &OsStr) -> String {
    name.to_string_lossy().into_owned()
}

/// Writes a temporary file in `dir`, with the permissions of an ordinary one.
fn write_aside(
    dir: &Path,
    name: &OsStr,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<TempPath> {
    let prefix: OsString = [OsStr::new("."), name, OsStr::new(".")].into_iter().collect();
    let file = ordinary_file(Builder::new().prefix(&prefix), dir)?;
    let mut buffered = BufWriter::with_capacity(1 << 16, file);
    write(&mut buffered)?;
    let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
    Ok(file.into_temp_path())
}

#[cfg(unix)]
fn ordinary_file(builder: &mut Builder<'_, '_>, dir: &Path) -> io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    // The user's umask takes its share, as of any new file.
    let permissions = fs::Permissions::from_mode(0o666);
    builder.permissions(permissions).tempfile_in(dir)
}

#[cfg(not(unix))]
fn ordinary_file(builder: &mut Builder<'_, '_>, dir: &Path) -> io::Result<NamedTempFile> {
    builder.tempfile_in(dir)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names and contents of a folder, in order.
    fn listing(dir: &Path) -> Vec<(String, String)> {
        let entries = fs::read_dir(dir).unwrap().map(Result::unwrap);
        let mut files: Vec<_> = entries
            .map(|entry| {
                let text = fs::read_to_string(entry.path()).unwrap_or_default();
                (entry.file_name().into_string().unwrap(), text)
            })
            .collect();
        files.sort();
        files
    }

    fn files(expected: &[(&str, &str)]) -> Vec<(String, String)> {
        let owned = |&(name, text): &(&str, &str)| (name.to_owned(), text.to_owned());
        expected.iter().map(owned).collect()
    }

    fn stage_files(dir: &Path, files: &[(&str, &str)]) -> OutputFolder {
        let mut folder = OutputFolder::stage(dir).unwrap();
        for (name, text) in files {
            folder.file(name, |w| w.write_all(text.as_bytes())).unwrap();
        }
        folder
    }

    const OWNED: [&str; 3] = ["torque.csv", "nodes.csv", "summary.json"];

    #[test]
    fn a_second_run_replaces_the_first_and_nothing_else() {
        let base = tempfile::tempdir().unwrap();
        let dir = base.path().join("a/b");
        let first = [("summary.json", "1"), ("torque.csv", "1"), ("nodes.csv", "1")];
        let folder = stage_files(&dir, &first);
        folder.commit("summary.json", &OWNED).unwrap();
        fs::write(dir.join("notes.txt"), "mine").unwrap();

        let second = [("summary.json", "2"), ("torque.csv", "2")];
        let folder = stage_files(&dir, &second);
        assert_eq!(fs::read_to_string(dir.join("torque.csv")).unwrap(), "1");
        folder.commit("summary.json", &OWNED).unwrap();
        let expected = [("notes.txt", "mine"), ("summary.json", "2"), ("torque.csv", "2")];
        assert_eq!(listing(&dir), files(&expected));
    }

    #[test]
    fn a_failing_writer_leaves_the_folder_as_it_was() {
        let base = tempfile::tempdir().unwrap();
        let dir = base.path();
        fs::write(dir.join("torque.csv"), "old").unwrap();
        let mut folder = stage_files(dir, &[("nodes.csv", "new")]);
        let error = folder
            .file("torque.csv", |w| {
                w.write_all(b"half a ta")?;
                Err(io::Error::from_raw_os_error(28))
            })
            .unwrap_err();
        // Number 28 means another thing on Windows.
        let words = io::Error::from_raw_os_error(28).to_string().replace(" (os error 28)", "");
        let expected = format!("{}: cannot write torque.csv: {words}", dir.display());
        assert_eq!(error.to_string(), expected);
        drop(folder);
        assert_eq!(listing(dir), files(&[("torque.csv", "old")]));
    }

    #[test]
    fn a_dropped_run_takes_the_folders_it_created_with_it() {
        let base = tempfile::tempdir().unwrap();
        drop(stage_files(&base.path().join("a/b"), &[("torque.csv", "1")]));
        assert_eq!(listing(base.path()), []);
    }

    #[test]
    fn a_file_that_cannot_take_its_name_leaves_no_summary() {
        let base = tempfile::tempdir().unwrap();
        let dir = base.path();
        fs::create_dir(dir.join("torque.csv")).unwrap();
        fs::write(dir.join("summary.json"), "old").unwrap();
        let folder = stage_files(dir, &[("summary.json", "2"), ("torque.csv", "2")]);
        let error = folder.commit("summary.json", &OWNED).unwrap_err();
        assert_eq!(error.action, FolderAction::Write("torque.csv".to_owned()));
        assert_eq!(listing(dir), files(&[("torque.csv", "")]));
    }

    #[test]
    fn replaced_files_are_there_at_every_moment() {
        let base = tempfile::tempdir().unwrap();
        let dir = base.path();
        fs::create_dir(dir.join("b.csv")).unwrap();
        fs::write(dir.join("z.csv"), "old").unwrap();
        let folder = stage_files(dir, &[("z.csv", "new"), ("b.csv", "new")]);
        let error = folder.replace().unwrap_err();
        assert_eq!(error.action, FolderAction::Write("b.csv".to_owned()));
        assert_eq!(listing(dir), files(&[("b.csv", ""), ("z.csv", "old")]));
        stage_files(dir, &[("z.csv", "new")]).replace().unwrap();
        assert_eq!(listing(dir), files(&[("b.csv", ""), ("z.csv", "new")]));
    }

    #[cfg(unix)]
    #[test]
    fn a_replaced_file_keeps_its_permissions() {
        use std::os::unix::fs::PermissionsExt as _;
        let base = tempfile::tempdir().unwrap();
        let path = base.path().join("torque.csv");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        stage_files(base.path(), &[("torque.csv", "new")]).replace().unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[test]
    fn a_file_in_the_place_of_the_folder_is_refused() {
        let base = tempfile::tempdir().unwrap();
        let dir = base.path().join("out");
        fs::write(&dir, "a file").unwrap();
        let error = OutputFolder::stage(&dir).unwrap_err();
        assert_eq!(error.action, FolderAction::Create);
        assert_eq!(fs::read_to_string(&dir).unwrap(), "a file");
    }

    #[cfg(unix)]
    #[test]
    fn files_have_the_permissions_of_ordinary_ones() {
        use std::os::unix::fs::PermissionsExt as _;
        let base = tempfile::tempdir().unwrap();
        let dir = base.path();
        fs::write(dir.join("ordinary"), "").unwrap();
        let folder = stage_files(dir, &[("summary.json", "{}")]);
        folder.commit("summary.json", &[]).unwrap();
        let mode = |name| fs::metadata(dir.join(name)).unwrap().permissions().mode();
        assert_eq!(mode("summary.json"), mode("ordinary"));
    }
}
