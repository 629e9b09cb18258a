//! Modes from position logs, compared with plants whose modes are known.

use posicast_identify::position::arx::{self, ArxError};
use posicast_identify::position::recursive::RecursiveArx;
use posicast_identify::position::{self, FoundInPosition, PositionError, PositionRemark};
use posicast_identify::synthetic::{KnownMode, Noise, position_log, pseudo_random, step};
use posicast_identify::{Between, FoundMode, PositionLog};
use posicast_shaper::mode::Mode;
use proptest::prelude::*;
use std::f64::consts::TAU;

fn mode(frequency_hz: f64, damping: f64) -> Mode {
    Mode { frequency_hz, damping }
}

/// Returns Gx and Gy of the XY stage (golden/xy_stage.json, `plants`).
fn stage() -> [Mode; 2] {
    [
        (823.832_507_248_894_6, 0.157_799_065_776_27),
        (586.156_975_562_007_6, 0.153_542_487_340_88),
    ]
    .map(|(omega, damping)| mode(omega / TAU, damping))
}

fn chirp(samples: usize, sample_s: f64, low_hz: f64, high_hz: f64) -> Vec<f64> {
    let rate = (high_hz - low_hz) / (samples as f64 * sample_s);
    let phase = |n: usize| {
        let t = n as f64 * sample_s;
        TAU * (low_hz * t + 0.5 * rate * t * t)
    };
    (0..samples).map(|n| phase(n).sin()).collect()
}

/// Returns a log of modes and their shares, with noise of the sensor.
fn log(modes: &[(Mode, f64)], command: &[f64], sample_s: f64, noise: f64, seed: u64) -> PositionLog {
    let modes: Vec<KnownMode> = modes.iter().map(|&(mode, share)| KnownMode { mode, share }).collect();
    position_log(&modes, command, sample_s, noise, seed).unwrap()
}

fn close(found: &FoundMode, truth: &Mode, frequency: f64, damping: f64) -> bool {
    (found.mode.frequency_hz / truth.frequency_hz - 1.0).abs() <= frequency
        && (found.mode.damping / truth.damping - 1.0).abs() <= damping
}

fn check(found: &FoundInPosition, truths: &[(Mode, f64)], frequency: f64, damping: f64) {
    assert_eq!(found.modes.len(), truths.len(), "{:#?} {truths:#?}", found.modes);
    for (found, (truth, share)) in found.modes.iter().zip(truths) {
        assert!(close(found, truth, frequency, damping), "{found:#?} {truth:#?}");
        assert!((found.participation - share).abs() < 0.05, "{found:#?} {share}");
    }
}

#[test]
fn without_noise_every_command_gives_the_mode_to_rounding() {
    for truth in stage() {
        for command in [
            pseudo_random(1023, 1),
            step(1000),
            pseudo_random(1000, 25),
            chirp(1000, 0.5e-3, 20.0, 300.0),
        ] {
            let found = position::identify(&log(&[(truth, 1.0)], &command, 0.5e-3, 0.0, 0)).unwrap();
            check(&found, &[(truth, 1.0)], 1e-10, 1e-9);
            assert_eq!(found.remarks, []);
        }
    }
}

#[test]
fn units_change_nothing() {
    let truths = [(stage()[1], 1.0)];
    for unit in [1e-300, 1e-9, 1e6, 1e300] {
        let mut log = log(&truths, &step(400), 0.5e-3, 0.001, 1);
        log.command
            .iter_mut()
            .chain(&mut log.response)
            .for_each(|value| *value *= unit);
        let found = position::identify(&log).unwrap();
        check(&found, &truths, 0.01, 0.15);
        assert!((found.noise / unit / 0.001 - 1.0).abs() < 0.5, "{unit} {}", found.noise);
    }
}

#[test]
fn with_noise_of_one_percent_the_mode_is_within_the_figures_of_the_notes() {
    for truth in stage() {
        // The samples per period increase, which makes plain least squares fail.
        for sample_s in [2e-3, 1e-3, 0.5e-3, 0.2e-3, 0.1e-3f64] {
            let samples = (0.5 / sample_s) as usize;
            let command = pseudo_random(samples, (0.5e-3 / sample_s).round().max(1.0) as usize);
            let found = position::identify(&log(&[(truth, 1.0)], &command, sample_s, 0.01, 1)).unwrap();
            check(&found, &[(truth, 1.0)], 0.002, 0.02);
            let rows = 1.0 / (truth.frequency_hz * found.row_s);
            assert!((3.5..=15.0).contains(&rows), "{rows} rows per period at {sample_s}");
        }
        // With a single step, least squares are useless.
        let found = position::identify(&log(&[(truth, 1.0)], &step(400), 0.5e-3, 0.01, 2)).unwrap();
        check(&found, &[(truth, 1.0)], 0.01, 0.15);
    }
}

#[test]
fn close_and_weak_modes_are_distinguished() {
    let machines = [
        vec![(mode(40.0, 0.03), 0.6), (mode(75.0, 0.05), 0.4)],
        vec![(mode(50.0, 0.03), 0.5), (mode(54.0, 0.03), 0.5)],
        vec![(mode(30.0, 0.02), 0.88), (mode(61.0, 0.04), 0.12)],
        vec![
            (mode(20.0, 0.05), 0.5),
            (mode(45.0, 0.03), 0.3),
            (mode(90.0, 0.02), 0.2),
        ],
    ];
    for (n, truths) in machines.iter().enumerate() {
        for command in [pseudo_random(4000, 4), step(3000)] {
            let log = log(truths, &command, 1e-3, 0.002, n as u64);
            check(&position::identify(&log).unwrap(), truths, 0.01, 0.15);
        }
    }
}

#[test]
fn a_free_decay_gives_frequency_and_damping() {
    for truth in [mode(12.0, 0.02), mode(0.4, 0.005), mode(80.0, 0.1)] {
        let sample_s = 0.02 / truth.frequency_hz;
        let mut noise = Noise::new(9);
        let ring = |n: usize| {
            let t = n as f64 * sample_s;
            3.0 + (-truth.decay() * t).exp() * (truth.omega_damped() * t + 0.4).cos() + 0.01 * noise.draw()
        };
        let log = PositionLog {
            sample_s,
            between: Between::Held,
            command: Vec::new(),
            response: (0..800).map(ring).collect(),
            missing: Vec::new(),
        };
        let found = position::identify(&log).unwrap();
        assert!(!found.is_forced);
        check(&found, &[(truth, 1.0)], 0.01, 0.15);
    }
}

/// Requires that at least nine tenths of the stated intervals hold the truth, over this many logs of each command.
fn intervals_hold_the_truth(logs: u32) {
    let truth = stage()[0];
    for command in [pseudo_random(400, 2), step(400), chirp(400, 1e-3, 20.0, 300.0)] {
        let (mut frequencies, mut dampings) = (0, 0);
        for seed in 0..logs {
            let found = position::identify(&log(&[(truth, 1.0)], &command, 1e-3, 0.01, seed.into())).unwrap();
            assert_eq!(found.modes.len(), 1, "{seed}: {:#?}", found.modes);
            frequencies += u32::from(found.modes[0].frequency_interval_hz().holds(truth.frequency_hz));
            dampings += u32::from(found.modes[0].damping_interval().holds(truth.damping));
        }
        let least = logs * 9 / 10;
        assert!(frequencies >= least && dampings >= least, "{frequencies} {dampings}");
    }
}

#[test]
fn stated_intervals_hold_the_truth() {
    intervals_hold_the_truth(30);
}

#[test]
fn long_stated_intervals_hold_the_truth_over_200_logs() {
    intervals_hold_the_truth(200);
}

#[test]
fn long_intervals_hold_the_truth_where_noise_has_a_memory() {
    // Nine tenths of the noise stay from sample to sample: it lasts ten samples, in a period of fifteen.
    const STAYS: f64 = 0.9;
    let truth = stage()[0];
    let command = pseudo_random(1000, 2);
    let clean = log(&[(truth, 1.0)], &command, 0.5e-3, 0.0, 0);
    let (mut frequencies, mut dampings) = (0, 0);
    for seed in 0..40 {
        let mut noise = Noise::new(seed);
        let mut log = clean.clone();
        let mut now = 0.0;
        for response in &mut log.response {
            now = STAYS * now + 0.01 * (1.0 - STAYS * STAYS).sqrt() * noise.draw();
            *response += now;
        }
        let found = position::identify(&log).unwrap();
        check(&found, &[(truth, 1.0)], 0.01, 0.15);
        frequencies += usize::from(found.modes[0].frequency_interval_hz().holds(truth.frequency_hz));
        dampings += usize::from(found.modes[0].damping_interval().holds(truth.damping));
    }
    assert!(frequencies >= 36 && dampings >= 36, "{frequencies} {dampings}");
}

#[test]
fn no_mode_is_invented() {
    let mut noise = Noise::new(4);
    let mut noisy = |n: usize| (0..n).map(|_| noise.draw()).collect::<Vec<f64>>();
    let command = pseudo_random(2000, 5);
    let logs = [
        // Noise alone; a rigid axis; one that follows with a lag; a command that does not move.
        (Vec::new(), noisy(2000)),
        (
            command.clone(),
            noisy(2000).iter().zip(&command).map(|(n, u)| u + 0.01 * n).collect(),
        ),
        (
            command.clone(),
            command
                .iter()
                .zip(noisy(2000))
                .scan(0.0, |state, (u, n)| {
                    *state += 0.05 * (u - *state);
                    Some(*state + 0.01 * n)
                })
                .collect(),
        ),
        (vec![1.0; 2000], noisy(2000)),
    ];
    for (command, response) in logs {
        let is_forced = command.first() != command.last();
        let log = PositionLog {
            sample_s: 1e-3,
            between: Between::Held,
            command,
            response,
            missing: Vec::new(),
        };
        let found = position::identify(&log).unwrap();
        assert_eq!(found.modes, [], "{is_forced}");
        assert_eq!(found.remarks.len(), 1);
        let expected = matches!(found.remarks[0], PositionRemark::NoRinging { .. }) == is_forced;
        assert!(expected, "{:?}", found.remarks);
    }
}

#[test]
fn a_measured_motion_drives_the_mode_along_straight_lines() {
    // The motor moves smoothly, and the scale is behind a mode, 20 times finer than the log, so that nothing is held.
    let truth = stage()[0];
    let fine_s = 1e-5;
    let motor: Vec<f64> = chirp(20_000, fine_s, 20.0, 250.0);
    let fine = log(&[(truth, 1.0)], &motor, fine_s, 0.0, 0);
    let every = |signal: &[f64]| signal.iter().step_by(20).copied().collect::<Vec<f64>>();
    let coarse = PositionLog {
        sample_s: 20.0 * fine_s,
        between: Between::Straight,
        command: every(&fine.command),
        response: every(&fine.response),
        missing: Vec::new(),
    };
    check(&position::identify(&coarse).unwrap(), &[(truth, 1.0)], 0.002, 0.02);
}

#[test]
fn golden_least_squares_match_the_models_of_the_stage() {
    // From golden/xy_stage.json, `arx_zoh`, at 0.5 ms.
    let expected = [
        [
            -1.721_222_944_760_167,
            0.878_095_430_920_561_3,
            0.080_144_879_108_171_59,
            0.076_727_607_052_222_48,
        ],
        [
            -1.832_374_278_501_373_5,
            0.913_931_185_271_228,
            0.041_391_803_666_882_11,
            0.040_165_103_102_972_61,
        ],
    ];
    for (truth, expected) in stage().into_iter().zip(expected) {
        for command in [pseudo_random(1023, 1), step(400), pseudo_random(1023, 20)] {
            let log = log(&[(truth, 1.0)], &command, 0.5e-3, 0.0, 0);
            let mut recursive = RecursiveArx::new(2, log.sample_s, 1.0);
            for (command, response) in log.command.iter().zip(&log.response) {
                recursive.take(*command, *response);
            }
            for (model, tolerance) in [
                (arx::least_squares(&log, 2).unwrap(), 1e-9),
                (arx::with_instruments(&log, 2).unwrap(), 1e-9),
                // It begins with a guess of variance 1e5, of which a trace remains.
                (recursive.model(), 1e-4),
            ] {
                for (found, expected) in model.a.iter().chain(&model.b).zip(expected) {
                    assert!((found - expected).abs() < tolerance, "{found} {expected}");
                }
            }
        }
    }
}

#[test]
fn instruments_remove_the_bias() {
    // Notes, section 9: 1 % noise of the sensor moves the damping by about 1 % (X) and 5 % (Y); instrumental
    // variables leave 0.2 %.
    for truth in stage() {
        let mut sums = [0.0; 2];
        const LOGS: u32 = 40;
        for seed in 0..LOGS {
            let log = log(&[(truth, 1.0)], &pseudo_random(4000, 1), 0.5e-3, 0.01, seed.into());
            let plain = arx::least_squares(&log, 2).unwrap().modes();
            let instruments = arx::with_instruments(&log, 2).unwrap().modes();
            sums[0] += plain[0].damping / truth.damping - 1.0;
            sums[1] += instruments[0].damping / truth.damping - 1.0;
        }
        let [plain, instruments] = sums.map(|sum| sum / f64::from(LOGS));
        assert!(plain > 0.005 && instruments.abs() < 0.002, "{plain} {instruments}");
    }
}

#[test]
fn forgetting_follows_a_mode_that_moves() {
    let (before, after) = (mode(100.0, 0.1), mode(120.0, 0.1));
    let command = pseudo_random(2000, 1);
    let logs = [before, after].map(|truth| log(&[(truth, 1.0)], &command, 1e-3, 0.0, 0));
    let mut recursive = RecursiveArx::new(2, 1e-3, 0.99);
    for (log, truth) in logs.iter().zip([before, after]) {
        for (command, response) in log.command.iter().zip(&log.response) {
            recursive.take(*command, *response);
        }
        let found = recursive.modes();
        assert!(
            (found[0].frequency_hz / truth.frequency_hz - 1.0).abs() < 1e-3,
            "{found:?}"
        );
    }
}

#[test]
fn a_mode_that_moves_during_a_log_gives_a_remark() {
    let command = pseudo_random(2000, 2);
    let [mut first, second] = [100.0, 104.0].map(|hz| log(&[(mode(hz, 0.05), 1.0)], &command, 1e-3, 0.01, hz as u64));
    let steady = position::identify(&first).unwrap();
    assert!(
        !steady.remarks.iter().any(|r| matches!(r, PositionRemark::Moves { .. })),
        "{:?}",
        steady.remarks
    );
    first.response.truncate(1000);
    first.response.extend(&second.response[1000..]);
    let found = position::identify(&first).unwrap();
    let moves = found.remarks.iter().find_map(|remark| match remark {
        PositionRemark::Moves { from_hz, to_hz } => Some((*from_hz, *to_hz)),
        _ => None,
    });
    let Some((from_hz, to_hz)) = moves else {
        panic!("{found:?}")
    };
    assert!(
        (from_hz - 100.0).abs() < 0.5 && (to_hz - 104.0).abs() < 0.5,
        "{from_hz} {to_hz}"
    );
}

#[test]
fn impossible_logs_are_refused() {
    let good = log(&[(stage()[0], 1.0)], &step(100), 1e-3, 0.0, 0);
    let short = PositionLog {
        command: Vec::new(),
        response: vec![1.0; 10],
        ..good.clone()
    };
    assert!(matches!(position::identify(&short), Err(PositionError::Short(10))));
    let mut uneven = good.clone();
    uneven.command.pop();
    assert!(matches!(position::identify(&uneven), Err(PositionError::Uneven { .. })));
    let mut infinite = good.clone();
    infinite.response[7] = f64::INFINITY;
    assert!(matches!(
        position::identify(&infinite),
        Err(PositionError::Uneven { .. })
    ));
    let timeless = PositionLog {
        sample_s: 0.0,
        ..good.clone()
    };
    assert!(matches!(position::identify(&timeless), Err(PositionError::Sample(_))));
    assert!(matches!(arx::least_squares(&short, 2), Err(ArxError::Short { .. })));
    let still = PositionLog {
        command: vec![0.0; 100],
        ..good
    };
    assert!(matches!(
        arx::least_squares(&still, 2),
        Err(ArxError::Excitation { order: 2 })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn prop_any_log_ends_without_a_panic(
        pairs in prop::collection::vec((-1e3f64..1e3, prop_oneof![Just(0.0), -1e6f64..1e6]), 24..200),
        sample_s in prop_oneof![Just(1e-9), Just(1e-3), Just(1e6)],
    ) {
        let (command, response): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let log = PositionLog { sample_s, between: Between::Held, command, response, missing: Vec::new() };
        if let Ok(found) = position::identify(&log) {
            for mode in found.modes {
                prop_assert!(mode.mode.frequency_hz > 0.0 && mode.participation.is_finite());
            }
        }
    }
}
