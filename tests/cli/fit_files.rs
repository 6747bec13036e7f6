//! The files of a fit: their names, whose place they take, and that they are of one run.

use std::process::{Command, Stdio};

use super::{Bench, ended, refusal, repository, stderr, succeeded};

const MEASURED: &str = "[[frequency]]\nmode = 1\nvalue = '1.8 Hz'\nuncertainty = '0.02 Hz'\n\
                        [[frequency]]\nmode = 2\nvalue = '5.3 Hz'\nuncertainty = '0.05 Hz'\n";

/// Arguments of a fit of the stiffness or of the payload, kind 0 or 1, which no file of the other equals.
fn arguments(kind: usize, more: &[&str]) -> Vec<String> {
    let free = ["segments.*.EI=0.01:100", "segments.*.EI=0.001:1000"][kind];
    let link = repository("specs/bayo1987_example1.toml");
    let all = [&["fit", &link, "measured.toml", "--free", free], more].concat();
    all.into_iter().map(str::to_owned).collect()
}

fn fit(bench: &Bench, kind: usize, more: &[&str]) -> std::process::Output {
    let arguments = arguments(kind, more);
    bench.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
}

#[test]
fn each_link_file_has_a_record_of_its_own_name() {
    let bench = Bench::new();
    bench.write("measured.toml", MEASURED);
    for (kind, name) in ["a.toml", "b.toml"].into_iter().enumerate() {
        succeeded(fit(&bench, kind, &["-o", name]));
    }
    let first = bench.read("a.json");
    assert!(first.contains("EI=0.01:100") && bench.read("b.json").contains("EI=0.001:1000"));
    assert!(!bench.path("fit.json").exists());
    // Again, over the record of an earlier fit.
    assert!(fit(&bench, 1, &["-o", "a.toml"]).status.success());
    assert_ne!(bench.read("a.json"), first);
}

#[test]
fn a_record_takes_the_place_of_no_other_file() {
    let bench = Bench::new();
    bench.write("measured.toml", MEASURED);
    for content in ["{\"flexlink\": \"0.1.0\", \"command\": \"solve\"}", "notes", ""] {
        bench.write("a.json", content);
        let out = ended(2, fit(&bench, 0, &["-o", "a.toml"]));
        let told =
            "--output = a.toml, but its record a.json would replace a file that no fit has written";
        assert!(stderr(&out).contains(told), "{}", stderr(&out));
        assert_eq!(bench.read("a.json"), content);
        assert!(!bench.path("a.toml").exists());
    }
}

#[test]
fn two_fits_into_one_folder_leave_files_of_one() {
    let bench = Bench::new();
    bench.write("measured.toml", MEASURED);
    let names = ["f.toml", "f.json", "f.html"];
    let more = ["-o", "f.toml", "--report"];
    let files = || names.map(|name| bench.read(name));
    let references = [0, 1].map(|kind| {
        assert!(fit(&bench, kind, &more).status.success());
        files()
    });
    for (a, b) in references[0].iter().zip(&references[1]).skip(1) {
        assert_ne!(a, b);
    }
    for round in 0..25 {
        let runs = [round % 2, 1 - round % 2].map(|kind| {
            let mut run = Command::new(env!("CARGO_BIN_EXE_flexlink"));
            run.args(arguments(kind, &more)).current_dir(bench.path("."));
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
    let bench = Bench::new();
    bench.write("measured.toml", MEASURED);
    for (name, target) in [("f.html", "page"), ("fit.html", "other"), ("typed.html", "typed")] {
        bench.write(target, "mine");
        std::os::unix::fs::symlink(target, bench.path(name)).unwrap();
    }
    assert!(fit(&bench, 0, &["-o", "f.toml", "--report"]).status.success());
    assert!(fit(&bench, 0, &["--report"]).status.success());
    assert!(fit(&bench, 0, &["--report", "typed.html"]).status.success());
    assert_eq!([bench.read("page"), bench.read("other")], ["mine", "mine"]);
    assert!(bench.read("f.html").starts_with("<!DOCTYPE") && bench.path("typed.html").is_symlink());
    assert!(bench.read("typed").starts_with("<!DOCTYPE"), "typed, and so followed");
    // The record would replace a link that no fit has made.
    bench.write("profile", "mine");
    std::os::unix::fs::symlink("profile", bench.path("g.json")).unwrap();
    assert_eq!(fit(&bench, 0, &["-o", "g.toml"]).status.code(), Some(2));
    assert_eq!(bench.read("profile"), "mine");
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_files_of_the_fit_before() {
    let bench = Bench::new();
    bench.write("measured.toml", MEASURED);
    let more = ["-o", "f.toml", "--report"];
    assert!(fit(&bench, 0, &more).status.success());
    let names = ["f.toml", "f.json", "f.html"];
    let before = names.map(|name| bench.read(name));
    // A limit of file sizes, in blocks, that the page alone exceeds.
    let blocks = bench.read("f.json").len() / 512 + 2;
    assert!(bench.read("f.html").len() > 1024 * (blocks + 1));
    let mut run = Command::new("sh");
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    run.args(["-c", &script, env!("CARGO_BIN_EXE_flexlink")]).args(arguments(1, &more));
    refusal(5, run.current_dir(bench.path(".")).output().unwrap(), "cannot write f.html");
    assert_eq!(names.map(|name| bench.read(name)), before);
}
