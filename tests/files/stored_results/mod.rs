//! What `read_result` gives of a folder is what `solve`, `simulate` or `sweep` has written there.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod arms;
#[path = "../../cli/bench.rs"]
mod bench;
mod read_back;
mod refusals;
mod summaries;
mod sweeps;
#[path = "../../cli/words.rs"]
mod words;

use std::path::{Path, PathBuf};
use std::process::Command;

use flexlink::result::{StoredRun, StoredSweep};
use flexlink::store::{StoredResult, read_result};

use bench::Bench;
use words::Words;

/// The paper's first link and its motion.
const PAPER: &str = "specs/bayo1987_example1.toml trajectories/sine_0.88s.csv";

/// A short window: what is asked here is not how exact an answer is.
const SHORT: &str = "--resample 0.002 --set analysis.tolerance=1e-3";

impl Bench {
    /// Runs the program in the repository's folder, with the results into `folder`.
    #[track_caller]
    fn run(&self, arguments: &(impl Words + ?Sized), folder: &str) {
        let into = self.path(folder);
        let mut command = Command::new(env!("CARGO_BIN_EXE_flexlink"));
        command.args(arguments.words()).arg("-o").arg(into).arg("--quiet");
        let output = command.current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }

    /// `solve` into `out`, with a short window.
    #[track_caller]
    fn solve(&self, arguments: &(impl Words + ?Sized)) {
        self.run(&["solve".words(), arguments.words(), SHORT.words()].concat(), "out");
    }

    /// A file of the bench as the program is told it.
    fn file(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    #[track_caller]
    fn run_of(&self, folder: &str) -> StoredRun {
        match read_result(&self.path(folder)) {
            Ok(StoredResult::Runs(mut runs)) => runs.remove(0),
            other => panic!("{other:?}"),
        }
    }

    #[track_caller]
    fn sweep_of(&self, name: &str) -> StoredSweep {
        match read_result(&self.path(name)) {
            Ok(StoredResult::Sweep(sweep)) => *sweep,
            other => panic!("{other:?}"),
        }
    }

    /// The refusal of a path, without the folder of the bench, and its hint.
    #[track_caller]
    fn refusal(&self, name: &str) -> (String, Option<String>) {
        let error = read_result(&self.path(name)).unwrap_err();
        let own = format!("{}/", self.folder.path().display());
        (error.to_string().replace(&own, ""), error.hint().map(str::to_owned))
    }

    #[track_caller]
    fn column(&self, name: &str, heading: &str) -> Vec<f64> {
        let columns = self.table(name);
        columns.into_iter().find(|(own, _)| own == heading).unwrap().1
    }
}

/// A file of the repository.
fn repository(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}
