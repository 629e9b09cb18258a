//! Logs in which rows are missing tell the same modes.

use crate::expected::check;
use posicast_identify::log::{self, Log, Remark};
use posicast_identify::position;
use posicast_identify::sweep::{self, Sweep};
use posicast_identify::synthetic::{Sensor, known, position_log, present_test, pseudo_random, resonance_test};
use posicast_identify::{AccelerationLog, PositionLog};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use std::fmt::Write;

/// The log that is read from a text with the rows for which `keep` holds, of their number and time, and what is said of it.
fn without(log: &AccelerationLog, mut keep: impl FnMut(usize, f64) -> bool) -> (AccelerationLog, Vec<Remark>) {
    let mut text = String::from("#time,accel_x\n");
    for (n, value) in log.directions[0].1.iter().enumerate() {
        let time_s = n as f64 * log.sample_s;
        if keep(n, time_s) {
            let _ = writeln!(text, "{:.6},{:.3}", 100.0 + time_s, 1e3 * value);
        }
    }
    let reading = log::read(text.as_bytes()).unwrap();
    match reading.log {
        Log::Acceleration(log) => (log, reading.remarks),
        other => panic!("{other:?}"),
    }
}

#[test]
fn missing_rows_cost_only_their_own_information() {
    let truths = [known(28.0, 0.04, 0.5), known(60.0, 0.05, 0.5)];
    let sensor = Sensor {
        sample_s: 1.0 / 800.0,
        ..Sensor::default()
    };
    for driven in [Sweep::default(), present_test()] {
        let log = resonance_test(&truths, &driven, &sensor, 1);
        let lost = |share: f64| {
            let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
            move |_: usize, _: f64| random.random::<f64>() > share
        };
        let cases = [
            (without(&log, |n, _| n != 30_000), 1..2),
            (without(&log, |_, time_s| !(48.0..48.02).contains(&time_s)), 16..17),
            (without(&log, lost(0.01)), 900..1200),
            (without(&log, lost(0.2)), 19_000..23_000),
            // Ten rows in a hundred, in a burst.
            (without(&log, |n, _| n % 100 < 90), 10_000..11_000),
        ];
        for ((log, remarks), count) in cases {
            let [Remark::Gaps { missing, .. }] = remarks[..] else {
                panic!("{remarks:?}")
            };
            assert!(count.contains(&missing), "{missing} {count:?}");
            let found = sweep::identify(&log, &Sweep::default()).unwrap();
            assert_eq!(found.modes.len(), 2, "{count:?} {:#?}", found.modes);
            assert_eq!(found.unseen, []);
            for (truth, found) in truths.iter().zip(&found.modes) {
                assert!(
                    (found.mode.frequency_hz / truth.mode.frequency_hz - 1.0).abs() < 2e-3,
                    "{count:?} {found:?}"
                );
                assert!(
                    (found.mode.damping / truth.mode.damping - 1.0).abs() < 0.03,
                    "{count:?} {found:?}"
                );
            }
        }
    }
}

/// Gaps of 40 ms are 2 and 4 periods of the modes, so that nothing between their ends shows what is missing. Without filling them by turns, each
/// deviation is 22 to 33 times as large as that of the whole log; after one turn, 6 to 8 times.
#[test]
fn a_lost_row_costs_little_more_than_a_row() {
    const MOST: f64 = 4.0;
    let truths = [known(60.0, 0.04, 0.5), known(110.0, 0.03, 0.5)];
    let sensor = Sensor {
        sample_s: 1.0 / 800.0,
        ..Sensor::default()
    };
    for driven in [Sweep::default(), present_test()] {
        let log = resonance_test(&truths, &driven, &sensor, 1);
        let whole = sweep::identify(&log, &Sweep::default()).unwrap();
        let (log, _) = without(&log, |n, _| n % 160 < 128);
        let found = sweep::identify(&log, &Sweep::default()).unwrap();
        check(&truths, &found.modes);
        for (found, whole) in found.modes.iter().zip(&whole.modes) {
            let costs = [
                found.frequency_sd_hz / whole.frequency_sd_hz,
                found.damping_sd / whole.damping_sd,
            ];
            assert!(costs.iter().all(|cost| *cost < MOST), "{costs:?} {found:?}");
        }
    }
}

#[test]
fn a_long_gap_hides_its_frequencies_and_no_others() {
    let truths = [known(25.0, 0.03, 0.5), known(60.0, 0.05, 0.5)];
    let sensor = Sensor {
        sample_s: 1.0 / 800.0,
        ..Sensor::default()
    };
    let log = resonance_test(&truths, &Sweep::default(), &sensor, 1);
    // From 19.6 to 29.6 Hz.
    let (log, _) = without(&log, |_, time_s| !(15.0..25.0).contains(&time_s));
    let found = sweep::identify(&log, &Sweep::default()).unwrap();
    let [unseen] = found.unseen[..] else {
        panic!("{:?}", found.unseen)
    };
    assert!(
        (unseen.low_hz - 19.6).abs() < 0.6 && (unseen.high_hz - 29.6).abs() < 0.6,
        "{unseen:?}"
    );
    let [only] = found.modes[..] else {
        panic!("{:?}", found.modes)
    };
    assert!((only.mode.frequency_hz - 60.0).abs() < 0.3, "{only:?}");
}

#[test]
fn missing_rows_do_not_end_a_position_log() {
    let truths = [known(24.0, 0.04, 0.7), known(55.0, 0.03, 0.3)];
    let log = position_log(&truths, &pseudo_random(4000, 4), 1e-3, 0.002, 3).unwrap();
    for share in [0.0003, 0.01] {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(9);
        let mut text = String::from("time,command,response\n");
        for (n, (command, response)) in log.command.iter().zip(&log.response).enumerate() {
            // Where the command stays, a missing row hides nothing of it.
            let stays = n % 4 == 2;
            if !(stays && random.random::<f64>() < 4.0 * share) {
                let _ = writeln!(text, "{:.4},{command},{response}", n as f64 * 1e-3);
            }
        }
        let reading = log::read(text.as_bytes()).unwrap();
        let Log::Position(read) = reading.log else { panic!() };
        assert!(!read.missing.is_empty());
        assert_eq!(read.response.len(), 4000);
        modes_are_found(&read, &truths.map(|truth| truth.mode.frequency_hz));
    }
}

fn modes_are_found(log: &PositionLog, frequencies_hz: &[f64]) {
    let found = position::identify(log).unwrap();
    assert_eq!(found.modes.len(), frequencies_hz.len(), "{:?}", found.modes);
    for (found, frequency_hz) in found.modes.iter().zip(frequencies_hz) {
        assert!((found.mode.frequency_hz / frequency_hz - 1.0).abs() < 0.01, "{found:?}");
    }
}
