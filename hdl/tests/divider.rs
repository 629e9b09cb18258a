//! The divider in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::divider::{Divider, DividerConfig, ports};
use posicast_hdl::divider::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    for tick_clocks in [1, 5000, 131_071] {
        let config = DividerConfig::new(tick_clocks).unwrap();
        let mut model = Divider::new(&config);
        let mut rusthdl = simulate(&config).unwrap();
        let mut random = Random(tick_clocks);
        let (mut expected, mut actual) = ([0; 5], [0; 5]);
        for clock in 0..20_000 {
            let size = random.below(24);
            let inputs = [
                u64::from(random.once_in(2000)),
                u64::from(random.once_in(30)),
                (random.word() >> size) & 0x3_ffff,
                (random.word() & 0xff_ffff) >> random.below(25),
                u64::from(random.once_in(50)),
            ];
            ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
            rusthdl.step(&inputs, &mut actual).unwrap();
            assert_eq!(actual, expected, "clock {clock}, {inputs:?}, {config:?}");
        }
    }
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit(&DividerConfig::new(5000).unwrap(), "stage").unwrap();
    assert_eq!((modules.len(), modules[0].name.as_str()), (1, "posicast_divider_5000"));
    assert_eq!(modules[0].ports, ports());
}
