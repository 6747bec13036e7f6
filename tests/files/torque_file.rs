//! Torque files: what is read.

use flexlink::csv::{TableError, read_torque_table};
use flexlink::response::Torque;

fn read(text: &str, column: Option<&str>) -> Result<Torque, TableError> {
    read_torque_table("lab.csv", text.as_bytes(), column)
}

/// Four samples of time and two columns, the second of them words.
fn headed(heading: &str) -> String {
    format!("time,{heading},state\n0,0,off\n1,1,on\n2,2,on\n3,3,off\n")
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
    assert_last(&headed("torque_m [N cm]"), Some("torque_m"), 0.03);
}
