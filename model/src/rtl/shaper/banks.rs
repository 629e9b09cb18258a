//! The three tap tables, how one is loaded, and when one becomes active: what the hardware's `tap_banks` does.

use super::Inputs;
use super::config::ShaperConfig;
use super::memory::Arbitrary;
use super::wrap;
use crate::taps::{COEFFICIENT_BITS, Tap};

/// The banks that can be loaded.
const LOADABLE: [u8; 2] = [1, 2];

/// A table of RAM, and how far it is loaded.
struct LoadableBank {
    /// As many as the RAM holds; the first `loaded` were written, the rest is arbitrary.
    taps: Vec<Tap>,
    loaded: usize,
    /// Sum of the coefficients loaded.
    sum: i64,
}

/// Bank 0 (the machine's table, ROM) and banks 1 and 2 (RAM); which is active, which comes next.
pub(super) struct Banks {
    rom: Vec<Tap>,
    loadable: [LoadableBank; 2],
    unity: i64,
    forbidden_delay: u32,
    active: u8,
    pending: Option<u8>,
    refused: bool,
}

impl Banks {
    pub(super) fn new(config: &ShaperConfig, contents: &mut Arbitrary) -> Self {
        let size = config.most_taps() as usize;
        let forbidden_delay = config.longest_delay_samples() + 1;
        let arbitrary_tap = |word: u64| Tap {
            delay_samples: word as u32 & forbidden_delay,
            coefficient: wrap((word >> 32) as i64, COEFFICIENT_BITS) as i32,
        };
        let loadable = LOADABLE.map(|_| LoadableBank {
            taps: contents.by_ref().take(size).map(arbitrary_tap).collect(),
            loaded: 0,
            sum: 0,
        });
        Self {
            rom: config.table().taps().to_vec(),
            loadable,
            unity: 1 << config.coefficient_fraction(),
            forbidden_delay,
            active: 0,
            pending: None,
            refused: false,
        }
    }

    /// The taps of the active table.
    pub(super) fn active_taps(&self) -> &[Tap] {
        match self.index_of(self.active) {
            Some(bank) => &self.loadable[bank].taps[..self.loadable[bank].loaded],
            None => &self.rom,
        }
    }

    pub(super) fn active(&self) -> u8 {
        self.active
    }

    pub(super) fn pending(&self) -> bool {
        self.pending.is_some()
    }

    pub(super) fn refused(&self) -> bool {
        self.refused
    }

    /// Everything that has a reset; the RAM keeps what it holds.
    pub(super) fn reset(&mut self) {
        for bank in &mut self.loadable {
            bank.loaded = 0;
            bank.sum = 0;
        }
        self.active = 0;
        self.pending = None;
        self.refused = false;
    }

    /// One clock. A write and a swap are judged by the state before the clock.
    pub(super) fn step(&mut self, inputs: &Inputs) {
        let swap_bank = inputs.swap_bank & 3;
        let swap_taken = inputs.swap && self.takes_swap(swap_bank);
        let write_taken = inputs.tap_write && self.take_tap(inputs);
        if inputs.strobe
            && let Some(bank) = self.pending.take()
        {
            self.active = bank;
        }
        if swap_taken {
            self.pending = Some(swap_bank);
        }
        if inputs.clear_flags {
            self.refused = false;
        }
        if inputs.swap != swap_taken || inputs.tap_write != write_taken {
            self.refused = true;
        }
    }

    /// Only a table that sums to one is ever made active: constant in, constant out.
    fn takes_swap(&self, bank: u8) -> bool {
        let complete = match self.index_of(bank) {
            Some(loadable) => self.loadable[loadable].sum == self.unity,
            None => bank == 0,
        };
        complete && self.pending.is_none()
    }

    fn take_tap(&mut self, inputs: &Inputs) -> bool {
        let delay_samples = u32::from(inputs.tap_delay) & self.forbidden_delay;
        let idle = self.pending.is_none() && !inputs.swap && inputs.tap_bank & 3 != self.active;
        let Some(bank) = self.index_of(inputs.tap_bank & 3) else {
            return false;
        };
        let bank = &mut self.loadable[bank];
        let index = usize::from(inputs.tap_index) & (bank.taps.len() - 1);
        if !idle || delay_samples == self.forbidden_delay || (index != 0 && index != bank.loaded) {
            return false;
        }
        let coefficient = wrap(i64::from(inputs.tap_coefficient), COEFFICIENT_BITS);
        bank.taps[index] = Tap {
            delay_samples,
            coefficient: coefficient as i32,
        };
        bank.loaded = index + 1;
        bank.sum = if index == 0 {
            coefficient
        } else {
            bank.sum + coefficient
        };
        true
    }

    /// Where a bank lies in `loadable`.
    fn index_of(&self, bank: u8) -> Option<usize> {
        LOADABLE.iter().position(|&b| b == bank)
    }
}
