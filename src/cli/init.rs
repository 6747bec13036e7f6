//! What a user starts with: `init` writes first files, `schema` the JSON Schema of the link file.

use std::io;
use std::path::PathBuf;

use clap::Args;

use flexlink::csv::{Digits, write_trajectory};
use flexlink::motion::Profile;
use flexlink::spec::link_file_schema;
use flexlink::store::OutputFolder;

use crate::terminal::files::check_folder;
use crate::terminal::{Exit, Failure, console};

/// A commented link file.
const LINK: &str = include_str!("templates/link.toml");

/// What heads motion.csv.
const MOTION_HEAD: &str = "# Tip travels 0.5 m in 1 s, seventh degree (s, m/s^2)\n";

/// The tip motion: smooth enough for a torque that needs few frequencies.
fn motion() -> io::Result<Vec<u8>> {
    let mut text = MOTION_HEAD.as_bytes().to_vec();
    let columns = Profile::Septic.sampled(0.5, 1e-3, 1000, [0, 0]);
    write_trajectory(&mut text, &columns, Digits::default())?;
    Ok(text)
}

const EXAMPLE: &str = "\
Example:
  flexlink init arm
  flexlink solve arm/link.toml arm/motion.csv -o arm/out";

/// Write files to start from: link.toml with its JSON Schema, and motion.csv.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Init {
    /// Folder for the three files; none of them may be there.
    #[arg(value_name = "DIR", default_value = ".")]
    folder: PathBuf,
}

impl Init {
    pub(crate) fn run(self) -> Result<(), Failure> {
        check_folder("DIR", &self.folder)?;
        let paths =
            ["link.toml", "motion.csv", "link.schema.json"].map(|name| self.folder.join(name));
        if let Some(path) = paths.iter().find(|path| path.exists()) {
            let message = format!("{} = a file, but must not be there yet", path.display());
            let hint = "name another folder: flexlink init DIR";
            return Err(Failure::new(Exit::CannotWrite, &message, Some(hint)));
        }
        let folder = OutputFolder::stage(&self.folder, &console::waiting)?;
        folder.file("link.toml", |out| out.write_all(LINK.as_bytes()))?;
        folder.file("motion.csv", |out| out.write_all(&motion()?))?;
        let schema = link_file_schema();
        folder.file("link.schema.json", |out| out.write_all(schema.as_bytes()))?;
        folder.commit("link.toml", &[])?;
        let [link, motion, schema] = paths.map(|path| path.display().to_string());
        console::print(&format!("written  {link}, {motion} and {schema}\n"))
    }
}

const SCHEMA_EXAMPLE: &str = "\
Example:
  flexlink schema -o link.schema.json

With the first line `#:schema ./link.schema.json` in link.toml, editors that use Taplo, such as \
VS Code with Even Better TOML, complete and check it.";

/// Print the JSON Schema of the link file, for editors.
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

#[cfg(test)]
mod tests {
    use super::*;
    use flexlink::csv::read_motion_table;
    use flexlink::spec::read_specification;

    #[test]
    fn what_it_writes_is_read() {
        let read = read_specification("link.toml", LINK, &[]).expect("a link file");
        assert!(read.mesh.is_automatic());
        let table =
            read_motion_table("motion.csv", &motion().expect("a motion"), read.link.length_m());
        let motion = table.and_then(flexlink::csv::MotionTable::into_motion);
        assert!((motion.expect("a motion").travel_m() - 0.5).abs() < 1e-5);
    }

    #[test]
    fn what_is_commented_out_is_read_too() {
        let uncommented: String = LINK
            .lines()
            .map(|line| match line.strip_prefix("# ") {
                Some(rest) if rest.starts_with('[') || rest.contains(" = ") => rest,
                _ => line,
            })
            .fold(String::new(), |text, line| text + line + "\n");
        let read = read_specification("link.toml", &uncommented, &[]).expect("a link file");
        assert_eq!(read.link.masses().len(), 1);
        assert!(read.link.drive().is_some() && read.limits.torque_n_m.is_some());
    }
}
