//! Time-out of the bridge, from clock and machine file.

use super::ports::{SILENCE_BITS, SILENCE_CLOCKS};
use std::ops::RangeInclusive;

/// Clocks of the bridge for a clock of the host, at least: the line to the host changes up to three clocks after a falling
/// edge, and must be there half a period after it.
pub const LEAST_CLOCKS_PER_BIT: u64 = 8;
/// Shortest and longest time-out of a frame that waits for its next byte, in units of 64 clocks, the time of a byte of the
/// fastest host.
const SILENCE_UNITS: RangeInclusive<f64> = 40.0..=1_048_575.0;

/// The constants of a bridge: the values of its inputs `silence_limit` and `address_limit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpiBridgeConfig {
    clock_hz: u64,
    silence_limit: u32,
    address_limit: u16,
}

/// Why a bridge cannot be built: its time-out is out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("a time-out of {seconds} s with a clock of {clock_hz} Hz: it is {shortest:.6} s to {longest:.3} s")]
pub struct SpiBridgeConfigError {
    /// Time-out in seconds.
    pub seconds: f64,
    /// Frequency of the clock in Hz.
    pub clock_hz: u64,
    /// Shortest time-out in seconds.
    pub shortest: f64,
    /// Longest time-out in seconds.
    pub longest: f64,
}

impl SpiBridgeConfig {
    /// A bridge at this clock in Hz, which drops a frame if its next byte takes longer than `silence_s` seconds, for
    /// registers with word addresses below `address_limit`.
    ///
    /// # Errors
    /// [`SpiBridgeConfigError`] if the time-out is out of range.
    pub fn new(clock_hz: u64, silence_s: f64, address_limit: u16) -> Result<Self, SpiBridgeConfigError> {
        let unit_s = f64::from(SILENCE_CLOCKS) / clock_hz as f64;
        let units = silence_s / unit_s;
        if !SILENCE_UNITS.contains(&units) {
            return Err(SpiBridgeConfigError {
                seconds: silence_s,
                clock_hz,
                shortest: SILENCE_UNITS.start() * unit_s,
                longest: SILENCE_UNITS.end() * unit_s,
            });
        }
        let limit = units.round() as u32;
        Ok(Self {
            clock_hz,
            silence_limit: limit.min((1 << SILENCE_BITS) - 1),
            address_limit,
        })
    }

    /// Fastest clock of the host in Hz.
    pub fn most_sck_hz(&self) -> u64 {
        self.clock_hz / LEAST_CLOCKS_PER_BIT
    }

    /// Time-out in units of 64 clocks.
    pub fn silence_limit(&self) -> u32 {
        self.silence_limit
    }

    /// Addresses below it exist.
    pub fn address_limit(&self) -> u16 {
        self.address_limit
    }

    /// The inputs of a bridge that is not selected.
    pub fn inputs(&self) -> super::Inputs {
        super::Inputs {
            spi_cs_n: true,
            silence_limit: self.silence_limit,
            address_limit: self.address_limit,
            ..super::Inputs::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed by hand: 10 ms at 50 MHz are 500,000 clocks, 7812.5 units of 64.
    #[test]
    fn time_outs_of_usual_clocks() {
        for (clock_hz, silence_s, limit, most) in [
            (50_000_000, 0.01, 7813, 6_250_000),
            (100_000_000, 0.5, 781_250, 12_500_000),
            (24_000_000, 0.001, 375, 3_000_000),
        ] {
            let config = SpiBridgeConfig::new(clock_hz, silence_s, 512).unwrap();
            assert_eq!((config.silence_limit(), config.most_sck_hz()), (limit, most));
            assert_eq!(config.inputs().silence_limit, limit);
        }
    }

    #[test]
    fn a_time_out_out_of_range_is_refused_with_the_range() {
        for silence_s in [2.0, 0.00005, f64::NAN] {
            let error = SpiBridgeConfig::new(50_000_000, silence_s, 512)
                .unwrap_err()
                .to_string();
            assert_eq!(
                error,
                format!("a time-out of {silence_s} s with a clock of 50000000 Hz: it is 0.000051 s to 1.342 s")
            );
        }
    }
}
