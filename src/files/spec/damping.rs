use super::choices::Model;
use super::error::{Fault, USUAL_RATIO, listed};
use super::raw::RawDamping;
use super::value::{Count, Si};
use crate::link::{Damping, in_unit_interval};

/// Damping law of `[damping]`.
pub(super) fn damping(raw: &RawDamping) -> Result<Damping, Fault> {
    let model = match raw.model {
        Some(model) => model,
        None if raw.ratio.is_some() => Model::Hysteretic,
        None => {
            let names = listed(&Model::ALL.map(Model::name), "or");
            let message = format!("damping.model is missing, but must be {names}");
            return Err(Fault::new("damping.model", message));
        }
    };
    refuse_surplus(raw, model)?;
    match model {
        Model::Hysteretic => {
            let missing = || Fault::new("damping.ratio", "damping.ratio is missing");
            let ratio = raw.ratio.ok_or_else(|| missing().hinting(USUAL_RATIO.to_owned()))?;
            Ok(Damping::Hysteretic { ratio })
        }
        Model::Modal | Model::Caughey => by_modes(raw, model),
        Model::Rayleigh => rayleigh(raw),
        Model::None => Ok(Damping::None),
    }
}

/// Refuses a key that does not belong to the model.
fn refuse_surplus(raw: &RawDamping, model: Model) -> Result<(), Fault> {
    let given = [
        ("ratio", raw.ratio.is_some()),
        ("ratios", raw.ratios.is_some()),
        ("modes", raw.modes.is_some()),
        ("alpha", raw.alpha.is_some()),
        ("beta", raw.beta.is_some()),
    ];
    let surplus = given.iter().find(|(key, given)| *given && !model.keys().contains(key));
    surplus.map_or(Ok(()), |(key, _)| {
        let path = format!("damping.{key}");
        let (name, takes) = (model.name(), model.takes());
        let message = format!("{path} is given, but model \"{name}\" takes {takes}");
        Err(Fault::new(path, message).hinting(instead(key, model).to_owned()))
    })
}

/// Hint for a surplus key: mostly the model that it belongs to.
fn instead(key: &str, model: Model) -> &'static str {
    match key {
        _ if model == Model::None => {
            "leave the key out; --set replaces the table: 'damping={model=\"none\"}'"
        }
        "ratio" => "one ratio in every mode is model = \"modal\"",
        "ratios" => "a ratio for each mode is model = \"modal\"",
        "modes" => "ratios of chosen modes are model = \"caughey\", or \"rayleigh\" for two modes",
        _ => "alpha and beta are model = \"rayleigh\"",
    }
}

/// Error for a law without keys.
fn neither(model: Model) -> Fault {
    let (name, takes) = (model.name(), model.takes());
    Fault::new("damping", format!("damping gives neither, but {name} must have {takes}"))
}

/// Error for a law given in two ways; it points at the last of its keys.
fn both(model: Model) -> Fault {
    let (name, takes) = (model.name(), model.takes());
    let paths = model.keys().iter().map(|key| format!("damping.{key}"));
    let message = format!("damping gives both, but {name} must have {takes}");
    Fault::among(paths.collect(), message)
}

fn modes_alone() -> Fault {
    Fault::new("damping", "damping gives modes, but must give their ratios too")
}

/// A ratio for each mode: modal damping, or a Caughey series through chosen modes.
fn by_modes(raw: &RawDamping, model: Model) -> Result<Damping, Fault> {
    match (raw.ratio, raw.ratios.clone(), &raw.modes) {
        (None, None, None) => Err(neither(model).hinting(USUAL_RATIO.to_owned())),
        (None, None, Some(_)) => Err(modes_alone()),
        (Some(ratio), None, None) => {
            // The link has only a list; this error names `ratio`.
            in_unit_interval("damping.ratio", ratio)?;
            Ok(Damping::Modal { ratios: vec![ratio] })
        }
        (Some(_), _, _) => Err(both(model)),
        (None, Some(ratios), None) if model == Model::Modal => Ok(Damping::Modal { ratios }),
        (None, Some(ratios), modes) => {
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

fn rayleigh(raw: &RawDamping) -> Result<Damping, Fault> {
    match (&raw.modes, &raw.ratios, raw.alpha, raw.beta) {
        (None, None, None, None) => Err(neither(Model::Rayleigh)),
        (None, None, alpha, beta) => Ok(Damping::Rayleigh {
            alpha_per_s: alpha.map_or(0.0, Si::si),
            beta_s: beta.map_or(0.0, Si::si),
        }),
        (Some(modes), Some(ratios), None, None) => Ok(Damping::RayleighThroughModes {
            modes: pair("damping.modes", &counts(modes))?,
            ratios: pair("damping.ratios", ratios)?,
        }),
        (Some(_), None, None, None) => Err(modes_alone()),
        (None, Some(_), None, None) => {
            Err(Fault::new("damping", "damping gives ratios, but must give their modes too"))
        }
        _ => Err(both(Model::Rayleigh)),
    }
}

fn counts(list: &[Count]) -> Vec<usize> {
    list.iter().map(|Count(count)| *count).collect()
}

fn pair<T: Copy + std::fmt::Debug>(path: &str, values: &[T]) -> Result<[T; 2], Fault> {
    values
        .try_into()
        .map_err(|_| Fault::new(path, format!("{path} = {values:?}, but must hold two numbers")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(model: Option<Model>) -> RawDamping {
        RawDamping { model, ratio: Some(0.02), ..RawDamping::default() }
    }

    #[test]
    fn a_ratio_alone_means_the_law_of_the_paper() {
        let law = Ok(Damping::Hysteretic { ratio: 0.02 });
        assert_eq!(damping(&ratio(None)), law);
        assert_eq!(damping(&ratio(Some(Model::Hysteretic))), law);
    }

    #[test]
    fn one_ratio_in_every_mode_is_modal_damping_under_both_names() {
        let law = Ok(Damping::Modal { ratios: vec![0.02] });
        assert_eq!(damping(&ratio(Some(Model::Modal))), law);
        assert_eq!(damping(&ratio(Some(Model::Caughey))), law);
    }
}
