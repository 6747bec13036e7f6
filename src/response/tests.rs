//! What makes a history of samples, and what does not.

use super::{HistoryError, HubReference, Torque};

const TIME_S: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];

fn refusal(result: Result<impl Sized, HistoryError>) -> (String, Option<usize>) {
    let error = result.err().unwrap();
    (error.to_string(), error.sample())
}

#[test]
fn a_history_keeps_its_samples_and_begins_at_its_first_time() {
    let torque = Torque::new(&TIME_S, vec![1.0, 2.0, 3.0, 2.0, 1.0]).unwrap();
    let grid = torque.grid();
    assert_eq!((grid.origin_s, grid.first, grid.len), (0.1, 0, 5));
    assert!((grid.step_s - 0.1).abs() < 1e-16);
    assert_eq!(torque.torque_n_m(), [1.0, 2.0, 3.0, 2.0, 1.0]);
    let hub = HubReference::new(&TIME_S, vec![0.5; 5], Some(vec![0.0; 5])).unwrap();
    assert_eq!(
        (hub.grid(), hub.angle_rad(), hub.rate_rad_s()),
        (grid, &[0.5; 5][..], Some(&[0.0; 5][..]))
    );
    assert_eq!(HubReference::new(&TIME_S, vec![0.5; 5], None).unwrap().rate_rad_s(), None);
}

#[test]
fn short_and_ragged_columns_are_refused() {
    let must = "but both must have equally many, at least 4";
    let short = refusal(Torque::new(&TIME_S[..3], vec![0.0; 3]));
    assert_eq!(short, (format!("torque has 3 samples and time 3, {must}"), None));
    assert!(Torque::new(&[], vec![]).is_err());
    let ragged = refusal(Torque::new(&TIME_S, vec![0.0; 4]));
    assert_eq!(ragged, (format!("torque has 4 samples and time 5, {must}"), None));
    let ragged = refusal(HubReference::new(&TIME_S, vec![0.0; 5], Some(vec![0.0; 6])));
    assert_eq!(ragged, (format!("hub_rate has 6 samples and time 5, {must}"), None));
}

#[test]
fn samples_that_are_no_numbers_are_refused_wherever_they_stand() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut samples = vec![0.0; 5];
        samples[3] = bad;
        let expected =
            |column: &str| (format!("{column} = {bad}, but must be a finite number"), Some(3));
        assert_eq!(refusal(Torque::new(&samples, vec![0.0; 5])), expected("time"));
        assert_eq!(refusal(Torque::new(&TIME_S, samples.clone())), expected("torque"));
        let rate = Some(samples.clone());
        assert_eq!(refusal(HubReference::new(&TIME_S, vec![0.0; 5], rate)), expected("hub_rate"));
        assert_eq!(refusal(HubReference::new(&TIME_S, samples, None)), expected("hub_angle"));
    }
}

#[test]
fn times_off_the_grid_are_refused_as_those_of_a_motion_are() {
    let error = Torque::new(&[0.0, 0.1, 0.2, 0.4, 0.5], vec![0.0; 5]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "time = 0.4 s, but must be 0.3 s: the samples before and after stand 0.1 s apart"
    );
    assert_eq!(error.sample(), Some(3));
    let hint = "write times with more decimals, or resample the file to a uniform step";
    assert_eq!(error.hint(), Some(hint));
    for times in [[0.0; 4], [3.0, 2.0, 1.0, 0.0], [-1e308, 0.0, 1e308, 1.1e308]] {
        assert!(Torque::new(&times, vec![0.0; 4]).is_err(), "{times:?}");
    }
}
