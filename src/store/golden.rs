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
/// All files are written aside before the first takes its name. If another run writes into it for
/// more than a second, `on_wait` is called once.
///
/// # Errors
/// [`FolderError`] names the first file that cannot be written or removed.
pub fn change_golden_files(
    folder: &Path,
    changes: &GoldenChanges,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    let mut staged: BTreeMap<PathBuf, OutputFolder> = BTreeMap::new();
    for (name, source) in &changes.written {
        let refused = |cause| {
            let action = FolderAction::Write(name.clone());
            FolderError { folder: folder.to_owned(), action, cause }
        };
        let path = real(folder, name).map_err(refused)?;
        let inner = folder_of(&path).to_owned();
        let own = path.file_name().unwrap_or(OsStr::new(name)).to_owned();
        if path.exists() && !path.is_file() {
            let cause = io::Error::other("it is there, and no file");
            let action = FolderAction::Write(own.to_string_lossy().into());
            return Err(FolderError { folder: inner, action, cause });
        }
        let aside = match staged.remove(&inner) {
            Some(aside) => aside,
            None => OutputFolder::stage(&inner, on_wait)?,
        };
        let aside = staged.entry(inner).or_insert(aside);
        aside.file(own, |out| io::copy(&mut File::open(source)?, out).map(drop))?;
    }
    staged.into_values().try_for_each(OutputFolder::replace)?;
    for name in &changes.removed {
        let removed = real(folder, name).and_then(|_| fs::remove_file(folder.join(name)));
        removed.map_err(|cause| FolderError {
            folder: folder.to_owned(),
            action: FolderAction::Remove(name.clone()),
            cause,
        })?;
    }
    Ok(())
}

/// The golden file that a name leads to, through symbolic links within the folder and none out of it:
/// a stranger's folder is not to say what else is written.
fn real(folder: &Path, name: &str) -> io::Result<PathBuf> {
    let (root, real) = (resolved(folder)?, resolved(&folder.join(name))?);
    if real.starts_with(&root) {
        return Ok(real);
    }
    let cause = format!("a symbolic link leads to {}, out of the folder", real.display());
    Err(io::Error::other(cause))
}

/// A path without symbolic links; what is not there yet is none.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    let path = std::path::absolute(path)?;
    let there = path.ancestors().find_map(|outer| Some((outer, outer.canonicalize().ok()?)));
    let Some((outer, real)) = there else { return Ok(path) };
    Ok(path.strip_prefix(outer).map_or(real.clone(), |rest| real.join(rest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(folder: &Path, changes: &GoldenChanges) -> Result<(), FolderError> {
        change_golden_files(folder, changes, &|_| {})
    }

    #[test]
    fn files_are_written_and_removed_in_folders_of_folders() {
        let base = tempfile::tempdir().unwrap();
        let (golden, source) = (base.path().join("new/golden"), base.path().join("source"));
        fs::write(&source, "content").unwrap();
        let written = ["a.csv", "b/c d/e.csv", "b/f.csv"].map(|n| (n.to_owned(), source.clone()));
        let changes = GoldenChanges { written: written.into(), removed: vec![] };
        change(&golden, &changes).unwrap();
        for name in ["a.csv", "b/c d/e.csv", "b/f.csv"] {
            assert_eq!(fs::read_to_string(golden.join(name)).unwrap(), "content");
        }
        let changes = GoldenChanges { removed: vec!["b/f.csv".into()], ..Default::default() };
        change(&golden, &changes).unwrap();
        assert!(!golden.join("b/f.csv").exists() && golden.join("b/c d/e.csv").exists());
        let error = change(&golden, &changes).unwrap_err();
        assert_eq!(error.action, FolderAction::Remove("b/f.csv".into()));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_within_the_folder_and_what_is_no_file_is_left_alone() {
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        fs::write(at("source"), "new").unwrap();
        fs::create_dir(at("golden")).unwrap();
        fs::create_dir(at("other")).unwrap();
        for name in ["golden/real", "golden/z.csv", "other/x.csv"] {
            fs::write(at(name), "old").unwrap();
        }
        let links = [
            ("golden/real", "golden/a.csv"),
            ("other/x.csv", "golden/x.csv"),
            ("other", "golden/sub"),
        ];
        for (target, link) in links {
            std::os::unix::fs::symlink(at(target), at(link)).unwrap();
        }
        let written = |names: &[&str]| {
            let written = names.iter().map(|name| ((*name).to_owned(), at("source"))).collect();
            change(&at("golden"), &GoldenChanges { written, removed: vec![] })
        };
        written(&["a.csv"]).unwrap();
        assert!(at("golden/a.csv").is_symlink());
        assert_eq!(fs::read_to_string(at("golden/real")).unwrap(), "new");
        for name in ["x.csv", "sub/x.csv", "sub/new.csv"] {
            let error = written(&["z.csv", name]).unwrap_err();
            assert!(error.cause.to_string().ends_with(", out of the folder"), "{error}");
        }
        let removed = GoldenChanges { removed: vec!["sub/x.csv".into()], ..Default::default() };
        change(&at("golden"), &removed).unwrap_err();
        assert_eq!(fs::read_to_string(at("other/x.csv")).unwrap(), "old");
        assert!(!at("other/new.csv").exists());
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
        change(base.path(), &changes).unwrap_err();
        assert_eq!(fs::read_to_string(base.path().join("a.csv")).unwrap(), "old");
        assert_eq!(fs::read_dir(base.path()).unwrap().count(), 2);
    }
}
