use super::equations::Equations;
use super::play::Driving;
use super::stepper::Stepper;
use crate::beam::Mesh;
use crate::numeric::TimeGrid;

/// Modal coordinates and their rates at every sample, one row a sample.
#[derive(Debug, Clone)]
pub(super) struct Record {
    pub(super) coordinates: Vec<f64>,
    rates: Vec<f64>,
    modes: usize,
}

impl Record {
    /// Steps from rest through all samples.
    pub(super) fn of(equations: &Equations, driving: &Driving, grid: &TimeGrid) -> Self {
        let modes = equations.coordinates.len();
        let mut stepper = Stepper::new(equations, grid.step_s);
        let mut coordinates = Vec::with_capacity(grid.len * modes);
        let mut rates = Vec::with_capacity(grid.len * modes);
        for sample in 0..grid.len {
            if sample > 0 {
                stepper.advance(&driving.after(sample - 1));
            }
            coordinates.extend(stepper.coordinates());
            rates.extend(stepper.rates());
        }
        Self { coordinates, rates, modes }
    }

    /// Coordinates and rates at a sample.
    pub(super) fn at(&self, sample: usize) -> (&[f64], &[f64]) {
        let row = sample * self.modes..(sample + 1) * self.modes;
        (&self.coordinates[row.clone()], &self.rates[row])
    }

    /// Torque of the motor in N m; angle, rate and acceleration of the hub in rad, rad/s and rad/s²;
    /// displacement, velocity and acceleration of the tip in m, m/s and m/s².
    pub(super) fn observed(
        &self,
        equations: &Equations,
        mesh: &Mesh,
        driving: &Driving,
        initial_tip_m: f64,
    ) -> [Vec<f64>; 7] {
        let tips = equations.tips(mesh);
        let tip = |q: &[f64]| -> f64 { q.iter().zip(&tips).map(|(q, tip)| q * tip).sum() };
        let initial_angle = initial_tip_m / mesh.length_m();
        let samples = self.coordinates.len() / self.modes;
        let mut columns = [(); 7].map(|()| Vec::with_capacity(samples));
        for sample in 0..samples {
            let (q, rate) = self.at(sample);
            let input = driving.at(sample);
            let acceleration = equations.accelerations(q, rate, input);
            let (angle, hub_rate) = (equations.hub(q), equations.hub(rate));
            // Friction acts on the hub; the rest of the reaction is the motor's.
            let reaction = equations.reaction;
            let of_motor =
                reaction.torque_n_m(angle, hub_rate) - reaction.friction_n_m_s_rad * hub_rate;
            let row = [
                input - of_motor,
                initial_angle + angle,
                hub_rate,
                equations.hub(&acceleration),
                initial_tip_m + tip(q),
                tip(rate),
                tip(&acceleration),
            ];
            for (column, value) in columns.iter_mut().zip(row) {
                column.push(value);
            }
        }
        columns
    }
}
