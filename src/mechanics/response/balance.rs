//! Lagrange's equations at one instant, assembled mass by mass.

use nalgebra::{DMatrix, DVector};

use crate::numeric::dot;

/// A place on the link, its motion, and its change by each coordinate, along x and y.
#[derive(Debug, Clone, Default)]
pub(super) struct Place {
    pub(super) at_m: [f64; 2],
    pub(super) rate_m_s: [f64; 2],
    /// Its acceleration while all rates are constant.
    pub(super) centripetal_m_s2: [f64; 2],
    pub(super) by: [Vec<f64>; 2],
}

impl Place {
    /// A place fixed against all `count` coordinates.
    pub(super) fn fixed(count: usize) -> Self {
        Self { by: [vec![0.0; count], vec![0.0; count]], ..Self::default() }
    }

    /// Acceleration in m/s² for accelerations of the coordinates.
    pub(super) fn acceleration_m_s2(&self, accelerations: &[f64]) -> [f64; 2] {
        [0, 1].map(|axis| self.centripetal_m_s2[axis] + dot(&self.by[axis], accelerations))
    }

    /// Moves the place by coordinate number `own`, at this value and rate, along x and y.
    pub(super) fn slide(&mut self, unit: [f64; 2], (value, rate): (f64, f64), own: usize) {
        for (axis, part) in unit.into_iter().enumerate() {
            self.at_m[axis] += part * value;
            self.rate_m_s[axis] += part * rate;
            self.by[axis][own] += part;
        }
    }

    /// The place at this distance along a direction that the coordinates `turned` turn at a rate.
    pub(super) fn beyond(&self, arm_m: f64, (angle, rate): (f64, f64), turned: &[usize]) -> Self {
        let mut place = self.clone();
        let (x, y) = (arm_m * libm::cos(angle), arm_m * libm::sin(angle));
        let (x_by, y_by) = (-y, x);
        for (axis, (part, by)) in [(x, x_by), (y, y_by)].into_iter().enumerate() {
            place.at_m[axis] += part;
            place.rate_m_s[axis] += by * rate;
            place.centripetal_m_s2[axis] -= part * rate * rate;
            for coordinate in turned {
                place.by[axis][*coordinate] += by;
            }
        }
        place
    }
}

/// Masses along the link, from the axis outward.
pub(super) enum Met<'a> {
    /// A mass in kg.
    Mass(f64),
    /// A rotary inertia in kg m² on the slope of these coordinates.
    Inertia(f64, &'a [usize]),
    /// The end of a piece up to the output, which these coordinates turn.
    End(&'a [usize]),
}

/// Kinetic energy, and that of strain and weight, in J.
#[derive(Debug, Clone, Copy)]
pub(super) struct Energies {
    pub(super) kinetic_j: f64,
    pub(super) potential_j: f64,
}

impl Energies {
    /// Energies of a link or an arm with this strain energy, before its masses.
    pub(super) fn of_strain(strain_j: f64) -> Self {
        Self { kinetic_j: 0.0, potential_j: strain_j }
    }

    /// Adds a mass, or a rotary inertia, at its place.
    pub(super) fn meet(
        &mut self,
        place: &Place,
        met: &Met<'_>,
        (rates, gravity_m_s2): (&[f64], [f64; 2]),
    ) {
        match met {
            Met::Mass(mass_kg) => {
                self.kinetic_j += 0.5 * mass_kg * dot(&place.rate_m_s, &place.rate_m_s);
                self.potential_j -= mass_kg * dot(&gravity_m_s2, &place.at_m);
            }
            Met::Inertia(inertia_kg_m2, turned) => {
                let rate: f64 = turned.iter().map(|i| rates[*i]).sum();
                self.kinetic_j += 0.5 * inertia_kg_m2 * rate * rate;
            }
            Met::End(_) => {}
        }
    }
}

/// Equations `M a = f` at one instant: the mass matrix row by row, and all forces but the motor's.
#[derive(Debug, Clone, Default)]
pub(super) struct Balance {
    pub(super) mass: Vec<f64>,
    pub(super) force: Vec<f64>,
    /// Efforts of the motors with losses, in front of these. The forces contain them.
    pub(super) efforts: Vec<f64>,
}

impl Balance {
    /// Begins with the forces of stiffness and damping, row by row, at coordinates and rates.
    pub(super) fn begin(
        &mut self,
        stiffness: &[f64],
        damping: &[f64],
        (q, rates): (&[f64], &[f64]),
    ) {
        let count = q.len();
        self.mass.clear();
        self.mass.resize(count * count, 0.0);
        self.force.clear();
        self.force.extend((0..count).map(|i| {
            let row = i * count..(i + 1) * count;
            -dot(&stiffness[row.clone()], q) - dot(&damping[row], rates)
        }));
    }

    /// Adds a mass, or a rotary inertia, at its place.
    pub(super) fn meet(&mut self, place: &Place, met: &Met<'_>, gravity_m_s2: [f64; 2]) {
        let (count, Self { mass, force, .. }) = (self.force.len(), self);
        match met {
            Met::Mass(mass_kg) => {
                for (axis, by) in place.by.iter().enumerate() {
                    let pulled = gravity_m_s2[axis] - place.centripetal_m_s2[axis];
                    for (i, own) in by.iter().enumerate() {
                        let own = mass_kg * own;
                        force[i] += own * pulled;
                        let row = &mut mass[i * count..=i * count + i];
                        row.iter_mut().zip(by).for_each(|(entry, other)| *entry += own * other);
                    }
                }
            }
            Met::Inertia(inertia_kg_m2, turned) => {
                for i in *turned {
                    for j in turned.iter().filter(|j| *j <= i) {
                        mass[i * count + j] += inertia_kg_m2;
                    }
                }
            }
            Met::End(_) => {}
        }
    }

    /// Ends with the other half of the masses.
    pub(super) fn end(&mut self) {
        let count = self.force.len();
        for i in 0..count {
            for j in 0..i {
                self.mass[j * count + i] = self.mass[i * count + j];
            }
        }
    }

    /// Accelerations that balance the forces, and in a column for each of these coordinates those by a unit force on it.
    /// `None` where the masses do not determine all of them.
    pub(super) fn accelerations(
        &self,
        by: impl ExactSizeIterator<Item = usize>,
    ) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let count = self.force.len();
        let mass = DMatrix::from_row_slice(count, count, &self.mass).lu();
        let accelerations = mass.solve(&DVector::from_column_slice(&self.force))?;
        let mut units = DMatrix::zeros(count, by.len());
        by.enumerate().for_each(|(column, row)| units[(row, column)] = 1.0);
        let answers = mass.solve(&units)?;
        let is_finite = accelerations.iter().chain(&answers).all(|own| own.is_finite());
        is_finite.then_some((accelerations, answers))
    }
}
