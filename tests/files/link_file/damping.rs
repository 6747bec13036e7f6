use flexlink::link::Damping;

use super::{SHORT, read, read_with, refusal, shown};

const MODELS: &str = "hysteretic, modal, rayleigh, caughey or none";
const USUAL: &str = "hint: 0.02 is usual for metal links";
const CONSTANT: &str = "model = 'modal'\nratio = 0.02";
const LIST: &str = "model = 'modal'\nratios = [0.02, 0.05]";
const SERIES: &str = "model = 'caughey'\nmodes = [1, 3]\nratios = [0.02, 0.05]";

fn law(keys: &str) -> Damping {
    read(&format!("{SHORT}[damping]\n{keys}\n")).unwrap().link.damping().clone()
}

/// The law of a file with these keys under these settings.
fn law_with(keys: &str, settings: &[&str]) -> Damping {
    let specification = read_with(&format!("{SHORT}[damping]\n{keys}\n"), settings);
    specification.unwrap().link.damping().clone()
}

fn modal(ratios: &[f64]) -> Damping {
    Damping::Modal { ratios: ratios.to_vec() }
}

/// Holds the refusal of keys, which begin in line 3, to what it must read.
fn assert_refused(keys: &str, expected: &str) {
    let found = refusal(&format!("{SHORT}[damping]\n{keys}\n"));
    assert_eq!(found, format!("link.toml:{expected}"));
}

#[test]
fn every_damping_law_is_read() {
    assert_eq!(law("ratio = 0.05"), Damping::Hysteretic { ratio: 0.05 });
    assert_eq!(law("model = 'none'"), Damping::None);
    let rayleigh = |alpha_per_s, beta_s| Damping::Rayleigh { alpha_per_s, beta_s };
    assert_eq!(law("model = 'rayleigh'\nalpha = '0.1 1/s'\nbeta = '2 ms'"), rayleigh(0.1, 0.002));
    assert_eq!(law("model = 'rayleigh'\nbeta = 0.002"), rayleigh(0.0, 0.002));
    assert_eq!(
        law("model = 'rayleigh'\nmodes = [1, 3]\nratios = [0.02, 0.01]"),
        Damping::RayleighThroughModes { modes: [1, 3], ratios: [0.02, 0.01] }
    );
    assert_eq!(law("model = 'modal'\nratio = 0.02"), modal(&[0.02]));
    assert_eq!(law("model = 'modal'\nratios = [0.02, 0, 0.05]"), modal(&[0.02, 0.0, 0.05]));
    assert_eq!(law("model = 'caughey'\nratio = 0.02"), modal(&[0.02]));
    let caughey = |modes: &[usize], ratios: &[f64]| Damping::Caughey {
        modes: modes.to_vec(),
        ratios: ratios.to_vec(),
    };
    let chosen = "model = 'caughey'\nmodes = [1, 2, 4]\nratios = [0.02, 0.01, 0.03]";
    assert_eq!(law(chosen), caughey(&[1, 2, 4], &[0.02, 0.01, 0.03]));
    assert_eq!(law("model = 'caughey'\nratios = [0.02, 0.01]"), caughey(&[1, 2], &[0.02, 0.01]));
}

#[test]
fn a_damping_model_is_one_of_five() {
    for (keys, expected) in [
        ("", format!("2: damping.model is missing, but must be {MODELS}")),
        ("alpha = 1", format!("2: damping.model is missing, but must be {MODELS}")),
        ("ratios = [0.02]", format!("2: damping.model is missing, but must be {MODELS}")),
        (
            "model = 'histeretic'",
            format!(
                "3: damping.model = \"histeretic\", but must be {MODELS}\nhint: did you mean \
                 `hysteretic`?"
            ),
        ),
        (
            "model = 'caughy'\nratio = 0.02",
            format!(
                "3: damping.model = \"caughy\", but must be {MODELS}\nhint: did you mean \
                 `caughey`?"
            ),
        ),
    ] {
        assert_refused(keys, &expected);
    }
}

#[test]
fn a_damping_law_takes_its_own_keys_only() {
    for (keys, expected) in [
        (
            "model = 'none'\nratio = 0.02",
            "4: damping.ratio is given, but model \"none\" takes nothing else\nhint: leave the \
             key out; --set replaces the table: 'damping={model=\"none\"}'",
        ),
        (
            "ratio = 0.02\nbeta = 1",
            "4: damping.beta is given, but model \"hysteretic\" takes ratio only\nhint: alpha and \
             beta are model = \"rayleigh\"",
        ),
        (
            "model = 'hysteretic'\nratios = [0.02, 0.05]",
            "4: damping.ratios is given, but model \"hysteretic\" takes ratio only\nhint: a ratio \
             for each mode is model = \"modal\"",
        ),
        (
            "model = 'modal'\nratios = [0.02, 0.05]\nmodes = [1, 3]",
            "5: damping.modes is given, but model \"modal\" takes ratio or ratios\nhint: ratios of \
             chosen modes are model = \"caughey\", or \"rayleigh\" for two modes",
        ),
        (
            "model = 'rayleigh'\nratio = 0.02",
            "4: damping.ratio is given, but model \"rayleigh\" takes alpha and beta, or modes and \
             ratios\nhint: one ratio in every mode is model = \"modal\"",
        ),
        (
            "model = 'caughey'\nalpha = 1",
            "4: damping.alpha is given, but model \"caughey\" takes ratio, or ratios with or \
             without modes\nhint: alpha and beta are model = \"rayleigh\"",
        ),
        ("rations = 1", "3: unknown key `rations` in damping\nhint: did you mean `ratios`?"),
    ] {
        assert_refused(keys, expected);
    }
}

#[test]
fn a_damping_law_is_given_in_exactly_one_way() {
    let rayleigh = "rayleigh must have alpha and beta, or modes and ratios";
    let caughey = "caughey must have ratio, or ratios with or without modes";
    for (keys, expected) in [
        ("model = 'hysteretic'", format!("2: damping.ratio is missing\n{USUAL}")),
        ("model = 'rayleigh'", format!("2: damping gives neither, but {rayleigh}")),
        (
            "model = 'modal'",
            format!("2: damping gives neither, but modal must have ratio or ratios\n{USUAL}"),
        ),
        ("model = 'caughey'", format!("2: damping gives neither, but {caughey}\n{USUAL}")),
        (
            "model = 'rayleigh'\nmodes = [1, 2]\nratios = [0.1, 0.2]\nalpha = 1",
            format!("6: damping gives both, but {rayleigh}"),
        ),
        (
            "model = 'modal'\nratio = 0.02\nratios = [0.1, 0.2]",
            "5: damping gives both, but modal must have ratio or ratios".into(),
        ),
        (
            "model = 'caughey'\nratios = [0.1, 0.2]\nratio = 0.02",
            format!("5: damping gives both, but {caughey}"),
        ),
        (
            "model = 'caughey'\nratio = 0.02\nmodes = [1, 2]",
            format!("5: damping gives both, but {caughey}"),
        ),
    ] {
        assert_refused(keys, &expected);
    }
    let alone = "damping gives modes, but must give their ratios too";
    for model in ["rayleigh", "caughey"] {
        assert_refused(&format!("model = '{model}'\nmodes = [1, 2]"), &format!("2: {alone}"));
    }
    assert_refused(
        "model = 'rayleigh'\nratios = [0.1, 0.2]",
        "2: damping gives ratios, but must give their modes too",
    );
}

#[test]
fn ratios_and_modes_have_their_ranges_in_every_law() {
    let range = "but must lie in [0, 1)";
    for model in ["hysteretic", "modal", "caughey"] {
        let keys = format!("model = '{model}'\nratio = -0.02");
        assert_refused(&keys, &format!("4: damping.ratio = -0.02, {range}\n{USUAL}"));
    }
    for (keys, expected) in [
        ("modal'\nratios = [0.1,\n 1.2]", format!("4: damping.ratios = 1.2, {range}")),
        ("modal'\nratios = []", "4: damping.ratios = [], but must hold at least one number".into()),
        ("modal'\nratios = 0.02", "4: damping.ratios = 0.02, but must be a list".into()),
        (
            "modal'\nratios = [0.1, '2 %']",
            "4: damping.ratios.1 = \"2 %\", but must be a number".into(),
        ),
        (
            "rayleigh'\nmodes = [1, 2, 3]\nratios = [0.1, 0.2]",
            "4: damping.modes = [1, 2, 3], but must hold two numbers".into(),
        ),
        (
            "rayleigh'\nmodes = [1, 2]\nratios = [0.1, 1.2]",
            format!("5: damping.ratios = 1.2, {range}"),
        ),
        (
            "rayleigh'\nalpha = '1 s'",
            "4: damping.alpha = \"1 s\" is a time, but must be a rate such as 1/s".into(),
        ),
        (
            "caughey'\nratios = []",
            "4: damping.ratios = [], but must hold 1 to 8 numbers for a Caughey series".into(),
        ),
        (
            "caughey'\nmodes = [1, 2, 3]\nratios = [0.1, 0.2]",
            "5: damping.modes = [1, 2, 3] and damping.ratios = [0.1, 0.2], but must hold a ratio \
             for each mode"
                .into(),
        ),
        (
            "caughey'\nmodes = [2, 1]\nratios = [0.1, 0.2]",
            "4: damping.modes = [2, 1], but must be flexible modes, numbered from 1, in ascending \
             order"
                .into(),
        ),
        (
            "caughey'\nmodes = [0, 1]\nratios = [0.1, 0.2]",
            "4: damping.modes.0 = 0, but must be a whole number from 1 to 100000".into(),
        ),
        ("caughey'\nratios = [0.1, -0.2]", format!("4: damping.ratios = -0.2, {range}")),
    ] {
        assert_refused(&format!("model = '{keys}"), &expected);
    }
}

#[test]
fn settings_change_one_ratio_or_a_list() {
    assert_eq!(law_with(CONSTANT, &["damping.ratio*=2"]), modal(&[0.04]));
    assert_eq!(law_with(LIST, &["damping.ratios*=2"]), modal(&[0.04, 0.1]));
    assert_eq!(law_with(LIST, &["damping.ratios.1=0.03"]), modal(&[0.02, 0.03]));
    assert_eq!(law_with("ratio = 0.02", &["damping.model=modal"]), modal(&[0.02]));
    let none = law_with(LIST, &["damping={model=\"none\"}"]);
    assert_eq!(none, Damping::None);
}

#[test]
fn one_ratio_set_takes_the_place_of_a_list_and_a_list_that_of_one() {
    assert_eq!(law_with(CONSTANT, &["damping.ratios=[0.02, 0.05]"]), modal(&[0.02, 0.05]));
    assert_eq!(law_with(LIST, &["damping.ratio=0.01"]), modal(&[0.01]));
    assert_eq!(law_with(SERIES, &["damping.ratio=0.01"]), modal(&[0.01]));
}

#[test]
fn a_damping_list_that_cannot_be_is_blamed_on_its_setting() {
    for (set, expected) in [
        ("damping.ratios*=40", "damping.ratios = 2, but must lie in [0, 1)"),
        ("damping.ratios.0=1", "damping.ratios = 1, but must lie in [0, 1)"),
        (
            "damping.modes.0=3",
            "damping.modes = [3, 3], but must be flexible modes, numbered from 1, in ascending order",
        ),
        (
            "damping.modes*=0.5",
            "damping.modes.0 = 0.5, but must be a whole number from 1 to 100000",
        ),
        (
            "damping.ratios=[0.02]",
            "damping.modes = [1, 3] and damping.ratios = [0.02], but must hold a ratio for each mode",
        ),
        (
            "damping.ratio*=2",
            "damping.ratio is not in the file, so it cannot be multiplied\nhint: the file gives \
             ratios there: multiply that",
        ),
        ("damping.ratios.2=0.02", "damping.ratios.2 is not in the file, which has 0, 1"),
    ] {
        let error = read_with(&format!("{SHORT}[damping]\n{SERIES}\n"), &[set]).unwrap_err();
        assert_eq!(shown(&error), format!("--set '{set}': {expected}"));
    }
}
