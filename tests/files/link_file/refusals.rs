use super::{EXAMPLE, SHORT, read_with};
use crate::snapshot;

#[test]
fn refusals_are_those_of_the_snapshot() {
    snapshot::compare("link_file.txt", |section, setting, input| {
        let file = match section {
            "Keys of a segment" => format!("[[segments]]\n{input}"),
            "Below a link in line 1" => format!("{SHORT}{input}"),
            "Settings of the example" => EXAMPLE.to_owned(),
            _ => input.to_owned(),
        };
        let settings = Some(setting).filter(|setting| !setting.is_empty());
        let error = read_with(&file, settings.as_slice()).expect_err(&file);
        snapshot::told(&error, error.hint())
    });
}
