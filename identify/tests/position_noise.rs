//! Position logs whose noise is correlated: it is not identified as a mode, and the existing modes are as certain as
//! stated.

use posicast_identify::position::{self, FoundInPosition, PositionRemark};
use posicast_identify::synthetic::Noise;
use posicast_identify::synthetic::pseudo_random;
use posicast_identify::{Between, PositionLog};
use posicast_shaper::mode::Mode;

/// Gy of the XY stage sampled at 0.5 ms (golden/xy_stage.json, `arx_zoh`), and its mode (`plants`).
const GY: [f64; 4] = [
    -1.832_374_278_501_373_5,
    0.913_931_185_271_228,
    0.041_391_803_666_882_11,
    0.040_165_103_102_972_61,
];
const GY_MODE: Mode = Mode {
    frequency_hz: 93.289_780_8,
    damping: 0.153_542_487_340_88,
};

fn log(command: Vec<f64>, response: Vec<f64>, sample_s: f64) -> PositionLog {
    PositionLog {
        sample_s,
        between: Between::Held,
        command,
        response,
        missing: Vec::new(),
    }
}

/// Returns noise that rings at 63 Hz, if samples are 1 ms apart: a fan, or another machine on the same floor.
fn narrow(samples: usize, seed: u64) -> Vec<f64> {
    let mut source = Noise::new(seed);
    let (mut last, mut before) = (0.0, 0.0);
    let ring = || {
        (last, before) = (1.8 * last - 0.95 * before + source.draw(), last);
        last
    };
    std::iter::repeat_with(ring).take(samples).collect()
}

fn identify(log: &PositionLog) -> FoundInPosition {
    position::identify(log).unwrap()
}

#[test]
fn ringing_noise_is_not_a_mode() {
    let step: Vec<f64> = (0..1000).map(|n| if n < 100 { 0.0 } else { 1.0 }).collect();
    for seed in 0..3 {
        let noise = narrow(1000, seed);
        let found = identify(&log(Vec::new(), noise.clone(), 1e-3));
        assert_eq!(found.modes, [], "free, {seed}");
        assert_eq!(found.remarks, [PositionRemark::NoExcitation]);
        for command in [pseudo_random(1000, 5), step.clone()] {
            // The log also has a rigid axis.
            let response = command.iter().zip(&noise).map(|(u, n)| u + 0.01 * n).collect();
            let found = identify(&log(command, response, 1e-3));
            assert_eq!(found.modes, [], "forced, {seed}");
            assert!(matches!(found.remarks[..], [PositionRemark::NoRinging { .. }]));
        }
    }
}

#[test]
fn long_noise_within_the_machine_leaves_the_figures_of_the_notes_and_honest_intervals() {
    // Notes, section 9, "equation noise 1 %": the disturbance rings as the mode does. Least squares on the equation
    // are the best method for it: over 200 such logs they are off by at most 0.8 % and 5.6 %.
    const LOGS: u64 = 24;
    let command = pseudo_random(1023, 1);
    let (mut frequencies, mut dampings) = (0, 0);
    for seed in 0..LOGS {
        let mut source = Noise::new(seed);
        let mut response: Vec<f64> = Vec::new();
        for k in 0..command.len() {
            let past = |signal: &[f64], n: usize| if k >= n { signal[k - n] } else { 0.0 };
            let drawn = 0.01 * source.draw();
            response.push(
                GY[2] * past(&command, 1) + GY[3] * past(&command, 2)
                    - GY[0] * past(&response, 1)
                    - GY[1] * past(&response, 2)
                    + drawn,
            );
        }
        let found = identify(&log(command.clone(), response, 0.5e-3));
        let [only] = found.modes[..] else {
            panic!("{seed}: {:#?}", found.modes);
        };
        assert!(
            (only.mode.frequency_hz / GY_MODE.frequency_hz - 1.0).abs() < 0.01,
            "{only:?}"
        );
        assert!((only.mode.damping / GY_MODE.damping - 1.0).abs() < 0.08, "{only:?}");
        frequencies += u64::from(only.frequency_interval_hz().holds(GY_MODE.frequency_hz));
        dampings += u64::from(only.damping_interval().holds(GY_MODE.damping));
    }
    assert!(frequencies >= 21 && dampings >= 21, "{frequencies} {dampings}");
}

#[test]
fn a_decay_is_found_in_noise_that_rings_elsewhere() {
    let truth = Mode {
        frequency_hz: 20.0,
        damping: 0.03,
    };
    for seed in 0..5 {
        let ring = |k: usize| {
            let t = k as f64 * 1e-3;
            (-truth.decay() * t).exp() * (truth.omega_damped() * t).cos()
        };
        let noise = narrow(1500, seed);
        let response = (0..1500).map(|k| ring(k) + 0.003 * noise[k]).collect();
        let found = identify(&log(Vec::new(), response, 1e-3));
        let [only] = found.modes[..] else {
            panic!("{seed}: {:#?}", found.modes);
        };
        assert!((only.mode.frequency_hz / 20.0 - 1.0).abs() < 0.01, "{only:?}");
        assert!((only.mode.damping / 0.03 - 1.0).abs() < 0.15, "{only:?}");
    }
}
