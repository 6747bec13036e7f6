//! The state space that `modes` writes.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::beam::MeshPlan;
use crate::link::Arm;
use crate::modal::DampingLaw;
use crate::response::{ModeChoice, StateSpace, StateSpaceScope, arm_modes, link_state_space};
use crate::result::{ModesResult, Setting};
use crate::spec::Specification;
use crate::store::{StateSpaceFile, StateSpaceForm};
use crate::text::significant;

use crate::cli::options::common::{NodeArgs, metres};
use crate::cli::terminal::files::keep_inputs;
use crate::cli::terminal::{Exit, Failure, console, memory};

/// Bytes of one entry of a matrix, as computed and as written.
const ENTRY_BYTES: usize = 64;

/// A file of A, B, C, D, and what it contains.
#[derive(Debug, Args)]
pub(crate) struct StateSpaceArgs {
    /// Write A, B, C and D of the first --count modes with free joints, their M, K and C, and names and units of states,
    /// inputs and outputs: .npz for NumPy, .mat for MATLAB and Octave, .json.
    #[arg(long, value_name = "FILE")]
    pub(crate) state_space: Option<PathBuf>,

    /// Add the displacement at these distances from the axis in m, or with unit (`60cm`), to its outputs; for an arm
    /// from each link's joint. The mesh gets a node there.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = metres)]
    #[arg(allow_negative_numbers = true, requires = "state_space")]
    pub(crate) stations: Vec<f64>,

    /// Numbers of the modes in FILE, as in the table, up to --count [default: all of the table].
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "state_space")]
    modes: Vec<usize>,

    /// Put the static response of the modes left out into D. Without it D is 0, except that of an acceleration.
    #[arg(long, requires = "state_space")]
    pub(crate) residual: bool,
}

impl StateSpaceArgs {
    /// Returns an error if FILE has an ending without a form, or would replace the link file.
    pub(crate) fn check(&self, link: &Path) -> Result<(), Failure> {
        let Some(file) = &self.state_space else { return Ok(()) };
        if StateSpaceForm::of(file).is_none() {
            let message =
                format!("--state-space = {}, but must end in .npz, .mat or .json", file.display());
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        keep_inputs("--state-space", file, &[link])
    }

    /// Puts a node at each station into the meshes.
    pub(crate) fn mesh(&self, specification: &mut Specification) -> Result<(), Failure> {
        NodeArgs::at(self.stations.clone()).meshes(&specification.arm, &mut specification.meshes)
    }

    /// The state space of the file, if there is one.
    pub(crate) fn compute(
        &self,
        specification: &Specification,
        found: &ModesResult,
        modes: usize,
    ) -> Result<Option<Written>, Failure> {
        if self.state_space.is_none() {
            return Ok(None);
        }
        let stations_m = self.stations.clone();
        let modes = match &self.modes[..] {
            [] => ModeChoice::First(modes),
            numbers => {
                if let Some(number) = numbers.iter().find(|number| **number > modes) {
                    let message =
                        format!("--modes = {number}, but must be at most --count, {modes}");
                    let hint = "--count sets the modes that the mesh resolves, and the table";
                    return Err(Failure::new(Exit::Usage, &message, Some(hint)));
                }
                ModeChoice::Numbers(numbers.to_vec())
            }
        };
        let scope = StateSpaceScope { modes, stations_m, has_residual: self.residual };
        let space = state_space(specification, found, &scope)?;
        Ok(Some(Written { space, scope }))
    }

    /// Writes the file, and says what it contains.
    pub(crate) fn write(
        &self,
        arm: &Arm,
        found: &ModesResult,
        Written { space, scope }: &Written,
    ) -> Result<Option<String>, Failure> {
        let file = self.state_space.as_deref();
        let Some((file, form)) = file.and_then(|file| Some((file, StateSpaceForm::of(file)?)))
        else {
            return Ok(None);
        };
        let description = described(space, scope);
        let directions_rad = match &found.setting {
            Setting::Weightless => None,
            Setting::Straight { angle_rad, .. } => Some(std::slice::from_ref(angle_rad)),
            Setting::AtRest { directions_rad, .. } => Some(&directions_rad[..]),
        };
        let contents = StateSpaceFile {
            space,
            scope,
            title: arm.title(),
            directions_rad,
            description: &description,
        };
        console::deliver_by(Some(file), |out| contents.write(form, out))?;
        let count = |number: usize, of: &str| {
            format!("{number} {of}{}", if number == 1 { "" } else { "s" })
        };
        Ok(Some(format!(
            "{} has {}, {} and {}: {description}",
            file.display(),
            count(space.states.len(), "state"),
            count(space.inputs.len(), "input"),
            count(space.outputs.len(), "output"),
        )))
    }
}

/// A state space, and what it contains.
pub(crate) struct Written {
    space: StateSpace,
    scope: StateSpaceScope,
}

/// The state space of modes with free joints, in the setting and on the mesh of known modes.
pub(super) fn state_space(
    specification: &Specification,
    found: &ModesResult,
    scope: &StateSpaceScope,
) -> Result<StateSpace, Failure> {
    let space = any_state_space(specification, found, scope)?;
    if let ModeChoice::Numbers(numbers) = &scope.modes {
        let has = |number: &usize| space.numbers().any(|own| own == *number);
        if let Some(number) = numbers.iter().find(|number| !has(number)) {
            let message = format!("modes = {number}, but must be numbers of modes that there are");
            return Err(Failure::new(Exit::Usage, &message, Some("`modes` prints their numbers")));
        }
    }
    Ok(space)
}

fn any_state_space(
    Specification { arm, meshes, .. }: &Specification,
    found: &ModesResult,
    scope: &StateSpaceScope,
) -> Result<StateSpace, Failure> {
    let states = 2 * (scope.modes.count() + arm.links().len());
    let bytes = states.saturating_mul(states).saturating_mul(ENTRY_BYTES);
    memory::check("the state space", bytes, None, "ask for fewer modes: --count")?;
    let outward_m_s2 = match &found.setting {
        Setting::Weightless => None,
        Setting::Straight { is_kept: true, outward_m_s2, .. } => Some(*outward_m_s2),
        Setting::Straight { angle_rad, .. } => {
            return in_pose(arm, meshes, std::slice::from_ref(angle_rad), scope);
        }
        Setting::AtRest { directions_rad, .. } => {
            return in_pose(arm, meshes, directions_rad, scope);
        }
    };
    let (link, mesh) = (&arm.links()[0].link, &found.meshes[0]);
    let law = DampingLaw::of(link, mesh)?;
    if outward_m_s2.is_some() && law.is_modal() {
        let message =
            "the ratios of modal damping are those without weight, but the link has weight";
        let hint = "--set gravity=[0,0] leaves the weight out; any other damping keeps it";
        return Err(Failure::new(Exit::NotSolvable, &message, Some(hint)));
    }
    link_state_space((link, mesh, &law), outward_m_s2, scope).ok_or_else(|| {
        let message = "a motion of the link moves no mass, but must with weight";
        Failure::new(Exit::NotSolvable, &message, Some("add mass to the segments"))
    })
}

fn in_pose(
    arm: &Arm,
    meshes: &[MeshPlan],
    directions_rad: &[f64],
    scope: &StateSpaceScope,
) -> Result<StateSpace, Failure> {
    let tolerance = MeshPlan::smallest_tolerance(meshes);
    let modes = arm_modes(arm, directions_rad, scope.modes.count(), tolerance)?;
    Ok(modes.state_space(scope)?)
}

/// The modes, the others and the damping in words.
pub(super) fn described(space: &StateSpace, scope: &StateSpaceScope) -> String {
    let numbers: Vec<usize> = space.numbers().collect();
    let modes = match &numbers[..] {
        [first, .., last] if last - first == numbers.len() - 1 => {
            format!("modes {first} to {last}")
        }
        [own] => format!("mode {own}"),
        _ => {
            format!("modes {}", numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", "))
        }
    };
    let others = if scope.has_residual {
        "D has the static response of the others"
    } else {
        "D lacks the static response of the others"
    };
    let damping = space.hysteretic_difference.map(|share| {
        let percent = significant(100.0 * share, 2);
        format!(
            "; hysteretic damping is viscous with the ratio of each mode, which changes the \
             response of the tip by at most {percent} %"
        )
    });
    format!("{modes}; {others}{}", damping.unwrap_or_default())
}
