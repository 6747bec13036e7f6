use super::{SHORT, read, refusal, segment_refusal};

#[test]
fn a_slip_of_the_toml_is_refused_in_its_line() {
    for (text, expected) in [
        (
            "[hub]\nradius = 5 cm\n",
            "link.toml:2: string values must be quoted, expected literal string",
        ),
        ("title = 'a'\n\ntitle = 'b'\n", "link.toml:3: duplicate key `title`"),
        ("[hub]\nradius = 0\n[hub]\n", "link.toml:3: duplicate key `hub`"),
        ("\n[[segments]\nlength = 1\n", "link.toml:2: unclosed array table, expected `]`"),
    ] {
        assert_eq!(refusal(text), expected);
    }
}

#[test]
fn segments_have_no_more_elements_than_memory_holds() {
    let segment = "[[segments]]\nlength = 1\nEI = 1\nmass_per_length = 1\nelements = 50001\n";
    assert_eq!(
        refusal(&segment.repeat(2)),
        "link.toml:1: segments = 100002 elements in all, but must be at most 100000"
    );
}

#[test]
fn control_characters_of_the_file_are_told_and_not_printed() {
    for (text, expected) in [
        (r#"hub."\u001b[31m" = 1"#, r"unknown key `\u{1b}[31m` in hub"),
        ("\"a\tb\" = 1", r"unknown key `a\tb`"),
        ("\"a\tb\" = 1\n\"a\tb\" = 2", r#"duplicate key `"a\tb"`"#),
        (
            r#"payload.mass = "1 g\u0007""#,
            r#"payload.mass = "1 g\u{7}" has the malformed unit `g\u{7}`"#,
        ),
        (
            "payload.mass = \"1 g\tm\"",
            r#"payload.mass = "1 g\tm" is measured in g\tm, but must be a mass such as kg"#,
        ),
    ] {
        let message = refusal(&format!("{SHORT}{text}"));
        let (place, message) = message.split_once(": ").unwrap();
        assert!(place.starts_with("link.toml:") && message.starts_with(expected), "{message}");
    }
}

#[test]
fn a_file_without_segments_is_refused() {
    let must = "must hold at least one [[segments]]";
    assert_eq!(refusal(""), format!("link.toml: {must}"));
    assert_eq!(refusal("\nsegments = []\n"), format!("link.toml:2: {must}"));
    assert_eq!(
        refusal("\n[segments]\nlength = 1\n"),
        "link.toml:2: segments = a table, but must be tables headed [[segments]]"
    );
    assert_eq!(
        refusal(&format!("{SHORT}masses = [0.1, 0.2]\n")),
        "link.toml:2: masses = [0.1, 0.2], but must be tables headed [[masses]]"
    );
}

#[test]
fn an_unknown_key_is_refused_with_the_nearest_known_one() {
    assert_eq!(
        segment_refusal("lenght = 1"),
        "link.toml:2: unknown key `lenght` in segments.0\nhint: did you mean `length`?"
    );
    assert_eq!(
        refusal(&format!("{SHORT}[hub]\ncolour = 'red'\n")),
        "link.toml:3: unknown key `colour` in hub\nhint: known here: inertia, radius and \
         viscous_friction"
    );
    assert_eq!(
        refusal(&format!("{SHORT}[payloads]\nmass = 1\n")),
        "link.toml:2: unknown key `payloads`\nhint: did you mean `payload`?"
    );
    assert_eq!(
        segment_refusal("length = 1\nsection = { shape = 'circle', radius = 1 }"),
        "link.toml:3: unknown key `radius` in segments.0.section\nhint: known here: shape, width, \
         thickness, height, diameter and wall"
    );
}

#[test]
fn drive_and_limits_have_their_ranges() {
    assert_eq!(
        refusal(&format!("{SHORT}[drive]\njoint_stiffness = 0\n")),
        "link.toml:3: drive.joint_stiffness = 0.0 N m/rad, but must lie from 1e-30 to 1e30 N m/rad, \
         or be inf for a stiff joint"
    );
    assert_eq!(
        refusal(&format!("{SHORT}[limits]\ntorque = '0 N m'\n")),
        "link.toml:3: limits.torque = 0 N m, but must be finite and above 0"
    );
}

#[test]
fn a_limit_of_the_motor_without_a_drive_is_refused_by_name() {
    for (limit, found) in [
        ("motor_torque = '50 N cm'", "motor_torque = 0.5 N m"),
        ("motor_rms_torque = 2", "motor_rms_torque = 2 N m"),
        ("motor_rate = 300", "motor_rate = 300 rad/s"),
        ("motor_power = '1000 N m/s'", "motor_power = 1000 W"),
    ] {
        assert_eq!(
            refusal(&format!("{SHORT}[limits]\n{limit}\n")),
            format!(
                "link.toml:3: limits.{found}, but must come with a [drive], the motor's side of \
                 the hub"
            )
        );
        let driven = format!("{SHORT}[drive]\n[limits]\n{limit}\n");
        assert!(read(&driven).is_ok(), "{limit}");
    }
}

#[test]
fn a_value_of_the_wrong_kind_is_refused_with_what_it_must_be() {
    for (lines, expected) in [
        ("title = 5", "link.toml:2: title = 5, but must be a string"),
        ("hub = [0.1, 0, 0]", "link.toml:2: hub = [0.1, 0, 0], but must be a table"),
        (
            "[hub]\ninertia = true",
            "link.toml:3: hub.inertia = true, but must be a number in SI or a string with its unit",
        ),
        (
            "[hub]\ninertia = 1979-05-27",
            "link.toml:3: hub.inertia = 1979-05-27, but must be a number in SI or a string with \
             its unit",
        ),
        ("[hub]\ninertia = nan", "link.toml:3: hub.inertia = NaN, but must be finite"),
        ("[hub]\n\ninertia = -inf", "link.toml:4: hub.inertia = -inf, but must be finite"),
        ("[hub]\ninertia = 1e999", "link.toml:3: hub.inertia = inf, but must be finite"),
        ("[damping]\nratio = '2 %'", "link.toml:3: damping.ratio = \"2 %\", but must be a number"),
        (
            "[mesh]\nelements = 10.0",
            "link.toml:3: mesh.elements = 10.0, but must be a whole number from 1 to 100000, or \
             \"auto\"",
        ),
        (
            "[mesh]\nelements = 'many'",
            "link.toml:3: mesh.elements = \"many\", but must be a whole number from 1 to 100000, \
             or \"auto\"",
        ),
        (
            "[mesh]\ntolerance = 0.2",
            "link.toml:3: mesh.tolerance = 0.2, but must lie in [1e-12, 0.1]",
        ),
        (
            "[analysis]\ntolerance = 0",
            "link.toml:3: analysis.tolerance = 0, but must lie in [1e-12, 1e-2]",
        ),
        (
            "[analysis]\nlead = '-1 s'",
            "link.toml:3: analysis.lead = -1 s, but must be finite and at least 0",
        ),
        (
            "[analysis]\nmode = 5",
            "link.toml:3: unknown key `mode` in analysis\nhint: did you mean `modes`?",
        ),
        ("[[masses]]\nmass = 1", "link.toml:2: masses.0.at is missing"),
        (
            "[[masses]]\nat = 2\nmass = 1",
            "link.toml:3: masses.0.at = 2 m, but must lie on the link, from 0 m to 1.5 m from \
             the axis",
        ),
    ] {
        assert_eq!(refusal(&format!("{SHORT}{lines}\n")), expected);
    }
    for modes in ["0", "-1", "2.5", "\"all\"", "100001"] {
        assert_eq!(
            refusal(&format!("{SHORT}[analysis]\nmodes = {modes}\n")),
            format!(
                "link.toml:3: analysis.modes = {modes}, but must be a whole number from 1 to 100000"
            )
        );
    }
    for (keys, expected) in [
        ("EI = 5", "link.toml:1: segments.0.length is missing"),
        (
            "length = 1\nEI = [5, 4, 3]",
            "link.toml:3: segments.0.EI = [5, 4, 3], but must be a number in SI, a string with \
             its unit, or two of them [inner, outer]",
        ),
        (
            "length = 1\nEI = [\n 5,\n false]",
            "link.toml:5: segments.0.EI.1 = false, but must be a number in SI or a string with \
             its unit",
        ),
        (
            "length = 1\nE = [1, 2]",
            "link.toml:3: segments.0.E = [1, 2], but must be a number in SI or a string with its \
             unit",
        ),
        (
            "length = 1\nelements = 0",
            "link.toml:3: segments.0.elements = 0, but must be a whole number from 1 to 100000",
        ),
        (
            "length = 1\nelements = 'auto'",
            "link.toml:3: segments.0.elements = \"auto\", but must be a whole number from 1 to \
             100000",
        ),
        (
            "length = 1\nsection = 'circle'",
            "link.toml:3: segments.0.section = \"circle\", but must be a table such as { shape = \
             \"circle\", diameter = 0.01 }",
        ),
    ] {
        assert_eq!(segment_refusal(keys), expected);
    }
}

#[test]
fn a_value_with_a_wrong_unit_is_refused_with_the_right_one() {
    for (length, expected) in [
        (
            "1.5",
            "link.toml:2: segments.0.length = \"1.5\" has no unit, but must be a length such as \
             m\nhint: a number without quotes is in SI units",
        ),
        (
            "150 kg",
            "link.toml:2: segments.0.length = \"150 kg\" is a mass, but must be a length such as \
             m",
        ),
        (
            "150 cn",
            "link.toml:2: segments.0.length = \"150 cn\" has the unknown unit `cn`\nhint: did you \
             mean `cm`?",
        ),
        (
            "1,5 m",
            "link.toml:2: segments.0.length = \"1,5 m\" does not begin with a decimal number\n\
             hint: a length is wanted, such as \"1 m\"",
        ),
        (
            "1 m/kg s",
            "link.toml:2: segments.0.length = \"1 m/kg s\" is ambiguous: only one unit may follow \
             the only `/`\nhint: use negative powers, as in `kg m^-1 s^-1`",
        ),
    ] {
        assert_eq!(segment_refusal(&format!("length = '{length}'")), expected);
    }
}
