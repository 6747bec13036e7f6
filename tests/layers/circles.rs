//! Files that import each other in a circle.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::source::{module, sources, without_text};

/// Module path of a file.
type Module = Vec<String>;

/// One imported name, and the path behind it.
struct Import {
    path: Vec<String>,
    name: String,
    re_export: bool,
}

struct File {
    code: String,
    imports: Vec<Import>,
    is_mod: bool,
}

/// All files by module path.
struct Tree(BTreeMap<Module, File>);

impl Tree {
    fn new(sources: impl IntoIterator<Item = (PathBuf, String)>) -> Self {
        let files = sources.into_iter().filter(|(path, _)| !path.ends_with("tests.rs"));
        Self(files.map(|(path, source)| (module(&path), File::new(&path, &source))).collect())
    }

    /// The file that defines `path`, seen from `at`. `None` for names of other crates.
    fn definition(&self, at: &[String], path: &[String]) -> Option<Module> {
        let (mut current, rest) = match path[0].as_str() {
            "crate" => (Vec::new(), &path[1..]),
            "self" => (at.to_vec(), &path[1..]),
            "super" => {
                let climbs = path.iter().take_while(|name| *name == "super").count();
                (at[..at.len().checked_sub(climbs)?].to_vec(), &path[climbs..])
            }
            _ if self.0.contains_key(&child(at, &path[0])) => (at.to_vec(), path),
            name => {
                let import = self.import(at, name)?;
                let path = [import.path.as_slice(), &path[1..]].concat();
                return self.definition(at, &path);
            }
        };
        for (number, name) in rest.iter().enumerate() {
            let inner = child(&current, name);
            if self.0.contains_key(&inner) {
                current = inner;
            } else if let Some(import) = self.import(&current, name) {
                let path = [&import.path, &rest[number + 1..]].concat();
                return self.definition(&current, &path).or(Some(current));
            } else {
                break;
            }
        }
        Some(current)
    }

    /// The import of `name` into the file `at` from a file of the tree.
    fn import(&self, at: &[String], name: &str) -> Option<&Import> {
        let imports = &self.0.get(at)?.imports;
        let of_this_crate = |import: &&Import| {
            let first = &import.path[0];
            ["crate", "self", "super"].contains(&first.as_str())
                || self.0.contains_key(&child(at, first))
        };
        imports
            .iter()
            .filter(of_this_crate)
            .find(|import| import.name == name && (import.path.len() > 1 || import.path[0] != name))
    }

    /// The files whose definitions a file names; a mod.rs may ignore its re-exports.
    fn needs(&self, at: &Module, file: &File) -> BTreeSet<Module> {
        let imports = file.imports.iter().filter(|import| !(file.is_mod && import.re_export));
        let named = imports.map(|import| import.path.clone()).chain(paths(&file.code));
        named
            .filter_map(|path| self.definition(at, &path))
            .filter(|target| target != at && !target.is_empty())
            .filter(|target| self.0.contains_key(target))
            .collect()
    }

    /// The sets of files that need each other.
    fn circles(&self) -> BTreeSet<Vec<String>> {
        let needs: BTreeMap<_, _> =
            self.0.iter().map(|(at, file)| (at, self.needs(at, file))).collect();
        let reached = |start: &Module| {
            let mut found = BTreeSet::new();
            let mut open: Vec<&Module> = needs[start].iter().collect();
            while let Some(next) = open.pop() {
                if found.insert(next) {
                    open.extend(&needs[next]);
                }
            }
            found
        };
        let all: BTreeMap<_, _> = self.0.keys().map(|at| (at, reached(at))).collect();
        let circle = |at: &Module| {
            let others = all[at].iter().filter(|other| all[**other].contains(at));
            others.map(|other| other.join("/")).collect::<Vec<_>>()
        };
        self.0.keys().map(circle).filter(|circle| !circle.is_empty()).collect()
    }
}

impl File {
    fn new(path: &Path, source: &str) -> Self {
        // The tests at the end of a file may use any room.
        let tested = source.split("\n#[cfg(test)]\nmod tests").next().unwrap_or(source);
        let text = without_text(tested);
        let mut code = String::new();
        let mut imports = Vec::new();
        let mut statement: Option<String> = None;
        for line in text.lines() {
            let words = line.trim_start();
            let visible = words.strip_prefix("pub").map(|rest| {
                rest.strip_prefix('(').and_then(|r| r.split_once(')')).map_or(rest, |(_, r)| r)
            });
            if statement.is_none() && visible.unwrap_or(words).trim_start().starts_with("use ") {
                statement = Some(String::new());
            }
            let Some(begun) = &mut statement else {
                code.push_str(line);
                code.push('\n');
                continue;
            };
            begun.push_str(words);
            begun.push(' ');
            if words.ends_with(';') {
                let (head, tree) = begun.split_once("use ").expect("a use statement");
                expand(&[], tree.trim_end_matches([' ', ';']), !head.is_empty(), &mut imports);
                statement = None;
            }
        }
        Self { code, imports, is_mod: path.ends_with("mod.rs") || path.ends_with("lib.rs") }
    }
}

/// Adds every import of a tree of paths behind `prefix`.
fn expand(prefix: &[String], tree: &str, re_export: bool, imports: &mut Vec<Import>) {
    let tree = tree.trim();
    let segments =
        |path: &str| path.split("::").map(|name| name.trim().to_owned()).collect::<Vec<_>>();
    if let Some((head, group)) = tree.split_once('{') {
        let inner: Vec<_> = prefix.iter().cloned().chain(segments(head)).collect();
        let inner: Vec<_> = inner.into_iter().filter(|name| !name.is_empty()).collect();
        let group = group.strip_suffix('}').expect("a closed group");
        let mut depth = 0;
        let split = |c: char| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == ',' && depth == 0
        };
        let members = group.split(split).filter(|member| !member.trim().is_empty());
        members.for_each(|member| expand(&inner, member, re_export, imports));
        return;
    }
    let (path, alias) = tree.split_once(" as ").map_or((tree, None), |(p, a)| (p, Some(a.trim())));
    let mut path: Vec<_> = prefix.iter().cloned().chain(segments(path)).collect();
    if path.last().is_some_and(|name| name == "self") {
        path.pop();
    }
    let name = alias.map_or_else(|| path[path.len() - 1].clone(), str::to_owned);
    imports.push(Import { path, name, re_export });
}

/// Paths of two names and more in code. The path in a visibility does not count.
fn paths(code: &str) -> Vec<Vec<String>> {
    let code = code.replace("pub(in crate::", "pub(in ");
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = code.split(|c| !is_path(c)).map(|word| word.trim_matches(':'));
    let paths = words.filter(|word| word.contains("::") && !word.contains(":::"));
    paths.map(|word| word.split("::").map(str::to_owned).collect()).collect()
}

fn child(at: &[String], name: &str) -> Module {
    at.iter().cloned().chain([name.to_owned()]).collect()
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    for (folder, least) in [("src", 900), ("python/src", 60)] {
        let tree = Tree::new(sources(folder));
        let imports: usize = tree.0.iter().map(|(at, file)| tree.needs(at, file).len()).sum();
        assert!(imports > least, "only {imports} imports between files of {folder} were found");
        assert_eq!(tree.circles(), BTreeSet::new(), "{folder}");
    }
}

#[test]
fn a_planted_circle_is_found() {
    let tree = |mesh: &str, stretch: &str| {
        let files = [
            ("lib.rs", "mod mechanics;\npub use mechanics::{beam, link};"),
            ("mechanics/mod.rs", "pub mod beam;\npub mod link;"),
            (
                "mechanics/beam/mod.rs",
                "mod mesh;\nmod stretch;\npub use mesh::{Mesh, Piece as Part};",
            ),
            ("mechanics/beam/mesh.rs", mesh),
            ("mechanics/beam/stretch.rs", stretch),
            ("mechanics/link/mod.rs", "use crate::beam::Mesh;"),
        ];
        Tree::new(files.map(|(path, source)| (path.into(), source.to_owned()))).circles()
    };
    let circle = BTreeSet::from([vec![
        "mechanics/beam/mesh".to_owned(),
        "mechanics/beam/stretch".to_owned(),
    ]]);
    let uses_mesh =
        ["use super::Part;", "use super::{\n    Mesh,\n};", "fn f(m: &crate::beam::Mesh) {}"];
    for source in uses_mesh {
        assert_eq!(tree("use super::stretch::doubled;", source), circle, "{source}");
        assert_eq!(tree("fn f() { super::stretch::doubled() }", source), circle, "{source}");
        assert_eq!(tree("// use super::stretch::doubled;", source), BTreeSet::new());
        let tested =
            "struct Mesh;\n#[cfg(test)]\nmod tests {\n    use super::super::stretch::doubled;\n}";
        assert_eq!(tree(tested, source), BTreeSet::new());
    }
}
