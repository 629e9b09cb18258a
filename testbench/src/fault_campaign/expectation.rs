//! What is demanded of a fault: data, one [`Expectation`] per kind, with the times of `docs/axis.md` and its neighbours.

use posicast_model::rtl::axis::{Cause, WATCH_CLOCKS};

/// Which axes a fault is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hit {
    /// One, or both at once.
    Axis,
    /// All: a shared line.
    Stage,
}

/// What follows on the axes that are hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reaction {
    /// Nothing: the move ends on target.
    Nothing,
    /// By `off_causes`: FAULT with the outputs off at once, or QUICK_STOP, standstill, brake, then FAULT.
    Fault,
    /// QUICK_STOP without a cause, then HOLD.
    Halt,
    /// QUICK_STOP without a cause, then HOLD, brake, READY.
    Disable,
    /// All registers as after power-up.
    Reset,
}

/// What the axes that are not hit do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Others {
    /// The group stop: QUICK_STOP two clocks later, then HOLD, with no cause but the group stop's.
    Stop,
    /// Their move ends on target.
    GoOn,
}

/// What a fault is seen by at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// |e| above its limit.
    FollowingError,
    /// |motor − scale| above its limit.
    Deviation,
    /// The command was cut for `SATURATION_TICKS`, or there was no count under a command
    /// for `LOST_TICKS`.
    Stuck,
    /// [`Stuck`](Self::Stuck) or [`Deviation`](Self::Deviation).
    Lost,
    /// The shaped position is beyond the soft limit that was moved.
    SoftLimit,
    /// The flag of the segments: underrun or overflow.
    Segments,
    /// The controller's flag: e was cut to its word.
    Range,
}

impl Seen {
    /// Clocks from then to the state: a flag is a cause and then acts, or has left the range and then is a cause that acts at
    /// once; the rest is compared first.
    pub(super) fn clocks(self) -> u64 {
        match self {
            Self::Segments | Self::Range => 2,
            Self::FollowingError | Self::Deviation | Self::Stuck | Self::Lost | Self::SoftLimit => WATCH_CLOCKS.into(),
        }
    }
}

/// When the state has changed at the latest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Due {
    /// So many clocks after the fault.
    Clocks(u64),
    /// So many clocks after the fault comes the first of so many ticks, then [`WATCH_CLOCKS`].
    Ticks {
        /// Clocks.
        clocks: u64,
        /// Ticks.
        ticks: u64,
    },
    /// `Seen::clocks` after it is seen.
    Seen(Seen),
}

/// How long a fault lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lasts {
    /// Until the axes have stopped.
    Held,
    /// So many clocks at least and at most.
    Clocks(u64, u64),
    /// Either of these.
    HeldOrClocks(u64, u64),
}

/// What is demanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Expectation {
    /// Where it is.
    pub hit: Hit,
    /// What follows.
    pub reaction: Reaction,
    /// Causes of which at least one must be there.
    pub causes: u32,
    /// Causes that may be there too: what the first one leads to.
    pub also: u32,
    /// When the state has changed.
    pub due: Due,
    /// The gates are off in the clock of the fault itself, without waiting for the state.
    pub gates_at_once: bool,
    /// Register and field that must be set.
    pub flag: Option<(&'static str, &'static str)>,
    /// What the others do.
    pub others: Others,
    /// The counter is never away from the plant. Not so if the encoder's lines themselves are corrupted.
    pub position_known: bool,
    /// How long the fault lasts.
    pub lasts: Lasts,
    /// It comes in HOLD, without a move.
    pub in_hold: bool,
    /// When it comes, in percent of the move.
    pub within_percent: [u64; 2],
}

/// A fault of an axis: the others stop.
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

/// What must do nothing.
pub(super) const NOTHING: Expectation = Expectation {
    reaction: Reaction::Nothing,
    others: Others::GoOn,
    ..FAULT
};

/// Bits of causes.
pub(super) const fn bits(causes: &[Cause]) -> u32 {
    let mut bits = 0;
    let mut at = 0;
    while at < causes.len() {
        bits |= causes[at].bit();
        at += 1;
    }
    bits
}
