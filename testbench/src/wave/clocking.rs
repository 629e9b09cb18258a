//! Times of the clock's edges as whole numbers of a timescale.

use vcd::TimescaleUnit;

use crate::Error;

const UNITS: [(TimescaleUnit, i32); 6] = [
    (TimescaleUnit::S, 0),
    (TimescaleUnit::MS, -3),
    (TimescaleUnit::US, -6),
    (TimescaleUnit::NS, -9),
    (TimescaleUnit::PS, -12),
    (TimescaleUnit::FS, -15),
];

/// A clock on the grid of a timescale.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clocking {
    /// Number and unit of the `$timescale`.
    pub(super) timescale: (u32, TimescaleUnit),
    half_period: u64,
}

impl Clocking {
    /// The coarsest timescale on which half a period is whole; femtoseconds, rounded, where there is none.
    pub(super) fn new(clock_hz: f64) -> Result<Self, Error> {
        let half_fs = 0.5e15 / clock_hz;
        // The upper bound keeps 2^24 periods within 64 bits; a clock that slow is a typing error.
        if !(clock_hz > 0.0 && (1.0..=5e17).contains(&half_fs)) {
            return Err(Error::Option(format!(
                "a clock of {clock_hz} Hz cannot be drawn: it must lie between 0.001 Hz and 500 THz"
            )));
        }
        for (unit, exponent) in UNITS {
            for (factor, zeros) in [(100, 2), (10, 1), (1, 0)] {
                let half = 0.5 / clock_hz * 10f64.powi(-exponent - zeros);
                if half >= 1.0 && (half - half.round()).abs() <= 1e-9 * half {
                    return Ok(Self {
                        timescale: (factor, unit),
                        half_period: half.round() as u64,
                    });
                }
            }
        }
        Ok(Self {
            timescale: (1, TimescaleUnit::FS),
            half_period: half_fs.round() as u64,
        })
    }

    /// Times of the rising edge with which step `step` begins, and of the falling edge in its middle.
    pub(super) fn edges(&self, step: u64) -> Result<(u64, u64), Error> {
        let rise = step
            .checked_mul(2)
            .and_then(|halves| halves.checked_mul(self.half_period));
        let both = rise.and_then(|rise| Some((rise, rise.checked_add(self.half_period)?)));
        both.ok_or_else(|| {
            Error::Option(format!(
                "{step} clocks of this length are more than a waveform can hold"
            ))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_timescale_is_the_coarsest_that_holds_half_a_period() {
        let of = |hz| {
            let clocking = Clocking::new(hz).unwrap();
            (clocking.timescale.0, clocking.timescale.1, clocking.half_period)
        };
        assert_eq!(of(50e6), (10, TimescaleUnit::NS, 1));
        assert_eq!(of(40e6), (100, TimescaleUnit::PS, 125));
        assert_eq!(of(10e3), (10, TimescaleUnit::US, 5));
        assert_eq!(of(3e6), (1, TimescaleUnit::FS, 166_666_667));
        assert_eq!(of(1.0), (100, TimescaleUnit::MS, 5));
    }

    #[test]
    fn unit_impossible_clocks_are_refused() {
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            assert!(Clocking::new(hz).is_err(), "{hz}");
        }
        assert!(Clocking::new(50e6).unwrap().edges(u64::MAX).is_err());
    }
}
