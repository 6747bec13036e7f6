//! What the rigid link's torque does to the flexible one (figures 8 and 9 of the paper).

use super::view::{View, inside};
use crate::link::Damping;
use crate::numeric::{largest, significant};
use crate::report::chart::{Figure, Stroke, is_extreme};
use crate::response::{Play, Simulation, Torque, simulate_on};
use crate::result::StoredSolution;

/// Tip of the link when the rigid link's torque is played on it; why there is no such figure, where
/// there is none.
///
/// Nothing where the run was not asked for a motion.
pub(super) fn tip_under_rigid_torque(view: &View) -> Option<Result<Figure, String>> {
    let solved = view.run.solved.as_ref()?;
    let why = |error: String| format!("the tip under the rigid link's torque, since {error}");
    let drawn = played(view, solved).and_then(|simulation| figure(view, solved, &simulation));
    Some(drawn.map_err(why))
}

fn played(view: &View, solved: &StoredSolution) -> Result<Simulation, String> {
    let run = view.run;
    let torque = Torque::new(&run.times_s, solved.rigid_torque_n_m.clone())
        .map_err(|error| error.to_string())?;
    let play = Play { initial_tip_m: run.tip.displacement_m[0], ..Play::of(&torque) };
    simulate_on(&run.link, run.mesh.clone(), &play).map_err(|error| error.to_string())
}

fn figure(view: &View, solved: &StoredSolution, simulation: &Simulation) -> Result<Figure, String> {
    let (run, tip) = (view.run, &simulation.tip.displacement_m);
    let wanted = &run.tip.displacement_m;
    let after = inside(&run.times_s, solved.moving_s.1, f64::INFINITY);
    let strays: Vec<f64> = after.map(|k| tip[k] - wanted[k]).collect();
    let strays_m = largest(&strays);
    if is_extreme(strays_m) {
        return Err("it strays by more or less than can be drawn".to_owned());
    }
    let share = 100.0 * strays_m / run.tip.farthest_m();
    let of_way = if is_extreme(share) {
        String::new()
    } else {
        format!(", {} % of its way", significant(share, 2))
    };
    let damping = match run.link.damping() {
        Damping::Hysteretic { .. } => ", its damping ratio as viscous in every mode",
        _ => "",
    };
    let curves = vec![
        view.curve("wanted", Stroke::Solid(3), wanted),
        view.curve("rigid link's torque", Stroke::Dashed(2), tip),
    ];
    Ok(Figure {
        caption: format!(
            "What a controller gets that takes the link for rigid: its torque, played on the flexible \
             link{damping} (figures 8 and 9). After the motion the tip still strays by up to {} \
             m{of_way}.",
            significant(strays_m, 3)
        ),
        ..view.figure(
            "tip-under-rigid-torque",
            "Tip under the rigid link's torque",
            ("displacement", "m"),
            curves,
        )
    })
}
