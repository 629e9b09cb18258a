//! The supervisor of an axis: what a motion engineer expects of it, and `hold` compared with `step`.

use posicast_blocks::axis::{
    Axis, CLEAR_CLOCKS, Cause, INPUT_PORTS, Inputs, KICK, LINE_CLOCKS, Outputs, SupervisorState, WATCH_CLOCKS,
};
use posicast_blocks::segments::{self, Entry, EntryMotion, STAND_COUNTS, Segments};
use proptest::prelude::*;

/// Number of clocks per tick in these tests.
const TICK_CLOCKS: u64 = 160;

/// Inputs of an axis that is healthy and idle.
const GOOD: Inputs = {
    let mut inputs = ZERO;
    inputs.emergency_stop_n = true;
    inputs.limit_plus_n = true;
    inputs.limit_minus_n = true;
    inputs.drive_ready = true;
    inputs.segments_empty = true;
    inputs.brake_release_ticks = 3;
    inputs.brake_apply_ticks = 4;
    inputs.settle_ticks = 5;
    inputs
};

const ZERO: Inputs = Inputs {
    rst: false,
    tick: false,
    emergency_stop_n: false,
    limit_plus_n: false,
    limit_minus_n: false,
    drive_ready: false,
    home: false,
    filter_clocks: 0,
    enable: false,
    start: false,
    stop: false,
    clear_faults: false,
    kick: false,
    kick_word: 0,
    write_homed: false,
    homed_value: false,
    group_stop: false,
    group_emergency_stop: false,
    off_causes: 0,
    brake_release_ticks: 0,
    brake_apply_ticks: 0,
    settle_ticks: 0,
    soft_limit_plus: 0,
    soft_limit_minus: 0,
    limits_after_homing: false,
    following_error_limit: 0,
    deviation_limit: 0,
    saturation_ticks: 0,
    lost_command: 0,
    lost_ticks: 0,
    watches_direction: false,
    watchdog_ticks: 0,
    modulo: false,
    position: 0,
    deviation: 0,
    segments_state: 0,
    segments_empty: false,
    segments_valid: false,
    segments_underrun: false,
    segments_overflow: false,
    segments_tick_missed: false,
    segments_out_of_range: false,
    command_velocity: 0,
    reference_position: 0,
    reference_velocity: 0,
    shaper_saturated: false,
    shaper_overrun: false,
    error: 0,
    command: 0,
    limited_ticks: 0,
    saturated_high: 0,
    saturated_low: 0,
    controller_overrun: false,
    pwm_tripped: false,
    encoder_illegal: false,
    encoder_disagreement: false,
    velocity_missed: false,
    scale_illegal: false,
    scale_disagreement: false,
};

/// A supervisor with its segments, and ticks.
struct Bench {
    axis: Axis,
    segments: Segments,
    inputs: Inputs,
    commands: segments::Inputs,
    clock: u64,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            axis: Axis::new(),
            segments: Segments::new(3),
            inputs: GOOD,
            commands: segments::Inputs {
                stop_deceleration: 1 << 23,
                ..segments::Inputs::default()
            },
            clock: 0,
        };
        bench.clocks(60);
        bench
    }

    fn clock(&mut self) -> Outputs {
        let played = self.segments.outputs(0);
        self.inputs.tick = self.clock % TICK_CLOCKS == TICK_CLOCKS - 1;
        self.inputs.segments_state = played.state as u8;
        self.inputs.segments_empty = played.empty;
        self.inputs.segments_valid = played.valid;
        self.inputs.segments_underrun = played.underrun;
        self.inputs.segments_overflow = played.overflow;
        self.inputs.segments_out_of_range = played.out_of_range;
        self.inputs.command_velocity = played.velocity;
        // There is no shaper.
        self.inputs.reference_position = played.position;
        self.inputs.reference_velocity = played.velocity;
        let shown = self.axis.step(&self.inputs);
        self.segments.step(&segments::Inputs {
            tick: self.inputs.tick,
            enable: shown.segments_enable,
            quick_stop: shown.segments_quick_stop,
            restart: shown.segments_restart,
            preset: shown.segments_preset,
            preset_position: self.inputs.position,
            clear_flags: shown.clear_sources,
            ..self.commands
        });
        self.commands.write = false;
        self.clock += 1;
        (self.inputs.start, self.inputs.stop) = (false, false);
        (self.inputs.clear_faults, self.inputs.kick) = (false, false);
        self.axis.outputs()
    }

    fn clocks(&mut self, clocks: u64) -> Outputs {
        (0..clocks).for_each(|_| {
            self.clock();
        });
        self.axis.outputs()
    }

    fn ticks(&mut self, ticks: u64) -> Outputs {
        self.clocks(ticks * TICK_CLOCKS)
    }

    /// Clocks until the state is reached, for at most this many clocks; returns their number.
    fn until(&mut self, state: SupervisorState, at_most: u64) -> u64 {
        for clocks in 0..=at_most {
            if self.axis.outputs().state == state {
                return clocks;
            }
            self.clock();
        }
        panic!("no {state:?} after {at_most} clocks: {:?}", self.axis.outputs());
    }

    /// Commits a segment with a jerk in 2^-32 counts per tick³.
    fn segment(&mut self, ticks: u32, jerk: i64) {
        let entry = Entry {
            ticks,
            motion: EntryMotion::Jerk(jerk),
            notify: false,
        };
        for (word, data) in (0..).zip(entry.words()) {
            self.commands = segments::Inputs {
                write: true,
                word,
                data,
                ..self.commands
            };
            self.clock();
        }
    }

    /// Brings the axis to HOLD, with the brake released.
    fn hold() -> Self {
        let mut bench = Self::new();
        bench.until(SupervisorState::Ready, 20);
        bench.inputs.enable = true;
        bench.until(SupervisorState::Hold, TICK_CLOCKS);
        bench.ticks(4);
        assert!(bench.axis.outputs().can_start);
        bench
    }

    /// Brings the axis to RUN, in a move of 80 ticks whose velocity is positive.
    fn run(jerk: i64) -> Self {
        let mut bench = Self::hold();
        for (ticks, jerk) in [(20, jerk), (40, -jerk), (20, jerk)] {
            bench.segment(ticks, jerk);
        }
        bench.inputs.start = true;
        bench.until(SupervisorState::Run, TICK_CLOCKS);
        bench.ticks(30);
        assert_eq!(bench.axis.outputs().state, SupervisorState::Run);
        assert_eq!(bench.segments.outputs(0).state, segments::SegmentsState::Move);
        bench
    }

    fn clear(&mut self) -> Outputs {
        self.inputs.clear_faults = true;
        self.clocks(u64::from(CLEAR_CLOCKS) + 2)
    }
}

const JERK: i64 = 1 << 26;

#[test]
fn off_to_hold_is_one_tick_and_takes_the_position_that_is_there() {
    let mut bench = Bench::new();
    bench.until(SupervisorState::Ready, 20);
    for position in [1000, 1003, 1010] {
        bench.inputs.position = position;
        bench.ticks(1);
        assert_eq!(bench.segments.outputs(0).position, position << 8);
        let shown = bench.axis.outputs();
        assert!(shown.shaper_start && shown.clear_integral && shown.segments_preset);
    }
    bench.inputs.enable = true;
    bench.inputs.position = 1017;
    bench.until(SupervisorState::Hold, TICK_CLOCKS);
    let shown = bench.axis.outputs();
    assert!(shown.drive_enable && shown.pwm_enable && shown.brake_release && shown.enabled);
    assert!(shown.shaper_start && !shown.segments_preset);
    bench.inputs.position = 2000;
    let shown = bench.clocks(u64::from(segments::LATENCY_CLOCKS) + 1);
    assert!(!shown.shaper_start && !shown.clear_integral);
    assert_eq!(bench.segments.outputs(0).position, 1017 << 8);
    bench.ticks(3);
    assert_eq!(bench.segments.outputs(0).position, 1017 << 8);
}

#[test]
fn a_start_waits_for_the_brake_and_is_refused_before() {
    let mut bench = Bench::new();
    bench.inputs.rst = true;
    bench.clock();
    (bench.inputs.rst, bench.inputs.enable) = (false, true);
    bench.ticks(2);
    assert_eq!(
        bench.axis.outputs().state,
        SupervisorState::Off,
        "enable must be low once"
    );
    bench.inputs.enable = false;
    bench.until(SupervisorState::Ready, 2);
    bench.inputs.enable = true;
    bench.until(SupervisorState::Hold, TICK_CLOCKS);
    bench.segment(1, 0);
    for _ in 0..3 {
        bench.inputs.start = true;
        let shown = bench.ticks(1);
        assert_eq!(shown.state, SupervisorState::Hold);
    }
    bench.inputs.start = true;
    assert!(bench.until(SupervisorState::Run, TICK_CLOCKS) <= TICK_CLOCKS);
}

#[test]
fn a_move_plays_and_ends_in_hold() {
    let mut bench = Bench::run(JERK);
    bench.until(SupervisorState::Hold, 60 * TICK_CLOCKS);
    let shown = bench.clock();
    assert!(shown.drive_enable && shown.brake_release && shown.causes == 0);
    assert_eq!(bench.segments.outputs(0).position >> 8, 20 * 20 * 20 / 64 * 2);
    // The next segment does not wait for the shaped command to settle.
    bench.segment(2, 0);
    bench.inputs.start = true;
    bench.until(SupervisorState::Run, TICK_CLOCKS);
}

#[test]
fn a_host_stop_slows_down_settles_and_comes_to_hold_with_segments_that_play_again() {
    let mut bench = Bench::run(JERK);
    bench.inputs.stop = true;
    bench.clock();
    assert_eq!(bench.axis.outputs().state, SupervisorState::QuickStop);
    let mut stopped_ticks = 0;
    while bench.axis.outputs().state == SupervisorState::QuickStop {
        bench.ticks(1);
        stopped_ticks += u64::from(bench.segments.outputs(0).state == segments::SegmentsState::Stopped);
    }
    assert_eq!(bench.axis.outputs().state, SupervisorState::Hold);
    assert!((6..=7).contains(&stopped_ticks), "{stopped_ticks}");
    bench.ticks(2);
    assert_eq!(bench.segments.outputs(0).state, segments::SegmentsState::Hold);
    bench.segment(2, 0);
    bench.inputs.start = true;
    bench.until(SupervisorState::Run, TICK_CLOCKS);
}

#[test]
fn every_line_reaches_the_pins_in_its_stated_clocks() {
    for filter_clocks in [0, 7, 63] {
        for line in 0..2 {
            let mut bench = Bench::run(JERK);
            bench.inputs.filter_clocks = filter_clocks;
            bench.inputs.off_causes = Cause::DriveLost.bit() as u16;
            bench.clocks(100);
            match line {
                0 => bench.inputs.emergency_stop_n = false,
                _ => bench.inputs.drive_ready = false,
            }
            let clocks = bench.until(SupervisorState::Fault, 200);
            assert_eq!(clocks, u64::from(LINE_CLOCKS) + u64::from(filter_clocks));
            let shown = bench.axis.outputs();
            assert!(!shown.drive_enable && !shown.pwm_enable && !shown.brake_release);
            assert_eq!(shown.pwm_trip_n, line != 0);
            assert!(shown.wants_group_stop && shown.faulted);
            assert_eq!(shown.emergency_stop, line == 0);
            // A lasting emergency stop keeps FAULT; a drive that is not ready keeps OFF.
            assert_eq!(
                bench.clear().state,
                [SupervisorState::Fault, SupervisorState::Off][line]
            );
            assert_eq!(
                bench.ticks(2).state,
                [SupervisorState::Fault, SupervisorState::Off][line]
            );
        }
    }
}

#[test]
fn a_quick_stop_by_a_cause_closes_the_brake_before_the_outputs_go_off() {
    let mut bench = Bench::run(JERK);
    bench.inputs.following_error_limit = 1 << 16;
    bench.inputs.error = -(1 << 16) - 2;
    bench.until(SupervisorState::QuickStop, TICK_CLOCKS + u64::from(WATCH_CLOCKS));
    assert_eq!(bench.axis.outputs().causes, Cause::FollowingError.bit());
    assert!(bench.axis.outputs().wants_group_stop);
    assert_eq!(bench.clear().state, SupervisorState::QuickStop, "a clear is too early");
    bench.until(SupervisorState::Fault, 100 * TICK_CLOCKS);
    let mut on_ticks = 0;
    while bench.axis.outputs().drive_enable {
        assert!(!bench.axis.outputs().brake_release);
        bench.ticks(1);
        on_ticks += 1;
    }
    assert_eq!(on_ticks, 5);
    let stands = bench.segments.outputs(0).position;
    bench.inputs.position = stands >> 8;
    // In the tick that switched off, the outputs were on and the following error was too large.
    bench.clocks(TICK_CLOCKS / 2);
    bench.inputs.error = 0;
    assert_eq!(bench.clear().state, SupervisorState::Off);
    bench.ticks(1);
    assert_eq!(bench.axis.outputs().state, SupervisorState::Off, "enable is still high");
    bench.inputs.enable = false;
    bench.until(SupervisorState::Ready, 2);
}

#[test]
fn enable_low_ends_through_quick_stop_and_brake() {
    let mut bench = Bench::run(JERK);
    bench.inputs.enable = false;
    bench.clock();
    assert_eq!(bench.axis.outputs().state, SupervisorState::QuickStop);
    bench.until(SupervisorState::Hold, 100 * TICK_CLOCKS);
    let mut braked = 0;
    while bench.axis.outputs().state == SupervisorState::Hold {
        let shown = bench.ticks(1);
        braked += u64::from(shown.drive_enable && !shown.brake_release);
    }
    assert_eq!(braked, 5);
    bench.until(SupervisorState::Ready, 1);
    assert!(!bench.axis.outputs().drive_enable && bench.axis.outputs().causes == 0);
}

#[test]
fn a_group_stop_ends_in_hold_and_blocks_the_start_until_it_is_cleared() {
    let mut bench = Bench::run(JERK);
    bench.inputs.group_stop = true;
    bench.clock();
    let shown = bench.axis.outputs();
    assert_eq!(
        (shown.state, shown.causes),
        (SupervisorState::QuickStop, Cause::GroupStop.bit())
    );
    assert!(!shown.wants_group_stop);
    bench.until(SupervisorState::Hold, 100 * TICK_CLOCKS);
    bench.ticks(2);
    bench.inputs.start = true;
    assert_eq!(bench.ticks(2).state, SupervisorState::Hold);
    bench.inputs.group_stop = false;
    let shown = bench.clear();
    assert_eq!((shown.state, shown.causes), (SupervisorState::Hold, 0));
    bench.segment(2, 0);
    bench.inputs.start = true;
    bench.until(SupervisorState::Run, TICK_CLOCKS);
}

#[test]
fn a_limit_blocks_its_own_direction_only() {
    for (plus, jerk, trips) in [
        (true, JERK, true),
        (true, -JERK, false),
        (false, -JERK, true),
        (false, JERK, false),
    ] {
        let mut bench = Bench::run(jerk);
        if plus {
            bench.inputs.limit_plus_n = false
        } else {
            bench.inputs.limit_minus_n = false
        }
        let state = bench.ticks(2).state;
        let cause = if plus { Cause::LimitPlus } else { Cause::LimitMinus };
        assert_eq!(
            state,
            if trips {
                SupervisorState::QuickStop
            } else {
                SupervisorState::Run
            }
        );
        assert_eq!(bench.axis.outputs().causes, if trips { cause.bit() } else { 0 });
    }
}

#[test]
fn behind_a_soft_limit_the_way_back_is_open() {
    let mut bench = Bench::run(JERK);
    (bench.inputs.soft_limit_plus, bench.inputs.soft_limit_minus) = (40 << 8, -1000 << 8);
    bench.until(SupervisorState::QuickStop, 30 * TICK_CLOCKS);
    assert_eq!(bench.axis.outputs().causes, Cause::SoftLimitPlus.bit());
    bench.until(SupervisorState::Fault, 100 * TICK_CLOCKS);
    bench.inputs.position = bench.segments.outputs(0).position >> 8;
    bench.ticks(6);
    assert!(bench.inputs.position > 40);
    bench.inputs.enable = false;
    bench.clear();
    bench.until(SupervisorState::Ready, 1);
    for (jerk, ends) in [(-JERK, SupervisorState::Run), (JERK, SupervisorState::QuickStop)] {
        bench.inputs.enable = true;
        bench.until(SupervisorState::Hold, TICK_CLOCKS);
        bench.ticks(4);
        for (ticks, jerk) in [(20, jerk), (40, -jerk), (20, jerk)] {
            bench.segment(ticks, jerk);
        }
        bench.inputs.start = true;
        bench.until(SupervisorState::Run, TICK_CLOCKS);
        bench.ticks(6);
        assert_eq!(bench.axis.outputs().state, ends, "jerk {jerk}");
        bench.inputs.position = 50;
        bench.inputs.enable = false;
        bench.ticks(100);
    }
}

#[test]
fn soft_limits_wait_for_homing_where_they_shall() {
    let moves = |after_homing: bool, homed: bool| {
        let mut bench = Bench::run(JERK);
        (bench.inputs.soft_limit_plus, bench.inputs.soft_limit_minus) = (40 << 8, -1000 << 8);
        bench.inputs.limits_after_homing = after_homing;
        (bench.inputs.write_homed, bench.inputs.homed_value) = (true, homed);
        bench.clocks(1);
        bench.inputs.write_homed = false;
        bench.ticks(30);
        bench
    };
    for (after_homing, homed) in [(false, false), (false, true), (true, true)] {
        let shown = moves(after_homing, homed).axis.outputs();
        assert_eq!(shown.causes, Cause::SoftLimitPlus.bit(), "{after_homing} {homed}");
    }
    let mut bench = moves(true, false);
    assert_eq!((bench.axis.outputs().causes, bench.axis.outputs().homed), (0, false));
    // The position is beyond the limit when homing takes effect.
    (bench.inputs.write_homed, bench.inputs.homed_value) = (true, true);
    bench.clocks(1);
    bench.inputs.write_homed = false;
    bench.ticks(2);
    assert_eq!(bench.axis.outputs().causes, Cause::SoftLimitPlus.bit());
}

#[test]
fn an_axis_is_homed_until_its_position_is_in_doubt() {
    let write = |bench: &mut Bench, value: bool| {
        (bench.inputs.write_homed, bench.inputs.homed_value) = (true, value);
        bench.clocks(1);
        bench.inputs.write_homed = false;
        bench.clocks(1);
        bench.axis.outputs().homed
    };
    let mut bench = Bench::hold();
    assert!(!bench.axis.outputs().homed);
    assert!(write(&mut bench, true));
    bench.ticks(5);
    assert!(bench.axis.outputs().homed);
    assert!(!write(&mut bench, false));
    assert!(write(&mut bench, true));
    bench.inputs.encoder_illegal = true;
    bench.clocks(3);
    assert!(!bench.axis.outputs().homed);
    // It leaves FAULT only when the cause has been cleared, and not by itself then.
    bench.inputs.encoder_illegal = false;
    assert!(!write(&mut bench, true));
    bench.inputs.enable = false;
    bench.ticks(20);
    bench.clear();
    bench.ticks(2);
    assert_eq!((bench.axis.outputs().causes, bench.axis.outputs().homed), (0, false));
    assert!(write(&mut bench, true));
    bench.inputs.rst = true;
    bench.clocks(1);
    bench.inputs.rst = false;
    assert!(!bench.axis.outputs().homed);
}

#[test]
fn what_lasts_too_long_trips_after_its_ticks() {
    // This command moves nothing; it begins between two ticks.
    let mut bench = Bench::hold();
    bench.clocks(TICK_CLOCKS / 2);
    (bench.inputs.lost_command, bench.inputs.lost_ticks) = (500, 6);
    bench.inputs.command = -502;
    bench.clocks(TICK_CLOCKS / 2);
    // One more tick is needed to see the new direction.
    bench.ticks(7);
    assert_eq!(bench.axis.outputs().causes, 0);
    bench.clocks(u64::from(WATCH_CLOCKS) - 1);
    assert_eq!(bench.axis.outputs().causes, Cause::EncoderLost.bit());
    // This command moves five counts now and then.
    let mut bench = Bench::hold();
    bench.clocks(TICK_CLOCKS / 2);
    (bench.inputs.lost_command, bench.inputs.lost_ticks) = (500, 6);
    bench.inputs.command = 501;
    bench.clocks(TICK_CLOCKS / 2);
    for count in 1..20 {
        bench.inputs.position = 5 * count;
        bench.ticks(5);
    }
    assert_eq!(bench.axis.outputs().causes, 0);
    // One host stops kicking, another kicks with a different word.
    let mut bench = Bench::hold();
    bench.inputs.watchdog_ticks = 10;
    bench.inputs.kick_word = KICK;
    for _ in 0..10 {
        bench.inputs.kick = true;
        bench.ticks(9);
        assert_eq!(bench.axis.outputs().state, SupervisorState::Hold);
    }
    bench.inputs.kick_word = !KICK;
    for _ in 0..11 {
        bench.inputs.kick = true;
        bench.ticks(1);
    }
    bench.clocks(u64::from(WATCH_CLOCKS) - 1);
    assert_eq!(bench.axis.outputs().causes, Cause::Watchdog.bit());
}

#[test]
fn thresholds_of_zero_watch_nothing() {
    let mut bench = Bench::hold();
    bench.inputs.error = i32::MIN;
    bench.inputs.deviation = i32::MAX;
    bench.inputs.limited_ticks = u16::MAX;
    bench.inputs.command = i32::MIN;
    let shown = bench.ticks(100);
    assert_eq!((shown.state, shown.causes), (SupervisorState::Hold, 0));
    bench.inputs.following_error_limit = i32::MAX as u32 - 1;
    assert_eq!(bench.ticks(1).causes, Cause::FollowingError.bit());
}

/// Any value for every port, with the lines mostly healthy.
fn any_inputs() -> impl Strategy<Value = Inputs> {
    (
        proptest::array::uniform32(any::<u64>()),
        proptest::array::uniform32(any::<u64>()),
    )
        .prop_map(|(first, second)| {
            let mut raw = [0; INPUT_PORTS];
            for (at, word) in raw.iter_mut().enumerate() {
                *word = if at < 32 { first[at] } else { second[at - 32] };
            }
            let mut inputs = Inputs::from_raw(&raw);
            inputs.rst = first[0] % 30 == 0;
            inputs.emergency_stop_n |= first[2] % 16 != 0;
            inputs.drive_ready |= first[5] % 16 != 0;
            for rare in [
                &mut inputs.group_emergency_stop,
                &mut inputs.segments_underrun,
                &mut inputs.segments_overflow,
                &mut inputs.segments_tick_missed,
                &mut inputs.shaper_overrun,
                &mut inputs.controller_overrun,
                &mut inputs.pwm_tripped,
                &mut inputs.encoder_illegal,
                &mut inputs.encoder_disagreement,
                &mut inputs.velocity_missed,
                &mut inputs.scale_illegal,
                &mut inputs.scale_disagreement,
            ] {
                *rare &= first[1] % 8 == 0;
            }
            (inputs.brake_release_ticks, inputs.brake_apply_ticks) = (first[17] as u16 & 3, first[18] as u16 & 3);
            inputs.settle_ticks = first[19] as u16 & 3;
            if first[20] % 4 != 0 {
                (inputs.soft_limit_plus, inputs.soft_limit_minus) = (0, 0);
                (inputs.following_error_limit, inputs.deviation_limit) = (0, 0);
            }
            inputs
        })
}

proptest! {
    #[test]
    fn prop_hold_is_many_steps(
        phases in proptest::collection::vec((any_inputs(), 1u64..90), 1..40)
    ) {
        let (mut fast, mut slow) = (Axis::new(), Axis::new());
        for (inputs, clocks) in phases {
            fast.hold(&inputs, clocks);
            for _ in 0..clocks {
                slow.step(&inputs);
            }
            prop_assert_eq!(fast.outputs(), slow.outputs());
        }
    }
}

#[test]
fn a_count_that_dithers_is_no_motion() {
    // One line of the encoder is stuck: the other lets the count go back and forth. In the other cases it goes on
    // slowly.
    for (counts, trips) in [
        ([0, 1], true),
        ([0, -1], true),
        ([2, -1], true),
        ([0, 5], false),
        ([0, -5], false),
    ] {
        let mut bench = Bench::hold();
        (bench.inputs.lost_command, bench.inputs.lost_ticks) = (500, 20);
        bench.inputs.command = 501;
        for tick in 0..100 {
            bench.inputs.position = 70 + counts[tick % 2];
            bench.ticks(1);
        }
        let causes = bench.axis.outputs().causes;
        assert_eq!(causes, if trips { Cause::EncoderLost.bit() } else { 0 }, "{counts:?}");
    }
    // A command that changes sign moves back and forth, and so may the position.
    let mut bench = Bench::hold();
    (bench.inputs.lost_command, bench.inputs.lost_ticks) = (500, 20);
    for tick in 0..100 {
        bench.inputs.command = if tick / 15 % 2 == 0 { 501 } else { -501 };
        bench.inputs.position = tick % 2;
        bench.ticks(1);
    }
    assert_eq!(bench.axis.outputs().causes, 0);
}

#[test]
fn out_of_range_the_outputs_are_refused_and_switched_off() {
    // A quick stop is not possible, whatever is configured: the meaning of position, command or error is unknown.
    type Change = fn(&mut Inputs);
    let out: [(&str, Change); 5] = [
        ("count +", |inputs| inputs.position = STAND_COUNTS),
        ("count -", |inputs| inputs.position = -STAND_COUNTS - 1),
        ("shaper", |inputs| inputs.shaper_saturated = true),
        ("e high", |inputs| inputs.saturated_high = 1),
        ("e low", |inputs| inputs.saturated_low = 0x7f),
    ];
    for (what, leave) in out {
        let mut bench = Bench::hold();
        leave(&mut bench.inputs);
        bench.ticks(1);
        bench.clocks(3);
        let shown = bench.axis.outputs();
        assert_eq!(
            (shown.state, shown.causes),
            (SupervisorState::Fault, Cause::Range.bit()),
            "{what}"
        );
        assert!(!shown.drive_enable && !shown.pwm_enable, "{what}");
        // READY does not leave with such a cause, and reports it once the outputs are requested; otherwise there is
        // nothing to report.
        let mut bench = Bench::new();
        leave(&mut bench.inputs);
        bench.ticks(3);
        assert_eq!(
            (bench.axis.outputs().state, bench.axis.outputs().causes),
            (SupervisorState::Ready, 0),
            "{what}"
        );
        bench.inputs.enable = true;
        for _ in 0..4 * TICK_CLOCKS {
            bench.clock();
            assert!(!bench.axis.outputs().drive_enable, "{what}");
        }
        assert_eq!(bench.axis.outputs().causes, Cause::Range.bit(), "{what}");
    }
    // Within the limits nothing stops, nor does a rotary axis.
    for (position, modulo) in [
        (STAND_COUNTS - 1, false),
        (-STAND_COUNTS, false),
        (i32::MIN, true),
        (i32::MAX, true),
    ] {
        let mut bench = Bench::new();
        (bench.inputs.position, bench.inputs.modulo) = (position, modulo);
        (bench.inputs.saturated_high, bench.inputs.saturated_low) = (0x7e, 0x7e);
        bench.inputs.enable = true;
        let shown = bench.ticks(3);
        assert_eq!((shown.state, shown.causes), (SupervisorState::Hold, 0), "{position}");
    }
}

#[test]
fn a_motion_against_the_command_is_none_where_the_direction_is_watched() {
    // The sign of the encoder is wrong: the position moves away from the command.
    for (command, step, watches_direction, trips) in [
        (502, -7, true, true),
        (-502, 7, true, true),
        (502, 7, true, false),
        (-502, -7, true, false),
        (502, -7, false, false),
        (-502, 7, false, false),
        // The counts per tick are few: there is motion in every other tick.
        (502, -3, true, true),
        (502, 3, true, false),
    ] {
        let mut bench = Bench::hold();
        (bench.inputs.lost_command, bench.inputs.lost_ticks) = (500, 20);
        (bench.inputs.command, bench.inputs.watches_direction) = (command, watches_direction);
        for _ in 0..60 {
            bench.inputs.position += step;
            bench.ticks(1);
        }
        let causes = bench.axis.outputs().causes;
        assert_eq!(
            causes,
            if trips { Cause::EncoderLost.bit() } else { 0 },
            "{command} {step} {watches_direction}"
        );
    }
}

#[test]
fn an_axis_that_is_slowed_down_and_turned_round_is_not_lost() {
    // A constant torque: 16 ticks against it, and back as far as it came.
    for side in [1, -1] {
        let mut bench = Bench::hold();
        (bench.inputs.lost_command, bench.inputs.lost_ticks) = (500, 20);
        (bench.inputs.command, bench.inputs.watches_direction) = (side * 502, true);
        for tick in -16..=16 {
            bench.inputs.position += side * 4 * tick;
            bench.ticks(1);
        }
        assert_eq!(bench.axis.outputs().causes, 0);
    }
}
