//! Where the iterations of a fit start.

use super::least_squares::Problem;

/// Starts beside that of the file: in general; with several free values of a link of which values alone are measured,
/// which takes milliseconds; the same of an arm.
const OTHER_STARTS: [usize; 3] = [3, 15, 7];

/// Largest factor between the file's value and another start.
const FARTHEST_START: f64 = 5.0;

impl<F> Problem<'_, F> {
    /// All starts, that of the file first.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        let [few, of_link, of_arm] = OTHER_STARTS;
        let values = self.measurements.values();
        let others = match values.first() {
            _ if self.free.len() < 2 || self.measurements.has_files() => few,
            Some(first) if first.observable.arm_mode().is_some() => of_arm,
            _ => of_link,
        };
        (0..=others).map(|number| self.start(number)).collect()
    }

    /// Number 0 is the file's own; the others are Halton's points in the logarithms. No sensor is late.
    fn start(&self, number: usize) -> Vec<f64> {
        const BASES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
        let reach = libm::log(FARTHEST_START);
        let place = |k: usize| {
            let [low, high] = self.bounds(k);
            let (low, high) = (low.max(-reach), high.min(reach));
            low + (high - low) * halton(number, BASES[k % BASES.len()])
        };
        let logarithm = |k: usize| if number == 0 { 0.0 } else { place(k) };
        let logarithms: Vec<f64> = (0..self.free.len()).map(logarithm).collect();
        let delays = self.measurements.records_with_free_delay().map(|_| 0.0);
        logarithms.iter().copied().chain(delays).collect()
    }
}

/// The `number`-th point of Halton's sequence in (0, 1), from 1.
fn halton(number: usize, base: usize) -> f64 {
    let (mut rest, mut share, mut sum) = (number, 1.0, 0.0);
    while rest > 0 {
        share /= base as f64;
        sum += share * (rest % base) as f64;
        rest /= base;
    }
    sum
}
