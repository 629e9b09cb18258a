//! The controller in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::sliding_mode::{INPUT_PORTS, OUTPUT_PORTS, SettingRow, SlidingMode, ports};
use posicast_hdl::sliding_mode::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = SlidingMode::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(1);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut inputs = [0; INPUT_PORTS];
    for clock in 0..30_000 {
        let mut word = || (random.word() as u32 as i32 >> random.below(32)) as u32;
        if clock % 40 == 0 {
            inputs[4..9].fill_with(|| u64::from(word()));
        }
        // The limit does not change while its step uses it.
        if expected[0] != SettingRow::Limit as u64 {
            inputs[9] = u64::from(word()) | random.below(32) << 18;
        }
        inputs[0] = u64::from(random.once_in(5000));
        inputs[1] = u64::from(random.once_in(100));
        (inputs[2], inputs[3]) = (random.below(4), random.below(2));
        (inputs[10], inputs[11]) = (u64::from(random.once_in(900)), u64::from(random.once_in(300)));
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
    }
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage_x").unwrap();
    let top = modules.last().unwrap();
    assert_eq!(top.name, "posicast_sliding_mode");
    assert_eq!(top.ports, ports());
}
