//! The record beside the table of a sweep: stiffness.json beside stiffness.csv.

use std::io;
use std::path::{Path, PathBuf};

use super::super::folder::{Durability, FolderError};
use super::super::json::Fingerprint;
use super::super::single_file::{is_stream, write_file};
use super::identity::{SweepIdentity, is_record};
use crate::csv::{InputFile, Place, TableError, quoted, sha256};

/// Where the record of a table lies.
pub(super) fn record_of(table: &Path) -> PathBuf {
    if table.extension().is_some_and(|end| end.eq_ignore_ascii_case("csv")) {
        return table.with_extension("json");
    }
    let mut name = table.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// Path of the file that holds the rows of a table until they are complete.
pub(super) fn part_of(table: &Path) -> PathBuf {
    let mut name = table.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// The files that a sweep writes for a table: itself, its record, and the rows until they are
/// complete.
pub fn sweep_files(table: &Path) -> [PathBuf; 3] {
    [table.to_owned(), record_of(table), part_of(table)]
}

/// A file that a table's record must not replace.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ForeignRecord {
    /// Where it lies.
    pub path: PathBuf,
    /// The table of which it is the record; none for a file that no sweep has written.
    pub table: Option<String>,
}

impl ForeignRecord {
    /// The file in the place of the record of `table`, if it is not an earlier one of the same table.
    pub fn beside(table: &Path) -> Option<Self> {
        let path = record_of(table);
        path.symlink_metadata().ok()?;
        let file = if path.is_file() { InputFile::read(&path).ok() } else { None };
        let Some(file) = file.filter(|file| is_record(&file.bytes)) else {
            return Some(Self { path, table: None });
        };
        let place = Place { file: &file.shown, line: None };
        let record = SweepIdentity::read(&file.bytes, place).ok()?;
        let own = &record.table()?.name;
        let other = table.with_file_name(own);
        // A table that was renamed with its record is no other one.
        let is_other = other.file_name() != table.file_name() && record_of(&other) == path;
        (is_other && other.exists()).then(|| Self { path, table: Some(own.clone()) })
    }

    /// A description for messages.
    pub fn what(&self) -> String {
        match &self.table {
            Some(table) => format!("the record of {table}"),
            None => "a file that no sweep has written".to_owned(),
        }
    }
}

/// Writes the table of a sweep, and its record beside it; a device or a pipe has none.
///
/// # Errors
/// [`FolderError`] if one of them cannot be written, or another file has the place of the record;
/// then neither is.
pub fn write_sweep(
    path: &Path,
    table: &[u8],
    identity: &SweepIdentity,
    durability: Durability,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    if is_stream(path) {
        return write_file(path, durability, |out| out.write_all(table), on_wait);
    }
    if let Some(foreign) = ForeignRecord::beside(path) {
        let cause = io::Error::other(format!("it would replace {}", foreign.what()));
        return Err(FolderError::of_file(&foreign.path, cause));
    }
    write_file(path, durability, |out| out.write_all(table), on_wait)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let json = identity.json(Fingerprint { name, sha256: sha256(table) });
    write_file(&record_of(path), durability, |out| out.write_all(json.as_bytes()), on_wait)
}

/// Refuses a shard that has changed since its record was written beside it; one that was copied
/// without its record is taken.
///
/// # Errors
/// [`TableError`] for such a shard, and for a record that is damaged or of another format.
pub fn check_record(path: &Path, shard: &InputFile) -> Result<(), TableError> {
    read_record(path, shard).map(drop)
}

/// The record beside a table that was read; none where there is none.
///
/// # Errors
/// [`TableError`] for a record that is damaged, of another version's format, or of another table.
pub(in crate::store) fn read_record(
    path: &Path,
    table: &InputFile,
) -> Result<Option<SweepIdentity>, TableError> {
    let path = record_of(path);
    if !path.is_file() {
        return Ok(None);
    }
    let Ok(file) = InputFile::read(&path) else { return Ok(None) };
    if !is_record(&file.bytes) {
        return Ok(None);
    }
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
        write_sweep(&path, b"x\n1\n2\n", &identity, Durability::InMemory, &|_| {}).unwrap();
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
                write_sweep(&path, b"x\n", &identity, Durability::InMemory, &|_| {}).unwrap_err();
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
        let write = |name| write_sweep(&at(name), b"x\n", &identity, Durability::InMemory, &|_| {});
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
