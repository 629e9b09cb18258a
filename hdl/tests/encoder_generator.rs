//! The internal encoder in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::encoder_generator::{EncoderGenerator, INPUT_PORTS, OUTPUT_PORTS, ports};
use posicast_hdl::encoder_generator::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = EncoderGenerator::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(3);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut inputs = [0; INPUT_PORTS];
    let mut indices = 0;
    for clock in 0..20_000 {
        inputs[0] = u64::from(clock < 2 || random.once_in(3000));
        if random.once_in(50) {
            inputs[1] = random.below(2);
            inputs[2] = (((random.word() as i32) >> random.below(8)) as u32).into();
        }
        if random.once_in(500) {
            inputs[3] = random.below(40);
        }
        (4..INPUT_PORTS).for_each(|pin| inputs[pin] = random.below(2));
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        indices += inputs[1] & expected[2];
    }
    assert!(indices > 300, "{indices} clocks with an index");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (2, "posicast_encoder_generator"));
    assert_eq!(top.ports, ports());
}
