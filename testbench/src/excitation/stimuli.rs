//! Seeded random inputs for the excitation: signals of every kind, size, period, sweep and duration, complete or
//! ended early by `enable`, `allowed`, a reset or another kind; positions at the ends of their word; ticks far apart,
//! and now and then too close; settings that change while a signal runs.

use posicast_blocks::excitation::{ExcitationKind, INPUT_PORTS, Inputs, OUTPUT_PORTS, TICK_CLOCKS, TURN_STEPS};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Values of `kind`, in the order of its bits.
const KINDS: [ExcitationKind; 4] = [
    ExcitationKind::None,
    ExcitationKind::Prbs,
    ExcitationKind::Chirp,
    ExcitationKind::Square,
];
/// Index of `excitation_active` among the outputs.
const ACTIVE: usize = 5;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct ExcitationRandom {
    rng: Xoshiro256PlusPlus,
    raw: [u64; INPUT_PORTS],
    clock: u64,
    until_valid: u32,
    tick_clocks: u32,
    /// Number of clocks until `enable` falls or rises.
    until_enable: u32,
    /// Whether settings change at any time.
    unrest: bool,
}

impl ExcitationRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            raw: [0; INPUT_PORTS],
            clock: 0,
            until_valid: 10,
            tick_clocks: 60,
            until_enable: 5,
            unrest: false,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    /// Draws the settings of another signal.
    fn settings(&mut self) {
        let rng = &mut self.rng;
        let word = rng.next_u64();
        let any = word & 0xffff;
        let small = any >> rng.random_range(0..16);
        let kind = *pick(rng, &[0, 1, 1, 1, 2, 2, 2, 3]);
        let amplitude = *pick(rng, &[any, any, small, 0, 1, 0xffff]);
        let other = word >> 16 & 0xffff;
        let limit = *pick(rng, &[0xffff, 0xffff, other, amplitude, amplitude.saturating_sub(1), 0]);
        let period = *pick(rng, &[1, 2, 3, 5, 8, 20, 100, small, any, 0]);
        // The first bits of a PRBS are 15 ones and 14 zeros: only short bits get beyond them in the time of a run.
        let period = if kind == 1 {
            *pick(rng, &[1, 1, 1, 2, 3, period])
        } else {
            period
        };
        let sweep = *pick(rng, &[0, small, small, any, 0xffff, 0xffff]);
        let duration = *pick(rng, &[0, 1, 2, 40, 300, 1000, 1000, 1000, word >> 40]);
        let modulo = word >> 32 & 1;
        self.raw[7..].copy_from_slice(&[kind, amplitude, limit, period, sweep, duration, modulo]);
        // Ticks come as close as the first frequency allows, as close as any frequency allows, or too close.
        let turn = (TURN_STEPS / (period as u32).max(1) + 24).min(TICK_CLOCKS);
        self.tick_clocks = *pick(rng, &[turn, turn, turn, turn, TICK_CLOCKS, 30]);
    }

    fn position(&mut self) -> u64 {
        let any = self.rng.next_u32();
        let beside = self.rng.random_range(0..0x1_0000);
        u64::from(*pick(
            &mut self.rng,
            &[
                any,
                any,
                0x7fff_ffff - beside,
                0x8000_0000 + beside,
                0x7fff_ffff,
                0x8000_0000,
            ],
        ))
    }
}

impl Stimuli for ExcitationRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        self.until_enable = self.until_enable.saturating_sub(1);
        let over = self.raw[5] == 1 && seen.get(ACTIVE) == Some(&0) && self.one_in(300);
        if self.until_enable == 0 || over {
            self.raw[5] ^= 1;
            let long = self.rng.random_range(1..40_000);
            let short = self.rng.random_range(1..200);
            self.until_enable = if self.raw[5] == 1 {
                *pick(&mut self.rng, &[long, long, short])
            } else {
                short
            };
            if self.raw[5] == 0 {
                self.settings();
                self.unrest = self.one_in(4);
            }
        }
        if self.unrest && self.one_in(500) {
            self.settings();
        }
        self.raw[0] = u64::from(self.clock < 2 || self.one_in(20_000));
        if self.one_in(if self.raw[6] == 1 { 10_000 } else { 150 }) {
            self.raw[6] ^= 1;
        }
        self.until_valid = self.until_valid.saturating_sub(1);
        self.raw[1] = u64::from(self.until_valid == 0);
        if self.until_valid == 0 {
            self.until_valid = if self.unrest && self.one_in(10) {
                self.rng.random_range(1..30)
            } else {
                self.tick_clocks
            };
            let words = [self.position(), self.rng.next_u64(), self.rng.next_u64()];
            self.raw[2..5].copy_from_slice(&words);
        } else if self.one_in(50) {
            // Between two ticks the positions are ignored.
            self.raw[2] = self.rng.next_u64();
        }
        self.clock += 1;
        for (input, value) in inputs.iter_mut().zip(self.raw) {
            *input = value;
        }
    }
}

/// Counts of the events in a lockstep run of the excitation.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ExcitationCoverage {
    before: Option<(Inputs, bool, i32)>,
    resets: u64,
    /// Number of ticks with a signal, by kind: PRBS, chirp, square.
    ticks: [u64; 3],
    prbs_changes: u64,
    zero_crossings: u64,
    done: u64,
    too_fast: u64,
    disabled: u64,
    forbidden: u64,
    limited: u64,
    at_the_ends: u64,
    wrapped: u64,
    /// Number of ticks of the running signal.
    length: u32,
}

impl ExcitationCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(raw), Ok(&[position, _, _, valid, value, active, done])) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let inputs = Inputs::from_raw(raw);
        let value = value as u32 as i32;
        self.resets += u64::from(inputs.rst);
        self.done += done;
        if let Some((before, was_active, value_before)) = self.before {
            self.length = if active == 0 && done == 0 {
                0
            } else {
                self.length + u32::from(before.valid)
            };
            self.too_fast += u64::from(done == 1 && self.length < before.duration_ticks);
            let aborted = was_active && active == 0 && !before.rst;
            self.disabled += u64::from(aborted && !before.enable);
            self.forbidden += u64::from(aborted && before.enable && !before.allowed);
            if valid == 1 && value != 0 {
                let exact = i64::from(before.y_0) + i64::from(value);
                let shown = position as u32 as i32;
                let fits = i32::try_from(exact).is_ok();
                self.at_the_ends += u64::from(!fits && !before.modulo && (shown == i32::MAX || shown == i32::MIN));
                self.wrapped += u64::from(!fits && before.modulo);
                self.limited += u64::from(before.amplitude > before.amplitude_limit);
                let kind = KINDS.iter().position(|kind| *kind == before.kind).unwrap_or_default();
                if let Some(ticks) = kind.checked_sub(1).and_then(|kind| self.ticks.get_mut(kind)) {
                    *ticks += 1;
                }
                let turned = value.signum() * value_before.signum() < 0;
                self.prbs_changes += u64::from(before.kind == ExcitationKind::Prbs && turned);
                self.zero_crossings += u64::from(before.kind == ExcitationKind::Chirp && turned);
            }
        }
        self.before = Some((inputs, active == 1, value));
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 13] {
        let [prbs, chirp, square] = self.ticks;
        [
            ("resets", self.resets),
            ("ticks of a PRBS", prbs),
            ("ticks of a chirp", chirp),
            ("ticks of a square", square),
            ("changes of a PRBS", self.prbs_changes),
            ("zeros of a chirp", self.zero_crossings),
            ("signals that ended by themselves", self.done),
            ("signals that became too fast", self.too_fast),
            ("signals ended by the host", self.disabled),
            ("signals ended by the axis", self.forbidden),
            ("ticks at the amplitude's limit", self.limited),
            ("positions at the ends of their word", self.at_the_ends),
            ("positions that wrap", self.wrapped),
        ]
    }
}
