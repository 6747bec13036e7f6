use std::borrow::Cow;

/// A piece of an input as a message quotes it: control characters told, so that it stays on its line
/// and no terminal obeys it.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return text.into();
    }
    let mut told = String::with_capacity(text.len() + 8);
    for letter in text.chars() {
        match letter {
            letter if letter.is_control() => told.extend(letter.escape_debug()),
            letter => told.push(letter),
        }
    }
    told.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_told_and_no_other() {
        assert_eq!(visible("m\u{1b}[31m\t'µ²'\n\u{85}"), "m\\u{1b}[31m\\t'µ²'\\n\\u{85}");
        assert_eq!(visible("N m²"), "N m²");
    }
}
