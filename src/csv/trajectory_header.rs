use super::header::{
    Header, Heading, check_names, check_single, nearest, refuse_missing, split_unit,
};
use super::quantity::{Quantity, TRAJECTORY};
use super::table_error::{Place, TableError, quoted};

/// Reads the row that names the columns, and checks that together they describe a motion.
///
/// Every column must be one of a trajectory: an unknown one may be a known one misspelt.
pub(super) fn read_trajectory_header(fields: &[&str], place: Place) -> Result<Header, TableError> {
    check_names(fields, &TRAJECTORY, place)?;
    let mut headings: Vec<Heading> = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        let heading = Heading::read(index, field, &TRAJECTORY, place)?
            .ok_or_else(|| unknown_column(index, field, place))?;
        check_single(&headings, &heading, place)?;
        check_arc(&headings, &heading, place)?;
        headings.push(heading);
    }
    check_motion(&headings, place)?;
    Ok(Header { width: fields.len(), headings })
}

fn unknown_column(index: usize, field: &str, place: Place) -> TableError {
    let subject = format!("column {}", index + 1);
    let words: Vec<&str> = TRAJECTORY.quantities.iter().map(|quantity| quantity.word()).collect();
    let must = format!("must be one of {}", words.join(", "));
    let (name, _) = split_unit(field);
    place.refuse(subject, quoted(field), must).with_hint(hint_for(&TRAJECTORY.plain(name)))
}

/// What the user may have meant by a name that is not known.
fn hint_for(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("a comma at the end of the row begins a column of its own".to_owned());
    }
    if name.starts_with("hub_") {
        return Some("a trajectory holds the tip's motion; the hub's follows from it".to_owned());
    }
    let begins = |quantity: &&Quantity| {
        let rest = name.strip_prefix(quantity.word());
        rest.is_some_and(|rest| rest.starts_with(['_', '(', '[', ' ']))
    };
    if let Some(quantity) = TRAJECTORY.quantities.iter().find(begins) {
        let [_, unit] = quantity.units();
        let word = quantity.word();
        return Some(format!("a unit follows in brackets: {word} [{unit}]"));
    }
    let words = TRAJECTORY.quantities.iter().map(|quantity| quantity.word());
    nearest(name, words).map(|word| format!("did you mean {word}?"))
}

/// Refuses an angle beside a displacement.
fn check_arc(before: &[Heading], heading: &Heading, place: Place) -> Result<(), TableError> {
    let is_arc =
        |heading: &&Heading| matches!(heading.quantity, Quantity::Displacement | Quantity::Angle);
    let Some(earlier) = before.iter().find(is_arc).filter(|_| is_arc(&heading)) else {
        return Ok(());
    };
    let same = format!("{}, {}", earlier.subject(), quoted(&earlier.name));
    let must = format!("must not stand beside {same}: they are two names of one thing");
    let hint = "displacement = angle * link length; keep one of them";
    Err(place.refuse(heading.subject(), quoted(&heading.name), must).with_hint(hint.to_owned()))
}

fn check_motion(headings: &[Heading], place: Place) -> Result<(), TableError> {
    let has = |wanted| headings.iter().any(|heading| heading.quantity == wanted);
    let names: Vec<&str> = headings.iter().map(|h| h.name.as_str()).collect();
    if !has(Quantity::Time) {
        return Err(refuse_missing(&names, "time", place));
    }
    let moves = has(Quantity::Acceleration) || has(Quantity::Displacement) || has(Quantity::Angle);
    if !moves {
        return Err(refuse_missing(&names, "acceleration, displacement or angle", place));
    }
    Ok(())
}
