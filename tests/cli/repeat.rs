//! A run done again: `solve --repeat`.

use std::fs;
use std::process::Output;

use super::{Bench, LINK, MOTION, ended, refusal, repository, stderr, stdout, succeeded, with};

/// A bench with link.toml and motion.csv.
fn bench() -> Bench {
    let bench = Bench::new();
    fs::copy(repository(LINK), bench.path("link.toml")).unwrap();
    fs::copy(repository(MOTION), bench.path("motion.csv")).unwrap();
    bench
}

/// A bench whose folder `out` holds a run.
#[track_caller]
fn solved(more: &str) -> Bench {
    let bench = bench();
    bench.done(&format!("solve link.toml motion.csv -q {more}"));
    bench
}

fn repeat(bench: &Bench, arguments: &[&str]) -> Output {
    bench.run(&with("solve --repeat", arguments))
}

#[track_caller]
fn repeats(bench: &Bench, arguments: &[&str], files: usize) {
    let output = repeat(bench, arguments);
    let same = format!("same     {files} files of {}, byte for byte\n", arguments[0]);
    assert_eq!((stdout(&output), stderr(&output)), (same, String::new()));
    assert_eq!(output.status.code(), Some(0));
}

/// The repetition must find that these lines, and the result, are not as they were.
#[track_caller]
fn differs(bench: &Bench, lines: &str, differing: usize, hint: &str) {
    let output = repeat(bench, &["out"]);
    let told = format!("{lines}result   {differing} of 7 files of out not the same\n");
    assert_eq!((stdout(&output), stderr(&output)), (told, hint.to_owned()));
    assert_eq!(output.status.code(), Some(1));
}

/// The repetition must be refused; returns what is said.
#[track_caller]
fn refused(bench: &Bench, arguments: &[&str]) -> String {
    let output = repeat(bench, arguments);
    assert_eq!((output.status.code(), stdout(&output)), (Some(3), String::new()));
    stderr(&output)
}

/// SHA-256 in a summary of `out`.
fn recorded(bench: &Bench, input: &str) -> String {
    bench.json("out/summary.json")["inputs"][input]["sha256"].as_str().unwrap().to_owned()
}

/// Changes the first place of a text in a file.
#[track_caller]
fn change(bench: &Bench, file: &str, from: &str, to: &str) {
    let text = bench.read(file);
    assert!(text.contains(from), "{file} has no {from}");
    bench.write(file, &text.replacen(from, to, 1));
}

#[test]
fn a_run_with_any_arguments_gives_the_same_bytes_again() {
    for (arguments, files) in [
        ("", 7),
        ("--set segments.*.EI*=2 --set payload.mass=0.05", 7),
        ("--resample 0.002 --nodes 0,5,10 --every 10 --deflections", 8),
        ("--moments --digits full --threads 1 --report", 8),
        ("--digits=6 --verify --no-sync --set drive.gear_ratio=3", 8),
        ("--scale-distance=-0.3 --scale-duration 1.7", 7),
        ("--columns time=1,acceleration=2 --scale acceleration=0.5 --skip=0", 7),
    ] {
        let bench = solved(arguments);
        repeats(&bench, &["out"], files);
        repeats(&bench, &["out", "--threads", "2"], files);
    }
}

#[test]
fn a_run_whose_answer_was_out_of_its_bounds_is_repeated_all_the_same() {
    let bench = bench();
    bench.ends(4, "solve link.toml motion.csv --digits=2 --verify --every=99");
    repeats(&bench, &["out"], 7);
}

#[test]
fn new_results_are_kept_where_they_are_asked_for_and_else_nothing_is_left() {
    let bench = solved("--moments");
    let names = bench.names(".");
    let temporary = bench.path("temporary");
    fs::create_dir(&temporary).unwrap();
    let mut program = bench.program("solve --repeat out");
    succeeded(program.env("TMPDIR", &temporary).output().unwrap());
    assert_eq!(bench.names("temporary"), [""; 0]);
    fs::remove_dir(&temporary).unwrap();
    assert_eq!(bench.names("."), names);
    let told = bench.silent("solve --repeat out -o again --no-sync");
    assert_eq!(told, "same     8 files of out, byte for byte\nwritten  again\n");
    assert!(bench.contents("out") == bench.contents("again"));
    assert_eq!(bench.silent("solve --repeat out -q"), "");
}

#[test]
fn one_byte_of_a_table_is_found_and_its_line_told() {
    let bench = solved("--digits 4");
    let text = bench.read("out/torque.csv");
    let row = text.lines().nth(3799).unwrap();
    let (last, rows) = (row.chars().last().unwrap(), text.lines().count());
    let other = format!("{}{}", &row[..row.len() - 1], if last == '1' { '2' } else { '1' });
    change(&bench, "out/torque.csv", &format!("\n{row}\n"), &format!("\n{other}\n"));
    let place = format!("line 3800, 1 of {rows} in all");
    let line = format!("differs  torque.csv: {place}: was \"{other}\", now \"{row}\"\n");
    differs(&bench, &line, 1, "hint: keep the new results for flexlink compare with -o DIR\n");
    let kept = ended(1, repeat(&bench, &["out", "-o", "again"]));
    assert_eq!(stderr(&kept), "hint: flexlink compare out again says by how much\n");
    bench.ends(1, "compare out again");
    let quiet = ended(1, repeat(&bench, &["out", "-q"]));
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
}

#[test]
fn a_table_that_is_missing_or_too_many_is_told_and_foreign_files_are_not() {
    let bench = solved("--report");
    bench.write("out/notes.txt", "mine");
    bench.write("out/report.html", "another page");
    repeats(&bench, &["out"], 7);
    fs::remove_file(bench.path("out/tip.csv")).unwrap();
    let missing = "missing  tip.csv: the run wrote it\n";
    differs(&bench, missing, 1, "");
    bench.write("out/motor.csv", "time_s\n");
    let told = stdout(&ended(1, repeat(&bench, &["out"])));
    let extra = "extra    motor.csv: the run does not write it\n";
    assert_eq!(told, format!("{missing}{extra}result   2 of 8 files of out not the same\n"));
}

#[test]
fn a_number_of_the_summary_is_compared_too() {
    let bench = solved("");
    change(&bench, "out/summary.json", "\"torque_ratio\": 0.5", "\"torque_ratio\": 0.6");
    let output = ended(1, repeat(&bench, &["out"]));
    let told = stdout(&output);
    assert_eq!(stderr(&output), "");
    assert!(told.starts_with("differs  summary.json: line ") && told.contains("was \""), "{told}");
}

#[test]
fn another_version_is_warned_of_and_its_line_differs() {
    let bench = solved("");
    let version = env!("CARGO_PKG_VERSION");
    let line = |version: &str| format!("\"flexlink\": \"{version}\",");
    change(&bench, "out/summary.json", &line(version), &line("9.1.0"));
    let lines = bench.read("out/summary.json").lines().count();
    let shown = |version| format!("\"  {}\"", line(version).escape_default());
    let (was, now) = (shown("9.1.0"), shown(version));
    let warning = format!(
        "warning: out/summary.json: flexlink = 9.1.0, but this is {version}\n\
         hint: differences may come from the other version\n"
    );
    let place = format!("line 3, 1 of {lines} in all");
    let told = format!("differs  summary.json: {place}: was {was}, now {now}\n");
    differs(&bench, &told, 1, &warning);
}

#[test]
fn an_input_is_found_by_its_content_here_in_the_folder_or_above_it() {
    let bench = bench();
    let moved = |from: &str, to: &str| fs::rename(bench.path(from), bench.path(to)).unwrap();
    fs::create_dir(bench.path("case")).unwrap();
    moved("link.toml", "case/link.toml");
    moved("motion.csv", "case/motion.csv");
    bench.done("solve case/link.toml case/motion.csv -o case/out -q");
    repeats(&bench, &["case/out"], 7);
    // Another file of the name stands first.
    bench.write("link.toml", "segments = []");
    repeats(&bench, &["case/out"], 7);
    moved("case/motion.csv", "case/out/motion.csv");
    repeats(&bench, &["case/out"], 7);
    fs::remove_file(bench.path("link.toml")).unwrap();
    moved("case/link.toml", "moved.toml");
    let folders = "must be in one of the folders ., case/out, case";
    let name = "name both: flexlink solve --repeat case/out LINK MOTION, one of them may be `-`";
    let error = "error: case/out/summary.json: inputs.link = \"link.toml\"";
    let told = format!("{error}, but {folders}\nhint: {name}\n");
    assert_eq!(refused(&bench, &["case/out"]), told);
    repeats(&bench, &["case/out", "moved.toml"], 7);
}

#[test]
fn an_input_that_has_changed_is_refused_with_both_fingerprints() {
    let bench = solved("");
    let before = recorded(&bench, "link");
    change(&bench, "link.toml", "Bayo", "Baio");
    bench.done("solve link.toml motion.csv -o new -q");
    let after = bench.json("new/summary.json")["inputs"]["link"]["sha256"].to_string();
    let give = "name both: flexlink solve --repeat out LINK MOTION, one of them may be `-`";
    let told = |found: &str, role: &str| {
        format!(
            "error: out/summary.json: {found}\n\
             hint: {role} has changed since the run, or is another file; {give}\n"
        )
    };
    let here = format!("link.toml has SHA-256 {}", after.trim_matches('"'));
    let must = format!("but must have SHA-256 {before}");
    let of_link = told(&format!("{here}, {must}"), "LINK");
    assert_eq!(refused(&bench, &["out"]), of_link);
    assert_eq!(refused(&bench, &["out", "link.toml"]), of_link);
    fs::copy(bench.path("link.toml"), bench.path("out/link.toml")).unwrap();
    let both = format!("{here}, out/{here}, {must}");
    assert_eq!(refused(&bench, &["out"]), told(&both, "LINK"));
    fs::copy(repository(LINK), bench.path("link.toml")).unwrap();
    let must = format!("but must have SHA-256 {}", recorded(&bench, "motion"));
    let other = told(&format!("link.toml has SHA-256 {before}, {must}"), "MOTION");
    assert_eq!(refused(&bench, &["out", "link.toml", "link.toml"]), other);
}

#[test]
fn standard_input_must_be_given_again() {
    let bench = bench();
    let motion = bench.read("motion.csv");
    succeeded(bench.fed(&motion, "solve link.toml - -q"));
    let told = refused(&bench, &["out"]);
    let error =
        "error: out/summary.json: inputs.motion = standard input, but must be given again\n";
    assert!(told.starts_with(error) && told.contains("\nhint: name both: "), "{told}");
    let output = bench.fed(&motion, "solve --repeat out link.toml -");
    assert_eq!(stdout(&output), "same     7 files of out, byte for byte\n", "{}", stderr(&output));
    // The content counts, and not where it comes from.
    repeats(&bench, &["out", "link.toml", "motion.csv"], 7);
    let twice = ended(2, bench.fed(&motion, "solve --repeat out - -"));
    assert_eq!(stderr(&twice), "error: standard input = several files, but must be one\n");
}

#[test]
fn names_may_have_blanks_and_begin_with_a_dash() {
    let bench = bench();
    fs::rename(bench.path("link.toml"), bench.path("-my link.toml")).unwrap();
    fs::rename(bench.path("motion.csv"), bench.path("--set")).unwrap();
    let set = "--set=title=\"-a b\"";
    bench.done(&["solve", "-q", "-o", "o t", set, "--", "-my link.toml", "--set"]);
    repeats(&bench, &["o t"], 7);
    repeats(&bench, &["o t", "--", "-my link.toml"], 7);
}

#[test]
fn the_case_of_a_sweep_is_repeated_as_a_run_of_solve() {
    let bench = bench();
    let vary = "sweep link.toml motion.csv -q --vary segments.*.EI*=1,3 --vary duration*=1,1.3";
    let thin =
        ["--outputs", "all", "--nodes", "0,10", "--digits", "6", "--set", "payload.mass=50 g"];
    bench.done(&with(vary, &thin));
    for case in ["all/1", "all/2", "all/4"] {
        repeats(&bench, &[case], 7);
    }
    let told = refused(&bench, &["all"]);
    let error = "error: all: summary.json is missing: this is not the folder of a run";
    assert!(told.starts_with(error) && told.ends_with(NO_RUN), "{told}");
}

const NO_RUN: &str =
    "hint: --repeat takes the folder of a run of `solve`, or of a case of `sweep --outputs`\n";

#[test]
fn a_simulation_and_what_is_no_run_are_refused() {
    let bench = solved("");
    bench.done("simulate link.toml out/torque.csv -q");
    let error = "error: simulated/summary.json: command = \"simulate\", but must be \"solve\"\n";
    assert_eq!(refused(&bench, &["simulated"]), format!("{error}{NO_RUN}"));
    let told = refused(&bench, &["link.toml"]);
    let error = "error: link.toml: summary.json is missing";
    assert!(told.starts_with(error) && told.ends_with(NO_RUN), "{told}");
}

#[test]
fn a_damaged_record_is_refused_and_leads_nowhere() {
    let bench = solved("--digits 8");
    let summary = bench.read("out/summary.json");
    let after = |from: &str, to: &str| {
        change(&bench, "out/summary.json", from, to);
        let told = refused(&bench, &["out"]);
        bench.write("out/summary.json", &summary);
        told
    };
    let version = env!("CARGO_PKG_VERSION");
    let arguments = "error: out/summary.json: inputs.arguments";
    let unknown = format!("{arguments} are not those of flexlink {version}: ");
    let digits = "\"--digits\",";
    for argument in ["--frobnicate", "--output", "--repeat", "--help", "motion.csv"] {
        let value = if argument == "--output" || argument == "--repeat" { "=out" } else { "" };
        let told = after(digits, &format!("\"{argument}{value}\",{digits}"));
        assert_eq!(told, format!("{unknown}unexpected argument '{argument}' found\n"));
    }
    let value = after("\"8\"", "\"88\"");
    assert!(
        value.starts_with(&format!("{unknown}invalid value '88' for '--digits <N>'")),
        "{value}"
    );
    for (argument, error) in [
        ("\"--set\", \"x\",", "--set 'x': has no `=`, but must read PATH=VALUE or PATH*=FACTOR\n"),
        ("\"--nodes\", \"99\",", "--nodes = 99, but must name nodes of the mesh, 0 to 10\n"),
    ] {
        let told = after(digits, &format!("{argument}{digits}"));
        assert!(told.starts_with(&format!("{arguments}: {error}")), "{told}");
    }
    let must = "but must be names, without folders or control characters";
    for (from, key, to) in [
        ("\"name\": \"link.toml\"", "inputs", "../link.toml"),
        ("\"tip.csv\"", "files", "/etc/tip.csv"),
    ] {
        let folder = after(from, &from.replace(to.rsplit('/').next().unwrap(), to));
        assert_eq!(folder, format!("error: out/summary.json: {key} = \"{to}\", {must}\n"));
    }
    let cut = after("\"arguments\"", "\"changes\"");
    assert!(cut.contains("arguments is missing"), "{cut}");
    bench.write("out/summary.json", &summary[..300]);
    let half = refused(&bench, &["out"]);
    assert!(half.contains("but must be the summary of a run, in JSON"), "{half}");
    assert_eq!(bench.names("."), ["link.toml", "motion.csv", "out"]);
}

#[test]
fn other_arguments_contradict_a_repetition() {
    let bench = Bench::new();
    let others = "--set=a=1 --resample=1 --scale-distance=1 --scale-duration=1 --nodes=1 --every=1 \
                  --deflections --moments --digits=10 --verify --report --strict --json --skip=1 \
                  --columns=time=1 --unit=m --time-unit=s --scale=time=2 --delimiter=; \
                  --decimal=comma";
    for argument in others.split(' ') {
        refusal(2, repeat(&bench, &["out", argument]), "--repeat <DIR>");
    }
}

#[test]
fn new_results_do_not_replace_those_that_they_are_held_against() {
    let bench = solved("");
    let before = bench.contents("out");
    for output in ["out", "./out/../out"] {
        let error = format!(
            "error: --output = {output}, but must be another folder than that of out/summary.json\n\
             hint: a folder holds one run: the results would replace those read\n"
        );
        assert_eq!(stderr(&ended(2, repeat(&bench, &["out", "-o", output]))), error);
    }
    assert!(bench.contents("out") == before);
    // Nor an input, wherever it was found.
    fs::copy(bench.path("out/tip.csv"), bench.path("tip.csv")).unwrap();
    bench.done("solve link.toml tip.csv -o second -q");
    ended(2, repeat(&bench, &["second", "-o", "."]));
    assert!(bench.read("tip.csv") == bench.read("out/tip.csv"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_of_the_system_that_takes_no_file_is_told_with_the_way_out() {
    let bench = solved("");
    let mut program = bench.program("solve --repeat out");
    let told = stderr(&ended(5, program.env("TMPDIR", bench.path("none")).output().unwrap()));
    assert!(told.contains("/none: cannot write into the folder: "), "{told}");
    assert!(told.ends_with("hint: choose another folder with -o DIR\n"), "{told}");
}

#[test]
fn a_golden_folder_that_was_blessed_repeats() {
    let bench = solved("-o golden --report");
    // Within the tolerance, and not the same bytes: a run is taken as a whole.
    change(&bench, "golden/nodes.csv", "0,0", "0,0.0000000000001");
    bench.done("solve link.toml motion.csv -q --set payload.mass=0.1");
    let told = bench.printed("compare golden out --bless");
    assert!(told.ends_with("files written, 1 removed\n"), "{told}");
    assert!(bench.contents("golden") == bench.contents("out"));
    repeats(&bench, &["golden"], 7);
    let again = bench.printed("compare golden out --bless");
    assert!(again.ends_with("blessed  nothing: golden is as it was\n"), "{again}");
}
