//! Chords of an arm: bars of changing length from joint to joint, in the directions of a rigid arm or with the tip on
//! its path.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rayon::prelude::*;

use super::chord::{check_period, counting, resolving};
use super::error::{ElasticaError, FEWEST};
use crate::numeric::{FourierPair, angular_frequency, magnitude};

/// A value with its first and second time derivative.
pub(super) type Moving = [f64; 3];

/// Histories of an angle in rad, its rate and its acceleration.
pub type AngleHistories = [Vec<f64>; 3];

/// Sine of the elbow's angle below which the rates of two bars do not follow from the motion of their end.
pub(crate) const STRETCHED: f64 = 0.05;

/// Share of the accelerations, all added up, beyond the frequencies that samples must resolve.
const LEFT_OUT: f64 = 1e-10;

/// Part of the rigid arm's motion that stays while the links bend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// The direction of every chord.
    Angles,
    /// The path of the tip, and the directions of all chords from the third on.
    Tip,
}

/// The chords of an arm over a period of N samples, in a plane with gravity.
#[derive(Debug, Clone)]
pub struct ArmPeriod {
    pub(super) pair: FourierPair,
    pub(super) step_s: f64,
    pub(super) gravity_m_s2: [f64; 2],
    /// Angles of the rigid arm's chords; of a link that slides its displacements across it.
    pub(super) rigid: Vec<AngleHistories>,
    /// Direction in rad of a link that slides.
    slides_rad: Option<f64>,
    /// Acceleration of the first axis along x and y in m/s²; empty for a fixed axis.
    axis_m_s2: Vec<[f64; 2]>,
    kept: Kept,
    /// Fewest samples that resolve the accelerations of links of equal length.
    pub(super) fewest: usize,
}

impl ArmPeriod {
    /// The period of an arm whose chords, with unbent links, have these directions from the plane's x axis at each
    /// `step_s`, the inner link first.
    ///
    /// If the motion ends with other directions than it starts, they must [return](super::returning) within the period
    /// at rest. Only the directions of weights and forces follow them, while rates and accelerations are zero.
    ///
    /// # Errors
    /// [`ElasticaError::Lengths`], [`ElasticaError::Sample`], [`ElasticaError::Step`], and [`ElasticaError::OneLink`]
    /// or [`ElasticaError::Elbow`] for an impossible tip path.
    pub fn new(
        step_s: f64,
        rigid: Vec<AngleHistories>,
        kept: Kept,
        gravity_m_s2: [f64; 2],
    ) -> Result<Self, ElasticaError> {
        let columns: Vec<_> =
            rigid.iter().map(|chord| [0, 1, 2].map(|part| &chord[part][..])).collect();
        let len = check_period(step_s, gravity_m_s2, &columns)?;
        let (pair, fewest) = (FourierPair::new(len), len);
        let (slides_rad, axis_m_s2) = (None, Vec::new());
        let arm = Self { pair, step_s, gravity_m_s2, rigid, slides_rad, axis_m_s2, kept, fewest };
        if kept == Kept::Tip {
            if arm.rigid.len() < 2 {
                return Err(ElasticaError::OneLink);
            }
            for sample in 0..len {
                arm.elbow(sample)?;
            }
        }
        Ok(arm.resolved())
    }

    /// The period of an arm whose first axis has these accelerations along x and y in m/s², one at each sample.
    #[must_use]
    pub fn carried_by(self, axis_m_s2: Vec<[f64; 2]>) -> Self {
        Self { axis_m_s2, ..self }.resolved()
    }

    /// Finds the fewest samples that resolve several links. One link takes all samples.
    fn resolved(self) -> Self {
        if self.links() > 1 { Self { fewest: self.resolving(), ..self } } else { self }
    }

    /// The period of one link that slides across this direction in rad: its angles, rates and accelerations are
    /// displacements in m and their derivatives.
    #[must_use]
    pub fn sliding(self, direction_rad: f64) -> Self {
        let [_, across] = axes(direction_rad);
        let moved = self.rigid[0][2].iter();
        let axis_m_s2 = moved.map(|own| across.map(|part| own * part)).collect();
        Self { slides_rad: Some(direction_rad), axis_m_s2, ..self }
    }

    /// True if the link slides.
    pub(super) fn slides(&self) -> bool {
        self.slides_rad.is_some()
    }

    /// Number N of samples.
    pub(super) fn len(&self) -> usize {
        self.pair.len()
    }

    /// Number of bins beyond which the amplitudes of each history, all added up, are a negligible share.
    fn band(&self, negligible: f64, histories: impl ParallelIterator<Item = Vec<f64>>) -> usize {
        let bands = histories.map(|history| {
            let amplitudes = self.pair.amplitudes(history);
            let sizes: Vec<f64> = amplitudes.iter().map(|value| magnitude(*value)).collect();
            counting(&sizes, negligible * sizes.iter().sum::<f64>())
        });
        bands.reduce(|| 1, usize::max)
    }

    /// Cosines and sines of the chords' directions.
    fn directions(&self) -> impl ParallelIterator<Item = Vec<f64>> {
        (0..self.links()).into_par_iter().flat_map_iter(move |link| {
            let angles = move |k| self.rigid_at(link, k)[0];
            [libm::cos, libm::sin].map(|of| (0..self.len()).map(|k| of(angles(k))).collect())
        })
    }

    /// Largest stride of samples that resolves the directions of the chords, up to a negligible share of their
    /// amplitudes.
    pub(super) fn stride(&self, negligible: f64) -> usize {
        // Twice the band, because bending is not linear in the directions.
        self.stride_to(4 * (self.band(negligible, self.directions()) - 1))
    }

    /// Fewest samples that resolve the accelerations of links of equal length, up to a negligible share of their
    /// amplitudes. The accelerations are each chord's turning, its centripetal acceleration, and the acceleration of
    /// its inner end along it and across it, with gravity.
    fn resolving(&self) -> usize {
        let bars_of = |sample: usize| {
            let bar = |link: usize| Bar {
                length_m: [1.0, 0.0, 0.0],
                angle_rad: self.rigid_at(link, sample),
            };
            let bars = (0..self.links()).map(bar);
            let carried = self.carried(sample, bars).map(|(bar, [along, across])| {
                let [_, rate, turning] = bar.angle_rad;
                [turning, rate * rate, along, across]
            });
            carried.collect::<Vec<_>>()
        };
        let samples: Vec<_> = (0..self.len()).into_par_iter().map(bars_of).collect();
        let histories = (0..4 * self.links())
            .into_par_iter()
            .map(|column| samples.iter().map(|parts| parts[column / 4][column % 4]).collect());
        resolving(self.band(LEFT_OUT, histories))
    }

    /// Each bar with the acceleration of its inner end along it and across it. Gravity counts as an upward acceleration
    /// of the first axis.
    pub(super) fn carried(
        &self,
        sample: usize,
        bars: impl IntoIterator<Item = Bar>,
    ) -> impl Iterator<Item = (Bar, [f64; 2])> {
        let mut axis = self.gravity_m_s2.map(|part| -part);
        if let Some(moved) = self.axis_m_s2.get(sample) {
            axis = [0, 1].map(|part| axis[part] + moved[part]);
        }
        bars.into_iter().map(move |bar| {
            let axes = bar.axes();
            let parts = axes.map(|unit| axis[0] * unit[0] + axis[1] * unit[1]);
            let [_, _, further] = bar.vector(axes);
            axis = [axis[0] + further[0], axis[1] + further[1]];
            (bar, parts)
        })
    }

    /// The longest stride that leaves at least `fewest` samples, an even number; 1 if none does.
    pub(super) fn stride_to(&self, fewest: usize) -> usize {
        let longest = self.len() / fewest.max(FEWEST);
        (1..=longest).rev().find(|stride| self.len().is_multiple_of(2 * stride)).unwrap_or(1)
    }

    /// This period with every `stride`-th sample.
    pub(super) fn thinned(&self, stride: usize) -> Self {
        let few = |history: &Vec<f64>| history.iter().copied().step_by(stride).collect();
        Self {
            pair: FourierPair::new(self.len() / stride),
            step_s: self.step_s * stride as f64,
            rigid: self.rigid.iter().map(|chord| chord.each_ref().map(few)).collect(),
            axis_m_s2: self.axis_m_s2.iter().copied().step_by(stride).collect(),
            ..*self
        }
    }

    /// True if all chords have the same direction at two samples.
    pub(super) fn rests(&self, sample: usize, other: usize) -> bool {
        let are_alike =
            |[angles, ..]: &AngleHistories| angles[sample].to_bits() == angles[other].to_bits();
        self.slides() || self.rigid.iter().all(are_alike)
    }

    /// A history at the samples of a pair, or a derivative of it, interpolated to all samples of the period from its
    /// first `bins` amplitudes.
    pub(super) fn at_all(
        &self,
        pair: &FourierPair,
        few: &[f64],
        bins: usize,
        derived: u32,
    ) -> Vec<f64> {
        let omega =
            |bin: usize| Complex64::new(0.0, angular_frequency(bin, self.len(), self.step_s));
        let amplitudes = pair.amplitudes(few);
        let kept = amplitudes.iter().take(bins).enumerate();
        let kept: Vec<_> = kept.map(|(bin, value)| value * omega(bin).powu(derived)).collect();
        self.pair.samples(kept)
    }

    /// Number of links.
    pub(super) fn links(&self) -> usize {
        self.rigid.len()
    }

    /// Unit vectors along the chord of a link of the rigid arm and across it.
    pub(super) fn axes(&self, link: usize, sample: usize) -> [[f64; 2]; 2] {
        axes(self.rigid_at(link, sample)[0])
    }

    /// Direction of a link of the rigid arm in rad, its rate and its acceleration.
    fn rigid_at(&self, link: usize, sample: usize) -> Moving {
        let turning = [0, 1, 2].map(|part| self.rigid[link][part][sample]);
        self.slides_rad.map_or(turning, |direction_rad| [direction_rad, 0.0, 0.0])
    }

    /// Sine of the angle from the first chord to the second.
    fn elbow(&self, sample: usize) -> Result<f64, ElasticaError> {
        let sine = libm::sin(self.rigid[1][0][sample] - self.rigid[0][0][sample]);
        if sine.abs() < STRETCHED {
            return Err(ElasticaError::Elbow { sample, sine });
        }
        Ok(sine)
    }

    /// The bars from joint to joint at a sample, with these lengths.
    ///
    /// # Errors
    /// [`ElasticaError::Elbow`].
    pub(super) fn bars(
        &self,
        sample: usize,
        [rigid_m, lengths]: [&[Moving]; 2],
    ) -> Result<Vec<Bar>, ElasticaError> {
        let bar = |link: usize, lengths: &[Moving]| Bar {
            length_m: lengths[link],
            angle_rad: self.rigid_at(link, sample),
        };
        let mut bars: Vec<_> = (0..self.links()).map(|link| bar(link, lengths)).collect();
        let bits = |length_m: &Moving| length_m.map(f64::to_bits);
        let are_rigid = rigid_m.iter().zip(lengths).all(|(rigid, own)| bits(rigid) == bits(own));
        if self.kept == Kept::Tip && !are_rigid {
            // End of the first two bars: the one of the rigid arm, plus the shortening of the others.
            let mut end = [[0.0; 2]; 3];
            for (link, own) in bars.iter().enumerate() {
                let (rigid, axes) = (bar(link, rigid_m), own.axes());
                let rigid = rigid.vector(axes);
                let own = if link < 2 { [[0.0; 2]; 3] } else { own.vector(axes) };
                for (end, (rigid, own)) in end.iter_mut().zip(rigid.iter().zip(&own)) {
                    *end = [end[0] + rigid[0] - own[0], end[1] + rigid[1] - own[1]];
                }
            }
            let sine = self.elbow(sample)?;
            let [first, second] = reach(&end, [bars[0], bars[1]], sine.signum())
                .ok_or(ElasticaError::Elbow { sample, sine: 0.0 })?;
            (bars[0], bars[1]) = (first, second);
        }
        Ok(bars)
    }
}

/// A chord that turns and changes its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bar {
    pub(super) length_m: Moving,
    pub(super) angle_rad: Moving,
}

/// Unit vectors along a chord and across it.
pub(super) fn axes(angle_rad: f64) -> [[f64; 2]; 2] {
    let (sine, cosine) = (libm::sin(angle_rad), libm::cos(angle_rad));
    [[cosine, sine], [-sine, cosine]]
}

impl Bar {
    /// Unit vectors along the bar and across it.
    pub(super) fn axes(&self) -> [[f64; 2]; 2] {
        axes(self.angle_rad[0])
    }

    /// Vector from the inner to the outer end: place, velocity and acceleration; the argument is [`Self::axes`].
    ///
    /// ```text
    /// r = ℓ e,   ṙ = ℓ̇ e + ℓ θ̇ n,   r̈ = (ℓ̈ − ℓ θ̇²) e + (2 ℓ̇ θ̇ + ℓ θ̈) n
    /// ```
    pub(super) fn vector(&self, [along, across]: [[f64; 2]; 2]) -> [[f64; 2]; 3] {
        let [l, l1, l2] = self.length_m;
        let [_, rate, acceleration] = self.angle_rad;
        let parts =
            [[l, 0.0], [l1, l * rate], [l2 - l * rate * rate, 2.0 * l1 * rate + l * acceleration]];
        parts.map(|[e, n]| [0, 1].map(|axis| e * along[axis] + n * across[axis]))
    }
}

/// Turns two bars so that the second ends at a moving point, with the elbow on the side of the sign; the first bar
/// stays within half a turn of its angle. `None` if the bars do not reach the point, or only stretched.
fn reach(end: &[[f64; 2]; 3], mut bars: [Bar; 2], side: f64) -> Option<[Bar; 2]> {
    let [place, velocity, acceleration] = end;
    let [l1, l2] = bars.map(|bar| bar.length_m[0]);
    let squared = place[0] * place[0] + place[1] * place[1];
    let cosine = (squared - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
    let sine = side * (1.0 - cosine * cosine).max(0.0).sqrt();
    if sine.abs() < STRETCHED {
        return None;
    }
    let first = libm::atan2(place[1], place[0]) - libm::atan2(l2 * sine, l1 + l2 * cosine);
    // The elbow stays within half a turn of its side.
    let near = bars[0].angle_rad[0];
    let first = near + libm::remainder(first - near, TAU);
    let angles = [first, first + libm::atan2(sine, cosine)];
    for (bar, angle) in bars.iter_mut().zip(angles) {
        bar.angle_rad = [angle, 0.0, 0.0];
    }
    let axes = bars.map(|bar| bar.axes());
    let [n1, n2] = axes.map(|[_, across]| across);
    // Σ ℓ θ̇ n is the velocity minus its value at zero rates; the accelerations follow likewise with these rates.
    for (order, wanted) in [(1, velocity), (2, acceleration)] {
        let without = [0, 1].map(|link: usize| bars[link].vector(axes[link])[order]);
        let left = [0, 1].map(|axis| wanted[axis] - without[0][axis] - without[1][axis]);
        let determinant = n1[0] * n2[1] - n1[1] * n2[0];
        bars[0].angle_rad[order] = (left[0] * n2[1] - left[1] * n2[0]) / (determinant * l1);
        bars[1].angle_rad[order] = (n1[0] * left[1] - n1[1] * left[0]) / (determinant * l2);
    }
    Some(bars)
}

/// Directions, rates and accelerations of the chords of a rigid arm for a prescribed tip: place in m, velocity and
/// acceleration along x and y at each sample. `outer` contains the chords from the third on; with `is_left` the second
/// link turns left of the first.
///
/// # Errors
/// [`ElasticaError::Elbow`] if the arm does not reach the tip, or only stretched.
///
/// # Panics
/// Unless there are two more lengths than `outer` chords.
pub fn reaching(
    tip: &[[[f64; 2]; 3]],
    lengths_m: &[f64],
    outer: &[AngleHistories],
    is_left: bool,
) -> Result<Vec<AngleHistories>, ElasticaError> {
    assert!(lengths_m.len() == outer.len() + 2, "two chords that follow");
    let side = if is_left { 1.0 } else { -1.0 };
    let bar = |length_m: f64, angle_rad| Bar { length_m: [length_m, 0.0, 0.0], angle_rad };
    let mut bars = [0, 1].map(|link| bar(lengths_m[link], [0.0; 3]));
    let mut chords = vec![[Vec::new(), Vec::new(), Vec::new()]; 2];
    for (sample, end) in tip.iter().enumerate() {
        let mut end = *end;
        for (chord, length_m) in outer.iter().zip(&lengths_m[2..]) {
            let further = bar(*length_m, [0, 1, 2].map(|part| chord[part][sample]));
            let further = further.vector(further.axes());
            for (end, further) in end.iter_mut().zip(further) {
                *end = [end[0] - further[0], end[1] - further[1]];
            }
        }
        bars = reach(&end, bars, side).ok_or(ElasticaError::Elbow { sample, sine: 0.0 })?;
        for (chord, bar) in chords.iter_mut().zip(&bars) {
            chord.iter_mut().zip(bar.angle_rad).for_each(|(column, value)| column.push(value));
        }
    }
    chords.extend_from_slice(outer);
    Ok(chords)
}
