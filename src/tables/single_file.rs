use std::io;
use std::path::Path;

use super::folder::{FolderAction, FolderError, OutputFolder};

/// Writes one file, whole or not at all; the folder it lies in is created where it is missing.
///
/// # Errors
/// [`FolderError`] if `path` names no file, or the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), FolderError> {
    let folder = folder_of(path);
    let Some(name) = path.file_name().map(|name| name.to_string_lossy()) else {
        let cause = io::Error::other("the path names no file");
        let action = FolderAction::Write(path.display().to_string());
        return Err(FolderError { folder: folder.to_owned(), action, cause });
    };
    let mut staged = OutputFolder::stage(folder)?;
    staged.file(&name, |out| out.write_all(bytes))?;
    staged.commit(&name, &[])
}

/// The folder that a file lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}
