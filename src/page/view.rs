//! Runs for a page, and the time shown in its figures.

use std::borrow::Cow;
use std::f64::consts::TAU;
use std::ops::Range;

use super::axis::{Axis, TIME};
use super::figure::{Curve, Figure, Mark, Span, Stroke};
use super::words::{Of, own};
use crate::link::Link;
use crate::modal::natural_frequencies;
use crate::numeric::largest;
use crate::result::{StoredArc, StoredJoint, StoredRun};
use crate::text::significant;

/// Shown time before and after the motion, in multiples of the largest lead and lag, and its minimum relative to the
/// duration.
const AROUND: f64 = 1.7;
const SHORTEST: f64 = 0.15;

/// Minimum time shown after the motion of a link, in periods of the first mode.
const PERIODS: f64 = 4.0;

/// Share of the peak above which a torque counts as acting, for runs of a link without a wanted motion.
const CALM: f64 = 1e-3;

/// Number of colours in the style sheet.
pub(super) const COLOURS: usize = 6;

/// Colours of the runs besides the first one; the other colours are of torques.
const BESIDE: [usize; 3] = [3, 5, 6];

/// Runs of a link or of an arm, and the time shown in their figures: the motion with some time before and after it.
#[derive(Debug, Clone)]
pub(super) struct View<'a> {
    /// The run of the page, then the runs beside it.
    pub(super) runs: &'a [StoredRun],
    /// The run of a single link.
    pub(super) link: Option<Single<'a>>,
    /// First and last time shown in s.
    pub(super) span_s: (f64, f64),
    /// Period of the first mode in s, for a run of one link that vibrates.
    pub(super) period_s: Option<f64>,
}

/// A run of a single link, with its mesh and the motion of its tip along the arc.
#[derive(Debug, Clone, Copy)]
pub(super) struct Single<'a> {
    pub(super) times_s: &'a [f64],
    pub(super) joint: &'a StoredJoint,
    pub(super) link: &'a Link,
    pub(super) arc: &'a StoredArc,
    pub(super) readings: &'a [(String, f64)],
}

impl<'a> Single<'a> {
    /// `None` for an arm of several links.
    pub(super) fn of(run: &'a StoredRun) -> Option<Self> {
        let StoredRun { times_s, joints, links, arc, readings, .. } = run;
        let (joint, link) = (&joints[0], &links[0].link);
        arc.as_ref().map(|arc| Self { times_s, joint, link, arc, readings })
    }
}

impl<'a> View<'a> {
    /// Finds the time in which tips and torques of all runs act; for simulated arms alone, all of it.
    pub(super) fn of(runs: &'a [StoredRun]) -> Self {
        let all: Vec<Self> = runs.chunks(1).map(Self::of_one).collect();
        let acting: Vec<&Self> = all.iter().filter(|own| own.acts()).collect();
        let spans: Vec<(f64, f64)> = if acting.is_empty() {
            all.iter().map(|own| own.span_s).collect()
        } else {
            acting.into_iter().map(|own| own.span_s).collect()
        };
        let span_s = spans
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        Self { runs, span_s, ..all[0].clone() }
    }

    /// True if the shown time depends on a motion or a torque.
    fn acts(&self) -> bool {
        self.is_solved() || self.link.is_some()
    }

    fn of_one(runs: &'a [StoredRun]) -> Self {
        let first = &runs[0];
        let link = Single::of(first);
        let times = &first.times_s;
        let frequencies = link.map(|run| natural_frequencies(&run.arc.mesh, 1));
        let period_s = frequencies.and_then(|all| all.first().map(|omega| TAU / omega));
        let after = PERIODS * period_s.unwrap_or(0.0);
        let (from_s, until_s) = if let Some((from, until)) = first.moving_s {
            let short = SHORTEST * (until - from);
            let most = |name: &str| {
                let all = first.joints.iter().filter_map(|joint| joint.reading(name));
                (AROUND * all.fold(0.0, f64::max)).max(short)
            };
            (from - most("lead_s"), until + most("lag_s").max(after))
        } else if link.is_some() {
            let torque = &first.joints[0].torque_n_m;
            let peak = largest(torque);
            let acts = |torque: &f64| torque.abs() > CALM * peak;
            let start = torque.iter().position(acts).unwrap_or(0);
            let last = torque.iter().rposition(acts).unwrap_or(times.len() - 1);
            let short = 0.1 * (times[last] - times[start]);
            (times[start] - short, times[last] + short.max(2.0 * after))
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        };
        let samples = inside(times, from_s, until_s);
        let span_s = (times[samples.start], times[samples.end - 1]);
        Self { runs, link, span_s, period_s }
    }

    /// The run of the page.
    pub(super) fn first(&self) -> &StoredRun {
        &self.runs[0]
    }

    /// True for a page of an arm of several links.
    pub(super) fn is_arm(&self) -> bool {
        self.link.is_none()
    }

    /// The first alternative on the page of a link, the second on the page of an arm.
    pub(super) fn pick<T>(&self, of_link: T, of_arm: T) -> T {
        if self.is_arm() { of_arm } else { of_link }
    }

    /// Whose words the quantities of a joint have.
    pub(super) fn kind(&self) -> Of {
        match self.link {
            None => Of::Joint,
            Some(run) if run.link.joint().slides() => Of::Carriage,
            Some(_) => Of::Hub,
        }
    }

    /// Id of a joint's figure: `torque`, `hub-rate`; for an arm `torque-1`, `rate-1`.
    pub(super) fn id(&self, name: &str, joint: usize) -> String {
        let of_arm = format!("{}-{}", name.trim_start_matches("hub-"), joint + 1);
        self.pick(name.to_owned(), of_arm)
    }

    /// A joint in words: `the hub`; for an arm `joint 2, fore`.
    pub(super) fn joint_words(&self, joint: usize) -> String {
        self.pick("the hub".to_owned(), format!("joint {}", self.number_of(joint)))
    }

    /// True for a solution for a wanted motion, false for a simulation.
    pub(super) fn is_solved(&self) -> bool {
        self.first().moving_s.is_some()
    }

    /// True if gravity acts in the plane of motion.
    pub(super) fn has_weight(&self) -> bool {
        largest(&self.first().gravity_m_s2) > 0.0
    }

    /// The runs, each with the name of its line, which is `name` for a single run.
    pub(super) fn named(&self, name: &str) -> impl Iterator<Item = (&StoredRun, String)> {
        let is_alone = self.runs.len() == 1;
        self.runs
            .iter()
            .map(move |arm| (arm, if is_alone { name.to_owned() } else { own(&arm.name) }))
    }

    /// A joint of a run; `None` without a joint of this number, and for a carriage beside a hub.
    pub(super) fn joint<'b>(&self, run: &'b StoredRun, joint: usize) -> Option<&'b StoredJoint> {
        let slides = |run: &StoredRun| Some(run.links.get(joint)?.link.joint().slides());
        run.joints.get(joint).filter(|_| slides(run) == slides(self.first()))
    }

    /// A line for each run of a single link with the quantity: times in s and values. The line of a single run has the
    /// `colour`.
    pub(super) fn of_links<'b>(
        &'b self,
        (own, colour): (&str, usize),
        of: impl Fn(Single<'b>) -> Option<(&'b [f64], Cow<'b, [f64]>)>,
    ) -> Vec<Curve> {
        let mut curves = self.of_runs(own, |run| of(Single::of(run)?));
        if let ([only], true) = (&mut curves[..], self.runs.len() == 1) {
            only.stroke = Stroke::Solid(colour);
        }
        curves
    }

    /// The first run with the rigid arm in its files.
    pub(super) fn rigid(&self) -> Option<&StoredRun> {
        let is_whole = |arm: &&StoredRun| {
            arm.arc.is_none() && arm.joints.iter().all(|j| j.rigid_angle_rad.is_some())
        };
        self.runs.iter().find(is_whole)
    }

    /// Peak in words from the summary of the whole run, or else from the samples.
    pub(super) fn peak(&self, name: &str, history: &[f64]) -> String {
        peak_words(reading(&self.first().readings, name), history)
    }

    /// A history as a line over the shown time.
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

    /// A line for each run with the quantity: times in s and values.
    pub(super) fn of_runs<'b>(
        &'b self,
        own: &str,
        of: impl Fn(&'b StoredRun) -> Option<(&'b [f64], Cow<'b, [f64]>)>,
    ) -> Vec<Curve> {
        let line = |(run, (arm, name)): (usize, (&'b StoredRun, String))| {
            let (times_s, history) = of(arm)?;
            Some(self.curve(&name, run_stroke(run), times_s, &history))
        };
        self.named(own).enumerate().filter_map(line).collect()
    }

    /// A line for each run and each of the `names` with the quantity: times in s and values.
    pub(super) fn each<'b>(
        &'b self,
        names: &[String],
        of: impl Fn(&'b StoredRun, usize) -> Option<(&'b [f64], Vec<f64>)>,
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

    /// A figure over the shown time, with the axis for its lines.
    pub(super) fn figure(
        &self,
        id: impl Into<Cow<'static, str>>,
        title: &str,
        caption: String,
        quantity: (&str, &str),
        curves: Vec<Curve>,
    ) -> Figure {
        Figure::of_curves(id, title, caption, self.time_axis(), quantity, curves)
    }

    /// Axis of the shown time.
    pub(super) fn time_axis(&self) -> Axis {
        Axis::linear(TIME, "s", self.span_s.0..self.span_s.1)
    }

    /// `joint 1`, `joint 2`, … for `what` = `joint`.
    pub(super) fn numbered(&self, what: &str) -> Vec<String> {
        (1..=self.first().joints.len()).map(|number| format!("{what} {number}")).collect()
    }

    /// Number of a joint or of its link, with the link's name if it has one: `2, fore`.
    pub(super) fn number_of(&self, link: usize) -> String {
        let number = (link + 1).to_string();
        let name = &self.first().links[link].name;
        if *name == number { number } else { format!("{number}, {}", own(name)) }
    }

    /// Shaded lead and lag of a joint's torque.
    pub(super) fn lead_and_lag(&self, joint: usize) -> Vec<Span> {
        let Some((from, until)) = self.first().moving_s else { return vec![] };
        let joint = &self.first().joints[joint];
        let lead = |lead_s| Span { name: "lead", range: from - lead_s..from };
        let lag = |lag_s| Span { name: "lag", range: until..until + lag_s };
        let spans = joint.reading("lead_s").map(lead).into_iter();
        let spans = spans.chain(joint.reading("lag_s").map(lag));
        spans.filter(|span| span.range.end > span.range.start).collect()
    }

    /// Marks at the start and the stop of the tip; a periodic motion has neither, nor a lead.
    pub(super) fn start_and_stop(&self) -> Vec<Mark> {
        let has_lead = |joint: &StoredJoint| joint.reading("lead_s").is_some();
        let moving_s = self.first().moving_s.filter(|_| self.first().joints.iter().any(has_lead));
        let marks = |(from, until)| {
            [(from, "tip starts", "start"), (until, "tip stops", "stop")]
                .map(|(at, label, class)| Mark { at, label: label.to_owned(), class })
        };
        moving_s.map(marks).into_iter().flatten().collect()
    }
}

/// Style of a run's line: lines beside the first are dashed, so that equal ones stay visible.
pub(super) fn run_stroke(run: usize) -> Stroke {
    match run.checked_sub(1) {
        None => Stroke::Solid(1),
        Some(beside) => Stroke::Dashed(BESIDE[beside % BESIDE.len()]),
    }
}

/// Distance of the tip from its first place in m.
pub(super) fn from_start_m(arm: &StoredRun) -> Vec<f64> {
    let [x, y] = &arm.tip_m;
    x.iter().zip(y).map(|(at_x, at_y)| libm::hypot(at_x - x[0], at_y - y[0])).collect()
}

/// Ending of the names of errors, which have a separate table.
pub(super) const ERROR: &str = "_error";

/// A number of a summary by its name.
pub(super) fn reading(readings: &[(String, f64)], name: &str) -> Option<f64> {
    readings.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
}

/// A peak for captions, with the digits of the tables. The summary's peak has precedence, since it may lie between
/// samples.
pub(super) fn peak_words(known: Option<f64>, history: &[f64]) -> String {
    significant(known.unwrap_or_else(|| largest(history)), 4)
}

/// The sample nearest to a time.
pub(super) fn nearest(times_s: &[f64], time_s: f64) -> usize {
    let next = times_s.partition_point(|t| *t < time_s).min(times_s.len() - 1);
    let before = next.saturating_sub(1);
    if time_s - times_s[before] < times_s[next] - time_s { before } else { next }
}

/// Samples from one time to another, at least two if there are two.
pub(super) fn inside(times_s: &[f64], from_s: f64, until_s: f64) -> Range<usize> {
    let len = times_s.len();
    let start = times_s.partition_point(|t| *t < from_s).min(len.saturating_sub(2));
    let end = times_s.partition_point(|t| *t <= until_s).max(start + 2).min(len);
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::tests::{run, view};

    #[test]
    fn the_view_holds_lead_and_lag_and_some_periods_but_not_all_the_calm() {
        let mut run = run();
        let (first, last) = (run.times_s[0], run.times_s[run.times_s.len() - 1]);
        let moving_s = run.moving_s.unwrap();
        let [lead_s, lag_s] = ["lead_s", "lag_s"].map(|name| reading(&run.readings, name).unwrap());
        let (from, until) = view(&run).span_s;
        assert!(first < from && from < moving_s.0 - lead_s, "from {from} s");
        assert!(until > moving_s.1 + 4.0 * 0.52 && until < last, "until {until} s");
        run.moving_s = None;
        let (from, until) = view(&run).span_s;
        assert!(first < from && from < moving_s.0 - lead_s, "from {from} s");
        assert!(until > moving_s.1 + lag_s, "until {until} s");
    }

    #[test]
    fn a_view_has_two_samples_at_least() {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        assert_eq!(inside(&times, 2.5, 6.0), 3..7);
        assert_eq!(inside(&times, -9.0, -8.0), 0..2);
        assert_eq!(inside(&times, 20.0, 30.0), 8..10);
        assert_eq!(inside(&times[..1], 0.0, 9.0), 0..1, "there is but one");
        assert_eq!([-5.0, 2.4, 2.6, 50.0].map(|t| nearest(&times, t)), [0, 2, 3, 9]);
    }
}
