//! Files that the user may not read.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt as _;

use super::{Bench, REFUSED, reads_all};

#[test]
fn a_file_without_the_right_to_read_it_is_told_in_the_systems_words() {
    let bench = Bench::new();
    for name in ["link.toml", "motion.csv"] {
        fs::set_permissions(bench.path(name), Permissions::from_mode(0o000)).unwrap();
        if reads_all(&bench.path(name)) {
            println!("not tried: this user, maybe root, may read every file");
            return;
        }
        let message = format!("error: {name}: cannot read: Permission denied\n");
        bench.refuses(&["solve", "link.toml", "motion.csv"], REFUSED, &message);
        fs::set_permissions(bench.path(name), Permissions::from_mode(0o600)).unwrap();
    }
}
