//! The cases of a sweep, from files and options.

use std::path::{Path, PathBuf};
use std::sync::{PoisonError, RwLock};

use clap::Args;

use crate::beam::Mesh;
use crate::cli::options::common::{NodeArgs, SyncArgs, digits_arguments, option};
use crate::cli::options::inputs::{
    ChangeArgs, MotionArgs, Wanted, are_read_alike, scale_arguments,
};
use crate::cli::options::moves::Moving;
use crate::cli::options::play::{Driven, DrivenFiles, MovingArgs};
use crate::cli::options::reading::{ReadArgs, TableName, tell};
use crate::cli::simulate::refusal;
use crate::cli::terminal::{Exit, Failure, memory};
use crate::csv::{Digits, InputFile};
use crate::link::{Arm, Link};
use crate::modal::natural_frequencies;
use crate::motion::{MotionScale, Periods};
use crate::result::{Limits, Remark};
use crate::spec::{LinkDocument, Override, SpecError, Specification};
use crate::store::{Fingerprint, RunOutputs, SimulateFiles, SweepIdentity, SweepInputs};
use crate::sweep::{CaseValues, Shard, SweepKind, SweepPlan};
use crate::text::{excerpt, visible};

/// Tables that options of reading may name.
const TABLES: [TableName; 3] = [TableName::Motion, TableName::Torque, TableName::Reference];

/// Options that all cases of a sweep share beside LINK and MOTION.
#[derive(Debug, Args)]
pub(crate) struct CaseArgs {
    #[command(flatten)]
    changes: ChangeArgs,

    #[command(flatten)]
    pub(super) motion: MotionArgs,

    #[command(flatten)]
    pub(crate) torque: TorqueArgs,

    #[command(flatten)]
    pub(crate) outputs: OutputsArgs,
}

/// The play of every case.
#[derive(Debug, Args)]
pub struct TorqueArgs {
    /// Play this torque (CSV: `time`, `torque`; of an arm `torque1`, `torque2`, …) on every case instead, or with --input
    /// a motion of the joints or a voltage, as simulate does, and compare the tip with MOTION.
    #[arg(long, value_name = "TORQUE")]
    pub(crate) torque: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) moving: MovingArgs,
}

/// Which files every case is to write.
#[derive(Debug, Args)]
pub(crate) struct OutputsArgs {
    /// Also write the results of every case, as solve or simulate do, into folders DIR/1, DIR/2,
    /// …, numbered as the rows are.
    #[arg(long, value_name = "DIR")]
    pub(crate) outputs: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) nodes: NodeArgs,

    /// Digits of the tables in --outputs, as in solve.
    #[arg(long, value_name = "N", default_value = "10", requires = "outputs")]
    pub(crate) digits: Digits,

    #[command(flatten)]
    pub(crate) sync: SyncArgs,
}

/// Common inputs and settings of all cases of a sweep.
pub(crate) struct Cases<'a> {
    pub(crate) plan: SweepPlan,
    pub(crate) shared: &'a CaseArgs,
    overrides: Vec<Override>,
    document: LinkDocument,
    pub(crate) link_file: InputFile,
    pub(crate) motion_file: InputFile,
    /// The play of every case.
    pub(crate) driven: Option<Driven>,
    /// Kind of the numbers in the table.
    pub(crate) kind: SweepKind,
    /// The first readable case.
    pub(crate) first: First,
    /// Memory in bytes for each of the cases that run at the same time.
    pub(crate) memory_bytes: Option<usize>,
    /// Shared by every case at work; exclusive for a case that needs more than its share of the memory.
    alone: RwLock<()>,
}

impl<'a> Cases<'a> {
    /// Reads all files; refuses inputs that leave no solvable case.
    pub(crate) fn read(
        plan: SweepPlan,
        link: &Path,
        motion: &Path,
        shared: &'a CaseArgs,
    ) -> Result<Self, Failure> {
        let overrides = shared.changes.overrides()?;
        let mut link_file = InputFile::read_toml(link)?;
        link_file.text()?;
        let mut motion_file = InputFile::read(motion)?;
        let document = LinkDocument::read(&link_file.shown, link_file.text()?)?;
        let described = |case| -> Result<Specification, SpecError> {
            let overrides = with_case(&overrides, &plan.case(case))?;
            document.specification(&link_file.shown, &overrides)
        };
        shared.motion.read.check(&TABLES)?;
        let read = |case| First::read(described(case)?, &motion_file, &shared.motion);
        // A path that the file lacks fails every case: a slip rather than a result.
        let first = read(0).or_else(|failure| {
            plan.single_changes().find_map(|case| read(case).ok()).ok_or(failure)
        })?;
        shared.motion.scale.scaled(&first.wanted)?;
        let driven = shared.torque.read(&first.arm, &shared.motion.read)?;
        tell(&motion_file.shown, &first.wanted.reading);
        refuse_without_effect(|case| described(case).ok(), &plan)?;
        // From here on errors are for the table, whose text must not depend on the place of the files.
        link_file.shown.clone_from(&link_file.name);
        motion_file.shown.clone_from(&motion_file.name);
        let first = first.named(&motion_file.name);
        let kind = match &driven {
            Some(_) => shared.torque.kind(&first.arm),
            None => SweepKind::of_arm(&first.arm),
        };
        Ok(Self {
            plan,
            shared,
            kind,
            overrides,
            document,
            link_file,
            motion_file,
            driven,
            first,
            memory_bytes: memory::available().map(|bytes| bytes / rayon::current_num_threads()),
            alone: RwLock::new(()),
        })
    }

    /// Record that distinguishes the rows of this sweep, which varies `vary`, from the rows of other sweeps.
    pub(crate) fn identity(&self, vary: &[String], shard: Shard) -> SweepIdentity {
        let arguments = [
            self.shared.changes.arguments(),
            self.shared.motion.arguments(),
            self.shared.torque.moving.arguments(),
            self.shared.outputs.identity(),
        ];
        let files = self.driven.as_ref().map(|own| own.files.recorded());
        let played = |of: fn(SimulateFiles<'_>) -> Option<&InputFile>| {
            files.and_then(of).map(Fingerprint::of)
        };
        let inputs = SweepInputs {
            link: Fingerprint::of(&self.link_file),
            motion: Fingerprint::of(&self.motion_file),
            torque: played(|own| Some(own.input)),
            force: played(|own| own.carriage),
            reference: played(|own| own.reference),
            carriage_reference: played(|own| own.carriage_reference),
            vary: vary.to_vec(),
            arguments: arguments.concat(),
        };
        let identity = SweepIdentity::new(self.first.arm.title(), inputs, self.plan.clone(), shard);
        identity.with_links(self.first.links().into_iter(), &self.first.limits)
    }

    /// Does the work of a case within its share of the memory. If the share is too little, waits until no other case
    /// is at work, and uses all available memory.
    pub(crate) fn within_memory<T>(
        &self,
        work: impl Fn(Option<usize>) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let shared = self.alone.read().unwrap_or_else(PoisonError::into_inner);
        let found = work(self.memory_bytes);
        drop(shared);
        match found {
            Err(failure) if failure.is_of_memory => {
                let _alone = self.alone.write().unwrap_or_else(PoisonError::into_inner);
                work(memory::available())
            }
            found => found,
        }
    }

    /// The file of the link or the arm with the changes of a case, with as many links as the first case.
    pub(crate) fn specification(&self, values: &CaseValues) -> Result<Specification, Failure> {
        let overrides = with_case(&self.overrides, values)?;
        let read = self.document.specification(&self.link_file.shown, &overrides)?;
        let [links, must] = [&read.arm, &self.first.arm].map(|arm| arm.links().len());
        if links != must {
            let message =
                format!("links = {links}, but must be {must}, as many as in the first case");
            return Err(Failure::new(Exit::InputRefused, &message, None));
        }
        let [slides, first_slides] = [&read.arm, &self.first.arm]
            .map(|arm| (arm.joint().slides(), arm.carriage().is_some()));
        if slides != first_slides {
            let message =
                "the link changes between hub and carriage, but must keep that of the first case";
            return Err(Failure::new(Exit::InputRefused, &message, None));
        }
        let OutputsArgs { outputs, nodes, .. } = &self.shared.outputs;
        let own = nodes.meshed(read).map_err(of_case)?;
        // The table of a sweep has no histories; the errors of an arm count them all the same.
        let is_short = outputs.is_none() && links == 1;
        let analysis = if is_short { own.analysis.without_tables() } else { own.analysis };
        Ok(Specification { analysis, ..own })
    }

    /// Remarks on unusual input of a case that need not be solved. Only a solution shows jumps.
    pub(crate) fn remarks(&self, case: usize) -> Vec<Remark> {
        let values = self.plan.case(case);
        let Ok(own) = self.specification(&values) else { return Vec::new() };
        let remarks = own.remarks.clone();
        let Ok(mesh) = Mesh::new(own.link(), own.mesh()) else { return remarks };
        let of_modes = |link| Remark::on_modes(link, &mesh, &natural_frequencies(&mesh, 1));
        let of_modes = own.arm.alone().map(of_modes).unwrap_or_default();
        let of_motion = self.motion_of(&own.arm, values.motion).map(|Wanted { motion, .. }| {
            let tolerance = own.analysis.tip_tolerance();
            Remark::on_motion(&own.arm, &motion, motion.largest_travel_m(), tolerance)
        });
        let weight = Remark::on_weight(&own.arm, own.link().direction_rad().is_some());
        let weight = weight.into_iter().collect();
        [remarks, of_modes, of_motion.unwrap_or_default(), weight].concat()
    }

    /// The motion of a case, which scales it.
    pub(crate) fn motion_of(&self, arm: &Arm, varied: MotionScale) -> Result<Wanted, Failure> {
        let scale = self.shared.motion.scale.scale() * varied;
        if let Some(motion) = self.first.motion_of(arm, scale) {
            return motion;
        }
        let Self { shared, motion_file, .. } = self;
        shared.motion.motion_of(motion_file, arm)?.of_case(scale)
    }

    /// The arguments of `solve` that shape the results of this case, for the record.
    pub(crate) fn arguments(&self, values: &CaseValues) -> Vec<String> {
        let varied = values.link_changes.iter().flat_map(|change| option("--set", change));
        [
            self.shared.changes.arguments(),
            varied.collect(),
            self.shared.motion.read.arguments(),
            self.shared.motion.samples.arguments(),
            scale_arguments(self.shared.motion.scale.scale() * values.motion),
            self.shared.torque.moving.arguments(),
            self.shared.outputs.arguments(),
        ]
        .concat()
    }
}

impl TorqueArgs {
    /// Reads the table of an arm; `None` without one.
    pub fn read(&self, arm: &Arm, read: &ReadArgs) -> Result<Option<Driven>, Failure> {
        let Some(path) = &self.torque else { return Ok(None) };
        self.moving.check(arm, &[])?;
        let driven = self.moving.load(path, arm, &|table| read.format(table, TABLES[0]));
        let driven = driven.map_err(|failure| TableName::Torque.refused(failure))?;
        let Driven { files: DrivenFiles { reference, .. }, moving, feedback, .. } = &driven;
        if let (Moving::Torques(torques), Some(file)) = (moving, reference) {
            for (own, torque) in feedback.iter().zip(torques) {
                own.check_times(torque).map_err(|error| {
                    let (message, hint) = refusal(&error, arm);
                    let message = format!("{}: {message}", file.shown);
                    Failure::new(Exit::InputRefused, &message, hint.as_deref())
                })?;
            }
        }
        Ok(Some(driven))
    }
}

/// Converts the refusal of a case to a failure that does not end the other cases.
pub(super) fn of_case(refused: Failure) -> Failure {
    Failure { exit: Exit::InputRefused, ..refused }
}

impl OutputsArgs {
    /// The arguments that shape the files of a case, for its record.
    pub(crate) fn arguments(&self) -> Vec<String> {
        [self.nodes.arguments(), digits_arguments(self.digits)].concat()
    }

    /// Arguments that shape the files of the cases, for the identity of a sweep. The files of finished rows have the
    /// same identity.
    pub(crate) fn identity(&self) -> Vec<String> {
        let folder = self.outputs.iter().flat_map(|folder| option("--outputs", folder.display()));
        folder.chain(self.arguments()).collect()
    }

    /// The tables of a case whose links have these nodes; refuses missing nodes. Meshes of arms differ from case to
    /// case, so a missing node ends only its case.
    pub(crate) fn of_case(&self, nodes_m: &[&[f64]]) -> Result<RunOutputs, Failure> {
        let is_arm = nodes_m.len() > 1;
        let checked = self.nodes.check(nodes_m);
        checked.map_err(|refused| if is_arm { of_case(refused) } else { refused })?;
        Ok(self.nodes.outputs(self.digits))
    }

    /// Folder of a case, numbered from 0, with as many digits as `cases` has.
    pub(crate) fn folder_of(&self, case: usize, cases: usize) -> Option<PathBuf> {
        let width = cases.to_string().len();
        self.outputs.as_ref().map(|folder| folder.join(format!("{:0width$}", case + 1)))
    }
}

/// Refuses a variation if a later one sets the same value again under another name.
fn refuse_without_effect(
    read: impl Fn(usize) -> Option<Specification>,
    plan: &SweepPlan,
) -> Result<(), Failure> {
    let Some(first) = read(0) else { return Ok(()) };
    let mut case = plan.cases();
    for variation in plan.variations() {
        // The case with its second value and the first values of all others.
        let values = variation.values().len();
        case /= values;
        if values < 2 || plan.case(case).link_changes == plan.case(0).link_changes {
            continue;
        }
        if read(case).is_some_and(|second| second == first) {
            let changes = variation.changes();
            let shown: Vec<_> = changes[..2].iter().map(|change| excerpt(change)).collect();
            let what = first.arm.pick("link", "arm");
            let message = format!("--vary: {} give the same {what}", shown.join(" and "));
            let hint = "a later --vary may set the same value under another name";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        }
    }
    Ok(())
}

/// Changes for all cases, followed by the changes of this case.
fn with_case(overrides: &[Override], values: &CaseValues) -> Result<Vec<Override>, SpecError> {
    let placed = |change: &String| {
        Override::placed(&format!("--vary '{}'", visible(&excerpt(change))), change)
    };
    let own = values.link_changes.iter().map(placed);
    overrides.iter().cloned().map(Ok).chain(own).collect()
}

/// The first readable case, and the inputs that others share with it.
pub(crate) struct First {
    pub(super) arm: Arm,
    pub(super) limits: Vec<Limits>,
    pub(super) wanted: Wanted,
    /// The periods of the motion of a link's tip, which most cases share.
    pub(super) periods: Option<Periods>,
}

impl First {
    /// Reads the motion of a link or an arm.
    pub(super) fn read(
        Specification { arm, limits, .. }: Specification,
        file: &InputFile,
        motion: &MotionArgs,
    ) -> Result<Self, Failure> {
        let wanted = motion.motion_of(file, &arm)?;
        let periods = wanted.motion.tip().map(Periods::of);
        Ok(Self { arm, limits, wanted, periods })
    }

    /// The first case with `name` as the name of its motion's file in errors.
    pub(super) fn named(self, name: &str) -> Self {
        let rows = self.wanted.rows.named(name);
        Self { wanted: Wanted { rows, ..self.wanted }, ..self }
    }

    /// Its motion over another distance and duration, if a file would be the same motion of this arm.
    pub(super) fn motion_of(
        &self,
        arm: &Arm,
        scale: MotionScale,
    ) -> Option<Result<Wanted, Failure>> {
        are_read_alike(arm, &self.arm).then(|| self.wanted.of_case(scale))
    }

    /// The links.
    pub(super) fn links(&self) -> Vec<&Link> {
        self.arm.links().iter().map(|own| &own.link).collect()
    }
}
