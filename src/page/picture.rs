//! A figure as a file: SVG or PNG.

use std::sync::Arc;

use maud::{PreEscaped, html};
use resvg::{tiny_skia, usvg};

use super::figure::{Figure, Figures};
use super::words::worded;
use crate::text::visible_document;

/// Style sheet of a figure's SVG file: the light colours of the page.
pub(super) const STYLE: &str = concat!(include_str!("drawing.css"), include_str!("figure.css"));

/// Font of the pictures, the same on every machine.
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");

/// Pixels of a picture per unit of the drawing.
const SCALE: f32 = 2.0;

impl Figures {
    /// One of the figures as an SVG file, with its styles, title and caption inside.
    pub fn svg_file(&self, figure: &Figure) -> String {
        let drawing = figure.svg().into_string();
        let head_len = drawing.find('>').map_or(0, |end| end + 1);
        let (head, rest) = drawing.split_at(head_len);
        let style = html! {
            title { (figure.title) }
            desc { (figure.caption) }
            style { (PreEscaped(STYLE)) }
            rect width="100%" height="100%" fill="#ffffff" {}
        };
        self.worded(&format!("{head}{}{rest}\n", style.into_string()))
    }

    /// A page or a drawing in the words of the link, with all its characters visible.
    pub(super) fn worded(&self, text: &str) -> String {
        visible_document(&worded(self.link.as_ref(), text))
    }

    /// One of the figures as a PNG file, two pixels per unit of the drawing, on white.
    ///
    /// # Errors
    /// The renderer's message about a drawing that is too large.
    pub fn png_file(&self, figure: &Figure) -> Result<Vec<u8>, String> {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(FONT.to_vec());
        let options = usvg::Options {
            fontdb: Arc::new(fonts),
            font_family: "DejaVu Sans".to_owned(),
            ..usvg::Options::default()
        };
        let tree = usvg::Tree::from_str(&self.svg_file(figure), &options)
            .map_err(|error| error.to_string())?;
        let size = tree.size().to_int_size().scale_by(SCALE).ok_or("its size is none")?;
        let mut pixels =
            tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("its size is none")?;
        let transform = tiny_skia::Transform::from_scale(SCALE, SCALE);
        resvg::render(&tree, transform, &mut pixels.as_mut());
        pixels.encode_png().map_err(|error| error.to_string())
    }
}
