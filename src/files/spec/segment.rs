//! A segment: its stiffness and its mass, each given in exactly one way, its cross-section, and its shear and rotary
//! inertia by Timoshenko's theory.

use super::error::{Fault, listed};
use super::raw::{MASS, Property, RawSection, RawSegment, STIFFNESS, Shape, Theory};
use super::value::Si;
use crate::link::{CrossSection, ParameterError, Section, Segment, Taper, Timoshenko};

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
        let must = "it needs E or density, and this segment has EI and mass_per_length";
        return Err(Fault::on(section_path, format!("has no effect: {must}")));
    }
    check_ranges(&at, &raw, &stiffness, &mass)?;
    let cross_section = match (section, stiffness.shape, mass.shape) {
        (Some(section), _, _) => Some(CrossSection::of(&section)),
        (None, Some(i_m4), Some(area_m2)) => Some(CrossSection::of_moment_and_area(i_m4, area_m2)),
        _ => None,
    };
    let known = Known { section, cross_section, mass_per_length_kg_m };
    let timoshenko = timoshenko(&at, &raw, theory, &known)?;
    Ok(Segment {
        name: raw.name,
        length_m: raw.length.si(),
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
        let words = format!("does not belong to a {shape}, which has {takes} only");
        return Err(Fault::on(format!("{path}.{key}"), words));
    }
    let length_m = |key: &str| {
        let value = given.iter().find(|(name, _)| *name == key).and_then(|(_, value)| *value);
        let missing = || Fault::on(format!("{path}.{key}"), "is missing");
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

/// Results of a segment's other keys.
struct Known {
    section: Option<Section>,
    cross_section: Option<CrossSection>,
    mass_per_length_kg_m: Taper,
}

/// Shear and rotary inertia of the segment at a path; `None` for a slender segment.
fn timoshenko(
    at: &str,
    raw: &RawSegment,
    of_link: Option<Theory>,
    known: &Known,
) -> Result<Option<Timoshenko>, Fault> {
    let theory = raw.theory.or(of_link);
    if let Some(found) = raw.poisson_ratio.filter(|ratio| !(*ratio > -1.0 && *ratio <= 0.5)) {
        let must = "must lie above -1 and at most at 0.5";
        let path = format!("{at}.poisson_ratio");
        return Err(ParameterError::new(path, found, "", must).into());
    }
    if theory == Some(Theory::Timoshenko) {
        let shear_stiffness_n = shear_stiffness_n(at, raw, known.section.as_ref())?;
        let rotary_inertia_per_length_kg_m = rotary_inertia_kg_m(at, raw, known)?;
        return Ok(Some(Timoshenko { shear_stiffness_n, rotary_inertia_per_length_kg_m }));
    }
    // If the file names the slender theory, numbers for the other theory may stay unused.
    let given = given(raw);
    if theory.is_some() && given[..3].iter().any(|(_, is_given)| *is_given) {
        shear_stiffness_n(at, raw, known.section.as_ref())?;
    }
    let given = given.into_iter().find(|(_, is_given)| *is_given);
    match given.filter(|_| theory.is_none()) {
        Some((key, _)) => {
            let words = "has no effect without theory = \"timoshenko\"";
            let hint =
                "set theory = \"timoshenko\" in this segment, or before all segments for the link";
            Err(Fault::on(format!("{at}.{key}"), words).hinting(hint.to_owned()))
        }
        None => Ok(None),
    }
}

fn given(raw: &RawSegment) -> [(&'static str, bool); 4] {
    [
        ("shear_stiffness", raw.shear_stiffness.is_some()),
        ("shear_modulus", raw.shear_modulus.is_some()),
        ("poisson_ratio", raw.poisson_ratio.is_some()),
        ("rotary_inertia_per_length", raw.rotary_inertia_per_length.is_some()),
    ]
}

/// Shear stiffness from its only combination of keys.
fn shear_stiffness_n(
    at: &str,
    raw: &RawSegment,
    section: Option<&Section>,
) -> Result<Taper, Fault> {
    let path = |key: &str| format!("{at}.{key}");
    let modulus = raw.shear_modulus.map(Si::si);
    let poisson_ratio = raw.poisson_ratio.unwrap_or(CrossSection::POISSON_RATIO);
    let of_section = |modulus_pa: f64, section: &Section| {
        Taper::constant(section.shear_coefficient(poisson_ratio) * modulus_pa * section.area_m2())
    };
    match (raw.shear_stiffness, modulus, raw.poisson_ratio, raw.modulus, section) {
        (Some(stiffness), None, None, ..) => Ok(stiffness.0),
        (None, Some(modulus), _, _, Some(section)) => Ok(of_section(modulus, section)),
        (None, None, Some(nu), Some(young), Some(section)) => {
            Ok(of_section(young.si() / (2.0 * (1.0 + nu)), section))
        }
        _ => {
            let must = "theory = \"timoshenko\" needs the shear stiffness in one way: shear_stiffness, \
                        or shear_modulus with section, or poisson_ratio with E and section";
            let keys = given(raw).into_iter().take(3).filter(|(_, is_given)| *is_given);
            let found: Vec<&str> = keys.map(|(key, _)| key).collect();
            let found =
                if found.is_empty() { "no key for it".to_owned() } else { found.join(" and ") };
            let paths = ["shear_stiffness", "shear_modulus", "poisson_ratio"].map(path);
            let paths = paths.into_iter().chain([path("theory"), at.to_owned()]);
            let hint = "set poisson_ratio, 0.3 for steel, 0.33 for aluminium";
            let message = format!("{at} gives {found}, but {must}");
            Err(Fault::among(paths.collect(), message).hinting(hint.to_owned()))
        }
    }
}

/// Rotary inertia per length: its own key, or `m̄ I/A`.
fn rotary_inertia_kg_m(at: &str, raw: &RawSegment, known: &Known) -> Result<Taper, Fault> {
    if let Some(rotary) = raw.rotary_inertia_per_length {
        return Ok(rotary.0);
    }
    let Some(section) = known.cross_section else {
        let path = format!("{at}.rotary_inertia_per_length");
        let must = "it is needed without section, and without I with area";
        let paths = vec![path.clone(), format!("{at}.theory"), at.to_owned()];
        return Err(Fault::among(paths, format!("{path} is missing: {must}")));
    };
    let square = |mass: f64, radius_m: f64| mass * radius_m * radius_m;
    Ok(Taper::of_ends(known.mass_per_length_kg_m, section.radius_of_gyration_m, square))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Override, Specification, read_specification};

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

    const WHOLE: &str = "[[segments]]\nlength = 1\nEI = 5\nmass_per_length = 0.8\n";
    const BAR: &str = "[[segments]]\nlength = 1\nE = '70 GPa'\ndensity = 2700\n\
                       section = { shape = 'rectangle', width = 0.02, thickness = 0.1 }\n";

    fn read(text: &str, changes: &[&str]) -> Result<Specification, String> {
        let changes: Vec<Override> = changes.iter().map(|change| change.parse().unwrap()).collect();
        read_specification("link.toml", text, &changes).map_err(|error| error.to_string())
    }

    #[test]
    fn shear_stiffness_is_given_in_three_ways() {
        let bar = |keys: &str| {
            let read = read(&format!("theory = 'timoshenko'\n{BAR}{keys}"), &[]).unwrap();
            read.link().segments()[0].timoshenko.unwrap()
        };
        let section = Section::Rectangle { width_m: 0.02, thickness_m: 0.1 };
        let (area, i) = (section.area_m2(), section.second_moment_m4());
        let near = |found: Taper, exact: f64| {
            assert!(found.is_constant() && (found.inner / exact - 1.0).abs() < 1e-14, "{found:?}");
        };
        let of_poisson = bar("poisson_ratio = 0.33");
        near(of_poisson.shear_stiffness_n, section.shear_coefficient(0.33) * 70e9 / 2.66 * area);
        near(of_poisson.rotary_inertia_per_length_kg_m, 2700.0 * i);
        let kappa = section.shear_coefficient(0.3);
        near(bar("shear_modulus = '26 GPa'").shear_stiffness_n, kappa * 26e9 * area);
        let own = bar("shear_stiffness = ['4 kN', 3000]\nrotary_inertia_per_length = '2 g m'");
        assert_eq!(own.shear_stiffness_n, Taper { inner: 4000.0, outer: 3000.0 });
        near(own.rotary_inertia_per_length_kg_m, 0.002);
    }

    #[test]
    fn a_segment_takes_its_own_theory_or_that_of_the_link() {
        let text = format!(
            "theory = 'timoshenko'\n{BAR}poisson_ratio = 0.3\n{BAR}theory = 'euler-bernoulli'\n"
        );
        let thick = |changes: &[&str]| -> Vec<bool> {
            let read = read(&text, changes).unwrap();
            read.link().segments().iter().map(|own| own.timoshenko.is_some()).collect()
        };
        assert_eq!(thick(&[]), [true, false]);
        assert_eq!(thick(&["theory=euler-bernoulli"]), [false, false]);
        // One combination replaces the other.
        let stiff = ["segments.0.shear_stiffness=3e7"];
        assert_eq!(thick(&stiff), [true, false]);
    }

    #[test]
    fn what_is_missing_or_too_much_is_refused_with_its_line() {
        for (text, expected) in [
            (
                format!("{WHOLE}shear_stiffness = 1000\n"),
                "link.toml:5: segments.0.shear_stiffness has no effect without theory = \"timoshenko\"",
            ),
            (
                format!("{WHOLE}theory = 'timoshenko'\n"),
                "link.toml:5: segments.0 gives no key for it, but theory = \"timoshenko\" needs the shear stiffness in one \
                 way: shear_stiffness, or shear_modulus with section, or poisson_ratio \
                 with E and section",
            ),
            (
                format!("{WHOLE}theory = 'timoshenko'\nshear_stiffness = 1000\n"),
                "link.toml:5: segments.0.rotary_inertia_per_length is missing: it is needed without section, and without I \
                 with area",
            ),
            (
                format!("theory = 'timoshenko'\n{BAR}poisson_ratio = 0.7\n"),
                "link.toml:7: segments.0.poisson_ratio = 0.7, but must lie above -1 and at most at 0.5",
            ),
            (
                format!("theory = 'euler-bernoulli'\n{BAR}shear_modulus = 0\n"),
                "link.toml:7: segments.0.shear_modulus = 0 Pa, but must be above 0",
            ),
            (
                format!(
                    "theory = 'euler-bernoulli'\n{BAR}shear_stiffness = 3\npoisson_ratio = 0.3\n"
                ),
                "link.toml:8: segments.0 gives shear_stiffness and poisson_ratio, but theory = \"timoshenko\" needs \
                 the shear stiffness in one way: shear_stiffness, or \
                 shear_modulus with section, or poisson_ratio with E and section",
            ),
            (
                format!("theory = 'timoshenko'\n{BAR}shear_stiffness = -3\n"),
                "link.toml:7: segments.0.shear_stiffness = -3 N, but must be above 0",
            ),
        ] {
            assert_eq!(read(&text, &[]).unwrap_err(), expected);
        }
    }
}
