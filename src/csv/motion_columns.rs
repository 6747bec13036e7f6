//! The columns of a tip trajectory.

use super::columns::{Columns, Header};
use super::format::Reading;
use super::heading::{
    ACCELERATION, ANGLE, ANGLES, DISPLACEMENT, Heading, Quantity, TIME, VELOCITY, Vocabulary, find,
    names, nearest, refuse_missing, require,
};
use super::place::{Place, TableError, quoted};
use super::unit_name::split_unit;

/// The tip's motion.
const TRAJECTORY: Vocabulary = Vocabulary {
    quantities: &[TIME, ACCELERATION, VELOCITY, DISPLACEMENT, ANGLE],
    prefix: "tip_",
    example: "time,acceleration",
    choice: None,
    by_option: "--columns time=1,displacement=2 says which column is what",
};

/// Most columns that a remark names.
const MOST_NAMED: usize = 8;

/// The quantities of which a motion has at least one.
const MOTIONS: [Quantity; 4] = [ACCELERATION, DISPLACEMENT, ANGLE, VELOCITY];

/// Reads the first row, and checks that the columns describe a motion.
pub(super) fn motion_columns(header: Header) -> Result<(Columns, Reading), TableError> {
    let Header { fields, place, .. } = header;
    let columns = Columns::find(&TRAJECTORY, header)?;
    let headings = &columns.headings;
    let has = |quantity: &Quantity| find(headings, *quantity).is_some();
    let is_motion = has(&TIME) && MOTIONS.iter().any(has);
    if !is_motion && let Some(index) = suspect(&columns, fields) {
        return Err(unknown_column(index, fields[index], place));
    }
    if let (Some(arc), Some(angle)) = (find(headings, DISPLACEMENT), find(headings, ANGLE)) {
        let (first, second) = if arc.index < angle.index { (arc, angle) } else { (angle, arc) };
        let first = first.named();
        let must = format!("must not be given with {first}: they are two names of one thing");
        let hint =
            "displacement = angle * link length; keep one of them, or choose it with --columns";
        let error = place.refuse_column(second.index, &second.name, must);
        return Err(error.with_hint(hint.to_owned()));
    }
    let by_option = || TRAJECTORY.by_option.to_owned();
    require(headings, TIME, fields, place).map_err(|error| error.or_hint(by_option()))?;
    if !is_motion {
        let wanted = "acceleration, displacement, angle or velocity";
        return Err(refuse_missing(&names(fields), wanted, place).or_hint(by_option()));
    }
    let reading = reading_of(&columns, fields);
    Ok((columns, reading))
}

/// A column that may be the one that is missing: the first one with a hint, else the first one unread.
fn suspect(columns: &Columns, fields: &[&str]) -> Option<usize> {
    let is_near =
        |index: &&usize| absent_by(&TRAJECTORY, &columns.headings, fields[**index]).is_some();
    columns.unread.iter().find(is_near).or(columns.unread.first()).copied()
}

/// The quantity that a table lacks and that an unknown heading may mean.
fn absent_by(vocabulary: &Vocabulary, headings: &[Heading], field: &str) -> Option<&'static str> {
    let absent = vocabulary.quantities.iter().filter(|known| find(headings, **known).is_none());
    let name = vocabulary.plain(split_unit(field).0);
    nearest(&name, absent.map(|quantity| quantity.word))
}

/// The reading of a motion's columns: columns that are not read, and a velocity that is integrated.
fn reading_of(columns: &Columns, fields: &[&str]) -> Reading {
    let has = |quantity: Quantity| find(&columns.headings, quantity).is_some();
    let is_velocity_alone = !(has(ACCELERATION) || has(DISPLACEMENT) || has(ANGLE));
    let integral = is_velocity_alone.then(|| "displacement as the velocity's integral".to_owned());
    let other = "--columns QUANTITY=NUMBER reads one of them instead";
    let (unread, hint) = unread(columns, fields, &TRAJECTORY, other);
    Reading { found: Vec::from_iter(integral), unread, hint, ..Reading::default() }
}

/// Which columns are not read, and what to do about them: a slip, or else the `other` hint.
pub(super) fn unread(
    columns: &Columns,
    fields: &[&str],
    vocabulary: &Vocabulary,
    other: &str,
) -> (Option<String>, Option<String>) {
    let named = |index: &usize| format!("{} {}", index + 1, quoted(fields[*index]));
    let mut unread: Vec<String> = columns.unread.iter().take(MOST_NAMED).map(named).collect();
    let more = columns.unread.len() - unread.len();
    unread.extend((more > 0).then(|| format!("and {more} more")));
    let slip = columns.unread.iter().find_map(|&index| {
        let word = absent_by(vocabulary, &columns.headings, fields[index])?;
        Some(format!("did you mean {word} by {}?", quoted(fields[index])))
    });
    let unread = (!unread.is_empty()).then(|| format!("columns not read: {}", unread.join(", ")));
    let hint = unread.as_ref().map(|_| slip.unwrap_or_else(|| other.to_owned()));
    (unread, hint)
}

fn unknown_column(index: usize, field: &str, place: Place) -> TableError {
    let words: Vec<&str> = TRAJECTORY.quantities.iter().map(|quantity| quantity.word).collect();
    let must = format!("must be one of {}", words.join(", "));
    let (name, _) = split_unit(field);
    let by_option = format!("{}; --skip N leaves out lines above the names", TRAJECTORY.by_option);
    place
        .refuse_column(index, field, must)
        .with_hint(hint_for(&TRAJECTORY.plain(name)))
        .or_hint(by_option)
}

/// What the user may have meant by an unknown name.
fn hint_for(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("a comma at the end of the row begins a column of its own".to_owned());
    }
    if name.starts_with("hub_") {
        return Some("a trajectory holds the tip's motion; the hub's follows from it".to_owned());
    }
    if ANGLES.iter().any(|quantity| quantity.word == name) {
        return Some(
            "an arm of several links is led by angle1, angle2, …; one link by angle".to_owned(),
        );
    }
    let begins = |quantity: &&Quantity| {
        let rest = name.strip_prefix(quantity.word);
        rest.is_some_and(|rest| rest.starts_with(['_', '(', '[', ' ']))
    };
    if let Some(quantity) = TRAJECTORY.quantities.iter().find(begins) {
        let [_, unit] = quantity.units;
        let word = quantity.word;
        return Some(format!("a unit follows in brackets: {word} [{unit}]"));
    }
    let words = TRAJECTORY.quantities.iter().map(|quantity| quantity.word);
    nearest(name, words).map(|word| format!("did you mean {word}?"))
}
