//! The position capture's model: what its datasheet says.

use posicast_blocks::capture::{AXES, Capture, CaptureEntry, ENTRIES, Inputs, LATENCY_CLOCKS, Outputs};
use posicast_blocks::pulse_counter::{self, PulseCounter};

/// Both edges are wanted, without a filter or a window.
const BOTH: Inputs = Inputs {
    rst: false,
    line: false,
    filter_clocks: 1,
    enable: true,
    rises: true,
    falls: true,
    count: [0; AXES],
    stamp: 0,
    windowed: false,
    window_axis: 0,
    window_first: 0,
    window_last: 0,
    take: false,
    clear: false,
    clear_flags: false,
};

/// Plays clocks whose positions and stamp are told by their number.
struct Bench {
    capture: Capture,
    settings: Inputs,
    clock: u32,
}

/// The entry of this clock.
fn entry(clock: u32, rising: bool) -> CaptureEntry {
    let clock_count = clock as i32;
    CaptureEntry {
        count: [clock_count, -clock_count, 7 * clock_count, 1_000_000 + clock_count],
        stamp: 3 * clock,
        rising,
    }
}

fn shown(outputs: &Outputs) -> CaptureEntry {
    CaptureEntry {
        count: outputs.entry_count,
        stamp: outputs.entry_stamp,
        rising: outputs.entry_rising,
    }
}

impl Bench {
    /// The line has been low for long.
    fn new(settings: Inputs) -> Self {
        let mut bench = Self::unknown(settings);
        bench.run(false, u32::from(settings.filter_clocks.max(1)) + LATENCY_CLOCKS);
        assert!(bench.capture.outputs().level_known);
        bench
    }

    /// The block is as after a reset.
    fn unknown(settings: Inputs) -> Self {
        Self {
            capture: Capture::new(),
            settings,
            clock: 0,
        }
    }

    fn step(&mut self, inputs: Inputs) -> Outputs {
        let CaptureEntry { count, stamp, .. } = entry(self.clock, false);
        self.clock += 1;
        self.capture.step(&Inputs { count, stamp, ..inputs })
    }

    fn run(&mut self, line: bool, clocks: u32) -> Outputs {
        for _ in 0..clocks {
            self.step(Inputs { line, ..self.settings });
        }
        self.capture.outputs()
    }

    /// A wanted edge, whose entry is written at the end of the last clock; returns the clock whose positions it takes.
    fn edge(&mut self, line: bool) -> u32 {
        let latency = LATENCY_CLOCKS + u32::from(self.settings.filter_clocks.max(1));
        self.run(line, latency + 1);
        self.clock - 1
    }

    fn take(&mut self) -> Outputs {
        let line = self.capture.outputs().level;
        self.step(Inputs {
            line,
            take: true,
            ..self.settings
        });
        self.capture.outputs()
    }
}

#[test]
fn the_positions_are_those_of_a_constant_latency_after_the_edge() {
    for filter_clocks in [0, 1, 2, 5, 100, u16::MAX] {
        let mut bench = Bench::new(Inputs { filter_clocks, ..BOTH });
        for rising in [true, false] {
            let changes = bench.clock;
            let latency = LATENCY_CLOCKS + u32::from(filter_clocks.max(1));
            let before = bench.run(rising, latency);
            assert_eq!(
                (before.level, before.captured),
                (rising, false),
                "the first clock of the new level"
            );
            let after = bench.run(rising, 1);
            assert!(after.captured && after.entries == 1 && after.edges == 2 - u32::from(rising));
            assert!(!after.entry_valid && shown(&after) == CaptureEntry::default());
            let later = bench.run(rising, 1);
            assert!(!later.captured && later.entry_valid);
            assert_eq!(
                shown(&later),
                entry(changes + latency, rising),
                "filter {filter_clocks}"
            );
            assert!(!bench.take().entry_valid);
        }
    }
}

#[test]
fn a_pulse_is_an_edge_if_it_lasts_as_long_as_the_filter() {
    for filter_clocks in [1, 2, 3, 40, 1000] {
        let mut bench = Bench::new(Inputs { filter_clocks, ..BOTH });
        let filter = u32::from(filter_clocks);
        // Many that are too short do not add up.
        for _ in 0..5 {
            bench.run(true, filter - 1);
            bench.run(false, 1);
        }
        assert_eq!(bench.run(false, 2 * filter + 4).edges, 0);
        bench.run(true, filter);
        let after = bench.run(false, 2 * filter + 4);
        assert_eq!((after.edges, after.entries), (2, 2), "filter {filter_clocks}");
    }
}

#[test]
fn the_first_level_after_a_reset_is_no_edge() {
    for (filter_clocks, line) in [(1, false), (1, true), (0, true), (6, false), (6, true), (300, true)] {
        let mut bench = Bench::unknown(Inputs { filter_clocks, ..BOTH });
        let filter = u32::from(filter_clocks.max(1));
        // A line that does not rest has no level.
        let restless = if filter > 1 { 20 * filter + 1 } else { 0 };
        for clock in 0..restless {
            assert!(!bench.run((clock % filter != 0) == line, 1).level_known);
        }
        let before = bench.run(line, filter + LATENCY_CLOCKS - 1);
        assert!(!before.level_known && !before.level, "filter {filter_clocks}");
        let after = bench.run(line, 1);
        assert!(after.level_known && after.level == line);
        let later = bench.run(line, 5);
        assert_eq!((later.edges, later.entries, later.entry_valid), (0, 0, false));
        // The next one is.
        bench.edge(!line);
        assert_eq!(bench.capture.outputs().edges, 1);

        // A reset forgets the level.
        bench.step(Inputs {
            rst: true,
            line: !line,
            ..bench.settings
        });
        assert_eq!(bench.capture.outputs(), Outputs::default());
        assert_eq!(bench.run(line, 2 * filter + 9).edges, 0);
    }
}

#[test]
fn only_wanted_edges_count_and_only_while_enabled() {
    for (enable, rises, falls) in [
        (false, true, true),
        (true, true, false),
        (true, false, true),
        (true, false, false),
    ] {
        let mut bench = Bench::new(Inputs {
            enable,
            rises,
            falls,
            ..BOTH
        });
        let rise = bench.edge(true);
        let fall = bench.edge(false);
        let after = bench.run(false, 2);
        let expected: Vec<CaptureEntry> = [(rise, true, rises), (fall, false, falls)]
            .into_iter()
            .filter(|(_, _, wanted)| enable && *wanted)
            .map(|(clock, rising, _)| entry(clock, rising))
            .collect();
        assert_eq!(
            (after.edges, usize::from(after.entries)),
            (expected.len() as u32, expected.len())
        );
        assert!(!after.outside && !after.overflowed && after.level_known && !after.level);
        assert_eq!(after.entry_valid.then(|| shown(&after)), expected.first().copied());
    }
    // While disabled, the level follows; to enable is no edge.
    let mut bench = Bench::new(Inputs { enable: false, ..BOTH });
    assert!(bench.run(true, 5).level);
    bench.settings.enable = true;
    assert_eq!(bench.run(true, 5).edges, 0);
}

#[test]
fn a_window_holds_both_of_its_ends() {
    let far = i32::MAX;
    for (axis, first, last, inside) in [
        (0, 0, 0, true),
        (1, 0, 0, true),
        (2, -1, 1, true),
        (3, 0, 1, true),
        (3, -1, 0, true),
        (0, 1, 2, false),
        (1, -2, -1, false),
        (2, 1, -1, false),
        (3, far, i32::MIN, false),
        (0, i32::MIN, far, true),
    ] {
        let mut bench = Bench::new(BOTH);
        let at = entry(bench.clock + LATENCY_CLOCKS + 1, true).count[axis];
        let window = |end: i32| if end.unsigned_abs() > 9 { end } else { at + end };
        bench.settings = Inputs {
            windowed: true,
            window_axis: axis as u8,
            window_first: window(first),
            window_last: window(last),
            ..BOTH
        };
        bench.edge(true);
        let after = bench.capture.outputs();
        assert_eq!(
            (after.captured, after.outside, after.edges),
            (inside, !inside, 1),
            "{axis}: {first} to {last}"
        );
        bench.settings.clear_flags = true;
        assert!(!bench.run(true, 1).outside);
    }
}

#[test]
fn a_full_memory_keeps_the_oldest_entries_in_order() {
    let mut bench = Bench::new(BOTH);
    let clocks: Vec<(u32, bool)> = (0..20).map(|edge| (bench.edge(edge % 2 == 0), edge % 2 == 0)).collect();
    let full = bench.capture.outputs();
    assert_eq!(
        (usize::from(full.entries), full.edges, full.overflowed),
        (ENTRIES, 20, true)
    );
    for (place, (clock, rising)) in clocks[..ENTRIES].iter().enumerate() {
        let now = bench.capture.outputs();
        assert!(now.entry_valid && usize::from(now.entries) == ENTRIES - place);
        assert_eq!(shown(&now), entry(*clock, *rising), "entry {place}");
        bench.take();
    }
    let empty = bench.take();
    assert_eq!((empty.entries, empty.entry_valid, empty.edges), (0, false, 20));
}

#[test]
fn take_and_clear_come_before_an_edge_of_the_same_clock() {
    let with = |entries: u32, also: fn(&mut Inputs)| {
        let mut bench = Bench::new(BOTH);
        for edge in 0..entries {
            bench.edge(edge.is_multiple_of(2));
        }
        let rising = entries.is_multiple_of(2);
        bench.run(rising, LATENCY_CLOCKS + 1);
        let mut inputs = Inputs {
            line: rising,
            ..bench.settings
        };
        also(&mut inputs);
        bench.step(inputs);
        bench.capture.outputs()
    };
    let full = with(16, |inputs| inputs.take = true);
    assert_eq!(
        (full.entries, full.captured, full.overflowed, full.edges),
        (16, true, false, 17)
    );
    let overflowed = with(16, |_| ());
    assert_eq!(
        (overflowed.entries, overflowed.captured, overflowed.overflowed),
        (16, false, true)
    );
    let cleared = with(16, |inputs| inputs.clear = true);
    assert_eq!(
        (cleared.entries, cleared.captured, cleared.overflowed, cleared.edges),
        (1, true, false, 1)
    );
    let both = with(5, |inputs| (inputs.take, inputs.clear) = (true, true));
    assert_eq!((both.entries, both.edges), (1, 1));
    let last = with(1, |inputs| inputs.take = true);
    assert_eq!((last.entries, last.entry_valid), (1, false));
    // Setting wins over clearing.
    assert!(with(16, |inputs| inputs.clear_flags = true).overflowed);
}

#[test]
fn an_entry_that_is_not_yet_shown_is_not_taken() {
    let mut bench = Bench::new(BOTH);
    bench.edge(true);
    assert!(bench.capture.outputs().captured);
    let after = bench.take();
    assert!(after.entry_valid && after.entries == 1);
}

#[test]
fn a_filter_two_clocks_longer_than_that_of_the_encoder_gives_the_position_of_the_touch() {
    for encoder_filter in [0, 3, 10, 63] {
        let mut counter = PulseCounter::new();
        let settings = Inputs {
            filter_clocks: u16::from(encoder_filter) + 2,
            ..BOTH
        };
        let mut capture = Capture::new();
        let step_clocks = i32::from(encoder_filter) + 3;
        for clock in 0..100 * step_clocks {
            let position = clock / step_clocks;
            let pins = pulse_counter::Inputs {
                a: matches!(position & 3, 1 | 2),
                b: position & 3 >= 2,
                filter_clocks: encoder_filter,
                ..pulse_counter::Inputs::default()
            };
            let count = [counter.step(&pins).count, 0, 0, 0];
            let line = position >= 50;
            capture.step(&Inputs {
                line,
                count,
                ..settings
            });
        }
        assert!(capture.outputs().entry_valid);
        assert_eq!(capture.outputs().entry_count[0], 50, "filter {encoder_filter}");
    }
}
