//! Numbers by which a simulation is verified: its balance of energy, and the tip of its modes under other
//! torques or hysteretic damping.

use num_complex::Complex64;

use super::modes::{Coordinate, Equations, HubReaction};
use super::play::{Interpolation, pieces};
use super::simulation::Simulation;
use super::stepper::Stepper;
use crate::modal::Shape;
use crate::numeric::{
    CubicSpline, FourierPair, SplineEnds, angular_frequency, fast_length, largest_difference,
};

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
        let balance = |k: usize| {
            let reached = |sum: &f64| *sum < total * k as f64 / count as f64;
            let sample = if k == count { last } else { worked.partition_point(reached) };
            let (q, rate) = self.record.at(sample);
            let [shape, velocity] = [q, rate].map(|own| Shape::sum(own, &self.equations.shapes));
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
        self.equations.damped_w(rate)
            + self.equations.reaction.friction_n_m_s_rad * self.hub_rate_rad_s[sample].powi(2)
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

impl Simulation {
    /// Tip displacement in m under a torque that follows straight lines between its samples, which begin
    /// with those of this simulation; friction and feedback act as in it.
    pub fn straight_tip_m(&self, torque_n_m: &[f64]) -> Vec<f64> {
        let mut tip_m = Vec::with_capacity(torque_n_m.len());
        let lines = pieces(torque_n_m, Interpolation::Linear);
        Stepper::new(&self.equations, self.grid.step_s).run(lines, |stepper| {
            tip_m.push(self.initial_tip_m + self.equations.tip(&stepper.coordinates()));
        });
        tip_m
    }

    /// Tip displacement in m of the same link with hysteretic damping ξ under a torque on the link, friction
    /// already taken off, at the samples of this simulation.
    ///
    /// Hysteretic damping has no equation in time. Each mode's response is computed over frequency, on a
    /// period of twice the simulation's length; the rigid rotation is integrated in time:
    ///
    /// ```text
    /// q̂_k = p_k T̂/(ω_k²(1 + 2iξ) − ω²)                        (Bayo 1987, eqs 15 and 16, mode by mode)
    /// ```
    pub fn hysteretic_tip_m(&self, ratio: f64, net_torque_n_m: &[f64]) -> Vec<f64> {
        let kappa = Complex64::new(1.0, 2.0 * ratio);
        let coordinates = &self.equations.coordinates;
        let bending = self.filtered(net_torque_n_m, |omega, torque| {
            let answers = coordinates[1..]
                .iter()
                .map(|mode| mode.tip * mode.hub_angle / (mode.square * kappa - omega * omega));
            answers.sum::<Complex64>() * torque
        });
        let rigid = self.rigid_rotation(net_torque_n_m);
        let moved = rigid.iter().zip(bending).map(|(q, bent)| q * coordinates[0].tip + bent);
        moved.map(|v| self.initial_tip_m + v).collect()
    }

    /// Difference in m between the tip of this link, damped viscously mode by mode, and a tip motion with
    /// these accelerations, under the torque that gives the same link with hysteretic damping ξ this motion.
    ///
    /// With X the tip's and Y the hub's acceleration per torque on the link, both sums over modes, and the
    /// hub's friction b:
    ///
    /// ```text
    /// v̂_viscous/v̂_hysteretic = X_v (iω + bY_h)/(X_h (iω + bY_v)),   X = Σ −ω² v_k p_k/D_k(ω)
    /// D_h = ω_k²(1 + 2iξ) − ω²,   D_v = ω_k² + iω 2ξω_k − ω²        (Bayo 1987, eqs 12 and 16)
    /// ```
    pub fn apart_m(&self, ratio: f64, tip_acceleration_m_s2: &[f64]) -> Vec<f64> {
        let friction = self.equations.reaction.damping_n_m_s_rad;
        let kappa = Complex64::new(1.0, 2.0 * ratio);
        self.filtered(tip_acceleration_m_s2, |omega, acceleration| {
            if omega == 0.0 {
                // The acceleration of a motion from rest to rest has no mean.
                return Complex64::ZERO;
            }
            let square = omega * omega;
            let rate = Complex64::new(0.0, omega);
            let answers = |law: &dyn Fn(&Coordinate) -> Complex64| {
                let terms = self.equations.coordinates.iter().map(|mode| {
                    let per_torque = Complex64::from(-square * mode.hub_angle) / law(mode);
                    (per_torque * mode.tip, per_torque * mode.hub_angle)
                });
                terms.fold((Complex64::ZERO, Complex64::ZERO), |sum, term| {
                    (sum.0 + term.0, sum.1 + term.1)
                })
            };
            let (x_h, y_h) = answers(&|mode| mode.square * kappa - square);
            let (x_v, y_v) = answers(&|mode| mode.square - square + mode.rate_per_s * rate);
            let laws = x_v * (rate + friction * y_h) / (x_h * (rate + friction * y_v));
            (laws - 1.0) * acceleration / -square
        })
    }

    /// The samples of what answers to other samples at each ω in rad/s, on a period of twice the simulation's
    /// length.
    fn filtered(&self, samples: &[f64], answer: impl Fn(f64, Complex64) -> Complex64) -> Vec<f64> {
        let len = fast_length(2 * self.grid.len);
        let pair = FourierPair::new(len);
        let mut padded = samples.to_vec();
        padded.resize(len, 0.0);
        let mut amplitudes = pair.amplitudes(padded);
        for (bin, amplitude) in amplitudes.iter_mut().enumerate() {
            *amplitude = answer(angular_frequency(bin, len, self.grid.step_s), *amplitude);
        }
        let mut filtered = pair.samples(amplitudes);
        filtered.truncate(self.grid.len);
        filtered
    }

    /// The rigid rotation's coordinate.
    fn rigid_rotation(&self, torque_n_m: &[f64]) -> Vec<f64> {
        let alone = Equations {
            coordinates: self.equations.coordinates[..1].to_vec(),
            shapes: self.equations.shapes[..1].to_vec(),
            reaction: HubReaction::default(),
            damping: None,
            prescribed: None,
        };
        let mut q = Vec::with_capacity(torque_n_m.len());
        let cubics = pieces(torque_n_m, Interpolation::Cubic);
        Stepper::new(&alone, self.grid.step_s)
            .run(cubics, |stepper| q.extend(stepper.coordinates()));
        q
    }
}

#[cfg(test)]
mod tests {
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Hub, Link, LinkParts, uniform};
    use crate::response::{Interpolation, Play, Torque, simulate};

    #[test]
    fn the_tip_is_that_of_the_torque_played_by_straight_lines() {
        let hub = Hub { viscous_friction_n_m_s_rad: 0.1, ..uniform().hub };
        let link = Link::new(LinkParts { hub, ..uniform() }).unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(10)), 1e-6).unwrap();
        let time_s: Vec<f64> = (0..=100).map(|k| 1e-2 * f64::from(k)).collect();
        let sine = time_s.iter().map(|t| (std::f64::consts::TAU * t).sin()).collect();
        let torque = Torque::new(&time_s, sine).unwrap();
        let play = Play { initial_tip_m: 0.5, ..Play::of(&torque) };
        let cubics = simulate(&link, &plan, &play).unwrap();
        let lines = Play { interpolation: Interpolation::Linear, ..play };
        let lines = simulate(&link, &plan, &lines).unwrap().tip.displacement_m;
        assert!(cubics.straight_tip_m(torque.torque_n_m()) == lines);
        assert!(cubics.tip.displacement_m != lines);
    }
}
