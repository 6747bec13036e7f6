use std::borrow::Cow;

/// Characters of an input that a message quotes at most.
const LONGEST: usize = 60;

/// A piece of an input as a message quotes it: control characters, and those that turn the direction
/// of writing, told, so that it stays on its line and no terminal obeys it.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return text.into();
    }
    let mut told = String::with_capacity(text.len() + 8);
    for letter in text.chars() {
        match letter {
            letter if letter.is_control() => told.extend(letter.escape_debug()),
            letter if is_hidden(letter) => told.extend(letter.escape_unicode()),
            letter => told.push(letter),
        }
    }
    told.into()
}

/// A document as it is shown, its line ends and tabs kept.
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

/// The beginning of a piece of an input, with a mark where more follows: what a message quotes.
pub fn excerpt(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(LONGEST) {
        None => text.into(),
        Some((end, _)) => format!("{}…", &text[..end]).into(),
    }
}

/// Whether a character is not seen but obeyed: a control character, or one that turns the direction
/// of writing.
pub fn is_hidden(letter: char) -> bool {
    let turns = matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}')
        || matches!(letter, '\u{2066}'..='\u{2069}');
    turns || letter.is_control()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_told_and_no_other() {
        assert_eq!(visible("m\u{1b}[31m\t'µ²'\n\u{85}"), "m\\u{1b}[31m\\t'µ²'\\n\\u{85}");
        assert_eq!(visible("N m²"), "N m²");
    }

    #[test]
    fn a_document_keeps_its_line_ends_and_tabs() {
        assert_eq!(visible_document("a\n\tb\u{202e}\u{7}c"), "a\n\tb\\u{202e}\\u{7}c");
    }

    #[test]
    fn what_turns_the_direction_of_writing_is_told() {
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
}
