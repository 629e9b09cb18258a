//! A stage whose axes have absolute encoders, on its simulated machine: where it stands after a reset, how it moves, and what its
//! encoders' faults do.

use posicast_blocks::axis::Cause;
use posicast_closed_loop::stage_bench::{StageBench, state};
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::{AbsoluteFault, PlantOptions};

use crate::support::{self, queue_move, stage, verilated};

const ARM: &str = include_str!("../../examples/measuring-arm.toml");
/// Clocks of a tick.
const TICK: u64 = 5000;
/// An encoder over SSI in place of that of the arm.
const SSI: [(&str, &str); 3] = [
    (
        "kind = \"biss_c\"",
        "kind = \"ssi\"\ncoding = \"gray\"\nparity = \"odd\"\nleading_bits = 1\ntrailing_bits = 2\nerror_bit = 1\n\
         error_level = \"low\"",
    ),
    ("clock_hz = 5_000_000", "clock_hz = 1_000_000"),
    (
        "answer_s = 15e-6                      # it computes for up to 10 µs\n",
        "",
    ),
];

fn arm() -> Machine {
    support::machine(ARM)
}

fn with_ssi() -> Machine {
    let text = SSI.iter().fold(ARM.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    support::machine(&text)
}

/// The bench, with every axis at this position in m.
fn bench(machine: &Machine, position: f64) -> StageBench {
    let options = PlantOptions {
        position,
        ..PlantOptions::default()
    };
    support::bench(machine, &stage(machine), &options, None, 1)
}

fn count(bench: &mut StageBench, axis: &str) -> i32 {
    bench.read(&format!("{axis}_count")).unwrap() as i32
}

#[test]
fn the_axes_know_where_they_stand_without_homing() {
    for machine in [arm(), with_ssi()] {
        for (position, expected) in [(0.0, 0), (0.123_456_7, 1_234_567), (-0.2, -2_000_000)] {
            let mut bench = bench(&machine, position);
            assert_eq!(bench.field("arm", "status", "homed").unwrap(), 0);
            bench.clocks(2 * TICK).unwrap();
            for axis in ["arm", "column"] {
                assert_eq!(count(&mut bench, axis), expected, "{axis}");
                assert_eq!(
                    bench.read(&format!("{axis}_position")).unwrap() as i32,
                    expected,
                    "{axis}"
                );
                assert_eq!(bench.field(axis, "status", "homed").unwrap(), 1);
                let state = bench.read(&format!("{axis}_encoder_state")).unwrap();
                assert_eq!(state & 0xffff, 1 << 8, "{axis}: known, and no flag");
            }
        }
    }
}

#[test]
fn an_axis_is_not_ready_before_it_is_placed() {
    let machine = arm();
    let mut bench = bench(&machine, 0.000_3);
    bench.write("arm_clear_faults", 0).unwrap();
    assert!(!bench.wait("arm", state::READY, TICK).unwrap());
    assert!(bench.wait("arm", state::READY, 2 * TICK).unwrap());
    bench.write("arm_control", 1).unwrap();
    assert!(bench.wait("arm", state::HOLD, 2 * TICK).unwrap());
    bench.clocks(100 * TICK).unwrap();
    assert_eq!(bench.read("arm_causes").unwrap(), 0);
    assert!((count(&mut bench, "arm") - 3000).abs() <= 2);
}

#[test]
fn an_encoder_that_is_not_there_is_a_cause() {
    let machine = arm();
    let mut bench = bench(&machine, 0.0);
    bench.fault_absolute_encoder(0, Some(AbsoluteFault::Stuck(true)));
    for _ in 0..2 {
        bench.clocks(4 * TICK).unwrap();
        assert_ne!(bench.read("arm_causes").unwrap() & Cause::EncoderError.bit(), 0);
        bench.write("arm_clear_faults", 0).unwrap();
    }
    assert!(!bench.wait("arm", state::READY, 10 * TICK).unwrap());
}

#[test]
fn a_move_ends_where_it_should_and_the_velocity_is_that_of_the_axis() {
    for machine in [arm(), with_ssi()] {
        let mut bench = bench(&machine, 0.05);
        assert!(bench.switch_on(10_000_000).unwrap());
        queue_move(&mut bench, &machine, 0, 100_000);
        queue_move(&mut bench, &machine, 1, -100_000);
        bench.write("start", 0b11).unwrap();
        bench.clocks(800 * TICK).unwrap();
        for (at, axis) in ["arm", "column"].into_iter().enumerate() {
            let velocity = bench.read(&format!("{axis}_velocity")).unwrap() as i32;
            let per_tick = bench.plant(at).motion().velocity * machine.axes[at].counts_per_unit * 1e-4;
            let found = f64::from(velocity) / 65_536.0;
            // A difference is that of the middle of the tick before, and a reading may be off by a count.
            assert!((found - per_tick).abs() < 4.0, "{axis}: {found} and {per_tick}");
            assert!(found.abs() > 20.0, "{axis}: {found}");
        }
        for axis in ["arm", "column"] {
            assert!(bench.wait(axis, state::HOLD, 50_000_000).unwrap());
        }
        bench.clocks(300 * TICK).unwrap();
        for (axis, expected) in [("arm", 600_000), ("column", 400_000)] {
            assert!((count(&mut bench, axis) - expected).abs() <= 2, "{axis}");
            assert_eq!(bench.read(&format!("{axis}_causes")).unwrap(), 0);
        }
    }
}

/// Position held by the axes, with this fault for so many ticks; then the causes of the arm.
fn causes_after(bench: &mut StageBench, fault: AbsoluteFault, ticks: u64) -> u32 {
    bench.fault_absolute_encoder(0, Some(fault));
    bench.clocks(ticks * TICK).unwrap();
    bench.fault_absolute_encoder(0, None);
    bench.clocks(3 * TICK).unwrap();
    bench.read("arm_causes").unwrap()
}

#[test]
fn tolerated_faults_move_nothing_and_one_more_switches_off() {
    let (biss, ssi) = (arm(), with_ssi());
    let faults = [
        (&biss, AbsoluteFault::Inverted(3), 0),
        (&biss, AbsoluteFault::Stuck(true), 1),
        (&biss, AbsoluteFault::Stuck(false), 2),
        (&biss, AbsoluteFault::Error, 3),
        (&ssi, AbsoluteFault::Error, 3),
    ];
    for (machine, fault, flag) in faults {
        let mut bench = bench(machine, 0.01);
        assert!(bench.switch_on(10_000_000).unwrap());
        // To the middle of a tick, between two readings.
        while bench.output("tick").unwrap() == 0 {
            bench.clocks(1).unwrap();
        }
        bench.clocks(TICK * 3 / 4).unwrap();
        assert_eq!(causes_after(&mut bench, fault, 2), 0, "{fault:?}");
        let state = bench.read("arm_encoder_state").unwrap();
        assert_eq!(state & 0xff, 1 << flag, "{fault:?}");
        assert!((count(&mut bench, "arm") - 100_000).abs() <= 2, "{fault:?}");

        assert_eq!(
            causes_after(&mut bench, fault, 3),
            Cause::EncoderError.bit(),
            "{fault:?}"
        );
        assert_eq!(bench.field("arm", "status", "state").unwrap(), state::FAULT);
        assert!(!bench.pins(0).drive_enable);
        assert_eq!(bench.field("arm", "flags", "encoder_lost").unwrap(), 1);
        assert_eq!(bench.field("arm", "status", "homed").unwrap(), 0);

        // The other axis stopped with it; after the host has cleared the faults, both go on.
        bench.displace(0, 5000.0);
        for axis in ["arm", "column"] {
            bench.write(&format!("{axis}_control"), 0).unwrap();
            bench.write(&format!("{axis}_clear_faults"), 0).unwrap();
        }
        bench.clocks(4 * TICK).unwrap();
        assert_eq!(bench.read("arm_causes").unwrap(), 0);
        assert!((count(&mut bench, "arm") - 105_000).abs() <= 2, "placed anew");
        assert_eq!(bench.read("arm_encoder_state").unwrap() & 0xffff, 1 << 8);
        assert!(bench.switch_on(10_000_000).unwrap());
    }
}

#[test]
fn a_jump_beyond_the_limits_is_no_reading() {
    let machine = arm();
    let mut bench = bench(&machine, 0.0);
    assert!(bench.switch_on(10_000_000).unwrap());
    // Twice what 200 mm/s move in a tick, and 8 counts, is 408.
    bench.displace(0, 300.0);
    bench.clocks(3 * TICK).unwrap();
    assert_eq!(bench.read("arm_encoder_state").unwrap() & 0xff, 0);
    bench.displace(0, 5000.0);
    bench.clocks(6 * TICK).unwrap();
    assert_ne!(bench.read("arm_encoder_state").unwrap() & 1 << 5, 0);
    assert_ne!(bench.read("arm_causes").unwrap() & Cause::EncoderError.bit(), 0);
}

#[test]
fn the_offset_acts_when_a_reading_places_the_axis() {
    let machine = arm();
    let mut bench = bench(&machine, 0.0);
    bench.clocks(2 * TICK).unwrap();
    bench.write("arm_encoder_offset", 33_554_432 + 70).unwrap();
    bench.clocks(2 * TICK).unwrap();
    assert_eq!(count(&mut bench, "arm"), 0);
    bench.fault_absolute_encoder(0, Some(AbsoluteFault::Stuck(true)));
    bench.clocks(4 * TICK).unwrap();
    bench.fault_absolute_encoder(0, None);
    bench.write("arm_clear_faults", 0).unwrap();
    bench.clocks(3 * TICK).unwrap();
    assert_eq!(count(&mut bench, "arm"), -70);
}

fn moves_and_loses_its_encoder(machine: &Machine) {
    let stage = stage(machine);
    let options = PlantOptions {
        position: 0.001,
        ..PlantOptions::default()
    };
    let mut bench = support::bench(machine, &stage, &options, Some(verilated(&stage)), 1);
    assert!(bench.switch_on(1_000_000).unwrap());
    queue_move(&mut bench, machine, 0, 500);
    queue_move(&mut bench, machine, 1, -500);
    bench.write("start", 0b11).unwrap();
    bench.clocks(60 * TICK).unwrap();
    bench.fault_absolute_encoder(1, Some(AbsoluteFault::Inverted(7)));
    bench.clocks(6 * TICK).unwrap();
    assert_eq!(bench.field("column", "status", "state").unwrap(), state::FAULT);
    let (differs, first) = bench.mismatches();
    assert_eq!(differs, 0, "{first:?}");
}

#[test]
fn lockstep_a_move_and_a_lost_encoder() {
    moves_and_loses_its_encoder(&arm());
}

#[test]
fn long_lockstep_a_move_and_a_lost_encoder_of_ssi() {
    moves_and_loses_its_encoder(&with_ssi());
}
