//! The element with shear and rotary inertia.

use nalgebra::{Matrix2, RowVector2, Vector2};

use super::element::{Element, RelativeElement};
use crate::link::{Taper, Timoshenko};

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
