//! Trajectory files: what is read.

use flexlink::csv::{MotionTable, TableError, read_motion_table};

/// Reads `text` as `traj.csv`, for a link of 2 m.
fn read(text: &str) -> Result<MotionTable, TableError> {
    read_motion_table("traj.csv", text.as_bytes(), 2.0)
}

/// Four samples of time and one column that is headed `heading`.
fn headed(heading: &str) -> String {
    format!("time,{heading}\n0,0\n1,1\n2,2\n3,3\n")
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
        let columns = read(&headed(heading)).unwrap().columns().unwrap().clone();
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
    let columns = read(text).unwrap().columns().unwrap().clone();
    assert_eq!(columns.time_s, [-1.0, 0.0, 1.0, 2.0]);
    assert_eq!(columns.displacement_m, Some(vec![1.0; 4]));
    assert_eq!(columns.velocity_m_s, Some(vec![2.0; 4]));
    assert_eq!(columns.acceleration_m_s2, Some(vec![3.0; 4]));
}

#[test]
fn columns_stand_in_any_order_and_units() {
    let text = "acceleration [cm/s^2],velocity [cm/s],time [ms]\n1,2,0\n1,2,5\n1,2,10\n1,2,15\n";
    let columns = read(text).unwrap().columns().unwrap().clone();
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
    assert_eq!(decorated.columns(), plain.columns());
    assert_eq!(decorated.rows().name(), "traj.csv");
    let lines = |table: &MotionTable| [0, 1, 2, 3].map(|sample| table.line_of(sample).unwrap());
    assert_eq!(lines(&plain), [2, 3, 4, 5]);
    assert_eq!(lines(&decorated), [4, 6, 8, 9]);
}

#[test]
fn bytes_of_no_text_are_refused() {
    let error = read_motion_table("-", b"time,angle\r\n0,0\r\n1,\x81\r\n", 2.0).unwrap_err();
    assert_eq!(error.to_string(), "-:3: text = byte 0x81, but must be UTF-8");
    assert_eq!(error.hint(), Some("save the file as text in UTF-8"));
}
