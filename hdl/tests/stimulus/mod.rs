//! Stimuli for the shaper: random strobes, starts and resets, and a host that loads tables, mostly correctly.

use posicast_blocks::shaper::{Inputs, ShaperConfig};
use posicast_taps::{COEFFICIENT_MAX, COEFFICIENT_MIN, Tap, TapTable};
use std::collections::VecDeque;

use crate::random;

pub(crate) use random::Random;

/// Returns `taps` taps at delays up to `longest`, with coefficients of either sign that sum to 2^fraction; `gain` is
/// about Σ|c|/2^F.
pub(crate) fn table(random: &mut Random, fraction: u32, taps: usize, longest: u32, gain: u32) -> TapTable {
    let mut delays: Vec<u32> = (0..taps - 1)
        .map(|_| random.below(u64::from(longest.max(1))) as u32)
        .collect();
    delays.push(longest);
    delays.sort_unstable();
    delays.dedup();
    let size = (u64::from(gain) << fraction) / delays.len() as u64 + 1;
    let mut rest = 1i64 << fraction;
    let mut list: Vec<Tap> = Vec::new();
    for (place, &delay_samples) in delays.iter().enumerate() {
        let left = (delays.len() - place) as i64;
        let jitter = random.below(2 * size + 1) as i64 - size as i64;
        let wanted = if left == 1 { rest } else { rest / left + jitter };
        let wanted = if wanted == 0 { 1 } else { wanted };
        let coefficient = wanted.clamp(i64::from(COEFFICIENT_MIN), i64::from(COEFFICIENT_MAX)) as i32;
        rest -= i64::from(coefficient);
        list.push(Tap {
            delay_samples,
            coefficient,
        });
    }
    match TapTable::new(fraction, list) {
        Ok(table) => table,
        // The last coefficient was zero or did not fit: draw again, with one tap fewer.
        Err(_) => table_of_fewer(random, fraction, taps, longest, gain),
    }
}

fn table_of_fewer(random: &mut Random, fraction: u32, taps: usize, longest: u32, gain: u32) -> TapTable {
    if taps <= 1 {
        return TapTable::new(
            fraction,
            vec![Tap {
                delay_samples: longest,
                coefficient: 1 << fraction,
            }],
        )
        .unwrap();
    }
    table(random, fraction, taps - 1, longest, gain)
}

/// Returns the writes that load `table` into `bank`, and the swap to it.
pub(crate) fn load(table: &TapTable, bank: u8) -> Vec<Inputs> {
    let write = |(index, tap): (usize, &Tap)| Inputs {
        tap_write: true,
        tap_bank: bank,
        tap_index: index as u16,
        tap_coefficient: tap.coefficient,
        tap_delay: tap.delay_samples as u16,
        ..Inputs::default()
    };
    let swap = Inputs {
        swap: true,
        swap_bank: bank,
        ..Inputs::default()
    };
    table.taps().iter().enumerate().map(write).chain([swap]).collect()
}

/// Endless random inputs, clock by clock: any input at any time, and valid sequences often enough.
pub(crate) struct Anything {
    config: ShaperConfig,
    random: Random,
    read_back: Random,
    until_strobe: u32,
    host: VecDeque<Inputs>,
}

impl Anything {
    pub(crate) fn new(config: &ShaperConfig, seed: u64) -> Self {
        Self {
            config: config.clone(),
            random: Random(seed),
            read_back: Random(seed.rotate_left(32)),
            until_strobe: 0,
            host: VecDeque::new(),
        }
    }

    fn sample(&mut self) -> i64 {
        match self.random.below(4) {
            0 => self.config.word_max(),
            1 => self.config.word_min(),
            2 => self.random.below(100) as i64 - 50,
            _ => self.random.word() as i64 >> (64 - self.config.word_bits()),
        }
    }

    /// Plans the host's next clocks: the load of a table, in one of three cases with an error in one clock; then
    /// possibly a random swap; then a pause.
    fn plan(&mut self) {
        let random = &mut self.random;
        let taps = 1 + random.below(u64::from(self.config.most_taps().min(24))) as usize;
        let longest = random.below(u64::from(self.config.longest_delay_samples().min(80)) + 1) as u32;
        let gain = 1 + random.below(4) as u32;
        let new = table(random, self.config.coefficient_fraction(), taps, longest, gain);
        let mut plan = load(&new, 1 + random.below(2) as u8);
        if random.once_in(3) {
            let spoiled = random.below(plan.len() as u64) as usize;
            let clock = &mut plan[spoiled];
            match random.below(6) {
                0 => clock.tap_index = random.word() as u16,
                1 => clock.tap_delay = u16::MAX,
                2 => clock.tap_coefficient ^= 1,
                3 => clock.tap_bank = random.below(4) as u8,
                4 => clock.swap = true,
                _ => clock.swap_bank = random.below(4) as u8,
            }
        }
        if random.once_in(4) {
            plan.push(Inputs {
                swap: true,
                swap_bank: random.below(4) as u8,
                ..Inputs::default()
            });
        }
        let pause = random.below(200) as usize;
        self.host.extend(plan);
        self.host.extend(std::iter::repeat_n(Inputs::default(), pause));
    }
}

impl Iterator for Anything {
    type Item = Inputs;

    fn next(&mut self) -> Option<Inputs> {
        if self.host.is_empty() {
            self.plan();
        }
        let mut inputs = self.host.pop_front()?;
        inputs.x = self.sample();
        inputs.rst = self.random.once_in(3000);
        // A handover lasts as many samples as a table is long. Starts are rare then, so that most handovers complete.
        inputs.start = self
            .random
            .once_in(if self.config.motion().is_some() { 4000 } else { 400 });
        inputs.x_rates = [self.sample(), self.sample()];
        inputs.swap_how = self.random.word() as u8;
        inputs.clear_flags = self.random.once_in(60);
        // Reading back has a generator of its own, so that the other random values stay the same.
        inputs.tap_read = self.read_back.once_in(20);
        if !inputs.tap_write {
            inputs.tap_bank = self.read_back.below(4) as u8;
            let far = self.read_back.once_in(8);
            inputs.tap_index = self.read_back.below(if far { 256 } else { 8 }) as u16;
        }
        inputs.strobe = self.until_strobe == 0;
        if inputs.strobe {
            let pass = self.config.pass_clocks(self.config.most_products());
            self.until_strobe = match self.random.below(8) {
                0 => 0,
                1 => self.random.below(u64::from(pass)) as u32,
                2 => pass - 1,
                _ => pass + self.random.below(30) as u32,
            };
        } else {
            self.until_strobe -= 1;
        }
        Some(inputs)
    }
}
