//! Runs among golden files: a folder holds one run, with the summary.json that goes with its tables.

use std::collections::BTreeSet;
use std::path::Path;

use flexlink::csv::{InputError, InputFile};
use flexlink::store::{CsvFolder, GoldenChanges, REPORT, SUMMARY, is_run};

/// Adds to `changes` what keeps each changed folder of EXPECTED that holds a run the folder of one:
/// its tables within tolerance, and summary.json and page, of ACTUAL, or none where it has none.
pub(crate) fn take_whole_runs(
    changes: &mut GoldenChanges,
    expected: &Path,
    actual: &Path,
) -> Result<(), InputError> {
    let names = changes.written.keys().chain(&changes.removed);
    let folders: BTreeSet<String> = names.map(|name| folder_of(name).to_owned()).collect();
    let found = CsvFolder::list(actual)?;
    for folder in folders.iter().filter(|folder| is_run(&expected.join(folder))) {
        let tables = found.tables.iter().filter(|(name, _)| folder_of(name) == *folder);
        for (name, source) in tables.filter(|(name, path)| !is_same(&expected.join(name), path)) {
            changes.written.insert(name.clone(), source.clone());
        }
        for own in [SUMMARY, REPORT] {
            let name = format!("{folder}{own}");
            let source = actual.join(&name);
            match (expected.join(&name).exists(), source.is_file()) {
                (false, _) => {}
                (true, true) => drop(changes.written.insert(name, source)),
                (true, false) => changes.removed.push(name),
            }
        }
    }
    Ok(())
}

/// The folders of a name with slashes, the last slash included.
fn folder_of(name: &str) -> &str {
    &name[..name.rfind('/').map_or(0, |slash| slash + 1)]
}

fn is_same(a: &Path, b: &Path) -> bool {
    matches!((InputFile::read(a), InputFile::read(b)), (Ok(a), Ok(b)) if a.bytes == b.bytes)
}
