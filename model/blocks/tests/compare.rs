//! The position compare: which positions are passed, in which clock, and what `arm`, jumps, hysteresis and the list do.

use posicast_blocks::compare::{Compare, Inputs, LATENCY_CLOCKS, LIST_POSITIONS, Outputs};
use proptest::prelude::*;

/// Clocks after which the block has found its place among a few positions.
const SETTLE_CLOCKS: usize = 400;

/// Plays counts after `arm`, and returns the outputs of every clock.
fn play(compare: &mut Compare, settings: Inputs, start: i32, counts: &[i32]) -> Vec<Outputs> {
    compare.step(&Inputs {
        count: start,
        ..settings
    });
    compare.step(&Inputs {
        arm: true,
        count: start,
        ..settings
    });
    for _ in 0..SETTLE_CLOCKS {
        compare.step(&Inputs {
            count: start,
            ..settings
        });
    }
    assert!(compare.outputs().ready);
    let rest = [*counts.last().unwrap(); LATENCY_CLOCKS as usize];
    let all = counts.iter().chain(&rest);
    all.map(|count| {
        compare.step(&Inputs {
            count: *count,
            ..settings
        });
        compare.outputs()
    })
    .collect()
}

fn load(compare: &mut Compare, entries: &[i32]) {
    for entry in entries {
        compare.step(&Inputs {
            entry: *entry,
            entry_write: true,
            ..Inputs::default()
        });
    }
}

/// The clocks in which `passed` is high, with the direction.
fn passages(outputs: &[Outputs]) -> Vec<(usize, bool)> {
    let all = outputs.iter().enumerate().filter(|(_, shown)| shown.passed);
    all.map(|(clock, shown)| (clock, shown.passed_upward)).collect()
}

fn row(first: i32, spacing: u32, positions: u32) -> Inputs {
    Inputs {
        first,
        spacing,
        positions,
        rises: true,
        falls: true,
        pulse_clocks: 1,
        ..Inputs::default()
    }
}

#[test]
fn a_position_is_passed_a_latency_after_its_count() {
    let mut compare = Compare::new(1);
    let outputs = play(&mut compare, row(10, 5, 2), 0, &(1..=20).collect::<Vec<i32>>());
    // Step k has the count k + 1, and shows the outputs after its clock.
    let after = |count: usize| count - 1 + LATENCY_CLOCKS as usize - 1;
    assert_eq!(passages(&outputs), [(after(10), true), (after(15), true)]);
}

#[test]
fn a_position_is_left_downward_at_the_count_below_it() {
    let mut compare = Compare::new(1);
    let counts: Vec<i32> = (8..20).rev().collect();
    let outputs = play(&mut compare, row(10, 5, 2), 20, &counts);
    let clock_of = |count: i32| counts.iter().position(|of| *of == count).unwrap() + LATENCY_CLOCKS as usize - 1;
    assert_eq!(passages(&outputs), [(clock_of(14), false), (clock_of(9), false)]);
}

#[test]
fn a_pulse_lasts_its_clocks_and_becomes_longer_when_the_next_begins() {
    let mut compare = Compare::new(1);
    let settings = Inputs {
        pulse_clocks: 4,
        ..row(10, 6, 2)
    };
    let outputs = play(&mut compare, settings, 0, &(1..=30).collect::<Vec<i32>>());
    let high = outputs.iter().filter(|shown| shown.pulse).count();
    assert_eq!((high, outputs.last().unwrap().merged), (8, false));

    let settings = Inputs {
        pulse_clocks: 7,
        ..row(10, 6, 2)
    };
    let outputs = play(&mut compare, settings, 0, &(1..=30).collect::<Vec<i32>>());
    let high = outputs.iter().filter(|shown| shown.pulse).count();
    assert_eq!((high, outputs.last().unwrap().merged), (13, true));
}

#[test]
fn jitter_at_an_edge_gives_one_pulse_with_hysteresis() {
    let jitter = [9, 10, 9, 10, 9, 10, 11, 10, 9, 8, 9, 10];
    let passes = |hysteresis| {
        let settings = Inputs {
            hysteresis,
            ..row(10, 100, 1)
        };
        passages(&play(&mut Compare::new(1), settings, 8, &jitter)).len()
    };
    assert_eq!(passes(0), 7);
    // 11 is a count away from the edge between 9 and 10, as 8 is.
    assert_eq!(passes(1), 3);
    assert_eq!(passes(2), 1);
}

#[test]
fn a_jump_passes_nothing_and_the_place_is_found_anew() {
    let mut compare = Compare::new(1);
    let mut counts = vec![1, 2, 1000];
    counts.extend([1000; 300]);
    counts.extend((0..=5).map(|more| 1000 + more));
    let outputs = play(&mut compare, row(10, 10, 200), 0, &counts);
    assert_eq!(passages(&outputs), []);
    assert!(outputs.last().unwrap().jumped && outputs.last().unwrap().ready);
    let settings = row(10, 10, 200);
    for count in 1006..=1010 {
        compare.step(&Inputs { count, ..settings });
    }
    compare.step(&Inputs {
        count: 1010,
        ..settings
    });
    assert_eq!(compare.outputs().passes, 1);
}

#[test]
fn a_list_takes_increasing_entries_while_nothing_is_armed() {
    let mut compare = Compare::new(1);
    load(&mut compare, &[-5, -1, 2, 3, 7]);
    // 2 is only 3 above −1, and 3 is taken.
    assert_eq!((compare.outputs().entries, compare.outputs().refused), (4, true));
    compare.step(&Inputs {
        clear_flags: true,
        ..Inputs::default()
    });
    assert!(!compare.outputs().refused);

    let armed = Inputs {
        arm: true,
        use_list: true,
        ..Inputs::default()
    };
    compare.step(&Inputs {
        entries_clear: true,
        ..armed
    });
    assert_eq!((compare.outputs().entries, compare.outputs().refused), (4, true));
    load(&mut compare, &[100]);
    assert_eq!(compare.outputs().entries, 4);

    compare.step(&Inputs {
        disarm: true,
        ..Inputs::default()
    });
    compare.step(&Inputs {
        entries_clear: true,
        ..Inputs::default()
    });
    let entries: Vec<i32> = (0..300).map(|k| 4 * k).collect();
    load(&mut compare, &entries);
    assert_eq!(usize::from(compare.outputs().entries), LIST_POSITIONS);
}

#[test]
fn the_ends_of_the_count_are_no_passage() {
    let counts = [i32::MAX - 1, i32::MAX, i32::MIN, i32::MIN + 1];
    let outputs = play(&mut Compare::new(1), row(i32::MIN, 1, u32::MAX), i32::MIN, &[i32::MIN]);
    assert_eq!(passages(&outputs), []);
    let outputs = play(&mut Compare::new(1), row(i32::MAX, 1, 5), i32::MAX - 2, &counts);
    assert_eq!(passages(&outputs).len(), 1);
    assert!(outputs.last().unwrap().jumped);
}

/// Positions that a walk passes, by the definition: `p` is passed upward from `p − 1` to `p`, downward from `p` to `p − 1`.
fn expected(positions: &[i32], start: i32, counts: &[i32]) -> Vec<(usize, bool)> {
    let before = std::iter::once(&start).chain(counts);
    let steps = before.zip(counts).enumerate();
    steps
        .filter_map(|(clock, (from, to))| {
            let edge = *from.max(to);
            (from != to && positions.contains(&edge)).then_some((clock + LATENCY_CLOCKS as usize - 1, to > from))
        })
        .collect()
}

proptest! {
    #[test]
    fn prop_a_walk_passes_each_position_once_per_crossing(
        first in -40..40i32, spacing in 1..9u32, positions in 0..20u32, start in -60..60i32,
        steps in prop::collection::vec(prop::sample::select(vec![-1, -1, 0, 1, 1, 1]), 1..400),
    ) {
        let walk = steps.iter().scan(start, |count, step| { *count += step; Some(*count) }).collect::<Vec<i32>>();
        let all: Vec<i32> = (0..positions).map(|k| first + (k * spacing) as i32).collect();
        let outputs = play(&mut Compare::new(1), row(first, spacing, positions), start, &walk);
        prop_assert_eq!(passages(&outputs), expected(&all, start, &walk));
        prop_assert_eq!(outputs.last().unwrap().passes as usize, expected(&all, start, &walk).len());
    }

    #[test]
    fn prop_a_list_is_passed_as_its_entries_say(
        first in -40..0i32, distances in prop::collection::vec(4..12i32, 0..15), start in -60..60i32,
        steps in prop::collection::vec(prop::sample::select(vec![-1, -1, -1, 0, 1, 1, 1, 1]), 1..400),
        seed in 0..1000u64,
    ) {
        let walk = steps.iter().scan(start, |count, step| { *count += step; Some(*count) }).collect::<Vec<i32>>();
        let all: Vec<i32> = distances.iter().scan(first, |entry, more| { *entry += more; Some(*entry) }).collect();
        let mut compare = Compare::new(seed);
        load(&mut compare, &all);
        let settings = Inputs { use_list: true, ..row(0, 0, 0) };
        let outputs = play(&mut compare, settings, start, &walk);
        prop_assert_eq!(passages(&outputs), expected(&all, start, &walk));
    }
}
