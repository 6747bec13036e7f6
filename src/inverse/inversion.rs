use std::sync::{Arc, OnceLock};

use super::analysis::Analysis;
use super::dynamics::{Dynamics, KeptModes};
use super::error::InversionError;
use super::period::{Padding, PeriodicTorque, check_memory};
use super::refinement::{Measured, measured_mesh, peak_in_range};
use super::rigid::rigid_torque_n_m;
use super::solution::{Accuracy, Band, Solution, cut, hub_motion};
use super::spectra::{Forcing, HubSpectra};
use super::warning::{Evidence, warnings};
use crate::beam::{Mesh, MeshPlan};
use crate::link::Link;
use crate::modal::torque_zeros;
use crate::motion::{TipMotion, TipMotionHistories, TipPeriod};
use crate::numeric::{TimeGrid, largest_difference};

/// What is to be solved, the mesh and the period left open.
struct Problem<'a> {
    link: &'a Link,
    motion: &'a TipMotion,
    analysis: &'a Analysis,
    padding: Padding,
}

/// The answer over one period.
struct PeriodicAnswer {
    period: Arc<TipPeriod>,
    hub: HubSpectra,
    torque_n_m: Vec<f64>,
}

/// What is known of the mesh besides the answer on it.
#[derive(Clone, Copy)]
struct Known {
    mesh_error: f64,
    truncation_error: Option<f64>,
    first_zero_per_s: Option<f64>,
}

impl PeriodicAnswer {
    fn periodic(&self) -> PeriodicTorque<'_> {
        PeriodicTorque { samples: &self.torque_n_m, before: self.period.spectrum.seam }
    }
}

/// Finds the hub torque that makes the tip of `link` follow `motion` (Bayo 1987, eqs 13-21).
///
/// Each frequency of the motion is divided by the link's transfer from torque to tip, on a period
/// long enough for the torque to decay before and after the motion; the mesh is measured against
/// one of half the element length, and refined where the plan says so.
///
/// # Errors
/// [`InversionError`]: damping that cannot be, a torque that is not finite, an automatic mesh that
/// does not converge, or a window too long to transform or for the memory allowed.
pub fn invert(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<Solution, InversionError> {
    let mesh = Mesh::new(link, plan);
    Dynamics::check_size(link, 2 * mesh.elements().len(), 2)?;
    let coarsest = Dynamics::new(link, mesh, KeptModes::of(analysis))?;
    let first_zero_of = |mesh: &Mesh| torque_zeros(mesh, 1).first().copied();
    let (coarsest_elements, first_zero) =
        (coarsest.mesh().elements().len(), first_zero_of(coarsest.mesh()));
    let padding = Padding::new(motion, analysis, first_zero);
    let problem = Problem { link, motion, analysis, padding };
    let period = problem.shortest_period()?;
    let friction_n_m_s_rad = link.hub().viscous_friction_n_m_s_rad;
    let (dynamics, Measured { hub, torque_n_m, error }) =
        measured_mesh(coarsest, plan, friction_n_m_s_rad, &period.spectrum)?;
    let answer = problem.decayed(&dynamics, PeriodicAnswer { period, hub, torque_n_m })?;
    // Only of the mesh that answers: one that is refined, or measured against, may be far too coarse.
    if let Some(frequency_hz) = answer.hub.blocked_hz {
        return Err(InversionError::BlockedTip { frequency_hz });
    }
    let truncation_error = problem.truncation_error(&dynamics, &answer)?;
    let is_refined = dynamics.mesh().elements().len() > coarsest_elements;
    let first_zero_per_s = if is_refined { first_zero_of(dynamics.mesh()) } else { first_zero };
    let known = Known { mesh_error: error, truncation_error, first_zero_per_s };
    Ok(problem.written(dynamics, known, answer))
}

/// The torque in N m that another sampling of a motion asks of a solution's link, on the same mesh
/// and over the same window; the first sample stands at the window's start.
///
/// # Errors
/// As [`invert`].
pub fn torque_over_window(
    solution: &Solution,
    link: &Link,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<Vec<f64>, InversionError> {
    let first_zero = solution.first_zero_per_s;
    let padding = Padding::new(motion, analysis, first_zero);
    let problem = Problem { link, motion, analysis, padding };
    let shortest = problem.shortest_period()?;
    let answer = problem.answer(&solution.dynamics, shortest)?;
    let answer = problem.decayed(&solution.dynamics, answer)?;
    let (window, grid) = (&solution.grid, motion.grid());
    let first = ((window.time_s(0) - grid.time_s(0)) / grid.step_s).round() as i64;
    let len = (window.duration_s() / grid.step_s).round() as usize + 1;
    Ok(cut(&answer.torque_n_m, &TimeGrid { first, len, ..grid }))
}

impl Problem<'_> {
    fn shortest_period(&self) -> Result<Arc<TipPeriod>, InversionError> {
        self.period(self.padding.period_len(self.motion.grid().len)?)
    }

    fn period(&self, len: usize) -> Result<Arc<TipPeriod>, InversionError> {
        check_memory(len, self.analysis)?;
        Ok(self.motion.over_period(len, self.padding.seam(self.motion.grid().len, len)))
    }

    fn forcing<'a>(&self, dynamics: &'a Dynamics, period: &'a TipPeriod) -> Forcing<'a> {
        let friction_n_m_s_rad = self.link.hub().viscous_friction_n_m_s_rad;
        Forcing { dynamics, friction_n_m_s_rad, spectrum: &period.spectrum }
    }

    fn answer(
        &self,
        dynamics: &Dynamics,
        period: Arc<TipPeriod>,
    ) -> Result<PeriodicAnswer, InversionError> {
        let hub = self.forcing(dynamics, &period).hub_spectra()?;
        let torque_n_m = period.spectrum.pair.samples(&hub.torque_n_m);
        Ok(PeriodicAnswer { period, hub, torque_n_m })
    }

    /// Lengthens the period until the torque has decayed where one period meets the next.
    ///
    /// The zeros tell the exponential decay; hysteretic damping adds an algebraic tail (∝ t⁻⁴), and
    /// a blocked tip rings on, so the decay is measured, too.
    fn decayed(
        &self,
        dynamics: &Dynamics,
        shortest: PeriodicAnswer,
    ) -> Result<PeriodicAnswer, InversionError> {
        let initial = shortest.torque_n_m.len();
        let mut answer = shortest;
        loop {
            let torque = answer.periodic();
            let has_decayed = torque.at_seam() <= self.analysis.tolerance() * torque.peak();
            let next = Padding::lengthened(answer.torque_n_m.len(), initial);
            match next.filter(|_| !has_decayed) {
                Some(len) => answer = self.answer(dynamics, self.period(len)?)?,
                None => return Ok(answer),
            }
        }
    }

    /// What a reduction to few modes changes of the torque, over its peak; none for all modes.
    fn truncation_error(
        &self,
        dynamics: &Dynamics,
        answer: &PeriodicAnswer,
    ) -> Result<Option<f64>, InversionError> {
        if dynamics.kept_modes() == KeptModes::All {
            return Ok(None);
        }
        let all = dynamics.unreduced()?;
        let exact = self.forcing(&all, &answer.period).torque_n_m()?;
        Ok(Some(largest_difference(&exact, &answer.torque_n_m) / peak_in_range(&exact)?))
    }

    /// Cuts the window to write out of the period and gathers what is known of the answer.
    fn written(&self, dynamics: Dynamics, known: Known, answer: PeriodicAnswer) -> Solution {
        let Known { mesh_error, truncation_error, first_zero_per_s } = known;
        let given = self.motion.grid();
        let torque = answer.periodic();
        let peak = torque.peak();
        let window = torque.window(given.len, given.step_s, self.analysis, peak);
        let grid = TimeGrid { first: window.start, len: window.len(), ..given };
        let moving = self.motion.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let spectrum = Arc::clone(&answer.period.spectrum);
        let (histories, root_moment_n_m) = rayon::join(
            || answer.period.histories(self.motion),
            || cut(&spectrum.pair.samples(&answer.hub.root_moment_n_m), &grid),
        );
        let rigid_torque = rigid_torque_n_m(self.link, dynamics.law(), histories);
        let tip = TipMotionHistories {
            displacement_m: cut(&histories.displacement_m, &grid),
            velocity_m_s: cut(&histories.velocity_m_s, &grid),
            acceleration_m_s2: cut(&histories.acceleration_m_s2, &grid),
        };
        let per_length = 1.0 / dynamics.mesh().length_m();
        let hub_motion = |tip: &[f64], order: usize| {
            hub_motion(tip, (&spectrum, &answer.hub.excess_angle_rad, order), &grid, per_length)
        };
        let (hub_angle_rad, hub_rate_rad_s) =
            rayon::join(|| hub_motion(&tip.displacement_m, 0), || hub_motion(&tip.velocity_m_s, 1));
        let evidence = Evidence {
            motion: self.motion,
            tolerance: self.analysis.tolerance(),
            cut: torque.outside(&window) / peak,
            seam: torque.at_seam() / peak,
            mesh_error,
        };
        let edge_error = evidence.cut.max(evidence.seam);
        let accuracy = Accuracy { mesh_error, edge_error, truncation_error };
        let mut solution = Solution {
            torque_n_m: cut(&answer.torque_n_m, &grid),
            rigid_torque_n_m: cut(&rigid_torque, &grid),
            hub_angle_rad,
            hub_rate_rad_s,
            rigid_hub_angle_rad: tip.displacement_m.iter().map(|v| v * per_length).collect(),
            root_moment_n_m,
            tip,
            moving: (on_grid(moving.0), on_grid(moving.1)),
            first_zero_per_s,
            accuracy,
            band: Band::of(&spectrum),
            warnings: Vec::new(),
            grid,
            dynamics,
            torque_amplitudes_n_m: answer.hub.torque_n_m,
            excess_amplitudes_rad: answer.hub.excess_angle_rad,
            hub_acceleration_rad_s2: OnceLock::new(),
            spectrum,
            friction_n_m_s_rad: self.link.hub().viscous_friction_n_m_s_rad,
            drive: self.link.drive().copied(),
        };
        solution.warnings = warnings(&evidence, &solution);
        solution
    }
}
