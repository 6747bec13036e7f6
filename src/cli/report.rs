//! `report`: the page of a result.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::page::{Figure, Figures, page};
use crate::store::{OutputFolder, REPORT, read_results};
use crate::text::shown_path;

use crate::cli::terminal::console::is_standard_output;
use crate::cli::terminal::files::{keep_files, keep_page};
use crate::cli::terminal::{Exit, Failure, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink report out
  flexlink report sweep.csv -o sweep.html
  flexlink report out --png figures
  flexlink report solved open closed -o loops.html

RESULT is a folder of `solve`, `simulate` or `robust`, or the table of `sweep`. BESIDE are folders of other runs, of \
links, carriages or arms with any link file and motion, or after a study of `robust` other studies. The figures of the \
first show the lines of all, a table their numbers. The page names what it cannot show together.";

/// Write a result as a page with figures.
///
/// The page is one HTML file that needs nothing else, neither network nor server: figures, waves, an
/// animation, all warnings and numbers. With --svg or --png the figures are written instead; add -o to
/// write the page, too.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Report {
    /// Folder of solve, simulate or robust, or table of a sweep.
    #[arg(value_name = "RESULT")]
    result: PathBuf,

    /// Folders of other runs, or of other studies, to show beside the first.
    #[arg(value_name = "BESIDE")]
    beside: Vec<PathBuf>,

    /// Page to write [default: report.html in the folder of a run, NAME.html beside the table
    /// NAME.csv of a sweep].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write the figures into this folder, as SVG.
    #[arg(long, value_name = "DIR")]
    svg: Option<PathBuf>,

    /// Write the figures into this folder, as PNG; their font has Latin, Greek and Cyrillic
    /// letters.
    #[arg(long, value_name = "DIR")]
    png: Option<PathBuf>,

    /// Print nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

impl Report {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let file = self.page_file()?;
        let all = || std::iter::once(&self.result).chain(&self.beside);
        memory::check_tables(all().map(|result| bytes_of(result)).sum(), PAGE_TIMES)?;
        // No other run may replace the files beside a page while it is made.
        let is_within = file.as_ref().is_some_and(|file| match &self.output {
            Some(typed) => lies_in(typed, &self.result),
            None => file.parent() == Some(&self.result) && self.result.is_dir(),
        });
        let run = is_within.then(|| OutputFolder::stage(&self.result, &console::waiting));
        let run = run.transpose()?;
        let result = read_results(&self.result, &self.beside)?;
        let figures = Figures::of(&result);
        let page =
            file.map(|file| self.write_page(&page(&result, &figures), &file, run)).transpose()?;
        let mut written = String::new();
        if let Some(folder) = &self.svg {
            let svg = |figure: &Figure| Ok(figures.svg_file(figure).into_bytes());
            written += &write_figures(folder, &figures, "svg", svg)?;
        }
        if let Some(folder) = &self.png {
            written += &write_figures(folder, &figures, "png", |own| figures.png_file(own))?;
        }
        written += &page.unwrap_or_default();
        if self.quiet { Ok(()) } else { console::print(&written) }
    }

    /// The file of the page; `None` for figures alone.
    fn page_file(&self) -> Result<Option<PathBuf>, Failure> {
        if let Some(output) = &self.output {
            for result in std::iter::once(&self.result).chain(&self.beside) {
                keep_files(output, &[result])?;
                keep_page(output, result)?;
            }
        }
        let is_alone = self.svg.is_none() && self.png.is_none();
        Ok(self.output.clone().or_else(|| is_alone.then(|| beside(&self.result))))
    }

    /// Writes the page to a file, in the folder of the `run` if it is there, and returns a line with its name; `None`
    /// for standard output.
    fn write_page(
        &self,
        page: &str,
        file: &Path,
        run: Option<OutputFolder>,
    ) -> Result<String, Failure> {
        match run {
            Some(run) => {
                let name = file.file_name().unwrap_or(OsStr::new(REPORT));
                run.file(name, |out| out.write_all(page.as_bytes()))?;
                run.replace()?;
            }
            None if self.output.is_none() => console::deliver_beside(file, page.as_bytes())?,
            None => console::deliver(Some(file), page.as_bytes())?,
        }
        let line = || format!("written  {}\n", shown_path(file));
        Ok(if is_standard_output(file) { String::new() } else { line() })
    }
}

/// Memory for reading a result and making its page, over the size of its files, as measured.
const PAGE_TIMES: usize = 8;

/// Bytes of a result: of the file, or of the files in its folder.
fn bytes_of(result: &Path) -> usize {
    let size = |path: &Path| path.metadata().map_or(0, |found| found.len());
    let bytes = match result.read_dir() {
        Err(_) => size(result),
        Ok(entries) => {
            let paths = entries.flatten().map(|entry| entry.path());
            paths.filter(|path| path.is_file()).map(|path| size(&path)).sum()
        }
    };
    usize::try_from(bytes).unwrap_or(usize::MAX)
}

/// True if a path names a file, present or not, in this folder; a link may lead out of it.
fn lies_in(file: &Path, folder: &Path) -> bool {
    let is_plain = file.is_file() || !file.exists();
    let outer = file.parent().map(|outer| Path::new(".").join(outer).canonicalize());
    let (Some(Ok(outer)), Ok(folder)) = (outer, folder.canonicalize()) else { return false };
    is_plain && !file.is_symlink() && folder.is_dir() && outer == folder
}

/// The default file of a result's page.
fn beside(result: &Path) -> PathBuf {
    match result.extension() {
        Some(extension) if extension == "csv" && !result.is_dir() => result.with_extension("html"),
        _ => result.join(REPORT),
    }
}

/// Writes the figures into a folder, and returns a line with its name.
fn write_figures(
    folder: &Path,
    figures: &Figures,
    format: &str,
    file: impl Fn(&Figure) -> Result<Vec<u8>, String>,
) -> Result<String, Failure> {
    let output = OutputFolder::stage(folder, &console::waiting)?;
    for figure in &figures.drawn {
        let name = format!("{}.{format}", figure.id);
        let refused = |why| {
            let message = format!("{}: not drawn: {why}", folder.join(&name).display());
            Failure::new(Exit::CannotWrite, &message, None)
        };
        let bytes = file(figure).map_err(refused)?;
        output.file(&name, |out| out.write_all(&bytes))?;
    }
    output.replace()?;
    Ok(format!("written  {} figures in {}\n", figures.drawn.len(), shown_path(folder)))
}
