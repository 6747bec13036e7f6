//! `help`: the help of a command, or a page of the book as text for a terminal.

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Command};

use crate::cli::terminal::{Failure, console};

/// Pages of the book by topic, with the content of each.
const PAGES: [(&str, &str, &str); 24] = [
    ("index", "Contents of the book", include_str!("../../docs/index.md")),
    ("install", "Install and test", include_str!("../../docs/install.md")),
    ("first_torque", "How to begin", include_str!("../../docs/first_torque.md")),
    ("first_uses", "Eight first uses", include_str!("../../docs/first_uses.md")),
    ("your_link", "From a drawing to a link file", include_str!("../../docs/your_link.md")),
    ("your_motion", "Make and read motions", include_str!("../../docs/your_motion.md")),
    ("is_it_true", "Errors and checks", include_str!("../../docs/is_it_true.md")),
    ("controller", "Tables that controllers play", include_str!("../../docs/controller.md")),
    ("files", "Link files, motions, measured tables, results", include_str!("../../docs/files.md")),
    ("commands", "The commands", include_str!("../../docs/commands.md")),
    ("limits", "The method and its limits", include_str!("../../docs/limits.md")),
    (
        "recordings",
        "Times, digits and noise of recorded motions",
        include_str!("../../docs/recordings.md"),
    ),
    ("ends", "Motions that repeat or do not rest", include_str!("../../docs/ends.md")),
    ("gravity", "Gravity and large deflections", include_str!("../../docs/gravity.md")),
    ("thick_links", "Shear and rotary inertia", include_str!("../../docs/thick_links.md")),
    ("carriage", "A link on a carriage", include_str!("../../docs/carriage.md")),
    ("arms", "Arms of several links", include_str!("../../docs/arms.md")),
    ("real_rig", "Measured rigs, and `fit`", include_str!("../../docs/real_rig.md")),
    ("uncertainty", "It survives my 5 %", include_str!("../../docs/robust.md")),
    ("many", "Many cases, many machines", include_str!("../../docs/many.md")),
    ("python", "The Python package", include_str!("../../docs/python.md")),
    ("golden", "Golden files", include_str!("../../docs/golden.md")),
    ("speed", "Speed, and how it is measured", include_str!("../../docs/speed.md")),
    ("paper", "Comparison with the paper", include_str!("../../docs/paper.md")),
];

/// All commands but `help`, as completions of shells list them.
const COMMANDS: [&str; 16] = [
    "solve",
    "simulate",
    "verify",
    "modes",
    "frf",
    "fit",
    "sweep",
    "robust",
    "learn",
    "trajectory",
    "compare",
    "report",
    "init",
    "schema",
    "completions",
    "man",
];

/// Width of a page in columns, which any terminal has. Names of files and numbers do not exceed it.
const WIDTH: usize = 80;

/// Least width of a table's column.
const NARROWEST: usize = 12;

const EXAMPLE: &str = "\
Example:
  flexlink help solve
  flexlink help files | less";

fn topics() -> PossibleValuesParser {
    let pages = PAGES.map(|(name, about, _)| PossibleValue::new(name).help(about));
    pages.into_iter().chain(COMMANDS.map(PossibleValue::new)).collect::<Vec<_>>().into()
}

/// Print the help of a command, or a page of the book, such as `files` or `limits`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Help {
    /// A command, or a page [default: all commands].
    #[arg(value_name = "TOPIC", value_parser = topics())]
    topic: Option<String>,
}

impl Help {
    pub(crate) fn run(&self, mut program: Command) -> Result<(), Failure> {
        let topic = self.topic.as_deref();
        if let Some((.., page)) = PAGES.iter().find(|(name, ..)| Some(*name) == topic) {
            return console::print(&terminal_text(page));
        }
        let words = ["flexlink"].into_iter().chain(topic).chain(["--help"]);
        let shown = program.try_get_matches_from_mut(words);
        shown.map_or_else(|help| console::parser_text(&help).map(drop), |_| Ok(()))
    }
}

/// A page of Markdown as plain text: lines and tables of `WIDTH` columns, code as it is, no marks of emphasis, no
/// figures. A link becomes its text and its page.
fn terminal_text(page: &str) -> String {
    let mut text = String::new();
    let mut lines = page.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("```") {
            for code in lines.by_ref().take_while(|line| !line.starts_with("```")) {
                text += format!("    {code}").trim_end();
                text.push('\n');
            }
        } else if let Some(heading) = line.strip_prefix('#') {
            let underline = match heading.trim_start_matches('#').len() {
                rest if rest == heading.len() => "=",
                rest if rest + 1 == heading.len() => "-",
                _ => "~",
            };
            let heading = inline(heading.trim_start_matches('#').trim());
            let underline = underline.repeat(heading.chars().count());
            text += &[heading.as_str(), &underline, ""].join("\n");
        } else if line.starts_with('|') {
            let mut rows = vec![line];
            while let Some(row) = lines.next_if(|line| line.starts_with('|')) {
                rows.push(row);
            }
            text += &table(&rows);
        } else if line.starts_with("![") {
            // A figure, and the empty line below it.
            lines.next();
        } else if line.is_empty() {
            text.push('\n');
        } else {
            let mut paragraph = line.to_owned();
            let goes_on = |line: &&str| !line.is_empty() && !line.starts_with(['#', '|', '*', '`']);
            while let Some(line) = lines.next_if(goes_on) {
                paragraph = paragraph + " " + line.trim_start();
            }
            let (first, rest) =
                paragraph.strip_prefix("* ").map_or(("", &*paragraph), |rest| ("* ", rest));
            let mut mark = first;
            for line in wrapped(&inline(rest), WIDTH - first.len()) {
                text += &[mark, &line, "\n"].concat();
                mark = if first.is_empty() { "" } else { "  " };
            }
        }
    }
    text
}

/// True if `help` has a page of this name.
fn is_page(name: &str) -> bool {
    PAGES.iter().any(|(page, ..)| *page == name)
}

/// A text without marks of emphasis and links; code keeps its marks.
fn inline(text: &str) -> String {
    let mut pieces = text.split('`');
    let mut shown = String::new();
    while let Some(words) = pieces.next() {
        shown += &words.replace('*', "");
        if let Some(code) = pieces.next() {
            shown += &["`", code, "`"].concat();
        }
    }
    let mut text = shown;
    while let Some((before, link)) = text.split_once("](") {
        let (Some((before, name)), Some((target, after))) =
            (before.rsplit_once('['), link.split_once(')'))
        else {
            break;
        };
        let page = target.split('#').next().unwrap_or_default();
        let shown = match page.strip_suffix(".md").filter(|page| is_page(page)) {
            Some(page) => format!("help {page}"),
            None if page.contains(':') => page.to_owned(),
            None => format!("docs/{page}"),
        };
        text = match name {
            name if target.starts_with('#') => format!("{before}{name}{after}"),
            name if page.ends_with(name) => format!("{before}{shown}{after}"),
            name => format!("{before}{name} ({shown}){after}"),
        };
    }
    text
}

/// A table with columns as wide as necessary, or narrower ones whose cells have several lines.
fn table(rows: &[&str]) -> String {
    let cells = |row: &&str| -> Vec<String> {
        row.trim_matches('|').split('|').map(|cell| inline(cell.trim())).collect()
    };
    let is_ruler = |row: &&str| row.chars().all(|c| "|-: ".contains(c)) && row.contains('-');
    let rows: Vec<_> = rows.iter().filter(|row| !is_ruler(row)).map(cells).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
    };
    // A column of one word each, such as names, stays as wide as the word.
    let least = |column: usize| {
        let words =
            rows.iter().filter_map(|row| row.get(column)?.split(' ').max_by_key(|own| own.len()));
        let longest = words.map(|word| word.chars().count()).max();
        longest.unwrap_or(0).clamp(NARROWEST, WIDTH / 2)
    };
    let mut widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    while widths.iter().sum::<usize>() + 2 * columns > WIDTH + 2 {
        let wide = widths.iter_mut().enumerate().filter(|(column, own)| **own > least(*column));
        match wide.max_by_key(|(_, own)| **own) {
            Some((_, widest)) => *widest -= 1,
            None => break,
        }
    }
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        let cells: Vec<_> =
            row.iter().zip(&widths).map(|(cell, width)| wrapped(cell, *width)).collect();
        let height = cells.iter().map(Vec::len).max().unwrap_or(0);
        for line in 0..height {
            let parts = cells.iter().zip(&widths).map(|(cell, width)| {
                format!("{:width$}", cell.get(line).map_or("", String::as_str))
            });
            text += parts.collect::<Vec<_>>().join("  ").trim_end();
            text.push('\n');
        }
        if number == 0 && height > 0 && row.iter().any(|cell| !cell.is_empty()) {
            let rulers: Vec<_> = widths.iter().map(|width| "-".repeat(*width)).collect();
            text += &(rulers.join("  ") + "\n");
        }
    }
    text
}

/// Lines of at most `width` letters, except for longer words.
pub(super) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // A percent sign stays with its number.
    for word in text.replace(" %", "\u{a0}%").split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| line.replace('\u{a0}', " ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_plain_text() {
        let page = "# Limits\n\nSee **the** [arms](arms.md#a), [ends.md](ends.md) or [above](#limits) for `EI*=4` \
                    and *more*.\n\n![A figure](a.svg)\n\n* one\n  and the same\n* two\n\n```toml\nx = [1]  # **\n```\n";
        let text = "Limits\n======\n\nSee the arms (help arms), help ends or above for `EI*=4` and more.\n\n\
                    * one and the same\n* two\n\n    x = [1]  # **\n";
        assert_eq!(terminal_text(page), text);
    }

    #[test]
    fn cells_of_wide_tables_have_several_lines() {
        let words = "word ".repeat(20);
        let text = terminal_text(&format!("| file | holds |\n|---|--:|\n| `a.csv` | {words}|\n"));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.starts_with("file     holds\n-------  ----"), "{text}");
        assert_eq!(text.lines().count(), 4, "{text}");
    }

    #[test]
    fn lines_of_the_pages_are_short_and_have_no_marks() {
        for (name, _, page) in PAGES {
            let text = terminal_text(page);
            assert!(!text.contains("]("), "{name}");
            // Code and printed results stay as they are.
            for line in text.lines().filter(|line| !line.starts_with("    ")) {
                assert!(line.chars().count() <= WIDTH, "{name}: {line}");
                // Python's `**motion` is code.
                assert!(!line.replace(", **", ", ").contains("**"), "{name}: {line}");
            }
        }
    }
}
