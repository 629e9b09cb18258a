//! Errors of keys that are each valid but contradict each other.

use crate::machine_file::files::{SMALL, breaks, kinds, right, wrong};

#[test]
fn the_sample_rate_divides_the_clock_and_the_message_names_the_nearest() {
    let case = |sample: &str, nearest: &str| {
        let expected = format!(
            "m.toml:4: clock.sample_hz: found {sample}; allowed: what divides clock.frequency_hz = 50000000 Hz a whole \
             number of times; the nearest is {nearest}"
        );
        breaks("10_000", sample, &expected);
        for named in nearest.split(", in whole hertz ") {
            right(&SMALL.replace("10_000", named));
        }
    };
    case("10_001", "10000");
    case("15_000", "15001.50015, in whole hertz 15625");
    case("9_999", "9998.00039992, in whole hertz 10000");
    case("60_000_000", "50000000");
    case("30_000_000", "25000000");
    let expected = "m.toml:4: clock.sample_hz: found 10; allowed: at least 50 Hz, a sample of at most 1000000 clocks";
    breaks("10_000", "10", expected);
}

#[test]
fn a_mode_at_or_above_half_the_sample_rate_is_refused() {
    let place = "m.toml:13: axis.mode.frequency_hz of axis x, mode 1";
    for value in ["5000", "5000.1", "1e8"] {
        let expected = format!("{place}: found {value}; allowed: below 5000 Hz, half of clock.sample_hz");
        breaks("40.0", value, &expected);
    }
    right(&SMALL.replace("40.0", "4999.9"));
    let expected = "m.toml:13: axis.mode.damped_frequency_hz of axis x, mode 1: found 4990, an undamped frequency of \
                    5015.14 Hz; allowed: below 5000 Hz, half of clock.sample_hz";
    breaks("frequency_hz = 40.0", "damped_frequency_hz = 4990", expected);
}

#[test]
fn one_of_the_two_frequencies_is_given() {
    let expected = "m.toml:14: axis.mode.damped_frequency_hz of axis x, mode 1: found both frequency_hz and \
                    damped_frequency_hz; allowed: one of the two";
    breaks(
        "frequency_hz = 40.0",
        "frequency_hz = 40.0\ndamped_frequency_hz = 39.0",
        expected,
    );
    let expected = "m.toml:12: axis.mode.frequency_hz of axis x, mode 1: found no such key; allowed: at least 0.001, at most \
                    1e9 Hz, or damped_frequency_hz or points in its place";
    breaks("frequency_hz = 40.0\n", "", expected);
}

#[test]
fn an_axis_has_modes_and_each_has_a_shaper() {
    let modes = "[[axis.mode]]\nfrequency_hz = 40.0\ndamping = 0.1\n";
    let expected = "m.toml:7: axis.mode of axis x: found an axis without modes; allowed: at least one [[axis.mode]], except \
                    with kind custom or none";
    breaks(modes, "", expected);
    right(&SMALL.replace(modes, "").replace("zvd", "none"));
    let expected = "m.toml:7: axis.shaper of axis x: found no [axis.shaper], and a mode without `shaper`; allowed: \
                    [axis.shaper], or `shaper` in every [[axis.mode]]";
    breaks("[axis.shaper]\nkind = \"zvd\"\n", "", expected);
    let nine = modes.repeat(9);
    let expected = "m.toml:12: axis.mode of axis x: found 9 tables; allowed: 1 to 8 tables [[axis.mode]]";
    breaks(modes, &nine, expected);
    let expected = "m.toml:12: axis.mode of axis x: found participation 0 in every mode; allowed: at least one mode with a \
                    participation above 0";
    breaks("damping = 0.1", "damping = 0.1\nparticipation = 0.0", expected);
}

#[test]
fn a_modes_own_shaper_serves_one_mode() {
    let expected = format!(
        "m.toml:15: axis.mode.shaper of axis x, mode 1: found shaper = \"custom\", which serves an axis and not one mode; \
         allowed: {}",
        kinds(|kind| !kind.treats_modes_together())
    );
    breaks("damping = 0.1", "damping = 0.1\nshaper = \"custom\"", &expected);
    let text = SMALL
        .replace("damping = 0.1", "damping = 0.1\nshaper = \"zv\"")
        .replace("\"zvd\"", "\"none\"");
    let expected = "m.toml:15: axis.mode.shaper of axis x, mode 1: found shaper = \"zv\" under kind = \"none\", which would \
                    ignore it; allowed: no `shaper` in a mode under kind = \"none\"";
    assert_eq!(wrong(&text).to_string(), expected);
}

#[test]
fn keys_of_other_kinds_are_refused() {
    let expected =
        "m.toml:12: axis.shaper.method of axis x: found method with kind zvd; allowed: method with kind antisymmetric";
    breaks("\"zvd\"", "\"zvd\"\nmethod = \"exact\"", expected);
    let expected = "m.toml:15: axis.mode.order of axis x, mode 1: found order with kind zvd; allowed: order with kind \
                    chebyshev-ei, vibrationless";
    breaks("damping = 0.1", "damping = 0.1\norder = 2", expected);
    let periodic = |base: &str| SMALL.replace("\"zvd\"", &format!("\"periodic\"\nbase = \"{base}\"\norder = 2"));
    right(&periodic("chebyshev-ei"));
    let expected = "m.toml:13: axis.shaper.order of axis x: found order with kind periodic, multi-ei; allowed: order with \
                    kind chebyshev-ei, vibrationless";
    assert_eq!(wrong(&periodic("multi-ei")).to_string(), expected);
    let expected = "m.toml:12: axis.shaper.impulses of axis x: found impulses with kind = \"zvd\"; allowed: impulses with \
                    kind = \"custom\" only";
    breaks("\"zvd\"", "\"zvd\"\nimpulses = [[0, 1]]", expected);
}

#[test]
fn the_impulses_of_custom_start_at_zero_increase_and_sum_to_one() {
    let key = "axis.shaper.impulses of axis x";
    let case = |impulses: &str, problem: &str| {
        let to = format!("\"custom\"\nimpulses = {impulses}");
        breaks("\"zvd\"", &to, &format!("m.toml:12: {key}: {problem}"));
    };
    case(
        "[[0.1, 1.0]]",
        "found a first impulse at 0.1 s; allowed: a first impulse at 0 s",
    );
    let times = "found an impulse at 0.1 s after one at 0.1 s; allowed: times that increase from impulse to impulse";
    case("[[0, 0.5], [0.1, 0.25], [0.1, 0.25]]", times);
    case(
        "[[0, 0.5], [0.1, 0.49]]",
        "found amplitudes with the sum 0.99; allowed: amplitudes with the sum 1, within 1e-9",
    );
    let rows = "allowed: a list of 1 to 256 pairs [time_s, amplitude], each number at least -65535, at most 65535";
    case("[]", &format!("found the array []; {rows}"));
    for row in ["[0, nan]", "[0, 1, 2]", "[0]", "[0, \"1\"]"] {
        case(&format!("[{row}]"), &format!("found the array {row}; {rows}"));
    }
    case("[0, 1]", &format!("found the integer 0; {rows}"));
    right(&SMALL.replace("\"zvd\"", "\"custom\"\nimpulses = [[0, 2], [0.1, -1.0000000001]]"));
    let expected = "m.toml:10: axis.shaper.impulses of axis x: found no such key; allowed: a list of 1 to 256 pairs [time_s, \
                    amplitude]";
    breaks("\"zvd\"", "\"custom\"", expected);
}

#[test]
fn the_travel_fits_the_position_word_or_the_next_size_is_named() {
    let limits = |bits: &str, travel: &str| format!("{}[axis.limits]\ntravel = {travel}\n", SMALL.replace("32", bits));
    let place = "m.toml:16: axis.limits.travel of axis x";
    let expected = format!(
        "{place}: found a travel of up to 50000 counts; allowed: at most 32767 counts in 24 bits \
                            with 8 fraction bits; set fixed_point.command_bits = 25"
    );
    assert_eq!(wrong(&limits("24", "[-0.05, 0.01]")).to_string(), expected);
    let expected = format!(
        "{place}: found a travel of up to 10000000 counts; allowed: at most 8388607 counts in 32 \
                            bits with 8 fraction bits; set fixed_point.command_fraction = 7"
    );
    assert_eq!(wrong(&limits("32", "[0.0, 10.0]")).to_string(), expected);
    let expected = format!("{place}: found [0.1, -0.1]; allowed: [low, high] with low below high");
    assert_eq!(wrong(&limits("32", "[0.1, -0.1]")).to_string(), expected);
    assert_eq!(
        right(&limits("24", "[-0.03, 0.03]")).axes[0].limits.unwrap().travel,
        Some([-0.03, 0.03])
    );
}

#[test]
fn a_command_is_positive_or_has_bounds_round_its_end() {
    let optimal = |more: &str| SMALL.replace("\"zvd\"", &format!("\"optimal\"\n{more}"));
    for right_one in [
        "command = \"positive\"",
        "command = [-1, 1]",
        "command = [0, 1.2]",
        "taps = 256",
        "prefer = \"least-delay\"",
        "amplitude_bounds = [0, 0.3]",
        "amplitude_bounds = [-0.5, 1.5]",
    ] {
        right(&optimal(right_one));
    }
    let place = "m.toml:12: axis.shaper.command of axis x";
    for (command, found) in [
        ("[0.5, 0.9]", "[0.5, 0.9]"),
        ("[1.1, 2]", "[1.1, 2]"),
        ("[1, 1]", "[1, 1]"),
    ] {
        let expected = format!(
            "{place}: found {found}; allowed: [low, high] with low below high, low at most 1 and high at least 1, where a step ends"
        );
        assert_eq!(wrong(&optimal(&format!("command = {command}"))).to_string(), expected);
    }
    for bounds in ["[0.1, 0.5]", "[-1, 0]"] {
        let expected = format!(
            "m.toml:12: axis.shaper.amplitude_bounds of axis x: found {bounds}; allowed: [low, high] with low at most 0 and high above 0"
        );
        assert_eq!(
            wrong(&optimal(&format!("amplitude_bounds = {bounds}"))).to_string(),
            expected
        );
    }
    let both = wrong(&optimal("amplitude_bounds = [0, 0.3]\ncommand = \"positive\"")).to_string();
    assert!(both.contains("allowed: one of amplitude_bounds and command"), "{both}");
    let expected = format!("{place}: found \"negative\"; allowed: positive");
    assert_eq!(wrong(&optimal("command = \"negative\"")).to_string(), expected);
    let expected = "m.toml:12: axis.shaper.taps of axis x: found 1; allowed: a whole number, 2 to 256";
    assert_eq!(wrong(&optimal("taps = 1")).to_string(), expected);
    let expected = "m.toml:12: axis.shaper.taps of axis x: found taps with kind zvd; allowed: taps with kind optimal";
    assert_eq!(
        wrong(&SMALL.replace("\"zvd\"", "\"zvd\"\ntaps = 4")).to_string(),
        expected
    );
}

#[test]
fn axes_that_arrive_together_all_have_optimal_shapers() {
    let together = |kind: &str| SMALL.replace("\"zvd\"", kind) + "[stage]\narrive_together = true\n";
    assert!(right(&together("\"optimal\"")).stage.unwrap().arrive_together);
    let error = wrong(&together("\"zvd\"")).to_string();
    assert!(
        error.contains(
            "stage.arrive_together: found arrive_together with axis x of kind zvd; allowed: kind = \"optimal\""
        ),
        "{error}"
    );
}

#[test]
fn the_bands_of_a_mode_hold_it_and_end_below_half_the_sample_rate() {
    let banded = |more: &str| SMALL.replace("damping = 0.1", &format!("damping = 0.1\n{more}"));
    right(&banded("frequency_band = 0.2\ndamping_band = [0.05, 0.1]"));
    let expected = "m.toml:15: axis.mode.damping_band of axis x, mode 1: found [0.2, 0.3]; allowed: [low, high] with the damping of \
                    0.1 between them";
    assert_eq!(wrong(&banded("damping_band = [0.2, 0.3]")).to_string(), expected);
    let expected = "m.toml:15: axis.mode.frequency_band of axis x, mode 1: found 1; allowed: at least 0, below 1";
    assert_eq!(wrong(&banded("frequency_band = 1")).to_string(), expected);
    let high = banded("frequency_band = 0.3").replace("40.0", "4000");
    let expected = "m.toml:15: axis.mode.frequency_band of axis x, mode 1: found 0.3, a band up to 5200 Hz; allowed: a band that ends \
                    below 5000 Hz, half of clock.sample_hz";
    assert_eq!(wrong(&high).to_string(), expected);
}
