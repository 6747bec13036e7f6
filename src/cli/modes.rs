//! `modes`: natural frequencies, mode shapes and zeros.

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::Args;

use flexlink::beam::{Mesh, MeshPlan};
use flexlink::csv::Digits;
use flexlink::link::Link;
use flexlink::modal::{
    DampingLaw, MOST_ELEMENTS_OF_A_POSE, PoseHub, Thickness, held_frequencies, mode,
    natural_frequencies, pose_squares, real_frequency_zeros, torque_zeros,
};
use flexlink::response::damping_ratios;
use flexlink::result::{
    CoarseMesh, HeldModes, LinkZeros, ModesResult, PoseModes, PoseSquares, Remark, mesh_errors,
};
use flexlink::spec::{ArmSpecification, Described, Specification};
use flexlink::store::{arm_modes_json, modes_json, pose_modes_json, write_arm_modes};

use super::arm_pose::{ArmInPose, COARSE, is_unstable, warn_of_fall};
use crate::options::common::{SyncArgs, angle_rad};
use crate::options::inputs::{LinkArgs, warn_of_gravity};
use crate::terminal::files::check_folder;
use crate::terminal::text::{arm_modes_text, modes_text, pose_text};
use crate::terminal::{Exit, Failure, StageBar, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink modes link.toml --count 5 -o out
  flexlink modes hanging.toml --at '-90 deg'
  flexlink modes arm.toml --at '30 deg,75 deg' -o out";

/// Error of an automatic mesh in the modes of a pose. They are computed by dense algebra, whose round-off grows with the
/// fourth power of the number of elements.
const POSE_TOLERANCE: f64 = 1e-5;

/// Gravity along the link over all of it that counts as none.
const ACROSS: f64 = 1e-12;

/// Memory in bytes that a node takes in a shape: as computed, and as it is written.
const BYTES_PER_DISPLACEMENT: usize = 16;

/// Natural frequencies, mode shapes and zeros of a link.
///
/// Prints tables; with -o, writes modes.csv, mode_shapes.csv, zeros.csv and held_modes.csv into a folder. Modes are
/// those of a hub that is free to turn, and, without shapes, of a hub that is held; shapes are mass-normalised and
/// positive at the tip. Zeros are those of
/// the transfer from hub torque to tip: they set how long before the tip the torque must start. An
/// automatic mesh is refined until the frequencies are exact to mesh.tolerance. The mesh error of each
/// number is measured on elements of half the length; above 1 % there is a warning. Damping ratios are those of
/// the complex modes: the damping of the link, friction of its hub and the spring of its joint together.
///
/// Of a link file with a [drive] the rotor is held, not the hub: the hub is then on the joint's spring or, if the joint is
/// stiff, clamped.
///
/// Gravity changes frequencies with the direction of the link: --at gives those of one direction, hub free and
/// held, by the weight that pulls along the straight link.
///
/// For an arm of several links --at is needed, with a direction for each: the frequencies are those of small motions about
/// the arm's shape at rest there, bent by its weight, all joints free and all rotors held; the zeros are those of each
/// link. The bending of the links is refined until the frequencies are exact to mesh.tolerance. With -o, held_modes.csv
/// has the rotors held, and mode_shapes.csv x and y of each node, at rest and moved by the modes with free joints,
/// mass-normalised and with the joint that turns most turning counterclockwise.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Modes {
    #[command(flatten)]
    link: LinkArgs,

    /// How many modes and zeros, at most 1000.
    #[arg(long, value_name = "N", default_value_t = 10)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    count: u16,

    /// The frequencies with gravity where the link points this way: an angle in rad, or with its unit, as
    /// in '-90 deg'. For an arm the directions of all its links, from joint to joint, the inner one first.
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

    /// Print modes and zeros as JSON instead of the table.
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    warnings: WarningArgs,

    #[command(flatten)]
    sync: SyncArgs,
}

impl Modes {
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.output.as_deref().map_or(Ok(()), |folder| check_folder("--output", folder))?;
        let specification = match self.link.described()? {
            Described::Link(own) => own,
            Described::Arm(arm) => {
                let pose = ArmInPose::of(arm, self.at.as_deref())?;
                return self.warnings.refuse(self.tell_arm(&pose)?);
            }
        };
        match self.at.as_deref() {
            None => {}
            Some(_) if self.output.is_some() => {
                let message = "--output with --at is for an arm of several links";
                return Err(Failure::new(Exit::Usage, &message, Some("--json has all numbers")));
            }
            Some([angle_rad]) => return self.tell_pose(&specification, *angle_rad),
            Some(more) => {
                let message = format!("--at = {} angles, but must be one for one link", more.len());
                return Err(Failure::new(Exit::Usage, &message, None));
            }
        }
        let bar = StageBar::new();
        bar.at("finding modes and zeros");
        let (mesh, result) = computed(&specification, usize::from(self.count))?;
        drop(bar);
        if let Some(folder) = &self.output {
            result.write(self.sync.stage(folder)?, self.digits)?;
        }
        let warnings = tell(&specification, &mesh, &result);
        let text = if self.json {
            modes_json(&result)
        } else {
            modes_text(&specification.link, &mesh, &result)
        };
        console::print(&text)?;
        self.warnings.refuse(warnings)
    }

    /// Prints modes of an arm and zeros of its links; returns the number of warnings.
    fn tell_arm(&self, pose: &ArmInPose) -> Result<usize, Failure> {
        let ArmSpecification { arm, meshes, remarks, .. } = &*pose.specification;
        let count = usize::from(self.count);
        let bar = StageBar::new();
        bar.at("finding the modes");
        let modes = pose.modes(count)?;
        bar.at("finding the zeros");
        let zeros = arm.links().iter().zip(meshes).map(|(own, plan)| {
            let (mesh, omega_rad_s) = resolved(&own.link, plan, count)?;
            let zeros = zeros_on(&mesh, count, omega_rad_s.last().copied().unwrap_or_default());
            Ok((zeros, mesh.nodes_m().to_vec()))
        });
        let zeros = zeros.collect::<Result<Vec<(LinkZeros, Vec<f64>)>, Failure>>()?;
        drop(bar);
        let (zeros, nodes_m): (Vec<_>, Vec<_>) = zeros.into_iter().unzip();
        if let Some(folder) = &self.output {
            let nodes: usize = nodes_m.iter().map(Vec::len).sum();
            check_shapes(2 * modes.free.modes.len() * nodes)?;
            let shapes = modes.shapes(nodes_m);
            write_arm_modes(self.sync.stage(folder)?, (&modes, &shapes, &zeros), self.digits)?;
        }
        console::remarks(remarks);
        let falls = [&modes.free, &modes.held]
            .map(|own| is_unstable(own.modes.iter().map(|mode| mode.square_per_s2)));
        let mut warnings = warn_of_fall(falls, ["arm", "joints"]);
        for (what, found) in [("joints free", &modes.free), ("rotors held", &modes.held)] {
            if let Some(first) =
                found.errors.iter().position(|error| error.is_nan() || *error > COARSE)
            {
                let words = format!(
                    "{what}: from mode {} on frequencies are wrong by more than 1 %",
                    first + 1
                );
                console::warning(words, "ask for fewer modes: --count");
                warnings += 1;
            }
        }
        for (link, own) in zeros.iter().enumerate() {
            for warning in own.warnings() {
                console::warning(format!("{}: {warning}", arm.name_of(link)), warning.hint());
                warnings += 1;
            }
        }
        let text = if self.json {
            arm_modes_json(&modes, &zeros)
        } else {
            arm_modes_text(arm, &modes, &zeros)
        };
        console::print(&text)?;
        Ok(warnings)
    }

    /// Prints the modes in a pose.
    fn tell_pose(&self, specification: &Specification, angle_rad: f64) -> Result<(), Failure> {
        let (mesh, pose) = in_pose(specification, angle_rad, usize::from(self.count))?;
        console::remarks(&specification.remarks);
        let lists = [("mode", &pose.free), ("mode with the hub held", &pose.held)];
        let coarse = lists.map(|(what, found)| CoarseMesh::of(what, &found.mesh_errors));
        let coarse: Vec<_> = coarse.into_iter().flatten().collect();
        console::warnings(&coarse);
        let falls = lists.map(|(_, found)| is_unstable(found.squares_per_s2.iter().copied()));
        let warnings = coarse.len() + warn_of_fall(falls, ["link", "hub"]);
        let text = if self.json {
            pose_modes_json(&pose)
        } else {
            pose_text(&specification.link, &mesh, &pose)
        };
        console::print(&text)?;
        self.warnings.refuse(warnings)
    }
}

/// The mesh, and the modes on it where the link points in a direction.
pub(crate) fn in_pose(
    specification: &Specification,
    angle_rad: f64,
    count: usize,
) -> Result<(Mesh, PoseModes), Failure> {
    let link = &specification.link;
    let Some(gravity) = link.gravity() else {
        let message = "--at = an angle, but the link file has no gravity";
        return Err(Failure::new(
            Exit::Usage,
            &message,
            Some("give it as --set 'gravity=[0, -9.81]'"),
        ));
    };
    let mut mesh = Mesh::new(link, &specification.mesh)?;
    if specification.mesh.is_automatic() {
        let (_, omega_rad_s) = resolved(link, &specification.mesh, count)?;
        mesh = mesh.resolving(omega_rad_s.last().copied().unwrap_or_default(), POSE_TOLERANCE);
    }
    let most = MOST_ELEMENTS_OF_A_POSE / 2;
    let elements = mesh.elements().len();
    if elements > most {
        let message =
            format!("the mesh has {elements} elements, but must have at most {most} for --at");
        return Err(Failure::new(
            Exit::NotSolvable,
            &message,
            Some("ask for fewer modes: --count"),
        ));
    }
    let [along_x, along_y] = gravity.acceleration_m_s2;
    let outward_m_s2 = along_x * libm::cos(angle_rad) + along_y * libm::sin(angle_rad);
    let is_across = outward_m_s2.abs() <= ACROSS * (along_x.abs() + along_y.abs());
    let outward_m_s2 = if is_across { 0.0 } else { outward_m_s2 };
    let finer = mesh.refined();
    let found = |hub, count| {
        let on = |mesh: &Mesh| {
            pose_squares(mesh, outward_m_s2, hub, count).ok_or_else(|| {
                let message = "a motion of the link moves no mass, but must move some for --at";
                Failure::new(
                    Exit::NotSolvable,
                    &message,
                    Some("give the segments and the hub mass"),
                )
            })
        };
        Ok::<_, Failure>(PoseSquares::of(&mesh, on(&mesh)?, &on(&finer)?))
    };
    let (free, held) =
        (found(PoseHub::Free, count + 1)?, found(PoseHub::Spring(held_by(link)), count)?);
    let free = if is_across { free.with_neutral_swing() } else { free };
    Ok((mesh, PoseModes { angle_rad, outward_m_s2, free, held }))
}

/// The mesh, and its modes and zeros with their mesh errors.
pub(crate) fn computed(
    specification: &Specification,
    count: usize,
) -> Result<(Mesh, ModesResult), Failure> {
    let link = &specification.link;
    let (mesh, omega_rad_s) = resolved(link, &specification.mesh, count)?;
    let law = DampingLaw::of(link, &mesh)?;
    check_shapes(omega_rad_s.len() * mesh.nodes_m().len())?;
    let finer = mesh.refined();
    let highest = omega_rad_s.last().copied().unwrap_or_default();
    let joint_stiffness_n_m_rad = held_by(link);
    let (held_rad_s, held_errors) =
        with_errors(&mesh, &|mesh| held_frequencies(mesh, joint_stiffness_n_m_rad, count));
    let ratios = |hub, omegas: &[f64]| damping_ratios((link, &mesh, &law), hub, omegas);
    let held = HeldModes {
        joint_stiffness_n_m_rad,
        damping_ratios: ratios(PoseHub::Spring(joint_stiffness_n_m_rad), &held_rad_s),
        omega_rad_s: held_rad_s,
        mesh_errors: held_errors,
    };
    let result = ModesResult {
        damping_ratios: ratios(PoseHub::Free, &omega_rad_s),
        mesh_errors: mesh_errors(&mesh, &omega_rad_s, &natural_frequencies(&finer, count)),
        zeros: zeros_on(&mesh, count, highest),
        nodes_m: mesh.nodes_m().to_vec(),
        shapes: omega_rad_s.iter().map(|omega| shape(&mesh, *omega)).collect(),
        omega_rad_s,
        held,
    };
    Ok((mesh, result))
}

/// Stiffness in N m/rad of what is between the hub and what holds it.
fn held_by(link: &Link) -> f64 {
    link.drive().map_or(f64::INFINITY, |drive| drive.joint_stiffness_n_m_rad)
}

/// Refuses mode shapes of so many displacements that they do not fit into the memory.
fn check_shapes(displacements: usize) -> Result<(), Failure> {
    let bytes = displacements * BYTES_PER_DISPLACEMENT;
    memory::check("the mode shapes", bytes, None, "ask for fewer modes: --count")
}

/// Values on a mesh, and what it is wrong by.
fn with_errors(mesh: &Mesh, of: &dyn Fn(&Mesh) -> Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let values = of(mesh);
    let errors = mesh_errors(mesh, &values, &of(&mesh.refined()));
    (values, errors)
}

/// The first `count` zeros of a link, and those at real frequencies below `highest_rad_s`.
fn zeros_on(mesh: &Mesh, count: usize, highest_rad_s: f64) -> LinkZeros {
    let (zeros_per_s, mesh_errors) = with_errors(mesh, &|mesh| torque_zeros(mesh, count));
    let (blocked, blocked_mesh_errors) =
        with_errors(mesh, &|mesh| real_frequency_zeros(mesh, highest_rad_s));
    let blocked_hz = blocked.iter().map(|omega| omega / TAU).collect();
    LinkZeros { zeros_per_s, mesh_errors, blocked_hz, blocked_mesh_errors }
}

/// Prints remarks and warnings; returns the number of warnings.
fn tell(specification: &Specification, mesh: &Mesh, result: &ModesResult) -> usize {
    let link = &specification.link;
    console::remarks(&specification.remarks);
    console::remarks(Remark::on_modes(link, mesh, &result.omega_rad_s));
    let thick = Thickness::known(link).noticeable(mesh, &result.omega_rad_s);
    if let Some(thick) = &thick {
        console::warning(thick, thick.hint());
    }
    let coarse = result.warnings();
    console::warnings(&coarse);
    usize::from(thick.is_some()) + coarse.len() + warn_of_gravity(link)
}

/// Displacements of all nodes in a mode.
fn shape(mesh: &Mesh, omega_rad_s: f64) -> Vec<f64> {
    mode(mesh, omega_rad_s).shape.displacements(mesh)
}

/// The mesh on which the modes are exact to the plan's tolerance, and their frequencies in rad/s:
/// fewer than `count` where the link has fewer, as massless ones may.
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
