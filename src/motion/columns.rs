/// Sampled columns of a tip motion as they were read, in SI, all of one length.
///
/// At least one of `acceleration_m_s2` and `displacement_m` is present.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionColumns {
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Tip acceleration in m/s².
    pub acceleration_m_s2: Option<Vec<f64>>,
    /// Tip velocity in m/s.
    pub velocity_m_s: Option<Vec<f64>>,
    /// Tip displacement along the arc in m.
    pub displacement_m: Option<Vec<f64>>,
}
