use super::analysis::Analysis;
use super::dynamics::{Dynamics, KeptModes};
use super::error::InversionError;
use super::period::{Padding, PeriodicTorque};
use super::refinement::{Measured, measured_mesh};
use super::rigid::rigid_torque_n_m;
use super::solution::{Accuracy, Band, Solution, cut};
use super::spectra::{Forcing, HubSpectra};
use super::warning::{Evidence, warnings};
use crate::beam::{Mesh, MeshPlan};
use crate::link::Link;
use crate::modal::{REPORTED_MODES, natural_frequencies, torque_zeros};
use crate::motion::{TipMotion, TipMotionHistories, TipSpectrum};
use crate::numeric::{TimeGrid, largest, largest_difference};

/// Zeros that a solution reports.
const REPORTED_ZEROS: usize = 3;

/// What is to be solved, the mesh and the period left open.
struct Problem<'a> {
    link: &'a Link,
    motion: &'a TipMotion,
    analysis: &'a Analysis,
    padding: Padding,
}

/// The answer over one period.
struct PeriodicAnswer {
    spectrum: TipSpectrum,
    hub: HubSpectra,
    torque_n_m: Vec<f64>,
}

impl PeriodicAnswer {
    fn periodic(&self) -> PeriodicTorque<'_> {
        PeriodicTorque { samples: &self.torque_n_m, before: self.spectrum.seam }
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
/// does not converge, or a window too long to transform.
pub fn invert(
    link: &Link,
    plan: &MeshPlan,
    motion: &TipMotion,
    analysis: &Analysis,
) -> Result<Solution, InversionError> {
    let mesh = Mesh::new(link, plan);
    Dynamics::check_size(link, 2 * mesh.elements().len(), 2)?;
    let coarsest = Dynamics::new(link, mesh, KeptModes::of(analysis))?;
    let first_zero = torque_zeros(coarsest.mesh(), 1).first().copied();
    let padding = Padding::new(motion, analysis, first_zero);
    let problem = Problem { link, motion, analysis, padding };
    let shortest = padding.period_len(motion.grid().len)?;
    let spectrum = problem.spectrum(shortest);
    let measured =
        measured_mesh(coarsest, plan, |link| problem.forcing(link, &spectrum).torque_n_m())?;
    let answer = problem.decayed(&measured.dynamics, spectrum)?;
    let truncation_error = problem.truncation_error(&measured.dynamics, &answer)?;
    Ok(problem.written(measured, truncation_error, answer))
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
    let first_zero = solution.zeros_per_s.first().copied();
    let padding = Padding::new(motion, analysis, first_zero);
    let problem = Problem { link, motion, analysis, padding };
    let spectrum = problem.spectrum(padding.period_len(motion.grid().len)?);
    let answer = problem.decayed(&solution.dynamics, spectrum)?;
    let (window, grid) = (&solution.grid, motion.grid());
    let first = ((window.time_s(0) - grid.time_s(0)) / grid.step_s).round() as i64;
    let len = (window.duration_s() / grid.step_s).round() as usize + 1;
    Ok(cut(&answer.torque_n_m, &TimeGrid { first, len, ..grid }))
}

impl Problem<'_> {
    fn spectrum(&self, len: usize) -> TipSpectrum {
        self.motion.spectrum(len, self.padding.seam(self.motion.grid().len, len))
    }

    fn forcing<'a>(&self, dynamics: &'a Dynamics, spectrum: &'a TipSpectrum) -> Forcing<'a> {
        let friction_n_m_s_rad = self.link.hub().viscous_friction_n_m_s_rad;
        Forcing { dynamics, friction_n_m_s_rad, spectrum }
    }

    fn answer(
        &self,
        dynamics: &Dynamics,
        spectrum: TipSpectrum,
    ) -> Result<PeriodicAnswer, InversionError> {
        let hub = self.forcing(dynamics, &spectrum).hub_spectra()?;
        let torque_n_m = spectrum.pair.samples(hub.torque_n_m.clone());
        Ok(PeriodicAnswer { spectrum, hub, torque_n_m })
    }

    /// Lengthens the period until the torque has decayed where one period meets the next.
    ///
    /// The zeros tell the exponential decay; hysteretic damping adds an algebraic tail (∝ t⁻⁴), and
    /// a blocked tip rings on, so the decay is measured, too.
    fn decayed(
        &self,
        dynamics: &Dynamics,
        shortest: TipSpectrum,
    ) -> Result<PeriodicAnswer, InversionError> {
        let initial = shortest.pair.len();
        let mut answer = self.answer(dynamics, shortest)?;
        loop {
            let torque = answer.periodic();
            let has_decayed = torque.at_seam() <= self.analysis.tolerance() * torque.peak();
            let next = Padding::lengthened(answer.torque_n_m.len(), initial);
            match next.filter(|_| !has_decayed) {
                Some(len) => answer = self.answer(dynamics, self.spectrum(len))?,
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
        let exact = self.forcing(&all, &answer.spectrum).torque_n_m()?;
        Ok(Some(largest_difference(&exact, &answer.torque_n_m) / largest(&exact)))
    }

    /// Cuts the window to write out of the period and gathers what is known of the answer.
    fn written(
        &self,
        measured: Measured,
        truncation_error: Option<f64>,
        answer: PeriodicAnswer,
    ) -> Solution {
        let Measured { dynamics, error: mesh_error } = measured;
        let given = self.motion.grid();
        let torque = answer.periodic();
        let peak = torque.peak();
        let window = torque.window(given.len, given.step_s, self.analysis, peak);
        let grid = TimeGrid { first: window.start, len: window.len(), ..given };
        let moving = self.motion.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let histories = self.motion.histories(&answer.spectrum);
        let rigid_torque = rigid_torque_n_m(self.link, dynamics.law(), &histories);
        let tip = TipMotionHistories {
            displacement_m: cut(&histories.displacement_m, &grid),
            velocity_m_s: cut(&histories.velocity_m_s, &grid),
            acceleration_m_s2: cut(&histories.acceleration_m_s2, &grid),
        };
        let [hub_angle_rad, hub_rate_rad_s, hub_acceleration_rad_s2] =
            hub_motion(&answer, &tip, &grid, dynamics.mesh().length_m());
        let evidence = Evidence {
            motion: self.motion,
            tolerance: self.analysis.tolerance(),
            cut: torque.outside(&window) / peak,
            seam: torque.at_seam() / peak,
            mesh_error,
        };
        let edge_error = evidence.cut.max(evidence.seam);
        let accuracy = Accuracy { mesh_error, edge_error, truncation_error };
        let length_m = dynamics.mesh().length_m();
        let mut solution = Solution {
            torque_n_m: cut(&answer.torque_n_m, &grid),
            rigid_torque_n_m: cut(&rigid_torque, &grid),
            hub_angle_rad,
            hub_rate_rad_s,
            hub_acceleration_rad_s2,
            rigid_hub_angle_rad: tip.displacement_m.iter().map(|v| v / length_m).collect(),
            root_moment_n_m: cut(
                &answer.spectrum.pair.samples(answer.hub.root_moment_n_m.clone()),
                &grid,
            ),
            tip,
            moving: (on_grid(moving.0), on_grid(moving.1)),
            natural_frequencies_rad_s: natural_frequencies(dynamics.mesh(), REPORTED_MODES),
            zeros_per_s: torque_zeros(dynamics.mesh(), REPORTED_ZEROS),
            accuracy,
            band: Band::of(&answer.spectrum),
            warnings: Vec::new(),
            grid,
            dynamics,
            torque_amplitudes_n_m: answer.hub.torque_n_m.clone(),
            spectrum: answer.spectrum,
            friction_n_m_s_rad: self.link.hub().viscous_friction_n_m_s_rad,
        };
        solution.warnings = warnings(&evidence, &solution, &answer.hub);
        solution
    }
}

/// Hub angle, rate and acceleration: those of the rigid link, `v_tip/L`, and what bending adds.
fn hub_motion(
    answer: &PeriodicAnswer,
    tip: &TipMotionHistories,
    grid: &TimeGrid,
    length_m: f64,
) -> [Vec<f64>; 3] {
    let rigid = [&tip.displacement_m, &tip.velocity_m_s, &tip.acceleration_m_s2];
    [0, 1, 2].map(|order| {
        let amplitudes = answer.spectrum.derivative(&answer.hub.excess_angle_rad, order);
        let excess = cut(&answer.spectrum.pair.samples(amplitudes), grid);
        rigid[order].iter().zip(excess).map(|(tip, excess)| tip / length_m + excess).collect()
    })
}
