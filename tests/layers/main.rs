//! The import law: five floors of rooms. A room imports only from levels below its own, and no files of the library
//! or of the Python module import each other in a circle.

mod circles;
mod source;

use std::path::{Path, PathBuf};

use source::{identifier, module, names, sources, without_text};

/// Rooms by floor and level. A room imports only from levels above its own in this list.
const FLOORS: [(&str, &[&[&str]]); 5] = [
    (
        "mechanics",
        &[
            &["text", "system"],
            &["numeric"],
            &["link"],
            &["motion", "beam"],
            &["recording"],
            &["modal"],
            &["model"],
            &["elastica"],
            &["response"],
            &["inverse"],
        ],
    ),
    ("study", &[&["compare"], &["result"], &["sweep", "verify", "fit", "robust"], &["learn"]]),
    ("files", &[&["spec", "csv"], &["measured"], &["store"]]),
    ("page", &[&["page"]]),
    ("cli", &[&["terminal"], &["options"], &["cli"]]),
];

/// Deeds of a few rooms alone, and the words that betray them.
const RESERVED: [(&str, &[&str], &[&str]); 2] = [
    (
        // `terminal` asks the system which signals the program was started to ignore.
        "opens files",
        &["spec", "csv", "store", "system", "measured", "terminal"],
        &["std::fs", "fs::", "File::open", "File::create", "OpenOptions", "tempfile"],
    ),
    (
        "prints",
        &["terminal", "cli"],
        &["println!", "print!", "eprintln!", "eprint!", "dbg!", "stdout(", "stderr("],
    ),
];

/// Functions whose rounding depends on the system or the processor; `libm` has versions with the same bits
/// everywhere.
const ROUNDED_ELSEWISE: [&str; 24] = [
    ".sin()",
    ".cos()",
    ".tan()",
    ".sin_cos()",
    ".asin()",
    ".acos()",
    ".atan()",
    ".atan2(",
    ".sinh()",
    ".cosh()",
    ".tanh()",
    ".exp()",
    ".exp_m1()",
    ".ln()",
    ".ln_1p()",
    ".log10()",
    ".log2()",
    ".powf(",
    ".cbrt()",
    ".hypot(",
    ".mul_add(",
    ".norm()",
    ".arg()",
    "::cis(",
];

/// Number of a room's level, from the lowest.
fn level(room: &str) -> Option<usize> {
    let mut levels = FLOORS.iter().flat_map(|(_, levels)| *levels);
    levels.position(|level| level.contains(&room))
}

/// The room of a file; `None` for the roots of the crates and of the floors, which list their rooms.
fn room(path: &[String]) -> Option<&str> {
    match path.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["cli", room @ ("options" | "terminal"), ..] => Some(room),
        [floor @ ("page" | "cli"), ..] => Some(floor),
        [] | ["main" | "mechanics" | "study" | "files"] => None,
        [floor, ref rooms @ ..] => Some(rooms.first().copied().unwrap_or(floor)),
    }
}

/// The breaches of the law in a source file of a room. `depth` is the number of modules in its path: 3 for
/// `mechanics/beam/mesh.rs`.
fn violations(room: &str, depth: usize, source: &str) -> Vec<String> {
    let code = without_text(source);
    let Some(own) = level(room) else {
        return vec![format!("{room} has no place in the table")];
    };
    let mut found = Vec::new();
    for target in imports(&code).into_iter().chain(climbs(&code, depth)) {
        match level(&target) {
            _ if target == room => {}
            None => found.push(format!("{room} imports {target}, which is not in the table")),
            Some(other) if other >= own => found.push(format!("{room} imports {target}")),
            Some(_) => {}
        }
    }
    for (deed, allowed, words) in RESERVED {
        let word = words.iter().find(|word| names(&code, word).next().is_some());
        if let Some(word) = word.filter(|_| !allowed.contains(&room)) {
            found.push(format!("{room} {deed}: {word}"));
        }
    }
    found
}

/// Rooms behind `crate::`, in groups too. A visibility names its room behind its floor.
fn imports(code: &str) -> Vec<String> {
    let code = code.replace("pub(in crate::", "pub(in ");
    names(&code, "crate::").flat_map(targets).map(|path| room_of_cli(&path)).collect()
}

/// Rooms behind a chain of at least `depth - 1` times `super::`, which leads to the floor or the root.
fn climbs(code: &str, depth: usize) -> Vec<String> {
    let chain = "super::".repeat(depth.saturating_sub(1).max(1));
    let paths = names(code, &chain).flat_map(|rest| targets(rest.trim_start_matches("super::")));
    paths.map(|path| room_of_cli(&path)).filter(|target| level(target).is_some()).collect()
}

/// Paths of two names behind a prefix: one, or those of a group.
fn targets(rest: &str) -> Vec<String> {
    match rest.strip_prefix('{') {
        Some(group) => members(group),
        None => vec![two_names(rest)],
    }
}

/// `cli::options` for `cli::options::common`, `link` for `link`.
fn two_names(path: &str) -> String {
    let first = identifier(path);
    let rest = path.trim_start().strip_prefix(&*first).and_then(|rest| rest.strip_prefix("::"));
    match rest.map(identifier) {
        Some(second) if first == "cli" => format!("{first}::{second}"),
        _ => first,
    }
}

/// The room of a path into `cli`: `options` for `cli::options`, `cli` for the commands. A group may name any.
fn room_of_cli(path: &str) -> String {
    match path.split_once("::") {
        Some(("cli", room @ ("options" | "terminal"))) => room.to_owned(),
        Some((floor, _)) => floor.to_owned(),
        None => path.to_owned(),
    }
}

/// First names of the members of a group, up to its closing brace.
fn members(group: &str) -> Vec<String> {
    let mut depth = 1;
    let mut found = vec![two_names(group)];
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => found.push(two_names(&group[at + 1..])),
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    found.retain(|name| !name.is_empty());
    found
}

#[test]
fn every_room_imports_only_from_levels_below_its_own() {
    let mut found = Vec::new();
    let mut checked = 0;
    for (path, source) in sources("src") {
        let names = module(&path);
        if let Some(room) = room(&names) {
            checked += 1;
            let file = violations(room, names.len(), &source);
            let shown = path.display();
            found.extend(file.into_iter().map(|violation| format!("{shown}: {violation}")));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(checked > 40, "only {checked} files were found");
}

#[test]
fn every_room_is_on_its_floor() {
    for (path, _) in sources("src") {
        let names = module(&path);
        let Some(room) = room(&names) else { continue };
        let floor = FLOORS.iter().find(|(_, levels)| levels.iter().any(|l| l.contains(&room)));
        assert_eq!(floor.map(|(floor, _)| *floor), Some(&*names[0]), "{}", path.display());
    }
}

#[test]
fn the_sources_are_at_most_335_files() {
    let count = sources("src").len();
    assert!(count <= 335, "{count} files");
}

#[test]
fn unsafe_code_is_in_the_allocator_alone() {
    let is_unsafe = |source: &str| {
        let code = without_text(source).replace("deny(unsafe_code)", "");
        names(&code, "unsafe").next().is_some()
    };
    assert!(is_unsafe("unsafe { f() }") && is_unsafe("#![allow(unsafe_code)]"));
    assert!(!is_unsafe("#![deny(unsafe_code)]\n// unsafe"));
    let found = sources("src").into_iter().filter(|(_, source)| is_unsafe(source));
    let paths: Vec<PathBuf> = found.map(|(path, _)| path).collect();
    assert_eq!(paths, [Path::new("cli/terminal/allocator.rs")]);
}

#[test]
fn a_planted_violation_is_found() {
    let planted = [
        ("beam", "use crate::motion::TipMotion;", "beam imports motion"),
        (
            "beam",
            "use crate::{\n    link::{Link, Taper},\n    modal::zeros,\n};",
            "beam imports modal",
        ),
        ("numeric", "fn f(link: &crate::link::Link) {}", "numeric imports link"),
        ("link", "use super::super::super::beam::Mesh;", "link imports beam"),
        ("link", "use super::super::beam::Mesh;", "link imports beam"),
        ("result", "pub(crate) use crate::spec::Place;", "result imports spec"),
        ("store", "fn f() { crate::cli::run() }", "store imports cli"),
        ("store", "use crate::cli::options::common;", "store imports options"),
        ("options", "use crate::cli::{solve, terminal};", "options imports cli"),
        (
            "options",
            "use crate::cli::terminal::Exit;\nuse crate::cli::solve::Solve;",
            "options imports cli",
        ),
        ("terminal", "use crate::{cli::options::common, text};", "terminal imports options"),
        ("link", "use super::super::{beam::Mesh, numeric::Root};", "link imports beam"),
        ("store", "use crate::page::Figures;", "store imports page"),
        ("link", "use crate::Error;", "link imports Error, which is not in the table"),
        ("inverse", "use std::fs;", "inverse opens files: std::fs"),
        ("cli", "let f = File::open(path)?;", "cli opens files: File::open"),
        ("modal", "println!(\"{x}\");", "modal prints: println!"),
        ("csv", "writeln!(io::stderr(), \"\")", "csv prints: stderr("),
        ("utils", "", "utils has no place in the table"),
    ];
    for (module, source, expected) in planted {
        assert_eq!(violations(module, 3, source), [expected]);
    }
}

#[test]
fn lawful_code_is_left_alone() {
    let lawful = [
        ("beam", "use crate::link::{Link, Taper};\nuse crate::numeric::Scalar;"),
        ("beam", "use crate::beam::Mesh;\nuse super::mesh::Mesh;"),
        ("numeric", "// as crate::link does\n/* std::fs */ const A: &str = \"println!(\\\"\";"),
        ("numeric", "const A: (char, char, &str) = ('\"', '\\'', r#\"crate::link\"#);"),
        ("link", "fn f<'a>(x: &'a str) { reprint!(x) }"),
        ("spec", "let text = std::fs::read_to_string(path)?;"),
        ("options", "use crate::cli::terminal::{Exit, Failure};"),
        ("beam", "pub(in crate::mechanics::beam) fn f() {}"),
        ("cli", "use crate::cli::exit;\nprintln!();"),
    ];
    for (module, source) in lawful {
        assert_eq!(violations(module, 3, source), [""; 0], "{source}");
    }
}

#[test]
fn no_number_comes_from_a_function_that_is_rounded_elsewise_on_other_processors() {
    let uses = |source: &str| {
        // The tests at the end of a file may use any room.
        let code = without_text(source.split("\n#[cfg(test)]\nmod tests").next().unwrap_or(source));
        ROUNDED_ELSEWISE.into_iter().find(|function| code.contains(function))
    };
    assert_eq!(uses("let a = x.sin();"), Some(".sin()"));
    assert_eq!(uses("// x.sin()\nlet a = 1;\n#[cfg(test)]\nmod tests { x.sin() }"), None);
    let is_code = |path: &Path| !path.ends_with("tests.rs");
    let sources = sources("src").into_iter().filter(|(path, _)| is_code(path));
    let found: Vec<_> = sources.filter_map(|(path, source)| Some((path, uses(&source)?))).collect();
    assert!(found.is_empty(), "{found:?}");
}
