use wildmatch::WildMatch;

/// Largest difference of a number from the expected one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Relative to the column's peak.
    pub rtol: f64,
    /// In the column's own unit.
    pub atol: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { rtol: 1e-9, atol: 0.0 }
    }
}

impl Tolerance {
    /// Largest difference allowed in a column of this peak, in the column's unit.
    pub fn allowed(&self, peak: f64) -> f64 {
        self.atol + self.rtol * peak
    }
}

/// How a column is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// It is not compared and may be missing.
    Ignore,
    /// Within a tolerance.
    Within(Tolerance),
}

/// What a rule changes for the columns that it names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// They are not compared.
    Ignore,
    /// They have another tolerance; a part that is `None` stays general.
    Tolerance {
        /// Relative to the column's peak.
        rtol: Option<f64>,
        /// In the column's own unit.
        atol: Option<f64>,
    },
}

/// Columns by pattern, and what changes for them.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnRule {
    /// The place of the rule, for messages.
    pub place: String,
    /// Pattern of the file's name, or of its path where the pattern has a slash; `None`: any.
    pub file: Option<String>,
    /// Pattern of the column's name.
    pub column: String,
    /// What changes for them.
    pub change: Change,
}

impl ColumnRule {
    /// True if it names this column of the file with this path, whose folders end in slashes.
    ///
    /// In patterns `*` matches any text and `?` one character.
    pub fn names(&self, file: &str, column: &str) -> bool {
        self.is_of(file) && WildMatch::new(&self.column).matches(column)
    }

    /// True if it names columns of the file with this path.
    pub fn is_of(&self, file: &str) -> bool {
        self.file.as_deref().is_none_or(|pattern| {
            let name = file.rsplit('/').next().unwrap_or(file);
            WildMatch::new(pattern).matches(if pattern.contains('/') { file } else { name })
        })
    }
}

/// The tolerances of all columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tolerances {
    /// For columns that no rule names.
    pub general: Tolerance,
    /// Exceptions; of several that name a column the last one counts.
    pub entries: Vec<ColumnRule>,
    /// True if rows do not count that only one side has before the first row of both or behind the last one.
    pub common_rows: bool,
}

impl Tolerances {
    /// How a column is compared.
    pub fn rule(&self, file: &str, column: &str) -> Rule {
        let general = self.general;
        match self.entries.iter().rfind(|entry| entry.names(file, column)) {
            None => Rule::Within(general),
            Some(ColumnRule { change: Change::Ignore, .. }) => Rule::Ignore,
            Some(ColumnRule { change: Change::Tolerance { rtol, atol }, .. }) => {
                Rule::Within(Tolerance {
                    rtol: rtol.unwrap_or(general.rtol),
                    atol: atol.unwrap_or(general.atol),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(file: Option<&str>, column: &str, change: Change) -> ColumnRule {
        let file = file.map(str::to_owned);
        ColumnRule { place: "t:1".into(), file, column: column.into(), change }
    }

    fn within(rtol: f64, atol: f64) -> Rule {
        Rule::Within(Tolerance { rtol, atol })
    }

    #[test]
    fn the_last_entry_that_names_a_column_holds_and_leaves_the_rest_general() {
        let rtol = |rtol| Change::Tolerance { rtol: Some(rtol), atol: None };
        let tolerances = Tolerances {
            general: Tolerance { rtol: 1e-6, atol: 1e-3 },
            entries: vec![
                entry(None, "v?_m", rtol(1e-4)),
                entry(None, "*", Change::Tolerance { rtol: None, atol: Some(0.5) }),
                entry(Some("t*.csv"), "v1_m", Change::Ignore),
                entry(Some("a/*.csv"), "v2_m", rtol(0.25)),
            ],
            common_rows: false,
        };
        assert_eq!(tolerances.rule("x.csv", "v1_m"), within(1e-6, 0.5));
        assert_eq!(tolerances.rule("deep/down/t.csv", "v1_m"), Rule::Ignore);
        assert_eq!(tolerances.rule("a/x.csv", "v2_m"), within(0.25, 1e-3));
        assert_eq!(tolerances.rule("b/a.csv", "v2_m"), within(1e-6, 0.5));
        let first = Tolerances { entries: tolerances.entries[..1].to_vec(), ..tolerances };
        assert_eq!(first.rule("x.csv", "v1_m"), within(1e-4, 1e-3));
        assert_eq!(first.rule("x.csv", "v10_m"), within(1e-6, 1e-3));
    }
}
