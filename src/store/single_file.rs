//! A single file that is written whole or not at all.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::folder::{Durability, FolderError, OutputFolder, folder_of};

/// Writes one file, whole or not at all; the folder it lies in is created if it is missing. `write`
/// receives a buffered writer.
///
/// A link is followed. A device or a named pipe is written to as it is, because renaming would put a file
/// in its place; it is no error if its reader goes away. If another run writes into the folder for more
/// than a second, `on_wait` is called once.
///
/// # Errors
/// [`FolderError`] if `path` names no file, or the file cannot be written.
pub fn write_file(
    path: &Path,
    durability: Durability,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    on_wait: &dyn Fn(&Path),
) -> Result<(), FolderError> {
    let path = &followed(path);
    let refused = |cause| FolderError::of_file(path, cause);
    // A path may end in a separator, or in a dot after it, which its last name does not show.
    let is_last =
        |name: &&OsStr| path.as_os_str().as_encoded_bytes().ends_with(name.as_encoded_bytes());
    let Some(name) = path.file_name().filter(is_last) else {
        return Err(refused(io::Error::other("the path names no file")));
    };
    if is_stream(path) {
        return write_through(path, write).map_err(refused);
    }
    let staged = OutputFolder::stage(folder_of(path), on_wait)?.with(durability);
    staged.file(name, write)?;
    staged.replace()
}

/// Target of a symbolic link, if it exists; else the path itself.
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
