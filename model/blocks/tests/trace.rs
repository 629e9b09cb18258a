//! The trace memory's model: what a motion engineer expects of it, and `hold` compared with `step`.

use posicast_blocks::trace::{Inputs, Outputs, SIGNALS, Trace, TraceConfig, TraceState, row_clocks, row_signals};
use proptest::prelude::*;

/// Settings with four different signals in a row and the trigger on a fifth.
const SETTINGS: Inputs = Inputs {
    rst: false,
    strobe: false,
    signal: [0; SIGNALS],
    select_0: 1,
    select_1: 15,
    select_2: 0,
    select_3: 7,
    signals: 2,
    decimation: 0,
    trigger_select: 4,
    trigger_mode: 1,
    trigger_level: 500,
    trigger_event: false,
    pre_trigger: 10,
    arm: false,
    halt: false,
    read_address: 0,
};

fn trace() -> Trace {
    Trace::new(&TraceConfig::new(256).unwrap())
}

/// Returns a number per tick and signal, different from all others; signal 4 is the tick itself.
fn signals(tick: i32) -> [i32; SIGNALS] {
    std::array::from_fn(|place| if place == 4 { tick } else { tick * 100 + place as i32 })
}

fn arm(trace: &mut Trace, settings: &Inputs) {
    trace.step(&Inputs { arm: true, ..*settings });
}

/// Plays a strobe with `signal`, and enough clocks for a row.
fn strobe(trace: &mut Trace, settings: &Inputs, signal: [i32; SIGNALS]) -> Outputs {
    let now = Inputs { signal, ..*settings };
    trace.step(&Inputs { strobe: true, ..now });
    trace.hold(&now, 20);
    trace.outputs()
}

fn read(trace: &mut Trace, read_address: u16) -> u32 {
    trace.step(&Inputs {
        read_address,
        ..Inputs::default()
    });
    trace.outputs().data
}

/// Returns the rows as a host reads them.
fn rows(trace: &mut Trace, signals: usize) -> Vec<Vec<i32>> {
    let words = trace.outputs().rows * signals as u16;
    let read: Vec<i32> = (0..words).map(|address| read(trace, address) as i32).collect();
    read.chunks(signals).map(<[i32]>::to_vec).collect()
}

#[test]
fn the_trace_is_the_rows_around_the_trigger_in_order_of_time() {
    let mut trace = trace();
    arm(&mut trace, &SETTINGS);
    assert_eq!(trace.outputs().state, TraceState::Filling);
    let states: Vec<TraceState> = (0..600)
        .map(|tick| strobe(&mut trace, &SETTINGS, signals(tick)).state)
        .collect();
    assert_eq!((states[8], states[9]), (TraceState::Filling, TraceState::Waiting));
    assert_eq!((states[499], states[500]), (TraceState::Waiting, TraceState::Taking));
    // 64 rows: 10 before the trigger, its own, 53 after it.
    assert_eq!((states[552], states[553]), (TraceState::Taking, TraceState::Idle));
    assert_eq!((trace.outputs().rows, trace.outputs().trigger_row), (64, 10));
    let expected: Vec<Vec<i32>> = (490..554)
        .map(|tick| {
            SETTINGS
                .selects()
                .map(|select| signals(tick)[usize::from(select)])
                .to_vec()
        })
        .collect();
    assert_eq!(rows(&mut trace, 4), expected);
    assert_eq!(read(&mut trace, 256), 0, "beyond the memory");
}

#[test]
fn every_row_leaves_out_as_many_strobes_as_decimation_says() {
    let mut trace = trace();
    let settings = Inputs {
        decimation: 6,
        trigger_mode: 0,
        pre_trigger: 0,
        signals: 0,
        ..SETTINGS.with_selects([4; 4])
    };
    arm(&mut trace, &settings);
    (100..5000).for_each(|tick| {
        strobe(&mut trace, &settings, signals(tick));
    });
    let ticks: Vec<i32> = rows(&mut trace, 1).concat();
    assert_eq!(ticks, (0..256).map(|row| 100 + 7 * row).collect::<Vec<_>>());
}

#[test]
fn halt_ends_with_the_row_that_is_being_taken_and_says_whether_the_trigger_came() {
    for (halted_at, rows_there) in [(5, 6), (200, 10), (502, 13)] {
        let mut trace = trace();
        arm(&mut trace, &SETTINGS);
        (0..halted_at).for_each(|tick| {
            strobe(&mut trace, &SETTINGS, signals(tick));
        });
        let now = Inputs {
            signal: signals(halted_at),
            ..SETTINGS
        };
        trace.step(&Inputs { strobe: true, ..now });
        trace.step(&Inputs { halt: true, ..now });
        let done = (0..20).filter(|_| trace.step(&now).done).count();
        let shown = trace.outputs();
        assert_eq!((shown.state, shown.rows, done), (TraceState::Idle, rows_there, 0));
        assert_eq!(shown.rows > shown.trigger_row, halted_at > 500);
        let read = rows(&mut trace, 4);
        assert_eq!(read.last().unwrap()[0], signals(halted_at)[1]);
    }
}

#[test]
fn nothing_is_read_that_is_not_a_word_of_a_trace_that_is_over() {
    let mut trace = trace();
    assert_eq!(read(&mut trace, 3), 0, "never armed");
    let settings = Inputs {
        trigger_mode: 0,
        pre_trigger: 0,
        ..SETTINGS
    };
    arm(&mut trace, &settings);
    (1..=3).for_each(|tick| {
        strobe(&mut trace, &settings, signals(tick));
    });
    assert_eq!(read(&mut trace, 0), 0, "being taken");
    trace.step(&Inputs { halt: true, ..settings });
    trace.hold(&settings, 5);
    assert_eq!([11, 12].map(|address| read(&mut trace, address)), [307, 0]);
    arm(&mut trace, &settings);
    assert_eq!(trace.outputs().rows, 0);
}

#[test]
fn an_event_is_kept_for_the_next_row() {
    let mut trace = trace();
    let settings = Inputs {
        trigger_mode: 3,
        decimation: 9,
        pre_trigger: 2,
        ..SETTINGS
    };
    arm(&mut trace, &settings);
    for tick in 0..15 {
        strobe(&mut trace, &settings, signals(tick));
    }
    trace.step(&Inputs {
        trigger_event: true,
        ..settings
    });
    for tick in 15..20 {
        assert_eq!(strobe(&mut trace, &settings, signals(tick)).state, TraceState::Waiting);
    }
    assert_eq!(strobe(&mut trace, &settings, signals(20)).state, TraceState::Taking);
}

#[test]
fn a_level_is_passed_from_one_row_to_the_next_and_not_by_the_first() {
    // Mode, values of the trigger's signal, the row that triggers.
    let cases: [(u8, &[i32], Option<usize>); 6] = [
        (1, &[600, 499, 500, 600], Some(2)),
        (1, &[500, 501, i32::MAX], None),
        (1, &[i32::MIN, i32::MAX], Some(1)),
        (2, &[0, 500, 499], Some(2)),
        (2, &[499, 0, i32::MIN], None),
        (0, &[0], Some(0)),
    ];
    for (trigger_mode, values, expected) in cases {
        let settings = Inputs {
            trigger_mode,
            pre_trigger: 0,
            ..SETTINGS
        };
        let mut trace = trace();
        arm(&mut trace, &settings);
        let came = values
            .iter()
            .position(|&value| strobe(&mut trace, &settings, [value; SIGNALS]).state == TraceState::Taking);
        assert_eq!(came, expected, "mode {trigger_mode}, {values:?}");
    }
}

#[test]
fn a_pre_trigger_that_is_too_long_leaves_one_row_for_the_trigger() {
    let mut trace = trace();
    let settings = Inputs {
        trigger_mode: 0,
        pre_trigger: 2047,
        ..SETTINGS
    };
    arm(&mut trace, &settings);
    (0..64).for_each(|tick| {
        strobe(&mut trace, &settings, signals(tick));
    });
    let shown = trace.outputs();
    assert_eq!((shown.state, shown.rows, shown.trigger_row), (TraceState::Idle, 64, 63));
}

#[test]
fn a_row_takes_its_clocks_and_a_strobe_within_them_is_missed() {
    for code in 0..=3 {
        let clocks = row_clocks(code);
        for (distance, missed) in [(clocks - 1, true), (clocks, false)] {
            let mut trace = trace();
            let settings = Inputs {
                signals: code,
                ..SETTINGS
            };
            arm(&mut trace, &settings);
            for _ in 0..3 {
                trace.step(&Inputs {
                    strobe: true,
                    ..settings
                });
                trace.hold(&settings, u64::from(distance) - 1);
            }
            assert_eq!(trace.outputs().missed, missed, "{code}, {distance}");
            arm(&mut trace, &settings);
            assert!(!trace.outputs().missed);
        }
    }
}

proptest! {
    /// Whatever the settings are, the trace consists of the last rows up to the one that completes it.
    #[test]
    fn prop_a_trace_ends_with_its_last_row(
        samples in prop::sample::select(vec![256u64, 512]),
        signals_code in 0u8..4,
        decimation in 0u16..3,
        pre_trigger in 0u16..600,
        trigger_tick in 0i32..900,
    ) {
        let config = TraceConfig::new(samples).unwrap();
        let mut trace = Trace::new(&config);
        let settings = Inputs {
            signals: signals_code,
            decimation,
            pre_trigger,
            trigger_level: trigger_tick,
            ..SETTINGS
        };
        arm(&mut trace, &settings);
        let done = (0..6000).find(|&tick| strobe(&mut trace, &settings, signals(tick)).state == TraceState::Idle);
        let step = i32::from(decimation) + 1;
        let pre = i32::from(pre_trigger).min(config.rows(signals_code) as i32 - 1);
        // The first row at or above the level has no row before it; a level that was crossed while filling never
        // triggers.
        let trigger_row = (trigger_tick + step - 1) / step;
        let comes = trigger_row >= pre.max(1);
        let last = trigger_row - pre + config.rows(signals_code) as i32 - 1;
        prop_assert_eq!(done, comes.then_some(last * step));
        if comes {
            let count = row_signals(signals_code);
            for (row, words) in rows(&mut trace, count).into_iter().enumerate() {
                let tick = (trigger_row - pre + row as i32) * step;
                for (word, select) in words.into_iter().zip(settings.selects()) {
                    prop_assert_eq!(word, signals(tick)[usize::from(select)]);
                }
            }
        }
    }

    #[test]
    fn prop_hold_is_that_many_steps(clocks in prop::collection::vec((any::<u64>(), 0u64..60), 1..60)) {
        let (mut held, mut stepped) = (trace(), trace());
        for (word, count) in clocks {
            let bit = |place: u32| word >> place & 1 == 1;
            let inputs = Inputs {
                strobe: bit(0),
                arm: word >> 1 & 31 == 0,
                halt: word >> 6 & 63 == 0,
                rst: word >> 12 & 255 == 0,
                trigger_event: bit(20),
                trigger_mode: (word >> 21 & 3) as u8,
                signals: (word >> 23 & 3) as u8,
                decimation: (word >> 25 & 3) as u16,
                pre_trigger: (word >> 28 & 7) as u16,
                signal: [(word >> 32) as i32; SIGNALS],
                read_address: (word >> 40 & 15) as u16,
                ..SETTINGS
            };
            held.hold(&inputs, count);
            (0..count).for_each(|_| { stepped.step(&inputs); });
            prop_assert_eq!(held.outputs(), stepped.outputs());
        }
    }
}
