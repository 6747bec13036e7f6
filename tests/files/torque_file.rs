//! Torque files: what is read, and the full text of every refusal.

use flexlink::csv::{TableError, read_torque_table};
use flexlink::response::Torque;

fn read(text: &str, column: Option<&str>) -> Result<Torque, TableError> {
    read_torque_table("lab.csv", text.as_bytes(), column)
}

fn assert_refused(text: &str, column: Option<&str>, message: &str, hint: Option<&str>) {
    let error = read(text, column).expect_err(message);
    assert_eq!(error.to_string(), message);
    assert_eq!(error.hint(), hint, "{message}");
}

/// Four samples of time and two columns, the second of them words.
fn headed(heading: &str) -> String {
    format!("time,{heading},state\n0,0,off\n1,1,on\n2,2,on\n3,3,off\n")
}

/// A good file but for its fourth line.
fn with_fourth_line(line: &str) -> String {
    format!("time,torque,state\n0,0,\n1,0,\n{line}\n3,1,\n4,1,\n")
}

/// Asserts the last of four torques in N m.
fn assert_last(text: &str, column: Option<&str>, torque_n_m: f64) {
    let torque = read(text, column).expect(text);
    let found = torque.torque_n_m()[3];
    assert!((found - torque_n_m).abs() < 1e-15, "{column:?} of {text}: {found}");
}

#[test]
fn the_torque_takes_a_prefix_a_suffix_a_unit_and_any_case() {
    for (heading, torque_n_m) in [
        ("torque", 3.0),
        (" Torque ", 3.0),
        ("torque_n_m", 3.0),
        ("HUB_torque", 3.0),
        ("hub_torque_n_m", 3.0),
        ("torque [N cm]", 0.03),
        ("hub_torque[mN m]", 0.003),
        ("\"torque [N m]\"", 3.0),
        ("torque [lbf ft]", 3.0 * 1.355_817_948_331_400_4),
    ] {
        assert_last(&headed(heading), None, torque_n_m);
        let grid = read(&headed(heading), None).unwrap().grid();
        assert_eq!((grid.time_s(0), grid.step_s, grid.first, grid.len), (0.0, 1.0, 0, 4));
    }
}

#[test]
fn the_torque_files_of_solve_are_read() {
    let torque = "time_s,torque_n_m\n-0.002,0.00\n0.000,1.50\n0.002,1.50\n0.004,0.00\n";
    let read_back = read(torque, None).unwrap();
    assert_eq!(read_back.torque_n_m(), [0.0, 1.5, 1.5, 0.0]);
    let grid = read_back.grid();
    assert!((grid.origin_s + 0.002).abs() + (grid.step_s - 0.002).abs() < 1e-15, "{grid:?}");
    let rigid = torque.replace("torque_n_m", "rigid_torque_n_m");
    assert_eq!(read(&rigid, Some("rigid_torque_n_m")), Ok(read_back));
    assert_refused(
        &rigid,
        None,
        "lab.csv:1: columns = \"time_s,rigid_torque_n_m\", but must include torque",
        Some("choose the torque with --column \"rigid_torque_n_m\""),
    );
}

#[test]
fn comments_blank_lines_quotes_and_line_ends_do_not_matter() {
    let plain = read(&headed("torque"), None).unwrap();
    let decorated = "\u{feff}# recorded\r\n\r\n time , \"torque\" ,state\r\n 0 ,0,\"a, b\"\r\n# half\
                     \r\n\"1\",1.0e0,\r\n  \r\n+2, \"2\",nan\r\n3.,3,?";
    assert_eq!(read(decorated, None), Ok(plain));
}

#[test]
fn columns_stand_in_any_order_and_those_not_used_hold_anything() {
    let text = "note,torque [N cm],,time [ms],current,current,torque_limit\n\
                a,100,,0,nan,,x\nb,200,,5,,,x\nc,300,,10,inf,-,x\nd,400,,15,1,1,x\n";
    let torque = read(text, None).unwrap();
    assert_eq!(torque.torque_n_m(), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!((torque.grid().time_s(0), torque.grid().step_s), (0.0, 0.005));
}

#[test]
fn a_column_is_chosen_as_written_or_without_its_unit() {
    let text = "time,torque,motor [N cm],M2,m2,joint_1\n\
                0,1,2,3,4,5\n1,1,2,3,4,5\n2,1,2,3,4,5\n3,1,2,3,4,5\n";
    for (column, torque_n_m) in [
        ("torque", 1.0),
        ("motor", 0.02),
        ("motor [N cm]", 0.02),
        ("M2", 3.0),
        ("m2", 4.0),
        ("joint_1", 5.0),
    ] {
        assert_last(text, Some(column), torque_n_m);
    }
    let twice = "time,torque [N m],torque [N cm]\n0,0,0\n1,1,1\n2,2,2\n3,3,3\n";
    assert_last(twice, Some("torque [N cm]"), 0.03);
    assert_refused(
        twice,
        Some("torque"),
        "lab.csv:1: column 3 = \"torque [N cm]\", but must not repeat column 2, \"torque [N m]\"",
        Some("choose one with its unit: --column \"torque [N m]\""),
    );
}

#[test]
fn an_unknown_column_is_refused_with_the_nearest_name() {
    let text = headed("Motor torque [N cm]");
    let must = "but must be one of the columns \"time,Motor torque,state\"";
    for (column, hint) in [
        ("motor torque", Some("did you mean \"Motor torque\"?")),
        ("Motor_torqe", Some("did you mean \"Motor torque\"?")),
        ("Motor torque [N m]", Some("did you mean \"Motor torque\"?")),
        ("voltage", None),
    ] {
        let message = format!("lab.csv:1: --column = \"{column}\", {must}");
        assert_refused(&text, Some(column), &message, hint);
    }
    let message = "lab.csv:1: --column = nothing, but must name a column";
    assert_refused(&headed(""), Some(""), message, None);
    let message = "lab.csv:1: --column = \"time\", but must be a torque, not the time";
    assert_refused(&text, Some("time"), message, None);
}

#[test]
fn a_file_without_a_column_of_torque_says_which_to_choose() {
    for (heading, hint) in [
        ("Motor Torque 2 [N cm]", "choose the torque with --column \"Motor Torque 2\""),
        ("current", "choose the torque with --column NAME"),
        ("torque_n_cm", "a unit follows in brackets: torque [N cm]"),
        ("Torque (Nm)", "a unit follows in brackets: torque [N cm]"),
    ] {
        let name = heading.split(" [").next().unwrap();
        let message =
            format!("lab.csv:1: columns = \"time,{name},state\", but must include torque");
        assert_refused(&headed(heading), None, &message, Some(hint));
    }
    let message = "lab.csv:1: columns = \"t,torque,state\", but must include time";
    assert_refused(&headed("torque [N m]").replace("time", "t"), None, message, None);
    assert_refused(&headed("torque").replace("time", "t"), Some("torque"), message, None);
}

#[test]
fn a_used_column_has_one_place() {
    let hint = Some("rename one of them; among torques --column chooses");
    for (header, message) in [
        (
            "time,torque,hub_torque",
            "column 3 = \"hub_torque\", but must not repeat column 2, \"torque\"",
        ),
        ("torque,time,Torque", "column 3 = \"Torque\", but must not repeat column 1, \"torque\""),
        ("time,time_s,torque", "column 2 = \"time_s\", but must not repeat column 1, \"time\""),
    ] {
        assert_refused(&format!("{header}\n"), None, &format!("lab.csv:1: {message}"), hint);
    }
    assert_refused(
        "time,M,x,M\n",
        Some("M"),
        "lab.csv:1: column 4 = \"M\", but must not repeat column 2, \"M\"",
        Some("rename one of them"),
    );
    assert!(read(&headed("torque"), Some("torque")).is_ok());
}

#[test]
fn a_unit_must_be_known_and_measure_a_torque() {
    let refused = |heading: &str, column, found: &str, units: &str, hint| {
        let name = heading.split(" [").next().unwrap();
        let must = format!("but must be a unit such as {units}");
        let message = format!("lab.csv:1: unit of {name} = \"{found}\", {must}");
        assert_refused(&headed(heading), column, &message, hint);
    };
    refused("torque [A]", None, "A", "N m or N cm", None);
    let hint = Some("a blank separates units: `N m`");
    refused("torque [Nm]", None, "Nm", "N m or N cm", hint);
    refused("motor [N]", Some("motor"), "N", "N m or N cm", None);
    refused("hub_angle [rad]", Some("hub_angle"), "rad", "N m or N cm", None);
    refused("torque []", None, "", "N m or N cm", None);
    assert_refused(
        "time [m],torque\n",
        None,
        "lab.csv:1: unit of time = \"m\", but must be a unit such as s or ms",
        None,
    );
    for (heading, column) in [("torque_n_m [N cm]", None), ("M_n_m [N cm]", Some("M_n_m"))] {
        let name = heading.split(" [").next().unwrap();
        let message = format!(
            "lab.csv:1: unit of {name} = \"N cm\", but must not stand beside the unit that {name} \
             names itself"
        );
        assert_refused(&headed(heading), column, &message, None);
    }
}

#[test]
fn a_name_that_ends_like_another_unit_is_not_taken_for_si() {
    let hint = Some("a unit follows in brackets: torque [N cm]");
    for (column, unit) in [
        ("torque_n_cm", "cm"),
        ("torque_Nm", "Nm"),
        ("Motor torque (ozin)", "ozin"),
        ("hub_angle_rad", "rad"),
        ("hub_acceleration_rad_s2", "s2"),
        ("torque_kn_m", "m"),
    ] {
        let must = format!("but must tell its unit in brackets: \"{unit}\" reads like one");
        let message = format!("lab.csv:1: column 2 = \"{column}\", {must}");
        assert_refused(&headed(column), Some(column), &message, hint);
    }
    assert_last(&headed("torque_m [N cm]"), Some("torque_m"), 0.03);
}

#[test]
fn columns_are_named_and_separated_by_commas() {
    let must = "but must name columns that are separated by commas";
    assert_refused(
        "time;torque\n0;0,5\n",
        None,
        &format!("lab.csv:1: first row = \"time;torque\", {must}"),
        Some("separate the columns with commas"),
    );
    assert_refused(
        "# time,torque\n0,0.5\n1,0.6\n",
        Some("torque"),
        "lab.csv:2: first row = \"0,0.5\", but must name the columns",
        Some("begin with a row like time,torque; a line that starts with # is a comment"),
    );
}

#[test]
fn every_field_of_a_used_column_is_a_finite_number() {
    for (field, told, hint) in [
        ("", "nothing, but must be a finite number", None),
        ("nan", "nan, but must be a finite number", None),
        ("-inf", "-inf, but must be a finite number", None),
        ("1e999", "1e999, but must be a finite number", None),
        ("0.5 Nm", "\"0.5 Nm\", but must be a number", None),
        (
            "\"0,5\"",
            "\"0,5\", but must be a number",
            Some("decimals follow a point, and nothing divides thousands"),
        ),
    ] {
        let message = format!("lab.csv:4: torque = {told}");
        assert_refused(&with_fourth_line(&format!("2,{field},")), None, &message, hint);
    }
    let message = "lab.csv:4: time = NaN, but must be a finite number";
    assert_refused(&with_fourth_line("NaN,0,"), None, message, None);
}

#[test]
fn rows_have_as_many_fields_as_the_header() {
    for (line, fields) in [("2,0.5", 2), ("2,0.5,on,", 4)] {
        let must = "but must be 3, as many as there are columns";
        let message = format!("lab.csv:4: fields = {fields}, {must}");
        assert_refused(&with_fourth_line(line), None, &message, None);
    }
}

#[test]
fn time_advances_in_even_steps() {
    let message = "lab.csv:4: time = 1 s, but must be above 1 s of line 3";
    assert_refused(&with_fourth_line("1,0.5,"), None, message, None);
    assert_refused(
        "# a row is missing\ntime [ms],torque\n0,0\n100,0\n200,0.1\n400,0.2\n500,0.2\n",
        None,
        "lab.csv:6: time = 0.4 s, but must be 0.3 s: the samples before and after stand 0.1 s apart",
        Some("write times with more decimals, or resample the file to a uniform step"),
    );
}

#[test]
fn a_torque_has_four_samples_or_more() {
    let message = "lab.csv: samples = 3, but must be 4 or more";
    assert_refused("time,torque\n0,0\n1,0\n2,0\n", None, message, None);
    let message = "lab.csv: content = nothing, but must hold a row of names and 4 samples or more";
    assert_refused("# only a comment", None, message, None);
}
