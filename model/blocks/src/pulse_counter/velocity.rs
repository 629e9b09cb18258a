//! Velocity by M/T: the steps of a tick divided by the time between the last edges before successive ticks.

use super::ports::Inputs;
use crate::divider::{ELAPSED_BITS, STEP_BITS};
use crate::shaper::wrap;

/// Fraction bits of the smoothed velocity beyond those of Q16.16.
pub const SMOOTHING_BITS: u32 = 3;
/// Offset of the smoothed velocity, so that truncating its extra bits rounds: it then settles exactly on its input.
const ROUNDING: i64 = (1 << (SMOOTHING_BITS - 1)) - 1;

/// A velocity behind a one-pole filter, Q16.19, plus [`ROUNDING`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SmoothedVelocity(i64);

impl SmoothedVelocity {
    /// The velocity 0.
    pub(crate) const REST: Self = Self(ROUNDING);

    /// Its value, Q16.16.
    pub(crate) fn value(self) -> i32 {
        (self.0 >> SMOOTHING_BITS) as i32
    }

    /// Distance to this velocity.
    fn distance(self, velocity: i32) -> i64 {
        (i64::from(velocity) << SMOOTHING_BITS) + ROUNDING - self.0
    }

    fn is_negative(self) -> bool {
        self.0 < 0
    }

    /// Closes 2^−k of the distance to this velocity, Q16.16, rounded half up.
    pub(crate) fn close(&mut self, velocity: i32, k: u8) {
        self.0 += (((2 * self.distance(velocity)) >> (k & 3)) + 1) >> 1;
    }
}
/// Number of bits of the last edge's time stamp that are kept: at the next tick it is less than half of that range
/// ago.
const LAST_STAMP_BITS: u32 = 19;

/// The lowest bits of a time stamp, as many as are kept.
fn low_stamp(time_stamp: u32) -> u32 {
    time_stamp & ((1 << LAST_STAMP_BITS) - 1)
}

/// Meaning of the quotient.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Job {
    /// A measured velocity.
    #[default]
    Measured,
    /// One count in the time since the last edge: an upper bound of the velocity.
    Bound,
    /// No quotient is used: the velocity is 0.
    Halt,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Velocity {
    /// Time stamp ([`LAST_STAMP_BITS`]) of the last edge; without an edge since the last tick, that of the clock
    /// before.
    last_stamp: u32,
    last_up: bool,
    /// Time stamp of the last edge before the last tick, valid if `known`.
    reference_stamp: u32,
    known: bool,
    /// Whether there was an edge since the last tick, or one against the direction of the edge before it.
    moved: bool,
    turned: bool,
    /// Count at the last tick.
    captured: i32,
    job: Job,
    steps: i32,
    elapsed: u32,
    pending: bool,
    smoothed: SmoothedVelocity,
    valid: bool,
    missed: bool,
}

impl Default for Velocity {
    fn default() -> Self {
        Self {
            last_stamp: 0,
            last_up: false,
            reference_stamp: 0,
            known: false,
            moved: false,
            turned: false,
            captured: 0,
            job: Job::Measured,
            steps: 0,
            elapsed: 0,
            pending: false,
            smoothed: SmoothedVelocity::REST,
            valid: false,
            missed: false,
        }
    }
}

impl Velocity {
    pub(super) fn steps(&self) -> i32 {
        self.steps
    }

    pub(super) fn elapsed(&self) -> u32 {
        self.elapsed
    }

    pub(super) fn pending(&self) -> bool {
        self.pending
    }

    pub(super) fn velocity(&self) -> i32 {
        self.smoothed.value()
    }

    pub(super) fn valid(&self) -> bool {
        self.valid
    }

    pub(super) fn missed(&self) -> bool {
        self.missed
    }

    /// Simulates one clock with a step up or down, or none. `count` is that before the step: a step belongs to the
    /// tick after it; one in the clock of a tick belongs to the next tick.
    pub(super) fn clock(&mut self, inputs: &Inputs, step: Option<bool>, count: i32) {
        let resolved = self.pending && inputs.quotient_valid;
        self.valid = resolved;
        if inputs.clear_flags {
            self.missed = false;
        }
        if inputs.tick && self.pending && !resolved {
            self.missed = true;
        }
        let negative = self.smoothed.is_negative();
        if resolved {
            self.resolve(inputs);
            self.pending = false;
        }
        if inputs.tick {
            self.tick(inputs, count, negative);
        }
        if step.is_some() || !self.moved {
            self.last_stamp = low_stamp(inputs.time_stamp);
        }
        if let Some(up) = step {
            self.turned |= up != self.last_up;
            self.last_up = up;
            self.moved = true;
        }
    }

    /// Whether the two states are equal except for the time.
    pub(super) fn is_but_for_time(&self, other: &Self) -> bool {
        let last_stamp = if self.moved { self.last_stamp } else { other.last_stamp };
        Self {
            last_stamp,
            ..self.clone()
        } == *other
    }

    /// Advances through clocks without tick, edge or quotient, up to the clock with this time stamp.
    pub(super) fn pass_time(&mut self, time_stamp: u32) {
        if !self.moved {
            self.last_stamp = low_stamp(time_stamp);
        }
    }

    /// The last edge's complete time stamp: its high bits are those of now, or one less if there was a carry since.
    fn whole_last_stamp(&self, now: u32) -> u32 {
        let top = 1 << (LAST_STAMP_BITS - 1);
        let carried = self.last_stamp & top != 0 && now & top == 0;
        let high = (now >> LAST_STAMP_BITS).wrapping_sub(u32::from(carried));
        high << LAST_STAMP_BITS | self.last_stamp
    }

    fn tick(&mut self, inputs: &Inputs, count: i32, negative: bool) {
        let last_stamp = self.whole_last_stamp(inputs.time_stamp);
        let elapsed = last_stamp.wrapping_sub(self.reference_stamp) & ((1 << ELAPSED_BITS) - 1);
        let counted = wrap(i64::from(count.wrapping_sub(self.captured)), STEP_BITS) as i32;
        let stale = !self.moved && elapsed >> 16 >= u32::from(inputs.timeout);
        let one_back = if negative { -1 } else { 1 };
        (self.job, self.steps, self.elapsed) = if inputs.velocity_m {
            (Job::Measured, counted, 0)
        } else if !self.known || self.turned {
            (Job::Halt, 0, elapsed)
        } else if stale {
            (Job::Halt, one_back, elapsed)
        } else if self.moved {
            (Job::Measured, counted, elapsed)
        } else {
            (Job::Bound, one_back, elapsed)
        };
        self.known = self.moved || (self.known && !stale);
        if self.moved {
            self.reference_stamp = last_stamp;
        }
        self.captured = count;
        self.moved = false;
        self.turned = false;
        self.pending = true;
    }

    /// Takes the quotient: `smoothed += (quotient − smoothed) · 2^−k`, rounded half up.
    fn resolve(&mut self, inputs: &Inputs) {
        let falls = self.smoothed.distance(inputs.quotient) < 0;
        let within_bound = falls == self.smoothed.is_negative();
        match self.job {
            Job::Halt => self.smoothed = SmoothedVelocity::REST,
            Job::Bound if within_bound => {}
            Job::Measured | Job::Bound => self.smoothed.close(inputs.quotient, inputs.smoothing),
        }
    }
}
