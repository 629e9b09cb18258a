//! The transition table as data: the clocked model follows it, the datasheet prints it, and lock step observes it.

/// State of the axis: the value of the port `state`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SupervisorState {
    /// Outputs off, not ready.
    #[default]
    Off = 0,
    /// Outputs off, everything in order: waits for `enable`.
    Ready = 1,
    /// Outputs on, the command stands still.
    Hold = 2,
    /// Outputs on, segments play.
    Run = 3,
    /// Outputs on, the command slows down through the shaper.
    QuickStop = 4,
    /// Outputs off at the latest after the brake has closed; stays until `clear_faults`.
    Fault = 5,
}

impl SupervisorState {
    /// All states, in the order of their values.
    pub const ALL: [Self; 6] = [
        Self::Off,
        Self::Ready,
        Self::Hold,
        Self::Run,
        Self::QuickStop,
        Self::Fault,
    ];

    /// The state with this port value; `None` for 6 and above.
    pub fn from_value(value: u64) -> Option<Self> {
        Self::ALL.into_iter().find(|state| *state as u64 == value)
    }

    /// Name in the datasheet.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "OFF",
            Self::Ready => "READY",
            Self::Hold => "HOLD",
            Self::Run => "RUN",
            Self::QuickStop => "QUICK_STOP",
            Self::Fault => "FAULT",
        }
    }

    /// Meaning for the outputs and the command, in the words of the register map.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Off => "outputs off",
            Self::Ready => "outputs off, no fault",
            Self::Hold => "outputs on, the command stands",
            Self::Run => "segments play",
            Self::QuickStop => "slowing down",
            Self::Fault => "a cause, until it is cleared",
        }
    }
}

/// Condition on which a transition can depend. Causes count in the clock in which they become active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// There is a cause that switches off.
    Cut = 0,
    /// There is a cause other than the group stop.
    Fault = 1,
    /// There is a cause.
    Cause = 2,
    /// The drive is ready, and the lines are known.
    DriveReady = 3,
    /// `enable` is high.
    Enable = 4,
    /// `tick` is high.
    Tick = 5,
    /// Another axis wants all axes to stop.
    GroupStop = 6,
    /// `stop` is high.
    Stop = 7,
    /// A `start` came since the last tick and nothing prevents it: the brake is open and the segments hold.
    Start = 8,
    /// The segments hold, and no entry waits.
    Done = 9,
    /// The segments have stopped.
    Stopped = 10,
    /// The timer is over.
    Elapsed = 11,
    /// The brake closes while the outputs are on.
    Closing = 12,
    /// `clear_faults` has taken effect, no cause is left, and the outputs are off.
    Cleared = 13,
}

impl Condition {
    /// All conditions, in the order of their bits.
    pub const ALL: [Self; 14] = [
        Self::Cut,
        Self::Fault,
        Self::Cause,
        Self::DriveReady,
        Self::Enable,
        Self::Tick,
        Self::GroupStop,
        Self::Stop,
        Self::Start,
        Self::Done,
        Self::Stopped,
        Self::Elapsed,
        Self::Closing,
        Self::Cleared,
    ];

    /// Name in small letters with underscores.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cut => "cut",
            Self::Fault => "fault",
            Self::Cause => "cause",
            Self::DriveReady => "drive_ready",
            Self::Enable => "enable",
            Self::Tick => "tick",
            Self::GroupStop => "group_stop",
            Self::Stop => "stop",
            Self::Start => "start",
            Self::Done => "done",
            Self::Stopped => "stopped",
            Self::Elapsed => "elapsed",
            Self::Closing => "closing",
            Self::Cleared => "cleared",
        }
    }

    const fn bit(self) -> u16 {
        1 << self as u16
    }
}

/// The conditions that hold in a clock.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Conditions(u16);

impl Conditions {
    /// Returns the conditions with `condition` added if `holds`.
    #[must_use]
    #[inline]
    pub const fn with(self, condition: Condition, holds: bool) -> Self {
        Self(self.0 | if holds { condition.bit() } else { 0 })
    }

    /// Returns whether a condition holds.
    #[inline]
    pub const fn has(self, condition: Condition) -> bool {
        self.0 & condition.bit() != 0
    }
}

/// A transition from one state to another, taken if all of `needs` and none of `forbids` hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// State before.
    pub from: SupervisorState,
    /// State after.
    pub to: SupervisorState,
    /// Reason in words, as in the datasheet.
    pub why: &'static str,
    needs: u16,
    forbids: u16,
}

impl Transition {
    const fn new(
        from: SupervisorState,
        to: SupervisorState,
        needs: &[Condition],
        forbids: &[Condition],
        why: &'static str,
    ) -> Self {
        Self {
            from,
            to,
            why,
            needs: bits(needs),
            forbids: bits(forbids),
        }
    }

    /// Returns whether the transition needs `condition`.
    pub const fn needs(&self, condition: Condition) -> bool {
        self.needs & condition.bit() != 0
    }

    /// Returns whether `condition` forbids the transition.
    pub const fn forbids(&self, condition: Condition) -> bool {
        self.forbids & condition.bit() != 0
    }

    #[inline]
    fn applies(&self, state: SupervisorState, conditions: Conditions) -> bool {
        self.from == state && conditions.0 & self.needs == self.needs && conditions.0 & self.forbids == 0
    }
}

const fn bits(conditions: &[Condition]) -> u16 {
    let mut bits = 0;
    let mut at = 0;
    while at < conditions.len() {
        bits |= conditions[at].bit();
        at += 1;
    }
    bits
}

/// All transitions. Of those of a state, the first that applies is taken; if none does, the state stays.
pub const TRANSITIONS: [Transition; 19] = {
    use Condition as C;
    use SupervisorState::{Fault, Hold, Off, QuickStop, Ready, Run};
    [
        Transition::new(
            Off,
            Ready,
            &[C::DriveReady],
            &[C::Cause, C::Enable],
            "no cause, drive ready, `enable` low",
        ),
        Transition::new(Ready, Fault, &[C::Fault], &[], "a cause"),
        Transition::new(Ready, Off, &[], &[C::DriveReady], "drive no longer ready"),
        Transition::new(
            Ready,
            Hold,
            &[C::Tick, C::Enable],
            &[C::GroupStop],
            "at a tick: `enable`, no `group_stop`",
        ),
        Transition::new(Hold, Fault, &[C::Cut], &[], "a cause that switches off"),
        Transition::new(
            Hold,
            Fault,
            &[C::Fault, C::Closing],
            &[],
            "a cause while the brake closes",
        ),
        Transition::new(Hold, QuickStop, &[C::Fault], &[], "any other cause but the group stop"),
        Transition::new(
            Hold,
            Off,
            &[C::Tick, C::Closing, C::Elapsed],
            &[],
            "at a tick: the brake has closed after `enable` went low",
        ),
        Transition::new(
            Hold,
            Run,
            &[C::Tick, C::Start, C::Enable],
            &[C::Cause, C::GroupStop, C::Stop],
            "at a tick: `start`, brake open, segments in hold, `enable`, no cause, no `group_stop`",
        ),
        Transition::new(Run, Fault, &[C::Cut], &[], "a cause that switches off"),
        Transition::new(Run, QuickStop, &[C::Fault], &[], "any other cause"),
        Transition::new(Run, QuickStop, &[C::Stop], &[], "`stop`"),
        Transition::new(Run, QuickStop, &[C::GroupStop], &[], "`group_stop`"),
        Transition::new(Run, QuickStop, &[], &[C::Enable], "`enable` low"),
        Transition::new(
            Run,
            Hold,
            &[C::Tick, C::Done],
            &[],
            "at a tick: segments in hold, none waits",
        ),
        Transition::new(QuickStop, Fault, &[C::Cut], &[], "a cause that switches off"),
        Transition::new(
            QuickStop,
            Fault,
            &[C::Tick, C::Stopped, C::Elapsed, C::Fault],
            &[],
            "at a tick: segments stopped, `settle_ticks` over, a cause but the group stop",
        ),
        Transition::new(
            QuickStop,
            Hold,
            &[C::Tick, C::Stopped, C::Elapsed],
            &[],
            "at a tick: segments stopped, `settle_ticks` over",
        ),
        Transition::new(
            Fault,
            Off,
            &[C::Cleared],
            &[],
            "`clear_faults`, no cause left, outputs off",
        ),
    ]
};

/// The state after this clock.
#[inline]
pub fn next(state: SupervisorState, conditions: Conditions) -> SupervisorState {
    let taken = TRANSITIONS.iter().find(|row| row.applies(state, conditions));
    taken.map_or(state, |row| row.to)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same transitions, written as branches.
    fn in_branches(state: SupervisorState, conditions: Conditions) -> SupervisorState {
        use Condition as C;
        let is = |condition| conditions.has(condition);
        let at_rest = is(C::Tick) && is(C::Stopped) && is(C::Elapsed);
        match state {
            SupervisorState::Off if is(C::DriveReady) && !is(C::Cause) && !is(C::Enable) => SupervisorState::Ready,
            SupervisorState::Ready if is(C::Fault) => SupervisorState::Fault,
            SupervisorState::Ready if !is(C::DriveReady) => SupervisorState::Off,
            SupervisorState::Ready if is(C::Tick) && is(C::Enable) && !is(C::GroupStop) => SupervisorState::Hold,
            SupervisorState::Fault if is(C::Cleared) => SupervisorState::Off,
            SupervisorState::Off | SupervisorState::Ready | SupervisorState::Fault => state,
            _ if is(C::Cut) => SupervisorState::Fault,
            SupervisorState::Hold if is(C::Fault) && is(C::Closing) => SupervisorState::Fault,
            SupervisorState::Hold if is(C::Fault) => SupervisorState::QuickStop,
            SupervisorState::Hold if is(C::Tick) => {
                let may_run = is(C::Enable) && !is(C::Cause) && !is(C::GroupStop) && !is(C::Stop);
                match (is(C::Closing) && is(C::Elapsed), is(C::Start) && may_run) {
                    (true, _) => SupervisorState::Off,
                    (false, true) => SupervisorState::Run,
                    (false, false) => SupervisorState::Hold,
                }
            }
            SupervisorState::Run if is(C::Fault) || is(C::Stop) || is(C::GroupStop) || !is(C::Enable) => {
                SupervisorState::QuickStop
            }
            SupervisorState::Run if is(C::Tick) && is(C::Done) => SupervisorState::Hold,
            SupervisorState::QuickStop if at_rest && is(C::Fault) => SupervisorState::Fault,
            SupervisorState::QuickStop if at_rest => SupervisorState::Hold,
            SupervisorState::Hold | SupervisorState::Run | SupervisorState::QuickStop => state,
        }
    }

    #[test]
    fn the_table_is_what_the_branches_say_in_every_case() {
        let mut taken = [0; TRANSITIONS.len()];
        for state in SupervisorState::ALL {
            for bits in 0..1 << Condition::ALL.len() {
                let conditions = Conditions(bits);
                assert_eq!(
                    next(state, conditions),
                    in_branches(state, conditions),
                    "{state:?} {bits:#x}"
                );
                if let Some(row) = TRANSITIONS.iter().position(|row| row.applies(state, conditions)) {
                    taken[row] += 1;
                }
            }
        }
        assert!(taken.iter().all(|count| *count > 0), "{taken:?}");
    }

    #[test]
    fn the_datasheet_prints_the_table() {
        let datasheet = include_str!("../../../../docs/axis.md");
        for row in &TRANSITIONS {
            let line = format!("| {} | {} | {} |", row.from.name(), row.why, row.to.name());
            assert!(datasheet.contains(&line), "docs/axis.md lacks\n{line}");
        }
    }
}
