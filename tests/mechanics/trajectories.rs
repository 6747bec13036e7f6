//! The trajectories that come with the program hold what their first line says.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use flexlink::csv::{MotionTable, read_motion_table};
use flexlink::motion::MotionColumns;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("trajectories")
}

fn read(name: &str) -> MotionTable {
    let bytes = fs::read(folder().join(name)).expect("the file is there");
    read_motion_table(name, &bytes, 1.5).expect("the file is a trajectory")
}

/// The move of one period of a sine acceleration: acceleration and displacement at a time.
fn sine(time_s: f64) -> (f64, f64) {
    let (travel_m, duration_s) = (0.5, 0.88);
    let phase = TAU * time_s / duration_s;
    let peak = TAU * travel_m / (duration_s * duration_s);
    (peak * phase.sin(), travel_m * (phase - phase.sin()) / TAU)
}

/// Largest difference of both columns from the sine.
fn distance_from_sine(columns: &MotionColumns) -> f64 {
    let mut worst: f64 = 0.0;
    for (k, &time_s) in columns.time_s.iter().enumerate() {
        let (acceleration, displacement) = sine(time_s);
        let apart = |column: &Option<Vec<f64>>, wanted: f64| {
            column.as_ref().map_or(0.0, |values| (values[k] - wanted).abs())
        };
        worst = worst.max(apart(&columns.acceleration_m_s2, acceleration));
        worst = worst.max(apart(&columns.displacement_m, displacement));
    }
    worst
}

#[test]
fn every_file_reads_and_advances_evenly() {
    let entries = fs::read_dir(folder()).unwrap().map(Result::unwrap);
    // Those of arms are paths.
    let entries: Vec<_> = entries.filter(|entry| entry.path().is_file()).collect();
    assert!(entries.len() >= 4);
    for entry in entries {
        let name = entry.file_name().into_string().unwrap();
        let columns = read(&name).columns().unwrap().clone();
        let (time, len) = (&columns.time_s, columns.time_s.len());
        let step = (time[len - 1] - time[0]) / (len - 1) as f64;
        assert!((0..len).all(|k| (time[k] - k as f64 * step).abs() < 1e-12), "{name}");
        if let Some(acceleration) = columns.acceleration_m_s2 {
            // The velocity left at the end is round-off, so no correction is due.
            assert!((step * acceleration.iter().sum::<f64>()).abs() < 1e-15, "{name}");
        }
        // A cycle ends a step before its start.
        let displacement = columns.displacement_m.filter(|_| name != "sway_1s.csv");
        if let Some(displacement) = displacement {
            assert_eq!((displacement[0], displacement[len - 1]), (0.0, 0.5), "{name}");
        }
    }
}

#[test]
fn the_sine_is_the_same_move_in_all_three_files() {
    for (name, samples) in
        [("sine_0.88s.csv", 881), ("sine_0.88s_displacement.csv", 881), ("sine_cm.csv", 441)]
    {
        let columns = read(name).columns().unwrap().clone();
        assert_eq!(columns.time_s.len(), samples, "{name}");
        assert!(distance_from_sine(&columns) < 1e-14, "{name}");
    }
}

#[test]
fn the_least_jerk_moves_half_a_metre_in_a_second() {
    let columns = read("min_jerk_1s.csv").columns().unwrap().clone();
    let acceleration = columns.acceleration_m_s2.unwrap();
    let displacement = columns.displacement_m.unwrap();
    for (k, u) in columns.time_s.iter().enumerate() {
        let place = 0.5 * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
        assert!((displacement[k] - place).abs() < 1e-14, "row {k}");
        let second = 30.0 * u * (1.0 - u) * (1.0 - 2.0 * u);
        assert!((acceleration[k] - second).abs() < 1e-13, "row {k}");
    }
}

#[test]
fn a_coarse_file_resampled_is_the_fine_one() {
    let coarse = read("sine_cm.csv").resampled(0.001).unwrap();
    assert_eq!(coarse.columns().unwrap().time_s.len(), 881);
    assert!(distance_from_sine(coarse.columns().unwrap()) < 1e-8);
}
