//! Figures: axes, lines, colours, and the SVG that shows them.

mod axis;
mod colour_map;
mod drawing;
mod figure;
mod legend;
mod raster;
mod svg_file;
mod table;
mod thinning;

pub(super) use axis::is_extreme;
pub use axis::{Axis, Scale};
pub use colour_map::{ColourMap, Colours};
pub use figure::{Across, Curve, Figure, Mark, Span, Stroke};
pub use table::FigureTable;
pub(super) use table::evenly;
