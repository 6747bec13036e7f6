//! Figures: axes, lines, colours, and the SVG that shows them.

mod axis;
mod colour_map;
mod drawing;
mod figure;
mod file;
mod legend;

pub(super) use axis::is_extreme;
pub use axis::{Axis, Scale};
pub use colour_map::{ColourMap, Colours};
pub(super) use figure::evenly;
pub use figure::{Across, Curve, Figure, FigureTable, Figures, Mark, Span, Stroke};
