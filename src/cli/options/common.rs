//! Options of several commands, and the arguments in a run's record.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::Path;

use clap::Args;

use crate::beam::{MeshPlan, node_at};
use crate::csv::Digits;
use crate::link::Arm;
use crate::numeric::{Dimension, parse_hertz, parse_quantity};
use crate::spec::Specification;
use crate::store::{Durability, OutputFolder, RunOutputs, STATIONS};
use crate::text::plain;

use crate::cli::terminal::{Exit, Failure, console};

/// Which part of the nodal tables to write.
#[derive(Debug, Args)]
pub struct NodeArgs {
    /// Nodes to write, numbered from 0 at the root [default: all]. For an arm the numbers apply to each link; a link
    /// with fewer nodes writes those that it has.
    #[arg(long = "nodes", value_name = "LIST", value_delimiter = ',', value_parser = node)]
    pub(crate) list: Option<Vec<usize>>,

    /// Write the nodes at these distances from the axis in m, or with unit (`60cm`); for an arm from each link's
    /// joint. The mesh gets a node there, unless it has one.
    #[arg(long = "stations", value_name = "LIST", value_delimiter = ',', value_parser = metres)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) stations_m: Vec<f64>,

    /// Write every K-th row of the nodal tables.
    #[arg(long, value_name = "K", default_value_t = NonZeroUsize::MIN, value_parser = every)]
    pub(crate) every: NonZeroUsize,
}

impl NodeArgs {
    /// The nodes at these places in m, in every row.
    pub(crate) fn at(stations_m: Vec<f64>) -> Self {
        Self { list: None, stations_m, every: NonZeroUsize::MIN }
    }

    /// Arguments for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let list = self.list.as_deref().map(|nodes| {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            option("--nodes", nodes.join(","))
        });
        let stations = (!self.stations_m.is_empty()).then(|| {
            let stations: Vec<String> = self.stations_m.iter().map(|x| plain(*x)).collect();
            option(STATIONS, stations.join(","))
        });
        let every = (self.every.get() != 1).then(|| option("--every", self.every));
        list.into_iter().chain(stations).chain(every).flatten().collect()
    }

    /// The first option in use that chooses nodes.
    pub(crate) fn chosen(&self) -> Option<&'static str> {
        let stations = (!self.stations_m.is_empty()).then_some(STATIONS);
        self.list.is_some().then_some("--nodes").or(stations)
    }

    /// Puts a node at each station into the meshes of an arm; of several links a shorter one gets those on it.
    pub fn meshes(&self, arm: &Arm, meshes: &mut [MeshPlan]) -> Result<(), Failure> {
        let refused = |error| Failure::new(Exit::Usage, &format!("--{error}"), None);
        let mut elsewhere_m = self.stations_m.clone();
        for (mesh, own) in meshes.iter_mut().zip(arm.links()) {
            let is_there =
                |at_m: &f64| arm.alone().is_some() || own.link.check_place(STATIONS, *at_m).is_ok();
            let stations_m: Vec<f64> = self.stations_m.iter().copied().filter(is_there).collect();
            elsewhere_m.retain(|at_m| !is_there(at_m));
            *mesh = mesh.clone().with_nodes_at(&own.link, &stations_m).map_err(refused)?;
        }
        let Some(at_m) = elsewhere_m.first() else { return Ok(()) };
        let message = format!("{STATIONS} = {at_m} m, but must lie on a link of the arm");
        let hint = "write a distance in m from the joint of a link, at most to its tip";
        Err(Failure::new(Exit::Usage, &message, Some(hint)))
    }

    /// The content of a file, meshed with a node at each station.
    pub(crate) fn meshed(&self, mut own: Specification) -> Result<Specification, Failure> {
        self.meshes(&own.arm, &mut own.meshes)?;
        Ok(own)
    }

    /// Tables of a run with these nodes and rows, without tables on demand.
    pub(crate) fn outputs(&self, digits: Digits) -> RunOutputs {
        let (nodes, stations_m) = (self.list.clone(), self.stations_m.clone());
        RunOutputs { nodes, stations_m, every: self.every, digits, ..RunOutputs::default() }
    }

    /// Returns an error if a node is not in the mesh, or named twice.
    pub fn check(&self, links_nodes_m: &[&[f64]]) -> Result<(), Failure> {
        self.check_stations(links_nodes_m)?;
        let most = links_nodes_m.iter().map(|nodes_m| nodes_m.len()).max().unwrap_or(1);
        let is_arm = links_nodes_m.len() > 1;
        self.check_up_to(most - 1, if is_arm { "nodes of a link" } else { "nodes of the mesh" })
    }

    fn check_stations(&self, links_nodes_m: &[&[f64]]) -> Result<(), Failure> {
        let is_node = |at_m: f64| links_nodes_m.iter().any(|nodes| node_at(nodes, at_m).is_some());
        let Some(at_m) = self.stations_m.iter().find(|at_m| !is_node(**at_m)) else {
            return Ok(());
        };
        let message = format!("{STATIONS} = {at_m} m, but must be a node of the mesh");
        let hint = "solve with --stations to have nodes there";
        Err(Failure::new(Exit::Usage, &message, Some(hint)))
    }

    /// Line of the summary with the nodes of the stations, for each link; empty without stations.
    pub(crate) fn text(&self, links_nodes_m: &[&[f64]]) -> String {
        let several = links_nodes_m.len() > 1;
        let of_station = |at_m: &f64| {
            let nodes = (1..).zip(links_nodes_m).filter_map(|(link, nodes_m)| {
                let node = node_at(nodes_m, *at_m)?;
                Some(if several { format!("{node} of link {link}") } else { node.to_string() })
            });
            format!("{} m: node {}", plain(*at_m), nodes.collect::<Vec<_>>().join(" and "))
        };
        let stations: Vec<String> = self.stations_m.iter().map(of_station).collect();
        if stations.is_empty() {
            String::new()
        } else {
            format!("stations {}\n", stations.join(", "))
        }
    }

    fn check_up_to(&self, last: usize, what: &str) -> Result<(), Failure> {
        let nodes = self.list.as_deref().unwrap_or_default();
        if let Some(node) = nodes.iter().find(|node| **node > last) {
            let message = format!("--nodes = {node}, but must name {what}, 0 to {last}");
            return Err(Failure::new(Exit::Usage, &message, Some("nodes.csv lists them")));
        }
        let mut seen = BTreeSet::new();
        let Some(node) = nodes.iter().find(|node| !seen.insert(**node)) else { return Ok(()) };
        let message = format!("--nodes = {node} twice, but must name each node once");
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

/// Parses a whole number above 0.
pub(crate) fn positive(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|k| *k > 0).ok_or_else(|| "must be a whole number above 0".into())
}

/// Parses the number of a node.
fn node(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "must be whole numbers from 0 on, separated by commas".into())
}

/// Parses a whole number above 0, as a step.
fn every(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "must be a whole number above 0".into())
}

/// Parses a finite number, 0 or above.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "must be a finite number, 0 or above".into())
}

/// Parses a finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| "must be a finite number".into())
}

/// Parses a finite number in SI, or one with its unit.
pub(crate) fn quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    finite(text).or_else(|_| parse_quantity(text, dimension).map_err(|error| error.to_string()))
}

/// Parses a frequency in Hz, or with its unit.
pub(crate) fn hertz(text: &str) -> Result<f64, String> {
    let must = || "must be a number of Hz, or a frequency such as '2 kHz'".to_owned();
    finite(text).ok().or_else(|| parse_hertz(text)).ok_or_else(must)
}

/// Parses a length in m, or with its unit.
pub(crate) fn metres(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::LENGTH)
}

/// Parses a time in s, or with its unit.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::TIME)
}

/// Parses an angle in rad, or with its unit.
pub(crate) fn angle_rad(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::NONE)
}

/// Directions of --at, one for each link of an arm.
pub(crate) fn directions(at: Option<&[f64]>, links: usize) -> Result<Vec<f64>, Failure> {
    let found = match at {
        Some(directions) if directions.len() == links => return Ok(directions.to_vec()),
        Some(directions) => format!("= {} directions", directions.len()),
        None => "is missing".to_owned(),
    };
    let (must, hint) = if links == 1 {
        ("but must be one direction".to_owned(), "write it as in --at '-90 deg'")
    } else {
        let must = format!("but must be {links} directions, one for each link of the arm");
        (must, "write them as in --at '30 deg,75 deg', from joint to joint, the inner link first")
    };
    Err(Failure::new(Exit::Usage, &format!("--at {found}, {must}"), Some(hint)))
}

/// An option and its value, in one text if the value alone would be read as an option.
pub fn option(name: &str, value: impl Display) -> Vec<String> {
    let value = value.to_string();
    if value.starts_with('-') {
        vec![format!("{name}={value}")]
    } else {
        vec![name.to_owned(), value]
    }
}

/// Argument for digits other than the default.
pub(crate) fn digits_arguments(digits: Digits) -> Vec<String> {
    if digits == Digits::default() { Vec::new() } else { option("--digits", digits) }
}
