use super::error::{Fault, listed, nearest};
use super::raw::RawSection;
use crate::link::Section;
use crate::numeric::Dimension;

const SHAPES: [&str; 4] = ["rectangle", "circle", "tube", "box"];

/// A cross-section with just the dimensions that its shape takes.
pub(super) fn section(path: &str, raw: &RawSection) -> Result<Section, Fault> {
    let shape = raw.shape.as_str();
    let takes: &[&str] = match shape {
        "rectangle" => &["width", "thickness"],
        "circle" => &["diameter"],
        "tube" => &["diameter", "wall"],
        "box" => &["width", "height", "wall"],
        _ => {
            let must = format!("must be {}", listed(&SHAPES, "or"));
            let message = format!("{path}.shape = {shape:?}, but {must}");
            let near = nearest(shape, SHAPES).map(|near| format!("did you mean `{near}`?"));
            return Err(Fault::new(format!("{path}.shape"), message).hinting(near));
        }
    };
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
        "rectangle" => Section::Rectangle {
            width_m: length_m("width")?,
            thickness_m: length_m("thickness")?,
        },
        "circle" => Section::Circle {
            diameter_m: length_m("diameter")?,
        },
        "tube" => Section::Tube {
            diameter_m: length_m("diameter")?,
            wall_m: length_m("wall")?,
        },
        _ => Section::Box {
            width_m: length_m("width")?,
            height_m: length_m("height")?,
            wall_m: length_m("wall")?,
        },
    };
    section.check(path)?;
    Ok(section)
}
