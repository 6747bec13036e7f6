//! Figures of an arm over time: of one run, or of several beside each other.

use std::fmt::Write as _;

use super::axis::{Axis, TIME};
use super::bending::Interpolation;
use super::figure::{Curve, Figure, Stroke};
use super::limited::{LIMITED, Limited, Turning};
use super::view::{inside, lead_and_lag, peak_words, reading};
use super::words::formula;
use crate::motion::Prescribed;
use crate::numeric::largest;
use crate::result::{StoredArm, StoredJoint};
use crate::text::significant;

/// Time shown before and after the path, in multiples of the largest lead and lag, and over its duration at least.
const AROUND: f64 = 1.7;
const SHORTEST: f64 = 0.15;

/// Colours of the style sheet.
pub(super) const COLOURS: usize = 6;

/// Colours of the runs beside the first one; those before are of torques.
const BESIDE: [usize; 3] = [3, 5, 6];

/// Runs of one arm, and the time that their figures show.
pub(super) struct Shown<'a> {
    /// The run that the page is of.
    pub(super) first: &'a StoredArm,
    arms: &'a [StoredArm],
    /// First and last time shown in s.
    pub(super) span_s: (f64, f64),
}

impl<'a> Shown<'a> {
    /// Finds the time in which the path moves and the torques act; without a path, all.
    pub(super) fn of(arms: &'a [StoredArm]) -> Self {
        let first = &arms[0];
        let times = &first.times_s;
        let (mut from, mut until) = (times[0], times[times.len() - 1]);
        if let Some(moving_s) = first.moving_s {
            let short = SHORTEST * (moving_s.1 - moving_s.0);
            let most = |name: &str| {
                let all = first.joints.iter().filter_map(|joint| joint.reading(name));
                (AROUND * all.fold(0.0, f64::max)).max(short)
            };
            from = from.max(moving_s.0 - most("lead_s"));
            until = until.min(moving_s.1 + most("lag_s"));
        }
        let samples = inside(times, from, until);
        Self { first, arms, span_s: (times[samples.start], times[samples.end - 1]) }
    }

    /// The runs, each with the name of its line: `own` if there is but one.
    pub(super) fn named(&self, own: &str) -> impl Iterator<Item = (&'a StoredArm, String)> {
        let is_alone = self.arms.len() == 1;
        let own = own.to_owned();
        self.arms.iter().map(move |arm| {
            let name = if is_alone { own.clone() } else { arm.name.clone() };
            (arm, name)
        })
    }

    /// The first run that the rigid arm was written of.
    pub(super) fn rigid(&self) -> Option<&'a StoredArm> {
        let is_whole = |arm: &&StoredArm| arm.joints.iter().all(|j| j.rigid_angle_rad.is_some());
        self.arms.iter().find(is_whole)
    }

    /// A line over the time shown.
    pub(super) fn curve(
        &self,
        name: &str,
        stroke: Stroke,
        times_s: &[f64],
        history: &[f64],
    ) -> Curve {
        let samples = inside(times_s, self.span_s.0, self.span_s.1);
        Curve::new(name, stroke, &times_s[samples.clone()], &history[samples])
    }

    /// A line for each run and each of the `names`, of which there is something: times in s and values.
    pub(super) fn each(
        &self,
        names: &[String],
        of: impl Fn(&'a StoredArm, usize) -> Option<(&'a [f64], Vec<f64>)>,
    ) -> Vec<Curve> {
        let mut curves = Vec::new();
        for (run, (arm, beside)) in self.named("").enumerate() {
            for (k, name) in names.iter().enumerate() {
                let Some((times_s, history)) = of(arm, k) else { continue };
                let words =
                    if beside.is_empty() { name.clone() } else { format!("{name}, {beside}") };
                let colour = 1 + k % COLOURS;
                let stroke = if run == 0 { Stroke::Solid(colour) } else { Stroke::Dashed(colour) };
                curves.push(self.curve(&words, stroke, times_s, &history));
            }
        }
        curves
    }

    pub(super) fn figure(
        &self,
        id: String,
        title: &str,
        caption: String,
        quantity: (&str, &str),
        curves: Vec<Curve>,
    ) -> Figure {
        Figure::of_curves(id, title, caption, self.time_axis(), quantity, curves)
    }

    pub(super) fn time_axis(&self) -> Axis {
        Axis::linear(TIME, "s", self.span_s.0..self.span_s.1)
    }

    /// `joint 1`, `joint 2`, ….
    pub(super) fn numbered(&self, what: &str) -> Vec<String> {
        (1..=self.first.joints.len()).map(|number| format!("{what} {number}")).collect()
    }

    /// `, fore`; nothing of a link without a name.
    pub(super) fn name_of(&self, link: usize) -> String {
        let name = &self.first.links[link].name;
        if *name == (link + 1).to_string() { String::new() } else { format!(", {name}") }
    }

    /// One quantity of a joint: of every run, and of the rigid arm.
    fn of_joint(
        &self,
        joint: usize,
        own: fn(&StoredJoint) -> &Vec<f64>,
        rigid: fn(&StoredJoint) -> Option<&Vec<f64>>,
    ) -> Vec<Curve> {
        let runs = self.named("flexible arm").enumerate().map(|(k, (arm, name))| {
            self.curve(&name, run_stroke(k), &arm.times_s, own(&arm.joints[joint]))
        });
        let mut curves: Vec<Curve> = runs.collect();
        let known = self.arms.iter().find_map(|arm| Some((arm, rigid(&arm.joints[joint])?)));
        if let Some((arm, rigid)) = known {
            curves.push(self.curve("rigid arm", Stroke::Dashed(2), &arm.times_s, rigid));
        }
        curves
    }

    pub(super) fn torque(&self, joint: usize) -> Figure {
        let own = &self.first.joints[joint];
        let peak = |name: &str, history: &[f64]| peak_words(own.reading(name), history);
        let mut caption = format!("At most {} N m.", peak("peak_torque_n_m", &own.torque_n_m));
        if let Some(rigid) = &own.rigid_torque_n_m {
            let rigid = peak("peak_rigid_torque_n_m", rigid);
            // Writing to a string cannot fail.
            let _ = write!(caption, " Were the links rigid, it would be {rigid} N m.");
        }
        let mut curves = self.of_joint(joint, |j| &j.torque_n_m, |j| j.rigid_torque_n_m.as_ref());
        caption.push_str(&Curve::add_limit(&mut curves, own.limits.torque_n_m, ("", "N m"), 1));
        let title = format!("Torque of joint {}{}", joint + 1, self.name_of(joint));
        let id = format!("torque-{}", joint + 1);
        let figure = self.figure(id, &title, caption, ("torque", "N m"), curves);
        let timing = ["lead_s", "lag_s"].map(|name| own.reading(name));
        let spans = self.first.moving_s.map(|moving_s| lead_and_lag(moving_s, timing));
        let formula = if self.first.moving_s.is_some() {
            formula::ARM_TORQUE
        } else {
            formula::TORQUE_PLAYED
        };
        Figure { spans: spans.unwrap_or_default(), ..figure }.by(formula)
    }

    pub(super) fn angle(&self, joint: usize) -> Figure {
        let curves = self.of_joint(joint, |j| &j.angle_rad, |j| j.rigid_angle_rad.as_ref());
        let against = if joint == 0 { "x" } else { "the tip of the link before" };
        let caption = format!("Angle that an encoder sees: of the link's root against {against}.");
        let title = format!("Angle of joint {}{}", joint + 1, self.name_of(joint));
        let id = format!("angle-{}", joint + 1);
        let figure = self.figure(id, &title, caption, ("angle", "rad"), curves);
        figure.by(formula::JOINT_ANGLE)
    }

    /// What else of a joint and its motor has a limit.
    pub(super) fn limited(&self, joint: usize) -> Vec<Figure> {
        let limits = &self.first.joints[joint].limits;
        let has_limit = |topic: &&Limited| (topic.limit)(limits).is_some();
        LIMITED.iter().filter(has_limit).filter_map(|topic| self.turning(joint, topic)).collect()
    }

    /// A quantity of a joint or its motor, where the first run has it.
    pub(super) fn turning(&self, joint: usize, topic: &Limited) -> Option<Figure> {
        let first = &self.first.joints[joint];
        (topic.of)(&Turning::from(first))?;
        let own = |(run, (arm, name)): (usize, (&'a StoredArm, String))| {
            let history = (topic.of)(&Turning::from(&arm.joints[joint]))?;
            Some(self.curve(&name, run_stroke(run), &arm.times_s, &history))
        };
        let curves: Vec<Curve> = self.named("flexible arm").enumerate().filter_map(own).collect();
        let what = format!("joint {}{}", joint + 1, self.name_of(joint));
        let (id, limit) = (format!("{}-{}", topic.id, joint + 1), (topic.limit)(&first.limits));
        Some(topic.figure((id, &what), self.time_axis(), (curves, limit), &first.readings))
    }

    /// What bending adds to the joint angles.
    pub(super) fn bent_angles(&self) -> Result<Figure, String> {
        let why = "what bending adds to the joint angles, since the rigid arm's were not written";
        let rigid = self.rigid().ok_or(why)?;
        let curves = self.each(&self.numbered("joint"), |arm, joint| {
            let straight = rigid.joints[joint].rigid_angle_rad.as_deref()?;
            let straight = at_times(&arm.times_s, (&rigid.times_s, straight));
            let pairs = arm.joints[joint].angle_rad.iter().zip(straight);
            Some((&arm.times_s, pairs.map(|(own, rigid)| 1e3 * (own - rigid)).collect()))
        });
        let weight = if has_weight(self.first) { " and sag" } else { "" };
        let caption = format!(
            "By how much each joint turns beyond the rigid arm's, so that the tip is where it should be although \
             the links bend{weight}."
        );
        let title = "What bending adds to the joint angles";
        let quantity = ("angle", "mrad");
        let figure = self.figure("bending-angles".to_owned(), title, caption, quantity, curves);
        Ok(figure.by(formula::BENDING_ANGLES))
    }

    pub(super) fn tip(&self) -> Figure {
        let names = ["x", "y"].map(str::to_owned);
        let mut curves =
            self.each(&names, |arm, axis| Some((&arm.times_s, arm.tip_m[axis].clone())));
        let way_m = reading(&self.first.readings, "farthest_m");
        let way_m = peak_words(way_m, &from_start_m(self.first));
        let mut caption = format!("Place of the tip; it gets up to {way_m} m away from its start.");
        if let Some(target) = &self.first.target {
            for (axis, history) in names.iter().zip(&target.wanted_m) {
                let name = format!("wanted {axis}");
                let colour = 1 + (2 + curves.len()) % COLOURS;
                curves.push(self.curve(&name, Stroke::Dashed(colour), &target.times_s, history));
            }
            caption.push_str(" Dashed: the target.");
        }
        let figure =
            self.figure("tip".to_owned(), "Place of the tip", caption, ("place", "m"), curves);
        figure.by(formula::ARM_TIP)
    }

    /// How far the tips of the other runs are from the place that the path of one run wants. The tip of that run is not
    /// drawn: its error is among the errors of the run.
    pub(super) fn strays(&self) -> Option<Figure> {
        let Some(rigid) = self.rigid() else { return self.off_target() };
        let wanted = rigid_tip_m(rigid)?;
        let mut worst = Vec::new();
        let runs = self.named("").enumerate().filter(|(_, (arm, _))| !std::ptr::eq(*arm, rigid));
        let curves = runs.map(|(k, (arm, name))| {
            let [x, y] = [0, 1].map(|axis| at_times(&arm.times_s, (&rigid.times_s, &wanted[axis])));
            let off = (0..arm.times_s.len())
                .map(|k| libm::hypot(arm.tip_m[0][k] - x[k], arm.tip_m[1][k] - y[k]));
            let off: Vec<f64> = off.collect();
            worst.push(format!("{name} {} m", significant(largest(&off), 2)));
            self.curve(&name, run_stroke(k), &arm.times_s, &off)
        });
        let curves: Vec<Curve> = curves.collect();
        if curves.is_empty() {
            return None;
        }
        let from = match rigid.prescribed {
            Some(Prescribed::Angles) => "the tip of the rigid arm with the same directions",
            _ => "where it is wanted",
        };
        let caption = format!("Distance of the tip from {from}, at most: {}.", worst.join(", "));
        let title = "How far the tip strays";
        let figure = self.figure("tip-error".to_owned(), title, caption, ("distance", "m"), curves);
        Some(figure.by(formula::ARM_TIP_ERROR))
    }

    /// How far the tip of a simulation is from its target.
    fn off_target(&self) -> Option<Figure> {
        let (target, first) = (self.first.target.as_ref()?, &self.first.readings);
        let worst_m = peak_words(reading(first, "tip_error_worst_m"), &target.error_m);
        let caption = format!("Distance of the tip from its target, at most {worst_m} m.");
        let error = self.curve("distance", Stroke::Solid(4), &target.times_s, &target.error_m);
        let (id, title) = ("tip-error".to_owned(), "How far the tip is from its target");
        let figure = self.figure(id, title, caption, ("distance", "m"), vec![error]);
        Some(figure.by(formula::ARM_TIP_ERROR))
    }
}

/// How a run's line is drawn: those beside the first are dashed, so that equal lines are seen.
pub(super) fn run_stroke(run: usize) -> Stroke {
    match run.checked_sub(1) {
        None => Stroke::Solid(1),
        Some(beside) => Stroke::Dashed(BESIDE[beside % BESIDE.len()]),
    }
}

/// True if gravity acts in the plane of the arm.
pub(super) fn has_weight(arm: &StoredArm) -> bool {
    largest(&arm.gravity_m_s2) > 0.0
}

/// A history at other times.
fn at_times(times_s: &[f64], (own_s, history): (&[f64], &[f64])) -> Vec<f64> {
    let at = |time_s: &f64| Interpolation::of(own_s, *time_s).mix(|k| history[k]);
    times_s.iter().map(at).collect()
}

/// Distance of the tip from its first place in m.
pub(super) fn from_start_m(arm: &StoredArm) -> Vec<f64> {
    let [x, y] = &arm.tip_m;
    x.iter().zip(y).map(|(at_x, at_y)| libm::hypot(at_x - x[0], at_y - y[0])).collect()
}

/// Directions of the rigid arm's links in rad at a sample, where its joint angles are known.
pub(super) fn rigid_directions_rad(arm: &StoredArm, sample: usize) -> Option<Vec<f64>> {
    let mut direction = 0.0;
    let turned = |joint: &StoredJoint| {
        direction += joint.rigid_angle_rad.as_ref()?[sample];
        Some(direction)
    };
    arm.joints.iter().map(turned).collect()
}

/// x and y of the rigid arm's tip in m: the wanted ones where the path prescribes the tip.
pub(super) fn rigid_tip_m(arm: &StoredArm) -> Option<[Vec<f64>; 2]> {
    let mut tip_m = [Vec::new(), Vec::new()];
    for sample in 0..arm.times_s.len() {
        let mut at = [0.0; 2];
        for (angle, own) in rigid_directions_rad(arm, sample)?.iter().zip(&arm.links) {
            at[0] += own.link.length_m() * libm::cos(*angle);
            at[1] += own.link.length_m() * libm::sin(*angle);
        }
        tip_m.iter_mut().zip(at).for_each(|(axis, at)| axis.push(at));
    }
    Some(tip_m)
}
