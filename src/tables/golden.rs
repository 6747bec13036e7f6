use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use super::folder::{FolderAction, FolderError, OutputFolder};
use super::single_file::folder_of;

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
    let mut staged: BTreeMap<PathBuf, OutputFolder> = BTreeMap::new();
    for (name, source) in &changes.written {
        // What a symbolic link leads to is the golden file.
        let path = folder.join(name);
        let path = path.canonicalize().unwrap_or(path);
        let inner = folder_of(&path).to_owned();
        let own = path.file_name().unwrap_or(OsStr::new(name)).to_owned();
        if path.exists() && !path.is_file() {
            let cause = io::Error::other("it is there, and no file");
            let action = FolderAction::Write(own.to_string_lossy().into());
            return Err(FolderError { folder: inner, action, cause });
        }
        let aside = match staged.remove(&inner) {
            Some(aside) => aside,
            None => OutputFolder::stage(&inner)?,
        };
        let aside = staged.entry(inner).or_insert(aside);
        aside.file(own, |out| io::copy(&mut File::open(source)?, out).map(drop))?;
    }
    staged.into_values().try_for_each(OutputFolder::replace)?;
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

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_what_is_no_file_is_left_alone() {
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        fs::write(at("source"), "new").unwrap();
        fs::create_dir(at("golden")).unwrap();
        fs::write(at("real.csv"), "old").unwrap();
        fs::write(at("golden/z.csv"), "old").unwrap();
        std::os::unix::fs::symlink(at("real.csv"), at("golden/a.csv")).unwrap();
        let written = |names: &[&str]| {
            let written = names.iter().map(|name| ((*name).to_owned(), at("source"))).collect();
            change_golden_files(&at("golden"), &GoldenChanges { written, removed: vec![] })
        };
        written(&["a.csv"]).unwrap();
        assert!(at("golden/a.csv").is_symlink());
        assert_eq!(fs::read_to_string(at("real.csv")).unwrap(), "new");
        fs::create_dir(at("golden/b.csv")).unwrap();
        written(&["b.csv", "z.csv"]).unwrap_err();
        assert_eq!(fs::read_to_string(at("golden/z.csv")).unwrap(), "old");
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
