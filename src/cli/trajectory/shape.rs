//! Motions that leave modes at rest: shaped ones, and durations at a zero of the motion's spectrum.

use std::f64::consts::TAU;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use rayon::prelude::*;

use crate::cli::modes::{Wanted, computed, level};
use crate::cli::terminal::{Exit, Failure};
use crate::motion::{Excitation, FEWEST_STEPS, Profile, Shaper, Shaping};
use crate::numeric::extremes;
use crate::response::{PoseMode, SettledModes, reached};
use crate::result::{Along, ModesResult};
use crate::spec::{Specification, Uncertain};
use crate::text::{plain, significant};

const VIBRATIONS: &str = "Vibrations";

/// Poses along a way whose modes count.
const POSES: usize = 9;

/// Largest phase ωT of a quiet duration, 64 periods.
const MOST_PHASE: f64 = 64.0 * TAU;

fn shapings() -> impl TypedValueParser<Value = Shaping> {
    let named = |name: String| Shaping::ALL.into_iter().find(|own| own.name() == name);
    PossibleValuesParser::new(Shaping::ALL.map(Shaping::name))
        .try_map(move |name| named(name).ok_or("must be the name of a shaper"))
}

/// Options of motions that excite modes little.
#[derive(Debug, Args)]
pub(super) struct ShapeArgs {
    /// Shape the motion for the modes of --of: it lasts longer, and leaves little vibration also where the frequencies
    /// are a few percent off. zv, zvd and ei need 1/2, 1 and 1 period of a mode, 2hump 1 1/2. For several modes
    /// the shapers follow each other. Each move from stop to stop is shaped. --duration is that without the shaper.
    #[arg(long, help_heading = VIBRATIONS, value_name = "SHAPER", value_parser = shapings())]
    #[arg(requires_all = ["of", "link"])]
    shape: Option<Shaping>,

    /// Modes that ring: with the hub, carriage or rotors held, if a drive holds the position, or free, if it applies a
    /// torque or a force.
    #[arg(long, help_heading = VIBRATIONS, value_name = "STATE", value_enum, requires = "shape")]
    of: Option<State>,

    /// Find the shortest duration at which the motion does not excite the mode, within all limits, if there are any. With
    /// intervals, by --uncertain or in the link file, choose the duration near it that excites the worst link of the
    /// intervals least. The motion has one move.
    #[arg(long, help_heading = VIBRATIONS, value_name = "STATE", value_enum, requires = "link")]
    #[arg(conflicts_with_all = ["shape", "duration"])]
    quiet_at: Option<State>,

    /// Interval of a value for --quiet-at, as in robust: KEY=±5%; repeatable [default: [uncertainty] of the link file].
    #[arg(long, help_heading = VIBRATIONS, value_name = "KEY=INTERVAL")]
    uncertain: Vec<Uncertain>,

    /// Numbers of the modes, as `flexlink modes` prints them [default: 1, or the first after the swings of an arm with
    /// free joints]. --quiet-at takes one.
    #[arg(long, help_heading = VIBRATIONS, value_name = "N", value_delimiter = ',')]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=100))]
    modes: Vec<u16>,
}

/// State of the joints in which modes ring.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum State {
    Held,
    Free,
}

/// Shaper and modes of the options.
pub(super) struct Shape {
    shaping: Option<Shaping>,
    state: State,
    modes: Vec<Mode>,
    pub(super) shaper: Shaper,
}

/// A mode in all poses on the way.
struct Mode {
    number: usize,
    /// Undamped frequency in rad/s and damping ratio in each pose.
    in_poses: Vec<(f64, f64)>,
    /// Undamped frequencies in rad/s of all plants of the intervals, in each pose.
    uncertain_rad_s: Vec<f64>,
}

impl Mode {
    /// Largest excitation by a motion of this duration in s.
    fn left(&self, excitation: &Excitation, duration_s: f64) -> f64 {
        let own = self.in_poses.iter().map(|own| &own.0).chain(&self.uncertain_rad_s);
        own.map(|omega_rad_s| excitation.at(omega_rad_s * duration_s)).fold(0.0, f64::max)
    }

    /// Smallest and largest frequency in rad/s.
    fn range_rad_s(&self) -> [f64; 2] {
        extremes(&self.in_poses.iter().map(|own| own.0).collect::<Vec<_>>())
    }

    /// Frequency in rad/s and damping ratio in the middle of their ranges: the largest detuning is the least possible.
    fn middle(&self) -> (f64, f64) {
        let ratios = extremes(&self.in_poses.iter().map(|own| own.1).collect::<Vec<_>>());
        let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
        (middle(self.range_rad_s()), middle(ratios))
    }
}

impl ShapeArgs {
    pub(super) fn is_given(&self) -> bool {
        self.shape.is_some() || self.quiet_at.is_some()
    }

    pub(super) fn is_quiet(&self) -> bool {
        self.quiet_at.is_some()
    }

    /// An option without a use, and those that have one for it.
    pub(super) fn idle(&self) -> Option<(&'static str, &'static str)> {
        if !self.is_given() && !self.modes.is_empty() {
            return Some(("--modes", "--shape or --quiet-at"));
        }
        let is_idle = self.quiet_at.is_none() && !self.uncertain.is_empty();
        is_idle.then_some(("--uncertain", "--quiet-at"))
    }

    /// The intervals of --uncertain.
    pub(super) fn uncertain(&self) -> &[Uncertain] {
        &self.uncertain
    }

    /// Shaper and modes for a way of the tip; `None` without these options. `plants` are those of the intervals.
    pub(super) fn shape(
        &self,
        own: Option<&Specification>,
        along: Along,
        plants: &[Specification],
    ) -> Result<Option<Shape>, Failure> {
        let Some((state, own)) = self.of.or(self.quiet_at).zip(own) else { return Ok(None) };
        if let (Some(_), [_, _, ..]) = (self.quiet_at, &self.modes[..]) {
            let message = "--modes = several modes, but must be one with --quiet-at";
            let hint = "a duration leaves one mode alone; --shape shapes for several";
            return Err(Failure::new(Exit::Usage, &message, Some(hint)));
        }
        let swings = if state == State::Free { own.arm.pick(0, own.arm.links().len()) } else { 0 };
        let numbers: Vec<usize> = self.modes.iter().map(|number| usize::from(*number)).collect();
        let numbers = if numbers.is_empty() { vec![1 + swings] } else { numbers };
        if let Some(again) = (1..numbers.len()).find(|k| numbers[..*k].contains(&numbers[*k])) {
            let message = format!("--modes = {} twice, but must differ", numbers[again]);
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        let mut modes = modes_along(own, along, (state, &numbers))?;
        let of_plant = |plant: &Specification| modes_along(plant, along, (state, &numbers));
        let of_plants: Vec<_> = plants.par_iter().map(of_plant).collect::<Result<_, _>>()?;
        for own in &of_plants {
            for (mode, own) in modes.iter_mut().zip(own) {
                mode.uncertain_rad_s.extend(own.in_poses.iter().map(|own| own.0));
            }
        }
        let mut shaper = Shaper::default();
        for mode in self.shape.iter().flat_map(|_| &modes) {
            let (omega_rad_s, ratio) = mode.middle();
            let own = self.shape.and_then(|shaping| Shaper::new(shaping, omega_rad_s, ratio));
            shaper = shaper.and(&own.ok_or_else(|| not_ringing(state, mode.number))?);
        }
        Ok(Some(Shape { shaping: self.shape, state, modes, shaper }))
    }
}

/// The modes of these numbers in all poses on a way.
fn modes_along(
    own: &Specification,
    along: Along,
    (state, numbers): (State, &[usize]),
) -> Result<Vec<Mode>, Failure> {
    let count = numbers.iter().copied().max().unwrap_or(1);
    let mode = |number: &usize| Mode {
        number: *number,
        in_poses: Vec::new(),
        uncertain_rad_s: Vec::new(),
    };
    let mut modes: Vec<Mode> = numbers.iter().map(mode).collect();
    for pose in poses(own, along)? {
        let found = computed(own, pose.as_deref(), count, Wanted::Modes)?;
        // Modes with weight have no ratios of their own: those without it are nearly the same.
        let damped = match own.arm.links() {
            [one] => Some(level((&one.link, own.mesh()), count)?),
            _ => None,
        };
        for mode in &mut modes {
            let rings = |found: &ModesResult, first: usize| {
                let SettledModes { modes, .. } = match state {
                    State::Held => &found.held,
                    State::Free => &found.free,
                };
                modes.get(first + mode.number - 1).cloned()
            };
            // The swing of one link with weight is its mode 0.
            let swings = own.arm.pick(usize::from(pose.is_some() && state == State::Free), 0);
            let with_ratio =
                rings(&found, swings).map(|PoseMode { square_per_s2, damping_ratio, .. }| {
                    let ratio = damping_ratio.or_else(|| rings(damped.as_ref()?, 0)?.damping_ratio);
                    (square_per_s2, ratio)
                });
            match with_ratio {
                Some((square, Some(ratio))) if square > 0.0 && (0.0..1.0).contains(&ratio) => {
                    mode.in_poses.push((square.sqrt(), ratio));
                }
                _ => return Err(not_ringing(state, mode.number)),
            }
        }
    }
    Ok(modes)
}

/// The poses along a way, as directions in rad of all links; `None` where the modes have no pose.
fn poses(own: &Specification, along: Along) -> Result<Vec<Option<Vec<f64>>>, Failure> {
    let shares = (0..POSES).map(|k| k as f64 / (POSES - 1) as f64);
    match along {
        Along::Arc(course) => {
            let link = own.link();
            if link.joint().slides() || !link.has_weight() {
                return Ok(vec![None]);
            }
            let start_rad = link.origin_rad().ok_or_else(|| {
                let message =
                    "start_angle is missing: modes with gravity depend on the link's direction";
                Failure::new(Exit::InputRefused, &message, Some("add it: --set start_angle=0"))
            })?;
            let [low_m, high_m] = extremes(&[&[0.0], course.stops_m()].concat());
            let direction =
                |share: f64| start_rad + (low_m + share * (high_m - low_m)) / link.rigid_tip();
            Ok(shares.map(|share| Some(vec![direction(share)])).collect())
        }
        Along::Curve(curve, outer_rad) => {
            let axis = own.arm.carriage().map_or([0.0; 2], |carriage| carriage.axis);
            let pose = |share: f64| {
                let arc_m = share * curve.length_m();
                let carriage_m = curve.carriage_at(arc_m).unwrap_or_default();
                let tip_m = curve.at(arc_m);
                let from_axis_m = [0, 1].map(|part| tip_m[part] - carriage_m * axis[part]);
                reached(&own.arm, from_axis_m, outer_rad).map(Some).ok_or_else(|| {
                    let [x, y] = tip_m.map(|part| significant(part, 4));
                    let message = format!("--path: the arm does not reach x = {x}, y = {y} m");
                    let hint = "use other points, elbow or --angles";
                    Failure::new(Exit::InputRefused, &message, Some(hint))
                })
            };
            shares.map(pose).collect()
        }
    }
}

fn not_ringing(state: State, number: usize) -> Failure {
    let state = state.word();
    let message =
        format!("{state} mode {number} does not vibrate, but --modes must be modes that do");
    let hint = "`flexlink modes` prints the modes, with --at in the poses of the motion";
    Failure::new(Exit::InputRefused, &message, Some(hint))
}

impl State {
    fn word(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::Free => "free",
        }
    }
}

impl Shape {
    /// Numbers of steps next to the zeros of a profile's spectrum at the mode, each with the least worst case of all poses
    /// and plants as far as halfway to the next zero; `None` if all durations count.
    pub(super) fn durations(&self, profile: Profile, step_s: f64) -> Option<Vec<usize>> {
        let mode = self.modes.first().filter(|_| self.shaping.is_none())?;
        let excitation = Excitation::of(profile);
        let in_steps = |phase: f64| whole(phase / (mode.middle().0 * step_s));
        let left = |steps: usize| mode.left(&excitation, steps as f64 * step_s);
        let zeros: Vec<usize> = excitation.quiet_phases(MOST_PHASE).map(in_steps).collect();
        let least = |number: usize| {
            let zero = zeros[number];
            let before = number.checked_sub(1).map_or(0, |before| zeros[before]);
            let from = before.midpoint(zero);
            let until = zeros.get(number + 1).map_or(zero, |next| next.midpoint(zero));
            let down = (from..zero).rev().map(|steps| (left(steps), steps));
            let up = (zero + 1..=until).map(|steps| (left(steps), steps));
            let own = (left(zero), zero);
            let lower = falls(own, down);
            if lower == own { falls(own, up).1 } else { lower.1 }
        };
        let mut steps: Vec<usize> =
            (0..zeros.len()).map(least).filter(|steps| *steps >= FEWEST_STEPS).collect();
        steps.dedup();
        Some(steps)
    }

    /// Refuses a step that is longer than the shaper of a mode: the samples do not show it.
    pub(super) fn check_step(&self, step_s: f64) -> Result<(), Failure> {
        let shaping = self.shaping.into_iter();
        let mut modes =
            shaping.flat_map(|shaping| self.modes.iter().map(move |own| (shaping, own)));
        let is_short = |(shaping, mode): &(Shaping, &Mode)| {
            let (omega_rad_s, ratio) = mode.middle();
            Shaper::new(*shaping, omega_rad_s, ratio).is_some_and(|own| own.duration_s() < step_s)
        };
        let Some((shaping, mode)) = modes.find(is_short) else { return Ok(()) };
        let (hertz, number) = (significant(mode.middle().0 / TAU, 4), mode.number);
        let message = format!(
            "--step = {} s is longer than {shaping} for mode {number}, {hertz} Hz, but must be shorter",
            plain(step_s)
        );
        Err(Failure::new(Exit::Usage, &message, Some("use lower --modes or a shorter --step")))
    }

    /// The modes, their frequencies and ratios.
    fn modes_text(&self) -> String {
        let mode = |mode: &Mode| {
            let (omega_rad_s, ratio) = mode.middle();
            let (hertz, ratio) = (significant(omega_rad_s / TAU, 4), significant(ratio, 2));
            let [low, high] = mode.range_rad_s().map(|own| significant(own / TAU, 4));
            let along = if low == high {
                String::new()
            } else {
                format!(" (the middle of {low} to {high} Hz on the way)")
            };
            let (state, number) = (self.state.word(), mode.number);
            format!("{state} mode {number}, {hertz} Hz{along}, damping ratio {ratio}")
        };
        self.modes.iter().map(mode).collect::<Vec<_>>().join("; ")
    }

    /// Note on the shaper of a motion of this duration in s, all in all; or on the distance of its profile's duration from a
    /// zero of the spectrum.
    pub(super) fn text(&self, profile: Profile, (profile_s, all_s): (f64, f64)) -> String {
        let modes = self.modes_text();
        let percent = |share: f64| significant(100.0 * share, 3);
        let Some(shaping) = self.shaping else {
            let mode = &self.modes[0];
            let excitation = Excitation::of(profile);
            let left = mode.left(&excitation, profile_s);
            let most =
                if mode.uncertain_rad_s.is_empty() { "" } else { " at most, in the intervals," };
            let omega_rad_s = mode.middle().0;
            let zeros = excitation.quiet_phases(MOST_PHASE).map(|phase| phase / omega_rad_s);
            let far = |zero_s: &f64| (zero_s - profile_s).abs();
            let zero_s = zeros.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or_default();
            let (zero, left) = (significant(zero_s, 5), percent(left));
            return format!(
                "quiet at {modes}: {profile} has a zero at {zero} s; |A|/ω is{most} {left} % of the travel"
            );
        };
        let left = |mode: &Mode| {
            let rings = mode.in_poses.iter().map(|own| self.shaper.residual(own.0, own.1));
            rings.fold(0.0, f64::max)
        };
        let left = self.modes.iter().map(left).fold(0.0, f64::max);
        let is_kept = self.modes.iter().all(|mode| mode.in_poses.len() == 1);
        let left = if is_kept {
            String::new()
        } else {
            format!("; on the way it leaves at most {} % of a mode's vibration", percent(left))
        };
        let (shaper_s, all_s) = (significant(self.shaper.duration_s(), 4), plain(all_s));
        format!(
            "{shaping} for {modes}: each move lasts {shaper_s} s longer, {all_s} s in all{left}"
        )
    }
}

/// The last of the numbers of steps that leave ever less.
fn falls(own: (f64, usize), more: impl Iterator<Item = (f64, usize)>) -> (f64, usize) {
    let step = |last: &mut (f64, usize), next: (f64, usize)| {
        let is_less = next.0 < last.0;
        *last = if is_less { next } else { *last };
        is_less.then_some(*last)
    };
    more.scan(own, step).last().unwrap_or(own)
}

/// The nearest whole number of steps.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
fn whole(steps: f64) -> usize {
    steps.round() as usize
}
