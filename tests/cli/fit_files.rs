//! The files of a fit: their names, whose place they take, and that they are of one run.

use std::process::{Command, Output, Stdio};

use super::{Bench, LINK, refusal, succeeded};

const MEASURED: &str = "[[frequency]]\nmode = 1\nvalue = '1.8 Hz'\nuncertainty = '0.02 Hz'\n\
                        [[frequency]]\nmode = 2\nvalue = '5.3 Hz'\nuncertainty = '0.05 Hz'\n";

/// A bench with measured values.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("measured.toml", MEASURED);
    bench
}

/// The program that fits the stiffness within one of two bounds, kind 0 or 1, which no file of the other equals.
fn program(bench: &Bench, kind: usize, more: &str) -> Command {
    let free = ["segments.*.EI=0.01:100", "segments.*.EI=0.001:1000"][kind];
    bench.program(&format!("fit {LINK} measured.toml --free {free} {more}"))
}

fn fit(bench: &Bench, kind: usize, more: &str) -> Output {
    program(bench, kind, more).output().unwrap()
}

#[test]
fn each_link_file_has_a_record_of_its_own_name() {
    let bench = bench();
    succeeded(fit(&bench, 0, "-o a.toml"));
    succeeded(fit(&bench, 1, "-o b.toml"));
    let first = bench.read("a.json");
    assert!(first.contains("EI=0.01:100") && bench.read("b.json").contains("EI=0.001:1000"));
    assert!(!bench.path("fit.json").exists());
    // Again, over the record of an earlier fit.
    succeeded(fit(&bench, 1, "-o a.toml"));
    assert_ne!(bench.read("a.json"), first);
}

#[test]
fn a_record_takes_the_place_of_no_other_file() {
    let bench = bench();
    for content in ["{\"flexlink\": \"0.1.0\", \"command\": \"solve\"}", "notes", ""] {
        bench.write("a.json", content);
        let told =
            "--output = a.toml, but its record a.json would replace a file that no fit has written";
        refusal(2, fit(&bench, 0, "-o a.toml"), told);
        assert_eq!(bench.read("a.json"), content);
        assert!(!bench.path("a.toml").exists());
    }
}

#[test]
fn two_fits_into_one_folder_leave_files_of_one() {
    let bench = bench();
    let more = "-o f.toml --report";
    let files = || ["f.toml", "f.json", "f.html"].map(|name| bench.read(name));
    let references = [0, 1].map(|kind| {
        succeeded(fit(&bench, kind, more));
        files()
    });
    assert!((1..3).all(|file| references[0][file] != references[1][file]));
    for round in 0..25 {
        let runs = [round % 2, 1 - round % 2].map(|kind| {
            let mut run = program(&bench, kind, more);
            run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
        });
        for mut run in runs {
            assert!(run.wait().unwrap().success());
        }
        assert!(references.contains(&files()), "round {round}");
    }
}

#[cfg(unix)]
#[test]
fn a_default_name_follows_no_link() {
    let bench = bench();
    for (name, target) in [("f.html", "page"), ("fit.html", "other"), ("typed.html", "typed")] {
        bench.write(target, "mine");
        std::os::unix::fs::symlink(target, bench.path(name)).unwrap();
    }
    for more in ["-o f.toml --report", "--report", "--report typed.html"] {
        succeeded(fit(&bench, 0, more));
    }
    assert_eq!([bench.read("page"), bench.read("other")], ["mine", "mine"]);
    assert!(bench.read("f.html").starts_with("<!DOCTYPE") && bench.path("typed.html").is_symlink());
    assert!(bench.read("typed").starts_with("<!DOCTYPE"), "typed, and so followed");
    // The record would replace a link that no fit has made.
    bench.write("profile", "mine");
    std::os::unix::fs::symlink("profile", bench.path("g.json")).unwrap();
    assert_eq!(fit(&bench, 0, "-o g.toml").status.code(), Some(2));
    assert_eq!(bench.read("profile"), "mine");
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_files_of_the_fit_before() {
    let bench = bench();
    let more = "-o f.toml --report";
    succeeded(fit(&bench, 0, more));
    let files = || ["f.toml", "f.json", "f.html"].map(|name| bench.read(name));
    let before = files();
    // A limit of file sizes, in blocks, that the page alone exceeds.
    let blocks = bench.read("f.json").len() / 512 + 2;
    assert!(bench.read("f.html").len() > 1024 * (blocks + 1));
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let fit = program(&bench, 1, more);
    let mut run = Command::new("sh");
    run.args(["-c", &script]).arg(fit.get_program()).args(fit.get_args());
    refusal(5, run.current_dir(bench.path(".")).output().unwrap(), "cannot write f.html");
    assert_eq!(files(), before);
}
