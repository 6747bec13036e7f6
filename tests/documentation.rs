//! Commands in README and book print what they say, the book's link file is read, and help texts and
//! refusals are as they were read last. A refusal writes nothing.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use flexlink::result::QUANTITIES;
use flexlink::spec::read_specification;
use trycmd::schema::Bin;
use walkdir::WalkDir;

/// Folders of the repository that the commands read.
const INPUTS: [&str; 3] = ["specs", "trajectories", "measurements"];

/// Runs the commands of these files of the repository and compares what they print.
fn run(files: &[&str]) {
    // In what it compares and writes, trycmd shows the backslash that continues a line as a slash.
    let cases = trycmd::TestCases::new();
    // On any machine: letters in UTF-8, lines as wide as this program makes them.
    cases.env("LC_ALL", "C.UTF-8").env("COLUMNS", "100").env("NO_COLOR", "1");
    // What a user does between two commands.
    for program in ["editor", "xdg-open"] {
        cases.register_bin(program, Bin::Ignore);
    }
    for file in files {
        cases.case(repository(file));
    }
}

fn repository(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// All files and folders below a folder; of a file its content.
fn content(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let entries = WalkDir::new(folder).into_iter().map(|entry| entry.unwrap().into_path());
    entries.map(|path| (path.clone(), fs::read(path).ok())).collect()
}

/// The commands run in a folder that holds the inputs alone, or in the folder of their own inputs.
#[test]
fn commands_of_readme_book_help_texts_and_refusals_print_what_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    for name in INPUTS {
        for entry in WalkDir::new(repository(name)) {
            let entry = entry.unwrap();
            let copy = folder.path().join(entry.path().strip_prefix(repository("")).unwrap());
            if entry.file_type().is_dir() {
                fs::create_dir(copy).unwrap();
            } else {
                fs::copy(entry.path(), copy).unwrap();
            }
        }
    }
    env::set_current_dir(folder.path()).unwrap();

    let inputs =
        ["compare.in", "runs.in", "tables.in"].map(|name| repository("tests/refusals").join(name));
    let watched = || inputs.iter().map(|input| content(input)).chain([content(folder.path())]);
    let before: Vec<_> = watched().collect();
    run(&["tests/help/*.trycmd", "tests/refusals/*.trycmd"]);
    for (before, after) in before.iter().zip(watched()) {
        let paths = before.keys().chain(after.keys());
        let changed: Vec<_> = paths.filter(|path| before.get(*path) != after.get(*path)).collect();
        assert!(changed.is_empty(), "a refusal has changed {changed:?}");
    }

    // Pages run side by side: each writes into folders of its own.
    run(&["README.md", "docs/*.md"]);
    // Windows removes no folder that a process is in.
    env::set_current_dir(repository("")).unwrap();
}

#[test]
fn the_book_lists_every_number_of_a_joint() {
    let rows = QUANTITIES.iter().map(|quantity| {
        let key = quantity.limit_key().map(|key| format!("`{key}`")).unwrap_or_default();
        format!("| `{}` | {key} | {} |\n", quantity.column(None), quantity.what)
    });
    let table =
        format!("| number | limit | meaning |\n|---|---|---|\n{}", rows.collect::<String>());
    let page = fs::read_to_string(repository("docs/files.md")).unwrap();
    assert!(page.contains(&table), "docs/files.md lacks this table:\n{table}");
}

#[test]
fn the_link_file_of_the_book_is_read() {
    let page = include_str!("../docs/files.md");
    let (_, rest) = page.split_once("```toml\n").unwrap();
    let (example, _) = rest.split_once("```").unwrap();
    let specification = read_specification("files.md", example, &[]).unwrap();
    assert_eq!(specification.link().segments().len(), 2);
    assert_eq!(specification.link().masses().len(), 1);
    assert!(!specification.mesh().is_automatic());
}
