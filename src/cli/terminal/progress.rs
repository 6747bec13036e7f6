//! Progress of long work, only on a terminal, and output at its end.

use std::fmt;
use std::io::{IsTerminal as _, stderr};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::inverse::{Stage, Watch};
use crate::response::PlayProgress;

use super::console;
use super::exit::Failure;

/// The form of the summary on standard output.
#[derive(Debug, Args)]
pub(crate) struct PrintArgs {
    #[arg(long, conflicts_with = "quiet", help = "Print summary.json instead of the summary")]
    pub(crate) json: bool,

    /// Print nothing but warnings and errors.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl PrintArgs {
    /// A bar that shows the progress of the work.
    pub(crate) fn stages(&self) -> StageBar {
        if self.quiet { StageBar::hidden() } else { StageBar::new() }
    }

    /// Prints the result as JSON or as text, or nothing.
    pub(crate) fn print(
        &self,
        json: impl FnOnce() -> String,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        match (self.quiet, self.json) {
            (true, _) => Ok(()),
            (_, true) => console::print_bytes(json().as_bytes()),
            _ => console::print(&text()),
        }
    }
}

/// The cases of a sweep, with rate and time left.
pub(crate) struct CaseBar(ProgressBar);

impl CaseBar {
    /// Shows `done` cases of `all`.
    pub(crate) fn new(done: usize, all: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(all as u64), ProgressDrawTarget::hidden());
        let rate = |state: &ProgressState, out: &mut dyn fmt::Write| {
            // The loss of an undrawn line does not matter.
            let _ = write!(out, "{:.1}/s", state.per_sec());
        };
        bar.set_style(style("[{bar:30}] {pos}/{len}, {rate}, {eta} left").with_key("rate", rate));
        // The rate of an earlier run does not apply to this one: the estimate begins after the finished cases, and
        // drawing begins after it.
        bar.set_position(done as u64);
        bar.tick();
        bar.reset_eta();
        bar.set_draw_target(ProgressDrawTarget::stderr());
        Self(bar)
    }

    /// Shows nothing.
    pub(crate) fn hidden() -> Self {
        Self(ProgressBar::hidden())
    }

    /// Shows one more case.
    pub(crate) fn advance(&self) {
        self.0.inc(1);
    }
}

impl Drop for CaseBar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Duration of a run below which no bar appears.
const SHORT: Duration = Duration::from_millis(500);

/// Time between two drawings of a resting bar.
const TICK: Duration = Duration::from_millis(100);

/// Number of moves of a bar over one play of an arm.
const PLAY_TICKS: usize = 100;

/// Stages of unknown length: the first, those between two others, and the one after the last row.
const FIRST: &str = "finding the band";
const BETWEEN: &str = "measuring errors";
const WRITTEN: &str = "waiting for the disk";

const UNKNOWN: &str = "{spinner} {msg} {elapsed}";
const KNOWN: &str = "{spinner} {msg} [{bar:30}] {percent:>3} % {elapsed}";

fn style(template: &str) -> ProgressStyle {
    // The templates are constants that the library can read.
    let style = ProgressStyle::with_template(template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    style.progress_chars("=> ").tick_chars("-\\|/ ")
}

/// The stages of one run.
pub struct StageBar {
    bar: ProgressBar,
    /// True if lines above the bar are suppressed, too.
    is_hidden: bool,
    /// True during the last stage, the writing of rows.
    is_writing: AtomicBool,
    /// The thread that shows the bar after a while; dropping the sender ends it.
    delay: Option<(Sender<()>, JoinHandle<()>)>,
}

impl StageBar {
    /// Shows the stage of a run that is not short; nothing if standard error is no terminal.
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_style(style(UNKNOWN));
        bar.set_message(FIRST);
        let (over, runs) = mpsc::channel();
        let shown = bar.clone();
        let show = move || {
            if runs.recv_timeout(SHORT) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        };
        let begin = || thread::Builder::new().spawn(show).ok();
        let waiting = stderr().is_terminal().then(begin).flatten();
        let delay = waiting.map(|waiting| (over, waiting));
        Self { bar, is_hidden: false, is_writing: AtomicBool::new(false), delay }
    }

    /// Shows nothing.
    pub fn hidden() -> Self {
        let (bar, is_writing) = (ProgressBar::hidden(), AtomicBool::new(false));
        Self { bar, is_hidden: true, is_writing, delay: None }
    }

    /// Prints a line above the bar, unless the bar is hidden.
    pub(crate) fn say(&self, message: &str) {
        if !self.is_hidden {
            self.above(|| console::line_below(message));
        }
    }

    /// Prints above the bar, even if it is hidden.
    pub(crate) fn above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Shows the number of links that a fit has tried.
    pub(crate) fn tried(&self, links: usize) {
        self.bar.set_message(format!("fitting, {links} links tried"));
    }

    /// Shows the progress of the play of bent links.
    pub(crate) fn played(&self, PlayProgress { refinement, done, samples }: PlayProgress) {
        if done % samples.div_ceil(PLAY_TICKS) != 0 {
            return;
        }
        self.bar.set_length(samples as u64);
        self.bar.set_position(done as u64);
        self.bar.set_message(match refinement {
            0 => "playing".to_owned(),
            finer => format!("playing, refinement {finer}"),
        });
        self.bar.set_style(style(KNOWN));
    }

    /// Shows a stage of unknown length.
    pub(crate) fn at(&self, stage: &'static str) {
        self.bar.set_style(style(UNKNOWN));
        self.bar.set_message(stage);
    }
}

impl Watch for StageBar {
    fn begin(&self, stage: Stage, parts: usize) {
        let message = match stage {
            Stage::Solve { elements } => format!("solving, {elements} elements"),
            Stage::Transform => "transforming".to_owned(),
            Stage::Write => "writing".to_owned(),
        };
        self.is_writing.store(stage == Stage::Write, Ordering::Relaxed);
        // Before the style, because each of these may draw.
        self.bar.set_position(0);
        self.bar.set_length(parts as u64);
        self.bar.set_message(message);
        self.bar.set_style(style(KNOWN));
    }

    fn advance(&self, parts: usize) {
        self.bar.inc(parts as u64);
        if Some(self.bar.position()) >= self.bar.length() {
            let is_written = self.is_writing.load(Ordering::Relaxed);
            self.at(if is_written { WRITTEN } else { BETWEEN });
        }
    }
}

impl Drop for StageBar {
    fn drop(&mut self) {
        if let Some((over, waiting)) = self.delay.take() {
            drop(over);
            // A failed thread has shown nothing.
            let _ = waiting.join();
        }
        self.bar.finish_and_clear();
    }
}
