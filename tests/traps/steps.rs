//! One motion at a step, a half, a quarter and an eighth of it: the same peaks, the same tip.

use super::case::Case;
use super::excuse::hangs_on_the_step;
use super::judge::claimed;
use super::motion::Samples;
use super::run::{Nodes, Outcome, Written, solved};
use super::truth::{Run, wanted_m};

/// What a step may change of a peak, besides the error that is claimed of its quantity.
const SAME_PEAK: f64 = 0.02;

/// Ten digits of tip.csv.
const ROUNDED: f64 = 1e-9;

/// Steps, as parts of the case's own.
const PARTS: [usize; 4] = [1, 2, 4, 8];

/// Peaks at the four steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Steps {
    /// Key of `results`, and a peak a step; none where the run was refused.
    pub(crate) peaks: Vec<(&'static str, Vec<Option<f64>>)>,
    /// Runs whose files want the same tip as the finest, the finest among them.
    pub(crate) same: usize,
    /// Band in Hz a step, none where every frequency is solved.
    pub(crate) bands_hz: Vec<Option<f64>>,
    pub(crate) wrong: Vec<String>,
}

/// A run at a part of the step.
struct AtStep {
    samples: Samples,
    part: usize,
    written: Box<Written>,
}

impl AtStep {
    fn band_hz(&self) -> Option<f64> {
        self.written.number("/analysis/band_hz")
    }
}

/// The share of the travel that the tip may stray by as a remark on few digits tells; 0 without one.
fn told_share(run: &AtStep) -> f64 {
    let remarks = run.written.summary["remarks"].as_array();
    let is_rounded = remarks.into_iter().flatten().any(|remark| remark["kind"] == "few_digits");
    let share = run.written.number("/errors/tip").filter(|_| is_rounded);
    share.unwrap_or_default()
}

pub(crate) fn compared(case: &Case) -> Steps {
    let runs: Vec<Option<AtStep>> = PARTS
        .iter()
        .map(|part| {
            let samples = case.motion.finer(*part).samples();
            match solved(case, &samples, &Nodes::Root) {
                Outcome::Written(written) => Some(AtStep { samples, part: *part, written }),
                Outcome::Refused(..) => None,
            }
        })
        .collect();
    let mut steps = Steps::default();
    // Samples of an acceleration that jumps or has a kink are another motion at another step: peaks
    // are the same where the files want the same tip, unless a warning says that they hang on the step.
    let told = |run: &AtStep| hangs_on_the_step(&run.written.warnings());
    let sure: Vec<&AtStep> = runs.iter().flatten().filter(|run| !told(run)).collect();
    let mut same = Vec::new();
    if let Some(finest) = sure.last() {
        for run in &sure {
            let Apart { tips, files } = tips_apart(run, finest);
            let share = case.tip_share().max(told_share(run)).max(told_share(finest));
            if tips > 2.0 * share + ROUNDED + files {
                let part = run.part;
                steps
                    .wrong
                    .push(format!("tip off by {tips:.1e} of its travel at 1/{part} of the step"));
            }
            if files <= case.tip_share() + ROUNDED {
                same.push(*run);
            }
        }
    }
    steps.same = same.len();
    steps.bands_hz = runs.iter().map(|run| run.as_ref().and_then(AtStep::band_hz)).collect();
    for (key, quantity) in
        [("peak_torque_n_m", "torque"), ("peak_motor_torque_n_m", "motor_torque")]
    {
        let peak =
            |run: &AtStep| run.written.number(&format!("/results/{}", run.written.named(key)));
        let peaks: Vec<Option<f64>> = runs.iter().map(|run| run.as_ref().and_then(peak)).collect();
        if peaks.iter().all(Option::is_none) {
            continue;
        }
        let sure = same.iter().filter_map(|run| peak(run));
        let sure: Vec<f64> = sure.collect();
        if let Some(finest) = sure.last() {
            let worst = sure.iter().fold(0.0_f64, |m, p| m.max((p / finest - 1.0).abs()));
            let claims = same.iter().filter_map(|run| {
                let own: f64 =
                    claimed(&run.written, quantity)?.iter().map(|(_, error)| error).sum();
                // Few digits are others at another step.
                let named = run.written.named(quantity);
                let input = run.written.number(&format!("/errors/{named}/input"));
                Some(own + input.unwrap_or_default())
            });
            let within = SAME_PEAK + claims.fold(0.0, f64::max);
            if worst > within {
                steps.wrong.push(format!("{key} changes by {worst:.1e} with the step"));
            }
        }
        steps.peaks.push((key, peaks));
    }
    steps
}

/// Distances over the travel: of the tips of two runs, and of the tips that their files want.
struct Apart {
    tips: f64,
    files: f64,
}

fn tips_apart(a: &AtStep, b: &AtStep) -> Apart {
    let [from, to] = [a, b].iter().fold([i64::MIN, i64::MAX], |[from, to], run| {
        let rows = run.written.table("torque.csv").column("time_s").len() as i64;
        let first = run.written.first_row(run.samples.step_s);
        let part = run.part as i64;
        [from.max(-(-first).div_euclid(part)), to.min((first + rows - 1).div_euclid(part))]
    });
    // Tip and wanted tip at the rows of the case's own step.
    let own = |run: &AtStep| {
        let part = run.part as i64;
        let first = run.written.first_row(run.samples.step_s);
        let tip = run.written.table("tip.csv");
        let tip = tip.column(run.written.named("tip_displacement_m"));
        let tip: Vec<f64> = (from..to).map(|row| tip[(row * part - first) as usize]).collect();
        let rows = from * part..to * part;
        let span = (rows.end - rows.start) as usize + run.samples.values.len();
        let wanted = Run {
            band_hz: None,
            rows,
            nodes_m: Vec::new(),
            period: (4 * span).next_power_of_two(),
            every: run.part,
        };
        (tip, wanted_m(&run.samples, &wanted))
    };
    let ((tip_a, wanted_a), (tip_b, wanted_b)) = (own(a), own(b));
    let apart = |a: &[f64], b: &[f64]| {
        let rows = a.iter().zip(b);
        rows.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / b_way(&wanted_b)
    };
    Apart { tips: apart(&tip_a, &tip_b), files: apart(&wanted_a, &wanted_b) }
}

fn b_way(wanted: &[f64]) -> f64 {
    wanted.iter().fold(0.0, |m, d| m.max((d - wanted[0]).abs()))
}
