//! Text for people where the locale takes nothing but ASCII.

use std::borrow::Cow;
use std::env;
use std::ffi::OsStr;

/// The text as the locale can show it.
pub(super) fn shown(text: &str) -> Cow<'_, str> {
    if text.is_ascii() || is_utf8(|name| env::var_os(name)) {
        text.into()
    } else {
        ascii(text).into()
    }
}

/// Whether the locale is one of UTF-8: the first of the variables that POSIX looks at which says
/// anything. Where none does, as on Windows, it is taken to be.
fn is_utf8<T: AsRef<OsStr>>(variable: impl Fn(&str) -> Option<T>) -> bool {
    let said = |name| variable(name).filter(|value| !value.as_ref().is_empty());
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(said);
    locale.is_none_or(|locale| {
        // language_territory.charset@modifier; some systems set the charset alone.
        let locale = locale.as_ref().to_string_lossy();
        let charset = locale.split_once('.').map_or(&*locale, |(_, charset)| charset);
        let charset = charset.split('@').next().unwrap_or_default();
        matches!(charset.to_lowercase().as_str(), "utf-8" | "utf8")
    })
}

/// The text in ASCII: this program's own signs as they are typed, any other letter as `?`.
fn ascii(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        if letter.is_ascii() {
            plain.push(letter);
            continue;
        }
        let typed = typed(letter);
        // A cell that was set to the right of its column stays there.
        let blanks = plain.len() - plain.trim_end_matches(' ').len();
        if blanks >= typed.len() {
            plain.truncate(plain.len() + 1 - typed.len());
        }
        plain.push_str(typed);
    }
    plain
}

fn typed(letter: char) -> &'static str {
    match letter {
        '\u{a0}' => " ",
        '²' => "^2",
        '³' => "^3",
        '⁴' => "^4",
        '±' => "+/-",
        '…' => "..",
        '→' => "->",
        '−' | '–' | '—' => "-",
        '×' | '·' | '⋅' => "*",
        '≤' => "<=",
        '≥' => ">=",
        '°' => "deg",
        'µ' | 'μ' => "u",
        '‘' | '’' => "'",
        '“' | '”' => "\"",
        'α' => "alpha",
        'β' => "beta",
        'θ' => "theta",
        'ξ' => "xi",
        'ζ' => "zeta",
        'ω' => "omega",
        _ => "?",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf8(variables: &[(&str, &'static str)]) -> bool {
        is_utf8(|name| variables.iter().find(|(set, _)| *set == name).map(|(_, value)| *value))
    }

    #[test]
    fn the_first_variable_that_says_anything_decides() {
        assert!(utf8(&[]));
        assert!(utf8(&[("LANG", ""), ("LC_ALL", "")]));
        assert!(!utf8(&[("LC_ALL", "C"), ("LC_CTYPE", "C.UTF-8"), ("LANG", "C.UTF-8")]));
        assert!(!utf8(&[("LC_ALL", ""), ("LC_CTYPE", "POSIX"), ("LANG", "C.UTF-8")]));
        assert!(utf8(&[("LC_CTYPE", "C.UTF-8"), ("LANG", "C")]));
    }

    #[test]
    fn a_locale_of_utf8_names_that_charset() {
        for locale in ["C.UTF-8", "en_US.utf8", "de_DE.UTF-8@euro", "UTF-8"] {
            assert!(utf8(&[("LANG", locale)]), "{locale}");
        }
        for locale in ["C", "POSIX", "en_US", "de_DE@euro", "ja_JP.eucJP", "de_DE.ISO-8859-15"] {
            assert!(!utf8(&[("LANG", locale)]), "{locale}");
        }
    }

    #[test]
    fn own_signs_are_typed_and_other_letters_are_marked() {
        assert_eq!(ascii("1 kg m² ± 2 … 3 → ξ"), "1 kg m^2 +/- 2 .. 3 -> xi");
        assert_eq!(ascii("Brückenträger 橋"), "Br?ckentr?ger ?");
    }

    #[test]
    fn a_cell_keeps_its_column() {
        assert_eq!(ascii("zero     ±[1/s]  lead"), "zero   +/-[1/s]  lead");
    }
}
