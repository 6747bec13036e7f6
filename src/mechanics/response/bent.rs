//! A torque, or a motion of the hub, played on a link with weight or at large angles.

use std::num::NonZeroUsize;

use super::balance::Balance;
use super::chain::{Chain, coordinates, play_bytes};
use super::driving::{Cubic, CycleError, Driving, Step};
use super::error::{STEP_SHARE, SimulationError, SimulationWarning};
use super::modes::HubReaction;
use super::play::{Input, Play, refuse_memory};
use super::radau::{Motion, Radau};
use super::shape::{Held, at_rest, direction, refuse_unknown, viscous};
use super::state::{State, settle};
use super::stepper::Record;
use crate::link::Link;
use crate::modal::DampingLaw;
use crate::numeric::{Size, TimeGrid, dot, extremes, largest_difference};

/// Order of the polynomials of a piece at first, beside one for each radian of a bending wave along it.
const FIRST_ORDER: usize = 3;

/// Highest order of the polynomials of a piece at first.
const HIGHEST_ORDER: usize = 24;

/// The waves that the first orders follow, in first natural frequencies.
const WAVES: f64 = 3.0;

/// What each refinement adds to every order.
const MORE_ORDERS: usize = 2;

/// Most refinements, and steps beyond which none is made.
const MOST_REFINEMENTS: usize = 6;
const LONGEST: usize = 1 << 20;

/// Changes of an angle in rad that are round-off.
const STILL_RAD: f64 = 1e-12;

/// What an elastica was played with, and its motion.
#[derive(Debug, Clone)]
pub struct BentPlay {
    /// Number of angles that describe the link, the hub's among them.
    pub angles: usize,
    /// Steps of the integration from one sample to the next.
    pub steps: usize,
    /// Torque in N m that holds the link where it starts.
    pub holding_n_m: f64,
    /// Largest change of the tip in m by the last refinement: two angles more on each piece of the link, half the step.
    pub(crate) tip_change_m: f64,
    /// The same of the hub's angle in rad.
    pub(super) hub_change_rad: f64,
    chain: Chain,
    friction_n_m_s_rad: f64,
    record: Record,
    /// Direction of the chord at each sample in rad, whole turns counted, and the one that displacements are counted
    /// from.
    chord_rad: Vec<f64>,
    from_rad: f64,
    /// Direction of the chord less that of the hub at the last sample in rad.
    bent_rad: f64,
    /// Rate of the reference, with which the damping of a loop turns, at each sample in rad/s.
    turning_rad_s: Vec<f64>,
}

/// Torque of the motor; angle, rate and acceleration of the hub; displacement, velocity and acceleration of the tip.
type Histories = [Vec<f64>; 7];

/// Plays an input at the samples of a grid, finer and finer until that changes tip and hub angle by less than
/// `tolerance` of what they move by.
///
/// # Errors
/// [`SimulationError`].
pub(super) fn play_bent(
    link: &Link,
    law: &DampingLaw,
    play: &Play,
    (grid, first_rad_s, tolerance): (&TimeGrid, f64, f64),
) -> Result<(BentPlay, Histories), SimulationError> {
    refuse_unknown(link, law)?;
    let problem = Problem { link, law, play, driving: play.driving(link)?, grid, first_rad_s };
    let played = |finer: usize, start: Option<&State>| {
        let order = |[from_m, end_m]: [f64; 2], [stiffness_n_m2, mass_kg_m]: [f64; 2]| {
            let omega_rad_s = WAVES * first_rad_s;
            let wave_rad = (end_m - from_m)
                * (mass_kg_m / stiffness_n_m2 * omega_rad_s * omega_rad_s).sqrt().sqrt();
            let order = (FIRST_ORDER as f64 + wave_rad.ceil()).min(HIGHEST_ORDER as f64) as usize;
            let given = play.state.map_or(0, |state| state.piece([from_m, end_m]).len());
            order.max(given.saturating_sub(1)) + finer * MORE_ORDERS
        };
        let (modes, samples) = (coordinates(link, order), grid.len);
        let bytes = play_bytes(modes, samples, 2 * modes + 16);
        refuse_memory((samples, modes), bytes, play.memory_bytes)?;
        problem.played(Chain::of(link, order), 1 << finer, start)
    };
    // Steps too long to converge are no reason against shorter ones.
    let mut coarse = played(0, play.state);
    for finer in 1..=MOST_REFINEMENTS {
        let is_last = finer == MOST_REFINEMENTS || (grid.len << finer) > LONGEST;
        let Ok((own, before)) = &coarse else {
            match coarse {
                Err(SimulationError::NotConverged { .. }) if !is_last => {
                    coarse = played(finer, play.state);
                }
                refused => return refused,
            }
            continue;
        };
        let (coarse_hub, coarse_tip) = (&before[1], &before[4]);
        // A cycle begins where that of coarser steps does, nearly.
        let begun = problem.driving.repeats.then(|| own.first_state(grid.time_s(0)));
        let (mut found, histories) = played(finer, begun.as_ref().or(play.state))?;
        let change = |own: &[f64], coarse: &[f64]| {
            let moved = own.iter().map(|value| (value - own[0]).abs()).fold(0.0, Size::larger);
            (largest_difference(own, coarse), moved)
        };
        let (hub, tip) = (change(&histories[1], coarse_hub), change(&histories[4], coarse_tip));
        (found.hub_change_rad, found.tip_change_m) = (hub.0, tip.0);
        // What does not move has nothing to settle.
        let least = [STILL_RAD, STILL_RAD * link.length_m()];
        let is_settled = [hub, tip]
            .iter()
            .zip(least)
            .all(|((change, moved), least)| *change <= (tolerance * moved).max(least));
        coarse = Ok((found, histories));
        if is_settled || is_last {
            break;
        }
    }
    coarse
}

struct Problem<'a> {
    link: &'a Link,
    law: &'a DampingLaw,
    play: &'a Play<'a>,
    driving: Driving,
    grid: &'a TimeGrid,
    first_rad_s: f64,
}

/// The input at one instant: the motor's part that does not depend on the link's motion, or the hub's acceleration.
#[derive(Clone, Copy)]
struct Drive {
    reaction: HubReaction,
    /// The hub angle at which feedback does nothing.
    aim_rad: f64,
    is_prescribed: bool,
}

impl Drive {
    /// Puts an input into the equations of the hub.
    fn apply(&self, input: f64, (q, rates): (&[f64], &[f64]), balance: &mut Balance) {
        let Balance { mass, force } = balance;
        if self.is_prescribed {
            mass[..q.len()].fill(0.0);
            mass[0] = 1.0;
            force[0] = input;
        } else {
            force[0] += input - self.reaction.torque_n_m(q[0] - self.aim_rad, rates[0]);
        }
    }
}

impl Problem<'_> {
    fn played(
        &self,
        mut chain: Chain,
        steps: usize,
        state: Option<&State>,
    ) -> Result<(BentPlay, Histories), SimulationError> {
        let (count, grid) = (chain.count, self.grid);
        let is_prescribed = !self.play.input.is_torque();
        let lost = |sample: usize| SimulationError::NotFinite { time_s: grid.time_s(sample) };
        let reaction = self.play.reaction(self.link);
        let free_hub = (!is_prescribed).then_some((reaction, self.first_rad_s));
        chain.damping = viscous(&chain, self.law, free_hub).ok_or(lost(0))?;
        let (q, mut rates, from_rad) = self.start(&chain, state)?;
        if let Input::HubAngle(hub) = self.play.input {
            rates[0] = hub.accelerations(self.play.cycle_turn_rad).2;
        }
        let aim_rad = match (self.play.zero_of_state_rad(self.link), self.play.feedback) {
            (Some(zero_rad), _) => zero_rad,
            (None, Some(feedback)) if self.link.has_weight() => feedback.reference().angle_rad()[0],
            _ => q[0],
        };
        let drive = Drive { reaction, aim_rad, is_prescribed };
        let mut stiffness = chain.stiffness.clone();
        let mut linear_damping = chain.damping.clone();
        if !is_prescribed {
            stiffness[0] += drive.reaction.stiffness_n_m_rad;
            linear_damping[0] += drive.reaction.damping_n_m_s_rad;
        }
        let step_s = grid.step_s / steps as f64;
        let mut radau = Radau::new(step_s, &stiffness, &linear_damping);
        let mut balance = Balance::default();
        let mut motion = Motion { rates, accelerations: vec![0.0; count], q };
        chain.balance(&motion.q, &motion.rates, &mut balance);
        let holding_n_m = -balance.force[0];
        chain.turn(self.driving.turning_at(0), &mut balance);
        drive.apply(self.driving.at(0), (&motion.q, &motion.rates), &mut balance);
        if let Some(first) = balance.accelerations() {
            motion.accelerations = first;
        }
        let mut found = BentPlay {
            angles: count,
            steps,
            holding_n_m,
            tip_change_m: f64::INFINITY,
            hub_change_rad: f64::INFINITY,
            friction_n_m_s_rad: self.link.hub().viscous_friction_n_m_s_rad,
            record: Record::with_capacity(count, grid.len),
            chord_rad: Vec::with_capacity(grid.len),
            from_rad,
            bent_rad: 0.0,
            turning_rad_s: self.driving.turning_rad_s(grid.len),
            chain,
        };
        let mut histories: Histories = [(); 7].map(|()| Vec::with_capacity(grid.len));
        let places = Radau::places();
        let mut advance = |chain: &Chain, motion: &mut Motion, sample: usize, driven: &Step| {
            let is_done = (0..steps).all(|step| {
                radau.advance(motion, |stage, q, rates, balance| {
                    let s = (step as f64 + places[stage]) / steps as f64;
                    let at =
                        |cubic: &Cubic| cubic.iter().rev().fold(0.0, |sum, term| sum * s + term);
                    chain.balance(q, rates, balance);
                    chain.turn(at(&driven.turning), balance);
                    drive.apply(at(&driven.input), (q, rates), balance);
                })
            });
            let time_s = grid.time_s(sample + 1);
            if is_done { Ok(()) } else { Err(SimulationError::NotConverged { time_s }) }
        };
        if self.driving.repeats {
            // Nothing holds the hub of such a link anywhere: it may turn on from cycle to cycle, at one rate.
            let is_free = !self.link.has_weight() && drive.reaction.stiffness_n_m_rad == 0.0;
            if is_free && !is_prescribed && drive.reaction.damping_n_m_s_rad == 0.0 {
                return Err(CycleError::Free.into());
            }
            let cycle = (&self.driving, self.play.input.grid());
            settle(&mut motion, cycle, is_free || is_prescribed, |motion, sample, step| {
                advance(&found.chain, motion, sample, step)
            })?;
        }
        found.observe(&mut motion, (self.driving.at(0), &drive), &mut balance, &mut histories);
        for (sample, step) in self.driving.steps(grid.len).enumerate() {
            advance(&found.chain, &mut motion, sample, &step)?;
            let input = (self.driving.at(sample + 1), &drive);
            found.observe(&mut motion, input, &mut balance, &mut histories);
        }
        Ok((found, histories))
    }

    /// Coordinates and rates before the input, at rest or of a state, and the direction of the chord from which
    /// displacements are counted.
    fn start(
        &self,
        chain: &Chain,
        state: Option<&State>,
    ) -> Result<(Vec<f64>, Vec<f64>, f64), SimulationError> {
        let given_rad = self.play.origin_rad(self.link);
        let rest = vec![0.0; chain.count];
        if let Some(state) = state {
            let (q, rates) = chain.of_state(state)?;
            let first_rad = direction(chain.tip(&q, &rest).at_m, q[0]);
            let from_rad =
                given_rad.unwrap_or(if self.link.has_weight() { first_rad } else { 0.0 });
            return Ok((q, rates, from_rad));
        }
        let start_rad = self.play.start_m(self.link) / self.link.length_m();
        let straight = |angle_rad: f64| {
            let mut q = vec![0.0; chain.count];
            q[0] = angle_rad;
            q
        };
        let start_rad = start_rad + given_rad.unwrap_or(0.0);
        if !self.link.has_weight() {
            return Ok((straight(start_rad), rest, given_rad.unwrap_or(0.0)));
        }
        let held = match self.play.input {
            Input::Torque(_) if given_rad.is_none() => return Err(SimulationError::NoStartAngle),
            Input::Torque(_) => Held::Chord(start_rad),
            Input::HubAngle(_) => Held::Hub,
        };
        let q = at_rest(chain, &straight(start_rad), held).ok_or(SimulationError::NoRest)?;
        // A prescribed hub leaves the chord where the weight bends it to.
        let first_rad = direction(chain.tip(&q, &rest).at_m, start_rad);
        Ok((q, rest, given_rad.unwrap_or(first_rad)))
    }
}

impl BentPlay {
    /// Adds what a motion is like to the record and the histories.
    fn observe(
        &mut self,
        motion: &mut Motion,
        (input, drive): (f64, &Drive),
        balance: &mut Balance,
        histories: &mut Histories,
    ) {
        let (q, rates, reaction) = (&motion.q, &motion.rates, drive.reaction);
        self.chain.balance(q, rates, balance);
        let motor_n_m = if drive.is_prescribed {
            let inertial_n_m = dot(&balance.mass[..self.angles], &motion.accelerations);
            inertial_n_m - balance.force[0] + reaction.friction_n_m_s_rad * rates[0]
        } else {
            // Friction acts on the hub; the rest of the reaction is the motor's.
            let friction_n_m = reaction.friction_n_m_s_rad * rates[0];
            // Where the torque jumps, those of the last step's end are of the torque before.
            self.chain.turn(self.turning_rad_s[self.chord_rad.len()], balance);
            drive.apply(input, (q, rates), balance);
            if let Some(now) = balance.accelerations() {
                motion.accelerations = now;
            }
            input - (reaction.torque_n_m(q[0] - drive.aim_rad, rates[0]) - friction_n_m)
        };
        let tip = self.chain.tip(q, rates);
        // The chord is where the hub is, bent by as much as before: a sample may be more than half a turn away.
        let chord_rad = direction(tip.at_m, q[0] + self.bent_rad);
        self.bent_rad = chord_rad - q[0];
        let ([x, y], [vx, vy]) = (tip.at_m, tip.rate_m_s);
        let [ax, ay] = tip.acceleration_m_s2(&motion.accelerations);
        let square = x * x + y * y;
        let rate = (x * vy - y * vx) / square;
        let turning = (x * ay - y * ax - 2.0 * (x * vx + y * vy) * rate) / square;
        let length_m = self.chain.length_m();
        let row = [
            motor_n_m,
            q[0],
            rates[0],
            motion.accelerations[0],
            length_m * (chord_rad - self.from_rad),
            length_m * rate,
            length_m * turning,
        ];
        self.chord_rad.push(chord_rad);
        self.record.push(q, rates);
        histories.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }

    /// Where the link is at the first sample, and how it moves.
    fn first_state(&self, time_s: f64) -> State {
        let (q, rates) = self.record.at(0);
        self.chain.state(time_s, q, rates)
    }

    /// Where the link is at the last sample, and how it moves.
    pub(super) fn state(&self, time_s: f64) -> State {
        let (q, rates) = self.record.at(self.chord_rad.len() - 1);
        self.chain.state(time_s, q, rates)
    }

    /// A warning of a torque that does not begin with what holds the link.
    pub(super) fn unheld(&self, torque_n_m: &[f64]) -> Option<SimulationWarning> {
        let (holding_n_m, [low, high]) = (self.holding_n_m, extremes(torque_n_m));
        let (first, range) = (torque_n_m[0], high - low);
        // A link that hangs straight is held by round-off.
        let least = STEP_SHARE * STEP_SHARE * self.chain.weight_moment_n_m();
        let size = if range > 0.0 { range } else { holding_n_m.abs() }.max(least);
        let share = (first - holding_n_m).abs() / size;
        let warning = SimulationWarning::BeginsUnheld { torque_n_m: first, holding_n_m, share };
        (share > STEP_SHARE).then_some(warning)
    }

    /// Displacement in m along the arc of places at distances along the link, at every `every`-th sample.
    pub(super) fn displacements_m(&self, along_m: &[f64], every: NonZeroUsize) -> Vec<Vec<f64>> {
        let stations = self.chain.stations(along_m);
        let mut columns = vec![Vec::new(); along_m.len()];
        for sample in (0..self.chord_rad.len()).step_by(every.get()) {
            let places = self.chain.places_m(&stations, self.record.at(sample).0);
            for ((column, at_m), s_m) in columns.iter_mut().zip(places).zip(along_m) {
                column.push(s_m * (direction(at_m, self.chord_rad[sample]) - self.from_rad));
            }
        }
        columns
    }

    /// Deflection of the tip from the hub's tangent line in m.
    pub(super) fn tip_deflection_m(&self) -> Vec<f64> {
        let rest = vec![0.0; self.angles];
        let deflection = |sample: usize| {
            let q = self.record.at(sample).0;
            let [x, y] = self.chain.tip(q, &rest).at_m;
            y * libm::cos(q[0]) - x * libm::sin(q[0])
        };
        (0..self.chord_rad.len()).map(deflection).collect()
    }

    /// Kinetic energy, and that of strain and weight, at a sample in J.
    pub(super) fn energies_j(&self, sample: usize) -> [f64; 2] {
        let (q, rates) = self.record.at(sample);
        self.chain.energies_j(q, rates)
    }

    /// Power that damping and friction dissipate at a sample in W.
    pub(super) fn loss_w(&self, sample: usize) -> f64 {
        let rates = self.record.at(sample).1;
        let friction_w = self.friction_n_m_s_rad * rates[0] * rates[0];
        self.chain.damped_w(rates, self.turning_rad_s[sample]) + friction_w
    }
}
