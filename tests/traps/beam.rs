//! The stepped Bernoulli-Euler link in closed form, piece by piece, without elements.
//!
//! At one frequency, with the joint moved by 1 and v = r + ω²u, r the rigid link (x of a hub, 1 of a carriage),
//!
//! ```text
//! EI κ v'''' = m μ ω² v          κ, μ: complex factors of stiffness and mass
//! N = −EI κ v'',  S = EI κ v'''   moment and force of the inner on the outer part
//! S jumps by −ω² m_p μ v and N by −ω² J_p μ v' at a body
//! ```
//!
//! Two ways to the same solution: at low frequency u and its three derivatives are carried from
//! root to tip by Krylov's power series, in which nothing cancels and nothing is singular at ω = 0;
//! at high frequency v is a sum of four waves in every piece, each decaying from the end where it
//! is largest, and the conditions between the pieces are one banded linear system.

use num_complex::Complex64;

use super::link::{Joint, Link, Payload, Piece};

/// Σ|β|l up to which the series is used.
pub(crate) const SERIES_UP_TO: f64 = 4.0;

/// ω² and the factors of stiffness and mass at one frequency.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frequency {
    pub(crate) square: Complex64,
    pub(crate) stiffness: Complex64,
    pub(crate) mass: Complex64,
}

/// The link cut into pieces, and the places that are looked at.
#[derive(Debug, Clone)]
pub(crate) struct Beam {
    pieces: Vec<Piece>,
    joint: Joint,
    hub_kg_m2: f64,
    radius_m: f64,
    /// Slope at the root per moment there, in rad/(N m).
    root_compliance: f64,
    payload: Payload,
    length_m: f64,
    /// Piece and place within it of every station; the output is the last one.
    stations: Vec<(usize, f64)>,
    stations_m: Vec<f64>,
}

/// The link under a unit of its joint.
#[derive(Debug, Clone)]
pub(crate) struct Turned {
    /// v at the output.
    pub(crate) tip_m: Complex64,
    /// u at the output, u = (v − r)/ω².
    pub(crate) tip_u: Complex64,
    /// −T/ω², of a carriage −F/ω².
    pub(crate) inertia_kg_m2: Complex64,
    /// u at the stations.
    pub(crate) u: Vec<Complex64>,
    /// −N/ω² at the stations.
    pub(crate) moment: Vec<Complex64>,
}

impl Beam {
    /// The link with stations at these distances from the axis.
    pub(crate) fn new(link: &Link, fineness: usize, stations_m: &[f64]) -> Self {
        let pieces = link.pieces(fineness);
        let stations_m = [stations_m, &[link.output_m()]].concat();
        let stations = stations_m.iter().map(|x| {
            let mut within = x - link.radius_m;
            let mut piece = 0;
            while piece + 1 < pieces.len() && within > pieces[piece].length_m + 1e-12 {
                within -= pieces[piece].length_m;
                piece += 1;
            }
            (piece, within.clamp(0.0, pieces[piece].length_m))
        });
        Self {
            stations: stations.collect(),
            stations_m,
            pieces,
            joint: link.joint,
            root_compliance: 1.0 / link.root_n_m_rad,
            hub_kg_m2: link.hub_kg_m2,
            radius_m: link.radius_m,
            payload: link.payload,
            length_m: link.length_m(),
        }
    }

    /// The link with its tip as output.
    pub(crate) fn to_tip(&self) -> Self {
        let mut own = self.clone();
        let (last, count) = (own.pieces.len() - 1, own.stations.len() - 1);
        own.stations[count] = (last, own.pieces[last].length_m);
        own.stations_m[count] = own.length_m;
        own
    }

    /// Displacement of the rigid link at the output per unit of the joint.
    pub(crate) fn rigid_output(&self) -> f64 {
        self.rigid(self.stations_m[self.stations_m.len() - 1])
    }

    /// Displacements of the rigid link at the stations per unit of the joint.
    pub(crate) fn rigid_stations(&self) -> impl Iterator<Item = f64> {
        let own = &self.stations_m[..self.stations_m.len() - 1];
        own.iter().map(|x| self.rigid(*x))
    }

    fn rigid(&self, x_m: f64) -> f64 {
        self.joint.rigid(x_m)[0]
    }

    /// Inertia of the rigid link: rotary about the axis of a hub, the whole mass on a carriage.
    pub(crate) fn rigid_inertia_kg_m2(&self) -> f64 {
        let mut from = self.radius_m;
        let mut inertia = self.hub_kg_m2;
        let body = |at_m: f64, mass_kg: f64, inertia_kg_m2: f64| {
            let [v, phi] = self.joint.rigid(at_m);
            mass_kg * v * v + inertia_kg_m2 * phi * phi
        };
        for piece in &self.pieces {
            let to = from + piece.length_m;
            let (mass_kg, middle) = (piece.mass_kg_m * piece.length_m, 0.5 * (from + to));
            inertia += body(middle, mass_kg, mass_kg * piece.length_m * piece.length_m / 12.0);
            inertia += body(to, piece.end_kg, piece.end_kg_m2);
            from = to;
        }
        let Payload { mass_kg, inertia_kg_m2, offset_m } = self.payload;
        inertia + body(from + offset_m, mass_kg, inertia_kg_m2)
    }

    /// Σ|β|l of the link.
    pub(crate) fn waves(&self, at: Frequency) -> f64 {
        self.pieces.iter().map(|piece| at.wave_number(piece).norm() * piece.length_m).sum()
    }

    pub(crate) fn turned(&self, at: Frequency) -> Turned {
        if self.waves(at) <= SERIES_UP_TO { self.by_series(at) } else { self.by_waves(at) }
    }

    /// The solution by Krylov's series.
    pub(crate) fn by_series(&self, at: Frequency) -> Turned {
        // u as it follows from the root's moment and force: the part of neither, and of each.
        let columns = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|root| self.carried(at, root));
        let Payload { mass_kg, inertia_kg_m2, offset_m: c } = self.payload;
        let (length, last) = (self.length_m, self.pieces.len() - 1);
        // S_L + m_t'(V + cΦ) = 0 and N_L + J'Φ + c m_t'(V + cΦ) = 0, both divided by ω².
        let [at_tip, turned] = self.joint.rigid(length);
        let residual = |column: &Carried, of_rigid: f64| {
            let [u, slope, n, s] = column.ends[last];
            let v = of_rigid * at_tip + at.square * u;
            let phi = of_rigid * turned + at.square * slope;
            let force = mass_kg * at.mass * (v + c * phi);
            [s + force, n + inertia_kg_m2 * at.mass * phi + c * force]
        };
        let free = residual(&columns[0], 1.0);
        let (of_n, of_s) = (residual(&columns[1], 0.0), residual(&columns[2], 0.0));
        let determinant = of_n[0] * of_s[1] - of_n[1] * of_s[0];
        let n = (of_s[0] * free[1] - of_s[1] * free[0]) / determinant;
        let s = (of_n[1] * free[0] - of_n[0] * free[1]) / determinant;
        let sum = |of: &dyn Fn(&Carried) -> Complex64| {
            of(&columns[0]) + n * of(&columns[1]) + s * of(&columns[2])
        };
        let count = self.stations.len() - 1;
        let at_station = |i: usize, k: usize| sum(&|column| column.stations[i][k]);
        let tip_u = at_station(count, 0);
        Turned {
            tip_m: self.rigid_output() + at.square * tip_u,
            tip_u,
            inertia_kg_m2: self.inertia_of_root(at, n, s),
            u: (0..count).map(|i| at_station(i, 0)).collect(),
            moment: (0..count).map(|i| -at_station(i, 1)).collect(),
        }
    }

    /// −T/ω², or −F/ω², from N/ω² and S/ω² at the root.
    fn inertia_of_root(&self, at: Frequency, n: Complex64, s: Complex64) -> Complex64 {
        let [v, phi] = self.joint.rigid(self.radius_m);
        self.hub_kg_m2 * at.mass - phi * n - v * s
    }

    /// u, u', N/ω² and S/ω² at the end of every piece; u and N/ω² at the stations. The first
    /// column carries the rigid rotation's own load, the others the root's moment or force alone.
    fn carried(&self, at: Frequency, root: [f64; 2]) -> Carried {
        let loaded = if root == [0.0, 0.0] { 1.0 } else { 0.0 };
        let zero = Complex64::ZERO;
        let sprung = -root[0] * self.root_compliance / at.stiffness;
        let mut state = [zero, sprung, root[0].into(), root[1].into()];
        let mut found =
            Carried { ends: Vec::new(), stations: vec![[zero; 2]; self.stations.len()] };
        let mut x = self.radius_m;
        for (k, piece) in self.pieces.iter().enumerate() {
            let [lift, slope] = self.joint.rigid(x).map(|own| loaded * own);
            for ((own, within), station) in self.stations.iter().zip(&mut found.stations) {
                if *own == k {
                    let [u, _, n, _] = at.advanced(piece, state, *within, lift, slope);
                    *station = [u, n];
                }
            }
            state = at.advanced(piece, state, piece.length_m, lift, slope);
            x += piece.length_m;
            let [lift, slope] = self.joint.rigid(x).map(|own| loaded * own);
            let (v, phi) = (lift + at.square * state[0], slope + at.square * state[1]);
            state[3] += piece.end_kg * at.mass * v;
            state[2] += piece.end_kg_m2 * at.mass * phi;
            found.ends.push(state);
        }
        found
    }

    /// The solution by decaying waves.
    pub(crate) fn by_waves(&self, at: Frequency) -> Turned {
        let root = (self.joint.rigid(self.radius_m), self.root_compliance);
        let system = super::waves::Waves::new(&self.pieces, self.payload, root, at);
        let coefficients = system.solved();
        let value = |piece: usize, within: f64, order: usize| {
            let own = &coefficients[4 * piece..4 * piece + 4];
            let waves = system.waves(piece, within, order);
            own.iter().zip(waves).map(|(c, w)| c * w).sum::<Complex64>()
        };
        let count = self.stations.len() - 1;
        let (last, within) = self.stations[count];
        let tip_m = value(last, within, 0);
        let stiffness = |piece: usize| self.pieces[piece].stiffness_n_m2 * at.stiffness;
        let (n, s) = (-stiffness(0) * value(0, 0.0, 2), stiffness(0) * value(0, 0.0, 3));
        let u = self.stations[..count].iter().zip(self.rigid_stations());
        let moment = self.stations[..count].iter();
        Turned {
            tip_m,
            tip_u: (tip_m - self.rigid_output()) / at.square,
            inertia_kg_m2: self.inertia_of_root(at, n / at.square, s / at.square),
            u: u.map(|((k, s), rigid)| (value(*k, *s, 0) - rigid) / at.square).collect(),
            moment: moment.map(|(k, s)| stiffness(*k) * value(*k, *s, 2) / at.square).collect(),
        }
    }
}

struct Carried {
    ends: Vec<[Complex64; 4]>,
    stations: Vec<[Complex64; 2]>,
}

impl Frequency {
    /// ω of a link with hysteretic damping.
    #[cfg(test)]
    pub(crate) fn hysteretic(omega_rad_s: f64, ratio: f64) -> Self {
        Self {
            square: (omega_rad_s * omega_rad_s).into(),
            stiffness: Complex64::new(1.0, 2.0 * ratio),
            mass: Complex64::ONE,
        }
    }

    /// β⁴ of a piece.
    fn fourth(self, piece: &Piece) -> Complex64 {
        piece.mass_kg_m * self.mass * self.square / (piece.stiffness_n_m2 * self.stiffness)
    }

    pub(crate) fn wave_number(self, piece: &Piece) -> Complex64 {
        self.fourth(piece).sqrt().sqrt()
    }

    /// u, u', N/ω² and S/ω² after a distance s, of a piece that begins where the rigid rotation
    /// is `lift` and has the slope `slope`.
    fn advanced(
        self,
        piece: &Piece,
        [u, slope_u, n, s]: [Complex64; 4],
        distance: f64,
        lift: f64,
        slope: f64,
    ) -> [Complex64; 4] {
        let q = self.fourth(piece);
        let k = krylov(q, distance);
        let stiffness = piece.stiffness_n_m2 * self.stiffness;
        let load = piece.mass_kg_m * self.mass / stiffness;
        let (curvature, third) = (-n / stiffness, s / stiffness);
        // The derivative of K_0 is q K_3, that of K_n is K_{n−1}.
        let (p, r) = (load * lift, load * slope);
        [
            u * k[0] + slope_u * k[1] + curvature * k[2] + third * k[3] + p * k[4] + r * k[5],
            u * q * k[3] + slope_u * k[0] + curvature * k[1] + third * k[2] + p * k[3] + r * k[4],
            -stiffness
                * (q * (u * k[2] + slope_u * k[3])
                    + curvature * k[0]
                    + third * k[1]
                    + p * k[2]
                    + r * k[3]),
            stiffness
                * (q * (u * k[1] + slope_u * k[2] + curvature * k[3])
                    + third * k[0]
                    + p * k[1]
                    + r * k[2]),
        ]
    }
}

/// `K_n(s) = Σ_j q^j s^(4j+n)/(4j+n)!` for n = 0 … 5.
fn krylov(q: Complex64, s: f64) -> [Complex64; 6] {
    let mut terms = [Complex64::ZERO; 6];
    let mut power = 1.0;
    for (n, term) in terms.iter_mut().enumerate() {
        *term = Complex64::from(power);
        power *= s / (n + 1) as f64;
    }
    let mut sums = terms;
    let step = q * s.powi(4);
    for j in 1..24_u32 {
        for (n, (term, sum)) in terms.iter_mut().zip(&mut sums).enumerate() {
            let first = f64::from(4 * j) + n as f64 - 3.0;
            *term *= step / (first * (first + 1.0) * (first + 2.0) * (first + 3.0));
            *sum += *term;
        }
        if terms[0].norm() <= 1e-18 * sums[0].norm() {
            break;
        }
    }
    sums
}
