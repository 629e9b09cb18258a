//! The error table's Verilog against its bit-exact model, every output in every clock.

use posicast_blocks::error_table::{ErrorTable, FULL_WEIGHT, Inputs};
use posicast_testbench::blocks;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::error_table::ErrorTableBlock;
use posicast_testbench::lockstep::TwoValued;

/// The scenes do so on any seed and for every number of entries. The model runs beside itself, so this tests the stimuli alone.
#[test]
fn the_scenes_reach_everything_on_any_seed() {
    for (entries, spacing_bits) in [(2, 4), (9, 6), (256, 12)] {
        let config = ErrorTableBlock::of_size(entries, spacing_bits).unwrap();
        let block = ErrorTableBlock::new(config, "", "alone");
        for seed in 0..5 {
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

/// `docs/error_table.md`, positions far from the table: the values at its ends hold until the position word wraps around.
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
