//! The table of a sweep and the record beside it, stiffness.json beside stiffness.csv: written and read.

use std::borrow::Borrow;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};

use super::super::files::{NamedBy, is_stream, record_beside, write_file};
use super::super::folder::{Durability, FolderError};
use super::super::json::{Fingerprint, unreadable};
use super::super::summary::RESULTS;
use super::identity::{SweepIdentity, is_record};
use super::table::{ERROR, WARNINGS};
use crate::compare::{Cell, Table};
use crate::csv::{CHECK, InputFile, Place, TableError, quoted, read_table, sha256};
use crate::link::MotorKnown;
use crate::result::StoredSweep;
use crate::spec::unit_of_key;
use crate::sweep::SweepKind;

/// The first column after the varied values: of a link, and of an arm.
const FIRST: &str = "period_1_s";
const FIRST_OF_ARM: &str = "zero_1_per_s";

/// Bytes of the longest readable row of names.
const LONGEST_HEADER: u64 = 1 << 20;

/// Path of the record of a table.
pub(super) fn record_of(table: &Path) -> PathBuf {
    record_beside(table, "csv")
}

/// Path of the file with the rows of an incomplete table.
pub(super) fn part_of(table: &Path) -> PathBuf {
    let mut name = table.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// The files of a sweep for a table: the table, its record, and the rows until they are complete.
pub fn sweep_files(table: &Path) -> [PathBuf; 3] {
    [table.to_owned(), record_of(table), part_of(table)]
}

/// A file that a table's record must not replace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ForeignRecord {
    /// Where it lies.
    pub path: PathBuf,
    /// Kind of the file, for messages.
    pub what: String,
}

impl ForeignRecord {
    /// The file in the place of the record of `table`, unless it is an earlier record of the same table.
    pub fn beside(table: &Path) -> Option<Self> {
        let path = record_of(table);
        path.symlink_metadata().ok()?;
        let Some(file) = record_file(&path) else {
            return Some(Self { path, what: "a file that no sweep has written".to_owned() });
        };
        let place = Place { file: &file.shown, line: None };
        let record = SweepIdentity::read(&file.bytes, place).ok()?;
        let own = &record.table()?.name;
        let other = table.with_file_name(own);
        // A table that was renamed with its record remains the same.
        let is_other = other.file_name() != table.file_name() && record_of(&other) == path;
        (is_other && other.exists()).then(|| Self { path, what: format!("the record of {own}") })
    }
}

/// Writes the table of a sweep, and its record beside it, except beside a device or a pipe.
///
/// # Errors
/// [`FolderError`] if one of them cannot be written. If another file has the place of the record, writes neither.
pub fn write_sweep(
    path: &Path,
    named_by: NamedBy,
    table: &[u8],
    identity: &SweepIdentity,
    durability: Durability,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    if named_by == NamedBy::User && is_stream(path) {
        return write_file(path, named_by, durability, |out| out.write_all(table), on_wait);
    }
    if let Some(foreign) = ForeignRecord::beside(path) {
        let cause = io::Error::other(format!("it would replace {}", foreign.what));
        return Err(FolderError::of_file(&foreign.path, cause));
    }
    write_file(path, named_by, durability, |out| out.write_all(table), on_wait)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let json = identity.json(Fingerprint { name, sha256: sha256(table) });
    let record = record_of(path);
    write_file(&record, NamedBy::Program, durability, |out| out.write_all(json.as_bytes()), on_wait)
}

/// The file at `path`, if it is the record of a sweep.
fn record_file(path: &Path) -> Option<InputFile> {
    let file = if path.is_file() { InputFile::read(path).ok() } else { None };
    file.filter(|file| is_record(&file.bytes))
}

/// The record beside a table; `None` without a record.
///
/// # Errors
/// [`TableError`] for a record that is damaged, of another version's format, or of another table.
pub(super) fn read_record(
    path: &Path,
    table: &InputFile,
) -> Result<Option<SweepIdentity>, TableError> {
    let Some(file) = record_file(&record_of(path)) else { return Ok(None) };
    let place = Place { file: &file.shown, line: None };
    let identity = SweepIdentity::read(&file.bytes, place)?;
    let found = identity.table().map_or("", |table| &table.sha256);
    let must = table.sha256();
    if found != must {
        let must = format!("must be {}, that of {}", quoted(&must), table.name);
        let hint =
            format!("the table has changed since; without {} it is taken as it is", file.name);
        return Err(place.refuse("table.sha256", quoted(found), must).with_hint(hint));
    }
    Ok(Some(identity))
}

/// Reads the table of a sweep at `path`, and the record beside it.
///
/// # Errors
/// [`TableError`] names the missing or damaged part of the table, or its difference from the record.
pub(in crate::files::store) fn read_sweep(path: &Path) -> Result<StoredSweep, TableError> {
    let file = &InputFile::read(path).map_err(|error| unreadable(&error))?;
    let table = read_table(&file.shown, &file.bytes);
    let is_table = file.name.to_lowercase().ends_with(".csv") || file.name == "-";
    let mut table =
        table.map_err(|error| if is_table { error } else { error.or_hint(RESULTS.to_owned()) })?;
    // That of a shard.
    table.columns.pop_if(|column| column.name() == CHECK);
    let place = Place { file: &file.shown, line: None };
    let names: Vec<&str> = table.names().collect();
    let varied = check_columns(&names, place)?;
    if table.lines.is_empty() {
        return Err(place.refuse_whole("the table has no cases, but must have at least one"));
    }
    check_cells(&table, varied, place)?;
    let record = read_record(path, file)?;
    let links = record.as_ref().map(SweepIdentity::links).unwrap_or_default();
    let limits = record.as_ref().map(SweepIdentity::limits).unwrap_or_default();
    let origin = record.map(|record| record.origin());
    let units = table.names().take(varied).map(|name| unit_of_key(name).unwrap_or_default());
    let units = units.collect();
    Ok(StoredSweep { name: file.name.clone(), origin, links, limits, units, table })
}

/// Number of the columns of varied values.
fn check_columns(names: &[&str], place: Place) -> Result<usize, TableError> {
    let place_of = |first: &str| names.iter().position(|name| *name == first);
    let varied = place_of(FIRST).or_else(|| place_of(FIRST_OF_ARM)).unwrap_or(0);
    if varied == 0 {
        let must = format!("must be those of a sweep: values varied, {FIRST}, …, {ERROR}");
        let error = place.refuse("columns", quoted(&names.join(",")), must);
        return Err(error.with_hint(RESULTS.to_owned()));
    }
    let joints = joints_of(names);
    let slides = names.contains(&"peak_force_n")
        || names.contains(&"peak_power_w") && !names.contains(&"peak_hub_rate_rad_s");
    let motors = [MotorKnown::Voltage, MotorKnown::Current, MotorKnown::Torque];
    let motors = || motors.into_iter().map(Some).chain([None]);
    let solved = |joints| motors().map(move |motor| SweepKind::Solved { joints, motor, slides });
    let played =
        |joints| [true, false].map(|is_open| SweepKind::Played { joints, slides, is_open });
    let kinds = solved(1).chain(played(1)).chain(solved(joints)).chain(played(joints));
    let names_of =
        |kind: SweepKind| [kind.names(), [WARNINGS, ERROR].map(str::to_owned).into()].concat();
    let known: Vec<_> = kinds.map(names_of).collect();
    let found = &names[varied..];
    if known.iter().any(|known| known == found) {
        return Ok(varied);
    }
    // The error names the kind of sweep that shares more names.
    let is_known = |known: &[String], name: &str| known.iter().any(|own| own == name);
    let shared = |known: &&Vec<String>| found.iter().filter(|name| is_known(known, name)).count();
    let known = known.iter().max_by_key(shared).map_or(&[][..], |known| known);
    let must = format!("must be {}", quoted_all(known));
    if !found.contains(&WARNINGS) {
        let error = place.refuse_whole(&format!("the column {WARNINGS} is missing"));
        let hint = "an older flexlink wrote it: run the sweep again";
        return Err(error.with_hint(hint.to_owned()));
    }
    if let Some(stray) = found.iter().position(|name| !is_known(known, name)) {
        return Err(place.refuse_column(varied + stray, found[stray], must));
    }
    let error = place.refuse(format!("columns from {FIRST} on"), quoted_all(found), must);
    Err(error.with_hint("if an older flexlink wrote it, run the sweep again".to_owned()))
}

/// Number of joints with these columns.
fn joints_of(names: &[&str]) -> usize {
    let joints = (1..).take_while(|joint| {
        let first = format!("peak_torque{joint}_n_m");
        names.contains(&&first[..])
    });
    joints.count()
}

fn quoted_all<S: Borrow<str>>(names: &[S]) -> String {
    format!("\"{}\"", names.join(","))
}

/// Refuses a field behind the varied values that is neither empty nor a finite number.
fn check_cells(table: &Table, varied: usize, place: Place) -> Result<(), TableError> {
    for column in &table.columns[varied..table.columns.len() - 2] {
        for (row, line) in table.lines.iter().enumerate() {
            let found = match column.cell(row) {
                Cell::Word("") => continue,
                Cell::Number(number) if number.is_finite() => continue,
                Cell::Number(number) => number.to_string(),
                Cell::Word(word) => quoted(word),
            };
            let place = Place { line: Some(*line), ..place };
            return Err(place.refuse(column.name(), found, "must be a finite number or nothing"));
        }
    }
    Ok(())
}

/// Whether a file begins with the row of names of a sweep.
pub(in crate::files::store) fn is_sweep(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let lines = BufReader::new(file.take(LONGEST_HEADER)).lines();
    let header = lines.map_while(Result::ok).find(|line| !line.starts_with('#'));
    header.is_some_and(|header| {
        let header = header.trim_end();
        let begins = |first: &str| header.contains(&format!(",{first},"));
        (begins(FIRST) || begins(FIRST_OF_ARM)) && header.ends_with(&format!(",{ERROR}"))
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::identity::identity_of;
    use super::*;

    #[test]
    fn a_record_has_the_name_of_its_table_and_never_its_place() {
        for (table, record) in [
            ("a/stiffness.csv", "a/stiffness.json"),
            ("s.2.CSV", "s.2.json"),
            ("s.2", "s.2.json"),
            ("sweep", "sweep.json"),
            ("sweep.json", "sweep.json.json"),
        ] {
            assert_eq!(record_of(Path::new(table)), Path::new(record));
        }
    }

    #[test]
    fn a_record_is_read_back_with_its_own_table_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.csv");
        let identity = identity_of("link", &[], "x=1,2", "1/1");
        write_sweep(&path, NamedBy::User, b"x\n1\n2\n", &identity, Durability::InMemory, &|_| {})
            .unwrap();
        let read = || read_record(&path, &InputFile::read(&path).unwrap());
        assert!(
            read()
                .unwrap()
                .unwrap()
                .check_same(&identity, Place { file: "", line: None }, "")
                .is_ok()
        );
        fs::write(&path, "x\n1\n3\n").unwrap();
        let error = read().unwrap_err();
        assert!(error.to_string().contains("s.json: table.sha256 = \""), "{error}");
        fs::remove_file(folder.path().join("s.json")).unwrap();
        assert_eq!(read().unwrap(), None);
    }

    #[test]
    fn a_file_of_someone_else_is_neither_written_over_nor_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.csv");
        let mine = folder.path().join("s.json");
        let identity = identity_of("link", &[], "x=1,2", "1/1");
        for content in ["{\"flexlink\": \"0.1.0\", \"command\": \"solve\"}", "notes", ""] {
            fs::write(&mine, content).unwrap();
            let found = ForeignRecord::beside(&path).map(|foreign| foreign.path);
            assert_eq!(found.as_ref(), Some(&mine));
            let error =
                write_sweep(&path, NamedBy::User, b"x\n", &identity, Durability::InMemory, &|_| {})
                    .unwrap_err();
            assert!(
                error.to_string().ends_with("it would replace a file that no sweep has written"),
                "{error}"
            );
            assert_eq!(fs::read_to_string(&mine).unwrap(), content);
            assert!(!path.exists());
            let table = InputFile { shown: "s".into(), name: "s".into(), bytes: vec![] };
            assert_eq!(read_record(&path, &table).unwrap(), None);
        }
        fs::write(&mine, "{\"flexlink\": \"0.1.0\", \"command\": \"sweep\"}").unwrap();
        assert_eq!(ForeignRecord::beside(&path), None, "an earlier sweep's");
    }

    #[test]
    fn the_record_of_another_table_is_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let identity = identity_of("link", &[], "x=1,2", "1/1");
        let write = |name| {
            write_sweep(&at(name), NamedBy::User, b"x\n", &identity, Durability::InMemory, &|_| {})
        };
        write("two").unwrap();
        write("two").unwrap();
        let error = write("two.csv").unwrap_err();
        assert!(error.to_string().ends_with("it would replace the record of two"), "{error}");
        assert!(!at("two.csv").exists());
        for end in ["", ".json"] {
            fs::rename(at(&format!("two{end}")), at(&format!("new{end}"))).unwrap();
        }
        write("new").unwrap();
    }
}
