//! How to begin: files to start from, completions, manual pages.

use std::path::Path;

use super::{Bench, stdout};

#[test]
fn the_files_to_start_from_are_solved_and_never_written_over() {
    let bench = Bench::new();
    bench.done(&["init", "my arm"]);
    assert_eq!(bench.names("my arm"), ["link.schema.json", "link.toml", "motion.csv"]);
    bench.silent(&["solve", "my arm/link.toml", "my arm/motion.csv", "--quiet"]);

    assert_eq!(bench.silent("init -q another"), "");
    assert_eq!(bench.names("another"), bench.names("my arm")[..3]);

    bench.write("my arm/link.toml", "mine");
    let again = bench.error(5, &["init", "my arm"]);
    let file = Path::new("my arm").join("link.toml");
    let error = format!("error: {} = a file, but must not be there yet\n", file.display());
    assert_eq!(again, error + "hint: name another folder: flexlink init DIR\n");
    assert_eq!(bench.read("my arm/link.toml"), "mine");
}

#[test]
fn the_arm_to_start_from_follows_its_path() {
    let bench = Bench::new();
    bench.done("init --arm robot");
    assert_eq!(bench.names("robot"), ["arm.toml", "link.schema.json", "path.csv"]);
    bench.silent("solve robot/arm.toml robot/path.csv --quiet");
    bench.ends(5, "init robot");
    assert!(!bench.path("robot/link.toml").exists());
}

#[test]
fn the_link_file_to_start_from_names_the_schema_beside_it() {
    let bench = Bench::new();
    bench.run("init");
    assert!(bench.read("link.toml").starts_with("#:schema ./link.schema.json\n"));
    let schema = bench.printed("schema");
    assert!(bench.read("link.schema.json") == schema);
    assert_eq!(bench.printed("schema -o new/schema.json"), "");
    assert!(bench.read("new/schema.json") == schema);
    assert_eq!(bench.json("link.schema.json")["else"]["required"][0], "segments");
}

#[test]
fn every_shell_gets_completions_that_know_the_commands() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = Bench::new().printed(&["completions", shell]);
        for word in ["solve", "simulate", "verify", "feedback"] {
            assert!(script.contains(word), "{shell} lacks {word}");
        }
    }
}

#[cfg(unix)]
#[test]
fn bash_reads_its_completions() {
    let bench = Bench::new();
    bench.write("c", &bench.printed("completions bash"));
    let ask = "source ./c; COMP_WORDS=(flexlink sim); COMP_CWORD=1; _flexlink flexlink sim flexlink; \
               echo ${COMPREPLY[@]}";
    let bash = std::process::Command::new("bash");
    let answer = { bash }.args(["-c", ask]).current_dir(bench.path(".")).output().unwrap();
    assert_eq!(stdout(&answer), "simulate\n");
}

#[test]
fn every_command_has_a_manual_page() {
    let bench = Bench::new();
    assert!(bench.printed("man").contains(".TH flexlink 1"));
    bench.done("man -o man1");
    let commands = super::help::commands(&bench);
    for command in &commands {
        let page = bench.read(&format!("man1/flexlink-{command}.1"));
        assert!(page.contains("Example:"), "{command}");
    }
    assert_eq!(bench.names("man1").len(), 1 + commands.len());
}
