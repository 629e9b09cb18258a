//! `[axis.steps]` and `[axis.stepper]`: values, defaults, and what is refused with which message.

use posicast_blocks::step_generator::{StepLinesActiveLow, StepMode, StepTimesInSeconds};

use super::files::{right, wrong};

const STEPS: &str = include_str!("../steps.toml");

/// Replaces the first `from` by `to` in the file, and expects this text, and part of the remedy.
#[track_caller]
fn case(from: &str, to: &str, expected: &str, remedy: &str) {
    assert!(STEPS.contains(from), "{from}");
    let error = wrong(&STEPS.replacen(from, to, 1));
    assert_eq!(error.to_string(), expected);
    assert!(
        error.problems()[0].remedy.contains(remedy),
        "{}",
        error.problems()[0].remedy
    );
}

#[test]
fn the_lines_and_their_times_are_read() {
    let machine = right(STEPS);
    let [x, y] = &machine.axes[..] else {
        panic!("{} axes", machine.axes.len());
    };
    let steps = x.steps.unwrap();
    assert_eq!(steps.mode, StepMode::StepDirection);
    // Space is as long as the pulse, hold as the setup.
    let times = StepTimesInSeconds {
        pulse_s: 2e-6,
        space_s: 2e-6,
        direction_setup_s: 5e-6,
        direction_hold_s: 5e-6,
    };
    assert_eq!((steps.times, steps.owed_limit), (times, None));
    assert_eq!(y.steps.unwrap().active_low, StepLinesActiveLow { a: false, b: true });
    // 100 + 100 clocks: a reversal waits 100 + 250 + 250 clocks, so it leaves 4 steps; a tick has 25.
    let generator = steps.generator(&machine.clock, 8).unwrap();
    assert_eq!((generator.period_clocks(), generator.reversal_steps()), (200, 4));
    assert_eq!(generator.owed_limit(), 2 * 4 + 26);
}

#[test]
fn times_and_lines_that_no_drive_has_are_refused() {
    case(
        "pulse_s = 2e-6",
        "pulse_s = 2e-3",
        "m.toml:21: axis.steps.pulse_s of axis x: found 2e-3 s; allowed: at most 1.311 ms, the 65535 clocks that the \
         hardware counts to",
        "check the unit",
    );
    case(
        "pulse_s = 2e-6",
        "pulse_s = 25e-6",
        "m.toml:21: axis.steps.pulse_s of axis x: found pulse and space of 2500 clocks with 24000 steps/s at \
         limits.velocity; allowed: a period of at most 41.67 µs; these lines give 20000 steps/s",
        "lower the velocity or the microsteps",
    );
    case(
        "active_low = [\"step_down\"]",
        "active_low = [\"direction\"]",
        "m.toml:47: axis.steps.active_low of axis y: found `direction` with mode = \"up_down\"; allowed: the lines of that \
         mode, `step_up` and `step_down`",
        "`step_up`",
    );
    case(
        "direction_setup_s = 5e-6\n\n",
        "direction_setup_s = 5e-6\nowed_limit = 3\n\n",
        "m.toml:23: axis.steps.owed_limit of axis x: found owed_limit = 3; allowed: more than 4, which a reversal at the \
         largest rate leaves owed",
        "raise it",
    );
}

#[test]
fn steps_stand_in_place_of_a_loop_and_need_limits() {
    case(
        "[axis.steps]",
        "[axis.encoder]\nfilter_clocks = 8\n[axis.steps]",
        "m.toml:19: axis.encoder of axis x: found [axis.encoder] beside [axis.steps]; allowed: either encoder, PWM, drive and \
         controller, or steps, whose drive has a loop of its own; an encoder that only watches the steps is [axis.scale]",
        "remove [axis.encoder]",
    );
    case(
        "velocity = 300.0",
        "",
        "m.toml:20: axis.steps.mode of axis x: found [axis.steps] without limits.velocity; allowed: steps with the axis's \
         largest velocity, which the times of the lines are checked against",
        "add [axis.limits] with `velocity`",
    );
    case(
        "jerk = 500_000.0",
        "jerk = 500_000.0\nfollowing_error = 0.1",
        "m.toml:28: axis.limits.following_error of axis x: found following_error with [axis.steps]; allowed: following_error \
         on an axis with [axis.controller], whose loop it is about",
        "remove `following_error`",
    );
}
