use crate::numeric::{CubicSpline, SplineEnds, TimeGrid};
use crate::response::Simulation;

/// How far a simulated tip strays from the motion that was wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipError {
    /// Largest distance in m.
    pub worst_m: f64,
    /// The same over the largest distance of the wanted motion from its start.
    pub share: f64,
    /// When it is reached, in s.
    pub time_s: f64,
    /// Root mean square of the distance over the target's samples in m.
    pub rms_m: f64,
    /// Distance at the target's last sample in m, simulated less wanted.
    pub final_m: f64,
}

impl TipError {
    /// Compares a simulation with a wanted displacement in m at the times of `grid`.
    ///
    /// Before the simulation's first sample its tip rests; between its samples a cubic spline goes
    /// through them. None if the target goes on after the simulation's last sample, or stands
    /// still.
    pub fn of(simulation: &Simulation, grid: &TimeGrid, wanted_m: &[f64]) -> Option<Self> {
        let own = &simulation.grid;
        let tip_m = &simulation.tip.displacement_m;
        let steps: Vec<f64> = (0..own.len).map(|k| k as f64).collect();
        let spline = CubicSpline::new(&steps, tip_m, SplineEnds::NotAKnot);
        let start_m = wanted_m.first()?;
        let way_m = wanted_m.iter().fold(0.0_f64, |m, x| m.max((x - start_m).abs()));
        let last = (own.len - 1) as f64;
        let at = |k: usize| (grid.time_s(k) - own.time_s(0)) / own.step_s;
        if way_m == 0.0 || at(grid.len - 1) > last + 1e-6 {
            return None;
        }
        let strays = |(k, wanted): (usize, &f64)| spline.value(at(k).clamp(0.0, last)) - wanted;
        let errors: Vec<f64> = wanted_m.iter().enumerate().map(strays).collect();
        let worst =
            (0..errors.len()).max_by(|a, b| errors[*a].abs().total_cmp(&errors[*b].abs()))?;
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        Some(Self {
            worst_m: errors[worst].abs(),
            share: errors[worst].abs() / way_m,
            time_s: grid.time_s(worst),
            rms_m: (squares / errors.len() as f64).sqrt(),
            final_m: errors[errors.len() - 1],
        })
    }
}
