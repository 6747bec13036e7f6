//! How far long work has come: on a terminal, and nothing in a pipe.

use std::fmt;
use std::io::{IsTerminal as _, stderr};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use flexlink::inverse::{Stage, Watch};

use super::console;

/// Work that is done before is not worth a bar.
const SHORT: Duration = Duration::from_millis(500);

/// How often a bar is drawn while nothing moves.
const TICK: Duration = Duration::from_millis(100);

/// What is shown before the first stage, between two, and after the last row is written.
const FIRST: &str = "finding the band";
const BETWEEN: &str = "measuring errors";
const WRITTEN: &str = "waiting for the disk";

const UNKNOWN: &str = "{spinner} {msg} {elapsed}";

const KNOWN: &str = "{spinner} {msg} [{bar:30}] {percent:>3} % {elapsed}";

/// The cases of a sweep, with rate and time left.
pub(crate) struct CaseBar(ProgressBar);

impl CaseBar {
    /// Shows `done` of `all`.
    pub(crate) fn new(done: usize, all: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(all as u64), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("[{bar:30}] {pos}/{len}, {rate}, {eta} left");
        // The template is a constant that the library reads.
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
        let rate = |state: &ProgressState, out: &mut dyn fmt::Write| {
            // A line that is not drawn is no loss.
            let _ = write!(out, "{:.1}/s", state.per_sec());
        };
        bar.set_style(style.with_key("rate", rate));
        // What an earlier run has done says nothing about the rate of this one: the estimate begins
        // after it has been told of it, and nothing is drawn before that.
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

    /// Shows one more.
    pub(crate) fn advance(&self) {
        self.0.inc(1);
    }
}

impl Drop for CaseBar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// The stages of one run.
pub(crate) struct StageBar {
    bar: ProgressBar,
    /// Whether nothing is told above it either.
    is_hidden: bool,
    /// Whether rows are being written, the last stage.
    is_writing: AtomicBool,
    /// Dropped when the run is over.
    over: Option<Sender<()>>,
    waiting: Option<JoinHandle<()>>,
}

impl StageBar {
    /// Shows what a run is at as soon as it is no short one; nothing where standard error is no
    /// terminal.
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        bar.set_style(stage_style(UNKNOWN));
        bar.set_message(FIRST);
        if !stderr().is_terminal() {
            return Self::of(bar);
        }
        let (over, runs) = mpsc::channel();
        let shown = bar.clone();
        let show = move || {
            if runs.recv_timeout(SHORT) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        };
        let waiting = thread::Builder::new().spawn(show).ok();
        let mut stages = Self::of(bar);
        (stages.over, stages.waiting) = (Some(over), waiting);
        stages
    }

    /// Shows nothing.
    pub(crate) fn hidden() -> Self {
        let mut stages = Self::of(ProgressBar::hidden());
        stages.is_hidden = true;
        stages
    }

    fn of(bar: ProgressBar) -> Self {
        Self {
            bar,
            is_hidden: false,
            is_writing: AtomicBool::new(false),
            over: None,
            waiting: None,
        }
    }

    /// Tells something above the bar, if that is no hidden one.
    pub(crate) fn say(&self, message: &str) {
        if !self.is_hidden {
            self.above(|| console::line_below(message));
        }
    }

    /// Prints something above the bar, hidden or not.
    pub(crate) fn above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Shows what goes on, and for how long the run has, where nobody knows how much of it is left.
    pub(crate) fn at(&self, what: &'static str) {
        self.bar.set_style(stage_style(UNKNOWN));
        self.bar.set_message(what);
    }
}

fn stage_style(template: &str) -> ProgressStyle {
    // The templates are constants that the library reads.
    let style = ProgressStyle::with_template(template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    style.progress_chars("=> ").tick_chars("-\\|/ ")
}

impl Watch for StageBar {
    fn begin(&self, stage: Stage, parts: usize) {
        let what = match stage {
            Stage::Solve { elements } => format!("solving, {elements} elements"),
            Stage::Transform => "transforming".to_owned(),
            Stage::Write => "writing".to_owned(),
        };
        self.is_writing.store(stage == Stage::Write, Ordering::Relaxed);
        // Before the style: each of these may draw.
        self.bar.set_position(0);
        self.bar.set_length(parts as u64);
        self.bar.set_message(what);
        self.bar.set_style(stage_style(KNOWN));
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
        drop(self.over.take());
        if let Some(waiting) = self.waiting.take() {
            // A thread that has failed has shown nothing.
            let _ = waiting.join();
        }
        self.bar.finish_and_clear();
    }
}
