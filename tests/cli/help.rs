//! Help as it stands in a window: complete, not too wide, its examples whole.

use super::{Bench, stderr, stdout, succeeded};

/// The commands that the program's own help lists.
pub(super) fn commands(bench: &Bench) -> Vec<String> {
    let text = stdout(&bench.run(&["--help"]));
    let (_, list) = text.split_once("Commands:\n").unwrap();
    let names = list.lines().take_while(|line| !line.is_empty());
    // A description that goes on in the next line is set in farther.
    let names = names.filter(|line| !line.starts_with("   "));
    let names = names.map(|line| line.split_whitespace().next().unwrap().to_owned());
    names.filter(|name| name != "help").collect()
}

fn help(bench: &Bench, arguments: &[&str], columns: usize) -> String {
    let mut program = bench.program(arguments);
    stdout(&succeeded(program.env("COLUMNS", columns.to_string()).output().unwrap()))
}

#[test]
fn every_command_has_an_example_that_no_window_breaks() {
    let bench = Bench::new();
    let commands = commands(&bench);
    assert!(commands.len() >= 10, "{commands:?}");
    let examples = |text: &str| {
        let examples = text.split_once("\nExample:\n").unwrap().1;
        examples.split("\n\n").next().unwrap().to_owned()
    };
    for command in &commands {
        for flag in ["-h", "--help"] {
            let texts = [100, 80, 60].map(|width| (width, help(&bench, &[command, flag], width)));
            let whole = examples(&texts[0].1);
            assert!(whole.contains(&format!("flexlink {command}")), "{command}: {whole}");
            for (width, text) in &texts {
                assert_eq!(examples(text), whole, "{command} at {width}");
                // A usage is not broken: it is to be read as one.
                for line in text.lines().filter(|line| !line.starts_with("Usage:")) {
                    assert!(line.chars().count() <= *width, "{width}: {line}");
                }
            }
        }
    }
}

#[test]
fn without_a_command_the_help_is_shown() {
    let bench = Bench::new();
    let output = bench.run("");
    assert_eq!((output.status.code(), stdout(&output)), (Some(2), String::new()));
    assert_eq!(stderr(&output), bench.printed("-h"));
    for code in [0, 1, 2, 3, 4, 5, 130] {
        assert!(stderr(&output).contains(&format!("{code} ")), "exit code {code}");
    }
}

#[test]
fn pages_of_the_book_are_topics_of_help() {
    let bench = Bench::new();
    for (topic, words) in [
        ("files", ["Link file\n---------", "hub_angle.csv"]),
        ("limits", ["The method\n----------", "* Large deflections"]),
    ] {
        let page = help(&bench, &["help", topic], 60);
        assert!(words.iter().all(|word| page.contains(word)), "{topic}: {page}");
        let mut lines = page.lines().filter(|line| !line.starts_with("    "));
        assert!(lines.all(|line| line.chars().count() <= 80));
    }
}

#[test]
fn help_of_a_command_is_its_own_help() {
    let bench = Bench::new();
    for command in commands(&bench) {
        let [by_topic, by_flag] =
            [["help", &command], [&command, "--help"]].map(|words| help(&bench, &words, 80));
        assert!(by_topic == by_flag, "{command}");
    }
    assert_eq!(help(&bench, &["help"], 80), help(&bench, &["--help"], 80));
}
