use flexlink::link::Damping;

use super::{SHORT, read, read_with};

const CONSTANT: &str = "model = 'modal'\nratio = 0.02";
const LIST: &str = "model = 'modal'\nratios = [0.02, 0.05]";
const SERIES: &str = "model = 'caughey'\nmodes = [1, 3]\nratios = [0.02, 0.05]";

fn law(keys: &str) -> Damping {
    read(&format!("{SHORT}[damping]\n{keys}\n")).unwrap().link().damping().clone()
}

/// The law of a file with these keys under these settings.
fn law_with(keys: &str, settings: &[&str]) -> Damping {
    let specification = read_with(&format!("{SHORT}[damping]\n{keys}\n"), settings);
    specification.unwrap().link().damping().clone()
}

fn modal(ratios: &[f64]) -> Damping {
    Damping::Modal { ratios: ratios.to_vec() }
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
