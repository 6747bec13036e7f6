use wildmatch::WildMatch;

/// Largest allowed difference of a number from the expected one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Part relative to the column's peak.
    pub rtol: f64,
    /// Absolute part in the column's unit.
    pub atol: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { rtol: 1e-9, atol: 0.0 }
    }
}

impl Tolerance {
    /// Largest allowed difference in a column of this peak, in the column's unit.
    pub fn allowed(&self, peak: f64) -> f64 {
        self.atol + self.rtol * peak
    }
}

/// Comparison of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// The column is not compared and may be missing.
    Ignore,
    /// The column is compared within a tolerance.
    Within(Tolerance),
}

/// Effect of a rule on its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// The columns are not compared.
    Ignore,
    /// The columns have another tolerance; a part that is `None` stays general.
    Tolerance {
        /// Part relative to the column's peak.
        rtol: Option<f64>,
        /// Absolute part in the column's unit.
        atol: Option<f64>,
    },
}

/// A pattern of columns, and the effect on them.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnRule {
    /// Place of the rule, for messages.
    pub place: String,
    /// Pattern of the file's name, or of its path if the pattern has a slash; `None` matches any file.
    pub file: Option<String>,
    /// Pattern of the column's name.
    pub column: String,
    /// Effect on the columns.
    pub change: Change,
}

impl ColumnRule {
    /// True if the rule matches this column of the file with this path, whose folders end in slashes.
    ///
    /// In patterns `*` matches any text and `?` one character.
    pub fn names(&self, file: &str, column: &str) -> bool {
        self.is_of(file) && WildMatch::new(&self.column).matches(column)
    }

    /// True if the rule matches columns of the file with this path.
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
    /// Tolerance of columns without a rule.
    pub general: Tolerance,
    /// Exceptions; the last matching one counts.
    pub entries: Vec<ColumnRule>,
    /// True if rows of only one side before the first common row or after the last one do not count.
    pub common_rows: bool,
}

impl Tolerances {
    /// Comparison of a column.
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
