//! What `solve --repeat` prints.

use std::path::Path;

use flexlink::result::{LineDifference, Repeated, RepeatedFile};

/// Characters of a line that are told before the first one that differs, and in all.
const BEFORE: usize = 20;
const IN_ALL: usize = 48;

/// A line a file that is not the same, and what came of all.
pub(crate) fn repetition_text(files: &[RepeatedFile], run: &Path, kept: Option<&Path>) -> String {
    let (all, run) = (files.len(), run.display());
    let lines: Vec<String> = files.iter().filter_map(file_line).collect();
    let result = match lines.len() {
        0 => format!("same     {all} files of {run}, byte for byte\n"),
        differ => format!("result   {differ} of {all} files of {run} not the same\n"),
    };
    let kept = kept.map(|folder| format!("written  {}\n", folder.display()));
    lines.into_iter().chain([result]).chain(kept).collect()
}

fn file_line(file: &RepeatedFile) -> Option<String> {
    let name = &file.name;
    match &file.outcome {
        Repeated::Same => None,
        Repeated::Missing => Some(format!("missing  {name}: the run wrote it\n")),
        Repeated::Extra => Some(format!("extra    {name}: the run does not write it\n")),
        Repeated::Differs(found) => {
            let LineDifference { line, differing, lines, run, repetition } = found;
            let told = |own: &Option<Vec<u8>>, other: &Option<Vec<u8>>| match own {
                Some(text) => excerpt(text, other.as_deref().unwrap_or_default()),
                None => "nothing".to_owned(),
            };
            let (was, now) = (told(run, repetition), told(repetition, run));
            let place = format!("line {line}, {differing} of {lines} in all");
            Some(format!("differs  {name}: {place}: was {was}, now {now}\n"))
        }
    }
}

/// A line about the first character in which it differs from another one.
fn excerpt(line: &[u8], other: &[u8]) -> String {
    let [text, other] = [line, other].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    let same = text.chars().zip(other.chars()).take_while(|(a, b)| a == b).count();
    // The line end is told where it is what differs.
    let content = text.trim_end_matches(['\r', '\n']);
    let is_content = same < content.chars().count();
    let text = if is_content { content } else { text.as_str() };
    let start = same.saturating_sub(BEFORE);
    let shown: String = text.chars().skip(start).take(IN_ALL).collect();
    let before = if start > 0 { "…" } else { "" };
    let after = if text.chars().nth(start + IN_ALL).is_some() { "…" } else { "" };
    format!("\"{before}{}{after}\"", shown.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_is_told_where_it_differs() {
        let line = |number: &str| format!("{}{number}{}\n", "0,".repeat(100), ",1".repeat(100));
        let (a, b) = (line("7"), line("8"));
        let expected = format!("\"…{}7{},…\"", "0,".repeat(10), ",1".repeat(13));
        assert_eq!(excerpt(a.as_bytes(), b.as_bytes()), expected);
        assert_eq!(excerpt(b"1,2\n", b"1,3\n"), "\"1,2\"");
    }

    #[test]
    fn a_line_end_is_told_where_nothing_else_differs() {
        assert_eq!(excerpt(b"1\r\n", b"1\n"), "\"1\\r\\n\"");
        assert_eq!(excerpt(b"1\n", b"1"), "\"1\\n\"");
        assert_eq!(excerpt(b"1", b"1\n"), "\"1\"");
        assert_eq!(excerpt(b"1,\xff\n", b"1,2\n"), "\"1,\u{fffd}\"");
    }
}
