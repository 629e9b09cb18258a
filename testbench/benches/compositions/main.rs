//! Clocks per second of compositions in Verilator, in the model's `step` and in the model's `hold`, on the same
//! inputs.
//!
//! ```text
//! cargo bench -p posicast-testbench --bench compositions                 all
//! cargo bench -p posicast-testbench --bench compositions -- stage        one
//! ```
//!
//! Verilator and `step` are called once per clock, with raw values for all ports. `hold` gets the same inputs as
//! events, and returns at each change of an output. Before anything is measured, all three run side by side and must
//! agree in every clock.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a benchmark of fixed compositions"
)]

mod components;
mod pins;
mod stage;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use posicast_blocks::composition::Composed;
use posicast_blocks::{ClockedBlock, Direction, Moore, OutputKind};
use posicast_hdl::emit::Module;
use posicast_testbench::verilator::{Verilated, VerilogSource};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

/// Number of clocks per tick: 10 kHz from 50 MHz.
const TICK_CLOCKS: u64 = 5000;
const CLOCKS: u64 = 20 * TICK_CLOCKS;
/// Least number of clocks in which an output must change: two per tick.
const LEAST_CHANGES: usize = 40;

/// Returns the value of an input in a clock.
type Input = Box<dyn Fn(&str, u64) -> u64>;

/// A composition with inputs of normal operation.
struct Whole {
    name: &'static str,
    /// Its Verilog modules, the top module last.
    modules: Vec<Module>,
    model: Composed,
    /// Returns the value of an input, given its name and the clock.
    input: Input,
}

/// Inputs, each with the number of clocks for which they stay.
type Events = Vec<(Vec<u64>, u64)>;

fn compositions(criterion: &mut Criterion) {
    for whole in components::all().into_iter().chain([stage::stage()]) {
        measure(criterion, whole);
    }
}

fn measure(criterion: &mut Criterion, mut whole: Whole) {
    let mut verilated = verilated(&whole);
    let events = events(&whole);
    let rows = || {
        let rows = events.iter();
        rows.flat_map(|(row, clocks)| std::iter::repeat_n(row, *clocks as usize))
    };
    let ports = whole.model.ports().iter();
    let outputs: Vec<_> = ports.filter(|port| port.direction == Direction::Output).collect();
    let counts = |name: &str| whole.model.output_kind(name) == OutputKind::Counter;
    let counter = outputs.iter().position(|port| counts(&port.name));
    let mut shown = vec![0; outputs.len()];
    let mut expected = Vec::new();
    for (clock, row) in rows().enumerate() {
        verilated.step(row, &mut shown).unwrap();
        expected.push(shown.clone());
        whole.model.step(row, &mut shown).unwrap();
        assert_eq!(shown, expected[clock], "{}, step: clock {clock}", whole.name);
    }
    let changes = expected.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(
        changes > LEAST_CHANGES,
        "{}: {changes} changes are rest, not work",
        whole.name
    );
    // The same check with `hold`, starting from a reset.
    whole.model.step(&events[0].0, &mut shown).unwrap();
    let mut expected = expected.iter();
    for (row, clocks) in &events {
        let mut left = *clocks;
        while left > 0 {
            let ran = whole.model.hold(row, left, &mut shown).unwrap();
            for (clock, expected) in expected.by_ref().take(ran as usize).enumerate() {
                if let Some(counter) = counter.filter(|_| clock > 0) {
                    shown[counter] += 1;
                }
                assert_eq!(shown, *expected, "{}, hold", whole.name);
            }
            left -= ran;
        }
    }

    let mut group = criterion.benchmark_group(whole.name);
    group.throughput(Throughput::Elements(CLOCKS));
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    group.bench_function("verilator", |bencher| {
        bencher.iter(|| {
            for row in rows() {
                verilated.step(black_box(row), black_box(&mut shown)).unwrap();
            }
        });
    });
    group.bench_function("model, step", |bencher| {
        bencher.iter(|| {
            for row in rows() {
                whole.model.step(black_box(row), black_box(&mut shown)).unwrap();
            }
        });
    });
    group.bench_function("model, hold", |bencher| {
        bencher.iter(|| {
            for (row, clocks) in &events {
                let mut left = *clocks;
                while left > 0 {
                    left -= whole.model.hold(black_box(row), left, black_box(&mut shown)).unwrap();
                }
            }
        });
    });
    group.finish();
}

/// Returns the inputs of all clocks; those of the first are a reset.
fn events(whole: &Whole) -> Events {
    let inputs = whole
        .model
        .ports()
        .iter()
        .filter(|port| port.direction == Direction::Input);
    let inputs: Vec<_> = inputs.collect();
    let mut events: Events = Vec::new();
    for clock in 0..CLOCKS {
        let value = |name: &str| match name {
            "rst" => u64::from(clock == 0),
            name => (whole.input)(name, clock),
        };
        let row = inputs.iter().map(|port| value(&port.name)).collect();
        match events.last_mut() {
            Some((held, clocks)) if *held == row => *clocks += 1,
            _ => events.push((row, 1)),
        }
    }
    events
}

fn verilated(whole: &Whole) -> Verilated {
    let folder = tempfile::tempdir().unwrap();
    let write = |module: &Module| {
        let path = folder.path().join(format!("{}.v", module.name));
        std::fs::write(&path, &module.text).unwrap();
        path
    };
    let files: Vec<PathBuf> = whole.modules.iter().map(write).collect();
    let source = VerilogSource {
        files: &files,
        top: &whole.modules.last().unwrap().name,
        ports: whole.model.ports(),
    };
    Verilated::build(&source, 1).unwrap()
}

criterion_group!(benches, compositions);
criterion_main!(benches);
