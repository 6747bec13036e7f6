//! The README's commands print what it says, its link file is read, and help texts and refusals are as
//! they were read last.

use flexlink::spec::read_specification;

#[test]
fn commands_of_the_readme_help_texts_and_refusals_print_what_is_shown() {
    // In what it compares and writes, trycmd shows the backslash that continues a line as a slash.
    let cases = trycmd::TestCases::new();
    // On any machine: letters in UTF-8, lines as wide as this program makes them.
    cases.env("LC_ALL", "C.UTF-8").env("COLUMNS", "100").env("NO_COLOR", "1");
    cases.case("README.md").case("tests/help/*.trycmd").case("tests/refusals/*.trycmd");
}

#[test]
fn the_link_file_of_the_readme_is_read() {
    let readme = include_str!("../README.md");
    let (_, rest) = readme.split_once("```toml\n").unwrap();
    let (example, _) = rest.split_once("```").unwrap();
    let specification = read_specification("README.md", example, &[]).unwrap();
    assert_eq!(specification.link.segments().len(), 2);
    assert_eq!(specification.link.masses().len(), 1);
    assert!(!specification.mesh.is_automatic());
}
