//! Small motions of arms about a pose, against closed forms and frames that are assembled here.

use std::f64::consts::{FRAC_PI_2, TAU};

use flexlink::beam::ElementCount;
use flexlink::learn::{Contraction, Plant, responses};
use flexlink::link::{
    Arm, ArmCarriage, ArmLink, ArmParts, Carriage, Damping, Drive, Hub, Link, LinkParts,
    LumpedMass, Payload, Segment,
};
use flexlink::modal::{held_frequencies, natural_frequencies};
use flexlink::model::KeptModes;
use flexlink::response::{ArmModes, ArmPose, PoseError, StateSpaceScope, arm_modes, arm_responses};
use flexlink::robust::Hold;
use nalgebra::{DMatrix, DVector, Matrix4, RowVector4};
use num_complex::Complex64;

use super::inversion::plans;
use crate::common::mesh_of;

const TOLERANCE: f64 = 1e-8;
const DOWN: [f64; 2] = [0.0, -9.81];

/// Two uniform links of lengths in m, stiffnesses in N m² and masses in kg/m.
#[derive(Debug, Clone, Copy)]
struct Two {
    lengths_m: [f64; 2],
    stiffnesses: [f64; 2],
    masses: [f64; 2],
    hubs: [f64; 2],
    carried: [f64; 2],
}

const TWO: Two = Two {
    lengths_m: [0.7, 0.6],
    stiffnesses: [60.0, 15.0],
    masses: [0.8, 0.4],
    hubs: [0.02, 0.005],
    carried: [0.6, 0.3],
};

impl Two {
    fn parts(&self) -> [LinkParts; 2] {
        [0, 1].map(|k| {
            Link::builder()
                .segment(Segment::uniform(self.lengths_m[k], self.stiffnesses[k], self.masses[k]))
                .hub_inertia_kg_m2(self.hubs[k])
                .payload(Payload { mass_kg: self.carried[k], ..Payload::default() })
        })
    }

    fn arm(&self, gravity_m_s2: [f64; 2]) -> Arm {
        arm(self.parts(), gravity_m_s2)
    }
}

fn arm<const N: usize>(parts: [LinkParts; N], gravity_m_s2: [f64; 2]) -> Arm {
    let links =
        parts.map(|own| ArmLink { name: None, link: own.build().expect("a valid link") }).into();
    Arm::new(ArmParts { links, gravity_m_s2, ..ArmParts::default() }).expect("a valid arm")
}

fn modes(arm: &Arm, directions_rad: &[f64], count: usize) -> ArmModes {
    let found = arm_modes(arm, directions_rad, count, TOLERANCE).expect("modes");
    let errors = found.free.errors.iter().chain(&found.held.errors);
    assert!(errors.into_iter().all(|error| *error <= TOLERANCE), "{found:?}");
    found
}

/// Squares of free and held modes.
fn squares(arm: &Arm, directions_rad: &[f64], count: usize) -> [Vec<f64>; 2] {
    let found = modes(arm, directions_rad, count);
    [found.free, found.held].map(|own| own.modes.iter().map(|mode| mode.square_per_s2).collect())
}

#[track_caller]
fn assert_close(found: &[f64], exact: &[f64], within: f64) {
    assert_eq!(found.len(), exact.len(), "{found:?} {exact:?}");
    let off = |(found, exact): (&f64, &f64)| (found / exact - 1.0).abs();
    let worst = found.iter().zip(exact).map(off).fold(0.0, f64::max);
    assert!(worst < within, "{worst:e}: {found:?} {exact:?}");
}

/// Mass and stiffness of the rigid arm, on the directions of its links.
fn double_pendulum(two: &Two, [inner, outer]: [f64; 2], [x, y]: [f64; 2]) -> [[f64; 3]; 2] {
    let Two { lengths_m: [l1, l2], masses: [m1, m2], hubs, carried, .. } = *two;
    let outboard_kg = carried[0] + m2 * l2 + carried[1];
    let first = hubs[0] + m1 * l1.powi(3) / 3.0 + outboard_kg * l1 * l1;
    let second = hubs[1] + m2 * l2.powi(3) / 3.0 + carried[1] * l2 * l2;
    let moments = [0.5 * m1 * l1 * l1 + outboard_kg * l1, 0.5 * m2 * l2 * l2 + carried[1] * l2];
    let along = |angle: f64| x * angle.cos() + y * angle.sin();
    let mass = [first, l1 * moments[1] * (outer - inner).cos(), second];
    [mass, [moments[0] * along(inner), 0.0, moments[1] * along(outer)]]
}

const STIFF: Two = Two { stiffnesses: [1e9, 1e9], ..TWO };

#[test]
fn links_that_do_not_bend_swing_and_fall_as_a_double_pendulum() {
    for pose in [[-FRAC_PI_2, -FRAC_PI_2], [-1.2, -0.4], [0.3, 1.2], [1.4, 1.7], [-1.8, 2.5]] {
        let [[a, b, c], [k, _, l]] = double_pendulum(&STIFF, pose, DOWN);
        // (k − λa)(l − λc) = λ²b²
        let (square, half, product) = (a * c - b * b, 0.5 * (k * c + l * a), k * l);
        let root = (half * half - square * product).sqrt();
        let exact = [(half - root) / square, (half + root) / square];
        let [free, _] = squares(&STIFF.arm(DOWN), &pose, 1);
        assert_close(&free[..2], &exact, 1e-6);
    }
    let [free, _] = squares(&STIFF.arm([0.0; 2]), &[0.3, 1.2], 1);
    assert_eq!(free[..2], [0.0, 0.0]);
}

#[test]
fn they_respond_to_torques_as_a_double_pendulum_with_friction() {
    let friction = [0.4, 0.2];
    let mut parts = STIFF.parts();
    for (own, friction) in parts.iter_mut().zip(friction) {
        own.hub.viscous_friction_n_m_s_rad = friction;
    }
    let (arm, pose) = (arm(parts, DOWN), [-1.2, 0.5]);
    let [mass, stiffness] = double_pendulum(&STIFF, pose, DOWN);
    let scope = StateSpaceScope::default();
    let space = modes(&arm, &pose, 0).state_space(&scope).expect("a state space");
    assert_eq!(space.a.nrows(), 4, "the swings alone");
    for hertz in [0.01, 0.7, 3.0] {
        let omega = TAU * hertz;
        let entry = |k: usize, damped: f64| {
            Complex64::new(stiffness[k] - omega * omega * mass[k], omega * damped)
        };
        // Friction acts on the first direction, and on the second less the first; torque 2 acts back on the first link.
        let [a, b, c] =
            [entry(0, friction[0] + friction[1]), entry(1, -friction[1]), entry(2, friction[1])];
        let determinant = a * c - b * b;
        let found = arm_responses(&arm, &pose, &[hertz], TOLERANCE).expect("a response");
        let in_space = space.response(omega).expect("a response");
        for (joint, [first, second]) in [[1.0, 0.0], [-1.0, 1.0]].into_iter().enumerate() {
            let turns =
                [(c * first - b * second) / determinant, (a * second - b * first) / determinant];
            let own = &found.rows[0].torques[joint];
            let mut exact = vec![turns[0], turns[1] - turns[0]];
            for part in [|angle: f64| -angle.sin(), |angle: f64| angle.cos()] {
                let arm_m = [0, 1].map(|k| STIFF.lengths_m[k] * part(pose[k]));
                exact.push(turns[0] * arm_m[0] + turns[1] * arm_m[1]);
            }
            let found: Vec<Complex64> = own.joints_rad.iter().chain(&own.tip_m).copied().collect();
            let names = ["joint1", "joint2", "tip_x", "tip_y"];
            for ((found, name), exact) in found.iter().zip(names).zip(&exact) {
                assert!((found - exact).norm() < 1e-6 * exact.norm(), "{found} {exact}");
                let row = space.outputs.iter().position(|own| own.name == name);
                let found = in_space[(row.expect(name), joint)];
                assert!((found - exact).norm() < 1e-6 * exact.norm(), "{found} {exact}");
            }
        }
    }
}

/// Rigid links of 0.5, 0.4 and 0.3 m with these masses in kg at their tips, and a carriage of a mass in kg.
struct Rigid<'a> {
    carried: &'a [f64],
    carriage: Option<f64>,
}

const LENGTHS_M: [f64; 3] = [0.5, 0.4, 0.3];
const MASSES: [f64; 3] = [0.8, 0.5, 0.3];
const HUBS: [f64; 3] = [0.02, 0.005, 0.004];
const AXIS: [f64; 2] = [0.6, 0.8];

impl Rigid<'_> {
    fn arm(&self) -> Arm {
        let link = |(k, mass_kg): (usize, &f64)| {
            let link = Link::builder()
                .segment(Segment::uniform(LENGTHS_M[k], 1e9, MASSES[k]))
                .hub_inertia_kg_m2(HUBS[k])
                .payload(Payload { mass_kg: *mass_kg, ..Payload::default() });
            ArmLink { name: None, link: link.build().expect("a valid link") }
        };
        let carriage = self.carriage.map(|mass_kg| ArmCarriage {
            carriage: Carriage { mass_kg, viscous_friction_n_s_m: 0.0 },
            axis: AXIS,
        });
        let links = self.carried.iter().enumerate().map(link).collect();
        Arm::new(ArmParts { links, carriage, ..ArmParts::default() }).expect("a valid arm")
    }

    /// Movement of a place on a link, a share of the link from its joint, by the directions of the links and the carriage.
    fn moved(&self, link: usize, share: f64, pose: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(2, self.count(), |axis, k| match k {
            _ if k == self.carried.len() => AXIS[axis],
            _ if k > link => 0.0,
            _ => {
                let across = [-pose[k].sin(), pose[k].cos()];
                across[axis] * LENGTHS_M[k] * if k == link { share } else { 1.0 }
            }
        })
    }

    fn count(&self) -> usize {
        self.carried.len() + usize::from(self.carriage.is_some())
    }

    /// Mass on these coordinates; Simpson's rule is exact.
    fn mass(&self, pose: &[f64]) -> DMatrix<f64> {
        let mut mass = DMatrix::zeros(self.count(), self.count());
        for (link, carried) in self.carried.iter().enumerate() {
            let own = LENGTHS_M[link] * MASSES[link] / 6.0;
            for (share, kg) in [(0.0, own), (0.5, 4.0 * own), (1.0, own + carried)] {
                let moved = self.moved(link, share, pose);
                mass += kg * moved.transpose() * moved;
            }
            mass[(link, link)] += HUBS[link];
        }
        if let Some(kg) = self.carriage {
            mass[(self.carried.len(), self.carried.len())] += kg;
        }
        mass
    }

    /// The tip, the directions of the links from the third on and the carriage, by the coordinates.
    fn prescribed(&self, pose: &[f64]) -> DMatrix<f64> {
        let mut rows = DMatrix::identity(self.count(), self.count());
        rows.rows_mut(0, 2).copy_from(&self.moved(self.carried.len() - 1, 1.0, pose));
        rows
    }
}

/// y = C q and M q̈ = τ for both arms, so that `G_true G⁻¹ = C M_true⁻¹ M C⁻¹`. Positions of joints place any rigid arm.
#[test]
fn the_error_of_rigid_arms_shrinks_in_learn_by_their_masses() {
    for (own, other) in [
        (([0.6, 0.3].as_slice(), None), ([0.6, 0.45].as_slice(), None)),
        ((&[0.6, 0.3, 0.2], None), (&[0.7, 0.3, 0.3], None)),
        ((&[0.6, 0.3], Some(5.0)), (&[0.6, 0.4], Some(8.0))),
        ((&[0.6, 0.3, 0.2], Some(5.0)), (&[0.6, 0.3, 0.3], Some(3.0))),
    ] {
        let [own, other] = [own, other].map(|(carried, carriage)| Rigid { carried, carriage });
        let pose = &[-0.4, 0.9, 1.7][..own.carried.len()];
        let rows = own.prescribed(pose);
        let inverse = rows.clone().try_inverse().expect("a pose with an inverse");
        let true_inverse = other.mass(pose).try_inverse().expect("a mass");
        let factor = rows * true_inverse * own.mass(pose) * inverse;
        let left = DMatrix::identity(2, 2) - factor.view((0, 0), (2, 2));
        let squares = left.transpose() * &left;
        let (half, product) = (0.5 * squares.trace(), squares.determinant());
        let exact = (half + (half * half - product).sqrt()).sqrt();
        for (hold, exact) in [(Hold::Effort, exact), (Hold::Position, 0.0)] {
            let frequencies_hz = vec![0.5, 1.0];
            let of = |arm: &Rigid<'_>| {
                let (arm, kept) = (&arm.arm(), KeptModes::All);
                let meshes = &plans(arm, ElementCount::Total(2))[..];
                let plant = Plant { arm, meshes, kept, delay_s: 0.0 };
                responses(&plant, hold, (&[pose.to_vec()], &frequencies_hz)).expect("responses")
            };
            let [own, other] = [&own, &other].map(of);
            let found = Contraction::of(frequencies_hz.clone(), &own, &[other]);
            let found = found.band().expect("a band").contraction(0.5);
            assert!((found - exact).abs() < 1e-6, "{found} is not {exact}");
        }
    }
}

/// All that a link can carry but shear.
fn loaded() -> LinkParts {
    Link::builder()
        .segment(Segment::uniform(0.4, 12.0, 0.6))
        .segment(Segment::uniform(0.3, 7.0, 0.4))
        .hub(Hub { inertia_kg_m2: 0.03, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.0 })
        .mass(LumpedMass { at_m: 0.3, mass_kg: 0.1, inertia_kg_m2: 1e-3 })
        .payload(Payload { mass_kg: 0.2, inertia_kg_m2: 2e-3, offset_m: 0.03 })
}

#[test]
fn an_outer_link_without_mass_leaves_the_inner_one_its_own_frequencies() {
    let link = loaded().build().expect("a link");
    let mesh = mesh_of(&link, 160);
    let light = || Link::builder().segment(Segment::uniform(0.5, 10.0, 1e-10));
    for spring_n_m_rad in [f64::INFINITY, 40.0] {
        let drive = Drive {
            joint_stiffness_n_m_rad: spring_n_m_rad,
            rotor_inertia_kg_m2: 1e-4,
            gear_ratio: 50.0,
            ..Drive::DIRECT
        };
        let arm = arm([loaded().drive(drive), light()], [0.0; 2]);
        let [free, held] = squares(&arm, &[0.4, 1.5], 4);
        let omega = |squares: &[f64]| squares.iter().map(|own| own.sqrt()).collect::<Vec<_>>();
        assert_close(&omega(&free[2..]), &natural_frequencies(&mesh, 4), 1e-6);
        assert_close(&omega(&held), &held_frequencies(&mesh, spring_n_m_rad, 4), 1e-6);
    }
}

/// σ in 1/s², above that with which an arm falls.
const SHIFT: f64 = 1e3;

/// Elements of each link of a frame.
const ELEMENTS: usize = 40;

/// The two links as straight beams that do not stretch: (v, φ) across each link at its nodes, the first link's before
/// the second's. The second one's root goes with the first one's tip, along and across it.
struct Frame {
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// Across the second link, and along it, for a motion of the first link's tip across that one.
    turned: [f64; 2],
}

/// Numbers of (v, φ) at a node of a link.
fn at(link: usize, node: usize) -> usize {
    2 * (link * (ELEMENTS + 1) + node)
}

const SIZE: usize = 4 * (ELEMENTS + 1);

impl Frame {
    /// `pull_m_s2` acts along both links, which then are one line.
    fn of(two: &Two, elbow_rad: f64, pull_m_s2: f64) -> Self {
        let mut frame = Self {
            mass: DMatrix::zeros(SIZE, SIZE),
            stiffness: DMatrix::zeros(SIZE, SIZE),
            turned: [elbow_rad.cos(), elbow_rad.sin()],
        };
        for link in [1, 0] {
            let h = two.lengths_m[link] / ELEMENTS as f64;
            let outboard = |node: usize| {
                let own = two.masses[link] * h * (ELEMENTS - node) as f64 + two.carried[link];
                if link == 0 {
                    own + two.masses[1] * two.lengths_m[1] + two.carried[1]
                } else {
                    own
                }
            };
            for element in 0..ELEMENTS {
                // Gauss's four points carry the products of cubics but one of the sixth order, which they carry, too.
                for (t, weight) in GAUSS {
                    let x = 0.5 * (1.0 + t);
                    let (x2, x3) = (x * x, x * x * x);
                    let shape = RowVector4::new(
                        1.0 - 3.0 * x2 + 2.0 * x3,
                        h * (x - 2.0 * x2 + x3),
                        3.0 * x2 - 2.0 * x3,
                        h * (x3 - x2),
                    );
                    let slope = RowVector4::new(
                        6.0 * (x2 - x) / h,
                        1.0 - 4.0 * x + 3.0 * x2,
                        6.0 * (x - x2) / h,
                        3.0 * x2 - 2.0 * x,
                    );
                    let curvature = RowVector4::new(
                        (12.0 * x - 6.0) / (h * h),
                        (6.0 * x - 4.0) / h,
                        (6.0 - 12.0 * x) / (h * h),
                        (6.0 * x - 2.0) / h,
                    );
                    let ds = 0.5 * weight * h;
                    let tension = pull_m_s2 * (outboard(element) - two.masses[link] * h * x);
                    let outer = |row: RowVector4<f64>| -> Matrix4<f64> { row.transpose() * row };
                    let first = at(link, element);
                    let mut block = frame.mass.fixed_view_mut::<4, 4>(first, first);
                    block += outer(shape) * (two.masses[link] * ds);
                    let mut block = frame.stiffness.fixed_view_mut::<4, 4>(first, first);
                    block += outer(curvature) * (two.stiffnesses[link] * ds)
                        + outer(slope) * (tension * ds);
                }
            }
            let (root, tip) = (at(link, 0) + 1, at(link, ELEMENTS));
            frame.mass[(root, root)] += two.hubs[link];
            frame.mass[(tip, tip)] += two.carried[link];
        }
        let along_kg = two.masses[1] * two.lengths_m[1] + two.carried[1];
        let tip = at(0, ELEMENTS);
        frame.mass[(tip, tip)] += along_kg * frame.turned[1].powi(2);
        frame
    }

    /// How all coordinates follow from independent ones: the first root stays, the second goes with the first tip, and a
    /// clamped joint turns its link with what carries it.
    fn follow(&self, is_clamped: [bool; 2]) -> DMatrix<f64> {
        let mut all = DMatrix::identity(SIZE, SIZE);
        let (tip, root) = (at(0, ELEMENTS), at(1, 0));
        all[(root, root)] = 0.0;
        all[(root, tip)] = self.turned[0];
        let mut gone = vec![0, root];
        if is_clamped[0] {
            gone.push(1);
        }
        if is_clamped[1] {
            all[(root + 1, root + 1)] = 0.0;
            all[(root + 1, tip + 1)] = 1.0;
            gone.push(root + 1);
        }
        gone.sort_unstable();
        all.remove_columns_at(&gone)
    }

    /// The lowest ω² with joints clamped or on springs in N m/rad.
    fn squares(&self, is_clamped: [bool; 2], springs: [f64; 2], count: usize) -> Vec<f64> {
        let follow = self.follow(is_clamped);
        let mut stiffness = self.stiffness.clone();
        let (before, own) = (at(0, ELEMENTS) + 1, at(1, 0) + 1);
        stiffness[(1, 1)] += springs[0];
        stiffness[(own, own)] += springs[1];
        stiffness[(before, before)] += springs[1];
        stiffness[(own, before)] -= springs[1];
        stiffness[(before, own)] -= springs[1];
        let [mass, stiffness] =
            [&self.mass, &stiffness].map(|matrix| follow.transpose() * matrix * &follow);
        // Those of (K + σM)⁻¹ M keep the digits of the lowest ones.
        let lower = (stiffness + &mass * SHIFT).cholesky().expect("a shift").unpack();
        let half = lower.solve_lower_triangular(&mass).expect("a shift");
        let whole = lower.solve_lower_triangular(&half.transpose()).expect("a shift");
        let inverse = whole.symmetric_eigenvalues();
        let mut squares: Vec<f64> = inverse.iter().map(|own| own.recip() - SHIFT).collect();
        squares.sort_by(f64::total_cmp);
        squares.truncate(count);
        squares
    }
}

/// Places in (−1, 1) and weights, 2 in sum, of Gauss and Legendre's four points.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

#[test]
fn a_bent_arm_has_the_frequencies_of_a_frame_of_beams() {
    let pose = [0.3, 1.8];
    let frame = Frame::of(&TWO, pose[1] - pose[0], 0.0);
    let [free, held] = squares(&TWO.arm([0.0; 2]), &pose, 4);
    assert_close(&free[2..], &frame.squares([false, false], [0.0; 2], 6)[2..], 1e-6);
    assert_close(&held, &frame.squares([true, true], [0.0; 2], 4), 1e-6);
    let springs = [80.0, 30.0];
    let mut parts = TWO.parts();
    for (own, joint_stiffness_n_m_rad) in parts.iter_mut().zip(springs) {
        own.drive = Some(Drive {
            joint_stiffness_n_m_rad,
            rotor_inertia_kg_m2: 1e-5,
            gear_ratio: 100.0,
            ..Drive::DIRECT
        });
    }
    let [_, held] = squares(&arm(parts, [0.0; 2]), &pose, 4);
    assert_close(&held, &frame.squares([false, false], springs, 4), 1e-6);
}

#[test]
fn a_hanging_arm_has_the_frequencies_of_a_frame_that_its_weight_pulls() {
    let frame = Frame::of(&TWO, 0.0, 9.81);
    let [free, held] = squares(&TWO.arm(DOWN), &[-FRAC_PI_2, -FRAC_PI_2], 3);
    assert_close(&free, &frame.squares([false, false], [0.0; 2], 5), 1e-6);
    assert_close(&held, &frame.squares([true, true], [0.0; 2], 3), 1e-6);
    // Upright it falls, by two ways.
    let frame = Frame::of(&TWO, 0.0, -9.81);
    let [free, held] = squares(&TWO.arm(DOWN), &[FRAC_PI_2, FRAC_PI_2], 3);
    assert!(free[1] < 0.0 && free[2] > 0.0, "{free:?}");
    assert_close(&free, &frame.squares([false, false], [0.0; 2], 5), 1e-6);
    assert_close(&held, &frame.squares([true, true], [0.0; 2], 3), 1e-6);
}

#[test]
fn a_bent_arm_responds_as_a_frame_of_beams_with_either_damping() {
    let (pose, hertz) = ([0.3, 1.8], 9.0);
    let frame = Frame::of(&TWO, pose[1] - pose[0], 0.0);
    let follow = frame.follow([false, false]);
    let omega = TAU * hertz;
    let beta_s = 1e-3;
    let laws = [
        (Damping::Hysteretic { ratio: 0.02 }, 0.04),
        (Damping::Rayleigh { alpha_per_s: 0.0, beta_s }, omega * beta_s),
    ];
    let (e1, e2) = ([-pose[0].sin(), pose[0].cos()], [pose[1].cos(), pose[1].sin()]);
    for (law, loss) in laws {
        let mut parts = TWO.parts();
        for own in &mut parts {
            own.damping = law.clone();
        }
        let found = arm_responses(&arm(parts, [0.0; 2]), &pose, &[hertz], TOLERANCE);
        let found = found.expect("a response");
        let dynamic = DMatrix::from_fn(SIZE, SIZE, |i, j| {
            let (k, m) = (frame.stiffness[(i, j)], frame.mass[(i, j)]);
            Complex64::new(k - omega * omega * m, loss * k)
        });
        let wide = follow.map(Complex64::from);
        let dynamic = (wide.transpose() * dynamic * &wide).lu();
        for (joint, own) in found.rows[0].torques.iter().enumerate() {
            let mut torque = DVector::zeros(SIZE);
            if joint == 0 {
                torque[1] = Complex64::from(1.0);
            } else {
                torque[at(1, 0) + 1] = Complex64::from(1.0);
                torque[at(0, ELEMENTS) + 1] = Complex64::from(-1.0);
            }
            let moved = &wide * dynamic.solve(&(wide.transpose() * torque)).expect("a response");
            let elbow = moved[at(0, ELEMENTS)];
            let (along, across) =
                (elbow * e1[0] * e2[0] + elbow * e1[1] * e2[1], moved[at(1, ELEMENTS)]);
            let tip = [along * e2[0] - across * e2[1], along * e2[1] + across * e2[0]];
            let turns = [moved[1], moved[at(1, 0) + 1] - moved[at(0, ELEMENTS) + 1]];
            let size = tip.iter().chain(&turns).map(|own| own.norm()).fold(0.0, f64::max);
            for (found, exact) in
                own.tip_m.iter().zip(&tip).chain(own.joints_rad.iter().zip(&turns))
            {
                assert!((found - exact).norm() < 1e-6 * size, "{law:?} {found} {exact}");
            }
        }
    }
}

/// Slowly turned joints move the tip from one shape at rest to the next.
#[test]
fn at_rest_a_sagging_arm_yields_to_torques_as_its_shapes_at_rest_do() {
    let soft = Two { stiffnesses: [25.0, 6.0], ..TWO };
    let (arm, pose) = (soft.arm(DOWN), [-1.1, -0.2]);
    let at = |directions: [f64; 2]| ArmPose::of(&arm, &directions, (0.0, 12)).expect("a pose");
    let own = at(pose);
    let part = 1e-3;
    // What a change of each direction takes, and where it moves the tip, to the fourth order.
    let of_direction = |direction: usize| {
        let values = [-2.0, -1.0, 1.0, 2.0].map(|by| {
            let mut pose = pose;
            pose[direction] += by * part;
            let at = at(pose);
            let (torques, tip) = (at.holding_torques_n_m(), at.tip_m());
            [torques[0], torques[1], tip[0], tip[1]]
        });
        [0, 1, 2, 3].map(|k| {
            (8.0 * (values[2][k] - values[1][k]) - (values[3][k] - values[0][k])) / (12.0 * part)
        })
    };
    let [first, second] = [of_direction(0), of_direction(1)];
    let determinant = first[0] * second[1] - first[1] * second[0];
    let found = own.response(1e-6);
    for (joint, [one, two]) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
        let turns = [
            (one * second[1] - two * second[0]) / determinant,
            (two * first[0] - one * first[1]) / determinant,
        ];
        for axis in [0, 1] {
            let exact = turns[0] * first[2 + axis] + turns[1] * second[2 + axis];
            let found = found.torques[joint].tip_m[axis];
            assert!((found - exact).norm() < 1e-7, "{found} {exact}");
        }
    }
    // The shape sags by more than round-off could hide.
    let rigid = [0.7 * pose[0].sin() + 0.6 * pose[1].sin(), own.tip_m()[1]];
    assert!((rigid[0] - rigid[1]).abs() > 1e-4, "{rigid:?}");
}

#[test]
fn a_torque_turns_another_joint_as_that_one_s_torque_turns_the_first() {
    let mut parts = [loaded(), TWO.parts()[0].clone(), TWO.parts()[1].clone()];
    for own in &mut parts {
        own.damping = Damping::Hysteretic { ratio: 0.01 };
        own.hub.viscous_friction_n_m_s_rad = 0.1;
    }
    let arm = arm(parts, [3.0, -9.0]);
    let found = arm_responses(&arm, &[-1.0, 0.4, 1.1], &[0.5, 5.0, 30.0], TOLERANCE);
    for row in found.expect("responses").rows {
        for i in 0..3 {
            for j in 0..i {
                let [a, b] = [row.torques[i].joints_rad[j], row.torques[j].joints_rad[i]];
                assert!((a - b).norm() < 1e-9 * a.norm(), "{a} {b}");
                assert!(a.norm() > 0.0);
            }
        }
    }
}

#[test]
fn a_link_held_by_its_rotor_is_damped_by_its_own_ratio_and_others_less() {
    let ratio_of = |ratios: [f64; 2]| {
        let mut parts = TWO.parts();
        for (own, ratio) in parts.iter_mut().zip(ratios) {
            own.damping = Damping::Hysteretic { ratio };
        }
        let found = modes(&arm(parts, [0.0; 2]), &[0.3, 1.8], 2);
        found.held.modes[0].damping_ratio.expect("it vibrates")
    };
    assert!((ratio_of([0.02, 0.02]) / 0.02 - 1.0).abs() < 1e-9);
    // Of light damping each link's share of the strain.
    let [inner, outer] = [ratio_of([1e-5, 0.0]), ratio_of([0.0, 1e-5])];
    assert!(((inner + outer) / 1e-5 - 1.0).abs() < 1e-9 && inner > outer && outer > 0.0);
}

#[test]
fn what_has_no_small_motions_is_refused() {
    let refused = |arm: &Arm, pose: &[f64]| arm_modes(arm, pose, 2, 1e-6).expect_err("refused");
    let one = refused(&TWO.arm(DOWN), &[0.1]);
    assert_eq!(one, PoseError::Directions { given: 1, links: 2 });
    let mut parts = TWO.parts();
    parts[1].damping = Damping::Modal { ratios: vec![0.01] };
    assert_eq!(
        refused(&arm(parts, DOWN), &[0.1, 0.2]).to_string(),
        "the damping of link 2 = modal, but must be none, hysteretic or rayleigh with alpha = 0"
    );
    assert_eq!(refused(&TWO.arm([0.0, -1e6]), &[0.1, 0.2]), PoseError::NoShape);
    let many = || {
        (1..=40).fold(Link::builder(), |link, k| {
            link.segment(Segment::uniform(0.01, 10.0 + f64::from(k), 1.0))
        })
    };
    let arm = arm([many(), many(), many(), many()], DOWN);
    assert!(matches!(refused(&arm, &[0.0; 4]), PoseError::TooMany { .. }));
}

/// Simpson's integral of samples at an even step.
fn integral(step: f64, values: &[f64]) -> f64 {
    let weight = |k: usize| match k {
        0 => 1.0,
        k if k + 1 == values.len() => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    values.iter().enumerate().map(|(k, value)| weight(k) * value).sum::<f64>() * step / 3.0
}

#[test]
fn shapes_are_normalised_by_the_masses_and_orthogonal() {
    const POINTS: usize = 200;
    let two = Two { hubs: [0.0; 2], ..TWO };
    let nodes_m = two.lengths_m.map(|length| {
        (0..=POINTS).map(|k| length * k as f64 / POINTS as f64).collect::<Vec<f64>>()
    });
    for (gravity_m_s2, pose) in [([0.0; 2], [0.3, 1.2]), (DOWN, [-1.2, 0.4])] {
        let shapes = modes(&two.arm(gravity_m_s2), &pose, 3).shapes(nodes_m.to_vec());
        assert_eq!(shapes.free.len(), 5);
        let product = |a: &[Vec<[f64; 3]>], b: &[Vec<[f64; 3]>]| -> f64 {
            let of_link = |link: usize| {
                let dot = |(a, b): (&[f64; 3], &[f64; 3])| a[0] * b[0] + a[1] * b[1];
                let dots: Vec<f64> = a[link].iter().zip(&b[link]).map(dot).collect();
                let step = two.lengths_m[link] / POINTS as f64;
                two.masses[link] * integral(step, &dots) + two.carried[link] * dots[POINTS]
            };
            of_link(0) + of_link(1)
        };
        for (i, a) in shapes.free.iter().enumerate() {
            for (j, b) in shapes.free.iter().enumerate() {
                let exact = if i == j { 1.0 } else { 0.0 };
                let found = product(a, b);
                assert!((found - exact).abs() < 1e-6, "modes {i} and {j}: {found}");
            }
        }
    }
}
