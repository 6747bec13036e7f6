//! The rows of a sweep, read from a shard or an unfinished table; shards joined to a table.

use std::path::Path;

use super::super::json::unreadable;
use super::identity::SweepIdentity;
use super::record::read_record;
use super::table::{check_names, check_row, fields};
use crate::csv::{CHECK, InputFile, Place, TableError, check_content, quoted, utf8};

/// Hint for a row that does not fit its case.
const NOT_AS_WRITTEN: &str = "a row was removed, doubled, moved or changed since it was written";

/// The rows of a shard, or of an interrupted sweep, from its file. Each row matches its case.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRows {
    /// The file, as the user named it.
    name: String,
    identity: SweepIdentity,
    /// The row that names the columns, without its line end.
    header: String,
    /// The other rows, likewise, without a row that an interruption cut off.
    rows: Vec<String>,
}

/// The fields of a row beside the numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SweptCase {
    /// Its number, from 0.
    pub number: usize,
    /// The kinds of its warnings.
    pub warnings: Vec<String>,
    /// Error of a case without numbers.
    pub error: Option<String>,
}

impl SweepRows {
    /// Reads a shard. A copy without its record is accepted.
    ///
    /// # Errors
    /// [`TableError`] as [`SweepRows::read`], and for a shard that has changed since its record was written.
    pub fn of_shard(path: &Path) -> Result<Self, TableError> {
        let file = InputFile::read(path).map_err(|error| unreadable(&error))?;
        let rows = Self::read(&file.shown, &file.bytes)?;
        read_record(path, &file)?;
        Ok(rows)
    }

    /// Reads the file of this name.
    ///
    /// # Errors
    /// [`TableError`] for a file that no sweep has written, one with too many rows, or a row that does not match its
    /// case.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, TableError> {
        let place = |line| Place { file: name, line: Some(line) };
        // An interruption may have cut off the last line, even within a letter.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let text = utf8(name, &bytes[..whole])?;
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

    /// The sweep of the rows.
    pub fn identity(&self) -> &SweepIdentity {
        &self.identity
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Refuses rows of another sweep than `own`, or with other columns than `header`; `of` names the source of both.
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

    /// The file as a whole.
    fn place(&self) -> Place<'_> {
        Place { file: &self.name, line: None }
    }
}

/// Joins the shards of a sweep to its table: every row of every shard, in the order of the cases.
///
/// # Errors
/// [`TableError`] names a shard of another sweep, a duplicate or unfinished shard, or the missing ones.
pub fn merge_shards(shards: &[SweepRows]) -> Result<String, TableError> {
    let Some(first) = shards.first() else {
        let place = Place { file: "shards", line: None };
        return Err(place.refuse_whole("must be one file or more"));
    };
    let of = first.identity.shard().of();
    let mut ordered: Vec<Option<&SweepRows>> = vec![None; of];
    for shard in shards {
        check_shard(shard, first)?;
        let earlier = ordered[shard.identity.shard().number() - 1].replace(shard);
        if let Some(earlier) = earlier {
            if earlier.name == shard.name {
                return Err(shard.place().refuse_whole("is named twice"));
            }
            let must = format!("must be another one than that of {}", earlier.name);
            return Err(shard.place().refuse("shard", shard.identity.shard().to_string(), must));
        }
    }
    let there: Option<Vec<&SweepRows>> = ordered.iter().copied().collect();
    let Some(ordered) = there else {
        let missing = ordered.iter().enumerate().filter(|(_, shard)| shard.is_none());
        let missing: Vec<String> =
            missing.map(|(number, _)| format!("{}/{of}", number + 1)).collect();
        let found = format!("{} of {of}", shards.len());
        let must = format!("must be all: {} missing", listed(&missing));
        return Err(first.place().refuse("shards", found, must));
    };
    let cases = first.identity.plan().cases();
    let row = |case: usize| ordered[case % of].rows[case / of].as_str();
    let lines = std::iter::once(first.header.as_str()).chain((0..cases).map(row));
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}

/// Refuses a shard of another sweep than the `first` one, and an unfinished shard.
fn check_shard(shard: &SweepRows, first: &SweepRows) -> Result<(), TableError> {
    shard.check_same(&first.identity, &first.header, &format!("in {}", first.name))?;
    let (own, of) = (shard.identity.shard(), first.identity.shard().of());
    if own.of() != of {
        let must = format!("must be one of {of} as in {}", first.name);
        let place = Place { file: &shard.name, line: Some(1) };
        return Err(place.refuse("shard", own.to_string(), must));
    }
    let (found, must) = (shard.rows.len(), shard.identity.rows());
    if found != must {
        let hint = format!("finish it with --shard {own} --resume");
        let error = shard.place().refuse("rows", found.to_string(), format!("must be {must}"));
        return Err(error.with_hint(hint));
    }
    Ok(())
}

/// A list of a few, or the first of many and their number.
fn listed(missing: &[String]) -> String {
    match missing {
        [one] => format!("{one} is"),
        few if few.len() <= 8 => format!("{} are", few.join(", ")),
        many => format!("{}, … ({} in all) are", many[..8].join(", "), many.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::identity::identity_of;
    use super::*;
    use crate::csv::{checked_header, checked_rows};

    const HEADER: &str = "x,peak,warnings,error\n";

    /// A file with these rows of the shard of a sweep over x = 1, 2, 3, …
    fn file(shard: &str, cases: usize, rows: &str) -> String {
        let identity = identity_of("link", &[], &format!("x=1:{cases}:{cases}"), shard);
        identity.line() + &checked_header(HEADER) + &checked_rows(rows)
    }

    /// Error of the second shard of three of ten cases, 2, 5, 8, with these rows.
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
                "s:3: peak = \"nan\", but must be a finite number or nothing".into(),
            ),
            (
                "a number of a failed case",
                "2,1,,no\n",
                "s:3: peak = \"1\", but must be nothing: the case has an error".into(),
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
        let text = error.to_string();
        assert!(text.starts_with("s:4: check = \"") && text.ends_with("\" for this row"), "{text}");
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
            ("y,peak,warnings,error", "s:2: column 1 = \"y\", but must be \"x\""),
            ("", "s:2: column 1 = \"\", but must be \"x\""),
            ("x,peak,error", "s:2: columns = \"x,peak,error\", but must end with warnings, error"),
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

    /// The rows of all cases of a shard.
    fn rows(shard: &SweepIdentity) -> String {
        let cases = (0..shard.rows()).map(|k| shard.shard().case(k) + 1);
        cases.map(|case| case.to_string() + ",0.5,,\n").collect()
    }

    fn shard(number: usize, of: usize, cases: usize) -> SweepRows {
        let shard = format!("{number}/{of}");
        let identity = identity_of("link", &[], &format!("x=1:{cases}:{cases}"), &shard);
        let text = file(&shard, cases, &rows(&identity));
        SweepRows::read(&format!("s{number}.csv"), text.as_bytes()).unwrap()
    }

    #[test]
    fn merged_rows_stand_in_the_order_of_the_cases() {
        for (of, cases) in [(3, 10), (4, 4), (1, 3), (5, 3)] {
            let mut shards: Vec<_> = (1..=of).map(|k| shard(k, of, cases)).collect();
            shards.reverse();
            let merged = merge_shards(&shards).unwrap();
            let whole = identity_of("link", &[], &format!("x=1:{cases}:{cases}"), "1/1");
            assert_eq!(merged, HEADER.to_owned() + &rows(&whole), "{of} shards");
        }
    }

    fn refusal(shards: &[SweepRows]) -> String {
        merge_shards(shards).unwrap_err().to_string()
    }

    #[test]
    fn a_missing_a_second_and_an_unfinished_shard_are_refused() {
        let [a, b, c] = [1, 2, 3].map(|k| shard(k, 3, 10));
        let missing = refusal(&[c.clone(), a.clone()]);
        assert_eq!(missing, "s3.csv: shards = 2 of 3, but must be all: 2/3 is missing");
        let twice = refusal(&[a.clone(), b.clone(), b.clone(), c.clone()]);
        assert_eq!(twice, "s2.csv: is named twice");
        let copy = SweepRows { name: "copy.csv".into(), ..b.clone() };
        let twice = refusal(&[a.clone(), b.clone(), copy]);
        assert_eq!(twice, "copy.csv: shard = 2/3, but must be another one than that of s2.csv");
        let mut cut = b.clone();
        cut.rows.pop();
        assert_eq!(refusal(&[a.clone(), cut, c.clone()]), "s2.csv: rows = 2, but must be 3");
        let mut renamed = b.clone();
        renamed.header = HEADER.trim_end().replace("peak", "other");
        assert!(
            refusal(&[a.clone(), renamed, c.clone()]).starts_with("s2.csv:2: columns = \"x,other")
        );
        let other = shard(2, 4, 10);
        let words = "s2.csv:1: shard = 2/4, but must be one of 3 as in s1.csv";
        assert_eq!(refusal(&[a, other, c]), words);
    }
}
