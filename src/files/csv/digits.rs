//! Quality of a motion's samples from the digits of its columns.

use crate::motion::{MotionColumns, Recording, Uncertainty};
use crate::numeric::largest;
use crate::recording::Rounding;

/// Number of slope changes of an exact acceleration: two at each of the four jumps of a trapezoid.
const MOST_KINKS: usize = 8;

/// Change of the slope, over the largest sample, below which it is round-off.
const KINK: f64 = 1e-9;

/// Quality of a motion from the digits of the column that defines it, and of the velocities at its ends.
pub(super) fn digits_of(
    columns: &MotionColumns,
    in_place: Option<Uncertainty>,
    [acceleration, velocity]: [Option<Rounding>; 2],
) -> Recording {
    let integrated = |column: &Option<Vec<f64>>, rounding: Option<Rounding>, times| {
        let is_rounded = !column.as_deref().is_some_and(has_few_kinks);
        let of = |Rounding { decimals, step }| Uncertainty::Integrated { times, decimals, step };
        rounding.filter(|_| is_rounded).map(of)
    };
    let once = integrated(&columns.velocity_m_s, velocity, 1);
    let uncertainty = match (&columns.acceleration_m_s2, &columns.displacement_m) {
        (Some(_), _) => integrated(&columns.acceleration_m_s2, acceleration, 2),
        (None, Some(_)) => in_place,
        (None, None) => once,
    };
    let velocity_m_s = once.map(|own| own.deviation());
    Recording { uncertainty, velocity_m_s, ..Recording::default() }
}

/// True for samples on few straight lines, such as those of a bang-bang or a trapezoid: few decimals represent them
/// exactly. The slope of rounded samples changes at every last decimal that they cross.
fn has_few_kinks(samples: &[f64]) -> bool {
    let round_off = KINK * largest(samples);
    let bends = |three: &&[f64]| (three[2] - 2.0 * three[1] + three[0]).abs() > round_off;
    samples.windows(3).filter(bends).count() <= MOST_KINKS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_with_jumps_are_exact_and_a_rounded_slope_is_not() {
        let trapezoid: Vec<f64> = (0..100)
            .map(|k| match k {
                10..30 => 2.5,
                70..90 => -2.5,
                _ => 0.0,
            })
            .collect();
        assert!(has_few_kinks(&trapezoid));
        let ramps: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(50 - i32::abs(k - 50))).collect();
        assert!(has_few_kinks(&ramps));
        let rounded: Vec<f64> = (0..100).map(|k| (0.137 * f64::from(k)).round()).collect();
        assert!(!has_few_kinks(&rounded));
    }
}
