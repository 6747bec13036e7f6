//! A segment: its stiffness and its mass, each given in exactly one way, and its cross-section.

use super::choices::{MASS, Property, STIFFNESS, Shape, Theory};
use super::error::{Fault, listed};
use super::raw::{RawSection, RawSegment};
use super::theory::{Known, timoshenko};
use super::value::Si;
use crate::link::{CrossSection, ParameterError, Section, Segment, Taper};

/// Reads the segment `segments.{index}` of a link file; `theory` is the theory of the link.
pub(super) fn segment(
    index: usize,
    raw: RawSegment,
    theory: Option<Theory>,
) -> Result<Segment, Fault> {
    let at = format!("segments.{index}");
    let section_path = format!("{at}.section");
    let section = raw.section.as_ref().map(|raw| section(&section_path, raw)).transpose()?;
    let stiffness = Given {
        whole: raw.bending_stiffness.map(|ei| ei.0),
        material: raw.modulus.map(Si::si),
        shape: raw.second_moment.map(|i| i.0),
        section: section.map(|section| section.second_moment_m4()),
    };
    let mass = Given {
        whole: raw.mass_per_length.map(|mass| mass.0),
        material: raw.density.map(Si::si),
        shape: raw.area.map(|area| area.0),
        section: section.map(|section| section.area_m2()),
    };
    let bending_stiffness_n_m2 = stiffness.value(&STIFFNESS, &at)?;
    let mass_per_length_kg_m = mass.value(&MASS, &at)?;
    if section.is_some() && stiffness.whole.is_some() && mass.whole.is_some() {
        let must = "must go with E or density, and this segment gives EI and mass_per_length";
        let message = format!("{section_path} is given, but {must}");
        return Err(Fault::new(section_path, message));
    }
    check_ranges(&at, &raw, &stiffness, &mass)?;
    let cross_section = match (section, stiffness.shape, mass.shape) {
        (Some(section), _, _) => Some(CrossSection::of(&section)),
        (None, Some(i_m4), Some(area_m2)) => Some(CrossSection::of_moment_and_area(i_m4, area_m2)),
        _ => None,
    };
    let known = Known { section, cross_section, mass_per_length_kg_m };
    let timoshenko = timoshenko(&at, &raw, theory, &known)?;
    let length_m = raw.length.si();
    let name = raw.name;
    Ok(Segment {
        name,
        length_m,
        bending_stiffness_n_m2,
        mass_per_length_kg_m,
        cross_section,
        timoshenko,
    })
}

/// Refuses a value out of its range under its key in the file; [`Link::new`] only knows products.
///
/// [`Link::new`]: crate::link::Link::new
fn check_ranges(at: &str, raw: &RawSegment, stiffness: &Given, mass: &Given) -> Result<(), Fault> {
    let density = mass.material.map(Taper::constant);
    let shear_modulus = raw.shear_modulus.map(|modulus| Taper::constant(modulus.si()));
    let rotary = raw.rotary_inertia_per_length.map(|own| own.0);
    for (key, value, unit, zero) in [
        ("I", stiffness.shape, "m^4", "above 0"),
        ("area", mass.shape, "m^2", "above 0"),
        ("EI", stiffness.whole, "N m^2", "above 0"),
        ("E", stiffness.material.map(Taper::constant), "Pa", "above 0"),
        ("density", density, "kg/m^3", "at least 0"),
        ("shear_stiffness", raw.shear_stiffness.map(|own| own.0), "N", "above 0"),
        ("shear_modulus", shear_modulus, "Pa", "above 0"),
        ("rotary_inertia_per_length", rotary, "kg m", "at least 0"),
    ] {
        let ends = value.into_iter().flat_map(|Taper { inner, outer }| [inner, outer]);
        let is_out = |end: &f64| *end < 0.0 || *end == 0.0 && zero == "above 0";
        if let Some(end) = ends.into_iter().find(is_out) {
            let path = format!("{at}.{key}");
            return Err(ParameterError::new(path, end, unit, format!("must be {zero}")).into());
        }
    }
    Ok(())
}

/// Keys of a segment for a [`Property`], in SI.
struct Given {
    whole: Option<Taper>,
    material: Option<f64>,
    shape: Option<Taper>,
    section: Option<f64>,
}

impl Given {
    /// The property from its only combination of keys.
    fn value(&self, property: &Property, at: &str) -> Result<Taper, Fault> {
        match (self.whole, self.material, self.shape, self.section) {
            (Some(whole), None, None, _) => Ok(whole),
            (None, Some(material), Some(shape), None) => Ok(shape.scaled(material)),
            (None, Some(material), None, Some(section)) => {
                Ok(Taper::constant(section).scaled(material))
            }
            _ => Err(self.refusal(property, at)),
        }
    }

    /// Error that names the keys that exclude each other, or the missing key.
    fn refusal(&self, property: &Property, at: &str) -> Fault {
        let Property { name, whole, material, shape } = property;
        let given = [
            (*whole, self.whole.is_some()),
            (*material, self.material.is_some()),
            (*shape, self.shape.is_some()),
        ];
        let given = given.iter().filter(|(_, is_given)| *is_given).map(|(key, _)| *key);
        let given: Vec<&str> = given.collect();
        let (keys, found) = if self.whole.is_some() {
            let found = format!("gives {}", listed(&given, "and"));
            (given, found)
        } else if self.shape.is_some() && self.section.is_some() {
            (vec![*shape, "section"], format!("gives {shape} and section"))
        } else if self.material.is_some() {
            (vec![*material], format!("gives {material} without {shape} or section"))
        } else if self.shape.is_some() {
            (vec![*shape], format!("gives {shape} without {material}"))
        } else if self.section.is_some() {
            (vec!["section"], format!("gives section without {material}"))
        } else {
            (vec![], format!("gives no {name}"))
        };
        let must = format!("{whole}, or {material} with {shape}, or {material} with section");
        let message = format!("{at} {found}, but must give the {name} in one way: {must}");
        let paths = keys.iter().map(|key| format!("{at}.{key}"));
        Fault::among(paths.chain([at.to_owned()]).collect(), message)
    }
}

/// Reads a cross-section with exactly the dimensions of its shape.
fn section(path: &str, raw: &RawSection) -> Result<Section, Fault> {
    let takes = raw.shape.dimensions();
    let given = [
        ("width", raw.width),
        ("thickness", raw.thickness),
        ("height", raw.height),
        ("diameter", raw.diameter),
        ("wall", raw.wall),
    ];
    let mut keys = given.iter().filter(|(_, value)| value.is_some());
    if let Some((key, _)) = keys.find(|(key, _)| !takes.contains(key)) {
        let (shape, takes) = (raw.shape.name(), listed(takes, "and"));
        let message = format!("{path}.{key} is given, but a {shape} must have {takes} only");
        return Err(Fault::new(format!("{path}.{key}"), message));
    }
    let length_m = |key: &str| {
        let value = given.iter().find(|(name, _)| *name == key).and_then(|(_, value)| *value);
        let missing = || Fault::new(format!("{path}.{key}"), format!("{path}.{key} is missing"));
        value.map(Si::si).ok_or_else(missing)
    };
    let section = match raw.shape {
        Shape::Rectangle => {
            Section::Rectangle { width_m: length_m("width")?, thickness_m: length_m("thickness")? }
        }
        Shape::Circle => Section::Circle { diameter_m: length_m("diameter")? },
        Shape::Tube => {
            Section::Tube { diameter_m: length_m("diameter")?, wall_m: length_m("wall")? }
        }
        Shape::Box => Section::Box {
            width_m: length_m("width")?,
            height_m: length_m("height")?,
            wall_m: length_m("wall")?,
        },
    };
    section.check(path)?;
    Ok(section)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::read_specification;

    #[test]
    fn just_three_sets_of_keys_give_a_property() {
        let accepted = (0..16).filter(|set| {
            let given = Given {
                whole: (set & 1 != 0).then_some(Taper::constant(1.0)),
                material: (set & 2 != 0).then_some(1.0),
                shape: (set & 4 != 0).then_some(Taper::constant(1.0)),
                section: (set & 8 != 0).then_some(1.0),
            };
            given.value(&STIFFNESS, "segments.0").is_ok()
        });
        // EI, with the section for the mass or without; E with I; E with section.
        assert_eq!(accepted.collect::<Vec<_>>(), [1, 2 + 4, 1 + 8, 2 + 8]);
    }

    #[test]
    fn a_dimension_of_another_shape_is_refused_and_an_own_one_is_needed() {
        let accepts = |section: &str| {
            let text = format!(
                "[[segments]]\nlength = 1\nE = 1\ndensity = 1\n\
                 section = {{ diameter = '20 mm', {section} }}"
            );
            read_specification("link.toml", &text, &[]).is_ok()
        };
        assert!(accepts("shape = 'tube', wall = 0.001"));
        assert!(!accepts("shape = 'tube'"));
        assert!(accepts("shape = 'circle'"));
        assert!(!accepts("shape = 'circle', wall = 0.001"));
    }
}
