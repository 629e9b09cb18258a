//! The pulse counter in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::pulse_counter::{Inputs, PulseCounter, ports};
use posicast_hdl::pulse_counter::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = PulseCounter::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(1);
    let mut inputs = Inputs::default();
    let (mut expected, mut actual) = ([0; 18], [0; 18]);
    for clock in 0..8_000 {
        if random.once_in(300) {
            inputs.filter_clocks = [0, 0, 1, 3][random.below(4) as usize];
            inputs.mode = random.below(6) as u8;
            inputs.differential = random.once_in(2);
            inputs.smoothing = random.below(4) as u8;
            inputs.velocity_m = random.once_in(3);
            inputs.index_gate = random.below(16) as u8;
            inputs.timeout = random.below(3) as u8;
            (inputs.swap, inputs.invert) = (random.once_in(2), random.once_in(2));
        }
        match random.below(12) {
            0 => inputs.a ^= true,
            1 => inputs.b ^= true,
            2 => inputs.z ^= true,
            _ => {}
        }
        (inputs.a_n, inputs.b_n, inputs.z_n) = (!inputs.a ^ random.once_in(40), !inputs.b, !inputs.z);
        inputs.rst = random.once_in(3000);
        inputs.index_arm = random.once_in(50);
        inputs.index_always = random.once_in(2);
        inputs.index_presets = random.once_in(2);
        inputs.preset = random.once_in(100);
        inputs.preset_value = random.word() as i32;
        inputs.clear_flags = random.once_in(100);
        inputs.tick = random.once_in(25);
        inputs.time_stamp = inputs.time_stamp + 1 + (random.word() as u32 & 0x1_ffff) * u32::from(random.once_in(99));
        inputs.quotient_valid = random.once_in(15);
        inputs.quotient = (random.word() as i32) >> random.below(32);
        ClockedBlock::step(&mut model, &inputs.to_raw(), &mut expected).unwrap();
        rusthdl.step(&inputs.to_raw(), &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
    }
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage_x").unwrap();
    let top = modules.last().unwrap();
    assert_eq!(top.name, "posicast_pulse_counter");
    assert_eq!(top.ports, ports());
}
