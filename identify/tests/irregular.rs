//! Position logs whose rows are not equally spaced: they show the modes of the machine and no others, or are refused.

use posicast_identify::log::{self, Log, LogError, Remark};
use posicast_identify::position;
use posicast_identify::synthetic::Noise;
use posicast_identify::synthetic::pseudo_random;
use posicast_shaper::mode::Mode;
use std::fmt::Write;

const MODE: Mode = Mode {
    frequency_hz: 20.0,
    damping: 0.05,
};
const SAMPLE_S: f64 = 1e-3;

/// Times of the rows, each off its place by up to this part of a sample, by a clock that wanders by half a sample.
fn times(rows: usize, off: f64, seed: u64) -> Vec<f64> {
    let mut noise = Noise::new(seed);
    // A normal deviate, folded into the range.
    let mut place = |row: usize| {
        let row = row as f64;
        row + 0.5 * (row / 200.0).sin() + off * (3.0 * noise.draw()).sin()
    };
    (0..rows).map(|row| SAMPLE_S * place(row)).collect()
}

/// The response of the mode to a command that is held from one row to the next; a rigid axis without the mode.
fn response(command: &[f64], times: &[f64], mode: Option<&Mode>) -> Vec<f64> {
    let Some(mode) = mode else {
        return command.to_vec();
    };
    let (decay, omega) = (mode.decay(), mode.omega_damped());
    let (mut position, mut velocity) = (0.0, 0.0);
    let mut found = Vec::new();
    for (row, u) in command.iter().enumerate() {
        found.push(position);
        let step_s = times.get(row + 1).map_or(0.0, |next| next - times[row]);
        // Free motion about the place that the command asks for.
        let (away, part) = (position - u, (-decay * step_s).exp());
        let (sin, cos) = (omega * step_s).sin_cos();
        let other = (velocity + decay * away) / omega;
        let moved = part * (away * cos + other * sin);
        velocity = -decay * moved + omega * part * (other * cos - away * sin);
        position = u + moved;
    }
    found
}

fn csv(columns: &str, times: &[f64], rows: &[&[f64]]) -> String {
    let mut text = format!("time,{columns}\n");
    for (row, time_s) in times.iter().enumerate() {
        let _ = write!(text, "{time_s:.9}");
        for column in rows {
            let _ = write!(text, ",{:.9}", column[row]);
        }
        text.push('\n');
    }
    text
}

/// Commands that show a mode: a pseudo-random sequence and a step.
fn commands(rows: usize) -> [Vec<f64>; 2] {
    let step = (0..rows).map(|row| f64::from(u8::from(row >= 50)));
    [pseudo_random(rows, 5), step.collect()]
}

#[test]
fn a_command_between_irregular_rows_is_refused() {
    let times = times(1500, 0.4, 1);
    for command in commands(1500) {
        for mode in [None, Some(&MODE)] {
            let response = response(&command, &times, mode);
            for columns in ["command,response", "drive_command,position"] {
                let text = csv(columns, &times, &[&command, &response]);
                let error = log::read(text.as_bytes()).unwrap_err();
                assert!(matches!(error, LogError::Irregular { .. }), "{error:?}");
                let said = error.to_string();
                assert!(said.contains("% of a step") && said.contains("constant rate"), "{said}");
            }
        }
    }
}

#[test]
fn long_rows_that_waver_little_show_the_machine_and_nothing_else() {
    for seed in 0..5 {
        let times = times(1500, 0.09, seed);
        for command in commands(1500) {
            for mode in [None, Some(&MODE)] {
                let mut noise = Noise::new(100 + seed);
                let response = response(&command, &times, mode);
                let noisy: Vec<f64> = response.iter().map(|y| y + 0.002 * noise.draw()).collect();
                let text = csv("command,response", &times, &[&command, &noisy]);
                let Log::Position(log) = log::read(text.as_bytes()).unwrap().log else {
                    panic!()
                };
                let found = position::identify(&log).unwrap();
                assert_eq!(
                    found.modes.len(),
                    usize::from(mode.is_some()),
                    "{seed}: {:?}",
                    found.modes
                );
                for found in &found.modes {
                    assert!(
                        (found.mode.frequency_hz / MODE.frequency_hz - 1.0).abs() < 0.01,
                        "{found:?}"
                    );
                    assert!((found.mode.damping / MODE.damping - 1.0).abs() < 0.15, "{found:?}");
                }
            }
        }
    }
}

/// A free decay has no command that would have to be known between the rows: interpolated, it shows its mode and no
/// other.
#[test]
fn a_free_decay_at_irregular_times_shows_its_mode_alone() {
    for seed in 0..5 {
        let times = times(1500, 0.4, seed);
        let mut noise = Noise::new(200 + seed);
        let ring = |t: &f64| (-MODE.decay() * t).exp() * (MODE.omega_damped() * t).cos();
        let response: Vec<f64> = times.iter().map(|t| ring(t) + 0.002 * noise.draw()).collect();
        let reading = log::read(csv("response", &times, &[&response]).as_bytes()).unwrap();
        assert!(matches!(reading.remarks[..], [Remark::Irregular { .. }]));
        let Log::Position(log) = reading.log else { panic!() };
        let found = position::identify(&log).unwrap();
        let [only] = found.modes[..] else {
            panic!("{seed}: {:?}", found.modes)
        };
        assert!(
            (only.mode.frequency_hz / MODE.frequency_hz - 1.0).abs() < 0.01,
            "{only:?}"
        );
        assert!((only.mode.damping / MODE.damping - 1.0).abs() < 0.15, "{only:?}");
    }
}
