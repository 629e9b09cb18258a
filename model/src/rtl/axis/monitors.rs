//! What is watched at ticks: limits, soft limits, errors against their limits, and what has lasted too long.

use super::cause::Cause;
use super::inputs::Inputs;

/// Registers of what is watched, all written at ticks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Monitors {
    /// The position at the last tick.
    pub(super) captured_position: i32,
    /// Limit +, limit −, soft limit +, soft limit − were passed at the last tick.
    were_passed: [bool; 4],
    /// Ticks in a row with a command and without a count.
    still_ticks: u16,
    /// Ticks since the last kick.
    unkicked_ticks: u16,
}

impl Monitors {
    /// Limit +, limit −, soft limit +, soft limit −: is it passed? `on_limits` are the filtered switches.
    fn passed(inputs: &Inputs, on_limits: [bool; 2]) -> [bool; 4] {
        let (plus, minus) = (inputs.soft_limit_plus, inputs.soft_limit_minus);
        let watched = plus != 0 || minus != 0;
        [
            on_limits[0],
            on_limits[1],
            watched && inputs.reference_position > plus,
            watched && inputs.reference_position < minus,
        ]
    }

    /// The causes of a tick with the outputs on.
    pub(super) fn causes(&self, inputs: &Inputs, on_limits: [bool; 2]) -> u16 {
        let passed = Self::passed(inputs, on_limits);
        let newly = |at: usize| !self.were_passed[at];
        let (plus, minus) = (inputs.command_velocity > 0, inputs.command_velocity < 0);
        // A switch bounces while the axis leaves it; a shaped position does not.
        let [limit_plus, limit_minus, soft_plus, soft_minus] = [
            plus || (newly(0) && inputs.reference_velocity > 0),
            minus || (newly(1) && inputs.reference_velocity < 0),
            plus || newly(2),
            minus || newly(3),
        ];
        let exceeds = |value: i32, limit: u32| limit != 0 && size(value) > limit;
        let lasts = |ticks: u16, limit: u16| limit != 0 && ticks >= limit;
        let found = [
            (Cause::LimitPlus, passed[0] && limit_plus),
            (Cause::LimitMinus, passed[1] && limit_minus),
            (Cause::SoftLimitPlus, passed[2] && soft_plus),
            (Cause::SoftLimitMinus, passed[3] && soft_minus),
            (
                Cause::FollowingError,
                exceeds(inputs.error, inputs.following_error_limit),
            ),
            (Cause::Deviation, exceeds(inputs.deviation, inputs.deviation_limit)),
            (Cause::Saturation, lasts(inputs.limited_ticks, inputs.saturation_ticks)),
            (Cause::EncoderLost, lasts(self.still_ticks, inputs.lost_ticks)),
            (Cause::Watchdog, lasts(self.unkicked_ticks, inputs.watchdog_ticks)),
        ];
        let bits = found.map(|(cause, is)| if is { cause.bit() } else { 0 });
        bits.into_iter().fold(0, |all, bit| all | bit)
    }

    /// One clock.
    pub(super) fn clock(&mut self, inputs: &Inputs, on_limits: [bool; 2], on: bool, kicked: bool) {
        if inputs.tick {
            let still = size(inputs.command) > inputs.lost_command && inputs.position == self.captured_position;
            self.still_ticks = counted(self.still_ticks, on && still);
            self.unkicked_ticks = counted(self.unkicked_ticks, on);
            self.were_passed = Self::passed(inputs, on_limits);
            self.captured_position = inputs.position;
        }
        if kicked {
            self.unkicked_ticks = 0;
        }
    }
}

/// One more tick, up to the end of the word; or none.
fn counted(ticks: u16, goes_on: bool) -> u16 {
    if goes_on { ticks.saturating_add(1) } else { 0 }
}

/// Distance from the middle between −1 and 0, cut: `value`, or −`value` − 1. It needs no carry in hardware.
fn size(value: i32) -> u32 {
    (value ^ (value >> 31)) as u32
}
