//! What must never happen after the drive command, for any inputs; and its order of events, by hand.

use posicast_blocks::axis::SupervisorState;
use posicast_blocks::drive_command::{DUTY_MAX, DUTY_MIN, DriveCommand, Inputs, Outputs, limited, saturated};
use proptest::prelude::*;

const READY: Inputs = Inputs {
    rst: false,
    tick: false,
    controller_duty: 0,
    controller_valid: false,
    axis_state: SupervisorState::Ready as u8,
    axis_pwm_enable: false,
    axis_drive_enable: false,
    axis_brake_release: false,
    axis_pwm_trip_n: true,
    drive_fault_n: true,
    limit_plus_ok: true,
    limit_minus_ok: true,
    direct_enable: true,
    direct_kick: false,
    direct_hold_ticks: 3,
    direct_duty: 500,
    direct_limit: 1000,
    self_test: false,
    gates: 0,
    valley: false,
};
const KICK: Inputs = Inputs {
    direct_kick: true,
    ..READY
};
const TICK: Inputs = Inputs { tick: true, ..READY };

/// Returns the outputs after each of the clocks.
fn play(clocks: &[Inputs]) -> Vec<Outputs> {
    let mut command = DriveCommand::new();
    let after = clocks.iter().map(|inputs| {
        command.step(inputs);
        command.outputs()
    });
    after.collect()
}

fn duties(clocks: &[Inputs]) -> Vec<i32> {
    play(clocks).iter().map(|shown| shown.duty).collect()
}

#[test]
fn a_kick_lasts_its_ticks() {
    let shown = play(&[KICK, TICK, READY, TICK, READY, TICK, READY]);
    let active: Vec<bool> = shown.iter().map(|shown| shown.direct_active).collect();
    assert_eq!(active, [true, true, true, true, true, false, false]);
    let expired: Vec<bool> = shown.iter().map(|shown| shown.direct_expired).collect();
    assert_eq!(expired, [false, false, false, false, false, true, false]);
    assert_eq!(
        duties(&[KICK, TICK, READY, TICK, READY, TICK, READY]),
        [0, 500, 500, 500, 500, 0, 0]
    );
}

#[test]
fn a_kick_in_the_last_tick_goes_on() {
    let last = Inputs { tick: true, ..KICK };
    let shown = play(&[KICK, TICK, TICK, last, TICK, TICK, TICK]);
    assert!(
        shown[..6]
            .iter()
            .all(|shown| shown.direct_active && !shown.direct_expired)
    );
    assert!(shown[6].direct_expired);
}

#[test]
fn it_takes_a_kick_in_ready_with_enable() {
    let off = Inputs {
        axis_state: SupervisorState::Off as u8,
        ..KICK
    };
    let not_wanted = Inputs {
        direct_enable: false,
        ..KICK
    };
    let no_time = Inputs {
        direct_hold_ticks: 0,
        ..KICK
    };
    for wrong in [off, not_wanted, no_time, READY] {
        let shown = play(&[wrong, READY, TICK, READY]);
        assert!(
            shown.iter().all(|shown| !shown.direct_active && !shown.pwm_enable),
            "{wrong:?}"
        );
    }
    // An interrupted self-test does not continue by itself.
    for wrong in [off, not_wanted] {
        let wrong = Inputs {
            direct_kick: false,
            ..wrong
        };
        assert!(!play(&[KICK, TICK, wrong, READY, TICK])[4].direct_active);
    }
}

#[test]
fn a_sign_that_turns_is_nothing_for_a_tick() {
    let back = Inputs {
        direct_duty: -500,
        direct_hold_ticks: 9,
        ..TICK
    };
    let kick = Inputs {
        direct_hold_ticks: 9,
        ..KICK
    };
    assert_eq!(duties(&[kick, TICK, back, back, TICK, TICK]), [0, 500, 0, -500, 0, 500]);
}

#[test]
fn a_limit_switch_stops_its_direction_between_ticks() {
    let on_plus = Inputs {
        limit_plus_ok: false,
        ..READY
    };
    let on_minus = Inputs {
        limit_minus_ok: false,
        ..READY
    };
    assert_eq!(duties(&[KICK, TICK, on_plus, READY]), [0, 500, 0, 0]);
    assert_eq!(duties(&[KICK, TICK, on_minus, READY]), [0, 500, 500, 500]);
}

#[test]
fn the_supervisor_takes_over_without_a_gap_and_without_the_manual_duty() {
    let hold = Inputs {
        axis_state: SupervisorState::Hold as u8,
        axis_pwm_enable: true,
        axis_drive_enable: true,
        axis_brake_release: true,
        ..READY
    };
    let controlled = Inputs {
        controller_valid: true,
        controller_duty: -131_072,
        ..hold
    };
    let shown = play(&[KICK, TICK, hold, hold, controlled, hold, READY]);
    assert!(
        shown[..6]
            .iter()
            .all(|shown| shown.pwm_enable && shown.drive_enable && shown.brake_release)
    );
    let taken: Vec<i32> = shown.iter().map(|shown| shown.duty).collect();
    assert_eq!(taken, [0, 500, 0, 0, DUTY_MIN, DUTY_MIN, 0]);
    assert!(!shown[6].pwm_enable && shown[4].feed && !shown[5].feed);
}

/// Inputs in READY with the self-test and these gates.
const TEST: Inputs = Inputs {
    self_test: true,
    ..READY
};

#[test]
fn a_self_test_runs_the_pwm_alone_and_behind_its_mask() {
    let kick = Inputs {
        direct_kick: true,
        ..TEST
    };
    let tick = Inputs { tick: true, ..TEST };
    let hold = Inputs {
        axis_state: SupervisorState::Hold as u8,
        axis_pwm_enable: true,
        axis_drive_enable: true,
        axis_brake_release: true,
        ..TEST
    };
    let outputs = |clocks: &[Inputs]| -> Vec<[bool; 4]> {
        let shown = play(clocks).into_iter();
        let pins = shown.map(|s| [s.mask_pins, s.pwm_enable, s.drive_enable, s.brake_release]);
        pins.collect()
    };
    let tests = [true, true, false, false];
    let ends = [true, false, false, false];
    let off = [false; 4];
    // Direct mode expires.
    assert_eq!(
        outputs(&[kick, tick, TEST, tick, tick, TEST]),
        [tests, tests, tests, tests, ends, off]
    );
    // The flag falls: the mask stays until the PWM has been off, and direct mode is not active with the pins on.
    assert_eq!(
        outputs(&[kick, tick, READY, READY, READY]),
        [tests, tests, ends, off, off]
    );
    let direct = [false, true, true, true];
    assert_eq!(outputs(&[kick, READY, KICK, READY]), [tests, ends, direct, direct]);
    // The flag rises.
    assert_eq!(outputs(&[KICK, TEST, kick]), [direct, off, tests]);
    // The supervisor takes over, with one clock of the PWM off in between.
    assert_eq!(outputs(&[kick, hold, hold]), [tests, [true, false, true, true], direct]);
    assert_eq!(duties(&[kick, tick, tick]), [0, 500, 500]);
}

#[test]
fn gates_are_counted_from_valley_to_valley() {
    let gates = |gates| Inputs { gates, ..TEST };
    let valley = |gates| Inputs {
        gates,
        valley: true,
        ..TEST
    };
    let kick = Inputs {
        direct_kick: true,
        ..TEST
    };
    let results = |clocks: &[Inputs]| {
        let shown = play(clocks);
        let last = shown[shown.len() - 1];
        (last.self_test_high, last.self_test_low)
    };
    let period = [
        kick,
        gates(1),
        valley(1),
        gates(0xd),
        gates(2),
        gates(0),
        gates(2),
        gates(2),
    ];
    assert_eq!(results(&period), (1, 0));
    let ended = [&period[..], &[valley(1)]].concat();
    assert_eq!(results(&ended), (2, 3));
    // Without the mask nothing is counted.
    let after = [&ended[..], &[READY, READY, valley(3), valley(3)]].concat();
    assert_eq!(results(&after), (2, 3));
    // The test lasts longer than the longest period.
    let long = [vec![kick], vec![gates(1); 70_000], vec![valley(0)]].concat();
    assert_eq!(results(&long), (u16::MAX, 0));
}

#[test]
fn words_of_18_bits_saturate_to_17() {
    for (wide, narrow) in [
        (65_535, DUTY_MAX),
        (65_536, DUTY_MAX),
        (131_071, DUTY_MAX),
        (-65_536, DUTY_MIN),
        (-65_537, DUTY_MIN),
        (-1, -1),
    ] {
        assert_eq!(saturated(wide), narrow);
    }
    assert_eq!((limited(-65_536, 65_535), limited(7, 0)), (-65_535, 0));
}

fn any_inputs() -> impl Strategy<Value = Inputs> {
    let often = proptest::bool::weighted(0.95);
    let seldom = proptest::bool::weighted(0.1);
    let states = prop_oneof![9 => Just(1u8), 1 => 0u8..8];
    (
        (
            proptest::bool::weighted(0.005),
            any::<bool>(),
            any::<i32>(),
            any::<bool>(),
            states,
        ),
        (seldom, seldom, seldom, often, often, often, often, often),
        (seldom, 0u16..9, -70_000i32..70_000, often, 0u8..16, any::<bool>()),
    )
        .prop_map(|(first, second, third)| {
            let (rst, tick, controller_duty, controller_valid, axis_state) = first;
            let (pwm, drive, brake, trip_n, fault_n, plus, minus, direct_enable) = second;
            let (direct_kick, direct_hold_ticks, direct_duty, self_test, gates, valley) = third;
            Inputs {
                rst,
                tick,
                controller_duty,
                controller_valid,
                axis_state,
                axis_pwm_enable: pwm,
                axis_drive_enable: drive,
                axis_brake_release: brake,
                axis_pwm_trip_n: trip_n,
                drive_fault_n: fault_n,
                limit_plus_ok: plus,
                limit_minus_ok: minus,
                direct_enable,
                direct_kick,
                direct_hold_ticks,
                direct_duty,
                direct_limit: 0,
                self_test,
                gates,
                valley,
            }
        })
}

proptest! {
    #[test]
    fn prop_nothing_is_on_that_should_not_be(
        clocks in proptest::collection::vec(any_inputs(), 1..400),
        direct_limit: u16,
        never_tested: bool,
    ) {
        let mut command = DriveCommand::new();
        let mut time_left = 0;
        for inputs in clocks {
            let self_test = inputs.self_test && !never_tested;
            let inputs = Inputs { direct_limit, self_test, ..inputs };
            let before = command.step(&inputs);
            let after = command.outputs();
            time_left = match (inputs.rst, inputs.direct_kick) {
                (true, _) => 0,
                (false, true) => u32::from(inputs.direct_hold_ticks),
                (false, false) => u32::saturating_sub(time_left, inputs.tick.into()),
            };
            let permitted = !inputs.rst && inputs.axis_state == 1 && inputs.direct_enable && time_left > 0;
            prop_assert!(permitted || !after.direct_active);
            let wanted = [inputs.axis_pwm_enable, inputs.axis_drive_enable, inputs.axis_brake_release];
            let shown = [after.pwm_enable, after.drive_enable, after.brake_release];
            let tests = after.direct_active && after.mask_pins;
            let ends = before.direct_active && before.mask_pins && !after.direct_active;
            for (output, (shown, wanted)) in shown.into_iter().zip(wanted).enumerate() {
                let is_pwm = output == 0;
                let wanted = !inputs.rst && wanted && !(is_pwm && ends);
                prop_assert_eq!(shown, (wanted || after.direct_active) && (is_pwm || !tests));
            }
            // Direct mode is part of the self-test as a whole or not at all; its mask outlives the PWM, but not for
            // long.
            prop_assert!(!after.direct_active || after.mask_pins == inputs.self_test);
            prop_assert!(after.direct_active || !after.mask_pins || (ends && !after.pwm_enable));
            prop_assert!(inputs.rst || !before.mask_pins || after.mask_pins || !before.pwm_enable);
            if !before.mask_pins && !inputs.rst {
                prop_assert_eq!(
                    (after.self_test_high, after.self_test_low),
                    (before.self_test_high, before.self_test_low)
                );
            }
            prop_assert!(after.pwm_enable || after.duty == 0);
            if after.direct_active {
                let limit = i32::from(direct_limit);
                let step = after.duty - before.duty;
                prop_assert!(after.duty.abs() <= limit);
                prop_assert!(step.abs() <= limit || !before.direct_active && after.duty == 0);
                prop_assert!(inputs.limit_plus_ok || after.duty <= 0);
                prop_assert!(inputs.limit_minus_ok || after.duty >= 0);
            }
        }
    }
}
