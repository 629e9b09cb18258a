//! `[axis.encoder]` with an absolute encoder: values, defaults, what the hardware gets, and what is refused with which message.

use posicast_blocks::absolute_encoder::{
    AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, FrameCheck, FrameStatusBit,
};
use posicast_machine::hardware::Hardware;
use posicast_machine::plan::design_machine;

use super::files::{right, wrong};

const ARM: &str = include_str!("../../../../examples/measuring-arm.toml");

/// The first axis with these keys in place of its `kind`.
fn with(keys: &str) -> String {
    ARM.replacen("kind = \"biss_c\"", keys, 1)
}

/// Expects this in the message of the file with a change, and this in the remedy.
#[track_caller]
fn case(from: &str, to: &str, expected: &str, remedy: &str) {
    assert!(ARM.contains(from), "{from}");
    let error = wrong(&ARM.replacen(from, to, 1));
    assert!(error.to_string().contains(expected), "{error}");
    let found = &error.problems()[0].remedy;
    assert!(found.contains(remedy), "{found}");
}

#[test]
fn the_hardware_gets_clocks_and_counts() {
    let machine = right(ARM);
    let design = design_machine(&machine).unwrap();
    let hardware = Hardware::of(&machine, &design).unwrap();
    let stage = hardware.stage().unwrap().unwrap();
    let [arm, column] = [0, 1].map(|axis| *stage.of_machine.config.axes[axis].absolute().unwrap());
    assert_eq!(arm.encoder.protocol(), AbsoluteProtocol::BissC);
    assert_eq!(*arm.encoder.frame(), AbsoluteFrame::biss_c(26));
    let times = AbsoluteTimes {
        half_period_clocks: 5,
        pause_clocks: 1250,
        answer_clocks: 750,
    };
    assert_eq!(arm.encoder.times(), times);
    // 200 mm/s are 200 counts in a tick: twice that, and 8.
    let limits = AbsoluteLimits {
        largest_jump: 408,
        tolerated: 2,
    };
    assert_eq!(arm.encoder.limits(), limits);
    assert_eq!((arm.offset, column.offset), (33_554_432, 20_000_000));
    let invert = |axis: usize| stage.of_machine.config.axes[axis].closed_loop().unwrap().encoder_invert;
    assert_eq!([0, 1].map(invert), [false, true]);
    // The answer, 34 bits, the start bit and four clocks; then two to count and velocity. The shaper needs less.
    assert_eq!(stage.of_machine.config.timing().control_clocks(), 750 + 35 * 10 + 4 + 2);
}

#[test]
fn ssi_has_its_own_keys() {
    let keys = "kind = \"ssi\"\nturns_bits = 3\ncoding = \"gray\"\nparity = \"even\"\nleading_bits = 2\ntrailing_bits = 3\n\
                error_bit = 2\nerror_level = \"low\"\ntolerated = 4";
    let text = with(keys)
        .replacen("answer_s = 15e-6                      #", "#", 1)
        .replacen("clock_hz = 5_000_000", "clock_hz = 1_000_000", 1);
    let encoder = right(&text).axes[0].encoder.unwrap().absolute.unwrap();
    let expected = AbsoluteFrame {
        leading_bits: 2,
        trailing_bits: 3,
        gray: true,
        check: FrameCheck::EvenParity,
        error: Some(FrameStatusBit {
            place: 1,
            active_low: true,
        }),
        ..AbsoluteFrame::ssi(29)
    };
    assert_eq!((encoder.frame, encoder.tolerated), (expected, 4));
    assert_eq!(encoder.protocol, AbsoluteProtocol::Ssi);
}

#[test]
fn an_error_bit_of_ssi_is_one_of_the_trailing_bits() {
    for (keys, found, allowed, remedy) in [
        (
            "error_bit = 2",
            "error_bit = 2 with trailing_bits = 1",
            "one of the trailing bits, the first behind the position being 1",
            "correct `error_bit`, or raise `trailing_bits`",
        ),
        (
            "error_level = \"low\"",
            "error_level = \"low\" without error_bit",
            "error_level beside error_bit, whose level it is",
            "add `error_bit`, or remove `error_level`",
        ),
    ] {
        let text = with(&format!("kind = \"ssi\"\ntrailing_bits = 1\n{keys}"));
        let error = wrong(&text.replacen("answer_s = 15e-6                      #", "#", 1));
        let problem = &error.problems()[0];
        assert_eq!(problem.cause.to_string(), format!("found {found}; allowed: {allowed}"));
        assert_eq!(problem.remedy, remedy);
    }
}

#[test]
fn keys_of_another_kind_are_refused() {
    case(
        "kind = \"biss_c\"",
        "kind = \"quadrature\"",
        "axis.encoder.bits of axis arm: found bits with kind = \"quadrature\"; allowed: bits with kind = \"ssi\" or \"biss_c\"",
        "remove `bits`, or change `kind`",
    );
    case(
        "kind = \"biss_c\"",
        "kind = \"biss_c\"\nindex = true",
        "found index with kind = \"biss_c\"; allowed: index with kind = \"quadrature\"",
        "remove `index`",
    );
    case(
        "kind = \"biss_c\"",
        "kind = \"biss_c\"\nparity = \"odd\"",
        "found parity with kind = \"biss_c\"; allowed: parity with kind = \"ssi\"",
        "remove `parity`",
    );
    case(
        "kind = \"biss_c\"",
        "kind = \"ssi\"",
        "answer_s with kind = \"ssi\"; allowed: answer_s with kind = \"biss_c\"",
        "",
    );
    case("kind = \"biss_c\"", "kind = \"biss\"", "found \"biss\"", "biss_c");
    case(
        "bits = 26 ",
        "# bits = 26 ",
        "axis.encoder.bits of axis arm: found no such key; allowed: a whole number, 1 to 40",
        "",
    );
}

#[test]
fn readings_that_do_not_fit_the_tick_are_refused() {
    case(
        "clock_hz = 5_000_000",
        "clock_hz = 500_000",
        "found a reading of 34 bits at 500000 Hz, which takes",
        "raise `clock_hz`, lower `pause_s` or `answer_s`, or lower clock.sample_hz",
    );
    case(
        "clock_hz = 5_000_000",
        "clock_hz = 1_000",
        "`half period` takes 25000 clocks",
        "check its unit, Hz",
    );
    case(
        "pause_s = 25e-6",
        "pause_s = 25e-3",
        "`pause` takes 1250000 clocks",
        "data sheet",
    );
}

#[test]
fn a_range_that_does_not_tell_where_the_axis_is_is_refused() {
    // 22 bits are 419 mm, and the travel 600.
    case(
        "bits = 26 ",
        "bits = 22 ",
        "found a position of 22 bits, which tells -209.715 mm to 209.715 mm apart, with limits.travel from -300.000 mm to 300.000 mm",
        "raise `turns_bits`, or let the axis's zero and `offset` be in the middle of the travel",
    );
    // Without a travel the whole range must fit the position word.
    case(
        "travel = [-300, 300] ",
        "# travel ",
        "a position of 26 bits, ±33554432 counts, without limits.travel; allowed: at most ±8388607 counts",
        "add `travel`",
    );
}

#[test]
fn a_position_that_changes_by_half_its_range_is_refused() {
    let text =
        ARM.replacen("bits = 26 ", "bits = 9 ", 1)
            .replacen("travel = [-300, 300] ", "travel = [-0.02, 0.02] #", 1);
    let error = wrong(&text);
    assert!(
        error.to_string().contains("a jump of 408 counts over 3 readings"),
        "{error}"
    );
}

#[test]
fn what_cannot_be_beside_it_is_refused() {
    case(
        "velocity = 200 ",
        "# velocity = 200 ",
        "kind = \"biss_c\" without limits.velocity",
        "add `velocity`",
    );
    case(
        "watchdog_s = 0.5",
        "watchdog_s = 0.5\noff = [\"following-error\"]",
        "with a list limits.off without \"encoder-error\"",
        "add \"encoder-error\"",
    );
    case(
        "watchdog_s = 0.5",
        "watchdog_s = 0.5\nsoft_limits_after_homing = true",
        "an absolute encoder needs no homing",
        "remove `soft_limits_after_homing`",
    );
    case(
        "[axis.pwm]",
        "[axis.scale]\ncounts_per_unit = 20_000\nuse = \"monitor\"\n[axis.pwm]",
        "[axis.scale] beside an absolute encoder",
        "remove [axis.scale]",
    );
    case(
        "[axis.pwm]",
        "[axis.compare]\nspacing = 0.01\npositions = 3\npulse_s = 1e-6\n[axis.pwm]",
        "[axis.compare] beside an absolute encoder",
        "remove [axis.compare]",
    );
}
