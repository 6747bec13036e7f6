//! The sources, without comments and quoted text.

use std::fs;
use std::path::{Path, PathBuf};

/// The text after each occurrence of `word`, unless the word ends a longer name.
pub(crate) fn names<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = &'a str> {
    let continues = |c: char| c.is_alphanumeric() || c == '_';
    let whole = move |at: &usize| !code[..*at].ends_with(continues);
    let starts = code.match_indices(word).map(|(at, _)| at);
    starts.filter(whole).map(move |at| code[at + word.len()..].trim_start())
}

pub(crate) fn identifier(code: &str) -> String {
    code.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The source without comments and quoted text.
pub(crate) fn without_text(source: &str) -> String {
    let mut code = String::new();
    let mut rest = source;
    while let Some(c) = rest.chars().next() {
        let skipped = match c {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            'r' if !code.ends_with(|c: char| c.is_alphanumeric() || c == '_') => raw_string(rest),
            '"' => quoted(rest),
            '\'' => character(rest),
            _ => 0,
        };
        if skipped == 0 {
            code.push(c);
            rest = &rest[c.len_utf8()..];
        } else {
            code.push(' ');
            rest = &rest[skipped..];
        }
    }
    code
}

/// Length of the string at the start of `code`, quotes included.
fn quoted(code: &str) -> usize {
    let mut escaped = true;
    let end = code.char_indices().find(|(_, c)| {
        let ends = *c == '"' && !escaped;
        // The opening quote counts as escaped.
        escaped = *c == '\\' && !escaped;
        ends
    });
    end.map_or(code.len(), |(at, _)| at + 1)
}

/// Length of the raw string at the start of `code`, 0 for anything else that begins with r.
fn raw_string(code: &str) -> usize {
    let hashes = code[1..].chars().take_while(|c| *c == '#').count();
    let inner = &code[1 + hashes..];
    if !inner.starts_with('"') {
        return 0;
    }
    let end = format!("\"{}", "#".repeat(hashes));
    inner[1..].find(&end).map_or(code.len(), |at| 1 + hashes + 1 + at + end.len())
}

/// Length of the character literal at the start of `code`, 0 for a lifetime.
fn character(code: &str) -> usize {
    let mut inner = code[1..].char_indices();
    match inner.next() {
        Some((_, '\\')) => code[3..].find('\'').map_or(0, |at| at + 4),
        Some((_, c)) if code[1 + c.len_utf8()..].starts_with('\'') => c.len_utf8() + 2,
        _ => 0,
    }
}

/// Names of the modules in a file's path: `["mechanics", "beam", "mesh"]` for mechanics/beam/mesh.rs, `["mechanics",
/// "beam"]` for mechanics/beam/mod.rs, empty for the root of the library.
pub(crate) fn module(path: &Path) -> Vec<String> {
    let names = path.with_extension("");
    let names = names.iter().map(|name| name.to_string_lossy().into_owned());
    names.filter(|name| name != "mod" && name != "lib").collect()
}

/// Every source file of a library below `folder`, with its path from there.
pub(crate) fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut folders = vec![root.clone()];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the sources") {
            let path = entry.expect("an entry of the folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let source = fs::read_to_string(&path).expect("a source in UTF-8");
                found
                    .push((path.strip_prefix(&root).expect("a path below src").to_owned(), source));
            }
        }
    }
    found
}
