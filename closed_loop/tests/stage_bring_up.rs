//! A stage with linear scales and the aids for bringing it up: Verilog beside model, on the simulated machine.

use posicast_closed_loop::stage_bench::{StageBench, state};
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::PlantOptions;

use crate::support::{self, XY, queue_move};

/// Returns a machine on which the loop of X uses its scale and that of Y is supervised by one; both have a trace
/// memory.
fn machine() -> Machine {
    let bring_up = |usage: &str| {
        format!("[axis.scale]\ncounts_per_unit = 4_000_000\nuse = \"{usage}\"\n[axis.trace]\nsamples = 256\n[axis.pwm]")
    };
    let text = XY.replacen("[axis.pwm]", &bring_up("position"), 1);
    // Its mode is inside the loop on the scale, and allows a gain of 130/s.
    let text = text.replacen("kind = \"pd\"", "kind = \"pd\"\nproportional = 60.0", 1);
    let second = text.rfind("[axis.pwm]").unwrap();
    let text = format!(
        "{}{}{}",
        &text[..second],
        bring_up("monitor"),
        &text[second + "[axis.pwm]".len()..]
    );
    support::machine(&text)
}

fn bench(machine: &Machine, with_rtl: bool) -> StageBench {
    let stage = support::stage(machine);
    let device = with_rtl.then(|| support::verilated(&stage));
    support::bench(machine, &stage, &PlantOptions::default(), device, 1)
}

/// Moves one axis by this many counts of its loop.
fn move_by(machine: &Machine, bench: &mut StageBench, axis: usize, counts: i32) {
    queue_move(bench, machine, axis, counts);
    bench.write("start", 1 << axis).unwrap();
    bench.clocks(20_000).unwrap();
    assert!(bench.wait(&machine.axes[axis].name, state::HOLD, 20_000_000).unwrap());
    bench.clocks(250_000).unwrap();
}

/// Returns the words of a trace that is full or halted.
fn traced(bench: &mut StageBench, axis: &str) -> Vec<i32> {
    let rows = bench.field(axis, "trace_status", "trace_rows").unwrap();
    let words = (0..4 * rows).map(|word| {
        bench.write(&format!("{axis}_trace_address"), word).unwrap();
        bench.clocks(2).unwrap();
        bench.read(&format!("{axis}_trace_data")).unwrap() as i32
    });
    words.collect()
}

/// Setup for four signals: shaped position, captured position, error, test signal.
const SETUP: u32 = 3 | 6 << 4 | 8 << 8 | 11 << 12 | 2 << 16;

/// All outputs of the stage to the drive of X; 0 means off.
const DRIVE_PINS: [&str; 6] = [
    "x_a_high",
    "x_a_low",
    "x_b_high",
    "x_b_low",
    "x_drive_enable",
    "x_brake_release",
];

/// Checks for this many clocks, one by one, that no pin of X is on.
fn all_off(bench: &mut StageBench, clocks: u64) {
    for _ in 0..clocks {
        bench.clocks(1).unwrap();
        for pin in DRIVE_PINS {
            assert_eq!(bench.output(pin).unwrap(), 0, "{pin} in clock {}", bench.now());
        }
    }
}

/// Runs, from reset, the self-test of X's PWM in READY with this duty. Returns the clocks in which the gates of leg A
/// are on.
fn self_test(bench: &mut StageBench, duty: i32) -> (u32, u32) {
    bench.clocks(1000).unwrap();
    bench.write("x_clear_faults", 0).unwrap();
    assert!(bench.wait("x", state::READY, 100_000).unwrap());
    // The PWM starts once the second tick has found it in phase.
    bench.clocks(2 * 5000).unwrap();
    bench.write("x_control", 1 << 1 | 1 << 3).unwrap();
    bench.write("x_direct", duty as u32 & 0x1_ffff).unwrap();
    // The next tick takes the duty; one period later the following period is complete.
    all_off(bench, 3 * 5000);
    assert_eq!(bench.net("x_pwm_running").unwrap(), 1);
    let clocks = ["self_test_high", "self_test_low"].map(|field| bench.field("x", "self_test", field).unwrap());
    // In one case its flag is cleared first, in the other everything at once.
    let last = if duty < 0 { 1 << 1 } else { 0 };
    bench.write("x_control", last).unwrap();
    all_off(bench, 3 * 5000);
    assert_eq!(bench.net("x_pwm_running").unwrap(), 0);
    (clocks[0], clocks[1])
}

#[test]
fn a_self_test_runs_the_pwm_and_nothing_else() {
    let machine = machine();
    // Locked antiphase, 2500 clocks, dead time 25: the leg's duty is half of the sum of period and duty.
    for (duty, leg_duty) in [(0, 1250), (200, 1350), (-101, 1199)] {
        let mut bench = bench(&machine, false);
        let count = bench.plant(0).count();
        let high = leg_duty - 25;
        assert_eq!(self_test(&mut bench, duty), (high, 2500 - high - 2 * 25), "{duty}");
        assert_eq!(bench.plant(0).count(), count);
        assert!(bench.switch_on(20_000_000).unwrap());
        assert_eq!(bench.read("x_causes").unwrap(), 0);
    }
}

#[test]
fn long_lockstep_a_move_on_the_scale_and_its_trace() {
    let machine = machine();
    let mut bench = bench(&machine, true);
    assert_eq!(self_test(&mut bench, 200), (1325, 1125));
    assert!(bench.switch_on(20_000_000).unwrap());
    bench.record();
    // It traces every tick from the start of the move on.
    bench.write("x_trace_setup", SETUP | 3 << 24).unwrap();
    bench.write("x_trace_rate", 2 << 16).unwrap();
    bench.write("x_trace_arm", 0).unwrap();
    bench.clocks(20_000).unwrap();
    move_by(&machine, &mut bench, 0, 300);
    assert_eq!(bench.mismatches(), (0, None));

    let samples = bench.recorded().swap_remove(0);
    let words = traced(&mut bench, "x");
    let trigger = bench.field("x", "trace_status", "trace_trigger_row").unwrap() as usize;
    assert_eq!((words.len(), trigger), (256, 2));
    assert_eq!(bench.field("x", "bring_up_events", "trace_done").unwrap(), 1);
    // The trace holds what the bench saw at the same ticks.
    let shaped: Vec<f64> = words.chunks(4).map(|row| f64::from(row[0]) / 256.0).collect();
    let seen: Vec<f64> = samples.iter().map(|sample| sample.shaped).collect();
    assert!(
        seen.windows(shaped.len()).any(|window| window == shaped),
        "{shaped:?}\n{seen:?}"
    );
    assert!(shaped.last() > shaped.first());
    // 300 counts of the scale are 75 of the motor.
    let (scale, motor) = (bench.plant(0).scale_count().unwrap(), bench.plant(0).count());
    assert!((scale - 300).abs() <= 4 && (motor - 75).abs() <= 2, "{scale} {motor}");
    assert!((bench.field("x", "deviation", "deviation").unwrap() as i32).abs() <= 4);
}

#[test]
fn a_watched_scale_stops_what_leaves_it() {
    let mut machine = machine();
    let limits = machine.axes[1].limits.as_mut().unwrap();
    limits.deviation = Some(20e-6);
    let mut bench = bench(&machine, false);
    assert!(bench.switch_on(20_000_000).unwrap());
    move_by(&machine, &mut bench, 1, 500);
    assert_eq!(bench.read("y_causes").unwrap(), 0);
    // A scale that stands still while the motor moves means a broken coupling.
    let stands = bench.plant(1).scale();
    bench.force_scale(1, Some(stands));
    queue_move(&mut bench, &machine, 1, 500);
    bench.write("start", 2).unwrap();
    assert!(bench.wait("y", state::FAULT, 20_000_000).unwrap());
    assert_eq!(bench.read("y_causes").unwrap() & 1 << 8, 1 << 8);
}

#[test]
fn a_test_signal_shakes_the_axis_in_hold() {
    let machine = machine();
    let mut bench = bench(&machine, false);
    assert!(bench.switch_on(20_000_000).unwrap());
    // A square of 3 counts, 20 ticks long, for 100 ticks.
    bench.write("y_excitation_time", 20).unwrap();
    bench.write("y_excitation_length", 100).unwrap();
    bench.write("y_trace_setup", SETUP).unwrap();
    bench.write("y_trace_arm", 0).unwrap();
    bench.write("y_excitation", 3 | 1 << 4 | (3 << 8) << 16).unwrap();
    bench.clocks(10_000).unwrap();
    assert_eq!(bench.field("y", "excitation_state", "excitation_active").unwrap(), 1);
    bench.clocks(5000 * 120).unwrap();
    assert_eq!(bench.field("y", "bring_up_events", "excitation_done").unwrap(), 1);
    let words = traced(&mut bench, "y");
    let added: Vec<i32> = words.chunks(4).map(|row| row[3]).collect();
    assert!(added.contains(&768) && added.contains(&-768), "{added:?}");
    let reached = words.chunks(4).map(|row| row[1]);
    assert!(reached.clone().max() >= Some(2) && reached.min() <= Some(-2));
    assert_eq!(bench.read("y_causes").unwrap(), 0);
}

#[test]
fn the_generator_counts_without_a_machine() {
    let machine = machine();
    let mut bench = bench(&machine, false);
    bench.clocks(1000).unwrap();
    let before = bench.read("x_count").unwrap() as i32;
    // A count in 250 clocks: 20 per tick.
    bench.write("x_generator_rate", ((1u64 << 32) / 250) as u32).unwrap();
    bench.write("x_generator", 1).unwrap();
    bench.clocks(250_000).unwrap();
    let counted = bench.read("x_count").unwrap() as i32 - before;
    assert!((counted - 1000).abs() <= 4, "{counted}");
    let velocity = f64::from(bench.read("x_velocity").unwrap() as i32) / 65_536.0;
    assert!((velocity - 20.0).abs() < 0.01, "{velocity}");
}
