//! A case's claims against its truth.
//!
//! A claim holds where it is at least half of the true error and at most 30 times it. Two floors:
//! below what the tables' ten digits and the truth itself resolve, an error counts as none; and where
//! claim and error are within the tolerance asked for, the user has what was asked for.

use super::case::{Case, Mesh};
use super::excuse::{Claim, excuses};
use super::link::Damping;
use super::motion::Samples;
use super::run::{Table, Warned, Written, has_one_moment};
use super::truth::{Run, Truth};

/// A claim is at least this share of the true error …
const AT_LEAST: f64 = 0.5;

/// … and at most so many times it.
const AT_MOST: f64 = 30.0;

/// Ten digits of every table, those of the window's start, and the truth's own tail.
const RESOLVED: f64 = 3e-9;

/// What a peak may be off by besides the error that is claimed: what lies between rows is known to 4e-2 at
/// 0.95 of the Nyquist frequency, and some bands end there. The truth's own grid takes as much.
const BETWEEN_ROWS: f64 = 4e-3;

/// Rows that are compared, at most about.
const ROWS: usize = 6000;

/// One quantity of one run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Verdict {
    pub(crate) quantity: &'static str,
    /// Shares of the quantity's own peak.
    pub(crate) claimed: Option<f64>,
    pub(crate) truth: f64,
    pub(crate) holds: bool,
    /// A warning says why the claim may be wrong.
    pub(crate) excused: bool,
}

/// A peak of the summary against the largest value of the truth at any time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Peak {
    pub(crate) key: &'static str,
    pub(crate) found: f64,
    pub(crate) truth: f64,
    pub(crate) holds: bool,
}

/// What is known of a case besides its claims.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Judgement {
    pub(crate) verdicts: Vec<Verdict>,
    pub(crate) peaks: Vec<Peak>,
    pub(crate) warnings: Vec<Warned>,
    pub(crate) band_hz: Option<f64>,
}

pub(crate) fn judged(case: &Case, samples: &Samples, written: &Written) -> Judgement {
    let tables = ["torque.csv", "hub_angle.csv", "tip.csv"].map(|name| written.table(name));
    let of = |table: &Table, column: &str| table.column(written.named(column)).to_vec();
    let [torque, angle, tip] = &tables;
    let len = torque.column("time_s").len();
    let run = run_of(case, samples, written, len);
    let truth = Truth::of(&case.link, samples, &run);
    let rows = Rows { first: (truth.first - run.rows.start) as usize, every: run.every };
    let warnings = written.warnings();
    let mut verdicts = Vec::new();
    let mut judge = |quantity, error: f64| {
        let claim = claimed(written, quantity);
        let claimed = claim.as_ref().map(|claim| claim.iter().map(|(_, error)| error).sum());
        let floor = RESOLVED.max(truth_floor(case));
        let within = asked(case, quantity).max(floor);
        let holds = claimed.is_some_and(|c: f64| {
            let as_asked = c.max(error) <= within;
            let below = c + floor < AT_LEAST * error;
            as_asked || (!below && c <= AT_MOST * error + within)
        });
        let excused = claim
            .is_some_and(|claim| excuses(&warnings, (quantity, written.named(quantity)), &claim));
        verdicts.push(Verdict { quantity, claimed, truth: error, holds, excused });
    };
    let way = span(&truth.wanted_m, truth.wanted_m[0]);
    let tip_m = rows.of(&of(tip, "tip_displacement_m"));
    judge("tip", farthest(&tip_m, &truth.wanted_m) / way);

    // What the window cuts off is lost, too.
    let outside = truth.outside_n_m;
    let peak = span(&truth.torque_n_m, 0.0);
    let off = farthest(&rows.of(&of(torque, "torque_n_m")), &truth.torque_n_m);
    judge("torque", off.max(outside[0]) / peak);

    let theta = &truth.hub_angle_rad;
    let off = farthest(&rows.of(&of(angle, "hub_angle_rad")), theta);
    judge("hub_angle", off / span(theta, theta[0]));

    let derived = [
        ("hub_rate", "hub_rate_rad_s", &truth.hub_rate_rad_s),
        ("hub_acceleration", "hub_acceleration_rad_s2", &truth.hub_acceleration_rad_s2),
    ];
    for (quantity, column, exact) in derived {
        judge(quantity, farthest(&rows.of(&of(angle, column)), exact) / span(exact, 0.0));
    }

    let nodes = written.table("nodal_displacements.csv");
    let peak = truth.displacement_m.iter().map(|v| span(v, v[0])).fold(0.0, f64::max);
    let pairs = nodes.values().iter().zip(&truth.displacement_m);
    let off = pairs.map(|(found, exact)| farthest(&rows.of(found), exact)).fold(0.0, f64::max);
    judge("displacement", off / peak);

    if !matches!(case.link.damping, Damping::Modal(_) | Damping::Caughey(_)) {
        let moments = written.table("bending_moments.csv");
        let peak = truth.moment_n_m.iter().map(|n| span(n, 0.0)).fold(0.0, f64::max);
        let pairs = moments.values().iter().zip(&truth.moment_n_m).zip(&run.nodes_m);
        let off = pairs
            .filter(|(_, x)| has_one_moment(case, **x))
            .map(|((found, exact), _)| farthest(&rows.of(found), exact))
            .fold(outside[2], f64::max);
        judge("bending_moment", off / peak);
    }
    let motor = truth.motor_torque_n_m.as_ref().zip(truth.motor_rate_rad_s.as_ref());
    if let Some((exact, exact_rate)) = motor {
        let motor = written.table("motor.csv");
        let off = farthest(&rows.of(motor.column("motor_rate_rad_s")), exact_rate);
        judge("motor_rate", off / span(exact_rate, 0.0));
        let off = farthest(&rows.of(motor.column("motor_torque_n_m")), exact);
        judge("motor_torque", off.max(outside[1]) / span(exact, 0.0));
    }
    let peaks = peaks(case, written, &truth, &verdicts);
    Judgement { verdicts, peaks, warnings, band_hz: run.band_hz }
}

/// The peaks of the summary, each with the error that is claimed of its quantity: of the deflection that of
/// the hub angle over the peak of the deflection.
fn peaks(case: &Case, written: &Written, truth: &Truth, verdicts: &[Verdict]) -> Vec<Peak> {
    let exact = &truth.peaks;
    let turned_m = case.link.rigid_output() * span(&truth.hub_angle_rad, truth.hub_angle_rad[0]);
    let keys = [
        ("peak_torque_n_m", "torque", Some(exact.torque_n_m), 1.0),
        ("peak_hub_rate_rad_s", "hub_rate", Some(exact.hub_rate_rad_s), 1.0),
        ("peak_deflection_m", "hub_angle", Some(exact.deflection_m), turned_m / exact.deflection_m),
        ("peak_root_moment_n_m", "bending_moment", exact.moment_n_m, 1.0),
        ("peak_motor_torque_n_m", "motor_torque", exact.motor_torque_n_m, 1.0),
    ];
    let judged = keys.into_iter().filter_map(|(key, quantity, truth, times)| {
        let verdict = verdicts.iter().find(|verdict| verdict.quantity == quantity);
        let claimed: f64 = claimed(written, quantity)?.iter().map(|(_, error)| error).sum();
        // Modal damping tells no moments.
        let truth = truth.filter(|truth| *truth > 0.0)?;
        let found = written.number(&format!("/results/{}", written.named(key))).unwrap_or(f64::NAN);
        let within = times * claimed + BETWEEN_ROWS;
        let is_excused = verdict.is_some_and(|verdict| verdict.excused);
        let holds = is_excused || (found / truth - 1.0).abs() <= within;
        Some(Peak { key, found, truth, holds })
    });
    judged.collect()
}

/// What the truth is to be computed for: the run's band and rows, on a period sixteen times as long
/// as its own, four times where every frequency is solved.
fn run_of(case: &Case, samples: &Samples, written: &Written, len: usize) -> Run {
    let step_s = samples.step_s;
    let first = written.first_row(step_s);
    let band_hz = written.number("/analysis/band_hz").filter(|_| case.tip_share() > 0.0);
    let own = written.number("/analysis/period_s").expect("a period") / step_s;
    let longer = if band_hz.is_some() { 16.0 } else { 4.0 };
    let period = ((longer * own) as usize).next_power_of_two().max(1 << 12);
    let nodes_m = written.nodes_m();
    let header = written.table("nodal_displacements.csv");
    let numbers = header.numbers();
    let fine = band_hz.map_or(1, |band| {
        ((1.0 / (24.0 * band * step_s)).max(1.0) as usize + 1).next_power_of_two() / 2
    });
    let few = (len / ROWS + 1).next_power_of_two();
    let every = if band_hz.is_some() { few.min(fine.max(1)) } else { 1 };
    Run {
        band_hz,
        rows: first..first + len as i64,
        nodes_m: numbers.iter().map(|node| nodes_m[*node]).collect(),
        period,
        every,
    }
}

/// What a run claims that a quantity may be off by, each kind of error.
pub(crate) fn claimed(written: &Written, quantity: &str) -> Option<Claim> {
    let errors = written.summary.pointer(&format!("/errors/{}", written.named(quantity)))?;
    if let Some(error) = errors.as_f64() {
        return Some(vec![(quantity.to_owned(), error)]);
    }
    // That of the step is about the motion between the samples, that of the input about the one before it was
    // rounded, that of the model about terms of second order; the truth has the samples, and is linear.
    let is_own = |kind: &str| !["step", "input", "model"].contains(&kind);
    let kinds = errors.as_object()?.iter().filter(|(kind, _)| is_own(kind));
    Some(kinds.filter_map(|(kind, error)| Some((kind.clone(), error.as_f64()?))).collect())
}

/// The tolerance that a quantity was asked for with.
fn asked(case: &Case, quantity: &str) -> f64 {
    match (quantity, case.mesh) {
        ("tip", _) => case.tip_share(),
        (_, Mesh::Auto(tolerance)) => tolerance + case.tolerance,
        (_, Mesh::Elements(_)) => case.tolerance,
    }
}

/// What the truth is known to.
fn truth_floor(case: &Case) -> f64 {
    let of_law = match case.link.damping {
        Damping::Modal(_) => 1e-7,
        Damping::Caughey(_) => 1e-6,
        _ => 0.0,
    };
    if case.link.is_tapered() { 1e-6_f64.max(of_law) } else { of_law }
}

/// Rows that are compared.
struct Rows {
    first: usize,
    every: usize,
}

impl Rows {
    fn of(&self, column: &[f64]) -> Vec<f64> {
        column[self.first..].iter().step_by(self.every).copied().collect()
    }
}

fn farthest(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len(), "rows that are compared");
    found.iter().zip(exact).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

fn span(values: &[f64], from: f64) -> f64 {
    values.iter().fold(0.0, |m, x| m.max((x - from).abs()))
}
