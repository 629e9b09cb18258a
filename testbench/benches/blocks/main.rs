//! Clocks per second of every block in Verilator, in the model's `step` and in the model's fast path, on the same
//! inputs.
//!
//! ```text
//! cargo bench -p posicast-testbench --bench blocks                 all
//! cargo bench -p posicast-testbench --bench blocks -- divider      one block
//! ```
//!
//! Verilator and `step` are called once per clock through [`ClockedBlock`], with raw values for all ports. The fast
//! path gets the same inputs as events and skips the clocks between them. Before anything is measured, Verilator and
//! `step` run side by side and must agree in every clock.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a benchmark of fixed blocks"
)]

mod command;
mod drive;
mod measurement;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_hdl::emit::Module;
use posicast_testbench::verilator::{Verilated, VerilogSource};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

/// Number of clocks per tick: 10 kHz from 50 MHz.
const TICK_CLOCKS: u64 = 5000;
/// Number of ticks of a run.
const TICKS: u64 = 20;
const CLOCKS: u64 = TICKS * TICK_CLOCKS;

/// A block with inputs of normal operation. A new block needs one more function and its name in [`blocks`].
struct Block {
    name: &'static str,
    /// Its Verilog modules, the top module last.
    modules: Vec<Module>,
    model: Box<dyn ClockedBlock>,
    /// One row per clock with one value per input port.
    inputs: Vec<u64>,
    /// Runs the same inputs through the fast path; returns a value that depends on all results.
    fast: Box<dyn FnMut() -> i64>,
}

/// Groups equal inputs: each with the number of clocks for which it stays.
fn hold<T: PartialEq>(inputs: impl Iterator<Item = T>) -> Vec<(T, u64)> {
    let mut events: Vec<(T, u64)> = Vec::new();
    for inputs in inputs {
        match events.last_mut() {
            Some((held, clocks)) if *held == inputs => *clocks += 1,
            _ => events.push((inputs, 1)),
        }
    }
    events
}

fn blocks(criterion: &mut Criterion) {
    for block in [
        measurement::pulse_counter(),
        measurement::divider(),
        command::segments(),
        command::shaper(),
        command::shaper_in_motion(),
        command::cascade(),
        drive::sliding_mode(),
        drive::pwm(),
    ] {
        measure(criterion, block);
    }
}

fn measure(criterion: &mut Criterion, mut block: Block) {
    let mut verilated = verilated(&block);
    let ports = |direction| block.model.ports().iter().filter(|p| p.direction == direction).count();
    let (inputs, mut outputs) = (ports(Direction::Input), vec![0; ports(Direction::Output)]);
    let mut expected = outputs.clone();
    for (clock, row) in block.inputs.chunks(inputs).enumerate() {
        verilated.step(row, &mut outputs).unwrap();
        block.model.step(row, &mut expected).unwrap();
        assert_eq!(outputs, expected, "{}: clock {clock}", block.name);
    }

    let mut group = criterion.benchmark_group(block.name);
    group.throughput(Throughput::Elements((block.inputs.len() / inputs) as u64));
    group.sample_size(20).measurement_time(Duration::from_secs(2));
    for (name, device) in [
        ("verilator", &mut verilated as &mut dyn ClockedBlock),
        ("model, step", block.model.as_mut()),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for row in block.inputs.chunks(inputs) {
                    device.step(black_box(row), black_box(&mut outputs)).unwrap();
                }
            });
        });
    }
    group.bench_function("model, fast path", |bencher| bencher.iter(|| black_box((block.fast)())));
    group.finish();
}

fn verilated(block: &Block) -> Verilated {
    let folder = tempfile::tempdir().unwrap();
    let write = |module: &Module| {
        let path = folder.path().join(format!("{}.v", module.name));
        std::fs::write(&path, &module.text).unwrap();
        path
    };
    let files: Vec<PathBuf> = block.modules.iter().map(write).collect();
    let source = VerilogSource {
        files: &files,
        top: &block.modules.last().unwrap().name,
        ports: block.model.ports(),
    };
    Verilated::build(&source, 1).unwrap()
}

criterion_group!(benches, blocks);
criterion_main!(benches);
