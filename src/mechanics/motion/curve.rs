//! Curves in the plane by their arc length: lines through points, with rounded corners, and arcs; and the places on
//! them over time.

use std::f64::consts::PI;

use super::error::{CurveError, FEWEST_STEPS};
use super::path::PathColumns;
use super::profile::Profile;
use super::shaper::Law;
use crate::numeric::GaussRule;

/// Largest coordinate, radius and length in m, and smallest length.
const LARGEST_M: f64 = 1e100;
const LEAST_M: f64 = 1e-100;

/// Largest turn in rad of a corner that can be rounded: almost a reversal.
const LARGEST_TURN: f64 = 175.0 / 180.0 * PI;

/// Share of a length that is round-off.
const ROUND_OFF: f64 = 1e-12;

/// Number of Gauss points along half a rounded corner: its integrals are exact to round-off.
const POINTS: usize = 32;

/// A place or a direction in the plane, along x and y.
type Vector = [f64; 2];

/// A curve in the plane that a tip follows from start to end, and its stops.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The pieces, and the arc length in m at the start of each.
    pieces: Vec<(f64, Piece)>,
    length_m: f64,
    /// Arc lengths in m of the stops, including the end.
    stops_m: Vec<f64>,
    /// Steps of rest at each intermediate stop.
    dwell: usize,
    /// Places in m of an arm's carriage at both ends, if it moves along.
    carriage_m: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
enum Piece {
    Line { from_m: Vector, to_m: Vector },
    Arc { center_m: Vector, from_m: Vector, angle_rad: f64 },
    Corner(Corner),
}

impl Curve {
    /// Straight legs through these points, in m; the tip stops at each of them.
    ///
    /// # Errors
    /// [`CurveError`] for equal points or coordinates that are not finite.
    pub fn through(points_m: &[[f64; 2]]) -> Result<Self, CurveError> {
        check_points(points_m)?;
        let legs = points_m.windows(2);
        let pieces = legs.map(|pair| Piece::Line { from_m: pair[0], to_m: pair[1] }).collect();
        let mut curve = Self::of(pieces);
        let inner = curve.pieces.iter().skip(1).map(|(start_m, _)| *start_m);
        curve.stops_m = inner.chain([curve.length_m]).collect();
        Ok(curve)
    }

    /// Legs through these points, in m, with corners rounded from `reach_m` before each point to `reach_m` after it;
    /// the tip stops only at the end.
    ///
    /// Along a rounded corner the direction follows [`Profile::Septic`] over the arc length: curvature and its first
    /// two derivatives do not jump from the legs into the corner.
    ///
    /// # Errors
    /// [`CurveError`] for equal points, a corner that turns back and corners that overlap.
    pub fn rounded(points_m: &[[f64; 2]], reach_m: f64) -> Result<Self, CurveError> {
        check_points(points_m)?;
        if !(LEAST_M..=LARGEST_M).contains(&reach_m) {
            return Err(CurveError::Corner { reach_m });
        }
        let corner = |(number, points): (usize, &[Vector])| {
            Corner::of([points[0], points[1], points[2]], reach_m, number + 2)
        };
        let corners: Vec<_> =
            points_m.windows(3).enumerate().map(corner).collect::<Result<_, _>>()?;
        let mut pieces = Vec::new();
        let mut from_m = points_m[0];
        for (leg, pair) in points_m.windows(2).enumerate() {
            let before = leg.checked_sub(1).and_then(|before| corners[before].as_ref());
            let after = corners.get(leg).and_then(Option::as_ref);
            let length_m = distance_m(pair[0], pair[1]);
            let taken_m = [before, after].into_iter().flatten().count() as f64 * reach_m;
            if taken_m > (1.0 + ROUND_OFF) * length_m {
                return Err(CurveError::Overlap { number: leg + 1, taken_m, length_m });
            }
            let to_m = after.map_or(pair[1], |corner| corner.start_m);
            if taken_m < (1.0 - ROUND_OFF) * length_m {
                pieces.push(Piece::Line { from_m, to_m });
            }
            from_m = after.map_or(to_m, |corner| corner.end_m);
            pieces.extend(after.cloned().map(Piece::Corner));
        }
        Ok(Self::of(pieces))
    }

    /// An arc from a place about a centre, both in m, by an angle in rad, counterclockwise if positive. It may exceed a
    /// turn.
    ///
    /// # Errors
    /// [`CurveError`] for an arc without length.
    pub fn arc(from_m: [f64; 2], center_m: [f64; 2], angle_rad: f64) -> Result<Self, CurveError> {
        check_numbers(&[from_m, center_m])?;
        if is_out_of_range(angle_rad) {
            return Err(CurveError::Range { name: "the angle", found: angle_rad });
        }
        let curve = Self::of(vec![Piece::Arc { center_m, from_m, angle_rad }]);
        let length_m = curve.length_m;
        if (LEAST_M..=LARGEST_M).contains(&length_m) {
            Ok(curve)
        } else {
            Err(CurveError::NoArc { length_m })
        }
    }

    fn of(pieces: Vec<Piece>) -> Self {
        let mut length_m = 0.0;
        let placed = pieces.into_iter().map(|piece| {
            let start_m = length_m;
            length_m += piece.length_m();
            (start_m, piece)
        });
        let pieces = placed.collect();
        Self { pieces, length_m, stops_m: vec![length_m], dwell: 0, carriage_m: None }
    }

    /// Sets the number of steps of rest at each intermediate stop.
    #[must_use]
    pub fn with_dwell(self, steps: usize) -> Self {
        Self { dwell: steps, ..self }
    }

    /// Moves an arm's carriage along, between these places in m: its share of the way is that of the tip on the curve.
    #[must_use]
    pub fn with_carriage(self, carriage_m: Option<[f64; 2]>) -> Self {
        Self { carriage_m, ..self }
    }

    /// Length of the curve in m.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Arc lengths in m of the stops, including the end.
    pub fn stops_m(&self) -> &[f64] {
        &self.stops_m
    }

    /// The place at an arc length in m, from 0 to the curve's length.
    pub fn at(&self, arc_m: f64) -> [f64; 2] {
        let piece = self.pieces.partition_point(|(start_m, _)| *start_m <= arc_m).max(1) - 1;
        let (start_m, piece) = &self.pieces[piece];
        piece.at(((arc_m - start_m) / piece.length_m()).clamp(0.0, 1.0))
    }

    /// Places of a carriage in m where the tip is at an arc length; `None` without a carriage.
    pub fn carriage_at(&self, arc_m: f64) -> Option<f64> {
        let [from_m, to_m] = self.carriage_m?;
        let way = Piece::Line { from_m: [from_m, 0.0], to_m: [to_m, 0.0] };
        Some(way.at(arc_m / self.length_m)[0])
    }

    /// Places at the samples of a law whose profile has `steps` steps, at rest for `rest[0]` steps before and `rest[1]`
    /// after. It is the law of the arc length over the whole curve, or over each leg if the tip stops between. Legs
    /// share the steps by their lengths, so that the tip is equally fast on each, as nearly as whole steps allow.
    ///
    /// # Errors
    /// [`CurveError::FewSteps`] for a leg with too few steps.
    pub fn sampled(
        &self,
        law: &Law,
        steps: usize,
        rest: [usize; 2],
    ) -> Result<Vec<[f64; 2]>, CurveError> {
        let arcs_m = self.arcs_m(law, steps, rest)?;
        Ok(arcs_m.into_iter().map(|arc_m| self.at(arc_m)).collect())
    }

    /// The path of an arm's tip, and of its carriage, at the samples of [`sampled`](Self::sampled), with constant directions
    /// in rad of the links from the third on.
    ///
    /// # Errors
    /// [`CurveError::FewSteps`] for a leg with too few steps.
    pub fn columns(
        &self,
        law: &Law,
        (step_s, steps): (f64, usize),
        rest: [usize; 2],
        outer_rad: &[f64],
    ) -> Result<PathColumns, CurveError> {
        let arcs_m = self.arcs_m(law, steps, rest)?;
        let places_m: Vec<[f64; 2]> = arcs_m.iter().map(|arc_m| self.at(*arc_m)).collect();
        let carriage_m = arcs_m.iter().map(|arc_m| self.carriage_at(*arc_m)).collect();
        let held = outer_rad.iter().map(|angle_rad| vec![*angle_rad; places_m.len()]);
        Ok(PathColumns::of_tip(step_s, &places_m, held, carriage_m))
    }

    /// Arc lengths in m at these samples.
    fn arcs_m(&self, law: &Law, steps: usize, rest: [usize; 2]) -> Result<Vec<f64>, CurveError> {
        let mut arcs_m = vec![0.0; rest[0] + 1];
        let (mut from_m, mut first) = (0.0, 0);
        for (leg, stop_m) in self.stops_m.iter().enumerate() {
            let last = whole(steps as f64 * stop_m / self.length_m);
            let own = last - first;
            if own < FEWEST_STEPS {
                return Err(CurveError::FewSteps { number: leg + 1, steps: own, all: steps });
            }
            if leg > 0 {
                arcs_m.extend(std::iter::repeat_n(from_m, self.dwell));
            }
            arcs_m.extend(law.places_m(from_m, *stop_m, own));
            (from_m, first) = (*stop_m, last);
        }
        arcs_m.extend(std::iter::repeat_n(self.length_m, rest[1]));
        Ok(arcs_m)
    }
}

impl Piece {
    fn length_m(&self) -> f64 {
        match self {
            Self::Line { from_m, to_m } => distance_m(*from_m, *to_m),
            Self::Arc { center_m, from_m, angle_rad } => {
                distance_m(*center_m, *from_m) * angle_rad.abs()
            }
            Self::Corner(corner) => corner.length_m,
        }
    }

    /// The place at a fraction of the piece's length.
    fn at(&self, share: f64) -> Vector {
        match self {
            Self::Line { from_m, to_m } if share > 0.5 => part(*to_m, *from_m, 1.0 - share),
            Self::Line { from_m, to_m } => part(*from_m, *to_m, share),
            Self::Arc { center_m, from_m, angle_rad } => {
                let turned = [libm::cos(angle_rad * share), libm::sin(angle_rad * share)];
                let from = [0, 1].map(|axis: usize| from_m[axis] - center_m[axis]);
                // At fraction 0 this is exactly the start.
                let [along, across] = [turned[0] - 1.0, turned[1]];
                [
                    from_m[0] + along * from[0] - across * from[1],
                    from_m[1] + along * from[1] + across * from[0],
                ]
            }
            Self::Corner(corner) => corner.at(share),
        }
    }
}

/// A rounded corner.
#[derive(Debug, Clone)]
struct Corner {
    start_m: Vector,
    end_m: Vector,
    /// Direction of the leg before the corner; `after` is the direction of the next leg.
    before: Vector,
    after: Vector,
    turn_rad: f64,
    length_m: f64,
    rule: GaussRule,
}

impl Corner {
    /// The corner at the second of three points; `None` if the path goes straight on.
    fn of(
        [from_m, at_m, to_m]: [Vector; 3],
        reach_m: f64,
        number: usize,
    ) -> Result<Option<Self>, CurveError> {
        let [before, after] = [direction(from_m, at_m), direction(at_m, to_m)];
        let across = before[0] * after[1] - before[1] * after[0];
        let turn_rad = libm::atan2(across, before[0] * after[0] + before[1] * after[1]);
        if turn_rad.abs() > LARGEST_TURN {
            return Err(CurveError::TurnsBack { number, turn_rad: turn_rad.abs() });
        }
        if turn_rad == 0.0 {
            return Ok(None);
        }
        let point =
            |along: Vector, by_m: f64| [0, 1].map(|axis: usize| at_m[axis] + by_m * along[axis]);
        let mut corner = Self {
            start_m: point(before, -reach_m),
            end_m: point(after, reach_m),
            before,
            after,
            turn_rad,
            length_m: 1.0,
            rule: GaussRule::new(POINTS),
        };
        // The halves meet on the bisector of the corner.
        let [along, across] = corner.half(0.5);
        corner.length_m = reach_m / (along + across * libm::tan(0.5 * turn_rad));
        Ok(Some(corner))
    }

    /// Distance of the corner along its first leg, and to the left of it, at a fraction of its length up to 1/2.
    fn half(&self, share: f64) -> Vector {
        let points = self.rule.places.iter().zip(&self.rule.weights);
        points.fold([0.0; 2], |[along, across], (place, weight)| {
            let angle_rad = self.turn_rad * Profile::Septic.share(0.5 * share * (1.0 + place));
            let length_m = self.length_m * share * weight;
            [along + length_m * libm::cos(angle_rad), across + length_m * libm::sin(angle_rad)]
        })
    }

    /// The place at a fraction of the corner's length: the second half mirrors the first one.
    fn at(&self, share: f64) -> Vector {
        let (from, leg, side, share) = if share > 0.5 {
            (self.end_m, self.after.map(|part| -part), -1.0, 1.0 - share)
        } else {
            (self.start_m, self.before, 1.0, share)
        };
        let [along, across] = self.half(share);
        let across = side * across;
        [from[0] + along * leg[0] - across * leg[1], from[1] + along * leg[1] + across * leg[0]]
    }
}

fn is_out_of_range(value: f64) -> bool {
    value.is_nan() || value.abs() > LARGEST_M
}

fn check_numbers(points_m: &[Vector]) -> Result<(), CurveError> {
    match points_m.iter().flatten().find(|found| is_out_of_range(**found)) {
        None => Ok(()),
        Some(found) => Err(CurveError::Range { name: "a coordinate", found: *found }),
    }
}

fn check_points(points_m: &[Vector]) -> Result<(), CurveError> {
    check_numbers(points_m)?;
    let same = points_m.windows(2).position(|pair| distance_m(pair[0], pair[1]) < LEAST_M);
    same.map_or(Ok(()), |leg| Err(CurveError::Same { number: leg + 1 }))
}

fn distance_m(from_m: Vector, to_m: Vector) -> f64 {
    libm::hypot(to_m[0] - from_m[0], to_m[1] - from_m[1])
}

fn direction(from_m: Vector, to_m: Vector) -> Vector {
    let length_m = distance_m(from_m, to_m);
    [0, 1].map(|axis: usize| (to_m[axis] - from_m[axis]) / length_m)
}

fn part(from_m: Vector, to_m: Vector, share: f64) -> Vector {
    [0, 1].map(|axis: usize| from_m[axis] + share * (to_m[axis] - from_m[axis]))
}

/// The nearest whole number of steps.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a number of steps"
)]
pub(super) fn whole(steps: f64) -> usize {
    steps.round() as usize
}
