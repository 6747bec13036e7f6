//! Standard input, output and error.

use std::fs;
use std::process::Command;

use super::{Bench, LINK, MOTION, ended, link_files, repository, stderr, stdout, succeeded};

#[test]
fn a_dash_reads_the_motion_from_standard_input() {
    let bench = Bench::new();
    bench.solve("-o file");
    let motion = fs::read(repository(MOTION)).unwrap();
    succeeded(bench.fed(motion, &format!("solve {LINK} - -o piped")));
    assert!(bench.read("piped/torque.csv") == bench.read("file/torque.csv"));
    let [summary, file] =
        ["piped", "file"].map(|run| bench.json(&format!("{run}/summary.json"))["inputs"].clone());
    assert_eq!(summary["motion"]["sha256"], file["motion"]["sha256"]);
    assert_eq!(summary["motion"]["name"], "-");
}

#[test]
fn a_refused_standard_input_is_called_by_that_name() {
    let refused = "time,acceleration\n0,zero\n";
    let told = stderr(&ended(3, Bench::new().fed(refused, &format!("solve {LINK} -"))));
    assert!(told.starts_with("error: standard input:2: "), "{told}");
}

/// `done` of a bench holds every line to 80 columns.
#[test]
fn lines_of_the_summary_have_at_most_eighty_columns() {
    let bench = Bench::new();
    let rayleigh = "damping={model=\"rayleigh\",modes=[1,3],ratios=[0.03,0.02]}";
    for spec in link_files() {
        for motion in ["trajectories/sine_0.88s.csv", "trajectories/min_jerk_1s.csv"] {
            for setting in ["hub.inertia=0.1234", rayleigh, "analysis.lead=12.345"] {
                let text = bench.printed(&["solve", &spec, motion, "--set", setting]);
                assert!(text.lines().count() <= 17, "{spec}: {text}");
            }
        }
    }
}

#[test]
fn a_link_with_all_that_a_summary_tells_has_seventeen_lines() {
    let bench = Bench::new();
    bench.write(
        "heavy.toml",
        "title = \"A heavy strip on a geared servo\"
segments = [{ length = 0.7, EI = 12.0, mass_per_length = 0.5 }]
hub.inertia = 0.01
payload.mass = 0.3
damping = { model = \"rayleigh\", beta = 2e-4 }
gravity = [0.0, -9.81]
start_angle = 0.2
drive = { gear_ratio = 50.0, rotor_inertia = 1e-5, joint_stiffness = 900.0 }
",
    );
    let text = bench.printed("solve heavy.toml trajectories/min_jerk_1s.csv");
    for label in ["damping  rayleigh, beta 2.00e-4 s, ratios ", "gravity ", "order ", "motor "] {
        assert!(text.lines().any(|line| line.starts_with(label)), "{text}");
    }
    assert!(text.lines().count() <= 17, "{text}");
}

#[test]
fn an_error_and_its_hint_go_to_standard_error_alone() {
    let bench = Bench::new();
    let link =
        "[[segments]]\nlength = 1\nEI = 5\nmass_per_length = 0.8\n\n[damping]\nratoi = 0.02\n";
    bench.write("link.toml", link);
    let output = bench.ends(3, &format!("solve link.toml {MOTION}"));
    assert_eq!(stdout(&output), "");
    assert_eq!(
        stderr(&output),
        "error: link.toml:7: unknown key `ratoi` in damping\nhint: did you mean `ratio`?\n"
    );
}

#[test]
fn a_warning_and_its_hint_go_to_standard_error_and_the_run_succeeds() {
    let output = Bench::new().solve("--set analysis.lag=0.1");
    let error = stderr(&output);
    let (warning, hint) = error.split_once('\n').unwrap();
    assert!(warning.starts_with("warning: the torque outside the written window"), "{warning}");
    assert_eq!(hint, "hint: use longer analysis.lead and lag, or leave both out\n");
    assert!(stdout(&output).starts_with("Bayo (1987), example 1"));
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let bench = Bench::new();
    let program = env!("CARGO_BIN_EXE_flexlink");
    let (link, motion) = (repository(LINK), repository(MOTION));
    // The reader is gone before the program prints; its exit code is kept in a file.
    bench.solve("-q");
    for command in [
        &format!("solve '{link}' '{motion}' -o new"),
        &format!("solve '{link}' '{motion}' -o new --json"),
        &format!("simulate '{link}' out/torque.csv -o new"),
        &format!("simulate '{link}' out/torque.csv -o new --json"),
        &format!("verify '{link}' '{motion}'"),
        &format!("modes '{link}' --count 3"),
        &format!("frf '{link}' --points 3 2> told"),
        "trajectory sine --distance 1 --duration 1 --step 0.0001",
        "init start",
        "schema",
        "completions bash",
        "man",
        "--help",
        "solve --help",
        "--version",
    ] {
        let script = format!("{{ '{program}' {command}; echo $? > code; }} | true");
        let mut shell = Command::new("sh");
        let output = shell.args(["-c", &script]).current_dir(bench.path(".")).output().unwrap();
        // The shell does not wait for the left side of a pipe in every case.
        for _ in 0..600 {
            if fs::read_to_string(bench.path("code")).is_ok_and(|code| code.ends_with('\n')) {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        assert_eq!(bench.read("code"), "0\n", "{command}");
        assert_eq!(stderr(&output), "");
        assert!(bench.path("new/summary.json").exists());
        fs::remove_file(bench.path("code")).unwrap();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_told_with_exit_code_five() {
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let bench = Bench::new();
    let mut program = bench.program(&format!("solve {LINK} {MOTION}"));
    let output = ended(5, program.stdout(full).output().unwrap());
    let expected = "error: standard output: cannot write: No space left on device\n";
    assert_eq!(stderr(&output), expected);
}
