//! A program that is being ended. No test may stand beside this one: what it calls holds the process
//! that it runs in.

use std::fs;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use flexlink::store::{OutputFolder, abandon_unfinished};

/// The end removes the file before it is waited for on the disk: to miss it there is no error.
#[test]
fn nobody_is_told_of_a_file_that_went_with_the_end() {
    let base = tempfile::tempdir().unwrap();
    let folder = base.path().join("out");
    let staged = OutputFolder::stage(&folder, &|_| {}).unwrap();
    staged.file("torque.csv", |out| out.write_all(b"0\n")).unwrap();
    assert!(fs::read_dir(&folder).unwrap().count() > 0, "nothing is aside");

    abandon_unfinished();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0, "what was begun is still there");
    let (tell, told) = channel();
    thread::spawn(move || tell.send(staged.replace().map_err(|error| error.to_string())));
    assert_eq!(told.recv_timeout(Duration::from_millis(500)), Err(RecvTimeoutError::Timeout));
}
