//! Seeded random inputs for the command FIFO: whole entries and single words, valid and invalid; moves that end at
//! rest and others; ticks at every pace; requests, resets, and stops of every size.

use posicast_blocks::segments::{
    CUBIC, CubicEntry, ENTRIES_MAX, Entry, EntryMotion, INPUT_PORTS, Inputs, LATENCY_CLOCKS, MORE, POINT, Point,
    SegmentsState, TICK_CLOCKS,
};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::VecDeque;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Number of clocks between changes of the slow inputs.
const MOOD_CLOCKS: u64 = 6_000;

/// Numbers of clocks from tick to tick: too few, the fewest allowed without a new entry and with one, and more.
const PACES: [u32; 8] = [
    1,
    LATENCY_CLOCKS,
    TICK_CLOCKS,
    TICK_CLOCKS,
    TICK_CLOCKS,
    TICK_CLOCKS + 1,
    60,
    100,
];

/// Jerks of the two moods from [`OVERFLOW_MOOD`] on: the sums overflow upwards, then downwards. Random jerks rarely
/// last long enough.
const OVERFLOWS: [i64; 2] = [(1 << 39) - 1, -(1 << 39)];

/// Number of random moods before the first overflow.
const OVERFLOW_MOOD: u64 = 8;
/// The mood that starves: the one after the last overflow.
const STARVING_MOOD: u64 = OVERFLOW_MOOD + OVERFLOWS.len() as u64;

/// Settings that hold for a while.
#[derive(Debug, Clone, Copy, Default)]
struct Mood {
    /// One write comes in this many clocks.
    write_pace: u32,
    /// One tick comes in about this many clocks.
    tick_pace: u32,
    /// One request comes in this many clocks.
    request_pace: u32,
    enable: bool,
    stop_deceleration: u64,
    low_water: u64,
    modulo: u64,
    /// Pace of the feed hold: never, always, or about every other tick.
    hold_pace: u32,
    extrapolation: u64,
    /// Whether nothing is written after the words that wait already.
    starves: bool,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct SegmentsRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    mood: Mood,
    until_tick: u32,
    feed_hold: bool,
    /// Whether the next clock requests a preset.
    presets: bool,
    /// Words to write, as (word, data).
    words: VecDeque<(u64, u64)>,
}

impl SegmentsRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            mood: Mood::default(),
            until_tick: 1,
            feed_hold: false,
            presets: false,
            words: VecDeque::new(),
        }
    }

    fn new_mood(&mut self) {
        let rng = &mut self.rng;
        let any: u64 = rng.random_range(0..1 << 31);
        let shifted = any >> rng.random_range(0..31);
        self.mood = Mood {
            write_pace: *pick(rng, &[1, 5, 40, 80, 200]),
            tick_pace: *pick(rng, &PACES),
            request_pace: *pick(rng, &[200, 2_000, 500_000, 500_000]),
            enable: rng.random_range(0..8) != 0,
            stop_deceleration: *pick(rng, &[0, 1, any, shifted, shifted, (1 << 31) - 1]),
            low_water: rng.random_range(0..u64::from(ENTRIES_MAX)),
            modulo: rng.random_range(0..2),
            hold_pace: *pick(rng, &[0, 0, 0, 1, 60, 60]),
            extrapolation: *pick(rng, &[0, 0, 1, 2, 5, 255]),
            starves: false,
        };
    }

    /// Drives the sums out of their words quickly and with certainty, then stops with the upper bits of the
    /// deceleration.
    fn overflow(&mut self, jerk: i64) {
        self.mood.enable = true;
        (self.mood.modulo, self.mood.hold_pace, self.mood.extrapolation) = (0, 0, 0);
        self.mood.stop_deceleration |= 1 << 30;
        (self.mood.write_pace, self.mood.tick_pace, self.mood.request_pace) = (5, TICK_CLOCKS, 500_000);
        self.words.clear();
        // The queued and the playing entries are discarded at the next tick, which comes with the first of these.
        self.presets = true;
        let entry = Entry {
            ticks: 30,
            motion: EntryMotion::Jerk(jerk),
            notify: false,
        };
        self.push_words(&[entry.words(); 8]);
    }

    /// Fills the whole FIFO with one batch after one that is too large, and then leaves its slow motion to be
    /// extrapolated: random batches seldom find the FIFO empty, and random motions soon leave the range.
    fn starve(&mut self) {
        self.mood = Mood {
            write_pace: 1,
            tick_pace: TICK_CLOCKS,
            request_pace: 500_000,
            enable: true,
            modulo: 1,
            hold_pace: 0,
            extrapolation: 255,
            starves: true,
            ..self.mood
        };
        self.words.clear();
        self.presets = true;
        let slow = Entry {
            ticks: 1,
            motion: EntryMotion::Cubic(CubicEntry {
                jerk: 0,
                velocity: 1 << 16,
                acceleration: 0,
            }),
            notify: false,
        };
        self.until_tick = 1;
        // The preset drops what arrives until the next tick, and so the first of the batches; one entry more than the
        // FIFO has drops the second.
        let all = usize::from(ENTRIES_MAX);
        for count in [all + 1, all + 1, all] {
            self.push_words(&Entry::batch(&vec![slow; count]));
        }
    }

    fn jerk(&mut self) -> i64 {
        let any = self.rng.random_range(-(1i64 << 39)..1 << 39);
        any >> self.rng.random_range(0..40)
    }

    fn ticks(&mut self) -> u32 {
        let few = self.rng.random_range(1..5);
        *pick(&mut self.rng, &[few, few, few, 30])
    }

    /// Queues a move there and back: the jerks j, −2·j, j over n ticks each way end at rest.
    fn push_move(&mut self) {
        let (jerk, ticks) = (self.jerk() >> 6, self.ticks());
        for (ticks, jerk) in [(ticks, jerk), (2 * ticks, -jerk), (ticks, jerk)] {
            let notify = self.rng.random_range(0..3) == 0;
            self.push(&Entry {
                ticks,
                motion: EntryMotion::Jerk(jerk),
                notify,
            });
        }
    }

    fn push_point(&mut self) {
        let rests = self.rng.random_range(0..2) == 0;
        let mut word = || {
            let any = self.rng.next_u64() as i32;
            // A byte beside the largest word covers what rounds up past the end.
            *pick(&mut self.rng, &[any, any >> 16, any >> 23, i32::MAX, i32::MIN, 0])
        };
        let position = word();
        let (velocity, acceleration) = if rests { (0, 0) } else { (word(), word()) };
        let point = Point {
            position,
            velocity,
            acceleration,
        };
        let ticks = self.ticks();
        self.push(&Entry {
            ticks,
            motion: EntryMotion::Point(point),
            notify: rests,
        });
        if self.rng.random_range(0..2) == 0 {
            // Less than an LSB of the outputs: added to the largest word, it would round past the end.
            let jerk = self.rng.random_range(0..256);
            self.push(&Entry {
                ticks: 1,
                motion: EntryMotion::Jerk(jerk),
                notify: false,
            });
        }
    }

    /// A cubic: long or short, slow or so fast that it overflows; it seldom ends at rest.
    fn cubic(&mut self) -> Entry {
        let rng = &mut self.rng;
        let mut word = || rng.next_u64() as i32 >> rng.random_range(0..32);
        let motion = EntryMotion::Cubic(CubicEntry {
            jerk: word(),
            velocity: word(),
            acceleration: word(),
        });
        Entry {
            ticks: self.ticks(),
            motion,
            notify: self.rng.random_range(0..3) == 0,
        }
    }

    /// Some entries that are taken together, or one of them is wrong.
    fn push_batch(&mut self) {
        let few = self.rng.random_range(1..5);
        let all = i32::from(ENTRIES_MAX);
        let many = self.rng.random_range(1..all);
        // All fit into an empty FIFO only, one more into none.
        let count = *pick(&mut self.rng, &[few, few, few, few, few, many, all, all + 1]);
        let entries: Vec<Entry> = (0..count).map(|_| self.cubic()).collect();
        let mut batch = Entry::batch(&entries);
        if self.rng.random_range(0..3) == 0 {
            let wrong = self.rng.random_range(0..batch.len());
            batch[wrong][3] ^= *pick(&mut self.rng, &[POINT, 1 << 24, MORE]);
        }
        self.push_words(&batch);
    }

    fn push_words(&mut self, entries: &[[u32; 4]]) {
        for words in entries {
            self.words
                .extend((0..).zip(*words).map(|(word, data)| (word, u64::from(data))));
        }
    }

    fn push(&mut self, entry: &Entry) {
        self.push_words(&[entry.words()]);
        if let (EntryMotion::Jerk(_), 0) = (entry.motion, self.rng.random_range(0..2)) {
            let unused = self.words.len() - 2;
            self.words.remove(unused);
        }
    }

    /// Queues an entry with one error.
    fn push_malformed(&mut self) {
        let jerk = self.jerk();
        let good = Entry {
            ticks: 3,
            motion: EntryMotion::Jerk(jerk),
            notify: false,
        };
        let mut words = good.words();
        let missing = self.rng.random_range(0..8);
        match self.rng.random_range(0..5) {
            0 => words[1] ^= 1 << self.rng.random_range(7..32),
            1 => words[3] |= 1 << self.rng.random_range(24..30),
            2 => words[3] = 0,
            3 => words[3] |= *pick(&mut self.rng, &[POINT, CUBIC, POINT | CUBIC]),
            _ => {}
        }
        for (word, data) in (0..).zip(words) {
            if word != missing {
                self.words.push_back((word, u64::from(data)));
            }
        }
    }

    fn refill(&mut self) {
        match self.rng.random_range(0..20) {
            0..=8 => self.push_move(),
            9..=11 => self.push_point(),
            16..=17 => self.push_batch(),
            18..=19 => {
                let cubic = self.cubic();
                self.push(&cubic);
            }
            12..=13 => self.push_malformed(),
            14 => {
                let entry = Entry {
                    ticks: self.ticks(),
                    motion: EntryMotion::Jerk(self.jerk()),
                    notify: true,
                };
                self.push(&entry);
            }
            _ => {
                let word = self.rng.random_range(0..4);
                let data = self.rng.next_u64();
                self.words.push_back((word, data));
            }
        }
    }
}

impl Stimuli for SegmentsRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        if self.clock.is_multiple_of(MOOD_CLOCKS) {
            let mood = self.clock / MOOD_CLOCKS;
            // Starving lasts for two moods: the FIFO has to run empty first.
            if mood != STARVING_MOOD + 1 {
                self.new_mood();
            }
            if let Some(jerk) = mood
                .checked_sub(OVERFLOW_MOOD)
                .and_then(|at| OVERFLOWS.get(at as usize))
            {
                self.overflow(*jerk);
            }
            if mood == STARVING_MOOD {
                self.starve();
            }
        }
        let Ok(raw) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
            return;
        };
        let mood = self.mood;
        self.until_tick = self.until_tick.saturating_sub(1);
        let tick = self.until_tick == 0;
        if tick {
            self.until_tick = mood.tick_pace + self.rng.random_range(0..2);
        }
        let idles = mood.starves && self.words.is_empty();
        let write = !idles && self.rng.random_range(0..mood.write_pace) == 0;
        let (mut word, mut data) = (self.rng.next_u64(), self.rng.next_u64());
        if write {
            if self.words.is_empty() {
                self.refill();
            }
            (word, data) = self.words.pop_front().unwrap_or_default();
        }
        self.feed_hold = match mood.hold_pace {
            0 => false,
            pace => self.feed_hold != (self.rng.random_range(0..pace) == 0),
        };
        let mut request = || self.rng.random_range(0..mood.request_pace) == 0;
        let [flush, quick_stop, preset] = [request(), request(), request()];
        let preset = preset | std::mem::take(&mut self.presets);
        // Without a restart most runs would end at the first stop.
        let restart = self.rng.random_range(0..200) == 0;
        let inputs = Inputs {
            rst: self.clock < 2 || (!mood.starves && self.rng.random_range(0..20_000) == 0),
            tick,
            enable: mood.enable != (!mood.starves && self.rng.random_range(0..2_000) == 0),
            write,
            word: word as u8,
            data: data as u32,
            flush,
            quick_stop,
            restart,
            preset,
            preset_position: self.rng.next_u64() as i32,
            stop_deceleration: mood.stop_deceleration as u32,
            low_water: mood.low_water as u8,
            clear_flags: self.rng.random_range(0..100) == 0,
            modulo: mood.modulo != 0,
            feed_hold: self.feed_hold,
            extrapolation: mood.extrapolation as u8,
        };
        *raw = inputs.to_raw();
        self.clock += 1;
    }
}

/// Number of clocks in which each event of a run occurred.
#[derive(Debug, Clone, Copy, Default)]
pub struct SegmentsCoverage {
    counts: [u64; NAMES.len()],
    state: u64,
    late_ticks: u64,
}

/// Names of the counted events.
const NAMES: [&str; 19] = [
    "hold",
    "move",
    "stop",
    "stopped",
    "full",
    "low",
    "empty",
    "notify",
    "done",
    "underrun",
    "overflow",
    "refused",
    "malformed",
    "tick_missed",
    "stop to stopped",
    "out_of_range",
    "rests",
    "held",
    "late",
];

impl SegmentsCoverage {
    /// Adds the outputs of a clock.
    pub fn observe(&mut self, outputs: &[u64]) {
        let &[
            _,
            _,
            _,
            _,
            state,
            level,
            low,
            empty,
            notify,
            done,
            underrun,
            overflow,
            refused,
            malformed,
            missed,
            out_of_range,
            rests,
            held,
            late_ticks,
        ] = outputs
        else {
            return;
        };
        let is = |wanted: SegmentsState| u64::from(state == wanted as u64);
        let stopped = u64::from(self.state == SegmentsState::Stop as u64) & is(SegmentsState::Stopped);
        let seen = [
            is(SegmentsState::Hold),
            is(SegmentsState::Move),
            is(SegmentsState::Stop),
            is(SegmentsState::Stopped),
            u64::from(level == u64::from(ENTRIES_MAX)),
            low,
            empty,
            notify,
            done,
            underrun,
            overflow,
            refused,
            malformed,
            missed,
            stopped,
            out_of_range,
            rests,
            held,
            u64::from(late_ticks != self.late_ticks),
        ];
        for (count, seen) in self.counts.iter_mut().zip(seen) {
            *count += seen;
        }
        (self.state, self.late_ticks) = (state, late_ticks);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        NAMES.into_iter().zip(self.counts)
    }

    /// Returns the smallest of all counts.
    pub fn least(&self) -> u64 {
        self.counts.into_iter().min().unwrap_or(0)
    }
}
