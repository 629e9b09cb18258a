//! Seeded random inputs for the PWM: duties of every size, and around the ends of every pattern; modes, periods and
//! times that a host changes in any clock; a time base in step and out of step; faults of every kind and length, and
//! hosts that clear them; a controller that feeds the watchdog, or forgets to; a mask that comes and goes in any
//! clock. [`GateSafety`] checks what every run must fulfil.

use posicast_blocks::pwm::{ActiveLow, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, ports};
use posicast_blocks::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Every third interval of this many clocks is calm.
const CALM_CLOCKS: u64 = 50_000;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct PwmRandom {
    rng: Xoshiro256PlusPlus,
    inputs: Inputs,
    clock: u64,
    until_feed: u32,
    /// Number of clocks that each fault still lasts: raw, PLL, filtered 0, filtered 1.
    faults: [u32; 4],
    /// Number of clocks since the last sync of the time base.
    since_sync: u32,
    /// The period that the carrier counts, as far as the pins show it.
    period_used: u16,
}

impl PwmRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            inputs: Inputs {
                enable: true,
                period: 70,
                max_duty: 0xffff,
                ..Inputs::default()
            },
            clock: 0,
            until_feed: 50,
            faults: [0; 4],
            since_sync: 0,
            period_used: 32,
        }
    }

    /// Returns whether the current interval is calm: nothing interrupts the run, so that long periods reach their
    /// edges.
    fn is_calm(&self) -> bool {
        self.clock / CALM_CLOCKS % 3 == 2
    }

    /// Like [`one_in`](Self::one_in), but twenty times as rare in a calm interval.
    fn interrupts(&mut self, clocks: u32) -> bool {
        let rarity = if self.is_calm() { 20 } else { 1 };
        self.one_in(clocks * rarity)
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    /// Changes period, dead time and minimum pulse: mostly while the PWM is off, as a host should.
    fn timing(&mut self, running: bool) {
        let changes = if running {
            self.one_in(4000)
        } else {
            self.interrupts(900)
        };
        if !changes {
            return;
        }
        let any = self.rng.next_u32() as u16;
        // A period of 0 means 65,536 clocks.
        let seldom = if self.one_in(4) { 0 } else { 2 };
        let short = if self.is_calm() {
            any >> self.rng.random_range(0..9)
        } else {
            self.rng.random_range(64..160)
        };
        self.inputs.period = *pick(
            &mut self.rng,
            &[short, short, short, short, 64, 65, 300, 48, 67, seldom, any >> 4, any],
        );
        let some = self.rng.random_range(0..12);
        let one_bit = [0; 2].map(|_: u8| 1 << self.rng.random_range(0..10));
        self.inputs.dead_time = *pick(&mut self.rng, &[0, 1, 2, 3, some, some, one_bit[0]]);
        self.inputs.minimum_pulse = *pick(&mut self.rng, &[0, 1, 2, some, some, one_bit[1]]);
        if self.one_in(6) {
            // The period has room for both sides' minima and nothing more, or one clock less or more.
            let sum = *pick(&mut self.rng, &[32, 33, 40, 64, 135]);
            self.inputs.dead_time = self.rng.random_range(4..28);
            self.inputs.minimum_pulse = sum - self.inputs.dead_time;
            self.inputs.period = 2 * sum + *pick(&mut self.rng, &[0, 0, 1]);
        }
    }

    fn command(&mut self) {
        let period = i32::from(self.inputs.period);
        if self.one_in(30) {
            let within = self.rng.random_range(-period..=period);
            let dead = i32::from(self.inputs.dead_time);
            let pulse = i32::from(self.inputs.minimum_pulse);
            let about = self.rng.random_range(-3..=3);
            let limit = i32::from(self.inputs.max_duty);
            let ends = [0, dead + pulse, period - dead - pulse, period, period / 2, limit, limit];
            let end = *pick(&mut self.rng, &ends) + about;
            let any = self.rng.random_range(-65_536..=65_535);
            let choices = [within, within, end, -end, period, -period, -self.inputs.duty, any];
            self.inputs.duty = *pick(&mut self.rng, &choices);
        }
        if self.one_in(2500) {
            let half = self.inputs.period / 2;
            self.inputs.max_duty = *pick(&mut self.rng, &[0xffff, 0xffff, self.inputs.period, half, half, 0]);
        }
        if self.interrupts(700) {
            self.inputs.mode = self.rng.random_range(0..4);
        }
        if self.one_in(2000) {
            self.inputs.update_at_peak = self.one_in(2);
        }
    }

    /// Returns a position in the period, often shortly before a boundary, so that the longest periods end soon.
    /// Rarely it is one beyond the period, from where the next valley is far.
    fn position(&mut self) -> u16 {
        let period = self.period_used;
        if self.one_in(30) {
            let one_bit = 1 << self.rng.random_range(0..16);
            return *pick(&mut self.rng, &[one_bit, u16::MAX]);
        }
        let early = self.rng.random_range(0..40).min(period / 2);
        let before = self.rng.random_range(1..20);
        let ends = [period.saturating_sub(before), (period / 2).saturating_sub(before)];
        *pick(&mut self.rng, &[early, early, early, ends[0], ends[0], ends[1]])
    }

    fn time_base(&mut self, running: bool) {
        // A carrier that is off waits at its phase for a sync or two, usually without an interruption.
        if self.one_in(if running { 3000 } else { 900 }) {
            self.inputs.phase = self.position();
        }
        if self.one_in(if running { 3000 } else { 60 }) {
            let any = self.position();
            self.inputs.trigger_phase = *pick(&mut self.rng, &[0, any, any, self.inputs.period.wrapping_sub(1)]);
        }
        self.since_sync += 1;
        // The time base stays in step for long times: a sync comes every third period, when off in every period, or
        // sometimes at any moment.
        let (periods, moment) = if running { (3, 180_000) } else { (1, 1200) };
        let in_step = self.since_sync >= periods * u32::from(self.inputs.period.max(1));
        self.inputs.sync = in_step || self.one_in(moment);
        if self.inputs.sync {
            self.since_sync = 0;
        }
        self.until_feed = self.until_feed.saturating_sub(1);
        self.inputs.feed = self.until_feed == 0;
        if self.inputs.feed {
            let forgets = self.one_in(if self.is_calm() { 150 } else { 30 });
            self.until_feed = if forgets && self.is_calm() {
                // 255 periods exercise every bit of the watchdog.
                self.inputs.watchdog_periods = 255;
                20_000
            } else if forgets {
                3000
            } else {
                (2 * u32::from(self.inputs.period.max(1))).min(2000)
            };
        }
        if self.one_in(5000) {
            let one_bit = 1 << self.rng.random_range(0..8);
            self.inputs.watchdog_periods = *pick(&mut self.rng, &[0, 2, 3, 3, 5, one_bit, one_bit, 255]);
        }
    }

    fn faults(&mut self) {
        for (at, rarity) in [(0, 4000), (1, 9000), (2, 900), (3, 900)] {
            self.faults[at] = self.faults[at].saturating_sub(1);
            if self.interrupts(rarity) {
                let filter = u32::from(self.inputs.filter_clocks);
                let lengths = [1, 2, 30, filter.max(1), filter + 1, filter + 2];
                self.faults[at] = *pick(&mut self.rng, &lengths);
            }
        }
        if self.one_in(6000) {
            self.inputs.filter_clocks = *pick(&mut self.rng, &[0, 1, 5, 20, 20, 255]);
        }
        let quiet = self.faults.map(|left| left == 0);
        self.inputs.fault_n = quiet[0];
        self.inputs.pll_locked = quiet[1];
        self.inputs.filtered_fault_n = u8::from(quiet[2]) | u8::from(quiet[3]) << 1;
        self.inputs.clear_trip = self.one_in(60);
        self.inputs.clear_flags = self.one_in(900);
    }
}

impl Stimuli for PwmRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let running = seen.get(4).is_some_and(|running| *running != 0);
        if !running && seen.get(8).is_some_and(|valley| *valley != 0) {
            self.period_used = self.inputs.period;
        }
        self.timing(running);
        self.command();
        self.time_base(running);
        self.faults();
        self.inputs.rst = self.clock < 2 || self.interrupts(20_000);
        let toggles = if self.inputs.enable {
            self.interrupts(2500)
        } else {
            self.one_in(300)
        };
        if toggles {
            self.inputs.enable = !self.inputs.enable;
        }
        if self.one_in(if self.inputs.mask_pins { 150 } else { 1500 }) {
            self.inputs.mask_pins = !self.inputs.mask_pins;
        }
        self.clock += 1;
        for (input, value) in inputs.iter_mut().zip(self.inputs.to_raw()) {
            *input = value;
        }
    }
}

/// Checks what must hold at the pins in every clock: both sides of a leg are never on together, and from the turn-off
/// of one side to the turn-on of the other at least the dead time in use elapses.
#[derive(Debug, Clone)]
pub struct GateSafety {
    active_low: [bool; 4],
    clock: u64,
    /// The last clock in which each gate was on, plus one.
    last_on: [u64; 4],
    was_on: [bool; 4],
    /// Description of the first violation.
    violation: Option<String>,
}

impl GateSafety {
    /// Creates a checker for pins of these polarities.
    pub fn new(active_low: ActiveLow) -> Self {
        Self {
            active_low: [active_low.a_high, active_low.a_low, active_low.b_high, active_low.b_low],
            clock: 0,
            last_on: [0; 4],
            was_on: [false; 4],
            violation: None,
        }
    }

    /// Adds a clock, given the device's outputs.
    pub fn observe(&mut self, shown: &[u64]) {
        let (levels, dead_time) = (&shown[..4], shown[15]);
        self.clock += 1;
        let mut on = [false; 4];
        for (at, level) in levels.iter().enumerate() {
            on[at] = (*level != 0) != self.active_low[at];
        }
        for at in 0..4 {
            let other = at ^ 1;
            let rises = on[at] && !self.was_on[at];
            let pause = self.clock - self.last_on[other] - 1;
            let close = rises && self.last_on[other] != 0 && pause < dead_time;
            if ((on[at] && on[other]) || close) && self.violation.is_none() {
                self.violation = Some(format!(
                    "clock {}: gate {at} on {pause} clocks after gate {other}, dead time {dead_time}",
                    self.clock
                ));
            }
        }
        for (at, on) in on.into_iter().enumerate() {
            if on {
                self.last_on[at] = self.clock;
            }
        }
        self.was_on = on;
    }

    /// Returns a description of the first violation.
    pub fn violation(&self) -> Option<&str> {
        self.violation.as_deref()
    }
}

/// Counts of the events in a lockstep run of the PWM, by name.
#[derive(Debug, Clone)]
pub struct PwmCoverage {
    outputs: Vec<String>,
    before: [u64; OUTPUT_PORTS],
    /// Number of times that each output changed.
    changed: Vec<u64>,
    resets: u64,
    /// Number of rising edges of a high side by mode, and of starts by mode.
    pulses: [u64; 4],
    starts: [u64; 4],
    /// Number of trips by cause.
    trips: [u64; 5],
    /// Number of periods with the high side always on, and never on.
    full: u64,
    none: u64,
    constant: Option<bool>,
    mode: u8,
    peak_updates: u64,
    off_by_enable: u64,
    /// Per pin, the number of clocks in which the gate is on and the mask keeps the pin off.
    masked: [u64; 4],
    was_masked: bool,
}

impl Default for PwmCoverage {
    fn default() -> Self {
        let is_output = |port: &Port| port.direction == Direction::Output;
        let outputs: Vec<String> = ports().into_iter().filter(is_output).map(|port| port.name).collect();
        Self {
            before: [0; OUTPUT_PORTS],
            changed: vec![0; outputs.len()],
            outputs,
            resets: 0,
            pulses: [0; 4],
            starts: [0; 4],
            trips: [0; 5],
            full: 0,
            none: 0,
            constant: None,
            mode: 0,
            peak_updates: 0,
            off_by_enable: 0,
            masked: [0; 4],
            was_masked: false,
        }
    }
}

impl PwmCoverage {
    /// Adds a clock, given its inputs and the model's outputs, of a PWM whose pins are all active high.
    pub fn observe(&mut self, inputs: &[u64], expected: &[u64]) {
        let (Ok(inputs), Ok(expected)) = (
            <&[u64; INPUT_PORTS]>::try_from(inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(expected),
        ) else {
            return;
        };
        let (inputs, shown) = (Inputs::from_raw(inputs), Outputs::from_raw(expected));
        let before = Outputs::from_raw(&self.before);
        let mode = usize::from(self.mode);
        let pulse = (shown.a_high && !before.a_high) || (shown.b_high && !before.b_high);
        self.resets += u64::from(inputs.rst);
        self.pulses[mode] += u64::from(pulse);
        self.starts[mode] += u64::from(shown.running && !before.running);
        for (at, trips) in self.trips.iter_mut().enumerate() {
            *trips += u64::from((shown.trip_causes & !before.trip_causes) >> at & 1);
        }
        self.off_by_enable += u64::from(!shown.running && before.running && !shown.tripped);
        self.peak_updates += u64::from(shown.running && shown.peak && inputs.update_at_peak);
        let gates = shown.gates;
        let in_order = [gates.a_high, gates.a_low, gates.b_high, gates.b_low];
        for (masked, gate) in self.masked.iter_mut().zip(in_order) {
            *masked += u64::from(self.was_masked && gate);
        }
        self.was_masked = inputs.mask_pins;
        // The gates are taken before the mask: a period whose pins were masked had its pulse.
        let high = gates.a_high || gates.b_high;
        if shown.valley {
            self.full += u64::from(self.constant == Some(true));
            self.none += u64::from(self.constant == Some(false));
            self.constant = shown.running.then_some(high);
        } else if self.constant != Some(high) || !shown.running {
            self.constant = None;
        }
        self.mode = inputs.mode;
        for (at, (value, before)) in expected.iter().zip(&mut self.before).enumerate() {
            self.changed[at] += u64::from(value != before);
            *before = *value;
        }
    }

    /// Returns each event's name and count: changes of every output, and some combined events.
    pub fn counts(&self) -> Vec<(&str, u64)> {
        let outputs = self
            .outputs
            .iter()
            .map(String::as_str)
            .zip(self.changed.iter().copied());
        let modes = ["direction", "half bridge", "unipolar", "locked"];
        let starts = ["start direction", "start half bridge", "start unipolar", "start locked"];
        let trips = [
            "latch trips",
            "filtered 0 trips",
            "filtered 1 trips",
            "pll trips",
            "watchdog trips",
        ];
        let masked = ["masked a_high", "masked a_low", "masked b_high", "masked b_low"];
        let more = [
            ("resets", self.resets),
            ("full periods", self.full),
            ("periods without a pulse", self.none),
            ("updates at the peak", self.peak_updates),
            ("off by enable", self.off_by_enable),
        ];
        outputs
            .chain(modes.into_iter().zip(self.pulses))
            .chain(starts.into_iter().zip(self.starts))
            .chain(trips.into_iter().zip(self.trips))
            .chain(masked.into_iter().zip(self.masked))
            .chain(more)
            .collect()
    }

    /// Returns the smallest of all counts.
    pub fn least(&self) -> u64 {
        self.counts().into_iter().map(|(_, count)| count).min().unwrap_or(0)
    }
}
