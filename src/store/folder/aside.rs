use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile, TempPath};

use super::unfinished::{HeldOff, Unfinished, hold_off_the_end};

/// What the names of all files written aside end in: other programs' are left alone.
const SUFFIX: &str = ".flexlink";

/// Characters that tell two of one name apart.
const RANDOM: usize = 6;

/// A file that is written and has not yet its name; dropped, it is removed.
#[derive(Debug)]
pub(super) struct Aside {
    pub(super) name: OsString,
    path: TempPath,
    // Dropped after the path: a file that is there is noted.
    _unfinished: Unfinished,
}

impl Aside {
    /// Writes a file in `dir`, with the permissions of an ordinary one.
    pub(super) fn write(
        dir: &Path,
        name: &OsStr,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> io::Result<Self> {
        let prefix: OsString = [OsStr::new("."), name, OsStr::new(".")].into_iter().collect();
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
        let held_off = hold_off_the_end();
        let (file, path) = ordinary_file(&mut builder, dir)?.into_parts();
        let unfinished = Unfinished::note(&path, &held_off);
        drop(held_off);
        let aside = Self { name: name.to_owned(), path, _unfinished: unfinished };
        let mut buffered = BufWriter::with_capacity(1 << 16, file);
        write(&mut buffered)?;
        buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(aside)
    }

    /// Waits until the content is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        // Windows asks for a file that may be written.
        let file = File::options().read(true).write(true).open(&self.path);
        as_far_as_supported(file.and_then(|file| file.sync_all()))
    }

    /// Gives it the permissions of a file, where there is one.
    pub(super) fn take_permissions_of(&self, other: &Path) {
        // On a file system without permissions there are none to keep.
        let _ = fs::metadata(other).map(|old| fs::set_permissions(&self.path, old.permissions()));
    }

    /// Gives it its name in `dir`, in the place of the file that has it.
    pub(super) fn take_name(self, dir: &Path, _: &HeldOff) -> io::Result<()> {
        self.path.persist(dir.join(self.name)).map_err(|refused| refused.error)
    }
}

/// Removes the files that a run has left in `dir`, as far as they can be.
pub(super) fn remove_left(dir: &Path) -> io::Result<()> {
    for entry in fs::read_dir(dir)? {
        let entry = entry?;
        if is_aside(&entry.file_name()) && entry.file_type()?.is_file() {
            // Another user's may stay.
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(())
}

/// Whether a name is one that [`Aside::write`] gives: `.torque.csv.3kQ9dZ.flexlink`.
fn is_aside(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    let inner = name.strip_prefix('.').and_then(|name| name.strip_suffix(SUFFIX));
    inner.and_then(|inner| inner.rsplit_once('.')).is_some_and(|(name, random)| {
        let is_random = random.len() == RANDOM && random.bytes().all(|c| c.is_ascii_alphanumeric());
        !name.is_empty() && is_random
    })
}

/// Waits until the names in a folder are on the disk, where the system can tell.
#[cfg(unix)]
pub(super) fn sync_folder(dir: &Path) -> io::Result<()> {
    as_far_as_supported(File::open(dir).and_then(|folder| folder.sync_all()))
}

/// Elsewhere folders are not opened; the system keeps their names in order.
#[cfg(not(unix))]
pub(super) fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Some network file systems cannot wait for the disk; what they can do is done.
fn as_far_as_supported(synced: io::Result<()>) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    match synced {
        // A folder may be open to writing and closed to reading, by the user's wish.
        Err(cause) if matches!(cause.kind(), InvalidInput | PermissionDenied | Unsupported) => {
            Ok(())
        }
        synced => synced,
    }
}

#[cfg(unix)]
fn ordinary_file(builder: &mut Builder<'_, '_>, dir: &Path) -> io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    // The user's umask takes its share, as of any new file.
    let permissions = fs::Permissions::from_mode(0o666);
    builder.permissions(permissions).tempfile_in(dir)
}

#[cfg(not(unix))]
fn ordinary_file(builder: &mut Builder<'_, '_>, dir: &Path) -> io::Result<NamedTempFile> {
    builder.tempfile_in(dir)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_this_program_are_taken_for_left_files() {
        assert!(is_aside(OsStr::new(".torque.csv.3kQ9dZ.flexlink")));
        let others = [
            ".torque.csv.3kQ9dZ", // rsync
            ".torque.csv.flexlink",
            "torque.csv.3kQ9dZ.flexlink",
            ".torque.csv.3kQ9dZ1.flexlink",
            ".torque.csv.notes!.flexlink",
            ".3kQ9dZ.flexlink",
            ".flexlink.lock",
        ];
        for name in others {
            assert!(!is_aside(OsStr::new(name)), "{name}");
        }
    }
}
