//! Golden files: lists of their folders, changes by `compare --bless`, and a comparison as JSON.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Value, json as object};
use walkdir::WalkDir;

use super::folder::{FolderError, OutputFolder, clear, folder_of, is_aside};
use super::json::json;
use crate::compare::{ColumnComparison, Comparison, FileComparison, FileOutcome, TableComparison};
use crate::csv::InputError;

/// The files of a folder and of the folders in it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CsvFolder {
    /// Every file whose name ends in `.csv`: its path from the folder, with slashes, and its path for opening.
    pub tables: BTreeMap<String, PathBuf>,
    /// The paths of all other files from the folder, with slashes.
    pub others: BTreeSet<String>,
}

impl CsvFolder {
    /// Lists a folder and follows links. A dead link counts as another file, unless its name is that of a table; an
    /// editor's lock, `.#torque.csv`, is not a table.
    ///
    /// # Errors
    /// [`InputError`] if the folder, or one in it, cannot be read or leads back to itself.
    pub fn list(folder: &Path) -> Result<Self, InputError> {
        let mut found = Self::default();
        let entries = WalkDir::new(folder).min_depth(1).follow_links(true).into_iter();
        // Another run may be writing into the folder.
        for entry in entries.filter_entry(|entry| !is_aside(entry.file_name())) {
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
            // Two names may be equal in UTF-8.
            if path.strip_prefix(folder).unwrap_or(path).to_str().is_none() {
                return refuse("its name is not UTF-8");
            }
            // Anything but a file may be endless.
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

/// The path of a dead link that caused an error, if it is not a table.
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

/// Changes to a folder of golden files, by their paths from it, with slashes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct GoldenChanges {
    /// New or replaced files, and the paths of their content.
    pub written: BTreeMap<String, PathBuf>,
    /// Files to be removed.
    pub removed: Vec<String>,
}

/// Changes a folder of golden files, and creates it if it is missing.
///
/// Writes all files aside before the first takes its name, and removes remains of killed runs. If another run writes
/// into the folder for more than a second, the function calls `on_wait` once.
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
        let refused = |cause| FolderError::new(folder, format!("write {name}"), cause);
        let path = real(folder, name).map_err(refused)?;
        let inner = folder_of(&path).to_owned();
        let own = path.file_name().unwrap_or(OsStr::new(name)).to_owned();
        if path.exists() && !path.is_file() {
            let cause = io::Error::other("it is there, and no file");
            return Err(FolderError::of_file(&path, cause));
        }
        let aside = match staged.remove(&inner) {
            Some(aside) => aside,
            None => OutputFolder::stage(&inner, on_wait)?,
        };
        let aside = staged.entry(inner).or_insert(aside);
        aside.file(own, |out| io::copy(&mut File::open(source)?, out).map(drop))?;
    }
    staged.into_values().try_for_each(OutputFolder::replace)?;
    let within = WalkDir::new(folder).into_iter().flatten();
    within.filter(|entry| entry.file_type().is_dir()).for_each(|inner| clear(inner.path()));
    for name in &changes.removed {
        let removed = real(folder, name).and_then(|_| fs::remove_file(folder.join(name)));
        removed.map_err(|cause| FolderError::new(folder, format!("remove {name}"), cause))?;
    }
    Ok(())
}

/// The golden file of a name, through symbolic links within the folder only: a folder from a stranger must not choose
/// other files to write.
fn real(folder: &Path, name: &str) -> io::Result<PathBuf> {
    let (root, real) = (resolved(folder)?, resolved(&folder.join(name))?);
    if real.starts_with(&root) {
        return Ok(real);
    }
    let cause = format!("a symbolic link leads to {}, out of the folder", real.display());
    Err(io::Error::other(cause))
}

/// A path without symbolic links. Parts that do not exist yet stay as they are.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    let path = std::path::absolute(path)?;
    let there = path.ancestors().find_map(|outer| Some((outer, outer.canonicalize().ok()?)));
    let Some((outer, real)) = there else { return Ok(path) };
    Ok(path.strip_prefix(outer).map_or(real.clone(), |rest| real.join(rest)))
}

/// The JSON text of a comparison, and of the changes after it.
///
/// Differences are in the columns' units; infinite or undefined ones are null.
pub fn comparison_json(comparison: &Comparison, blessed: Option<&GoldenChanges>) -> String {
    let changes = |changes: &GoldenChanges| {
        let written: Vec<_> = changes.written.keys().collect();
        object!({ "written": written, "removed": changes.removed })
    };
    let files: Vec<Value> = comparison.files.iter().map(file_values).collect();
    json(&object!({
        "equal": comparison.is_equal(),
        "files": files,
        "not_compared": comparison.not_compared,
        "blessed": blessed.map(changes),
    }))
}

fn file_values(file: &FileComparison) -> Value {
    let (outcome, table) = match &file.outcome {
        FileOutcome::Compared(table) if table.is_equal() => ("equal", Some(table)),
        FileOutcome::Compared(table) => ("different", Some(table)),
        FileOutcome::OnlyExpected(_) => ("only in expected", None),
        FileOutcome::OnlyActual(_) => ("only in actual", None),
    };
    object!({ "file": file.name, "outcome": outcome, "table": table.map(table_values), "inputs": file.inputs })
}

fn table_values(table: &TableComparison) -> Value {
    let columns: Vec<Value> = table.columns.iter().map(column_values).collect();
    object!({
        "matched_by": table.matched_by,
        "rows": table.rows,
        "columns": columns,
        "columns_only_in_expected": table.columns_expected,
        "columns_only_in_actual": table.columns_actual,
        "rows_at_the_ends": table.rows_aside,
        "rows_only_in_expected": table.rows_expected,
        "rows_only_in_actual": table.rows_actual,
    })
}

fn column_values(column: &ColumnComparison) -> Value {
    let outcome = match column.tolerance {
        None => "ignored",
        Some(_) if column.fails() => "beyond",
        Some(_) => "within",
    };
    let worst = column.worst.as_ref().map(|worst| {
        object!({
            "difference": worst.difference,
            "relative_to_peak": column.relative(),
            "expected": worst.expected,
            "actual": worst.actual,
            "expected_field": worst.expected_field,
            "actual_field": worst.actual_field,
        })
    });
    object!({
        "column": column.name,
        "outcome": outcome,
        "peak": column.peak,
        "rtol": column.tolerance.map(|tolerance| tolerance.rtol),
        "atol": column.tolerance.map(|tolerance| tolerance.atol),
        "allowed": column.allowed(),
        "rows_beyond": column.rows_beyond,
        "worst": worst,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(error.action, "remove b/f.csv");
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
