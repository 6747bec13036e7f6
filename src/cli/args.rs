//! Arguments that several commands share.

use std::num::NonZero;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

use flexlink::beam::Mesh;
use flexlink::csv::{InputFile, read_motion_table};
use flexlink::link::Link;
use flexlink::motion::{MotionScale, TipMotion};
use flexlink::numeric::plain;
use flexlink::spec::{Override, SpecError, Specification, read_specification};
use flexlink::store::Durability;

use super::exit::{Exit, Failure};
use super::memory::{available, most_threads};
use super::progress::StageBar;
use super::record::option;

pub(crate) const LINK: &str = "Link file (TOML)";

pub(crate) const MOTION: &str =
    "Tip trajectory (CSV): `time` and `acceleration`, `displacement` or `angle`";

/// A link file and the changes to it.
#[derive(Debug, Args)]
pub(crate) struct LinkArgs {
    #[arg(value_name = "LINK", help = LINK)]
    pub(crate) link: PathBuf,

    #[command(flatten)]
    pub(crate) changes: ChangeArgs,
}

impl LinkArgs {
    /// Reads the link file and applies the changes.
    pub(crate) fn load(&self) -> Result<(InputFile, Specification), Failure> {
        let file = InputFile::read_toml(&self.link)?;
        let specification = self.changes.specification(&file)?;
        Ok((file, specification))
    }
}

/// Changes to a link file.
#[derive(Debug, Args)]
pub(crate) struct ChangeArgs {
    /// Replace a value of the link file, or multiply it with `*=`; repeatable, in order. A segment
    /// is named, numbered from 0, or `*` for all: 'segments.*.EI*=4', 'payload.mass="50 g"'.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    changes: Vec<String>,
}

impl ChangeArgs {
    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        self.changes.iter().flat_map(|change| option("--set", change)).collect()
    }

    /// The changes, read.
    pub(crate) fn overrides(&self) -> Result<Vec<Override>, Failure> {
        let overrides: Result<_, SpecError> =
            self.changes.iter().map(|change| change.parse()).collect();
        overrides.map_err(|error| Failure::new(Exit::Usage, &error, error.hint()))
    }

    /// What a link file describes with the changes.
    pub(crate) fn specification(&self, file: &InputFile) -> Result<Specification, Failure> {
        specification(file, &self.overrides()?)
    }
}

/// What a link file describes with some changes.
pub(crate) fn specification(
    file: &InputFile,
    changes: &[Override],
) -> Result<Specification, Failure> {
    let read = read_specification(&file.shown, file.text()?, changes);
    let mut specification = read.map_err(|error| {
        let extension = Path::new(&file.name).extension();
        let is_table = extension.is_some_and(|extension| extension == "csv");
        let order = is_table.then_some("LINK, a TOML file, stands before MOTION or TORQUE");
        Failure::new(Exit::InputRefused, &error, file.disguise().or(error.hint()).or(order))
    })?;
    specification.analysis = specification.analysis.within_memory(available());
    Ok(specification)
}

/// A tip trajectory.
#[derive(Debug, Args)]
pub(crate) struct MotionArgs {
    #[arg(value_name = "MOTION", help = MOTION)]
    pub(crate) motion: PathBuf,

    #[command(flatten)]
    pub(crate) resample: ResampleArgs,
}

/// How the samples of a trajectory are taken.
#[derive(Debug, Args)]
pub(crate) struct ResampleArgs {
    /// Make the trajectory uniform by a cubic spline, at this step in s.
    #[arg(long, value_name = "STEP", allow_negative_numbers = true)]
    resample: Option<f64>,
}

impl ResampleArgs {
    /// The trajectory that a file holds for the tip of a link.
    pub(crate) fn motion_of(&self, file: &InputFile, link: &Link) -> Result<TipMotion, Failure> {
        let table = read_motion_table(&file.shown, &file.bytes, link.length_m())?;
        let table = match self.resample {
            Some(step_s) => table.resampled(step_s)?,
            None => table,
        };
        Ok(table.into_motion()?)
    }

    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        self.resample.map(|step_s| option("--resample", step_s)).unwrap_or_default()
    }
}

/// Factors on a motion, as a sweep has them.
#[derive(Debug, Args)]
pub(crate) struct ScaleArgs {
    #[arg(long, value_name = "FACTOR", value_parser = finite, allow_negative_numbers = true)]
    #[arg(
        default_value_t = 1.0,
        hide_default_value = true,
        help = "Multiply the motion's distance"
    )]
    scale_distance: f64,

    /// Multiply the motion's duration, from its first sample on.
    #[arg(long, value_name = "FACTOR", value_parser = finite, allow_negative_numbers = true)]
    #[arg(default_value_t = 1.0, hide_default_value = true)]
    scale_duration: f64,
}

impl ScaleArgs {
    fn scale(&self) -> MotionScale {
        MotionScale { distance: self.scale_distance, duration: self.scale_duration }
    }

    /// A motion with these factors.
    pub(crate) fn scaled(&self, motion: TipMotion) -> Result<TipMotion, Failure> {
        if self.scale() == MotionScale::default() {
            return Ok(motion);
        }
        let scaled = motion.scaled(self.scale());
        scaled.map_err(|error| {
            let message = format!("{}: {error}", scale_arguments(self.scale()).join(" "));
            Failure::new(Exit::Usage, &message, error.hint())
        })
    }

    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        scale_arguments(self.scale())
    }
}

/// The arguments that scale a motion so, for the record.
pub(crate) fn scale_arguments(scale: MotionScale) -> Vec<String> {
    let MotionScale { distance, duration } = scale;
    let factors = [("--scale-distance", distance), ("--scale-duration", duration)];
    let others = factors.into_iter().filter(|(_, factor)| factor.total_cmp(&1.0).is_ne());
    others.flat_map(|(name, factor)| option(name, plain(factor))).collect()
}

/// What to print on standard output.
#[derive(Debug, Args)]
pub(crate) struct PrintArgs {
    #[arg(long, conflicts_with = "quiet", help = "Print summary.json instead of the summary")]
    pub(crate) json: bool,

    /// Print nothing but warnings and errors.
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl PrintArgs {
    /// Shows how far the work is.
    pub(crate) fn stages(&self) -> StageBar {
        if self.quiet { StageBar::hidden() } else { StageBar::new() }
    }
}

/// Which part of the nodal tables to write.
#[derive(Debug, Args)]
pub(crate) struct NodeArgs {
    /// Nodes to write, numbered from 0 at the root [default: all].
    #[arg(long = "nodes", value_name = "LIST", value_delimiter = ',')]
    pub(crate) list: Option<Vec<usize>>,

    /// Write every K-th row of the nodal tables.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = positive)]
    pub(crate) every: usize,
}

impl NodeArgs {
    /// The arguments, for the record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        let list = self.list.as_deref().map(|nodes| {
            let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
            option("--nodes", nodes.join(","))
        });
        let every = (self.every != 1).then(|| option("--every", self.every));
        list.into_iter().chain(every).flatten().collect()
    }

    /// Refuses nodes that the mesh does not have, and those named twice.
    pub(crate) fn check(&self, mesh: &Mesh) -> Result<(), Failure> {
        let last = mesh.nodes_m().len() - 1;
        let nodes = self.list.as_deref().unwrap_or_default();
        let refuse = |message: &str, hint| Err(Failure::new(Exit::Usage, &message, hint));
        if let Some(node) = nodes.iter().find(|node| **node > last) {
            let message = format!("--nodes = {node}, but must name nodes of the mesh, 0 to {last}");
            return refuse(&message, Some("nodes.csv lists them"));
        }
        let twice = nodes.iter().enumerate().find(|(k, node)| nodes[..*k].contains(node));
        match twice {
            Some((_, node)) => {
                refuse(&format!("--nodes = {node} twice, but must name it once"), None)
            }
            None => Ok(()),
        }
    }
}

/// Whether a run waits for the disk.
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
}

/// How many threads to use.
#[derive(Debug, Args, Default)]
pub(crate) struct ThreadArgs {
    /// Threads to use [default: all cores]; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Prepares the threads, of which the calling one is the first; to be called once, before any
    /// work. Where the system has no others, and no one asked for them, it does the work of all.
    pub(crate) fn apply(&self) -> Result<(), Failure> {
        let most = most_threads();
        // They start while this one goes on; for the global ones it would wait, which a small run
        // feels.
        match self.number(most).use_current_thread().build() {
            Ok(pool) => {
                // They serve until the program ends.
                let pool = Box::leak(Box::new(pool));
                // Where memory is limited, nothing else may take what they begin with.
                if most.is_some() {
                    pool.broadcast(|_| ());
                }
                Ok(())
            }
            Err(error) if self.threads.is_some() => Err(no_threads(&error)),
            Err(_) => Ok(()),
        }
    }

    /// Prepares threads for a caller that waits for them and is none of them itself.
    pub(crate) fn apply_apart(&self) -> Result<(), Failure> {
        let most = most_threads();
        self.number(most).build_global().map_err(|error| no_threads(&error))?;
        if most.is_some() {
            rayon::broadcast(|_| ());
        }
        Ok(())
    }

    /// A pool of the threads that the user asks for, or of one for each core; `most` limits their number.
    fn number(&self, most: Option<usize>) -> ThreadPoolBuilder {
        let asked = self.threads.map(usize::from);
        let threads = match most {
            Some(most) => asked.unwrap_or_else(default_threads).min(most),
            None => asked.unwrap_or(0),
        };
        ThreadPoolBuilder::new().num_threads(threads)
    }
}

/// How many threads there are where nobody asks for a number, as rayon counts them.
fn default_threads() -> usize {
    let told = std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok());
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    told.filter(|threads| *threads > 0).unwrap_or_else(cores)
}

fn no_threads(error: &ThreadPoolBuildError) -> Failure {
    let hint = "the system limits threads and memory (`ulimit -u`, `ulimit -v`)";
    Failure::new(Exit::NotSolvable, &format!("cannot start threads: {error}"), Some(hint))
}

/// A whole number above 0.
pub(crate) fn positive(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|k| *k > 0).ok_or_else(|| "must be a whole number above 0".into())
}

/// A finite number, 0 or above.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "must be a finite number, 0 or above".into())
}

/// A number that is neither infinite nor none.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| "must be a finite number".into())
}
