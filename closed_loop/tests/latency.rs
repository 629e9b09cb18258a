//! Measures the clocks from a host's write to a change at the pins of a stage, the figures of `docs/hosts.md`.

use posicast_blocks::segments::{CubicEntry, Entry, EntryMotion};
use posicast_closed_loop::stage_bench::StageBench;
use posicast_machine::plant::axis::{DrivePins, PlantOptions};

use crate::support::{XY, bench, machine, stage};

const TICK_CLOCKS: u64 = 5000;
const PWM_CLOCKS: u64 = 2500;

/// The example's stage in HOLD, with an entry of a steady velocity in X's FIFO, this many clocks after a tick.
fn ready(clocks: u64) -> StageBench {
    let machine = machine(XY);
    let mut bench = bench(&machine, &stage(&machine), &PlantOptions::default(), None, 1);
    assert!(bench.switch_on(100_000).unwrap());
    let motion = EntryMotion::Cubic(CubicEntry {
        velocity: 10 << 16,
        ..CubicEntry::default()
    });
    bench
        .segment(
            "x",
            &Entry {
                ticks: 100,
                motion,
                notify: false,
            },
        )
        .unwrap();
    while bench.output("tick").unwrap() == 0 {
        bench.clocks(1).unwrap();
    }
    bench.clocks(clocks).unwrap();
    bench
}

/// Clocks from the write of START until the command, the shaped command and the gates change.
fn latency(clocks: u64) -> [u64; 3] {
    let (mut bench, mut waits) = (ready(clocks), ready(clocks));
    bench.write("start", 1).unwrap();
    waits.write("start", 0).unwrap();
    let nets = ["x_command_position", "x_shaped_position"].map(|net| bench.probe(net).unwrap());
    let mut found = [None; 3];
    let gates = |pins: DrivePins| [pins.a_high, pins.a_low, pins.b_high, pins.b_low];
    for clock in 1..4 * TICK_CLOCKS {
        bench.clocks(1).unwrap();
        waits.clocks(1).unwrap();
        let differs = [
            bench.at(nets[0]) != waits.at(nets[0]),
            bench.at(nets[1]) != waits.at(nets[1]),
            gates(bench.pins(0)) != gates(waits.pins(0)),
        ];
        for (place, differs) in found.iter_mut().zip(differs) {
            if differs {
                place.get_or_insert(clock);
            }
        }
        if found.iter().all(Option::is_some) {
            break;
        }
    }
    found.map(Option::unwrap)
}

#[test]
fn a_start_moves_the_command_in_the_third_tick_and_the_pins_a_period_of_the_pwm_later() {
    for tenth in 0..10 {
        let into_tick = tenth * TICK_CLOCKS / 10 + 100;
        let to_third_tick = 3 * TICK_CLOCKS - into_tick;
        let [command, shaped, gates] = latency(into_tick).map(|clocks| clocks - to_third_tick);
        // RUN begins with the first tick, the entry is read in the second; it plays in the third, and a write takes a clock and two more.
        assert_eq!(command, 43, "{into_tick} clocks after a tick");
        assert_eq!(shaped, command + 27, "three channels, five taps");
        // The duty is there 729 clocks after the tick, and the PWM takes it at its next period.
        assert_eq!(gates, PWM_CLOCKS + 557, "{into_tick} clocks after a tick");
    }
}
