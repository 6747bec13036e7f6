//! Levenberg and Marquardt's iteration on the logarithms of the free values, within bounds.

use faer::linalg::solvers::SolveLstsq;
use faer::{Col, Mat, Scale};
use rayon::prelude::*;

use super::measurement::{FARTHEST, LinkFitError};
use super::measurements::{Measurements, Prediction};
use super::misfits::DELAY_UNIT;
use super::outcome::{Course, FitOutcome, Free, StartEnd};
use super::record::Record;
use super::specimen::{COARSE, FINE, Specimen};

/// Step of a logarithm for a derivative. At a resonance of damping ratio 0.02 the fourth order leaves a share of
/// (h/0.02)⁴, and a frequency has 13 digits.
const STEP: f64 = 2e-4;

/// Depth of an iteration.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    /// Relative error of the frequencies on its mesh.
    pub(super) mesh_tolerance: f64,
    /// Change of the logarithms at which it ends.
    pub(super) settled: f64,
    /// Relative decrease of the sum of squares at which it also ends.
    pub(super) little: f64,
    pub(super) most_iterations: usize,
}

/// Depth for comparing starts.
const SURVEY: Depth =
    Depth { mesh_tolerance: COARSE, settled: 1e-4, little: 1e-4, most_iterations: 30 };

/// Depth for the last digits.
pub(super) const POLISH: Depth =
    Depth { mesh_tolerance: FINE, settled: 1e-9, little: 0.0, most_iterations: 60 };

/// Square of a column of the Jacobian over the largest, below which it counts as zero.
const NO_WEIGHT: f64 = 1e-14;

/// Relative decrease of the sum of squares below which it is round-off.
const NO_GAIN: f64 = 1e-9;

/// Number of times that channels without uncertainties are weighted by the remainder of the fit before.
const WEIGHINGS: usize = 3;

/// Shares of the records that are fitted before the whole.
const BEGINNINGS: [f64; 2] = [1.0 / 16.0, 1.0 / 4.0];

/// Ratio of sums of squares below which another start is better than the first.
const BETTER: f64 = 0.99;

/// Difference of sums of squares below which they are equal at the accuracy of the survey's mesh.
const TIE: f64 = 1e-8;

/// Finds the factors on the free values of a link or an arm that fit the measurements best.
///
/// `specimen_at` makes an [`Arm`](crate::link::Arm), or a link and the plan of its mesh, from factors on the free
/// values. The search minimises the sum of squared residuals from the file's values and from other starts, up to five
/// times larger or smaller.
///
/// # Errors
/// [`LinkFitError`]: the file's values make no link or arm, or one without the measured modes.
pub fn fit<S: Into<Specimen>, E: Send>(
    measurements: &Measurements,
    free: &[Free],
    specimen_at: impl Fn(&[f64]) -> Result<S, E> + Sync,
) -> Result<FitOutcome, LinkFitError<E>> {
    let problem = Problem { measurements, free, specimen_at };
    let own = vec![0.0; free.len() + measurements.records_with_free_delay().count()];
    problem.check(&own)?;
    let starts = problem.starts();
    let ends: Vec<Option<End>> = starts.par_iter().map(|x| problem.survey(x.clone())).collect();
    let told =
        starts.iter().zip(&ends).map(|(from, end)| told(from, end.as_ref(), free.len())).collect();
    let mut ends = ends;
    let first = ends[0].take().unwrap_or(End { x: own, ..End::NONE });
    let mut others: Vec<End> = ends.into_iter().flatten().collect();
    // The first of equals.
    let best = (0..others.len()).reduce(|a, b| if others[b].cost < others[a].cost { b } else { a });
    let better = best
        .filter(|k| others[*k].cost < BETTER * first.cost && others[*k].cost < first.cost - TIE);
    let is_from_other_start = better.is_some();
    let main = match better {
        Some(k) => std::mem::replace(&mut others[k], first),
        None => first,
    };
    let (survey, surveyed) = (main.x, main.cost);
    let mut end = problem.descend(survey.clone(), POLISH).unwrap_or(End { x: survey, ..End::NONE });
    let mut weighed = measurements.clone();
    for _ in 0..WEIGHINGS {
        let refinements = problem.refinements(&end.x, FINE).unwrap_or(0);
        let predicted = problem.predicted(&end.x, refinements);
        let Some(next) = predicted.and_then(|found| measurements.weighed(&found)) else { break };
        weighed = next;
        let again = Problem { measurements: &weighed, ..problem.by_ref() };
        let Some(next) = again.descend(end.x.clone(), POLISH) else { break };
        end = End { iterations: end.iterations + next.iterations, ..next };
    }
    let problem = Problem { measurements: &weighed, ..problem.by_ref() };
    let End { x, iterations, has_settled, .. } = end;
    let refinements = problem.refinements(&x, FINE).unwrap_or(0);
    let jacobian = problem.jacobian(&x, refinements, true);
    let predicted = problem.predicted(&x, refinements);
    let course = Course { is_from_other_start, has_settled, iterations, starts: told };
    let outcome = FitOutcome::of(&weighed, free, &x, predicted.as_ref(), &jacobian, course);
    Ok(problem.with_other_answers(outcome, (&x, predicted.as_ref()), others, surveyed))
}

/// End of an iteration, with the sum of squares there, and true if no step led further down.
pub(super) struct End {
    /// Logarithms of the factors, then delays in units of [`DELAY_UNIT`] samples.
    pub(super) x: Vec<f64>,
    pub(super) cost: f64,
    iterations: usize,
    has_settled: bool,
}

impl End {
    /// Result without a possible iteration.
    const NONE: Self =
        Self { x: Vec::new(), cost: f64::INFINITY, iterations: 0, has_settled: false };
}

/// Description of a start and its end, with `free` values.
fn told(from: &[f64], end: Option<&End>, free: usize) -> StartEnd {
    let factors = |x: &[f64]| x[..free].iter().map(|x| libm::exp(*x)).collect();
    StartEnd {
        from: factors(from),
        to: end.map(|end| factors(&end.x)),
        sum_of_squares: end.map(|end| end.cost),
        iterations: end.map_or(0, |end| end.iterations),
    }
}

pub(super) struct Problem<'a, F> {
    pub(super) measurements: &'a Measurements,
    pub(super) free: &'a [Free],
    pub(super) specimen_at: F,
}

impl<'a, F> Problem<'a, F> {
    /// Bounds of a logarithm, or of a delay.
    pub(super) fn bounds(&self, k: usize) -> [f64; 2] {
        if let Some(free) = self.free.get(k) {
            return free.factors.map(libm::log);
        }
        let mut records = self.measurements.records_with_free_delay();
        let record = records.nth(k - self.free.len());
        let longest = record.map_or(0, Record::longest_delay) as f64;
        [-longest / DELAY_UNIT, longest / DELAY_UNIT]
    }

    pub(super) fn by_ref(&self) -> Problem<'a, &F> {
        Problem { measurements: self.measurements, free: self.free, specimen_at: &self.specimen_at }
    }
}

impl<S: Into<Specimen>, E: Send, F: Fn(&[f64]) -> Result<S, E> + Sync> Problem<'_, F> {
    fn specimen(&self, x: &[f64]) -> Result<Specimen, E> {
        let factors: Vec<f64> = x[..self.free.len()].iter().map(|x| libm::exp(*x)).collect();
        (self.specimen_at)(&factors).map(Into::into)
    }

    /// The delays in samples.
    fn delays(&self, x: &[f64]) -> Vec<f64> {
        x[self.free.len()..].iter().map(|delay| DELAY_UNIT * delay).collect()
    }

    /// Refuses a specimen without a measured mode.
    fn check(&self, x: &[f64]) -> Result<(), LinkFitError<E>> {
        let specimen = self.specimen(x).map_err(LinkFitError::Link)?;
        let unfit = specimen.drive().and_then(|drive| self.measurements.unfit(drive));
        unfit.map_or(Ok(()), |unfit| Err(LinkFitError::Drive(unfit)))?;
        let refinements = specimen.checked(self.measurements)?;
        let predicted = specimen.predicted(self.measurements, refinements, &self.delays(x));
        let predicted = predicted.ok_or(LinkFitError::NoModel)?;
        for (measured, predicted) in self.measurements.values().iter().zip(predicted.values) {
            let observable = &measured.observable;
            // A link without a damping law has no ratio at all, an arm has a ratio of 0.
            let least = if observable.arm_mode().is_some() { None } else { Some(0.0) };
            if observable.is_damping() && predicted.or(least) == Some(0.0) {
                return Err(LinkFitError::NoDamping(observable.clone()));
            }
            match predicted {
                None => return Err(LinkFitError::NoMode(observable.clone())),
                Some(value) if value.is_nan() => {
                    return Err(LinkFitError::NoVibration(observable.clone()));
                }
                Some(own) if !observable.is_damping() => {
                    let factor = own / measured.value;
                    if !(1.0 / FARTHEST..=FARTHEST).contains(&factor) {
                        let (observable, measured) = (observable.clone(), measured.value);
                        return Err(LinkFitError::Distant { observable, measured, own });
                    }
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    pub(super) fn refinements(&self, x: &[f64], tolerance: f64) -> Option<u32> {
        self.specimen(x).ok()?.refinements::<E>(self.measurements, tolerance).ok()
    }

    /// Predictions at logarithms of the factors, on a mesh refined this many times.
    fn predicted(&self, x: &[f64], refinements: u32) -> Option<Prediction> {
        self.specimen(x).ok()?.predicted(self.measurements, refinements, &self.delays(x))
    }

    fn residuals(&self, x: &[f64], refinements: u32) -> Option<Col<f64>> {
        let residuals = self.measurements.residuals(&self.predicted(x, refinements)?)?;
        Some(Col::from_fn(residuals.len(), |row| residuals[row]))
    }

    /// Derivatives of the residuals on one mesh, of fourth order if `is_exact`, else of second.
    pub(super) fn jacobian(&self, x: &[f64], refinements: u32, is_exact: bool) -> Mat<f64> {
        let [rows, _] = self.measurements.rows();
        let at = |k: usize, step: f64| {
            let mut beside = x.to_vec();
            beside[k] += step;
            self.residuals(&beside, refinements)
        };
        let slope = |k: usize, step: f64| match (at(k, step), at(k, -step)) {
            (Some(above), Some(below)) => Some((above - below) / Scale(2.0 * step)),
            // The link is impossible here, as when a segment becomes shorter than the place of a mass.
            (above, below) => {
                let here = self.residuals(x, refinements)?;
                above
                    .map(|above| (above - &here) / Scale(step))
                    .or(below.map(|below| (here - below) / Scale(step)))
            }
        };
        let columns = (0..x.len()).into_par_iter().map(|k| {
            let near = slope(k, STEP);
            let column = if is_exact {
                near.zip(slope(k, 2.0 * STEP))
                    .map(|(near, far)| (near * Scale(4.0) - far) / Scale(3.0))
            } else {
                near
            };
            column.unwrap_or_else(|| Col::zeros(rows))
        });
        let columns: Vec<Col<f64>> = columns.collect();
        Mat::from_fn(rows, x.len(), |row, column| columns[column][row])
    }

    /// Iterates from a start. Over records it continues from the results over their beginnings, where a wrong frequency
    /// cannot lose count of the periods. It iterates again if the resulting link fits them better with delays far from
    /// the start's, which the iteration does not see.
    fn survey(&self, start: Vec<f64>) -> Option<End> {
        let mut from = start.clone();
        if !self.measurements.records().is_empty() {
            for share in BEGINNINGS {
                let short = self.measurements.beginning(share);
                let found =
                    Problem { measurements: &short, ..self.by_ref() }.descend(from.clone(), SURVEY);
                from = found.map_or(from, |end| end.x);
            }
        }
        let is_own = start.iter().all(|x| *x == 0.0) && from != start;
        let direct = if is_own { self.descend(start, SURVEY) } else { None };
        let first = self.descend(from, SURVEY);
        let first =
            first.into_iter().chain(direct).reduce(|a, b| if b.cost < a.cost { b } else { a })?;
        let again = || {
            let refinements = self.refinements(&first.x, COARSE)?;
            let specimen = self.specimen(&first.x).ok()?;
            let delays = specimen.rough_delays(self.measurements, refinements)?;
            let delays = delays.into_iter().map(|delay| delay / DELAY_UNIT);
            let x: Vec<f64> = first.x[..self.free.len()].iter().copied().chain(delays).collect();
            let is_better = self.residuals(&x, refinements)?.squared_norm_l2() < first.cost;
            if is_better { self.descend(x, SURVEY) } else { None }
        };
        let second = if first.x.len() > self.free.len() { again() } else { None };
        let second = second.filter(|second| second.cost < first.cost);
        let iterations = first.iterations;
        Some(
            second.map_or(first, |second| End {
                iterations: iterations + second.iterations,
                ..second
            }),
        )
    }

    /// Iterates from a start to the nearest least sum of squares; `None` if the start makes no link with the measured
    /// modes.
    pub(super) fn descend(&self, mut x: Vec<f64>, depth: Depth) -> Option<End> {
        let mut damping = 1e-3;
        let mut refinements = self.refinements(&x, depth.mesh_tolerance)?;
        let mut residuals = self.residuals(&x, refinements)?;
        let (mut has_settled, mut iterations) = (false, 0);
        while iterations < depth.most_iterations {
            iterations += 1;
            let jacobian = self.jacobian(&x, refinements, false);
            let mut moved = None;
            while moved.is_none() && damping < 1e12 {
                let next = self.stepped(&x, &jacobian, &residuals, damping);
                match self.residuals(&next, refinements) {
                    Some(found) if found.squared_norm_l2() <= residuals.squared_norm_l2() => {
                        moved = Some((next, found));
                        damping = (damping * 0.1).max(1e-12);
                    }
                    _ => damping *= 10.0,
                }
            }
            let Some((next, found)) = moved else {
                has_settled = true;
                break;
            };
            let gain = residuals.squared_norm_l2() - found.squared_norm_l2();
            let is_little = gain < depth.little * residuals.squared_norm_l2();
            let has_gained = gain > NO_GAIN * residuals.squared_norm_l2();
            let steps = next.iter().zip(&x).map(|(next, x)| (next - x).abs());
            let largest = steps.fold(0.0, f64::max);
            (x, residuals) = (next, found);
            // A short step under strong damping is an end only if it gains nothing.
            if is_little || largest < depth.settled && (damping < 1.0 || !has_gained) {
                has_settled = true;
                break;
            }
            let finer = self.refinements(&x, depth.mesh_tolerance)?;
            if finer != refinements {
                refinements = finer;
                residuals = self.residuals(&x, refinements)?;
            }
        }
        Some(End { cost: residuals.squared_norm_l2(), x, iterations, has_settled })
    }

    /// One step, along all logarithms except those at a bound that would pass it.
    fn stepped(
        &self,
        x: &[f64],
        jacobian: &Mat<f64>,
        residuals: &Col<f64>,
        damping: f64,
    ) -> Vec<f64> {
        let gradient = jacobian.transpose() * residuals;
        let is_open = |k: &usize| {
            let [low, high] = self.bounds(*k);
            !(x[*k] <= low && gradient[*k] > 0.0 || x[*k] >= high && gradient[*k] < 0.0)
        };
        let open: Vec<usize> = (0..x.len()).filter(is_open).collect();
        let mut next = x.to_vec();
        if open.is_empty() {
            return next;
        }
        let weights = open.iter().map(|k| jacobian.col(*k).squared_norm_l2());
        let weights: Vec<f64> = weights.collect();
        let largest = weights.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        // Marquardt's scaling, so that a value with little weight in the residuals also moves. The damping is in rows
        // below the Jacobian, which keep the digits that normal equations lose.
        let damped = |k: usize| (damping * weights[k].max(NO_WEIGHT * largest)).sqrt();
        let rows = residuals.nrows();
        let system = Mat::from_fn(rows + open.len(), open.len(), |row, column| match row {
            _ if row < rows => jacobian[(row, open[column])],
            _ if row == rows + column => damped(column),
            _ => 0.0,
        });
        let right =
            Col::from_fn(system.nrows(), |row| if row < rows { -residuals[row] } else { 0.0 });
        let step = system.qr().solve_lstsq(&right);
        for (k, step) in open.iter().zip(step.iter()) {
            let [low, high] = self.bounds(*k);
            next[*k] = (x[*k] + step).clamp(low, high);
        }
        next
    }
}
