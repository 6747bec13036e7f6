//! Refusals as they were read last: a file of tests/refusals holds inputs, each below a line of `---`, and
//! behind `>>>` what is said of them. `TRYCMD=overwrite` writes it anew, as the snapshots of commands.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::path::Path;

/// Compares every refusal of a file with what `refusal` returns for its section, the words behind
/// `---` and the input below them.
#[track_caller]
pub(crate) fn compare(name: &str, refusal: impl Fn(&str, &str, &str) -> String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refusals").join(name);
    let expected = fs::read_to_string(&path).unwrap();
    let (mut found, mut cases) = (String::new(), 0);
    let (mut section, mut words, mut input) = ("", "", None::<String>);
    for line in expected.lines() {
        let is_told = line.starts_with(">>>");
        if let Some(rest) = line.strip_prefix("== ") {
            if !section.is_empty() {
                found.push('\n');
            }
            assert!(input.is_none(), "{name}: an input above \"== {rest}\" has no line of >>>");
            section = rest;
        } else if let Some(rest) = line.strip_prefix("---") {
            assert!(input.is_none(), "{name}: the input above \"{line}\" has no line of >>>");
            (words, input) = (rest.trim(), Some(String::new()));
        } else if is_told {
            let input = input.take().unwrap();
            found.extend([">>> ", &refusal(section, words, &input), "\n"]);
            cases += 1;
        } else if let Some(input) = &mut input {
            input.extend([line, "\n"]);
        } else if !section.is_empty() {
            continue; // a hint, or the empty line above a section
        }
        if !is_told {
            found.extend([line, "\n"]);
        }
    }
    assert!(input.is_none(), "{name}: the last input has no line of >>>");
    assert!(cases > 40, "{name}: only {cases} cases");
    if std::env::var_os("TRYCMD").is_some_and(|action| action == "overwrite") {
        fs::write(&path, found).unwrap();
    } else if let Some((old, new)) = expected.lines().zip(found.lines()).find(|(a, b)| a != b) {
        panic!("{name}: {new}\nwas: {old}");
    } else {
        assert_eq!(found.len(), expected.len(), "{name}");
    }
}

/// A refusal and its hint as the program prints them.
pub(crate) fn told(error: &impl ToString, hint: Option<&str>) -> String {
    let hint = hint.map(|hint| format!("\nhint: {hint}")).unwrap_or_default();
    format!("{}{hint}", error.to_string())
}
