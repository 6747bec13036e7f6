//! A simulation beside a recording whose delay, gain and noise are known.

use super::{link, peak, plan_of, played};
use crate::recordings::Random;
use flexlink::link::Damping;
use flexlink::response::{Play, Played, Torque};
use flexlink::result::{ChannelComparison, ChannelRecording, Comparison, NoFit, SimulatedChannel};

/// Parts of the simulation's step that a recording may be late by.
const PARTS: u32 = 10;
const STEP_S: f64 = 0.002;

/// A torque that starts and ends smoothly, on a damped link.
fn simulated(step_s: f64, until_s: f64) -> Played {
    let link = link(|parts| parts.damping = Damping::Modal { ratios: vec![0.02] });
    let count = (3.0 / step_s).round();
    let time_s: Vec<f64> =
        (0_i32..=100_000).map(f64::from).take_while(|k| *k <= count).map(|k| k * step_s).collect();
    let torque = |t: &f64| {
        let u = (t / 2.0).clamp(0.0, 1.0);
        (std::f64::consts::PI * u).sin().powi(6) * (1.0 - 2.0 * u)
    };
    let torque = Torque::new(&time_s, time_s.iter().map(torque).collect()).unwrap();
    played(&link, &plan_of(&link, 10), &Play { until_s: Some(until_s), ..Play::of(&torque) })
}

fn samples(simulation: &Played, channel: SimulatedChannel) -> Vec<f64> {
    match channel {
        SimulatedChannel::HubAngle => simulation.hub().angle_rad.clone(),
        SimulatedChannel::HubRate => simulation.hub().rate_rad_s.clone(),
        SimulatedChannel::Tip => simulation.tip[0].displacement_m.clone(),
        SimulatedChannel::Velocity => simulation.tip[0].velocity_m_s.clone(),
        SimulatedChannel::Acceleration => simulation.tip[0].acceleration_m_s2.clone(),
        SimulatedChannel::TipDeflection => simulation.tip_deflection_m(),
        SimulatedChannel::Torque => simulation.hub().torque_n_m.clone(),
        _ => panic!("a channel of arms"),
    }
}

const ALL: [SimulatedChannel; 7] = [
    SimulatedChannel::HubAngle,
    SimulatedChannel::HubRate,
    SimulatedChannel::Tip,
    SimulatedChannel::Velocity,
    SimulatedChannel::Acceleration,
    SimulatedChannel::TipDeflection,
    SimulatedChannel::Torque,
];

/// A recording every `every` parts of a step, late by so many parts, of all channels.
fn recorded(fine: &Played, every: usize, late: i32, gain: f64, offset: f64) -> ChannelRecording {
    let places: Vec<usize> = (3..fine.grid.len).step_by(every).collect();
    let channel = |channel: SimulatedChannel| {
        let own = samples(fine, channel);
        let last = i32::try_from(own.len() - 1).unwrap();
        let at = |k: &usize| {
            let place = (i32::try_from(*k).unwrap() - late).clamp(0, last);
            gain * own[usize::try_from(place).unwrap()] + offset
        };
        (channel, places.iter().map(at).collect())
    };
    ChannelRecording {
        time_s: places.iter().map(|k| fine.grid.time_s(*k)).collect(),
        channels: ALL.map(channel).into(),
    }
}

fn compared(simulation: &Played, measured: &ChannelRecording) -> Vec<ChannelComparison> {
    Comparison::of(simulation, measured).unwrap().channels
}

#[test]
fn delay_and_gain_are_found_in_every_channel() {
    let (own, fine) = (simulated(STEP_S, 4.0), simulated(STEP_S / f64::from(PARTS), 4.0));
    // Steps of the recording: shorter than, unlike and longer than the simulation's.
    for every in [7, 13, 20] {
        for (late, gain) in [(0, 1.0), (73, 1.05), (-41, 0.9), (4, -1.2), (1, 1.0)] {
            for channel in compared(&own, &recorded(&fine, every, late, gain, 0.0)) {
                let name = channel.channel.name();
                let fit = channel.fit.unwrap();
                let late_s = f64::from(late) * STEP_S / f64::from(PARTS);
                let error = (fit.delay_s - late_s).abs() / STEP_S;
                assert!(error < 1e-3, "{name}, {late} parts: off by {error:e} steps");
                let error = (fit.gain / gain - 1.0).abs();
                assert!(error < 1e-6, "{name}, gain {gain}: off by {error:e}");
                assert!(fit.left < 1e-5, "{name}: {:e} is left", fit.left);
                let scale = peak(&samples(&own, channel.channel));
                assert!(fit.offset.abs() < 1e-5 * scale, "{name}: offset {:e}", fit.offset);
            }
        }
    }
}

#[test]
fn a_sensor_with_another_zero_has_its_offset_and_the_gain_does_not_care() {
    let (own, fine) = (simulated(STEP_S, 4.0), simulated(STEP_S / f64::from(PARTS), 4.0));
    let channels = compared(&own, &recorded(&fine, 7, 20, 1.1, 0.3));
    let fit = channels[0].fit.unwrap();
    assert!((fit.offset - 0.3).abs() < 1e-6 && (fit.gain - 1.1).abs() < 1e-5, "{fit:?}");
    assert!(channels[0].share.unwrap() > 0.1, "the difference itself has it");
}

#[test]
fn noise_is_the_difference_and_what_is_left() {
    let own = simulated(STEP_S, 4.0);
    let mut measured = recorded(&own, 1, 0, 1.0, 0.0);
    let mut random = Random(7);
    for (channel, values) in &mut measured.channels {
        let deviation = 0.01 * peak(&samples(&own, *channel));
        for value in values {
            *value += deviation * random.normal();
        }
    }
    for channel in compared(&own, &measured) {
        let name = channel.channel.name();
        let deviation = 0.01 * peak(&samples(&own, channel.channel));
        let ratio = channel.rms / deviation;
        assert!((ratio - 1.0).abs() < 0.12, "{name}: {ratio}");
        let fit = channel.fit.unwrap();
        let left = fit.left * channel.recorded_deviation / deviation;
        assert!((left - 1.0).abs() < 0.12, "{name}: {left}");
        assert!(
            fit.delay_s.abs() < 0.5 * STEP_S && (fit.gain - 1.0).abs() < 0.01,
            "{name}: {fit:?}"
        );
    }
}

/// A tenth of the shared 4 s is more than a quarter of the first period, 0.13 s.
#[test]
fn a_delay_beyond_the_range_is_not_found_rather_than_wrong() {
    let (own, fine) = (simulated(STEP_S, 4.0), simulated(STEP_S / f64::from(PARTS), 4.0));
    let comparison = Comparison::of(&own, &recorded(&fine, 7, 1000, 1.0, 0.0)).unwrap();
    let longest_s = comparison.longest_delay_s;
    assert!((longest_s - 0.25 * own.first_period_s().unwrap()).abs() < 1e-12, "{longest_s}");
    let hub = &comparison.channels[0];
    assert_eq!((hub.fit, hub.no_fit), (None, Some(NoFit::LongestDelay)));
    assert!(hub.share.unwrap() > 0.1, "{hub:?}");
}

#[test]
fn times_outside_are_left_out_and_a_channel_at_rest_has_no_delay() {
    let own = simulated(STEP_S, 4.0);
    let time_s: Vec<f64> =
        (0..500).map(|k| -0.5 + 0.01 * f64::from(k) + 0.0004 * f64::from(k % 3)).collect();
    // One as a load cell at rest has it, one with an offset.
    let channels = vec![
        (SimulatedChannel::Torque, vec![0.0; 500]),
        (SimulatedChannel::HubAngle, vec![10.1; 500]),
    ];
    let recording = ChannelRecording { time_s, channels };
    let comparison = Comparison::of(&own, &recording).unwrap();
    assert_eq!((comparison.samples, comparison.left_out), (401, 99));
    for channel in &comparison.channels {
        assert_eq!((channel.share, channel.fit), (None, None));
        assert_eq!(channel.no_fit, Some(NoFit::ConstantRecording));
        assert_eq!(channel.recorded_deviation.to_bits(), 0);
        assert!(channel.rms > 0.0 && channel.simulated_deviation > 0.0);
    }
    let json = serde_json::to_string(&comparison).unwrap();
    assert_eq!(serde_json::from_str::<Comparison>(&json).unwrap(), comparison);
}

/// An absolute encoder far from 0 makes no misfit look small.
#[test]
fn shares_are_of_the_recording_about_its_mean() {
    let own = simulated(STEP_S, 4.0);
    let fitted = |offset: f64| {
        let mut recording = recorded(&own, 1, 0, 1.0, offset);
        recording.channels.truncate(1);
        let mut random = Random(7);
        for value in &mut recording.channels[0].1 {
            *value += 0.1 * (random.next() - 0.5);
        }
        compared(&own, &recording)[0]
    };
    let (near, far) = (fitted(0.0), fitted(100.0));
    let [near_left, far_left] = [near, far].map(|channel| channel.fit.unwrap().left);
    assert!((far_left / near_left - 1.0).abs() < 1e-6, "{far_left} is not {near_left}");
    assert!(far.share.unwrap() > 100.0, "the offset is a difference");
}

#[test]
fn a_recording_of_nothing_or_of_another_time_is_refused() {
    let own = simulated(STEP_S, 4.0);
    let refused = |time_s: &[f64], channels: &[(SimulatedChannel, Vec<f64>)]| {
        let recording = ChannelRecording { time_s: time_s.to_vec(), channels: channels.to_vec() };
        Comparison::of(&own, &recording).unwrap_err().to_string()
    };
    let tip = |count: usize| (SimulatedChannel::Tip, vec![0.1; count]);
    let overlap = "0 of the times lie within the simulation, 0 to 4 s, but at least 8 must";
    assert_eq!(refused(&[5.0, 6.0, 7.0, 8.0], &[tip(4)]), overlap);
    assert_eq!(refused(&[], &[tip(0)]), overlap);
    let nothing = "the recording has no channel, but must have one or more";
    assert_eq!(refused(&[0.0, 1.0], &[]), nothing);
    let uneven = "tip = 3 samples, but must be as many as there are times, 2";
    assert_eq!(refused(&[0.0, 1.0], &[tip(2), tip(3)]), uneven);
    let joint = (SimulatedChannel::JointAngle(1), vec![0.1; 9]);
    let absent = "joint2 = a channel of the recording, but the simulation has 1 joint(s)";
    let times: Vec<f64> = (0..9).map(|k| 0.1 * f64::from(k)).collect();
    assert_eq!(refused(&times, &[joint]), absent);
}
