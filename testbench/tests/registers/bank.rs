//! Tests the register bank alone, with every kind of access in one map.

use crate::registers::everything::everything;
use crate::registers::support::{Bench, assert_match};
use posicast_blocks::registers::RegisterBank;
use posicast_hdl::registers::emit;
use posicast_testbench::lockstep::report::LockstepVerdict;
use posicast_testbench::registers::{RegistersCoverage, RegistersRandom};

fn bench(from: &str, to: &str) -> Bench {
    Bench::new("registers", &[emit(&everything(), "").unwrap()], from, to)
}

#[test]
fn lockstep_a_million_random_clocks() {
    let (map, bench) = (everything(), bench("", ""));
    bench.assert_clean();
    let mut coverage = RegistersCoverage::new(&map);
    let report = bench.run(
        &mut RegisterBank::new(&map),
        &mut bench.verilated(),
        &mut RegistersRandom::new(&map, map.ports(), 1),
        1_000_000,
        &mut |clock| coverage.observe(clock.inputs),
    );
    assert_match(&report);
    assert_eq!(coverage.missing(), [""; 0]);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let (map, bench) = (everything(), bench("", ""));
    let report = bench.run(
        &mut RegisterBank::new(&map),
        &mut bench.icarus(),
        &mut RegistersRandom::new(&map, map.ports(), 2),
        20_000,
        &mut |_| {},
    );
    assert_match(&report);
}

/// Breaks the Verilog and requires a mismatch.
fn caught(from: &str, to: &str) {
    let (map, bench) = (everything(), bench(from, to));
    let report = bench.run(
        &mut RegisterBank::new(&map),
        &mut bench.verilated(),
        &mut RegistersRandom::new(&map, map.ports(), 3),
        100_000,
        &mut |_| {},
    );
    assert_eq!(report.result, LockstepVerdict::Mismatch, "`{to}` is not found");
}

#[test]
fn lockstep_catches_a_clear_that_wins_over_a_set() {
    caught(
        "flag_fault <= fault || (flag_fault && !(write_flags && written[0]))",
        "flag_fault <= (fault || flag_fault) && !(write_flags && written[0])",
    );
}

#[test]
fn lockstep_catches_a_command_that_takes_a_part() {
    caught("start <= !rst && write_start && whole", "start <= !rst && write_start");
}

#[test]
fn lockstep_catches_staging_words_that_move_while_a_commit_waits() {
    caught(
        "if (write_gain && !waits && avs_byteenable[0])",
        "if (write_gain && avs_byteenable[0])",
    );
}

#[test]
fn lockstep_catches_a_floor_one_too_low() {
    caught(">= 10'd25", ">= 10'd24");
}

#[test]
fn lockstep_catches_a_missing_byte_enable() {
    caught("if (write_mode && avs_byteenable[1])", "if (write_mode)");
}

#[test]
fn lockstep_catches_a_shadow_of_another_word() {
    caught("shadow_phase <= phase", "shadow_phase <= position[5:0]");
}
