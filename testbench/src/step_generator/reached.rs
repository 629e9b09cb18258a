//! Counts of the events in a lockstep run of the step generator.

use posicast_blocks::step_generator::{INPUT_PORTS, OUTPUT_PORTS, StepGeneratorConfig};

use crate::lockstep::Clock;

/// What was in the clock before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Before {
    active: bool,
    enabled: bool,
    too_fast: bool,
    owed_exceeded: bool,
    cleared: bool,
    count: i32,
    owed: i32,
}

/// Counts of the events in a lockstep run of the step generator.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StepGeneratorCoverage {
    tick_clocks: u64,
    period_clocks: u64,
    pulse_clocks: u64,
    before: Option<Before>,
    /// Clocks since the last step and the last tick, and whether the last step was up.
    since_step: u64,
    since_tick: u64,
    last_up: Option<bool>,
    counts: [u64; EVENTS.len()],
}

/// The events, in the order of the counters.
const EVENTS: [&str; 16] = [
    "resets while active",
    "steps up",
    "steps down",
    "steps below zero",
    "steps at the largest rate",
    "steps after more than two ticks",
    "reversals",
    "more than one step owed",
    "enabled at a position",
    "disabled in mid pulse",
    "disabled with steps owed",
    "ticks too early",
    "ticks too late",
    "causes: too fast",
    "causes: too many steps owed",
    "causes in the clock of a clear",
];

impl StepGeneratorCoverage {
    /// Creates the counters.
    pub fn new(config: &StepGeneratorConfig) -> Self {
        Self {
            tick_clocks: config.tick_clocks().into(),
            period_clocks: config.period_clocks(),
            pulse_clocks: config.times().pulse_clocks,
            before: None,
            since_step: 0,
            since_tick: 0,
            last_up: None,
            counts: [0; EVENTS.len()],
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(&[rst, enable, tick, _, clear_flags]), Ok(&[_, _, count, owed, active, too_fast, owed_exceeded, _])) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let now = Before {
            active: active == 1,
            enabled: enable == 1,
            too_fast: too_fast == 1,
            owed_exceeded: owed_exceeded == 1,
            cleared: clear_flags == 1,
            count: count as u32 as i32,
            owed: i32::from(owed as u16 as i16),
        };
        let (tick, falls) = (tick == 1, |before: Before| before.enabled && !now.enabled);
        self.since_step += 1;
        self.since_tick += 1;
        let change = self.before.map_or(0, |before| now.count.wrapping_sub(before.count));
        let up = change > 0;
        let events = self.before.map_or([false; EVENTS.len()], |before| {
            let caused = (now.too_fast && !before.too_fast) || (now.owed_exceeded && !before.owed_exceeded);
            [
                rst == 1 && now.active,
                change == 1,
                change == -1,
                change == -1 && before.count == 0,
                change != 0 && self.since_step == self.period_clocks && self.last_up == Some(up),
                change != 0 && self.since_step > 2 * self.tick_clocks,
                change != 0 && self.last_up == Some(!up) && self.since_step < 2 * self.tick_clocks,
                now.owed.abs() > 1 && before.owed.abs() <= 1,
                now.active && !before.active,
                falls(before) && (change != 0 || self.since_step < self.pulse_clocks),
                falls(before) && now.owed != 0,
                now.active && tick && self.since_tick < self.tick_clocks,
                now.active && tick && self.since_tick > self.tick_clocks,
                now.too_fast && !before.too_fast,
                now.owed_exceeded && !before.owed_exceeded,
                caused && before.cleared,
            ]
        });
        for (count, event) in self.counts.iter_mut().zip(events) {
            *count += u64::from(event);
        }
        if change != 0 {
            (self.since_step, self.last_up) = (0, Some(up));
        }
        if tick {
            self.since_tick = 0;
        }
        self.before = (rst == 0).then_some(now);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); EVENTS.len()] {
        std::array::from_fn(|at| (EVENTS[at], self.counts[at]))
    }
}
