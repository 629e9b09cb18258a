//! Time to simulate the axis: clock by clock, as the RTL is simulated, and cell by cell, as a fast model does.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use posicast_machine::machine_file;
use posicast_machine::plant::axis::{AxisPlant, DrivePins, PlantOptions};

/// Number of clocks per tick in the examples.
const TICK_CLOCKS: u64 = 5_000;

fn tick(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("plant");
    group.throughput(Throughput::Elements(TICK_CLOCKS));
    for (name, text) in [
        ("velocity", include_str!("../../../examples/xy-stage.toml")),
        ("torque", include_str!("../../../examples/xy-stage-torque.toml")),
    ] {
        let Ok(machine) = machine_file::parse(name, text) else {
            return;
        };
        let Ok(plant) = AxisPlant::new(&machine.axes[0], &machine.clock, &PlantOptions::default()) else {
            return;
        };
        let pins = DrivePins {
            a_high: true,
            b_low: true,
            drive_enable: true,
            brake_release: true,
            ..DrivePins::default()
        };
        for (pace, clocks) in [("clocks", 1), ("quiet", u64::MAX)] {
            group.bench_function(format!("{name}, {pace}"), |bencher| {
                let mut plant = plant.clone();
                bencher.iter(|| {
                    let mut left = TICK_CLOCKS;
                    while left > 0 {
                        let now = clocks.min(plant.quiet_clocks()).min(left);
                        plant.clocks(black_box(pins), now);
                        black_box(plant.encoder());
                        left -= now;
                    }
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, tick);
criterion_main!(benches);
