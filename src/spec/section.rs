use super::error::{Fault, listed, nearest};
use super::raw::RawSection;
use crate::link::Section;
use crate::numeric::{Dimension, excerpt};

pub(super) const SHAPES: [&str; 4] = ["rectangle", "circle", "tube", "box"];

/// A cross-section with just the dimensions that its shape takes.
pub(super) fn section(path: &str, raw: &RawSection) -> Result<Section, Fault> {
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

/// The keys that a shape takes.
pub(super) fn dimensions_of(shape: &str) -> Option<&'static [&'static str]> {
    Some(match shape {
        "rectangle" => &["width", "thickness"],
        "circle" => &["diameter"],
        "tube" => &["diameter", "wall"],
        "box" => &["width", "height", "wall"],
        _ => return None,
    })
}

fn unknown_shape(path: &str, shape: &str) -> Fault {
    let must = format!("must be {}", listed(&SHAPES, "or"));
    let message = format!("{path}.shape = {:?}, but {must}", excerpt(shape));
    let near = nearest(shape, SHAPES).map(|near| format!("did you mean `{near}`?"));
    Fault::new(format!("{path}.shape"), message).hinting(near)
}

#[cfg(test)]
mod tests {
    use super::super::quantity::Quantity;
    use super::*;

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
