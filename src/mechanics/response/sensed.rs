use std::f64::consts::PI;

use super::driving::{Cubic, Interpolation, pieces};
use super::error::SimulationError;
use super::linear::{PASSES, STEADY};
use super::losses::Losses;
use super::modes::{Coordinate, Equations, HubReaction, held};
use super::stepper::Stepper;
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::{DampingLaw, ModalBasis, Shape, hub_moves_mass, modes_below};
use crate::model::Sensor;
use crate::numeric::{QuinticSpline, largest};

/// Most modes in sensor histories; one residual mode stands for the others.
const MOST_MODES: usize = 100;

/// Input of a link from rest, at uniform times.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Driven {
    /// Samples of the torque at the hub in N m, zero before the first, and its shape between them.
    Torque(Vec<f64>, Interpolation),
    /// Hub angles in rad, joined by a spline; before them the hub rests at the first angle.
    Angle(Vec<f64>),
}

/// Histories of sensors on a link, at the samples of its input.
///
/// The caller has checked for at least four samples, all finite, and for a step above 0.
///
/// The losses of a drive act under a torque. `back` is the friction of a motor's back voltage, if the torque is that of a
/// motor under a voltage; the link contains it, and the rotor.
///
/// Angle and deflection begin at 0. Modes below the Nyquist frequency are integrated as in [`simulate`]; the others act
/// as one residual mode.
///
/// [`simulate`]: super::simulate
///
/// # Errors
/// [`SimulationError`]: a damping law that does not suit the mesh, a hub that moves no mass, numbers beyond double
/// precision.
///
/// # Panics
/// With fewer than four samples of a spline.
pub(crate) fn sensed(
    link: &Link,
    mesh: &Mesh,
    (driven, back): (&Driven, Option<f64>),
    step_s: f64,
    sensors: &[Sensor],
) -> Result<Vec<Vec<f64>>, SimulationError> {
    if !hub_moves_mass(mesh) {
        return Err(SimulationError::MasslessHub);
    }
    let law = DampingLaw::of(link, mesh)?;
    let modes = modes_below(mesh, PI / step_s).saturating_sub(1).clamp(1, MOST_MODES);
    let friction = link.joint().friction();
    let reaction = HubReaction {
        damping_n_m_s_rad: friction,
        friction_n_m_s_rad: friction,
        ..HubReaction::default()
    };
    let basis = ModalBasis::lowest(mesh, modes);
    let modes = basis.modes.len();
    let free = Equations::new(mesh, &law, basis, reaction);
    let root_n_m2 = link.segments()[0].bending_stiffness_n_m2.inner;
    let bends = || free.root_curvatures(mesh, modes, root_n_m2);
    let row = |equations: &Equations, bends: &[f64], sensor: &Sensor| {
        Row::of(*sensor, equations, mesh.rigid_tip(), bends)
    };
    match driven {
        Driven::Torque(samples, interpolation) => {
            let bends = bends();
            let rows: Vec<Row> = sensors.iter().map(|sensor| row(&free, &bends, sensor)).collect();
            let last = samples.last().copied().unwrap_or_default();
            let steps = pieces(samples, *interpolation);
            let rates = |equations: &Equations| {
                let row = row(equations, &bends, &Sensor::HubRate);
                histories(equations, &[row], (&steps, last), step_s).remove(0)
            };
            let losses = Losses::of(link, back, (0.0, f64::INFINITY));
            let free = losses.map_or_else(|| free.clone(), |own| with_losses(&free, own, rates));
            Ok(histories(&free, &rows, (&steps, last), step_s))
        }
        Driven::Angle(angle_rad) => {
            let not_finite = SimulationError::NotFinite { time_s: 0.0 };
            let held = held(&free, &law).ok_or(not_finite)?;
            let bends = held.curvatures_of(mesh, &free, &bends());
            let rows: Vec<Row> = sensors.iter().map(|sensor| row(&held, &bends, sensor)).collect();
            let spline = QuinticSpline::from_rest(angle_rad);
            let square = step_s * step_s;
            let pieces = spline.curvature_pieces().map(|piece| piece.map(|part| part / square));
            let last = spline.curvatures().last().unwrap_or_default() / square;
            Ok(histories(&held, &rows, (&pieces.collect::<Vec<Cubic>>(), last), step_s))
        }
    }
}

/// Factors of coordinates, of their rates and of the input in a sensor's value.
#[expect(clippy::struct_field_names, reason = "factors on each")]
struct Row {
    on_coordinates: Vec<f64>,
    on_rates: Vec<f64>,
    on_input: f64,
}

impl Row {
    /// `bends` is the curvature of each coordinate's shape at the root in 1/m.
    fn of(sensor: Sensor, equations: &Equations, rigid_tip: f64, bends: &[f64]) -> Self {
        let Equations { coordinates, reaction, .. } = equations;
        let row = |of: &dyn Fn(&Coordinate) -> f64| coordinates.iter().map(of).collect::<Vec<_>>();
        let nothing = || vec![0.0; coordinates.len()];
        let (on_coordinates, on_rates, on_input) = match sensor {
            Sensor::HubAngle | Sensor::Carriage => (row(&|c| c.hub_angle), nothing(), 0.0),
            Sensor::HubRate | Sensor::CarriageVelocity => (nothing(), row(&|c| c.hub_angle), 0.0),
            Sensor::TipDeflection => (row(&|c| c.tip - rigid_tip * c.hub_angle), nothing(), 0.0),
            Sensor::TipAcceleration => {
                let on_input: f64 = coordinates.iter().map(|c| c.tip * c.drive).sum();
                let friction = on_input * reaction.damping_n_m_s_rad;
                let damped = equations.damped_tip();
                let on_rates = coordinates.iter().zip(damped);
                let on_rates = on_rates.map(|(c, damped)| -damped - friction * c.hub_angle);
                (row(&|c| -c.tip * c.square), on_rates.collect(), on_input)
            }
            Sensor::RootStrain => (bends.to_vec(), nothing(), 0.0),
        };
        Self { on_coordinates, on_rates, on_input }
    }
}

impl Equations {
    /// Reduction of the tip's acceleration by damping, per rate of each coordinate.
    fn damped_tip(&self) -> Vec<f64> {
        let tips = || self.coordinates.iter().map(|c| c.tip);
        match &self.damping {
            None => self.coordinates.iter().map(|c| c.tip * c.rate_per_s).collect(),
            Some(damping) => {
                let count = self.coordinates.len();
                let column = |k: usize| damping[k..].iter().step_by(count);
                let taken = |k: usize| tips().zip(column(k)).map(|(tip, rate)| tip * rate).sum();
                (0..count).map(taken).collect()
            }
        }
    }

    /// Curvature of each coordinate's shape at the root in 1/m, for the free link with `modes` modes.
    ///
    /// A mode bends the link like its inertia forces, ω² times its shape. The residual mode bends it like a constant
    /// torque, less the part of the kept modes.
    fn root_curvatures(&self, mesh: &Mesh, modes: usize, root_n_m2: f64) -> Vec<f64> {
        let moments: Vec<f64> = self.shapes.iter().map(|shape| shape.moments(mesh)[0]).collect();
        let kept = self.coordinates.iter().zip(&moments).take(modes + 1);
        let per_torque: f64 = kept.map(|(c, moment)| c.hub_angle * moment).sum();
        let bent = self.coordinates.iter().zip(&moments).enumerate().map(|(k, (c, moment))| {
            if k <= modes { c.square * moment } else { -c.square / c.hub_angle * per_torque }
        });
        bent.map(|moment| moment / root_n_m2).collect()
    }

    /// Curvatures of shapes that are sums of the free link's shapes, from the free link's `curvatures`.
    fn curvatures_of(&self, mesh: &Mesh, free: &Self, curvatures: &[f64]) -> Vec<f64> {
        let share = |own: &Shape, of: &Shape| own.mass_product(mesh, of);
        let sum = |own: &Shape| {
            let terms = free.shapes.iter().zip(curvatures);
            terms.map(|(shape, curvature)| share(own, shape) * curvature).sum()
        };
        self.shapes.iter().map(sum).collect()
    }
}

/// The equations with losses at the friction's rate for the peak of the `rates` that they leave, in steps that resolve it.
fn with_losses(
    free: &Equations,
    losses: Losses,
    rates: impl Fn(&Equations) -> Vec<f64>,
) -> Equations {
    let mut equations = free.clone();
    let (mut last, mut friction_rate) = (rates(free), f64::NAN);
    for _ in 0..PASSES {
        let mut own = losses.at(largest(&last));
        own.substeps = own.steps_for(&last);
        equations.losses = Some(own);
        if (own.friction_rate / friction_rate - 1.0).abs() <= STEADY || largest(&last) == 0.0 {
            break;
        }
        friction_rate = own.friction_rate;
        last = rates(&equations);
    }
    equations
}

/// Histories from rest, before the first and after each of these steps of the input, which ends with
/// the value `last`.
fn histories(
    equations: &Equations,
    rows: &[Row],
    (steps, last): (&[Cubic], f64),
    step_s: f64,
) -> Vec<Vec<f64>> {
    let stepper = Stepper::new(equations, step_s);
    let factors: Vec<Vec<f64>> =
        rows.iter().map(|row| stepper.factors(&row.on_coordinates, &row.on_rates)).collect();
    let mut inputs = steps.iter().map(|cubic| cubic[0]).chain([last]);
    let mut sums = vec![Vec::with_capacity(steps.len() + 1); rows.len()];
    stepper.run(steps.iter().copied(), |stepper| {
        let input = inputs.next().unwrap_or(0.0);
        let lost = equations
            .losses
            .map_or(0.0, |_| equations.loss_n_m(&stepper.coordinates(), &stepper.rates(), input));
        let input = input - lost;
        for ((row, factors), history) in rows.iter().zip(&factors).zip(&mut sums) {
            history.push(stepper.weighted(factors) + row.on_input * input);
        }
    });
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Hub, LinkParts, LumpedMass, Payload, uniform};
    use crate::response::{Play, Played, Torque, simulate_on};

    const STEP_S: f64 = 0.005;

    const ALL: [Sensor; 5] = [
        Sensor::HubAngle,
        Sensor::HubRate,
        Sensor::TipDeflection,
        Sensor::TipAcceleration,
        Sensor::RootStrain,
    ];

    fn link(viscous_friction_n_m_s_rad: f64) -> Link {
        Link::new(LinkParts {
            hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad },
            masses: vec![LumpedMass { at_m: 0.9, mass_kg: 0.2, inertia_kg_m2: 0.001 }],
            payload: Payload { mass_kg: 0.3, inertia_kg_m2: 0.002, offset_m: 0.0 },
            ..uniform()
        })
        .unwrap()
    }

    /// A torque sin³ of 0.6 s, then zero for another 0.6 s.
    fn torque() -> Vec<f64> {
        let at = |k: i32| {
            let phase = std::f64::consts::TAU * f64::from(k) / 120.0;
            if k <= 120 { 2.0 * phase.sin().powi(3) } else { 0.0 }
        };
        (0..=240).map(at).collect()
    }

    fn simulated(link: &Link, mesh: &Mesh) -> Played {
        let time_s: Vec<f64> = (0..=240).map(|k| STEP_S * f64::from(k)).collect();
        let torque = Torque::new(&time_s, torque()).unwrap();
        simulate_on(link, mesh.clone(), &Play::of(&torque)).unwrap()
    }

    /// Largest difference over the largest value.
    fn off(found: &[f64], exact: &[f64]) -> f64 {
        assert_eq!(found.len(), exact.len());
        let differences: Vec<f64> = found.iter().zip(exact).map(|(a, b)| a - b).collect();
        largest(&differences) / largest(exact)
    }

    #[test]
    fn histories_are_consistent_with_the_simulation() {
        for friction in [0.0, 0.2] {
            let link = link(friction);
            let mesh = Mesh::on(&link, 20);
            let simulation = simulated(&link, &mesh);
            let driven = Driven::Torque(torque(), Interpolation::Cubic);
            let found = sensed(&link, &mesh, (&driven, None), STEP_S, &ALL).unwrap();
            for (sensor, found) in ALL.iter().zip(&found) {
                let exact = match sensor {
                    Sensor::HubAngle | Sensor::Carriage => simulation.hub().angle_rad.clone(),
                    Sensor::HubRate | Sensor::CarriageVelocity => {
                        simulation.hub().rate_rad_s.clone()
                    }
                    Sensor::TipDeflection => simulation.tip_deflection_m(),
                    Sensor::TipAcceleration => simulation.tip[0].acceleration_m_s2.clone(),
                    // The simulation has no strain; the moment at the root checks it below.
                    Sensor::RootStrain => continue,
                };
                let error = off(found, &exact);
                assert!(error < 1e-5, "{sensor:?}: {error:e}");
            }
        }
    }

    /// Prescribes the torque's motion of the hub: modes of the clamped link replace those of the free link.
    #[test]
    fn a_hub_moved_as_recorded_bends_the_link_as_the_torque_does() {
        let link = link(0.2);
        let mesh = Mesh::on(&link, 20);
        let hub_angle_rad = simulated(&link, &mesh).joints.swap_remove(0).angle_rad;
        let torque = Driven::Torque(torque(), Interpolation::Cubic);
        let exact = sensed(&link, &mesh, (&torque, None), STEP_S, &ALL).unwrap();
        let found =
            sensed(&link, &mesh, (&Driven::Angle(hub_angle_rad), None), STEP_S, &ALL).unwrap();
        for ((sensor, found), exact) in ALL.iter().zip(&found).zip(&exact) {
            let error = off(found, exact);
            assert!(error < 1e-3, "{sensor:?}: {error:e}");
        }
    }

    /// A torque that grows slowly to a constant bends the link like its constant acceleration: `EI w'' = −∫ m̄ x (x −
    /// r) dx θ̈`, here with the masses, too.
    #[test]
    fn the_strain_at_the_root_is_that_of_the_moment_there() {
        let link = link(0.0);
        let mesh = Mesh::on(&link, 20);
        let at = |k: i32| {
            let s = (f64::from(k) / 1800.0).min(1.0);
            s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
        };
        let torque = Driven::Torque((0..2000).map(at).collect(), Interpolation::Cubic);
        let found = sensed(&link, &mesh, (&torque, None), STEP_S, &[Sensor::RootStrain]).unwrap();
        let (root, tip) = (0.05, link.length_m());
        let beam = |x: f64| 0.8 * (x.powi(3) / 3.0 - root * x * x / 2.0);
        let body = |mass: f64, x: f64, inertia: f64| mass * x * (x - root) + inertia;
        let moment = beam(tip) - beam(root) + body(0.2, 0.9, 0.001) + body(0.3, tip, 0.002);
        let exact = -moment / link.rigid_inertia_kg_m2() / 5.0;
        let last = found[0].last().unwrap();
        assert!((last / exact - 1.0).abs() < 1e-4, "{last} is not {exact}");
    }
}
