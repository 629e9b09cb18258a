//! `[axis.limits]`, `[axis.scale]`, `[axis.trace]` and `[stage]`: accepted and refused values.

use crate::machine_file::files::{EVERYTHING, SMALL, right, wrong};
use posicast_blocks::axis::{ALWAYS_OFF, Cause};
use posicast_machine::machine_file::{LimitsSection, Scale, ScaleUse, StageSection, TraceSection};

#[track_caller]
fn case(from: &str, to: &str, expected: &str) {
    assert!(EVERYTHING.contains(from), "{from}");
    assert_eq!(wrong(&EVERYTHING.replace(from, to)).to_string(), expected);
}

#[test]
fn every_key_yields_its_value() {
    let machine = right(EVERYTHING);
    let axis = &machine.axes[0];
    let expected = LimitsSection {
        velocity: Some(0.25),
        acceleration: Some(8.0),
        jerk: Some(400.0),
        travel: Some([-0.1, 0.1]),
        soft_limits_after_homing: true,
        stop_deceleration: Some(12.0),
        following_error: Some(0.001),
        deviation: Some(50e-6),
        deviation_s: 0.002,
        saturation_s: 0.1,
        encoder_lost_s: 0.02,
        encoder_lost_command: 0.25,
        watchdog_s: 0.5,
        brake_release_s: 0.05,
        brake_apply_s: 0.05,
        line_filter_s: 1e-6,
        off_causes: (ALWAYS_OFF | Cause::FollowingError.bit() | Cause::Watchdog.bit()) as u16,
        direct_duty: 0.05,
        direct_hold_s: Some(0.1),
        excitation: Some(10e-6),
    };
    assert_eq!(axis.limits, Some(expected));
    let scale = Scale {
        counts_per_unit: 10e6,
        usage: ScaleUse::Monitor,
        invert: false,
    };
    assert_eq!(axis.scale, Some(scale));
    assert_eq!(axis.trace, Some(TraceSection { samples: 1024 }));
    let stage = StageSection {
        extra_delay_s: 0.0,
        contour_speed: Some(0.1),
        arrive_together: false,
    };
    assert_eq!(machine.stage, Some(stage));
}

#[test]
fn what_is_left_out_has_its_default() {
    let machine = right(&format!("{SMALL}[axis.limits]\n"));
    assert_eq!(machine.axes[0].limits, Some(LimitsSection::default()));
    assert_eq!((machine.axes[0].scale, machine.axes[0].trace), (None, None));
    assert_eq!(machine.stage, None);
    // Bits 0 and 1 are always set; the others are drive lost, following error, deviation, encoder lost and in error,
    // schedule.
    assert_eq!(LimitsSection::default().off_causes, 0b1000_1101_1000_0111);
    let monitor = right(&EVERYTHING.replace("use = \"monitor\"\n", "")).axes[0].scale;
    assert_eq!(monitor.unwrap().usage, ScaleUse::Monitor);
    let position = right(&EVERYTHING.replace("\"monitor\"", "\"position\"")).axes[0].scale;
    assert_eq!(position.unwrap().usage, ScaleUse::Position);
    let stage = right(&format!("{SMALL}[stage]\n")).stage;
    let nothing = StageSection {
        extra_delay_s: 0.0,
        contour_speed: None,
        arrive_together: false,
    };
    assert_eq!(stage, Some(nothing));
}

#[test]
fn values_out_of_range_are_refused_with_their_place() {
    case(
        "\"monitor\"",
        "\"both\"",
        "m.toml:41: axis.scale.use of axis x: found \"both\"; allowed: monitor, position",
    );
    let expected = "m.toml:40: axis.scale.counts_per_unit of axis x: found 0; allowed: above 0, at most 1e12";
    case("= 10_000_000", "= 0", expected);
    case(
        "1024",
        "1000",
        "m.toml:90: axis.trace.samples of axis x: found 1000; allowed: 256, 512, 1024, 2048",
    );
    case(
        "1024",
        "1000000000000",
        "m.toml:90: axis.trace.samples of axis x: found 1000000000000; allowed: 256, 512, 1024, 2048",
    );
    let expected = "m.toml:94: stage.contour_speed: found 0; allowed: above 0, at most 1e9 m/s";
    case("contour_speed = 0.1", "contour_speed = 0", expected);
    let expected = "m.toml:93: stage.extra_delay_s: found 1.1; allowed: at least 0, at most 1 s";
    case("extra_delay_s = 0.0", "extra_delay_s = 1.1", expected);
    let expected = "m.toml:72: axis.limits.following_error of axis x: found the boolean true; allowed: a number, above 0, at \
                    most 1e9";
    case("following_error = 0.001", "following_error = true", expected);
    let expected = "m.toml:80: axis.limits.encoder_lost_command of axis x: found 1; allowed: at least 0, below 1";
    case("encoder_lost_command = 0.25", "encoder_lost_command = 1", expected);
    let expected = "m.toml:81: axis.limits.watchdog_s of axis x: found 61; allowed: at least 0, at most 6.5535 s, the \
                    65,535 ticks that its word counts: a lower clock.sample_hz allows more";
    case("watchdog_s = 0.5", "watchdog_s = 61", expected);
    let expected = "m.toml:85: axis.limits.direct_hold_s of axis x: found 0; allowed: above 0, at most 6.5535 s, the \
                    65,535 ticks that its word counts: a lower clock.sample_hz allows more";
    case("direct_hold_s = 0.1", "direct_hold_s = 0", expected);
}

#[test]
fn causes_that_switch_off_are_words_of_a_list() {
    let off = |list: &str| EVERYTHING.replace("[\"following-error\", \"watchdog\"]", list);
    assert_eq!(right(&off("[]")).axes[0].limits.unwrap().off_causes, ALWAYS_OFF as u16);
    let both = right(&off("[\"schedule\", \"schedule\", \"drive-lost\"]")).axes[0].limits;
    assert_eq!(both.unwrap().off_causes, 0b1000_0000_0000_0111);
    let names = "drive-lost, limit-plus, limit-minus, soft-limit-plus, soft-limit-minus, following-error, deviation, \
                 saturation, encoder-lost, encoder-error, segments, watchdog, schedule";
    let place = "m.toml:83: axis.limits.off of axis x: found";
    for wrong_word in ["\"watch-dog\"", "7", "\"emergency-stop\"", "\"group-stop\""] {
        let error = wrong(&off(&format!("[\"deviation\", {wrong_word}]")));
        assert_eq!(error.to_string(), format!("{place} {wrong_word}; allowed: {names}"));
    }
    let error = wrong(&off("[\"watchdogs\"]"));
    assert_eq!(error.problems()[0].remedy, "did you mean \"watchdog\"?");
    let expected = format!("{place} the string \"watchdog\"; allowed: a list of words, each one of {names}");
    assert_eq!(wrong(&off("\"watchdog\"")).to_string(), expected);
}

#[test]
fn the_loop_counts_with_the_counter_that_it_runs_on() {
    let counts = |text: &str| right(text).axes[0].loop_counts_per_unit();
    assert_eq!(counts(EVERYTHING), 1e6);
    let position = EVERYTHING.replace("\"monitor\"", "\"position\"");
    assert_eq!(counts(&position), 10e6);
    // ±0.1 m are a million counts of the scale, ±1 m are too many.
    let error = wrong(&position.replace("[-0.1, 0.1]", "[-1.0, 1.0]"));
    assert!(
        error.to_string().contains("a travel of up to 10000000 counts"),
        "{error}"
    );
    right(&EVERYTHING.replace("[-0.1, 0.1]", "[-1.0, 1.0]"));
}

#[test]
fn what_needs_another_block_says_which() {
    let limits = |key: &str| wrong(&format!("{SMALL}[axis.limits]\n{key}\n"));
    let keys = [
        "stop_deceleration = 1",
        "following_error = 1",
        "deviation = 1",
        "deviation_s = 1",
        "saturation_s = 1",
        "encoder_lost_s = 1",
        "watchdog_s = 1",
        "brake_release_s = 1",
        "brake_apply_s = 1",
        "line_filter_s = 1",
        "off = []",
        "direct_duty = 1",
        "direct_hold_s = 1",
        "excitation = 1",
        "soft_limits_after_homing = true",
    ];
    for line in keys {
        let key = line.split(' ').next().unwrap();
        let error = limits(line);
        let of_a_loop = [
            "following_error",
            "saturation_s",
            "encoder_lost_s",
            "direct_duty",
            "direct_hold_s",
        ];
        let or = if of_a_loop.contains(&key) {
            ""
        } else {
            " or [axis.steps]"
        };
        let expected = format!(
            "m.toml:16: axis.limits.{key} of axis x: found {key} without [axis.controller]; allowed: {key} on an axis with \
             [axis.controller]{or}, which has a supervisor"
        );
        assert_eq!(error.to_string(), expected);
        let remedy = format!("add [axis.controller], or remove `{key}`");
        assert_eq!(error.problems()[0].remedy, remedy);
    }
    let scale = "[axis.scale]\ncounts_per_unit = 10_000_000\nuse = \"monitor\"\n";
    let expected = "m.toml:73: axis.limits.deviation of axis x: found deviation without [axis.scale]; allowed: deviation on \
                    an axis with [axis.scale], from which the motor may deviate";
    case(scale, "", expected);
    let expected = "m.toml:76: axis.limits.deviation_s of axis x: found deviation_s without deviation; allowed: deviation_s \
                    with deviation, which it lets pass for a time";
    case("deviation = 50e-6\n", "", expected);
    let expected = "m.toml:79: axis.limits.encoder_lost_command of axis x: found encoder_lost_command without encoder_lost_s; \
                    allowed: encoder_lost_command with encoder_lost_s, which switches the monitor on";
    case("encoder_lost_s = 0.02\n", "", expected);
    let expected = "m.toml:86: axis.limits.soft_limits_after_homing of axis x: found soft_limits_after_homing without travel; \
                    allowed: soft_limits_after_homing with travel, which are the soft limits";
    case("travel = [-0.1, 0.1]\n", "", expected);
    let alone = |table: &str| wrong(&format!("{SMALL}{table}")).to_string();
    let expected = "m.toml:15: axis.trace of axis x: found [axis.trace] without [axis.controller]; allowed: a trace with \
                    [axis.controller] or [axis.steps], whose signals it records";
    assert_eq!(alone("[axis.trace]\nsamples = 256\n"), expected);
    let expected = "m.toml:15: axis.scale of axis x: found [axis.scale] without [axis.encoder]; allowed: a scale with \
                    [axis.encoder], the motor's, which it is compared with, or with [axis.steps]";
    assert_eq!(alone(scale), expected);
    let expected = "m.toml:18: axis.scale.use of axis x: found use = \"position\" without [axis.controller]; allowed: \
                    position on an axis with [axis.controller], whose loop it closes; else monitor";
    let position = scale.replace("monitor", "position");
    assert_eq!(alone(&format!("[axis.encoder]\n{position}")), expected);
    right(&format!("{SMALL}[axis.encoder]\n{scale}"));
}
