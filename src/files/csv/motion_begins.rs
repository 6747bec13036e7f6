//! The line of a table that says when its motion begins and whether a drive holds its rows, and the shift to the times of the
//! motion's file.

use std::fmt;

use crate::numeric::rounded;
use crate::text::plain;

/// Beginning of the line.
const BEGINS: &str = "motion begins at ";

/// Before the time in the motion's file.
const IN_FILE: &str = ", in its file at ";

/// After the times, of a table whose values are for a converter or a drive that holds them.
const HELD: &str = ", held to the next row";

/// Decimals of the times.
const DECIMALS: f64 = 1e12;

/// When a motion begins in a table, and when in the motion's file: `# motion begins at 0.044 s, in its file at 0 s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionBegins {
    /// Time in s of the table.
    pub time_s: f64,
    /// Time in s of the motion's file, and of all tables without the line.
    pub in_file_s: f64,
    /// Whether each row is for a converter or a drive that holds it to the next one.
    pub is_held: bool,
}

impl fmt::Display for MotionBegins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [time, in_file] = [self.time_s, self.in_file_s].map(plain);
        let held = if self.is_held { HELD } else { "" };
        write!(f, "{BEGINS}{time} s{IN_FILE}{in_file} s{held}")
    }
}

impl MotionBegins {
    /// The line of these times, without their round-off.
    pub fn new(time_s: f64, in_file_s: f64, is_held: bool) -> Self {
        let [time_s, in_file_s] = [time_s, in_file_s].map(|time_s| {
            let shown = (time_s * DECIMALS).round() / DECIMALS;
            if shown.is_finite() { shown + 0.0 } else { time_s }
        });
        Self { time_s, in_file_s, is_held }
    }

    /// Finds the line among the comments above a table. Without the time in its file, the motion begins there at 0 s.
    pub fn find(bytes: &[u8]) -> Option<Self> {
        let lines = bytes.split(|byte| *byte == b'\n').map(String::from_utf8_lossy);
        let mut comments = lines.map_while(|line| {
            let line = line.trim_start_matches('\u{feff}').trim().to_owned();
            (line.is_empty() || line.starts_with('#')).then_some(line)
        });
        comments.find_map(|line| Self::of_line(line.strip_prefix('#')?.trim()))
    }

    fn of_line(line: &str) -> Option<Self> {
        let rest = line.strip_prefix(BEGINS)?;
        let (rest, is_held) = rest.strip_suffix(HELD).map_or((rest, false), |rest| (rest, true));
        let (time, in_file) = rest.split_once(IN_FILE).unwrap_or((rest, "0 s"));
        let seconds = |text: &str| -> Option<f64> {
            text.strip_suffix(" s")?.trim().parse().ok().filter(|time: &f64| time.is_finite())
        };
        Some(Self { time_s: seconds(time)?, in_file_s: seconds(in_file)?, is_held })
    }

    /// Shift in s from the times of the table to those of the motion's file.
    pub(super) fn shift_s(self) -> f64 {
        rounded(self.in_file_s - self.time_s, 13)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_read_as_it_is_written() {
        let begins = MotionBegins::new(0.1 + 0.2, -1.5, false);
        let held = MotionBegins { is_held: true, ..begins };
        assert_eq!(MotionBegins::find(format!("# {held}\ntime_s\n").as_bytes()), Some(held));
        let table = format!("# {begins}\n# more\ntime_s,torque_n_m\n");
        assert!(table.starts_with("# motion begins at 0.3 s, in its file at -1.5 s\n"), "{table}");
        assert_eq!(MotionBegins::find(table.as_bytes()), Some(begins));
        let by_hand = "\u{feff}\n#motion begins at 0.044 s\r\ntime_s\n";
        let found = MotionBegins::new(0.044, 0.0, false);
        assert_eq!(MotionBegins::find(by_hand.as_bytes()), Some(found));
        for other in
            ["time_s\n# motion begins at 1 s\n", "# motion begins at x s\n", "# motion\n", ""]
        {
            assert_eq!(MotionBegins::find(other.as_bytes()), None, "{other}");
        }
    }

    #[test]
    fn the_shift_leads_to_the_times_of_the_file() {
        let shift_s = |time_s, in_file_s| MotionBegins::new(time_s, in_file_s, false).shift_s();
        let found = [shift_s(0.3, 0.1), shift_s(2.0, 2.0)];
        assert_eq!(found.map(f64::to_bits), [-0.2, 0.0].map(f64::to_bits));
    }
}
