use super::finite;
use super::wording::check_words;
use flexlink::csv::{Digits, MotionTable, read_motion_table, write_trajectory};
use flexlink::motion::{Cutoff, MotionColumns, TipMotion};
use flexlink::response::Torque;

const FILE: &str = "motion.csv";

/// Samples of a period that is worth the time.
const MOST_SAMPLES: usize = 4096;

/// Laws: a trajectory is refused with words, or is a motion from rest to rest; so it is resampled.
///
/// # Panics
/// If one is broken.
pub fn motion_csv(bytes: &[u8]) {
    let table = match read_motion_table(FILE, bytes, 1.5) {
        Err(error) => return check_words(FILE, &error, error.hint()),
        Ok(table) => table,
    };
    let columns = table.columns().expect("a tip");
    check_columns(columns);
    check_written(columns);
    let times_s = &columns.time_s;
    let (first, last) = (times_s[0], *times_s.last().expect("times"));
    // Steps that divide the duration, and one that mostly does not.
    for step_s in [(last - first) / 7.0, (last - first) / 100.0, 0.01] {
        if (last - first) / step_s < MOST_SAMPLES as f64 {
            match table.clone().resampled(step_s) {
                Err(error) => check_words(FILE, &error, error.hint()),
                Ok(table) => check_motion(table),
            }
        }
    }
    check_motion(table);
}

fn check_columns(columns: &MotionColumns) {
    let MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m } = columns;
    assert!(time_s.len() >= 4 && finite(time_s) && time_s.is_sorted_by(|a, b| a < b));
    for samples in [acceleration_m_s2, velocity_m_s, displacement_m].into_iter().flatten() {
        assert!(samples.len() == time_s.len() && finite(samples));
    }
}

// Law: what is written with all digits is read to the same bits, and times to 1e-12 s and far less than
// a step.
fn check_written(columns: &MotionColumns) {
    let still = vec![0.0; columns.time_s.len()];
    let Ok(torque) = Torque::new(&columns.time_s, still) else { return };
    let mut written = Vec::new();
    write_trajectory(&mut written, columns, Digits::Full).expect("a vector");
    let again = read_motion_table("again.csv", &written, 1.5).expect("what was written");
    let again = again.columns().expect("a tip");
    let allowed_s = 1e-12_f64.min(1e-3 * torque.grid().step_s);
    let times = again.time_s.iter().zip(&columns.time_s);
    assert!(times.into_iter().all(|(a, b)| (a - b).abs() <= allowed_s));
    assert_eq!(*again, MotionColumns { time_s: again.time_s.clone(), ..columns.clone() });
}

fn check_motion(table: MotionTable) {
    match table.into_motion() {
        Err(error) => check_words(FILE, &error, error.hint()),
        Ok(motion) => check_rest(&motion.into_tip().expect("a tip")),
    }
}

fn check_rest(motion: &TipMotion) {
    let grid = motion.grid();
    let (first, last) = motion.moving_samples();
    assert!(grid.step_s > 0.0 && first < last && last < grid.len, "{grid:?}, {first} to {last}");
    assert!(motion.travel_m().is_finite() && motion.initial_displacement_m().is_finite());
    if 4 * grid.len > MOST_SAMPLES {
        return;
    }
    // The middle of the rest between two repetitions.
    let (len, seam) = (4 * grid.len, grid.len + 3 * grid.len / 2);
    let histories = motion.histories_over(len, seam, Cutoff::ALL).expect("a seam in the padding");
    let speeds = &histories.velocity_m_s;
    let accelerations = &histories.acceleration_m_s2;
    for samples in [&histories.displacement_m, speeds, accelerations] {
        assert!(samples.len() == len && finite(samples), "a history that is not finite");
    }
    check_stillness(speeds[seam], accelerations, grid.step_s);
}

// Each sample a is a sinc of its own, whose integral comes to rest as a Δt/(π² k) after k steps; on a
// period the sum of all its images is no more than twice that. Of displacements, the differences are
// larger by up to (π/2)² near the Nyquist frequency, where these waves are. An end velocity of 1e-9 of
// the peak velocity is left in, and below the normal numbers everything is rounded.
fn check_stillness(speed: f64, accelerations: &[f64], step_s: f64) {
    let all: f64 = accelerations.iter().map(|a| a.abs()).sum();
    let away = accelerations.len() as f64 / 4.0;
    let round_off = f64::EPSILON * accelerations.len() as f64;
    let allowed = all * step_s * (5.0 / (9.8 * away) + round_off + 1e-9) + f64::MIN_POSITIVE;
    assert!(speed.abs() <= allowed, "{speed:e} m/s at rest, of at most {allowed:e}");
}
