//! Files that a simulation is held to: the hub's motion, and the tip's as a target.

use flexlink::csv::{TableError, read_hub_reference, read_motion_table};
use flexlink::response::HubReference;

fn read(text: &str) -> Result<HubReference, TableError> {
    read_hub_reference("hub.csv", text.as_bytes())
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

/// The text of a target's refusal, with its hint.
fn target_refusal(text: &str) -> (String, Option<String>) {
    let table = read_motion_table("tip.csv", text.as_bytes(), 2.0).expect(text);
    let error = table.into_target().expect_err(text);
    (error.to_string(), error.hint().map(str::to_owned))
}

#[test]
fn the_hub_file_of_solve_is_a_reference() {
    let text = "time_s,hub_angle_rad,hub_rate_rad_s,hub_acceleration_rad_s2,rigid_hub_angle_rad\n\
                -0.5,0,1,8,9\n0.0,1,2,8,9\n0.5,2,3,8,9\n1.0,3,4,8,9\n";
    let reference = read(text).unwrap();
    assert_eq!(reference.angle_rad(), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(reference.rate_rad_s(), Some(&[1.0, 2.0, 3.0, 4.0][..]));
    let grid = reference.grid();
    assert_eq!((grid.time_s(0), grid.time_s(3), grid.len), (-0.5, 1.0, 4));
}

#[test]
fn angle_and_rate_take_units_and_any_case_and_the_rate_may_be_absent() {
    let degree = std::f64::consts::PI / 180.0;
    for (heading, scale) in [
        ("hub_angle", 1.0),
        ("Hub_Angle_rad", 1.0),
        ("hub_angle [deg]", degree),
        ("hub_angle [mrad]", 1e-3),
    ] {
        let reference = read(&headed(heading)).unwrap();
        assert!((reference.angle_rad()[3] - 3.0 * scale).abs() < 1e-15, "{heading}");
        assert_eq!(reference.rate_rad_s(), None);
    }
    let text =
        "hub_rate [deg/s],note,time [ms],hub_angle\n90,a,0,0\n90,b,5,0\n90,,10,0\n90,?,15,0\n";
    let reference = read(text).unwrap();
    assert!((reference.rate_rad_s().unwrap()[3] - 90.0 * degree).abs() < 1e-15);
    assert!((reference.grid().step_s - 0.005).abs() < 1e-15);
}

#[test]
fn a_reference_without_time_or_angle_is_refused() {
    let hint = Some("hub_angle.csv of `flexlink solve` holds it");
    // A tip angle is no hub angle, and neither is a rigid link's.
    for heading in ["angle", "rigid_hub_angle_rad", "hub_rate_rad_s"] {
        let message =
            format!("hub.csv:1: columns = \"time,{heading}\", but must include hub_angle");
        assert_refused(&headed(heading), &message, hint);
    }
    let message = "hub.csv:1: columns = \"t,hub_angle\", but must include time";
    assert_refused(&headed("hub_angle").replace("time", "t"), message, None);
    let message = "hub.csv:1: first row = \"0,0\", but must name the columns";
    let hint = "begin with a row like time,hub_angle; a line that starts with # is a comment";
    assert_refused("0,0\n1,1\n", message, Some(hint));
}

#[test]
fn a_used_column_has_one_place_and_a_unit_that_measures_it() {
    let hint = Some("rename one of them");
    assert_refused(
        "time,hub_angle,hub_angle_rad\n",
        "hub.csv:1: column 3 = \"hub_angle_rad\", but must not repeat column 2, \"hub_angle\"",
        hint,
    );
    assert_refused(
        "time,hub_rate,hub_angle,hub_rate\n",
        "hub.csv:1: column 4 = \"hub_rate\", but must not repeat column 2, \"hub_rate\"",
        hint,
    );
    assert_refused(
        "time,hub_angle [m]\n",
        "hub.csv:1: unit of hub_angle = \"m\", but must be a unit such as rad or deg",
        None,
    );
    assert_refused(
        "time,hub_angle,hub_rate [deg]\n",
        "hub.csv:1: unit of hub_rate = \"deg\", but must be a unit such as rad/s or deg/s",
        None,
    );
}

#[test]
fn a_sample_of_the_reference_that_is_at_fault_is_named_with_its_line() {
    let file =
        |line: &str| format!("time,hub_angle,hub_rate,x\n0,0,0,\n1,0,0,\n{line}\n3,1,0,\n4,1,0,\n");
    for (line, message) in [
        ("2,,0,", "hub_angle = nothing, but must be a finite number"),
        ("2,0,nan,", "hub_rate = nan, but must be a finite number"),
        ("2,0,x,", "hub_rate = \"x\", but must be a number"),
        ("2,0,0", "fields = 3, but must be 4, as many as there are columns"),
        ("1,0,0,", "time = 1 s, but must be above 1 s of line 3"),
    ] {
        assert_refused(&file(line), &format!("hub.csv:4: {message}"), None);
    }
    assert_refused(
        &file("2.25,0,0,"),
        "hub.csv:4: time = 2.25 s, but must be 2 s: the samples before and after stand 1 s apart",
        Some("write times with more decimals, or resample the file to a uniform step"),
    );
    let few = "time,hub_angle\n0,0\n1,0\n2,0\n";
    assert_refused(few, "hub.csv: samples = 3, but must be 4 or more", None);
}

#[test]
fn a_target_is_a_displacement_that_need_not_come_to_rest() {
    let text = "time_s,tip_displacement_m,tip_velocity_m_s,tip_acceleration_m_s2\n\
                -1,1,2,3\n0,2,9,9\n1,3,9,9\n2,4,9,9\n";
    let target = read_motion_table("tip.csv", text.as_bytes(), 2.0).unwrap().into_target().unwrap();
    let grid = target.grid();
    assert_eq!((grid.time_s(0), grid.time_s(3), grid.len), (-1.0, 2.0, 4));
    assert_eq!(target.displacement_m(), [1.0, 2.0, 3.0, 4.0]);
    let table = read_motion_table("tip.csv", headed("angle").as_bytes(), 2.0).unwrap();
    assert_eq!(table.into_target().unwrap().displacement_m(), [0.0, 2.0, 4.0, 6.0]);
    // A tip that stands still is a target, too.
    let still = b"time,displacement\n0,5\n1,5\n2,5\n3,5\n";
    let table = read_motion_table("tip.csv", still, 2.0).unwrap();
    assert_eq!(table.into_target().unwrap().displacement_m(), [5.0; 4]);
}

#[test]
fn a_target_without_displacement_or_off_the_grid_is_refused() {
    let hint = "an acceleration leaves open where the tip is; tip.csv of `flexlink solve` holds the \
                displacement";
    let message = "tip.csv: displacement = nothing, but must be given of a target, as displacement \
                   or angle";
    let expected = (message.to_owned(), Some(hint.to_owned()));
    assert_eq!(target_refusal(&headed("acceleration")), expected);
    let text = "# a row is missing\ntime,displacement\n0,0\n0.1,0\n0.2,1\n0.4,2\n0.5,3\n";
    let message = "tip.csv:6: time = 0.4 s, but must be 0.3 s: the samples before and after stand \
                   0.1 s apart";
    let hint = "write times with more decimals, or resample the file to a uniform step";
    assert_eq!(target_refusal(text), (message.to_owned(), Some(hint.to_owned())));
}
