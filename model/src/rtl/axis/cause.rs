//! What can go wrong, and what follows: the cause word, one bit each.

/// A cause: the number of its bit in `causes` and `off_causes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The emergency stop's line is low, or that of another axis.
    EmergencyStop = 0,
    /// The PWM has tripped; after a reset it always has.
    PwmTripped = 1,
    /// The drive is no longer ready while on.
    DriveLost = 2,
    /// On the limit switch + and moving towards it.
    LimitPlus = 3,
    /// On the limit switch − and moving towards it.
    LimitMinus = 4,
    /// The shaped position passed the soft limit +, or moves on behind it.
    SoftLimitPlus = 5,
    /// The same for the soft limit −.
    SoftLimitMinus = 6,
    /// |e| above its limit.
    FollowingError = 7,
    /// Motor and scale apart by more than their limit.
    Deviation = 8,
    /// The controller's command was cut for too many ticks in a row.
    Saturation = 9,
    /// A command above its threshold, and for too many ticks no motion, or one against it where the direction is watched.
    EncoderLost = 10,
    /// An illegal transition, or a pair that disagrees, of motor encoder or scale.
    EncoderError = 11,
    /// The segments stopped by themselves: underrun or overflow.
    Segments = 12,
    /// The host did not kick in time.
    Watchdog = 13,
    /// Another axis wants all to stop.
    GroupStop = 14,
    /// A tick was missed, or a pass was not over in time.
    Schedule = 15,
    /// A position left the range of its word: the count, the shaped command, or e.
    Range = 16,
}

/// Bits of the cause word. Those above the 16 of `off_causes` leave no choice: they always switch off.
pub const CAUSE_BITS: u32 = 17;

impl Cause {
    /// All, in the order of their bits.
    pub const ALL: [Self; CAUSE_BITS as usize] = [
        Self::EmergencyStop,
        Self::PwmTripped,
        Self::DriveLost,
        Self::LimitPlus,
        Self::LimitMinus,
        Self::SoftLimitPlus,
        Self::SoftLimitMinus,
        Self::FollowingError,
        Self::Deviation,
        Self::Saturation,
        Self::EncoderLost,
        Self::EncoderError,
        Self::Segments,
        Self::Watchdog,
        Self::GroupStop,
        Self::Schedule,
        Self::Range,
    ];

    /// Its name, as the machine file has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::EmergencyStop => "emergency-stop",
            Self::PwmTripped => "pwm-tripped",
            Self::DriveLost => "drive-lost",
            Self::LimitPlus => "limit-plus",
            Self::LimitMinus => "limit-minus",
            Self::SoftLimitPlus => "soft-limit-plus",
            Self::SoftLimitMinus => "soft-limit-minus",
            Self::FollowingError => "following-error",
            Self::Deviation => "deviation",
            Self::Saturation => "saturation",
            Self::EncoderLost => "encoder-lost",
            Self::EncoderError => "encoder-error",
            Self::Segments => "segments",
            Self::Watchdog => "watchdog",
            Self::GroupStop => "group-stop",
            Self::Schedule => "schedule",
            Self::Range => "range",
        }
    }

    /// Its bit.
    pub const fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// Causes that always switch off, whatever `off_causes` says.
pub const ALWAYS_OFF: u32 = Cause::EmergencyStop.bit() | Cause::PwmTripped.bit() | Cause::Range.bit();

/// Causes that act in the clock in which they become active; all others act when they stand, a clock later.
pub const AT_ONCE: u32 =
    Cause::EmergencyStop.bit() | Cause::PwmTripped.bit() | Cause::DriveLost.bit() | Cause::Range.bit();

/// Causes after which an axis is in order: it only waits, in HOLD, for the others.
pub const HARMLESS: u32 = Cause::GroupStop.bit();

/// Causes after which the position may be another one: the axis is no longer homed.
pub const DOUBTFUL: u32 = Cause::EncoderLost.bit() | Cause::EncoderError.bit();

/// Those of `causes` that switch the outputs off at once.
pub const fn switching_off(causes: u32, off_causes: u16) -> u32 {
    causes & (off_causes as u32 | ALWAYS_OFF) & !HARMLESS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_all_bits_once_in_their_order() {
        for (bit, cause) in (0..).zip(Cause::ALL) {
            assert_eq!(cause.bit(), 1 << bit);
        }
        assert_eq!(switching_off(u32::MAX, 0), 1 << 16 | 3);
        assert_eq!(switching_off(u32::MAX, u16::MAX), 0x1_ffff & !(1 << 14));
    }
}
