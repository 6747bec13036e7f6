use nalgebra::{Matrix2, Matrix4, RowVector2, Vector2, Vector4};

use crate::link::{Taper, Timoshenko};

/// One Hermite cubic element with linearly tapered stiffness and mass (Bayo 1987, eqs 8-10), or the spring of the root.
///
/// Inner end i, outer end j; degrees of freedom `(v_i, φ_i, v_j, φ_j)` with φ = dv/dx; with shear, φ is the
/// rotation of the cross-section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Length l in m; 0 for a rotational spring without mass.
    pub length_m: f64,
    /// Bending stiffness EI in N m²; the stiffness k of a spring in N m/rad.
    pub bending_stiffness_n_m2: Taper,
    /// Mass per length m̄ in kg/m.
    pub mass_per_length_kg_m: Taper,
    /// Shear and rotary inertia; `None` for a Bernoulli-Euler element.
    pub timoshenko: Option<Timoshenko>,
}

/// Stiffness across a spring over k in 1/m²: no number of a link is as large, so that its ends stay together.
const RIGID_PER_M2: f64 = (1_u128 << 100) as f64;

impl Element {
    /// A rotational spring without length and mass.
    pub fn spring(stiffness_n_m_rad: f64) -> Self {
        Self {
            length_m: 0.0,
            bending_stiffness_n_m2: Taper::constant(stiffness_n_m_rad),
            mass_per_length_kg_m: Taper::constant(0.0),
            timoshenko: None,
        }
    }

    /// True for a rotational spring.
    pub fn is_spring(&self) -> bool {
        self.length_m == 0.0
    }

    /// Stiffness, 4×4, symmetric, rank 2; of a spring on the slopes alone. Rows: `v_i` (N), `φ_i` (N m), `v_j`, `φ_j`.
    pub fn stiffness(&self) -> Matrix4<f64> {
        if self.is_spring() {
            let slopes = Vector4::new(0.0, -1.0, 0.0, 1.0);
            return slopes * slopes.transpose() * self.bending_stiffness_n_m2.inner;
        }
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
        let mass = self.translational_mass();
        let k_d = if self.is_spring() {
            Matrix2::from_diagonal(&Vector2::new(RIGID_PER_M2, 1.0))
                * self.bending_stiffness_n_m2.inner
        } else {
            self.bending_stiffness().fixed_view::<2, 2>(2, 2).into()
        };
        let Taper { inner: p, outer: q } = self.mass_per_length_kg_m;
        let (l2, l3) = (l * l, l * l * l);
        let slender = RelativeElement {
            length_m: l,
            k_d,
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

impl Timoshenko {
    /// Adds shear and rotary inertia to a slender element in relative coordinates.
    ///
    /// The shear strain γ is constant along the element; the rotation ψ of the cross-section follows Hermite's cubic h
    /// through d less the shear. The least energy gives γ; for a uniform element these are the exact static shapes
    /// (Przemieniecki, *Theory of Matrix Structural Analysis*, 1968, sections 5.6 and 11.8).
    ///
    /// ```text
    /// v = v_i + s φ_i + hᵀ d' + s γ,   ψ = φ_i + h'ᵀ d',   h = (3t² − 2t³, l (t³ − t²)),   t = s/l
    /// γ = cᵀ d,   c = (K_vv, K_vφ)/(S + l K_vv),   S = mean κGA,   d' = C d = (d_v − l γ, d_φ)
    /// M = ∫ m̄ v v + ρI ψ ψ ds
    /// ```
    ///
    /// Static shapes have a constant shear force in an element. They miss the energy `∫ (m̄ω²l)² v²/(24 κGA) ds`:
    /// frequencies converge with order 2. The energy is of order ω⁴; no K and M without inner unknowns can contain it.
    pub(super) fn sheared(&self, element: &Element, slender: &RelativeElement) -> RelativeElement {
        let l = element.length_m;
        let Taper { inner: p, outer: q } = element.bending_stiffness_n_m2;
        let Taper { inner: j_i, outer: j_j } = self.rotary_inertia_per_length_kg_m;
        let (k, m_ud, m_uu) = (&slender.k_d, &slender.m_ud, &slender.m_uu);
        let shear = self.shear_stiffness_n.mean();
        let sum = shear + l * k.m11;
        // det K by hand, to avoid cancellation in a short element.
        let determinant = 2.0 * (p * p + 4.0 * p * q + q * q) / l.powi(4);
        let k_d = Matrix2::new(
            k.m11 * (shear / sum),
            k.m12 * (shear / sum), //
            k.m21 * (shear / sum),
            (k.m22 * shear + l * determinant) / sum,
        );
        let c = RowVector2::new(k.m11, k.m12) / sum;
        let bent = Matrix2::new(shear / sum, -l * c[1], 0.0, 1.0);
        // ∫ m̄ s (1, s) ds and ∫ m̄ s hᵀ ds.
        let first = Vector2::new(m_uu.m12, m_uu.m22);
        let along = RowVector2::new(m_ud.m21, m_ud.m22) * bent;
        // ∫ ρI ds, ∫ ρI h' ds, ∫ ρI h' h'ᵀ ds.
        let whole = 0.5 * l * (j_i + j_j);
        let turned = RowVector2::new(0.5 * (j_i + j_j), l * (j_j - j_i) / 12.0) * bent;
        let both = Matrix2::new(
            0.6 * (j_i + j_j) / l,
            -0.1 * j_i, //
            -0.1 * j_i,
            l * (j_i + 3.0 * j_j) / 30.0,
        );
        let crossed = along.transpose() * c;
        RelativeElement {
            length_m: l,
            k_d,
            m_dd: bent.transpose() * (slender.m_dd + both) * bent
                + crossed
                + crossed.transpose()
                + c.transpose() * c * m_uu.m22,
            m_ud: m_ud * bent + first * c + Vector2::y() * turned,
            m_uu: m_uu + Matrix2::new(0.0, 0.0, 0.0, whole),
        }
    }
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

#[cfg(test)]
mod tests_with_shear {
    use nalgebra::{Matrix4, SMatrix, Vector4};

    use super::*;

    const ELEMENT: Element = Element {
        length_m: 0.7,
        bending_stiffness_n_m2: Taper { inner: 5.0, outer: 3.0 },
        mass_per_length_kg_m: Taper { inner: 0.8, outer: 1.4 },
        timoshenko: Some(Timoshenko {
            shear_stiffness_n: Taper { inner: 90.0, outer: 50.0 },
            rotary_inertia_per_length_kg_m: Taper { inner: 0.07, outer: 0.03 },
        }),
    };

    fn close<const R: usize, const C: usize>(a: &SMatrix<f64, R, C>, b: &SMatrix<f64, R, C>) {
        assert!((a - b).abs().max() < 1e-13 * a.abs().max(), "{a} is not {b}");
    }

    /// Shapes of v and ψ over `(v_i, φ_i, v_j, φ_j)` at a fraction t of the length.
    fn shapes(element: &Element, t: f64) -> [Vector4<f64>; 2] {
        let l = element.length_m;
        let k = element.bending_stiffness();
        let shear = element.timoshenko.unwrap().shear_stiffness_n.mean();
        // γ minimises ½ (u − lγ e)ᵀ K (u − lγ e) + ½ S l γ², with e the displacement of the outer end.
        let strain = k.column(2) / (shear + l * k.m33);
        let cubic = Vector4::new(
            1.0 - 3.0 * t * t + 2.0 * t.powi(3),
            l * (t - 2.0 * t * t + t.powi(3)),
            3.0 * t * t - 2.0 * t.powi(3),
            l * (t.powi(3) - t * t),
        );
        let slope = Vector4::new(
            6.0 * (t * t - t) / l,
            1.0 - 4.0 * t + 3.0 * t * t,
            6.0 * (t - t * t) / l,
            3.0 * t * t - 2.0 * t,
        );
        let v = cubic + strain * (l * t - l * cubic[2]);
        let psi = slope - strain * (l * slope[2]);
        [v, psi]
    }

    /// ∫₀ˡ f ds by Simpson's rule on 2000 pieces: exact to 1e-14.
    fn integral(f: impl Fn(f64) -> Matrix4<f64>) -> Matrix4<f64> {
        let pieces = 2000;
        let at = |k: i32| f64::from(k) / f64::from(pieces);
        let sum = (0..=pieces).fold(Matrix4::zeros(), |sum, k| {
            let weight = match k {
                0 => 1.0,
                k if k == pieces => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            sum + f(at(k)) * weight
        });
        sum * (ELEMENT.length_m / f64::from(pieces) / 3.0)
    }

    #[test]
    fn mass_is_the_integral_of_the_shapes() {
        let own = ELEMENT.timoshenko.unwrap();
        let mass = integral(|t| {
            let [v, psi] = shapes(&ELEMENT, t);
            v * v.transpose() * ELEMENT.mass_per_length_kg_m.at(t)
                + psi * psi.transpose() * own.rotary_inertia_per_length_kg_m.at(t)
        });
        close(&ELEMENT.mass(), &mass);
        let rigid = Vector4::new(1.0, 0.0, 1.0, 0.0);
        assert!((ELEMENT.stiffness() * rigid).abs().max() < 1e-13);
    }

    /// Przemieniecki's matrix with Φ = 12 EI/(κGA l²), thin and thick, at values without cancellation.
    #[test]
    fn stiffness_of_a_uniform_element_is_the_published_one() {
        for shear in [1e-3, 10.0, 1e9] {
            let (l, ei) = (0.7, 5.0);
            let own = Timoshenko {
                shear_stiffness_n: Taper::constant(shear),
                rotary_inertia_per_length_kg_m: Taper::constant(0.0),
            };
            let element = Element {
                bending_stiffness_n_m2: Taper::constant(ei),
                timoshenko: Some(own),
                ..ELEMENT
            };
            let phi = 12.0 * ei / (shear * l * l);
            let published = Matrix2::new(12.0, -6.0 * l, -6.0 * l, (4.0 + phi) * l * l)
                * (ei / (l.powi(3) * (1.0 + phi)));
            close(&element.relative().k_d, &published);
        }
    }

    /// `K_d⁻¹` is the flexibility of the clamped element: bending, plus shear in the displacement.
    #[test]
    fn a_short_element_keeps_its_digits() {
        let element =
            Element { length_m: 1e-5, bending_stiffness_n_m2: Taper::constant(5.0), ..ELEMENT };
        let k = element.relative().k_d;
        let load = Vector2::new(3.0, 0.2);
        let (l, ei, shear) = (1e-5, 5.0, 70.0);
        let bent = Vector2::new(
            load[0] * (l * l * l / (3.0 * ei) + l / shear) + load[1] * l * l / (2.0 * ei),
            load[0] * l * l / (2.0 * ei) + load[1] * l / ei,
        );
        let found = k.try_inverse().unwrap() * load;
        close(&found, &bent);
    }

    #[test]
    fn without_shear_and_rotary_inertia_it_is_the_slender_element() {
        let slender = Element { timoshenko: None, ..ELEMENT }.relative();
        let own = Timoshenko {
            shear_stiffness_n: Taper::constant(1e18),
            rotary_inertia_per_length_kg_m: Taper::constant(0.0),
        };
        let stiff = Element { timoshenko: Some(own), ..ELEMENT }.relative();
        close(&stiff.k_d, &slender.k_d);
        close(&stiff.m_dd, &slender.m_dd);
        close(&stiff.m_ud, &slender.m_ud);
        close(&stiff.m_uu, &slender.m_uu);
    }
}
