//! The drive command in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::drive_command::{DriveCommand, OUTPUT_PORTS, ports};
use posicast_hdl::drive_command::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = DriveCommand::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(3);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut self_test = 0;
    let (mut direct_clocks, mut test_clocks) = (0, 0);
    for clock in 0..30_000 {
        let mut seldom = |pace| u64::from(random.once_in(pace));
        let bits = [seldom(2000), seldom(5), seldom(7), seldom(9), seldom(9), seldom(9)];
        let [rst, tick, valid, pwm_enable, drive_enable, brake_release] = bits;
        let lines = [(); 4].map(|()| 1 - seldom(30));
        let state = if seldom(40) == 1 { random.below(8) } else { 1 };
        let direct_enable = u64::from(!random.once_in(100));
        let kick = u64::from(random.once_in(30));
        let size = random.below(18);
        if random.once_in(200) {
            self_test = 1 - self_test;
        }
        let inputs = [
            rst,
            tick,
            random.word() & 0x3_ffff,
            valid,
            state,
            pwm_enable,
            drive_enable,
            brake_release,
            lines[0],
            lines[1],
            lines[2],
            lines[3],
            direct_enable,
            kick,
            random.below(7),
            (random.word() & 0x1_ffff) >> size,
            (random.word() & 0xffff) >> random.below(17),
            self_test,
            random.below(16),
            u64::from(random.once_in(12)),
        ];
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        direct_clocks += expected[6];
        test_clocks += expected[8];
    }
    assert!(direct_clocks > 5000, "{direct_clocks} clocks in direct mode");
    assert!(test_clocks > 2000, "{test_clocks} clocks in the self-test");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let names: Vec<&str> = modules.iter().map(|module| module.name.as_str()).collect();
    assert_eq!(names, ["posicast_pin_register", "posicast_drive_command"]);
    assert_eq!(modules[1].ports, ports());
}
