//! Noisy, spiked and scaled paths of arms, against the exact ones.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fmt::Write as _;

use flexlink::beam::ElementCount;
use flexlink::csv::{TableFormat, read_motion_table_as};
use flexlink::inverse::{Analysis, Solution};
use flexlink::link::Arm;
use flexlink::motion::{ArmPath, Motion, MotionScale, Uncertainty};
use flexlink::result::Remark;

use super::digits::{Way, path_of, random_arm, random_way, ratios, read};
use super::inversion::{arm, largest, solved};
use super::two_links;
use crate::recordings::{Random, septic};

/// Rows at rest before and after a noisy path.
const REST: u32 = 60;

/// A file of a way between rests; `off` is added to a column in a row.
fn file(way: &Way, decimals: usize, mut off: impl FnMut(usize, u32) -> f64) -> String {
    let mut text = format!("time,{}\n", way.names.join(","));
    for k in 0..=way.steps + 2 * REST {
        let share = (f64::from(k) - f64::from(REST)) / f64::from(way.steps);
        write!(text, "{:.12}", share * way.duration_s).unwrap();
        for (column, [from, to]) in way.ends.iter().enumerate() {
            let value = from + (to - from) * (way.shape)(share.clamp(0.0, 1.0))[0];
            write!(text, ",{:.decimals$}", value + off(column, k)).unwrap();
        }
        text.push('\n');
    }
    text
}

fn answer(arm: &Arm, path: &ArmPath) -> Solution {
    solved(arm, path, ElementCount::Auto, &Analysis::default())
}

fn line(steps: u32) -> Way {
    Way {
        names: vec!["x".to_owned(), "y".to_owned()],
        ends: vec![[0.9, 0.5], [-0.5, 0.8]],
        shape: septic,
        duration_s: 1.5,
        steps,
    }
}

#[test]
fn the_stated_input_error_holds_for_noisy_paths() {
    let mut random = Random::of(11);
    for case in 0..6 {
        let arm = random_arm(&mut random, if case % 4 == 1 { 3 } else { 2 });
        let way = Way { steps: 400, ..random_way(&mut random, &arm, case) };
        let exact = answer(&arm, &path_of(&read(&file(&way, 16, |_, _| 0.0), &arm)));
        let deviation_m = [1e-5, 1e-4][case / 2 % 2];
        let lengths_m = arm.lengths_m();
        // The noise of an angle is that of the arc of its link's tip.
        let per_m = |column: usize| if case % 2 == 0 { 1.0 } else { lengths_m[column].recip() };
        let noisy = file(&way, 16, |column, _| deviation_m * per_m(column) * random.normal());
        let table = read(&noisy, &arm).with_noise(deviation_m).unwrap();
        let path = path_of(&table);
        let Some(Uncertainty::Noisy { deviation_m: told_m, .. }) = path.recording().uncertainty
        else {
            panic!("noise")
        };
        assert!((told_m / deviation_m - 1.0).abs() < 1e-12);
        let found = answer(&arm, &path);
        let ratios = ratios(&found, &exact);
        println!("case {case}, {deviation_m:e} m: {ratios:.3?}");
        let is_bound = |[of_input, of_all]: &[f64; 2]| *of_all <= 1.0 && 60.0 * of_input >= 1.0;
        assert!(ratios.iter().all(is_bound), "case {case}: {ratios:.3?}");
        let Motion::Path(_) = &found.motion else { panic!("a path") };
        let travel_m = found.tip_travel_m();
        let remarks = Remark::on_motion(&arm, &found.motion, travel_m, 1e-6);
        assert!(remarks.iter().any(|own| matches!(own, Remark::Noise { .. })), "{remarks:?}");
    }
}

/// A coordinate that only trembles is constant, and one that moves is not.
#[test]
fn noise_alone_moves_no_coordinate() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let way = Way { ends: vec![[0.9, 0.3], [0.4, 0.4]], ..line(400) };
    let mut random = Random::of(5);
    let noisy = file(&way, 16, |_, _| 1e-4 * random.normal());
    let found = answer(&arm, &path_of(&read(&noisy, &arm).with_noise(1e-4).unwrap()));
    let exact = answer(&arm, &path_of(&read(&file(&way, 16, |_, _| 0.0), &arm)));
    let held_m = &found.tip[1].displacement_m;
    let mean_m = held_m.iter().sum::<f64>() / held_m.len() as f64;
    assert!((mean_m - 0.4).abs() < 3e-5, "{mean_m}");
    assert!(largest(held_m.iter().map(|own| own - mean_m)) < 1e-6);
    let ratios = ratios(&found, &exact);
    assert!(ratios.iter().all(|[_, of_all]| *of_all <= 1.0), "{ratios:.3?}");
}

#[test]
fn a_cut_off_of_the_user_leaves_out_what_lies_above_it() {
    let arm = arm(&two_links(), [0.0; 2]);
    let table = read(&file(&line(400), 16, |_, _| 0.0), &arm);
    let found = answer(&arm, &path_of(&table.with_lowpass(4.0)));
    assert!((found.band.cutoff_hz.unwrap() - 4.0).abs() < 1e-9);
    // The tip strays from its line by what the error says.
    let stated_m = found.tip_error * found.tip_travel_m();
    let before = usize::try_from(-found.grid.first).unwrap() + REST as usize;
    let strayed = (0..=400).map(|k| {
        let share = septic(f64::from(u32::try_from(k).unwrap()) / 400.0)[0];
        let wanted_m = [0.9 - 0.4 * share, -0.5 + 1.3 * share];
        let off = |axis: usize| found.tip[axis].displacement_m[before + k] - wanted_m[axis];
        off(0).hypot(off(1))
    });
    let strayed_m = largest(strayed);
    assert!(strayed_m < 1.01 * stated_m && 3.0 * strayed_m > stated_m, "{strayed_m} {stated_m}");
}

#[test]
fn a_path_whose_spikes_are_dropped_is_the_path_without_them() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let way = line(300);
    let clean = answer(&arm, &path_of(&read(&file(&way, 5, |_, _| 0.0), &arm)));
    let spiked = file(&way, 5, |column, k| match (column, k) {
        (0, 150) => 0.02,
        (1, 210) => -0.01,
        _ => 0.0,
    });
    let lengths_m = arm.lengths_m();
    let as_it_is = TableFormat::default();
    let error = read_motion_table_as("p.csv", spiked.as_bytes(), &lengths_m, &as_it_is);
    assert!(error.unwrap_err().to_string().starts_with("p.csv:152: x = "));
    let format = TableFormat { drop_outliers: true, ..as_it_is };
    let table = read_motion_table_as("p.csv", spiked.as_bytes(), &lengths_m, &format).unwrap();
    let path = path_of(&table);
    assert_eq!(path.recording().dropped, 2);
    let found = answer(&arm, &path);
    let ratios = ratios(&found, &clean);
    assert!(ratios.iter().all(|[_, of_all]| *of_all <= 1.0), "{ratios:.3?}");
    let remarks = Remark::on_motion(&arm, &found.motion, found.tip_travel_m(), 1e-6);
    assert!(remarks.contains(&Remark::DroppedOutliers { samples: 2 }), "{remarks:?}");
}

/// A path over half the distance in twice the time is the path of another file.
#[test]
fn a_scaled_path_is_the_path_to_a_nearer_end() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let way = line(300);
    let path = path_of(&read(&way.file(1, 16), &arm));
    let unchanged = Motion::Path(path.clone()).scaled(MotionScale::default()).unwrap();
    assert_eq!(unchanged, Motion::Path(path.clone()));
    let scaled = path.scaled(MotionScale { distance: 0.5, duration: 2.0 }).unwrap();
    let ends = way.ends.iter().map(|[from, to]| [*from, 0.5 * (from + to)]).collect();
    let nearer = Way { ends, duration_s: 2.0 * way.duration_s, ..line(300) };
    let [found, expected] =
        [scaled, path_of(&read(&nearer.file(1, 16), &arm))].map(|path| answer(&arm, &path));
    for (own, other) in found.joints.iter().zip(&expected.joints) {
        let pairs = own.torque_n_m.iter().zip(&other.torque_n_m);
        let off_n_m = largest(pairs.map(|(a, b)| a - b));
        assert!(off_n_m < 1e-8 * largest(other.torque_n_m.iter().copied()), "{off_n_m:e}");
    }
}

/// Times off a uniform grid are interpolated for a path as they are for a tip.
#[test]
fn jittered_times_of_a_path_are_made_uniform() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let way = line(300);
    let exact = answer(&arm, &path_of(&read(&way.file(1, 16), &arm)));
    let mut text = "time,x,y\n".to_owned();
    for k in 0..=300 {
        let off = if k % 3 == 1 { 0.0217 } else { 0.0 };
        let share = (f64::from(k) + off) / 300.0;
        let at = |axis: usize| {
            way.ends[axis][0] + (way.ends[axis][1] - way.ends[axis][0]) * septic(share)[0]
        };
        writeln!(text, "{:.15},{:.16},{:.16}", 1.5 * share, at(0), at(1)).unwrap();
    }
    let path = path_of(&read(&text, &arm));
    let jitter = path.recording().jitter.unwrap();
    assert!((jitter - 0.0145).abs() < 7e-3, "{jitter}");
    let found = answer(&arm, &path);
    for (own, other) in found.joints.iter().zip(&exact.joints) {
        let pairs = own.torque_n_m.iter().zip(&other.torque_n_m);
        let off_n_m = largest(pairs.map(|(a, b)| a - b));
        assert!(off_n_m < 1e-5 * largest(other.torque_n_m.iter().copied()), "{off_n_m:e}");
    }
    let remarks = Remark::on_motion(&arm, &found.motion, found.tip_travel_m(), 1e-6);
    assert!(remarks.iter().any(|own| matches!(own, Remark::Jitter { .. })), "{remarks:?}");
}

#[test]
fn ends_that_are_no_rests_and_noise_without_rests_are_refused() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let table = read(&line(300).file(1, 16), &arm);
    let error =
        table.clone().with_ends(flexlink::motion::Ends::Periodic).into_motion().unwrap_err();
    assert!(error.to_string().contains("x: a step after its last row the cycle is"), "{error}");
    let error = table.with_noise(1e-7).unwrap_err();
    assert!(error.to_string().contains("x: the recording rests for"), "{error}");
}

/// Places of the tip with the direction of the first link, which agree within the noise or contradict.
#[test]
fn directions_beside_the_places_agree_within_the_noise_alone() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let [l1, l2] = [0, 1].map(|link| arm.lengths_m()[link]);
    let text = |mut noise: Box<dyn FnMut() -> f64>, off_rad: f64| {
        let mut text = "time,x,y,angle1\n".to_owned();
        for k in 0..=420_u32 {
            let share = septic(((f64::from(k) - 60.0) / 300.0).clamp(0.0, 1.0))[0];
            let [a, b] = [-0.6 + 0.7 * share, 0.8 + 0.3 * share];
            let (x, y) = (l1 * a.cos() + l2 * b.cos(), l1 * a.sin() + l2 * b.sin());
            let [x, y, a] = [x + noise(), y + noise(), a + off_rad + noise() / l1];
            writeln!(text, "{:.6},{x:.16},{y:.16},{a:.16}", 0.005 * f64::from(k)).unwrap();
        }
        text
    };
    let mut random = Random::of(23);
    let noisy = text(Box::new(move || 1e-3 * random.normal()), 0.0);
    let refused = |path: &ArmPath| {
        let plans = super::inversion::plans(&arm, ElementCount::Auto);
        let motion = Motion::Path(path.clone());
        let resources = flexlink::inverse::Resources::default();
        let solved = flexlink::inverse::invert_motion(
            &arm,
            &plans,
            &motion,
            &Analysis::default(),
            &resources,
        );
        matches!(solved, Err(flexlink::inverse::InversionError::Disagree { .. }))
    };
    assert!(!refused(&path_of(&read(&noisy, &arm).with_noise(1e-3).unwrap())));
    let contradicting = path_of(&read(&text(Box::new(|| 0.0), 0.3), &arm));
    let shorter = MotionScale { distance: 0.9, ..MotionScale::default() };
    assert!(refused(&contradicting) && refused(&contradicting.scaled(shorter).unwrap()));
    let agreeing = path_of(&read(&text(Box::new(|| 0.0), 0.0), &arm));
    assert!(!refused(&agreeing) && !refused(&agreeing.scaled(shorter).unwrap()));
}
