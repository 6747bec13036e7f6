//! Conversion of a motion's table by its noise, times, digits and ends, and of its angles under gravity.

use std::f64::consts::TAU;

use super::input::{Place, TableError};
use super::motion::{MotionTable, SampleRows, Sampled};
use super::quality;
use super::uniform::Uniform;
use crate::link::Link;
use crate::motion::{
    ArmPath, Ends, Motion, MotionColumns, PathColumn, Recording, TipMotion, Uncertainty, wrapped,
};
use crate::numeric::{CubicSpline, SplineEnds};
use crate::recording::{LARGEST_JITTER, NoRest, jitter, rested};
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
    /// [`TableError`] if the link has another start angle, and for angles of a link on a carriage, which does not turn.
    pub fn of_link(mut self, link: &Link) -> Result<Self, TableError> {
        let Sampled::Tip { columns, recording, first_angle_rad: Some(first_rad) } =
            &mut self.sampled
        else {
            return Ok(self);
        };
        if link.joint().slides() {
            let place = Place { file: &self.rows.name, line: None };
            let why =
                "angle, but a link on a carriage takes displacement, velocity or acceleration";
            return Err(place.refuse_whole(why));
        }
        let (Some(gravity), link_length_m) = (link.gravity(), link.length_m()) else {
            return Ok(self);
        };
        let first_rad = *first_rad;
        let other = gravity.start_angle_rad.filter(|own| (own - first_rad).abs() > SAME_ANGLE_RAD);
        if let Some(own) = other {
            let place = Place { file: &self.rows.name, line: self.rows.lines.first().copied() };
            let must =
                format!("must be start_angle of the link file, {} rad, at the start", plain(own));
            return Err(place.refuse("angle", format!("{} rad", plain(first_rad)), must));
        }
        for displacement in columns.displacement_m.iter_mut().flatten() {
            *displacement -= first_rad * link_length_m;
        }
        recording.start_angle_rad = Some(first_rad);
        Ok(self)
    }

    /// Checks the samples and makes them a motion.
    ///
    /// A velocity without other columns is integrated: the displacement is the integral of its not-a-knot cubic spline.
    ///
    /// # Errors
    /// Those of [`TipMotion::with_ends`] and [`ArmPath::with_ends`], with file and line.
    pub fn into_motion(self) -> Result<Motion, TableError> {
        self.refuse_jump()?;
        let of_integral = self.with_integral();
        // Beyond its ends a cycle differs from its spline.
        let uniform = match of_integral.ends {
            Ends::Periodic => of_integral,
            _ => of_integral.made_uniform(),
        };
        uniform.check_ends()?;
        let Self { sampled, rows, ends, .. } = uniform;
        let motion = match sampled {
            Sampled::Path { columns, lengths_m } => {
                let path = ArmPath::with_ends(columns, &lengths_m, ends);
                Motion::Path(path.map_err(|e| rows.refused(e.sample(), &e, e.hint()))?)
            }
            Sampled::Tip { columns, recording, .. } => {
                let acceleration = columns.acceleration_m_s2.clone();
                let motion = TipMotion::with_ends(columns, ends);
                let motion = motion.map_err(|e| rows.refused(e.sample(), &e, e.hint()))?;
                let moves_by_column = ends == Ends::AtRest && motion.ends() == Ends::Moving;
                let mut recording = Recording { moves_by_column, ..recording };
                if let Some(acceleration) = acceleration {
                    let deviation = recording.deviation();
                    let of_integral = quality::of_acceleration(&motion, &acceleration, deviation);
                    recording.between = recording.between.or(of_integral);
                }
                Motion::Tip(motion.recorded(recording))
            }
        };
        check_worth(&motion, &rows.name)?;
        Ok(motion)
    }

    /// Refuses velocities at the ends from rounded rows, because they depend on only four rows.
    fn check_ends(&self) -> Result<(), TableError> {
        let Sampled::Tip { columns, recording, .. } = &self.sampled else { return Ok(()) };
        let MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m } = columns;
        let given = velocity_m_s.as_ref().or(acceleration_m_s2.as_ref());
        let displacement_m = displacement_m.as_deref().filter(|_| given.is_none());
        let (Some(samples), Some(uncertainty), Ends::Moving) =
            (displacement_m, &recording.uncertainty, self.ends)
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
        let place = Place { file: &self.rows.name, line: None };
        let hint = "add a column of the velocity, or write the displacement with more decimals";
        Err(place.refuse_whole(&must).with_hint(Some(hint.to_owned())))
    }

    /// Declares normal noise of this standard deviation in rad on a motion of angles: of a link of this length in m, or the
    /// directions of an arm's links.
    ///
    /// # Errors
    /// Those of [`MotionTable::with_noise`]; also a motion of lengths.
    pub fn with_angle_noise(
        mut self,
        deviation_rad: f64,
        link_length_m: f64,
    ) -> Result<Self, TableError> {
        match &mut self.sampled {
            Sampled::Tip { first_angle_rad: Some(_), .. } => {
                return self.with_noise(deviation_rad * link_length_m);
            }
            Sampled::Path { columns, lengths_m }
                if columns.tip.is_none() && columns.carriage.is_none() =>
            {
                // The noise of a direction is that of its arc over its length.
                for (PathColumn { name, values, recording }, _) in columns.each_mut(lengths_m) {
                    let noise = declare_noise(values, recording, deviation_rad);
                    noise.map_err(|error| self.rows.noisy(&format!("{name}: {error}")))?;
                }
            }
            _ => {
                let place = Place { file: &self.rows.name, line: None };
                let error = place.refuse_whole("--noise is an angle, but the motion has lengths");
                let hint = "state the noise as a length, as in --noise '0.1 mm'";
                return Err(error.with_hint(hint.to_owned()));
            }
        }
        Ok(self)
    }

    /// Declares normal noise of this standard deviation in m on the displacement, or on all places of a path; the rests
    /// at the ends become their means. A direction of a link has the noise of the arc that its tip makes.
    ///
    /// # Errors
    /// [`TableError`] unless places or directions define the motion and rest at both ends.
    pub fn with_noise(mut self, deviation_m: f64) -> Result<Self, TableError> {
        let place = Place { file: &self.rows.name, line: None };
        let declared = match &mut self.sampled {
            Sampled::Tip { columns, recording, .. } => {
                let displacement_m = columns.displacement_m.as_mut();
                let Some(own_m) = displacement_m.filter(|_| columns.acceleration_m_s2.is_none())
                else {
                    let must = "--noise needs displacement or angle, and no acceleration";
                    return Err(place.refuse_whole(must));
                };
                declare_noise(own_m, recording, deviation_m).map_err(|error| error.to_string())
            }
            Sampled::Path { columns, lengths_m } => columns.each_mut(lengths_m).try_for_each(
                |(PathColumn { name, values, recording }, length_m)| {
                    let noise = declare_noise(values, recording, deviation_m / length_m);
                    noise.map_err(|error| format!("{name}: {error}"))
                },
            ),
        };
        declared.map_err(|why| self.rows.noisy(&why))?;
        Ok(self)
    }

    /// Sets a cut-off in Hz in place of a search.
    #[must_use]
    pub fn with_lowpass(mut self, hertz: f64) -> Self {
        self.record(|recording| recording.lowpass_rad_s = Some(TAU * hertz));
        self
    }

    /// Changes the quality of all columns.
    fn record(&mut self, change: impl Fn(&mut Recording)) {
        match &mut self.sampled {
            Sampled::Tip { recording, .. } => change(recording),
            Sampled::Path { columns, lengths_m } => {
                columns.each_mut(lengths_m).for_each(|(column, _)| change(&mut column.recording));
            }
        }
    }

    /// The samples at `steps` steps from the first time on. A last one beyond the table is at rest.
    pub(super) fn at_steps(mut self, steps: usize, step_s: f64) -> Self {
        let known_s = self.time_s().clone();
        let uniform = Uniform::of(&known_s, steps, step_s);
        let spacing_s = Some(Uniform::over(&known_s).step_s);
        let on_grid = |values: &mut Vec<f64>, ends| *values = uniform.interpolated(values, ends);
        let displaced = |values: &mut Vec<f64>, recording: &mut Recording, ends| {
            let spline_m = quality::of_spline_m(&known_s, values, ends);
            recording.between.spline_m = recording.between.spline_m.max(spline_m);
            on_grid(values, ends);
        };
        match &mut self.sampled {
            Sampled::Tip { columns, recording, .. } => {
                let ends = self.ends.said_by(columns.velocity_m_s.as_deref());
                let rests =
                    if ends == Ends::AtRest { SplineEnds::Clamped } else { SplineEnds::NotAKnot };
                match (&columns.acceleration_m_s2, &mut columns.displacement_m) {
                    (Some(own), displacement) => {
                        let deviation = recording.deviation();
                        recording.between =
                            quality::of_spline_of_acceleration(&known_s, own, deviation);
                        if let Some(values) = displacement {
                            on_grid(values, rests);
                        }
                    }
                    (None, Some(own)) => displaced(own, recording, rests),
                    (None, None) => {}
                }
                let others = [&mut columns.acceleration_m_s2, &mut columns.velocity_m_s];
                let last_s = known_s[known_s.len() - 1];
                let is_beyond = uniform.times_s[steps] > last_s + LARGEST_JITTER * step_s;
                for own in others.into_iter().flatten() {
                    on_grid(own, SplineEnds::NotAKnot);
                    if is_beyond {
                        own[steps] = 0.0;
                    }
                }
                columns.time_s.clone_from(&uniform.times_s);
            }
            Sampled::Path { columns, lengths_m } => {
                for (PathColumn { values, recording, .. }, _) in columns.each_mut(lengths_m) {
                    displaced(values, recording, SplineEnds::Clamped);
                }
                columns.time_s.clone_from(&uniform.times_s);
            }
        }
        self.rows.lines = uniform.lines(&self.rows.lines);
        self.record(|recording| recording.spacing_s = spacing_s);
        self
    }

    /// Replaces a velocity without other columns by its displacement.
    pub(super) fn with_integral(mut self) -> Self {
        let Sampled::Tip { columns, recording, .. } = &mut self.sampled else { return self };
        if columns.acceleration_m_s2.is_some() || columns.displacement_m.is_some() {
            return self;
        }
        let Some(velocity) = columns.velocity_m_s.take() else { return self };
        let ends = self.ends.said_by(Some(&velocity));
        columns.displacement_m = Some(integral(&columns.time_s, &velocity, ends));
        if ends != Ends::Periodic {
            recording.between = quality::of_velocity(&columns.time_s, &velocity);
        }
        // The displacement does not show the velocity's ends.
        columns.velocity_m_s = (ends != Ends::AtRest).then_some(velocity);
        self
    }

    /// The samples on the uniform grid from the first time to the last. They are interpolated if the times are off the
    /// grid by more than their digits explain, but by at most [`LARGEST_JITTER`] steps.
    fn made_uniform(self) -> Self {
        let time_s = self.time_s();
        let jitter = match &self.sampled {
            Sampled::Tip { columns, .. } => {
                let displacement_m = columns.displacement_m.as_deref();
                jitter(time_s, displacement_m.filter(|_| columns.acceleration_m_s2.is_none()))
            }
            Sampled::Path { columns, .. } => {
                columns.each().find_map(|column| jitter(time_s, Some(&column.values)))
            }
        };
        if jitter.is_none() {
            return self;
        }
        let (steps, step_s) = (time_s.len() - 1, Uniform::over(time_s).step_s);
        let rows = self.rows.clone();
        let mut uniform = self.at_steps(steps, step_s);
        uniform.record(|recording| recording.jitter = jitter);
        Self { rows, ..uniform }
    }
}

impl SampleRows {
    /// The refusal of a noise.
    fn noisy(&self, why: &str) -> TableError {
        let hint =
            "record the tip at rest before and after the motion, or state the noise as it is";
        let place = Place { file: &self.name, line: None };
        place.refuse_whole(why).with_hint(Some(hint.to_owned()))
    }
}

/// Declares noise of this standard deviation on places or directions.
fn declare_noise(
    values: &mut Vec<f64>,
    recording: &mut Recording,
    deviation_m: f64,
) -> Result<(), NoRest> {
    let (rested, moved_m) = rested(values, deviation_m)?;
    *values = rested;
    recording.uncertainty = Some(Uncertainty::Noisy { deviation_m, moved_m });
    Ok(())
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

/// Refuses displacements that hardly exceed their uncertainty. The uncertainty from velocities or accelerations is an
/// error of the solution, which warns of it.
fn check_worth(motion: &Motion, name: &str) -> Result<(), TableError> {
    let uncertain = motion.recording().uncertainty.filter(|own| own.times() == 0);
    let Some(tolerance_m) = uncertain.and_then(|_| motion.known_to_m()) else { return Ok(()) };
    let travel_m = motion.largest_travel_m();
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
    let what = if motion.tip().is_some() { "displacement" } else { "path" };
    Err(place.refuse(what, found, must).with_hint(Some(hint.to_owned())))
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
