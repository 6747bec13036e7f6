use super::analysis::Analysis;
use super::error::InversionError;
use super::law::DampingLaw;
use super::period::{Padding, PeriodicTorque};
use super::refinement::measured_mesh;
use super::rigid::rigid_torque_n_m;
use super::solution::{Accuracy, Band, Solution, TipMotionHistories, cut};
use super::spectra::{Forcing, HubSpectra};
use super::warning::{Evidence, warnings};
use crate::beam::{Mesh, MeshPlan};
use crate::link::Link;
use crate::modal::{natural_frequencies, torque_zeros};
use crate::motion::{TipMotion, TipSpectrum};
use crate::numeric::TimeGrid;

/// Natural frequencies that a solution reports.
const REPORTED_MODES: usize = 5;

/// Zeros that a solution reports.
const REPORTED_ZEROS: usize = 3;

/// What is to be solved, the mesh and the period left open.
struct Problem<'a> {
    link: &'a Link,
    motion: &'a TipMotion,
    analysis: &'a Analysis,
    law: DampingLaw,
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
    let coarsest = Mesh::new(link, plan);
    let law = DampingLaw::of(link.damping(), &coarsest)?;
    let first_zero = torque_zeros(&coarsest, 1).first().copied();
    let padding = Padding::new(motion, analysis, first_zero);
    let problem = Problem { link, motion, analysis, law, padding };
    let shortest = padding.period_len(motion.grid().len)?;
    let spectrum = problem.spectrum(shortest);
    let measured =
        measured_mesh(coarsest, plan, |mesh| problem.forcing(mesh, &spectrum).torque_n_m())?;
    let answer = problem.decayed(&measured.mesh, spectrum)?;
    Ok(problem.written(measured.mesh, measured.error, answer))
}

impl Problem<'_> {
    fn spectrum(&self, len: usize) -> TipSpectrum {
        self.motion.spectrum(len, self.padding.seam(self.motion.grid().len, len))
    }

    fn forcing<'a>(&self, mesh: &'a Mesh, spectrum: &'a TipSpectrum) -> Forcing<'a> {
        let friction_n_m_s_rad = self.link.hub().viscous_friction_n_m_s_rad;
        Forcing { mesh, law: self.law, friction_n_m_s_rad, spectrum }
    }

    fn answer(&self, mesh: &Mesh, spectrum: TipSpectrum) -> Result<PeriodicAnswer, InversionError> {
        let hub = self.forcing(mesh, &spectrum).hub_spectra()?;
        let torque_n_m = spectrum.pair.samples(hub.torque_n_m.clone());
        Ok(PeriodicAnswer { spectrum, hub, torque_n_m })
    }

    /// Lengthens the period until the torque has decayed where one period meets the next.
    ///
    /// The zeros tell the exponential decay; hysteretic damping adds an algebraic tail (∝ t⁻⁴), and
    /// a blocked tip rings on, so the decay is measured, too.
    fn decayed(
        &self,
        mesh: &Mesh,
        shortest: TipSpectrum,
    ) -> Result<PeriodicAnswer, InversionError> {
        let initial = shortest.pair.len();
        let mut answer = self.answer(mesh, shortest)?;
        loop {
            let torque = answer.periodic();
            let has_decayed = torque.at_seam() <= self.analysis.tolerance() * torque.peak();
            let next = Padding::lengthened(answer.torque_n_m.len(), initial);
            match next.filter(|_| !has_decayed) {
                Some(len) => answer = self.answer(mesh, self.spectrum(len))?,
                None => return Ok(answer),
            }
        }
    }

    /// Cuts the window to write out of the period and gathers what is known of the answer.
    fn written(&self, mesh: Mesh, mesh_error: f64, answer: PeriodicAnswer) -> Solution {
        let given = self.motion.grid();
        let torque = answer.periodic();
        let peak = torque.peak();
        let window = torque.window(given.len, given.step_s, self.analysis, peak);
        let grid = TimeGrid { first: window.start, len: window.len(), ..given };
        let moving = self.motion.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let histories = self.motion.histories(&answer.spectrum);
        let rigid_torque = rigid_torque_n_m(self.link, self.law, &histories);
        let tip = TipMotionHistories {
            displacement_m: cut(&histories.displacement_m, &grid),
            velocity_m_s: cut(&histories.velocity_m_s, &grid),
            acceleration_m_s2: cut(&histories.acceleration_m_s2, &grid),
        };
        let [hub_angle_rad, hub_rate_rad_s, hub_acceleration_rad_s2] =
            hub_motion(&answer, &tip, &grid, mesh.length_m());
        let evidence = Evidence {
            motion: self.motion,
            tolerance: self.analysis.tolerance(),
            cut: torque.outside(&window) / peak,
            seam: torque.at_seam() / peak,
            mesh_error,
        };
        let accuracy = Accuracy { mesh_error, edge_error: evidence.cut.max(evidence.seam) };
        let mut solution = Solution {
            torque_n_m: cut(&answer.torque_n_m, &grid),
            rigid_torque_n_m: cut(&rigid_torque, &grid),
            hub_angle_rad,
            hub_rate_rad_s,
            hub_acceleration_rad_s2,
            rigid_hub_angle_rad: tip.displacement_m.iter().map(|v| v / mesh.length_m()).collect(),
            root_moment_n_m: cut(
                &answer.spectrum.pair.samples(answer.hub.root_moment_n_m.clone()),
                &grid,
            ),
            tip,
            moving: (on_grid(moving.0), on_grid(moving.1)),
            law: self.law,
            natural_frequencies_rad_s: natural_frequencies(&mesh, REPORTED_MODES),
            zeros_per_s: torque_zeros(&mesh, REPORTED_ZEROS),
            accuracy,
            band: Band::of(&answer.spectrum),
            warnings: Vec::new(),
            grid,
            mesh,
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
