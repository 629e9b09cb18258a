//! The checks, each with the page of its numbers. `k` is an axis and `o` the other one.

use super::bed::*;

/// Name and check; each begins after a reset.
pub(super) type Check = (&'static str, fn(&mut Bed));

/// The checks, in the order of the pages.
pub(super) const CHECKS: [Check; 15] = [
    ("pins", pins_belong_to_their_axis),
    ("drive pins", drive_and_brake_belong_to_their_axis),
    ("gates", gates_follow_the_duty_of_their_axis),
    ("trigger", triggers_have_their_own_phase),
    ("faults", a_fault_stops_the_other_axis_by_quick_stop),
    ("emergency", an_emergency_stop_switches_both_off),
    ("limits", a_limit_switch_stops_its_own_direction),
    ("soft limits", soft_limits_look_at_the_shaped_position),
    ("following error", the_following_error_is_reference_minus_position),
    ("registers", registers_show_their_own_axis),
    ("capture", the_position_is_that_of_the_tick),
    ("velocity", velocities_are_counts_per_tick),
    ("snapshot", a_snapshot_is_of_one_clock),
    ("start", axes_start_in_one_tick_or_not_at_all),
    ("interrupts", interrupts_belong_to_their_axis),
];

/// register-tables.md, `STATUS`: bits 8 to 15 are filtered lines, bits 24:20 causes of a trip.
fn pins_belong_to_their_axis(bed: &mut Bed) {
    bed.clocks(1000);
    // In both axes an emergency stop and the PLL are the shared ones.
    for axis in 0..2 {
        assert_eq!(
            bed.of(axis, STATUS) >> 8 & 0xff,
            0x0f,
            "healthy lines, home and encoder low"
        );
        bed.write_of(axis, CLEAR_FAULTS, 0);
    }
    bed.clocks(100);
    let lines = [
        ("limit_plus_n", 0, 9),
        ("limit_minus_n", 0, 10),
        ("drive_ready", 0, 11),
        ("home", 1, 12),
        ("a", 1, 13),
        ("b", 1, 14),
        ("z", 1, 15),
        ("fault_n", 0, 20),
        ("drive_fault_n", 0, 22),
    ];
    for (k, name) in AXES.into_iter().enumerate() {
        for (pin, active, bit) in lines {
            let before = [bed.of(0, STATUS), bed.of(1, STATUS)];
            bed.set(&format!("{name}_{pin}"), active);
            bed.clocks(100);
            let after = [bed.of(0, STATUS), bed.of(1, STATUS)];
            let levels = 0x01f0_ff00;
            let changed = [0, 1].map(|axis| (before[axis] ^ after[axis]) & levels);
            let mut expected = [0, 0];
            expected[k] = 1 << bit;
            assert_eq!(changed, expected, "{name}_{pin}");
            bed.set(&format!("{name}_{pin}"), 1 - active);
            bed.clocks(100);
            for axis in [k, 1 - k] {
                bed.write_of(axis, CLEAR_FAULTS, 0);
                bed.clocks(100);
            }
        }
    }
    for (pin, bit) in [("emergency_stop_n", 8), ("pll_locked", 23)] {
        bed.set(pin, 0);
        bed.clocks(100);
        for axis in 0..2 {
            let status = bed.of(axis, STATUS);
            assert_eq!(status >> bit & 1, u32::from(bit == 23), "{pin}");
        }
        bed.set(pin, 1);
        bed.clocks(100);
    }
}

/// axis.md: `drive_enable` and `brake_release` come with HOLD, and go with `enable`.
fn drive_and_brake_belong_to_their_axis(bed: &mut Bed) {
    bed.clocks(1000);
    for axis in 0..2 {
        bed.write_of(axis, CLEAR_FAULTS, 0);
    }
    bed.ticks(1);
    for (k, name) in AXES.into_iter().enumerate() {
        let other = AXES[1 - k];
        bed.write_of(k, CONTROL, 1);
        bed.ticks(2);
        for pin in ["drive_enable", "brake_release"] {
            assert_eq!(
                (bed.pin(&format!("{name}_{pin}")), bed.pin(&format!("{other}_{pin}"))),
                (1, 0),
                "{name}_{pin}"
            );
        }
        assert_eq!([bed.state(k), bed.state(1 - k)], [HOLD, READY]);
        bed.write_of(k, CONTROL, 0);
        bed.wait_for(k, READY);
        assert_eq!(bed.pin(&format!("{name}_drive_enable")), 0);
    }
}

/// Clocks of a period of 2,500 in which each gate is on.
fn on_clocks(bed: &mut Bed, axis: &str) -> [u64; 4] {
    let mut on = [0; 4];
    for _ in 0..2500 {
        bed.clock();
        for (count, gate) in on.iter_mut().zip(["a_high", "a_low", "b_high", "b_low"]) {
            *count += bed.pin(&format!("{axis}_{gate}"));
        }
    }
    on
}

/// drive_command.md, self-test: with a period of 2500 and D = 25, duty 200 gives 1325 and 1125 in locked antiphase; pwm.md: leg B is the
/// other way round. A duty of −100: the leg duty is 1200, W = 1175, L = 2500 − 1175 − 50 = 1275.
fn gates_follow_the_duty_of_their_axis(bed: &mut Bed) {
    bed.clocks(1000);
    for axis in 0..2 {
        bed.write_of(axis, CLEAR_FAULTS, 0);
    }
    bed.clocks(100);
    for (k, name) in AXES.into_iter().enumerate() {
        let other = AXES[1 - k];
        bed.write_of(k, CONTROL, 2);
        bed.write_of(k, DIRECT, 200);
        bed.ticks(3);
        assert_eq!(on_clocks(bed, name), [1325, 1125, 1125, 1325], "{name}");
        assert_eq!(on_clocks(bed, other), [0; 4], "{other}");
        assert_eq!(
            (
                bed.pin(&format!("{name}_drive_enable")),
                bed.pin(&format!("{other}_drive_enable"))
            ),
            (1, 0)
        );
        bed.write_of(k, CONTROL, 0);
        bed.clocks(10);
        assert_eq!(on_clocks(bed, name), [0; 4], "{name}, off");
    }
    for axis in 0..2 {
        bed.write_of(axis, CONTROL, 2);
        bed.write_of(axis, DIRECT, if axis == 0 { 200 } else { -100_i32 as u32 });
    }
    bed.ticks(4);
    assert_eq!(on_clocks(bed, "x"), [1325, 1125, 1125, 1325]);
    assert_eq!(on_clocks(bed, "y"), [1175, 1275, 1275, 1175]);
}

/// stage.md: `pwm_trigger` is high for one clock per period, `PWM_TRIGGER` clocks after the valley; all PWMs have the tick's phase.
fn triggers_have_their_own_phase(bed: &mut Bed) {
    for (phases, apart) in [([100, 700], 600), ([1300, 40], 1240)] {
        (0..2).for_each(|axis| bed.write_of(axis, PWM_TRIGGER, phases[axis]));
        bed.ticks(3);
        let mut at = [Vec::new(), Vec::new()];
        for clock in 0..5000_i64 {
            bed.clock();
            for (k, name) in AXES.into_iter().enumerate() {
                if bed.pin(&format!("{name}_pwm_trigger")) == 1 {
                    at[k].push(clock);
                }
            }
        }
        assert_eq!([at[0].len(), at[1].len()], [2, 2]);
        assert!(at.iter().all(|at| at[1] - at[0] == 2500));
        assert_eq!((at[1][0] - at[0][0]).rem_euclid(2500), apart, "from x to y");
    }
}

/// stage.md, group stop, and axis.md, causes: a trip of one axis is bit 1 there and bit 14 in the other, which ends in HOLD and is no
/// fault of it. It must be cleared after the faulty one.
fn a_fault_stops_the_other_axis_by_quick_stop(bed: &mut Bed) {
    for (k, name) in AXES.into_iter().enumerate() {
        let o = 1 - k;
        bed.set("rst", 1);
        bed.clocks(4);
        bed.set("rst", 0);
        bed.hold();
        bed.long_move(o, true);
        bed.write(START, 1 << o);
        bed.ticks(8);
        assert_eq!([bed.state(k), bed.state(o)], [HOLD, RUN]);
        let pin = format!("{}_fault_n", name);
        bed.set(&pin, 0);
        bed.clocks(20);
        bed.set(&pin, 1);
        bed.clocks(20);
        assert_eq!([bed.state(k), bed.state(o)], [FAULT, QUICK_STOP]);
        assert_eq!([bed.of(k, CAUSES), bed.of(o, CAUSES)], [1 << 1, 1 << 14]);
        assert_eq!(bed.pin(&format!("{}_drive_enable", name)), 0);
        assert_eq!(
            bed.pin(&format!("{}_drive_enable", AXES[o])),
            1,
            "a healthy axis stays on"
        );
        // From 16 counts per tick by 1 count per tick² it takes 16 ticks, then two ticks settle.
        bed.ticks(12);
        assert_eq!(bed.state(o), QUICK_STOP);
        bed.ticks(12);
        assert_eq!(bed.state(o), HOLD);
        let stands = bed.of(o, COMMAND_POSITION);
        bed.ticks(2);
        assert_eq!(bed.of(o, COMMAND_POSITION), stands);
        // No start before its CLEAR_FAULTS; cleared before the faulty one, it has the group stop again.
        bed.write(FLAGS, u32::MAX);
        bed.write(START, 1 << o);
        bed.ticks(2);
        assert_eq!((bed.read(FLAGS), bed.state(o)), (1 << 2, HOLD));
        bed.write_of(o, CLEAR_FAULTS, 0);
        bed.clocks(40);
        assert_eq!(bed.of(o, CAUSES), 1 << 14);
        bed.write_of(k, CLEAR_FAULTS, 0);
        bed.clocks(40);
        bed.write_of(o, CLEAR_FAULTS, 0);
        bed.clocks(40);
        assert_eq!([bed.of(k, CAUSES), bed.of(o, CAUSES)], [0, 0]);
        assert_eq!(bed.of(o, STATUS) >> 3 & 1, 1, "can_start");
    }
}

/// axis.md, timing: `filter_clocks` + 4 clocks after the line, the outputs are off; verification.md, `stage_axis`: drive and brake at the
/// pins one clock later, and the bridge another one later.
fn an_emergency_stop_switches_both_off(bed: &mut Bed) {
    bed.hold();
    bed.set("emergency_stop_n", 0);
    // The filter of the example is 0 clocks long: its drive lines are not filtered. Clock 0 is the one in which the line goes low.
    bed.clocks(5);
    let on = AXES.map(|axis| bed.pin(&format!("{axis}_drive_enable")));
    assert_eq!(on, [1, 1], "4 clocks after the line");
    bed.clocks(1);
    let all_are_off = |bed: &Bed, pins: &[&str]| {
        for (axis, pin) in AXES.iter().flat_map(|axis| pins.iter().map(move |pin| (axis, pin))) {
            assert_eq!(bed.pin(&format!("{axis}_{pin}")), 0, "{axis}_{pin}");
        }
    };
    all_are_off(bed, &["drive_enable", "brake_release"]);
    bed.clocks(1);
    all_are_off(
        bed,
        &["drive_enable", "brake_release", "a_high", "a_low", "b_high", "b_low"],
    );
    bed.clocks(20);
    for axis in 0..2 {
        assert_eq!((bed.state(axis), bed.of(axis, CAUSES) & 1), (FAULT, 1));
    }
}

/// axis.md: the switch in the direction of the motion is cause 3 or 4; the other switch causes no fault.
fn a_limit_switch_stops_its_own_direction(bed: &mut Bed) {
    for (k, up) in [(0, true), (0, false), (1, true), (1, false)] {
        bed.set("rst", 1);
        bed.clocks(4);
        bed.set("rst", 0);
        bed.hold();
        bed.long_move(k, up);
        bed.write(START, 1 << k);
        bed.ticks(8);
        let pin = |plus: bool| format!("{}_limit_{}_n", AXES[k], if plus { "plus" } else { "minus" });
        bed.set(&pin(!up), 0);
        bed.ticks(3);
        assert_eq!((bed.state(k), bed.of(k, CAUSES)), (RUN, 0), "the switch behind it");
        bed.set(&pin(!up), 1);
        bed.set(&pin(up), 0);
        bed.ticks(3);
        assert_eq!(bed.of(k, CAUSES), if up { 1 << 3 } else { 1 << 4 });
        assert_eq!(bed.of(1 - k, CAUSES), 1 << 14);
        bed.set(&pin(up), 1);
    }
}

/// axis.md, cause 5 and 6, and shaper-design.md: ZVD of the example has (1, 2 K, K²)/(1 + K)², K = exp(−ζ π/√(1 − ζ²)). X: K = 0.6052
/// and half a period of 38.6 samples; a jump of 150 counts is 58.2 counts at once, 128.7 after 39 samples. Y: ζ = 0.1535, K = 0.6138,
/// 57.6 counts at once, 128.3 after half a period of 54.2 samples.
fn soft_limits_look_at_the_shaped_position(bed: &mut Bed) {
    for (k, plus, half_period) in [(0, true, 39), (0, false, 39), (1, true, 55), (1, false, 55)] {
        bed.set("rst", 1);
        bed.clocks(4);
        bed.set("rst", 0);
        bed.hold();
        let sign = if plus { 1 } else { -1 };
        bed.write_of(k, SOFT_LIMIT_PLUS, if plus { 100 << 8 } else { 100_000 << 8 });
        bed.write_of(
            k,
            SOFT_LIMIT_MINUS,
            if plus {
                -(100_000_i32 << 8) as u32
            } else {
                -(100_i32 << 8) as u32
            },
        );
        // Neither the measured position nor the command counts.
        bed.encoder(k, sign * 120);
        bed.ticks(2);
        assert_eq!(bed.of(k, CAUSES), 0, "the measured position is beyond the limit");
        bed.encoder(k, -sign * 120);
        bed.point(k, sign as i32 * (150 << 8), 200);
        bed.write(START, 1 << k);
        bed.ticks(5);
        assert_eq!(bed.of(k, COMMAND_POSITION), (sign as i32 * (150 << 8)) as u32);
        let shaped = bed.of(k, SHAPED_POSITION) as i32 as f64 / 256.0;
        let first = if k == 0 { 58.2 } else { 57.6 };
        assert!((shaped - sign as f64 * first).abs() < 0.3, "{shaped}");
        bed.ticks(half_period - 10);
        assert_eq!(
            (bed.of(k, CAUSES), bed.state(k)),
            (0, RUN),
            "the command alone is beyond the limit"
        );
        bed.ticks(14);
        assert_eq!(bed.of(k, CAUSES), if plus { 1 << 5 } else { 1 << 6 });
        assert_eq!(bed.of(1 - k, CAUSES), 1 << 14);
    }
}

/// sliding_mode.md: e = r − x in Q16.16. axis.md: cause 7 above the limit; the size of a negative e is one LSB less.
fn the_following_error_is_reference_minus_position(bed: &mut Bed) {
    for (k, up) in [(0, 1), (0, -1), (1, 1), (1, -1)] {
        bed.set("rst", 1);
        bed.clocks(4);
        bed.set("rst", 0);
        bed.hold();
        bed.write_of(k, FOLLOWING_ERROR_LIMIT, 100 << 16);
        bed.encoder(k, up * 100);
        bed.ticks(3);
        assert_eq!(bed.of(k, ERROR) as i32, -up as i32 * (100 << 16));
        assert_eq!(bed.of(1 - k, ERROR), 0);
        assert_eq!([bed.of(k, CAUSES), bed.of(1 - k, CAUSES)], [0, 0], "at the limit");
        bed.encoder(k, up);
        bed.ticks(3);
        assert_eq!(
            [bed.of(k, CAUSES), bed.of(1 - k, CAUSES)],
            [1 << 7, 1 << 14],
            "a count beyond it"
        );
    }
}

/// stage.md, position and homing; pulse_counter.md: `POSITION` = `COUNT` − `ORIGIN`; a preset and an index move the origin alone.
fn registers_show_their_own_axis(bed: &mut Bed) {
    bed.clocks(1000);
    bed.encoder(0, 10);
    bed.encoder(1, -7);
    assert_eq!([bed.of(0, COUNT), bed.of(1, COUNT)], [10, -7_i32 as u32]);
    bed.write_of(0, PRESET, 1000);
    bed.write_of(1, PRESET, 2000);
    bed.clocks(8);
    assert_eq!([bed.of(0, POSITION), bed.of(1, POSITION)], [1000, 2000]);
    assert_eq!(
        [bed.of(0, ORIGIN), bed.of(1, ORIGIN)],
        [-990_i32 as u32, -2007_i32 as u32]
    );
    assert_eq!(
        [bed.of(0, COUNT), bed.of(1, COUNT)],
        [10, -7_i32 as u32],
        "a preset does not move the count"
    );
    // An index presets the position if the register selects that; the value is the last one written.
    for (k, name, count) in [(0, "x", 15_i32), (1, "y", -2)] {
        bed.write_of(k, INDEX, 2);
        bed.write_of(k, INDEX_ARM, 0);
        bed.encoder(k, 5);
        bed.set(&format!("{name}_z"), 1);
        bed.clocks(40);
        bed.set(&format!("{name}_z"), 0);
        bed.clocks(40);
        assert_eq!(bed.of(k, INDEX_COUNT), count as u32);
        assert_eq!(bed.of(k, POSITION), [1000, 2000][k]);
    }
    assert_eq!(bed.of(0, INDEX_COUNT), 15);
    // The windows do not share a word: what can be read back, with a pattern of its own per axis.
    for (word, mask) in [
        (SOFT_LIMIT_PLUS, u32::MAX),
        (SOFT_LIMIT_MINUS, u32::MAX),
        (FOLLOWING_ERROR_LIMIT, u32::MAX),
        (SETTLE, 0xffff),
    ] {
        bed.write_of(0, word, 0x1234_5678);
        bed.write_of(1, word, 0x0fed_cba9);
        assert_eq!(
            [bed.of(0, word), bed.of(1, word)],
            [0x1234_5678 & mask, 0x0fed_cba9 & mask]
        );
    }
}

/// axis.md: the controller takes the position of the tick. Steps between the tick and the controller's start, 210 clocks later
/// (`CONTROL_CLOCKS`), belong to the next tick.
fn the_position_is_that_of_the_tick(bed: &mut Bed) {
    bed.hold();
    for k in 0..2 {
        bed.next_tick();
        bed.clocks(1);
        // Six steps in 72 clocks and the filter's time: counted well before clock 210.
        bed.encoder(k, 6);
        bed.clocks(1000);
        assert_eq!(bed.of(k, ERROR), 0, "those of after the tick do not count");
        assert_eq!(bed.of(k, COUNT), 6);
        bed.next_tick();
        bed.clocks(1000);
        assert_eq!(bed.of(k, ERROR) as i32, -6 << 16);
        assert_eq!(bed.of(1 - k, ERROR) as i32, if k == 0 { 0 } else { -6 << 16 });
    }
}

/// pulse_counter.md: with `velocity_m` the velocity is the counts per tick, Q16.16.
fn velocities_are_counts_per_tick(bed: &mut Bed) {
    bed.clocks(1000);
    for axis in 0..2 {
        bed.write_of(axis, INDEX, 1 << 12);
    }
    for _ in 0..4 {
        bed.next_tick();
        bed.encoder(0, 10);
        bed.encoder(1, -7);
    }
    bed.next_tick();
    bed.clocks(400);
    assert_eq!(
        [bed.of(0, VELOCITY), bed.of(1, VELOCITY)],
        [10 << 16, (-7_i32 << 16) as u32]
    );
}

/// stage.md, snapshot: one clock of all axes, time stamp and tick count.
fn a_snapshot_is_of_one_clock(bed: &mut Bed) {
    bed.clocks(1000);
    for (pause, steps) in [(3, 9), (40, 5), (7777, 23), (1, 1)] {
        // Both encoders step in the same clocks, so every snapshot has equal positions.
        (0..steps).for_each(|_| bed.step([1, 1]));
        bed.step([1, 1]);
        let ticks = bed.read(TICK_COUNT);
        bed.write(SNAPSHOT, 0);
        let taken = bed.now;
        (0..5).for_each(|_| bed.step([1, -1]));
        bed.clocks(pause);
        let [x, y] = [bed.of(0, SNAPSHOT_POSITION), bed.of(1, SNAPSHOT_POSITION)];
        assert_eq!(x, y);
        assert_ne!(bed.of(0, POSITION), x, "the live word has moved on");
        let stamp = bed.read(SNAPSHOT_TIME_STAMP);
        let live = bed.read(TIME_STAMP);
        // The read of the live word takes two clocks and returns the value of the first.
        assert_eq!(u64::from(live - stamp), bed.now - 2 - (taken - 1));
        let at_the_snapshot = bed.read(SNAPSHOT_TICK_COUNT);
        assert!(
            (ticks..=ticks + 1).contains(&at_the_snapshot),
            "{at_the_snapshot}, {ticks} before"
        );
        // Back, so that both stand at equal positions again.
        (0..5).for_each(|_| bed.step([-1, 1]));
    }
}

/// stage.md, start and group stop; feed hold; commit.
fn axes_start_in_one_tick_or_not_at_all(bed: &mut Bed) {
    bed.hold();
    (0..2).for_each(|axis| bed.long_move(axis, axis == 0));
    bed.write(START, 3);
    bed.next_tick();
    let mut first = [0_u32; 2];
    for tick in 1..8 {
        bed.clocks(100);
        for (axis, first) in first.iter_mut().enumerate() {
            if bed.of(axis, COMMAND_POSITION) != 0 && *first == 0 {
                *first = tick;
            }
        }
        bed.next_tick();
    }
    assert!(first[0] > 0 && first[0] == first[1], "{first:?}");
    assert_eq!(
        [bed.of(0, COMMAND_POSITION) >> 31, bed.of(1, COMMAND_POSITION) >> 31],
        [0, 1]
    );
    // STOP is of its axis alone, and its quick stop is no cause.
    bed.write_of(0, STOP, 0);
    bed.clocks(20);
    assert_eq!([bed.state(0), bed.state(1)], [QUICK_STOP, RUN]);
    bed.ticks(40);
    assert_eq!([bed.state(0), bed.state(1), bed.of(0, CAUSES)], [HOLD, RUN, 0]);
    // Y runs and cannot start, so X does not start either.
    bed.long_move(0, true);
    bed.write(FLAGS, u32::MAX);
    bed.write(START, 3);
    bed.ticks(3);
    assert_eq!((bed.read(FLAGS), bed.state(0)), (1 << 2, HOLD));
    bed.write(START, 1);
    bed.ticks(3);
    assert_eq!(bed.state(0), RUN);
    // A hold of X, which never rests: Y goes on. A commit takes the next tick.
    bed.write(FEED_HOLD, 1);
    let before = bed.of(1, COMMAND_POSITION);
    bed.ticks(3);
    assert_ne!(bed.of(1, COMMAND_POSITION), before);
    bed.clocks(100);
    bed.write_of(0, LAW, 2);
    bed.write(COMMIT, 0);
    bed.clocks(4);
    assert_eq!(bed.read(COMMIT), 1);
    bed.write(COMMIT, 0);
    bed.clocks(4);
    assert_eq!(bed.read(FLAGS) >> 1 & 1, 1, "a write while one waits");
    bed.next_tick();
    bed.clocks(4);
    assert_eq!(bed.read(COMMIT), 0);
}

/// register-tables.md: bit 7 · axis + k is notify, move_done, fifo_low, halted, stopping, faulted, index_seen; 28 tick, 29 start_refused.
fn interrupts_belong_to_their_axis(bed: &mut Bed) {
    bed.hold();
    // At most one entry waits: low. Two entries end that.
    for (k, name) in AXES.into_iter().enumerate() {
        let base = 7 * k as u32;
        let own = |bed: &mut Bed| bed.read(INTERRUPT_STATE) & 0x3fff;
        let low = |bed: &mut Bed| {
            // `fifo_low` is a state: both FIFOs are empty in between.
            bed.write(INTERRUPT_STATE, u32::MAX);
            bed.clocks(4);
            own(bed)
        };
        (0..2).for_each(|axis| bed.write_of(axis, FIFO_CONTROL, 1));
        assert_eq!(low(bed), 1 << 2 | 1 << 9);
        (0..3).for_each(|_| bed.point(k, 0, 1));
        bed.clocks(10);
        assert_eq!(low(bed), 1 << (9 - base), "three entries wait in {}", name);
        // They end at rest, without `notify`; the axis comes to RUN and back.
        bed.write(START, 1 << k);
        bed.ticks(8);
        let other_low = 1 << (9 - base);
        assert_eq!(
            own(bed),
            other_low | (1 << 1 | 1 << 2 | 1 << 3) << base,
            "move_done, fifo_low, halted of {}",
            name
        );
        // An entry with `notify`.
        low(bed);
        for (at, word) in [0, 0, 0, 1 << 31 | 1 << 30 | 1].into_iter().enumerate() {
            bed.write_of(k, SEGMENT + at as u32, word);
        }
        bed.write(START, 1 << k);
        bed.ticks(8);
        assert_eq!(
            own(bed) & !(1 << 2 | 1 << 9),
            (1 | 1 << 1 | 1 << 3) << base,
            "notify of {}",
            name
        );
        // A stop, and an index.
        bed.long_move(k, true);
        bed.write(START, 1 << k);
        bed.ticks(5);
        low(bed);
        bed.write_of(k, STOP, 0);
        bed.clocks(20);
        assert_eq!(own(bed) & !(1 << 2 | 1 << 9), 1 << 4 << base, "stopping");
        bed.ticks(30);
        low(bed);
        bed.write_of(k, INDEX_ARM, 0);
        bed.clocks(4);
        bed.set(&format!("{}_z", name), 1);
        bed.clocks(30);
        bed.set(&format!("{}_z", name), 0);
        bed.clocks(30);
        assert_eq!(own(bed) & !(1 << 2 | 1 << 9), 1 << 6 << base, "index_seen");
        // The pin follows state and enable.
        bed.write(INTERRUPT_ENABLE, 1 << 6 << base);
        bed.clocks(4);
        assert_eq!(bed.pin("irq"), 1);
        bed.write(INTERRUPT_ENABLE, 1 << 6 << (7 - base));
        bed.clocks(4);
        assert_eq!(bed.pin("irq"), 0);
    }
    bed.next_tick();
    bed.clocks(20);
    bed.write(INTERRUPT_STATE, u32::MAX);
    bed.write(START, 4);
    bed.clocks(10);
    assert_eq!(
        bed.read(INTERRUPT_STATE) >> 28 & 3,
        2,
        "start_refused of an axis that is not there"
    );
    bed.next_tick();
    bed.clocks(4);
    assert_eq!(bed.read(INTERRUPT_STATE) >> 28 & 1, 1);
    bed.write(INTERRUPT_STATE, u32::MAX);
    bed.set("y_fault_n", 0);
    bed.clocks(20);
    bed.set("y_fault_n", 1);
    bed.clocks(20);
    assert_eq!(
        bed.read(INTERRUPT_STATE) & 0x3fff & !(1 << 2 | 1 << 9),
        1 << 12,
        "faulted of y; x stays in HOLD"
    );
}
