//! The initial words of an axis's supervision.

/// Initial words of the supervisor ([`crate::axis`]), of the quick stop of [`crate::segments`] and of an axis's bring-up:
/// reset values of registers, or constants where there is no register. Names and formats are those of the ports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Supervision {
    /// One bit per cause: 1 switches the outputs off, 0 leads to a quick stop.
    pub off_causes: u16,
    /// Ticks from entering HOLD until the brake is open.
    pub brake_release_ticks: u16,
    /// Ticks from applying the brake until it holds.
    pub brake_apply_ticks: u16,
    /// Ticks from the command's standstill to the standstill of the shaped command.
    pub settle_ticks: u16,
    /// Upper soft limit in Q24.8 counts. With both limits 0 there are no soft limits.
    pub soft_limit_plus: i32,
    /// Lower soft limit in Q24.8 counts.
    pub soft_limit_minus: i32,
    /// Whether the soft limits act only once the axis is homed.
    pub limits_after_homing: bool,
    /// Largest following error in Q16.16 counts; 0 disables the check.
    pub following_error_limit: u32,
    /// Largest deviation from the scale in counts of the loop; 0 disables the check.
    pub deviation_limit: u32,
    /// Ticks for which a larger deviation may last; 0: it acts at once.
    pub deviation_ticks: u16,
    /// Consecutive ticks for which the command may be clamped; 0 disables the check.
    pub saturation_ticks: u16,
    /// Command in Q20.12 command units above which the encoder must count.
    pub lost_command: u32,
    /// Ticks for which the encoder may stand still under such a command; 0 disables the check.
    pub lost_ticks: u16,
    /// Whether a motion against the command counts as standstill of the encoder.
    pub watches_direction: bool,
    /// Ticks within which the host must kick the watchdog; 0 disables it.
    pub watchdog_ticks: u16,
    /// Pulses of up to this many clocks on a line are ignored, 0 to 63.
    pub filter_clocks: u8,
    /// Deceleration of a quick stop in Q7.24 counts per tick²; 0: the axis stops at once.
    pub stop_deceleration: u32,
    /// Largest manual duty, in clocks of the PWM's period.
    pub direct_limit: u16,
    /// Ticks for which a manual duty stays applied.
    pub direct_hold_ticks: u16,
    /// Largest amplitude of test signals, Q8.8 counts.
    pub excitation_limit: u16,
}

impl Supervision {
    /// Every word with its name, in the order of the fields.
    pub fn words(&self) -> [(&'static str, i64); 20] {
        [
            ("off_causes", self.off_causes.into()),
            ("brake_release_ticks", self.brake_release_ticks.into()),
            ("brake_apply_ticks", self.brake_apply_ticks.into()),
            ("settle_ticks", self.settle_ticks.into()),
            ("soft_limit_plus", self.soft_limit_plus.into()),
            ("soft_limit_minus", self.soft_limit_minus.into()),
            ("limits_after_homing", self.limits_after_homing.into()),
            ("following_error_limit", self.following_error_limit.into()),
            ("deviation_limit", self.deviation_limit.into()),
            ("deviation_ticks", self.deviation_ticks.into()),
            ("saturation_ticks", self.saturation_ticks.into()),
            ("lost_command", self.lost_command.into()),
            ("lost_ticks", self.lost_ticks.into()),
            ("watches_direction", self.watches_direction.into()),
            ("watchdog_ticks", self.watchdog_ticks.into()),
            ("filter_clocks", self.filter_clocks.into()),
            ("stop_deceleration", self.stop_deceleration.into()),
            ("direct_limit", self.direct_limit.into()),
            ("direct_hold_ticks", self.direct_hold_ticks.into()),
            ("excitation_limit", self.excitation_limit.into()),
        ]
    }
}
