//! The linear scale in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::linear_scale::{LinearScale, OUTPUT_PORTS, ports};
use posicast_hdl::linear_scale::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = LinearScale::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(4);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut tied = [0; 3];
    let mut results = 0;
    for clock in 0..30_000 {
        let rst = u64::from(clock < 2 || random.once_in(1000));
        if rst == 1 {
            tied = [random.word() & 0x3_ffff, random.below(32), random.below(2)];
        }
        let mut size = || random.word() as i64 >> (32 + random.below(32));
        let [motor, scale, velocity] = [size(), size(), size()].map(|value| value as u64 & 0xffff_ffff);
        let inputs = [
            rst,
            u64::from(random.once_in(70)),
            motor,
            scale,
            velocity,
            u64::from(random.once_in(70)),
            u64::from(random.once_in(300)),
            tied[0],
            tied[1],
            tied[2],
        ];
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        results += expected[1];
    }
    assert!(results > 100, "{results} deviations");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (2, "posicast_linear_scale"));
    assert_eq!(top.ports, ports());
}
