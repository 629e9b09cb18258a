//! The output ports of the axis's supervisor.

use super::transition::State;
use crate::rtl::PlainRow;

/// The output ports, all of them registers or functions of registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// What the axis is doing: 0 OFF, 1 READY, 2 HOLD, 3 RUN, 4 QUICK_STOP, 5 FAULT.
    pub state: State,
    /// Sticky: what went wrong. See [`Cause`](super::Cause).
    pub causes: u32,
    /// To the drive.
    pub drive_enable: bool,
    /// To the brake: high opens it.
    pub brake_release: bool,
    /// To the PWM.
    pub pwm_enable: bool,
    /// To the PWM's filtered fault: low is an emergency stop.
    pub pwm_trip_n: bool,
    /// To `segments`: its `enable`.
    pub segments_enable: bool,
    /// To `segments`: its `preset`; while the outputs are off.
    pub segments_preset: bool,
    /// To `segments`: its `quick_stop`; until it stops.
    pub segments_quick_stop: bool,
    /// To `segments`: its `restart`; in HOLD until it holds.
    pub segments_restart: bool,
    /// To the shaper: its `start`; until the first sample after the outputs went on.
    pub shaper_start: bool,
    /// To the controller; as `shaper_start`.
    pub clear_integral: bool,
    /// One clock after `clear_faults`: to the flags and the trip that causes come from.
    pub clear_sources: bool,
    /// To the stage: a fault, or a quick stop because of one.
    pub wants_group_stop: bool,
    /// To the stage: this axis's own line.
    pub emergency_stop: bool,
    /// A `start` would lead to RUN at the next tick; as of the clock before.
    pub can_start: bool,
    /// The host has homed the axis, and its position has not been in doubt since then.
    pub homed: bool,
    /// The position at the last tick, counts.
    pub captured_position: i32,
    /// Filtered line.
    pub level_emergency_stop_n: bool,
    /// Filtered line.
    pub level_limit_plus_n: bool,
    /// Filtered line.
    pub level_limit_minus_n: bool,
    /// Filtered line.
    pub level_drive_ready: bool,
    /// Filtered line.
    pub level_home: bool,
    /// One clock: READY to HOLD.
    pub enabled: bool,
    /// One clock: HOLD to RUN.
    pub started: bool,
    /// One clock: to QUICK_STOP.
    pub stopping: bool,
    /// One clock: RUN or QUICK_STOP to HOLD.
    pub halted: bool,
    /// One clock: HOLD to OFF.
    pub disabled: bool,
    /// One clock: to FAULT.
    pub faulted: bool,
    /// One clock: a `start` that led to nothing.
    pub refused: bool,
}

/// In port order, with width and sign.
pub(super) const OUTPUTS: [PlainRow; 30] = [
    ("state", 3, false),
    ("causes", 17, false),
    ("drive_enable", 1, false),
    ("brake_release", 1, false),
    ("pwm_enable", 1, false),
    ("pwm_trip_n", 1, false),
    ("segments_enable", 1, false),
    ("segments_preset", 1, false),
    ("segments_quick_stop", 1, false),
    ("segments_restart", 1, false),
    ("shaper_start", 1, false),
    ("clear_integral", 1, false),
    ("clear_sources", 1, false),
    ("wants_group_stop", 1, false),
    ("emergency_stop", 1, false),
    ("can_start", 1, false),
    ("homed", 1, false),
    ("captured_position", 32, true),
    ("level_emergency_stop_n", 1, false),
    ("level_limit_plus_n", 1, false),
    ("level_limit_minus_n", 1, false),
    ("level_drive_ready", 1, false),
    ("level_home", 1, false),
    ("enabled", 1, false),
    ("started", 1, false),
    ("stopping", 1, false),
    ("halted", 1, false),
    ("disabled", 1, false),
    ("faulted", 1, false),
    ("refused", 1, false),
];

/// Number of output ports.
pub const OUTPUT_PORTS: usize = OUTPUTS.len();

impl Outputs {
    /// From raw bit patterns, one per output port in port order; none for a state that there is not.
    pub fn from_raw(raw: &[u64; OUTPUT_PORTS]) -> Option<Self> {
        let mut values = raw.iter().copied();
        let mut word = || values.next().unwrap_or_default();
        Some(Self {
            state: State::from_value(word())?,
            causes: word() as u32 & 0x1_ffff,
            drive_enable: word() & 1 != 0,
            brake_release: word() & 1 != 0,
            pwm_enable: word() & 1 != 0,
            pwm_trip_n: word() & 1 != 0,
            segments_enable: word() & 1 != 0,
            segments_preset: word() & 1 != 0,
            segments_quick_stop: word() & 1 != 0,
            segments_restart: word() & 1 != 0,
            shaper_start: word() & 1 != 0,
            clear_integral: word() & 1 != 0,
            clear_sources: word() & 1 != 0,
            wants_group_stop: word() & 1 != 0,
            emergency_stop: word() & 1 != 0,
            can_start: word() & 1 != 0,
            homed: word() & 1 != 0,
            captured_position: word() as i32,
            level_emergency_stop_n: word() & 1 != 0,
            level_limit_plus_n: word() & 1 != 0,
            level_limit_minus_n: word() & 1 != 0,
            level_drive_ready: word() & 1 != 0,
            level_home: word() & 1 != 0,
            enabled: word() & 1 != 0,
            started: word() & 1 != 0,
            stopping: word() & 1 != 0,
            halted: word() & 1 != 0,
            disabled: word() & 1 != 0,
            faulted: word() & 1 != 0,
            refused: word() & 1 != 0,
        })
    }

    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        [
            self.state as u64,
            u64::from(self.causes),
            u64::from(self.drive_enable),
            u64::from(self.brake_release),
            u64::from(self.pwm_enable),
            u64::from(self.pwm_trip_n),
            u64::from(self.segments_enable),
            u64::from(self.segments_preset),
            u64::from(self.segments_quick_stop),
            u64::from(self.segments_restart),
            u64::from(self.shaper_start),
            u64::from(self.clear_integral),
            u64::from(self.clear_sources),
            u64::from(self.wants_group_stop),
            u64::from(self.emergency_stop),
            u64::from(self.can_start),
            u64::from(self.homed),
            u64::from(self.captured_position as u32),
            u64::from(self.level_emergency_stop_n),
            u64::from(self.level_limit_plus_n),
            u64::from(self.level_limit_minus_n),
            u64::from(self.level_drive_ready),
            u64::from(self.level_home),
            u64::from(self.enabled),
            u64::from(self.started),
            u64::from(self.stopping),
            u64::from(self.halted),
            u64::from(self.disabled),
            u64::from(self.faulted),
            u64::from(self.refused),
        ]
    }
}
