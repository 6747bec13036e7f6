//! Trajectory files: what is read, and the full text of every refusal.

use flexlink::csv::{MotionTable, TableError, read_motion_table};

/// Reads `text` as `traj.csv`, for a link of 2 m.
fn read(text: &str) -> Result<MotionTable, TableError> {
    read_motion_table("traj.csv", text.as_bytes(), 2.0)
}

fn assert_refused(text: &str, message: &str, hint: Option<&str>) {
    let error = read(text).expect_err(message);
    assert_eq!(error.to_string(), message);
    assert_eq!(error.hint(), hint, "{message}");
}

/// Four samples of time and one column that is headed `heading`.
fn headed(heading: &str) -> String {
    format!("time,{heading}\n0,0\n1,1\n2,2\n3,3\n")
}

/// A good file but for its fourth line.
fn with_fourth_line(line: &str) -> String {
    format!("time,displacement\n0,0\n1,0\n{line}\n3,1\n4,1\n")
}

#[test]
fn names_take_a_prefix_a_suffix_a_unit_and_any_case() {
    for (heading, displacement_m) in [
        ("displacement", 3.0),
        (" Displacement ", 3.0),
        ("TIP_displacement", 3.0),
        ("tip_displacement_m", 3.0),
        ("displacement_m", 3.0),
        ("displacement [cm]", 0.03),
        ("tip_displacement[mm]", 0.003),
        ("\"displacement [m]\"", 3.0),
        ("angle", 6.0),
        ("angle_rad", 6.0),
        ("Angle [deg]", 6.0 * std::f64::consts::PI / 180.0),
    ] {
        let columns = read(&headed(heading)).unwrap().columns;
        let found = columns.displacement_m.unwrap()[3];
        assert!((found - displacement_m).abs() < 1e-15, "{heading}: {found}");
        assert_eq!(columns.time_s, [0.0, 1.0, 2.0, 3.0]);
        assert_eq!((columns.velocity_m_s, columns.acceleration_m_s2), (None, None));
    }
}

#[test]
fn this_programs_own_tip_file_is_a_trajectory() {
    let text = "time_s,tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2\n\
                -1,1,2,3\n0,1,2,3\n1,1,2,3\n2,1,2,3\n";
    let columns = read(text).unwrap().columns;
    assert_eq!(columns.time_s, [-1.0, 0.0, 1.0, 2.0]);
    assert_eq!(columns.displacement_m, Some(vec![1.0; 4]));
    assert_eq!(columns.velocity_m_s, Some(vec![2.0; 4]));
    assert_eq!(columns.acceleration_m_s2, Some(vec![3.0; 4]));
}

#[test]
fn columns_stand_in_any_order_and_units() {
    let text = "acceleration [cm/s^2],velocity [cm/s],time [ms]\n1,2,0\n1,2,5\n1,2,10\n1,2,15\n";
    let columns = read(text).unwrap().columns;
    assert_eq!(columns.time_s, [0.0, 0.005, 0.01, 0.015]);
    assert_eq!(columns.velocity_m_s, Some(vec![0.02; 4]));
    assert_eq!(columns.acceleration_m_s2, Some(vec![0.01; 4]));
    assert_eq!(columns.displacement_m, None);
}

#[test]
fn comments_blank_lines_quotes_and_line_ends_do_not_matter() {
    let plain = read(&headed("displacement")).unwrap();
    let decorated = "\u{feff}# made by hand\r\n\r\n time , \"displacement\" \r\n 0 ,0\r\n# half\r\n\
                     \"1\",1.0e0\r\n  \r\n+2, \"2\"\r\n3.,3";
    let decorated = read(decorated).unwrap();
    assert_eq!(decorated.columns, plain.columns);
    assert_eq!(decorated.name(), "traj.csv");
    let lines = |table: &MotionTable| [0, 1, 2, 3].map(|sample| table.line_of(sample));
    assert_eq!(lines(&plain), [2, 3, 4, 5]);
    assert_eq!(lines(&decorated), [4, 6, 8, 9]);
}

#[test]
fn unknown_columns_are_refused_with_the_nearest_name() {
    let must = "but must be one of time, acceleration, velocity, displacement, angle";
    for (heading, hint) in [
        ("displacment", Some("did you mean displacement?")),
        ("acc", Some("did you mean acceleration?")),
        ("Velocities", Some("did you mean velocity?")),
        ("displacement (cm)", Some("a unit follows in brackets: displacement [cm]")),
        ("tip_displacement_cm", Some("a unit follows in brackets: displacement [cm]")),
        ("hub_angle_rad", Some("a trajectory holds the tip's motion; the hub's follows from it")),
        ("torque", None),
    ] {
        let message = format!("traj.csv:1: column 2 = \"{heading}\", {must}");
        assert_refused(&headed(heading), &message, hint);
    }
    let message = format!("traj.csv:2: column 3 = \"\", {must}");
    let hint = "a comma at the end of the row begins a column of its own";
    assert_refused("#\ntime,angle,\n0,1,\n", &message, Some(hint));
}

#[test]
fn one_quantity_has_one_column() {
    assert_refused(
        "time,displacement,tip_displacement_m\n",
        "traj.csv:1: column 3 = \"tip_displacement_m\", but must not repeat column 2, \
         \"displacement\"",
        None,
    );
    assert_refused(
        "angle [deg],time,displacement\n",
        "traj.csv:1: column 3 = \"displacement\", but must not stand beside column 1, \"angle\": \
         they are two names of one thing",
        Some("displacement = angle * link length; keep one of them"),
    );
}

#[test]
fn time_and_something_that_moves_are_required() {
    assert_refused(
        "acceleration,velocity\n0,0\n",
        "traj.csv:1: columns = \"acceleration,velocity\", but must include time",
        None,
    );
    assert_refused(
        "time,velocity\n0,0\n",
        "traj.csv:1: columns = \"time,velocity\", but must include acceleration, displacement or \
         angle",
        None,
    );
}

#[test]
fn a_unit_must_be_known_and_measure_the_column() {
    let refused = |heading: &str, found: &str, units: &str, hint| {
        let name = heading.split(' ').next().unwrap();
        let must = format!("but must be a unit such as {units}");
        let message = format!("traj.csv:1: unit of {name} = \"{found}\", {must}");
        assert_refused(&headed(heading), &message, hint);
    };
    refused("displacement [furlong]", "furlong", "m or cm", None);
    refused("Displacement [cn]", "cn", "m or cm", Some("did you mean `cm`?"));
    refused("displacement [s]", "s", "m or cm", None);
    refused("displacement []", "", "m or cm", None);
    refused("angle [m]", "m", "rad or deg", None);
    refused("acceleration [cm/s]", "cm/s", "m/s^2 or cm/s^2", None);
    assert_refused(
        "time [m],velocity [m/s]\n",
        "traj.csv:1: unit of time = \"m\", but must be a unit such as s or ms",
        None,
    );
    assert_refused(
        "time,angle,velocity [m]\n",
        "traj.csv:1: unit of velocity = \"m\", but must be a unit such as m/s or cm/s",
        None,
    );
    assert_refused(
        &headed("displacement_m [cm]"),
        "traj.csv:1: unit of displacement_m = \"cm\", but must not stand beside the unit that \
         displacement_m names itself",
        None,
    );
}

#[test]
fn columns_are_named_and_separated_by_commas() {
    let hint = Some("separate the columns with commas");
    let must = "but must name columns that are separated by commas";
    assert_refused(
        "time;displacement\n0;0,5\n",
        &format!("traj.csv:1: first row = \"time;displacement\", {must}"),
        hint,
    );
    assert_refused(
        "time\tdisplacement\n0\t0.5\n",
        &format!("traj.csv:1: first row = \"time\\tdisplacement\", {must}"),
        hint,
    );
    assert_refused(
        "# time,displacement\n0,0.5\n1,0.6\n",
        "traj.csv:2: first row = \"0,0.5\", but must name the columns",
        Some("begin with a row like time,acceleration; a line that starts with # is a comment"),
    );
}

#[test]
fn every_field_is_a_finite_number() {
    let refused = |field: &str, told: &str, hint| {
        let message = format!("traj.csv:4: displacement = {told}");
        assert_refused(&with_fourth_line(&format!("2,{field}")), &message, hint);
    };
    refused("", "nothing, but must be a finite number", None);
    refused("  ", "nothing, but must be a finite number", None);
    refused("nan", "nan, but must be a finite number", None);
    refused("-inf", "-inf, but must be a finite number", None);
    refused("1e999", "1e999, but must be a finite number", None);
    refused("0.5 m", "\"0.5 m\", but must be a number", None);
    let hint = Some("decimals follow a point, and nothing divides thousands");
    refused("\"0,5\"", "\"0,5\", but must be a number", hint);
    let message = "traj.csv:4: time = NaN, but must be a finite number";
    assert_refused(&with_fourth_line("NaN,0"), message, None);
    let huge = format!("\"0.5\n{}\n\"", "3,1\n".repeat(40));
    let start = "0.5\\n3,1".to_owned() + &"\\n3,1".repeat(13);
    let message = format!("\"{start}\\n…\", but must be a number");
    refused(&huge, &message, None);
}

#[test]
fn rows_have_as_many_fields_as_the_header() {
    assert_refused(
        &with_fourth_line("2,0.5,"),
        "traj.csv:4: fields = 3, but must be 2, as many as there are columns",
        None,
    );
    assert_refused(
        &with_fourth_line("2"),
        "traj.csv:4: fields = 1, but must be 2, as many as there are columns",
        None,
    );
}

#[test]
fn time_advances_from_row_to_row() {
    assert_refused(
        &with_fourth_line("1,0.5"),
        "traj.csv:4: time = 1 s, but must be above 1 s of line 3",
        None,
    );
    assert_refused(
        "Tip_Time [ms],angle\n0,0\n10,0\n# a jump back\n9.5,0\n",
        "traj.csv:5: Tip_Time = 9.5 ms, but must be above 10 ms of line 3",
        None,
    );
}

#[test]
fn a_motion_has_four_samples_or_more() {
    assert_refused(
        "time,angle\n0,0\n1,0\n2,0\n",
        "traj.csv: samples = 3, but must be 4 or more",
        None,
    );
    assert_refused("time,angle\n", "traj.csv: samples = 0, but must be 4 or more", None);
    for empty in ["", "\u{feff}", "\n\r\n  \n", "# only a comment"] {
        let must = "but must hold a row of names and 4 samples or more";
        assert_refused(empty, &format!("traj.csv: content = nothing, {must}"), None);
    }
}

#[test]
fn text_is_utf_8() {
    let error = read_motion_table("-", b"time,angle\r\n0,0\r\n1,\xff\r\n", 2.0).unwrap_err();
    assert_eq!(error.to_string(), "-:3: text = byte 0xff, but must be UTF-8");
    assert_eq!(error.hint(), Some("save the file as text in UTF-8"));
}
