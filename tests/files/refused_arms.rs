//! Arms and paths that are refused, each with its line and what to do.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use flexlink::csv::{TableFormat, read_motion_table, read_motion_table_as};
use flexlink::inverse::{Resources, invert_motion};
use flexlink::spec::{Override, SpecError, Specification, read_measurements, read_specification};

use crate::snapshot::{self, told};

const ARM: &str = include_str!("../../specs/arms/two_links.toml");

fn read(text: &str, settings: &[&str]) -> Result<Specification, SpecError> {
    let overrides: Result<Vec<Override>, _> = settings.iter().map(|set| set.parse()).collect();
    read_specification("arm.toml", text, &overrides?)
}

/// The arm, or one with a third link as its last.
fn arm(links: usize) -> Specification {
    let last = "segments = [{ length = 0.3, EI = 15.0, mass_per_length = 0.4 }]";
    let text = match links {
        2 => ARM.to_owned(),
        _ => format!("{}\n[[links]]\nname = \"hand\"\n{last}\n", ARM.replace("payload", "tip")),
    };
    read(&text, &[]).unwrap()
}

/// Why an arm of so many links does not follow a path.
fn refusal_of_path(links: usize, text: &str) -> String {
    let Specification { arm, meshes, analysis, .. } = arm(links);
    let (lengths_m, format) = (arm.lengths_m(), TableFormat::default());
    let table = read_motion_table_as("path.csv", text.as_bytes(), &lengths_m, &format);
    let refused = table.and_then(|table| {
        let rows = table.rows().clone();
        let motion = table.into_motion()?;
        let solved = invert_motion(&arm, &meshes, &motion, &analysis, &Resources::default());
        let error = solved.err().unwrap();
        Err::<(), _>(rows.refused(error.sample(), &error, error.hint()))
    });
    let error = refused.unwrap_err();
    told(&error, error.hint())
}

/// Why measurements are not those of so many links.
fn refusal_of_measurements(text: &str, links: usize) -> String {
    let error = read_measurements("measured.toml", text, (links, false)).expect_err(text);
    told(&error, error.hint())
}

#[test]
fn refusals_are_those_of_the_snapshot() {
    snapshot::compare("arms.txt", |section, words, input| match section {
        "Paths: path.csv" => refusal_of_path(2, input),
        "Paths of an arm of three links: path.csv" => refusal_of_path(3, input),
        "Paths of an arm for one link: path.csv" => {
            let error = read_motion_table("path.csv", input.as_bytes(), 1.5).unwrap_err();
            told(&error, error.hint())
        }
        "Measurements of the arm: measured.toml" => refusal_of_measurements(input, 2),
        "Measurements of an arm for one link: measured.toml" => refusal_of_measurements(input, 1),
        "Settings of the arm: arm.toml" => {
            let error = read(ARM, &[words]).expect_err(words);
            told(&error, error.hint())
        }
        _ => {
            let error = read(input, &[]).expect_err(input);
            told(&error, error.hint())
        }
    });
}
