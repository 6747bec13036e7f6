//! Tip of a solved arm with its joints moved by Lagrange's equations ([`move_arm`]), independent of the inversion.

use std::f64::consts::TAU;

use crate::inverse::{Solution, Straying};
use crate::motion::{ArmPath, Ends, Prescribed};
use crate::numeric::Size;
use crate::response::{MovedJoint, Played, SimulationError, move_arm};

/// Tolerance of a moved arm, over the tolerance of the analysis.
const SETTLED: f64 = 0.1;

/// Largest change by the last refinement of a moved arm, over the tip's error, that still allows to measure this error.
const SHARP: f64 = 0.3;

impl Solution {
    /// The arm with its joints moved as solved, by Lagrange's equations.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn moved(&self) -> Result<Played, SimulationError> {
        let accelerations: Vec<_> =
            (0..self.joints.len()).map(|joint| self.acceleration_rad_s2(joint)).collect();
        let joints =
            self.joints.iter().zip(&accelerations).map(|(joint, acceleration)| MovedJoint {
                angle_rad: joint.angle_rad[0],
                rate_rad_s: joint.rate_rad_s[0],
                accelerations_rad_s2: acceleration,
            });
        let joints: Vec<MovedJoint<'_>> = joints.collect();
        let highest_rad_s = TAU * self.band.cutoff_hz.unwrap_or(0.25 / self.grid.step_s);
        let tolerance = SETTLED * self.analysis.tolerance();
        let repeats = self.motion.ends() == Ends::Periodic;
        move_arm(&self.arm, &joints, &self.grid, (highest_rad_s, tolerance), repeats)
    }

    /// Largest distance of the moved arm's tip from its path, over its travel; for a path of angles, from the solved
    /// tip.
    pub fn tip_error_of(&self, moved: &Played, path: &ArmPath) -> f64 {
        let off = |k: usize| {
            let wanted_m = self.wanted_tip_m(path, k);
            distance([0, 1].map(|axis: usize| moved.tip[axis].displacement_m[k] - wanted_m[axis]))
        };
        (0..self.grid.len).map(off).fold(0.0, Size::larger) / self.tip_travel_m()
    }

    /// Wanted place of the tip at a sample of the window, x and y in m; for a path of angles, the solved place.
    pub(crate) fn wanted_tip_m(&self, path: &ArmPath, k: usize) -> [f64; 2] {
        let last = path.grid().len - 1;
        let before = usize::try_from(-self.grid.first).unwrap_or(0);
        [0, 1].map(|axis: usize| match path.prescribed() {
            // A window holds all rows of its path.
            Prescribed::Tip => path.given()[axis][k.saturating_sub(before).min(last)],
            Prescribed::Angles => self.tip[axis].displacement_m[k],
        })
    }
}

/// Error of the tip from chords as long as their links.
pub(super) fn straying(solution: &Solution, path: &ArmPath) -> Straying {
    let travel_m = solution.tip_travel_m();
    let measured = solution.moved().ok().and_then(|moved| {
        let share = solution.tip_error_of(&moved, path);
        (moved.change()[0] <= SHARP * share * travel_m).then_some(Straying::Measured(share))
    });
    measured.unwrap_or_else(|| Straying::Estimated(shortened_m(solution) / travel_m))
}

/// Largest error of the tip in m by shorter chords: the chord of a bent link is ½ ∫ w'² ds shorter than its link.
fn shortened_m(solution: &Solution) -> f64 {
    let at = |k: usize| {
        let links = solution.shapes().zip(solution.nodes_m());
        let missed = links.fold([0.0; 2], |[x, y], (link, nodes_m)| {
            let rows = link.deflections_m.windows(2).zip(nodes_m.windows(2));
            let short: f64 = rows
                .map(|(w, s)| 0.5 * (w[1][k] - w[0][k]) * (w[1][k] - w[0][k]) / (s[1] - s[0]))
                .sum();
            let angle = link.chord[0][k];
            [x + short * libm::cos(angle), y + short * libm::sin(angle)]
        });
        distance(missed)
    };
    (0..solution.grid.len).map(at).fold(0.0, Size::larger)
}

fn distance([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
