//! `init`, `schema`, `completions` and `man`: files for the first use.

use std::fmt::Display;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::csv::{Digits, write_path, write_trajectory};
use crate::motion::{Curve, Profile};
use crate::spec::link_file_schema;
use crate::store::OutputFolder;
use crate::text::{plain, shown_path};

use crate::cli::terminal::files::check_folder;
use crate::cli::terminal::{Exit, Failure, console};

const INIT_EXAMPLE: &str = "\
Example:
  flexlink init arm
  flexlink solve arm/link.toml arm/motion.csv -o arm/out
  flexlink init --carriage mast
  flexlink solve mast/link.toml mast/motion.csv -o mast/out
  flexlink init --arm robot
  flexlink solve robot/arm.toml robot/path.csv -o robot/out";

/// Write files to start from: link.toml with its JSON Schema, and motion.csv.
#[derive(Debug, Args)]
#[command(after_help = INIT_EXAMPLE)]
pub(crate) struct Init {
    /// Folder for the three files, which must not exist yet.
    #[arg(value_name = "DIR", default_value = ".")]
    folder: PathBuf,

    /// Write an arm of two links, arm.toml, and path.csv of its tip instead.
    #[arg(long)]
    arm: bool,

    /// Write a link on a carriage instead: a mast, which a force moves.
    #[arg(long, conflicts_with = "arm")]
    carriage: bool,

    /// Print nothing but errors.
    #[arg(long, short)]
    quiet: bool,
}

impl Init {
    pub(crate) fn run(self) -> Result<(), Failure> {
        check_folder("DIR", &self.folder)?;
        let [described, moved] =
            if self.arm { ["arm.toml", "path.csv"] } else { ["link.toml", "motion.csv"] };
        let names = [described, moved, "link.schema.json"];
        let paths = names.map(|name| self.folder.join(name));
        if let Some(path) = paths.iter().find(|path| path.exists()) {
            let message = format!("{} = a file, but must not be there yet", path.display());
            let hint = "name another folder: flexlink init DIR";
            return Err(Failure::new(Exit::CannotWrite, &message, Some(hint)));
        }
        let (text, samples) = match (self.arm, self.carriage) {
            (true, _) => (ARM, path()?),
            (_, true) => (CARRIAGE, motion(2.0, 2000)?),
            _ => (LINK, motion(0.5, 1000)?),
        };
        let folder = OutputFolder::stage(&self.folder, &console::waiting)?;
        folder.file(names[0], |out| out.write_all(text.as_bytes()))?;
        folder.file(names[1], |out| out.write_all(&samples))?;
        folder.file(names[2], |out| out.write_all(link_file_schema().as_bytes()))?;
        folder.commit(names[0], &[])?;
        if self.quiet {
            return Ok(());
        }
        let [described, moved, schema] = paths.map(|path| shown_path(&path));
        console::print(&format!("written  {described}, {moved} and {schema}\n"))
    }
}

/// A commented link file.
const LINK: &str = include_str!("templates/link.toml");

/// A commented file of a link on a carriage.
const CARRIAGE: &str = include_str!("templates/carriage.toml");

/// A commented arm file.
const ARM: &str = include_str!("templates/arm.toml");

/// A tip motion over a distance, of this many steps of 1 ms: smooth enough for a torque that needs few frequencies.
fn motion(distance_m: f64, steps: usize) -> Result<Vec<u8>, Failure> {
    let (distance, duration) = (plain(distance_m), plain(1e-3 * steps as f64));
    let title = format!("# Tip travels {distance} m in {duration} s, seventh degree (s, m/s^2)\n");
    let mut text = title.into_bytes();
    let columns = Profile::Septic.sampled(distance_m, 1e-3, steps, [0, 0]);
    write_trajectory(&mut text, &columns, Digits::default())
        .map_err(|error| Failure::new(Exit::CannotWrite, &error, None))?;
    Ok(text)
}

/// A path of an arm's tip, equally smooth.
fn path() -> Result<Vec<u8>, Failure> {
    let not_written = |error: &dyn Display| Failure::new(Exit::CannotWrite, &error, None);
    let mut text =
        b"# Tip goes straight from (0.9, -0.5) to (0.5, 0.8) in 1.5 s, seventh degree (s, m)\n"
            .to_vec();
    let curve = Curve::through(&[[0.9, -0.5], [0.5, 0.8]]).map_err(|error| not_written(&error))?;
    let columns = curve.columns(&Profile::Septic.into(), (2e-3, 750), [0, 0], &[]);
    let columns = columns.map_err(|error| not_written(&error))?;
    write_path(&mut text, &columns, Digits::Full).map_err(|error| not_written(&error))?;
    Ok(text)
}

const SCHEMA_EXAMPLE: &str = "\
Example:
  flexlink schema -o link.schema.json

With the first line `#:schema ./link.schema.json` in link.toml or arm.toml, editors that use Taplo, such as \
VS Code with Even Better TOML, complete and check it.";

/// Print the JSON Schema of link files and arm files, for editors.
#[derive(Debug, Args)]
#[command(after_help = SCHEMA_EXAMPLE)]
pub(crate) struct Schema {
    /// File to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Schema {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        console::deliver(self.output.as_deref(), link_file_schema().as_bytes())
    }
}

const COMPLETIONS_EXAMPLE: &str = "\
Example:
  d=~/.local/share/bash-completion/completions
  flexlink completions bash > $d/flexlink
  flexlink completions zsh > ~/.zfunc/_flexlink";

/// Print completions for a shell.
#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS_EXAMPLE)]
pub(crate) struct Completions {
    /// Shell to complete for.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(&self, mut program: Command) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program, "flexlink", &mut script);
        console::print_bytes(&script)
    }
}

const MAN_EXAMPLE: &str = "\
Example:
  flexlink man | man -l -
  flexlink man -o ~/.local/share/man/man1";

/// Print the manual page, or write one for every command.
#[derive(Debug, Args)]
#[command(after_help = MAN_EXAMPLE)]
pub(crate) struct Manual {
    /// Folder for the pages of all commands, flexlink.1, flexlink-solve.1, …
    /// [default: flexlink.1 is printed].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl Manual {
    pub(crate) fn run(&self, mut program: Command) -> Result<(), Failure> {
        program.build();
        let Some(folder) = &self.output else {
            return console::print_bytes(&page(program)?);
        };
        check_folder("--output", folder)?;
        let pages = OutputFolder::stage(folder, &console::waiting)?;
        for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
            let (name, page) = (command.get_name(), page(command.clone())?);
            pages.file(format!("flexlink-{name}.1"), |out| out.write_all(&page))?;
        }
        let page = page(program)?;
        pages.file("flexlink.1", |out| out.write_all(&page))?;
        Ok(pages.commit("flexlink.1", &[])?)
    }
}

fn page(command: Command) -> Result<Vec<u8>, Failure> {
    let mut text = Vec::new();
    let written = Man::new(command).render(&mut text);
    written.map_err(|error| Failure::new(Exit::CannotWrite, &error, None))?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv::read_motion_table;
    use crate::spec::read_specification;

    #[test]
    fn what_it_writes_is_read() {
        let read = read_specification("link.toml", LINK, &[]).expect("a link file");
        assert!(read.mesh().is_automatic());
        let table = read_motion_table(
            "motion.csv",
            &motion(0.5, 1000).expect("a motion"),
            read.link().length_m(),
        );
        let motion = table.and_then(crate::csv::MotionTable::into_motion);
        let motion = motion.expect("a motion").into_tip().expect("of a tip");
        assert!((motion.travel_m() - 0.5).abs() < 1e-5);
    }

    #[test]
    fn what_is_commented_out_is_read_too() {
        let uncommented = |text: &str| {
            text.lines()
                .map(|line| match line.strip_prefix("# ") {
                    Some(rest) if rest.starts_with('[') || rest.contains(" = ") => rest,
                    _ => line,
                })
                .fold(String::new(), |text, line| text + line + "\n")
        };
        let read = read_specification("link.toml", &uncommented(LINK), &[]).expect("a link file");
        assert_eq!(read.link().masses().len(), 1);
        assert!(read.link().drive().is_some() && read.limits[0].of("torque").is_some());
        let mast = read_specification("link.toml", &uncommented(CARRIAGE), &[]).expect("a mast");
        assert!(mast.link().joint().slides() && mast.limits[0].of("hub_rate").is_some());
        let arm = read_specification("arm.toml", &uncommented(ARM), &[]).expect("an arm");
        assert_eq!(arm.arm.links().len(), 2);
        assert!(arm.limits.iter().all(|limits| limits.of("torque").is_some()));
    }
}
