//! Amplitudes of all quantities over the band, and their size over time.

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::analysis::{Analysis, Unwatched, Watch};
use super::spectra::{DrivenModel, HubSpectra, MotorSpectra};
use crate::beam::{Mesh, MeshPlan, NodalQuantity};
use crate::model::ModelError;
use crate::motion::TipPeriod;
use crate::numeric::{FourierPair, largest};

/// Most nodes with measured displacements and moments. Waves between two of them are too short for the mesh.
const MOST_NODES: usize = 8;

/// Measured quantities besides torques and the hub's angle and rate.
pub(super) struct Probes {
    /// Nodes with measured displacements and moments.
    pub(super) nodes: Vec<usize>,
    /// True to measure quantities of tables over time: displacements of the nodes, the hub's acceleration.
    tables: bool,
    /// True to measure bending moments along the link.
    moments: bool,
}

impl Probes {
    /// Evenly spread nodes of a mesh without the tip, which moves as wanted on every mesh.
    pub(super) fn of(mesh: &Mesh, plan: &MeshPlan, analysis: &Analysis) -> Self {
        // An automatic mesh must not depend on the choice of measured quantities.
        let tables = analysis.measures_tables() || plan.is_automatic();
        let inner = mesh.nodes_m().len() - 1;
        let count = inner.min(MOST_NODES);
        // Includes the root: moments are largest there, and it moves where the hub has a radius.
        let nodes = (0..count).map(|k| k * inner / count).collect();
        Self { nodes, tables, moments: analysis.measures_moments() }
    }

    /// The same places on the mesh whose elements are half as long.
    pub(super) fn refined(&self) -> Self {
        Self { nodes: self.nodes.iter().map(|node| 2 * node).collect(), ..*self }
    }
}

impl Probes {
    /// The same quantities at other nodes.
    pub(super) fn at(&self, nodes: &[usize]) -> Self {
        Self { nodes: nodes.to_vec(), ..*self }
    }

    /// Keeps the measured quantities of some values.
    pub(super) fn measured(&self, of: PerQuantity<f64>) -> PerQuantity<f64> {
        PerQuantity {
            hub_acceleration: of.hub_acceleration.filter(|_| self.tables),
            displacement: of.displacement.filter(|_| self.tables),
            bending_moment: of.bending_moment.filter(|_| self.moments),
            ..of
        }
    }
}

/// Amplitudes of all quantities over the band on one mesh.
pub(super) struct Amplitudes {
    pub(super) hub: HubSpectra,
    /// Hub rate in rad/s, and acceleration in rad/s² where tables count, less those of a rigid link.
    pub(super) hub_rate_rad_s: Vec<Complex64>,
    pub(super) hub_acceleration_rad_s2: Option<Vec<Complex64>>,
    pub(super) motor: Option<MotorSpectra>,
    /// Displacement less that of a rigid link, `v − x v_tip/L`, at the probes in m, where tables count.
    pub(super) displacement_m: Option<Vec<Vec<Complex64>>>,
    /// Bending moment at the probes in N m, where moments count.
    pub(super) moment_n_m: Option<Vec<Vec<Complex64>>>,
    pair: FourierPair,
}

impl Amplitudes {
    /// Solves for the amplitudes of all quantities.
    ///
    /// # Errors
    /// As [`DrivenModel::hub_spectra`].
    pub(super) fn of(driven: DrivenModel<'_>, probes: &Probes) -> Result<Self, ModelError> {
        let Probes { tables, moments, .. } = *probes;
        let nodal = usize::from(tables) + usize::from(moments);
        driven.begin(nodal.max(1), 0);
        // The hub takes hardly any time compared to the nodes.
        let watch: &dyn Watch = if nodal > 0 { &Unwatched } else { driven.watch };
        let hub = DrivenModel { watch, ..driven }.hub_spectra()?;
        let motor = driven.motor_spectra(&hub);
        let excess = || hub.excess_angle_rad.iter().zip(driven.omegas_rad_s());
        let hub_rate_rad_s = excess().map(|(e, omega)| e * Complex64::new(0.0, *omega)).collect();
        let accelerations = || excess().map(|(e, omega)| -e * (omega * omega)).collect();
        let hub_acceleration_rad_s2 = tables.then(accelerations);
        let displacements = || {
            let nodes_m = driven.model.mesh().nodes_m();
            let mut rows = driven.nodal_spectra(&probes.nodes, NodalQuantity::Deflection);
            for (row, node) in rows.iter_mut().zip(&probes.nodes) {
                for (deflection, angle) in row.iter_mut().zip(&hub.excess_angle_rad) {
                    *deflection += angle * nodes_m[*node];
                }
            }
            rows
        };
        let displacement_m = tables.then(displacements);
        let moments_n_m = || driven.nodal_spectra(&probes.nodes, NodalQuantity::Moment);
        let moment_n_m = moments.then(moments_n_m);
        Ok(Self {
            hub,
            hub_rate_rad_s,
            hub_acceleration_rad_s2,
            motor,
            displacement_m,
            moment_n_m,
            pair: driven.period.spectrum.band_pair.clone(),
        })
    }

    /// The spectra of each quantity: one, or one for each probe.
    fn spectra(&self) -> PerQuantity<&[Vec<Complex64>]> {
        PerQuantity {
            torque: std::slice::from_ref(&self.hub.torque_n_m),
            hub_angle: std::slice::from_ref(&self.hub.excess_angle_rad),
            hub_rate: std::slice::from_ref(&self.hub_rate_rad_s),
            hub_acceleration: self.hub_acceleration_rad_s2.as_ref().map(std::slice::from_ref),
            displacement: self.displacement_m.as_deref(),
            bending_moment: self.moment_n_m.as_deref(),
            motor_torque: self.motor.as_ref().map(|m| std::slice::from_ref(&m.torque_n_m)),
            motor_rate: self.motor.as_ref().map(|m| std::slice::from_ref(&m.rate_rad_s)),
        }
    }

    /// Largest difference at any time between two answers to the same motion, over the peak of each
    /// quantity.
    pub(super) fn change_to(&self, other: &Self, peaks: &PerQuantity<f64>) -> PerQuantity<f64> {
        let changes = self.spectra().zip(&other.spectra(), |from, to| {
            let rows = from.iter().zip(to).map(|(from, to)| {
                let change: Vec<_> = to.iter().zip(from).map(|(to, from)| to - from).collect();
                self.peak_of(&change)
            });
            rows.fold(0.0, f64::max)
        });
        changes.zip(peaks, |change, peak| if change == 0.0 { 0.0 } else { change / peak })
    }

    fn peak_of(&self, amplitudes: &[Complex64]) -> f64 {
        largest(&self.pair.samples(amplitudes))
    }

    /// Largest distance of the hub angle from its start, in rad.
    fn hub_turn_rad(&self, period: &TipPeriod, length_m: f64) -> f64 {
        let tip = &period.histories;
        let excess_rad = self.pair.samples(&self.hub.excess_angle_rad);
        let (start_m, all) = (tip.start_m(), tip.displacement_m.len());
        let turns = excess_rad.iter().enumerate().filter_map(|(k, excess)| {
            // The sample at or before this time: within a step the tip hardly moves.
            let sample = k * all / excess_rad.len();
            let at_m = tip.displacement_m[sample];
            tip.counts(sample).then(|| ((at_m - start_m) / length_m + excess).abs())
        });
        turns.fold(0.0, f64::max)
    }

    /// Peak of each quantity; the tip's travel for displacements.
    pub(super) fn peaks(&self, period: &TipPeriod, length_m: f64) -> PerQuantity<f64> {
        let of_all = |rows: &Vec<Vec<Complex64>>| {
            rows.iter().map(|row| self.peak_of(row)).fold(0.0, f64::max)
        };
        // The spectrum of a velocity at the ends is without it.
        let [before_m_s, after_m_s] = period.end_velocities_m_s();
        let ends_rad_s = before_m_s.abs().max(after_m_s.abs()) / length_m;
        let with_rigid = |excess: &[Complex64], tip: &[Complex64]| {
            let both: Vec<_> = excess.iter().zip(tip).map(|(e, tip)| e + tip / length_m).collect();
            self.peak_of(&both)
        };
        let (tip, acceleration) = (&period.spectrum, self.hub_acceleration_rad_s2.as_ref());
        let travel_m = || period.histories.largest_travel_m();
        PerQuantity {
            torque: self.peak_of(&self.hub.torque_n_m),
            hub_angle: self.hub_turn_rad(period, length_m),
            hub_rate: with_rigid(&self.hub_rate_rad_s, &tip.velocity_m_s).max(ends_rad_s),
            hub_acceleration: acceleration.map(|a| with_rigid(a, &tip.acceleration_m_s2)),
            displacement: self.displacement_m.is_some().then(travel_m),
            bending_moment: self.moment_n_m.as_ref().map(of_all),
            motor_torque: self.motor.as_ref().map(|motor| self.peak_of(&motor.torque_n_m)),
            motor_rate: self.motor.as_ref().map(|motor| self.peak_of(&motor.rate_rad_s)),
        }
    }
}
