//! Shear and rotary inertia of a segment: Timoshenko's theory, its keys, and the values from a cross-section.

use super::choices::Theory;
use super::error::Fault;
use super::raw::RawSegment;
use super::value::Si;
use crate::link::{CrossSection, ParameterError, Section, Taper, Timoshenko};

/// Results of a segment's other keys.
pub(super) struct Known {
    pub(super) section: Option<Section>,
    pub(super) cross_section: Option<CrossSection>,
    pub(super) mass_per_length_kg_m: Taper,
}

/// Shear and rotary inertia of the segment at a path; `None` for a slender segment.
pub(super) fn timoshenko(
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
            let path = format!("{at}.{key}");
            let message = format!("{path} is given, but must stand beside theory = \"timoshenko\"");
            let hint =
                "theory = \"timoshenko\" in this segment, or before all segments for the link";
            Err(Fault::new(path, message).hinting(hint.to_owned()))
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
            let must = "theory = \"timoshenko\" must have the shear stiffness in one way: shear_stiffness, \
                        or shear_modulus with section, or poisson_ratio with E and section";
            let keys = given(raw).into_iter().take(3).filter(|(_, is_given)| *is_given);
            let found: Vec<&str> = keys.map(|(key, _)| key).collect();
            let found = if found.is_empty() { "none".to_owned() } else { found.join(" and ") };
            let paths = ["shear_stiffness", "shear_modulus", "poisson_ratio"].map(path);
            let paths = paths.into_iter().chain([path("theory"), at.to_owned()]);
            let hint = "poisson_ratio = 0.3 is that of steel, 0.33 that of aluminium";
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
        let must = "must be given where neither section nor I with area is";
        let paths = vec![path.clone(), format!("{at}.theory"), at.to_owned()];
        return Err(Fault::among(paths, format!("{path} is missing, but {must}")));
    };
    let square = |mass: f64, radius_m: f64| mass * radius_m * radius_m;
    Ok(Taper::of_ends(known.mass_per_length_kg_m, section.radius_of_gyration_m, square))
}

#[cfg(test)]
mod tests {
    use crate::link::{Section, Taper};
    use crate::spec::{Override, Specification, read_specification};

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
            read.link.segments()[0].timoshenko.unwrap()
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
            read.link.segments().iter().map(|own| own.timoshenko.is_some()).collect()
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
                "link.toml:5: segments.0.shear_stiffness is given, but must stand beside theory = \
                 \"timoshenko\"",
            ),
            (
                format!("{WHOLE}theory = 'timoshenko'\n"),
                "link.toml:5: segments.0 gives none, but theory = \"timoshenko\" must have the shear \
                 stiffness in one way: shear_stiffness, or shear_modulus with section, or poisson_ratio \
                 with E and section",
            ),
            (
                format!("{WHOLE}theory = 'timoshenko'\nshear_stiffness = 1000\n"),
                "link.toml:5: segments.0.rotary_inertia_per_length is missing, but must be given where \
                 neither section nor I with area is",
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
                "link.toml:8: segments.0 gives shear_stiffness and poisson_ratio, but theory = \
                 \"timoshenko\" must have the shear stiffness in one way: shear_stiffness, or \
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
