//! The expectation for a fault as data: one [`Expectation`] per kind, with the times of `docs/axis.md` and related
//! pages.

use posicast_blocks::axis::{Cause, WATCH_CLOCKS};

/// Axes that a fault hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hit {
    /// One axis, or both at the same time.
    Axis,
    /// All axes, by a shared line.
    Stage,
}

/// Reaction of the axes that are hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reaction {
    /// None: the move ends on target.
    Nothing,
    /// By `off_causes`: FAULT with the outputs off at once, or QUICK_STOP, standstill, brake, then FAULT.
    Fault,
    /// QUICK_STOP without a cause, then HOLD.
    Halt,
    /// QUICK_STOP without a cause, then HOLD, brake, READY.
    Disable,
    /// All registers are as after power-up.
    Reset,
}

/// Reaction of the axes that are not hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Others {
    /// The group stop: QUICK_STOP two clocks later, then HOLD, with no cause except the group stop's.
    Stop,
    /// None: their move ends on target.
    GoOn,
}

/// Condition that detects a fault at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// |e| exceeds its limit.
    FollowingError,
    /// |motor − scale| exceeds its limit, and has done so for as many ticks as it may.
    Deviation,
    /// The command was clamped for `SATURATION_TICKS`, or there was no count under a command for `LOST_TICKS`.
    Stuck,
    /// [`Stuck`](Self::Stuck) or [`Deviation`](Self::Deviation).
    Lost,
    /// The shaped position is beyond the soft limit that was moved.
    SoftLimit,
    /// A flag of the segments is set: underrun or overflow.
    Segments,
    /// A flag of the controller is set: e was saturated to its word.
    Range,
    /// The step generator has stopped.
    StepsTripped,
}

impl Seen {
    /// Clocks from the condition to the state: a flag becomes a cause and then acts; a position outside its range
    /// becomes a cause that acts at once; the others are compared first.
    pub(super) fn clocks(self) -> u64 {
        match self {
            Self::Segments | Self::Range => 2,
            // A cause that acts at once.
            Self::StepsTripped => 1,
            Self::FollowingError | Self::Deviation | Self::Stuck | Self::Lost | Self::SoftLimit => WATCH_CLOCKS.into(),
        }
    }
}

/// Latest time at which the state must have changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Due {
    /// This many clocks after the fault.
    Clocks(u64),
    /// [`WATCH_CLOCKS`] after a tick: this many clocks after the fault, this many ticks are counted.
    Ticks {
        /// Number of clocks.
        clocks: u64,
        /// Number of ticks.
        ticks: u64,
    },
    /// `Seen::clocks` after the condition is detected.
    Seen(Seen),
}

/// Duration of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lasts {
    /// Until the axes have stopped.
    Held,
    /// Between these two numbers of clocks.
    Clocks(u64, u64),
    /// Either of these.
    HeldOrClocks(u64, u64),
}

/// The expectation for a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Expectation {
    /// Axes that it hits.
    pub hit: Hit,
    /// Reaction of these axes.
    pub reaction: Reaction,
    /// At least one of these causes must be set; 0: no cause is required.
    pub causes: u32,
    /// Causes that may also be set, as consequences of the first one.
    pub also: u32,
    /// Time at which the state must have changed.
    pub due: Due,
    /// Whether the gates must be off in the clock of the fault itself, before the state changes.
    pub gates_at_once: bool,
    /// Register and field that must be set.
    pub flag: Option<(&'static str, &'static str)>,
    /// Reaction of the other axes.
    pub others: Others,
    /// Whether the counter must never deviate from the plant; false if the encoder's lines themselves are corrupted.
    pub position_known: bool,
    /// Duration of the fault.
    pub lasts: Lasts,
    /// Whether the fault is injected in HOLD, without a move.
    pub in_hold: bool,
    /// Range of its time, in percent of the move.
    pub within_percent: [u64; 2],
}

/// A fault of one axis that stops the others too.
pub(super) const FAULT: Expectation = Expectation {
    hit: Hit::Axis,
    reaction: Reaction::Fault,
    causes: 0,
    also: 0,
    due: Due::Clocks(0),
    gates_at_once: false,
    flag: None,
    others: Others::Stop,
    position_known: true,
    lasts: Lasts::Held,
    in_hold: false,
    within_percent: [0, 85],
};

/// A fault that must have no effect.
pub(super) const NOTHING: Expectation = Expectation {
    reaction: Reaction::Nothing,
    others: Others::GoOn,
    ..FAULT
};

/// Mask of causes.
pub(super) const fn bits(causes: &[Cause]) -> u32 {
    let mut bits = 0;
    let mut at = 0;
    while at < causes.len() {
        bits |= causes[at].bit();
        at += 1;
    }
    bits
}
