use super::error::SimulationError;
use super::play::Play;
use super::selection::kept_modes;
use super::simulation::{Simulation, equations_on};
use super::stepper::Stepper;
use super::warning::SimulationWarning;
use crate::link::Link;
use crate::modal::DampingLaw;
use crate::numeric::largest;

/// Error above which a warning is given.
const COARSE: f64 = 1e-2;

/// Errors of a simulation by its mesh and its modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayError {
    /// Largest error of the tip's displacement, over its travel.
    pub tip: f64,
    /// Largest error of the hub angle, over its peak.
    pub hub_angle: f64,
}

impl PlayError {
    /// Plays the same torque on elements of half the length, with all modes that the torque moves
    /// there, and measures the change; where modes were cut, with twice as many.
    ///
    /// The error falls with the fourth power of the element length, so that the change is 15/16 of
    /// it. It takes about as long as the simulation, and no memory. `None` where such elements do not
    /// allow the damping law.
    ///
    /// # Errors
    /// As [`simulate`](super::simulate) of this simulation.
    pub fn of(
        simulation: &Simulation,
        link: &Link,
        play: &Play,
    ) -> Result<Option<Self>, SimulationError> {
        let mesh = simulation.mesh.refined();
        let Ok(law) = DampingLaw::of(link.damping(), &mesh) else { return Ok(None) };
        let most_modes = simulation.selection.most_modes_beyond();
        let (basis, _) = kept_modes(&mesh, simulation.band_rad_s, most_modes);
        let equations = equations_on(link, &mesh, &law, play, basis);
        let (driving, tips) = (play.driving()?, equations.tips(&mesh));
        let mut stepper = Stepper::new(&equations, simulation.grid.step_s);
        let (start_m, start_rad) = (simulation.tip.displacement_m[0], simulation.hub_angle_rad[0]);
        let (mut tip_m, mut hub_rad) = (0.0_f64, 0.0_f64);
        for sample in 0..simulation.grid.len {
            if sample > 0 {
                stepper.advance(&driving.after(sample - 1));
            }
            let q = stepper.coordinates();
            let tip: f64 = q.iter().zip(&tips).map(|(q, tip)| q * tip).sum();
            let moved_m = simulation.tip.displacement_m[sample] - start_m;
            let turned_rad = simulation.hub_angle_rad[sample] - start_rad;
            tip_m = tip_m.max((tip - moved_m).abs());
            hub_rad = hub_rad.max((equations.hub(&q) - turned_rad).abs());
        }
        let turned: Vec<f64> = simulation.hub_angle_rad.iter().map(|a| a - start_rad).collect();
        let share = |error: f64, whole: f64| if error == 0.0 { 0.0 } else { error / whole };
        Ok(Some(Self {
            tip: 16.0 / 15.0 * share(tip_m, simulation.tip.largest_travel_m()),
            hub_angle: 16.0 / 15.0 * share(hub_rad, largest(&turned)),
        }))
    }

    /// A warning if the errors are large.
    pub fn warning(&self) -> Option<SimulationWarning> {
        let Self { tip, hub_angle } = *self;
        (tip.max(hub_angle) > COARSE).then_some(SimulationWarning::CoarseMesh { tip, hub_angle })
    }
}
