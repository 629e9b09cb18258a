//! Remarks and errors for position logs that determine little or nothing.

use posicast_identify::position::{self, FoundInPosition, PositionError, PositionRemark};
use posicast_identify::synthetic::Noise;
use posicast_identify::{Between, PositionLog};
use posicast_machine::plant::{Plant, SampledPlant};
use posicast_shaper::mode::Mode;

const MODE: Mode = Mode {
    frequency_hz: 20.0,
    damping: 0.03,
};

fn log(command: Vec<f64>, response: Vec<f64>) -> PositionLog {
    PositionLog {
        sample_s: 1e-3,
        between: Between::Held,
        command,
        response,
        missing: Vec::new(),
    }
}

fn noisy(clean: impl Iterator<Item = f64>, noise: f64, seed: u64) -> Vec<f64> {
    let mut source = Noise::new(seed);
    clean.map(|y| y + noise * source.draw()).collect()
}

/// Returns bits of a maximum-length sequence of ±1, `x^10 + x^7 + 1`, each held for 5 samples.
fn pseudo_random(samples: usize) -> Vec<f64> {
    let mut register = 1u32;
    let mut bits = Vec::new();
    while bits.len() < samples {
        let bit = (register >> 9 ^ register >> 6) & 1;
        register = (register << 1 | bit) & 0x3ff;
        bits.extend(std::iter::repeat_n(if bit == 1 { 1.0 } else { -1.0 }, 5));
    }
    bits.truncate(samples);
    bits
}

fn ring(n: usize) -> f64 {
    ring_at(n as f64 * 1e-3)
}

fn ring_at(t: f64) -> f64 {
    (-MODE.decay() * t).exp() * (MODE.omega_damped() * t).cos()
}

fn identify(log: &PositionLog) -> FoundInPosition {
    position::identify(log).unwrap()
}

#[test]
fn an_axis_that_follows_late_has_no_mode() {
    let command = pseudo_random(1500);
    for (delay, noise) in [(1, 0.0), (2, 0.0), (7, 0.01), (20, 0.01), (20, 0.0), (40, 0.003)] {
        let late = (0..1500).map(|k: usize| k.checked_sub(delay).map_or(0.0, |k| command[k]));
        let found = identify(&log(command.clone(), noisy(late, noise, 1)));
        assert_eq!(found.modes, [], "{delay}");
        let said = match found.remarks[..] {
            [PositionRemark::Late { samples }] => samples == delay,
            // The fit itself has a few samples of delay.
            [PositionRemark::NoRinging { .. }] => delay < 10,
            _ => false,
        };
        assert!(said, "{delay}: {:?}", found.remarks);
    }
}

#[test]
fn a_tone_that_does_not_decay_is_not_a_mode() {
    let tone = |n: usize| 0.05 * (MODE.omega() * n as f64 * 1e-3).sin();
    let command = pseudo_random(1500);
    for (command, response) in [
        (Vec::new(), noisy((0..1500).map(tone), 0.001, 1)),
        (
            command.clone(),
            noisy((0..1500).map(|n| command[n] + tone(n)), 0.005, 2),
        ),
    ] {
        let found = identify(&log(command, response));
        assert_eq!(found.modes, []);
        assert!(
            matches!(found.remarks[..], [PositionRemark::Tone { frequency_hz }] if (frequency_hz - 20.0).abs() < 0.1),
            "{:?}",
            found.remarks
        );
    }
}

#[test]
fn a_log_shorter_than_a_period_says_how_long_it_should_be() {
    // The log is 30 ms of a mode with a period of 50 ms.
    let short = PositionLog {
        sample_s: 1e-4,
        ..log(Vec::new(), noisy((0..300).map(|n| ring_at(n as f64 * 1e-4)), 0.002, 3))
    };
    let found = identify(&short);
    assert_eq!(found.modes, []);
    let [
        PositionRemark::TooShort {
            seconds, frequency_hz, ..
        },
    ] = found.remarks[..]
    else {
        panic!("{:?}", found.remarks);
    };
    assert!(
        (seconds - 0.03).abs() < 1e-12 && (frequency_hz / 20.0 - 1.0).abs() < 0.2,
        "{frequency_hz}"
    );
    let said = found.remarks[0].to_string();
    assert!(
        said.contains("0.0300 s long") && said.contains("three periods"),
        "{said}"
    );
}

#[test]
fn samples_before_a_blow_are_left_out() {
    let struck = (0..2000).map(|n: usize| n.checked_sub(500).map_or(0.0, ring));
    let found = identify(&log(Vec::new(), noisy(struck, 0.01, 4)));
    let [only] = found.modes[..] else { panic!("{found:?}") };
    assert!((only.mode.frequency_hz / 20.0 - 1.0).abs() < 0.01 && (only.mode.damping / 0.03 - 1.0).abs() < 0.15);
    assert!(
        matches!(found.remarks[..], [PositionRemark::Onset { samples }] if (495..530).contains(&samples)),
        "{:?}",
        found.remarks
    );
}

#[test]
fn a_dead_sensor_is_refused() {
    let dead = log(pseudo_random(100), vec![3.0; 100]);
    assert_eq!(
        position::identify(&dead),
        Err(PositionError::Dead {
            value: 3.0,
            samples: 100
        })
    );
}

#[test]
fn a_step_that_decays_in_half_of_the_log_does_not_seem_to_move() {
    let truth = Mode {
        frequency_hz: 131.0,
        damping: 0.158,
    };
    let mut sampled = SampledPlant::new(&Plant::new(&[(truth, 1.0)]).unwrap(), 1e-3, 0.0);
    let command: Vec<f64> = (0..1000).map(|n| if n < 100 { 0.0 } else { 1.0 }).collect();
    for delay in [0, 1, 2] {
        let clean: Vec<f64> = command.iter().map(|u| sampled.step(*u)).collect();
        let late = (0..1000).map(|k: usize| k.checked_sub(delay + 1).map_or(0.0, |k| clean[k]));
        let found = identify(&log(command.clone(), noisy(late, 0.005, 1)));
        let moves = found.remarks.iter().any(|r| matches!(r, PositionRemark::Moves { .. }));
        assert!(found.modes.len() == 1 && !moves, "{found:?}");
        sampled = SampledPlant::new(&Plant::new(&[(truth, 1.0)]).unwrap(), 1e-3, 0.0);
    }
}

#[test]
fn flat_tops_do_not_bias_a_mode() {
    let truth = Mode {
        frequency_hz: 50.0,
        damping: 0.1,
    };
    for (limit, seed) in [(1.1, 1), (0.9, 2), (0.9, 3)] {
        let mut sampled = SampledPlant::new(&Plant::new(&[(truth, 1.0)]).unwrap(), 1e-3, 0.0);
        let command = pseudo_random(2000);
        let mut at = 0.0;
        let clean: Vec<f64> = command
            .iter()
            .map(|u| std::mem::replace(&mut at, sampled.step(*u)))
            .collect();
        let mut response = noisy(clean.into_iter(), 0.005, seed);
        response.iter_mut().for_each(|y| *y = y.clamp(-limit, limit));
        let found = identify(&log(command, response));
        let [only] = found.modes[..] else {
            panic!("{limit}: {:?} {:?}", found.modes, found.remarks)
        };
        let (frequency, damping) = (only.mode.frequency_hz - 50.0, only.mode.damping - 0.1);
        assert!(
            frequency.abs() < 0.5 && frequency.abs() < 3.0 * only.frequency_sd_hz,
            "{only:?}"
        );
        assert!(
            damping.abs() < 0.015 && damping.abs() < 3.0 * only.damping_sd,
            "{only:?}"
        );
    }
}
