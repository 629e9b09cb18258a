//! `[axis.encoder]`, `[axis.pwm]`, `[axis.drive]`, `[axis.controller]` and `modulo`: accepted and refused values.

use crate::machine_file::files::{SMALL, breaks, right, wrong};
use posicast_machine::machine_file::{Controller, DriveMode, Encoder, PwmMode};

/// Every block of a torque axis, one key per line; its tables follow those of [`SMALL`].
const BLOCKS: &str = r#"[axis.encoder]
filter_clocks = 8
index = true
[axis.pwm]
mode = "half-bridge"
frequency_hz = 20_000
dead_time_s = 500e-9
minimum_pulse_s = 1.01e-6
active_low = true
[axis.drive]
mode = "torque"
equivalent_mass = 64.274
force_constant = 475.01
current_limit_a = 2.73
full_scale_a = 3.0
bandwidth_hz = 1000.0
viscous = 200.0
coulomb = 40.0
[axis.controller]
kind = "sliding-mode"
c = 150.0
k = 50.0
epsilon = 4.0
boundary = 0.05
"#;

fn with_blocks() -> String {
    format!("{SMALL}{BLOCKS}")
}

#[track_caller]
fn case(from: &str, to: &str, expected: &str) {
    let text = with_blocks();
    assert!(text.contains(from), "{from}");
    assert_eq!(wrong(&text.replace(from, to)).to_string(), expected);
}

#[test]
fn every_block_yields_its_values() {
    let machine = right(&with_blocks());
    let axis = &machine.axes[0];
    assert_eq!(
        axis.encoder,
        Some(Encoder {
            filter_clocks: 8,
            index: true,
            invert: false,
            absolute: None,
        })
    );
    let pwm = axis.pwm.unwrap();
    assert_eq!((pwm.mode, pwm.active_low), (PwmMode::HalfBridge, true));
    assert_eq!(pwm.period_clocks(&machine.clock), 2500);
    // 1.01 µs are 50.5 clocks: rounded up, never below the requested time.
    assert_eq!(
        (
            pwm.dead_time_clocks(&machine.clock),
            pwm.minimum_pulse_clocks(&machine.clock)
        ),
        (25, 51)
    );
    let drive = axis.drive.unwrap();
    let torque = DriveMode::Torque {
        equivalent_mass: 64.274,
        force_constant: 475.01,
        current_limit_a: 2.73,
        full_scale_a: 3.0,
    };
    assert_eq!((drive.mode, drive.bandwidth_hz), (torque, Some(1000.0)));
    assert_eq!((drive.viscous, drive.coulomb), (200.0, 40.0));
    let law = Controller::SlidingMode {
        c: 150.0,
        k: 50.0,
        epsilon: 4.0,
        boundary: 0.05,
    };
    assert_eq!(axis.controller, Some(law));
}

#[test]
fn what_is_left_out_has_its_default() {
    let machine = right(&format!(
        "{SMALL}[axis.encoder]\n[axis.pwm]\nmode = \"direction\"\nfrequency_hz = 10_000\n"
    ));
    let axis = &machine.axes[0];
    assert_eq!(
        axis.encoder,
        Some(Encoder {
            filter_clocks: 0,
            index: false,
            invert: false,
            absolute: None,
        })
    );
    let pwm = axis.pwm.unwrap();
    assert_eq!(
        (pwm.dead_time_s, pwm.minimum_pulse_s, pwm.active_low),
        (0.0, 0.0, false)
    );
    assert_eq!((axis.drive, axis.controller), (None, None));
    let small = right(SMALL);
    assert!(small.axes[0].encoder.is_none() && small.axes[0].pwm.is_none());
}

#[test]
fn the_filter_reaches_as_far_as_the_hardware() {
    let expected = "m.toml:16: axis.encoder.filter_clocks of axis x: found 64; allowed: a whole number, 0 to 63";
    case("filter_clocks = 8", "filter_clocks = 64", expected);
    right(&with_blocks().replace("filter_clocks = 8", "filter_clocks = 63"));
}

#[test]
fn the_pwm_fits_clock_and_sample() {
    let expected = "m.toml:20: axis.pwm.frequency_hz of axis x: found 25_000; allowed: what divides clock.frequency_hz = \
                    50000000 Hz and is a multiple of clock.sample_hz = 10000 Hz; the nearest is 20000";
    case("= 20_000", "= 25_000", expected);
    let short = with_blocks().replace("= 20_000", "= 200_000");
    // 1.48 µs and 1.01 µs are 74 and 51 clocks: in a period of 250 clocks, a leg that is late once would stay late.
    let expected = "m.toml:21: axis.pwm.dead_time_s of axis x: found 250 clocks, twice the dead time and the minimum pulse; \
                    allowed: below 250 clocks, the PWM period";
    assert_eq!(wrong(&short.replace("500e-9", "1.48e-6")).to_string(), expected);
    right(&short.replace("500e-9", "1.46e-6"));
    let expected = "m.toml:21: axis.pwm.dead_time_s of axis x: found 20.47e-6 s, 1024 clocks; allowed: at most 20.46 µs, \
                    the 1023 clocks that the hardware counts to";
    case("500e-9", "20.47e-6", expected);
    let slow = with_blocks().replace("= 20_000", "= 500").replace("10_000", "500");
    let expected = "m.toml:20: axis.pwm.frequency_hz of axis x: found a period of 100000 clocks; allowed: 64 to 65536 clocks: \
                    from 762.939 Hz on";
    assert_eq!(wrong(&slow).to_string(), expected);
    let expected = "m.toml:19: axis.pwm.mode of axis x: found \"bridge\"; allowed: direction, half-bridge, full-bridge, \
                    locked-antiphase";
    case("\"half-bridge\"", "\"bridge\"", expected);
}

#[test]
fn a_drive_has_the_keys_of_its_mode() {
    let expected = "m.toml:28: axis.drive.current_limit_a of axis x: found a current limit of 3.5 A; allowed: at most \
                    full_scale_a = 3 A";
    case("2.73", "3.5", expected);
    let expected = "m.toml:24: axis.drive.full_scale_velocity of axis x: found no such key; allowed: above 0, at most \
                    1e12\nm.toml:29: axis.drive.full_scale_a of axis x: found full_scale_a with mode = \"velocity\"; \
                    allowed: full_scale_a with mode torque, full_scale_velocity with mode velocity";
    case("\"torque\"", "\"velocity\"", expected);
    let text = with_blocks()
        .replace("\"torque\"", "\"velocity\"")
        .replace("full_scale_a = 3.0", "full_scale_velocity = 0.5");
    let velocity = DriveMode::Velocity {
        full_scale_velocity: 0.5,
    };
    assert_eq!(right(&text).axes[0].drive.unwrap().mode, velocity);
}

#[test]
fn a_controller_has_the_gains_of_its_kind() {
    let expected = "m.toml:33: axis.controller.boundary of axis x: found no such key; allowed: above 0, at most 1e12";
    case("boundary = 0.05\n", "", expected);
    let gains = "kind = \"sliding-mode\"\nc = 150.0\nk = 50.0\nepsilon = 4.0\nboundary = 0.05\n";
    let controller = |keys: &str| right(&with_blocks().replace(gains, keys)).axes[0].controller.unwrap();
    let none = Controller::Pd {
        proportional: None,
        derivative: None,
    };
    assert_eq!(controller("kind = \"pd\"\n"), none);
    let given = Controller::Pid {
        proportional: Some(60.0),
        derivative: Some(0.5),
        integral: Some(400.0),
    };
    let keys = "kind = \"pid\"\nproportional = 60.0\nderivative = 0.5\nintegral = 400\n";
    assert_eq!(controller(keys), given);
    let place = "m.toml:35: axis.controller";
    let expected = format!(
        "{place}.integral of axis x: found integral with kind = \"pd\"; allowed: integral with kind = \"pid\" only"
    );
    case(gains, "kind = \"pd\"\nintegral = 400\n", &expected);
    let expected =
        format!("{place}.c of axis x: found c with kind = \"pd\"; allowed: c with kind = \"sliding-mode\" only");
    case(gains, "kind = \"pd\"\nc = 400\n", &expected);
    let expected = "m.toml:39: axis.controller.derivative of axis x: found derivative with kind = \"sliding-mode\"; allowed: \
                    derivative with kind = \"pd\" or \"pid\" only";
    case("boundary = 0.05\n", "boundary = 0.05\nderivative = 1.0\n", expected);
    let expected = format!("{place}.proportional of axis x: found 0; allowed: above 0, at most 1e12");
    case(gains, "kind = \"pid\"\nproportional = 0\n", &expected);
}

#[test]
fn blocks_that_need_each_other_say_what_to_add() {
    let without = |names: &[&str]| {
        let tables = BLOCKS.split("[axis.").skip(1);
        let kept = tables.filter(|table| !names.iter().any(|name| table.starts_with(name)));
        SMALL.to_owned() + &kept.map(|table| format!("[axis.{table}")).collect::<String>()
    };
    let allowed =
        "a controller with [axis.encoder], [axis.pwm] and [axis.drive]: the position, the pins, and what they command";
    let error = wrong(&without(&["drive"]));
    let expected = format!(
        "m.toml:24: axis.controller of axis x: found [axis.controller] without [axis.drive]; allowed: {allowed}"
    );
    assert_eq!(error.to_string(), expected);
    assert_eq!(
        error.problems()[0].remedy,
        "add [axis.drive], or remove [axis.controller]"
    );
    let error = wrong(&without(&["encoder", "pwm"]));
    let expected = format!(
        "m.toml:15: axis.drive of axis x: found [axis.drive] without [axis.pwm]; allowed: a drive with its [axis.pwm], which \
         commands it\nm.toml:24: axis.controller of axis x: found [axis.controller] without [axis.encoder] and [axis.pwm]; \
         allowed: {allowed}"
    );
    assert_eq!(error.to_string(), expected);
    right(&without(&["controller"]));
    right(&without(&["encoder", "controller"]));
    right(&without(&["pwm", "drive", "controller"]));
}

#[test]
fn a_modulo_axis_wraps_and_has_words_of_18_bits_or_more() {
    let modulo = |bits: &str, value: &str| {
        let to = format!("1_000_000\nmodulo = {value}");
        SMALL.replace("1_000_000", &to).replace("32", bits)
    };
    assert!(right(&modulo("32", "true")).axes[0].modulo && right(&modulo("18", "true")).axes[0].modulo);
    assert!(!right(&modulo("16", "false")).axes[0].modulo && !right(SMALL).axes[0].modulo);
    let error = wrong(&modulo("17", "true"));
    assert_eq!(
        error.to_string(),
        "m.toml:10: axis.modulo of axis x: found modulo = true with command words of 17 bits; allowed: modulo = true with \
         fixed_point.command_bits = 18 to 32"
    );
    assert_eq!(error.problems()[0].remedy, "set fixed_point.command_bits = 18");
    breaks(
        "1_000_000",
        "1_000_000\nmodulo = 1",
        "m.toml:10: axis.modulo of axis x: found the integer 1; allowed: true or false",
    );
    // Any travel fits a word that wraps.
    right(&(modulo("24", "true") + "[axis.limits]\ntravel = [-100.0, 100.0]\n"));
}

#[test]
fn a_cascade_needs_vibrationless_axes_that_have_shapers_alone() {
    let vibrationless = SMALL.replace("kind = \"zvd\"", "kind = \"vibrationless\"\nstructure = \"cascade\"");
    assert!(right(&vibrationless).axes[0].shaped().is_cascade());
    assert!(!right(SMALL).axes[0].shaped().is_cascade());
    let found = |text: &str| wrong(text).to_string();
    let other = found(&SMALL.replace("kind = \"zvd\"", "kind = \"zvd\"\nstructure = \"cascade\""));
    assert!(other.contains("found structure = \"cascade\" with kind zvd"), "{other}");
    let mixed = found(&format!("{vibrationless}shaper = \"zv\"\n"));
    assert!(mixed.contains("found structure = \"cascade\" with kind zv;"), "{mixed}");
    let measured = found(&format!("{vibrationless}[axis.encoder]\n"));
    assert!(
        measured.contains("found structure = \"cascade\" on an axis with `encoder`"),
        "{measured}"
    );
    let stage = found(&format!("{vibrationless}[stage]\n"));
    assert!(
        stage.contains("stage: found axis x with structure = \"cascade\" beside [stage]"),
        "{stage}"
    );
    let word = found(&vibrationless.replace("\"cascade\"", "\"fir\""));
    assert!(word.contains("structure"), "{word}");
}
