//! The shaper's ports, typed and as the raw bit patterns of lock step.

use super::config::ShaperConfig;
use super::{moving, plain, wrap};
use crate::Port;
use posicast_taps::COEFFICIENT_BITS;

/// Values of `swap_how`, which says when a swap takes effect. 3 is refused.
pub mod swap_how {
    /// The new table shapes the whole history from the next sample on: the output jumps if the command moves.
    pub const AT_ONCE: u8 = 0;
    /// From the next sample on, each increment of the command passes exactly one of the tables: the output does not
    /// jump.
    pub const HANDOVER: u8 = 1;
    /// The swap takes effect at the first sample before which the position command stood still for the longest delay
    /// of both tables: the output does not jump.
    pub const WHEN_SETTLED: u8 = 2;
}

/// The input ports. Bits above a port's width are ignored, and so are ports that the configuration does not have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: `x` is a new sample.
    pub strobe: bool,
    /// One clock: restart; all samples before now count as `x`.
    pub start: bool,
    /// Command word of channel 0, W bits: the position.
    pub x: i64,
    /// Command words of channels 1 and 2, W bits: velocity and acceleration.
    pub x_rates: [i64; 2],
    /// Clears `saturated`, `overrun`, `refused`.
    pub clear_flags: bool,
    /// One clock: writes a tap to a loadable bank.
    pub tap_write: bool,
    /// Bank of the tap: 1 or 2 for a write.
    pub tap_bank: u8,
    /// Index of the tap, T bits: 0 begins a table, then one after the other.
    pub tap_index: u16,
    /// Coefficient of the tap, 18 bits.
    pub tap_coefficient: i32,
    /// Delay of the tap in samples, A bits, not all ones.
    pub tap_delay: u16,
    /// One clock: read back the tap at `tap_index` of `tap_bank`.
    pub tap_read: bool,
    /// One clock: make `swap_bank` active, at the next strobe or as `swap_how` says.
    pub swap: bool,
    /// The bank to make active, 0..=2.
    pub swap_bank: u8,
    /// When the swap takes effect: see [`swap_how`].
    pub swap_how: u8,
}

/// The output ports, all of them registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Shaped command of channel 0, W bits; holds between samples.
    pub y: i64,
    /// Shaped commands of channels 1 and 2, new in the same clock; 0 where there is no such channel.
    pub y_rates: [i64; 2],
    /// One clock: the outputs of all channels are new.
    pub valid: bool,
    /// Sticky: an output was clamped.
    pub saturated: bool,
    /// A pass over the table is running.
    pub busy: bool,
    /// Sticky: a strobe came while a pass was running.
    pub overrun: bool,
    /// A swap waits, or hands over.
    pub swap_pending: bool,
    /// The active bank.
    pub bank: u8,
    /// Sticky: a write or a swap was refused.
    pub refused: bool,
    /// Coefficient of the tap that was read back last; 0 where no tap is loaded.
    pub loaded_coefficient: i32,
    /// Delay of that tap in samples, A bits.
    pub loaded_delay: u16,
    /// A read waits to be served.
    pub tap_read_waits: bool,
}

/// The ports of a shaper in the order of the Verilog's port list, without `clk`.
pub fn ports(config: &ShaperConfig) -> Vec<Port> {
    let [word, index, delay] =
        [config.word_bits(), config.tap_index_bits(), config.ring_address_bits()].map(|bits| bits as usize);
    match config.motion() {
        None => plain::ports(word, index, delay),
        Some(motion) => moving::ports(motion.channels as usize, word, index, delay),
    }
}

impl Inputs {
    /// Converts raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64], config: &ShaperConfig) -> Self {
        let mut values = raw.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        let mut inputs = Self {
            rst: next() & 1 != 0,
            strobe: next() & 1 != 0,
            start: next() & 1 != 0,
            x: next() as i64,
            ..Self::default()
        };
        for word in inputs.x_rates.iter_mut().take(config.channels() - 1) {
            *word = next() as i64;
        }
        Self {
            clear_flags: next() & 1 != 0,
            tap_write: next() & 1 != 0,
            tap_bank: next() as u8,
            tap_index: next() as u16,
            tap_coefficient: next() as i32,
            tap_delay: next() as u16,
            tap_read: next() & 1 != 0,
            swap: next() & 1 != 0,
            swap_bank: next() as u8,
            swap_how: config.motion().map_or(0, |_| next() as u8),
            ..inputs
        }
    }

    /// The raw bit patterns, one per input port in port order, each cut to its port's width.
    pub fn to_raw(&self, config: &ShaperConfig) -> Vec<u64> {
        let cut = |value: i64, bits: u32| value as u64 & ((1 << bits) - 1);
        let mut raw = vec![
            u64::from(self.rst),
            u64::from(self.strobe),
            u64::from(self.start),
            cut(self.x, config.word_bits()),
        ];
        let rates = self.x_rates.iter().take(config.channels() - 1);
        raw.extend(rates.map(|word| cut(*word, config.word_bits())));
        raw.extend([
            u64::from(self.clear_flags),
            u64::from(self.tap_write),
            cut(i64::from(self.tap_bank), 2),
            cut(i64::from(self.tap_index), config.tap_index_bits()),
            cut(i64::from(self.tap_coefficient), COEFFICIENT_BITS),
            cut(i64::from(self.tap_delay), config.ring_address_bits()),
            u64::from(self.tap_read),
            u64::from(self.swap),
            cut(i64::from(self.swap_bank), 2),
        ]);
        raw.extend(config.motion().map(|_| cut(i64::from(self.swap_how), 2)));
        raw
    }
}

impl Outputs {
    /// Converts raw bit patterns, one per output port in port order.
    pub fn from_raw(raw: &[u64], config: &ShaperConfig) -> Self {
        let mut values = raw.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        let word = |raw: u64| wrap(raw as i64, config.word_bits());
        let mut outputs = Self {
            y: word(next()),
            ..Self::default()
        };
        for rate in outputs.y_rates.iter_mut().take(config.channels() - 1) {
            *rate = word(next());
        }
        Self {
            valid: next() & 1 != 0,
            saturated: next() & 1 != 0,
            busy: next() & 1 != 0,
            overrun: next() & 1 != 0,
            swap_pending: next() & 1 != 0,
            bank: next() as u8 & 3,
            refused: next() & 1 != 0,
            loaded_coefficient: wrap(next() as i64, COEFFICIENT_BITS) as i32,
            loaded_delay: next() as u16,
            tap_read_waits: next() & 1 != 0,
            ..outputs
        }
    }

    /// Writes the raw bit patterns, one per output port in port order, as far as `raw` reaches.
    pub fn write_raw(&self, config: &ShaperConfig, raw: &mut [u64]) {
        let mask = (1 << config.word_bits()) - 1;
        let rates = self.y_rates.iter().take(config.channels() - 1);
        let words = [self.y]
            .into_iter()
            .chain(rates.copied())
            .map(|word| word as u64 & mask);
        let flags = [
            u64::from(self.valid),
            u64::from(self.saturated),
            u64::from(self.busy),
            u64::from(self.overrun),
            u64::from(self.swap_pending),
            u64::from(self.bank),
            u64::from(self.refused),
            self.loaded_coefficient as u64 & ((1 << COEFFICIENT_BITS) - 1),
            u64::from(self.loaded_delay),
            u64::from(self.tap_read_waits),
        ];
        for (place, value) in raw.iter_mut().zip(words.chain(flags)) {
            *place = value;
        }
    }
}
