use num_complex::Complex64;

use super::equations::{Coordinate, Equations, HubReaction};
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

    /// How far in m the tip of this link, damped viscously mode by mode, parts from a motion with these
    /// accelerations under the torque that moves the same link with hysteretic damping ξ so.
    ///
    /// Both answer by their modes, X the tip's and Y the hub's acceleration per torque on the link; the
    /// hub's friction b takes its share of the motor's torque:
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
                // A motion that ends at rest holds nothing there.
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
