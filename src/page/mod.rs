//! A result, or a fit, as figures and as a page.

mod axis;
mod bending;
mod beside;
mod colour_map;
mod document;
mod drawing;
mod figure;
mod fit;
mod frequency;
mod joint;
mod link;
mod motion;
mod paper;
mod picture;
mod robust;
mod sweep;
mod swept;
mod swept_quantities;
mod tables;
mod tip;
mod view;
mod words;

pub use figure::{Figure, Figures};
pub use fit::{FitReport, fit_page};

use crate::store::StoredResult;
use view::View;

impl Figures {
    /// All figures of a result.
    pub fn of(result: &StoredResult) -> Self {
        let (figures, link) = match result {
            StoredResult::Runs(runs) => {
                (run_figures(&View::of(runs)), runs[0].links.first().map(|own| &own.link))
            }
            StoredResult::Sweep(sweep) => (swept::sweep_figures(sweep), sweep.links.first()),
            StoredResult::Robust(studies) => {
                (robust::robust_figures(studies), studies[0].links.first())
            }
        };
        Self { link: link.cloned(), ..figures }
    }
}

/// The page of a result, with its figures: one self-contained HTML file.
pub fn page(result: &StoredResult, figures: &Figures) -> String {
    let document = match result {
        StoredResult::Runs(runs) => document::run_page(&View::of(runs), figures),
        StoredResult::Sweep(sweep) => sweep::sweep_page(sweep, figures),
        StoredResult::Robust(studies) => robust::robust_page(studies, figures),
    };
    figures.worded(&document.into_string())
}

fn run_figures(view: &View) -> Figures {
    let joints = 0..view.first().joints.len();
    let mut figures = Figures::default();
    for joint in joints.clone() {
        figures.add(Ok(joint::torque(view, joint)));
        figures.extend(joint::MOTOR_TORQUE.figure(view, joint).map(Ok));
    }
    figures.extend(joint::carriage(view).into_iter().map(Ok));
    let motion = view.link.map(|run| tip::motion(view, run));
    let [acceleration, displacement] = motion.map_or([None, None], |motion| motion.map(Some));
    figures.add(Ok(displacement.unwrap_or_else(|| tip::place(view))));
    figures.extend(tip::error(view).into_iter().chain(acceleration).map(Ok));
    for joint in joints.clone() {
        figures.add(Ok(joint::angle(view, joint)));
        figures.extend(joint::limited(view, joint));
    }
    figures.extend(view.is_arm().then(|| joint::bent_angles(view)));
    figures.extend(joints.map(|link| bending::waves(view, link)));
    if let Some(run) = view.link {
        figures.extend(view.is_solved().then(|| tip::under_rigid_torque(view, run)));
        figures.extend([frequency::transfer(view, run), frequency::shapes(&run.arc.mesh)]);
    } else {
        figures.add(joint::root_moments(view));
    }
    figures.omitted.extend(beside::drawn_apart(view));
    figures
}

#[cfg(test)]
mod tests;
