use super::choices::{MODELS, Model};
use super::error::{Fault, USUAL_RATIO, listed, nearest};
use super::quantity::{Count, Real, optional_si};
use super::raw::RawDamping;
use crate::link::{Damping, in_unit_interval};
use crate::numeric::{Dimension, excerpt};

/// The damping law that `[damping]` gives.
pub(super) fn damping(raw: &RawDamping) -> Result<Damping, Fault> {
    let model = model(raw)?;
    refuse_surplus(raw, model)?;
    match model.name {
        "hysteretic" => hysteretic(raw),
        "modal" => modal(raw, model),
        "rayleigh" => rayleigh(raw, model),
        "caughey" => caughey(raw, model),
        _ => Ok(Damping::None),
    }
}

fn model(raw: &RawDamping) -> Result<&'static Model, Fault> {
    let name = match &raw.model {
        Some(name) => name.as_str(),
        None if raw.ratio.is_some() => "hysteretic",
        None => {
            let message = format!("damping.model is missing, but must be {}", names());
            return Err(Fault::new("damping.model", message));
        }
    };
    MODELS.iter().find(|model| model.name == name).ok_or_else(|| unknown_model(name))
}

fn names() -> String {
    listed(&MODELS.map(|model| model.name), "or")
}

fn unknown_model(name: &str) -> Fault {
    let message = format!("damping.model = {:?}, but must be {}", excerpt(name), names());
    let near = nearest(name, MODELS.map(|model| model.name));
    let near = near.map(|near| format!("did you mean `{near}`?"));
    Fault::new("damping.model", message).hinting(near)
}

/// Refuses a key that does not belong to the model.
fn refuse_surplus(raw: &RawDamping, model: &Model) -> Result<(), Fault> {
    let given = [
        ("ratio", raw.ratio.is_some()),
        ("ratios", raw.ratios.is_some()),
        ("modes", raw.modes.is_some()),
        ("alpha", raw.alpha.is_some()),
        ("beta", raw.beta.is_some()),
    ];
    let surplus = given.iter().find(|(key, given)| *given && !model.keys.contains(key));
    surplus.map_or(Ok(()), |(key, _)| {
        let path = format!("damping.{key}");
        let Model { name, takes, .. } = model;
        let message = format!("{path} is given, but model \"{name}\" takes {takes}");
        Err(Fault::new(path, message).hinting(instead(key, model).to_owned()))
    })
}

/// A hint for a surplus key: mostly the model that takes it.
fn instead(key: &str, model: &Model) -> &'static str {
    match key {
        _ if model.name == "none" => {
            "leave the key out; --set replaces the table: 'damping={model=\"none\"}'"
        }
        "ratio" => "one ratio in every mode is model = \"modal\"",
        "ratios" => "a ratio for each mode is model = \"modal\"",
        "modes" => "ratios of chosen modes are model = \"caughey\", or \"rayleigh\" for two modes",
        _ => "alpha and beta are model = \"rayleigh\"",
    }
}

fn neither(model: &Model) -> Fault {
    let Model { name, takes, .. } = model;
    Fault::new("damping", format!("damping gives neither, but {name} must have {takes}"))
}

/// Refuses a law that is given in two ways; the error points at the last of the `keys`.
fn both(model: &Model, keys: &[&str]) -> Fault {
    let Model { name, takes, .. } = model;
    let paths = keys.iter().map(|key| format!("damping.{key}"));
    let message = format!("damping gives both, but {name} must have {takes}");
    Fault::among(paths.collect(), message)
}

fn modes_alone() -> Fault {
    Fault::new("damping", "damping gives modes, but must give their ratios too")
}

fn hysteretic(raw: &RawDamping) -> Result<Damping, Fault> {
    match raw.ratio {
        Some(Real(ratio)) => Ok(Damping::Hysteretic { ratio }),
        None => {
            Err(Fault::new("damping.ratio", "damping.ratio is missing")
                .hinting(USUAL_RATIO.to_owned()))
        }
    }
}

fn modal(raw: &RawDamping, model: &Model) -> Result<Damping, Fault> {
    match (raw.ratio, &raw.ratios) {
        (None, None) => Err(neither(model).hinting(USUAL_RATIO.to_owned())),
        (Some(ratio), None) => in_every_mode(ratio),
        (None, Some(ratios)) => Ok(Damping::Modal { ratios: reals(ratios) }),
        (Some(_), Some(_)) => Err(both(model, &["ratio", "ratios"])),
    }
}

/// Checks the range here, for an error that names `ratio`: the link has a list only.
fn in_every_mode(Real(ratio): Real) -> Result<Damping, Fault> {
    in_unit_interval("damping.ratio", ratio)?;
    Ok(Damping::Modal { ratios: vec![ratio] })
}

fn caughey(raw: &RawDamping, model: &Model) -> Result<Damping, Fault> {
    match (raw.ratio, &raw.ratios, &raw.modes) {
        (None, None, None) => Err(neither(model).hinting(USUAL_RATIO.to_owned())),
        (None, None, Some(_)) => Err(modes_alone()),
        (Some(ratio), None, None) => in_every_mode(ratio),
        (Some(_), _, _) => Err(both(model, &["ratio", "ratios", "modes"])),
        (None, Some(ratios), modes) => {
            let ratios = reals(ratios);
            let modes = modes.as_deref().map_or_else(|| (1..=ratios.len()).collect(), counts);
            if modes.len() != ratios.len() {
                let paths = ["damping.modes", "damping.ratios"].map(str::to_owned).to_vec();
                let found = format!("damping.modes = {modes:?} and damping.ratios = {ratios:?}");
                let message = format!("{found}, but must hold a ratio for each mode");
                return Err(Fault::among(paths, message));
            }
            Ok(Damping::Caughey { modes, ratios })
        }
    }
}

fn rayleigh(raw: &RawDamping, model: &Model) -> Result<Damping, Fault> {
    match (&raw.modes, &raw.ratios, &raw.alpha, &raw.beta) {
        (None, None, None, None) => Err(neither(model)),
        (None, None, alpha, beta) => {
            let alpha = optional_si("damping.alpha", alpha.as_ref(), Dimension::RATE)?;
            let beta = optional_si("damping.beta", beta.as_ref(), Dimension::TIME)?;
            Ok(Damping::Rayleigh {
                alpha_per_s: alpha.unwrap_or_default(),
                beta_s: beta.unwrap_or_default(),
            })
        }
        (Some(modes), Some(ratios), None, None) => Ok(Damping::RayleighThroughModes {
            modes: pair("damping.modes", &counts(modes))?,
            ratios: pair("damping.ratios", &reals(ratios))?,
        }),
        (Some(_), None, None, None) => Err(modes_alone()),
        (None, Some(_), None, None) => {
            Err(Fault::new("damping", "damping gives ratios, but must give their modes too"))
        }
        _ => Err(both(model, &["alpha", "beta", "modes", "ratios"])),
    }
}

fn counts(list: &[Count]) -> Vec<usize> {
    list.iter().map(|Count(count)| *count).collect()
}

fn reals(list: &[Real]) -> Vec<f64> {
    list.iter().map(|Real(number)| *number).collect()
}

fn pair<T: Copy + std::fmt::Debug>(path: &str, values: &[T]) -> Result<[T; 2], Fault> {
    values
        .try_into()
        .map_err(|_| Fault::new(path, format!("{path} = {values:?}, but must hold two numbers")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(model: Option<&str>) -> RawDamping {
        RawDamping {
            model: model.map(str::to_owned),
            ratio: Some(Real(0.02)),
            ..RawDamping::default()
        }
    }

    #[test]
    fn a_ratio_alone_means_the_law_of_the_paper() {
        let law = Ok(Damping::Hysteretic { ratio: 0.02 });
        assert_eq!(damping(&ratio(None)), law);
        assert_eq!(damping(&ratio(Some("hysteretic"))), law);
    }

    #[test]
    fn one_ratio_in_every_mode_is_modal_damping_under_both_names() {
        let law = Ok(Damping::Modal { ratios: vec![0.02] });
        assert_eq!(damping(&ratio(Some("modal"))), law);
        assert_eq!(damping(&ratio(Some("caughey"))), law);
    }

    #[test]
    fn an_unknown_model_is_refused_before_its_keys_are() {
        assert_eq!(damping(&ratio(Some("viscous"))), Err(unknown_model("viscous")));
    }
}
