//! Numbers by which a simulation is verified: its balance of energy, its errors, and the tip of its modes under other
//! torques or hysteretic damping; and the state that it leaves.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::driving::{Interpolation, pieces};
use super::error::{SimulationError, SimulationWarning};
use super::modes::{Coordinate, Equations, HubReaction, MOST_MODES, kept_modes};
use super::play::Play;
use super::simulation::{ModalPlay, Played, Simulation};
use super::state::State;
use super::stepper::Stepper;
use crate::link::Link;
use crate::modal::{DampingLaw, Shape};
use crate::numeric::{
    CubicSpline, FourierPair, SplineEnds, angular_frequency, fast_length, largest,
    largest_difference,
};

/// Balance of energy at one time, in J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyBalance {
    /// Time in s.
    pub time_s: f64,
    /// Work of the motor since the start, ∫ T θ̇ dt.
    pub work_j: f64,
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// Strain energy, and with weight or at large angles that of both since the start.
    pub strain_j: f64,
    /// Energy dissipated by damping and friction.
    pub dissipated_j: f64,
}

/// Balances over time, and the error of their integrals.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyAccount {
    /// The balances.
    pub balances: Vec<EnergyBalance>,
    /// Energy that the link holds at the start in J: 0 at rest.
    pub start_j: f64,
    /// Estimated error of the integrals of work and loss in J: a quarter of their change when every second
    /// sample is left out. A smooth power has an error of a sixteenth, one with kinks a larger one.
    pub quadrature_error_j: f64,
}

impl Simulation {
    /// The balance at `count` samples, the last one among them. The integral of the motor's absolute power
    /// between two of them is the same, so that few fall into a long rest.
    ///
    /// Work and dissipation are integrated over all samples by a cubic spline; the energies are
    /// those of the elements in the shape and rate that the modes add up to, or of the elastica.
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
            let [kinetic_j, strain_j] = self.energies_j(sample);
            EnergyBalance {
                time_s: self.grid.time_s(sample),
                work_j: work[sample],
                kinetic_j,
                strain_j,
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
            start_j: self.energies_j(0).iter().sum(),
            quadrature_error_j: 0.25 * (missing(&motor, &work) + missing(&lost, &dissipated)),
        }
    }

    /// Kinetic energy, and that of strain and weight since the start, at a sample in J.
    fn energies_j(&self, sample: usize) -> [f64; 2] {
        let modes = match &self.played {
            Played::Modes(modes) => modes,
            Played::Elastica(bent) => {
                let ([kinetic_j, held_j], [_, first_j]) =
                    (bent.energies_j(sample), bent.energies_j(0));
                return [kinetic_j, held_j - first_j];
            }
        };
        let (q, rate) = modes.record.at(sample);
        let [shape, velocity] = [q, rate].map(|own| Shape::sum(own, &modes.equations.shapes));
        let kinetic_j = 0.5 * velocity.mass_product(&self.mesh, &velocity);
        [kinetic_j, 0.5 * shape.stiffness_product(&self.mesh, &shape)]
    }

    /// Power that damping and friction dissipate at a sample in W.
    fn loss_w(&self, sample: usize) -> f64 {
        let modes = match &self.played {
            Played::Modes(modes) => modes,
            Played::Elastica(bent) => return bent.loss_w(sample),
        };
        let rate = modes.record.at(sample).1;
        let turning_rad_s = modes.turning_rad_s.get(sample).copied().unwrap_or(0.0);
        modes.equations.damped_w(rate, turning_rad_s)
            + modes.equations.reaction.friction_n_m_s_rad * self.hub_rate_rad_s[sample].powi(2)
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
    /// Where the link is at the last sample, and how it moves.
    pub fn state(&self) -> State {
        let time_s = self.grid.end_s();
        match &self.played {
            Played::Modes(modes) => {
                let (q, rates) = modes.record.at(self.grid.len - 1);
                let all = [q, rates].map(|own| Shape::sum(own, &modes.equations.shapes));
                let at = |own: &Shape, part: usize| -> Vec<f64> {
                    let nodes = 0..self.mesh.nodes_m().len();
                    nodes.map(|node| own.total(&self.mesh, node)[part]).collect()
                };
                let turned = modes.initial_tip_m / self.mesh.length_m();
                let nodes_m = self.mesh.nodes_m();
                let moved = at(&all[0], 0).into_iter().zip(nodes_m).map(|(v, x)| v + x * turned);
                let from_rad = modes.from_rad + turned;
                State {
                    time_s,
                    x_m: nodes_m.to_vec(),
                    slope_rad: at(&all[0], 1).iter().map(|slope| slope + from_rad).collect(),
                    slope_rate_rad_s: at(&all[1], 1),
                    displacement_m: Some(moved.collect()),
                    velocity_m_s: Some(at(&all[1], 0)),
                }
            }
            Played::Elastica(bent) => bent.state(time_s),
        }
    }
}

impl ModalPlay {
    /// Tip displacement in m under a torque that follows straight lines between its samples, which begin
    /// with those of this simulation; friction and feedback act as in it.
    pub fn straight_tip_m(&self, torque_n_m: &[f64]) -> Vec<f64> {
        let mut tip_m = Vec::with_capacity(torque_n_m.len());
        let lines = pieces(torque_n_m, Interpolation::Linear);
        let (coordinates, rates) = self.record.at(0);
        let stepper = Stepper::new(&self.equations, self.grid.step_s);
        stepper.starting_at(coordinates, rates).run(lines, |stepper| {
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
        // Two cycles of what repeats: a transform has an even length.
        let len = if self.repeats { 2 * self.grid.len } else { fast_length(2 * self.grid.len) };
        let pair = FourierPair::new(len);
        let mut padded = samples.to_vec();
        if self.repeats {
            padded.extend_from_slice(samples);
        }
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
            drags: None,
            prescribed: None,
        };
        let mut q = Vec::with_capacity(torque_n_m.len());
        let cubics = pieces(torque_n_m, Interpolation::Cubic);
        Stepper::new(&alone, self.grid.step_s)
            .run(cubics, |stepper| q.extend(stepper.coordinates()));
        q
    }
}

/// Error of a tip or a hub angle above which a warning is given.
const COARSE: f64 = 1e-2;

/// The same at large angles, where refinement goes on until nothing changes.
pub(super) const UNSETTLED: f64 = 1e-4;

/// Errors of a simulation by its mesh and its modes; at large angles by its angles and steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlayError {
    /// Largest error of the tip's displacement, over its travel.
    pub tip: f64,
    /// Largest error of the hub angle, over its peak.
    pub hub_angle: f64,
}

impl PlayError {
    /// Of a linear link: plays the same torque on elements of half the length, with all modes that the torque moves
    /// there, and measures the change; where modes were cut, with twice as many.
    ///
    /// It takes about as long as the simulation, and no memory. `None` where such elements do not
    /// allow the damping law. At large angles the errors are what the last refinement changed.
    ///
    /// # Errors
    /// As [`simulate`](super::simulate) of this simulation.
    pub fn of(
        simulation: &Simulation,
        link: &Link,
        play: &Play,
    ) -> Result<Option<Self>, SimulationError> {
        let Simulation { grid, tip, hub_angle_rad, .. } = simulation;
        let (start_m, start_rad) = (tip.displacement_m[0], hub_angle_rad[0]);
        let turned: Vec<f64> = hub_angle_rad.iter().map(|angle| angle - start_rad).collect();
        let share = |error: f64, whole: f64| if error == 0.0 { 0.0 } else { error / whole };
        let modes = match &simulation.played {
            Played::Modes(modes) => modes,
            Played::Elastica(bent) => {
                return Ok(Some(Self {
                    tip: share(bent.tip_change_m, tip.largest_travel_m()),
                    hub_angle: share(bent.hub_change_rad, largest(&turned)),
                }));
            }
        };
        let mesh = simulation.mesh.refined();
        let Ok(law) = DampingLaw::of(link, &mesh) else { return Ok(None) };
        let were_cut = modes.selection.modes >= MOST_MODES;
        let most_modes = if were_cut { 2 * MOST_MODES } else { MOST_MODES };
        let (basis, _) = kept_modes(&mesh, modes.band_rad_s, most_modes);
        let equations = play.equations(link, (&mesh, &law), basis)?;
        let driving = play.driving(link)?;
        let mut found = tip.displacement_m.iter().zip(&turned);
        let (mut tip_m, mut hub_rad) = (0.0_f64, 0.0_f64);
        let ([q, rates], _) = play.start(link, (&equations, &mesh), &driving)?;
        let stepper = Stepper::new(&equations, grid.step_s).starting_at(&q, &rates);
        let (first_m, first_rad) =
            (equations.tip(&stepper.coordinates()), equations.hub(&stepper.coordinates()));
        stepper.run(driving.steps(grid.len), |stepper| {
            let q = stepper.coordinates();
            let Some((displacement_m, turned_rad)) = found.next() else { return };
            let (own_m, own_rad) = (equations.tip(&q) - first_m, equations.hub(&q) - first_rad);
            tip_m = tip_m.max((own_m - (displacement_m - start_m)).abs());
            hub_rad = hub_rad.max((own_rad - turned_rad).abs());
        });
        let per_change = mesh.error_per_change();
        let tip = per_change * share(tip_m, tip.largest_travel_m());
        let hub_angle = per_change * share(hub_rad, largest(&turned));
        Ok(Some(Self { tip, hub_angle }))
    }

    /// A warning if the errors are large.
    pub fn warning(&self, simulation: &Simulation) -> Option<SimulationWarning> {
        let Self { tip, hub_angle } = *self;
        let (largest, warning) = match simulation.played {
            Played::Modes(_) => (COARSE, SimulationWarning::CoarseMesh { tip, hub_angle }),
            Played::Elastica(_) => (UNSETTLED, SimulationWarning::Unsettled { tip, hub_angle }),
        };
        (tip.max(hub_angle) > largest).then_some(warning)
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
        assert!(cubics.modes().unwrap().straight_tip_m(torque.torque_n_m()) == lines);
        assert!(cubics.tip.displacement_m != lines);
    }
}
