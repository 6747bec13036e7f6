use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use super::figure::Figure;

/// Letters of every figure, so that it looks the same on every machine.
const FONT: &[u8] = include_bytes!("../font/DejaVuSans.ttf");

/// Its name.
const FAMILY: &str = "DejaVu Sans";

/// Pixels of a picture for each of the drawing: sharp in print and on fine screens.
const SCALE: f32 = 2.0;

impl Figure {
    /// The figure as a PNG file of two pixels for each of the drawing, on white.
    ///
    /// # Errors
    /// What the renderer says, should the drawing be too large for it.
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
