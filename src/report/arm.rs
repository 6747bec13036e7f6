//! Figures of an arm over time: of one run, or of several beside each other.

use std::fmt::Write as _;

use super::axis::{Axis, TIME, is_extreme};
use super::bending::{Interpolation, deflections, map, with_colour};
use super::figure::{Curve, Figure, Figures, Stroke};
use super::limited::{LIMITED, Turning};
use super::view::{inside, lead_and_lag, start_and_stop};
use super::words::formula;
use crate::motion::Prescribed;
use crate::numeric::largest;
use crate::result::{StoredArm, StoredJoint};
use crate::text::significant;

/// Time shown before and after the path, in multiples of the largest lead and lag, and over its duration at least.
const AROUND: f64 = 1.7;
const SHORTEST: f64 = 0.15;

/// Colours of the style sheet.
const COLOURS: usize = 6;

/// Colours of the runs beside the first one; those before are of torques.
const BESIDE: [usize; 3] = [3, 5, 6];

/// All figures of an arm's runs.
pub(super) fn arm_figures(arms: &[StoredArm]) -> Figures {
    let shown = Shown::of(arms);
    let joints = 0..shown.first.joints.len();
    let mut figures = Figures::default();
    joints.clone().for_each(|joint| figures.add(Ok(shown.torque(joint))));
    figures.add(Ok(shown.tip()));
    shown.strays().into_iter().for_each(|figure| figures.add(Ok(figure)));
    for joint in joints.clone() {
        figures.add(Ok(shown.angle(joint)));
        for figure in shown.limited(joint) {
            figures.add(Ok(figure));
        }
    }
    figures.add(shown.bent_angles());
    joints.for_each(|link| figures.add(shown.waves(link)));
    figures.add(shown.root_moments());
    figures
}

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
    fn curve(&self, name: &str, stroke: Stroke, times_s: &[f64], history: &[f64]) -> Curve {
        let samples = inside(times_s, self.span_s.0, self.span_s.1);
        Curve::new(name, stroke, &times_s[samples.clone()], &history[samples])
    }

    /// A line for each run and each of the `names`, of which there is something: times in s and values.
    fn each(
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

    fn figure(
        &self,
        id: String,
        title: &str,
        caption: String,
        quantity: (&str, &str),
        curves: Vec<Curve>,
    ) -> Figure {
        Figure::of_curves(id, title, caption, self.time_axis(), quantity, curves)
    }

    fn time_axis(&self) -> Axis {
        Axis::linear(TIME, "s", self.span_s.0..self.span_s.1)
    }

    /// `joint 1`, `joint 2`, ….
    fn numbered(&self, what: &str) -> Vec<String> {
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

    fn torque(&self, joint: usize) -> Figure {
        let own = &self.first.joints[joint];
        let peak = |history: &[f64]| significant(largest(history), 4);
        let mut caption = format!("Torque at most {} N m.", peak(&own.torque_n_m));
        if let Some(rigid) = &own.rigid_torque_n_m {
            // Writing to a string cannot fail.
            let _ = write!(caption, " Were the links rigid, it would be {} N m.", peak(rigid));
        }
        let mut curves = self.of_joint(joint, |j| &j.torque_n_m, |j| j.rigid_torque_n_m.as_ref());
        if let Some(motor) = &own.motor {
            let (times_s, torque) = (&self.first.times_s, &motor.torque_n_m);
            curves.push(self.curve("motor", Stroke::Solid(4), times_s, torque));
            let motor = peak(torque);
            let _ = write!(caption, " On its side of the drive the motor gives up to {motor} N m.");
        }
        let limits = &own.limits;
        for (limit, whose, colour) in
            [(limits.torque_n_m, "", 1), (limits.motor_torque_n_m, "motor's", 4)]
        {
            caption.push_str(&Curve::add_limit(&mut curves, limit, (whose, "N m"), colour));
        }
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

    fn angle(&self, joint: usize) -> Figure {
        let curves = self.of_joint(joint, |j| &j.angle_rad, |j| j.rigid_angle_rad.as_ref());
        let against = if joint == 0 { "x" } else { "the tip of the link before" };
        let caption = format!("Angle that an encoder sees: of the link's root against {against}.");
        let title = format!("Angle of joint {}{}", joint + 1, self.name_of(joint));
        let id = format!("angle-{}", joint + 1);
        let figure = self.figure(id, &title, caption, ("angle", "rad"), curves);
        figure.by(formula::JOINT_ANGLE)
    }

    /// What else of a joint and its motor has a limit.
    fn limited(&self, joint: usize) -> Vec<Figure> {
        let what = format!("joint {}{}", joint + 1, self.name_of(joint));
        let limits = &self.first.joints[joint].limits;
        let drawn = LIMITED.iter().filter_map(|topic| {
            let limit = (topic.limit)(limits)?;
            let own = |(run, (arm, name)): (usize, (&'a StoredArm, String))| {
                let history = (topic.of)(&Turning::from(&arm.joints[joint]))?;
                Some(self.curve(&name, run_stroke(run), &arm.times_s, &history))
            };
            let curves: Vec<Curve> =
                self.named("flexible arm").enumerate().filter_map(own).collect();
            let id = format!("{}-{}", topic.id, joint + 1);
            Some(topic.figure((id, &what), self.time_axis(), curves, limit))
        });
        drawn.collect()
    }

    /// What bending adds to the joint angles.
    fn bent_angles(&self) -> Result<Figure, String> {
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

    fn tip(&self) -> Figure {
        let names = ["x", "y"].map(str::to_owned);
        let curves = self.each(&names, |arm, axis| Some((&arm.times_s, arm.tip_m[axis].clone())));
        let way_m = significant(largest(&from_start_m(self.first)), 4);
        let caption = format!("Place of the tip; it gets up to {way_m} m away from its start.");
        let figure =
            self.figure("tip".to_owned(), "Place of the tip", caption, ("place", "m"), curves);
        figure.by(formula::ARM_TIP)
    }

    /// How far the tips of the other runs are from the place that the path of one run wants. The tip of that run is not
    /// drawn: its error is among the errors of the run.
    fn strays(&self) -> Option<Figure> {
        let rigid = self.rigid()?;
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

    /// Waves along a link: the bending moment, or the deflection where it was not written.
    fn waves(&self, link: usize) -> Result<Figure, String> {
        let arm = self.first;
        let own = &arm.links[link];
        let (name, unit, what, formula, mut nodes) = if let Some(moments) = own.moments_n_m.clone()
        {
            ("moment", "N m", "bending moment", formula::ARM_MOMENT, moments)
        } else {
            let what = "deflection from the chord";
            ("deflection", "m", what, formula::ARM_DEFLECTION, deflections(arm, link))
        };
        let words = format!("link {}{}", link + 1, self.name_of(link));
        if nodes.times_s.len() < 2 {
            return Err(format!("waves along {words}, since but one moment was written"));
        }
        if is_extreme(nodes.peak()) {
            let why = "since what bends is too large or too small to be drawn";
            return Err(format!("waves along {words}, {why}"));
        }
        for history in &mut nodes.histories {
            let rest = history[0];
            for value in history {
                *value -= rest;
            }
        }
        let peak = significant(nodes.peak(), 3);
        let rest = if has_weight(arm) { ", less what it is at rest at first," } else { "" };
        let caption = format!(
            "The {what}{rest} over time (to the right) and along the link (up, from its joint), below the tip's \
             distance from where it begins; it reaches {peak} {unit}. Colours go by the square root, so that weak waves \
             are seen too."
        );
        let tip =
            self.curve("tip from its start", Stroke::Solid(6), &arm.times_s, &from_start_m(arm));
        let above = Axis::around("tip", "m", tip.points.iter().map(|(_, value)| value));
        let (map, x) = map(self.span_s, &nodes, &own.nodes_m, (name, unit));
        let title = format!("Waves along {words}");
        let figure =
            Figure::new(format!("waves-{}", link + 1), &title, caption, self.time_axis(), x);
        let marks = arm.moving_s.map(start_and_stop).unwrap_or_default();
        Ok(Figure { map: Some(map), strip: Some((tip, above)), marks, ..figure }
            .by(with_colour(formula, name)))
    }

    /// The bending moment at the root of each link.
    fn root_moments(&self) -> Result<Figure, String> {
        let mut curves = self.each(&self.numbered("link"), |arm, link| {
            let moments = arm.links[link].moments_n_m.as_ref()?;
            Some((&moments.times_s, moments.histories[0].clone()))
        });
        if curves.is_empty() {
            return Err(
                "bending moments, since they were not written: solve --moments writes them"
                    .to_owned(),
            );
        }
        let mut caption =
            "Bending moment at the root of each link, where it is largest as a rule.".to_owned();
        for (link, joint) in self.first.joints.iter().enumerate() {
            let (whose, limit) = (format!("link {}:", link + 1), joint.limits.bending_moment_n_m);
            let colour = 1 + link % COLOURS;
            caption.push_str(&Curve::add_limit(&mut curves, limit, (&whose, "N m"), colour));
        }
        let title = "Bending moments at the roots";
        let quantity = ("moment", "N m");
        let figure = self.figure("root-moments".to_owned(), title, caption, quantity, curves);
        Ok(figure.by(formula::ROOT_MOMENTS))
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
fn from_start_m(arm: &StoredArm) -> Vec<f64> {
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
