//! Numbers over a rectangle as colours.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::numeric::largest;

/// Numbers over a rectangle, shown by colours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColourMap {
    /// Name of the quantity: `deflection`.
    pub(super) name: String,
    /// Its unit.
    pub(super) unit: String,
    /// Which colours stand for its numbers.
    pub(super) colours: Colours,
    /// Rows of numbers, the lowest row first; all of one length.
    pub(super) rows: Vec<Vec<f64>>,
}

/// Which colours stand for numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Colours {
    /// Blue below zero, red above, white at zero.
    Diverging,
    /// Dark blue for the smallest number to yellow for the largest.
    Sequential,
}

impl ColourMap {
    /// Smallest and largest number that a colour stands for.
    pub(super) fn limits(&self) -> (f64, f64) {
        if self.colours == Colours::Diverging {
            let peak = self.rows.iter().map(|row| largest(row)).fold(0.0, f64::max);
            return (-peak, peak);
        }
        let finite = || self.rows.iter().flatten().copied().filter(|value| value.is_finite());
        (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max))
    }

    /// True if its numbers are too large for colours.
    pub(super) fn is_extreme(&self) -> bool {
        let (low, high) = self.limits();
        [low, high].into_iter().any(|limit| limit.is_finite() && limit.abs() > 1e300)
    }

    /// Red, green and blue of a number; white for NaN.
    fn colour(&self, value: f64, (low, high): (f64, f64)) -> [u8; 3] {
        if !value.is_finite() {
            return [255; 3];
        }
        let share = if high > low { (value - low) / (high - low) } else { 0.5 };
        let colour = match self.colours {
            Colours::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - share),
            Colours::Sequential => colorous::CIVIDIS.eval_continuous(share),
        };
        [colour.r, colour.g, colour.b]
    }

    /// The colours at `count` places from the smallest number to the largest, as `#rrggbb`.
    pub(super) fn scale(&self, count: usize) -> Vec<String> {
        let (low, high) = self.limits();
        let value = |k: usize| low + (high - low) * k as f64 / (count - 1) as f64;
        let hexadecimal = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
        (0..count).map(|k| hexadecimal(self.colour(value(k), (low, high)))).collect()
    }

    /// A PNG picture of the numbers as a `data:` address, a pixel for each.
    #[expect(clippy::cast_possible_truncation, reason = "no more pixels than those of a figure")]
    pub(super) fn picture(&self) -> String {
        let limits = self.limits();
        let (columns, rows) = (self.rows.first().map_or(0, Vec::len), self.rows.len());
        let numbers = self.rows.iter().rev().flatten();
        let pixels: Vec<u8> = numbers.flat_map(|number| self.colour(*number, limits)).collect();
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, columns as u32, rows as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        // Writing to memory, and as many pixels as announced, cannot fail.
        if let Ok(mut writer) = encoder.write_header() {
            let _ = writer.write_image_data(&pixels);
        }
        format!("data:image/png;base64,{}", STANDARD.encode(file))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(colours: Colours) -> ColourMap {
        let rows = vec![vec![-1.0, 0.0, 2.0], vec![f64::NAN, 0.5, 1.0]];
        ColourMap { name: "deflection".into(), unit: "m".into(), colours, rows }
    }

    fn pixels(address: &str) -> (u32, u32, Vec<u8>) {
        let file =
            STANDARD.decode(address.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        (frame.width, frame.height, pixels)
    }

    #[test]
    fn the_picture_has_the_first_row_at_its_foot_and_zero_in_white() {
        let map = map(Colours::Diverging);
        assert_eq!(map.limits(), (-2.0, 2.0));
        let (width, height, pixels) = pixels(&map.picture());
        assert_eq!((width, height), (3, 2));
        let pixel = |row: usize, column: usize| &pixels[3 * (3 * row + column)..][..3];
        assert_eq!(pixel(0, 0), [255; 3], "nothing known");
        assert!(pixel(1, 1).iter().all(|part| *part > 235), "zero: {:?}", pixel(1, 1));
        assert!(pixel(1, 2)[0] > pixel(1, 2)[2], "above zero is red");
        assert!(pixel(1, 0)[2] > pixel(1, 0)[0], "below zero is blue");
    }

    #[test]
    fn sizes_go_from_dark_to_light() {
        let map = map(Colours::Sequential);
        assert_eq!(map.limits(), (-1.0, 2.0));
        let scale = map.scale(3);
        assert_eq!(scale.len(), 3);
        assert!(scale[0] < scale[2], "{scale:?}");
    }
}
