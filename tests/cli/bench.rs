//! A folder in which a test writes and reads files.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

/// A temporary folder for the files of one test.
pub(crate) struct Bench {
    pub(crate) folder: TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Columns of a table, each with its name, below its comments.
    pub(crate) fn table(&self, name: &str) -> Vec<(String, Vec<f64>)> {
        let text = self.read(name);
        let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
        let names = lines.next().unwrap().split(',').map(str::to_owned);
        let mut columns: Vec<(String, Vec<f64>)> = names.map(|name| (name, Vec::new())).collect();
        for line in lines {
            let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            assert_eq!(fields.len(), columns.len(), "{name}: {line}");
            for ((_, values), field) in columns.iter_mut().zip(fields) {
                values.push(field);
            }
        }
        columns
    }
}
