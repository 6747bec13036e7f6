//! One file, or several of one run, which take their names together: no other run's files come between them.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::folder::{Durability, FolderError, OutputFolder, create, folder_of};

/// Author of the name of a new file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NamedBy {
    /// A path that the user typed. The program follows symbolic links, and writes into a device or a named pipe as it
    /// is, because renaming would put a file in its place.
    User,
    /// A name of the program, such as the record beside a table. The file replaces anything else of this name,
    /// because a link there must not decide which file is written.
    Program,
}

/// A file to be written.
#[derive(Debug, Clone, Copy)]
pub struct NewFile<'a> {
    /// Where it goes.
    pub path: &'a Path,
    /// What it holds.
    pub bytes: &'a [u8],
    /// Who has named it.
    pub named_by: NamedBy,
}

/// A folder under its original name, with the names and the bytes of its files.
type Folder<'a> = (PathBuf, Vec<(OsString, &'a [u8])>);

/// Writes all files, or none. First writes all under other names, then renames each while locks keep other runs out
/// of their folders. If another run writes into one of them for more than a second, calls `on_wait` with the folder.
///
/// # Errors
/// [`FolderError`] names the first file that cannot be written.
pub fn write_files(files: &[NewFile], on_wait: &dyn Fn(&Path)) -> Result<(), FolderError> {
    let mut streams = Vec::new();
    // Sorted by true path: every run takes the locks in this order.
    let mut folders: BTreeMap<PathBuf, Folder> = BTreeMap::new();
    for file in files {
        match Target::of(file.path, file.named_by)? {
            Target::Stream => streams.push(file),
            Target::File { folder, name } => {
                create(&folder)?;
                let real = folder.canonicalize().unwrap_or_else(|_| folder.clone());
                let (_, names) = folders.entry(real).or_insert_with(|| (folder, Vec::new()));
                names.push((name, file.bytes));
            }
        }
    }
    let mut staged = Vec::new();
    for (folder, names) in folders.into_values() {
        let output = OutputFolder::stage(&folder, on_wait)?;
        for (name, bytes) in names {
            output.file(name, |out| out.write_all(bytes))?;
        }
        output.names()?;
        staged.push(output);
    }
    for file in streams {
        write_through(file.path, |out| out.write_all(file.bytes))?;
    }
    staged.into_iter().try_for_each(OutputFolder::replace)
}

/// Writes one file, whole or not at all, and creates its folder if it is missing. `write` receives a buffered writer.
///
/// A reader of a pipe may go away without an error. If another run writes into the folder for more than a second,
/// calls `on_wait` once.
///
/// # Errors
/// [`FolderError`] if `path` names no file, leads through links in a circle, or the file cannot be written.
pub fn write_file(
    path: &Path,
    named_by: NamedBy,
    durability: Durability,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    match Target::of(path, named_by)? {
        Target::Stream => write_through(path, write),
        Target::File { folder, name } => {
            let staged = OutputFolder::stage(&folder, on_wait)?.with(durability);
            staged.file(name, write)?;
            staged.replace()
        }
    }
}

/// The path of the record beside a file: `a.json` for `a.toml` if `own` is the ending `toml`, else `NAME.json` for
/// NAME.
pub(super) fn record_beside(file: &Path, own: &str) -> PathBuf {
    if file.extension().is_some_and(|end| end.eq_ignore_ascii_case(own)) {
        return file.with_extension("json");
    }
    let mut name = file.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// Where a file goes.
enum Target {
    /// A device, a pipe or a file that this process has open.
    Stream,
    /// Into a folder.
    File {
        /// The folder.
        folder: PathBuf,
        /// The name there.
        name: OsString,
    },
}

impl Target {
    /// Target at the end of a path.
    fn of(path: &Path, named_by: NamedBy) -> Result<Self, FolderError> {
        if named_by == NamedBy::User && is_stream(path) {
            return Ok(Self::Stream);
        }
        let path = &match named_by {
            NamedBy::User => followed(path).map_err(|cause| FolderError::of_file(path, cause))?,
            NamedBy::Program => path.to_owned(),
        };
        // The last name does not show a separator at the end, or a dot after it.
        let is_last =
            |name: &&OsStr| path.as_os_str().as_encoded_bytes().ends_with(name.as_encoded_bytes());
        let Some(name) = path.file_name().filter(is_last) else {
            let cause = io::Error::other("the path names no file");
            return Err(FolderError::of_file(path, cause));
        };
        Ok(Self::File { folder: folder_of(path).to_owned(), name: name.to_owned() })
    }
}

/// Target of a symbolic link, if it exists; else the path itself.
///
/// # Errors
/// Errors of the system for links in a circle or through anything but a folder.
pub(super) fn followed(path: &Path) -> io::Result<PathBuf> {
    if !path.is_symlink() || is_stream(path) {
        return Ok(path.to_owned());
    }
    match path.canonicalize() {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(path.to_owned()),
        target => target,
    }
}

/// Whether a path names a device, a pipe or a file that this process has open.
pub(super) fn is_stream(path: &Path) -> bool {
    let open = ["/dev/fd", "/dev/stdout", "/dev/stderr", "/proc/self/fd"];
    let is_open = open.iter().any(|name| path.starts_with(name));
    is_open || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

fn write_through(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<(), FolderError> {
    let open = || File::options().append(true).open(path);
    match open().and_then(|mut file| write(&mut file).and_then(|()| file.flush())) {
        Err(cause) if cause.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|cause| FolderError::of_file(path, cause)),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    use super::NamedBy::{Program, User};
    use super::*;

    fn write(files: &[(&Path, NamedBy)]) -> Result<(), FolderError> {
        let files: Vec<NewFile> = files
            .iter()
            .map(|&(path, named_by)| NewFile { path, bytes: b"new", named_by })
            .collect();
        write_files(&files, &|_| {})
    }

    #[test]
    fn a_link_is_followed_where_it_was_typed_and_replaced_where_not() {
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        for (name, target) in [("typed.toml", "one"), ("default.html", "two")] {
            fs::write(at(target), "old").unwrap();
            fs::set_permissions(at(target), fs::Permissions::from_mode(0o600)).unwrap();
            symlink(target, at(name)).unwrap();
        }
        write(&[(&at("typed.toml"), User), (&at("default.html"), Program)]).unwrap();
        let text = |name: &str| fs::read_to_string(at(name)).unwrap();
        assert!(at("typed.toml").is_symlink() && text("one") == "new");
        assert!(!at("default.html").is_symlink() && text("two") == "old");
        assert_eq!(text("default.html"), "new");
        let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!((mode("one"), mode("default.html") & 0o111), (0o600, 0), "as ordinary ones");
    }

    #[test]
    fn files_of_several_folders_are_written_all_or_none() {
        let base = tempfile::tempdir().unwrap();
        let at = |name: &str| base.path().join(name);
        fs::create_dir_all(at("b/taken.html")).unwrap();
        fs::write(base.path().join("kept.toml"), "old").unwrap();
        let (kept, taken) = (at("kept.toml"), at("b/taken.html"));
        let error = write(&[(&kept, User), (&at("a/kept.json"), Program), (&taken, Program)]);
        assert_eq!(error.unwrap_err().action, "write taken.html");
        assert_eq!(fs::read_to_string(&kept).unwrap(), "old");
        let all_of = |name: &str| fs::read_dir(at(name)).unwrap().count();
        assert_eq!((all_of("a"), all_of("b")), (0, 1));
        fs::remove_dir(&taken).unwrap();
        write(&[(&kept, User), (&at("a/kept.json"), Program), (&taken, Program)]).unwrap();
        assert_eq!(fs::read_to_string(&taken).unwrap(), "new");
    }
}
