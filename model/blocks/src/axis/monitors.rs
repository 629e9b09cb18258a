//! The checks at ticks: limits, soft limits, errors against their limits, and time limits.
//!
//! Levels are taken as they are at the tick ([`Shown`]). Numbers follow byte by byte ([`Taken`]) and are compared in
//! two rounds. A cause must be found in both rounds, so that a limit that is written meanwhile, half old and half new,
//! does not trip the axis. The causes act on the state [`WATCH_CLOCKS`](super::WATCH_CLOCKS) after the tick.

use super::cause::Cause;
use super::ports::Inputs;

/// Clocks after the tick in which a round is over and its result known.
const FIRST_ROUND: u8 = 5;
const SECOND_ROUND: u8 = 10;
/// A change of fewer counts is no motion: −4 to 3.
pub(super) const STILL_COUNTS: i32 = 4;

/// Levels at a tick.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Shown {
    /// Whether the outputs are on.
    on: bool,
    /// Whether the command's velocity is positive, and whether it is negative.
    ways: [bool; 2],
    /// Whether the shaped velocity is positive, and whether it is negative.
    shaped_ways: [bool; 2],
    /// Whether limit switch + and limit switch − are active.
    on_limits: [bool; 2],
    /// Whether e, deviation and command are negative.
    negative: [bool; 3],
}

impl Shown {
    /// Takes the levels; `on_limits` are the filtered switches.
    fn new(inputs: &Inputs, on_limits: [bool; 2], on: bool) -> Self {
        let ways = |velocity: i32| [velocity > 0, velocity < 0];
        Self {
            on,
            ways: ways(inputs.command_velocity),
            shaped_ways: ways(inputs.reference_velocity),
            on_limits,
            negative: [inputs.error, inputs.deviation, inputs.command].map(i32::is_negative),
        }
    }
}

/// Numbers and limits of a round. Each clock takes a byte of each; of those of 16 bits a nibble.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Taken {
    reference_position: u32,
    soft_limits: [u32; 2],
    /// The numbers e, deviation and command.
    numbers: [u32; 3],
    /// Their limits.
    limits: [u32; 3],
    limited_ticks: u16,
    /// Time limits of saturation, of a lost encoder and of the watchdog.
    most_ticks: [u16; 3],
}

impl Taken {
    /// Simulates one clock, in which byte `part` is taken; the lowest is 0. A linear scale computes its next
    /// deviation from the tick on, so the deviation of the tick is passed.
    fn take(&mut self, inputs: &Inputs, deviation: i32, part: u8) {
        let mask = 0xff << (8 * part);
        let byte = |taken: &mut u32, word: u32| *taken = *taken & !mask | word & mask;
        byte(&mut self.reference_position, inputs.reference_position as u32);
        let soft_limits = [inputs.soft_limit_plus, inputs.soft_limit_minus];
        let numbers = [inputs.error, deviation, inputs.command];
        let limits = [
            inputs.following_error_limit,
            inputs.deviation_limit,
            inputs.lost_command,
        ];
        self.soft_limits
            .iter_mut()
            .zip(soft_limits)
            .for_each(|(taken, word)| byte(taken, word as u32));
        self.numbers
            .iter_mut()
            .zip(numbers)
            .for_each(|(taken, word)| byte(taken, word as u32));
        self.limits
            .iter_mut()
            .zip(limits)
            .for_each(|(taken, word)| byte(taken, word));
        let mask = 0xf << (4 * part);
        let nibble = |taken: &mut u16, half: u16| *taken = *taken & !mask | half & mask;
        nibble(&mut self.limited_ticks, inputs.limited_ticks);
        let most_ticks = [inputs.saturation_ticks, inputs.lost_ticks, inputs.watchdog_ticks];
        self.most_ticks
            .iter_mut()
            .zip(most_ticks)
            .for_each(|(taken, half)| nibble(taken, half));
    }
}

/// Registers of the checks, which are all quiet soon after a tick.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Monitors {
    /// The position at the last tick.
    pub(super) captured_position: i32,
    /// Causes that the last tick's checks have found.
    pub(super) found: u32,
    /// Clocks since the tick; 0 once the second round is over.
    clocks: u8,
    shown: Shown,
    /// Deviation at the tick.
    deviation: i32,
    taken: Taken,
    /// Causes that the first round has found.
    first_found: u32,
    /// Whether limit +, limit −, soft limit +, soft limit − were passed at the last tick.
    were_passed: [bool; 4],
    /// Consecutive ticks with a command in one direction and without a motion of more than [`STILL_COUNTS`].
    still_ticks: u16,
    /// Position and sign of the command at the last tick that `still_ticks` did not count or, if later, at the last
    /// motion.
    still_since: (i32, bool),
    /// Ticks since the last kick.
    unkicked_ticks: u16,
    /// Whether a kick came during a comparison.
    kick_waits: bool,
}

impl Monitors {
    /// Whether limit +, limit −, soft limit +, soft limit − are passed. `waits`: the soft limits do not act yet.
    fn passed(&self, waits: bool) -> [bool; 4] {
        let [plus, minus] = self.taken.soft_limits.map(|limit| limit as i32);
        let reference = self.taken.reference_position as i32;
        let watched = (plus != 0 || minus != 0) && !waits;
        let [on_plus, on_minus] = self.shown.on_limits;
        [
            on_plus,
            on_minus,
            watched && reference > plus,
            watched && reference < minus,
        ]
    }

    /// Whether the magnitude of e, deviation or command (by index) exceeds its limit.
    fn exceeds(&self, at: usize) -> bool {
        let word = self.taken.numbers[at];
        let size = if self.shown.negative[at] { !word } else { word };
        size > self.taken.limits[at]
    }

    /// Whether the axis has moved backward, and forward, since the position was last seen to move. The count of a
    /// stuck line may dither by one, which does not count as motion.
    fn motion(&self) -> [bool; 2] {
        let motion = self.captured_position.wrapping_sub(self.still_since.0);
        [motion < -STILL_COUNTS, motion >= STILL_COUNTS]
    }

    /// Whether the command exceeds its threshold, in the same direction as when the position was last seen to move,
    /// and there was no motion since then. With `watches_direction` a motion against the command does not count.
    fn stands(&self, watches_direction: bool) -> bool {
        let negative = self.still_since.1;
        let [backward, forward] = self.motion();
        let against = if negative { forward } else { backward };
        let moves = (backward || forward) && !(watches_direction && against);
        self.shown.on && !moves && self.shown.negative[2] == negative && self.exceeds(2)
    }

    /// The causes that a round finds.
    fn causes(&self, waits: bool) -> u32 {
        let shown = &self.shown;
        let newly = |at: usize| !self.were_passed[at];
        let ([plus, minus], [shaped_plus, shaped_minus]) = (shown.ways, shown.shaped_ways);
        // A switch bounces while the axis leaves it; a shaped position does not bounce.
        let [limit_plus, limit_minus, soft_plus, soft_minus] = [
            plus || (newly(0) && shaped_plus),
            minus || (newly(1) && shaped_minus),
            plus || newly(2),
            minus || newly(3),
        ];
        let passed = self.passed(waits);
        let exceeds = |at: usize| self.taken.limits[at] != 0 && self.exceeds(at);
        let [saturation, lost, watchdog] = self.taken.most_ticks;
        let found = [
            (Cause::LimitPlus, passed[0] && limit_plus),
            (Cause::LimitMinus, passed[1] && limit_minus),
            (Cause::SoftLimitPlus, passed[2] && soft_plus),
            (Cause::SoftLimitMinus, passed[3] && soft_minus),
            (Cause::FollowingError, exceeds(0)),
            (Cause::Deviation, exceeds(1)),
            (Cause::Saturation, lasts(self.taken.limited_ticks, saturation)),
            (Cause::EncoderLost, lasts(self.still_ticks, lost)),
            (Cause::Watchdog, lasts(self.unkicked_ticks, watchdog)),
        ];
        let bits = found.map(|(cause, is)| if is { cause.bit() } else { 0 });
        bits.into_iter().fold(0, |all, bit| all | bit)
    }

    /// Simulates one clock.
    pub(super) fn clock(&mut self, inputs: &Inputs, on_limits: [bool; 2], waits: bool, on: bool, kicked: bool) {
        let clocks = self.clocks;
        self.found = 0;
        if inputs.tick {
            self.deviation = inputs.deviation;
        }
        if clocks == FIRST_ROUND {
            self.first_found = self.causes(waits);
            self.still_ticks = self.still_ticks.saturating_add(1);
            self.unkicked_ticks = self.unkicked_ticks.saturating_add(1);
        }
        if clocks == SECOND_ROUND {
            if self.shown.on {
                self.found = self.causes(waits) & self.first_found;
            }
            self.were_passed = self.passed(waits);
            let stands = self.stands(inputs.watches_direction);
            if !stands {
                self.still_ticks = 0;
            }
            // A motion against the command does not count as motion, but the reference position follows it: an axis
            // that a torque has slowed down and reversed then moves with the command, however far it is from where it
            // began to slow down.
            if !stands || self.motion().contains(&true) {
                self.still_since = (self.captured_position, self.shown.negative[2]);
            }
        }
        // A kick waits while counts are compared.
        let compares = matches!(clocks, 1..=4 | 6..=9);
        let kicked = kicked || self.kick_waits;
        self.kick_waits = kicked && compares;
        if !compares && (kicked || !self.shown.on) {
            self.unkicked_ticks = 0;
        }
        match clocks {
            1..=3 => self.taken.take(inputs, self.deviation, clocks),
            5..=8 => self.taken.take(inputs, self.deviation, clocks - FIRST_ROUND),
            _ => {}
        }
        self.clocks = if matches!(clocks, 0 | SECOND_ROUND) {
            0
        } else {
            clocks + 1
        };
        if inputs.tick {
            self.taken.take(inputs, self.deviation, 0);
            self.shown = Shown::new(inputs, on_limits, on);
            self.captured_position = inputs.position;
            self.clocks = 1;
        }
    }
}

/// Whether a time limit is exceeded; 0 disables the check.
fn lasts(ticks: u16, limit: u16) -> bool {
    limit != 0 && ticks >= limit
}
