//! The excitation in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::excitation::{Excitation, INPUT_PORTS, OUTPUT_PORTS, ports};
use posicast_hdl::excitation::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = Excitation::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(4);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut inputs = [0; INPUT_PORTS];
    let (mut active, mut until_valid) = (0, 5);
    for clock in 0..30_000 {
        until_valid -= 1;
        inputs[0] = u64::from(clock < 2 || random.once_in(5000));
        inputs[1] = u64::from(until_valid == 0);
        if until_valid == 0 {
            until_valid = 1 + random.below(60);
            (2..5).for_each(|port| inputs[port] = random.word() & 0xffff_ffff);
        }
        inputs[5] = u64::from(!random.once_in(300));
        inputs[6] = u64::from(!random.once_in(1000));
        if inputs[5] == 0 {
            inputs[7] = random.below(4);
            inputs[8] = random.below(1 << 16);
            inputs[9] = random.below(1 << 16) | 0x8000;
            inputs[10] = 10 + random.below(100);
            inputs[11] = random.below(1 << 16) >> random.below(16);
            inputs[12] = 1 + random.below(40);
            inputs[13] = random.below(2);
        }
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        active += expected[5];
    }
    assert!(active > 5000, "{active} clocks with a signal");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (2, "posicast_excitation"));
    assert_eq!(top.ports, ports());
}
