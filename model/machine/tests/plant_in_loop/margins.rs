//! The computed stability margins compared with the simulated machine.

use crate::plant_in_loop::chain::{Chain, Pace, TORQUE, VELOCITY, machine};
use posicast_machine::control::sampled::SampledLoop;
use posicast_machine::control::{ControlError, DEFAULT_MARGIN, gains, loop_lag_s};

/// 5 kg on a current drive, with a lightly damped mode of 25 Hz: gains that the lag alone would allow are unstable.
const SOFT: &str = r#"
name = "soft_axis"
[clock]
frequency_hz = 50_000_000
sample_hz = 10_000
[[axis]]
name = "x"
counts_per_unit = 1_000_000
[axis.shaper]
kind = "zvd"
[[axis.mode]]
frequency_hz = 25
damping = 0.03
[axis.encoder]
[axis.pwm]
mode = "locked-antiphase"
frequency_hz = 20_000
dead_time_s = 500e-9
minimum_pulse_s = 1e-6
[axis.drive]
mode = "torque"
equivalent_mass = 5
force_constant = 20
current_limit_a = 4
full_scale_a = 5
bandwidth_hz = 1000
[axis.controller]
kind = "pd"
"#;

/// A run of the simulated loop: its duration, and the initial distance from its position in counts.
#[derive(Clone, Copy)]
struct Run {
    ticks: u32,
    away: i32,
    /// Swings of up to this many counts are the encoder's steps.
    steps: f64,
}

/// Returns whether the simulated loop swings at the end at least as much as before.
fn swings(text: &str, factor: f64, run: Run) -> bool {
    let mut chain = Chain::new(&machine(text, true), 0, 1.0, Pace::Ticks).with_feedback(factor);
    let distances = chain.hold(run.away, run.ticks);
    // The two windows are a part of a period apart, so that they show what swings, not what settles.
    let apart = run.ticks as usize / 300;
    let swing = |part: &[f64]| {
        let pairs = part.iter().zip(&part[apart..]);
        pairs.fold(0.0f64, |peak, (from, to)| peak.max((to - from).abs()))
    };
    let third = distances.len() / 3;
    let (middle, last) = (swing(&distances[third..2 * third]), swing(&distances[2 * third..]));
    last > run.steps && last > 0.9 * middle
}

#[test]
fn golden_the_gain_margin_is_where_the_simulated_loop_begins_to_swing() {
    // Without nonlinear effects: friction, and a boundary layer as narrow as the swing.
    let linear = [
        ("coulomb = 40.0", "coulomb = 0.0"),
        ("epsilon = 4.0", "epsilon = 40.0"),
        ("boundary = 0.02", "boundary = 0.2"),
        ("current_limit_a = 2.73", "current_limit_a = 27.3"),
        ("full_scale_a = 3.0", "full_scale_a = 30.0"),
    ];
    let linear = linear
        .iter()
        .fold(TORQUE.to_owned(), |text, (from, to)| text.replace(from, to));
    let pid = VELOCITY.replace("kind = \"pd\"", "kind = \"pid\"");
    let run = |ticks, away, steps| Run { ticks, away, steps };
    for (text, run) in [
        (VELOCITY, run(900, 60, 12.0)),
        (pid.as_str(), run(900, 60, 12.0)),
        (linear.as_str(), run(3_000, 60, 12.0)),
        (SOFT, run(30_000, 30_000, 3.0)),
    ] {
        let derived = Chain::new(&machine(text, true), 0, 1.0, Pace::Ticks).derived;
        let computed = derived.margins.gain_margin.unwrap();
        assert!(computed > 2.0 && computed < 20.0, "{:?}", derived.margins);
        let (mut calm, mut wild) = (0.7 * computed, 1.4 * computed);
        assert!(!swings(text, calm, run), "{computed}");
        assert!(swings(text, wild, run), "{computed}");
        for _ in 0..6 {
            let middle = (calm * wild).sqrt();
            if swings(text, middle, run) {
                wild = middle;
            } else {
                calm = middle;
            }
        }
        let found = (calm * wild).sqrt();
        assert!(
            (found / computed - 1.0).abs() < 0.15,
            "{found} simulated, {computed} computed"
        );
    }
}

#[test]
fn default_gains_leave_their_margin_on_machines_that_are_a_fifth_off() {
    let of = |kind: &str, text: &str| machine(&text.replace("kind = \"pd\"", &format!("kind = \"{kind}\"")), true);
    let wrist = include_str!("../../../../closed_loop/tests/fixtures/machines/wrist.toml");
    for machine in [of("pd", SOFT), of("pid", SOFT), of("pid", wrist), of("pd", VELOCITY)] {
        let axis = &machine.axes[0];
        let lag_s = loop_lag_s(axis.drive.as_ref().unwrap(), 150e-6);
        let derived = gains(axis, machine.clock, lag_s).unwrap();
        assert_eq!(derived.warnings, [], "{}", machine.name);
        for factor in [0.8, 0.9, 1.0, 1.1, 1.2] {
            let sampled = SampledLoop::new(axis, machine.clock, lag_s, factor).unwrap();
            let margins = sampled.margins(&derived.linear);
            let holds = margins.stable
                && margins.modulus_margin > DEFAULT_MARGIN - 1e-9
                && margins.gain_margin.unwrap() > 1.99
                && margins.phase_margin_deg.unwrap() > 28.9;
            assert!(holds, "{} {factor}: {margins:?}", machine.name);
        }
    }
}

#[test]
fn gains_that_the_machine_does_not_bear_are_an_error_with_the_margin() {
    let with = |gains: &str| machine(&SOFT.replace("kind = \"pd\"", &format!("kind = \"pd\"\n{gains}")), true);
    let derive = |text: &str| {
        let machine = with(text);
        let axis = &machine.axes[0];
        gains(axis, machine.clock, loop_lag_s(axis.drive.as_ref().unwrap(), 150e-6))
    };
    // The lag alone would give a derivative gain of 0.4/lag.
    let error = derive("proportional = 418_000\nderivative = 1293").unwrap_err();
    let ControlError::Unstable {
        gain_margin_db: Some(margin),
        key,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert!(margin < -40.0 && key == "axis.controller.proportional", "{error}");
    let said = error.to_string();
    assert!(said.contains("gain margin -") && said.contains("leave"), "{said}");
    assert!(matches!(
        derive("proportional = 4e8\nderivative = 40"),
        Err(ControlError::Unstable { .. })
    ));
    let thin = derive("proportional = 2\nderivative = 6.5").unwrap().warnings;
    assert!(
        thin.iter().any(|warning| warning.to_string().contains("thin")),
        "{thin:?}"
    );
}
