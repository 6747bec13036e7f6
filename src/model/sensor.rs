use num_complex::Complex64;
use serde::Serialize;

use super::link_on_mesh::Model;
use crate::beam::TipTransfer;

/// What a sensor shows of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// Hub angle in rad.
    HubAngle,
    /// Hub rate in rad/s.
    HubRate,
    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    TipDeflection,
    /// Acceleration of the tip in m/s².
    TipAcceleration,
    /// Curvature `w''` at the root in 1/m: strain over the gauge's distance from the neutral axis.
    RootStrain,
}

impl Sensor {
    /// Its name in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::HubAngle => "hub_angle",
            Self::HubRate => "hub_rate",
            Self::TipDeflection => "tip_deflection",
            Self::TipAcceleration => "tip_acceleration",
            Self::RootStrain => "root_strain",
        }
    }

    /// What it measures, in words.
    pub fn quantity(self) -> &'static str {
        match self {
            Self::HubAngle => "hub angle",
            Self::HubRate => "hub rate",
            Self::TipDeflection => "tip deflection",
            Self::TipAcceleration => "tip acceleration",
            Self::RootStrain => "root curvature",
        }
    }

    /// The SI unit of that.
    pub fn unit(self) -> &'static str {
        match self {
            Self::HubAngle => "rad",
            Self::HubRate => "rad/s",
            Self::TipDeflection => "m",
            Self::TipAcceleration => "m/s^2",
            Self::RootStrain => "1/m",
        }
    }

    /// The unit over N m.
    pub fn unit_per_torque(self) -> &'static str {
        match self {
            Self::HubAngle => "rad/(N m)",
            Self::HubRate => "1/(N m s)",
            Self::TipDeflection => "1/N",
            Self::TipAcceleration => "1/(kg m)",
            Self::RootStrain => "1/(N m^2)",
        }
    }

    /// Its response per torque at the hub, joint friction included, at angular frequencies above 0.
    ///
    /// ```text
    /// θ/T = −(θ/v_tip)/(ω² T/a_tip),   w''/T = −(M_root/a_tip)/(EI κ T/a_tip)
    /// ```
    pub fn per_torque(self, model: &dyn Model, omegas_rad_s: &[f64]) -> Vec<Complex64> {
        let transfers = model.tip_transfers(omegas_rad_s);
        let rows = transfers.iter().zip(omegas_rad_s);
        rows.map(|(transfer, omega)| self.of(transfer, model, *omega)).collect()
    }

    fn of(self, transfer: &TipTransfer, model: &dyn Model, omega: f64) -> Complex64 {
        let (law, rate) = (model.law(), Complex64::new(0.0, omega));
        let with_mass_damping = 1.0 + law.mass_rate_per_s() / rate;
        let friction = model.link().joint().friction_n_m_s_rad;
        let torque =
            transfer.inertia_kg_m * with_mass_damping + transfer.angle_rad_m * friction / rate;
        let acceleration = torque.inv();
        let angle = -transfer.angle_rad_m * acceleration / (omega * omega);
        match self {
            Self::HubAngle => angle,
            Self::HubRate => rate * angle,
            Self::TipDeflection => {
                -transfer.deflection_s2 * law.lambda(omega) / (omega * omega) * acceleration
            }
            Self::TipAcceleration => acceleration,
            Self::RootStrain => {
                let root = &model.link().segments()[0].bending_stiffness_n_m2;
                let stiffness = law.stiffness_factor(omega) * root.inner;
                -transfer.root_inertia_kg_m * with_mass_damping * acceleration / stiffness
            }
        }
    }
}
