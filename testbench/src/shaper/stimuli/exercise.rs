//! What a lockstep run of shapers must have exercised before its result counts: every tap, every bank, both levels of
//! every flag.
//!
//! It is measured in the run itself, from the model's ports. If no sample reached a table's longest delay, that table
//! has not been compared, however many clocks were equal.
//!
//! ```text
//! tap i was seen:  in a pass over bank 0, not clamped, with 2^F ≤ |c_i · x[n − d_i]| and x[n − d_i] ≠ x[n − d_i ± 1]
//! ```
//!
//! Of a cascade, which has neither banks nor a clamp, each half sum counts in place of a tap: as the impulse 2^−N after its delay.

use std::collections::VecDeque;

use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::shaper::wrap;
use posicast_taps::Tap;

use crate::lockstep::Clock;
use crate::shaper::{AxisLayout, Layout};

/// Least number of times that a tap must be seen: once could be chance.
const LEAST_TIMES: u32 = 2;

/// Flags that must be seen at both levels.
const FLAGS: [&str; 5] = ["saturated", "overrun", "refused", "swap_pending", "tap_read_waits"];

/// What each shaper of a layout has exercised so far.
#[derive(Debug, Clone)]
pub struct ShaperExercise {
    rst: usize,
    strobe: usize,
    shapers: Vec<Shown>,
}

#[derive(Debug, Clone)]
struct Shown {
    axis: AxisLayout,
    taps: Vec<Tap>,
    /// Fraction bits of their coefficients.
    fraction: u32,
    /// Number of times that each tap was seen.
    seen: Vec<u32>,
    /// Number of samples that make a full delay line.
    longest_delay_samples: u32,
    word_bits: u32,
    saturates: bool,
    /// Samples since the last start, newest first, as many as the longest delay needs.
    samples: VecDeque<i64>,
    /// Whether a pass over bank 0 is under way.
    in_pass: bool,
    /// Number of results over each bank.
    results: [u32; 3],
    /// Whether each flag was seen low, and high.
    flags: [[bool; 2]; FLAGS.len()],
}

impl ShaperExercise {
    /// Creates a record for shapers of these configurations, in the order of the layout.
    pub fn new<'a>(layout: &Layout, configs: impl IntoIterator<Item = &'a AxisShaperConfig>) -> Self {
        let shown = |(axis, config): (&AxisLayout, &AxisShaperConfig)| {
            let (fraction, taps) = seen_taps(config);
            Shown {
                axis: axis.clone(),
                seen: vec![0; taps.len()],
                taps,
                fraction,
                longest_delay_samples: config.longest_delay_samples(),
                word_bits: config.word_bits(),
                saturates: config.saturates(),
                samples: VecDeque::new(),
                in_pass: false,
                results: [0; 3],
                flags: [[false; 2]; FLAGS.len()],
            }
        };
        Self {
            rst: layout.rst,
            strobe: layout.strobe,
            shapers: layout.axes.iter().zip(configs).map(shown).collect(),
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (reset, strobe) = (clock.inputs[self.rst] & 1 != 0, clock.inputs[self.strobe] & 1 != 0);
        for shown in &mut self.shapers {
            shown.observe(reset, strobe, clock);
        }
    }

    /// Returns what has not been exercised, per shaper.
    pub fn missing(&self) -> Vec<Vec<String>> {
        self.shapers.iter().map(Shown::missing).collect()
    }
}

/// The taps that must be seen, and their fraction bits.
fn seen_taps(config: &AxisShaperConfig) -> (u32, Vec<Tap>) {
    match config {
        AxisShaperConfig::Taps(config) => (config.coefficient_fraction(), config.table().taps().to_vec()),
        AxisShaperConfig::Cascade(config) => {
            let half_sum = |&delay_samples: &u32| Tap {
                delay_samples,
                coefficient: 1,
            };
            (config.stages(), config.delays_samples().iter().map(half_sum).collect())
        }
    }
}

impl Shown {
    fn observe(&mut self, reset: bool, strobe: bool, clock: &Clock<'_>) {
        let (inputs, outputs) = (clock.inputs, clock.expected);
        let axis = &self.axis;
        let tables = axis.tables.as_ref();
        let levels = [
            tables.map(|tables| tables.saturated),
            Some(axis.overrun),
            tables.map(|tables| tables.refused),
            tables.map(|tables| tables.swap_pending),
            tables.map(|tables| tables.tap_read_waits),
        ];
        for (flag, output) in self.flags.iter_mut().zip(levels) {
            let level = output.map_or(0, |output| outputs[output] & 1);
            flag[usize::from(level != 0)] = true;
        }
        let bank = tables.map_or(0, |tables| outputs[tables.bank]);
        let swaps = tables.is_some_and(|tables| outputs[tables.swap_pending] & 1 != 0);
        let busy = outputs[axis.busy] & 1 != 0;
        let (start, x) = (inputs[axis.start] & 1 != 0, inputs[axis.x]);
        if outputs[axis.valid] & 1 != 0 {
            if let Some(results) = self.results.get_mut(bank as usize) {
                *results = results.saturating_add(1);
            }
            if self.in_pass && bank == 0 && !swaps {
                self.look();
            }
            self.in_pass = false;
        }
        if reset || start || strobe && busy {
            // The earlier samples are gone or no longer certain.
            self.samples.clear();
            self.in_pass = false;
        }
        if strobe && !reset && (start || !busy) {
            self.samples.push_front(wrap(x as i64, self.word_bits));
            self.samples.truncate(self.longest_delay_samples as usize + 2);
            self.in_pass = bank == 0 && !swaps;
        }
    }

    /// Finds the taps that a result over bank 0 shows.
    fn look(&mut self) {
        let sample = |delay: u32| self.samples.get(delay as usize).copied();
        let products = self.taps.iter().map(|tap| {
            let product = i128::from(sample(tap.delay_samples)?) * i128::from(tap.coefficient);
            Some(product)
        });
        // A delay line that is not yet full still contains the start value, so no product is certain.
        let is_full = sample(self.longest_delay_samples).is_some();
        let Some(products) = products.collect::<Option<Vec<i128>>>().filter(|_| is_full) else {
            return;
        };
        let one = 1i128 << self.fraction;
        let largest = one * i128::from(self.axis.largest_word());
        if self.saturates && products.iter().sum::<i128>().abs() >= largest {
            return;
        }
        for ((tap, product), seen) in self.taps.iter().zip(products).zip(&mut self.seen) {
            let here = sample(tap.delay_samples);
            let other = |delay: Option<u32>| delay.is_none_or(|delay| sample(delay).is_some_and(|x| Some(x) != here));
            let is_alone = other(tap.delay_samples.checked_add(1)) && other(tap.delay_samples.checked_sub(1));
            *seen = seen.saturating_add(u32::from(product.abs() >= one && is_alone));
        }
    }

    fn missing(&self) -> Vec<String> {
        let mut missing = Vec::new();
        for (index, (tap, seen)) in self.taps.iter().zip(&self.seen).enumerate() {
            if *seen < LEAST_TIMES {
                let name = match self.axis.tables {
                    Some(_) => format!("tap {index} of the machine's table"),
                    None => format!("half sum {index}"),
                };
                missing.push(format!("{name} (after {} samples)", tap.delay_samples));
            }
        }
        for (bank, results) in self.results.iter().enumerate() {
            if *results == 0 && (bank == 0 || self.axis.tables.is_some()) {
                missing.push(format!("a result over bank {bank}"));
            }
        }
        for (flag, [low, high]) in FLAGS.into_iter().zip(self.flags) {
            let possible = match self.axis.tables {
                Some(_) => self.saturates || flag != "saturated",
                None => flag == "overrun",
            };
            for (level, seen) in [(0, low), (1, high)] {
                if possible && !seen {
                    missing.push(format!("`{flag}` = {level}"));
                }
            }
        }
        missing
    }
}
