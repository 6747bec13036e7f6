//! Columns of a tip trajectory, and the angle from places of the tip.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::columns::{Beside, Columns, Header};
use super::heading::{
    ACCELERATION, ANGLE, ANGLES, CARRIAGE, DISPLACEMENT, PATH_X, PATH_Y, Quantity, Spelling, TIME,
    VELOCITY, Vocabulary, joined, names, nearest, refuse_missing,
};
use super::input::{Place, TableError, quoted};
use super::samples::{Samples, refuse_samples};
use super::unit_name::split_unit;
use crate::recording::Rounding;
use crate::text::significant;

/// Names of the tip's motion.
const TRAJECTORY: Vocabulary = Vocabulary {
    quantities: &[TIME, ACCELERATION, VELOCITY, DISPLACEMENT, ANGLE],
    prefix: "tip_",
    example: "time,acceleration",
    choice: None,
    by_option: "--columns time=1,displacement=2 names the columns",
};

/// Names of the tip's place, whose direction is the angle.
const PLACES: Vocabulary = Vocabulary {
    quantities: &[TIME, PATH_X, PATH_Y],
    example: "time,x,y",
    by_option: "--columns time=1,x=2,y=3 names the columns",
    ..TRAJECTORY
};

/// Names of an arm's path.
const PATH: Vocabulary = Vocabulary {
    quantities: &joined::<13>(&[&[TIME, PATH_X, PATH_Y], &ANGLES, &[CARRIAGE]]),
    prefix: "tip_",
    example: "time,x,y",
    choice: None,
    by_option: PATH_BY_OPTION,
};

/// Hint about a choice of columns: after a choice of one quantity, others are not searched.
const PATH_BY_OPTION: &str = "--columns time=1,x=2,y=3 names the columns";

/// Largest number of columns in a remark.
const MOST_NAMED: usize = 8;

/// Quantities that define a motion; it has at least one of them.
const MOTIONS: [Quantity; 4] = [ACCELERATION, DISPLACEMENT, ANGLE, VELOCITY];

/// Reads the first row, and checks that its columns describe a motion.
pub(super) fn motion_columns(header: Header) -> Result<Columns, TableError> {
    let Header { fields, place, .. } = header;
    if is_of_places(header) {
        return place_columns(header);
    }
    let mut columns = Columns::find(&TRAJECTORY, header, Beside::Time)?;
    let is_motion = columns.has(TIME) && MOTIONS.iter().any(|quantity| columns.has(*quantity));
    if !is_motion && let Some(index) = suspect(&columns, fields) {
        return Err(unknown_column(index, fields[index], place));
    }
    let hint = "displacement = angle * link length; keep one of them, or choose it with --columns displacement=COLUMN";
    columns.refuse_both([DISPLACEMENT, ANGLE], header, hint)?;
    check_angle(&columns, header)?;
    let by_option = || TRAJECTORY.by_option.to_owned();
    columns.require(TIME, header).map_err(|error| error.or_hint(by_option()))?;
    if !is_motion {
        let wanted = "acceleration, displacement, angle or velocity";
        return Err(refuse_missing(&names(fields), wanted, place).or_hint(by_option()));
    }
    if ![ACCELERATION, DISPLACEMENT, ANGLE].iter().any(|quantity| columns.has(*quantity)) {
        columns.reading.found.push("displacement as the velocity's integral".to_owned());
    }
    columns.reading.unread = unread(&columns, fields, &TRAJECTORY, OTHER);
    Ok(columns)
}

/// Refuses an angle with a common heading, such as `Angle (°)`, beside a displacement that is not read: it may be the
/// hub's.
fn check_angle(columns: &Columns, header: Header) -> Result<(), TableError> {
    let Header { fields, place, format } = header;
    let column = |quantity, way| {
        fields.iter().position(|field| TRAJECTORY.spelling(field, quantity) == Some(way))
    };
    let is_chosen = format.columns.iter().any(|choice| choice.quantity != TIME);
    let found = column(ANGLE, Spelling::Free).zip(column(DISPLACEMENT, Spelling::Alias));
    let Some((angle, other)) = found.filter(|_| !is_chosen && columns.has(ANGLE)) else {
        return Ok(());
    };
    let must = format!(
        "must not stand beside {}: either may be the motion of the tip",
        quoted(fields[other])
    );
    let hint = format!(
        "--columns time=1,displacement={} or --columns time=1,angle={} chooses one",
        other + 1,
        angle + 1
    );
    Err(place.refuse_column(angle, fields[angle], must).with_hint(hint))
}

/// Reads the first row, and checks that its columns describe a path.
pub(super) fn path_columns(header: Header) -> Result<Columns, TableError> {
    let Header { fields, place, .. } = header;
    let mut columns = Columns::find(&PATH, header, Beside::Time)?;
    columns.require(TIME, header).map_err(|error| error.or_hint(PATH_BY_OPTION.to_owned()))?;
    let hint = format!(
        "the path of an arm has time, x and y, or time, angle1, angle2, …; {PATH_BY_OPTION}"
    );
    check_places(&columns, header, PATH_BY_OPTION, &hint)?;
    if !columns.has(PATH_X) && !ANGLES.iter().any(|quantity| columns.has(*quantity)) {
        return Err(refuse_missing(&names(fields), "x and y, or angle1", place).with_hint(hint));
    }
    columns.reading.unread = unread(&columns, fields, &PATH, PATH_BY_OPTION);
    Ok(columns)
}

/// True if the columns x and y of a table are the tip's place: by the user's choice, or because both are present and
/// neither the user nor a standard name defines another motion.
fn is_of_places(header: Header) -> bool {
    let is_place = |quantity: Quantity| [PATH_X, PATH_Y].contains(&quantity);
    let chosen = || header.format.columns.iter().map(|choice| choice.quantity);
    if chosen().any(|quantity| quantity != TIME) {
        return chosen().any(is_place);
    }
    let spelling = |quantity: Quantity| {
        header.fields.iter().filter_map(move |field| TRAJECTORY.spelling(field, quantity))
    };
    let is_named = |quantity| spelling(quantity).any(|way| way != Spelling::Alias);
    is_named(PATH_X) && is_named(PATH_Y) && !MOTIONS.into_iter().any(is_named)
}

/// Finds the time and the tip's place.
fn place_columns(header: Header) -> Result<Columns, TableError> {
    let mut columns = Columns::find(&PLACES, header, Beside::Time)?;
    let by_option = PLACES.by_option;
    columns.require(TIME, header).map_err(|error| error.or_hint(by_option.to_owned()))?;
    check_places(&columns, header, by_option, by_option)?;
    columns.reading.found.push("angle as the direction of x and y".to_owned());
    columns.reading.unread = unread(&columns, header.fields, &PLACES, OTHER);
    Ok(columns)
}

/// Refuses x without y and y without x.
fn check_places(
    columns: &Columns,
    header: Header,
    by_option: &str,
    hint: &str,
) -> Result<(), TableError> {
    for (own, other) in [(PATH_X, PATH_Y), (PATH_Y, PATH_X)] {
        if !columns.has(own) {
            continue;
        }
        let is_chosen = header.format.columns.iter().any(|choice| choice.quantity != TIME);
        if is_chosen && !columns.has(other) {
            let must = format!("must also choose {}: it reads no other column", other.word);
            let error = header.place.refuse("--columns", own.word, must);
            return Err(error.with_hint(by_option.to_owned()));
        }
        columns.require(other, header).map_err(|error| error.or_hint(hint.to_owned()))?;
    }
    Ok(())
}

/// Remedy for an unread column.
const OTHER: &str = "--columns QUANTITY=NUMBER reads one of them instead";

/// A column that may be the missing one: the first with a hint, else the first unread one.
fn suspect(columns: &Columns, fields: &[&str]) -> Option<usize> {
    let is_near = |index: &&usize| absent_by(&TRAJECTORY, columns, fields[**index]).is_some();
    columns.unread.iter().find(is_near).or(columns.unread.first()).copied()
}

/// The absent quantity that an unknown heading may mean.
fn absent_by(vocabulary: &Vocabulary, columns: &Columns, field: &str) -> Option<&'static str> {
    let absent = vocabulary.quantities.iter().filter(|known| !columns.has(**known));
    let name = vocabulary.plain(split_unit(field).0);
    nearest(&name, absent.map(|quantity| quantity.word)).filter(|word| *word != name)
}

/// Unread columns, and a remedy: correcting a slip, or else the `other` hint.
pub(super) fn unread(
    columns: &Columns,
    fields: &[&str],
    vocabulary: &Vocabulary,
    other: &str,
) -> Option<(String, String)> {
    let named = |index: &usize| format!("{} {}", index + 1, quoted(fields[*index]));
    let mut unread: Vec<String> = columns.unread.iter().take(MOST_NAMED).map(named).collect();
    let more = columns.unread.len() - unread.len();
    unread.extend((more > 0).then(|| format!("and {more} more")));
    let slip = columns.unread.iter().find_map(|&index| {
        let word = absent_by(vocabulary, columns, fields[index])?;
        Some(format!("did you write {word} as {}?", quoted(fields[index])))
    });
    let hint = slip.unwrap_or_else(|| other.to_owned());
    (!unread.is_empty()).then(|| (format!("columns not read: {}", unread.join(", ")), hint))
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

/// Possible meaning of an unknown name.
fn hint_for(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("a comma at the end of the row begins a column of its own".to_owned());
    }
    if name.starts_with("hub_") {
        return Some("a trajectory holds the tip's motion; the hub's follows from it".to_owned());
    }
    if ANGLES.iter().any(|quantity| quantity.word == name) {
        return Some(
            "an arm of several links takes angle1, angle2, …; one link takes angle".to_owned(),
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

/// Largest distance of a tip from the circle about the hub, as a share of the link's length.
const OFF_CIRCLE: f64 = 0.02;

/// Other possible meanings of such a table.
const OF_PLACES: &str = "x and y are places from the hub's axis; name their unit as in \"x [mm]\", or --columns displacement=N \
                    reads one column as the arc of the tip";

/// Angles in rad, and their rounding.
type Angles = (Vec<f64>, Option<Rounding>);

/// Takes the angle of the tip's place from a table that has it, in rad and continuous over turns, with its rounding in
/// rad.
///
/// # Errors
/// [`TableError`] for a place whose distance from the hub is not the link's length, and for a tip that turns by more
/// than a quarter in one step.
pub(super) fn take_angle(
    samples: &mut Samples,
    file: &str,
    link_length_m: f64,
) -> Result<Option<Angles>, TableError> {
    let rounding = [PATH_X, PATH_Y].map(|quantity| samples.rounding_of(quantity));
    let Some((x, y)) = samples.take(PATH_X).zip(samples.take(PATH_Y)) else { return Ok(None) };
    let mut angles: Vec<f64> = Vec::with_capacity(x.len());
    for (k, (x, y)) in x.into_iter().zip(y).enumerate() {
        let refuse = |what: &str, found: f64, unit: &str, must: String| {
            let why = format!("{what} = {} {unit}, but {must}", significant(found, 4));
            refuse_samples(file, &samples.lines, Some(k), &why, Some(OF_PLACES))
        };
        let radius_m = libm::hypot(x, y);
        if (radius_m - link_length_m).abs() > OFF_CIRCLE * link_length_m {
            let length = significant(link_length_m, 4);
            let must = format!(
                "must be the link's length of {length} m within {} %",
                significant(100.0 * OFF_CIRCLE, 2)
            );
            return Err(refuse("distance of x and y from the hub", radius_m, "m", must));
        }
        let within = libm::atan2(y, x);
        let Some(before) = angles.last() else {
            angles.push(within);
            continue;
        };
        let turn = (within - before) - TAU * ((within - before) / TAU).round();
        if turn.abs() > FRAC_PI_2 {
            let must = "must be at most a quarter turn in one step".to_owned();
            return Err(refuse("turn of x and y about the hub", turn, "rad", must));
        }
        angles.push(before + turn);
    }
    let rounding = match rounding {
        [Some(x), Some(y)] => Some(Rounding {
            decimals: x.decimals.min(y.decimals),
            step: libm::hypot(x.step, y.step) / link_length_m,
        }),
        _ => None,
    };
    Ok(Some((angles, rounding)))
}

#[cfg(test)]
mod tests {
    use crate::csv::{MotionTable, TableError, TableFormat, read_motion_table_as};
    use std::f64::consts::PI;

    const LENGTH_M: f64 = 1.5;

    fn read(text: &str, choices: &[&str]) -> Result<MotionTable, TableError> {
        let columns = choices.iter().map(|choice| choice.parse().unwrap()).collect();
        let format = TableFormat { columns, ..TableFormat::default() };
        read_motion_table_as("p.csv", text.as_bytes(), &[LENGTH_M], &format)
    }

    /// Places of the tip at these angles, `radius_m` from the hub.
    fn places(angles: impl Iterator<Item = f64>, radius_m: f64) -> String {
        let row = |(k, angle): (usize, f64)| {
            format!(
                "{},{:.9},{:.9}\n",
                k as f64 * 0.01,
                radius_m * angle.cos(),
                radius_m * angle.sin()
            )
        };
        "t,x,y\n".to_owned() + &angles.enumerate().map(row).collect::<String>()
    }

    fn angle(k: u32) -> f64 {
        0.4 + 9.0 * 0.5 * (1.0 - (PI * f64::from(k) / 100.0).cos())
    }

    #[test]
    fn places_give_the_arc_over_more_than_a_turn() {
        for (radius_m, choices) in
            [(LENGTH_M, &[][..]), (1.01 * LENGTH_M, &["x=2", "y=3", "time=1"])]
        {
            let table = read(&places((0..=100).map(angle), radius_m), choices).unwrap();
            let arc_m = table.columns().unwrap().displacement_m.as_deref().unwrap();
            for (k, found) in (0..).zip(arc_m) {
                assert!((found - LENGTH_M * angle(k)).abs() < 1.5e-9, "sample {k}: {found}");
            }
            assert!(table.is_of_angle());
            let note = table.reading().note().unwrap();
            assert!(note.ends_with("angle as the direction of x and y"), "{note}");
        }
    }

    #[test]
    fn what_is_no_place_of_the_tip_is_refused() {
        let far = read(&places((0..=100).map(angle), 1.03 * LENGTH_M), &[]).unwrap_err();
        assert_eq!(
            far.to_string(),
            "p.csv:2: distance of x and y from the hub = 1.545 m, but must be the link's length of 1.500 m within 2.0 %"
        );
        let turns = read(&places([0.0, 0.1, 1.8, 1.9].into_iter(), LENGTH_M), &[]).unwrap_err();
        assert!(turns.to_string().starts_with("p.csv:4: turn of x and y"), "{turns}");
        let text = places((0..=100).map(angle), LENGTH_M);
        assert!(read(&text, &["x=2"]).is_err(), "y is not chosen");
    }

    #[test]
    fn an_angle_beside_a_displacement_of_another_name_is_chosen_by_the_user() {
        let text = "Temps;Déplacement (mm);Angle (°)\n0;0;0\n1;1;2\n2;2;4\n3;3;6\n";
        let error = read(text, &[]).unwrap_err().to_string();
        assert!(error.contains("must not stand beside"), "{error}");
        assert!(read(text, &["time=1", "angle=3"]).is_ok());
        assert!(read(text, &["time=1", "displacement=2"]).is_ok());
    }

    #[test]
    fn a_column_that_is_chosen_or_has_the_word_itself_is_read() {
        let text = places((0..=100).map(angle), LENGTH_M);
        let arc = read(&text, &["displacement=x"]).unwrap();
        let first_m = arc.columns().unwrap().displacement_m.as_ref().unwrap()[0];
        assert!(first_m.total_cmp(&1.381_591_491).is_eq(), "{first_m}");
        let named =
            read("time,displacement,x,y\n0,0,5,5\n1,1,5,5\n2,2,5,5\n3,3,5,5\n", &[]).unwrap();
        assert_eq!(
            named.columns().unwrap().displacement_m.as_deref(),
            Some(&[0.0, 1.0, 2.0, 3.0][..])
        );
    }
}
