use nalgebra::{Matrix2, Matrix4, Vector4};

use crate::link::{Taper, Timoshenko};

/// One Hermite cubic element with linearly tapered stiffness and mass (Bayo 1987, eqs 8-10).
///
/// Inner end i, outer end j; degrees of freedom `(v_i, φ_i, v_j, φ_j)` with φ = dv/dx; with shear, φ is the
/// rotation of the cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Length l in m.
    pub length_m: f64,
    /// Bending stiffness EI in N m².
    pub bending_stiffness_n_m2: Taper,
    /// Mass per length m̄ in kg/m.
    pub mass_per_length_kg_m: Taper,
    /// Shear and rotary inertia; `None` for a Bernoulli-Euler element.
    pub timoshenko: Option<Timoshenko>,
}

impl Element {
    /// Stiffness, 4×4, symmetric, rank 2. Rows: `v_i` (N), `φ_i` (N m), `v_j`, `φ_j`.
    pub fn stiffness(&self) -> Matrix4<f64> {
        if self.timoshenko.is_none() {
            return self.bending_stiffness();
        }
        let mut stiffness = Matrix4::zeros();
        stiffness.fixed_view_mut::<2, 2>(2, 2).copy_from(&self.relative().k_d);
        let absolute = self.deformations();
        absolute.transpose() * stiffness * absolute
    }

    /// Consistent mass, 4×4, symmetric. Rows: `v_i` (kg), `φ_i` (kg m), `v_j`, `φ_j`.
    pub fn mass(&self) -> Matrix4<f64> {
        if self.timoshenko.is_none() {
            return self.translational_mass();
        }
        let RelativeElement { m_uu, m_ud, m_dd, .. } = self.relative();
        let mut mass = Matrix4::zeros();
        for (at, block) in
            [((0, 0), m_uu), ((0, 2), m_ud), ((2, 0), m_ud.transpose()), ((2, 2), m_dd)]
        {
            mass.fixed_view_mut::<2, 2>(at.0, at.1).copy_from(&block);
        }
        let absolute = self.deformations();
        absolute.transpose() * mass * absolute
    }

    /// The matrix from `(u_i, u_j)` to `(u_i, d)`, 4×4.
    fn deformations(&self) -> Matrix4<f64> {
        let l = self.length_m;
        Matrix4::new(
            1.0, 0.0, 0.0, 0.0, //
            0.0, 1.0, 0.0, 0.0, //
            -1.0, -l, 1.0, 0.0, //
            0.0, -1.0, 0.0, 1.0,
        )
    }

    /// Bending stiffness, 4×4.
    ///
    /// ```text
    /// K_ab = ∫₀ˡ EI N_a'' N_b'' dx                                (Bayo 1987, eqs 7 and 10)
    /// ```
    pub(super) fn bending_stiffness(&self) -> Matrix4<f64> {
        let l = self.length_m;
        let Taper { inner: p, outer: q } = self.bending_stiffness_n_m2;
        let vv = 6.0 * (p + q) / l.powi(3);
        let vi = (4.0 * p + 2.0 * q) / l.powi(2);
        let vj = (2.0 * p + 4.0 * q) / l.powi(2);
        let ij = (p + q) / l;
        Matrix4::from([
            [vv, vi, -vv, vj],
            [vi, (3.0 * p + q) / l, -vi, ij],
            [-vv, -vi, vv, -vj],
            [vj, ij, -vj, (p + 3.0 * q) / l],
        ])
    }

    /// Mass of Hermite's cubic shapes, 4×4.
    ///
    /// ```text
    /// M_ab = ∫₀ˡ m̄ N_a N_b dx                                     (Bayo 1987, eqs 7 and 9)
    /// ```
    fn translational_mass(&self) -> Matrix4<f64> {
        let l = self.length_m;
        let Taper { inner: p, outer: q } = self.mass_per_length_kg_m;
        let (l2, l3) = (l * l, l * l * l);
        let (v_phi_i, v_phi_j) =
            (l2 * (15.0 * p + 7.0 * q) / 420.0, -l2 * (7.0 * p + 15.0 * q) / 420.0);
        let (cross_i, cross_j) =
            (-l2 * (7.0 * p + 6.0 * q) / 420.0, l2 * (6.0 * p + 7.0 * q) / 420.0);
        let vv = 9.0 * l * (p + q) / 140.0;
        let phi_phi = -l3 * (p + q) / 280.0;
        Matrix4::from([
            [l * (10.0 * p + 3.0 * q) / 35.0, v_phi_i, vv, cross_i],
            [v_phi_i, l3 * (5.0 * p + 3.0 * q) / 840.0, cross_j, phi_phi],
            [vv, cross_j, l * (3.0 * p + 10.0 * q) / 35.0, v_phi_j],
            [cross_i, phi_phi, v_phi_j, l3 * (3.0 * p + 5.0 * q) / 840.0],
        ])
    }

    /// Forces in N and moments in N m on the inner and the outer node that do the work of a linear force per length in
    /// N/m: `∫ f N dx`, the force that a mass per length of size f needs for unit acceleration.
    pub fn load(&self, force_n_m: Taper) -> [[f64; 2]; 2] {
        let weighed = Self { mass_per_length_kg_m: force_n_m, ..*self };
        let load = weighed.mass() * Vector4::new(1.0, 0.0, 1.0, 0.0);
        [[load[0], load[1]], [load[2], load[3]]]
    }

    /// This element in relative coordinates.
    pub fn relative(&self) -> RelativeElement {
        let l = self.length_m;
        let (stiffness, mass) = (self.bending_stiffness(), self.translational_mass());
        let Taper { inner: p, outer: q } = self.mass_per_length_kg_m;
        let (l2, l3) = (l * l, l * l * l);
        let slender = RelativeElement {
            length_m: l,
            k_d: stiffness.fixed_view::<2, 2>(2, 2).into(),
            m_dd: mass.fixed_view::<2, 2>(2, 2).into(),
            // M_ij + Rᵀ M_jj, summed by hand to avoid cancellation.
            m_ud: Matrix2::new(
                l * (3.0 * p + 7.0 * q) / 20.0,
                -l2 * (2.0 * p + 3.0 * q) / 60.0, //
                l2 * (5.0 * p + 16.0 * q) / 60.0,
                -l3 * (p + 2.0 * q) / 60.0,
            ),
            // ∫ m̄ (1, s)ᵀ (1, s) ds, the rigid inertia about the inner end.
            m_uu: Matrix2::new(
                l * (p + q) / 2.0,
                l2 * (p + 2.0 * q) / 6.0, //
                l2 * (p + 2.0 * q) / 6.0,
                l3 * (p + 3.0 * q) / 12.0,
            ),
        };
        self.timoshenko.map_or(slender, |timoshenko| timoshenko.sheared(self, &slender))
    }

    /// Two halves of the element.
    pub fn halves(&self) -> [Self; 2] {
        [(0.0, 0.5), (0.5, 1.0)].map(|(from, to)| Self {
            length_m: 0.5 * self.length_m,
            bending_stiffness_n_m2: self.bending_stiffness_n_m2.between(from, to),
            mass_per_length_kg_m: self.mass_per_length_kg_m.between(from, to),
            timoshenko: self.timoshenko.map(|own| own.between(from, to)),
        })
    }

    /// Frequency in rad/s up to which the element follows a bending wave: the relative error (βl)⁴/1440 of a natural
    /// frequency reaches 1 % there; with shear, its sum with `ω² l² m̄/(24 κGA)`.
    ///
    /// Infinite for an element without mass, because its shapes are then exact.
    pub fn resolved_frequency_rad_s(&self) -> f64 {
        let stiffness = self.bending_stiffness_n_m2.inner.min(self.bending_stiffness_n_m2.outer);
        let mass = self.mass_per_length_kg_m.inner.max(self.mass_per_length_kg_m.outer);
        let bending = (14.4 * stiffness / mass).sqrt() / self.length_m.powi(2);
        self.timoshenko.map_or(bending, |own| {
            let Taper { inner, outer } = own.shear_stiffness_n;
            let shear = (0.24 * inner.min(outer) / mass).sqrt() / self.length_m;
            // Both errors grow with the square of the frequency.
            bending / libm::hypot(1.0, bending / shear)
        })
    }
}

/// An element in relative coordinates: the motion `u_i = (v_i, φ_i)` of its inner end and the deformation
/// `d = u_j − R u_i` of its outer end, seen from the inner end's tangent.
///
/// Stiffness acts on d alone, so that rigid motion at low frequency loses no digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeElement {
    /// Length l in m; the rigid transfer is `R = [[1, l], [0, 1]]`.
    pub length_m: f64,
    /// `K_d`, 2×2, symmetric: the jj block of the stiffness.
    pub k_d: Matrix2<f64>,
    /// `M_dd = M_jj`, 2×2, symmetric.
    pub m_dd: Matrix2<f64>,
    /// `M_ud = M_ij + Rᵀ M_jj`, 2×2.
    pub m_ud: Matrix2<f64>,
    /// `M_uu = M_ii + M_ij R + Rᵀ M_ji + Rᵀ M_jj R`, 2×2, symmetric: rigid inertia about i.
    pub m_uu: Matrix2<f64>,
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    const ELEMENT: Element = Element {
        length_m: 0.7,
        bending_stiffness_n_m2: Taper { inner: 5.0, outer: 3.0 },
        mass_per_length_kg_m: Taper { inner: 0.8, outer: 1.4 },
        timoshenko: None,
    };

    /// ∫₀ˡ f(x) dx by Gauss-Legendre with five points, exact to degree 9.
    fn integral(f: impl Fn(f64) -> Matrix4<f64>) -> Matrix4<f64> {
        let nodes = [
            (0.0, 128.0 / 225.0),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        ];
        let l = ELEMENT.length_m;
        let mut sum = Matrix4::zeros();
        for (node, weight) in nodes {
            let signs: &[f64] = if node == 0.0 { &[1.0] } else { &[-1.0, 1.0] };
            for sign in signs {
                sum += f(0.5 * l * (1.0 + sign * node)) * (0.5 * l * weight);
            }
        }
        sum
    }

    fn close<const R: usize, const C: usize>(a: &SMatrix<f64, R, C>, b: &SMatrix<f64, R, C>) {
        assert!((a - b).abs().max() < 1e-14 * a.abs().max(), "{a} is not {b}");
    }

    #[test]
    fn matrices_are_the_integrals_of_hermite_cubics() {
        let l = ELEMENT.length_m;
        let shapes = |x: f64| {
            let s = x / l;
            Vector4::new(
                1.0 - 3.0 * s * s + 2.0 * s.powi(3),
                l * (s - 2.0 * s * s + s.powi(3)),
                3.0 * s * s - 2.0 * s.powi(3),
                l * (s.powi(3) - s * s),
            )
        };
        let curvatures = |x: f64| {
            let s = x / l;
            Vector4::new(
                (12.0 * s - 6.0) / (l * l),
                (6.0 * s - 4.0) / l,
                (6.0 - 12.0 * s) / (l * l),
                (6.0 * s - 2.0) / l,
            )
        };
        let mass = |x: f64| ELEMENT.mass_per_length_kg_m.at(x / l);
        let stiffness = |x: f64| ELEMENT.bending_stiffness_n_m2.at(x / l);
        close(&ELEMENT.mass(), &integral(|x| shapes(x) * shapes(x).transpose() * mass(x)));
        let bending = |x: f64| curvatures(x) * curvatures(x).transpose() * stiffness(x);
        close(&ELEMENT.stiffness(), &integral(bending));
    }

    #[test]
    fn relative_coordinates_are_a_congruence_of_the_element() {
        let l = ELEMENT.length_m;
        // (v_i, φ_i, v_j, φ_j) = C (v_i, φ_i, d_v, d_φ)
        let c = Matrix4::new(
            1.0, 0.0, 0.0, 0.0, //
            0.0, 1.0, 0.0, 0.0, //
            1.0, l, 1.0, 0.0, //
            0.0, 1.0, 0.0, 1.0,
        );
        let relative = ELEMENT.relative();
        let mass = c.transpose() * ELEMENT.mass() * c;
        close(&relative.m_uu, &mass.fixed_view::<2, 2>(0, 0).into());
        close(&relative.m_ud, &mass.fixed_view::<2, 2>(0, 2).into());
        close(&relative.m_dd, &mass.fixed_view::<2, 2>(2, 2).into());
        let mut stiffness = Matrix4::zeros();
        stiffness.fixed_view_mut::<2, 2>(2, 2).copy_from(&relative.k_d);
        close(&(c.transpose() * ELEMENT.stiffness() * c), &stiffness);
    }

    #[test]
    fn a_wave_is_followed_up_to_one_per_cent_of_a_natural_frequency() {
        let omega_rad_s = ELEMENT.resolved_frequency_rad_s();
        // The wave is shortest where the element is softest and heaviest.
        let wave_number = (1.4 * omega_rad_s * omega_rad_s / 3.0).sqrt().sqrt();
        let error = (wave_number * 0.7).powi(4) / 1440.0;
        assert!((error / 0.01 - 1.0).abs() < 1e-14, "{error}");
        let massless = Element { mass_per_length_kg_m: Taper::constant(0.0), ..ELEMENT };
        assert!(massless.resolved_frequency_rad_s().is_infinite());
    }

    #[test]
    fn two_halves_carry_the_rigid_inertia_of_the_whole() {
        let whole = ELEMENT.relative().m_uu;
        let [a, b] = ELEMENT.halves().map(|half| half.relative().m_uu);
        let r = Matrix2::new(1.0, 0.35, 0.0, 1.0);
        close(&whole, &(a + r.transpose() * b * r));
    }
}
