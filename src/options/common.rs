//! Options of several commands, and the arguments that a run records.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::Path;

use clap::Args;

use flexlink::beam::Mesh;
use flexlink::csv::Digits;
use flexlink::inverse::ArmSolution;
use flexlink::numeric::{Dimension, parse_quantity};
use flexlink::store::{Durability, OutputFolder, RunOutputs};

use crate::terminal::{Exit, Failure, console};

/// Which part of the nodal tables to write.
#[derive(Debug, Args)]
pub(crate) struct NodeArgs {
    /// Nodes to write, numbered from 0 at the root [default: all]. Of an arm that is solved those of each
    /// link: a link that has fewer writes those that it has.
    #[arg(long = "nodes", value_name = "LIST", value_delimiter = ',', value_parser = node)]
    pub(crate) list: Option<Vec<usize>>,

    /// Write every K-th row of the nodal tables.
    #[arg(long, value_name = "K", default_value_t = NonZeroUsize::MIN, value_parser = every)]
    pub(crate) every: NonZeroUsize,
}

impl NodeArgs {
    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let list = self.list.as_deref().map(|nodes| {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            option("--nodes", nodes.join(","))
        });
        let every = (self.every.get() != 1).then(|| option("--every", self.every));
        list.into_iter().chain(every).flatten().collect()
    }

    /// The tables of a run with these nodes and rows, without those on demand.
    pub(crate) fn outputs(&self, digits: Digits) -> RunOutputs {
        let (nodes, every) = (self.list.clone(), self.every);
        RunOutputs { nodes, every, digits, ..RunOutputs::default() }
    }

    /// Returns an error if a node is not one of the mesh, or named twice.
    pub(crate) fn check(&self, mesh: &Mesh) -> Result<(), Failure> {
        self.check_up_to(mesh.nodes_m().len() - 1, "nodes of the mesh")
    }

    /// Returns an error if no link of an arm has a node, or one is named twice.
    pub(crate) fn check_arm(&self, solution: &ArmSolution) -> Result<(), Failure> {
        let most = solution.links.iter().map(|link| link.nodes_m.len()).max();
        self.check_up_to(most.unwrap_or(1) - 1, "nodes of a link")
    }

    fn check_up_to(&self, last: usize, what: &str) -> Result<(), Failure> {
        let nodes = self.list.as_deref().unwrap_or_default();
        if let Some(node) = nodes.iter().find(|node| **node > last) {
            let message = format!("--nodes = {node}, but must name {what}, 0 to {last}");
            return Err(Failure::new(Exit::Usage, &message, Some("nodes.csv lists them")));
        }
        let mut seen = BTreeSet::new();
        let Some(node) = nodes.iter().find(|node| !seen.insert(**node)) else { return Ok(()) };
        let message = format!("--nodes = {node} twice, but must name it once");
        Err(Failure::new(Exit::Usage, &message, None))
    }
}

/// If a run waits for the disk.
#[derive(Debug, Args)]
pub(crate) struct SyncArgs {
    /// Wait until the results are on the disk: they survive a power failure right after the run.
    #[arg(long, conflicts_with = "no_sync")]
    sync: bool,

    /// Has no effect: a run waits for the disk only with --sync. Older scripts may still give it.
    #[arg(long, hide = true)]
    no_sync: bool,
}

impl SyncArgs {
    pub(crate) fn durability(&self) -> Durability {
        if self.sync { Durability::OnDisk } else { Durability::InMemory }
    }

    /// Begins a folder of results.
    pub(crate) fn stage(&self, folder: &Path) -> Result<OutputFolder, Failure> {
        Ok(OutputFolder::stage(folder, &console::waiting)?.with(self.durability()))
    }
}

/// A whole number above 0.
pub(crate) fn positive(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|k| *k > 0).ok_or_else(|| "must be a whole number above 0".into())
}

/// The number of a node.
fn node(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "must be whole numbers from 0 on, separated by commas".into())
}

/// A whole number above 0, as a step.
fn every(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "must be a whole number above 0".into())
}

/// A finite number, 0 or above.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "must be a finite number, 0 or above".into())
}

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| "must be a finite number".into())
}

/// A finite number in SI, or one with its unit.
pub(crate) fn quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    finite(text).or_else(|_| parse_quantity(text, dimension).map_err(|error| error.to_string()))
}

/// A time in s, or with its unit.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::TIME)
}

/// An angle in rad, or with its unit.
pub(crate) fn angle_rad(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::NONE)
}

/// The directions of --at, one for each link of an arm.
pub(crate) fn directions(at: Option<&[f64]>, links: usize) -> Result<Vec<f64>, Failure> {
    let found = match at {
        Some(directions) if directions.len() == links => return Ok(directions.to_vec()),
        Some(directions) => format!("{} directions", directions.len()),
        None => "nothing".to_owned(),
    };
    let must = format!("but must be {links} directions, one for each link of the arm");
    let hint = "as in --at '30 deg,75 deg': from joint to joint, the inner link first";
    Err(Failure::new(Exit::Usage, &format!("--at = {found}, {must}"), Some(hint)))
}

/// An option and its value, in one text if the value alone would be read as an option.
pub(crate) fn option(name: &str, value: impl Display) -> Vec<String> {
    let value = value.to_string();
    if value.starts_with('-') {
        vec![format!("{name}={value}")]
    } else {
        vec![name.to_owned(), value]
    }
}

/// The argument for digits other than the default.
pub(crate) fn digits_arguments(digits: Digits) -> Vec<String> {
    if digits == Digits::default() { Vec::new() } else { option("--digits", digits) }
}

/// Refuses options, as they are recorded, that are known for one link alone.
pub(crate) fn refuse_for_arms(options: impl IntoIterator<Item = String>) -> Result<(), Failure> {
    match options.into_iter().find(|option| option.starts_with("--")) {
        None => Ok(()),
        Some(option) => {
            let option = option.split('=').next().unwrap_or_default();
            let message = format!("{option} is for one link, and the arm has several");
            Err(Failure::new(Exit::Usage, &message, None))
        }
    }
}
