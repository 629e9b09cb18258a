//! The error table in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::error_table::{EntryUnit, ErrorTable, ErrorTableConfig, ErrorTableFormat, OUTPUT_PORTS, ports};
use posicast_hdl::error_table::{emit, simulate};
use random::Random;

fn config() -> ErrorTableConfig {
    let format = ErrorTableFormat {
        first_counts: -40,
        spacing_bits: 4,
        unit: EntryUnit::Fine,
    };
    ErrorTableConfig::new(format, vec![0, 200, -56, -300, -100]).unwrap()
}

#[test]
fn lockstep_everything_at_random() {
    let config = config();
    let mut model = ErrorTable::new(&config);
    let mut rusthdl = simulate(&config).unwrap();
    let mut random = Random(4);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut index = 0;
    let mut errors = 0;
    for clock in 0..60_000 {
        let on = u64::from(clock % 20_000 < 15_000);
        let write = random.once_in(30);
        let inputs = [
            u64::from(clock < 2 || random.once_in(20_000)),
            u64::from(random.once_in(90)),
            (random.below(120 << 8) as i64 - (60 << 8)) as u64 & 0xffff_ffff,
            (random.below(120) as i64 - 60) as u64 & 0xffff_ffff,
            u64::from(clock >= 30_000),
            0,
            random.below(3),
            on,
            on,
            on,
            (clock / 10_000) & 1,
            u64::from(write),
            u64::from(!random.once_in(9)),
            index,
            (random.below(300) as i64 - 150) as u64 & 0x3_ffff,
            u64::from(random.once_in(20)),
        ];
        index = if write { random.below(7).min(index + 1) } else { index };
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        errors += u64::from(expected[2] != 0);
    }
    assert!(errors > 1000, "{errors} clocks with an error");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit(&config(), "stage_x").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (6, "stage_x_error_table"));
    assert_eq!(top.ports, ports());
}
