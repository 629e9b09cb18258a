//! The PWM in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::pwm::{ActiveLow, Inputs, OUTPUT_PORTS, Pwm, PwmConfig, ports};
use posicast_hdl::pwm::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let active_low = ActiveLow {
        b_high: true,
        ..ActiveLow::default()
    };
    let config = PwmConfig::new(active_low, 2, 3).unwrap();
    let mut model = Pwm::new(&config);
    let mut rusthdl = simulate(&config).unwrap();
    let mut random = Random(1);
    let mut inputs = Inputs {
        period: 70,
        max_duty: 90,
        ..Inputs::default()
    };
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut running = 0;
    for clock in 0..16_000 {
        if random.once_in(600) {
            inputs.period = 60 + random.below(60) as u16;
            inputs.dead_time = random.below(6) as u16;
            inputs.minimum_pulse = random.below(6) as u16;
            inputs.update_at_peak = random.once_in(2);
            inputs.filter_clocks = random.below(4) as u8;
            inputs.watchdog_periods = random.below(4) as u8;
            inputs.phase = random.below(20) as u16;
        }
        if random.once_in(25) {
            inputs.duty = random.below(241) as i32 - 120;
        }
        if random.once_in(300) {
            inputs.mode = random.below(4) as u8;
        }
        inputs.rst = random.once_in(3000);
        inputs.enable = !random.once_in(900);
        inputs.sync = random.once_in(200);
        inputs.feed = random.once_in(60);
        inputs.fault_n = !random.once_in(900);
        inputs.pll_locked = !random.once_in(900);
        inputs.filtered_fault_n = if random.once_in(400) { 1 } else { 3 };
        inputs.clear_trip = random.once_in(10);
        inputs.clear_flags = random.once_in(100);
        if random.once_in(150) {
            inputs.mask_pins = !inputs.mask_pins;
        }
        ClockedBlock::step(&mut model, &inputs.to_raw(), &mut expected).unwrap();
        rusthdl.step(&inputs.to_raw(), &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        running += expected[4];
    }
    assert!(running > 2_000, "{running}");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit(&PwmConfig::new(ActiveLow::default(), 1, 1).unwrap(), "stage_x").unwrap();
    let top = modules.last().unwrap();
    assert_eq!(top.name, "posicast_pwm_1x1_0000");
    assert_eq!(top.ports, ports());
}
