//! The position capture's model, compared with a naive reference that looks back at the whole past.

use posicast_blocks::capture::{Capture, CaptureEntry, ENTRIES, Inputs, Outputs};
use proptest::prelude::*;
use std::collections::VecDeque;

/// The datasheet in the simplest words: what is known of the line is looked up in all its samples since the reset.
#[derive(Default)]
struct Naive {
    samples: Vec<bool>,
    level: Option<bool>,
    edge: Option<bool>,
    waiting: VecDeque<CaptureEntry>,
    shows: bool,
    captured: bool,
    edges: u32,
    overflowed: bool,
    outside: bool,
}

impl Naive {
    fn outputs(&self) -> Outputs {
        let entry = self.waiting.front().filter(|_| self.shows).copied().unwrap_or_default();
        Outputs {
            level: self.level == Some(true),
            level_known: self.level.is_some(),
            captured: self.captured,
            entries: self.waiting.len() as u8,
            edges: self.edges,
            entry_valid: self.shows,
            entry_count: entry.count,
            entry_stamp: entry.stamp,
            entry_rising: entry.rising,
            overflowed: self.overflowed,
            outside: self.outside,
        }
    }

    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            *self = Self::default();
            return;
        }
        if inputs.clear {
            self.waiting.clear();
            self.edges = 0;
        } else if inputs.take && self.shows {
            self.waiting.pop_front();
        }
        self.shows = !self.waiting.is_empty();
        self.captured = false;
        if inputs.clear_flags {
            (self.overflowed, self.outside) = (false, false);
        }
        let is_wanted = |rising: &bool| inputs.enable && if *rising { inputs.rises } else { inputs.falls };
        if let Some(rising) = self.edge.filter(is_wanted) {
            let position = inputs.count[usize::from(inputs.window_axis)];
            self.edges = self.edges.wrapping_add(1);
            if inputs.windowed && (position < inputs.window_first || position > inputs.window_last) {
                self.outside = true;
            } else if self.waiting.len() == ENTRIES {
                self.overflowed = true;
            } else {
                self.captured = true;
                let (count, stamp) = (inputs.count, inputs.stamp);
                self.waiting.push_back(CaptureEntry { count, stamp, rising });
            }
        }
        // The filter sees the samples of two clocks ago and before.
        let filter = usize::from(inputs.filter_clocks.max(1));
        let newest: Vec<bool> = self.samples.iter().rev().skip(1).take(filter).copied().collect();
        self.samples.push(inputs.line);
        let rests = newest.len() == filter && newest.iter().all(|sample| *sample == newest[0]);
        let now = newest.first().copied().filter(|now| rests && self.level != Some(*now));
        self.edge = now.filter(|_| self.level.is_some());
        self.level = now.or(self.level);
    }
}

fn clocks() -> impl Strategy<Value = Vec<(Inputs, u16)>> {
    let rare = || prop::bool::weighted(0.05);
    let often = || prop::bool::weighted(0.9);
    let near = || -3..4_i32;
    let positions = (near(), near(), near(), near());
    let line = (rare(), any::<bool>(), 1..9_u16);
    let wants = (
        often(),
        often(),
        often(),
        prop::bool::weighted(0.3),
        0..4_u8,
        near(),
        near(),
    );
    let commands = (prop::bool::weighted(0.15), rare(), rare(), any::<u32>());
    let clock = (line, wants, positions, commands).prop_map(|(line, wants, positions, commands)| {
        let (rst, line, clocks) = line;
        let (enable, rises, falls, windowed, window_axis, window_first, window_last) = wants;
        let (take, clear, clear_flags, stamp) = commands;
        let inputs = Inputs {
            rst: rst && clear_flags,
            line,
            filter_clocks: 0,
            enable,
            rises,
            falls,
            count: positions.into(),
            stamp,
            windowed,
            window_axis,
            window_first,
            window_last,
            take,
            clear: clear && rst,
            clear_flags,
        };
        (inputs, clocks)
    });
    (0..6_u16, prop::collection::vec(clock, 1..300)).prop_map(|(filter_clocks, clocks)| {
        let with = |(inputs, clocks)| {
            (
                Inputs {
                    filter_clocks,
                    ..inputs
                },
                clocks,
            )
        };
        clocks.into_iter().map(with).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn prop_every_output_is_that_of_a_reference_that_looks_back(clocks in clocks(), takes in any::<bool>()) {
        let (mut capture, mut naive) = (Capture::new(), Naive::default());
        for (time, (inputs, lasts)) in clocks.into_iter().enumerate() {
            for clock in 0..lasts {
                // Commands last for a clock; positions go on.
                let first = clock == 0;
                let inputs = Inputs {
                    rst: inputs.rst && first,
                    take: inputs.take && takes,
                    clear: inputs.clear && first,
                    count: inputs.count.map(|count| count + i32::from(clock)),
                    ..inputs
                };
                let shown = capture.step(&inputs);
                prop_assert_eq!(shown, naive.outputs(), "group {} clock {}", time, clock);
                naive.clock(&inputs);
            }
        }
    }
}
