//! The file beside a sweep's table that holds the rows until they are complete.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use same_file::Handle;

use super::folder::{FolderAction, FolderError, folder_of};

/// Where the rows of a table lie until they are complete.
pub(super) fn part_of(table: &Path) -> PathBuf {
    let mut name = table.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// Opens the part of a table for this run alone.
///
/// # Errors
/// [`FolderError`] if it cannot be opened, or another run is writing it.
pub(super) fn open_part(table: &Path) -> Result<(PathBuf, File), FolderError> {
    let part = part_of(table);
    let folder = folder_of(table);
    fs::create_dir_all(folder).map_err(|cause| FolderError {
        folder: folder.to_owned(),
        action: FolderAction::Create,
        cause,
    })?;
    if table.is_dir() || table.file_name().is_none() {
        return Err(error(table, io::Error::other("a folder is no file")));
    }
    // Who may write beside the table must not have another file cut off by this.
    if part.is_symlink() {
        return Err(error(&part, io::Error::other("it is a symbolic link")));
    }
    loop {
        if let Some(file) = attempt(&part).map_err(|cause| error(&part, cause))? {
            return Ok((part, file));
        }
    }
}

/// Nothing where another run has just removed the file.
fn attempt(part: &Path) -> io::Result<Option<File>> {
    let file = OpenOptions::new().create(true).append(true).open(part)?;
    // A file system without locks has no say.
    if let Err(TryLockError::WouldBlock) = file.try_lock() {
        return Err(io::Error::other("another run is writing it"));
    }
    // Another run may have finished, and removed the file, before it was locked here.
    let is_there = Handle::from_path(part).ok() == Some(Handle::from_file(file.try_clone()?)?);
    Ok(is_there.then_some(file))
}

/// Why a file of a sweep cannot be written.
pub(super) fn error(path: &Path, cause: io::Error) -> FolderError {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    let action = FolderAction::Write(name.unwrap_or_default());
    FolderError { folder: folder_of(path).to_owned(), action, cause }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_no_file_for_a_sweep() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("..")] {
            let error = open_part(&path).unwrap_err();
            assert!(error.to_string().ends_with("a folder is no file"), "{error}");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
