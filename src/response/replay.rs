//! The tip of the modes of a simulation under straight lines between the samples, or under hysteretic
//! damping.

use num_complex::Complex64;

use super::equations::{Coordinate, Equations, HubReaction};
use super::play::{Interpolation, pieces};
use super::simulation::Simulation;
use super::stepper::Stepper;
use crate::numeric::{FourierPair, angular_frequency, fast_length};

impl Simulation {
    /// Tip displacement in m under a torque that follows straight lines between its samples, which stand at
    /// those of this simulation; friction and feedback act as in it.
    ///
    /// # Panics
    /// If there are not as many samples as the simulation has.
    pub fn straight_tip_m(&self, torque_n_m: &[f64]) -> Vec<f64> {
        assert_eq!(torque_n_m.len(), self.grid.len, "every time has a sample");
        let tips = self.equations.tips(&self.mesh);
        let tip = |q: &[f64]| -> f64 { q.iter().zip(&tips).map(|(q, tip)| q * tip).sum() };
        let stepper = Stepper::new(&self.equations, self.grid.step_s);
        let lines = pieces(torque_n_m, Interpolation::Linear);
        stepper.through(&lines, |q| self.initial_tip_m + tip(q))
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
    ///
    /// # Panics
    /// If there are not as many samples as the simulation has.
    pub fn hysteretic_tip_m(&self, ratio: f64, net_torque_n_m: &[f64]) -> Vec<f64> {
        assert_eq!(net_torque_n_m.len(), self.grid.len, "every time has a sample");
        let tips = self.equations.tips(&self.mesh);
        let rigid = self.rigid_rotation(net_torque_n_m);
        let len = fast_length(2 * self.grid.len);
        let pair = FourierPair::new(len);
        let mut samples = net_torque_n_m.to_vec();
        samples.resize(len, 0.0);
        let torque = pair.amplitudes(samples);
        let kappa = Complex64::new(1.0, 2.0 * ratio);
        let modes = || self.equations.coordinates.iter().zip(&tips).skip(1);
        let bending = torque.iter().enumerate().map(|(bin, torque)| {
            let omega = angular_frequency(bin, len, self.grid.step_s);
            let answers = modes()
                .map(|(mode, tip)| tip * mode.hub_angle / (mode.square * kappa - omega * omega));
            answers.sum::<Complex64>() * torque
        });
        let bending = pair.samples(bending.collect::<Vec<_>>());
        let moved = rigid.iter().zip(bending).map(|(q, bent)| q * tips[0] + bent);
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
    ///
    /// # Panics
    /// If there are not as many samples as the simulation has.
    pub fn apart_m(&self, ratio: f64, tip_acceleration_m_s2: &[f64]) -> Vec<f64> {
        assert_eq!(tip_acceleration_m_s2.len(), self.grid.len, "every time has a sample");
        let tips = self.equations.tips(&self.mesh);
        let friction = self.equations.reaction.damping_n_m_s_rad;
        let kappa = Complex64::new(1.0, 2.0 * ratio);
        let len = fast_length(2 * self.grid.len);
        let pair = FourierPair::new(len);
        let mut samples = tip_acceleration_m_s2.to_vec();
        samples.resize(len, 0.0);
        let accelerations = pair.amplitudes(samples);
        let apart = accelerations.iter().enumerate().map(|(bin, acceleration)| {
            if bin == 0 {
                // The acceleration of a motion from rest to rest has no mean.
                return Complex64::ZERO;
            }
            let omega = angular_frequency(bin, len, self.grid.step_s);
            let square = omega * omega;
            let rate = Complex64::new(0.0, omega);
            let answers = |law: &dyn Fn(&Coordinate) -> Complex64| {
                let modes = self.equations.coordinates.iter().zip(&tips);
                let terms = modes.map(|(mode, tip)| {
                    let per_torque = Complex64::from(-square * mode.hub_angle) / law(mode);
                    (per_torque * tip, per_torque * mode.hub_angle)
                });
                terms.fold((Complex64::ZERO, Complex64::ZERO), |sum, term| {
                    (sum.0 + term.0, sum.1 + term.1)
                })
            };
            let (x_h, y_h) = answers(&|mode| mode.square * kappa - square);
            let (x_v, y_v) = answers(&|mode| mode.square - square + mode.rate_per_s * rate);
            let laws = x_v * (rate + friction * y_h) / (x_h * (rate + friction * y_v));
            (laws - 1.0) * acceleration / -square
        });
        pair.samples(apart.collect::<Vec<_>>())[..self.grid.len].to_vec()
    }

    /// The rigid rotation's coordinate.
    fn rigid_rotation(&self, torque_n_m: &[f64]) -> Vec<f64> {
        let alone = Equations {
            coordinates: self.equations.coordinates[..1].to_vec(),
            shapes: self.equations.shapes[..1].to_vec(),
            reaction: HubReaction::default(),
        };
        let stepper = Stepper::new(&alone, self.grid.step_s);
        stepper.through(&pieces(torque_n_m, Interpolation::Cubic), |q| q[0])
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
