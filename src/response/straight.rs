use super::forcing::{Interpolation, pieces};
use super::simulation::Simulation;
use super::stepper::Stepper;

impl Simulation {
    /// Tip displacement in m of the same modes under a torque that goes by straight lines between
    /// its samples, which stand at those of this simulation; hub and feedback react as in it.
    ///
    /// # Panics
    /// If there are not as many samples as the simulation has.
    pub fn straight_tip_m(&self, torque_n_m: &[f64]) -> Vec<f64> {
        assert_eq!(torque_n_m.len(), self.grid.len, "every time has a sample");
        let tips = self.equations.tips(&self.mesh);
        let tip = |q: &[f64]| -> f64 { q.iter().zip(&tips).map(|(q, tip)| q * tip).sum() };
        let stepper = Stepper::new(&self.equations, self.grid.step_s);
        let lines = pieces(torque_n_m, Interpolation::Linear);
        stepper.through(&lines, |q| self.initial_tip_m + tip(q))
    }
}

#[cfg(test)]
mod tests {
    use crate::beam::{ElementCount, MeshPlan};
    use crate::link::{Hub, Link, LinkParts, uniform};
    use crate::response::{Interpolation, Play, Torque, simulate};

    #[test]
    fn the_tip_is_that_of_the_torque_played_by_straight_lines() {
        let hub = Hub { viscous_friction_n_m_s_rad: 0.1, ..uniform().hub };
        let link = Link::new(LinkParts { hub, ..uniform() }).unwrap();
        let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Total(10)), 1e-6).unwrap();
        let time_s: Vec<f64> = (0..=100).map(|k| 1e-2 * f64::from(k)).collect();
        let sine = time_s.iter().map(|t| (std::f64::consts::TAU * t).sin()).collect();
        let torque = Torque::new(&time_s, sine).unwrap();
        let play = Play { initial_tip_m: 0.5, ..Play::of(&torque) };
        let cubics = simulate(&link, &plan, &play).unwrap();
        let lines = Play { interpolation: Interpolation::Linear, ..play };
        let lines = simulate(&link, &plan, &lines).unwrap().tip.displacement_m;
        assert!(cubics.straight_tip_m(torque.torque_n_m()) == lines);
        assert!(cubics.tip.displacement_m != lines);
    }
}
