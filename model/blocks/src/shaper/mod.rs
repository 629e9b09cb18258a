//! The input shaper: `y[n] = saturate( (Σ c_i · x[n − d_i] + 2^(F−1)) >> F )`, one tap per clock through one multiplier.
//!
//! The datasheet is `docs/shaper.md`; the hardware is compared with this reference model.
//!
//! | type | what it is |
//! |---|---|
//! | [`ShaperConfig`] | the build parameters of a shaper: word width, sizes of its memories, the table in its ROM |
//! | [`Shaper`] | cycle accurate at the ports, one [`Shaper::step`] per clock, from typed [`Inputs`] to typed [`Outputs`] |
//! | [`SampleShaper`] | the same results without the clocks: one [`SampleShaper::push`] per sample |
//! | [`ShaperMotion`] | the additional features of a motion shaper: channels that share a table, handover, modulo axes |
//! | [`MotionShaper`] | its samples without the clocks |
//!
//! ```text
//! clock     0   1   2   3         N+7 N+8 N+9
//! strobe   ‾‾‾\__________________________________
//! x        < x>----------------------------------
//! busy     ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____________
//! valid    _________________________/‾‾‾\________
//! y        ------- as before -------< y[n] ------
//! ```
//!
//! The history before the first sample since a start is the start value, so a constant command gives a constant
//! output. The running sum never overflows: 2^T products of W + 18 bits, and half, fit in W + 18 + T ≤ 58 bits; those
//! of two tables in a handover need one bit more.
//!
//! ```
//! use posicast_blocks::shaper::{Inputs, SampleShaper, Shaper, ShaperConfig, pass_clocks};
//! use posicast_taps::{Tap, TapTable};
//!
//! let half = |delay_samples| Tap { delay_samples, coefficient: 1 << 15 };
//! let config = ShaperConfig::new(32, TapTable::new(16, vec![half(0), half(2)])?)?;
//!
//! // A step of 1000 comes out as two halves, two samples apart.
//! let mut fast = SampleShaper::new(&config);
//! assert_eq!([1000; 4].map(|x| fast.push(x)), [500, 500, 1000, 1000]);
//!
//! // The same at the ports: the first result stands there `pass_clocks` after its strobe.
//! let mut shaper = Shaper::new(&config, 1);
//! shaper.step(&Inputs { strobe: true, x: 1000, ..Inputs::default() });
//! let waited = (1..100).find(|_| shaper.step(&Inputs::default()).valid);
//! assert_eq!(waited, Some(pass_clocks(2)));
//! assert_eq!(shaper.outputs().y, 500);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod banks;
mod clocked;
mod config;
mod memory;
mod motion;
pub mod moving;
pub mod plain;
mod ports;
mod sample;
mod tables;

pub use clocked::Shaper;
pub use config::{
    CHANNELS_MAX, MOTION_OVERHEAD_CLOCKS, MOTION_WORD_BITS, PASS_OVERHEAD_CLOCKS, PassError, RING_ADDRESS_BITS,
    ShaperConfig, ShaperConfigError, ShaperMotion, TAP_INDEX_BITS, WORD_BITS, pass_clocks,
};
pub(crate) use memory::Arbitrary;
pub use motion::MotionShaper;
pub use ports::{Inputs, Outputs, ports, swap_how};
pub use sample::{CommandWord, LengthError, LoadError, SampleShaper};

use tables::Tables;

/// The output of a channel, and whether it was clamped; `sample(d)` is the sample `d` samples back.
///
/// On a modulo axis the position passes the table as differences from the newest sample, each wrapped to the word:
/// the coefficients sum to one, so `Σ c_i · x_i = Σ c_i · (x_i − x) + 2^F · x`.
fn finish(config: &ShaperConfig, channel: usize, tables: &Tables<'_>, sample: impl Fn(u32) -> i64) -> (i64, bool) {
    let (fraction, word_bits) = (config.coefficient_fraction(), config.word_bits());
    if !config.wraps(channel) {
        return round_and_saturate(tables.sum(channel, sample), fraction, word_bits);
    }
    let newest = sample(0);
    let sum = tables.sum(channel, |delay| wrap(sample(delay) - newest, word_bits));
    let rounded = (sum + (newest << fraction) + (1 << (fraction - 1))) >> fraction;
    (wrap(rounded, word_bits), false)
}

/// Rounds and clamps a sum: half is added, `fraction` bits are dropped (an arithmetic shift), and the rest is clamped
/// to `word_bits`.
///
/// `sum` is `Σ c_i · x_i`, of magnitude 2^59 at most. The second result is true if the sum was clamped.
pub(crate) fn round_and_saturate(sum: i64, fraction: u32, word_bits: u32) -> (i64, bool) {
    let rounded = (sum + (1 << (fraction - 1))) >> fraction;
    let largest = (1i64 << (word_bits - 1)) - 1;
    let clamped = rounded.clamp(-largest - 1, largest);
    (clamped, clamped != rounded)
}

/// The lowest `bits` (1..=64) of `value` as a two's complement number, as a port of that width shows it.
pub fn wrap(value: i64, bits: u32) -> i64 {
    let unused = 64 - bits;
    (value << unused) >> unused
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_up_on_both_sides_of_zero() {
        let rounded = |sum| round_and_saturate(sum, 2, 16).0;
        assert_eq!(
            [-7, -6, -5, -3, -2, -1, 0, 1, 2, 3, 5, 6].map(rounded),
            [-2, -1, -1, -1, 0, 0, 0, 0, 1, 1, 1, 2]
        );
    }

    #[test]
    fn saturation_reaches_both_ends_exactly() {
        assert_eq!(round_and_saturate(32767 << 4, 4, 16), (32767, false));
        assert_eq!(round_and_saturate((32767 << 4) + 8, 4, 16), (32767, true));
        assert_eq!(round_and_saturate(-(32768 << 4) - 8, 4, 16), (-32768, false));
        assert_eq!(round_and_saturate(-(32768 << 4) - 9, 4, 16), (-32768, true));
    }

    #[test]
    fn wrap_takes_the_low_bits() {
        assert_eq!(wrap(0x8000, 16), -0x8000);
        assert_eq!(wrap(-1, 16), -1);
        assert_eq!(wrap(0x1_0001, 16), 1);
        assert_eq!(wrap(i64::MIN, 64), i64::MIN);
    }
}
