//! `modes`: natural frequencies, mode shapes and zeros.

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::Args;

use crate::beam::{Mesh, MeshPlan};
use crate::csv::Digits;
use crate::link::{Arm, Link};
use crate::modal::{
    DampingLaw, MOST_ELEMENTS_OF_A_POSE, PoseHub, Shape, Thickness, mode, natural_frequencies,
    pose_modes, pose_zeros, real_frequency_zeros, torque_zeros,
};
use crate::response::{
    ArmModes, ArmShapes, PoseMode, SettledModes, StateSpace, StateSpaceScope, arm_modes,
    damping_ratios,
};
use crate::result::NO_DIRECTION;
use crate::result::{LinkZeros, ModesResult, Notice, Remark, Setting, mesh_errors};
use crate::spec::Specification;
use crate::store::modes_json;

use super::state_space::{StateSpaceArgs, described, state_space};
use crate::cli::options::common::{NodeArgs, SyncArgs, angle_rad, directions};
use crate::cli::options::inputs::{LinkArgs, refuse_direction, warn_of_gravity};
use crate::cli::terminal::files::check_folder;
use crate::cli::terminal::text::modes_text;
use crate::cli::terminal::{Exit, Failure, PrintArgs, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink modes link.toml --count 5 -o out
  flexlink modes hanging.toml --at '-90 deg' -o out
  flexlink modes arm.toml --at '30 deg,75 deg' -o out
  flexlink modes link.toml --count 3 --state-space link.json";

/// Error of an automatic mesh in the modes of a pose. Dense algebra computes them, and its round-off grows with the
/// fourth power of the number of elements.
const POSE_TOLERANCE: f64 = 1e-5;

/// Share of gravity along the link below which it counts as 0.
const ACROSS: f64 = 1e-12;

/// Memory in bytes of a node in a shape, as computed and as written.
const BYTES_PER_DISPLACEMENT: usize = 16;

/// Natural frequencies, mode shapes and zeros of a link or an arm.
///
/// Prints tables; with -o, writes modes.csv, mode_shapes.csv, zeros.csv and held_modes.csv into a folder. Modes are
/// computed with a free hub and with a held hub; shapes are mass-normalised and positive at the tip.
/// The zeros of the transfer from hub torque to tip set how long before the tip the torque must start. An
/// automatic mesh is refined until the frequencies are exact to mesh.tolerance. The mesh error of each
/// number is measured on elements of half the length; above 1 % there is a warning. Damping ratios are those of the
/// complex modes, with the damping of the link, the friction of its hub and the spring of its joint.
///
/// With a [drive] the rotor is held instead of the hub: the hub is then on the joint's spring or, if the joint is
/// stiff, clamped.
///
/// Gravity changes frequencies with the direction of the link. --at computes those of one direction, hub free and
/// held, from the weight that pulls along the straight link. The sag is left out, and the zeros are without gravity.
///
/// An arm of several links needs --at, with a direction for each link. The frequencies are those of small motions
/// about the arm's shape at rest there, bent by its weight, with all joints free and with all rotors held; the zeros
/// are those of each link. The bending of the links is refined until the frequencies are exact to mesh.tolerance.
///
/// With --at and -o, mode_shapes.csv has x and y of each node, at rest and moved by the modes with free joints and with
/// held rotors. The shapes are mass-normalised, and the joint that turns most turns counterclockwise. A mode that leaves
/// the pose has a growth rate.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
#[command(mut_arg("json", |arg| arg.help("Print modes and zeros as JSON instead of the table")))]
pub(crate) struct Modes {
    #[command(flatten)]
    link: LinkArgs,

    /// Number of modes and zeros, at most 1000.
    #[arg(long, value_name = "N", default_value_t = 10)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    count: u16,

    /// Direction of the link, for frequencies with gravity: an angle in rad, or with its unit, as in '-90 deg'. For
    /// an arm the directions of all its links, from joint to joint, the inner one first.
    #[arg(long, value_name = "ANGLE", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(value_delimiter = ',')]
    at: Option<Vec<f64>>,

    /// Folder for the tables [default: none is written].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "12")]
    digits: Digits,

    #[command(flatten)]
    print: PrintArgs,

    #[command(flatten)]
    state_space: StateSpaceArgs,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    sync: SyncArgs,
}

impl Modes {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.output.as_deref().map_or(Ok(()), |folder| check_folder("--output", folder))?;
        self.state_space.check(&self.link.link)?;
        let (_, mut specification) = self.link.load()?;
        self.state_space.mesh(&mut specification)?;
        let arm = &specification.arm;
        let bar = self.print.stages();
        bar.at("finding modes and zeros");
        let wanted = match (&self.output, arm.links().len()) {
            (Some(_), _) => Wanted::Tables,
            (None, 1) => Wanted::Modes,
            (None, _) => Wanted::Zeros,
        };
        let count = usize::from(self.count);
        let found = computed(&specification, self.at.as_deref(), count, wanted)?;
        let space = self.state_space.compute(&specification, &found, count)?;
        drop(bar);
        if let Some(folder) = &self.output {
            found.write(self.sync.stage(folder)?, self.digits)?;
        }
        if let Some(space) = &space {
            let told = self.state_space.write(&specification.arm, &found, space)?;
            told.filter(|_| !self.print.quiet).iter().for_each(|own| console::note(own));
        }
        let warnings = tell(&specification, &found);
        self.print.print(|| modes_json(&found), || modes_text(arm, &found))?;
        self.warnings.refuse(warnings)
    }
}

/// Extent of the results in a pose.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub enum Wanted {
    /// Modes alone.
    Modes,
    /// Zeros of the links, too.
    Zeros,
    /// All tables: modes, zeros and shapes.
    Tables,
}

/// The first `count` modes of a link, or of a link or an arm in the directions of `--at`, in rad.
pub fn computed(
    specification: &Specification,
    at: Option<&[f64]>,
    count: usize,
    wanted: Wanted,
) -> Result<ModesResult, Failure> {
    let links = specification.arm.links();
    match (links, at) {
        ([one], None) => match one.link.direction_rad() {
            Some(angle_rad) => {
                straight((&one.link, specification.mesh()), angle_rad, count, wanted)
            }
            None => level((&one.link, specification.mesh()), count),
        },
        ([one], Some(at)) => {
            if one.link.gravity().is_some_and(|own| own.start_angle_rad.is_some()) {
                refuse_direction(&specification.arm)?;
            }
            let angle_rad = directions(Some(at), 1)?[0];
            straight((&one.link, specification.mesh()), angle_rad, count, wanted)
        }
        (_, at) => at_rest(specification, &directions(at, links.len())?, count, wanted),
    }
}

/// Modes of a link or an arm, its state space, and what this contains in words.
///
/// # Errors
/// As of [`computed`]; a station beside the links.
pub fn state_space_of(
    specification: &Specification,
    at: Option<&[f64]>,
    scope: &StateSpaceScope,
) -> Result<(ModesResult, StateSpace, String), Failure> {
    let mut specification = specification.clone();
    let stations = NodeArgs::at(scope.stations_m.clone());
    stations.meshes(&specification.arm, &mut specification.meshes)?;
    let found = computed(&specification, at, scope.modes.count(), Wanted::Modes)?;
    let space = state_space(&specification, &found, scope)?;
    let description = described(&space, scope);
    Ok((found, space, description))
}

/// Modes of an arm about its shape at rest.
fn at_rest(
    Specification { arm, meshes, .. }: &Specification,
    directions_rad: &[f64],
    count: usize,
    wanted: Wanted,
) -> Result<ModesResult, Failure> {
    let modes = arm_modes(arm, directions_rad, count, MeshPlan::smallest_tolerance(meshes))?;
    let (mut zeros, mut links) = (Vec::new(), Vec::new());
    if wanted >= Wanted::Zeros {
        for (own, plan) in arm.links().iter().zip(meshes) {
            let (mesh, omega_rad_s) = resolved(&own.link, plan, count)?;
            zeros.push(zeros_on(&mesh, count, omega_rad_s.last().copied().unwrap_or_default()));
            links.push(mesh);
        }
    }
    let shapes = if wanted == Wanted::Tables {
        let nodes_m: Vec<_> = links.iter().map(|mesh| mesh.nodes_m().to_vec()).collect();
        let nodes: usize = nodes_m.iter().map(Vec::len).sum();
        check_shapes(3 * (modes.free.modes.len() + modes.held.modes.len()) * nodes)?;
        Some(modes.shapes(nodes_m))
    } else {
        None
    };
    let ArmModes { free, held, joint_stiffnesses_n_m_rad, .. } = modes;
    let setting = Setting::AtRest {
        directions_rad: modes.directions_rad,
        tip_m: modes.tip_m,
        holding_torques_n_m: modes.holding_torques_n_m,
    };
    Ok(ModesResult { setting, free, held, joint_stiffnesses_n_m_rad, zeros, meshes: links, shapes })
}

/// Modes of a straight link in one direction.
fn straight(
    (link, plan): (&Link, &MeshPlan),
    angle_rad: f64,
    count: usize,
    wanted: Wanted,
) -> Result<ModesResult, Failure> {
    let Some(gravity) = link.gravity() else {
        let message = "--at needs gravity, but the link file has none";
        let hint = "add it: --set 'gravity=[0, -9.81]'";
        return Err(Failure::new(Exit::Usage, &message, Some(hint)));
    };
    let is_resolved = plan.is_automatic() || wanted == Wanted::Tables;
    let exact = is_resolved.then(|| resolved(link, plan, count)).transpose()?;
    let highest = exact.as_ref().and_then(|(_, omega_rad_s)| omega_rad_s.last().copied());
    let highest_rad_s = highest.unwrap_or_default();
    let mut mesh = Mesh::new(link, plan)?;
    if plan.is_automatic() {
        mesh = mesh.resolving(highest_rad_s, POSE_TOLERANCE);
    }
    let most = MOST_ELEMENTS_OF_A_POSE / 2;
    let elements = mesh.elements().len();
    if elements > most {
        let message =
            format!("the mesh has {elements} elements, but must have at most {most} with weight");
        let hint = "ask for fewer modes: --count";
        return Err(Failure::new(Exit::NotSolvable, &message, Some(hint)));
    }
    let [along_x, along_y] = gravity.acceleration_m_s2;
    let (cos, sin) = (libm::cos(angle_rad), libm::sin(angle_rad));
    let outward_m_s2 = gravity.along_m_s2(angle_rad);
    let is_across = outward_m_s2.abs() <= ACROSS * (along_x.abs() + along_y.abs());
    let outward_m_s2 = if is_across { 0.0 } else { outward_m_s2 };
    let finer = mesh.refined();
    let settled = |hub: PoseHub, count| {
        let on = |mesh: &Mesh| {
            pose_modes(mesh, outward_m_s2, hub, count).ok_or_else(|| {
                let message = "a motion of the link moves no mass, but must with --at";
                let hint = "add mass to the segments and inertia to the hub";
                Failure::new(Exit::NotSolvable, &message, Some(hint))
            })
        };
        let (modes, on_halves) = (on(&mesh)?, on(&finer)?);
        let rates = |modes: &[(f64, Shape)]| -> Vec<f64> {
            modes.iter().map(|(square, _)| square.abs().sqrt()).collect()
        };
        let errors = mesh_errors(&mesh, &rates(&modes), &rates(&on_halves));
        let turn = if hub == PoseHub::Spring(f64::INFINITY) { 0.0 } else { 1.0 };
        let mode = |(square_per_s2, shape)| PoseMode {
            square_per_s2,
            damping_ratio: None,
            joints: vec![turn],
            shape: Vec::new(),
            of_link: Some(shape),
        };
        Ok::<_, Failure>(SettledModes { modes: modes.into_iter().map(mode).collect(), errors })
    };
    let spring_n_m_rad = link.joint_stiffness_n_m_rad();
    let mut free = settled(PoseHub::Free, count + 1)?;
    let held = settled(PoseHub::Spring(spring_n_m_rad), count)?;
    let slides = link.joint().slides();
    if slides {
        // Weight does not drive the motion of the whole link.
        let size = |mode: &PoseMode| mode.square_per_s2.abs();
        let modes = free.modes.iter().enumerate();
        let rigid = modes.min_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
        let rigid = rigid.map_or(0, |(number, _)| number);
        free.modes.remove(rigid);
        free.errors.remove(rigid);
    } else if is_across {
        // Nothing drives the swing; dense algebra leaves round-off.
        free.modes.iter_mut().take(1).for_each(|swing| swing.square_per_s2 = 0.0);
        free.errors.iter_mut().take(1).for_each(|error| *error = 0.0);
    }
    let (mut zeros, mut shapes) = (Vec::new(), None);
    if slides {
        // The link keeps its direction: its zeros are those with the weight.
        let [on_mesh, on_halves] = [&mesh, &finer].map(|mesh| {
            let highest_rad_s =
                free.modes.last().map_or(0.0, |mode| mode.square_per_s2.abs().sqrt());
            pose_zeros(mesh, outward_m_s2, count, highest_rad_s).unwrap_or_default()
        });
        let errors = |axis: usize| mesh_errors(&mesh, &on_mesh[axis], &on_halves[axis]);
        zeros.push(LinkZeros {
            mesh_errors: errors(0),
            blocked_mesh_errors: errors(1),
            blocked_hz: on_mesh[1].iter().map(|omega| omega / TAU).collect(),
            zeros_per_s: on_mesh[0].clone(),
        });
    } else if wanted == Wanted::Tables {
        zeros.extend(exact.iter().map(|(mesh, _)| zeros_on(mesh, count, highest_rad_s)));
    }
    if wanted == Wanted::Tables {
        shapes = Some(straight_shapes(&mesh, [cos, sin], [&free, &held])?);
    }
    Ok(ModesResult {
        setting: Setting::Straight { is_kept: slides, angle_rad, outward_m_s2 },
        held,
        free,
        joint_stiffnesses_n_m_rad: vec![spring_n_m_rad],
        zeros,
        meshes: vec![mesh],
        shapes,
    })
}

/// Shapes in the plane of a straight link with this cosine and sine of its direction, with a free and a held hub.
fn straight_shapes(
    mesh: &Mesh,
    [cos, sin]: [f64; 2],
    [free, held]: [&SettledModes; 2],
) -> Result<ArmShapes, Failure> {
    let nodes_m = mesh.nodes_m().to_vec();
    check_shapes(3 * (free.modes.len() + held.modes.len()) * nodes_m.len())?;
    let across = |shape: &Shape| {
        let nodes = (0..nodes_m.len()).map(|node| shape.total(mesh, node));
        vec![nodes.map(|own| [-sin * own[0], cos * own[0], own[1]]).collect()]
    };
    let moved = |own: &SettledModes| {
        own.modes.iter().filter_map(|mode| Some(across(mode.of_link.as_ref()?))).collect()
    };
    Ok(ArmShapes {
        rest_m: vec![nodes_m.iter().map(|x| [cos * x, sin * x]).collect()],
        free: moved(free),
        held: moved(held),
        nodes_m: vec![nodes_m.clone()],
    })
}

/// Modes and zeros of a link without gravity.
pub(super) fn level(
    (link, plan): (&Link, &MeshPlan),
    count: usize,
) -> Result<ModesResult, Failure> {
    let (mesh, omega_rad_s) = resolved(link, plan, count)?;
    let law = DampingLaw::of(link, &mesh)?;
    check_shapes(6 * omega_rad_s.len() * mesh.nodes_m().len())?;
    let finer = mesh.refined();
    let highest_rad_s = omega_rad_s.last().copied().unwrap_or_default();
    let settled = |hub: PoseHub, omega_rad_s: &[f64]| {
        let ratios = damping_ratios((link, &mesh, &law), hub, omega_rad_s);
        let modes = omega_rad_s.iter().zip(ratios).map(|(omega, ratio)| PoseMode {
            square_per_s2: omega * omega,
            damping_ratio: Some(ratio).filter(|ratio| !ratio.is_nan()),
            joints: Vec::new(),
            shape: Vec::new(),
            of_link: Some(mode(&mesh, *omega).shape),
        });
        let errors = mesh_errors(&mesh, omega_rad_s, &hub.frequencies(&finer, count));
        SettledModes { modes: modes.collect(), errors }
    };
    let spring_n_m_rad = link.joint_stiffness_n_m_rad();
    let held = PoseHub::Spring(spring_n_m_rad);
    Ok(ModesResult {
        setting: Setting::Weightless,
        free: settled(PoseHub::Free, &omega_rad_s),
        held: settled(held, &held.frequencies(&mesh, count)),
        joint_stiffnesses_n_m_rad: vec![spring_n_m_rad],
        zeros: vec![zeros_on(&mesh, count, highest_rad_s)],
        meshes: vec![mesh],
        shapes: None,
    })
}

/// Message of a link or an arm that falls from a pose with its hub, or joints, in a state.
pub(crate) fn falling(arm: &Arm, state: &str) -> String {
    let hub = arm.joint().worded("hub") + " is";
    let (what, joints) = arm.pick(("link", &*hub), ("arm", "joints are"));
    format!("the {what} falls from this pose if its {joints} {state}")
}

/// Warns of a pose that a link or an arm leaves with free joints, or even with held ones; returns the number of warnings.
fn warn_of_fall(arm: &Arm, [free, held]: [bool; 2]) -> usize {
    let warn = |state: &str, hint: &str| {
        let words = falling(arm, state) + ": it leaves it, and does not vibrate about it";
        console::warning(words, hint);
    };
    if held {
        warn("held", "use a stiffer link, or less mass at its tip: the weight buckles the link");
    } else if free {
        warn("free", "the table shows how fast; a controller that holds the pose changes this");
    }
    usize::from(free || held)
}

/// Refuses mode shapes of this many displacements if they exceed the memory.
fn check_shapes(displacements: usize) -> Result<(), Failure> {
    let bytes = displacements * BYTES_PER_DISPLACEMENT;
    memory::check("the mode shapes", bytes, None, "ask for fewer modes: --count")
}

/// Values on a mesh, and their errors.
fn with_errors(mesh: &Mesh, of: &dyn Fn(&Mesh) -> Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let values = of(mesh);
    let errors = mesh_errors(mesh, &values, &of(&mesh.refined()));
    (values, errors)
}

/// The first `count` zeros of a link, and the zeros at real frequencies below `highest_rad_s`.
fn zeros_on(mesh: &Mesh, count: usize, highest_rad_s: f64) -> LinkZeros {
    let (zeros_per_s, mesh_errors) = with_errors(mesh, &|mesh| torque_zeros(mesh, count));
    let (blocked, blocked_mesh_errors) =
        with_errors(mesh, &|mesh| real_frequency_zeros(mesh, highest_rad_s));
    let blocked_hz = blocked.iter().map(|omega| omega / TAU).collect();
    LinkZeros { zeros_per_s, mesh_errors, blocked_hz, blocked_mesh_errors }
}

/// Prints remarks and warnings; returns the number of warnings.
fn tell(Specification { arm, remarks, .. }: &Specification, found: &ModesResult) -> usize {
    console::remarks(remarks);
    let mut warnings = 0;
    if let ([one], [mesh], Setting::Weightless) = (arm.links(), &found.meshes[..], &found.setting) {
        let modes = found.free.modes.iter();
        let omega_rad_s: Vec<f64> = modes.map(|mode| mode.square_per_s2.sqrt()).collect();
        let on_modes = Remark::on_modes(&one.link, mesh, &omega_rad_s).into_iter();
        console::remarks(on_modes.map(|own| Notice::from(own).worded(arm)));
        if let Some(thick) = Thickness::known(&one.link).noticeable(mesh, &omega_rad_s) {
            console::warnings([Notice::from(thick).worded(arm)]);
            warnings += 1;
        }
    }
    let coarse = found.warnings(arm);
    warnings += coarse.len();
    console::warnings(coarse);
    let falls = [&found.free, &found.held].map(SettledModes::falls);
    let level = (found.setting == Setting::Weightless)
        .then(|| warn_of_gravity(&arm.links()[0].link, NO_DIRECTION));
    warnings + warn_of_fall(arm, falls) + level.unwrap_or_default()
}

/// The mesh for modes within the plan's tolerance, and their frequencies in rad/s: fewer than `count` if the link has
/// fewer, for example with massless parts.
fn resolved(link: &Link, plan: &MeshPlan, count: usize) -> Result<(Mesh, Vec<f64>), Failure> {
    let mut mesh = Mesh::new(link, plan)?;
    let mut frequencies = natural_frequencies(&mesh, count);
    if !plan.is_automatic() {
        return Ok((mesh, frequencies));
    }
    while frequencies.len() < count {
        let finer = mesh.refined();
        let more = natural_frequencies(&finer, count);
        if more.len() == frequencies.len() {
            break;
        }
        (mesh, frequencies) = (finer, more);
    }
    let highest = frequencies.last().copied().unwrap_or_default();
    let mesh = mesh.resolving(highest, plan.tolerance());
    let frequencies = natural_frequencies(&mesh, count);
    Ok((mesh, frequencies))
}
