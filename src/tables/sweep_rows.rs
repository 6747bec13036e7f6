use csv::ReaderBuilder;

use super::encoding::remedy;
use super::sweep_identity::SweepIdentity;
use super::table_error::{Place, TableError, quoted};

/// The rows of a shard, or of a sweep that was interrupted, as read from its file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SweepRows {
    /// The file, as the user named it.
    pub(super) name: String,
    pub(super) identity: SweepIdentity,
    /// The row that names the columns, without its line end.
    pub(super) header: String,
    /// The other rows, likewise; one that was cut off in writing is left out.
    pub(super) rows: Vec<String>,
}

impl SweepRows {
    /// Reads the file of this name.
    ///
    /// # Errors
    /// [`TableError`] for a file that no sweep has written, or one with more rows than it may have.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, TableError> {
        let place = |line| Place { file: name, line: Some(line) };
        // Only whole lines count; the last one may have been cut within a letter.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let text = std::str::from_utf8(&bytes[..whole])
            .map_err(|_| place(1).refuse("text", "other bytes", "must be UTF-8"))
            .map_err(|error| error.with_hint(remedy(bytes).to_owned()))?;
        let mut lines = text.lines();
        let first = lines.next().unwrap_or_default();
        let (Some(identity), Some(header)) = (SweepIdentity::read(first), lines.next()) else {
            let must = "must be that of a shard, `# flexlink … sweep …`, and the names of columns";
            let hint = "a shard is written by flexlink sweep --shard I/N";
            let error = place(1).refuse("first line", quoted(first), must);
            return Err(error.with_hint(hint.to_owned()));
        };
        let rows: Vec<String> = lines.map(str::to_owned).collect();
        let width = fields(header).len();
        let ragged = (3..).zip(&rows).find(|(_, row)| fields(row).len() != width);
        if let Some((line, row)) = ragged {
            let must = format!("must be {width}, as many as there are columns");
            return Err(place(line).refuse("fields", fields(row).len().to_string(), must));
        }
        if rows.len() > identity.rows() {
            let must = format!("must be {}", identity.rows());
            let whole = Place { file: name, line: None };
            return Err(whole.refuse("rows", rows.len().to_string(), must));
        }
        Ok(Self { name: name.to_owned(), identity, header: header.to_owned(), rows })
    }

    /// The cases that failed: their numbers, from 0, and why.
    pub fn failures(&self) -> Vec<(usize, String)> {
        let error = |row: &String| fields(row).pop().filter(|error| !error.is_empty());
        let rows = self.rows.iter().enumerate();
        rows.filter_map(|(k, row)| Some((self.identity.shard.case(k), error(row)?))).collect()
    }

    /// How many rows are there.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether no row is there.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    fn refuse(&self, subject: &str, found: String, must: impl Into<String>) -> TableError {
        Place { file: &self.name, line: None }.refuse(subject, found, must)
    }
}

/// Joins the shards of a sweep to its table: every row of every shard, in the order of the cases.
///
/// # Errors
/// [`TableError`] names a shard that is of another sweep, that is there twice, that is not finished,
/// or those that are missing.
///
/// # Panics
/// Without a shard.
pub fn merge_shards(shards: &[SweepRows]) -> Result<String, TableError> {
    let first = &shards[0];
    let of = first.identity.shard.of();
    let mut ordered: Vec<Option<&SweepRows>> = vec![None; of];
    for shard in shards {
        if !shard.identity.is_of_sweep(&first.identity) || shard.header != first.header {
            let found = shard.identity.to_string();
            let must = format!("must be a shard of the same sweep as {}", first.name);
            return Err(shard.refuse("first line", quoted(&found), must));
        }
        let (found, must) = (shard.rows.len(), shard.identity.rows());
        if found != must {
            let hint = format!("finish it with --shard {} --resume", shard.identity.shard);
            let error = shard.refuse("rows", found.to_string(), format!("must be {must}"));
            return Err(error.with_hint(hint));
        }
        let earlier = ordered[shard.identity.shard.number() - 1].replace(shard);
        if let Some(earlier) = earlier {
            let must = format!("must not be that of {}, too", earlier.name);
            return Err(shard.refuse("shard", shard.identity.shard.to_string(), must));
        }
    }
    let there: Option<Vec<&SweepRows>> = ordered.iter().copied().collect();
    let Some(ordered) = there else {
        let missing = ordered.iter().enumerate().filter(|(_, shard)| shard.is_none());
        let missing: Vec<String> =
            missing.map(|(number, _)| format!("{}/{of}", number + 1)).collect();
        let found = format!("{} of {of}", shards.len());
        let must = format!("must be all: {} missing", told(&missing));
        return Err(first.refuse("shards", found, must));
    };
    let cases = first.identity.cases;
    let row = |case: usize| ordered[case % of].rows[case / of].as_str();
    let lines = std::iter::once(first.header.as_str()).chain((0..cases).map(row));
    Ok(lines.flat_map(|line| [line, "\n"]).collect())
}

/// The fields of one row; none where it is no CSV.
fn fields(row: &str) -> Vec<String> {
    let mut reader = ReaderBuilder::new().has_headers(false).from_reader(row.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map(|fields| fields.iter().map(str::to_owned).collect()).unwrap_or_default()
}

/// A list of a few, or how many there are.
fn told(missing: &[String]) -> String {
    match missing {
        [one] => format!("{one} is"),
        few if few.len() <= 8 => format!("{} are", few.join(", ")),
        many => format!("{}, … ({} in all) are", many[..8].join(", "), many.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Shard;

    /// The numbers of cases, each as a row.
    fn lines(cases: impl Iterator<Item = usize>) -> String {
        cases.map(|case| case.to_string() + "\n").collect()
    }

    fn shard(number: usize, of: usize, cases: usize) -> SweepRows {
        let shard: Shard = format!("{number}/{of}").parse().unwrap();
        let rows = lines((0..shard.len(cases)).map(|k| shard.case(k)));
        let first = format!("# flexlink 0.1.0 sweep 00ff, shard {shard} of {cases} cases");
        let text = format!("{first}\ncase\n{rows}");
        SweepRows::read(&format!("s{number}.csv"), text.as_bytes()).unwrap()
    }

    #[test]
    fn merged_rows_stand_in_the_order_of_the_cases() {
        for (of, cases) in [(3, 10), (4, 4), (1, 3), (5, 3)] {
            let mut shards: Vec<_> = (1..=of).map(|k| shard(k, of, cases)).collect();
            shards.reverse();
            let merged = merge_shards(&shards).unwrap();
            let expected = lines(0..cases);
            assert_eq!(merged, format!("case\n{expected}"), "{of} shards");
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
        assert_eq!(twice, "s2.csv: shard = 2/3, but must not be that of s2.csv, too");
        let mut cut = b.clone();
        cut.rows.pop();
        assert_eq!(refusal(&[a.clone(), cut, c.clone()]), "s2.csv: rows = 2, but must be 3");
        let other = shard(2, 4, 10);
        assert!(refusal(&[a, other, c]).contains("must be a shard of the same sweep as s1.csv"));
    }

    #[test]
    fn failed_cases_are_numbered_as_in_the_whole_sweep() {
        let first = "# flexlink 0.1.0 sweep 00ff, shard 2/2 of 6 cases";
        let text = format!("{first}\nx,error\n1,\n3,\"a, b\"\n5,\n");
        let rows = SweepRows::read("s", text.as_bytes()).unwrap();
        assert_eq!(rows.failures(), [(3, "a, b".to_owned())]);
    }

    #[test]
    fn a_row_cut_off_in_writing_does_not_count_and_one_too_many_is_refused() {
        let first = "# flexlink 0.1.0 sweep 00ff, shard 1/2 of 4 cases";
        let rows = SweepRows::read("s", format!("{first}\ncase\n0\n2").as_bytes()).unwrap();
        assert_eq!(rows.rows, ["0"]);
        let cut = [first.as_bytes(), b"\ncase\n0\n\xc3"].concat();
        assert_eq!(SweepRows::read("s", &cut).unwrap().rows, ["0"], "cut within a letter");
        let error = SweepRows::read("s", format!("{first}\ncase\n0\n2\n4\n").as_bytes());
        assert_eq!(error.unwrap_err().to_string(), "s: rows = 3, but must be 2");
        for (row, fields) in [("", 0), ("0,1", 2)] {
            let text = format!("{first}\ncase\n0\n{row}\n");
            let error = SweepRows::read("s", text.as_bytes()).unwrap_err().to_string();
            let expected = format!("s:4: fields = {fields}, but must be 1, as many as there are");
            assert!(error.starts_with(&expected), "{error}");
        }
        let error = SweepRows::read("s", b"time_s,torque_n_m\n0,1\n").unwrap_err();
        assert!(error.to_string().starts_with("s:1: first line = \"time_s,torque_n_m\", but must"));
    }
}
