//! Files that a simulation is held to: the hub's motion, and the tip's as a target.

use flexlink::csv::{TableError, read_hub_reference, read_motion_table};
use flexlink::response::HubReference;

fn read(text: &str) -> Result<HubReference, TableError> {
    read_hub_reference("hub.csv", text.as_bytes())
}

/// Four samples of time and one column that is headed `heading`.
fn headed(heading: &str) -> String {
    format!("time,{heading}\n0,0\n1,1\n2,2\n3,3\n")
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
