//! What is watched at ticks: limits, soft limits, errors against their limits, and what has lasted too long.
//!
//! At the tick all is taken as it is ([`Shown`]); a clock later it is compared, and one more later the causes are there:
//! [`WATCH_CLOCKS`](super::WATCH_CLOCKS) with the state's.

use super::cause::Cause;
use super::inputs::Inputs;

/// What a tick shows.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Shown {
    /// The outputs are on.
    on: bool,
    /// The command's velocity is positive; negative.
    ways: [bool; 2],
    /// The shaped velocity is.
    shaped_ways: [bool; 2],
    /// Limit +, limit −, soft limit +, soft limit − are passed.
    passed: [bool; 4],
    /// The position is that of the tick before.
    same_position: bool,
    /// The command was cut for too many ticks in a row.
    saturated: bool,
    /// Sizes of e, deviation and command.
    sizes: [u32; 3],
}

impl Shown {
    /// `on_limits` are the filtered switches.
    fn new(inputs: &Inputs, on_limits: [bool; 2], on: bool, captured_position: i32) -> Self {
        let ways = |velocity: i32| [velocity > 0, velocity < 0];
        let (plus, minus) = (inputs.soft_limit_plus, inputs.soft_limit_minus);
        let watched = plus != 0 || minus != 0;
        Self {
            on,
            ways: ways(inputs.command_velocity),
            shaped_ways: ways(inputs.reference_velocity),
            passed: [
                on_limits[0],
                on_limits[1],
                watched && inputs.reference_position > plus,
                watched && inputs.reference_position < minus,
            ],
            same_position: inputs.position == captured_position,
            saturated: lasts(inputs.limited_ticks, inputs.saturation_ticks),
            sizes: [inputs.error, inputs.deviation, inputs.command].map(size),
        }
    }
}

/// What a tick counts, two clocks later.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Counts {
    /// Outputs on.
    on: bool,
    /// A command and no count.
    stands: bool,
}

/// Registers of what is watched, all quiet soon after a tick.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Monitors {
    /// The position at the last tick.
    pub(super) captured_position: i32,
    /// Causes that a tick has found.
    pub(super) found: u16,
    /// A clock after a tick.
    shown: Option<Shown>,
    /// Two clocks after it.
    counts: Option<Counts>,
    /// Limit +, limit −, soft limit +, soft limit − were passed at the last tick.
    were_passed: [bool; 4],
    /// Ticks in a row with a command and without a count.
    still_ticks: u16,
    /// Ticks since the last kick.
    unkicked_ticks: u16,
}

impl Monitors {
    /// The causes of a tick with the outputs on.
    fn causes(&self, inputs: &Inputs, shown: &Shown) -> u16 {
        let newly = |at: usize| !self.were_passed[at];
        let ([plus, minus], [shaped_plus, shaped_minus]) = (shown.ways, shown.shaped_ways);
        // A switch bounces while the axis leaves it; a shaped position does not.
        let [limit_plus, limit_minus, soft_plus, soft_minus] = [
            plus || (newly(0) && shaped_plus),
            minus || (newly(1) && shaped_minus),
            plus || newly(2),
            minus || newly(3),
        ];
        let exceeds = |size: u32, limit: u32| limit != 0 && size > limit;
        let [error, deviation, _] = shown.sizes;
        let found = [
            (Cause::LimitPlus, shown.passed[0] && limit_plus),
            (Cause::LimitMinus, shown.passed[1] && limit_minus),
            (Cause::SoftLimitPlus, shown.passed[2] && soft_plus),
            (Cause::SoftLimitMinus, shown.passed[3] && soft_minus),
            (Cause::FollowingError, exceeds(error, inputs.following_error_limit)),
            (Cause::Deviation, exceeds(deviation, inputs.deviation_limit)),
            (Cause::Saturation, shown.saturated),
            (Cause::EncoderLost, lasts(self.still_ticks, inputs.lost_ticks)),
            (Cause::Watchdog, lasts(self.unkicked_ticks, inputs.watchdog_ticks)),
        ];
        let bits = found.map(|(cause, is)| if is { cause.bit() } else { 0 });
        bits.into_iter().fold(0, |all, bit| all | bit)
    }

    /// One clock.
    pub(super) fn clock(&mut self, inputs: &Inputs, on_limits: [bool; 2], on: bool, kicked: bool) {
        let shown = self.shown.take();
        self.found = match &shown {
            Some(shown) if shown.on => self.causes(inputs, shown),
            _ => 0,
        };
        if let Some(counts) = self.counts.take() {
            self.still_ticks = counted(self.still_ticks, counts.stands);
            self.unkicked_ticks = counted(self.unkicked_ticks, counts.on);
        }
        if kicked {
            self.unkicked_ticks = 0;
        }
        if let Some(Shown {
            on,
            passed,
            same_position,
            sizes: [_, _, command],
            ..
        }) = shown
        {
            self.were_passed = passed;
            let stands = on && same_position && command > inputs.lost_command;
            self.counts = Some(Counts { on, stands });
        }
        if inputs.tick {
            self.shown = Some(Shown::new(inputs, on_limits, on, self.captured_position));
            self.captured_position = inputs.position;
        }
    }
}

/// Has it lasted too long? 0: not watched.
fn lasts(ticks: u16, limit: u16) -> bool {
    limit != 0 && ticks >= limit
}

/// One more tick, up to the end of the word; or none.
fn counted(ticks: u16, goes_on: bool) -> u16 {
    if goes_on { ticks.saturating_add(1) } else { 0 }
}

/// Distance from the middle between −1 and 0, cut: `value`, or −`value` − 1. It needs no carry in hardware.
fn size(value: i32) -> u32 {
    (value ^ (value >> 31)) as u32
}
