//! Checks the guards of a stage: changes of the feedback's sign with the drive on are refused, an axis waits for a PWM
//! that is out of step, every interrupt can be cleared, and soft limits may wait for homing.

use posicast_blocks::axis::Cause;
use posicast_closed_loop::stage_bench::{StageBench, state};
use posicast_machine::motion::{TickLimits, plan_move};
use posicast_machine::plant::axis::{EncoderPins, PlantOptions};

use crate::support::{self, XY, machine, queue_move, stage};

/// Returns the example's stage with a linear scale and an encoder generator at X, on its simulated machine. With
/// `invert`, encoder and scale of X are wired backwards and the file sets `invert`.
fn bench(invert: bool) -> StageBench {
    bench_of(invert, "")
}

/// The same with more keys in `[axis.limits]` of X.
fn bench_of(invert: bool, limits: &str) -> StageBench {
    let more = format!(
        "[axis.scale]\ncounts_per_unit = 4_000_000\nuse = \"monitor\"\ninvert = {invert}\n[axis.trace]\nsamples = 256\n[axis.pwm]"
    );
    let text = XY.replacen("[axis.pwm]", &more, 1);
    let encoder = format!("[axis.encoder]\ninvert = {invert}");
    let text = text.replacen("[axis.encoder]", &encoder, 1);
    let text = text.replacen("[axis.limits]", &format!("[axis.limits]\n{limits}"), 1);
    let machine = machine(&text);
    support::bench(&machine, &stage(&machine), &PlantOptions::default(), None, 1)
}

/// Goes from reset to HOLD with the words of the documented bring-up, and the brake released.
fn switch_on(bench: &mut StageBench, axis: &str) {
    bench.clocks(1000).unwrap();
    bench.write(&format!("{axis}_clear_faults"), 0).unwrap();
    assert!(bench.wait(axis, state::READY, 100_000).unwrap());
    bench.write(&format!("{axis}_control"), 1).unwrap();
    assert!(bench.wait(axis, state::HOLD, 100_000).unwrap());
    while bench.field(axis, "status", "can_start").unwrap() == 0 {
        bench.clocks(1000).unwrap();
    }
}

/// Registers that select the loop's position.
const FEEDBACK: [&str; 3] = ["x_encoder", "x_scale_control", "x_generator"];

#[test]
fn the_feedback_is_not_changed_while_the_drive_is_on() {
    let mut bench = bench(false);
    switch_on(&mut bench, "x");
    for register in FEEDBACK {
        bench.write("flags", 1 << 3).unwrap();
        bench.write(register, 1).unwrap();
        bench.clocks(4).unwrap();
        assert_eq!(bench.read(register).unwrap(), 0, "{register}");
        assert_eq!(bench.read("flags").unwrap(), 1 << 3, "{register}");
    }
    // The former bit 2 of CONTROL no longer belongs to it.
    bench.write("x_control", 0b101).unwrap();
    bench.clocks(50_000).unwrap();
    assert_eq!(
        (bench.read("x_control").unwrap(), bench.read("x_causes").unwrap()),
        (1, 0)
    );
    assert_eq!(bench.field("x", "status", "state").unwrap(), state::HOLD);

    // Once the brake is applied and the drive off, they are accepted.
    bench.write("x_control", 0).unwrap();
    assert!(bench.wait("x", state::READY, 20_000_000).unwrap());
    bench.clocks(10_000).unwrap();
    bench.write("flags", 1 << 3).unwrap();
    for register in FEEDBACK {
        bench.write(register, 1).unwrap();
        bench.clocks(4).unwrap();
        assert_eq!(bench.read(register).unwrap(), 1, "{register}");
    }
    assert_eq!(bench.read("flags").unwrap(), 0);
}

/// The lines of this machine count backwards, which its file states; the documented bring-up keeps the sign.
#[test]
fn a_machine_wired_backwards_moves_by_its_file() {
    let mut bench = bench(true);
    switch_on(&mut bench, "x");
    assert_eq!(
        (bench.read("x_encoder").unwrap(), bench.read("x_scale_control").unwrap()),
        (1, 1)
    );
    let machine = machine(XY);
    let limits = TickLimits::of_axis(&machine.axes[0], &machine.clock);
    for entry in plan_move(0, 1000 * 256, &limits).unwrap() {
        bench.segment("x", &entry).unwrap();
    }
    bench.write("start", 1).unwrap();
    bench.clocks(20_000).unwrap();
    assert!(bench.wait("x", state::HOLD, 20_000_000).unwrap());
    bench.clocks(500_000).unwrap();
    assert_eq!(bench.read("x_causes").unwrap(), 0);
    let [count, scale] = ["x_count", "x_scale_count"].map(|register| bench.read(register).unwrap() as i32);
    assert!((count - 1000).abs() <= 2, "{count}");
    assert!((scale - 4000).abs() <= 40, "{scale}");
}

/// A host enables at once, in direct mode and from there in HOLD: the PWM waits for the time base.
#[test]
fn the_pwm_never_runs_out_of_step() {
    for wait in [50, 700, 1300, 2700, 4800] {
        let mut bench = bench(false);
        bench.clocks(wait).unwrap();
        bench.write("x_clear_faults", 0).unwrap();
        assert!(bench.wait("x", state::READY, 100_000).unwrap());
        bench.write("x_control", 2).unwrap();
        for _ in 0..4 {
            bench.write("x_direct", 50).unwrap();
            bench.clocks(5000).unwrap();
            assert_eq!(bench.field("x", "flags", "pwm_unaligned").unwrap(), 0, "wait {wait}");
        }
        assert_eq!(bench.net("x_pwm_running").unwrap(), 1);
        bench.write("x_control", 1).unwrap();
        assert!(bench.wait("x", state::HOLD, 100_000).unwrap());
        bench.clocks(20_000).unwrap();
        assert_eq!(bench.net("x_pwm_running").unwrap(), 1);
        assert_eq!(bench.field("x", "flags", "pwm_unaligned").unwrap(), 0, "wait {wait}");
    }
}

/// Each index interrupts, and writing a one to the state clears it, like any other interrupt.
#[test]
fn an_index_interrupts_once() {
    const INDEX_SEEN: u32 = 1 << 6;
    let mut bench = bench(false);
    bench.clocks(1000).unwrap();
    bench.write("x_index", 1).unwrap();
    // A count in 250 clocks, an index in 100 counts.
    bench.write("x_generator_rate", ((1u64 << 32) / 250) as u32).unwrap();
    bench.write("x_generator", 1 | 100 << 16).unwrap();
    let mut latched = Vec::new();
    while latched.len() < 3 {
        bench.clocks(100).unwrap();
        if bench.read("interrupt_state").unwrap() & INDEX_SEEN != 0 {
            latched.push(bench.read("x_index_count").unwrap() as i32);
            bench.write("interrupt_state", INDEX_SEEN).unwrap();
            bench.clocks(4).unwrap();
            assert_eq!(bench.read("interrupt_state").unwrap() & INDEX_SEEN, 0);
        }
    }
    assert_eq!(
        [latched[1] - latched[0], latched[2] - latched[1]],
        [100, 100],
        "{latched:?}"
    );
}

/// The pin for an ADC is active for a clock in each period, at the phase of the register.
#[test]
fn the_trigger_comes_at_its_phase() {
    let mut bench = bench(false);
    // After two ticks the PWM is in phase.
    bench.clocks(12_000).unwrap();
    let mut phases = |phase| {
        bench.write("x_pwm_trigger", phase).unwrap();
        let mut seen = Vec::new();
        let mut since_tick = None;
        for _ in 0..15_000 {
            bench.clocks(1).unwrap();
            since_tick = match bench.output("tick").unwrap() {
                1 => Some(0),
                _ => since_tick.map(|clocks| clocks + 1),
            };
            if bench.output("x_pwm_trigger").unwrap() == 1 {
                seen.extend(since_tick);
            }
        }
        seen
    };
    // Position 0 is in the clock after the tick, and the pins follow by a clock.
    let at_valley = phases(0);
    assert!(
        at_valley.len() >= 4 && at_valley.iter().all(|clocks| clocks % 2500 == 2),
        "{at_valley:?}"
    );
    let later = phases(1250);
    assert!(later.iter().all(|clocks| clocks % 2500 == 1252), "{later:?}");
}

/// Moves X by this many counts, and returns its causes at the end.
fn moved(bench: &mut StageBench, counts: i32) -> u32 {
    queue_move(bench, &machine(XY), 0, counts);
    bench.write("start", 1).unwrap();
    bench.clocks(20_000).unwrap();
    let _ = bench.wait("x", state::HOLD, 3_000_000).unwrap();
    bench.clocks(500_000).unwrap();
    bench.read("x_causes").unwrap()
}

#[test]
fn soft_limits_act_before_homing_unless_the_file_says_otherwise() {
    for after_homing in [false, true] {
        let mut bench = bench_of(false, &format!("soft_limits_after_homing = {after_homing}"));
        switch_on(&mut bench, "x");
        // The file's limits have no meaning yet: the axis may be anywhere in its travel.
        bench.write("x_soft_limit_plus", 500 << 8).unwrap();
        let causes = moved(&mut bench, 1000);
        assert_eq!(causes, if after_homing { 0 } else { Cause::SoftLimitPlus.bit() });
        assert_eq!(bench.field("x", "status", "homed").unwrap(), 0);
        if !after_homing {
            continue;
        }
        bench.write("x_soft_limit_plus", 1500 << 8).unwrap();
        bench.write("x_homed", 1).unwrap();
        bench.clocks(10_000).unwrap();
        assert_eq!(bench.field("x", "status", "homed").unwrap(), 1);
        assert_eq!(bench.read("x_causes").unwrap(), 0);
        assert_eq!(moved(&mut bench, 1000), Cause::SoftLimitPlus.bit());
        // After an error of the encoder the position may be wrong.
        let lines = bench.plant(0).encoder();
        let pins = EncoderPins {
            a: !lines.a,
            b: !lines.b,
            ..lines
        };
        bench.force_encoder(0, Some(pins));
        bench.clocks(1000).unwrap();
        assert_eq!(bench.field("x", "status", "homed").unwrap(), 0);
    }
}
