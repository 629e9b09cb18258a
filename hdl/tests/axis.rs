//! The supervisor in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::axis::{Axis, Inputs, LEAST_TICK_CLOCKS, OUTPUT_PORTS, ports};
use posicast_hdl::axis::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = Axis::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(9);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut seen = [0; 6];
    let mut since_tick = 0;
    for clock in 0..10_000 {
        since_tick += 1;
        let tick = since_tick >= LEAST_TICK_CLOCKS && random.once_in(6);
        if tick {
            since_tick = 0;
        }
        let inputs = Inputs {
            rst: clock < 2 || random.once_in(3000),
            tick,
            emergency_stop_n: !random.once_in(400),
            limit_plus_n: !random.once_in(30),
            limit_minus_n: !random.once_in(30),
            drive_ready: !random.once_in(300),
            home: random.once_in(2),
            enable: random.below(300) > 30 && clock % 500 > 50,
            start: random.once_in(5),
            stop: random.once_in(300),
            clear_faults: random.once_in(40),
            group_stop: random.once_in(300),
            off_causes: random.word() as u16,
            brake_release_ticks: random.below(3) as u16,
            brake_apply_ticks: random.below(3) as u16,
            settle_ticks: random.below(3) as u16,
            following_error_limit: 1 << 30,
            error: (random.word() as i32) >> random.below(8),
            position: random.below(3) as i32,
            segments_state: random.below(4) as u8,
            segments_empty: random.once_in(8),
            segments_valid: random.once_in(6),
            segments_underrun: random.once_in(500),
            command_velocity: random.word() as i32 >> 31,
            ..Inputs::default()
        };
        let raw = inputs.to_raw();
        ClockedBlock::step(&mut model, &raw, &mut expected).unwrap();
        rusthdl.step(&raw, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        seen[expected[0] as usize] += 1;
    }
    assert!(seen.iter().all(|clocks| *clocks > 30), "{seen:?} clocks in each state");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage_x").unwrap();
    let top = modules.last().unwrap();
    assert_eq!(top.name.as_str(), "posicast_axis");
    assert_eq!(top.ports, ports());
}
