//! Conversion of a motion's table by its noise, times, digits and ends, and of its angles under gravity.

use std::f64::consts::TAU;

use super::motion::MotionTable;
use super::quality;
use super::rows::{Place, TableError};
use super::samples::refuse_samples;
use super::uniform::Uniform;
use crate::link::Gravity;
use crate::motion::{Between, Ends, MotionColumns, Recording, TipMotion, Uncertainty, wrapped};
use crate::numeric::{CubicSpline, SplineEnds};
use crate::recording::{jitter, rested};
use crate::text::{plain, significant};

/// Largest uncertainty of a displacement over its travel.
const LEAST_WORTH: f64 = 0.1;

/// Ratio of the error of a slope from four rows to the error of a row, and its largest allowed ratio to the largest
/// step.
const OF_FOUR_ROWS: f64 = 3.8;
const LEAST_WORTH_OF_ENDS: f64 = 1e-3;

/// Difference of angles below which they are equal.
const SAME_ANGLE_RAD: f64 = 1e-3;

impl MotionTable {
    /// Makes the angles absolute for a link with gravity. The first angle is the start angle, where the displacement is
    /// 0.
    ///
    /// # Errors
    /// [`TableError`] if the link has another start angle.
    pub fn with_gravity(
        mut self,
        gravity: &Gravity,
        link_length_m: f64,
    ) -> Result<Self, TableError> {
        let Some(first_rad) = self.first_angle_rad else { return Ok(self) };
        let other = gravity.start_angle_rad.filter(|own| (own - first_rad).abs() > SAME_ANGLE_RAD);
        if let Some(own) = other {
            let place = Place { file: &self.name, line: self.lines.first().copied() };
            let must =
                format!("must be start_angle of the link file, {} rad, at the start", plain(own));
            return Err(place.refuse("angle", format!("{} rad", plain(first_rad)), must));
        }
        for displacement in self.columns.displacement_m.iter_mut().flatten() {
            *displacement -= first_rad * link_length_m;
        }
        self.recording.start_angle_rad = Some(first_rad);
        Ok(self)
    }

    /// Checks the samples and makes them a motion.
    ///
    /// A velocity without other columns is integrated: the displacement is the integral of its not-a-knot cubic spline.
    ///
    /// # Errors
    /// Those of [`TipMotion::with_ends`], with file and line.
    pub fn into_motion(self) -> Result<TipMotion, TableError> {
        let of_integral = self.with_integral();
        // Beyond its ends a cycle differs from its spline.
        let uniform = match of_integral.ends {
            Ends::Periodic => of_integral,
            _ => of_integral.made_uniform(),
        };
        uniform.check_ends()?;
        let Self { columns, name, lines, recording, ends, .. } = uniform;
        let acceleration = columns.acceleration_m_s2.clone();
        let motion = TipMotion::with_ends(columns, ends)
            .map_err(|error| refuse_samples(&name, &lines, error.sample(), &error, error.hint()))?;
        let moves_by_column = ends == Ends::AtRest && motion.ends() == Ends::Moving;
        let mut recording = Recording { moves_by_column, ..recording };
        if let Some(acceleration) = acceleration {
            let of_integral =
                quality::of_acceleration(&motion, &acceleration, recording.deviation());
            recording.between = recording.between.or(of_integral);
        }
        let motion = motion.recorded(recording);
        check_worth(&motion, &name)?;
        Ok(motion)
    }

    /// Refuses velocities at the ends from rounded rows, because they depend on only four rows.
    fn check_ends(&self) -> Result<(), TableError> {
        let MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m } =
            &self.columns;
        let given = velocity_m_s.as_ref().or(acceleration_m_s2.as_ref());
        let displacement_m = displacement_m.as_deref().filter(|_| given.is_none());
        let (Some(samples), Some(uncertainty), Ends::Moving) =
            (displacement_m, &self.recording.uncertainty, self.ends)
        else {
            return Ok(());
        };
        let most_m =
            samples.windows(2).fold(0.0_f64, |most, two| most.max((two[1] - two[0]).abs()));
        let off_m = OF_FOUR_ROWS * uncertainty.deviation();
        if off_m <= LEAST_WORTH_OF_ENDS * most_m {
            return Ok(());
        }
        let step_s = time_s[1] - time_s[0];
        let must = format!(
            "velocity is missing: the decimals of the displacement determine it only to {} m/s",
            significant(off_m / step_s, 2)
        );
        let place = Place { file: &self.name, line: None };
        let hint = "add a column of the velocity, or write the displacement with more decimals";
        Err(place.refuse_whole(&must).with_hint(Some(hint.to_owned())))
    }

    /// Declares normal noise of this standard deviation in m on the displacement; the rests at the ends become their
    /// means.
    ///
    /// # Errors
    /// [`TableError`] unless a displacement defines the motion and rests at both ends.
    pub fn with_noise(mut self, deviation_m: f64) -> Result<Self, TableError> {
        let place = Place { file: &self.name, line: None };
        let displacement_m = self.columns.displacement_m.as_deref();
        let Some(given_m) = displacement_m.filter(|_| self.columns.acceleration_m_s2.is_none())
        else {
            let must = "--noise needs displacement or angle, and no acceleration";
            return Err(place.refuse_whole(must));
        };
        let (rested_m, moved_m) = rested(given_m, deviation_m).map_err(|error| {
            let hint =
                "record the tip at rest before and after the motion, or state the noise as it is";
            place.refuse_whole(&error.to_string()).with_hint(Some(hint.to_owned()))
        })?;
        self.columns.displacement_m = Some(rested_m);
        self.recording.uncertainty = Some(Uncertainty::Noisy { deviation_m, moved_m });
        Ok(self)
    }

    /// Sets a cut-off in Hz in place of a search.
    #[must_use]
    pub fn with_lowpass(mut self, hertz: f64) -> Self {
        self.recording.lowpass_rad_s = Some(TAU * hertz);
        self
    }

    /// The samples at `steps` steps from the first time on; the last one is the last of the table.
    pub(super) fn at_steps(self, steps: usize, step_s: f64) -> Self {
        let uniform = Uniform::of(&self.columns.time_s, steps, step_s);
        let on_grid = |values: &Option<Vec<f64>>, ends| {
            values.as_deref().map(|values| uniform.interpolated(values, ends))
        };
        let columns = &self.columns;
        let known_s = &columns.time_s;
        let spacing_s = Uniform::over(known_s).step_s;
        let ends = self.ends.said_by(columns.velocity_m_s.as_deref());
        let rests = if ends == Ends::AtRest { SplineEnds::Clamped } else { SplineEnds::NotAKnot };
        let earlier = self.recording.between;
        let between = match (&columns.acceleration_m_s2, &columns.displacement_m) {
            (Some(own), _) => {
                quality::of_spline_of_acceleration(known_s, own, self.recording.deviation())
            }
            (None, Some(own)) => {
                let spline_m = quality::of_spline_m(known_s, own, rests).max(earlier.spline_m);
                Between { spline_m, ..earlier }
            }
            (None, None) => earlier,
        };
        let lines = uniform.lines(&self.lines);
        let recording = Recording { spacing_s: Some(spacing_s), between, ..self.recording };
        let columns = MotionColumns {
            acceleration_m_s2: on_grid(&columns.acceleration_m_s2, SplineEnds::NotAKnot),
            velocity_m_s: on_grid(&columns.velocity_m_s, SplineEnds::NotAKnot),
            displacement_m: on_grid(&columns.displacement_m, rests),
            time_s: uniform.times_s,
        };
        Self { columns, lines, recording, ..self }
    }

    /// Replaces a velocity without other columns by its displacement.
    pub(super) fn with_integral(mut self) -> Self {
        let MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m } =
            self.columns;
        let (velocity_m_s, displacement_m) = match (velocity_m_s, displacement_m) {
            (Some(velocity), None) if acceleration_m_s2.is_none() => {
                let ends = self.ends.said_by(Some(&velocity));
                let integral = integral(&time_s, &velocity, ends);
                if ends != Ends::Periodic {
                    self.recording.between = quality::of_velocity(&time_s, &velocity);
                }
                // The displacement does not show the velocity's ends.
                ((ends != Ends::AtRest).then_some(velocity), Some(integral))
            }
            given => given,
        };
        let columns = MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m };
        Self { columns, ..self }
    }

    /// The samples on the uniform grid from the first time to the last. They are interpolated if the times are off the
    /// grid by more than their digits explain, but by at most [`LARGEST_JITTER`] steps.
    fn made_uniform(self) -> Self {
        let MotionColumns { time_s, acceleration_m_s2, displacement_m, .. } = &self.columns;
        let decides = displacement_m.as_deref().filter(|_| acceleration_m_s2.is_none());
        let Some(jitter) = jitter(time_s, decides) else { return self };
        let (steps, step_s) = (time_s.len() - 1, Uniform::over(time_s).step_s);
        let lines = self.lines.clone();
        let uniform = self.at_steps(steps, step_s);
        let recording = Recording { jitter: Some(jitter), ..uniform.recording };
        Self { lines, recording, ..uniform }
    }
}

/// Displacement in m from a velocity.
fn integral(time_s: &[f64], velocity_m_s: &[f64], ends: Ends) -> Vec<f64> {
    let (len, last) = (time_s.len(), time_s.len() - 1);
    if ends != Ends::Periodic {
        return CubicSpline::new(time_s, velocity_m_s, SplineEnds::NotAKnot).integral();
    }
    let period_s = (time_s[last] - time_s[0]) * len as f64 / last as f64;
    let times_s = wrapped(time_s, period_s, len);
    let spline = CubicSpline::new(&times_s, &wrapped(velocity_m_s, 0.0, len), SplineEnds::NotAKnot);
    let all = spline.integral();
    all[len..2 * len].iter().map(|m| m - all[len]).collect()
}

/// Refuses a displacement that hardly exceeds its uncertainty. The uncertainty from velocities or accelerations is an
/// error of the solution, which warns of it.
fn check_worth(motion: &TipMotion, name: &str) -> Result<(), TableError> {
    let uncertain = motion.recording().uncertainty.filter(|own| own.times() == 0);
    let Some(tolerance_m) = uncertain.and(motion.known_to_m()) else { return Ok(()) };
    let grid = motion.grid();
    let travel_m = motion.target(grid.time_s(0), grid.end_s()).largest_travel_m();
    if tolerance_m <= LEAST_WORTH * travel_m {
        return Ok(());
    }
    let found = format!("{} m of travel", significant(travel_m, 3));
    let must = format!(
        "must be at least {} m: it is known to {} m only",
        significant(tolerance_m / LEAST_WORTH, 3),
        significant(tolerance_m, 3)
    );
    let hint = "write the samples with more decimals, or record them with less noise";
    let place = Place { file: name, line: None };
    Err(place.refuse("displacement", found, must).with_hint(Some(hint.to_owned())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noisy_motion_begins_and_ends_when_the_exact_one_does() {
        let septic = |u: f64| u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3));
        let mut state = 3_u64;
        let mut part = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        for (deviation_m, within_s) in [(1e-5, 0.02), (2e-4, 0.05)] {
            let time_s: Vec<f64> = (0..=400).map(|k| 0.005 * f64::from(k)).collect();
            let mut place = |t: &f64| {
                let radius = (-2.0 * libm::log(part().max(1e-300))).sqrt();
                0.5 * septic((t - 0.5).clamp(0.0, 1.0))
                    + deviation_m * radius * libm::cos(TAU * part())
            };
            let displacement_m = Some(time_s.iter().map(&mut place).collect());
            let columns = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
            let table = MotionTable::of_columns("motion", columns).unwrap();
            let motion = table.with_noise(deviation_m).unwrap().into_motion().unwrap();
            let (first, last) = motion.moving_samples();
            let [from_s, until_s] = [first, last].map(|k| motion.grid().time_s(k));
            assert!((from_s - 0.5).abs() < within_s, "{deviation_m}: from {from_s} s");
            assert!((until_s - 1.5).abs() < within_s, "{deviation_m}: until {until_s} s");
        }
    }
}
