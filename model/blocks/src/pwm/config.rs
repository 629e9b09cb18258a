//! Build parameters of a PWM: polarities, lower limits that no register can undercut, and whether it waits for a time
//! base.

/// Width of the dead time and of the minimum pulse in bits.
pub const TIME_BITS: u32 = 10;

/// Build parameters of a PWM.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PwmConfig {
    active_low: ActiveLow,
    dead_time_floor_clocks: u16,
    minimum_pulse_floor_clocks: u16,
    on_time_base: bool,
}

/// The pins that are active low. Such a pin is off at a high level: the off level follows from the polarity, so that
/// a gate that is off never conducts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ActiveLow {
    /// High side of leg A; in mode `direction` the PWM.
    pub a_high: bool,
    /// Low side of leg A.
    pub a_low: bool,
    /// High side of leg B; in mode `direction` the direction.
    pub b_high: bool,
    /// Low side of leg B.
    pub b_low: bool,
}

/// Why a PWM cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PwmConfigError {
    /// The dead time is 0, or the register does not hold it.
    #[error(
        "a dead time of at least {0} clocks: 1 to 1023 are allowed; take the driver's dead time, rounded up to whole clocks"
    )]
    DeadTime(u64),
    /// The minimum pulse is 0, or the register does not hold it.
    #[error(
        "a minimum pulse of at least {0} clocks: 1 to 1023 are allowed; take the shortest pulse that the driver passes on, \
         or 1 if there is none"
    )]
    MinimumPulse(u64),
}

impl PwmConfig {
    /// A PWM whose dead time and minimum pulse never go below these values in clocks.
    ///
    /// # Errors
    /// [`PwmConfigError`] unless both are 1 to 1023.
    pub fn new(
        active_low: ActiveLow,
        dead_time_floor_clocks: u64,
        minimum_pulse_floor_clocks: u64,
    ) -> Result<Self, PwmConfigError> {
        let fits = |clocks: u64| {
            u16::try_from(clocks)
                .ok()
                .filter(|fits| (1..1 << TIME_BITS).contains(fits))
        };
        Ok(Self {
            active_low,
            dead_time_floor_clocks: fits(dead_time_floor_clocks)
                .ok_or(PwmConfigError::DeadTime(dead_time_floor_clocks))?,
            minimum_pulse_floor_clocks: fits(minimum_pulse_floor_clocks)
                .ok_or(PwmConfigError::MinimumPulse(minimum_pulse_floor_clocks))?,
            on_time_base: false,
        })
    }

    /// Makes the PWM wait for a time base at `sync`: it does not start before a `sync` has found it in phase.
    /// Otherwise a PWM that has not seen a `sync` since its reset starts as it is.
    #[must_use]
    pub fn on_time_base(self) -> Self {
        Self {
            on_time_base: true,
            ..self
        }
    }

    /// Whether it waits for its first `sync`.
    pub fn is_on_time_base(&self) -> bool {
        self.on_time_base
    }

    /// The pins that are active low.
    pub fn active_low(&self) -> ActiveLow {
        self.active_low
    }

    /// Shortest dead time, in clocks.
    pub fn dead_time_floor_clocks(&self) -> u16 {
        self.dead_time_floor_clocks
    }

    /// Shortest minimum pulse, in clocks.
    pub fn minimum_pulse_floor_clocks(&self) -> u16 {
        self.minimum_pulse_floor_clocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_that_do_not_fit_are_named() {
        for found in [0, 1024, u64::MAX] {
            let built = |dead, pulse| PwmConfig::new(ActiveLow::default(), dead, pulse);
            assert_eq!(built(found, 1), Err(PwmConfigError::DeadTime(found)));
            assert_eq!(built(1, found), Err(PwmConfigError::MinimumPulse(found)));
        }
    }
}
