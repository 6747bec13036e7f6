use super::error::{Fault, listed, nearest};
use super::quantity::Quantity;
use super::raw::RawDamping;
use crate::link::Damping;
use crate::numeric::Dimension;

const MODELS: [&str; 3] = ["hysteretic", "rayleigh", "none"];

/// The damping law that `[damping]` gives.
pub(super) fn damping(raw: RawDamping) -> Result<Damping, Fault> {
    let model = match &raw.model {
        Some(model) => model.as_str(),
        None if raw.ratio.is_some() => "hysteretic",
        None => {
            let message = format!("damping.model is missing, but must be {}", models());
            return Err(Fault::new("damping.model", message));
        }
    };
    let takes: &[&str] = match model {
        "hysteretic" => &["ratio"],
        "rayleigh" => &["alpha", "beta", "modes", "ratios"],
        "none" => &[],
        _ => return Err(unknown_model(model)),
    };
    refuse_surplus(&raw, model, takes)?;
    match (model, raw.ratio) {
        ("none", _) => Ok(Damping::None),
        ("rayleigh", _) => rayleigh(raw),
        (_, Some(ratio)) => Ok(Damping::Hysteretic { ratio: ratio.0 }),
        (_, None) => Err(Fault::new("damping.ratio", "damping.ratio is missing")
            .hinting("0.02 is usual for metal links".to_owned())),
    }
}

fn models() -> String {
    listed(&MODELS, "or")
}

fn unknown_model(model: &str) -> Fault {
    let message = format!("damping.model = {model:?}, but must be {}", models());
    if matches!(model, "modal" | "caughey") {
        let message = format!("{message}: {model} damping is not supported yet");
        return Fault::new("damping.model", message);
    }
    let near = nearest(model, MODELS).map(|near| format!("did you mean `{near}`?"));
    Fault::new("damping.model", message).hinting(near)
}

/// Refuses a key that does not belong to the model.
fn refuse_surplus(raw: &RawDamping, model: &str, takes: &[&str]) -> Result<(), Fault> {
    let given = [
        ("ratio", raw.ratio.is_some()),
        ("ratios", raw.ratios.is_some()),
        ("modes", raw.modes.is_some()),
        ("alpha", raw.alpha.is_some()),
        ("beta", raw.beta.is_some()),
    ];
    let surplus = given.iter().find(|(key, given)| *given && !takes.contains(key));
    surplus.map_or(Ok(()), |(key, _)| {
        let takes = match takes {
            [] => "nothing else".to_owned(),
            ["ratio"] => "ratio only".to_owned(),
            _ => "alpha and beta, or modes and ratios".to_owned(),
        };
        let path = format!("damping.{key}");
        let message = format!("{path} is given, but model \"{model}\" takes {takes}");
        let undamped = "leave the key out; --set replaces the table: 'damping={model=\"none\"}'";
        Err(Fault::new(path, message).hinting((model == "none").then(|| undamped.to_owned())))
    })
}

fn rayleigh(raw: RawDamping) -> Result<Damping, Fault> {
    const WAYS: &str = "alpha and beta, or modes and ratios";
    let RawDamping { ratios, modes, alpha, beta, .. } = raw;
    match (modes, ratios, &alpha, &beta) {
        (None, None, None, None) => {
            let message = format!("damping gives neither, but rayleigh must have {WAYS}");
            Err(Fault::new("damping", message))
        }
        (None, None, alpha, beta) => {
            let si = |path, value: &Option<Quantity>, dimension| {
                let si = value.as_ref().map(|value| value.si(path, dimension));
                si.transpose().map(Option::unwrap_or_default)
            };
            Ok(Damping::Rayleigh {
                alpha_per_s: si("damping.alpha", alpha, Dimension::RATE)?,
                beta_s: si("damping.beta", beta, Dimension::TIME)?,
            })
        }
        (Some(modes), Some(ratios), None, None) => {
            let modes: Vec<usize> = modes.iter().map(|mode| mode.0).collect();
            let ratios: Vec<f64> = ratios.iter().map(|ratio| ratio.0).collect();
            Ok(Damping::RayleighThroughModes {
                modes: pair("damping.modes", &modes)?,
                ratios: pair("damping.ratios", &ratios)?,
            })
        }
        (Some(_), None, None, None) => {
            Err(Fault::new("damping", "damping gives modes, but must give their ratios too"))
        }
        (None, Some(_), None, None) => {
            Err(Fault::new("damping", "damping gives ratios, but must give their modes too"))
        }
        _ => {
            let keys = ["alpha", "beta", "modes", "ratios"];
            let paths = keys.map(|key| format!("damping.{key}"));
            let message = format!("damping gives both, but rayleigh must have {WAYS}");
            Err(Fault::among(paths.to_vec(), message))
        }
    }
}

fn pair<T: Copy + std::fmt::Debug>(path: &str, values: &[T]) -> Result<[T; 2], Fault> {
    values
        .try_into()
        .map_err(|_| Fault::new(path, format!("{path} = {values:?}, but must hold two numbers")))
}

#[cfg(test)]
mod tests {
    use super::super::quantity::Real;
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
        assert_eq!(damping(ratio(None)), law);
        assert_eq!(damping(ratio(Some("hysteretic"))), law);
    }

    #[test]
    fn an_unsupported_model_is_refused_before_its_keys_are() {
        for model in ["modal", "caughey", "viscous"] {
            let fault = damping(ratio(Some(model))).unwrap_err();
            assert_eq!(fault, unknown_model(model));
        }
    }
}
