//! The link as the paper solves it: assembled matrices and a factorisation with pivoting.

use faer::linalg::solvers::Solve;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, MatRef, Par, Side, c64};
use flexlink::beam::{Inertia, Mesh};
use flexlink::link::{Link, LumpedMass, Taper};
use nalgebra::{Matrix2, Matrix4, SMatrix, Vector5};

/// Mass and stiffness of one element on (v, φ) of its two nodes.
struct Part {
    mass: Matrix4<f64>,
    stiffness: Matrix4<f64>,
}

/// All parts of a link, before anything is said about the hub.
pub(crate) struct Assembly {
    /// Element k lies between nodes k and k + 1.
    parts: Vec<Part>,
    /// Mass matrices on (v, φ) of a node.
    lumped: Vec<(usize, Matrix2<f64>)>,
    root_m: f64,
    hub_inertia_kg_m2: f64,
}

/// Where a unit load acts.
#[derive(Clone, Copy)]
pub(crate) enum Load {
    /// Torque at the hub.
    HubTorque,
    /// Transverse force at the tip.
    TipForce,
}

impl Assembly {
    /// The program's own element matrices, assembled.
    pub(crate) fn of_mesh(mesh: &Mesh) -> Self {
        let parts = mesh
            .elements()
            .iter()
            .map(|element| Part { mass: element.mass(), stiffness: element.stiffness() });
        let body = |i: Inertia<f64>| Matrix2::new(i.vv, i.vp, i.vp, i.pp);
        let n = mesh.elements().len();
        let lumped = (0..n).filter_map(|k| mesh.lumped_inertia(k).map(|i| (k, body(i))));
        Self {
            parts: parts.collect(),
            lumped: lumped.chain([(n, body(mesh.tip_inertia()))]).collect(),
            root_m: mesh.nodes_m()[0],
            hub_inertia_kg_m2: mesh.joint().inertia(),
        }
    }

    /// Element matrices integrated here from the link's own data; only where the nodes stand is
    /// taken from the program.
    pub(crate) fn of_link(link: &Link, nodes_m: &[f64]) -> Self {
        let n = nodes_m.len() - 1;
        let nearest = |mass: &LumpedMass| {
            let distance = |k: &usize| (nodes_m[*k] - mass.at_m).abs();
            (0..=n).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let point = |m: &LumpedMass| Matrix2::new(m.mass_kg, 0.0, 0.0, m.inertia_kg_m2);
        let payload = link.payload();
        let (m, c) = (payload.mass_kg, payload.offset_m);
        let tip = Matrix2::new(m, m * c, m * c, payload.inertia_kg_m2 + m * c * c);
        let masses = link.masses().iter().map(|mass| (nearest(mass), point(mass)));
        Self {
            parts: nodes_m.windows(2).map(|ends| integrate(link, ends[0], ends[1])).collect(),
            lumped: masses.chain([(n, tip)]).collect(),
            root_m: link.hub().radius_m,
            hub_inertia_kg_m2: link.hub().inertia_kg_m2,
        }
    }

    /// Number of nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.parts.len() + 1
    }

    /// H of all that lies outboard of node `from`, on (v, φ) of all nodes; M alone for 1/λ = 0.
    ///
    /// ```text
    /// H = M − K*/ω² = M − K/λ                                     (Bayo 1987, eqs 15 and 16)
    /// ```
    fn h(&self, from: usize, per_lambda: c64) -> Mat<c64> {
        let size = 2 * self.nodes();
        let mut h = Mat::zeros(size, size);
        for (k, part) in self.parts.iter().enumerate().skip(from) {
            for (row, column) in (0..4).flat_map(|r| (0..4).map(move |c| (r, c))) {
                let stiffness = per_lambda * part.stiffness[(row, column)];
                h[(2 * k + row, 2 * k + column)] += c64::from(part.mass[(row, column)]) - stiffness;
            }
        }
        for (node, body) in self.lumped.iter().filter(|(node, _)| *node >= from) {
            for (row, column) in (0..2).flat_map(|r| (0..2).map(move |c| (r, c))) {
                h[(2 * node + row, 2 * node + column)] += c64::from(body[(row, column)]);
            }
        }
        h
    }

    /// All natural frequencies squared, ascending, with a spring between hub and ground: the
    /// eigenvalues of `L⁻¹ K L⁻ᵀ`, with `M = L Lᵀ`.
    pub(crate) fn squared_frequencies(&self, spring_n_m_rad: f64) -> Vec<f64> {
        let [mass, mut stiffness] = self.mass_and_stiffness();
        stiffness[(0, 0)] += spring_n_m_rad;
        let cholesky = mass.llt(Side::Lower).expect("every degree of freedom moves mass");
        let half = solve_lower(cholesky.L(), &stiffness);
        let whole = solve_lower(cholesky.L(), &half.transpose().to_owned());
        whole.self_adjoint_eigenvalues(Side::Lower).expect("a symmetric matrix")
    }

    /// Motion (v, φ) of all nodes under a unit load, times −ω²: `H a = f`.
    pub(crate) fn accelerations(&self, lambda: c64, load: Load) -> Vec<c64> {
        let size = 2 * self.nodes();
        let h = self.held(&self.h(0, lambda.inv()));
        let mut f = Mat::<c64>::zeros(size - 1, 1);
        match load {
            Load::HubTorque => f[(0, 0)] = c64::ONE,
            Load::TipForce => f[(size - 3, 0)] = c64::ONE,
        }
        let a = self.root_on_hub() * h.partial_piv_lu().solve(&f);
        (0..size).map(|row| a[(row, 0)]).collect()
    }

    /// Torque, and motion (v, φ) of all nodes times −ω², under loads on the nodes, while the axis accelerates
    /// and the tip's acceleration is that of the chord. Mass times `factors[0]` and stiffness times `factors[1]`
    /// are the link's own.
    ///
    /// The unknowns are the motions of all nodes against the ground, the root's force and its moment.
    pub(crate) fn loaded(
        &self,
        omega: f64,
        factors: [c64; 2],
        [axis, chord]: [c64; 2],
        nodal: &[[c64; 2]],
        length_m: f64,
    ) -> (c64, Vec<c64>) {
        let size = 2 * self.nodes();
        let inertia = self.h(0, factors[1] / factors[0] / (omega * omega));
        let mut system = Mat::<c64>::zeros(size + 2, size + 2);
        system.get_mut(..size, ..size).copy_from(&inertia);
        let mut right = Mat::<c64>::zeros(size + 2, 1);
        for (node, load) in nodal.iter().enumerate() {
            for part in 0..2 {
                right[(2 * node + part, 0)] = load[part] / factors[0];
            }
        }
        system[(0, size)] = -c64::ONE;
        system[(1, size + 1)] = -c64::ONE;
        system[(size, 0)] = c64::ONE;
        system[(size, 1)] = -c64::from(self.root_m);
        right[(size, 0)] = axis;
        system[(size + 1, size - 2)] = c64::ONE;
        right[(size + 1, 0)] = axis + chord * length_m;
        let found = system.partial_piv_lu().solve(&right);
        let hub = found[(1, 0)] * self.hub_inertia_kg_m2;
        let torque = found[(size + 1, 0)] + found[(size, 0)] * self.root_m + hub;
        (torque * factors[0], (0..size).map(|row| found[(row, 0)]).collect())
    }

    /// Motion (v, φ) of all nodes per `(θ, v_1, φ_1, …, v_n, φ_n)`.
    fn root_on_hub(&self) -> Mat<c64> {
        let size = 2 * self.nodes();
        let mut held = Mat::<c64>::zeros(size, size - 1);
        held[(0, 0)] = self.root_m.into();
        for row in 1..size {
            held[(row, row - 1)] = c64::ONE;
        }
        held
    }

    /// H on `(θ, v_1, φ_1, …)`, with the hub's own inertia.
    fn held(&self, h: &Mat<c64>) -> Mat<c64> {
        let held = self.root_on_hub();
        let mut h = held.transpose() * h * &held;
        h[(0, 0)] += self.hub_inertia_kg_m2;
        h
    }

    /// M and K on `(θ, v_1, φ_1, …, v_n, φ_n)`, the hub's inertia included.
    pub(crate) fn mass_and_stiffness(&self) -> [Mat<f64>; 2] {
        let mass = self.held(&self.h(0, c64::ZERO));
        let both = self.held(&self.h(0, -c64::ONE));
        let real = |of: &dyn Fn(usize, usize) -> c64| {
            Mat::from_fn(mass.nrows(), mass.ncols(), |row, column| of(row, column).re)
        };
        [real(&|r, c| mass[(r, c)]), real(&|r, c| both[(r, c)] - mass[(r, c)])]
    }

    /// Moment that the part inside node `from` exerts on the part outside, for given accelerations.
    pub(crate) fn moment(&self, from: usize, lambda: c64, accelerations: &[c64]) -> c64 {
        let h = self.h(from, lambda.inv());
        let row = 2 * from + 1;
        accelerations.iter().enumerate().map(|(k, a)| h[(row, k)] * a).sum()
    }

    /// Moment about node `from` that gives what lies outboard of it these accelerations.
    pub(crate) fn inertial_moment(
        &self,
        from: usize,
        nodes_m: &[f64],
        accelerations: &[c64],
    ) -> c64 {
        let forces =
            self.h(from, c64::ZERO) * Mat::from_fn(accelerations.len(), 1, |k, _| accelerations[k]);
        let moment =
            |k: usize| forces[(2 * k, 0)] * (nodes_m[k] - nodes_m[from]) + forces[(2 * k + 1, 0)];
        (from..self.nodes()).map(moment).sum()
    }

    /// Rotary inertia of the link that turns about the axis without bending.
    pub(crate) fn rigid_inertia_kg_m2(&self, nodes_m: &[f64]) -> f64 {
        let mass = self.h(0, c64::ZERO);
        let motion: Vec<f64> = nodes_m.iter().flat_map(|x| [*x, 1.0]).collect();
        let pairs = (0..motion.len()).flat_map(|r| (0..motion.len()).map(move |c| (r, c)));
        let sum: f64 = pairs.map(|(r, c)| motion[r] * mass[(r, c)].re * motion[c]).sum();
        self.hub_inertia_kg_m2 + sum
    }
}

fn solve_lower(lower: MatRef<'_, f64>, right: &Mat<f64>) -> Mat<f64> {
    let mut solved = right.clone();
    solve_lower_triangular_in_place(lower, solved.as_mut(), Par::Seq);
    solved
}

/// Hermite cubics between two nodes, integrated by four Gauss points: exact to degree 7.
fn integrate(link: &Link, from_m: f64, to_m: f64) -> Part {
    const POINTS: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let l = to_m - from_m;
    let (mut mass, mut stiffness) = (SMatrix::<f64, 5, 5>::zeros(), SMatrix::<f64, 5, 5>::zeros());
    let mut has_shear = false;
    for (point, weight) in POINTS {
        let s = 0.5 * (1.0 + point);
        let Properties { bending_stiffness, mass_per_length, thick } =
            properties(link, from_m + s * l);
        let (tip, slope) = (s * s * (3.0 - 2.0 * s), 6.0 * (s - s * s) / l);
        let shape = Vector5::new(
            (1.0 - s).powi(2) * (1.0 + 2.0 * s),
            l * s * (1.0 - s).powi(2),
            tip,
            l * s * s * (s - 1.0),
            l * (s - tip),
        );
        let rotation = Vector5::new(
            -slope,
            1.0 - 4.0 * s + 3.0 * s * s,
            slope,
            3.0 * s * s - 2.0 * s,
            -l * slope,
        );
        let bend = (6.0 - 12.0 * s) / (l * l);
        let curvature =
            Vector5::new(-bend, (6.0 * s - 4.0) / l, bend, (6.0 * s - 2.0) / l, -l * bend);
        let dx = 0.5 * l * weight;
        mass += shape * shape.transpose() * (mass_per_length * dx);
        stiffness += curvature * curvature.transpose() * (bending_stiffness * dx);
        if let Some((shear_stiffness, rotary_inertia)) = thick {
            has_shear = true;
            stiffness[(4, 4)] += shear_stiffness * dx;
            mass += rotation * rotation.transpose() * (rotary_inertia * dx);
        }
    }
    // The strain with the least energy, or none.
    let mut strain = SMatrix::<f64, 5, 4>::identity();
    if has_shear {
        for k in 0..4 {
            strain[(4, k)] = -stiffness[(4, k)] / stiffness[(4, 4)];
        }
    }
    let reduced = |whole: SMatrix<f64, 5, 5>| strain.transpose() * whole * strain;
    let (mass, stiffness) = (reduced(mass), reduced(stiffness));
    Part { mass, stiffness }
}

/// What the link is made of at one place.
struct Properties {
    bending_stiffness: f64,
    mass_per_length: f64,
    /// Shear stiffness and rotary inertia.
    thick: Option<(f64, f64)>,
}

/// At a distance from the axis.
fn properties(link: &Link, x_m: f64) -> Properties {
    let mut root_m = link.hub().radius_m;
    for segment in link.segments() {
        if x_m < root_m + segment.length_m {
            let s = (x_m - root_m) / segment.length_m;
            let linear = |taper: Taper| taper.inner + (taper.outer - taper.inner) * s;
            let thick = segment.timoshenko.map(|own| {
                (linear(own.shear_stiffness_n), linear(own.rotary_inertia_per_length_kg_m))
            });
            return Properties {
                bending_stiffness: linear(segment.bending_stiffness_n_m2),
                mass_per_length: linear(segment.mass_per_length_kg_m),
                thick,
            };
        }
        root_m += segment.length_m;
    }
    panic!("{x_m} m lies beyond the tip");
}
