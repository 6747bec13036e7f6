//! Inputs that ask for more memory than there is. The system's own limit stands for a small machine.
#![cfg(target_os = "linux")]

use std::fmt::Write as _;
use std::fs::File;
use std::process::{Output, Stdio};

use super::{Bench, NOT_SOLVABLE, PROGRAM, REFUSED, text};

impl Bench {
    /// Runs the program on two threads with so many MB of address space, `input` as standard input.
    fn run_within(&self, megabytes: u32, arguments: &[&str], input: Stdio) -> Output {
        self.run_limited(&format!("-v {}", 1000 * megabytes), arguments, input)
    }

    /// Runs the program on two threads under a limit of the shell's `ulimit`.
    fn run_limited(&self, limit: &str, arguments: &[&str], input: Stdio) -> Output {
        let script = format!("ulimit {limit}; exec \"$0\" \"$@\"");
        let words = [&["-c", &script, PROGRAM], arguments].concat();
        let mut command = self.command("sh", &words);
        command.env("RAYON_NUM_THREADS", "2").stdin(input).output().unwrap()
    }
}

#[test]
fn memory_that_no_estimate_foresees_ends_as_any_refusal_does() {
    let bench = Bench::new();
    let mut ends = [0, 0];
    // The limit of data, which no estimate takes into account: from the first words to the last table.
    for megabytes in 3..=22 {
        let limit = format!("-d {}", 1000 * megabytes);
        let solve = ["solve", "link.toml", "motion.csv", "-q", "--set", "analysis.lag=20"];
        let output = bench.run_limited(&limit, &solve, Stdio::null());
        if output.status.code() == Some(0) {
            ends[0] += 1;
            std::fs::remove_dir_all(bench.path("out")).unwrap();
            continue;
        }
        ends[1] += 1;
        // The folder of the results may be there by then, but with nothing in it.
        let out = bench.path("out");
        if out.exists() {
            std::fs::remove_dir(out).unwrap();
        }
        bench.is_refusal(&output, NOT_SOLVABLE, "error: out of memory");
        assert_eq!(text(&output.stderr).matches("out of memory").count(), 1);
        assert_eq!(std::fs::read_dir(bench.path(".")).unwrap().count(), 2, "{limit}");
    }
    assert!(ends[1] > 2, "{ends:?}");
}

#[test]
fn as_many_threads_work_as_there_is_room_for() {
    let bench = Bench::new();
    let sweep = ["sweep", "link.toml", "motion.csv", "--vary", "segments.*.EI*=1:4:16", "-q"];
    let sweep = [&sweep[..], &["--threads", "16", "-o"]].concat();
    bench.run(&[&sweep[..], &["all.csv"]].concat());
    for megabytes in [80, 155, 170, 200, 400, 800] {
        let few = [&sweep[..], &["few.csv"]].concat();
        let output = bench.run_within(megabytes, &few, Stdio::null());
        assert_eq!(output.status.code(), Some(0), "{megabytes} MB: {}", text(&output.stderr));
        let [all, few] =
            ["all.csv", "few.csv"].map(|name| std::fs::read(bench.path(name)).unwrap());
        assert!(all == few, "{megabytes} MB");
    }
}

#[test]
fn what_is_no_text_takes_little_memory_to_refuse() {
    let bench = Bench::new();
    File::create(bench.path("sparse")).unwrap().set_len(1 << 30).unwrap();
    let message = "error: sparse: cannot read: not a text file: byte 1 is 0x00\n";
    for arguments in [
        ["solve", "sparse", "motion.csv"],
        ["solve", "link.toml", "sparse"],
        ["simulate", "link.toml", "sparse"],
        ["compare", "sparse", "motion.csv"],
    ] {
        let output = bench.run_within(300, &arguments, Stdio::null());
        bench.is_refusal(&output, REFUSED, message);
    }
}

#[test]
fn an_input_without_end_is_refused_before_memory_ends() {
    let bench = Bench::new();
    let zeros = File::open("/dev/zero").unwrap();
    let output = bench.run_within(300, &["solve", "link.toml", "-"], zeros.into());
    bench.is_refusal(
        &output,
        REFUSED,
        "standard input: cannot read: not a text file: byte 1 is 0x00",
    );
    let noise = File::open("/dev/urandom").unwrap();
    let output = bench.run_within(300, &["solve", "link.toml", "-"], noise.into());
    bench.is_refusal(&output, REFUSED, "standard input: cannot read: not a text file: byte ");
    let mut letters = bench.command("sh", &["-c", "yes | tr -d '\\n'"]);
    let mut letters = letters.stdout(Stdio::piped()).spawn().unwrap();
    let input = letters.stdout.take().unwrap();
    let output = bench.run_within(300, &["solve", "link.toml", "-"], input.into());
    letters.wait().unwrap();
    bench.is_refusal(&output, REFUSED, "standard input: cannot read: line 1 is longer than 16 MiB");
    let mut lines = bench.command("yes", &["0.1,0.2"]).stdout(Stdio::piped()).spawn().unwrap();
    let input = lines.stdout.take().unwrap();
    let output = bench.run_within(600, &["solve", "link.toml", "-"], input.into());
    let _ = lines.kill();
    lines.wait().unwrap();
    bench.is_refusal(&output, REFUSED, "cannot read: longer than 16778240 lines\n");
}

#[test]
fn a_link_file_without_end_is_refused_before_it_takes_much() {
    let bench = Bench::new();
    let mut lines = bench.command("yes", &["[[segments]]"]).stdout(Stdio::piped()).spawn().unwrap();
    let input = lines.stdout.take().unwrap();
    let output = bench.run_within(900, &["modes", "-"], input.into());
    let _ = lines.kill();
    lines.wait().unwrap();
    bench.is_refusal(&output, REFUSED, "standard input: cannot read: longer than 16778240 lines\n");
}

#[test]
#[ignore = "half a minute and 3 GB: cargo test --test hostile -- --ignored"]
fn ten_million_rows_are_solved_in_the_memory_that_was_estimated() {
    let bench = Bench::new();
    let mut rows = String::from("time,acceleration\n");
    for k in 0..=10_000_000_u32 {
        let phase = std::f64::consts::TAU * f64::from(k) / 1e7;
        writeln!(rows, "{:.4},{}", 1e-4 * f64::from(k), phase.sin()).unwrap();
    }
    bench.write("motion.csv", rows);
    let options = ["--nodes", "10", "--every", "1000", "-q"];
    let solve = [&["solve", "link.toml", "motion.csv"], &options[..]].concat();
    let output = bench.run_within(4000, &solve, Stdio::null());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let output = bench.run_within(1500, &[&solve[..], &["-o", "other"]].concat(), Stdio::null());
    assert_eq!(output.status.code(), Some(NOT_SOLVABLE), "{}", text(&output.stderr));
    let told = text(&output.stderr);
    assert!(told.contains("the inversion would need 2.1 GB of memory"), "{told}");
}

#[test]
fn what_solving_would_need_is_told_before_it_is_taken() {
    let bench = Bench::new();
    let long = ["solve", "link.toml", "motion.csv", "--set", "analysis.lag=80000"];
    let output = bench.run_within(900, &long, Stdio::null());
    let message = "error: the inversion would need 1.7 GB of memory, but must fit in the 0.";
    bench.is_refusal(&output, NOT_SOLVABLE, message);
    // The period fits, but twice as long, as the decay before the motion asks for, it does not.
    let longer = ["solve", "link.toml", "motion.csv", "--set", "analysis.lag=20000"];
    let output = bench.run_within(900, &longer, Stdio::null());
    let message = "error: the inversion would need 1.3 GB of memory, but must fit in the 0.";
    bench.is_refusal(&output, NOT_SOLVABLE, message);
    let hint = "hint: use a longer step, or a shorter analysis.lead and analysis.lag\n";
    assert!(text(&output.stderr).ends_with(hint), "{}", text(&output.stderr));
}

#[test]
fn what_the_nodes_would_need_is_told_and_fewer_nodes_need_less() {
    let bench = Bench::new();
    let many = ["solve", "link.toml", "motion.csv", "--set", "analysis.lag=2000"];
    let many = [&many[..], &["--set", "mesh.elements=600"]].concat();
    let output = bench.run_within(700, &many, Stdio::null());
    let message = "error: the motion of the nodes would need 1.";
    bench.is_refusal(&output, NOT_SOLVABLE, message);
    assert!(text(&output.stderr).ends_with("hint: use --nodes or --every\n"));
    let few = [&many[..], &["--nodes", "0,600", "--every", "100"]].concat();
    let output = bench.run_within(700, &few, Stdio::null());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

#[test]
fn verifying_and_the_cases_of_a_sweep_are_held_to_the_same_memory() {
    let bench = Bench::new();
    let lag = "analysis.lag=80000";
    let verify = ["verify", "link.toml", "motion.csv", "--set", lag];
    let output = bench.run_within(1000, &verify, Stdio::null());
    bench.is_refusal(&output, NOT_SOLVABLE, "error: the inversion would need 1.7 GB of memory");
    let vary = "segments.*.EI*=1,2";
    let sweep = ["sweep", "link.toml", "motion.csv", "--vary", vary, "-q", "-o", "sweep.csv"];
    let sweep = [&sweep[..], &["--threads", "2", "--set"]].concat();
    // Each has half; a case that needs more waits until it has all.
    for (lag, megabytes, failed) in [(lag, 1000, 2), ("analysis.lag=10000", 1600, 0)] {
        let output = bench.run_within(megabytes, &[&sweep[..], &[lag]].concat(), Stdio::null());
        let code = if failed > 0 { NOT_SOLVABLE } else { 0 };
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        let table = std::fs::read_to_string(bench.path("sweep.csv")).unwrap();
        assert_eq!(table.matches("the inversion would need").count(), failed, "{table}");
    }
}

#[test]
fn a_case_whose_files_would_need_too_much_fails_alone() {
    let bench = Bench::new();
    let vary = "mesh.elements=10,600";
    let sweep = ["sweep", "link.toml", "motion.csv", "--vary", vary, "-q", "-o", "sweep.csv"];
    let outputs = ["--outputs", "cases", "--threads", "1", "--set", "analysis.lag=2000"];
    let output = bench.run_within(700, &[&sweep[..], &outputs[..]].concat(), Stdio::null());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = std::fs::read_to_string(bench.path("sweep.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[1].ends_with(','), "{table}");
    assert!(rows[2].contains("the motion of the nodes would need 1."), "{table}");
    assert!(bench.path("cases/1/summary.json").exists() && !bench.path("cases/2").exists());
}

#[test]
fn a_frequency_response_that_would_need_too_much_is_refused() {
    let bench = Bench::new();
    let many = ["frf", "link.toml", "--points", "100000000"];
    let output = bench.run_within(500, &many, Stdio::null());
    let message = "error: the frequency response would need 22 GB of memory";
    bench.is_refusal(&output, NOT_SOLVABLE, message);
    assert!(text(&output.stderr).ends_with("hint: use fewer --points\n"));
}

#[test]
fn what_playing_and_its_nodes_would_need_is_told_before_it_is_taken() {
    let bench = Bench::new();
    bench.write("torque.csv", "time,torque\n0,0\n0.01,1\n0.02,0\n0.03,0\n");
    let simulate = ["simulate", "link.toml", "torque.csv", "--until"];
    let long = [&simulate[..], &["100000"]].concat();
    let output = bench.run_within(900, &long, Stdio::null());
    let message = "error: 10000001 samples of ";
    bench.is_refusal(&output, NOT_SOLVABLE, message);
    assert!(text(&output.stderr).contains(" of memory, but must fit in the 0."));
    let many = [&simulate[..], &["1000", "--set", "mesh.elements=600"]].concat();
    let output = bench.run_within(450, &many, Stdio::null());
    let message = "error: the motion of the nodes would need 0.48 GB of memory";
    bench.is_refusal(&output, NOT_SOLVABLE, message);
    let few = [&many[..], &["--nodes", "0,600"]].concat();
    let output = bench.run_within(450, &few, Stdio::null());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

#[test]
fn an_arm_of_many_pieces_is_counted_before_its_matrices_are_made() {
    let bench = Bench::new();
    let segments = |count: usize| {
        let length_m = 0.7 / count as f64;
        let one = format!("{{ length = {length_m}, EI = 60, mass_per_length = 0.8 }},");
        format!("segments = [{}]\n", one.repeat(count))
    };
    let mut masses = String::new();
    for k in 1..1500 {
        write!(masses, "{{ at = {}, mass = 1e-4 }},", 0.7 * f64::from(k) / 1500.0).unwrap();
    }
    let many = [segments(1500), format!("{}masses = [{masses}]\n", segments(1))];
    bench.write("m.toml", "at = [0.1, 1.2]\n[[frequency]]\nmode = 3\nvalue = 8.0\n");
    bench.write("t.csv", "time,torque1,torque2\n0,0,0\n0.1,1,0\n0.2,0,1\n0.3,0,0\n");
    for pieces in many {
        let link =
            |name: &str| format!("[[links]]\nname = \"{name}\"\nhub.inertia = 0.1\n{pieces}");
        bench.write("arm.toml", format!("elbow = \"left\"\n{}{}", link("a"), link("b")));
        let fit = ["fit", "arm.toml", "m.toml", "--free", "links.a.segments.*.EI"];
        for (arguments, code) in [
            (&["modes", "arm.toml", "--at", "0.1,1.2"][..], NOT_SOLVABLE),
            (&["frf", "arm.toml", "--at", "0.1,1.2", "--points", "3"], NOT_SOLVABLE),
            (&fit, REFUSED),
        ] {
            let output = bench.run_within(300, arguments, Stdio::null());
            let message =
                "the bending of all links takes 9002 coordinates, but must take at most 400";
            bench.is_refusal(&output, code, message);
        }
        let simulate = ["simulate", "arm.toml", "t.csv", "--at", "0.1,1.2"];
        let output = bench.run_within(300, &simulate, Stdio::null());
        bench.is_refusal(&output, NOT_SOLVABLE, "modes would need");
    }
}

#[test]
fn a_link_of_many_pieces_is_counted_before_it_is_played_with_its_weight() {
    let bench = Bench::new();
    let one = "{ length = 0.001, EI = 60, mass_per_length = 0.8 },".repeat(3000);
    let rest = "hub.inertia = 0.1\ngravity = [0, -9.81]\nstart_angle = 0.1\n";
    bench.write("link.toml", format!("segments = [{one}]\n{rest}"));
    bench.write("t.csv", "time,torque\n0,0\n0.1,1\n0.2,-1\n0.3,0\n");
    let output = bench.run_within(300, &["simulate", "link.toml", "t.csv"], Stdio::null());
    bench.is_refusal(&output, NOT_SOLVABLE, "modes would need");
}
