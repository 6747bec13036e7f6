use faer::linalg::solvers::Solve;
use faer::{Col, Mat};
use num_complex::Complex64;

use super::link_on_mesh::{LinkOnMesh, Model};
use crate::beam::{
    Inertia, LoadedMotion, Loads, Mesh, NodalTransfer, TipTransfer, loaded_motion, nodal_transfer,
};
use crate::modal::{ModalBasis, Shape};

/// Largest number of elements for assembly and factorisation: the work grows with the cube of the number.
pub const MOST_ELEMENTS_OF_DENSE_SOLVE: usize = 200;

/// Safety factor of an estimate of round-off.
const CAUTION: f64 = 100.0;

/// The paper's solution: assembled matrices on θ and (v, φ) of nodes 1 … n, and a factorisation with pivoting.
///
/// ```text
/// H x = e_h T,   H = M − K*/ω²  (+ C/(iω) of modal damping)      (Bayo 1987, eqs 15-17)
/// ```
///
/// The last digits of the transfers differ between processors, because faer uses other instructions on each.
#[derive(Debug, Clone)]
pub struct Dense {
    link: LinkOnMesh,
    mass: Mat<f64>,
    stiffness: Mat<f64>,
    /// Mass times each mode and its 2ζω, for a modal law.
    modes: Vec<(Col<f64>, f64)>,
}

impl Dense {
    /// Assembles the link; `None` beyond [`MOST_ELEMENTS_OF_DENSE_SOLVE`], or if the modes of a modal law are not
    /// finite.
    pub fn assemble(link: LinkOnMesh) -> Option<Self> {
        let mesh = link.mesh();
        let count = mesh.elements().len();
        if count > MOST_ELEMENTS_OF_DENSE_SOLVE {
            return None;
        }
        // On (v, φ) of all nodes.
        let size = 2 * count + 2;
        let (mut mass, mut stiffness) = (Mat::zeros(size, size), Mat::zeros(size, size));
        for (k, element) in mesh.elements().iter().enumerate() {
            let (m, s) = (element.mass(), element.stiffness());
            for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
                mass[(2 * k + row, 2 * k + column)] += m[(row, column)];
                stiffness[(2 * k + row, 2 * k + column)] += s[(row, column)];
            }
        }
        let lumped = (0..count).filter_map(|k| mesh.lumped_inertia(k).map(|body| (k, body)));
        for (node, Inertia { vv, vp, pp }) in lumped.chain([(count, mesh.tip_inertia())]) {
            let at = 2 * node;
            mass[(at, at)] += vv;
            mass[(at, at + 1)] += vp;
            mass[(at + 1, at)] += vp;
            mass[(at + 1, at + 1)] += pp;
        }
        let mut mass = held(mesh, &mass);
        mass[(0, 0)] += mesh.joint().inertia();
        let mut stiffness = held(mesh, &stiffness);
        if mesh.springs() == 1 {
            // The outer end of a spring moves with the joint: its place among the unknowns stays 0.
            stiffness[(1, 1)] = stiffness[(2, 2)];
        }
        let modes = damped_modes(&link, &mass)?;
        Some(Self { link, mass, stiffness, modes })
    }

    /// `H⁻¹` times loads on the unknowns: the accelerations of the unknowns.
    fn accelerations(&self, omega_rad_s: f64, loads: &Mat<Complex64>) -> Mat<Complex64> {
        let solution = self.solved(omega_rad_s, loads);
        // On a pole of an undamped link no number is finite, but slightly beside it all are.
        if solution.col_iter().all(|column| column.iter().all(|a| a.is_finite())) {
            solution
        } else {
            self.solved(omega_rad_s * (1.0 + 4.0 * f64::EPSILON), loads)
        }
    }

    /// Two columns of loads on the unknowns: a unit torque at the hub, and loads on all nodes.
    fn torque_and_loads(&self, nodal: &[[Complex64; 2]]) -> Mat<Complex64> {
        let [v, phi] = self.mesh().rigid(0);
        Mat::from_fn(self.mass.nrows(), 2, |row, column| match (row, column) {
            (0, 0) => Complex64::ONE,
            (_, 0) => Complex64::ZERO,
            (0, _) => {
                nodal[0][1] * phi
                    + nodal[..=self.mesh().springs()].iter().map(|load| load[0]).sum::<Complex64>()
                        * v
            }
            (1, _) if self.mesh().springs() == 1 => Complex64::ZERO,
            _ => nodal[row.div_ceil(2)][(row + 1) % 2],
        })
    }

    fn solved(&self, omega_rad_s: f64, loads: &Mat<Complex64>) -> Mat<Complex64> {
        let size = self.mass.nrows();
        let per_lambda = self.law().lambda(omega_rad_s).inv();
        let mut h = Mat::from_fn(size, size, |row, column| {
            Complex64::from(self.mass[(row, column)]) - per_lambda * self.stiffness[(row, column)]
        });
        for (mode, rate) in &self.modes {
            // iωC/(−ω²)
            let factor = Complex64::new(0.0, -rate / omega_rad_s);
            for column in 0..size {
                for row in 0..size {
                    h[(row, column)] += factor * (mode[row] * mode[column]);
                }
            }
        }
        h.partial_piv_lu().solve(loads)
    }

    /// Accelerations (v, φ) of nodes 0 … n from the accelerations of the unknowns: the root sits on the hub.
    fn nodes(&self, unknowns: &[Complex64]) -> Vec<[Complex64; 2]> {
        let root = self.mesh().rigid(0).map(|part| unknowns[0] * part);
        let outer = unknowns[1..].chunks(2).map(|node| [node[0], node[1]]);
        let mut nodes: Vec<_> = std::iter::once(root).chain(outer).collect();
        if self.mesh().springs() == 1 {
            nodes[1][0] = root[0];
        }
        nodes
    }

    /// Moments at nodes 0 … n from the part outboard of each, for accelerations (v, φ) of the nodes.
    fn moments(&self, accelerations: &[[Complex64; 2]]) -> Vec<Complex64> {
        let mesh = self.mesh();
        let load = |Inertia { vv, vp, pp }: Inertia<f64>, [v, phi]: [Complex64; 2]| {
            [v * vv + phi * vp, v * vp + phi * pp]
        };
        let last = accelerations.len() - 1;
        let [mut force, mut moment] = load(mesh.tip_inertia(), accelerations[last]);
        let mut moments = vec![moment; last + 1];
        for (k, element) in mesh.elements().iter().enumerate().rev() {
            let (mass, ends) = (element.mass(), [accelerations[k], accelerations[k + 1]]);
            let row = |row: usize| -> Complex64 {
                (0..4).map(|column| ends[column / 2][column % 2] * mass[(row, column)]).sum()
            };
            let lumped = mesh.lumped_inertia(k).map(|body| load(body, accelerations[k]));
            let [lumped_force, lumped_moment] = lumped.unwrap_or_default();
            let length_m = mesh.nodes_m()[k + 1] - mesh.nodes_m()[k];
            moment += row(3) + (force + row(2)) * length_m + row(1) + lumped_moment;
            force += row(2) + row(0) + lumped_force;
            moments[k] = moment;
        }
        moments
    }

    /// Estimate of the relative error from round-off at ω: K annihilates rigid motion only up to ε times its largest
    /// entry, and the remainder is divided by ω² and by the rigid inertia.
    pub fn round_off(&self, omega_rad_s: f64) -> f64 {
        let mesh = self.mesh();
        let rigid = column(mesh, &ModalBasis::lowest(mesh, 0).rigid);
        let largest = (1..self.mass.nrows())
            .step_by(2)
            .map(|row| self.stiffness[(row, row)] * rigid[row].powi(2));
        let largest = largest.fold(0.0, f64::max);
        let sum = (mesh.elements().len() as f64).sqrt();
        CAUTION * f64::EPSILON * sum * largest / omega_rad_s.powi(2)
    }
}

impl Model for Dense {
    fn on_mesh(&self) -> &LinkOnMesh {
        &self.link
    }

    fn tip_transfer(&self, omega_rad_s: f64) -> TipTransfer {
        self.nodal_transfer(omega_rad_s).tip
    }

    /// [`Dense::round_off`] estimates the error of round-off. At ω = 0, where K/ω² is infinite, the link is rigid.
    fn nodal_transfer(&self, omega_rad_s: f64) -> NodalTransfer {
        if omega_rad_s == 0.0 {
            return nodal_transfer(self.mesh(), Complex64::ZERO);
        }
        let (nodes, lambda) = (self.mesh().nodes_m().len(), self.law().lambda(omega_rad_s));
        let torque = self.torque_and_loads(&vec![[Complex64::ZERO; 2]; nodes]);
        let accelerations = self.accelerations(omega_rad_s, &torque);
        let inertia_kg_m = accelerations[(2 * self.mesh().output() - 1, 0)].inv();
        let per_tip: Vec<_> = accelerations.col(0).iter().map(|a| a * inertia_kg_m).collect();
        let angle_rad_m = per_tip[0];
        let nodes = self.nodes(&per_tip);
        let moments_kg_m = self.moments(&nodes);
        let deflection_s2 = |(node, v): (usize, &[Complex64; 2])| {
            (v[0] - angle_rad_m * self.mesh().rigid(node)[0]) / lambda
        };
        let deflections_s2: Vec<_> = nodes.iter().enumerate().map(deflection_s2).collect();
        let tip = TipTransfer {
            inertia_kg_m,
            root_inertia_kg_m: moments_kg_m[0],
            angle_rad_m,
            deflection_s2: deflections_s2[self.mesh().output()],
        };
        NodalTransfer { tip, deflections_s2, moments_kg_m }
    }

    /// At ω = 0, where K/ω² is infinite, the recursion answers.
    fn loaded_motion(&self, omega_rad_s: f64, loads: &Loads<Complex64>) -> LoadedMotion<Complex64> {
        let (mesh, lambda) = (self.mesh(), self.law().lambda(omega_rad_s));
        let factors = self.law().factors(omega_rad_s);
        assert!(loads.nodal.len() == mesh.nodes_m().len(), "a load for each node");
        if omega_rad_s == 0.0 {
            return loaded_motion(mesh, lambda, factors, loads);
        }
        let per_mass = factors[0].inv();
        let with_axis = |(load, inertia): (&[Complex64; 2], [f64; 2])| {
            [0, 1].map(|part| load[part] * per_mass - loads.axis_m_s2 * inertia[part])
        };
        let nodal: Vec<_> = loads.nodal.iter().zip(shifted_masses(mesh)).map(with_axis).collect();
        let moved = self.accelerations(omega_rad_s, &self.torque_and_loads(&nodal));
        let (tip, chord_rad_s2) = (2 * mesh.output() - 1, loads.chord_rad_s2);
        let torque = (chord_rad_s2 * mesh.rigid_tip() - moved[(tip, 1)]) / moved[(tip, 0)];
        let relative: Vec<_> =
            (0..moved.nrows()).map(|row| moved[(row, 0)] * torque + moved[(row, 1)]).collect();
        let per_square = -(omega_rad_s * omega_rad_s).recip();
        let from_chord = |(node, moved): (usize, [Complex64; 2])| {
            let rigid = mesh.rigid(node);
            [0, 1].map(|part| (moved[part] - chord_rad_s2 * rigid[part]) * per_square)
        };
        let deflections = self.nodes(&relative).into_iter().enumerate().map(from_chord).collect();
        let hub_slope_rad = (relative[0] - chord_rad_s2) * per_square;
        LoadedMotion { torque_n_m: torque * factors[0], hub_slope_rad, deflections }
    }
}

/// Force and moment on each node for a unit acceleration of the whole link along its normal.
fn shifted_masses(mesh: &Mesh) -> Vec<[f64; 2]> {
    let mut masses = vec![[0.0; 2]; mesh.nodes_m().len()];
    masses[0][0] = mesh.joint().position([1.0, 0.0]) * mesh.joint().inertia();
    for (k, element) in mesh.elements().iter().enumerate() {
        for (node, load) in [k, k + 1].into_iter().zip(element.load(element.mass_per_length_kg_m)) {
            masses[node] = [0, 1].map(|part| masses[node][part] + load[part]);
        }
    }
    let last = masses.len() - 1;
    let lumped = (0..last).filter_map(|k| mesh.lumped_inertia(k).map(|body| (k, body)));
    for (node, body) in lumped.chain([(last, mesh.tip_inertia())]) {
        masses[node] = [masses[node][0] + body.vv, masses[node][1] + body.vp];
    }
    masses
}

/// Mass times each mode and its 2ζω, for a modal law: `C = Σ 2ζω (M φ)(M φ)ᵀ`.
fn damped_modes(link: &LinkOnMesh, mass: &Mat<f64>) -> Option<Vec<(Col<f64>, f64)>> {
    let (mesh, law) = (link.mesh(), link.law());
    if !law.is_modal() {
        return Some(Vec::new());
    }
    let basis = ModalBasis::complete(mesh).ok()?;
    let damped = basis.modes.iter().enumerate().map(|(k, mode)| {
        let rate = 2.0 * law.modal_ratio(k + 1, mode.omega_rad_s) * mode.omega_rad_s;
        (mass * column(mesh, &mode.shape), rate)
    });
    Some(damped.collect())
}

/// Reduces a matrix on (v, φ) of all nodes to the unknowns: the joint moves the root along its unit motion.
fn held(mesh: &Mesh, free: &Mat<f64>) -> Mat<f64> {
    let [v, phi] = mesh.rigid(0);
    let springs = mesh.springs();
    // Weights of the unknown's own place, of the root, and of the outer end of a spring at the root.
    let weights = |index| match index {
        0 => [phi, v, v * springs as f64],
        1 if springs == 1 => [0.0; 3],
        _ => [1.0, 0.0, 0.0],
    };
    let in_row = |row, column| {
        let [own, root, outer] = weights(row);
        own * free[(row + 1, column)] + root * free[(0, column)] + outer * free[(2, column)]
    };
    Mat::from_fn(free.nrows() - 1, free.ncols() - 1, |row, column| {
        let [own, root, outer] = weights(column);
        own * in_row(row, column + 1) + root * in_row(row, 0) + outer * in_row(row, 2)
    })
}

/// A shape as a column of θ and (v, φ) of nodes 1 … n.
fn column(mesh: &Mesh, shape: &Shape) -> Col<f64> {
    Col::from_fn(2 * mesh.nodes_m().len() - 1, |row| {
        if row % 2 == 1 {
            let is_of_spring = row == 1 && mesh.springs() == 1;
            if is_of_spring { 0.0 } else { shape.displacement(mesh, row.div_ceil(2)) }
        } else if row == 0 {
            shape.hub_angle
        } else {
            shape.total(mesh, row / 2)[1]
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, uniform};
    use crate::model::superposition::Superposition;
    use crate::model::{KeptModes, model_of};

    fn apart(found: &[Complex64], expected: &[Complex64]) -> f64 {
        let largest = expected.iter().fold(0.0, |most: f64, x| most.max(x.norm()));
        let differences = found.iter().zip(expected).map(|(a, b)| (a - b).norm());
        differences.fold(0.0, f64::max) / largest
    }

    fn wave(k: usize) -> Complex64 {
        let angle = 1.3 * k as f64;
        Complex64::new(angle.sin(), (2.1 * angle).cos())
    }

    #[test]
    fn recursion_and_superposition_answer_as_the_assembled_matrices_do() {
        let parts = LinkParts {
            hub: Hub { radius_m: 0.1, ..uniform().hub },
            masses: [0.1, 0.6]
                .map(|at_m| LumpedMass { at_m, mass_kg: 0.2, inertia_kg_m2: 3e-3 })
                .into(),
            payload: Payload { mass_kg: 0.3, inertia_kg_m2: 2e-3, offset_m: 0.05 },
            ..uniform()
        };
        for (damping, output_m) in [
            (Damping::None, None),
            (Damping::Hysteretic { ratio: 0.03 }, None),
            (Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 2e-3 }, None),
            (Damping::Modal { ratios: vec![0.05, 0.01] }, None),
            (Damping::Hysteretic { ratio: 0.03 }, Some(0.6)),
        ] {
            let link = Link::new(LinkParts { output_m, damping, ..parts.clone() }).unwrap();
            let mesh = Mesh::on(&link, 6);
            let model = model_of(&link, mesh, KeptModes::All).unwrap();
            let dense = Dense::assemble(model.on_mesh().clone()).unwrap();
            for omega in [0.0, 3.0, 17.0, 90.0] {
                let [found, expected] =
                    [&*model, &dense as &dyn Model].map(|model| model.nodal_transfer(omega));
                let tip = |of: &NodalTransfer| {
                    [of.tip.inertia_kg_m, of.tip.root_inertia_kg_m, of.tip.angle_rad_m]
                };
                for off in [
                    apart(&tip(&found), &tip(&expected)),
                    apart(&found.deflections_s2, &expected.deflections_s2),
                    apart(&found.moments_kg_m, &expected.moments_kg_m),
                    apart(&[found.tip.deflection_s2], &[expected.tip.deflection_s2]),
                ] {
                    assert!(off < 1e-8, "{:?} at {omega}: {off:e}", link.damping());
                }
                // Damping through modes has only the model of all modes.
                let modes = Superposition::new(model.on_mesh().clone(), KeptModes::All).unwrap();
                let at_rest = Complex64::ZERO;
                let loads = Loads {
                    axis_m_s2: Complex64::new(9.81, 0.3),
                    chord_rad_s2: if omega == 0.0 { at_rest } else { Complex64::new(-2.0, 0.7) },
                    nodal: (0..7).map(|k| [wave(k), wave(3 * k + 1) * 0.05]).collect(),
                };
                let exact = dense.loaded_motion(omega, &loads);
                for model in [&*model, &modes as &dyn Model] {
                    let found = model.loaded_motion(omega, &loads);
                    let part = |of: &LoadedMotion<Complex64>, part: usize| -> Vec<Complex64> {
                        of.deflections.iter().map(|w| w[part]).collect()
                    };
                    for off in [
                        apart(&[found.torque_n_m], &[exact.torque_n_m]),
                        apart(&[found.hub_slope_rad], &[exact.hub_slope_rad]),
                        apart(&part(&found, 0), &part(&exact, 0)),
                        apart(&part(&found, 1), &part(&exact, 1)),
                    ] {
                        assert!(off < 1e-10, "{model:?} at {omega}: {off:e}");
                    }
                }
            }
        }
    }
}
