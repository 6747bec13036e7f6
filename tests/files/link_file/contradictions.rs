use super::segment_refusal;

#[test]
fn stiffness_and_mass_must_be_given_in_exactly_one_way() {
    let stiffness = "but must give the bending stiffness in one way: EI, or E with I, or E with \
                     section";
    let mass = "but must give the mass per length in one way: mass_per_length, or density with \
                area, or density with section";
    let section = "section = { shape = 'circle', diameter = 0.01 }";
    for (keys, line, found, must) in [
        ("EI = 5\nE = 1", 4, "gives EI and E", stiffness),
        ("I = 1\nEI = 5\nE = 1", 5, "gives EI, E and I", stiffness),
        ("E = 1", 3, "gives E without I or section", stiffness),
        ("I = 1", 3, "gives I without E", stiffness),
        (section, 3, "gives section without E", stiffness),
        ("", 1, "gives no bending stiffness", stiffness),
        (&format!("E = 1\nI = 1\n{section}"), 5, "gives I and section", stiffness),
        ("EI = 5", 1, "gives no mass per length", mass),
        ("EI = 5\ndensity = 1", 4, "gives density without area or section", mass),
        ("EI = 5\narea = 1", 4, "gives area without density", mass),
        ("EI = 5\nmass_per_length = 1\narea = 1", 5, "gives mass_per_length and area", mass),
        (&format!("E = 5\n{section}"), 4, "gives section without density", mass),
    ] {
        let expected = format!("link.toml:{line}: segments.0 {found}, {must}");
        assert_eq!(segment_refusal(&format!("length = 1\n{keys}")), expected);
    }
    assert_eq!(
        segment_refusal(&format!("length = 1\nEI = 5\nmass_per_length = 1\n{section}")),
        "link.toml:5: segments.0.section is given, but must go with E or density, and this segment \
         gives EI and mass_per_length"
    );
}

#[test]
fn a_value_out_of_its_range_is_named_by_the_key_that_was_written() {
    for (keys, expected) in [
        (
            "EI = [5, '-1 N m^2']\nmass_per_length = 1",
            "3: segments.0.EI = -1 N m^2, but must be above 0",
        ),
        (
            "E = '-70 GPa'\nI = 1\nmass_per_length = 1",
            "3: segments.0.E = -70000000000 Pa, but must be above 0",
        ),
        (
            "E = 1\nI = '0 cm^4'\nmass_per_length = 1",
            "4: segments.0.I = 0 m^4, but must be above 0",
        ),
        (
            "EI = 1\ndensity = -1\narea = 1",
            "4: segments.0.density = -1 kg/m^3, but must be at least 0",
        ),
        ("EI = 1\ndensity = 1\narea = [1, 0]", "5: segments.0.area = 0 m^2, but must be above 0"),
        (
            "EI = 1\nmass_per_length = -1",
            "4: segments.0.mass_per_length = -1 kg/m, but must be finite and at least 0",
        ),
        (
            "EI = 1\ndensity = 1\nsection = { shape = 'tube', diameter = 1, wall = 0.5 }",
            "5: segments.0.section.wall = 0.5 m, but must be below half the outer size 1 m",
        ),
        (
            "EI = 1\nmass_per_length = 1\nname = '1'",
            "5: segments.0.name = \"1\", but must not be empty or a number, nor hold `.`, `*`, `=` \
             or outer blanks",
        ),
    ] {
        let found = segment_refusal(&format!("length = 1\n{keys}"));
        assert_eq!(found, format!("link.toml:{expected}"));
    }
}

#[test]
fn a_section_has_just_the_dimensions_of_its_shape() {
    for (keys, expected) in [
        ("shape = 'disc'", ".shape = \"disc\", but must be rectangle, circle, tube or box"),
        (
            "shape = 'rectangel'",
            ".shape = \"rectangel\", but must be rectangle, circle, tube or box\nhint: did you mean \
             `rectangle`?",
        ),
        ("shape = 'tube', diameter = 1", ".wall is missing"),
        ("width = 1", ".shape is missing"),
        (
            "shape = 'circle', diameter = 1, wall = 0.1",
            ".wall is given, but a circle must have diameter only",
        ),
        (
            "shape = 'box', width = 1, height = 1, wall = 0.1, thickness = 1",
            ".thickness is given, but a box must have width, height and wall only",
        ),
    ] {
        let found = segment_refusal(&format!("length = 1\nsection = {{ {keys} }}"));
        assert_eq!(found, format!("link.toml:3: segments.0.section{expected}"));
    }
}
