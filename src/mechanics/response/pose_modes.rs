//! Modes and responses of an arm about a pose: the order of its polynomials grows until the results settle.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use rayon::prelude::*;

use super::link_ratios::{SmallMotions, damping_ratio};
use super::pose::{ArmPose, ArmResponse, PoseError, TorqueResponse, quadratic};
use crate::link::Arm;
use crate::modal::Shape;
use crate::numeric::{Size, SymmetricEigen, dot, magnitude, relative_change};

/// Orders that each refinement adds, and most refinements.
pub(crate) const MORE_ORDERS: usize = 4;
pub(crate) const MOST_REFINEMENTS: u32 = 8;

/// Initial shift σ of the eigenvalues of `(K + σM)⁻¹ M`, over the softest coordinate's K/M, and most tenfold increases
/// of σ until `K + σM` is positive: gravity may turn an arm over.
const SHIFT: f64 = 1e-3;
const MOST_SHIFTS: usize = 40;

/// Smallest angle of a joint, over a mode's largest coordinate; smaller angles count as 0.
const NO_TURN: f64 = 1e-9;

/// A natural mode of a link or an arm.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PoseMode {
    /// ω² in 1/s²; below 0 where the arm leaves the pose as e^{√(−ω²) t}.
    pub square_per_s2: f64,
    /// Viscous damping ratio of the complex mode, from the damping of the links and the friction of the joints. `None`
    /// without a vibration.
    pub damping_ratio: Option<f64>,
    /// Turn of each joint, scaled to a largest turn of 1; all 0 for a mode that turns no joint.
    pub joints: Vec<f64>,
    /// Mass-normalised shape in coordinates of the pose; empty for one straight link.
    pub shape: Vec<f64>,
    /// Mass-normalised shape of one straight link.
    pub of_link: Option<Shape>,
}

/// Modes with the lowest ω² first, and their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct SettledModes {
    /// The modes.
    pub modes: Vec<PoseMode>,
    /// Relative change of each ω by the last refinement; NaN where unknown.
    pub errors: Vec<f64>,
}

impl SettledModes {
    /// True if one of the modes leaves the pose.
    pub fn falls(&self) -> bool {
        self.modes.iter().any(|mode| mode.square_per_s2 < 0.0)
    }
}

/// Nodes of each link of an arm at rest, and their movement by modes.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmShapes {
    /// Distances of the nodes in m from the joint of their link.
    pub nodes_m: Vec<Vec<f64>>,
    /// x and y at rest in m.
    pub rest_m: Vec<Vec<[f64; 2]>>,
    /// Mass-normalised displacements along x and y in 1/√kg and turn of the link in 1/(m √kg), one list a mode with all
    /// joints free.
    pub free: Vec<Vec<Vec<[f64; 3]>>>,
    /// The same of the modes with held rotors.
    pub held: Vec<Vec<Vec<[f64; 3]>>>,
}

/// Modes of an arm about a pose.
#[derive(Debug, Clone)]
pub struct ArmModes {
    /// Direction of each link's chord in rad, counterclockwise from x.
    pub directions_rad: Vec<f64>,
    /// x and y of the tip at rest, in m.
    pub tip_m: [f64; 2],
    /// Torque in N m that holds each joint at rest.
    pub holding_torques_n_m: Vec<f64>,
    /// Modes with all joints free, the swings first; each joint has one swing.
    pub free: SettledModes,
    /// Modes with the rotors of all joints held.
    pub held: SettledModes,
    /// Stiffness of each joint between rotor and hub in N m/rad, infinite for a rigid joint.
    pub joint_stiffnesses_n_m_rad: Vec<f64>,
    pub(super) pose: ArmPose,
}

impl ArmModes {
    /// Shapes of the modes at nodes with these distances in m from the joint of their link, link by link. The joint
    /// with the largest turn turns counterclockwise. If no joint turns, the tip moves along x or y, the axis of its
    /// larger movement.
    pub fn shapes(&self, nodes_m: Vec<Vec<f64>>) -> ArmShapes {
        let moved = |own: &SettledModes| {
            let modes = own.modes.par_iter();
            modes.map(|mode| self.pose.moved(&nodes_m, &mode.shape)).collect()
        };
        let (free, held) = (moved(&self.free), moved(&self.held));
        ArmShapes { rest_m: self.pose.places_m(&nodes_m), free, held, nodes_m }
    }
}

/// Responses of an arm about a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmResponses {
    /// The response at each frequency.
    pub rows: Vec<ArmResponse>,
    /// Largest change of each row by the last refinement: of the tip's displacement and of the joints' angles, over
    /// their size.
    pub errors: Vec<f64>,
}

impl ArmPose {
    /// The first `count` modes with all joints free or, by `springs_n_m_rad`, on springs; infinite springs clamp. Fewer
    /// where fewer modes move mass.
    ///
    /// # Errors
    /// [`PoseError::Spread`].
    pub fn modes(
        &self,
        springs_n_m_rad: Option<&[f64]>,
        count: usize,
    ) -> Result<Vec<PoseMode>, PoseError> {
        let mut modes = self.undamped(springs_n_m_rad, count)?;
        let (stiffness, moves) = self.on_springs(springs_n_m_rad);
        let motions = Matrices::of(self, &stiffness, &moves);
        modes.par_iter_mut().filter(|mode| mode.square_per_s2 > 0.0).for_each(|mode| {
            let x: Vec<f64> = moves.iter().map(|k| mode.shape[*k]).collect();
            mode.damping_ratio = damping_ratio(&motions, mode.square_per_s2.sqrt(), &x);
        });
        Ok(modes)
    }

    /// [`ArmPose::modes`] without damping ratios.
    pub(super) fn undamped(
        &self,
        springs_n_m_rad: Option<&[f64]>,
        count: usize,
    ) -> Result<Vec<PoseMode>, PoseError> {
        let (stiffness, moves) = self.on_springs(springs_n_m_rad);
        let mut modes: Vec<PoseMode> = lowest(&self.mass, &stiffness, &moves, count)?
            .into_iter()
            .map(|x| self.mode(&stiffness, &x))
            .collect();
        modes.sort_by(|a, b| a.square_per_s2.total_cmp(&b.square_per_s2));
        if springs_n_m_rad.is_none() && !self.has_weight {
            // A free arm without restoring forces has zero eigenvalues; dense algebra leaves round-off.
            for swing in modes.iter_mut().take(self.joints.len()) {
                swing.square_per_s2 = 0.0;
            }
        }
        Ok(modes)
    }

    /// The stiffness with springs at the joints, and the coordinates that move: infinite springs clamp their joints.
    fn on_springs(&self, springs_n_m_rad: Option<&[f64]>) -> (Vec<f64>, Vec<usize>) {
        let spring = |joint: usize| springs_n_m_rad.map_or(0.0, |springs| springs[joint]);
        let mut stiffness = self.stiffness.clone();
        let mut moves = vec![true; self.count];
        for (number, joint) in self.joints.iter().enumerate() {
            if spring(number).is_finite() {
                stiffness[joint * self.count + joint] += spring(number);
            } else {
                moves[*joint] = false;
            }
        }
        (stiffness, (0..self.count).filter(|k| moves[*k]).collect())
    }

    /// The undamped mode of a shape, ω² by Rayleigh's quotient.
    fn mode(&self, stiffness: &[f64], x: &[f64]) -> PoseMode {
        let mass = quadratic(&self.mass, x);
        let square_per_s2 = quadratic(stiffness, x) / mass;
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0, |most: f64, own| if own.abs() > most.abs() { own } else { most })
        };
        let turn = largest(&mut self.joints.iter().map(|joint| x[*joint]));
        let turns = turn.abs() > NO_TURN * largest(&mut x.iter().copied()).abs();
        let part = |joint: &usize| if turns { x[*joint] / turn } else { 0.0 };
        let tip = largest(&mut self.tip_rows.iter().map(|row| dot(row, x)));
        let factor = f64::copysign(1.0, if turns { turn } else { tip }) / mass.sqrt();
        PoseMode {
            square_per_s2,
            damping_ratio: None,
            joints: self.joints.iter().map(part).collect(),
            shape: x.iter().map(|own| factor * own).collect(),
            of_link: None,
        }
    }
}

/// The matrices of the coordinates that move.
struct Matrices {
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// Viscous damping of links and joints, and the loss of hysteretic links.
    damping: DMatrix<f64>,
    loss: DMatrix<f64>,
}

impl Matrices {
    fn of(pose: &ArmPose, stiffness: &[f64], moves: &[usize]) -> Self {
        let part = |full: &[f64]| {
            let at = |i: usize, j: usize| full[moves[i] * pose.count + moves[j]];
            DMatrix::from_fn(moves.len(), moves.len(), at)
        };
        let mut damping = pose.damping.clone();
        for (joint, friction) in pose.joints.iter().zip(&pose.friction_n_m_s_rad) {
            damping[joint * pose.count + joint] += friction;
        }
        Self {
            mass: part(&pose.mass),
            stiffness: part(stiffness),
            damping: part(&damping),
            loss: part(&pose.loss),
        }
    }

    /// The viscous damping between two coordinates for motions `e^{st}`, |s| being `rate_per_s`.
    fn viscous(&self, at: (usize, usize), rate_per_s: f64) -> f64 {
        self.damping[at] + self.loss[at] / rate_per_s
    }
}

/// Products of the rows of a matrix with x.
fn times(count: usize, at: impl Fn(usize, usize) -> f64, x: &[Complex64]) -> Vec<Complex64> {
    let row = |i: usize| (0..count).map(|j| x[j] * at(i, j)).sum();
    (0..count).map(row).collect()
}

impl SmallMotions for Matrices {
    fn inertia(&self, x: &[Complex64]) -> Vec<Complex64> {
        times(x.len(), |i, j| self.mass[(i, j)], x)
    }

    fn damping(&self, s_per_s: Complex64, x: &[Complex64]) -> Vec<Complex64> {
        let rate_per_s = magnitude(s_per_s);
        times(x.len(), |i, j| self.viscous((i, j), rate_per_s), x)
    }

    fn solved(&self, s_per_s: Complex64, share: f64, y: &[Complex64]) -> Option<Vec<Complex64>> {
        let (rate_per_s, square) = (magnitude(s_per_s), s_per_s * s_per_s);
        let matrix = DMatrix::from_fn(y.len(), y.len(), |i, j| {
            let damping = s_per_s * (share * self.viscous((i, j), rate_per_s));
            square * self.mass[(i, j)] + damping + self.stiffness[(i, j)]
        });
        let solution = matrix.lu().solve(&DVector::from_column_slice(y))?;
        Some(solution.as_slice().to_vec())
    }
}

/// Shapes of the `count` lowest eigenvalues of `K x = ω² M x`, in all coordinates; only the coordinates in `moves`
/// differ from 0.
///
/// With `K + σM = L Lᵀ` they are `L⁻ᵀ z` of the largest `1/(ω² + σ)` of `L⁻¹ M L⁻ᵀ`: M may be singular, and K negative.
fn lowest(
    mass: &[f64],
    stiffness: &[f64],
    moves: &[usize],
    count: usize,
) -> Result<Vec<Vec<f64>>, PoseError> {
    let all = mass.len().isqrt();
    let size = moves.len();
    let part = |full: &[f64]| DMatrix::from_fn(size, size, |i, j| full[moves[i] * all + moves[j]]);
    let (mass, stiffness) = (part(mass), part(stiffness));
    let softest = (0..size).map(|k| stiffness[(k, k)].abs() / mass[(k, k)]);
    let softest =
        softest.filter(|ratio| ratio.is_finite() && *ratio > 0.0).fold(f64::MAX, f64::min);
    let mut shift = SHIFT * if softest < f64::MAX { softest } else { 1.0 };
    let mut factor = None;
    for _ in 0..MOST_SHIFTS {
        factor = (&stiffness + shift * &mass).cholesky();
        if factor.is_some() {
            break;
        }
        shift *= 10.0;
    }
    let lower = factor.ok_or(PoseError::Spread)?.unpack();
    let eigen = SymmetricEigen::over(&lower, &mass).ok_or(PoseError::Spread)?;
    let least = size as f64 * f64::EPSILON * eigen.values.last().copied().unwrap_or_default();
    let upper = lower.transpose();
    let kept = (0..size).rev().take_while(|k| eigen.values[*k] > least).take(count);
    kept.map(|k| {
        let z = DVector::from_column_slice(eigen.vector(k));
        let coordinates = upper.solve_upper_triangular(&z).ok_or(PoseError::Spread)?;
        let mut x = vec![0.0; all];
        moves.iter().zip(coordinates.iter()).for_each(|(at, coordinates)| x[*at] = *coordinates);
        Ok(x)
    })
    .collect()
}

/// Refines until `is_settled`, or to the highest polynomials; `on` receives the orders to add.
fn refined<T>(
    mut on: impl FnMut(usize, Option<&T>) -> Result<T, PoseError>,
    is_settled: impl Fn(&T) -> bool,
) -> Result<T, PoseError> {
    let mut known = on(0, None)?;
    for refinement in 1..=MOST_REFINEMENTS {
        match on(refinement as usize * MORE_ORDERS, Some(&known)) {
            Ok(found) => known = found,
            // The error is unknown without a refinement.
            Err(PoseError::TooMany { .. }) if refinement > 1 => break,
            Err(error) => return Err(error),
        }
        if is_settled(&known) {
            break;
        }
    }
    Ok(known)
}

/// The modes of an arm about a pose: the swings and `count` more with all joints free, and `count` with all rotors
/// held. They settle to `tolerance`, or [`SettledModes::errors`] exceed it.
///
/// # Errors
/// [`PoseError`].
pub fn arm_modes(
    arm: &Arm,
    directions_rad: &[f64],
    count: usize,
    tolerance: f64,
) -> Result<ArmModes, PoseError> {
    let springs = arm.joint_stiffnesses_n_m_rad();
    let on = |more_orders: usize, before: Option<&ArmModes>| {
        let pose = ArmPose::of(arm, directions_rad, (0.0, more_orders))?;
        let modes_on = |springs: Option<&[f64]>, count, before: Option<&SettledModes>| {
            let modes = pose.modes(springs, count)?;
            Ok::<_, PoseError>(SettledModes { errors: changes(&modes, before), modes })
        };
        Ok(ArmModes {
            free: modes_on(None, count + springs.len(), before.map(|own| &own.free))?,
            held: modes_on(Some(&springs), count, before.map(|own| &own.held))?,
            directions_rad: directions_rad.to_vec(),
            tip_m: pose.tip_m(),
            holding_torques_n_m: pose.holding_torques_n_m().to_vec(),
            joint_stiffnesses_n_m_rad: springs.clone(),
            pose,
        })
    };
    refined(on, |found| {
        let errors = found.free.errors.iter().chain(&found.held.errors);
        errors.fold(0.0, |most, error| Size::larger(most, *error)) <= tolerance
    })
}

/// Relative changes of ω from the modes before; NaN without modes before.
fn changes(modes: &[PoseMode], before: Option<&SettledModes>) -> Vec<f64> {
    let rate = |mode: &PoseMode| {
        let square = mode.square_per_s2;
        square.signum() * square.abs().sqrt()
    };
    let before = before.map_or(&[][..], |own| &own.modes);
    let change = |(k, mode): (usize, &PoseMode)| match before.get(k).map(rate) {
        None => f64::NAN,
        Some(before) if before.total_cmp(&rate(mode)).is_eq() => 0.0,
        Some(before) => (before / rate(mode) - 1.0).abs(),
    };
    modes.iter().enumerate().map(change).collect()
}

/// The responses of an arm about a pose at frequencies above 0; a carriage moves as a joint. They settle to `tolerance`, or
/// [`ArmResponses::errors`] exceed it.
///
/// # Errors
/// [`PoseError`].
pub fn arm_responses(
    arm: &Arm,
    directions_rad: &[f64],
    frequencies_hz: &[f64],
    tolerance: f64,
) -> Result<ArmResponses, PoseError> {
    let highest_hz = frequencies_hz.iter().copied().fold(0.0, f64::max);
    let on = |more_orders: usize, before: Option<&ArmResponses>| {
        let highest_rad_s = std::f64::consts::TAU * highest_hz;
        let pose = ArmPose::of_all_joints(arm, directions_rad, (highest_rad_s, more_orders))?;
        let rows: Vec<_> = frequencies_hz.par_iter().map(|hertz| pose.response(*hertz)).collect();
        let errors = match before {
            None => vec![f64::NAN; rows.len()],
            Some(before) => before.rows.iter().zip(&rows).map(|(a, b)| change(a, b)).collect(),
        };
        Ok(ArmResponses { rows, errors })
    };
    refined(on, |found| {
        found.errors.iter().fold(0.0, |most, error| Size::larger(most, *error)) <= tolerance
    })
}

/// The larger change of the tip's displacement and of the joints' angles, each over its size, for the torque with the
/// largest change.
fn change(before: &ArmResponse, found: &ArmResponse) -> f64 {
    type Part = fn(&TorqueResponse) -> &[Complex64];
    let parts: [Part; 2] = [|own| &own.tip_m, |own| &own.joints_rad];
    let size = |values: &mut dyn Iterator<Item = Complex64>| {
        values.map(|x| magnitude(x) * magnitude(x)).sum::<f64>().sqrt()
    };
    let pairs = before.torques.iter().zip(&found.torques);
    let change_of = |(a, b): (&TorqueResponse, &TorqueResponse)| {
        let each = parts.map(|part| {
            let (a, b) = (part(a), part(b));
            let off = size(&mut a.iter().zip(b).map(|(a, b)| a - b));
            relative_change(off, [a, b].map(|own| size(&mut own.iter().copied())))
        });
        each[0].max(each[1])
    };
    pairs.map(change_of).fold(0.0, f64::max)
}
