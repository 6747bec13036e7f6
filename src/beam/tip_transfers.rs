//! What the recursion is asked for: transfers per unit of tip motion, at one λ and at many.

use num_complex::Complex64;

use super::mesh::Mesh;

/// Transfers from the tip at one λ, per unit of tip motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipTransfer<S = Complex64> {
    /// `T/a_tip = (A_0[φφ] + I_H)/(L + e_tip)` in kg m (Bayo 1987, eq 20).
    pub inertia_kg_m: S,
    /// Moment at the root, node 0, per tip acceleration in kg m: what the hub exerts on the link.
    pub root_inertia_kg_m: S,
    /// `θ/v_tip = 1/(L + e_tip)` in rad/m (eq 21).
    pub angle_rad_m: S,
    /// `e_tip/(λ (L + e_tip))` in s²: deflection of the tip.
    pub lag_s2: S,
}

impl<S> TipTransfer<S> {
    /// The same with each number changed.
    pub(super) fn map<T>(self, change: impl Fn(S) -> T) -> TipTransfer<T> {
        TipTransfer {
            inertia_kg_m: change(self.inertia_kg_m),
            root_inertia_kg_m: change(self.root_inertia_kg_m),
            angle_rad_m: change(self.angle_rad_m),
            lag_s2: change(self.lag_s2),
        }
    }
}

/// [`TipTransfer`]s at many λ: each quantity by itself, a value for each λ.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipTransfers {
    /// `T/a_tip` in kg m.
    pub inertia_kg_m: Vec<Complex64>,
    /// Moment at the root per tip acceleration in kg m.
    pub root_inertia_kg_m: Vec<Complex64>,
    /// `θ/v_tip` in rad/m.
    pub angle_rad_m: Vec<Complex64>,
    /// Deflection of the tip per tip motion and λ in s².
    pub lag_s2: Vec<Complex64>,
}

impl TipTransfers {
    pub(super) fn with_capacity(len: usize) -> Self {
        let [inertia_kg_m, root_inertia_kg_m, angle_rad_m, lag_s2] =
            [(); 4].map(|()| Vec::with_capacity(len));
        Self { inertia_kg_m, root_inertia_kg_m, angle_rad_m, lag_s2 }
    }

    /// Those at each λ.
    pub fn iter(&self) -> impl Iterator<Item = TipTransfer> {
        (0..self.inertia_kg_m.len()).map(|k| TipTransfer {
            inertia_kg_m: self.inertia_kg_m[k],
            root_inertia_kg_m: self.root_inertia_kg_m[k],
            angle_rad_m: self.angle_rad_m[k],
            lag_s2: self.lag_s2[k],
        })
    }

    pub(super) fn set(&mut self, k: usize, tip: TipTransfer) {
        self.inertia_kg_m[k] = tip.inertia_kg_m;
        self.root_inertia_kg_m[k] = tip.root_inertia_kg_m;
        self.angle_rad_m[k] = tip.angle_rad_m;
        self.lag_s2[k] = tip.lag_s2;
    }

    /// Number of the first λ at which the tip moves by no more than rounding: `|L + e_tip|` below
    /// `(64 + 2n) ε L` on n elements, somewhat more than was found at blocked frequencies. The numbers
    /// there are of any size.
    pub fn first_blocked(&self, mesh: &Mesh) -> Option<usize> {
        let rounding = (64.0 + 2.0 * mesh.elements().len() as f64) * f64::EPSILON;
        let square_m2 = (rounding * mesh.length_m()).powi(2);
        self.angle_rad_m.iter().position(|angle| angle.norm_sqr() * square_m2 > 1.0)
    }
}

impl FromIterator<TipTransfer> for TipTransfers {
    fn from_iter<I: IntoIterator<Item = TipTransfer>>(all: I) -> Self {
        let mut transfers = Self::default();
        for tip in all {
            transfers.inertia_kg_m.push(tip.inertia_kg_m);
            transfers.root_inertia_kg_m.push(tip.root_inertia_kg_m);
            transfers.angle_rad_m.push(tip.angle_rad_m);
            transfers.lag_s2.push(tip.lag_s2);
        }
        transfers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::tip_transfer;
    use crate::beam::undamped::{Units, mesh_in};

    #[test]
    fn a_tip_is_blocked_within_rounding_of_its_length_in_any_units() {
        for exponent in [-20, 0, 20] {
            let mesh = mesh_in(10, Units { length: 2.0_f64.powi(exponent), mass: 1.0 });
            let at_rest = tip_transfer(&mesh, Complex64::ZERO);
            let moved = |epsilons: f64| {
                let moved_m = Complex64::from(epsilons * f64::EPSILON * mesh.length_m());
                TipTransfer { angle_rad_m: moved_m.inv(), ..at_rest }
            };
            let first = |all: &[f64]| {
                let all: TipTransfers = all.iter().map(|epsilons| moved(*epsilons)).collect();
                all.first_blocked(&mesh)
            };
            assert_eq!(first(&[1e9, 85.0, 83.0, 0.1]), Some(2), "length 2^{exponent}");
            assert_eq!(first(&[1e9, 85.0]), None, "length 2^{exponent}");
        }
    }
}
