/// Rigid hub that the motor turns.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hub {
    /// Rotary inertia I_H about the axis in kg m².
    pub inertia_kg_m2: f64,
    /// Rigid radius between the axis and the link's root in m.
    pub radius_m: f64,
    /// Viscous friction b of the joint in N m s/rad.
    pub viscous_friction_n_m_s_rad: f64,
}

/// A point mass fixed to the link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LumpedMass {
    /// Distance from the axis in m, hub radius included.
    pub at_m: f64,
    /// Mass in kg.
    pub mass_kg: f64,
    /// Rotary inertia about its own centre in kg m².
    pub inertia_kg_m2: f64,
}

/// What the tip carries.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Payload {
    /// Mass m_t in kg.
    pub mass_kg: f64,
    /// Rotary inertia J_t about its own centre of mass in kg m².
    pub inertia_kg_m2: f64,
    /// Offset c of that centre beyond the tip in m; negative towards the hub.
    pub offset_m: f64,
}
