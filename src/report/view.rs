//! The part of a run's time that its figures show.

use std::ops::Range;

use super::axis::{Axis, TIME};
use super::figure::{Curve, Figure, Mark, Span, Stroke};
use crate::modal::natural_frequencies;
use crate::numeric::largest;
use crate::result::{StoredNodes, StoredRun, StoredSolution};
use crate::text::significant;

/// Time shown before and after the motion, in multiples of lead and lag.
const AROUND: f64 = 1.7;

/// Time shown after the motion at least, in periods of the first mode.
const PERIODS: f64 = 4.0;

/// Share of the peak above which a torque acts, for runs without a wanted motion.
const CALM: f64 = 1e-3;

/// The part of a run's time that its figures show: the motion with some time before and after it, but
/// not all the rest.
#[derive(Debug, Clone)]
pub(super) struct View<'a> {
    /// The run.
    pub(super) run: &'a StoredRun,
    /// Samples shown.
    pub(super) samples: Range<usize>,
    /// Period of the first mode in s, if anything vibrates.
    pub(super) period_s: Option<f64>,
}

impl<'a> View<'a> {
    /// Finds the part of a run in which link and torque act.
    pub(super) fn of(run: &'a StoredRun) -> Self {
        let times = &run.times_s;
        let period_s = natural_frequencies(&run.mesh, 1).first().map(|w| std::f64::consts::TAU / w);
        let after = PERIODS * period_s.unwrap_or(0.0);
        let (from_s, until_s) = if let Some(solved) = &run.solved {
            let (from, until) = solved.moving_s;
            let short = 0.15 * (until - from);
            let [lead_s, lag_s] = [solved.lead_s, solved.lag_s].map(Option::unwrap_or_default);
            let before = (AROUND * lead_s).max(short);
            (from - before, until + (AROUND * lag_s).max(short).max(after))
        } else {
            let peak = largest(&run.torque_n_m);
            let acts = |torque: &f64| torque.abs() > CALM * peak;
            let first = run.torque_n_m.iter().position(acts).unwrap_or(0);
            let last = run.torque_n_m.iter().rposition(acts).unwrap_or(times.len() - 1);
            let short = 0.1 * (times[last] - times[first]);
            (times[first] - short, times[last] + short.max(2.0 * after))
        };
        let samples = inside(times, from_s, until_s);
        Self { run, samples, period_s }
    }

    /// A number of the run's summary.
    pub(super) fn reading(&self, name: &str) -> Option<f64> {
        reading(&self.run.readings, name)
    }

    /// The peak that the summary has under a name, in words; that of the samples if it has none.
    pub(super) fn peak(&self, name: &str, history: &[f64]) -> String {
        peak_words(self.reading(name), history)
    }

    /// First and last time shown, in s.
    pub(super) fn span_s(&self) -> (f64, f64) {
        (self.run.times_s[self.samples.start], self.run.times_s[self.samples.end - 1])
    }

    /// A history as a line over the time shown.
    pub(super) fn curve(&self, name: &str, stroke: Stroke, history: &[f64]) -> Curve {
        let samples = self.samples.clone();
        Curve::new(name, stroke, &self.run.times_s[samples.clone()], &history[samples])
    }

    /// A history at times of its own as a line over the time shown.
    pub(super) fn over_time(
        &self,
        name: &str,
        stroke: Stroke,
        (times_s, history): (&Vec<f64>, &Vec<f64>),
    ) -> Curve {
        let (from_s, until_s) = self.span_s();
        let samples = inside(times_s, from_s, until_s);
        Curve::new(name, stroke, &times_s[samples.clone()], &history[samples])
    }

    /// A figure over the time shown, with the axis that its lines need.
    pub(super) fn figure(
        &self,
        id: &'static str,
        title: &str,
        caption: String,
        quantity: (&str, &str),
        curves: Vec<Curve>,
    ) -> Figure {
        Figure::of_curves(id, title, caption, self.time_axis(), quantity, curves)
    }

    /// Deflections, completed by those of the root, 0, and of the tip, `v − Lθ`. None if no node between
    /// them was written, or fewer than two times.
    pub(super) fn deflections(&self) -> Option<StoredNodes> {
        let run = self.run;
        let mut nodes = run.deflections_m.clone().filter(|nodes| nodes.times_s.len() > 1)?;
        let tip = run.mesh.nodes_m().len() - 1;
        if nodes.nodes.first() != Some(&0) {
            nodes.nodes.insert(0, 0);
            nodes.histories.insert(0, vec![0.0; nodes.times_s.len()]);
        }
        if nodes.nodes.last() != Some(&tip) {
            let length_m = run.mesh.length_m();
            let bent = |time_s: &f64| {
                let k = nearest(&run.times_s, *time_s);
                run.tip.displacement_m[k] - length_m * (run.hub_angle_rad[k] - run.origin_rad)
            };
            nodes.histories.push(nodes.times_s.iter().map(bent).collect());
            nodes.nodes.push(tip);
        }
        (nodes.nodes.len() > 2 || tip < 2).then_some(nodes)
    }

    /// The axis of the time shown.
    pub(super) fn time_axis(&self) -> Axis {
        let (from, until) = self.span_s();
        Axis::linear(TIME, "s", from..until)
    }

    /// Lead and lag, shaded.
    pub(super) fn lead_and_lag(&self) -> Vec<Span> {
        let solved = self.run.solved.as_ref();
        let spans =
            |solved: &StoredSolution| lead_and_lag(solved.moving_s, [solved.lead_s, solved.lag_s]);
        solved.map(spans).unwrap_or_default()
    }

    /// Times at which the tip starts and stops, if they are known.
    pub(super) fn start_and_stop(&self) -> Vec<Mark> {
        let timed = self.run.solved.as_ref().filter(|solved| solved.lead_s.is_some());
        timed.map(|solved| start_and_stop(solved.moving_s)).unwrap_or_default()
    }
}

/// A number of a summary by its name.
pub(super) fn reading(readings: &[(String, f64)], name: &str) -> Option<f64> {
    readings.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
}

/// A peak as captions have it, with the digits of the tables: it may lie between samples, so that the one of the summary
/// comes first.
pub(super) fn peak_words(known: Option<f64>, history: &[f64]) -> String {
    significant(known.unwrap_or_else(|| largest(history)), 4)
}

/// Lead and lag in s of a torque whose tip moves between two times, shaded.
pub(super) fn lead_and_lag(
    (from, until): (f64, f64),
    [lead_s, lag_s]: [Option<f64>; 2],
) -> Vec<Span> {
    let lead = |lead_s| Span { name: "lead", range: from - lead_s..from };
    let lag = |lag_s| Span { name: "lag", range: until..until + lag_s };
    let spans = lead_s.map(lead).into_iter().chain(lag_s.map(lag));
    spans.filter(|span| span.range.end > span.range.start).collect()
}

/// The times between which a tip moves.
pub(super) fn start_and_stop((from, until): (f64, f64)) -> Vec<Mark> {
    let marks = [(from, "tip starts", "start"), (until, "tip stops", "stop")];
    marks.map(|(at, label, class)| Mark { at, label: label.to_owned(), class }).into()
}

/// The sample nearest to a time.
pub(super) fn nearest(times_s: &[f64], time_s: f64) -> usize {
    let next = times_s.partition_point(|t| *t < time_s).min(times_s.len() - 1);
    let before = next.saturating_sub(1);
    if time_s - times_s[before] < times_s[next] - time_s { before } else { next }
}

/// The samples from one time to another, at least two if there are two.
pub(super) fn inside(times_s: &[f64], from_s: f64, until_s: f64) -> Range<usize> {
    let len = times_s.len();
    let start = times_s.partition_point(|t| *t < from_s).min(len.saturating_sub(2));
    let end = times_s.partition_point(|t| *t <= until_s).max(start + 2).min(len);
    start..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::run;

    #[test]
    fn the_view_holds_lead_and_lag_and_some_periods_but_not_all_the_calm() {
        let mut run = run();
        let (first, last) = (run.times_s[0], run.times_s[run.times_s.len() - 1]);
        let solved = run.solved.clone().unwrap();
        let (from, until) = View::of(&run).span_s();
        assert!(first < from && from < solved.moving_s.0 - solved.lead_s.unwrap(), "from {from} s");
        assert!(until > solved.moving_s.1 + 4.0 * 0.52 && until < last, "until {until} s");
        run.solved = None;
        let (from, until) = View::of(&run).span_s();
        assert!(first < from && from < solved.moving_s.0 - solved.lead_s.unwrap(), "from {from} s");
        assert!(until > solved.moving_s.1 + solved.lag_s.unwrap(), "until {until} s");
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
