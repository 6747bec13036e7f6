//! Numbers over a rectangle as colours.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::axis::digits;
use crate::numeric::{extremes, largest};

/// Numbers over a rectangle, shown as colours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColourMap {
    /// Name of the quantity: `deflection`.
    pub(super) name: String,
    /// Unit of the quantity.
    pub(super) unit: String,
    /// Colours for its numbers.
    pub(super) colours: Colours,
    /// Rows of numbers of equal length, the lowest row first.
    pub(super) rows: Vec<Vec<f64>>,
    /// Single numbers, if the map consists of fields.
    pub(super) fields: Option<Fields>,
}

/// Fields of a map: a number at each x and y, NaN for a gap.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fields {
    /// x and y of the columns and rows, ascending.
    pub(super) places: [Vec<f64>; 2],
    /// Rows of numbers, the lowest row first.
    pub(super) values: Vec<Vec<f64>>,
    /// Hatched fields.
    pub(super) hatch: Option<Hatch>,
}

/// Hatched fields of a map.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hatch {
    /// Name in the legend.
    pub(super) name: String,
    /// For each field whether it is hatched, the lowest row first.
    pub(super) fields: Vec<Vec<bool>>,
}

/// Kind of colours for numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Colours {
    /// Blue below zero, red above, transparent at zero. Their strength follows the square root of the number, so that
    /// small ones stay visible.
    Diverging,
    /// Dark blue for the smallest number to yellow for the largest.
    Sequential,
    /// A pale colour for each of these kinds; the numbers of the rows are the numbers of the kinds.
    Kinds(Vec<String>),
}

/// Pale colours of kinds, as in the style sheets.
const PALE: [[u8; 3]; 6] = [
    [166, 206, 227],
    [248, 197, 158],
    [158, 214, 194],
    [219, 186, 209],
    [232, 216, 150],
    [205, 205, 205],
];

/// Number of colours of a map, numbered from 1; 0 is transparent.
const COLOURS: u8 = 255;

/// The strongest blue and red.
const ENDS: [[u8; 3]; 2] = [[36, 113, 199], [214, 56, 47]];

/// Smallest span of the colours, relative to the largest number: smaller differences look alike.
const LEAST_SPAN: f64 = 0.1;

impl ColourMap {
    /// Smallest and largest number of the map.
    fn range(&self) -> [f64; 2] {
        let all = self.rows.iter().flatten().copied();
        extremes(&all.filter(|value| value.is_finite()).collect::<Vec<f64>>())
    }

    /// Smallest and largest number with a colour.
    pub(super) fn limits(&self) -> (f64, f64) {
        if self.colours == Colours::Diverging {
            let peak = self.rows.iter().map(|row| largest(row)).fold(0.0, f64::max);
            return (-peak, peak);
        }
        let [low, high] = self.range();
        let lacks = 0.5 * (LEAST_SPAN * low.abs().max(high.abs()) - (high - low)).max(0.0);
        (low - lacks, high + lacks)
    }

    /// Range of the numbers in words, and that of the colours if wider.
    pub(super) fn range_words(&self) -> String {
        let ([low, high], (first, last)) = (self.range(), self.limits());
        if !low.is_finite() {
            return String::new();
        }
        let is_narrow = self.colours == Colours::Sequential && (first < low || last > high);
        let [low, high] = [low, high].map(|value| digits(value, if is_narrow { 5 } else { 4 }));
        let range = format!(" From {low} to {high} {}", self.unit);
        let range = range.trim_end();
        if is_narrow {
            let [first, last] = [first, last].map(|value| digits(value, 3));
            return format!(
                "{range}; the colours span {first} to {last}, as the numbers hardly differ."
            );
        }
        format!("{range}.")
    }

    /// True if its numbers are too large for colours.
    pub(super) fn is_extreme(&self) -> bool {
        let (low, high) = self.limits();
        [low, high].into_iter().any(|limit| limit.is_finite() && limit.abs() > 1e300)
    }

    /// Number of the colour for a value.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 … 254")]
    fn colour(&self, value: f64, (low, high): (f64, f64)) -> u8 {
        if !value.is_finite() {
            return 0;
        }
        let share = match self.colours {
            Colours::Kinds(_) => return 1 + value.clamp(0.0, (PALE.len() - 1) as f64) as u8,
            _ if high <= low => 0.5,
            Colours::Diverging => 0.5 * (1.0 + value.signum() * (value.abs() / high).sqrt()),
            Colours::Sequential => (value - low) / (high - low),
        };
        1 + (share * f64::from(COLOURS - 1)).round() as u8
    }

    /// Red, green, blue and opacity of a colour by its number.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 … 255")]
    fn shade(&self, number: u8) -> ([u8; 3], u8) {
        let Some(place) = number.checked_sub(1) else { return ([255; 3], 0) };
        let share = f64::from(place) / f64::from(COLOURS - 1);
        match self.colours {
            Colours::Diverging => {
                let end = ENDS[usize::from(share > 0.5)];
                (end, (255.0 * (2.0 * share - 1.0).abs()).round() as u8)
            }
            Colours::Sequential => {
                let colour = colorous::CIVIDIS.eval_continuous(share);
                ([colour.r, colour.g, colour.b], 255)
            }
            Colours::Kinds(_) => (PALE[usize::from(place) % PALE.len()], 255),
        }
    }

    /// Colours at `count` even places of the scale, as `#rrggbb` and opacity.
    #[expect(clippy::cast_possible_truncation, reason = "1 … 255")]
    pub(super) fn scale(&self, count: u8) -> Vec<(String, f64)> {
        let number =
            |k: u8| 1 + (u16::from(k) * u16::from(COLOURS - 1) / u16::from(count - 1)) as u8;
        let hexadecimal = |([r, g, b], opacity): ([u8; 3], u8)| {
            (format!("#{r:02x}{g:02x}{b:02x}"), f64::from(opacity) / 255.0)
        };
        (0..count).map(|k| hexadecimal(self.shade(number(k)))).collect()
    }

    /// Numbers shown at the scale, each with its share of the scale's length.
    pub(super) fn scale_ticks(&self) -> Vec<(f64, f64)> {
        let (low, high) = self.limits();
        match self.colours {
            Colours::Diverging => vec![(low, 0.0), (0.0, 0.5), (high, 1.0)],
            Colours::Sequential => vec![(low, 0.0), (0.5 * (low + high), 0.5), (high, 1.0)],
            Colours::Kinds(_) => vec![],
        }
    }

    /// Names of the kinds; empty for numbers.
    pub(super) fn kinds(&self) -> &[String] {
        if let Colours::Kinds(names) = &self.colours { names } else { &[] }
    }

    /// True if a value's colour is dark, so that letters on it must be light.
    pub(super) fn is_dark(&self, value: f64) -> bool {
        if matches!(self.colours, Colours::Kinds(_)) {
            return false;
        }
        let ([r, g, b], _) = self.shade(self.colour(value, self.limits()));
        2 * u32::from(r) + 5 * u32::from(g) + u32::from(b) < 8 * 118
    }

    /// A PNG picture of the numbers as a `data:` address, with a pixel for each.
    #[expect(clippy::cast_possible_truncation, reason = "no more pixels than those of a figure")]
    pub(super) fn picture(&self) -> String {
        let limits = self.limits();
        let (columns, rows) = (self.rows.first().map_or(0, Vec::len), self.rows.len());
        let numbers = self.rows.iter().rev().flatten();
        let pixels: Vec<u8> = numbers.map(|number| self.colour(*number, limits)).collect();
        let (palette, opacities): (Vec<_>, Vec<_>) =
            (0..=COLOURS).map(|number| self.shade(number)).unzip();
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, columns as u32, rows as u32);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(palette.concat());
        encoder.set_trns(opacities);
        encoder.set_compression(png::Compression::High);
        // Writing to memory, with the announced number of pixels, cannot fail.
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
        ColourMap { name: "deflection".into(), unit: "m".into(), colours, rows, fields: None }
    }

    fn pixels(address: &str) -> (u32, u32, Vec<u8>) {
        let file =
            STANDARD.decode(address.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        (frame.width, frame.height, pixels)
    }

    #[test]
    fn the_picture_has_the_first_row_at_its_foot_and_zero_in_no_colour() {
        let map = map(Colours::Diverging);
        assert_eq!(map.limits(), (-2.0, 2.0));
        let (width, height, pixels) = pixels(&map.picture());
        assert_eq!((width, height), (3, 2));
        let pixel = |row: usize, column: usize| &pixels[4 * (3 * row + column)..][..4];
        assert_eq!(pixel(0, 0)[3], 0, "nothing known");
        assert!(pixel(1, 1)[3] < 3, "zero: {:?}", pixel(1, 1));
        assert!(pixel(1, 2)[0] > pixel(1, 2)[2] && pixel(1, 2)[3] == 255, "above zero is red");
        assert!(pixel(1, 0)[2] > pixel(1, 0)[0], "below zero is blue");
        // −1 out of 2 with the square root.
        assert!(pixel(1, 0)[3].abs_diff(180) < 3, "{:?}", pixel(1, 0));
        let halves = map.scale_ticks().into_iter().map(|(value, share)| {
            (value, 0.5 + 0.5 * value.signum() * (value.abs() / 2.0).sqrt() - share)
        });
        assert!(halves.into_iter().all(|(value, off)| value.abs() < 1e-12 || off.abs() < 1e-12));
    }

    #[test]
    fn sizes_go_from_dark_to_light() {
        let map = map(Colours::Sequential);
        assert_eq!(map.limits(), (-1.0, 2.0));
        let scale = map.scale(3);
        assert_eq!(scale.len(), 3);
        assert!(scale[0] < scale[2], "{scale:?}");
        assert!(map.is_dark(-1.0) && !map.is_dark(2.0));
    }

    #[test]
    fn numbers_that_hardly_differ_have_hardly_different_colours() {
        let mut map = map(Colours::Sequential);
        map.rows = vec![vec![0.99995, 1.0]];
        let (low, high) = map.limits();
        assert!((high - low - 0.1).abs() < 1e-12 && low < 0.96 && high > 1.04, "{low} … {high}");
        let [first, last] = [0.99995, 1.0].map(|value| map.colour(value, (low, high)));
        assert!(last.abs_diff(first) < 2, "{first}, {last}");
        let words = map.range_words();
        assert!(
            words.contains("From 0.99995 to 1.0000 m; the colours span 0.950 to 1.05"),
            "{words}"
        );
        map.rows = vec![vec![0.2, 1.0]];
        assert_eq!((map.limits(), map.range_words().contains("span")), ((0.2, 1.0), false));
    }
}
