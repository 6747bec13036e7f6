use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use super::input::InputError;

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
    /// Lists a folder; links are followed.
    ///
    /// # Errors
    /// [`InputError`] if the folder, or one in it, cannot be read or leads back to itself.
    pub fn list(folder: &Path) -> Result<Self, InputError> {
        let mut found = Self::default();
        for entry in WalkDir::new(folder).min_depth(1).follow_links(true) {
            let entry = entry.map_err(|error| {
                let shown = error.path().unwrap_or(folder).display().to_string();
                let circle = || io::Error::other("the folder leads back to itself");
                InputError::new(shown, error.into_io_error().unwrap_or_else(circle))
            })?;
            if entry.file_type().is_dir() {
                continue;
            }
            let path = entry.path();
            let inner = path.strip_prefix(folder).unwrap_or(path);
            let steps: Vec<_> = inner.iter().map(|step| step.to_string_lossy()).collect();
            let name = steps.join("/");
            // Two names may be one in UTF-8.
            if inner.to_str().is_none() {
                let cause = io::Error::other("its name is not UTF-8");
                return Err(InputError::new(path.display().to_string(), cause));
            }
            if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv")) {
                // It may have no end.
                if !entry.file_type().is_file() {
                    let cause = io::Error::other("it is a device or a pipe");
                    return Err(InputError::new(path.display().to_string(), cause));
                }
                found.tables.insert(name, entry.into_path());
            } else {
                found.others.insert(name);
            }
        }
        Ok(found)
    }
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

    #[cfg(unix)]
    #[test]
    fn a_folder_that_leads_back_to_itself_is_refused() {
        let base = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(base.path(), base.path().join("again")).unwrap();
        let error = CsvFolder::list(base.path()).unwrap_err().to_string();
        assert!(error.ends_with("again: cannot read: the folder leads back to itself"), "{error}");
    }
}
