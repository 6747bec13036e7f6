//! The scripts and programs of examples/, run as they stand. Most scripts need programs that a Rust
//! toolchain does not bring; `.ci/run` installs these and runs the ignored tests, too.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const VARY: &str = "segments.*.EI*=0.5:8:20:log";

/// A folder with the paper's link and a motion, in which `flexlink` is on the path.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (from, to) in [
            ("specs/bayo1987_example1.toml", "link.toml"),
            ("trajectories/sine_0.88s.csv", "move.csv"),
        ] {
            fs::copy(repository(from), folder.path().join(to)).unwrap();
        }
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn command(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Command {
        let own = Path::new(env!("CARGO_BIN_EXE_flexlink")).parent().unwrap();
        let before = env::var_os("PATH").unwrap_or_default();
        let paths = [own.to_owned()].into_iter().chain(env::split_paths(&before));
        let mut command = Command::new(program.as_ref());
        command.args(arguments).current_dir(self.folder.path());
        command.env("PATH", env::join_paths(paths).unwrap());
        command
    }

    /// Runs a program, which must succeed.
    #[track_caller]
    fn run(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Output {
        let output = self.command(program, arguments).output().unwrap();
        assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
        output
    }

    /// The table of a sweep on this machine alone.
    fn whole_sweep(&self) -> String {
        self.run("flexlink", &["sweep", "link.toml", "move.csv", "--vary", VARY, "-o", "one.csv"]);
        self.read("one.csv")
    }
}

fn repository(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
#[ignore = "needs gnuplot"]
fn the_stiffness_sweep_is_tabulated_and_plotted() {
    let desk = Desk::new();
    let script = repository("examples/stiffness_sweep.sh");
    let output = desk.run(script, &["link.toml", "move.csv", "link's stiffness"]);
    assert!(text(&output.stdout).ends_with("plotted  link's stiffness.svg\n"));
    assert_eq!(desk.read("link's stiffness.csv").lines().count(), 61);
    let plot = desk.read("link's stiffness.svg");
    assert!(plot.contains("peak torque over rigid") && plot.trim_end().ends_with("</svg>"));
    // Every curve of the plot has as many points as the table has rows.
    let points = |path: &str| path.matches(['M', 'L']).count();
    let curves = plot.split("<path").filter(|path| points(path) >= 60).count();
    assert_eq!(curves, 4, "torque ratio, the rigid link, lead and lag");
}

#[test]
#[ignore = "needs GNU parallel"]
fn gnu_parallel_shares_a_sweep_among_hosts() {
    let desk = Desk::new();
    let whole = desk.whole_sweep();
    let script = repository("examples/sweep_hosts.sh");
    desk.run(script, &[":", "3", "link.toml", "move.csv", VARY]);
    assert!(desk.read("sweep.csv") == whole);
    assert!(desk.path("sweep-3-of-3.csv").exists());
}

#[test]
#[ignore = "needs make"]
fn the_makefile_solves_only_what_changed() {
    let desk = Desk::new();
    desk.run("cp", &["link.toml", "other.toml"]);
    let makefile = repository("examples/Makefile");
    let makefile = makefile.to_str().unwrap();
    let make = || {
        let arguments = ["-f", makefile, "-j2", "LINKS=*.toml", "MOTIONS=move.csv"];
        text(&desk.run("make", &arguments).stdout)
    };
    assert_eq!(make().matches("flexlink solve").count(), 2);
    assert!(desk.path("results/other/move/summary.json").exists());
    assert_eq!(make().matches("flexlink solve").count(), 0);
    desk.run("touch", &["-d", "1 minute", "other.toml"]);
    let again = make();
    assert_eq!(again.matches("flexlink solve").count(), 1, "{again}");
    assert!(again.contains("flexlink solve other.toml move.csv"));
}

#[test]
#[ignore = "needs Python with pandas and matplotlib"]
fn pandas_reads_the_results_and_matplotlib_plots_them() {
    let desk = Desk::new();
    desk.whole_sweep();
    desk.run("flexlink", &["solve", "link.toml", "move.csv", "--quiet"]);
    let python = env::var("FLEXLINK_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = repository("examples/read_results.py");
    let arguments = [script.to_str().unwrap(), "out", "--sweep", "one.csv", "-o", "figure.png"];
    let output = desk.run(python, &arguments);
    let expected = "8234 rows, peak torque 1.358 N m, plotted in figure.png\n";
    assert_eq!(text(&output.stdout), expected);
    assert!(fs::read(desk.path("figure.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
#[ignore = "needs a Slurm cluster, which tests/slurm/run starts on one node"]
fn a_slurm_job_array_does_one_shard_a_task() {
    let desk = Desk::new();
    let whole = desk.whole_sweep();
    let script = repository("examples/sweep_array.sbatch");
    let script = script.to_str().unwrap();
    for tasks in ["1,3", "2"] {
        let array = format!("--array={tasks}");
        let submit = ["--wait", &array, script, "link.toml", "move.csv", VARY, "3"];
        desk.run("sbatch", &submit);
    }
    let shards = ["sweep-1-of-3.csv", "sweep-2-of-3.csv", "sweep-3-of-3.csv"];
    desk.run("flexlink", &[&["sweep", "-o", "sweep.csv", "--merge"], &shards[..]].concat());
    assert!(desk.read("sweep.csv") == whole);
}

/// The script of the step of this name in a workflow or an action of examples/.
fn script_of(file: &str, name: &str) -> String {
    let workflow = fs::read_to_string(repository(&format!("examples/{file}"))).unwrap();
    let (_, step) = workflow.split_once(&format!("- name: {name}\n")).unwrap();
    let (_, run) = step.split_once("run: ").unwrap();
    let end = run.find("\n      - ").unwrap_or(run.len());
    run[..end].trim_start_matches("|\n").to_owned()
}

#[test]
#[ignore = "needs curl and shasum"]
fn the_action_installs_an_archive_with_the_sum_that_is_given_and_no_other() {
    let desk = Desk::new();
    desk.run("mkdir", &["flexlink-0.1.0-here", "temp"]);
    fs::copy(env!("CARGO_BIN_EXE_flexlink"), desk.path("flexlink-0.1.0-here/flexlink")).unwrap();
    desk.run("tar", &["-czf", "archive.tar.gz", "flexlink-0.1.0-here"]);
    let sum = text(&desk.run("shasum", &["--algorithm", "256", "archive.tar.gz"]).stdout);
    let install = |sum: &str| {
        let script = script_of("action.yml", "Install");
        let mut command = desk.command("bash", &["-euo", "pipefail", "-c", &script]);
        command.env("ARCHIVE", format!("file://{}", desk.path("archive.tar.gz").display()));
        command.env("SHA256", sum).env("RUNNER_TEMP", desk.path("temp"));
        command.env("GITHUB_PATH", desk.path("path")).output().unwrap()
    };
    let short = text(&desk.run("shasum", &["--algorithm", "1", "archive.tar.gz"]).stdout);
    for wrong in [&"0".repeat(64), &short[..40], ""] {
        let refused = install(wrong);
        assert!(!refused.status.success() && !desk.path("path").exists(), "{wrong}");
    }
    assert!(!desk.path("temp/flexlink/flexlink").exists(), "it is not even unpacked");
    let installed = install(&sum[..64]);
    let version = concat!("flexlink ", env!("CARGO_PKG_VERSION"), "\n");
    assert!(installed.status.success(), "{}", text(&installed.stderr));
    assert!(text(&installed.stdout).ends_with(version), "{}", text(&installed.stdout));
    let folder = desk.read("path");
    let program = Path::new(folder.trim_end()).join("flexlink");
    desk.run(program, &["solve", "link.toml", "move.csv", "--quiet"]);
}

#[test]
fn the_workflow_for_golden_files_accepts_what_is_right_and_nothing_else() {
    let desk = Desk::new();
    desk.run("mkdir", &["links", "motions"]);
    desk.run("mv", &["link.toml", "links/my arm.toml"]);
    desk.run("mv", &["move.csv", "motions"]);
    let step = |name| {
        desk.command("bash", &["-euo", "pipefail", "-c", &script_of("golden_files.yml", name)])
            .output()
            .unwrap()
    };
    let solved = step("Solve");
    assert!(solved.status.success(), "{}", text(&solved.stderr));
    desk.run("flexlink", &["compare", "golden", "results", "--bless"]);
    assert_eq!(step("Compare").status.code(), Some(0));

    let torque = "results/my arm/move/torque.csv";
    let changed = desk.read(torque).replacen("0.", "0.1", 1);
    fs::write(desk.path(torque), changed).unwrap();
    let compared = step("Compare");
    assert_eq!(compared.status.code(), Some(1));
    assert!(text(&compared.stdout).contains("torque.csv"), "{}", text(&compared.stdout));
}

/// A program of examples/, which `cargo test` builds beside this test.
fn example(name: &str) -> PathBuf {
    let this = env::current_exe().unwrap();
    let path = this.parent().unwrap().with_file_name("examples").join(name);
    let path = path.with_extension(env::consts::EXE_EXTENSION);
    assert!(path.exists(), "{} is not built: cargo test --examples", path.display());
    path
}

/// Times and numbers of the first two columns of a table.
fn two_columns(table: &str) -> (Vec<f64>, Vec<f64>) {
    let row = |line: &str| {
        let mut fields = line.split(',').map(|field| field.parse::<f64>().unwrap());
        (fields.next().unwrap(), fields.next().unwrap())
    };
    table.lines().skip(1).map(row).unzip()
}

/// The torque of both programs: without friction it is all that changes the angular momentum, so the
/// link rests at the end, turned by the tip's 0.5 m over its length, with its rigid inertia of 1 kg m².
#[track_caller]
fn assert_turns_the_strip(time_s: &[f64], torque_n_m: &[f64]) {
    let step_s = time_s[1] - time_s[0];
    let (mut momentum, mut turned, mut largest) = (0.0, 0.0, 0.0_f64);
    for torque_n_m in torque_n_m {
        momentum += torque_n_m * step_s;
        turned += momentum * step_s;
        largest = largest.max(torque_n_m.abs());
    }
    assert!(momentum.abs() < 1e-5, "{momentum:e} N m s");
    assert!((turned - 0.5 / 1.5).abs() < 1e-4, "{turned} kg m² rad");
    let begins = torque_n_m.iter().position(|torque| torque.abs() > 0.02 * largest).unwrap();
    let ends = torque_n_m.iter().rposition(|torque| torque.abs() > 0.02 * largest).unwrap();
    assert!(time_s[begins] < -0.2, "it begins at {} s, before the tip does", time_s[begins]);
    assert!(time_s[ends] > 0.88 + 0.2, "it ends at {} s, after the tip has", time_s[ends]);
    // The tip's largest acceleration, 2π·0.5 m/(0.88 s)², turns a rigid strip.
    let rigid = std::f64::consts::TAU * 0.5 / 0.88_f64.powi(2) / 1.5;
    assert!(largest < 0.6 * rigid, "{largest} N m of {rigid} N m");
}

#[test]
fn the_torque_from_numbers_turns_the_link_and_leaves_it_at_rest() {
    let output = Desk::new().run(example("torque_from_numbers"), &[]);
    assert_eq!(text(&output.stderr), "", "it warns of nothing");
    let table = text(&output.stdout);
    assert!(table.starts_with("time_s,torque_N_m\n"));
    let (time_s, torque_n_m) = two_columns(&table);
    assert_turns_the_strip(&time_s, &torque_n_m);
}

#[test]
fn the_result_folder_from_numbers_holds_the_torque_and_is_made_into_a_page() {
    let desk = Desk::new();
    let output = desk.run(example("result_folder"), &["strip"]);
    let (time_s, torque_n_m) = two_columns(&desk.read("strip/torque.csv"));
    assert_turns_the_strip(&time_s, &torque_n_m);
    let rows = time_s.len();
    assert_eq!(text(&output.stdout), format!("{rows} rows of torque in strip\n"));
    let (_, hub_rad) = two_columns(&desk.read("strip/hub_angle.csv"));
    let (_, tip_m) = two_columns(&desk.read("strip/tip.csv"));
    assert!((tip_m[rows - 1] - 0.5).abs() < 1e-6, "{} m", tip_m[rows - 1]);
    // Hysteretic damping leaves a slow tail, 2e-5 rad at the window's edge.
    assert!((hub_rad[rows - 1] - 0.5 / 1.5).abs() < 1e-4, "{} rad", hub_rad[rows - 1]);
    desk.run("flexlink", &["report", "strip", "--quiet"]);
    assert!(desk.read("strip/report.html").contains("</html>"));
}
