//! The joints of a solved arm moved by Lagrange's equations ([`move_arm`]), which know nothing of the inversion: where the
//! tip goes.

use std::f64::consts::TAU;

use super::solution::ArmSolution;
use super::warning::Straying;
use crate::motion::Prescribed;
use crate::numeric::Size;
use crate::response::{MovedJoint, Played, SimulationError, move_arm};

/// Share of the tolerance to which a moved arm is settled.
const SETTLED: f64 = 0.1;

/// Change by the last refinement of a moved arm, over how far its tip strays, with which that is measured.
const SHARP: f64 = 0.3;

impl ArmSolution {
    /// The arm with its joints moved as solved, by Lagrange's equations.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn moved(&self) -> Result<Played, SimulationError> {
        let joints = self.joints.iter().map(|joint| MovedJoint {
            angle_rad: joint.angle[0][0],
            rate_rad_s: joint.angle[1][0],
            accelerations_rad_s2: &joint.angle[2],
        });
        let joints: Vec<MovedJoint<'_>> = joints.collect();
        let highest_rad_s = TAU * self.cutoff_hz.unwrap_or(0.25 / self.grid.step_s);
        let tolerance = SETTLED * self.analysis.tolerance();
        move_arm(&self.arm, &joints, &self.grid, (highest_rad_s, tolerance))
    }

    /// How far the tip of the moved arm is from the path at most, over its way; where the path is one of angles, from the
    /// tip that is solved.
    pub fn tip_error_of(&self, moved: &Played) -> f64 {
        let off = |k: usize| {
            let wanted_m = self.wanted_tip_m(k);
            distance([0, 1].map(|axis: usize| moved.tip[axis].displacement_m[k] - wanted_m[axis]))
        };
        (0..self.grid.len).map(off).fold(0.0, Size::larger) / self.way_m
    }

    /// Where the tip must be at a sample of the window, x and y in m; where the path is one of angles, where it is solved to be.
    pub(crate) fn wanted_tip_m(&self, k: usize) -> [f64; 2] {
        let last = self.path.grid().len - 1;
        let before = usize::try_from(-self.grid.first).unwrap_or(0);
        [0, 1].map(|axis: usize| match self.path.prescribed() {
            // A window holds all rows of its path.
            Prescribed::Tip => self.path.given()[axis][k.saturating_sub(before).min(last)],
            Prescribed::Angles => self.tip[axis][0][k],
        })
    }

    /// How far the tip strays where chords are taken for as long as their links.
    pub(super) fn straying(&self) -> Straying {
        let measured = self.moved().ok().and_then(|moved| {
            let share = self.tip_error_of(&moved);
            (moved.change()[0] <= SHARP * share * self.way_m).then_some(Straying::Measured(share))
        });
        measured.unwrap_or_else(|| Straying::Estimated(self.shortened_m() / self.way_m))
    }

    /// By how far the chords of the bent links, each ½ ∫ w'² ds shorter than its link, miss the tip at most, in m.
    fn shortened_m(&self) -> f64 {
        let at = |k: usize| {
            let missed = self.links.iter().fold([0.0; 2], |[x, y], link| {
                let rows = link.deflections_m.windows(2).zip(link.nodes_m.windows(2));
                let short: f64 = rows
                    .map(|(w, s)| 0.5 * (w[1][k] - w[0][k]) * (w[1][k] - w[0][k]) / (s[1] - s[0]))
                    .sum();
                let angle = link.chord[0][k];
                [x + short * libm::cos(angle), y + short * libm::sin(angle)]
            });
            distance(missed)
        };
        (0..self.grid.len).map(at).fold(0.0, Size::larger)
    }
}

fn distance([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
