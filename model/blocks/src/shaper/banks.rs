//! The three tap tables: how one is loaded and becomes active, as in the hardware's `tap_banks`.

use super::config::ShaperConfig;
use super::memory::Arbitrary;
use super::ports::{Inputs, swap_how};
use super::tables::Tables;
use super::wrap;
use posicast_taps::{COEFFICIENT_BITS, Tap};

/// The loadable banks.
const LOADABLE: [u8; 2] = [1, 2];

/// A table in RAM, and how many of its taps are loaded.
struct LoadableBank {
    /// The whole RAM: the first `loaded` taps were written, the rest is arbitrary.
    taps: Vec<Tap>,
    loaded: usize,
    /// Sum of the loaded coefficients.
    sum: i64,
}

/// An accepted swap, which waits and then may hand over.
#[derive(Clone, Copy)]
struct Change {
    bank: u8,
    how: u8,
    /// Longest delay of both tables, in samples.
    reach: u32,
    state: State,
}

#[derive(Clone, Copy)]
enum State {
    /// The swap waits for a strobe at which it takes effect.
    Waits,
    /// The handover from the table of bank `before`, whose last sample lies `samples` back.
    HandsOver { before: u8, samples: u32 },
}

/// A host's read of a tap, and the result of the last one.
#[derive(Clone, Copy)]
struct ReadBack {
    waits: bool,
    /// The tap at the tables' output in this clock, if it is the host's: 0 where no tap is loaded.
    served: Option<Tap>,
    found: Tap,
}

const NO_TAP: Tap = Tap {
    delay_samples: 0,
    coefficient: 0,
};

const NOTHING_READ: ReadBack = ReadBack {
    waits: false,
    served: None,
    found: NO_TAP,
};

/// Bank 0 (the machine's table, in ROM) and banks 1 and 2 (RAM), with the active bank and the one to become active.
pub(super) struct Banks {
    rom: Vec<Tap>,
    loadable: [LoadableBank; 2],
    unity: i64,
    forbidden_delay: u32,
    active: u8,
    change: Option<Change>,
    refused: bool,
    read_back: ReadBack,
    has_swap_how: bool,
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
            change: None,
            refused: false,
            read_back: NOTHING_READ,
            has_swap_how: config.motion().is_some(),
        }
    }

    /// The tables that shape the last sample.
    pub(super) fn tables(&self) -> Tables<'_> {
        let handover = match self.change.map(|change| change.state) {
            Some(State::HandsOver { before, samples }) => Some((self.taps(before), samples)),
            _ => None,
        };
        Tables {
            active: self.taps(self.active),
            handover,
            unity: self.unity,
        }
    }

    fn taps(&self, bank: u8) -> &[Tap] {
        match self.index_of(bank) {
            Some(bank) => &self.loadable[bank].taps[..self.loadable[bank].loaded],
            None => &self.rom,
        }
    }

    pub(super) fn active(&self) -> u8 {
        self.active
    }

    /// Whether a swap waits or hands over.
    pub(super) fn pending(&self) -> bool {
        self.change.is_some()
    }

    pub(super) fn hands_over(&self) -> bool {
        matches!(self.change.map(|change| change.state), Some(State::HandsOver { .. }))
    }

    pub(super) fn refused(&self) -> bool {
        self.refused
    }

    /// The tap that a host read back last.
    pub(super) fn loaded_tap(&self) -> Tap {
        self.read_back.found
    }

    /// Whether a host's read waits to be served.
    pub(super) fn read_waits(&self) -> bool {
        self.read_back.waits
    }

    /// Whether a clock changes something of a host's read, which may come in this clock or be waiting.
    pub(super) fn reads(&self, tap_read: bool, busy: bool) -> bool {
        let ReadBack { waits, served, .. } = self.read_back;
        tap_read && !waits || waits && (served.is_some() || !busy)
    }

    /// Resets every register that has a reset; the RAM keeps its contents.
    pub(super) fn reset(&mut self) {
        for bank in &mut self.loadable {
            bank.loaded = 0;
            bank.sum = 0;
        }
        self.active = 0;
        self.change = None;
        self.refused = false;
        self.read_back = NOTHING_READ;
    }

    /// Simulates one clock. A write and a swap are judged by the state before the clock.
    ///
    /// `still` is the number of samples since the position command changed, including a start of this clock but not
    /// its strobe. While a pass is `busy` it reads the tables, and a host waits.
    pub(super) fn step(&mut self, inputs: &Inputs, still: u32, busy: bool) {
        self.read_tap(inputs, busy);
        let swap_bank = inputs.swap_bank & 3;
        let how = if self.has_swap_how {
            inputs.swap_how & 3
        } else {
            swap_how::AT_ONCE
        };
        let swap_taken = inputs.swap && how <= swap_how::WHEN_SETTLED && self.takes_swap(swap_bank);
        let write_taken = inputs.tap_write && self.take_tap(inputs);
        if let Some(change) = self.change {
            self.change = self.advance(change, inputs, still);
        }
        if swap_taken {
            self.change = Some(Change {
                bank: swap_bank,
                how,
                reach: self.longest_delay(self.active).max(self.longest_delay(swap_bank)),
                state: State::Waits,
            });
        }
        if inputs.clear_flags {
            self.refused = false;
        }
        if inputs.swap != swap_taken || inputs.tap_write != write_taken {
            self.refused = true;
        }
    }

    /// A read uses the tables in the first clock in which no pass runs and no tap is written, and has its word in the
    /// next.
    fn read_tap(&mut self, inputs: &Inputs, busy: bool) {
        let ReadBack { waits, served, found } = self.read_back;
        let serves = waits && served.is_none() && !busy && !inputs.tap_write;
        self.read_back = ReadBack {
            waits: inputs.tap_read || waits && served.is_none(),
            served: serves.then(|| self.tap_at(inputs.tap_bank & 3, inputs.tap_index)),
            found: served.unwrap_or(found),
        };
    }

    /// The tap at this index of a bank; 0 where none is loaded.
    fn tap_at(&self, bank: u8, index: u16) -> Tap {
        let index = usize::from(index) & (self.loadable[0].taps.len() - 1);
        let taps = if bank == 3 { &[] } else { self.taps(bank) };
        taps.get(index).copied().unwrap_or(NO_TAP)
    }

    /// The change after a clock; `None` once it is over.
    fn advance(&mut self, change: Change, inputs: &Inputs, still: u32) -> Option<Change> {
        let hands_over = |before, samples| {
            // After a start the history is constant, and both tables shape it alike.
            (samples <= change.reach && !inputs.start).then_some(Change {
                state: State::HandsOver { before, samples },
                ..change
            })
        };
        match change.state {
            State::HandsOver { before, samples } => hands_over(before, samples + u32::from(inputs.strobe)),
            State::Waits if inputs.strobe && (change.how != swap_how::WHEN_SETTLED || still >= change.reach) => {
                let before = std::mem::replace(&mut self.active, change.bank);
                hands_over(before, 1).filter(|_| change.how == swap_how::HANDOVER)
            }
            State::Waits => Some(change),
        }
    }

    fn longest_delay(&self, bank: u8) -> u32 {
        self.taps(bank).iter().map(|tap| tap.delay_samples).max().unwrap_or(0)
    }

    /// Whether a swap to this bank is accepted. Only a table whose sum is one becomes active, so that a constant
    /// command gives a constant output.
    fn takes_swap(&self, bank: u8) -> bool {
        let complete = match self.index_of(bank) {
            Some(loadable) => self.loadable[loadable].sum == self.unity,
            None => bank == 0,
        };
        complete && self.change.is_none()
    }

    fn take_tap(&mut self, inputs: &Inputs) -> bool {
        let delay_samples = u32::from(inputs.tap_delay) & self.forbidden_delay;
        let idle = self.change.is_none() && !inputs.swap && inputs.tap_bank & 3 != self.active;
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

    /// Index of a bank in `loadable`.
    fn index_of(&self, bank: u8) -> Option<usize> {
        LOADABLE.iter().position(|&b| b == bank)
    }
}
