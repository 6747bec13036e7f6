//! The only module that prints.
//!
//! On a terminal, text for people is coloured. Files are printed byte for byte.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::builder::styling::{AnsiColor, Style};
use clap::error::ContextValue;

use crate::csv::system_words;
use crate::result::Notice;
use crate::store::{Durability, NamedBy, NewFile, write_file, write_files};
use crate::text::{excerpt, is_hidden};

use super::exit::{Exit, Failure};

const ERROR: Style = AnsiColor::Red.on_default().bold();
const WARNING: Style = AnsiColor::Yellow.on_default().bold();
const HINT: Style = AnsiColor::Green.on_default();

/// Prints an error and its hint to standard error.
pub(crate) fn error(message: &str, hint: Option<&str>) {
    labelled("error", ERROR, message, hint);
}

/// Prints a warning and its hint to standard error.
pub(crate) fn warning(message: impl Display, hint: &str) {
    labelled("warning", WARNING, &message.to_string(), Some(hint));
}

/// Prints warnings and their hints to standard error.
pub(crate) fn warnings(warnings: impl IntoIterator<Item: Into<Notice>>) {
    for Notice { message, hint, .. } in warnings.into_iter().map(Into::into) {
        warning(message, &hint);
    }
}

/// Prints remarks and their hints to standard error.
pub(crate) fn remarks(remarks: impl IntoIterator<Item: Into<Notice>>) {
    for Notice { message, hint, .. } in remarks.into_iter().map(Into::into) {
        remark(&message, &hint);
    }
}

/// False if `--quiet` hides remarks.
static REMARKS_ARE_SHOWN: AtomicBool = AtomicBool::new(true);

/// Shows or hides remarks from now on.
pub(crate) fn show_remarks(shown: bool) {
    REMARKS_ARE_SHOWN.store(shown, Ordering::Relaxed);
}

/// Prints one remark and its hint to standard error.
pub(crate) fn remark(message: &str, hint: &str) {
    if REMARKS_ARE_SHOWN.load(Ordering::Relaxed) {
        labelled("remark", WARNING, message, Some(hint));
    }
}

/// Prints a line without a label to standard error, below the current line of the terminal.
pub(crate) fn line_below(message: &str) {
    let _ = anstream::stderr().lock().write_all(format!("\n{message}\n").as_bytes());
}

/// Prints a sentence without a label to standard error.
pub(crate) fn plain(message: &str) {
    let message: String = message.chars().map(visible).collect();
    let _ = anstream::stderr().lock().write_all(format!("{message}\n").as_bytes());
}

/// Prints a note to standard error.
pub(crate) fn note(message: &str) {
    labelled("note", HINT, message, None);
}

/// Prints to standard error that the run waits for another run's lock on the folder.
pub(crate) fn waiting(folder: &Path) {
    let folder = folder.display();
    note(&format!("{folder}: another run is writing into the folder; waiting until it is done"));
}

/// Prints a hint to standard error.
pub(crate) fn hint(message: &str) {
    labelled("hint", HINT, message, None);
}

fn labelled(label: &str, style: Style, message: &str, hint: Option<&str>) {
    let line = |label: &str, style: Style, message: &str| {
        let message: String = message.chars().map(visible).collect();
        format!("{style}{label}:{style:#} {message}\n")
    };
    let hint = hint.map_or(String::new(), |hint| line("hint", HINT, hint));
    let text = line(label, style, message) + &hint;
    // If standard error is closed, no other place to print to remains.
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

/// A character, or the replacement character for one that controls a terminal. The name of a file may contain such
/// characters.
fn visible(letter: char) -> char {
    if is_hidden(letter) { char::REPLACEMENT_CHARACTER } else { letter }
}

/// Prints the text of the command line's parser, help or an error of usage; returns the exit code.
pub(crate) fn parser_text(error: &clap::Error) -> Result<u8, Failure> {
    // The colours of the text are control characters, too.
    let shown = |c: char| if c.is_control() { c } else { visible(c) };
    let text: String =
        shortened(error, error.render().ansi().to_string()).chars().map(shown).collect();
    if error.use_stderr() {
        let _ = anstream::stderr().lock().write_all(text.as_bytes());
    } else {
        let mut out = anstream::stdout().lock();
        delivered(out.write_all(text.as_bytes()).and_then(|()| out.flush()))?;
    }
    Ok(u8::try_from(error.exit_code()).unwrap_or(Exit::Usage as u8))
}

/// Text of a parser's error, with arguments shortened as in other messages.
pub(crate) fn shortened(error: &clap::Error, text: String) -> String {
    let pieces = error.context().flat_map(|(_, piece)| match piece {
        ContextValue::String(piece) => std::slice::from_ref(piece),
        ContextValue::Strings(pieces) => &pieces[..],
        _ => &[],
    });
    pieces.fold(text, |text, piece| match excerpt(piece) {
        Cow::Borrowed(_) => text,
        Cow::Owned(short) => text.replace(piece.as_str(), &short),
    })
}

/// Writes text for people to standard output; a closed reader is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let text: String = text.chars().map(|c| if c == '\n' { c } else { visible(c) }).collect();
    print_bytes(text.as_bytes())
}

/// True if a path means standard output, which must not be opened a second time: that would write from its start.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]
        .iter()
        .any(|name| path.as_os_str() == *name)
}

/// State of the reader of standard output.
pub(crate) enum Reader {
    There,
    Gone,
}

/// Writes a file unchanged to standard output; a closed reader is no error.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    print_part(bytes).map(drop)
}

/// Writes a part of a file to standard output, and returns the state of its reader.
pub(crate) fn print_part(bytes: &[u8]) -> Result<Reader, Failure> {
    let mut out = io::stdout().lock();
    delivered(out.write_all(bytes).and_then(|()| out.flush()))
}

/// Writes bytes to the file `output`, or to standard output if it is `None` or `-`.
pub fn deliver(output: Option<&Path>, bytes: &[u8]) -> Result<(), Failure> {
    deliver_by(output, |out| out.write_all(bytes))
}

/// Writes bytes to a file named by the program.
pub(crate) fn deliver_beside(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let write = |out: &mut (dyn Write + Send)| out.write_all(bytes);
    Ok(write_file(path, NamedBy::Program, Durability::default(), write, &waiting)?)
}

/// Writes several files, all or none; standard output is not among them.
pub fn deliver_all(files: &[NewFile]) -> Result<(), Failure> {
    Ok(write_files(files, &waiting)?)
}

/// Like [`deliver`], for bytes that `write` makes while they are written.
pub fn deliver_by(
    output: Option<&Path>,
    write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<(), Failure> {
    if let Some(path) = output.filter(|path| !is_standard_output(path)) {
        return Ok(write_file(path, NamedBy::User, Durability::default(), write, &waiting)?);
    }
    let mut out = io::stdout();
    delivered(write(&mut out).and_then(|()| out.flush())).map(drop)
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
