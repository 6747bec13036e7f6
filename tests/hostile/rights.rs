//! Files that the user may not read, and folders that they may not write into.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::process::CommandExt as _;
use std::process::Output;

use super::{Bench, PROGRAM, REFUSED, SOLVE, text};

const CANNOT_WRITE: i32 = 5;
/// The user who owns nothing.
const NOBODY: u32 = 65534;

impl Bench {
    fn set_mode(&self, name: &str, mode: u32) {
        fs::set_permissions(self.path(name), Permissions::from_mode(mode)).unwrap();
    }

    /// Runs `solve` as a user whom the system hides files from: root, who may read everything, as
    /// nobody, with the program where that one can reach it; nothing where root cannot be another.
    #[expect(clippy::print_stderr, reason = "what a test leaves out is told")]
    fn solve_without_rights(&self) -> Option<Output> {
        self.set_mode("", 0o755);
        let program = self.path("flexlink");
        self.write("hidden", "");
        self.set_mode("hidden", 0o000);
        if fs::read(self.path("hidden")).is_err() {
            return Some(self.run(SOLVE));
        }
        fs::copy(PROGRAM, &program).unwrap();
        self.set_mode("flexlink", 0o755);
        let mut command = self.command(program.to_str().unwrap(), SOLVE);
        let output = command.uid(NOBODY).gid(NOBODY).output();
        output.inspect_err(|why| eprintln!("left out: cannot run as nobody: {why}")).ok()
    }
}

#[test]
fn a_file_without_the_right_to_read_it_is_told_in_the_systems_words() {
    for name in ["link.toml", "motion.csv"] {
        let bench = Bench::new();
        bench.set_mode("link.toml", 0o644);
        bench.set_mode("motion.csv", 0o644);
        bench.set_mode(name, 0o000);
        let message = format!("error: {name}: cannot read: Permission denied\n");
        if let Some(output) = bench.solve_without_rights() {
            bench.is_refusal(&output, REFUSED, &message);
        }
    }
}

#[test]
fn a_folder_without_the_right_to_write_into_it_is_told_and_left_as_it_is() {
    let bench = Bench::new();
    bench.set_mode("link.toml", 0o644);
    bench.set_mode("motion.csv", 0o644);
    fs::create_dir(bench.path("out")).unwrap();
    bench.set_mode("out", 0o555);
    let Some(output) = bench.solve_without_rights() else { return };
    let error = text(&output.stderr);
    assert!(error.starts_with("error: out") && error.contains("Permission denied"), "{error}");
    assert_eq!(output.status.code(), Some(CANNOT_WRITE), "{error}");
    assert_eq!(fs::read_dir(bench.path("out")).unwrap().count(), 0);
}
