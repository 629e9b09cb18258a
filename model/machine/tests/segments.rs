//! The command FIFO's model: what a host sees, and `hold` compared with `step`.

use posicast_blocks::segments::{
    CUBIC, CubicEntry, ENTRIES_MAX, ENTRY_WORDS, Entry, EntryMotion, Inputs, Integrator, LATENCY_CLOCKS, Outputs,
    Point, REACH_COUNTS, STAND_COUNTS, Segments, SegmentsState, TICK_CLOCKS,
};
use posicast_machine::motion::{TickLimits, plan_move};
use proptest::prelude::*;

const QUIET: Inputs = Inputs {
    rst: false,
    tick: false,
    enable: true,
    write: false,
    word: 0,
    data: 0,
    flush: false,
    quick_stop: false,
    restart: false,
    preset: false,
    preset_position: 0,
    stop_deceleration: 1 << 24,
    low_water: 2,
    clear_flags: false,
    modulo: false,
    feed_hold: false,
    extrapolation: 0,
};

fn write(segments: &mut Segments, entry: &Entry) {
    write_words(segments, entry.words());
}

fn write_words(segments: &mut Segments, words: [u32; ENTRY_WORDS]) {
    for (word, data) in (0..).zip(words) {
        segments.step(&Inputs {
            write: true,
            word,
            data,
            ..QUIET
        });
    }
}

/// Plays one tick; returns the outputs after it.
fn tick(segments: &mut Segments) -> Outputs {
    tick_with(segments, &QUIET)
}

fn tick_with(segments: &mut Segments, inputs: &Inputs) -> Outputs {
    segments.step(&Inputs { tick: true, ..*inputs });
    segments.hold(inputs, 100);
    segments.outputs(inputs.low_water)
}

fn cubic(ticks: u32, velocity: i32, acceleration: i32, jerk: i32) -> Entry {
    Entry {
        ticks,
        motion: EntryMotion::Cubic(CubicEntry {
            jerk,
            velocity,
            acceleration,
        }),
        notify: false,
    }
}

fn jerk(ticks: u32, jerk: i64) -> Entry {
    Entry {
        ticks,
        motion: EntryMotion::Jerk(jerk),
        notify: false,
    }
}

#[test]
fn a_planned_move_arrives_with_the_integrator_at_every_tick() {
    let limits = TickLimits::new(0.25, 8.0, 400.0, 1e6, 1e4);
    let end = 5_000 << 8;
    let entries = plan_move(0, end, &limits).unwrap();
    let mut segments = Segments::new(3);
    entries.iter().for_each(|entry| write(&mut segments, entry));
    let mut expected = Integrator::default();
    let first = tick(&mut segments);
    assert_eq!(
        (first.state, first.position),
        (SegmentsState::Move, 0),
        "the first entry is read at the first tick"
    );
    for entry in &entries {
        for nth in 0..entry.ticks {
            expected.play(&entry.motion, nth == 0).unwrap();
            let shown = tick(&mut segments);
            assert_eq!([shown.position, shown.velocity, shown.acceleration], expected.rounded());
            assert_eq!(segments.command(), expected);
        }
    }
    let rest = segments.outputs(2);
    assert_eq!(
        (rest.state, rest.position, rest.empty, rest.underrun),
        (SegmentsState::Hold, end, true, false)
    );
}

#[test]
fn without_an_entry_while_moving_it_stops_by_itself_and_says_so() {
    let mut segments = Segments::new(3);
    write(&mut segments, &jerk(10, 1 << 32));
    let states: Vec<SegmentsState> = (0..200).map(|_| tick(&mut segments).state).collect();
    let shown = segments.outputs(2);
    assert!(shown.underrun && shown.velocity == 0 && shown.acceleration == 0);
    assert_eq!(shown.state, SegmentsState::Stopped);
    // v = 55 counts per tick after 10 ticks, decelerated by 1 count per tick²: 55 ticks, and one to be at rest.
    assert_eq!(states.iter().filter(|state| **state == SegmentsState::Stop).count(), 56);
    // Nothing is taken until the host permits it.
    write(&mut segments, &jerk(1, 0));
    assert!(segments.outputs(2).refused && segments.outputs(2).level == 0);
    segments.step(&Inputs { restart: true, ..QUIET });
    assert_eq!(tick(&mut segments).state, SegmentsState::Hold);
    write(&mut segments, &jerk(1, 0));
    assert_eq!(segments.outputs(2).level, 1);
}

/// Every cubic begins where the previous one ended, and plays as its closed form says.
#[test]
fn cubics_go_on_from_the_present_position() {
    let entries = [
        cubic(10, 70_000, -900, 5_000),
        cubic(7, -20_000, 4_000, i32::MIN),
        cubic(2, 0, 0, 0),
    ];
    let mut segments = Segments::new(3);
    entries.iter().for_each(|entry| write(&mut segments, entry));
    tick(&mut segments);
    let mut end = 0;
    for entry in &entries {
        let EntryMotion::Cubic(cubic) = entry.motion else {
            unreachable!()
        };
        let n = i64::from(entry.ticks);
        let (v, a, j) = (
            i64::from(cubic.velocity) << 16,
            i64::from(cubic.acceleration) << 8,
            i64::from(cubic.jerk),
        );
        for _ in 0..n {
            tick(&mut segments);
        }
        end += n * v + n * (n - 1) / 2 * a + (n - 1) * n * (n + 1) / 6 * j;
        assert_eq!(segments.command().position, end);
        assert_eq!(segments.command().velocity, v + (n - 1) * a + n * (n - 1) / 2 * j);
    }
    assert_eq!(segments.outputs(2).state, SegmentsState::Hold);
}

#[test]
fn a_late_entry_finds_the_axis_at_its_velocity_and_a_missing_one_stops_it() {
    let patient = Inputs {
        extrapolation: 3,
        ..QUIET
    };
    let mut segments = Segments::new(3);
    write(&mut segments, &cubic(4, 3 << 16, 1 << 20, 0));
    for _ in 0..5 {
        tick_with(&mut segments, &patient);
    }
    let end = segments.command();
    assert_eq!(
        (segments.outputs(2).late_ticks, segments.outputs(2).state),
        (1, SegmentsState::Move)
    );
    // Two late ticks; then the entry that was missing goes on from there.
    for late in 1..=2 {
        let shown = tick_with(&mut segments, &patient);
        assert_eq!(segments.command().position, end.position + late * end.velocity);
        assert_eq!(
            (segments.command().velocity, shown.acceleration, shown.underrun),
            (end.velocity, 0, false)
        );
        if late == 1 {
            write(&mut segments, &cubic(1, 1 << 16, 0, 0));
        }
    }
    tick_with(&mut segments, &patient);
    assert_eq!(segments.command().position, end.position + 2 * end.velocity + (1 << 32));
    assert_eq!(segments.outputs(2).late_ticks, 3);
    // Nothing comes: three ticks at this velocity, then the quick stop.
    let shown: Vec<Outputs> = (0..5).map(|_| tick_with(&mut segments, &patient)).collect();
    let states = shown.iter().map(|shown| (shown.state, shown.underrun, shown.velocity));
    let (moves, stops) = (SegmentsState::Move, SegmentsState::Stop);
    let velocity = 1 << 16;
    assert_eq!(
        states.collect::<Vec<_>>(),
        [
            (moves, false, velocity),
            (moves, false, velocity),
            (stops, true, velocity),
            (stops, true, 0),
            (SegmentsState::Stopped, true, 0)
        ]
    );
    assert_eq!(shown[4].late_ticks, 5);
}

/// `late_ticks` counts where a tick is decided, at the end of the one before; a quick stop may come in between.
#[test]
fn a_late_tick_counts_one_tick_before_it_is_played_even_if_a_quick_stop_replaces_it() {
    let patient = Inputs {
        extrapolation: 3,
        stop_deceleration: 1 << 20,
        ..QUIET
    };
    let stopping = Inputs {
        quick_stop: true,
        ..patient
    };
    for (next, late_ticks, state) in [(&patient, 2, SegmentsState::Move), (&stopping, 1, SegmentsState::Stop)] {
        let mut segments = Segments::new(3);
        write(&mut segments, &cubic(4, 3 << 16, 1 << 20, 0));
        for _ in 0..5 {
            tick_with(&mut segments, &patient);
        }
        // The entry has just ended: no tick was extrapolated yet, and one counts already.
        assert_eq!(segments.outputs(2).late_ticks, 1);
        tick_with(&mut segments, next);
        assert_eq!(
            (segments.outputs(2).late_ticks, segments.outputs(2).state),
            (late_ticks, state)
        );
    }
}

#[test]
fn a_batch_is_taken_whole_or_not_at_all() {
    let entries = [jerk(1, 5), cubic(2, 7, 0, 0), jerk(1, -5)];
    let batch = Entry::batch(&entries);
    let mut segments = Segments::new(3);
    for words in &batch[..2] {
        write_words(&mut segments, *words);
        assert_eq!(
            tick(&mut segments).state,
            SegmentsState::Hold,
            "a batch that is not whole plays"
        );
    }
    write_words(&mut segments, batch[2]);
    assert_eq!(segments.outputs(2).level, 3);
    // One that is malformed takes those before and after it along; the next entry is taken again.
    let mut wrong = batch.clone();
    wrong[1][3] |= 1 << 31;
    assert!(wrong[1][3] & CUBIC != 0);
    for words in wrong.into_iter().chain([jerk(1, 0).words()]) {
        write_words(&mut segments, words);
    }
    assert_eq!((segments.outputs(2).level, segments.outputs(2).malformed), (4, true));
    // A flush in its middle drops the rest of it too.
    write_words(&mut segments, batch[0]);
    segments.step(&Inputs { flush: true, ..QUIET });
    assert_eq!(tick_with(&mut segments, &Inputs { enable: false, ..QUIET }).level, 0);
    write_words(&mut segments, batch[1]);
    write_words(&mut segments, batch[2]);
    assert_eq!(segments.outputs(2).level, 0);
    // Half of one, left behind: after a preset the next entry is taken as it is.
    write_words(&mut segments, batch[0]);
    segments.step(&Inputs { preset: true, ..QUIET });
    tick_with(&mut segments, &Inputs { enable: false, ..QUIET });
    write(&mut segments, &jerk(1, 0));
    assert_eq!(segments.outputs(2).level, 1);
    segments.step(&Inputs { flush: true, ..QUIET });
    tick_with(&mut segments, &Inputs { enable: false, ..QUIET });
    // Of 63 and two none is kept.
    for _ in 0..63 {
        write(&mut segments, &jerk(1, 0));
    }
    write_words(&mut segments, batch[0]);
    write_words(&mut segments, batch[2]);
    assert_eq!((segments.outputs(2).level, segments.outputs(2).refused), (63, true));
}

/// Rests at this number of counts; returns the states at the ticks while `entry` plays.
fn from(counts: i32, entry: &Entry, inputs: &Inputs, ticks: usize) -> Vec<Outputs> {
    let mut segments = Segments::new(3);
    segments.step(&Inputs {
        preset: true,
        ..*inputs
    });
    let tick = |segments: &mut Segments| {
        segments.step(&Inputs {
            tick: true,
            preset_position: counts,
            ..*inputs
        });
        segments.hold(inputs, 100);
        segments.outputs(0)
    };
    tick(&mut segments);
    write(&mut segments, entry);
    (0..ticks).map(|_| tick(&mut segments)).collect()
}

#[test]
fn the_command_stops_before_the_end_of_its_word_and_never_wraps() {
    let way = |side: i32| (side * (REACH_COUNTS - 3_000), jerk(600, i64::from(side) << 32));
    for side in [1, -1] {
        // Up to 1,200 counts per tick, decelerated by 1 count per tick², and by almost nothing: the rest stops at
        // once.
        for stop_deceleration in [1 << 24, 1, 0] {
            let inputs = Inputs {
                stop_deceleration,
                ..QUIET
            };
            let (counts, entry) = way(side);
            let shown = from(counts, &entry, &inputs, 3_000);
            let last = shown.last().unwrap();
            assert!(last.out_of_range && !last.overflow && !last.underrun);
            assert_eq!((last.state, last.velocity), (SegmentsState::Stopped, 0));
            for (before, after) in shown.iter().zip(&shown[1..]) {
                let step = i64::from(after.position) - i64::from(before.position);
                assert!(
                    (0..40_000 << 8).contains(&(step * i64::from(side))),
                    "{before:?} {after:?}"
                );
                let decelerates = (before.velocity - after.velocity) * side <= 1 << 16;
                let stands = after.velocity == 0 && before.position / 256 * side >= STAND_COUNTS;
                assert!(stop_deceleration == 0 || decelerates || stands, "{before:?} {after:?}");
            }
        }
        // A rotary axis turns for ever, and the way back from the end is open.
        let (counts, entry) = way(side);
        let shown = from(counts, &entry, &Inputs { modulo: true, ..QUIET }, 590);
        assert!(shown.iter().all(|shown| !shown.out_of_range));
        assert!(shown.iter().any(|shown| shown.position.signum() == -side));
        let shown = from(
            side * (STAND_COUNTS + 9),
            &jerk(100, i64::from(-side) << 32),
            &QUIET,
            90,
        );
        assert!(
            shown
                .iter()
                .all(|shown| !shown.out_of_range && shown.position.signum() == side)
        );
    }
}

/// Returns three moves of four ticks, by 2, 6 and −4 counts, of three entries each: the jerks j, −j, −j, j.
fn three_moves() -> Vec<Entry> {
    let moves = [1i64, 3, -2].map(|way| way << 32);
    let entries = moves.map(|way| [jerk(1, way), jerk(2, -way), jerk(1, way)]);
    entries.concat()
}

#[test]
fn a_feed_hold_stands_at_the_next_rest_and_keeps_the_queue() {
    let held = Inputs {
        feed_hold: true,
        ..QUIET
    };
    for asked in 0..13 {
        let mut segments = Segments::new(3);
        three_moves().iter().for_each(|entry| write(&mut segments, entry));
        (0..asked).for_each(|_| {
            tick(&mut segments);
        });
        let shown: Vec<Outputs> = (0..20)
            .map(|_| {
                segments.step(&Inputs { tick: true, ..held });
                segments.hold(&held, 100);
                segments.outputs(2)
            })
            .collect();
        // The first tick reads and moves nothing. A move that has begun is played to its end, and none after it
        // begins.
        let moves_played = [0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3][asked];
        let stands = shown[19];
        assert_eq!(
            stands.position,
            [0, 2 << 8, 8 << 8, 4 << 8][moves_played],
            "after {asked} ticks"
        );
        assert_eq!([stands.velocity, stands.acceleration], [0, 0]);
        assert_eq!(
            (stands.held, stands.state == SegmentsState::Move),
            (moves_played < 3, moves_played < 3)
        );
        assert_eq!(usize::from(stands.level), [8, 5, 2, 0][moves_played]);
        // It continues from where it stood: each remaining tick is played, and the end is exact.
        let left = (1..40).find(|_| tick(&mut segments).state == SegmentsState::Hold);
        assert_eq!(left, Some((4 * (3 - moves_played)).max(1)));
        assert_eq!(segments.command(), Integrator::resting_at(4));
        assert!(!segments.outputs(2).held && !segments.outputs(2).underrun);
    }
}

#[test]
fn a_stop_ends_a_feed_hold_and_drops_the_queue() {
    let mut segments = Segments::new(3);
    three_moves().iter().for_each(|entry| write(&mut segments, entry));
    let held = Inputs {
        tick: true,
        feed_hold: true,
        ..QUIET
    };
    for quick_stop in [false, false, false, true, false] {
        segments.step(&Inputs { quick_stop, ..held });
        segments.hold(&QUIET, 100);
    }
    let shown = segments.outputs(2);
    assert_eq!(
        (shown.state, shown.level, shown.held),
        (SegmentsState::Stopped, 0, false)
    );
}

#[test]
fn a_full_fifo_refuses_and_keeps_what_it_has() {
    let mut segments = Segments::new(3);
    for ticks in 1..=u32::from(ENTRIES_MAX) {
        write(&mut segments, &jerk(ticks, 0));
    }
    assert!(!segments.outputs(2).refused);
    write(&mut segments, &jerk(99, 0));
    let shown = segments.outputs(2);
    assert!(shown.refused && shown.level == ENTRIES_MAX);
    // 1 + 2 + … + 64 ticks, and the one that reads the first.
    let ticks = (1..4_000).find(|_| tick(&mut segments).state == SegmentsState::Hold && segments.outputs(2).empty);
    assert_eq!(ticks, Some(64 * 65 / 2 + 1));
}

#[test]
fn preset_rests_anywhere_at_the_next_tick() {
    let mut segments = Segments::new(3);
    write(&mut segments, &jerk(50, 1 << 32));
    (0..20).for_each(|_| {
        tick(&mut segments);
    });
    segments.step(&Inputs { preset: true, ..QUIET });
    segments.step(&Inputs {
        tick: true,
        preset_position: -77,
        ..QUIET
    });
    segments.hold(&QUIET, 100);
    assert_eq!(segments.command(), Integrator::resting_at(-77));
    assert_eq!(
        (segments.outputs(0).state, segments.outputs(0).level),
        (SegmentsState::Hold, 0)
    );
}

#[test]
fn valid_comes_after_its_latency_and_ticks_fit_their_clocks() {
    let mut segments = Segments::new(3);
    write(&mut segments, &jerk(1, 0));
    segments.step(&Inputs { tick: true, ..QUIET });
    let valid = (1..100).find(|_| segments.step(&QUIET).valid);
    assert_eq!(valid, Some(LATENCY_CLOCKS));
    segments.hold(&QUIET, 100);
    for _ in 0..3 {
        segments.step(&Inputs { tick: true, ..QUIET });
        segments.hold(&QUIET, u64::from(TICK_CLOCKS) - 1);
        write(&mut segments, &jerk(1, 0));
    }
    assert!(!segments.outputs(2).tick_missed);
}

fn inputs() -> impl Strategy<Value = Inputs> {
    let entry = (any::<bool>(), 0..4u8, any::<u32>(), 0..20u32);
    let requests = proptest::collection::vec(proptest::bool::weighted(0.03), 6);
    (entry, requests, any::<bool>(), any::<i32>(), 0..u32::MAX >> 1).prop_map(
        |((write, word, data, shift), requests, tick, preset_position, deceleration)| Inputs {
            rst: requests[0],
            tick,
            enable: !requests[1],
            write,
            word,
            data: if word == 3 { data & 0x3000_0007 } else { data >> shift },
            flush: requests[2],
            quick_stop: requests[3],
            restart: requests[4],
            preset: requests[5],
            preset_position,
            stop_deceleration: deceleration >> shift,
            low_water: 3,
            clear_flags: false,
            modulo: data & 1 != 0,
            feed_hold: data & 2 != 0,
            extrapolation: shift as u8,
        },
    )
}

proptest! {
    #[test]
    fn prop_hold_is_as_many_steps(script in proptest::collection::vec((inputs(), 1..40u64), 1..60)) {
        let (mut stepped, mut held) = (Segments::new(1), Segments::new(1));
        for (inputs, clocks) in script {
            for _ in 0..clocks {
                stepped.step(&inputs);
            }
            held.hold(&inputs, clocks);
            prop_assert_eq!(stepped.outputs(3), held.outputs(3));
            prop_assert_eq!(stepped.command(), held.command());
        }
    }

    #[test]
    fn prop_what_the_integrator_says_of_a_point_is_the_point(position: i32, velocity: i32, acceleration: i32) {
        let point = Point { position, velocity, acceleration };
        prop_assert_eq!(Integrator::at_point(&point).rounded(), [position, velocity, acceleration]);
    }
}
