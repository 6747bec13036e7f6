//! What a shell and its user want of an installed program: completions and manual pages.

use std::io;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;

use flexlink::store::OutputFolder;

use super::console;
use super::exit::{Exit, Failure};
use super::files::check_folder;

const COMPLETIONS: &str = "\
Example:
  d=~/.local/share/bash-completion/completions
  flexlink completions bash > $d/flexlink
  flexlink completions zsh > ~/.zfunc/_flexlink";

/// Print completions for a shell.
#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS)]
pub(crate) struct Completions {
    /// Shell to complete for.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

const MAN: &str = "\
Example:
  flexlink man | man -l -
  flexlink man -o ~/.local/share/man/man1";

/// Print the manual page, or write one for every command.
#[derive(Debug, Args)]
#[command(after_help = MAN)]
pub(crate) struct Manual {
    /// Folder for the pages of all commands, flexlink.1, flexlink-solve.1, …
    /// [default: the first is printed].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl Completions {
    pub(crate) fn run(&self, mut program: Command) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program, "flexlink", &mut script);
        console::print_bytes(&script)
    }
}

impl Manual {
    pub(crate) fn run(&self, mut program: Command) -> Result<(), Failure> {
        program.build();
        let cannot = |error: io::Error| Failure::new(Exit::CannotWrite, &error, None);
        let Some(folder) = &self.output else {
            return console::print_bytes(&page(program).map_err(cannot)?);
        };
        check_folder("--output", folder)?;
        let pages = OutputFolder::stage(folder, &console::waiting)?;
        for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
            let name = format!("flexlink-{}", command.get_name());
            let content = page(command.clone()).map_err(cannot)?;
            pages.file(format!("{name}.1"), |out| out.write_all(&content))?;
        }
        let content = page(program).map_err(cannot)?;
        pages.file("flexlink.1", |out| out.write_all(&content))?;
        Ok(pages.commit("flexlink.1", &[])?)
    }
}

fn page(command: Command) -> io::Result<Vec<u8>> {
    let mut text = Vec::new();
    Man::new(command).render(&mut text)?;
    Ok(text)
}
