use super::compared::TableComparison;
use super::tolerance::{Entry, Tolerances};

/// One file that EXPECTED, ACTUAL or both have.
#[derive(Debug, Clone, PartialEq)]
pub struct FileComparison {
    /// Path from the folders that are compared, with slashes.
    pub name: String,
    /// What was found.
    pub outcome: FileOutcome,
}

/// What was found of one file.
#[derive(Debug, Clone, PartialEq)]
pub enum FileOutcome {
    /// Both sides have it.
    Compared(TableComparison),
    /// EXPECTED alone has it, with these columns.
    OnlyExpected(Vec<String>),
    /// ACTUAL alone has it, with these columns.
    OnlyActual(Vec<String>),
}

impl FileComparison {
    /// Whether both sides have it, the same within tolerance.
    pub fn is_equal(&self) -> bool {
        matches!(&self.outcome, FileOutcome::Compared(table) if table.is_equal())
    }

    /// Names of its columns on either side.
    fn columns(&self) -> Vec<&str> {
        match &self.outcome {
            FileOutcome::OnlyExpected(names) | FileOutcome::OnlyActual(names) => {
                names.iter().map(String::as_str).collect()
            }
            FileOutcome::Compared(table) => {
                let both = table.columns.iter().map(|column| &column.name);
                let alone = table.columns_expected.iter().chain(&table.columns_actual);
                both.chain(alone).map(String::as_str).collect()
            }
        }
    }
}

/// All files of two sides held against each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The files, in the order of their names.
    pub files: Vec<FileComparison>,
    /// Number of files on either side that are no tables.
    pub not_compared: usize,
}

impl Comparison {
    /// Whether nothing differs beyond tolerance.
    pub fn is_equal(&self) -> bool {
        self.files.iter().all(FileComparison::is_equal)
    }

    /// The entries that name no column of any file.
    pub fn idle<'a>(&self, tolerances: &'a Tolerances) -> Vec<&'a Entry> {
        let files: Vec<_> = self.files.iter().map(|file| (&file.name, file.columns())).collect();
        let is_idle = |entry: &&Entry| {
            !files.iter().any(|(file, names)| names.iter().any(|name| entry.names(file, name)))
        };
        tolerances.entries.iter().filter(is_idle).collect()
    }
}
