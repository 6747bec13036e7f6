use num_complex::Complex64;

use super::equations::{Equations, HubReaction};
use super::forcing::{Interpolation, pieces};
use super::simulation::Simulation;
use super::stepper::Stepper;
use crate::numeric::{FourierPair, angular_frequency, fast_length};

impl Simulation {
    /// Tip displacement in m of the same link with hysteretic damping ξ under a torque at the
    /// samples of this simulation, what friction takes already taken off.
    ///
    /// Hysteretic damping has no equation in time. Each mode answers by its frequency response, on
    /// a period of twice the simulation's length; the rigid rotation is integrated in time:
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
