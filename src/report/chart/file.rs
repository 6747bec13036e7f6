//! A figure as a file of its own: SVG and PNG.

use std::sync::Arc;

use maud::{PreEscaped, html};
use resvg::{tiny_skia, usvg};

use super::figure::Figure;
use crate::numeric::visible_document;

/// Style sheet of a figure in a file of its own: the light colours of the page.
const STYLE: &str = include_str!("figure.css");

/// Font of the pictures, so that they are the same on every machine.
const FONT: &[u8] = include_bytes!("../font/DejaVuSans.ttf");

/// Name of the font.
const FAMILY: &str = "DejaVu Sans";

/// Pixels of a picture per unit of the drawing.
const SCALE: f32 = 2.0;

impl Figure {
    /// The figure as a file of its own.
    pub fn svg_file(&self) -> String {
        let drawing = self.svg().into_string();
        let Some(begin) = drawing.find('>') else { return drawing };
        let (head, rest) = drawing.split_at(begin + 1);
        let style = html! {
            title { (self.title) }
            desc { (self.caption) }
            style { (PreEscaped(STYLE)) }
            rect width="100%" height="100%" fill="#ffffff" {}
        };
        visible_document(&format!("{head}{}{rest}\n", style.into_string()))
    }

    /// The figure as a PNG file, two pixels per unit of the drawing, on white.
    ///
    /// # Errors
    /// The renderer's message if the drawing is too large for it.
    pub fn png_file(&self) -> Result<Vec<u8>, String> {
        let mut fonts = usvg::fontdb::Database::new();
        fonts.load_font_data(FONT.to_vec());
        let options = usvg::Options {
            fontdb: Arc::new(fonts),
            font_family: FAMILY.to_owned(),
            ..usvg::Options::default()
        };
        let tree = usvg::Tree::from_str(&self.svg_file(), &options).map_err(|e| e.to_string())?;
        let size = tree.size().to_int_size().scale_by(SCALE).ok_or("its size is none")?;
        let mut pixels =
            tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("its size is none")?;
        let transform = tiny_skia::Transform::from_scale(SCALE, SCALE);
        resvg::render(&tree, transform, &mut pixels.as_mut());
        pixels.encode_png().map_err(|error| error.to_string())
    }
}
