//! The ports of the controller.

use crate::rtl::{Direction, Port};

/// Which law computes the command.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Law {
    /// `c·de + k·s + ε·sat(s/φ)`.
    #[default]
    SlidingMode = 0,
    /// Proportional and derivative.
    Pd = 1,
    /// The same and the integral.
    Pid = 2,
}

impl Law {
    /// From the port's two bits; 3 means nothing, and acts as PD.
    pub fn from_bits(bits: u8) -> Self {
        match bits & 3 {
            0 => Self::SlidingMode,
            2 => Self::Pid,
            _ => Self::Pd,
        }
    }
}

/// What a tick is about: what the shaper wants and the pulse counter sees.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Motion {
    /// r: Q24.8 counts.
    pub position_reference: i32,
    /// dr: Q16.16 counts/T.
    pub velocity_reference: i32,
    /// ddr: Q8.24 counts/T².
    pub acceleration_reference: i32,
    /// Measured, counts.
    pub position: i32,
    /// Measured, Q16.16 counts/T.
    pub velocity: i32,
}

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: a tick. Ignored while a pass runs.
    pub start: bool,
    /// The law of this tick, 2 bits; see [`Law::from_bits`].
    pub law: u8,
    /// A rotary axis: references wrap modulo 2^32 LSB.
    pub modulo: bool,
    /// Reference and measurement.
    pub motion: Motion,
    /// The word at the `setting_address` of the clock before.
    pub setting: u32,
    /// Clears the integral.
    pub clear_integral: bool,
    /// Clears the sticky flags.
    pub clear_flags: bool,
}

/// What can saturate: bits of `saturated_high` and `saturated_low`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saturation {
    /// e.
    Error = 0,
    /// de.
    ErrorRate = 1,
    /// s.
    Sliding = 2,
    /// The sum of the feedback.
    Feedback = 3,
    /// The integral of e.
    Integral = 4,
    /// The command, at its limit.
    Command = 5,
    /// The duty.
    Duty = 6,
}

impl Saturation {
    /// Its bit.
    pub const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// The output ports, all of them registers but `setting_address` and `ends`, which follow from registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Address of a setting: its word is expected in the next clock.
    pub setting_address: u8,
    /// e of the last tick, Q16.16 counts.
    pub error: i32,
    /// s of the last tick, Q16.16 counts/T; in PD and PID too.
    pub sliding: i32,
    /// Q20.12 command units, within ±limit.
    pub command: i32,
    /// 18 bits signed, clocks of the PWM period.
    pub duty: i32,
    /// One clock: the outputs are those of the last `start`.
    pub valid: bool,
    /// A pass runs.
    pub busy: bool,
    /// The last command was cut at +limit.
    pub limited_high: bool,
    /// The last command was cut at −limit.
    pub limited_low: bool,
    /// For how many ticks in a row commands were cut; stops at 65,535.
    pub limited_ticks: u16,
    /// Sticky: what was cut at its upper end, a clock after the word; bits as in [`Saturation`].
    pub saturated_high: u8,
    /// Sticky: what was cut at its lower end.
    pub saturated_low: u8,
    /// Sticky: a start came while a pass ran, and was ignored.
    pub overrun: bool,
    /// One clock: the last of a pass; `valid` comes in the next, in which another pass may start. Law and settings change
    /// with it.
    pub ends: bool,
}

/// Number of input ports.
pub const INPUTS: usize = 12;
/// Number of output ports.
pub const OUTPUTS: usize = 14;

/// The ports of a controller in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    use Direction::{Input, Output};
    let port = |name: &str, direction, width, signed| Port {
        name: name.to_owned(),
        direction,
        width,
        signed,
    };
    vec![
        port("rst", Input, 1, false),
        port("start", Input, 1, false),
        port("law", Input, 2, false),
        port("modulo", Input, 1, false),
        port("position_reference", Input, 32, true),
        port("velocity_reference", Input, 32, true),
        port("acceleration_reference", Input, 32, true),
        port("position", Input, 32, true),
        port("velocity", Input, 32, true),
        port("setting", Input, 32, false),
        port("clear_integral", Input, 1, false),
        port("clear_flags", Input, 1, false),
        port("setting_address", Output, 4, false),
        port("error", Output, 32, true),
        port("sliding", Output, 32, true),
        port("command", Output, 32, true),
        port("duty", Output, 18, true),
        port("valid", Output, 1, false),
        port("busy", Output, 1, false),
        port("limited_high", Output, 1, false),
        port("limited_low", Output, 1, false),
        port("limited_ticks", Output, 16, false),
        port("saturated_high", Output, 7, false),
        port("saturated_low", Output, 7, false),
        port("overrun", Output, 1, false),
        port("ends", Output, 1, false),
    ]
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order; `None` unless there are [`INPUTS`].
    pub fn from_raw(raw: &[u64]) -> Option<Self> {
        let &[
            rst,
            start,
            law,
            modulo,
            position_reference,
            velocity_reference,
            acceleration_reference,
            position,
            velocity,
            setting,
            clear_integral,
            clear_flags,
        ] = raw
        else {
            return None;
        };
        Some(Self {
            rst: rst & 1 != 0,
            start: start & 1 != 0,
            law: law as u8 & 3,
            modulo: modulo & 1 != 0,
            motion: Motion {
                position_reference: position_reference as i32,
                velocity_reference: velocity_reference as i32,
                acceleration_reference: acceleration_reference as i32,
                position: position as i32,
                velocity: velocity as i32,
            },
            setting: setting as u32,
            clear_integral: clear_integral & 1 != 0,
            clear_flags: clear_flags & 1 != 0,
        })
    }

    /// As raw bit patterns, one per input port in port order, each cut to its port's width.
    pub fn to_raw(&self) -> [u64; INPUTS] {
        [
            u64::from(self.rst),
            u64::from(self.start),
            u64::from(self.law & 3),
            u64::from(self.modulo),
            u64::from(self.motion.position_reference as u32),
            u64::from(self.motion.velocity_reference as u32),
            u64::from(self.motion.acceleration_reference as u32),
            u64::from(self.motion.position as u32),
            u64::from(self.motion.velocity as u32),
            u64::from(self.setting),
            u64::from(self.clear_integral),
            u64::from(self.clear_flags),
        ]
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUTS] {
        [
            u64::from(self.setting_address),
            u64::from(self.error as u32),
            u64::from(self.sliding as u32),
            u64::from(self.command as u32),
            u64::from(self.duty as u32 & 0x3_ffff),
            u64::from(self.valid),
            u64::from(self.busy),
            u64::from(self.limited_high),
            u64::from(self.limited_low),
            u64::from(self.limited_ticks),
            u64::from(self.saturated_high),
            u64::from(self.saturated_low),
            u64::from(self.overrun),
            u64::from(self.ends),
        ]
    }
}
