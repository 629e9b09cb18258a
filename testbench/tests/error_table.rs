//! The error table's Verilog against its bit-exact model, every output in every clock.

use crate::support;

use posicast_blocks::error_table::{ErrorTable, FULL_WEIGHT, Inputs};
use posicast_testbench::blocks;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::error_table::ErrorTableBlock;
use posicast_testbench::lockstep::TwoValued;
use support::{caught, icarus_agrees, million_random_clocks};

fn block() -> ErrorTableBlock {
    ErrorTableBlock::new(ErrorTableBlock::of_size(9, 6).unwrap(), "", "9 entries")
}

/// The directed scenes reach everything, so any seed will do.
#[test]
fn lockstep_a_million_random_clocks() {
    for seed in [1, 2] {
        million_random_clocks(&block(), seed, 3);
    }
}

#[test]
fn lockstep_a_million_random_clocks_of_a_full_table() {
    let config = ErrorTableBlock::of_size(256, 12).unwrap();
    million_random_clocks(&ErrorTableBlock::new(config, "", "256 entries"), 3, 3);
}

/// The scenes do so on any seed and for every number of entries. The model runs beside itself, so this tests the stimuli alone.
#[test]
fn the_scenes_reach_everything_on_any_seed() {
    for (entries, spacing_bits) in [(2, 4), (9, 6), (256, 12)] {
        let config = ErrorTableBlock::of_size(entries, spacing_bits).unwrap();
        let block = ErrorTableBlock::new(config, "", "alone");
        for seed in 0..20 {
            let mut twin = TwoValued(block.model(seed));
            let run = blocks::compare(&block, &mut twin, 150_000, seed, &mut |_| {}).unwrap();
            assert_eq!(
                run.rare(3),
                [""; 0],
                "{entries} entries, seed {seed}: {:?}",
                run.coverage
            );
        }
    }
}

/// What `docs/error_table.md` says of positions that are far from the table: its ends hold up to where a place comes round.
#[test]
fn the_ends_of_a_table_hold_until_the_position_comes_round() {
    let config = ErrorTableBlock::of_size(9, 6).unwrap();
    let (first, last) = (config.entries()[0], config.entries()[8]);
    assert!(first != last && config.format().first_counts == -100);
    let on = Inputs {
        on_measured: true,
        drive_enable: true,
        homed: true,
        error_enable: true,
        ..Inputs::default()
    };
    let mut table = ErrorTable::new(&config);
    let mut error_at = |measured: i32, passes: u16| {
        let on = Inputs { measured, ..on };
        for _ in 0..passes {
            table.step(&Inputs { valid: true, ..on });
            (0..config.latency_clocks()).for_each(|_| {
                table.step(&on);
            });
        }
        table.outputs().table_error
    };
    error_at(0, FULL_WEIGHT);
    for (measured, error) in [
        (i32::MIN, first),
        (-(1 << 30), first),
        (1 << 30, last),
        (i32::MAX - 100, last),
        (i32::MAX - 99, first),
        (i32::MAX, first),
    ] {
        assert_eq!(error_at(measured, 1), error, "{measured}");
    }
}

/// Neighbours that may differ by anything: no comparison is constant.
#[test]
fn the_widest_spacing_is_lint_clean() {
    let config = ErrorTableBlock::of_size(4, 20).unwrap();
    let block = ErrorTableBlock::new(config, "", "4 entries");
    assert_eq!(Sources::write(&block).unwrap().lint(&block).unwrap(), [""; 0]);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&block());
}

#[test]
fn lockstep_catches_an_average_that_is_not_rounded() {
    caught(&block(), "rounded = average + half", "rounded = average", 200_000);
}

#[test]
fn lockstep_catches_a_neighbour_behind_the_last_entry() {
    caught(&block(), "!beyond & (index < LAST)", "!beyond", 200_000);
}

#[test]
fn lockstep_catches_an_origin_that_jumps() {
    caught(&block(), "if (off) begin", "if (off | ~homed) begin", 300_000);
}

#[test]
fn lockstep_catches_a_bank_that_is_written_while_in_use() {
    caught(&block(), "(loaded & !off)", "(loaded & off)", 300_000);
}

#[test]
fn lockstep_catches_a_step_that_is_too_steep_by_one() {
    caught(&block(), "step <= MOST_STEP", "step <= MOST_STEP + 20'sd1", 300_000);
}

#[test]
fn lockstep_catches_a_sum_that_wraps() {
    caught(
        &block(),
        "beyond = sum_bits[32] ^ sum_bits[31]",
        "beyond = sum_bits[32] & ~sum_bits[32]",
        300_000,
    );
}
