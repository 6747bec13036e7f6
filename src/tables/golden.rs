use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use super::folder::{FolderAction, FolderError, OutputFolder};

/// Changes to a folder of golden files, by their paths from there, with slashes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct GoldenChanges {
    /// Files that take the place of others or are new, and where their content is.
    pub written: BTreeMap<String, PathBuf>,
    /// Files to be removed.
    pub removed: Vec<String>,
}

/// Changes a folder of golden files, which is created where it is missing.
///
/// All files are written aside before the first takes its name.
///
/// # Errors
/// [`FolderError`] names the first file that cannot be written or removed.
pub fn change_golden_files(folder: &Path, changes: &GoldenChanges) -> Result<(), FolderError> {
    let mut staged: BTreeMap<PathBuf, (OutputFolder, String)> = BTreeMap::new();
    for (name, source) in &changes.written {
        let path = folder.join(name);
        let inner = path.parent().filter(|inner| !inner.as_os_str().is_empty());
        let inner = inner.unwrap_or(Path::new(".")).to_owned();
        let own = name.rsplit('/').next().unwrap_or(name);
        if !staged.contains_key(&inner) {
            staged.insert(inner.clone(), (OutputFolder::stage(&inner)?, String::new()));
        }
        if let Some((aside, last)) = staged.get_mut(&inner) {
            aside.file(own, |out| io::copy(&mut File::open(source)?, out).map(drop))?;
            own.clone_into(last);
        }
    }
    for (aside, last) in staged.into_values() {
        aside.commit(&last, &[])?;
    }
    for name in &changes.removed {
        fs::remove_file(folder.join(name)).map_err(|cause| FolderError {
            folder: folder.to_owned(),
            action: FolderAction::Remove(name.clone()),
            cause,
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_written_and_removed_in_folders_of_folders() {
        let base = tempfile::tempdir().unwrap();
        let (golden, source) = (base.path().join("new/golden"), base.path().join("source"));
        fs::write(&source, "content").unwrap();
        let written = ["a.csv", "b/c d/e.csv", "b/f.csv"].map(|n| (n.to_owned(), source.clone()));
        let changes = GoldenChanges { written: written.into(), removed: vec![] };
        change_golden_files(&golden, &changes).unwrap();
        for name in ["a.csv", "b/c d/e.csv", "b/f.csv"] {
            assert_eq!(fs::read_to_string(golden.join(name)).unwrap(), "content");
        }
        let changes = GoldenChanges { removed: vec!["b/f.csv".into()], ..Default::default() };
        change_golden_files(&golden, &changes).unwrap();
        assert!(!golden.join("b/f.csv").exists() && golden.join("b/c d/e.csv").exists());
        let error = change_golden_files(&golden, &changes).unwrap_err();
        assert_eq!(error.action, FolderAction::Remove("b/f.csv".into()));
    }

    #[test]
    fn a_source_that_cannot_be_read_changes_nothing() {
        let base = tempfile::tempdir().unwrap();
        let source = base.path().join("source");
        fs::write(&source, "new").unwrap();
        fs::write(base.path().join("a.csv"), "old").unwrap();
        let written = [("a.csv", source), ("b.csv", base.path().join("none"))];
        let written = written.map(|(name, source)| (name.to_owned(), source)).into();
        let changes = GoldenChanges { written, removed: vec!["a.csv".into()] };
        change_golden_files(base.path(), &changes).unwrap_err();
        assert_eq!(fs::read_to_string(base.path().join("a.csv")).unwrap(), "old");
        assert_eq!(fs::read_dir(base.path()).unwrap().count(), 2);
    }
}
