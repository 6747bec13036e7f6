//! The import law: a module imports only from levels below its own, siblings never from each other, and
//! no files of a module import each other in a circle. Files are few and short.

mod circles;
mod source;

use std::path::{Path, PathBuf};

use source::{identifier, names, sources, without_text};

/// Modules by level. What stands on a level knows those above it in this list, and nothing else.
const LEVELS: [&[&str]; 19] = [
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
    &["compare"],
    &["result"],
    &["sweep", "verify", "fit"],
    &["spec", "csv", "report"],
    &["measured"],
    &["store"],
    &["terminal"],
    &["options"],
    &["cli"],
];

/// What only the modules named may do, and the words that betray it.
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

/// Functions that the system, or the processor, rounds in its own way; `libm` has those that give the
/// same bits everywhere.
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

fn level(module: &str) -> Option<usize> {
    LEVELS.iter().position(|level| level.contains(&module))
}

/// Everything that a source file of `module` does against the law. `depth` is the number of
/// modules that its path names: 2 for `beam/mesh.rs`.
fn violations(module: &str, depth: usize, source: &str) -> Vec<String> {
    let code = without_text(source);
    let Some(own) = level(module) else {
        return vec![format!("{module} has no place in the table")];
    };
    let mut found = Vec::new();
    for target in imports(&code).into_iter().chain(climbs(&code, depth)) {
        match level(&target) {
            _ if target == module => {}
            None => found.push(format!("{module} imports {target}, which is not in the table")),
            Some(other) if other >= own => found.push(format!("{module} imports {target}")),
            Some(_) => {}
        }
    }
    for (deed, allowed, words) in RESERVED {
        let word = words.iter().find(|word| names(&code, word).next().is_some());
        if let Some(word) = word.filter(|_| !allowed.contains(&module)) {
            found.push(format!("{module} {deed}: {word}"));
        }
    }
    found
}

/// Modules named behind `crate::`, in groups too.
fn imports(code: &str) -> Vec<String> {
    let targets = |rest: &str| match rest.strip_prefix('{') {
        Some(group) => members(group),
        None => vec![identifier(rest)],
    };
    names(code, "crate::").flat_map(targets).collect()
}

/// Modules of the table that a chain of at least `depth` times `super::` leads to.
fn climbs(code: &str, depth: usize) -> Vec<String> {
    let chain = "super::".repeat(depth);
    let target = |rest: &str| identifier(rest.trim_start_matches("super::"));
    names(code, &chain).map(target).filter(|target| level(target).is_some()).collect()
}

/// First names of the members of a group, up to its closing brace.
fn members(group: &str) -> Vec<String> {
    let mut depth = 1;
    let mut found = vec![identifier(group)];
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => found.push(identifier(&group[at + 1..])),
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
fn every_module_imports_only_from_levels_below_its_own() {
    let mut found = Vec::new();
    let mut checked = 0;
    for (path, source) in sources() {
        let module = path.with_extension("");
        let mut names: Vec<_> = module.iter().map(|name| name.to_string_lossy()).collect();
        names.retain(|name| name != "mod");
        if ["lib", "main"].contains(&names[0].as_ref()) {
            continue;
        }
        checked += 1;
        let file = violations(&names[0], names.len(), &source);
        found.extend(file.into_iter().map(|violation| format!("{}: {violation}", path.display())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(checked > 40, "only {checked} files were found");
}

#[test]
fn the_sources_are_at_most_350_files() {
    let count = sources().len();
    assert!(count <= 350, "{count} files");
}

#[test]
fn the_library_does_not_know_the_command_line() {
    let (_, source) = sources().into_iter().find(|(path, _)| path == Path::new("lib.rs")).unwrap();
    let code = without_text(&source);
    assert!(code.contains("pub mod beam"));
    assert!(names(&code, "cli").all(|rest| rest.starts_with(char::is_alphanumeric)));
}

#[test]
fn unsafe_code_is_in_the_allocator_alone() {
    let is_unsafe = |source: &str| {
        let code = without_text(source).replace("forbid(unsafe_code)", "");
        names(&code, "unsafe").next().is_some()
    };
    assert!(is_unsafe("unsafe { f() }") && is_unsafe("#![allow(unsafe_code)]"));
    assert!(!is_unsafe("#![forbid(unsafe_code)]\n// unsafe"));
    let found = sources().into_iter().filter(|(_, source)| is_unsafe(source));
    let paths: Vec<PathBuf> = found.map(|(path, _)| path).collect();
    assert_eq!(paths, [Path::new("terminal/allocator.rs")]);
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
        ("link", "use super::super::beam::Mesh;", "link imports beam"),
        ("result", "pub(crate) use crate::spec::Place;", "result imports spec"),
        ("store", "fn f() { crate::cli::run() }", "store imports cli"),
        ("link", "use crate::Error;", "link imports Error, which is not in the table"),
        ("inverse", "use std::fs;", "inverse opens files: std::fs"),
        ("cli", "let f = File::open(path)?;", "cli opens files: File::open"),
        ("modal", "println!(\"{x}\");", "modal prints: println!"),
        ("csv", "writeln!(io::stderr(), \"\")", "csv prints: stderr("),
        ("utils", "", "utils has no place in the table"),
    ];
    for (module, source, expected) in planted {
        assert_eq!(violations(module, 2, source), [expected]);
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
        ("cli", "use crate::cli::exit;\nprintln!();"),
    ];
    for (module, source) in lawful {
        assert_eq!(violations(module, 2, source), [""; 0], "{source}");
    }
}

#[test]
fn no_number_comes_from_a_function_that_is_rounded_elsewise_on_other_processors() {
    let uses = |source: &str| {
        // The tests of a file stand at its end, and may use what they like.
        let code = without_text(source.split("\n#[cfg(test)]\nmod tests").next().unwrap_or(source));
        ROUNDED_ELSEWISE.into_iter().find(|function| code.contains(function))
    };
    assert_eq!(uses("let a = x.sin();"), Some(".sin()"));
    assert_eq!(uses("// x.sin()\nlet a = 1;\n#[cfg(test)]\nmod tests { x.sin() }"), None);
    let is_code = |path: &Path| !path.ends_with("tests.rs");
    let sources = sources().into_iter().filter(|(path, _)| is_code(path));
    let found: Vec<_> = sources.filter_map(|(path, source)| Some((path, uses(&source)?))).collect();
    assert!(found.is_empty(), "{found:?}");
}
