use super::choices::{SHAPES, dimensions_of};
use super::error::{Fault, listed, nearest};
use super::quantity::{Quantity, Tapered, positive};
use super::raw::{RawSection, RawSegment};
use crate::link::{CrossSection, ParameterError, Section, Segment, Taper};
use crate::numeric::{Dimension, excerpt};
use crate::result::Remark;

/// A segment, its stiffness and its mass each given in exactly one way.
pub(super) fn segment(index: usize, raw: RawSegment) -> Result<Segment, Fault> {
    let at = format!("segments.{index}");
    let length_m = raw.length.si(&format!("{at}.length"), Dimension::LENGTH)?;
    let section_path = format!("{at}.section");
    let section = raw.section.map(|raw| section(&section_path, &raw));
    let section = section.transpose()?;
    let stiffness_way = STIFFNESS.way(
        &at,
        raw.bending_stiffness.as_ref(),
        raw.modulus.as_ref(),
        (raw.second_moment.as_ref(), section.as_ref()),
    )?;
    let mass_way = MASS.way(
        &at,
        raw.mass_per_length.as_ref(),
        raw.density.as_ref(),
        (raw.area.as_ref(), section.as_ref()),
    )?;
    if let (Some(_), Way::Whole(_), Way::Whole(_)) = (section, &stiffness_way, &mass_way) {
        let must = "must go with E or density, and this segment gives EI and mass_per_length";
        let message = format!("{section_path} is given, but {must}");
        return Err(Fault::new(section_path, message));
    }
    let cross_section = cross_section(&at, section.as_ref(), &stiffness_way, &mass_way)?;
    Ok(Segment {
        name: raw.name,
        length_m,
        bending_stiffness_n_m2: stiffness(&at, &stiffness_way)?,
        mass_per_length_kg_m: mass_per_length(&at, &mass_way)?,
        cross_section,
    })
}

/// Remarks on unusual materials.
pub(super) fn remarks(segments: &[RawSegment]) -> Result<Vec<Remark>, Fault> {
    let mut remarks = Vec::new();
    for (index, raw) in segments.iter().enumerate() {
        if let Some(modulus) = &raw.modulus {
            let path = format!("segments.{index}.E");
            remarks.extend(Remark::on_modulus(&path, modulus.si(&path, Dimension::PRESSURE)?));
        }
        if let Some(density) = &raw.density {
            let path = format!("segments.{index}.density");
            remarks.extend(Remark::on_density(&path, density.si(&path, Dimension::DENSITY)?));
        }
    }
    Ok(remarks)
}

/// The cross-section by `section`, or by I and area if both are given.
fn cross_section(
    at: &str,
    section: Option<&Section>,
    stiffness: &Way<'_>,
    mass: &Way<'_>,
) -> Result<Option<CrossSection>, Fault> {
    match (section, stiffness, mass) {
        (Some(section), _, _) => Ok(Some(CrossSection::of(section))),
        (None, Way::Shape(_, i), Way::Shape(_, area)) => {
            let (i_m4, area_m2) = (second_moment_m4(at, i)?, area_m2(at, area)?);
            Ok(Some(CrossSection::of_moment_and_area(i_m4, area_m2)))
        }
        _ => Ok(None),
    }
}

fn second_moment_m4(at: &str, i: &Tapered) -> Result<Taper, Fault> {
    let path = format!("{at}.I");
    positive(&path, i.si(&path, Dimension::SECOND_MOMENT)?, "m^4")
}

fn area_m2(at: &str, area: &Tapered) -> Result<Taper, Fault> {
    let path = format!("{at}.area");
    positive(&path, area.si(&path, Dimension::AREA)?, "m^2")
}

fn stiffness(at: &str, way: &Way<'_>) -> Result<Taper, Fault> {
    let modulus = |value: &Quantity| {
        let path = format!("{at}.E");
        let e_pa = value.si(&path, Dimension::PRESSURE)?;
        positive(&path, Taper::constant(e_pa), "Pa").map(|_| e_pa)
    };
    match way {
        Way::Whole(ei) => {
            let path = format!("{at}.EI");
            positive(&path, ei.si(&path, Dimension::BENDING_STIFFNESS)?, "N m^2")
        }
        Way::Shape(e, i) => Ok(second_moment_m4(at, i)?.scaled(modulus(e)?)),
        Way::Section(e, section) => {
            Ok(Taper::constant(section.second_moment_m4()).scaled(modulus(e)?))
        }
    }
}

fn mass_per_length(at: &str, way: &Way<'_>) -> Result<Taper, Fault> {
    let density = |value: &Quantity| {
        let path = format!("{at}.density");
        let kg_m3 = value.si(&path, Dimension::DENSITY)?;
        if kg_m3 < 0.0 {
            let must = "must be at least 0";
            return Err(ParameterError::new(path, kg_m3, "kg/m^3", must).into());
        }
        Ok::<_, Fault>(kg_m3)
    };
    match way {
        Way::Whole(mass) => mass.si(&format!("{at}.mass_per_length"), Dimension::MASS_PER_LENGTH),
        Way::Shape(rho, area) => Ok(area_m2(at, area)?.scaled(density(rho)?)),
        Way::Section(rho, section) => Ok(Taper::constant(section.area_m2()).scaled(density(rho)?)),
    }
}

/// A property along the segment, given as a whole or as a material's constant times a property of the
/// cross-section.
struct Property {
    name: &'static str,
    whole: &'static str,
    material: &'static str,
    shape: &'static str,
}

const STIFFNESS: Property =
    Property { name: "bending stiffness", whole: "EI", material: "E", shape: "I" };

const MASS: Property = Property {
    name: "mass per length",
    whole: "mass_per_length",
    material: "density",
    shape: "area",
};

/// The one way in which a property is given.
enum Way<'a> {
    Whole(&'a Tapered),
    Shape(&'a Quantity, &'a Tapered),
    Section(&'a Quantity, &'a Section),
}

impl Property {
    fn way<'a>(
        &self,
        at: &str,
        whole: Option<&'a Tapered>,
        material: Option<&'a Quantity>,
        (shape, section): (Option<&'a Tapered>, Option<&'a Section>),
    ) -> Result<Way<'a>, Fault> {
        match (whole, material, shape, section) {
            (Some(whole), None, None, _) => Ok(Way::Whole(whole)),
            (None, Some(material), Some(shape), None) => Ok(Way::Shape(material, shape)),
            (None, Some(material), None, Some(section)) => Ok(Way::Section(material, section)),
            _ => {
                let given = [
                    (self.whole, whole.is_some()),
                    (self.material, material.is_some()),
                    (self.shape, shape.is_some()),
                    ("section", section.is_some()),
                ];
                let given = given.into_iter().filter(|(_, given)| *given);
                Err(self.refusal(at, &given.map(|(key, _)| key).collect::<Vec<_>>()))
            }
        }
    }

    /// Names the keys that exclude each other, or the missing key.
    fn refusal(&self, at: &str, given: &[&str]) -> Fault {
        let Self { name, whole, material, shape } = self;
        let has = |key: &&str| given.contains(key);
        let (keys, found) = if has(whole) {
            let clash: Vec<&str> = given.iter().copied().filter(|k| *k != "section").collect();
            let found = format!("gives {}", listed(&clash, "and"));
            (clash, found)
        } else if has(shape) && has(&"section") {
            let clash = vec![*shape, "section"];
            (clash, format!("gives {shape} and section"))
        } else if has(material) {
            let found = format!("gives {material} without {shape} or section");
            (vec![*material], found)
        } else if let Some(key) = given.first() {
            (vec![*key], format!("gives {key} without {material}"))
        } else {
            (vec![], format!("gives no {name}"))
        };
        let must = format!("{whole}, or {material} with {shape}, or {material} with section");
        let message = format!("{at} {found}, but must give the {name} in one way: {must}");
        let paths = keys.iter().map(|key| format!("{at}.{key}"));
        Fault::among(paths.chain([at.to_owned()]).collect(), message)
    }
}

/// A cross-section with just the dimensions that its shape takes.
fn section(path: &str, raw: &RawSection) -> Result<Section, Fault> {
    let shape = raw.shape.as_str();
    let takes = dimensions_of(shape).ok_or_else(|| unknown_shape(path, shape))?;
    let given = [
        ("width", &raw.width),
        ("thickness", &raw.thickness),
        ("height", &raw.height),
        ("diameter", &raw.diameter),
        ("wall", &raw.wall),
    ];
    let mut keys = given.iter().filter(|(_, value)| value.is_some());
    if let Some((key, _)) = keys.find(|(key, _)| !takes.contains(key)) {
        let takes = listed(takes, "and");
        let message = format!("{path}.{key} is given, but a {shape} must have {takes} only");
        return Err(Fault::new(format!("{path}.{key}"), message));
    }
    let length_m = |key: &str| {
        let inner = format!("{path}.{key}");
        let value = given.iter().find(|(name, _)| *name == key);
        match value.and_then(|(_, value)| value.as_ref()) {
            Some(value) => value.si(&inner, Dimension::LENGTH),
            None => Err(Fault::new(&inner, format!("{inner} is missing"))),
        }
    };
    let section = match shape {
        "rectangle" => {
            Section::Rectangle { width_m: length_m("width")?, thickness_m: length_m("thickness")? }
        }
        "circle" => Section::Circle { diameter_m: length_m("diameter")? },
        "tube" => Section::Tube { diameter_m: length_m("diameter")?, wall_m: length_m("wall")? },
        _ => Section::Box {
            width_m: length_m("width")?,
            height_m: length_m("height")?,
            wall_m: length_m("wall")?,
        },
    };
    section.check(path)?;
    Ok(section)
}

fn unknown_shape(path: &str, shape: &str) -> Fault {
    let must = format!("must be {}", listed(&SHAPES, "or"));
    let message = format!("{path}.shape = {:?}, but {must}", excerpt(shape));
    let near = nearest(shape, SHAPES).map(|near| format!("did you mean `{near}`?"));
    Fault::new(format!("{path}.shape"), message).hinting(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn just_three_sets_of_keys_give_a_property() {
        let (tapered, number) = (Tapered::Constant(Quantity::Number(1.0)), Quantity::Number(1.0));
        let section = Section::Circle { diameter_m: 0.01 };
        let accepted = (0..16).filter(|set| {
            let way = STIFFNESS.way(
                "segments.0",
                (set & 1 != 0).then_some(&tapered),
                (set & 2 != 0).then_some(&number),
                ((set & 4 != 0).then_some(&tapered), (set & 8 != 0).then_some(&section)),
            );
            way.is_ok()
        });
        // EI, with the section for the mass or without; E with I; E with section.
        assert_eq!(accepted.collect::<Vec<_>>(), [1, 2 + 4, 1 + 8, 2 + 8]);
    }

    #[test]
    fn a_dimension_of_another_shape_is_refused_and_an_own_one_is_needed() {
        let raw = |shape: &str, wall: Option<f64>| RawSection {
            shape: shape.into(),
            width: None,
            thickness: None,
            height: None,
            diameter: Some(Quantity::Text("20 mm".into())),
            wall: wall.map(Quantity::Number),
        };
        let tube = Section::Tube { diameter_m: 0.02, wall_m: 0.001 };
        assert_eq!(section("section", &raw("tube", Some(0.001))), Ok(tube));
        assert!(section("section", &raw("tube", None)).is_err());
        assert!(section("section", &raw("circle", None)).is_ok());
        assert!(section("section", &raw("circle", Some(0.001))).is_err());
    }
}
