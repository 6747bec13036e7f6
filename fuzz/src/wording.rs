use std::error::Error;

/// Law: a refusal says something, on one line, that no terminal obeys; and where, if `place` does.
///
/// # Panics
/// If it does not.
pub fn check_words(place: &str, error: &impl Error, hint: Option<&str>) {
    let message = error.to_string();
    assert!(message.starts_with(place), "not of {place}: {message:?}");
    for text in [Some(message.as_str()), hint].into_iter().flatten() {
        assert!(!text.trim().is_empty(), "says nothing: {message:?}");
        assert!(!text.contains(char::is_control), "a control character: {text:?}");
    }
}
