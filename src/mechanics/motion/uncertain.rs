//! Errors of a motion's samples, from the quality of its recording.

use super::period::farthest_m;
use super::recording::{Between, Noise, UNCERTAIN, Uncertainty};
use super::samples::Ends;
use super::tip_motion::TipMotion;
use crate::numeric::largest;

/// Errors of the motion between its samples, over its travel, above which they count: of a spline, whose error has the
/// frequency of the samples, and of an integral.
const SPLINE_COUNTS: f64 = 1e-8;
const INTEGRAL_COUNTS: f64 = 1e-4;

/// Standard deviation of an acceleration between its samples, over the largest sample, above which it counts.
const ACCELERATION_COUNTS: f64 = 1e-7;

/// Errors of the samples, over the tip's tolerance, above which they count: the relative error of an acceleration
/// exceeds that of its displacement.
const MATTERS: f64 = 1e-2;

/// Ratio of the error of a slope from four rows to the error of a row.
const OF_FOUR_ROWS: f64 = 3.8;

impl TipMotion {
    /// Estimate of the tip's largest error in m from the samples; `None` for exact samples.
    pub fn known_to_m(&self) -> Option<f64> {
        self.noise().map(|noise| noise.largest_m())
    }

    /// Largest distance of the displacements from the first one in m; for accelerations, the travel.
    pub(super) fn farthest_m(&self) -> f64 {
        match self.samples().displacements_m() {
            [] => self.travel_m().abs(),
            samples => farthest_m(samples[0], samples),
        }
    }

    /// Errors of the samples, if they move the tip noticeably.
    pub(super) fn uncertain(&self, tolerance: f64, travel_m: f64) -> Option<Noise> {
        let matters_m = MATTERS * if tolerance > 0.0 { tolerance } else { UNCERTAIN } * travel_m;
        self.noise().filter(|noise| noise.is_between() || noise.largest_m() > matters_m)
    }

    /// Errors of the motion between its samples, if they count.
    fn between(&self) -> Between {
        let own = self.recording().between;
        if own == Between::default() {
            return own;
        }
        let way_m = self.farthest_m();
        let counts = own.displacement_m > INTEGRAL_COUNTS * way_m;
        let peak_m_s2 = largest(self.samples().forcing_m_s2());
        let above = |own: f64, least: f64| if own > least { own } else { 0.0 };
        Between {
            spline_m: above(own.spline_m, SPLINE_COUNTS * way_m),
            acceleration_m_s2: above(own.acceleration_m_s2, ACCELERATION_COUNTS * peak_m_s2),
            ..if counts { own } else { Between::default() }
        }
    }

    /// Errors of the samples; `None` for exact samples.
    pub(super) fn noise(&self) -> Option<Noise> {
        let (recording, grid, ends) = (self.recording(), self.grid(), self.ends());
        let (first, last) = self.moving_samples();
        let lasts_s = (last - first).max(1) as f64 * grid.step_s;
        let own = recording.uncertainty;
        let times = own.map_or(0, |own| own.times());
        let deviation = recording.deviation();
        let recorded_s = recording.spacing_s.unwrap_or(grid.step_s).max(grid.step_s);
        let spacing_s = match own {
            Some(Uncertainty::Integrated { step, .. }) => {
                let forcing = self.samples().forcing_m_s2();
                let way = if times == 1 {
                    forcing.iter().map(|a| a.abs()).sum::<f64>() * grid.step_s
                } else {
                    forcing.windows(2).map(|two| (two[1] - two[0]).abs()).sum()
                };
                recorded_s.max((step * lasts_s / way).min(lasts_s))
            }
            _ => recorded_s,
        };
        let is_moving = ends == Ends::Moving;
        let of_ends = || recording.velocity_m_s.unwrap_or(OF_FOUR_ROWS * deviation / grid.step_s);
        let ends_m_s = if is_moving && times == 0 { of_ends() } else { 0.0 };
        let of_integral_m = match (times, ends) {
            (1, _) => deviation * (spacing_s * lasts_s).sqrt(),
            // Without another column the samples do not determine the velocity at the start.
            (2, Ends::Moving) if recording.velocity_m_s.is_none() => {
                deviation * (spacing_s * lasts_s.powi(3) / 3.0).sqrt()
            }
            (2, Ends::Moving | Ends::AtRest) => {
                deviation * (spacing_s * lasts_s.powi(3) / 12.0).sqrt()
            }
            _ => 0.0,
        };
        let of_cycle_m = match (times, ends) {
            (2, Ends::Periodic) => deviation * (spacing_s * lasts_s.powi(3) / 720.0).sqrt(),
            _ => 0.0,
        };
        // Beyond its ends a moving tip is off by the error of its velocity.
        let velocity_m_s = match times {
            _ if !is_moving => 0.0,
            0 => ends_m_s,
            1 => deviation,
            _ => recording.velocity_m_s.unwrap_or_default(),
        };
        let of_ends_m = 0.5 * velocity_m_s * lasts_s;
        let between = self.between();
        let off_m = [of_integral_m, of_ends_m, between.displacement_m];
        let travel_m = off_m.iter().map(|own| own * own).sum::<f64>().sqrt();
        let noise = Noise {
            deviation,
            times,
            spacing_s,
            step_s: grid.step_s,
            ends_m_s,
            recorded_s,
            between,
            lasts_s,
            travel_m,
            tip_m: travel_m.max(of_cycle_m),
            largest: (2.0 * libm::log(grid.len.max(2) as f64)).sqrt() + 3.0_f64.sqrt(),
            sampled_m: own.filter(|_| times == 0).map_or(0.0, |own| own.tolerance_m(grid.len)),
        };
        let is_uncertain = deviation > 0.0 || ends_m_s > 0.0 || between != Between::default();
        is_uncertain.then_some(noise)
    }
}
