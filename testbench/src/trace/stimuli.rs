//! Seeded random inputs for the trace memory: every trigger mode, every number of signals, strobes at every pace,
//! signals that wander around the level; arms and halts in every state, settings that change meanwhile, reads of all
//! addresses.

use posicast_blocks::trace::{Inputs, ROW_SIGNALS, TraceConfig, TraceState, row_clocks};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Distance of the strobes.
#[derive(Debug, Clone, Copy)]
enum Pace {
    /// Strobes come as fast as rows can be taken, plus this many clocks.
    Row(u32),
    /// Strobes come one clock earlier: every second strobe is missed.
    TooFast,
    EveryClock,
    /// One strobe comes in about this many clocks.
    Random(u32),
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct TraceRandom {
    rng: Xoshiro256PlusPlus,
    config: TraceConfig,
    clock: u64,
    /// Number of clocks until the next mood.
    mood_clocks: u32,
    pace: Pace,
    until_strobe: u32,
    /// One halt comes in about this many clocks.
    halt_pace: u32,
    /// One `arm` comes in about this many clocks while a trace is being taken.
    arm_pace: u32,
    /// Whether signals change in every clock, not only with the strobe.
    noisy: bool,
    now: Inputs,
}

impl TraceRandom {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(config: &TraceConfig, seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            config: *config,
            clock: 0,
            mood_clocks: 0,
            pace: Pace::EveryClock,
            until_strobe: 1,
            halt_pace: 1,
            arm_pace: 1,
            noisy: false,
            now: Inputs::default(),
        }
    }

    fn new_mood(&mut self) {
        let samples = self.config.samples();
        let rng = &mut self.rng;
        self.mood_clocks = rng.random_range(1..20 * samples);
        let about = rng.random_range(1..30);
        let paces = [
            Pace::Row(0),
            Pace::Row(0),
            Pace::Row(about),
            Pace::TooFast,
            Pace::EveryClock,
            Pace::Random(about),
        ];
        self.pace = *pick(rng, &paces);
        self.halt_pace = *pick(rng, &[200, 8 * samples, u32::MAX, u32::MAX]);
        self.arm_pace = *pick(
            rng,
            &[100, 1000, 100 * samples, 100 * samples, 100 * samples, 100 * samples],
        );
        self.noisy = rng.random_range(0..4) == 0;
        for setting in 0..SETTINGS {
            self.change(setting);
        }
    }

    /// Changes one of the settings.
    fn change(&mut self, setting: u32) {
        let rng = &mut self.rng;
        let any = rng.next_u64();
        match setting {
            0 => {
                self.now = self
                    .now
                    .with_selects([0, 4, 8, 12].map(|shift| (any >> shift) as u8 & 15))
            }
            1 => self.now.signals = any as u8 & 3,
            2 => self.now.decimation = *pick(rng, &[0, 0, 0, 1, 2, any as u16 & 15, any as u16]),
            3 => self.now.trigger_select = any as u8 & 15,
            4 => self.now.trigger_mode = any as u8 & 3,
            5 => self.now.trigger_level = *pick(rng, &[0, 0, any as i32 >> 24, any as i32, i32::MIN, i32::MAX]),
            _ => {
                let rows = self.config.rows(self.now.signals) as u16;
                let shifted = (any as u16 & 0x7ff) >> (any >> 60);
                self.now.pre_trigger = *pick(rng, &[0, 1, rows / 2, rows - 1, rows, 2047, shifted, shifted]);
            }
        }
    }

    fn strobe_now(&mut self) -> bool {
        self.until_strobe = self.until_strobe.saturating_sub(1);
        if self.until_strobe > 0 {
            return false;
        }
        let clocks = row_clocks(self.now.signals);
        self.until_strobe = match self.pace {
            Pace::Row(more) => clocks + more,
            Pace::TooFast => clocks - 1,
            Pace::EveryClock => 1,
            Pace::Random(about) => self.rng.random_range(1..=2 * about),
        };
        true
    }

    /// Moves the signals in small steps, and now and then to any value.
    fn move_signals(&mut self) {
        for signal in &mut self.now.signal {
            let any = self.rng.next_u64();
            let step = (any as i32 % 128).saturating_sub(*signal / 64);
            *signal = match any >> 58 {
                0 => (any >> 20) as i32,
                1 => *pick(&mut self.rng, &[i32::MIN, i32::MAX, 0, -1]),
                2..=8 => (any as i8).into(),
                _ => signal.saturating_add(step),
            };
        }
    }
}

/// Number of settings that [`TraceRandom::change`] chooses from.
const SETTINGS: u32 = 7;

impl Stimuli for TraceRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        if self.mood_clocks == 0 {
            self.new_mood();
        }
        self.mood_clocks -= 1;
        let strobe = self.strobe_now();
        if strobe || self.noisy {
            self.move_signals();
        }
        if self.rng.random_range(0..3_000) == 0 {
            let setting = self.rng.random_range(0..SETTINGS);
            self.change(setting);
        }
        let is_idle = seen.get(1) == Some(&(TraceState::Idle as u64));
        let samples = self.config.samples();
        let rng = &mut self.rng;
        // There is mostly enough time to read everything.
        let arm_pace = if is_idle { 2 * samples } else { self.arm_pace };
        self.now.read_address = match rng.random_range(0..samples) {
            0 => rng.random_range(0..2048),
            1 => 0,
            _ => (self.now.read_address + 1) & 0x7ff,
        };
        let raw = Inputs {
            rst: self.clock < 2 || rng.random_range(0..30_000) == 0,
            strobe,
            trigger_event: rng.random_range(0..400) == 0,
            arm: rng.random_range(0..arm_pace) == 0,
            halt: rng.random_range(0..self.halt_pace) == 0,
            ..self.now
        }
        .to_raw();
        inputs.iter_mut().zip(raw).for_each(|(input, value)| *input = value);
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the trace memory.
#[derive(Debug, Clone)]
pub struct TraceCoverage {
    config: TraceConfig,
    counts: [u64; NAMES.len()],
    before: Inputs,
    state: u64,
}

/// Names of the counted events.
const NAMES: [&str; 22] = [
    "idle",
    "filling",
    "waiting",
    "taking",
    "complete, one signal",
    "complete, two signals",
    "complete, four signals",
    "trigger at once",
    "trigger rising",
    "trigger falling",
    "trigger by event",
    "halted while filling",
    "halted while waiting",
    "halted while taking",
    "armed anew while filling",
    "armed anew while waiting",
    "armed anew while taking",
    "pre-trigger cut",
    "strobe missed",
    "word read",
    "nothing read beyond the rows",
    "reset while active",
];

impl TraceCoverage {
    /// Creates counters at zero.
    pub fn new(config: &TraceConfig) -> Self {
        Self {
            config: *config,
            counts: [0; NAMES.len()],
            before: Inputs::default(),
            state: 0,
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(raw), &[data, state, rows, _, missed, done]) = (clock.inputs.try_into(), clock.expected) else {
            return;
        };
        let inputs = Inputs::from_raw(raw);
        let before = std::mem::replace(&mut self.before, inputs);
        let state_before = std::mem::replace(&mut self.state, state);
        let samples = u64::from(self.config.samples());
        let was = |wanted: TraceState| state_before == wanted as u64;
        let halted = state == TraceState::Idle as u64 && done == 0 && !before.rst;
        let triggered = state == TraceState::Taking as u64 && !was(TraceState::Taking);
        let triggered_by = |mode| triggered && before.trigger_mode == mode;
        let idle = state == TraceState::Idle as u64 && was(TraceState::Idle);
        let beyond = u64::from(before.read_address) >= rows * ROW_SIGNALS as u64;
        let seen = [
            state == TraceState::Idle as u64,
            state == TraceState::Filling as u64,
            state == TraceState::Waiting as u64,
            state == TraceState::Taking as u64,
            done == 1 && rows == samples,
            done == 1 && rows == samples / 2,
            done == 1 && rows == samples / 4,
            triggered_by(0),
            triggered_by(1),
            triggered_by(2),
            triggered_by(3),
            halted && was(TraceState::Filling),
            halted && was(TraceState::Waiting),
            halted && was(TraceState::Taking),
            before.arm && was(TraceState::Filling),
            before.arm && was(TraceState::Waiting),
            before.arm && was(TraceState::Taking),
            inputs.arm && usize::from(inputs.pre_trigger) >= self.config.rows(inputs.signals),
            missed == 1,
            data != 0,
            idle && rows > 0 && beyond,
            before.rst && state_before != TraceState::Idle as u64,
        ];
        for (count, seen) in self.counts.iter_mut().zip(seen) {
            *count += u64::from(seen);
        }
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        NAMES.into_iter().zip(self.counts)
    }
}
