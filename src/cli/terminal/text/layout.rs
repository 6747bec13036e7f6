//! Lines of at most 80 columns: wrapped items, and values below their names.

use std::fmt::Write as _;

/// Number of columns of a line, and of its label.
pub(super) const COLUMNS: usize = 80;
pub(super) const LABEL: usize = 9;

/// Items with commas between them and an end, wrapped at 80 columns.
pub(super) fn wrapped(items: impl Iterator<Item = String>, end: &str) -> String {
    let (mut text, mut column) = (String::new(), LABEL);
    for item in items {
        let width = item.chars().count();
        if !text.is_empty() && column + 2 + width + end.len() > COLUMNS {
            text += ",\n";
            text += &" ".repeat(LABEL);
            column = LABEL;
        } else if !text.is_empty() {
            text += ", ";
            column += 2;
        }
        text += &item;
        column += width;
    }
    text + end
}

/// Values below their names, in blocks of at most 80 columns, with an end after the last one.
pub(super) fn in_columns(items: impl Iterator<Item = (String, String)>, end: &str) -> String {
    let mut blocks: Vec<[String; 2]> = Vec::new();
    for (name, value) in items {
        let width = name.chars().count().max(value.chars().count());
        let fits = |block: &[String; 2]| LABEL + block[0].chars().count() + 2 + width <= COLUMNS;
        if !blocks.last().is_some_and(fits) {
            blocks.push([String::new(), String::new()]);
        }
        if let Some([names, values]) = blocks.last_mut() {
            let gap = if names.is_empty() { "" } else { "  " };
            // Writing to a string cannot fail.
            let _ = write!(names, "{gap}{name:<width$}");
            let _ = write!(values, "{gap}{value:<width$}");
        }
    }
    let mut lines: Vec<String> =
        blocks.iter().flatten().map(|line| line.trim_end().to_owned()).collect();
    match lines.last_mut() {
        Some(last) if LABEL + last.chars().count() + 2 + end.len() <= COLUMNS => {
            let _ = write!(last, "  {end}");
        }
        _ => lines.push(end.to_owned()),
    }
    lines.join(&format!("\n{:LABEL$}", ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_below_their_names_on_as_many_lines_as_they_need() {
        let item = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let two = [item("tip", "1.0e-6"), item("mesh (hub angle)", "2e-4")];
        let text = in_columns(two.into_iter(), "of the peak");
        assert_eq!(text, "tip     mesh (hub angle)\n         1.0e-6  2e-4  of the peak");
        let many = (0..9).map(|k| item(&format!("quantity {k}"), "1.0e-6"));
        let text = in_columns(many, "of the peak");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4, "{text}");
        assert!(lines[2].trim_start().starts_with("quantity 6"), "{text}");
        assert!(lines.iter().all(|line| line.chars().count() <= COLUMNS), "{text}");
    }
}
