use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use crate::csv::InputError;

/// The files of a folder and of the folders in it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CsvFolder {
    /// Every file whose name ends in `.csv`: its path from the folder, with slashes, and its path
    /// as it is opened.
    pub tables: BTreeMap<String, PathBuf>,
    /// The paths of all other files from the folder, with slashes.
    pub others: BTreeSet<String>,
}

impl CsvFolder {
    /// Lists a folder; links are followed. One that leads nowhere is a file like others if it is not
    /// called as a table, or is an editor's lock, `.#torque.csv`.
    ///
    /// # Errors
    /// [`InputError`] if the folder, or one in it, cannot be read or leads back to itself.
    pub fn list(folder: &Path) -> Result<Self, InputError> {
        let mut found = Self::default();
        for entry in WalkDir::new(folder).min_depth(1).follow_links(true) {
            let entry = match entry {
                Ok(entry) => entry,
                Err(error) => match stray_link(&error) {
                    Some(path) => {
                        found.others.insert(name_within(folder, path));
                        continue;
                    }
                    None => return Err(unlisted(folder, error)),
                },
            };
            if entry.file_type().is_dir() {
                continue;
            }
            let path = entry.path();
            let name = name_within(folder, path);
            if !is_csv(path) {
                found.others.insert(name);
                continue;
            }
            let refuse = |why| {
                let cause = io::Error::other(why);
                Err(InputError::new(path.display().to_string(), cause))
            };
            // Two names may be one in UTF-8.
            if path.strip_prefix(folder).unwrap_or(path).to_str().is_none() {
                return refuse("its name is not UTF-8");
            }
            // It may have no end.
            if !entry.file_type().is_file() {
                return refuse("it is a device or a pipe");
            }
            found.tables.insert(name, entry.into_path());
        }
        Ok(found)
    }
}

fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// A path from the folder, with slashes.
fn name_within(folder: &Path, path: &Path) -> String {
    let inner = path.strip_prefix(folder).unwrap_or(path);
    inner.iter().map(|step| step.to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// The link that an error is about, if it leads nowhere and is no table.
fn stray_link(error: &walkdir::Error) -> Option<&Path> {
    let path = error.path()?;
    let is_dangling = || error.io_error().is_some_and(|e| e.kind() == io::ErrorKind::NotFound);
    let is_lock = || path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".#"));
    (path.is_symlink() && is_dangling() && (!is_csv(path) || is_lock())).then_some(path)
}

fn unlisted(folder: &Path, error: walkdir::Error) -> InputError {
    let shown = error.path().unwrap_or(folder).display().to_string();
    let circle = || io::Error::other("the folder leads back to itself");
    InputError::new(shown, error.into_io_error().unwrap_or_else(circle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn tables_are_found_in_folders_of_folders() {
        let base = tempfile::tempdir().unwrap();
        fs::create_dir_all(base.path().join("a b/c.csv")).unwrap();
        for name in ["z.csv", "a b/c.csv/x.CSV", "a b/csv", "summary.json"] {
            fs::write(base.path().join(name), "").unwrap();
        }
        let found = CsvFolder::list(base.path()).unwrap();
        assert_eq!(found.tables.keys().collect::<Vec<_>>(), ["a b/c.csv/x.CSV", "z.csv"]);
        assert_eq!(found.others.iter().collect::<Vec<_>>(), ["a b/csv", "summary.json"]);
        assert_eq!(found.tables["z.csv"], base.path().join("z.csv"));
    }

    #[test]
    fn a_folder_that_is_not_there_is_told_in_the_systems_words() {
        let error = CsvFolder::list(Path::new("no/such")).unwrap_err();
        assert_eq!(error.to_string(), "no/such: cannot read: No such file or directory");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_name_that_is_no_utf8_is_refused() {
        use std::os::unix::ffi::OsStrExt as _;
        let base = tempfile::tempdir().unwrap();
        fs::write(base.path().join(std::ffi::OsStr::from_bytes(b"a\xfe.csv")), "").unwrap();
        let error = CsvFolder::list(base.path()).unwrap_err().to_string();
        assert!(error.ends_with(": cannot read: its name is not UTF-8"), "{error}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_no_table_may_lead_nowhere_and_have_any_name() {
        use std::os::unix::ffi::OsStrExt as _;
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        fs::write(at("a.csv"), "").unwrap();
        for lock in [".#notes.txt", ".#a.csv", "old.txt"] {
            std::os::unix::fs::symlink("me@host.123:456", at(lock)).unwrap();
        }
        fs::write(base.path().join(std::ffi::OsStr::from_bytes(b"caf\xe9.txt")), "").unwrap();
        let found = CsvFolder::list(base.path()).unwrap();
        assert_eq!(found.tables.keys().collect::<Vec<_>>(), ["a.csv"]);
        assert_eq!(found.others.len(), 4);
        std::os::unix::fs::symlink("nowhere", at("b.csv")).unwrap();
        let error = CsvFolder::list(base.path()).unwrap_err().to_string();
        assert!(error.ends_with("b.csv: cannot read: No such file or directory"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_leads_back_to_itself_is_refused() {
        let base = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(base.path(), base.path().join("again")).unwrap();
        let error = CsvFolder::list(base.path()).unwrap_err().to_string();
        assert!(error.ends_with("again: cannot read: the folder leads back to itself"), "{error}");
    }
}
