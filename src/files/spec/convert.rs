use serde::Deserialize;

use super::error::{Fault, USUAL_RATIO, listed};
use super::raw::{
    Model, OF_CARRIAGE, RawAnalysis, RawDamping, RawDrive, RawLimits, RawSpecification, Theory,
};
use super::segment::segment;
use super::tree::Node;
use super::value::{AlongAxes, Count, Elements, Si, Unbounded};
use crate::beam::{ElementCount, MeshPlan};
use crate::inverse::Analysis;
use crate::link::{
    Carriage, Damping, Drive, Gravity, Hub, Joint, Link, LinkParts, LumpedMass, ParameterError,
    Payload, in_unit_interval,
};
use crate::result::{Limits, Remark};

/// The keys of one link, checked.
pub(super) struct LinkKeys {
    pub(super) link: Link,
    pub(super) mesh: MeshPlan,
    pub(super) analysis: Analysis,
    pub(super) limits: Limits,
    pub(super) remarks: Vec<Remark>,
}

/// Reads the keys of one link from a tree.
pub(super) fn link_keys(tree: &Node) -> Result<LinkKeys, Fault> {
    convert(RawSpecification::deserialize(tree)?)
}

/// Converts the raw form to the checked one.
fn convert(raw: RawSpecification) -> Result<LinkKeys, Fault> {
    if raw.segments.is_empty() {
        return Err(Fault::new("segments", "must hold at least one [[segments]]"));
    }
    let own_elements: Vec<Option<usize>> =
        raw.segments.iter().map(|segment| segment.elements.map(|count| count.0)).collect();
    let remarks = raw.segments.iter().enumerate().flat_map(|(index, segment)| {
        let at = |key: &str| format!("segments.{index}.{key}");
        let modulus = segment.modulus.and_then(|e| Remark::on_modulus(&at("E"), e.si()));
        let density = segment.density.and_then(|rho| Remark::on_density(&at("density"), rho.si()));
        // A named theory of thick links shows that the link is meant to be thick.
        let theory = segment.theory.or(raw.theory);
        let section = segment.section.as_ref().filter(|_| theory != Some(Theory::Timoshenko));
        let section = section.and_then(|section| {
            let (width, thickness) = (section.width?.si(), section.thickness?.si());
            Remark::on_rectangle(&at("section"), width, thickness)
        });
        modulus.into_iter().chain(density).chain(section)
    });
    let angle = raw.start_angle.and_then(|angle| Remark::on_start_angle(angle.si()));
    let remarks = remarks.chain(angle).collect();
    let theory = raw.theory;
    let gravity = match (raw.gravity, raw.start_angle) {
        (None, Some(_)) => {
            let message = "start_angle needs gravity: without gravity all directions are alike";
            return Err(Fault::new("start_angle", message));
        }
        (gravity, start_angle) => gravity.map(|AlongAxes(acceleration_m_s2)| Gravity {
            acceleration_m_s2,
            start_angle_rad: start_angle.map(Si::si),
        }),
    };
    if raw.hub.is_some() && raw.carriage.is_some() {
        let message = "must not be there beside [carriage], which takes the place of the hub";
        return Err(Fault::on("hub", message));
    }
    if raw.carriage.as_ref().is_some_and(|own| own.axis.is_some()) {
        let message =
            "is for an arm of two links or more: one link slides across its own direction";
        let hint = "start_angle = \"90 deg\" is an upright link, whose carriage moves along x";
        return Err(Fault::on("carriage.axis", message).hinting(hint.to_owned()));
    }
    let of_hub = raw.hub.as_ref().and_then(|hub| hub.root_stiffness.as_ref());
    let of_carriage = raw.carriage.as_ref().and_then(|own| own.root_stiffness.as_ref());
    let slides = raw.carriage.is_some();
    let turning = |own: &Unbounded| match own.0.slides {
        Some(true) => {
            let joint = if slides { "carriage" } else { "hub" };
            Err(Fault::on(format!("{joint}.root_stiffness"), "must be in N m/rad"))
        }
        _ => Ok(own.0.si),
    };
    let root_stiffness_n_m_rad = of_hub.or(of_carriage).map(turning).transpose()?;
    let segments = raw.segments.into_iter().enumerate();
    let link = Link::new(LinkParts {
        title: raw.title.unwrap_or_default(),
        segments: segments
            .map(|(index, raw)| segment(index, raw, theory))
            .collect::<Result<_, _>>()?,
        hub: raw.hub.map_or_else(Hub::default, |hub| Hub {
            inertia_kg_m2: hub.inertia.si(),
            radius_m: hub.radius.si(),
            viscous_friction_n_m_s_rad: hub.viscous_friction.si(),
        }),
        carriage: raw.carriage.map(|carriage| Carriage {
            mass_kg: carriage.mass.si(),
            viscous_friction_n_s_m: carriage.viscous_friction.si(),
        }),
        root_stiffness_n_m_rad: root_stiffness_n_m_rad.filter(|own| *own != f64::INFINITY),
        output_m: raw.output.at.map(Si::si),
        masses: raw
            .masses
            .iter()
            .map(|mass| LumpedMass {
                at_m: mass.at.si(),
                mass_kg: mass.mass.si(),
                inertia_kg_m2: mass.inertia.si(),
            })
            .collect(),
        payload: Payload {
            mass_kg: raw.payload.mass.si(),
            inertia_kg_m2: raw.payload.inertia.si(),
            offset_m: raw.payload.offset.si(),
        },
        damping: raw.damping.as_ref().map_or(Ok(Damping::None), damping)?,
        drive: raw.drive.map(|drive| self::drive(&drive, slides)).transpose()?,
        gravity,
    })?;
    let count = raw.mesh.elements.map(|elements| match elements {
        Elements::Word(_) => ElementCount::Auto,
        Elements::Total(count) => ElementCount::Total(count.0),
    });
    let tolerance = raw.mesh.tolerance.unwrap_or(MeshPlan::DEFAULT_TOLERANCE);
    let mesh = MeshPlan::new(&link, &own_elements, count, tolerance)?;
    let analysis = analysis(&raw.analysis)?;
    let limits = limits(&raw.limits, &link.joint(), link.drive())?;
    Ok(LinkKeys { link, mesh, analysis, limits, remarks })
}

/// The drive of a hub, or of a carriage, whose pinion makes its ratio rad of the motor per m.
fn drive(raw: &RawDrive, slides: bool) -> Result<Drive, Fault> {
    let gear_ratio = raw.gear_ratio.unwrap_or(1.0);
    let ratio = match raw.pinion_radius.map(Si::si) {
        Some(radius_m) if slides && radius_m > 0.0 && radius_m.is_finite() => gear_ratio / radius_m,
        Some(radius_m) if slides => {
            let must = "must be finite and above 0";
            return Err(ParameterError::new("drive.pinion_radius", radius_m, "m", must).into());
        }
        None if slides => {
            let message = "drive.pinion_radius is missing: the carriage moves by it for a turn of 1 rad of its pinion";
            return Err(Fault::new("drive", message));
        }
        Some(_) => {
            return Err(Fault::on("drive.pinion_radius", "is for a carriage, but this is a hub"));
        }
        None => gear_ratio,
    };
    let stiffness = raw.joint_stiffness.map(|own| own.0);
    let suits = |own: Option<bool>| own.is_none_or(|own| own);
    for (key, is_right, units) in [
        ("joint_stiffness", suits(stiffness.map(|own| own.suits(slides))), ["N m/rad", "N/m"]),
        (
            "coulomb_friction",
            suits(raw.coulomb_friction.map(|own| own.suits(slides))),
            ["N m", "N"],
        ),
        ("friction_rate", suits(raw.friction_rate.map(|own| own.suits(slides))), ["rad/s", "m/s"]),
    ] {
        let place = if slides { "on a carriage" } else { "at a hub" };
        if !is_right {
            let words = format!("must be in {} {place}", units[usize::from(slides)]);
            return Err(Fault::on(format!("drive.{key}"), words));
        }
    }
    Ok(Drive {
        joint_stiffness_n_m_rad: stiffness.map_or(f64::INFINITY, |own| own.si),
        rotor_inertia_kg_m2: raw.rotor_inertia.si(),
        gear_ratio: ratio,
        efficiency: raw.efficiency.unwrap_or(1.0),
        coulomb_friction_n_m: raw.coulomb_friction.map_or(0.0, |own| own.si),
        friction_rate_rad_s: raw.friction_rate.map(|own| own.si),
        torque_constant_n_m_a: raw.torque_constant.map(Si::si),
        resistance_ohm: raw.resistance.map(Si::si),
    })
}

/// The limits of a link by the keys of its joint.
pub(super) fn limits(
    raw: &RawLimits,
    joint: &Joint,
    drive: Option<&Drive>,
) -> Result<Limits, Fault> {
    let of_joint = |(key, limit): &(&'static str, f64)| {
        let pair = OF_CARRIAGE.iter().find(|(own, of_hub, _)| own == key || of_hub == key);
        let Some((own, of_hub, _)) = pair else { return Ok((*key, *limit)) };
        let must = if joint.slides() { own } else { of_hub };
        if must == key {
            return Ok((*of_hub, *limit));
        }
        let place = if joint.slides() { "on a carriage" } else { "at a hub" };
        Err(Fault::on(format!("limits.{key}"), format!("must be {must} {place}")))
    };
    let limits = raw.0.iter().map(of_joint).collect::<Result<Vec<_>, _>>()?;
    let worded = |error: ParameterError| {
        let parameter = joint.worded(&error.parameter);
        // Limits of moments and motors keep their names and units.
        let is_of_joint = parameter != error.parameter;
        let found = if is_of_joint { joint.worded(&error.found) } else { error.found };
        ParameterError { parameter, found, must: joint.worded(&error.must) }
    };
    let limits = Limits::new(limits).and_then(|limits| limits.check(drive));
    Ok(limits.map_err(worded)?)
}

fn analysis(raw: &RawAnalysis) -> Result<Analysis, Fault> {
    let tolerance = raw.tolerance.unwrap_or(Analysis::DEFAULT_TOLERANCE);
    let tip_tolerance = raw.tip_tolerance.unwrap_or(Analysis::DEFAULT_TIP_TOLERANCE);
    let analysis = Analysis::new(tolerance, raw.lead.map(Si::si), raw.lag.map(Si::si))?
        .with_tip_tolerance(tip_tolerance)?;
    let analysis = match raw.second_order {
        Some(order) => analysis.with_second_order(order),
        None => analysis,
    };
    match raw.modes {
        Some(Count(modes)) => Ok(analysis.keeping_modes(modes)?),
        None => Ok(analysis),
    }
}

/// Damping law of `[damping]`.
fn damping(raw: &RawDamping) -> Result<Damping, Fault> {
    let model = match raw.model {
        Some(model) => model,
        None if raw.ratio.is_some() => Model::Hysteretic,
        None => {
            let names = listed(&Model::ALL.map(Model::name), "or");
            return Err(Fault::on("damping.model", format!("is missing, but must be {names}")));
        }
    };
    refuse_surplus(raw, model)?;
    match model {
        Model::Hysteretic => {
            let missing = || Fault::on("damping.ratio", "is missing");
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
        let (name, takes) = (model.name(), model.takes());
        let words = format!("does not belong to model \"{name}\", which takes {takes}");
        Err(Fault::on(format!("damping.{key}"), words).hinting(instead(key, model).to_owned()))
    })
}

/// Hint for a surplus key: mostly the model that it belongs to.
fn instead(key: &str, model: Model) -> &'static str {
    match key {
        _ if model == Model::None => {
            "leave the key out; --set replaces the table: 'damping={model=\"none\"}'"
        }
        "ratio" => "for one ratio in every mode, set model = \"modal\"",
        "ratios" => "for a ratio in each mode, set model = \"modal\"",
        "modes" => "for chosen modes, set model = \"caughey\", or \"rayleigh\" for two modes",
        _ => "for alpha and beta, set model = \"rayleigh\"",
    }
}

/// Error for a law without keys.
fn neither(model: Model) -> Fault {
    let (name, takes) = (model.name(), model.takes());
    Fault::on("damping", format!("lacks keys: model \"{name}\" needs {takes}"))
}

/// Error for a law given in two ways; it points at the last of its keys.
fn both(model: Model) -> Fault {
    let (name, takes) = (model.name(), model.takes());
    let paths = model.keys().iter().map(|key| format!("damping.{key}"));
    let message = format!("damping mixes keys: model \"{name}\" needs {takes}");
    Fault::among(paths.collect(), message)
}

fn modes_alone() -> Fault {
    Fault::on("damping", "has modes, but must have their ratios, too")
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
            Err(Fault::on("damping", "has ratios, but must have their modes, too"))
        }
        _ => Err(both(Model::Rayleigh)),
    }
}

fn counts(list: &[Count]) -> Vec<usize> {
    list.iter().map(|Count(count)| *count).collect()
}

fn pair<T: Copy + std::fmt::Debug>(path: &str, values: &[T]) -> Result<[T; 2], Fault> {
    let must = || Fault::on(path, format!("= {values:?}, but must hold two numbers"));
    values.try_into().map_err(|_| must())
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
