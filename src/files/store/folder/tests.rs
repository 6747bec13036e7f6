use std::cell::Cell;
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use super::{Durability, LOCK, Lock, OutputFolder, STAGING};
use crate::store::{NamedBy, write_file};

fn in_silence(_: &Path) {}

/// Names and contents of a folder, in order.
fn listing(dir: &Path) -> Vec<(String, String)> {
    let entries = fs::read_dir(dir).unwrap().map(Result::unwrap);
    let mut files: Vec<_> = entries
        .map(|entry| {
            let text = fs::read_to_string(entry.path()).unwrap_or_default();
            (entry.file_name().into_string().unwrap(), text)
        })
        .collect();
    files.sort();
    files
}

fn files(expected: &[(&str, &str)]) -> Vec<(String, String)> {
    let owned = |&(name, text): &(&str, &str)| (name.to_owned(), text.to_owned());
    expected.iter().map(owned).collect()
}

fn stage_files(dir: &Path, files: &[(&str, &str)]) -> OutputFolder {
    let folder = OutputFolder::stage(dir, &in_silence).unwrap();
    for (name, text) in files {
        folder.file(name, |w| w.write_all(text.as_bytes())).unwrap();
    }
    folder
}

const OWNED: [&str; 3] = ["torque.csv", "nodes.csv", "summary.json"];

#[test]
fn a_second_run_replaces_the_first_and_nothing_else() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path().join("a/b");
    let first = [("summary.json", "1"), ("torque.csv", "1"), ("nodes.csv", "1")];
    let folder = stage_files(&dir, &first);
    folder.commit("summary.json", &OWNED).unwrap();
    fs::write(dir.join("notes.txt"), "mine").unwrap();

    let second = [("summary.json", "2"), ("torque.csv", "2")];
    let folder = stage_files(&dir, &second);
    assert_eq!(fs::read_to_string(dir.join("torque.csv")).unwrap(), "1");
    folder.commit("summary.json", &OWNED).unwrap();
    let expected = [("notes.txt", "mine"), ("summary.json", "2"), ("torque.csv", "2")];
    assert_eq!(listing(&dir), files(&expected));
}

#[test]
fn files_are_written_at_the_same_time() {
    let base = tempfile::tempdir().unwrap();
    let folder = OutputFolder::stage(base.path(), &in_silence).unwrap();
    let (begun, waits) = mpsc::channel();
    thread::scope(|scope| {
        let nodes = folder.file("nodes.csv", |w| {
            scope.spawn(|| {
                let torque = folder.file("torque.csv", |w| w.write_all(b"2"));
                begun.send(torque).unwrap();
            });
            waits.recv_timeout(Duration::from_secs(20)).unwrap().unwrap();
            w.write_all(b"1")
        });
        nodes.unwrap();
    });
    folder.commit("torque.csv", &OWNED).unwrap();
    assert_eq!(listing(base.path()), files(&[("nodes.csv", "1"), ("torque.csv", "2")]));
}

#[test]
fn a_failing_writer_leaves_the_folder_as_it_was() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path();
    fs::write(dir.join("torque.csv"), "old").unwrap();
    let folder = stage_files(dir, &[("nodes.csv", "new")]);
    let error = folder
        .file("torque.csv", |w| {
            w.write_all(b"half a ta")?;
            Err(io::Error::from_raw_os_error(28))
        })
        .unwrap_err();
    // On Windows number 28 has another meaning.
    let words = io::Error::from_raw_os_error(28).to_string().replace(" (os error 28)", "");
    let expected = format!("{}: cannot write torque.csv: {words}", dir.display());
    assert_eq!(error.to_string(), expected);
    drop(folder);
    assert_eq!(listing(dir), files(&[("torque.csv", "old")]));
}

#[test]
fn a_dropped_run_leaves_no_file() {
    let base = tempfile::tempdir().unwrap();
    drop(stage_files(&base.path().join("a/b"), &[("torque.csv", "1")]));
    assert_eq!(listing(&base.path().join("a/b")), []);
}

#[test]
fn a_file_that_cannot_take_its_name_changes_nothing() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path();
    fs::create_dir(dir.join("torque.csv")).unwrap();
    fs::write(dir.join("summary.json"), "old").unwrap();
    let folder = stage_files(dir, &[("summary.json", "2"), ("torque.csv", "2")]);
    let error = folder.commit("summary.json", &OWNED).unwrap_err();
    assert_eq!(error.action, "write torque.csv");
    assert_eq!(listing(dir), files(&[("summary.json", "old"), ("torque.csv", "")]));
}

#[test]
fn replaced_files_are_there_at_every_moment() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path();
    fs::create_dir(dir.join("b.csv")).unwrap();
    fs::write(dir.join("z.csv"), "old").unwrap();
    let folder = stage_files(dir, &[("z.csv", "new"), ("b.csv", "new")]);
    let error = folder.replace().unwrap_err();
    assert_eq!(error.action, "write b.csv");
    assert_eq!(listing(dir), files(&[("b.csv", ""), ("z.csv", "old")]));
    stage_files(dir, &[("z.csv", "new")]).replace().unwrap();
    assert_eq!(listing(dir), files(&[("b.csv", ""), ("z.csv", "new")]));
}

#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt as _;
    let base = tempfile::tempdir().unwrap();
    let path = base.path().join("torque.csv");
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    stage_files(base.path(), &[("torque.csv", "new")]).replace().unwrap();
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
}

#[test]
fn a_file_in_the_place_of_the_folder_is_refused() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path().join("out");
    fs::write(&dir, "a file").unwrap();
    let error = OutputFolder::stage(&dir, &in_silence).unwrap_err();
    assert_eq!(error.action, "create the folder");
    assert_eq!(fs::read_to_string(&dir).unwrap(), "a file");
}

#[cfg(unix)]
#[test]
fn files_have_the_permissions_of_ordinary_ones() {
    use std::os::unix::fs::PermissionsExt as _;
    let base = tempfile::tempdir().unwrap();
    let dir = base.path();
    fs::write(dir.join("ordinary"), "").unwrap();
    let folder = stage_files(dir, &[("summary.json", "{}")]);
    folder.commit("summary.json", &[]).unwrap();
    let mode = |name| fs::metadata(dir.join(name)).unwrap().permissions().mode();
    assert_eq!(mode("summary.json"), mode("ordinary"));
}

#[test]
fn what_a_killed_run_has_left_goes_with_the_next() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path();
    fs::create_dir(dir.join(".flexlink.run-a1B2c3")).unwrap();
    fs::write(dir.join(".flexlink.run-a1B2c3/torque.csv"), "half").unwrap();
    fs::write(dir.join(".torque.csv.a1B2c3"), "of another program").unwrap();
    fs::write(dir.join(LOCK), "").unwrap();
    stage_files(dir, &[("torque.csv", "2")]).replace().unwrap();
    let left = [(".torque.csv.a1B2c3", "of another program"), ("torque.csv", "2")];
    assert_eq!(listing(dir), files(&left));
}

#[test]
fn a_run_waits_for_another_in_its_folder_and_says_so_when_it_gives_up() {
    let base = tempfile::tempdir().unwrap();
    let dir = base.path();
    let first = stage_files(dir, &[("torque.csv", "1"), ("summary.json", "1")]);
    let error = Lock::take(&dir.join(LOCK), Duration::from_millis(20), &|| {}).unwrap_err();
    assert_eq!(error.to_string(), "another run has been writing into it for 20ms");
    assert_eq!(fs::read_dir(dir).unwrap().count(), 2, "the first run's files are left alone");
    thread::scope(|scope| {
        scope.spawn(|| {
            let second = stage_files(dir, &[("torque.csv", "2"), ("summary.json", "2")]);
            second.commit("summary.json", &OWNED).unwrap();
        });
        thread::sleep(Duration::from_millis(20));
        first.commit("summary.json", &OWNED).unwrap();
    });
    assert_eq!(listing(dir), files(&[("summary.json", "2"), ("torque.csv", "2")]));
}

#[test]
fn a_wait_that_is_no_short_one_is_told_once() {
    let base = tempfile::tempdir().unwrap();
    let held = stage_files(base.path(), &[]);
    let told = Cell::new(0);
    let wait = |millis| {
        let tell = || told.set(told.get() + 1);
        Lock::take(&base.path().join(LOCK), Duration::from_millis(millis), &tell).unwrap_err();
        told.get()
    };
    assert_eq!(wait(50), 0, "a short one is not");
    assert_eq!(wait(1300), 1);
    drop(held);
}

#[test]
fn a_single_file_is_whole_or_not_there_and_takes_the_place_of_what_a_killed_run_left() {
    let base = tempfile::tempdir().unwrap();
    let path = base.path().join("new/frf.csv");
    let write = |text: &'static str, ended: fn() -> io::Result<()>| {
        let write = |w: &mut (dyn Write + Send)| {
            w.write_all(text.as_bytes())?;
            ended()
        };
        write_file(&path, NamedBy::User, Durability::InMemory, write, &|_| {})
    };
    let error = write("half", || Err(io::Error::other("full"))).unwrap_err();
    assert_eq!(error.action, "write frf.csv");
    assert_eq!(listing(path.parent().unwrap()), []);
    write("whole", || Ok(())).unwrap();
    let left = path.with_file_name(format!("{STAGING}killed"));
    fs::create_dir(&left).unwrap();
    fs::write(left.join("frf.csv"), "longer, of a killed run").unwrap();
    write("again", || Ok(())).unwrap();
    assert_eq!(listing(path.parent().unwrap()), files(&[("frf.csv", "again")]));
}
