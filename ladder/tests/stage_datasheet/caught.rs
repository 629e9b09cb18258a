//! Wrong wires of a composition: a check must find each of them. In a stage's description they would be in model and Verilog alike.

use std::panic::{AssertUnwindSafe, catch_unwind};

use posicast_ladder::mutation::{WireMutant, with_wires};

use super::bed::{Bed, modules};
use super::checks::CHECKS;

/// Axis, part and port, the wire, and the wrong one.
const WRONG: [(&str, [&str; 2], &str, &str); 14] = [
    (
        "y",
        ["axis", "reference_position"],
        "shaped_position",
        "command_position",
    ),
    ("x", ["axis", "limit_plus_n"], "limit_plus_n", "limit_minus_n"),
    ("x", ["sliding_mode", "position"], "captured_position", "count"),
    ("y", ["sliding_mode", "position"], "captured_position", "user_position"),
    ("x", ["axis", "error"], "error", "following_error_limit"),
    ("", ["y", "group_stop"], "y_group_stop", "x_group_stop"),
    ("", ["y", "axis_start"], "y_axis_start", "x_axis_start"),
    ("", ["y", "a"], "y_a", "x_a"),
    ("", ["y", "quotient_valid"], "y_quotient_valid", "x_quotient_valid"),
    ("", ["y", "fault_n"], "y_fault_n", "x_fault_n"),
    ("", ["y", "trigger_phase"], "y_trigger_phase", "x_trigger_phase"),
    ("", ["y", "preset_value"], "y_preset_value", "x_preset_value"),
    ("", ["x", "direct_duty"], "x_direct_duty", "y_direct_duty"),
    ("", ["registers", "y_index_seen"], "y_index_seen", "x_index_seen"),
];

#[test]
fn long_the_bench_of_the_data_sheets_finds_each_wrong_wire() {
    let mutant = |(axis, port, from, to): &(&str, [&str; 2], &str, &str)| WireMutant::exchange(axis, *port, from, to);
    let mutants: Vec<WireMutant> = WRONG.iter().map(mutant).collect();
    let modules = with_wires(&modules(), &mutants).unwrap();
    let mut unseen = Vec::new();
    for (number, mutant) in (1..).zip(&mutants) {
        let fails = |check: fn(&mut Bed)| {
            let mut bed = Bed::new(&modules);
            bed.set("mutsel", number);
            catch_unwind(AssertUnwindSafe(|| check(&mut bed))).is_err()
        };
        if !CHECKS.iter().any(|(_, check)| fails(*check)) {
            unseen.push(mutant.describe());
        }
    }
    assert_eq!(unseen, [""; 0]);
}
