//! Figures of one run.

mod moments;
mod rigid_torque;
mod shapes;
mod time;
mod transfer;
mod view;
mod waves;

pub(super) use moments::bending_moments;
pub use view::View;
pub(super) use view::{inside, nearest};

use super::figures::Figures;

/// All figures of a run.
pub(super) fn run_figures(view: &View) -> Figures {
    let run = view.run;
    let mut figures = Figures::default();
    figures.add(Ok(time::torque(view)));
    for figure in time::motion(view) {
        figures.add(Ok(figure));
    }
    figures.add(Ok(time::hub(view)));
    figures.add(waves::waves(view));
    if let Some(figure) = rigid_torque::tip_under_rigid_torque(view) {
        figures.add(figure);
    }
    figures.add(transfer::transfer(run));
    figures.add(shapes::shapes(&run.mesh));
    figures
}
