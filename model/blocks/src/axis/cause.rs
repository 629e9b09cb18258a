//! The causes of a fault, as bits of the cause word, and their consequences.

/// A cause; its number is that of its bit in `causes` and `off_causes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The emergency stop line of this axis, or of another one, is low.
    EmergencyStop = 0,
    /// The PWM has tripped; after a reset it always is tripped.
    PwmTripped = 1,
    /// The drive is no longer ready while the outputs are on.
    DriveLost = 2,
    /// The axis is on limit switch + and moves towards it.
    LimitPlus = 3,
    /// The axis is on limit switch − and moves towards it.
    LimitMinus = 4,
    /// The shaped position passed soft limit +, or moves on beyond it.
    SoftLimitPlus = 5,
    /// The shaped position passed soft limit −, or moves on beyond it.
    SoftLimitMinus = 6,
    /// |e| exceeds its limit.
    FollowingError = 7,
    /// Motor and scale differ by more than their limit.
    Deviation = 8,
    /// The controller's command was clamped for too many consecutive ticks.
    Saturation = 9,
    /// The command exceeds its threshold, and for too many ticks there was no motion, or motion against the command
    /// where the direction is checked.
    EncoderLost = 10,
    /// An illegal transition, or two lines of a pair that disagree, at the motor encoder or the scale.
    EncoderError = 11,
    /// The segments stopped by themselves because of an underrun or overflow.
    Segments = 12,
    /// The host did not kick the watchdog in time.
    Watchdog = 13,
    /// Another axis wants all axes to stop.
    GroupStop = 14,
    /// A tick was missed, or a computation was not finished in time.
    Schedule = 15,
    /// A position left the range of its word: the count, the shaped command, or e.
    Range = 16,
}

/// Width of the cause word. Causes above the 16 bits of `off_causes` always switch the outputs off.
pub const CAUSE_BITS: u32 = 17;

impl Cause {
    /// All causes, in the order of their bits.
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

    /// Name of the cause in the machine file.
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

    /// Bit of the cause in the cause word.
    pub const fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// Causes that switch the outputs off for any value of `off_causes`.
pub const ALWAYS_OFF: u32 = Cause::EmergencyStop.bit() | Cause::PwmTripped.bit() | Cause::Range.bit();

/// Causes that act in the clock in which they become active; all others act one clock later, when their bit is set.
pub const AT_ONCE: u32 =
    Cause::EmergencyStop.bit() | Cause::PwmTripped.bit() | Cause::DriveLost.bit() | Cause::Range.bit();

/// Causes that are not this axis's own fault: it waits in HOLD.
pub const HARMLESS: u32 = Cause::GroupStop.bit();

/// Causes that put the position in doubt, so that the axis is no longer homed.
pub const DOUBTFUL: u32 = Cause::EncoderLost.bit() | Cause::EncoderError.bit();

/// Those of `causes` that switch the outputs off at once.
pub const fn switching_off(causes: u32, off_causes: u16) -> u32 {
    causes & (off_causes as u32 | ALWAYS_OFF) & !HARMLESS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_bits_once_in_their_order() {
        for (bit, cause) in (0..).zip(Cause::ALL) {
            assert_eq!(cause.bit(), 1 << bit);
        }
        assert_eq!(switching_off(u32::MAX, 0), 1 << 16 | 3);
        assert_eq!(switching_off(u32::MAX, u16::MAX), 0x1_ffff & !(1 << 14));
    }
}
