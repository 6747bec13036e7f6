use std::path::PathBuf;

use clap::Args;

use crate::terminal::{Failure, console};
use flexlink::spec::link_file_schema;

const EXAMPLE: &str = "\
Example:
  flexlink schema -o link.schema.json

With the first line `#:schema ./link.schema.json` in link.toml, editors that use Taplo, such as \
VS Code with Even Better TOML, complete and check it.";

/// Print the JSON Schema of the link file, for editors.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
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
