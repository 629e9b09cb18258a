//! The ports of the controller.

use crate::rtl::ports;

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
pub struct TickMotion {
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

impl Inputs {
    /// Reference and measurement.
    #[inline]
    pub fn motion(&self) -> TickMotion {
        TickMotion {
            position_reference: self.position_reference,
            velocity_reference: self.velocity_reference,
            acceleration_reference: self.acceleration_reference,
            position: self.position,
            velocity: self.velocity,
        }
    }

    /// Another reference and measurement.
    pub fn set_motion(&mut self, motion: TickMotion) {
        self.position_reference = motion.position_reference;
        self.velocity_reference = motion.velocity_reference;
        self.acceleration_reference = motion.acceleration_reference;
        self.position = motion.position;
        self.velocity = motion.velocity;
    }
}

/// Reference and measurement; everything else is 0.
impl From<TickMotion> for Inputs {
    fn from(motion: TickMotion) -> Self {
        let mut inputs = Self::default();
        inputs.set_motion(motion);
        inputs
    }
}

ports! {
    sliding_mode_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: a tick. Ignored while a pass runs.
        start: Bit as bool;
        /// 0 sliding mode, 1 PD, 2 PID, 3 as 1; taken at `start`.
        law: Bits(2) as u8;
        /// Tied: a rotary axis, whose references wrap.
        modulo: Bit as bool;
        /// Reference r of the position; taken at `start`.
        position_reference: Signed(32) as i32, "counts, Q24.8";
        /// Reference dr of the velocity.
        velocity_reference: Signed(32) as i32, "counts per tick, Q16.16";
        /// Reference ddr of the acceleration.
        acceleration_reference: Signed(32) as i32, "counts per tick², Q8.24";
        /// Measured position x, live; taken at `start`.
        position: Signed(32) as i32, "counts";
        /// Measured velocity v.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// The word at the `setting_address` of the clock before.
        setting: Bits(32) as u32;
        /// Clears Σe; wins over a sum under way, from the first clock of step 14 to the end of step 15.
        clear_integral: Bit as bool;
        /// Clears `saturated_high`, `saturated_low`, `overrun`.
        clear_flags: Bit as bool;
    }

    /// The output ports, all of them registers but `setting_address` and `ends`, which follow from registers.
    outputs Outputs {
        /// Row of the settings: its word is expected in the next clock.
        setting_address: Bits(4) as u8;
        /// e: new in the clock after `start`.
        error: Signed(32) as i32, "counts, Q16.16";
        /// s, with every law.
        sliding: Signed(32) as i32, "counts per tick, Q16.16";
        /// The command, within ±limit.
        command: Signed(32) as i32, "command units, Q20.12";
        /// The command as clocks of the PWM period.
        duty: Signed(18) as i32, "clocks";
        /// One clock: all outputs are of the last `start`.
        valid: Bit as bool;
        /// A pass runs.
        busy: Bit as bool;
        /// The last command was cut at +limit.
        limited_high: Bit as bool;
        /// The last command was cut at −limit.
        limited_low: Bit as bool;
        /// For so many ticks in a row commands were cut; stops at 65,535. For a trip.
        limited_ticks: Bits(16) as u16, "ticks";
        /// Sticky: what was cut at its upper end: bit 0 e, 1 de, 2 s, 3 a, 4 Σe, 5 command, 6 duty. A clock after the
        /// word that was cut, all by `valid`. Set wins over clear.
        saturated_high: Bits(7) as u8;
        /// Sticky: what was cut at its lower end; bits as in `saturated_high`.
        saturated_low: Bits(7) as u8;
        /// Sticky: a `start` came while `busy`, and was ignored. Set wins over clear.
        overrun: Bit as bool;
        /// One clock: the last of a pass. `valid` is high in the next, in which another pass may start.
        ends: Bit as bool;
    }
}
