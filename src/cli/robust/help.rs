//! Other commands on the worst plants, for comparison: another hold, a shaped motion, a longer one.

use std::f64::consts::TAU;

use rayon::prelude::*;

use crate::inverse::{Resources, Solution, invert_motion};
use crate::motion::{Ends, Motion, MotionColumns, MotionScale, Shaper, Shaping, TipMotion};
use crate::robust::{
    Help, Histories, Hold, How, Measure, Robustness, Strays, Thinned, directions_rad,
};
use crate::spec::Specification;
use crate::text::significant;

use super::{Plants, Played, RobustOptions};
use crate::cli::problem::Problem;
use crate::cli::terminal::memory;

/// Most plants on which other commands play.
const CORNERS: usize = 16;

/// Step of the search for a longer motion, over its duration, and number of steps.
const LONGER: f64 = 0.01;
const STEPS: u8 = 100;

/// Amplitude at the mode that rings, over that of the motion, below which a longer motion is quiet.
const QUIET: f64 = 0.2;

/// Frequency of the held joints over that of a joint on feedback, and its damping ratio.
const SLOWER: f64 = 3.0;
const DAMPED: f64 = 0.7;

/// A study whose command is to be compared with others.
struct Compared<'a> {
    options: &'a RobustOptions,
    problem: &'a Problem,
    plants: &'a Plants,
    corners: Vec<&'a [Option<f64>]>,
}

impl RobustOptions {
    /// Plays other commands on the keys and corners with the largest tip errors. A command that cannot be made
    /// or played is left out.
    pub(super) fn help(
        &self,
        problem: &Problem,
        solution: &Solution,
        outcome: &Robustness,
        plants: &Plants,
    ) -> Vec<Help> {
        // A delay has no meaning for another hold.
        if plants.keys.iter().any(|key| key.how == How::Delay) {
            return Vec::new();
        }
        let compared =
            Compared { options: self, problem, plants, corners: outcome.hardest(CORNERS) };
        let holds = [Hold::Position, Hold::Effort].into_iter();
        let holds = holds.filter(|hold| *hold != self.hold());
        let mut help: Vec<Help> = holds
            .filter_map(|hold| {
                let (histories, end_s) = self.histories(problem, solution, hold).ok()?;
                let what = format!("--play {}", hold.name());
                compared.played(what, solution, (&histories, end_s), (hold, &[]))
            })
            .collect();
        let own = self.gains(&problem.specification.arm).unwrap_or_default();
        help.extend((self.hold() == Hold::Effort).then(|| compared.fed_back(solution)).flatten());
        if self.played == Played::Inverse {
            let period_s = outcome.plants[0].strays.period_s;
            let motions = period_s.map(|period_s| compared.motions(solution, TAU / period_s));
            help.extend(motions.into_iter().flatten().filter_map(|(what, motion)| {
                let solution = compared.inverted(&motion)?;
                let histories = Histories::of(&solution, false);
                let end_s = solution.grid.time_s(solution.moving.1);
                compared.played(what, &solution, (&histories, end_s), (self.hold(), &own))
            }));
        }
        help
    }
}

impl Compared<'_> {
    /// Shaped and longer motions, for the mode that rings.
    fn motions(&self, solution: &Solution, omega_rad_s: f64) -> Vec<(String, Motion)> {
        let motion = &solution.motion;
        let lasts_s = motion.grid().duration_s();
        // `trajectory` knows the modes of held and of free joints, but not those of a loop.
        let of = match self.options.hold() {
            Hold::Position => Some("held"),
            Hold::Effort => Some("free"),
            Hold::Feedback => None,
        };
        let shaper = of.and_then(|of| Some((of, Shaper::new(Shaping::Zv, omega_rad_s, 0.0)?)));
        let shaped = shaper.and_then(|(of, shaper)| {
            // The path of an arm would leave its line.
            let tip = motion.tip().filter(|tip| tip.ends() == Ends::AtRest)?;
            let grid = solution.grid;
            let displacement_m =
                shaper.shaped_samples(&solution.tip[0].displacement_m, grid.step_s);
            let time_s = (0..displacement_m.len()).map(|k| grid.time_s(k)).collect();
            let columns = MotionColumns {
                time_s,
                displacement_m: Some(displacement_m),
                acceleration_m_s2: None,
                velocity_m_s: None,
            };
            let angles = tip.target(grid.time_s(0), grid.end_s()).start_angle_rad();
            let own = TipMotion::new(columns).ok().filter(|_| angles.is_none())?;
            let more = significant(shaper.duration_s(), 3);
            let what = format!("--shape zv --of {of}, {more} s longer");
            Some((what, Motion::Tip(own)))
        });
        let longer = quiet_factor(solution, omega_rad_s).and_then(|duration| {
            let scale = MotionScale { distance: 1.0, duration };
            let own = motion.scaled(scale).ok()?;
            let lasts = significant(lasts_s * duration, 3);
            let factor = significant(duration, 3);
            Some((format!("--scale-duration {factor}, {lasts} s"), own))
        });
        shaped.into_iter().chain(longer).collect()
    }

    /// The same efforts with feedback of usual gains: each joint alone, with its links rigid, turns at a third of the lowest
    /// frequency of the held joints, with a damping ratio of 0.7.
    fn fed_back(&self, solution: &Solution) -> Option<Help> {
        let Specification { arm, meshes, .. } = &self.problem.specification;
        let (histories, end_s) =
            self.options.histories(self.problem, solution, Hold::Position).ok()?;
        let histories = (&histories, end_s);
        let held = (Hold::Position, &[][..], Thinned::Yes);
        let held = self.problem.command(solution, histories, held).ok()?;
        let held = held.plant((arm, meshes), (0.0, 1.0, end_s), &[]).ok()?.rings?;
        let omega_rad_s = held.omega_rad_s() / SLOWER;
        let two_digits = |gain: f64| significant(gain, 2).parse::<f64>().ok();
        let gains_of = |inertia: f64| {
            let stiffness = two_digits(inertia * omega_rad_s * omega_rad_s)?;
            Some((stiffness, two_digits(2.0 * DAMPED * inertia * omega_rad_s)?))
        };
        let inertias = arm.joint_inertias(&directions_rad(solution, 0));
        let gains: Vec<(f64, f64)> = inertias.into_iter().map(gains_of).collect::<Option<_>>()?;
        let words: Vec<String> = gains.iter().map(|(kp, kd)| format!("{kp},{kd}")).collect();
        let what = format!("--feedback {}", words.join(","));
        self.played(what, solution, histories, (Hold::Feedback, &gains))
    }

    fn inverted(&self, motion: &Motion) -> Option<Solution> {
        let Specification { arm, meshes, analysis, .. } = &self.problem.specification;
        let resources = Resources { memory_bytes: memory::available(), ..Resources::default() };
        invert_motion(arm, meshes, motion, analysis, &resources).ok()
    }

    /// Plays a command on the corners.
    fn played(
        &self,
        what: String,
        solution: &Solution,
        histories: (&Histories, f64),
        (hold, gains): (Hold, &[(f64, f64)]),
    ) -> Option<Help> {
        let Specification { arm, meshes, .. } = &self.problem.specification;
        let how = (hold, gains, Thinned::Yes);
        let command = self.problem.command(solution, histories, how).ok()?;
        let command = command.refined(arm, meshes).ok()?;
        let end_s = command.end_s;
        let nominal = command.plant((arm, meshes), (0.0, 1.0, end_s), &[]).ok()?;
        let takes_off = self.options.takes_off(&self.problem.specification);
        let command = if takes_off { command.less(nominal.error_m) } else { command };
        let of_corner = |values: &&[Option<f64>]| {
            let own = self.plants.with(values).ok()?;
            let played = command.plant((&own.arm, &own.meshes), (0.0, 1.0, end_s), &[]);
            played.ok().map(|played| played.strays)
        };
        let strays: Vec<Strays> = self.corners.par_iter().map(of_corner).collect::<Option<_>>()?;
        let worst = |measure| strays.iter().map(|own| own.size_m(measure)).fold(0.0, f64::max);
        Some(Help {
            what,
            tip_error_m: worst(Measure::TipError),
            rest_vibration_m: worst(Measure::RestVibration),
            drift_m: worst(Measure::Drift),
        })
    }
}

/// Factor on the duration at which the tip's acceleration hardly excites a frequency: the first minimum of |A(ω)| beyond
/// the motion itself.
fn quiet_factor(solution: &Solution, omega_rad_s: f64) -> Option<f64> {
    let grid = solution.grid;
    let amplitude = |factor: f64| {
        let phase = |k: usize| factor * omega_rad_s * grid.step_s * k as f64;
        let of_axis = |samples: &[f64]| {
            let sum = |part: fn(f64) -> f64| {
                samples.iter().enumerate().map(|(k, a)| a * part(phase(k))).sum::<f64>()
            };
            let [cos, sin] = [sum(libm::cos), sum(libm::sin)];
            cos * cos + sin * sin
        };
        solution.tip.iter().map(|axis| of_axis(&axis.acceleration_m_s2)).sum::<f64>().sqrt()
    };
    let own = amplitude(1.0);
    let factors = (0..=STEPS).map(|k| 1.0 + LONGER * f64::from(k));
    let tried: Vec<(f64, f64)> = factors.map(|factor| (factor, amplitude(factor))).collect();
    let is_least = |three: &&[(f64, f64)]| {
        let [before, own, after] = [0, 1, 2].map(|k| three[k].1);
        own <= before && own <= after
    };
    let quiet = tried.windows(3).filter(|three| three[1].1 < QUIET * own);
    quiet.into_iter().find(is_least).map(|three| three[1].0)
}
