//! A link at one frequency: its transfers, and the response of sensors.

use std::f64::consts::TAU;

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::link_on_mesh::{LinkOnMesh, Model, ModelError};
use crate::beam::TipTransfer;
use crate::modal::WeighedLink;
use crate::numeric::{magnitude, relative_change};
use crate::system::end_if_stopped;

/// Number of frequencies solved at a time on the finer mesh, which limits the memory.
const AT_A_TIME: usize = 4096;

/// Number of frequencies solved between two checks for a stop; a multiple of every processor's vectors.
const UNSTOPPED: usize = 256;

/// Transfers of a link at one frequency, for e^{+iωt}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyResponse {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// `T/a_tip` in kg m (Bayo 1987, eq 20), including joint friction.
    pub torque_per_tip_acceleration_kg_m: Complex64,
    /// `θ/v_tip` in rad/m (eq 21).
    pub hub_angle_per_tip_displacement_rad_m: Complex64,
    /// `v_tip/T` in 1/N (eq 19).
    pub tip_displacement_per_torque_1_n: Complex64,
}

impl FrequencyResponse {
    /// Transfers at `frequency_hz` > 0.
    ///
    /// ```text
    /// T/a_tip = (A_0[φφ] + I_H)/(L + e_tip) (1 + α/(iω)) + b/(iω (L + e_tip))
    /// ```
    ///
    /// At a pole of an undamped link a transfer may be infinite.
    pub fn at(model: &dyn Model, frequency_hz: f64) -> Self {
        Self::of(model.tip_transfer(frequency_hz * TAU), model, frequency_hz)
    }

    /// [`FrequencyResponse::at`] for many frequencies, one for each lane of the processor's vectors at a time.
    pub fn at_all(model: &dyn Model, frequencies_hz: &[f64]) -> Vec<Self> {
        let mut rows = Vec::with_capacity(frequencies_hz.len());
        for frequencies_hz in frequencies_hz.chunks(UNSTOPPED) {
            end_if_stopped();
            let omegas: Vec<f64> = frequencies_hz.iter().map(|hz| hz * TAU).collect();
            let transfers = model.tip_transfers(&omegas).into_iter().zip(frequencies_hz);
            rows.extend(transfers.map(|(of, hz)| Self::of(of, model, *hz)));
        }
        rows
    }

    fn of(transfer: TipTransfer, model: &dyn Model, frequency_hz: f64) -> Self {
        let omega = frequency_hz * TAU;
        let torque = torque_kg_m(&transfer, model, Complex64::new(0.0, omega));
        Self {
            frequency_hz,
            torque_per_tip_acceleration_kg_m: torque,
            hub_angle_per_tip_displacement_rad_m: transfer.angle_rad_m,
            tip_displacement_per_torque_1_n: -(torque * omega * omega).inv(),
        }
    }
}

/// `T/a_tip` in kg m with friction and mass damping, `rate` being iω in 1/s.
fn torque_kg_m(transfer: &TipTransfer, model: &dyn Model, rate: Complex64) -> Complex64 {
    transfer.inertia_kg_m * (1.0 + model.law().mass_rate_per_s() / rate)
        + transfer.angle_rad_m * model.link().joint().friction() / rate
}

/// Changes of the transfers of `rows` on halved elements: for each row the larger change of `T/a_tip` and `θ/v_tip`,
/// over the larger of the magnitudes before and after.
///
/// Dividing by the larger keeps the change finite at an undamped pole or zero.
///
/// # Errors
/// [`ModelError::TooManyElements`] if damping needs all modes of the finer mesh.
pub fn changes_on_halves(
    model: &dyn Model,
    rows: &[FrequencyResponse],
) -> Result<Vec<f64>, ModelError> {
    let finer = model.refined()?;
    let changes = rows.chunks(AT_A_TIME).flat_map(|rows| {
        let frequencies_hz: Vec<f64> = rows.iter().map(|row| row.frequency_hz).collect();
        let on_halves = FrequencyResponse::at_all(&*finer, &frequencies_hz);
        rows.iter().zip(on_halves).map(|(row, half)| change(row, &half)).collect::<Vec<_>>()
    });
    Ok(changes.collect())
}

/// Transfers of a link that keeps its direction, with the weight along it, and their changes as of [`changes_on_halves`].
/// `None` for other links, with a modal damping law, and on meshes that are too large.
pub fn responses_with_weight(
    link: &LinkOnMesh,
    frequencies_hz: &[f64],
) -> Option<(Vec<FrequencyResponse>, Option<Vec<f64>>)> {
    let rows = rows_with_weight(link, frequencies_hz)?;
    let halves = link.refined().ok().and_then(|finer| rows_with_weight(&finer, frequencies_hz));
    let changes = halves
        .map(|halves| rows.iter().zip(&halves).map(|(row, half)| change(row, half)).collect());
    Some((rows, changes))
}

fn rows_with_weight(of: &LinkOnMesh, frequencies_hz: &[f64]) -> Option<Vec<FrequencyResponse>> {
    let outward_m_s2 = of.link().outward_m_s2().filter(|_| !of.law().is_modal())?;
    let weighed = WeighedLink::of(of.mesh(), outward_m_s2)?;
    let friction = of.link().joint().friction();
    let row = |frequency_hz: &f64| {
        end_if_stopped();
        let omega = frequency_hz * TAU;
        let [effort, tip] = weighed.transfer(omega, of.law().factors(omega));
        let effort = effort + Complex64::new(0.0, omega * friction);
        FrequencyResponse {
            frequency_hz: *frequency_hz,
            torque_per_tip_acceleration_kg_m: -effort / (tip * omega * omega),
            hub_angle_per_tip_displacement_rad_m: tip.inv(),
            tip_displacement_per_torque_1_n: tip / effort,
        }
    };
    Some(frequencies_hz.iter().map(row).collect())
}

fn change(found: &FrequencyResponse, half: &FrequencyResponse) -> f64 {
    let relative = |of: fn(&FrequencyResponse) -> Complex64| {
        let (found, half) = (of(found), of(half));
        relative_change(magnitude(found - half), [found, half].map(magnitude))
    };
    relative(|row| row.torque_per_tip_acceleration_kg_m)
        .max(relative(|row| row.hub_angle_per_tip_displacement_rad_m))
}

/// Quantity that a sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// Hub angle in rad.
    HubAngle,
    /// Hub rate in rad/s.
    HubRate,
    /// Position of the carriage in m.
    Carriage,
    /// Velocity of the carriage in m/s.
    CarriageVelocity,
    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    TipDeflection,
    /// Acceleration of the tip in m/s².
    TipAcceleration,
    /// Curvature `w''` at the root in 1/m: strain over the distance of the gauge from the neutral axis.
    RootStrain,
}

impl Sensor {
    /// Name in files, measured quantity in words, its SI unit, and its unit per effort of the joint, of a hub where both
    /// joints have the quantity.
    fn texts(self) -> [&'static str; 4] {
        match self {
            Self::HubAngle => ["hub_angle", "hub angle", "rad", "rad/(N m)"],
            Self::HubRate => ["hub_rate", "hub rate", "rad/s", "1/(N m s)"],
            Self::Carriage => ["carriage", "carriage", "m", "m/N"],
            Self::CarriageVelocity => ["carriage_velocity", "carriage velocity", "m/s", "m/(N s)"],
            Self::TipDeflection => ["tip_deflection", "tip deflection", "m", "1/N"],
            Self::TipAcceleration => ["tip_acceleration", "tip acceleration", "m/s^2", "1/(kg m)"],
            Self::RootStrain => ["root_strain", "root curvature", "1/m", "1/(N m^2)"],
        }
    }

    /// Name in files.
    pub fn word(self) -> &'static str {
        self.texts()[0]
    }

    /// Measured quantity in words.
    pub fn quantity(self) -> &'static str {
        self.texts()[1]
    }

    /// Whether links on carriages, or on hubs, have the quantity; `None`: both.
    pub fn slides(self) -> Option<bool> {
        match self {
            Self::HubAngle | Self::HubRate => Some(false),
            Self::Carriage | Self::CarriageVelocity => Some(true),
            _ => None,
        }
    }

    /// SI unit of the quantity.
    pub fn unit(self) -> &'static str {
        self.texts()[2]
    }

    /// Unit of the quantity per N m at a hub, or per N on a carriage.
    pub fn unit_per_effort(self, slides: bool) -> &'static str {
        match self {
            Self::TipDeflection if slides => "m/N",
            Self::TipAcceleration if slides => "1/kg",
            Self::RootStrain if slides => "1/(N m)",
            _ => self.texts()[3],
        }
    }

    /// Response per torque at the hub, or force on the carriage, including joint friction, at angular frequencies above 0.
    ///
    /// ```text
    /// θ/T = −(θ/v_tip)/(ω² T/a_tip),   w''/T = −((M + M_d)/a_tip)/(EI κ T/a_tip)
    /// ```
    ///
    /// M is the moment at the root that accelerates the link. Damping, by κ or as the moment `M_d` of modal damping, is no
    /// strain.
    pub fn per_torque(self, model: &dyn Model, omegas_rad_s: &[f64]) -> Vec<Complex64> {
        let transfers = model.tip_transfers(omegas_rad_s);
        let rows = transfers.iter().zip(omegas_rad_s);
        rows.map(|(transfer, omega)| self.of(transfer, model, *omega)).collect()
    }

    fn of(self, transfer: &TipTransfer, model: &dyn Model, omega: f64) -> Complex64 {
        let (law, rate) = (model.law(), Complex64::new(0.0, omega));
        let acceleration = torque_kg_m(transfer, model, rate).inv();
        let angle = -transfer.angle_rad_m * acceleration / (omega * omega);
        match self {
            Self::HubAngle | Self::Carriage => angle,
            Self::HubRate | Self::CarriageVelocity => rate * angle,
            Self::TipDeflection => {
                -transfer.deflection_s2 * law.lambda(omega) / (omega * omega) * acceleration
            }
            Self::TipAcceleration => acceleration,
            Self::RootStrain => {
                let root = &model.link().segments()[0].bending_stiffness_n_m2;
                let stiffness = law.stiffness_factor(omega) * root.inner;
                let with_mass_damping = 1.0 + law.mass_rate_per_s() / rate;
                let moment = transfer.root_inertia_kg_m * with_mass_damping;
                -(moment + model.root_damping_kg_m(omega)) * acceleration / stiffness
            }
        }
    }
}
