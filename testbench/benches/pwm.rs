//! The PWM's model beside its Verilog under Verilator, on one stimulus: `cargo bench -p posicast-testbench --bench pwm`.
//!
//! 20 kHz from 50 MHz, unipolar, a new duty in every period. Best of five runs each, in million clocks per second.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs, reason = "a benchmark")]

use posicast_model::rtl::pwm::{ActiveLow, Inputs, OUTPUTS, Pwm, PwmConfig, ports};
use posicast_testbench::verilator::{Source, Verilated};
use std::hint::black_box;
use std::time::Instant;

const PERIOD: usize = 2500;
const CLOCKS: usize = 400 * PERIOD;

fn inputs(clock: usize) -> Inputs {
    let period = clock / PERIOD;
    Inputs {
        enable: true,
        mode: 2,
        period: PERIOD as u16,
        duty: (period * 391 % PERIOD) as i32,
        max_duty: PERIOD as u16,
        trigger_phase: PERIOD as u16 / 2,
        fault_n: true,
        pll_locked: true,
        filtered_fault_n: 3,
        clear_trip: period < 4,
        ..Inputs::default()
    }
}

fn verilated(config: &PwmConfig) -> Verilated {
    let folder = tempfile::tempdir().unwrap();
    let modules = posicast_hdl::pwm::emit(config, "").unwrap();
    let files = modules.iter().map(|module| {
        let path = folder.path().join(format!("{}.v", module.name));
        std::fs::write(&path, &module.text).unwrap();
        path
    });
    let (files, ports): (Vec<_>, _) = (files.collect(), ports());
    let source = Source {
        files: &files,
        top: "pwm",
        ports: &ports,
    };
    Verilated::build(&source, 1).unwrap()
}

fn report(name: &str, mut run: impl FnMut()) {
    let fastest = (0..5).map(|_| {
        let start = Instant::now();
        run();
        start.elapsed()
    });
    let seconds = fastest.min().unwrap_or_default().as_secs_f64();
    println!("{name:10} {:10.1} million clocks/s", CLOCKS as f64 / seconds / 1e6);
}

fn main() {
    let config = PwmConfig::new(ActiveLow::default(), 25, 50).unwrap();
    let mut device = verilated(&config);
    let rows: Vec<u64> = (0..CLOCKS).flat_map(|clock| inputs(clock).to_raw()).collect();
    let mut shown = vec![0; CLOCKS * OUTPUTS];
    report("verilator", || device.run(&rows, &mut shown).unwrap());
    report("step", || {
        let mut pwm = Pwm::new(&config);
        for clock in 0..CLOCKS {
            black_box(pwm.step(&inputs(clock)));
        }
    });
    report("hold", || {
        let mut pwm = Pwm::new(&config);
        for period in 0..CLOCKS / PERIOD {
            let inputs = inputs(period * PERIOD);
            pwm.hold(&inputs, PERIOD as u64);
            black_box(pwm.outputs(&inputs));
        }
    });
}
