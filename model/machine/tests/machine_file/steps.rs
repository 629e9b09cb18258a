//! `[axis.steps]` and `[axis.stepper]`: values, defaults, and what is refused with which message.

use posicast_blocks::step_generator::{StepLinesActiveLow, StepMode, StepTimesInSeconds};
use posicast_machine::machine_file::{CorrectionSection, ProbeSection, ProbeSide};

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

const PROBE: &str = "[axis.probe]\nactive_low = true\nfilter_s = 1e-6\nside = \"plus\"\nvelocity = 10.0\nwithin = 30.0\nretract = 3.0\n\
                     position = 235.0\n\n[axis.limits]\nvelocity = 300.0";

/// The file with a probe on its first axis, changed.
fn with_probe(from: &str, to: &str) -> String {
    let text = STEPS.replacen("[axis.limits]\nvelocity = 300.0", PROBE, 1);
    assert!(text.contains("[axis.probe]") && text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn a_probe_is_read_in_the_unit_of_the_axis() {
    let machine = right(&with_probe("", ""));
    let expected = ProbeSection {
        active_low: true,
        filter_s: 1e-6,
        side: ProbeSide::Plus,
        velocity: 0.01,
        slow_velocity: 0.002,
        within: 0.03,
        retract: 0.003,
        position: 0.235,
    };
    assert_eq!((machine.axes[0].probe, machine.axes[1].probe), (Some(expected), None));
    assert_eq!(expected.filter_clocks(&machine.clock), 50);
}

#[test]
fn a_probe_that_contradicts_its_axis_is_refused() {
    for (from, to, expected) in [
        (
            "velocity = 10.0",
            "velocity = 400.0",
            "m.toml:28: axis.probe.velocity of axis x: found velocity = 400 with limits.velocity = 300; allowed: an approach at \
             most as fast as a move",
        ),
        (
            "within = 30.0",
            "within = 2.0",
            "m.toml:30: axis.probe.retract of axis x: found retract = 3 with within = 2; allowed: a retract of at most the \
             distance in which the contact is",
        ),
        (
            "filter_s = 1e-6",
            "filter_s = 1e-3",
            "m.toml:26: axis.probe.filter_s of axis x: found filter_s = 1e-3; allowed: at most 1.260 µs, 63 clocks",
        ),
        (
            "retract = 3.0",
            "slow_velocity = 11.0\nretract = 3.0",
            "m.toml:30: axis.probe.slow_velocity of axis x: found slow_velocity = 11 with velocity = 10; allowed: a second \
             approach at most as fast as the first one",
        ),
    ] {
        let error = wrong(&with_probe(from, to));
        assert_eq!(error.to_string(), expected);
    }
    let text = with_probe("", "").replacen(
        "mode = \"step_direction\"\npulse_s = 2e-6\ndirection_setup_s = 5e-6\n",
        "",
        1,
    );
    let error = wrong(&text.replacen("[axis.steps]\n", "", 1)).to_string();
    assert!(error.contains("found [axis.probe] without [axis.steps]"), "{error}");
}

const CORRECTION: &str = "[axis.scale]\ncounts_per_unit = 800\n\n[axis.correction]\nfrom = 0.1\nmost = 5.0\nvelocity = 2.0\nrest_s = 0.3\n\n\
                          [axis.limits]\ndeviation = 5.0\nvelocity = 300.0";

#[test]
fn a_correction_is_read_and_its_contradictions_are_refused() {
    let text = STEPS.replacen("[axis.limits]\nvelocity = 300.0", CORRECTION, 1);
    let machine = right(&text);
    let expected = CorrectionSection {
        from: 0.0001,
        most: 0.005,
        velocity: 0.002,
        rest_s: 0.3,
    };
    assert_eq!(machine.axes[0].correction, Some(expected));
    for (from, to, expected) in [
        (
            "from = 0.1",
            "from = 0.01",
            "axis.correction.from of axis x: found from = 0.01, 0.8 steps; allowed: at least a step",
        ),
        (
            "from = 0.1",
            "from = 6.0",
            "axis.correction.from of axis x: found from = 6 with most = 5; allowed: less than `most`",
        ),
        (
            "most = 5.0",
            "most = 6.0",
            "axis.correction.most of axis x: found most = 6 with limits.deviation = 5; allowed: a correction of at most the \
             deviation that stops the axis",
        ),
        (
            "velocity = 2.0",
            "velocity = 400.0",
            "axis.correction.velocity of axis x: found velocity = 400 with limits.velocity = 300; allowed: a correction at most \
             as fast as a move",
        ),
        (
            "[axis.scale]\ncounts_per_unit = 800\n",
            "",
            "found [axis.correction] without [axis.scale]; allowed: a correction with [axis.steps] and [axis.scale], which shows \
             the missing steps",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = wrong(&text.replacen(from, to, 1)).to_string();
        assert!(error.contains(expected), "{error}");
    }
}
