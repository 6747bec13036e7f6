//! The contraction of a step of learning over frequency, and the band in which it is below 1.
//!
//! A step adds the nominal inverse of the error to the effort. On a plant with another response the error becomes
//! `(1 − G_true/G) E`, so it shrinks where `|G_true/G − 1| < 1`.
//!
//! Of an arm G is the matrix of responses to the efforts of all joints: of x and y of the tip, and of what its motion
//! prescribes beside them, whose correction is 0. The factor on the error of the tip is then the part of
//! `1 − G_true G⁻¹` in the rows and columns of x and y, and its largest singular value counts.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::error::LearnError;
use super::recorded::smooth;
use crate::beam::{Mesh, MeshPlan};
use crate::link::Arm;
use crate::model::{FrequencyResponse, KeptModes, model_of, responses_with_weight};
use crate::response::{ArmResponse, TorqueResponse, arm_responses};
use crate::robust::Hold;

/// Numbers of frequencies for one link and for a pose of an arm.
const POINTS: [usize; 2] = [1000, 250];

/// Share of the band's end up to which the whole error is corrected.
const WHOLE: f64 = 0.6;

/// A plant: the link or the arm, its meshes, the kept modes and the delay of its drives in s.
#[derive(Debug, Clone, Copy)]
pub struct Plant<'a> {
    /// The link or the arm.
    pub arm: &'a Arm,
    /// The plans of its meshes.
    pub meshes: &'a [MeshPlan],
    /// The kept modes of one link.
    pub kept: KeptModes,
    /// Delay of its drives in s.
    pub delay_s: f64,
}

/// Response of the tip, and of what is prescribed beside it, to each joint at one frequency.
type Matrix = DMatrix<Complex64>;

/// Responses in each pose at each frequency.
pub type Responses = Vec<Vec<Matrix>>;

/// Responses of the tip to the efforts or to the positions of the joints, about poses with these directions in rad.
///
/// # Errors
/// [`LearnError`] of a link without model, and of a pose without response.
pub fn responses(
    plant: &Plant<'_>,
    hold: Hold,
    (poses_rad, frequencies_hz): (&[Vec<f64>], &[f64]),
) -> Result<Responses, LearnError> {
    let Plant { arm, meshes, kept, delay_s } = *plant;
    let delayed = |rows: Vec<Matrix>| {
        let late = |(rows, hertz): (Matrix, &f64)| {
            let angle = -TAU * hertz * delay_s;
            let turn = Complex64::new(libm::cos(angle), libm::sin(angle));
            rows * turn
        };
        rows.into_iter().zip(frequencies_hz).map(late).collect::<Vec<_>>()
    };
    if let Some(link) = arm.alone()
        && (link.joint().slides() || !link.has_weight())
    {
        let highest_hz = frequencies_hz.iter().copied().fold(0.0, f64::max);
        let mut mesh = Mesh::new(link, &meshes[0])?;
        if meshes[0].is_automatic() {
            mesh = mesh.resolving(TAU * highest_hz, meshes[0].tolerance());
        }
        let model = model_of(link, mesh, kept)?;
        let is_weighed = link.has_weight() && kept == KeptModes::All;
        let weighed = Some(model.on_mesh()).filter(|_| is_weighed);
        let weighed = weighed.and_then(|own| responses_with_weight(own, frequencies_hz));
        let rows = match weighed {
            Some((rows, _)) => rows,
            None => FrequencyResponse::at_all(&*model, frequencies_hz),
        };
        let value = |row: &FrequencyResponse| match hold {
            Hold::Position => row.hub_angle_per_tip_displacement_rad_m.inv(),
            Hold::Effort | Hold::Feedback => row.tip_displacement_per_torque_1_n,
        };
        return Ok(vec![delayed(
            rows.iter().map(|row| Matrix::from_element(1, 1, value(row))).collect(),
        )]);
    }
    let tolerance = MeshPlan::smallest_tolerance(meshes);
    let in_pose = |directions_rad: &Vec<f64>| {
        let found = arm_responses(arm, directions_rad, frequencies_hz, tolerance)?;
        let prescribed = |own: &TorqueResponse| {
            let [x, y] = own.tip_m;
            if arm.alone().is_some() {
                let [sin, cos] = [libm::sin, libm::cos].map(|of| of(directions_rad[0]));
                return vec![y * cos - x * sin];
            }
            [&[x, y], &own.chords_rad[2..], &own.joints_rad[arm.links().len()..]].concat()
        };
        let matrix = |own: &ArmResponse| {
            let columns = |of: &dyn Fn(&TorqueResponse) -> Vec<Complex64>| {
                let columns: Vec<_> = own.torques.iter().map(of).collect();
                Matrix::from_fn(columns.len(), columns.len(), |row, column| columns[column][row])
            };
            let efforts = columns(&prescribed);
            match hold {
                Hold::Position => over(&efforts, &columns(&|own| own.joints_rad.clone())),
                Hold::Effort | Hold::Feedback => efforts,
            }
        };
        Ok(delayed(found.rows.iter().map(matrix).collect()))
    };
    poses_rad.iter().map(in_pose).collect()
}

/// A B⁻¹, not finite without inverse.
fn over(a: &Matrix, b: &Matrix) -> Matrix {
    let found = b.transpose().lu().solve(&a.transpose());
    found.map_or_else(|| a * Complex64::from(f64::NAN), |found| found.transpose())
}

/// Largest singular value of the tip's part of A B⁻¹ − 1.
fn ratio(a: &Matrix, b: &Matrix) -> f64 {
    let measured = a.nrows().min(2);
    let own = over(a, b).view((0, 0), (measured, measured)) - Matrix::identity(measured, measured);
    if own.norm_squared().is_finite() { own.singular_values().max() } else { f64::INFINITY }
}

/// Largest `|G_true/G − 1|` of all plants and poses over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Contraction {
    frequencies_hz: Vec<f64>,
    ratios: Vec<f64>,
}

impl Contraction {
    /// Frequencies from one to another in Hz, by a constant factor.
    pub fn frequencies_hz(arm: &Arm, [from_hz, to_hz]: [f64; 2]) -> Vec<f64> {
        let points = POINTS[usize::from(arm.alone().is_none())];
        let share = |k: usize| k as f64 / (points - 1) as f64;
        (0..points).map(|k| from_hz * libm::pow(to_hz / from_hz, share(k))).collect()
    }

    /// The contraction of these plants against the nominal one, at the frequencies of their responses.
    pub fn of(frequencies_hz: Vec<f64>, nominal: &Responses, plants: &[Responses]) -> Self {
        let mut ratios = vec![0.0_f64; frequencies_hz.len()];
        for (poses, plant) in plants.iter().flat_map(|plant| nominal.iter().zip(plant)) {
            for ((most, own), true_one) in ratios.iter_mut().zip(poses).zip(plant) {
                *most = most.max(ratio(true_one, own));
            }
        }
        Self { frequencies_hz, ratios }
    }

    /// The band below the lowest frequency with a contraction of 1 or above.
    ///
    /// # Errors
    /// [`LearnError::NoBand`] without a frequency below it.
    pub fn band(self) -> Result<Band, LearnError> {
        let first = self.ratios.iter().position(|ratio| *ratio >= 1.0);
        let last = self.frequencies_hz.len() - 1;
        let end_hz = self.frequencies_hz[first.unwrap_or(last)];
        let below = self.frequencies_hz.partition_point(|hertz| *hertz <= WHOLE * end_hz);
        if below == 0 {
            let (hertz, ratio) = (self.frequencies_hz[0], self.ratios[first.unwrap_or(0)]);
            return Err(LearnError::NoBand { hertz, ratio });
        }
        Ok(Band { end_hz, is_limited: first.is_some(), contraction: self })
    }
}

/// Frequencies in which the error is corrected.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Its end in Hz.
    pub end_hz: f64,
    /// True if the plants end it, false if the motion does.
    pub is_limited: bool,
    contraction: Contraction,
}

impl Band {
    /// Frequency in Hz up to which the whole error is corrected; the rest rolls off to the band's end.
    pub fn whole_until_hz(&self) -> f64 {
        WHOLE * self.end_hz
    }

    /// Share of the error at a frequency in Hz that is corrected.
    pub fn weight(&self, hertz: f64) -> f64 {
        let share = (hertz - self.whole_until_hz()) / (self.end_hz - self.whole_until_hz());
        1.0 - smooth(share)
    }

    /// Contraction at a frequency in Hz of the band.
    pub fn contraction(&self, hertz: f64) -> f64 {
        let Contraction { frequencies_hz, ratios } = &self.contraction;
        let above = frequencies_hz.partition_point(|own| *own < hertz);
        if above == 0 || above == frequencies_hz.len() {
            return ratios[above.min(ratios.len() - 1)];
        }
        let [low, high] = [frequencies_hz[above - 1], frequencies_hz[above]];
        let share = (hertz - low) / (high - low);
        ratios[above - 1] + share * (ratios[above] - ratios[above - 1])
    }

    /// Largest contraction where the whole error is corrected, and its frequency in Hz.
    pub fn largest(&self) -> (f64, f64) {
        let Contraction { frequencies_hz, ratios } = &self.contraction;
        let pairs = ratios.iter().copied().zip(frequencies_hz.iter().copied());
        let within = pairs.take_while(|(_, hertz)| *hertz <= self.whole_until_hz());
        within.reduce(|most, own| if own.0 > most.0 { own } else { most }).unwrap_or_default()
    }
}
