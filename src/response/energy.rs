use super::equations::Coordinate;
use super::simulation::Simulation;
use crate::modal::Shape;
use crate::numeric::{CubicSpline, SplineEnds, largest_difference};

/// Balance of energy at one time, in J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyBalance {
    /// Time in s.
    pub time_s: f64,
    /// Work of the motor since the start, ∫ T θ̇ dt.
    pub work_j: f64,
    /// Kinetic energy, element by element.
    pub kinetic_j: f64,
    /// Strain energy, element by element.
    pub strain_j: f64,
    /// Energy dissipated by damping and friction.
    pub dissipated_j: f64,
}

/// Balances over time, and the error of their integrals.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyAccount {
    /// The balances.
    pub balances: Vec<EnergyBalance>,
    /// Estimated error of the integrals of work and loss in J: a quarter of their change when every second
    /// sample is left out. A smooth power has an error of a sixteenth, one with kinks a larger one.
    pub quadrature_error_j: f64,
}

impl Simulation {
    /// The balance at `count` samples, the last one among them. The integral of the motor's absolute power
    /// between two of them is the same, so that few fall into a long rest.
    ///
    /// Work and dissipation are integrated over all samples by a cubic spline; the energies are
    /// those of the elements in the shape and rate that the modes add up to.
    pub fn energy(&self, count: usize) -> EnergyAccount {
        let motor: Vec<f64> =
            self.torque_n_m.iter().zip(&self.hub_rate_rad_s).map(|(t, rate)| t * rate).collect();
        let lost: Vec<f64> = (0..self.grid.len).map(|sample| self.loss_w(sample)).collect();
        let (work, dissipated) = (self.integral(&motor, 1), self.integral(&lost, 1));
        let last = self.grid.len - 1;
        let mut total = 0.0;
        let worked: Vec<f64> = motor
            .iter()
            .map(|power| {
                total += power.abs();
                total
            })
            .collect();
        let place = |k: usize| match k {
            k if k == count => last,
            k => worked.partition_point(|sum| *sum < total * k as f64 / count as f64),
        };
        let balance = |k: usize| {
            let sample = place(k);
            let (q, rate) = self.record.at(sample);
            let (shape, velocity) = (self.shape(q), self.shape(rate));
            EnergyBalance {
                time_s: self.grid.time_s(sample),
                work_j: work[sample],
                kinetic_j: 0.5 * velocity.mass_product(&self.mesh, &velocity),
                strain_j: 0.5 * shape.stiffness_product(&self.mesh, &shape),
                dissipated_j: dissipated[sample],
            }
        };
        let missing = |power: &[f64], integral: &[f64]| {
            if power.len() < 2 * CubicSpline::MIN_POINTS {
                // Too few samples to leave every second one out.
                return 0.0;
            }
            let every_second: Vec<f64> = integral.iter().copied().step_by(2).collect();
            largest_difference(&every_second, &self.integral(power, 2))
        };
        EnergyAccount {
            balances: (1..=count).map(balance).collect(),
            quadrature_error_j: 0.25 * (missing(&motor, &work) + missing(&lost, &dissipated)),
        }
    }

    /// Power that damping and friction dissipate at a sample in W.
    fn loss_w(&self, sample: usize) -> f64 {
        let rate = self.record.at(sample).1;
        let modes = rate.iter().zip(&self.equations.coordinates);
        let damped: f64 =
            modes.map(|(rate, Coordinate { rate_per_s, .. })| rate_per_s * rate * rate).sum();
        damped + self.equations.reaction.friction_n_m_s_rad * self.hub_rate_rad_s[sample].powi(2)
    }

    fn shape(&self, coordinates: &[f64]) -> Shape {
        Shape::sum(coordinates, &self.equations.shapes)
    }

    /// ∫ dt from the first to each `every`-th of the samples, by these alone.
    fn integral(&self, samples: &[f64], every: usize) -> Vec<f64> {
        let samples: Vec<f64> = samples.iter().copied().step_by(every).collect();
        let step_s = every as f64 * self.grid.step_s;
        let spline = CubicSpline::uniform(&samples, SplineEnds::NotAKnot);
        let pieces = samples
            .windows(2)
            .zip(spline.slopes().windows(2))
            .map(|(ends, slopes)| 0.5 * (ends[0] + ends[1]) + (slopes[0] - slopes[1]) / 12.0);
        let running = pieces.scan(0.0, |sum, piece| {
            *sum += piece * step_s;
            Some(*sum)
        });
        std::iter::once(0.0).chain(running).collect()
    }
}
