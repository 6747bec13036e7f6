//! Inputs that ask for more memory than there is. The system's own limit stands for a small machine.
#![cfg(target_os = "linux")]

use std::fmt::Write as _;
use std::fs::{self, File};
use std::process::{Output, Stdio};

use super::words::Words;
use super::{Bench, NOT_SOLVABLE, PROGRAM, REFUSED, SOLVE, succeeded, text};

impl Bench {
    /// Runs the program on two threads with so many MB of address space.
    fn run_within(&self, megabytes: u32, arguments: &str) -> Output {
        self.run_limited(&format!("-v {}", 1000 * megabytes), arguments, Stdio::null())
    }

    /// Runs the program on two threads under a limit of the shell's `ulimit`, `input` as standard input.
    fn run_limited(&self, limit: &str, arguments: &str, input: Stdio) -> Output {
        let script = format!("ulimit {limit}; exec \"$0\" \"$@\"");
        let shell = ["-c", &script, PROGRAM].map(str::to_owned).to_vec();
        let mut command = self.command("sh", &[shell, arguments.words()].concat());
        command.env("RAYON_NUM_THREADS", "2").stdin(input).output().unwrap()
    }

    /// The program must succeed within so many MB.
    #[track_caller]
    fn done_within(&self, megabytes: u32, arguments: &str) {
        succeeded(&(megabytes, arguments), &self.run_within(megabytes, arguments));
    }

    /// The program must refuse within so many MB, with this message and this hint at its end.
    #[track_caller]
    fn refuses_within(&self, megabytes: u32, arguments: &str, told: (i32, &str, &str)) {
        let (code, message, hint) = told;
        let output = self.run_within(megabytes, arguments);
        self.is_refusal(&output, code, message);
        assert!(text(&output.stderr).ends_with(hint), "{}", text(&output.stderr));
    }
}

#[test]
fn memory_that_no_estimate_foresees_ends_as_any_refusal_does() {
    let bench = Bench::new();
    let mut refusals = 0;
    // The limit of data, which no estimate takes into account: from the first words to the last table.
    for megabytes in 3..=22 {
        let limit = format!("-d {}", 1000 * megabytes);
        let solve = format!("{SOLVE} -q --set analysis.lag=20");
        let output = bench.run_limited(&limit, &solve, Stdio::null());
        let out = bench.path("out");
        if output.status.code() == Some(0) {
            fs::remove_dir_all(out).unwrap();
            continue;
        }
        refusals += 1;
        // The folder of the results may be there by then, but with nothing in it.
        if out.exists() {
            fs::remove_dir(out).unwrap();
        }
        bench.is_refusal(&output, NOT_SOLVABLE, "error: out of memory");
        assert_eq!(text(&output.stderr).matches("out of memory").count(), 1);
        assert_eq!(fs::read_dir(bench.path(".")).unwrap().count(), 2, "{limit}");
    }
    assert!(refusals > 2, "{refusals}");
}

#[test]
fn as_many_threads_work_as_there_is_room_for() {
    let bench = Bench::new();
    let vary = "--vary segments.*.EI*=1:4:16 -q --threads 16";
    bench.run(&format!("sweep link.toml motion.csv {vary} -o all.csv"));
    for megabytes in [80, 155, 170, 200, 400, 800] {
        bench.done_within(megabytes, &format!("sweep link.toml motion.csv {vary} -o few.csv"));
        assert!(bench.read("all.csv") == bench.read("few.csv"), "{megabytes} MB");
    }
}

#[test]
fn what_is_no_text_takes_little_memory_to_refuse() {
    let bench = Bench::new();
    File::create(bench.path("sparse")).unwrap().set_len(1 << 30).unwrap();
    let message = "error: sparse: cannot read: not a text file: byte 1 is 0x00\n";
    for arguments in [
        "solve sparse motion.csv",
        "solve link.toml sparse",
        "simulate link.toml sparse",
        "compare sparse motion.csv",
    ] {
        bench.refuses_within(300, arguments, (REFUSED, message, ""));
    }
}

#[test]
fn an_input_without_end_is_refused_before_memory_ends() {
    let bench = Bench::new();
    let lines = "cannot read: longer than 16778240 lines\n";
    for (megabytes, arguments, input, message) in [
        (300, "solve link.toml -", "/dev/zero", "cannot read: not a text file: byte 1 is 0x00"),
        (300, "solve link.toml -", "/dev/urandom", "cannot read: not a text file: byte "),
        (
            300,
            "solve link.toml -",
            "yes | tr -d '\\n'",
            "cannot read: line 1 is longer than 16 MiB",
        ),
        (600, "solve link.toml -", "yes 0.1,0.2", lines),
        // A link file takes much of it only once it has ended.
        (900, "modes -", "yes '[[segments]]'", lines),
    ] {
        let mut endless = bench.command("sh", &["-c", input]);
        let mut endless = endless.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let pipe = endless.stdout.take().unwrap();
        let input =
            if input.starts_with('/') { File::open(input).unwrap().into() } else { pipe.into() };
        let output = bench.run_limited(&format!("-v {megabytes}000"), arguments, input);
        endless.wait().unwrap();
        bench.is_refusal(&output, REFUSED, &format!("standard input: {message}"));
    }
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
    let solve = format!("{SOLVE} --nodes 10 --every 1000 -q");
    bench.done_within(4000, &solve);
    let output = bench.run_within(1500, &format!("{solve} -o other"));
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(NOT_SOLVABLE), "{told}");
    assert!(told.contains("the inversion would need 2.1 GB of memory"), "{told}");
}

#[test]
fn what_solving_would_need_is_told_before_it_is_taken() {
    let bench = Bench::new();
    let hint = "hint: use a longer step, or a shorter analysis.lead and analysis.lag\n";
    // The second period fits, but twice as long, as the decay before the motion asks for, it does not.
    for (lag, gigabytes) in [(80000, 1.7), (20000, 1.3)] {
        let message = format!(
            "error: the inversion would need {gigabytes} GB of memory, but must fit in the 0."
        );
        let solve = format!("{SOLVE} --set analysis.lag={lag}");
        bench.refuses_within(900, &solve, (NOT_SOLVABLE, &message, hint));
    }
}

#[test]
fn what_the_nodes_would_need_is_told_and_fewer_nodes_need_less() {
    let bench = Bench::new();
    let many = format!("{SOLVE} --set analysis.lag=2000 --set mesh.elements=600");
    let message = "error: the motion of the nodes would need 1.";
    let hint = "hint: use --nodes or --every\n";
    bench.refuses_within(700, &many, (NOT_SOLVABLE, message, hint));
    bench.done_within(700, &format!("{many} --nodes 0,600 --every 100"));
}

#[test]
fn verifying_and_the_cases_of_a_sweep_are_held_to_the_same_memory() {
    let bench = Bench::new();
    let message = "error: the inversion would need 1.7 GB of memory";
    let verify = "verify link.toml motion.csv --set analysis.lag=80000";
    bench.refuses_within(1000, verify, (NOT_SOLVABLE, message, ""));
    let sweep = "sweep link.toml motion.csv --vary segments.*.EI*=1,2 -q -o sweep.csv --threads 2";
    // Each has half; a case that needs more waits until it has all.
    for (lag, megabytes, failed) in [(80000, 1000, 2), (10000, 1600, 0)] {
        let output = bench.run_within(megabytes, &format!("{sweep} --set analysis.lag={lag}"));
        let code = if failed > 0 { NOT_SOLVABLE } else { 0 };
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        let table = bench.read("sweep.csv");
        assert_eq!(table.matches("the inversion would need").count(), failed, "{table}");
    }
}

#[test]
fn a_case_whose_files_would_need_too_much_fails_alone() {
    let bench = Bench::new();
    let sweep = "sweep link.toml motion.csv --vary mesh.elements=10,600 -q -o sweep.csv";
    let outputs = "--outputs cases --threads 1 --set analysis.lag=2000";
    bench.done_within(700, &format!("{sweep} {outputs}"));
    let table = bench.read("sweep.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[1].ends_with(','), "{table}");
    assert!(rows[2].contains("the motion of the nodes would need 1."), "{table}");
    assert!(bench.path("cases/1/summary.json").exists() && !bench.path("cases/2").exists());
}

#[test]
fn a_frequency_response_that_would_need_too_much_is_refused() {
    let message = "error: the frequency response would need 22 GB of memory";
    let told = (NOT_SOLVABLE, message, "hint: use fewer --points\n");
    Bench::new().refuses_within(500, "frf link.toml --points 100000000", told);
}

#[test]
fn what_playing_and_its_nodes_would_need_is_told_before_it_is_taken() {
    let bench = Bench::new();
    bench.write("torque.csv", "time,torque\n0,0\n0.01,1\n0.02,0\n0.03,0\n");
    let simulate = "simulate link.toml torque.csv --until";
    for message in ["error: 10000001 samples of ", " of memory, but must fit in the 0."] {
        bench.refuses_within(900, &format!("{simulate} 100000"), (NOT_SOLVABLE, message, ""));
    }
    let many = format!("{simulate} 1000 --set mesh.elements=600");
    let message = "error: the motion of the nodes would need 0.48 GB of memory";
    bench.refuses_within(450, &many, (NOT_SOLVABLE, message, ""));
    bench.done_within(450, &format!("{many} --nodes 0,600"));
}

#[test]
fn an_arm_of_many_pieces_is_counted_before_its_matrices_are_made() {
    let bench = Bench::new();
    let segments = |count: usize| {
        let length_m = 0.7 / count as f64;
        let one = format!("{{ length = {length_m}, EI = 60, mass_per_length = 0.8 }},");
        format!("segments = [{}]\n", one.repeat(count))
    };
    let mass = |k: i32| format!("{{ at = {}, mass = 1e-4 }},", 0.7 * f64::from(k) / 1500.0);
    let masses: String = (1..1500).map(mass).collect();
    bench.write("m.toml", "at = [0.1, 1.2]\n[[frequency]]\nmode = 3\nvalue = 8.0\n");
    bench.write("t.csv", "time,torque1,torque2\n0,0,0\n0.1,1,0\n0.2,0,1\n0.3,0,0\n");
    for pieces in [segments(1500), format!("{}masses = [{masses}]\n", segments(1))] {
        let link =
            |name: &str| format!("[[links]]\nname = \"{name}\"\nhub.inertia = 0.1\n{pieces}");
        bench.write("arm.toml", format!("elbow = \"left\"\n{}{}", link("a"), link("b")));
        let bending = "the bending of all links takes 9002 coordinates, but must take at most 400";
        for (arguments, code, message) in [
            ("modes arm.toml --at 0.1,1.2", NOT_SOLVABLE, bending),
            ("frf arm.toml --at 0.1,1.2 --points 3", NOT_SOLVABLE, bending),
            ("fit arm.toml m.toml --free links.a.segments.*.EI", REFUSED, bending),
            ("simulate arm.toml t.csv --at 0.1,1.2", NOT_SOLVABLE, "modes would need"),
        ] {
            bench.refuses_within(300, arguments, (code, message, ""));
        }
    }
}

#[test]
fn a_link_of_many_pieces_is_counted_before_it_is_played_with_its_weight() {
    let bench = Bench::new();
    let one = "{ length = 0.001, EI = 60, mass_per_length = 0.8 },".repeat(3000);
    let rest = "hub.inertia = 0.1\ngravity = [0, -9.81]\nstart_angle = 0.1\n";
    bench.write("link.toml", format!("segments = [{one}]\n{rest}"));
    bench.write("t.csv", "time,torque\n0,0\n0.1,1\n0.2,-1\n0.3,0\n");
    bench.refuses_within(300, "simulate link.toml t.csv", (NOT_SOLVABLE, "modes would need", ""));
}
