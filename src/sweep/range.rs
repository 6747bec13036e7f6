//! The values of `START:STOP:COUNT[:log]`.

use super::variation::VariationError;
use crate::numeric::{excerpt, rounded, split_number};

/// Digits that values between the ends of a range are given.
const DIGITS: usize = 15;

/// Most values of one range.
const MOST: usize = 1_000_000;

/// Values of a range as text, and the unit that both its ends have.
pub(super) struct Range {
    pub(super) values: Vec<String>,
    pub(super) unit: String,
}

impl Range {
    /// Reads what stands between the colons of a range.
    pub(super) fn read(parts: &[&str]) -> Result<Self, VariationError> {
        let text = parts.join(":");
        let text = excerpt(&text);
        let refuse =
            |must: &str| Err(VariationError::refusing(format!("range = {text:?}, but {must}")));
        let (start, stop, count, logarithmic) = match *parts {
            [start, stop, count] => (start, stop, count, false),
            [start, stop, count, "log"] => (start, stop, count, true),
            _ => return refuse("must read START:STOP:COUNT or START:STOP:COUNT:log"),
        };
        let number = |text: &str| {
            let split = split_number(text).filter(|(number, _)| number.is_finite());
            split.map(|(number, unit)| (number, unit.trim().to_owned()))
        };
        let (Some((start, unit)), Some((stop, stop_unit))) = (number(start), number(stop)) else {
            return refuse("must begin with two finite numbers");
        };
        if unit != stop_unit {
            return refuse("must have the same unit at both ends");
        }
        let count = match count.parse::<usize>() {
            Ok(count) if (1..=MOST).contains(&count) => count,
            _ => return refuse(&format!("must have a count from 1 to {MOST}")),
        };
        if count == 1 && start.total_cmp(&stop).is_ne() {
            return refuse("must have a count of 2 or more to reach both ends");
        }
        let one_sign = start.signum() * stop.signum() > 0.0 && start != 0.0 && stop != 0.0;
        if logarithmic && !one_sign {
            return refuse("must have ends of one sign, neither of them 0, to be logarithmic");
        }
        let at = |k: usize| value(start, stop, (k, count - 1), logarithmic);
        Ok(Self { values: (0..count).map(|k| shortest(at(k))).collect(), unit })
    }
}

/// Value `k` of `0 ..= last`, the ends exact.
fn value(start: f64, stop: f64, (k, last): (usize, usize), logarithmic: bool) -> f64 {
    if k == 0 {
        return start;
    }
    if k == last {
        return stop;
    }
    let share = k as f64 / last as f64;
    let between = if logarithmic {
        // Neither their product nor their quotient, which may be beyond all numbers.
        start.signum() * libm::pow(start.abs(), 1.0 - share) * libm::pow(stop.abs(), share)
    } else {
        (1.0 - share) * start + share * stop
    };
    rounded(between, DIGITS)
}

/// The shortest text that reads back to the same number, in a link file, too.
fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if (1e-4..1e15).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        range(text).unwrap().values
    }

    fn range(text: &str) -> Result<Range, VariationError> {
        Range::read(&text.split(':').map(str::trim).collect::<Vec<_>>())
    }

    fn refusal(text: &str) -> String {
        range(text).err().unwrap().to_string()
    }

    #[test]
    fn a_range_holds_both_ends_and_even_steps_between() {
        assert_eq!(values("0.1:0.5:5"), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("10:30:3"), ["10", "20", "30"]);
        assert_eq!(values("1:-1:3"), ["1", "0", "-1"]);
        assert_eq!(values("7:7:1"), ["7"]);
        assert_eq!(values("1e20 : 3e20 : 3"), ["1e20", "2e20", "3e20"]);
    }

    #[test]
    fn a_logarithmic_range_has_even_ratios() {
        assert_eq!(values("0.01:100:5:log"), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(values("-8:-1:4:log"), ["-8", "-4", "-2", "-1"]);
        assert_eq!(values("1e-200:1e-150:3:log")[1], "1e-175");
        assert_eq!(values("1e-200:1e200:3:log")[1], "1");
        let found: Vec<f64> = values("2:5:4:log").iter().map(|v| v.parse().unwrap()).collect();
        assert!((found[1] / found[0] - 2.5_f64.cbrt()).abs() < 1e-14);
    }

    #[test]
    fn a_unit_stands_at_both_ends() {
        let range = range("5e4 N cm^2:2e5 N cm^2:2").unwrap();
        assert_eq!((range.values[1].as_str(), range.unit.as_str()), ("200000", "N cm^2"));
        assert!(refusal("10 g:1 kg:3").ends_with("must have the same unit at both ends"));
    }

    #[test]
    fn what_is_no_range_is_refused_with_what_it_must_be() {
        assert!(refusal("1:2").contains("must read START:STOP:COUNT"));
        assert!(refusal("1:2:3:cubic").contains("must read START:STOP:COUNT"));
        assert!(refusal("a:2:3").contains("two finite numbers"));
        assert!(refusal("1:2:0").contains("a count from 1"));
        assert!(refusal("1:2:2.5").contains("a count from 1"));
        assert!(refusal("1:2:1").contains("a count of 2 or more"));
        assert!(refusal("-1:2:3:log").contains("one sign"));
        assert!(refusal("0:2:3:log").contains("neither of them 0"));
    }
}
