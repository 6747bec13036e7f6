//! Times of day and dates with times, as loggers and spreadsheets write them.

use std::fmt;

/// Seconds in a day.
const DAY_S: i64 = 86_400;

/// An instant as written: a time of day such as `17:24:05.123`, with or without a date.
#[derive(Debug, Clone, PartialEq)]
pub struct ClockTime {
    text: String,
    date: Date,
    /// Whole seconds from 1970, or from midnight without a date.
    whole_s: i64,
    /// The rest, from 0 to below 1 s, of days to below a day.
    part_s: f64,
    /// True if the text names its distance from UTC.
    has_zone: bool,
}

/// Unit of a count of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CountUnit {
    Days,
    /// A number of units in a second.
    PerSecond(i64),
}

impl CountUnit {
    /// The unit of this duration in s, if there is one.
    pub(super) fn of_seconds(unit_s: f64) -> Option<Self> {
        let is_of = |per_s: &i64| (unit_s * *per_s as f64 - 1.0).abs() < 1e-9;
        let per_s = [1, 1_000, 1_000_000, 1_000_000_000].into_iter().find(is_of);
        let is_day = (unit_s / DAY_S as f64 - 1.0).abs() < 1e-9;
        per_s.map(Self::PerSecond).or_else(|| is_day.then_some(Self::Days))
    }
}

/// The date of an instant.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Date {
    Absent,
    Known,
    /// A count of days, whose first day differs between programs.
    Counted,
    /// A date such as `11/30/2026`, which shows whether the month is first.
    Slashed {
        is_month_first: bool,
    },
    /// A date such as `11/12/2026`, whose day and month are in doubt: its days from 1970 with the month first and with the
    /// day first.
    Doubtful(String, [i64; 2]),
}

/// The instant as written.
impl fmt::Display for ClockTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl ClockTime {
    /// Reads an instant; `None` for other text.
    ///
    /// Dates are `2026-11-30`, `2026/11/30`, `20261130`, `30.11.2026` and `11/30/2026`, before a blank or a `T`. A time has
    /// a point or a comma before the decimals of its seconds. `AM`, `PM`, `Z`, `UTC` or an offset such as `+01:00` may
    /// follow. `24:05.1`, as spreadsheets write it, is minutes and seconds.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        // The t of Oct divides nothing.
        let is_end = |(at, letter): (usize, char)| {
            let is_after_digit = text[..at].ends_with(|c: char| c.is_ascii_digit());
            (letter == ' ' || is_after_digit && "Tt".contains(letter)).then_some(at)
        };
        let end = text.char_indices().find_map(is_end).filter(|_| has_date(text));
        let (date, rest) = match end {
            Some(at) => (Some(&text[..at]), text[at + 1..].trim()),
            None => (None, text),
        };
        let (date, days) = match date {
            None => (Date::Absent, 0),
            Some(date) => read_date(date)?,
        };
        let (rest, zone_s) = split_zone(rest)?;
        let (rest, afternoon) = split_half(rest);
        let (seconds, part_s) = read_time(rest, date != Date::Absent)?;
        let seconds = match afternoon {
            None => seconds,
            Some(_) if !(3600..13 * 3600).contains(&seconds) => return None,
            Some(is_afternoon) => seconds % (12 * 3600) + if is_afternoon { 12 * 3600 } else { 0 },
        };
        Some(Self {
            text: text.to_owned(),
            date,
            whole_s: days * DAY_S + seconds - zone_s.unwrap_or(0),
            part_s,
            has_zone: zone_s.is_some(),
        })
    }

    /// A count of whole units and a part of one: of days, or of a unit since 1970 in UTC.
    pub(super) fn of_count(text: String, (count, part): (i64, f64), unit: CountUnit) -> Self {
        let (date, whole_s, part_s) = match unit {
            CountUnit::Days => (Date::Counted, count.saturating_mul(DAY_S), part * DAY_S as f64),
            CountUnit::PerSecond(per_s) => {
                let part_s = (count.rem_euclid(per_s) as f64 + part) / per_s as f64;
                (Date::Known, count.div_euclid(per_s), part_s)
            }
        };
        Self { text, date, whole_s, part_s, has_zone: true }
    }

    /// Time in s from another instant to this one; `None` if one has a date or a zone and the other has none, and for
    /// different dates in doubt.
    pub(super) fn since(&self, other: &Self) -> Option<f64> {
        let is_known = |own: &Self| matches!(own.date, Date::Known | Date::Slashed { .. });
        let is_dated_alike = self.date == other.date || is_known(self) && is_known(other);
        let is_alike = is_dated_alike && self.has_zone == other.has_zone;
        is_alike.then(|| (self.whole_s - other.whole_s) as f64 + (self.part_s - other.part_s))
    }

    /// True if this time of day without a date is on the day after another one: it is earlier by more than half a day.
    pub(super) fn is_past_midnight(&self, before: &Self) -> bool {
        let is_bare = self.date == Date::Absent && before.date == Date::Absent;
        is_bare && before.whole_s - self.whole_s > DAY_S / 2
    }

    /// True if day and month are in doubt.
    pub(super) fn is_doubtful(&self) -> bool {
        matches!(self.date, Date::Doubtful(..))
    }

    /// The instant with day and month in the order of another date, if that one shows it.
    pub(super) fn in_order_of(self, other: &Self) -> Self {
        let (Date::Doubtful(_, days), Date::Slashed { is_month_first }) = (&self.date, &other.date)
        else {
            return self;
        };
        let days = days[usize::from(!is_month_first)];
        Self { date: other.date.clone(), whole_s: self.whole_s + days * DAY_S, ..self }
    }

    /// The same instant some days later.
    pub(super) fn later_by(self, days: i64) -> Self {
        Self { whole_s: self.whole_s + days * DAY_S, ..self }
    }
}

/// True if a text begins with a date.
fn has_date(text: &str) -> bool {
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    digits == 8 || text[digits..].starts_with(['-', '/']) || {
        let first = text.split(['T', 't', ' ']).next().unwrap_or_default();
        first.matches('.').count() == 2 && !first.contains(':')
    }
}

/// True for a date without a time.
pub(super) fn is_date(text: &str) -> bool {
    read_date(text.trim()).is_some()
}

/// A whole number of this many digits, at least and at most.
fn number(text: &str, [least, most]: [usize; 2]) -> Option<i64> {
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit());
    ((least..=most).contains(&text.len()) && is_number).then(|| text.parse().ok())?
}

const MONTHS: [&str; 12] =
    ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

/// A date, and its days from 1970; 0 for a date in doubt.
fn read_date(text: &str) -> Option<(Date, i64)> {
    let known = |year: &str, month: &str, day: &str| {
        let days =
            days_from_1970(number(year, [4, 4])?, number(month, [1, 2])?, number(day, [1, 2])?)?;
        Some((Date::Known, days))
    };
    let slashed =
        |(_, days): (Date, i64), is_month_first| Some((Date::Slashed { is_month_first }, days));
    let parts =
        |sign: char| -> Option<[&str; 3]> { text.split(sign).collect::<Vec<_>>().try_into().ok() };
    if let Some([first, month, last]) = parts('-') {
        // MATLAB writes 30-Nov-2026.
        let named = MONTHS.iter().position(|own| own.eq_ignore_ascii_case(month));
        return named.map_or_else(
            || known(first, month, last),
            |named| known(last, &(named + 1).to_string(), first),
        );
    }
    if let Some([day, month, year]) = parts('.') {
        return known(year, month, day);
    }
    if let Some([first, second, year]) = parts('/') {
        if first.len() == 4 {
            return known(first, second, year);
        }
        let [one, other] = [number(first, [1, 2])?, number(second, [1, 2])?];
        return match (one > 12, other > 12) {
            (true, _) => slashed(known(year, second, first)?, false),
            (_, true) => slashed(known(year, first, second)?, true),
            // Any two rows of one such date have the same day.
            _ => {
                let days = [known(year, first, second)?.1, known(year, second, first)?.1];
                Some((Date::Doubtful(text.to_owned(), days), 0))
            }
        };
    }
    let is_basic = text.len() == 8 && text.is_ascii();
    is_basic.then(|| known(&text[..4], &text[4..6], &text[6..]))?
}

/// Days from 1970-01-01 of a date of the Gregorian calendar.
fn days_from_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let february = if is_leap { 29 } else { 28 };
    let lengths = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let before = usize::try_from(month - 1).ok().filter(|before| *before < 12)?;
    if !(1..=lengths[before]).contains(&day) {
        return None;
    }
    let leaps = |year: i64| year / 4 - year / 100 + year / 400;
    let years = 365 * (year - 1970) + leaps(year - 1) - leaps(1969);
    Some(years + lengths[..before].iter().sum::<i64>() + day - 1)
}

/// The time before its zone, and the distance of the zone from UTC in s.
fn split_zone(text: &str) -> Option<(&str, Option<i64>)> {
    for word in ["Z", "z", "UTC", "GMT"] {
        if let Some(rest) = text.strip_suffix(word) {
            return Some((rest.trim(), Some(0)));
        }
    }
    let Some(at) = text.rfind(['+', '-', '\u{2212}']) else { return Some((text, None)) };
    let sign = if text[at..].starts_with('+') { 1 } else { -1 };
    let digits = text[at..].trim_start_matches(['+', '-', '\u{2212}']).replace(':', "");
    let (hours, minutes) = match digits.len() {
        _ if !digits.is_ascii() => return None,
        2 => (number(&digits, [2, 2])?, 0),
        4 => (number(&digits[..2], [2, 2])?, number(&digits[2..], [2, 2])?),
        _ => return None,
    };
    let is_zone = hours < 24 && minutes < 60;
    is_zone.then(|| (text[..at].trim(), Some(sign * (3600 * hours + 60 * minutes))))
}

/// The time before AM or PM, and whether it is in the afternoon.
fn split_half(text: &str) -> (&str, Option<bool>) {
    let lower = text.to_ascii_lowercase();
    let halves = [("am", false), ("pm", true)];
    let half = halves.into_iter().find(|(word, _)| lower.ends_with(word));
    half.map_or((text, None), |(_, is_later)| (text[..text.len() - 2].trim(), Some(is_later)))
}

/// Seconds from midnight and their rest, of `17:24:05.123`, `17:24` after a date, `24:05.1` or `172405.123`.
fn read_time(text: &str, has_date: bool) -> Option<(i64, f64)> {
    let (clock, decimals) = match text.split_once(['.', ',']) {
        Some((clock, decimals)) => (clock, Some(decimals)),
        None => (text, None),
    };
    let part_s = match decimals {
        None => 0.0,
        Some(digits) if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
            format!("0.{digits}").parse().ok()?
        }
        Some(_) => return None,
    };
    let parts: Vec<&str> = clock.split(':').collect();
    let [hours, minutes, seconds] = match parts[..] {
        [hours, minutes, seconds] => [hours, minutes, seconds],
        [minutes, seconds] if decimals.is_some() && !has_date => ["0", minutes, seconds],
        [hours, minutes] if decimals.is_none() && has_date => [hours, minutes, "0"],
        [basic] if has_date && basic.len() == 6 && basic.is_ascii() => {
            [&basic[..2], &basic[2..4], &basic[4..]]
        }
        _ => return None,
    };
    let [hours, minutes, seconds] = [hours, minutes, seconds].map(|own| number(own, [1, 2]));
    let (hours, minutes, seconds) = (hours?, minutes?, seconds?);
    // A leap second is the 61st.
    (hours < 24 && minutes < 60 && seconds <= 60)
        .then_some((3600 * hours + 60 * minutes + seconds, part_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(text: &str) -> ClockTime {
        ClockTime::parse(text).unwrap_or_else(|| panic!("{text}"))
    }

    /// Seconds from 1970 by `date -u -d TEXT +%s`.
    #[test]
    fn dates_in_all_notations_are_the_same_instant() {
        let exact = time("2026-11-30T17:24:05.125Z");
        assert_eq!((exact.whole_s, exact.part_s), (1_796_059_445, 0.125));
        for text in [
            "2026-11-30 17:24:05,125 UTC",
            "2026-11-30T18:24:05.125+01:00",
            "2026-11-30T12:54:05.125-0430",
            "20261130T172405.125Z",
        ] {
            assert_eq!(time(text).since(&exact), Some(0.0), "{text}");
        }
        let local = time("30.11.2026 17:24:05,125");
        for text in [
            "2026/11/30 17:24:05.125",
            "30-Nov-2026 17:24:05.125",
            "11/30/2026 5:24:05.125 PM",
            "30/11/2026 17:24:05.125",
            "2026-11-30 17:24:05.125",
        ] {
            assert_eq!(time(text).since(&local), Some(0.0), "{text}");
        }
        assert_eq!(local.since(&exact), None, "one has no zone");
        assert_eq!(time("31-Oct-2026 10:00:00").since(&time("31.10.2026 10:00:00")), Some(0.0));
        let of_count = |text: &str, count, unit_s| {
            ClockTime::of_count(text.into(), count, CountUnit::of_seconds(unit_s).unwrap())
        };
        let milliseconds = of_count("ms", (1_796_059_445_125, 0.0), 1e-3);
        assert_eq!(milliseconds.since(&exact), Some(0.0));
        let [one, other] = [0.25, 0.5].map(|part| of_count("d", (46_356, part), 86_400.0));
        assert_eq!(other.since(&one), Some(21_600.0));
        assert_eq!(one.since(&exact), None, "programs count days from other dates");
        assert_eq!(CountUnit::of_seconds(60.0), None);
        for (text, whole_s) in [
            ("1970-01-01T00:00:00Z", 0),
            ("2000-02-29T12:00:00Z", 951_825_600),
            ("2100-03-01T00:00:00Z", 4_107_542_400),
            ("1969-12-31 23:59", -60),
        ] {
            assert_eq!(time(text).whole_s, whole_s, "{text}");
        }
    }

    #[test]
    fn times_of_day_pass_midnight_and_spreadsheets_write_minutes() {
        let [before, after] = ["23:59:59.9", "0:00:00.1"].map(time);
        assert!(after.is_past_midnight(&before) && !before.is_past_midnight(&after));
        let lasts_s = after.later_by(1).since(&before).unwrap();
        assert!((lasts_s - 0.2).abs() < 1e-12, "{lasts_s}");
        assert_eq!(time("24:05.5").since(&time("0:24:05.0")), Some(0.5));
        assert_eq!(time("12:00:01 AM").whole_s, 1);
        assert_eq!(time("12:00:01 PM").whole_s, 12 * 3600 + 1);
        let day = |text: &str| time(text);
        let doubtful = day("11/12/2026 10:00:01");
        assert_eq!(doubtful.since(&day("11/12/2026 10:00:00")), Some(1.0));
        assert_eq!(doubtful.since(&day("12/12/2026 10:00:00")), None, "days may be months");
        for (before, after) in [
            ("11/30/2026 23:59:59.5", "12/01/2026 0:00:00"),
            ("31/12/2026 23:59:59.5", "1/1/2027 0:00:00"),
        ] {
            let before = day(before);
            assert_eq!(day(after).in_order_of(&before).since(&before), Some(0.5), "{after}");
        }
    }

    #[test]
    fn other_text_is_no_instant() {
        for text in [
            "",
            "T",
            ":",
            "12",
            "0.5",
            "17:24",
            "0:00:00:01",
            "25:00:00",
            "10:60:00",
            "10:00:61",
            "2026-02-29 10:00:00",
            "2026-13-01 10:00:00",
            "2026-11-30",
            "30.11.2026",
            "1.5e-3",
            "13:00:00 PM",
            "10:00:00.1.2",
            "10:00:00+5",
            "-1:00:00",
            "x:y:z",
            "1/2/3",
            "é:00:00",
            "2026-11-30Té",
            "20261130 é",
            "+01:00",
            "Z",
            "10:00:0é",
            "-0.001",
            "1,5",
        ] {
            assert_eq!(ClockTime::parse(text), None, "{text}");
        }
    }
}
