//! Inputs of a simulation over time: a torque, and a hub motion for feedback.

use thiserror::Error;

use super::driving::{CycleError, Interpolation, Jump};
use super::error::SimulationError;
use crate::link::{ParameterError, not_negative};
use crate::motion::wrapped;
use crate::numeric::{CubicSpline, NotUniform, QuinticSpline, SplineEnds, TimeCurve, TimeGrid};

/// Warning threshold of the angle between a reference and the hub at the start in rad.
pub(super) const APART_RAD: f64 = 1e-4;

/// Step of an angle from its last sample to its first, over the largest between samples, that is too large for a
/// repeating motion.
const JUMP: f64 = 3.0;

/// Fewest samples of a torque or a reference.
const MIN_SAMPLES: usize = 4;

/// Reason why samples over time are no torque or hub reference.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HistoryError {
    /// Fewer than 4 samples, or different numbers of samples and times.
    #[error(
        "{column} has {samples} samples and time {times}, but both must have equally many, at \
         least 4"
    )]
    Shape {
        /// Name of the column.
        column: &'static str,
        /// Samples of the column.
        samples: usize,
        /// Samples of the time column.
        times: usize,
    },
    /// A sample that is NaN or infinite.
    #[error("{column} = {found}, but must be a finite number")]
    NotFinite {
        /// Number of the sample, from 0.
        sample: usize,
        /// Name of the column.
        column: &'static str,
        /// Value of the sample.
        found: f64,
    },
    /// A time off the uniform grid.
    #[error(transparent)]
    NotUniform(#[from] NotUniform),
}

impl HistoryError {
    /// Number of the sample that causes the error, from 0, if one does.
    pub fn sample(&self) -> Option<usize> {
        match self {
            Self::NotFinite { sample, .. } | Self::NotUniform(NotUniform { sample, .. }) => {
                Some(*sample)
            }
            Self::Shape { .. } => None,
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NotUniform(error) => Some(error.hint()),
            Self::Shape { .. } | Self::NotFinite { .. } => None,
        }
    }
}

/// The uniform grid through times in s. Every named column must have a sample for each time.
pub(super) fn grid_of(
    time_s: &[f64],
    columns: &[(&'static str, &[f64])],
) -> Result<TimeGrid, HistoryError> {
    let times = time_s.len();
    for &(column, samples) in columns {
        let samples = samples.len();
        if samples != times || times < MIN_SAMPLES {
            return Err(HistoryError::Shape { column, samples, times });
        }
    }
    for &(column, samples) in [("time", time_s)].iter().chain(columns) {
        if let Some(sample) = samples.iter().position(|x| !x.is_finite()) {
            return Err(HistoryError::NotFinite { sample, column, found: samples[sample] });
        }
    }
    Ok(TimeGrid::through(time_s)?)
}

/// A torque at the hub on a uniform time grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Torque {
    grid: TimeGrid,
    torque_n_m: Vec<f64>,
}

impl Torque {
    /// Checks samples in N m at times in s.
    ///
    /// ```
    /// use flexlink::response::Torque;
    /// let torque = Torque::new(&[-0.5, 0.0, 0.5, 1.0], vec![0.0, 2.0, 2.0, 0.0])?;
    /// assert_eq!((torque.grid().time_s(0), torque.grid().step_s), (-0.5, 0.5));
    /// assert!(Torque::new(&[0.0, 0.5, 1.5, 2.0], vec![0.0; 4]).is_err(), "an uneven step");
    /// # Ok::<(), flexlink::response::HistoryError>(())
    /// ```
    ///
    /// # Errors
    /// [`HistoryError`]: fewer than 4 samples, different numbers of samples and times, a sample that is not finite, or
    /// times off a uniform grid.
    pub fn new(time_s: &[f64], torque_n_m: Vec<f64>) -> Result<Self, HistoryError> {
        let grid = grid_of(time_s, &[("torque", &torque_n_m)])?;
        Ok(Self { grid, torque_n_m })
    }

    /// Grid of the samples; its origin is the first sample.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Torque in N m at each time of the grid.
    pub fn torque_n_m(&self) -> &[f64] {
        &self.torque_n_m
    }

    /// The torque times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let torque_n_m = self.torque_n_m.iter().map(|own| factor * own).collect();
        Self { torque_n_m, ..*self }
    }
}

/// A motion of the hub on a uniform time grid, as a reference of feedback or as a prescribed motion.
#[derive(Debug, Clone, PartialEq)]
pub struct HubReference {
    grid: TimeGrid,
    angle_rad: Vec<f64>,
    rate_rad_s: Option<Vec<f64>>,
    /// Angle in rad and rate in rad/s at which the hub arrives at its first sample.
    arrival: Option<[f64; 2]>,
}

impl HubReference {
    /// Checks angles in rad and optional rates in rad/s at times in s.
    ///
    /// # Errors
    /// [`HistoryError`]: fewer than 4 samples, different numbers of samples and times, a sample that is not finite, or
    /// times off a uniform grid.
    pub fn new(
        time_s: &[f64],
        angle_rad: Vec<f64>,
        rate_rad_s: Option<Vec<f64>>,
    ) -> Result<Self, HistoryError> {
        let rate = rate_rad_s.as_deref().map(|rate| ("hub_rate", rate));
        let columns: Vec<_> = [("hub_angle", &angle_rad[..])].into_iter().chain(rate).collect();
        let grid = grid_of(time_s, &columns)?;
        Ok(Self { grid, angle_rad, rate_rad_s, arrival: None })
    }

    /// The motion as a prescribed one whose hub arrives at the first sample with an angle in rad and a rate in rad/s, and with
    /// it a linear link that turns undeformed. Without this the hub rests at the first sample.
    #[must_use]
    pub fn arriving(self, angle_rad: f64, rate_rad_s: f64) -> Self {
        Self { arrival: Some([angle_rad, rate_rad_s]), ..self }
    }

    /// Angle in rad and rate in rad/s of a prescribed hub before its first sample.
    pub(super) fn arrival(&self) -> [f64; 2] {
        self.arrival.unwrap_or([self.angle_rad[0], 0.0])
    }

    /// The motion at the times of `grid`: samples at these times as they are, others by a cubic spline. `None` for times before
    /// the first sample or after the last.
    pub fn on_times(&self, grid: &TimeGrid) -> Option<Self> {
        let own = self.grid;
        let curve = TimeCurve::new(own, &self.angle_rad, SplineEnds::NotAKnot);
        if ![grid.time_s(0), grid.end_s()].iter().all(|time_s| curve.covers(*time_s)) {
            return None;
        }
        let on_grid = |samples: &[f64]| TimeCurve::resampled(samples, own, grid).into_owned();
        let rate_rad_s = self.rate_rad_s.as_deref().map(on_grid);
        let angle_rad = on_grid(&self.angle_rad);
        Some(Self { grid: *grid, angle_rad, rate_rad_s, ..self.clone() })
    }

    /// Grid of the samples; its origin is the first sample.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Hub angle in rad at each time of the grid.
    pub fn angle_rad(&self) -> &[f64] {
        &self.angle_rad
    }

    /// Hub rate in rad/s at each time of the grid, for a reference with rates.
    pub fn rate_rad_s(&self) -> Option<&[f64]> {
        self.rate_rad_s.as_deref()
    }

    /// Turn in rad from the first sample, or from another angle, to the last sample.
    pub(super) fn turn_rad(&self, zero_rad: Option<f64>) -> f64 {
        let angle = self.angle_rad();
        angle[angle.len() - 1] - zero_rad.unwrap_or(angle[0])
    }

    /// Rates in rad/s of a cubic spline through the angles, which may repeat.
    pub(super) fn slopes_rad_s(&self, repeats: bool) -> Vec<f64> {
        let angles_rad = self.angle_rad();
        let around = if repeats { angles_rad.len() } else { 0 };
        let spline = CubicSpline::uniform(&wrapped(angles_rad, 0.0, around), SplineEnds::NotAKnot);
        let slopes = &spline.slopes()[around..][..angles_rad.len()];
        slopes.iter().map(|slope| slope / self.grid().step_s).collect()
    }

    /// Angle in rad from the last sample to the first one a cycle's turn later. `None` for a plausible step of a
    /// repeating motion.
    pub(super) fn jump_rad(&self, turn_rad: f64) -> Option<f64> {
        let angles_rad = self.angle_rad();
        let steps = angles_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let jump_rad = angles_rad[0] + turn_rad - angles_rad[angles_rad.len() - 1];
        (jump_rad.abs() > JUMP * steps.fold(0.0, f64::max)).then_some(jump_rad)
    }

    /// Jump of a prescribed hub's angle in rad at its first sample.
    pub(super) fn first_jump_rad(&self) -> f64 {
        self.angle_rad[0] - self.arrival()[0]
    }

    /// Jumps of position and rate at the samples, for a joint that keeps each position until the next sample, or moves
    /// along straight lines. A joint that does not repeat rests after its last sample.
    pub(super) fn jumps(&self, is_stairs: bool, cycle_turn_rad: Option<f64>) -> Vec<Jump> {
        let own = self.angle_rad();
        // From the last sample to the first one of the next cycle.
        let around = cycle_turn_rad.map_or(0.0, |turn_rad| own[0] + turn_rad - own[own.len() - 1]);
        let rises = own.windows(2).map(|pair| pair[1] - pair[0]).chain([around]);
        if is_stairs {
            let jumps = [around].into_iter().chain(rises.take(own.len() - 1));
            return self.begun(jumps.map(|rise| [rise, 0.0]).collect(), cycle_turn_rad);
        }
        let rates: Vec<f64> = rises.map(|rise| rise / self.grid().step_s).collect();
        let before = [rates[own.len() - 1]].into_iter().chain(rates.iter().copied());
        let jumps = rates.iter().zip(before).map(|(rate, before)| [0.0, rate - before]);
        self.begun(jumps.collect(), cycle_turn_rad)
    }

    /// Jumps with the first one from the motion before it, unless they repeat.
    fn begun(&self, mut jumps: Vec<Jump>, cycle_turn_rad: Option<f64>) -> Vec<Jump> {
        if cycle_turn_rad.is_none() {
            jumps[0][0] += self.first_jump_rad();
            jumps[0][1] -= self.arrival()[1];
        }
        jumps
    }

    /// Rate in rad/s at the first sample of a repeating cycle, else before it. A jump comes later.
    pub(super) fn first_rate_rad_s(
        &self,
        interpolation: Interpolation,
        cycle_turn_rad: Option<f64>,
    ) -> f64 {
        let own = self.angle_rad();
        match interpolation {
            Interpolation::Cubic => self.accelerations(cycle_turn_rad, false).2,
            Interpolation::Linear if cycle_turn_rad.is_some() => {
                (own[1] - own[0]) / self.grid().step_s
            }
            Interpolation::Linear | Interpolation::Zero => self.arrival()[1],
        }
    }

    /// Accelerations in rad/s² at the samples and between them, and the first rate in rad/s: the one before the first
    /// sample, or the one of a repeating cycle with this turn. A joint that `stops` is where its last sample is a step later,
    /// without rate and acceleration.
    pub(super) fn accelerations(
        &self,
        cycle_turn_rad: Option<f64>,
        stops: bool,
    ) -> (Vec<f64>, Vec<[f64; 4]>, f64) {
        let (own, turn_rad) = (self.angle_rad(), cycle_turn_rad.unwrap_or(0.0));
        let around = if cycle_turn_rad.is_some() { own.len() } else { 0 };
        let (step_s, [_, arrival_rad_s]) = (self.grid().step_s, self.arrival());
        // A steady turn has no acceleration.
        let steady = |(k, angle_rad)| angle_rad - k as f64 * step_s * arrival_rad_s;
        let bent: Vec<f64> =
            wrapped(own, turn_rad, around).into_iter().enumerate().map(steady).collect();
        let spline = QuinticSpline::from_rest(&bent);
        let per_s2 = step_s.powi(-2);
        let samples = spline.curvatures().skip(around).take(own.len());
        let pieces = spline.curvature_pieces().skip(around).take(own.len());
        let stop = spline.stop(arrival_rad_s * step_s);
        let stop = stops.then_some(stop).into_iter();
        (
            samples.map(|curvature| curvature * per_s2).collect(),
            pieces.chain(stop).map(|piece| piece.map(|c| c * per_s2)).collect(),
            spline.slope(around) / step_s + arrival_rad_s,
        )
    }
}

/// Distance of a time from a sample, in steps, that counts as none.
const SAME_TIME: f64 = 1e-3;

/// Whether two grids have the same samples, times within a thousandth of a step.
pub(super) fn same_times(a: &TimeGrid, b: &TimeGrid) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= SAME_TIME * a.step_s;
    a.len == b.len
        && near(a.time_s(0), b.time_s(0))
        && near(a.time_s(a.len - 1), b.time_s(b.len - 1))
}

/// Collocated feedback at the hub around a computed motion (Bayo 1987, section 6).
///
/// ```text
/// u = T + k_p (θ_ref − θ) + k_d (θ̇_ref − θ̇)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    stiffness_n_m_rad: f64,
    damping_n_m_s_rad: f64,
    reference: HubReference,
}

impl Feedback {
    /// Checks gains `k_p` in N m/rad and `k_d` in N m s/rad around a reference.
    ///
    /// # Errors
    /// [`ParameterError`] names the first gain that is negative or not finite.
    pub fn new(
        stiffness_n_m_rad: f64,
        damping_n_m_s_rad: f64,
        reference: HubReference,
    ) -> Result<Self, ParameterError> {
        not_negative("KP", stiffness_n_m_rad, "N m/rad")?;
        not_negative("KD", damping_n_m_s_rad, "N m s/rad")?;
        Ok(Self { stiffness_n_m_rad, damping_n_m_s_rad, reference })
    }

    /// `k_p` in N m/rad.
    pub fn stiffness_n_m_rad(&self) -> f64 {
        self.stiffness_n_m_rad
    }

    /// `k_d` in N m s/rad.
    pub fn damping_n_m_s_rad(&self) -> f64 {
        self.damping_n_m_s_rad
    }

    /// True unless damping alone acts and the reference has rates.
    fn needs_angles(&self) -> bool {
        self.stiffness_n_m_rad > 0.0 || self.reference.rate_rad_s().is_none()
    }

    /// The reference.
    pub fn reference(&self) -> &HubReference {
        &self.reference
    }

    /// Refuses a torque at other times than those of the reference.
    ///
    /// # Errors
    /// [`SimulationError::OtherTimes`].
    pub fn check_times(&self, torque: &Torque) -> Result<(), SimulationError> {
        let (found, torque) = (self.reference.grid(), torque.grid());
        if same_times(&found, &torque) {
            return Ok(());
        }
        Err(SimulationError::OtherTimes { found, torque })
    }

    /// The reference's part of the torque at each sample, `k_p (θ_ref − θ_ref(0)) + k_d θ̇_ref`. The link starts at the
    /// reference's first angle, or from a state with angles from `zero_rad`.
    ///
    /// # Errors
    /// [`SimulationError::OtherTimes`].
    pub(super) fn wanted_torque_n_m(
        &self,
        torque: &Torque,
        zero_rad: Option<f64>,
        repeats: bool,
    ) -> Result<Vec<f64>, SimulationError> {
        self.check_times(torque)?;
        if let Some(jump_rad) =
            self.reference.jump_rad(0.0).filter(|_| repeats && self.needs_angles())
        {
            return Err(CycleError::Reference { jump_rad }.into());
        }
        let angle = self.reference.angle_rad();
        let zero_rad = zero_rad.unwrap_or(angle[0]);
        let wanted = angle.iter().zip(self.rate_rad_s(repeats)).map(|(angle_rad, rate)| {
            self.stiffness_n_m_rad * (angle_rad - zero_rad) + self.damping_n_m_s_rad * rate
        });
        Ok(wanted.collect())
    }

    /// Rate of the reference, or of a spline through its angles.
    pub(super) fn rate_rad_s(&self, repeats: bool) -> Vec<f64> {
        let known = self.reference.rate_rad_s().map(<[f64]>::to_vec);
        known.unwrap_or_else(|| self.reference.slopes_rad_s(repeats))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIME_S: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];

    fn refusal(result: Result<impl Sized, HistoryError>) -> (String, Option<usize>) {
        let error = result.err().unwrap();
        (error.to_string(), error.sample())
    }

    #[test]
    fn a_history_keeps_its_samples_and_begins_at_its_first_time() {
        let torque = Torque::new(&TIME_S, vec![1.0, 2.0, 3.0, 2.0, 1.0]).unwrap();
        let grid = torque.grid();
        assert_eq!((grid.origin_s, grid.first, grid.len), (0.1, 0, 5));
        assert!((grid.step_s - 0.1).abs() < 1e-16);
        assert_eq!(torque.torque_n_m(), [1.0, 2.0, 3.0, 2.0, 1.0]);
        let hub = HubReference::new(&TIME_S, vec![0.5; 5], Some(vec![0.0; 5])).unwrap();
        assert_eq!(
            (hub.grid(), hub.angle_rad(), hub.rate_rad_s()),
            (grid, &[0.5; 5][..], Some(&[0.0; 5][..]))
        );
        assert_eq!(HubReference::new(&TIME_S, vec![0.5; 5], None).unwrap().rate_rad_s(), None);
    }

    #[test]
    fn short_and_ragged_columns_are_refused() {
        let must = "but both must have equally many, at least 4";
        let short = refusal(Torque::new(&TIME_S[..3], vec![0.0; 3]));
        assert_eq!(short, (format!("torque has 3 samples and time 3, {must}"), None));
        assert!(Torque::new(&[], vec![]).is_err());
        let ragged = refusal(Torque::new(&TIME_S, vec![0.0; 4]));
        assert_eq!(ragged, (format!("torque has 4 samples and time 5, {must}"), None));
        let ragged = refusal(HubReference::new(&TIME_S, vec![0.0; 5], Some(vec![0.0; 6])));
        assert_eq!(ragged, (format!("hub_rate has 6 samples and time 5, {must}"), None));
    }

    #[test]
    fn samples_that_are_no_numbers_are_refused_wherever_they_stand() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut samples = vec![0.0; 5];
            samples[3] = bad;
            let expected =
                |column: &str| (format!("{column} = {bad}, but must be a finite number"), Some(3));
            assert_eq!(refusal(Torque::new(&samples, vec![0.0; 5])), expected("time"));
            assert_eq!(refusal(Torque::new(&TIME_S, samples.clone())), expected("torque"));
            let rate = Some(samples.clone());
            assert_eq!(
                refusal(HubReference::new(&TIME_S, vec![0.0; 5], rate)),
                expected("hub_rate")
            );
            assert_eq!(refusal(HubReference::new(&TIME_S, samples, None)), expected("hub_angle"));
        }
    }

    #[test]
    fn times_off_the_grid_are_refused_as_those_of_a_motion_are() {
        let error = Torque::new(&[0.0, 0.1, 0.2, 0.4, 0.5], vec![0.0; 5]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "time = 0.4 s, but must be 0.3 s: the samples before and after are 0.1 s apart"
        );
        assert_eq!(error.sample(), Some(3));
        let hint = "write times with more decimals, or resample the file to a uniform step";
        assert_eq!(error.hint(), Some(hint));
        for times in [[0.0; 4], [3.0, 2.0, 1.0, 0.0], [-1e308, 0.0, 1e308, 1.1e308]] {
            assert!(Torque::new(&times, vec![0.0; 4]).is_err(), "{times:?}");
        }
    }
}
