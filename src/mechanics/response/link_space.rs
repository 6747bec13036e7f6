//! The modes of one link for its state space: with a free hub or carriage, about its straight shape.

use nalgebra::DMatrix;

use super::state_space::{ModeChoice, Modes, Motion, Output, Signal, StateSpace, StateSpaceScope};
use crate::beam::{Mesh, node_at};
use crate::link::Link;
use crate::modal::{DampingLaw, ModalBasis, PoseHub, Shape, pose_modes, root_pull};
use crate::model::Sensor;

/// The state space of a link about its straight shape, under the torque of its hub, or the force on its carriage.
/// `outward_m_s2` is gravity along a link that keeps its direction; without it no weight counts.
///
/// `None` with weight and more than [`MOST_ELEMENTS_OF_A_POSE`](crate::modal::MOST_ELEMENTS_OF_A_POSE) elements, or if a
/// motion moves no mass then.
///
/// # Panics
/// With a station that is no node of the mesh.
pub fn link_state_space(
    (link, mesh, law): (&Link, &Mesh, &DampingLaw),
    outward_m_s2: Option<f64>,
    scope: &StateSpaceScope,
) -> Option<StateSpace> {
    let Kept { numbers, squares, shapes, rest } = match outward_m_s2 {
        None => weightless(mesh, &scope.modes),
        Some(outward_m_s2) => weighed(mesh, outward_m_s2, &scope.modes)?,
    };
    let friction = link.joint().friction();
    let bends = |i: usize, j: usize| shapes[i].stiffness_product(mesh, &shapes[j]);
    let is_straight = outward_m_s2.is_none();
    let viscous = DMatrix::from_fn(squares.len(), squares.len(), |i, j| {
        let hub = friction * shapes[i].hub_angle * shapes[j].hub_angle;
        let by_law = match law {
            DampingLaw::Hysteretic { .. } => 0.0,
            DampingLaw::Rayleigh { beta_s, .. } if !is_straight => beta_s * bends(i, j),
            _ if i != j || i == 0 => 0.0,
            _ => {
                let omega_rad_s = squares[i].sqrt();
                2.0 * law.modal_ratio(numbers[i], omega_rad_s) * omega_rad_s - law.mass_rate_per_s()
            }
        };
        hub + by_law + if i == j { law.mass_rate_per_s() } else { 0.0 }
    });
    let loss = DMatrix::from_fn(squares.len(), squares.len(), |i, j| match law {
        DampingLaw::Hysteretic { ratio } if !is_straight => 2.0 * ratio * bends(i, j),
        DampingLaw::Hysteretic { ratio } if i == j => 2.0 * ratio * squares[i],
        _ => 0.0,
    });
    let angles: Vec<f64> = shapes.iter().map(|shape| shape.hub_angle).collect();
    let output = |name: &str, unit: &str, motion, of: &dyn Fn(&Shape) -> f64| {
        let name = if link.has_station() { name.replace("tip", "output") } else { name.to_owned() };
        Output {
            signal: Signal::new(name, unit),
            motion,
            modes: shapes.iter().map(of).collect(),
            rest: vec![of(&rest)],
        }
    };
    let of_sensor = |sensor: Sensor, motion, of: &dyn Fn(&Shape) -> f64| {
        output(sensor.word(), sensor.unit(), motion, of)
    };
    let ([position, rate], effort) = if link.joint().slides() {
        ([Sensor::Carriage, Sensor::CarriageVelocity], Signal::new("force", "N"))
    } else {
        ([Sensor::HubAngle, Sensor::HubRate], Signal::new("torque", "N m"))
    };
    let tip = |shape: &Shape| shape.tip_displacement(mesh);
    let mut outputs = vec![
        of_sensor(position, Motion::Displacement, &|shape| shape.hub_angle),
        of_sensor(rate, Motion::Rate, &|shape| shape.hub_angle),
        output("tip_displacement", "m", Motion::Displacement, &tip),
        of_sensor(Sensor::TipDeflection, Motion::Displacement, &|shape| {
            shape.deflections[mesh.output()][0]
        }),
        of_sensor(Sensor::TipAcceleration, Motion::Acceleration, &tip),
        root_strain((link, mesh), outward_m_s2, (&squares, &shapes, &rest)),
    ];
    for (number, at_m) in (1..).zip(&scope.stations_m) {
        #[expect(clippy::expect_used, reason = "stated under Panics")]
        let node = node_at(mesh.nodes_m(), *at_m).expect("a node at each station");
        outputs.push(output(&format!("station{number}"), "m", Motion::Displacement, &|shape| {
            shape.displacement(mesh, node)
        }));
    }
    let modes = Modes {
        numbers,
        squares_per_s2: squares,
        viscous,
        loss,
        inputs: vec![(effort, angles)],
        frictions: vec![friction],
        outputs,
        tip: vec![2],
    };
    Some(modes.state_space(scope.has_residual))
}

/// The modes of a choice, the rigid motion first.
struct Kept {
    /// Numbers in tables of modes; 0 for the rigid motion.
    numbers: Vec<usize>,
    /// ω² in 1/s².
    squares: Vec<f64>,
    shapes: Vec<Shape>,
    /// Static response of all other modes per unit of effort.
    rest: Shape,
}

impl Kept {
    fn of(modes: impl Iterator<Item = (usize, f64, Shape)>, rest: Shape) -> Self {
        let mut kept = Self { numbers: Vec::new(), squares: Vec::new(), shapes: Vec::new(), rest };
        for (number, square, shape) in modes {
            kept.numbers.push(number);
            kept.squares.push(square);
            kept.shapes.push(shape);
        }
        kept
    }
}

fn weightless(mesh: &Mesh, choice: &ModeChoice) -> Kept {
    let mut basis = ModalBasis::lowest(mesh, choice.count());
    let numbers = (1..=basis.modes.len()).filter(|number| choice.has(*number, 0..=0));
    let numbers: Vec<usize> = numbers.collect();
    basis.modes = numbers.iter().map(|number| basis.modes[number - 1].clone()).collect();
    let rest = basis.static_residual(mesh);
    let modes = numbers.into_iter().zip(basis.modes);
    let modes = modes.map(|(number, own)| (number, own.omega_rad_s.powi(2), own.shape));
    Kept::of(std::iter::once((0, 0.0, basis.rigid)).chain(modes), rest)
}

fn weighed(mesh: &Mesh, outward_m_s2: f64, choice: &ModeChoice) -> Option<Kept> {
    let mut all = pose_modes(mesh, outward_m_s2, PoseHub::Free, usize::MAX)?;
    if mesh.joint().slides() {
        // Weight does not drive the motion of the whole link.
        let size = |mode: &(f64, Shape)| mode.0.abs();
        let rigid = all.iter().enumerate().min_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
        let (_, shape) = all.remove(rigid?.0);
        all.insert(0, (0.0, shape));
    }
    let mut rest = all[0].1.clone().scaled(0.0);
    let mut kept = Vec::new();
    for (number, (square, shape)) in all.into_iter().enumerate() {
        if choice.has(number, 0..=0) {
            kept.push((number, square, shape));
        } else {
            rest = rest.less(-shape.hub_angle / square, &shape);
        }
    }
    Some(Kept::of(kept.into_iter(), rest))
}

/// Curvature at the root: each mode bends the link there like its inertia forces, ω² times its shape, and its weight.
///
/// A constant torque bends the link like its constant acceleration, which no mode has; the other modes have the rest.
fn root_strain(
    (link, mesh): (&Link, &Mesh),
    outward_m_s2: Option<f64>,
    (squares, shapes, rest): (&[f64], &[Shape], &Shape),
) -> Output {
    let root_n_m2 = link.segments()[0].bending_stiffness_n_m2.inner;
    let pull = outward_m_s2.map(|own| root_pull(mesh, own)).unwrap_or_default();
    let of_weight = |shape: &Shape| {
        let bent = shape.deflections.iter().flat_map(|w| [w[0], w[1]]);
        pull.iter().zip(bent).map(|(pull, w)| pull * w).sum::<f64>()
    };
    let moment = |shape: &Shape| shape.moments(mesh)[mesh.springs()];
    let bends = squares.iter().zip(shapes);
    let bends =
        bends.map(|(square, shape)| (square * moment(shape) - of_weight(shape)) / root_n_m2);
    let turned: f64 = shapes.iter().map(|shape| moment(shape) * shape.hub_angle).sum();
    Output {
        signal: Signal::new(Sensor::RootStrain.word(), Sensor::RootStrain.unit()),
        motion: Motion::Displacement,
        modes: bends.collect(),
        rest: vec![-(turned + of_weight(rest)) / root_n_m2],
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use num_complex::Complex64;

    use super::*;
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{
        Carriage, Damping, Gravity, Hub, LinkParts, LumpedMass, Payload, Segment, uniform,
    };
    use crate::model::{FrequencyResponse, KeptModes, LinkOnMesh, model_of, responses_with_weight};

    /// A link with everything, on a hub with friction.
    fn parts(damping: Damping) -> LinkParts {
        LinkParts {
            segments: vec![Segment::uniform(0.7, 14.0, 0.6), Segment::uniform(0.8, 9.0, 0.4)],
            hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.3 },
            masses: vec![LumpedMass { at_m: 0.9, mass_kg: 0.2, inertia_kg_m2: 0.001 }],
            payload: Payload { mass_kg: 0.3, inertia_kg_m2: 0.002, offset_m: 0.04 },
            damping,
            ..uniform()
        }
    }

    fn mesh(link: &Link) -> Mesh {
        let total = Some(ElementCount::Total(6));
        Mesh::new(link, &MeshPlan::new(link, &[None; 2], total, 1e-6).unwrap()).unwrap()
    }

    fn space(
        link: &Link,
        mesh: &Mesh,
        outward_m_s2: Option<f64>,
        (modes, has_residual): (usize, bool),
    ) -> StateSpace {
        let law = DampingLaw::of(link, mesh).unwrap();
        let modes = ModeChoice::First(modes);
        let scope = StateSpaceScope { modes, stations_m: Vec::new(), has_residual };
        link_state_space((link, mesh, &law), outward_m_s2, &scope).unwrap()
    }

    fn row<'a>(space: &StateSpace, all: &'a DMatrix<Complex64>, name: &str) -> &'a Complex64 {
        &all[(space.outputs.iter().position(|own| own.name == name).unwrap(), 0)]
    }

    #[test]
    fn without_flexible_modes_a_link_is_a_double_integrator() {
        for (slides, names) in [
            (false, ["torque", "hub_angle", "hub_rate"]),
            (true, ["force", "carriage", "carriage_velocity"]),
        ] {
            let carriage = Carriage { mass_kg: 0.8, viscous_friction_n_s_m: 0.3 };
            let parts = parts(Damping::None);
            let on_carriage =
                |parts: LinkParts| LinkParts { hub: Hub::default(), ..parts }.carriage(carriage);
            let link = Link::new(if slides { on_carriage(parts) } else { parts }).unwrap();
            let found = space(&link, &mesh(&link), None, (0, false));
            let inertia = link.rigid_inertia_kg_m2();
            assert_eq!(found.inputs[0].name, names[0]);
            let outputs: Vec<&str> = found.outputs.iter().map(|own| &*own.name).collect();
            assert_eq!(outputs[..2], names[1..]);
            assert_eq!((found.a.nrows(), found.a[(0, 1)], found.a[(1, 0)]), (2, 1.0, 0.0));
            assert!((found.a[(1, 1)] + 0.3 / inertia).abs() < 1e-12);
            let gain = found.c[(0, 0)] * found.b[(1, 0)];
            assert!((gain * inertia - 1.0).abs() < 1e-12, "{gain}");
        }
    }

    /// v = sin(bx/L)/sin b + sinh(bx/L)/sinh b has the norm ∫ m̄ v² dx = m̄ L.
    #[test]
    fn the_inputs_of_a_pinned_and_free_beam_are_those_of_its_closed_form() {
        let link = Link::new(LinkParts {
            hub: Hub::default(),
            payload: Payload::default(),
            damping: Damping::Hysteretic { ratio: 0.01 },
            ..uniform()
        })
        .unwrap();
        let found = space(&link, &Mesh::on(&link, 100), None, (2, false));
        for (k, b) in [3.926_602_312_047_919_f64, 7.068_582_745_628_732].into_iter().enumerate() {
            let slope = b / 1.5 * (1.0 / b.sin() + 1.0 / b.sinh()) / (0.8_f64 * 1.5).sqrt();
            let input = found.b[(4 + k, 0)];
            assert!((input.abs() / slope.abs() - 1.0).abs() < 1e-6, "{input} is not {slope}");
            let omega = (b / 1.5).powi(2) * (5.0_f64 / 0.8).sqrt();
            assert!((found.a[(4 + k, 1 + k)] / -omega.powi(2) - 1.0).abs() < 1e-7);
            assert!((found.a[(4 + k, 4 + k)] / (-0.02 * omega) - 1.0).abs() < 1e-7);
        }
    }

    /// Against the recursion, which has all motions of the mesh, and against the sum of few modes.
    #[test]
    fn the_response_is_that_of_frf_with_all_modes_and_with_few() {
        let laws = [
            Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 0.0 },
            Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 2e-4 },
            Damping::Modal { ratios: vec![0.01, 0.02, 0.03] },
        ];
        for (number, damping) in laws.into_iter().enumerate() {
            let link = Link::new(parts(damping)).unwrap();
            let mesh = mesh(&link);
            let all = crate::modal::flexible_modes(&mesh);
            for (modes, kept) in [(all, KeptModes::All), (3, KeptModes::First(3))] {
                let found = space(&link, &mesh, None, (modes, kept == KeptModes::All));
                let whole = space(&link, &mesh, None, (modes, true));
                let model = model_of(&link, mesh.clone(), kept).unwrap();
                for hertz in [0.05, 0.7, 3.0, 11.0, 40.0, 90.0] {
                    let omega = std::f64::consts::TAU * hertz;
                    let at = found.response(omega).unwrap();
                    let exact = FrequencyResponse::at(&*model, hertz);
                    let sensed = |sensor: Sensor| sensor.per_torque(&*model, &[omega])[0];
                    let pairs = [
                        ("tip_displacement", exact.tip_displacement_per_torque_1_n),
                        ("hub_angle", sensed(Sensor::HubAngle)),
                        ("hub_rate", sensed(Sensor::HubRate)),
                        ("tip_deflection", sensed(Sensor::TipDeflection)),
                        ("tip_acceleration", sensed(Sensor::TipAcceleration)),
                        ("root_strain", sensed(Sensor::RootStrain)),
                    ];
                    for (name, exact) in pairs {
                        if name == "root_strain" {
                            // frf bends the link like the inertia forces, with the static response of other modes,
                            // which stiffness-proportional damping reduces there alone.
                            let at = whole.response(omega).unwrap();
                            let own =
                                whole.outputs.iter().position(|own| own.name == name).unwrap();
                            let factor = model.law().stiffness_factor(omega);
                            let net = 1.0 - 0.3 * row(&whole, &at, "hub_rate");
                            let undamped = whole.d[(own, 0)] * net * (1.0 - factor.inv());
                            let off = (at[(own, 0)] - undamped - exact).norm() / exact.norm();
                            assert!(
                                off < 1e-9,
                                "law {number} at {hertz} Hz, {modes} modes: {off:e}"
                            );
                            continue;
                        }
                        let off = (row(&found, &at, name) / exact - 1.0).norm();
                        assert!(off < 1e-9, "{name} at {hertz} Hz, {modes} modes: {off:e}");
                    }
                }
            }
        }
    }

    /// The strain of a gauge is the bend of the link where it is, whatever part of the moment there damping has.
    #[test]
    fn the_strain_at_the_root_is_the_curvature_of_the_shape() {
        for damping in [
            Damping::Hysteretic { ratio: 0.2 },
            Damping::Rayleigh { alpha_per_s: 2.0, beta_s: 0.03 },
            Damping::Modal { ratios: vec![0.3, 0.2] },
        ] {
            let link = Link::new(LinkParts { damping, ..uniform() }).unwrap();
            let model = model_of(&link, Mesh::on(&link, 60), KeptModes::All).unwrap();
            for hertz in [0.7, 3.0, 9.0] {
                let omega = std::f64::consts::TAU * hertz;
                let acceleration = Sensor::TipAcceleration.per_torque(&*model, &[omega])[0];
                let deflections = model.nodal_transfer(omega).deflections_s2;
                let bent = |node: usize| {
                    let lambda = model.law().lambda(omega) / (omega * omega);
                    let x_m = 1.5 * node as f64 / 60.0;
                    -deflections[node] * lambda * acceleration / (x_m * x_m)
                };
                // w/x² goes to half the curvature, here by a cubic through four nodes.
                let curvature = 2.0 * (4.0 * bent(1) - 6.0 * bent(2) + 4.0 * bent(3) - bent(4));
                let found = Sensor::RootStrain.per_torque(&*model, &[omega])[0];
                let off = (found / curvature - 1.0).norm();
                assert!(off < 1e-4, "{:?} at {hertz} Hz: {off:e}", link.damping());
            }
        }
    }

    #[test]
    fn a_weight_along_a_link_on_a_carriage_counts_as_in_frf() {
        for (damping, most) in [
            (Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 2e-4 }, 1e-8),
            (Damping::Hysteretic { ratio: 0.01 }, 0.03),
        ] {
            let gravity = Gravity { acceleration_m_s2: [0.0, -9.81], start_angle_rad: Some(1.5) };
            let carriage = Carriage { mass_kg: 0.8, viscous_friction_n_s_m: 0.3 };
            let parts = LinkParts {
                gravity: Some(gravity),
                hub: Hub::default(),
                ..parts(damping).carriage(carriage)
            };
            let link = Link::new(parts).unwrap();
            let mesh = mesh(&link);
            let found = space(&link, &mesh, link.outward_m_s2(), (100, true));
            let frequencies_hz = [0.05, 0.7, 3.0, 11.0, 40.0];
            let on_mesh = LinkOnMesh::new(&link, mesh).unwrap();
            let (rows, _) = responses_with_weight(&on_mesh, &frequencies_hz).unwrap();
            for exact in rows {
                let at = found.response(std::f64::consts::TAU * exact.frequency_hz).unwrap();
                let tip = exact.tip_displacement_per_torque_1_n;
                let off = (row(&found, &at, "tip_displacement") / tip - 1.0).norm();
                assert!(off < most, "{off:e} at {} Hz", exact.frequency_hz);
                let joint = exact.hub_angle_per_tip_displacement_rad_m * tip;
                let off = (row(&found, &at, "carriage") / joint - 1.0).norm();
                assert!(off < most, "{off:e} at {} Hz", exact.frequency_hz);
            }
        }
    }
}
