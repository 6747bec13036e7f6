//! Motion of a link's tip from stop to stop, once or there and back in a cycle.

use super::curve::whole;
use super::error::{CurveError, FEWEST_STEPS};
use super::profile::Profile;
use super::samples::{Ends, MotionColumns};
use super::shaper::Law;

/// Course of a link's tip along its arc through stops, with rest at each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Displacement of each stop from the start in m; the last is the end.
    stops_m: Vec<f64>,
    /// Steps of rest at each intermediate stop, and at both ends of a cycle.
    dwell: usize,
    ends: Ends,
}

impl Course {
    /// A course straight to an end, at this displacement from the start in m.
    pub fn to(distance_m: f64) -> Self {
        Self { stops_m: vec![distance_m], dwell: 0, ends: Ends::AtRest }
    }

    /// A course through stops at these displacements from the start in m, with `dwell` steps of rest at each
    /// intermediate stop.
    ///
    /// # Errors
    /// [`CurveError::Same`] for two equal stops in a row.
    pub fn through(stops_m: Vec<f64>, dwell: usize) -> Result<Self, CurveError> {
        let before = [0.0].into_iter().chain(stops_m.iter().copied());
        match before
            .zip(&stops_m)
            .position(|(from_m, to_m)| (from_m - to_m).abs() < f64::MIN_POSITIVE)
        {
            None => Ok(Self { stops_m, dwell, ends: Ends::AtRest }),
            Some(leg) => Err(CurveError::Same { number: leg + 1 }),
        }
    }

    /// The cycle there and back: after the rest at the far end follow the reversed motion and the rest at the start.
    #[must_use]
    pub fn there_and_back(self) -> Self {
        Self { ends: Ends::Periodic, ..self }
    }

    /// Displacement of each stop from the start in m.
    pub fn stops_m(&self) -> &[f64] {
        &self.stops_m
    }

    /// Tip motion before the first sample and after the last.
    pub fn ends(&self) -> Ends {
        self.ends
    }

    /// Samples of a law whose profile has `steps` steps for the moves of the outward motion, without the rests between
    /// them and the steps of the shaper. Unless the course is a cycle, the tip rests for `rest[0]` steps before and
    /// `rest[1]` after. They are accelerations or, shaped, displacements.
    ///
    /// Moves share the steps by the roots of their lengths, so that all have the same acceleration, as nearly as whole
    /// steps allow. The first sample of a cycle follows its last one a step later.
    ///
    /// # Errors
    /// [`CurveError::FewSteps`] for a move, [`CurveError::TurnsAtOnce`] for a stop without rest at which the
    /// acceleration of the profile jumps from one sign to the other, unless it is shaped.
    pub fn sampled(
        &self,
        law: &Law,
        step_s: f64,
        steps: usize,
        rest: [usize; 2],
    ) -> Result<MotionColumns, CurveError> {
        let profile = law.profile();
        if let ([distance_m], Ends::AtRest, 0) = (&self.stops_m[..], self.ends, law.more_steps()) {
            return Ok(profile.sampled(*distance_m, step_s, steps, rest));
        }
        let moves = self.moves(steps)?;
        let is_cycle = self.ends == Ends::Periodic;
        let (acceleration_m_s2, displacement_m) = if law.more_steps() > 0 {
            (None, Some(self.shaped_m(law, moves, rest)))
        } else if is_cycle {
            let there = self.there(profile, step_s, &moves)?;
            self.check_turn(profile, self.stops_m.len())?;
            let mut cycle = there.clone();
            append(&mut cycle, there.into_iter().rev(), self.dwell);
            // The next cycle's first sample follows the rest.
            append(&mut cycle, [0.0], self.dwell);
            let seam = cycle.pop().unwrap_or_default();
            cycle[0] += seam;
            (Some(cycle), None)
        } else {
            let there = self.there(profile, step_s, &moves)?;
            let rests = rest.map(|steps| vec![0.0; steps]);
            (Some([rests[0].clone(), there, rests[1].clone()].concat()), None)
        };
        let samples = acceleration_m_s2.as_ref().or(displacement_m.as_ref()).map_or(0, Vec::len);
        Ok(MotionColumns {
            time_s: (0..samples).map(|k| k as f64 * step_s).collect(),
            acceleration_m_s2,
            displacement_m,
            velocity_m_s: None,
        })
    }

    /// The outward moves: start and end in m, and steps of the profile.
    fn moves(&self, steps: usize) -> Result<Vec<([f64; 2], usize)>, CurveError> {
        let before = [0.0].into_iter().chain(self.stops_m.iter().copied());
        let ends_m = || before.clone().zip(self.stops_m.iter().copied());
        let root = |(from_m, to_m): (f64, f64)| (to_m - from_m).abs().sqrt();
        let all: f64 = ends_m().map(root).sum();
        let (mut gone, mut first) = (0.0, 0);
        let own = |(number, (from_m, to_m)): (usize, (f64, f64))| {
            gone += root((from_m, to_m));
            let last = whole(steps as f64 * gone / all);
            let own = last - first;
            first = last;
            if own < FEWEST_STEPS {
                return Err(CurveError::FewSteps { number, steps: own, all: steps });
            }
            Ok(([from_m, to_m], own))
        };
        (1..).zip(ends_m()).map(own).collect()
    }

    /// Accelerations in m/s² from the start to the last stop.
    fn there(
        &self,
        profile: Profile,
        step_s: f64,
        moves: &[([f64; 2], usize)],
    ) -> Result<Vec<f64>, CurveError> {
        let (mut samples, mut before_m) = (vec![0.0], None);
        for (number, ([from_m, to_m], own)) in moves.iter().enumerate() {
            let move_m = to_m - from_m;
            if before_m.is_some_and(|before_m: f64| before_m * move_m < 0.0) {
                self.check_turn(profile, number)?;
            }
            let columns = profile.sampled(move_m, step_s, *own, [0, 0]);
            let dwell = if number > 0 { self.dwell } else { 0 };
            append(&mut samples, columns.acceleration_m_s2.unwrap_or_default(), dwell);
            before_m = Some(move_m);
        }
        Ok(samples)
    }

    /// Displacements in m of shaped moves. Those back are shaped, too: they are not the reversed ones.
    fn shaped_m(&self, law: &Law, mut moves: Vec<([f64; 2], usize)>, rest: [usize; 2]) -> Vec<f64> {
        let is_cycle = self.ends == Ends::Periodic;
        if is_cycle {
            let back = moves.iter().rev().map(|([from_m, to_m], own)| ([*to_m, *from_m], *own));
            moves.extend(back.collect::<Vec<_>>());
        }
        let mut places_m = vec![0.0; 1 + rest[0]];
        for (number, ([from_m, to_m], own)) in moves.iter().enumerate() {
            let dwell = if number > 0 { self.dwell } else { 0 };
            places_m.extend(std::iter::repeat_n(*from_m, dwell));
            places_m.extend(law.places_m(*from_m, *to_m, *own));
        }
        let end_m = places_m.last().copied().unwrap_or_default();
        places_m.extend(std::iter::repeat_n(end_m, if is_cycle { self.dwell } else { rest[1] }));
        if is_cycle {
            // The next cycle's first sample follows the rest.
            places_m.pop();
        }
        places_m
    }

    /// Refuses a turn at a stop, numbered from 1, if the acceleration jumps with one sign and no rest separates the
    /// jumps.
    fn check_turn(&self, profile: Profile, stop: usize) -> Result<(), CurveError> {
        let jumps = profile.jumps_at_its_ends();
        if jumps && self.dwell == 0 {
            return Err(CurveError::TurnsAtOnce { stop, profile: profile.name() });
        }
        Ok(())
    }
}

/// Appends the samples of a move that begins `dwell` steps after the last sample. For `dwell` 0 the last sample and the
/// move's first one coincide, and their accelerations add up.
fn append(samples: &mut Vec<f64>, own: impl IntoIterator<Item = f64>, dwell: usize) {
    let mut own = own.into_iter();
    if dwell == 0 {
        let first = own.next().unwrap_or_default();
        if let Some(last) = samples.last_mut() {
            *last += first;
        }
    } else {
        samples.extend(std::iter::repeat_n(0.0, dwell - 1));
    }
    samples.extend(own);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::TipMotion;

    const STEP_S: f64 = 0.01;

    /// Displacement at each sample, integrated like in [`TipMotion`], but written out.
    fn displacements_m(columns: &MotionColumns) -> Vec<f64> {
        let (mut velocity, mut displacement) = (0.0, 0.0);
        let accelerations = columns.acceleration_m_s2.as_ref().unwrap();
        accelerations
            .iter()
            .map(|own| {
                let here = displacement;
                velocity += STEP_S * own;
                displacement += STEP_S * velocity;
                here
            })
            .collect()
    }

    #[test]
    fn the_tip_rests_at_each_stop() {
        for profile in Profile::ALL {
            let course = Course::through(vec![0.1, -0.3, 0.6], 7).unwrap();
            let columns = course.sampled(&profile.into(), STEP_S, 120, [3, 2]).unwrap();
            assert_eq!(columns.time_s.len(), 120 + 2 * 7 + 3 + 2 + 1, "{profile}");
            let displacement = displacements_m(&columns);
            // Moves of 0.1, 0.4 and 0.9 m take 20, 40 and 60 steps: equal acceleration.
            for (samples, at_m) in [(0..=3, 0.0), (24..=30, 0.1), (71..=77, -0.3), (138..=139, 0.6)]
            {
                for k in samples {
                    let off_m = displacement[k] - at_m;
                    assert!(off_m.abs() < 1e-13, "{profile} at {k}: {off_m:e}");
                }
            }
            assert_eq!(TipMotion::new(columns).unwrap().corrected(), None);
        }
    }

    #[test]
    fn a_cycle_goes_back_as_it_came_and_begins_again() {
        let all = Profile::ALL.map(|profile| (profile, 9)).into_iter();
        let without_rest = Profile::ALL.map(|profile| (profile, 0)).into_iter();
        let without_rest = without_rest.filter(|(profile, _)| !profile.jumps_at_its_ends());
        for (profile, dwell) in all.chain(without_rest) {
            let course = Course::through(vec![0.1, 0.4], dwell).unwrap().there_and_back();
            let columns = course.sampled(&profile.into(), STEP_S, 40, [0, 0]).unwrap();
            // Two moves there and two back, with a rest after each.
            assert_eq!(columns.time_s.len(), 2 * 40 + 4 * dwell, "{profile}");
            let own = columns.acceleration_m_s2.clone().unwrap();
            assert!(own.iter().sum::<f64>().abs() < 1e-12, "{profile} does not end at rest");
            let there = 40 + dwell;
            for k in 1..there {
                let back = own[there + dwell + (there - k)];
                assert!((own[k] - back).abs() < 1e-12, "{profile} at {k}");
            }
            let displacement = displacements_m(&columns);
            let far_m = displacement[there + usize::from(dwell > 0)];
            // In the sample that both motions share, the end of the bell already acts.
            let most_m = if dwell > 0 { 1e-13 } else { 1e-6 };
            assert!((far_m - 0.4).abs() < most_m, "{profile}: {far_m}");
            let motion = TipMotion::with_ends(columns, course.ends()).unwrap();
            assert!(motion.travel_m().abs() < 1e-13 && motion.ends() == Ends::Periodic);
            // With any number of steps its last sample is not taken for a repeated first one.
            for steps in [100, 250, 1000] {
                let columns = course.sampled(&profile.into(), STEP_S, steps, [0, 0]).unwrap();
                let motion = TipMotion::with_ends(columns, course.ends());
                assert!(motion.is_ok(), "{profile}, {steps}: {:?}", motion.err());
            }
        }
    }

    #[test]
    fn what_cannot_be_sampled_is_refused() {
        let same = Course::through(vec![0.2, 0.2], 0).unwrap_err();
        assert_eq!(same, CurveError::Same { number: 2 });
        let back = Course::through(vec![0.2, 0.1], 0).unwrap();
        let at_once = CurveError::TurnsAtOnce { stop: 1, profile: "bang-bang" };
        assert_eq!(
            back.sampled(&Profile::BangBang.into(), STEP_S, 40, [0, 0]).unwrap_err(),
            at_once
        );
        assert!(back.sampled(&Profile::MinJerk.into(), STEP_S, 40, [0, 0]).is_ok());
        let near = Course::through(vec![0.2, 0.15], 0).unwrap();
        let few = CurveError::FewSteps { number: 2, steps: 3, all: 9 };
        assert_eq!(near.sampled(&Profile::MinJerk.into(), STEP_S, 9, [0, 0]).unwrap_err(), few);
        let cycle = Course::to(0.5).there_and_back();
        assert!(cycle.sampled(&Profile::Versine.into(), STEP_S, 40, [0, 0]).is_err());
    }
}
