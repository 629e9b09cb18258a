//! Times of the clock's edges as whole numbers of a [unit of time](wavecmp::unit).

use vcd::TimescaleUnit;
use wavecmp::unit::unit_for;

use crate::Error;

/// Half a second in units of femtosecond-nanohertz: divided by the clock in nanohertz it gives half a period in
/// femtoseconds.
const HALF_FS_NANOHERTZ: u128 = 500_000_000_000_000_000_000_000;

/// A clock on the grid of a unit of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clocking {
    /// Unit of the `$timescale`; the number before it is 1.
    pub(super) unit: TimescaleUnit,
    unit_fs: u64,
    clock_nanohertz: u128,
}

impl Clocking {
    /// Finds the coarsest unit in which half a period is a whole number; femtoseconds if there is none.
    pub(super) fn new(clock_hz: f64) -> Result<Self, Error> {
        let half_fs = 0.5e15 / clock_hz;
        if !(clock_hz > 0.0 && (1.0..=5e17).contains(&half_fs)) {
            return Err(Error::Option(format!(
                "a clock of {clock_hz} Hz cannot be drawn: it must lie between 0.001 Hz and 500 THz"
            )));
        }
        let clock_nanohertz = (clock_hz * 1e9).round() as u128;
        let (unit, unit_fs) = if HALF_FS_NANOHERTZ.is_multiple_of(clock_nanohertz) {
            unit_for((HALF_FS_NANOHERTZ / clock_nanohertz) as u64)
        } else {
            (TimescaleUnit::FS, 1)
        };
        Ok(Self {
            unit,
            unit_fs,
            clock_nanohertz,
        })
    }

    /// Returns the times of the rising edge with which clock `clock` begins, and of the falling edge in its middle.
    ///
    /// Each is rounded separately, so that a half period that is not a whole number of femtoseconds does not
    /// accumulate an error.
    pub(super) fn edges(&self, clock: u64) -> Result<(u64, u64), Error> {
        let halves = u128::from(clock) * 2;
        match (self.time(halves), self.time(halves + 1)) {
            (Some(rise), Some(fall)) => Ok((rise, fall)),
            _ => Err(Error::Option(format!(
                "{clock} clocks of this length are more than a waveform can hold"
            ))),
        }
    }

    /// Returns the time half a period before clock `clock` begins; 0 for the first clock.
    pub(super) fn before(&self, clock: u64) -> Result<u64, Error> {
        Ok(clock
            .checked_sub(1)
            .map(|last| self.edges(last))
            .transpose()?
            .map_or(0, |(_, fall)| fall))
    }

    fn time(&self, halves: u128) -> Option<u64> {
        let fs = halves.checked_mul(HALF_FS_NANOHERTZ)?;
        let unit = self.clock_nanohertz * u128::from(self.unit_fs);
        u64::try_from((fs + unit / 2) / unit).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_is_the_coarsest_power_of_1000_that_holds_half_a_period() {
        let of = |hz| {
            let clocking = Clocking::new(hz).unwrap();
            (clocking.unit, clocking.edges(1).unwrap())
        };
        assert_eq!(of(50e6), (TimescaleUnit::NS, (20, 30)));
        assert_eq!(of(40e6), (TimescaleUnit::PS, (25_000, 37_500)));
        assert_eq!(of(180e3), (TimescaleUnit::FS, (5_555_555_556, 8_333_333_333)));
        assert_eq!(of(10e3), (TimescaleUnit::US, (100, 150)));
        assert_eq!(of(3e6), (TimescaleUnit::FS, (333_333_333, 500_000_000)));
        assert_eq!(of(1.0), (TimescaleUnit::MS, (1000, 1500)));
        assert_eq!(of(0.5), (TimescaleUnit::S, (2, 3)));
    }

    #[test]
    fn a_half_period_that_is_not_whole_adds_no_error() {
        let clocking = Clocking::new(3e6).unwrap();
        assert_eq!(clocking.edges(3_000_000_000).unwrap().0, 1_000_000_000_000_000_000);
        assert_eq!(clocking.before(3).unwrap(), clocking.edges(2).unwrap().1);
        assert_eq!(clocking.before(0).unwrap(), 0);
    }

    #[test]
    fn impossible_clocks_are_refused() {
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            assert!(Clocking::new(hz).is_err(), "{hz}");
        }
        assert!(Clocking::new(50e6).unwrap().edges(u64::MAX).is_err());
    }
}
