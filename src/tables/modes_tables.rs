//! The files of `modes`: every column's name and unit, once.

use super::folder::{FolderError, OutputFolder};
use super::number::Digits;
use super::plain_table::{PlainColumn, write_plain};

/// What is known of the modes and zeros of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesResult {
    /// Natural frequencies in rad/s, the rigid rotation left out.
    pub omega_rad_s: Vec<f64>,
    /// Damping ratio that the law gives each mode.
    pub damping_ratios: Vec<f64>,
    /// Zeros ±z of torque → tip in 1/s.
    pub zeros_per_s: Vec<f64>,
    /// Zeros at real frequencies, in Hz: there no torque moves the tip.
    pub blocked_hz: Vec<f64>,
    /// Distance of each node from the axis in m.
    pub nodes_m: Vec<f64>,
    /// Mass-normalised displacement of each node in 1/√kg, one list a mode.
    pub shapes: Vec<Vec<f64>>,
}

/// Names of all files that `modes` writes.
const OWNED: [&str; 3] = ["modes.csv", "mode_shapes.csv", "zeros.csv"];

impl ModesResult {
    /// Natural frequencies in Hz.
    pub fn frequencies_hz(&self) -> Vec<f64> {
        self.omega_rad_s.iter().map(|omega| omega / std::f64::consts::TAU).collect()
    }

    /// Periods in s.
    pub fn periods_s(&self) -> Vec<f64> {
        self.frequencies_hz().into_iter().map(f64::recip).collect()
    }

    /// How long before the motion the torque is still 1 % of what it is at its start, in s, were
    /// there but this zero: ln(100)/z.
    pub fn leads_s(&self) -> Vec<f64> {
        self.zeros_per_s.iter().map(|zero| 100.0_f64.ln() / zero).collect()
    }

    /// Writes modes.csv, `mode_shapes.csv` and zeros.csv, all or none.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(&self, mut folder: OutputFolder, digits: Digits) -> Result<(), FolderError> {
        let numbers: Vec<usize> = (1..=self.omega_rad_s.len()).collect();
        let modes = [
            PlainColumn::counts("mode", &numbers),
            PlainColumn::values("omega_rad_s", &self.omega_rad_s),
            PlainColumn::values("frequency_hz", &self.frequencies_hz()),
            PlainColumn::values("period_s", &self.periods_s()),
            PlainColumn::values("damping_ratio", &self.damping_ratios),
        ];
        folder.file(OWNED[0], |out| write_plain(out, &modes, digits))?;
        let mut shapes = vec![PlainColumn::values("x_m", &self.nodes_m)];
        shapes.extend(
            numbers
                .iter()
                .zip(&self.shapes)
                .map(|(mode, shape)| PlainColumn::values(&format!("mode_{mode}"), shape)),
        );
        folder.file(OWNED[1], |out| write_plain(out, &shapes, digits))?;
        let zeros = [
            PlainColumn::values("zero_per_s", &self.zeros_per_s),
            PlainColumn::values("lead_to_1_percent_s", &self.leads_s()),
            PlainColumn::values("blocked_frequency_hz", &self.blocked_hz),
        ];
        folder.file(OWNED[2], |out| write_plain(out, &zeros, digits))?;
        folder.commit(OWNED[2], &OWNED)
    }
}
