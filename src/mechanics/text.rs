//! Text of numbers and pieces of an input in messages.

use std::borrow::Cow;
use std::path::Path;

/// Upper limit of a number's decimals; the formatter of the standard library takes a few more.
const MOST_DECIMALS: usize = 1100;

/// A time before an event in words, with `digits` significant digits: a negative one lies after it.
///
/// ```
/// use flexlink::text::{after, before};
/// assert_eq!(before(0.3051, 3) + " the motion", "0.305 s before the motion");
/// assert_eq!(before(-0.024, 2) + " the motion begins", "0.024 s after the motion begins");
/// assert_eq!(after(-0.5, 1) + " it ends", "0.5 s before it ends");
/// ```
pub fn before(ahead_s: f64, digits: usize) -> String {
    let side = if ahead_s < 0.0 { "after" } else { "before" };
    format!("{} s {side}", significant(ahead_s.abs(), digits))
}

/// A time after an event in words, as [`before`]: a negative one lies before it.
pub fn after(later_s: f64, digits: usize) -> String {
    let side = if later_s < 0.0 { "before" } else { "after" };
    format!("{} s {side}", significant(later_s.abs(), digits))
}

/// A number with `digits` significant digits, for people; scientific below 0.001 and from a million
/// on.
///
/// ```
/// use flexlink::text::significant;
/// assert_eq!(significant(0.526_425_1, 4), "0.5264");
/// assert_eq!(significant(1.5e-4, 2), "1.5e-4");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    let after_first = digits.saturating_sub(1).min(MOST_DECIMALS);
    let scientific = format!("{value:.after_first$e}");
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse::<isize>().ok());
    match exponent {
        Some(exponent) if (-3..6).contains(&exponent) => {
            let decimals = after_first.saturating_add_signed(-exponent);
            format!("{value:.decimals$}")
        }
        _ => scientific,
    }
}

/// A time in s for people: like [`significant`], but with milliseconds from a million seconds on, as epochs need.
///
/// ```
/// use flexlink::text::instant;
/// assert_eq!(instant(0.526_425_1, 4), "0.5264");
/// assert_eq!(instant(1_772_620_001.336_4, 3), "1772620001.336");
/// ```
pub fn instant(time_s: f64, digits: usize) -> String {
    if (1e6..1e12).contains(&time_s.abs()) {
        format!("{time_s:.3}")
    } else {
        significant(time_s, digits)
    }
}

/// Number of significant digits, two to six, that shows that a number exceeds its bound; two if it does not.
pub fn digits_beyond(found: f64, bound: f64) -> usize {
    let differs = |after: &usize| format!("{found:.after$e}") != format!("{bound:.after$e}");
    1 + (1..5).find(|after| found <= bound || differs(after)).unwrap_or(5)
}

/// A number with all its digits, for people; with a power of ten if it is far from 1.
///
/// ```
/// use flexlink::text::plain;
/// assert_eq!([2.0, 0.25, 1e300].map(plain), ["2", "0.25", "1e300"]);
/// ```
pub fn plain(value: f64) -> String {
    let is_near = value == 0.0 || !value.is_finite() || (1e-5..1e16).contains(&value.abs());
    if is_near { value.to_string() } else { format!("{value:e}") }
}

/// An input number for people: with all its digits, or with six if they are many, for example after a conversion of
/// units.
///
/// ```
/// use flexlink::text::given;
/// assert_eq!([2.0, 0.25, 314.159_265_358_979_3].map(given), ["2", "0.25", "314.159"]);
/// ```
pub fn given(value: f64) -> String {
    let plain = plain(value);
    if plain.len() <= 8 { plain } else { significant(value, 6) }
}

/// A number of things, in singular or plural.
///
/// ```
/// use flexlink::text::counted;
/// assert_eq!([1, 2].map(|number| counted(number, "key")), ["1 key", "2 keys"]);
/// ```
pub fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// A share in percent, for people.
///
/// ```
/// use flexlink::text::about_percent;
/// assert_eq!([0.0123, 1.7].map(about_percent), ["about 1.2 %", "100 % and more"]);
/// ```
pub fn about_percent(share: f64) -> String {
    if share < 1.0 {
        format!("about {} %", significant(100.0 * share, 2))
    } else {
        "100 % and more".to_owned()
    }
}

/// Memory in GB, for people; in MB below a tenth of a GB.
///
/// ```
/// use flexlink::text::gigabytes;
/// assert_eq!(gigabytes(1_530_000_000), "1.5 GB");
/// assert_eq!(gigabytes(24_300_000), "24 MB");
/// ```
pub fn gigabytes(bytes: usize) -> String {
    if bytes < 100_000_000 {
        return format!("{} MB", significant(bytes as f64 / 1e6, 2));
    }
    format!("{} GB", significant(bytes as f64 / 1e9, 2))
}

/// Largest number of characters of an input that a message quotes.
const LONGEST: usize = 60;

/// A piece of an input for a message. Control characters, and those that change the direction of writing, are escaped,
/// so that the text stays on its line and no terminal executes it.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return text.into();
    }
    let mut escaped = String::with_capacity(text.len() + 8);
    for letter in text.chars() {
        match letter {
            letter if letter.is_control() => escaped.extend(letter.escape_debug()),
            letter if is_hidden(letter) => escaped.extend(letter.escape_unicode()),
            letter => escaped.push(letter),
        }
    }
    escaped.into()
}

/// A path for a line of text, with control characters escaped as in [`visible`].
pub fn shown_path(path: &Path) -> String {
    visible(&path.display().to_string()).into_owned()
}

/// A word of a command, quoted for a shell.
pub fn in_shell(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./=,:+%@".contains(c);
    if word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// The path of a file, quoted for a shell so that no program reads it as an option.
pub fn path_in_shell(path: &str) -> String {
    if path.starts_with('-') && path != "-" {
        in_shell(&format!("./{path}"))
    } else {
        in_shell(path)
    }
}

/// A document with the characters of [`visible`] escaped, except line ends and tabs.
pub fn visible_document(document: &str) -> String {
    let mut shown = String::with_capacity(document.len());
    for letter in document.chars() {
        match letter {
            '\n' | '\t' => shown.push(letter),
            letter if is_hidden(letter) => shown.extend(letter.escape_unicode()),
            letter => shown.push(letter),
        }
    }
    shown
}

/// The first 60 characters of a piece of an input, and `…` if more follow.
pub fn excerpt(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(LONGEST) {
        None => text.into(),
        Some((end, _)) => format!("{}…", &text[..end]).into(),
    }
}

/// True for a control character, and for one that changes the direction of writing.
pub fn is_hidden(letter: char) -> bool {
    let turns = matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}')
        || matches!(letter, '\u{2066}'..='\u{2069}');
    turns || letter.is_control()
}

/// Hint about the candidate with the spelling nearest to `word`, if one is near.
///
/// ```
/// use flexlink::text::did_you_mean;
/// let hint = did_you_mean("lenght", ["width", "length"]);
/// assert_eq!(hint.as_deref(), Some("did you mean `length`?"));
/// ```
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    let scores =
        candidates.into_iter().map(|candidate| (candidate, strsim::jaro_winkler(word, candidate)));
    let best = scores.reduce(|best, next| if next.1 > best.1 { next } else { best });
    let near = best.filter(|(_, score)| *score > 0.75);
    near.map(|(candidate, _)| format!("did you mean `{candidate}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_just_beyond_its_bound_looks_larger() {
        assert_eq!(digits_beyond(1.0004, 1.0), 5);
        assert_eq!(digits_beyond(1.03e-6, 1e-6), 3);
        assert_eq!(digits_beyond(0.9996, 1.0), 2);
        assert_eq!(digits_beyond(5.4e-1, 1e-2), 2);
        assert_eq!(digits_beyond(1.0 + 1e-12, 1.0), 6);
    }

    #[test]
    fn digits_are_significant_and_extremes_are_scientific() {
        assert_eq!(significant(181.588, 4), "181.6");
        assert_eq!(significant(123_456.7, 3), "123457");
        assert_eq!(significant(9.9996, 4), "10.00");
        assert_eq!(significant(1.5e7, 2), "1.5e7");
        assert_eq!(significant(0.0, 3), "0.00");
        assert_eq!(significant(1.0, usize::MAX).len(), 1102);
    }

    #[test]
    fn control_characters_are_escaped_and_no_other() {
        assert_eq!(visible("m\u{1b}[31m\t'µ²'\n\u{85}"), "m\\u{1b}[31m\\t'µ²'\\n\\u{85}");
        assert_eq!(visible("N m²"), "N m²");
    }

    #[test]
    fn a_document_keeps_its_line_ends_and_tabs() {
        assert_eq!(visible_document("a\n\tb\u{202e}\u{7}c"), "a\n\tb\\u{202e}\\u{7}c");
    }

    #[test]
    fn what_turns_the_direction_of_writing_is_escaped() {
        let all = "\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}\
                   \u{200e}\u{200f}\u{61c}";
        let told = visible(all).into_owned();
        assert!(told.starts_with("\\u{202a}\\u{202b}") && told.is_ascii(), "{told}");
        assert_eq!(told.matches("\\u{").count(), all.chars().count());
        assert_eq!(visible("שלום \u{200d}"), "שלום \u{200d}", "letters are left alone");
    }

    #[test]
    fn an_excerpt_has_sixty_characters_and_says_that_there_is_more() {
        let sixty = "µ".repeat(60);
        assert_eq!(excerpt(&sixty), sixty);
        assert_eq!(excerpt(&format!("{sixty}x")), format!("{sixty}…"));
    }

    #[test]
    fn a_misspelt_word_is_near_the_meant_one_and_a_strange_one_near_none() {
        let known = ["length", "mass_per_length", "EI", "elements"];
        let meant = |word: &str| Some(format!("did you mean `{word}`?"));
        assert_eq!(did_you_mean("lenght", known), meant("length"));
        assert_eq!(did_you_mean("mass_per_lenght", known), meant("mass_per_length"));
        assert_eq!(did_you_mean("colour", known), None);
    }

    #[test]
    fn a_shell_reads_words_as_they_were() {
        for (word, text) in [
            ("--window", "--window"),
            ("payload.mass=\"50 g\"", "'payload.mass=\"50 g\"'"),
            ("it's", "'it'\\''s'"),
        ] {
            assert_eq!(in_shell(word), text);
        }
        for (path, text) in [("-rf.csv", "./-rf.csv"), ("-", "-"), ("-a b", "'./-a b'"), ("a", "a")]
        {
            assert_eq!(path_in_shell(path), text);
        }
    }
}
