//! Seeded random mixtures, weighted so that deep states are reached within a few thousand clocks.
//!
//! Uniformly random bits would never load a table (its sum must be `2^F`) and would strobe in every second clock.
//! Therefore every axis runs small random processes, and strobes come in phases:
//!
//! - *strobes*: as fast as the pass allows, one clock earlier, one later, in every clock, at random, after long idle
//!   times;
//! - *commands*: noise, full-scale steps, ramps, constants, reversals;
//! - *tables*: loaded completely and correctly, then swapped in; or with one error;
//! - *read back*: taps of any bank at any time, drawn from a generator of its own;
//! - *everything else* at a low rate: start, clear, reset, stray writes and swaps.

use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::shaper::{AxisLayout, Layout, TableLayout};
use crate::stimuli::Stimuli;
use crate::stimuli::table::{Table, pick};

/// Time of the next strobe relative to the length of a pass.
#[derive(Debug, Clone, Copy)]
enum Pace {
    /// The strobe comes this many clocks after the pass could end; a negative number is an overrun.
    Pass(i64),
    EveryClock,
    Random,
    Idle,
}

/// Course of the command words.
#[derive(Debug, Clone, Copy)]
enum Course {
    Noise,
    FullScale,
    Ramp(i64),
    Constant,
    Walk,
}

/// State of an axis's loading of tables.
#[derive(Debug, Clone, Copy)]
enum Loading {
    Rest(u32),
    Write {
        bank: u64,
        index: usize,
        wrong: Option<usize>,
    },
    Ask {
        bank: u64,
        clocks: u32,
    },
}

#[derive(Debug, Clone)]
struct AxisState {
    axis: AxisLayout,
    course: Course,
    word: i64,
    loading: Loading,
    table: Table,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct Random {
    rng: Xoshiro256PlusPlus,
    /// Generator of the reads by a host, separate so that it does not change what else a run reaches.
    read_back: Xoshiro256PlusPlus,
    layout: Layout,
    axes: Vec<AxisState>,
    clock: u64,
    pace: Pace,
    phase_strobes: u32,
    clocks_since_strobe: u64,
    next_strobe: u64,
    pass_clocks: u64,
    was_busy: bool,
}

impl Random {
    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(layout: &Layout, seed: u64) -> Self {
        let state = |axis: &AxisLayout| AxisState {
            axis: axis.clone(),
            course: Course::Noise,
            word: 0,
            loading: Loading::Rest(20),
            table: Table::with_capacity(axis.tables.as_ref().map_or(0, most_taps)),
        };
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            read_back: Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(32)),
            axes: layout.axes.iter().map(state).collect(),
            layout: layout.clone(),
            clock: 0,
            pace: Pace::Random,
            phase_strobes: 0,
            clocks_since_strobe: 0,
            next_strobe: 3,
            pass_clocks: 16,
            was_busy: false,
        }
    }

    /// Measures the length of a pass from the slowest axis, and returns whether to strobe in this clock.
    fn strobe_now(&mut self, seen: &[u64]) -> bool {
        let busy = self.axes.iter().any(|state| seen[state.axis.busy] != 0);
        self.clocks_since_strobe += 1;
        if self.was_busy && !busy {
            // The outputs are seen one clock late: the first idle clock was the previous one.
            self.pass_clocks = self.clocks_since_strobe.saturating_sub(1).clamp(1, 4096);
        }
        self.was_busy = busy;
        if self.clocks_since_strobe < self.next_strobe {
            return false;
        }
        if self.phase_strobes == 0 {
            let paces = [
                Pace::Pass(0),
                Pace::Pass(0),
                Pace::Pass(0),
                Pace::Pass(-1),
                Pace::Pass(1),
                Pace::Pass(2),
                Pace::Pass(7),
                Pace::EveryClock,
                Pace::Random,
                Pace::Idle,
            ];
            self.pace = *pick(&mut self.rng, &paces);
            self.phase_strobes = match self.pace {
                Pace::Idle => 1,
                Pace::EveryClock => self.rng.random_range(2..20),
                _ => self.rng.random_range(1..40),
            };
        }
        self.phase_strobes -= 1;
        self.next_strobe = match self.pace {
            Pace::Pass(more) => self.pass_clocks.saturating_add_signed(more).max(1),
            Pace::EveryClock => 1,
            Pace::Random => self.rng.random_range(1..=2 * self.pass_clocks),
            Pace::Idle => self.rng.random_range(100..600),
        };
        self.clocks_since_strobe = 0;
        true
    }
}

impl Stimuli for Random {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        // Inputs that are not read in this clock are noise, so that a block that reads them is found.
        for (at, input) in inputs.iter_mut().enumerate() {
            let mut tables = self.axes.iter().filter_map(|state| state.axis.tables.as_ref());
            let read_back = tables.any(|tables| tables.tap_read == at);
            *input = if read_back { 0 } else { self.rng.next_u64() };
        }
        let reset = self.clock < 2 || one_in(&mut self.rng, 4000);
        let strobe = self.strobe_now(seen);
        inputs[self.layout.rst] = u64::from(reset);
        inputs[self.layout.strobe] = u64::from(strobe);
        for state in &mut self.axes {
            state.fill(&mut self.rng, strobe, seen, inputs);
            state.read_back(&mut self.read_back, inputs);
        }
        self.clock += 1;
    }
}

impl AxisState {
    fn fill(&mut self, rng: &mut Xoshiro256PlusPlus, strobe: bool, seen: &[u64], inputs: &mut [u64]) {
        let axis = &self.axis;
        inputs[axis.start] = u64::from(one_in(rng, if strobe { 60 } else { 200 }));
        inputs[axis.clear_flags] = u64::from(one_in(rng, 50));
        if let Some(tables) = &axis.tables {
            inputs[tables.tap_write] = u64::from(one_in(rng, 1000));
            inputs[tables.swap] = u64::from(one_in(rng, 1000));
        }
        if strobe {
            self.advance_word(rng);
            inputs[self.axis.x] = self.word as u64;
        }
        self.load(rng, seen, inputs);
    }

    /// Requests a tap, and sets its address in the clocks in which no tap is written: usually near the beginning,
    /// since most tables are short.
    fn read_back(&self, rng: &mut Xoshiro256PlusPlus, inputs: &mut [u64]) {
        let Some(tables) = &self.axis.tables else {
            return;
        };
        inputs[tables.tap_read] = u64::from(one_in(rng, 20));
        let (bank, index) = (rng.random_range(0..4), rng.random_range(0..8));
        let far = one_in(rng, 8);
        if inputs[tables.tap_write] == 0 {
            inputs[tables.tap_bank] = bank;
            inputs[tables.tap_index] = if far { inputs[tables.tap_index] } else { index };
        }
    }

    fn advance_word(&mut self, rng: &mut Xoshiro256PlusPlus) {
        let most = self.axis.largest_word();
        if one_in(rng, 30) {
            let courses = [
                Course::Noise,
                Course::FullScale,
                Course::FullScale,
                Course::Ramp(rng.random_range(-most / 50..=most / 50)),
                Course::Constant,
                Course::Walk,
            ];
            self.course = *pick(rng, &courses);
        }
        self.word = match self.course {
            Course::Noise => rng.random_range(-most - 1..=most),
            Course::FullScale => {
                let far = [
                    most,
                    -most - 1,
                    most - rng.random_range(0..4),
                    rng.random_range(0..4) - most,
                ];
                if one_in(rng, 3) { *pick(rng, &far) } else { self.word }
            }
            Course::Ramp(step) => self.word.saturating_add(step),
            Course::Constant => self.word,
            Course::Walk => self.word.saturating_add(rng.random_range(-3..=3)),
        };
        self.word = self.word.clamp(-most - 1, most);
    }

    /// Makes one step of loading a table; leaves `tap_write` and `swap` unchanged if there is nothing to do.
    fn load(&mut self, rng: &mut Xoshiro256PlusPlus, seen: &[u64], inputs: &mut [u64]) {
        let Some(tables) = &self.axis.tables else {
            return;
        };
        match &mut self.loading {
            Loading::Rest(clocks @ 1..) => *clocks -= 1,
            Loading::Rest(_) => {
                let size = most_taps(tables);
                let few = rng.random_range(1..=size.min(6));
                let count = *pick(rng, &[few, few, few, few, few, few, few, size / 4, size / 2 + 1, size]);
                // A handover lasts for the longest delay: with short tables it ends before something else ends it.
                let short = tables.swap_how.is_some() && !one_in(rng, 4);
                let reach_bits = if short { 3 } else { tables.ring_address_bits };
                self.table.draw(rng, count, tables.coefficient_fraction, reach_bits);
                let active = seen[tables.bank];
                // Mostly it is the loadable bank that is not active.
                let bank = if one_in(rng, 8) {
                    rng.random_range(0..4)
                } else {
                    2 - active.min(2) / 2
                };
                let wrong = one_in(rng, 6).then(|| rng.random_range(0..self.table.taps.len()));
                self.loading = Loading::Write { bank, index: 0, wrong };
            }
            Loading::Write { bank, index, wrong } => {
                if one_in(rng, 4) {
                    return;
                }
                let bank = *bank;
                let Some((coefficient, delay)) = self.table.taps.get(*index).copied() else {
                    self.loading = Loading::Ask {
                        bank,
                        clocks: rng.random_range(0..6),
                    };
                    return;
                };
                inputs[tables.tap_write] = 1;
                inputs[tables.tap_bank] = bank;
                inputs[tables.tap_index] = *index as u64;
                inputs[tables.tap_coefficient] = i64::from(coefficient) as u64;
                inputs[tables.tap_delay] = delay;
                if *wrong == Some(*index) {
                    match rng.random_range(0..5) {
                        0 => inputs[tables.tap_index] ^= 1,
                        1 => inputs[tables.tap_coefficient] = i64::from(coefficient + 1) as u64,
                        2 => inputs[tables.tap_delay] = u64::MAX,
                        3 => inputs[tables.tap_bank] ^= 3,
                        _ => inputs[tables.tap_coefficient] = 0,
                    }
                }
                *index += 1;
            }
            Loading::Ask {
                clocks: clocks @ 1.., ..
            } => *clocks -= 1,
            Loading::Ask { bank, .. } => {
                inputs[tables.swap] = 1;
                inputs[tables.swap_bank] = if one_in(rng, 10) { rng.random_range(0..4) } else { *bank };
                self.loading = Loading::Rest(*pick(rng, &[0, 10, 200, 1000]));
            }
        }
    }
}

/// Number of taps of the largest table.
fn most_taps(tables: &TableLayout) -> usize {
    1 << tables.tap_index_bits.min(8)
}

fn one_in(rng: &mut Xoshiro256PlusPlus, clocks: u32) -> bool {
    rng.random_range(0..clocks) == 0
}
