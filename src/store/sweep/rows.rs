//! The rows of a sweep, read from a shard or an unfinished table.

use super::identity::SweepIdentity;
use super::table::{check_names, check_row, fields};
use crate::csv::{CHECK, Place, TableError, check_content, quoted, remedy};

/// Hint for a row that does not fit its case.
const NOT_AS_WRITTEN: &str = "a row was removed, doubled, moved or changed since it was written";

/// The rows of a shard, or of a sweep that was interrupted, as read from its file: each is that of
/// its own case.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRows {
    /// The file, as the user named it.
    pub(super) name: String,
    pub(super) identity: SweepIdentity,
    /// The row that names the columns, without its line end.
    pub(super) header: String,
    /// The other rows, likewise; one that was cut off in writing is left out.
    pub(super) rows: Vec<String>,
}

/// The fields of a row beside the numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SweptCase {
    /// Its number, from 0.
    pub number: usize,
    /// The kinds of its warnings.
    pub warnings: Vec<String>,
    /// Why it has no numbers, if it has none.
    pub error: Option<String>,
}

impl SweepRows {
    /// Reads the file of this name.
    ///
    /// # Errors
    /// [`TableError`] for a file that no sweep has written, one with more rows than it may have, or
    /// a row that is not that of its case.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, TableError> {
        let place = |line| Place { file: name, line: Some(line) };
        // The last line may have been cut off in writing, even within a letter.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let text = std::str::from_utf8(&bytes[..whole])
            .map_err(|error| {
                let good = &bytes[..error.valid_up_to()];
                let line = good.split(|byte| *byte == b'\n').count() as u64;
                let found = format!("byte 0x{:02x}", bytes[good.len()]);
                place(line).refuse("text", found, "must be UTF-8")
            })
            .map_err(|error| error.with_hint(remedy(bytes).to_owned()))?;
        let mut lines = text.lines();
        let identity = SweepIdentity::read_line(lines.next().unwrap_or_default(), place(1))?;
        let header = lines.next().unwrap_or_default();
        let header =
            header.strip_suffix(CHECK).and_then(|rest| rest.strip_suffix(',')).unwrap_or("");
        let names = fields(header);
        check_names(&identity, &names, place(2))?;
        let parted: Vec<(&str, &str)> =
            lines.map(|line| line.rsplit_once(',').unwrap_or((line, ""))).collect();
        for ((line, (row, check)), k) in (3..).zip(&parted).zip(0..identity.rows()) {
            check_row(&identity, &names, k, &fields(row), place(line))
                .and_then(|()| check_content(row, check, place(line)))
                .map_err(|error| error.or_hint(NOT_AS_WRITTEN.to_owned()))?;
        }
        let rows: Vec<String> = parted.iter().map(|(row, _)| (*row).to_owned()).collect();
        if rows.len() > identity.rows() {
            let must = format!("must be {}", identity.rows());
            let whole = Place { file: name, line: None };
            return Err(whole.refuse("rows", rows.len().to_string(), must));
        }
        Ok(Self { name: name.to_owned(), identity, header: header.to_owned(), rows })
    }

    /// Warnings and errors of the cases, in order.
    pub fn cases(&self) -> impl Iterator<Item = SweptCase> {
        let shard = self.identity.shard();
        self.rows.iter().enumerate().map(move |(k, row)| {
            let mut fields = fields(row);
            let error = fields.pop().filter(|error| !error.is_empty());
            let kinds = fields.pop().unwrap_or_default();
            let kinds = kinds.split(';').filter(|kind| !kind.is_empty());
            SweptCase { number: shard.case(k), warnings: kinds.map(str::to_owned).collect(), error }
        })
    }

    /// The sweep whose rows they are.
    pub fn identity(&self) -> &SweepIdentity {
        &self.identity
    }

    /// How many rows are there.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether no row is there.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Refuses rows of another sweep than `own`, or with other columns than those of `header`; `of` tells
    /// whose these are.
    pub(super) fn check_same(
        &self,
        own: &SweepIdentity,
        header: &str,
        of: &str,
    ) -> Result<(), TableError> {
        let place = |line| Place { file: &self.name, line: Some(line) };
        self.identity.check_same(own, place(1), of)?;
        if self.header == header {
            return Ok(());
        }
        let must = format!("must be {} as {of}", quoted(header));
        Err(place(2).refuse("columns", quoted(&self.header), must))
    }

    pub(super) fn refuse(
        &self,
        subject: &str,
        found: String,
        must: impl Into<String>,
    ) -> TableError {
        Place { file: &self.name, line: None }.refuse(subject, found, must)
    }
}

#[cfg(test)]
pub(super) const HEADER: &str = "x,told,warnings,error\n";

/// A file with these rows of the shard of a sweep over x = 1, 2, 3, …
#[cfg(test)]
pub(super) fn file(shard: &str, cases: usize, rows: &str) -> String {
    use crate::csv::{checked_header, checked_rows};
    let identity =
        super::identity::identity_of("link", &[], &format!("x=1:{cases}:{cases}"), shard);
    identity.line() + &checked_header(HEADER) + &checked_rows(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Why the second shard of three of ten cases, 2, 5, 8, is refused with these rows.
    fn row_refusal(rows: &str) -> (String, Option<String>) {
        let error = SweepRows::read("s", file("2/3", 10, rows).as_bytes()).unwrap_err();
        (error.to_string(), error.hint().map(str::to_owned))
    }

    #[test]
    fn a_row_that_is_not_that_of_its_case_is_refused_with_its_column() {
        let of_case = |line, found, must, case| {
            format!("s:{line}: x = \"{found}\", but must be \"{must}\", the value of case {case}")
        };
        for (what, rows, message) in [
            ("removed", "2,1,,\n8,1,,\n", of_case(4, "8", "5", 5)),
            ("doubled", "2,1,,\n2,1,,\n5,1,,\n", of_case(4, "2", "5", 5)),
            (
                "doubled at the end",
                "2,1,,\n5,1,,\n8,1,,\n8,1,,\n",
                "s: rows = 4, but must be 3".into(),
            ),
            ("swapped", "5,1,,\n2,1,,\n8,1,,\n", of_case(3, "5", "2", 2)),
            ("changed", "2,1,,\n5.0,1,,\n8,1,,\n", of_case(4, "5.0", "5", 5)),
            (
                "no number",
                "2,nan,,\n",
                "s:3: told = \"nan\", but must be a finite number or nothing".into(),
            ),
            (
                "a number of a failed case",
                "2,1,,no\n",
                "s:3: told = \"1\", but must be nothing: the case has an error".into(),
            ),
        ] {
            let (found, hint) = row_refusal(rows);
            assert_eq!(found, message, "{what}");
            assert!(hint.is_none_or(|hint| hint == NOT_AS_WRITTEN), "{what}");
        }
    }

    #[test]
    fn a_number_that_was_changed_is_refused_with_its_line() {
        let text = file("2/3", 10, "2,0.5,,\n5,0.25,,\n").replace("0.25", "0.26");
        let error = SweepRows::read("s", text.as_bytes()).unwrap_err();
        let told = error.to_string();
        assert!(told.starts_with("s:4: check = \"") && told.ends_with("\" for this row"), "{told}");
        assert_eq!(error.hint(), Some(NOT_AS_WRITTEN));
    }

    #[test]
    fn a_byte_that_is_no_text_is_named_with_its_line() {
        let bytes = [file("2/3", 10, "2,1,,\n").as_bytes(), b"5,\xff,,,0\n"].concat();
        let error = SweepRows::read("s", &bytes).unwrap_err();
        assert_eq!(error.to_string(), "s:4: text = byte 0xff, but must be UTF-8");
    }

    #[test]
    fn columns_of_another_sweep_are_refused() {
        for (header, message) in [
            ("y,told,warnings,error", "s:2: column 1 = \"y\", but must be \"x\""),
            ("", "s:2: column 1 = \"\", but must be \"x\""),
            ("x,told,error", "s:2: columns = \"x,told,error\", but must end with warnings, error"),
        ] {
            let text = file("2/3", 10, "").replace(HEADER.trim_end(), header);
            let text = if header.is_empty() { text.replace(",check", "") } else { text };
            let error = SweepRows::read("s", text.as_bytes()).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn what_rows_say_of_their_cases_is_numbered_as_in_the_whole_sweep() {
        let text = file("2/2", 6, "2,1,a;b:c,\n4,,,\"a, b\"\n6,1,,\n");
        let rows = SweepRows::read("s", text.as_bytes()).unwrap();
        let case = |number, warnings: &[&str], error: Option<&str>| SweptCase {
            number,
            warnings: warnings.iter().map(|kind| (*kind).to_owned()).collect(),
            error: error.map(str::to_owned),
        };
        let expected =
            [case(1, &["a", "b:c"], None), case(3, &[], Some("a, b")), case(5, &[], None)];
        assert!(rows.cases().eq(expected));
    }

    #[test]
    fn a_row_cut_off_in_writing_does_not_count_and_one_too_many_fields_are_refused() {
        let cut = file("1/2", 4, "1,1,,\n3");
        assert_eq!(SweepRows::read("s", cut.as_bytes()).unwrap().rows, ["1,1,,"]);
        let cut = [file("1/2", 4, "1,1,,\n").as_bytes(), b"\xc3"].concat();
        assert_eq!(SweepRows::read("s", &cut).unwrap().rows, ["1,1,,"], "cut within a letter");
        for (row, fields) in [("", 0), ("2,1,,,", 5)] {
            let (found, _) = row_refusal(&format!("{row}\n"));
            let expected = format!("s:3: fields = {fields}, but must be 4, as many as there are");
            assert!(found.starts_with(&expected), "{found}");
        }
    }
}
