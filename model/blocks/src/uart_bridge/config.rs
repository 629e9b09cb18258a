//! Baud rate and time-out of the bridge, from clock and machine file.

use super::ports::{SILENCE_BITS, STEP_BITS};
use std::ops::RangeInclusive;

/// Baud rates that a host may choose.
pub const BAUD: RangeInclusive<u32> = 115_200..=3_000_000;
/// Largest error of the baud rate, relative. The receiver takes a bit in its middle, known to an eighth, so that both ends
/// together may be off by 3.9 % at the last of ten bits; this leaves the other half to the host.
pub const MOST_BAUD_ERROR: f64 = 0.02;
/// Shortest and longest time-out of a frame that waits for its next byte, in bits; the longest is 43 ms at 3,000,000 baud.
pub const SILENCE_BIT_TIMES: RangeInclusive<f64> = 20.0..=131_071.0;

/// The constants of a bridge: the values of its inputs `baud_step`, `silence_limit` and `address_limit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UartBridgeConfig {
    baud: u32,
    baud_step: u32,
    baud_error: f64,
    silence_limit: u32,
    address_limit: u16,
}

/// Why a bridge cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum UartBridgeConfigError {
    /// The baud rate is out of range.
    #[error("{0} baud: a bridge is built for {min} to {max}", min = BAUD.start(), max = BAUD.end())]
    Baud(u32),
    /// The clock does not divide to the baud rate.
    #[error(
        "{baud} baud from a clock of {clock_hz} Hz is off by {percent:.1} %, more than 2 %: take at most {most} baud, or \
         a clock of at least {least_hz} Hz"
    )]
    BaudError {
        /// Baud rate.
        baud: u32,
        /// Frequency of the clock in Hz.
        clock_hz: u64,
        /// Error in per cent.
        percent: f64,
        /// Largest baud rate with this clock.
        most: u64,
        /// Slowest clock for this baud rate, in Hz.
        least_hz: u64,
    },
    /// The time-out is out of range.
    #[error("a time-out of {seconds} s at {baud} baud: it is {shortest:.6} s to {longest:.3} s")]
    Silence {
        /// Time-out in seconds.
        seconds: f64,
        /// Baud rate.
        baud: u32,
        /// Shortest time-out in seconds.
        shortest: f64,
        /// Longest time-out in seconds.
        longest: f64,
    },
}

impl UartBridgeConfig {
    /// A bridge at this clock in Hz and baud rate, which drops a frame if its next byte takes longer than `silence_s`
    /// seconds, for registers with word addresses below `address_limit`.
    ///
    /// # Errors
    /// [`UartBridgeConfigError`] if the baud rate is out of range or off by more than 2 %, or if the time-out is out of
    /// range.
    pub fn new(clock_hz: u64, baud: u32, silence_s: f64, address_limit: u16) -> Result<Self, UartBridgeConfigError> {
        if !BAUD.contains(&baud) {
            return Err(UartBridgeConfigError::Baud(baud));
        }
        let one = f64::from(1 << STEP_BITS);
        let exact = 8.0 * f64::from(baud) / clock_hz as f64 * one;
        let step = exact.round().clamp(1.0, one - 1.0);
        let baud_error = step / exact - 1.0;
        if baud_error.is_nan() || baud_error.abs() > MOST_BAUD_ERROR {
            let fastest = (one - 1.0) / one / (1.0 - MOST_BAUD_ERROR);
            return Err(UartBridgeConfigError::BaudError {
                baud,
                clock_hz,
                percent: baud_error.abs() * 100.0,
                most: (clock_hz as f64 / 8.0 * fastest) as u64,
                least_hz: (8.0 * f64::from(baud) / fastest).ceil() as u64,
            });
        }
        let bits = silence_s * f64::from(baud);
        if !SILENCE_BIT_TIMES.contains(&bits) {
            return Err(UartBridgeConfigError::Silence {
                seconds: silence_s,
                baud,
                shortest: SILENCE_BIT_TIMES.start() / f64::from(baud),
                longest: SILENCE_BIT_TIMES.end() / f64::from(baud),
            });
        }
        let limit = (bits * 8.0).round() as u32;
        Ok(Self {
            baud,
            baud_step: step as u32,
            baud_error,
            silence_limit: limit.min((1 << SILENCE_BITS) - 1),
            address_limit,
        })
    }

    /// Baud rate that was asked for.
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// Relative error of the baud rate; above 0 it is too fast.
    pub fn baud_error(&self) -> f64 {
        self.baud_error
    }

    /// Eighths of a bit per clock, in 65,536ths.
    pub fn baud_step(&self) -> u32 {
        self.baud_step
    }

    /// Time-out in eighths of a bit.
    pub fn silence_limit(&self) -> u32 {
        self.silence_limit
    }

    /// Addresses below it exist.
    pub fn address_limit(&self) -> u16 {
        self.address_limit
    }

    /// The inputs of an idle bridge.
    pub fn inputs(&self) -> super::Inputs {
        super::Inputs {
            uart_rx: true,
            baud_step: self.baud_step,
            silence_limit: self.silence_limit,
            address_limit: self.address_limit,
            ..super::Inputs::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps and errors computed by hand: 8 · baud · 65536 / clock.
    #[test]
    fn baud_rates_of_usual_clocks() {
        for (clock_hz, baud, step, error) in [
            (50_000_000, 115_200, 1208, 3.31e-5),
            (50_000_000, 3_000_000, 31457, -8.9e-6),
            (100_000_000, 921_600, 4832, 3.31e-5),
            (24_000_000, 3_000_000, 65535, -1.53e-5),
            (200_000_000, 115_200, 302, 3.31e-5),
        ] {
            let config = UartBridgeConfig::new(clock_hz, baud, 0.01, 512).unwrap();
            assert_eq!(config.baud_step(), step);
            assert!((config.baud_error() - error).abs() < 1e-6, "{}", config.baud_error());
        }
    }

    #[test]
    fn a_clock_that_is_too_slow_is_refused_with_what_is_fast_enough() {
        let text = |clock_hz, baud, silence_s| {
            UartBridgeConfig::new(clock_hz, baud, silence_s, 512)
                .map(|_| ())
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            text(20_000_000, 3_000_000, 0.01),
            "3000000 baud from a clock of 20000000 Hz is off by 16.7 %, more than 2 %: take at most 2550981 baud, or a \
             clock of at least 23520359 Hz"
        );
        assert!(UartBridgeConfig::new(20_000_000, 2_550_981, 0.01, 512).is_ok());
        assert!(UartBridgeConfig::new(23_520_359, 3_000_000, 0.01, 512).is_ok());
        assert!(UartBridgeConfig::new(23_520_000, 3_000_000, 0.01, 512).is_err());
        assert_eq!(
            text(50_000_000, 9600, 0.01),
            "9600 baud: a bridge is built for 115200 to 3000000"
        );
        assert_eq!(
            text(50_000_000, 3_000_000, 0.1),
            "a time-out of 0.1 s at 3000000 baud: it is 0.000007 s to 0.044 s"
        );
    }
}
