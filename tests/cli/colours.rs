//! Colours: on a terminal or where they are asked for, never in what a program reads.

use super::{Bench, LINK, MOTION, repository, stderr, stdout, succeeded};

use std::process::Output;

const UMLAUTS: &str = "title = 'Träger, ξ = 2 %'\nsegments = [{ length = 1.5, EI = 5, \
                       mass_per_length = 0.8 }]\ndamping.ratio = 0.02\nmesh.elements = 4\n";

/// Runs the program under these variables alone.
fn under(bench: &Bench, variables: &[(&str, &str)], arguments: &[&str]) -> Output {
    let mut program = bench.program(arguments);
    program.env_remove("LC_ALL").env_remove("LANG");
    program.envs(variables.iter().copied()).output().unwrap()
}

#[test]
fn what_a_program_reads_has_no_colour_and_does_not_depend_on_the_locale() {
    let bench = Bench::new();
    bench.write("link.toml", UMLAUTS);
    let motion = repository(MOTION);
    bench.solve(&["-q"]);
    for arguments in [
        &["solve", "link.toml", &motion, "-o", "new", "--json"][..],
        &["simulate", "link.toml", "out/torque.csv", "-o", "played", "--json"],
        &["verify", "link.toml", &motion, "--json"],
        &["frf", "link.toml", "--points", "3"],
        &["schema"],
        &["completions", "zsh"],
        &["man"],
    ] {
        let [utf8, plain] = ["C.UTF-8", "C"].map(|locale| {
            let output =
                succeeded(under(&bench, &[("LC_ALL", locale), ("CLICOLOR_FORCE", "1")], arguments));
            output.stdout
        });
        assert!(utf8 == plain && !utf8.contains(&0x1b), "{arguments:?}");
    }
    assert_eq!(bench.json("new/summary.json")["title"], "Träger, ξ = 2 %");
}

const ERROR: &str = "\u{1b}[1m\u{1b}[31merror:\u{1b}[0m ";

#[test]
fn labels_are_coloured_where_colours_are_asked_for() {
    let bench = Bench::new();
    let forced = [("CLICOLOR_FORCE", "1"), ("LC_ALL", "C.UTF-8")];
    bench.write("link.toml", "segments = [{ lenght = 1 }]\n");
    assert_eq!(
        stderr(&under(&bench, &forced, &["modes", "link.toml"])),
        format!(
            "{ERROR}link.toml:1: unknown key `lenght` in segments.0\n\
             \u{1b}[32mhint:\u{1b}[0m did you mean `length`?\n"
        )
    );
    let usage = stderr(&under(&bench, &forced, &["slove"]));
    assert!(usage.starts_with(ERROR), "{usage}");
    let (link, motion) = (repository(LINK), repository(MOTION));
    let warned = ["solve", &link, &motion, "--set", "analysis.lag=0.1"];
    let warning = under(&bench, &forced, &warned);
    assert!(stderr(&warning).starts_with("\u{1b}[1m\u{1b}[33mwarning:\u{1b}[0m the torque"));
    assert!(!stdout(&warning).contains('\u{1b}'), "the summary has no colours");
    assert!(stdout(&under(&bench, &forced, &["--help"])).contains('\u{1b}'));
}

#[test]
fn no_colour_reaches_a_pipe_or_a_user_who_wants_none() {
    let bench = Bench::new();
    for variables in [
        &[][..],
        &[("TERM", "xterm-256color")],
        &[("CLICOLOR", "1")],
        &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")],
    ] {
        for arguments in [&["modes", "none.toml"][..], &["slove"], &["solve"], &["--help"]] {
            let output = under(&bench, variables, arguments);
            let text = stdout(&output) + &stderr(&output);
            assert!(!text.contains('\u{1b}'), "{variables:?} {arguments:?}: {text}");
        }
    }
}
