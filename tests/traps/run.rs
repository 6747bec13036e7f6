//! The program on a case: files in, summary.json and tables out.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use super::case::{Case, Mesh};
use super::link::Link;
use super::motion::Samples;

/// Nodes that are compared, at most.
const NODES: usize = 6;

/// Bodies with rotary inertia make the moment jump; nodes there are left out.
const BESIDE_M: f64 = 1e-6;

/// What a run came to.
pub(crate) enum Outcome {
    Written(Box<Written>),
    /// Exit code and message.
    Refused(Option<i32>, String),
}

/// A warning of a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Warned {
    pub(crate) kind: String,
    pub(crate) message: String,
}

impl Warned {
    /// Whether the message is about `the <quantity>`; the motor torque is not the torque.
    pub(crate) fn names(&self, quantity: &str) -> bool {
        self.message.contains(&format!("the {} ", quantity.replace('_', " ")))
    }
}

/// Results of a run.
pub(crate) struct Written {
    pub(crate) summary: Value,
    link: Link,
    folder: TempDir,
}

/// A table's columns.
pub(crate) struct Table {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Table {
    /// The column of a name.
    pub(crate) fn column(&self, name: &str) -> &[f64] {
        let found = self.names.iter().position(|own| own == name);
        &self.columns[found.unwrap_or_else(|| panic!("no column {name} in {:?}", self.names))]
    }

    /// Columns after the first.
    pub(crate) fn values(&self) -> &[Vec<f64>] {
        &self.columns[1..]
    }

    /// Numbers of the nodes in a nodal table's heading.
    pub(crate) fn numbers(&self) -> Vec<usize> {
        let digits = |name: &String| name.chars().filter(char::is_ascii_digit).collect::<String>();
        self.names[1..].iter().map(|name| digits(name).parse().expect("a node")).collect()
    }

    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).expect("a table that was written");
        let mut lines = text.lines();
        let names: Vec<String> =
            lines.next().expect("a heading").split(',').map(str::to_owned).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for line in lines {
            for (column, cell) in columns.iter_mut().zip(line.split(',')) {
                column.push(cell.parse().unwrap_or(f64::NAN));
            }
        }
        Self { names, columns }
    }
}

/// Runs the program on a case's link and some samples; with nodes that are compared the moments, too.
pub(crate) fn solved(case: &Case, samples: &Samples, nodes: &Nodes) -> Outcome {
    let folder = tempfile::tempdir().expect("a place for files");
    let path = |name: &str| folder.path().join(name);
    fs::write(path("link.toml"), case.toml()).expect("a link file");
    fs::write(path("motion.csv"), samples.csv()).expect("a motion file");
    let mut program = Command::new(env!("CARGO_BIN_EXE_flexlink"));
    program.current_dir(folder.path()).args(["solve", "link.toml", "motion.csv"]);
    program.args(["--quiet", "--no-sync", "--threads", "1", "--nodes", &nodes.list()]);
    match nodes {
        Nodes::These(_) => program.arg("--moments"),
        Nodes::Root => program.args(["--every", "1000"]),
    };
    let output = program.output().expect("a program that starts");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        return Outcome::Refused(output.status.code(), message);
    }
    let summary = fs::read_to_string(path("out/summary.json")).expect("a summary");
    let summary = serde_json::from_str(&summary).expect("JSON");
    Outcome::Written(Box::new(Written { summary, link: case.link.clone(), folder }))
}

/// Nodes whose histories a run writes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Nodes {
    /// The root's alone, for runs that are only asked for their peak.
    Root,
    These(Vec<usize>),
}

impl Nodes {
    fn list(&self) -> String {
        match self {
            Self::Root => "0".to_owned(),
            Self::These(nodes) => nodes.iter().map(usize::to_string).collect::<Vec<_>>().join(","),
        }
    }

    /// Some nodes from root to tip of a case's mesh; an automatic one is asked of the program.
    pub(crate) fn of(case: &Case, samples: &Samples) -> Self {
        let count = match (case.mesh, solved(case, samples, &Self::Root)) {
            (_, Outcome::Written(written)) => written.nodes_m().len() - 1,
            (Mesh::Elements(count), Outcome::Refused(..)) => count,
            (Mesh::Auto(_), Outcome::Refused(..)) => 1,
        };
        let mut nodes: Vec<usize> = (0..NODES).map(|k| k * count / (NODES - 1)).collect();
        nodes.dedup();
        Self::These(nodes)
    }
}

impl Written {
    /// A table, by its name for a hub with the tip as output.
    pub(crate) fn table(&self, name: &str) -> Table {
        Table::read(&self.folder.path().join("out").join(self.link.named(name)))
    }

    /// The program's name of a column or key, from that of a hub with the tip as output.
    pub(crate) fn named<'a>(&self, name: &'a str) -> &'a str {
        self.link.named(name)
    }

    /// A number of the summary, none where there is none.
    pub(crate) fn number(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer).and_then(Value::as_f64)
    }

    pub(crate) fn warnings(&self) -> Vec<Warned> {
        let warnings = self.summary["warnings"].as_array().cloned().unwrap_or_default();
        let text = |warning: &Value, key: &str| {
            warning[key].as_str().expect("a text of a warning").to_owned()
        };
        let warned = |w| Warned { kind: text(w, "kind"), message: text(w, "message") };
        warnings.iter().map(warned).collect()
    }

    /// Places of all nodes in m from the axis.
    pub(crate) fn nodes_m(&self) -> Vec<f64> {
        self.table("nodes.csv").column("x_m").to_vec()
    }

    /// Number of the first row, counted from the motion's first sample.
    pub(crate) fn first_row(&self, step_s: f64) -> i64 {
        let start = self.table("torque.csv").column("time_s")[0];
        (start / step_s).round() as i64
    }
}

/// Whether the moment at a place has one value.
pub(crate) fn has_one_moment(case: &Case, x_m: f64) -> bool {
    let jumps = case.link.bodies.iter().filter(|body| body.inertia_kg_m2 > 0.0);
    jumps.into_iter().all(|body| (body.at_m - x_m).abs() > BESIDE_M)
}
