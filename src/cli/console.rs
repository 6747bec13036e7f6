//! The only place that prints.
//!
//! Text for people is in the locale's letters and, on a terminal, in colours; files that are printed
//! are neither touched nor coloured.

use std::fmt::{self, Display};
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::builder::styling::{AnsiColor, Style};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use flexlink::tables::{system_words, write_file};

use super::charset::shown;
use super::exit::{Exit, Failure};
use super::files::is_standard_output;

const ERROR: Style = AnsiColor::Red.on_default().bold();
const WARNING: Style = AnsiColor::Yellow.on_default().bold();
const HINT: Style = AnsiColor::Green.on_default();

/// Prints an error and its hint to standard error.
pub(crate) fn error(message: &str, hint: Option<&str>) {
    told("error", ERROR, message, hint);
}

/// Prints a warning and its hint to standard error.
pub(crate) fn warning(message: impl Display, hint: &str) {
    told("warning", WARNING, &message.to_string(), Some(hint));
}

/// Prints what goes on to standard error, below what stands on a terminal's line.
pub(crate) fn note(message: &str) {
    let _ = anstream::stderr().lock().write_all(format!("\n{message}\n").as_bytes());
}

fn told(kind: &str, style: Style, message: &str, hint: Option<&str>) {
    let line = |kind: &str, style: Style, message: &str| {
        let message: String = message.chars().map(visible).collect();
        format!("{style}{kind}:{style:#} {message}\n")
    };
    let hint = hint.map_or(String::new(), |hint| line("hint", HINT, hint));
    let text = line(kind, style, message) + &hint;
    // There is nowhere left to tell that standard error is closed.
    let _ = anstream::stderr().lock().write_all(shown(&text).as_bytes());
}

/// A letter, or the mark of a control character, which a file's name may hold.
fn visible(letter: char) -> char {
    if letter.is_control() { char::REPLACEMENT_CHARACTER } else { letter }
}

/// Prints what the command line's parser has to say, help or a wrong usage.
pub(crate) fn told_by_parser(words: &clap::Error) -> Result<ExitCode, Failure> {
    let text = words.render().ansi().to_string();
    let text = shown(&text);
    if words.use_stderr() {
        let _ = anstream::stderr().lock().write_all(text.as_bytes());
    } else {
        let mut out = anstream::stdout().lock();
        delivered(out.write_all(text.as_bytes()).and_then(|()| out.flush()))?;
    }
    Ok(ExitCode::from(u8::try_from(words.exit_code()).unwrap_or(Exit::Usage as u8)))
}

/// Writes text for people to standard output; a reader that has gone away is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let text: String = text.chars().map(|c| if c == '\n' { c } else { visible(c) }).collect();
    print_bytes(shown(&text).as_bytes())
}

/// Whether there is still someone who reads standard output.
pub(crate) enum Reader {
    There,
    Gone,
}

/// Writes a file to standard output as it is; a reader that has gone away is no error.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    print_part(bytes).map(drop)
}

/// Writes a part of a file to standard output, and tells whether to go on.
pub(crate) fn print_part(bytes: &[u8]) -> Result<Reader, Failure> {
    let mut out = io::stdout().lock();
    delivered(out.write_all(bytes).and_then(|()| out.flush()))
}

/// Writes what a command makes to the file `output`, or to standard output where there is none or it
/// is `-`.
pub(crate) fn deliver(output: Option<&Path>, bytes: &[u8]) -> Result<(), Failure> {
    match output.filter(|path| !is_standard_output(path)) {
        None => print_bytes(bytes),
        Some(path) => Ok(write_file(path, bytes)?),
    }
}

fn delivered(written: io::Result<()>) -> Result<Reader, Failure> {
    match written {
        Ok(()) => Ok(Reader::There),
        Err(cause) if cause.kind() == io::ErrorKind::BrokenPipe => Ok(Reader::Gone),
        Err(cause) => {
            let message = format!("standard output: cannot write: {}", system_words(&cause));
            Err(Failure::new(Exit::CannotWrite, &message, None))
        }
    }
}

/// Progress on a terminal, with rate and time left; nothing in a pipe.
pub(crate) struct Progress(ProgressBar);

impl Progress {
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

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
