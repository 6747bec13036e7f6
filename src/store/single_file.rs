use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::folder::{Durability, FolderAction, FolderError, OutputFolder};

/// Writes one file, whole or not at all; the folder it lies in is created where it is missing.
///
/// A link is followed. What is no file on a disk, a device or a named pipe, is written to as it is:
/// taking its name would put a file in its place. A reader of it that goes away is no error. If
/// another run writes into the folder for more than a second, `on_wait` is called once.
///
/// # Errors
/// [`FolderError`] if `path` names no file, or the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8], on_wait: &dyn Fn(&Path)) -> Result<(), FolderError> {
    write_file_with(path, bytes, Durability::default(), on_wait)
}

/// The same for a file that is made while it is written: `write` receives a buffered writer.
///
/// # Errors
/// As [`write_file`].
pub fn write_file_by(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    write_by(path, write, Durability::default(), on_wait)
}

/// As [`write_file`], with a wait for the disk or without.
pub(super) fn write_file_with(
    path: &Path,
    bytes: &[u8],
    durability: Durability,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    write_by(path, |out| out.write_all(bytes), durability, on_wait)
}

fn write_by(
    path: &Path,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    durability: Durability,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    let path = &followed(path);
    let folder = folder_of(path);
    let refused = |cause| {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let action = FolderAction::Write(name.to_string_lossy().into());
        FolderError { folder: folder.to_owned(), action, cause }
    };
    // A path may end in a separator, or in a dot after it, which its last name does not show.
    let is_last =
        |name: &&OsStr| path.as_os_str().as_encoded_bytes().ends_with(name.as_encoded_bytes());
    let Some(name) = path.file_name().filter(is_last) else {
        return Err(refused(io::Error::other("the path names no file")));
    };
    if is_stream(path) {
        return write_through(path, write).map_err(refused);
    }
    let staged = OutputFolder::stage(folder, on_wait)?.with(durability);
    staged.file(name, write)?;
    staged.replace()
}

/// What a symbolic link leads to, if that is there; else the path itself.
fn followed(path: &Path) -> PathBuf {
    let target =
        if path.is_symlink() && !is_stream(path) { path.canonicalize().ok() } else { None };
    target.unwrap_or_else(|| path.to_owned())
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
) -> io::Result<()> {
    let mut file = fs::File::options().append(true).open(path)?;
    match write(&mut file).and_then(|()| file.flush()) {
        Err(cause) if cause.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// The folder that a file lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}
