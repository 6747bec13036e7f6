use std::sync::LazyLock;

use super::text_of;
use super::wording::check_words;
use flexlink::spec::{LinkDocument, Override, SpecError, Specification};

const LINK: &str = "link.toml";

/// The published links, as files and as they are without any change.
static LINKS: LazyLock<Vec<(LinkDocument, Specification)>> = LazyLock::new(|| {
    let texts = [
        include_str!("../../specs/bayo1987_example1.toml"),
        include_str!("../../specs/gu_petkov.toml"),
        include_str!("../../specs/quanser_flexgage.toml"),
        include_str!("../../specs/rome_link.toml"),
        include_str!("../all_keys.toml"),
    ];
    let read = |text| {
        let document = LinkDocument::read(LINK, text).expect("a link file");
        let unchanged = document.specification(LINK, &[]).expect("a link");
        (document, unchanged)
    };
    texts.map(read).into()
});

/// Laws: each line is refused with words, or is a change that keeps those of a link file.
///
/// # Panics
/// If one is broken.
pub fn override_path(bytes: &[u8]) {
    let text = text_of(bytes);
    let changes: Result<Vec<Override>, SpecError> = text.lines().map(str::parse).collect();
    match changes {
        Err(error) => check_words("--set '", &error, error.hint()),
        Ok(changes) => LINKS.iter().for_each(|link| check(link, &changes, text)),
    }
}

// Laws: changes are refused with words, or make a link; a value that is set again changes nothing, if
// it is still there under its name; nor does a factor of 1, nor one of 2 that one of a half follows.
fn check((document, unchanged): &(LinkDocument, Specification), changes: &[Override], text: &str) {
    match document.specification(LINK, changes) {
        Err(error) => check_words("", &error, error.hint()),
        Ok(changed) => {
            let last = changes.last().cloned();
            let again: Vec<Override> = changes.iter().cloned().chain(last).collect();
            let replaces = !text.lines().last().is_some_and(multiplies);
            if let (true, Ok(again)) = (replaces, document.specification(LINK, &again)) {
                assert_eq!(again, changed, "{text:?} again");
            }
        }
    }
    for line in text.lines().filter(|line| multiplies(line)) {
        let by = |factors: &[&str]| {
            let path = line.split('=').next().unwrap_or_default();
            let factors = factors.iter().map(|factor| format!("{path}={factor}").parse());
            document.specification(LINK, &factors.collect::<Result<Vec<_>, _>>().expect(line))
        };
        if let Ok(once) = by(&["1"]) {
            assert_eq!(&once, unchanged, "{line:?} by 1");
            assert_eq!(by(&["2", "0.5"]).as_ref(), Ok(unchanged), "{line:?} by 2 and a half");
        }
    }
}

fn multiplies(line: &str) -> bool {
    line.split('=').next().is_some_and(|path| path.trim_end().ends_with('*'))
}
