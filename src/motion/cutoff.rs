use std::f64::consts::PI;

/// End of the roll-off over the cut-off.
pub(super) const ROLL_OFF: f64 = 1.5;

/// Factor on the tolerance for which a second cut-off is found: the torque must not depend on it much.
pub const LOOSER: f64 = 2.0;

/// The frequency up to which a motion is solved for, and the error of the tip that follows.
///
/// For a motion with a kink, with rounded digits or with a fine step the torque has no bound: |T/a| grows
/// with frequency, while the tip's displacement falls as ω⁻². The motor need not do what the tip does not
/// show (Bayo 1987, after eq 17): the motion is solved up to the lowest frequency that keeps the tip within
/// a tolerance, a share of its travel, at all times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutoff {
    /// Frequency in rad/s up to which amplitudes are kept unchanged; infinite where all are.
    pub omega_rad_s: f64,
    /// The same in rad/s for [`LOOSER`] times the tolerance.
    pub looser_rad_s: f64,
    /// Largest error in m of the solved tip against the wanted one, at any time.
    pub tip_error_m: f64,
    /// Why the tip is not within the tolerance; `None` where it is.
    pub shortfall: Option<Shortfall>,
}

/// Why the samples of a motion do not bring the tip within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortfall {
    /// The step is too long; this one in s is short enough.
    Step(f64),
    /// The error hardly falls with frequency: noise, or too few digits.
    Noise,
}

impl Cutoff {
    /// All frequencies of the samples.
    pub const ALL: Self = Self {
        omega_rad_s: f64::INFINITY,
        looser_rad_s: f64::INFINITY,
        tip_error_m: 0.0,
        shortfall: None,
    };

    /// True if every frequency is kept.
    pub fn keeps_all(&self) -> bool {
        self.omega_rad_s.is_infinite()
    }

    /// Factor on the amplitude at ω ≥ 0: 1 up to the cut-off, then a raised cosine over half of it.
    pub fn weight(&self, omega_rad_s: f64) -> f64 {
        weight(omega_rad_s, self.omega_rad_s)
    }

    /// Weight for the looser tolerance over [`Self::weight`]: the factor that turns one into the other.
    pub fn weight_of_looser(&self, omega_rad_s: f64) -> f64 {
        let own = self.weight(omega_rad_s);
        if own > 0.0 { weight(omega_rad_s, self.looser_rad_s) / own } else { 0.0 }
    }

    /// The highest frequency that is solved, in rad/s.
    pub fn end_rad_s(&self) -> f64 {
        ROLL_OFF * self.omega_rad_s
    }
}

pub(super) fn weight(omega_rad_s: f64, cutoff_rad_s: f64) -> f64 {
    if omega_rad_s <= cutoff_rad_s {
        return 1.0;
    }
    let beyond = (omega_rad_s / cutoff_rad_s - 1.0) / (ROLL_OFF - 1.0);
    if beyond >= 1.0 { 0.0 } else { 0.5 * (1.0 + libm::cos(PI * beyond)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_is_one_up_to_the_cut_off_and_none_from_half_above_it() {
        let cutoff = Cutoff { omega_rad_s: 10.0, looser_rad_s: 8.0, ..Cutoff::ALL };
        let weights = [9.9, 12.5, 15.0].map(|omega| cutoff.weight(omega));
        assert!((weights[0], weights[2]) == (1.0, 0.0) && (weights[1] - 0.5).abs() < 1e-15);
        // 11 is three quarters of the way from 8 to 12.
        let looser = cutoff.weight(11.0) * cutoff.weight_of_looser(11.0);
        assert!((looser - 0.5 * (1.0 + (0.75 * PI).cos())).abs() < 1e-15);
        assert_eq!(cutoff.weight_of_looser(15.0).to_bits(), 0);
        assert!(Cutoff::ALL.keeps_all());
        assert_eq!(Cutoff::ALL.weight(1e9).to_bits(), 1.0_f64.to_bits());
    }
}
