//! The trace memory in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::trace::{Inputs, SAMPLES, Trace, TraceConfig, ports};
use posicast_hdl::trace::{emit, simulate};
use random::Random;

/// Plays random inputs, with events rare enough for traces to complete. Returns the number of clocks in each state.
fn lockstep(samples: u32, seed: u64, clocks: u32) -> [u64; 4] {
    let config = TraceConfig::new(u64::from(samples)).unwrap();
    let mut model = Trace::new(&config);
    let mut rusthdl = simulate(&config).unwrap();
    assert_eq!(rusthdl.ports(), ports());
    let mut random = Random(seed);
    let mut seen = [0; 4];
    let mut settings = Inputs::default();
    for clock in 0..clocks {
        if clock % 400 == 0 {
            settings = Inputs {
                select_0: random.below(16) as u8,
                select_1: random.below(16) as u8,
                select_2: random.below(16) as u8,
                select_3: random.below(16) as u8,
                signals: random.below(4) as u8,
                decimation: random.below(3) as u16,
                trigger_select: random.below(16) as u8,
                trigger_mode: random.below(4) as u8,
                pre_trigger: random.below(2048) as u16 >> random.below(12),
                ..settings
            };
        }
        let inputs = Inputs {
            rst: clock < 2 || random.once_in(3000),
            strobe: random.once_in(4),
            signal: std::array::from_fn(|_| random.word() as i32),
            trigger_event: random.once_in(60),
            trigger_level: random.word() as i32 >> 4,
            arm: random.once_in(2000),
            halt: random.once_in(2500),
            read_address: random.below(2 * u64::from(samples)) as u16 & 0x7ff,
            ..settings
        };
        let mut actual = [0; 6];
        rusthdl.step(&inputs.to_raw(), &mut actual).unwrap();
        let expected = model.step(&inputs);
        assert_eq!(
            actual,
            expected.to_raw(),
            "{samples} samples, clock {clock}, {inputs:?}"
        );
        seen[expected.state as usize] += 1;
    }
    seen
}

#[test]
fn lockstep_every_size() {
    for samples in SAMPLES {
        lockstep(samples, u64::from(samples), 1_000);
    }
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    for samples in SAMPLES {
        let modules = emit(&TraceConfig::new(u64::from(samples)).unwrap(), "stage").unwrap();
        let top = modules.last().unwrap();
        assert_eq!(
            (modules.len(), top.name.as_str()),
            (5, format!("posicast_trace_{samples}").as_str())
        );
        assert_eq!(top.ports, ports());
    }
}
