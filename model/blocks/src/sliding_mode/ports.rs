//! The ports of the controller.

use crate::ports;

/// Control law that computes the command.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Law {
    /// Sliding mode: `c·de + k·s + ε·sat(s/φ)`.
    #[default]
    SlidingMode = 0,
    /// Proportional and derivative.
    Pd = 1,
    /// Proportional, integral and derivative.
    Pid = 2,
}

impl Law {
    /// The law for the port's two bits; 3 acts as PD.
    pub fn from_bits(bits: u8) -> Self {
        match bits & 3 {
            0 => Self::SlidingMode,
            2 => Self::Pid,
            _ => Self::Pd,
        }
    }
}

/// Reference and measurement of a tick, from the shaper and the pulse counter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TickMotion {
    /// Reference position r in Q24.8 counts.
    pub position_reference: i32,
    /// Reference velocity dr in Q16.16 counts/T.
    pub velocity_reference: i32,
    /// Reference acceleration ddr in Q8.24 counts/T².
    pub acceleration_reference: i32,
    /// Measured position in counts.
    pub position: i32,
    /// Measured velocity in Q16.16 counts/T.
    pub velocity: i32,
}

/// Values that can saturate: bits of `saturated_high` and `saturated_low`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saturation {
    /// Position error e.
    Error = 0,
    /// Rate of the error de.
    ErrorRate = 1,
    /// Sliding variable s.
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
    /// Bit of the value.
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

    /// Sets reference and measurement.
    pub fn set_motion(&mut self, motion: TickMotion) {
        self.position_reference = motion.position_reference;
        self.velocity_reference = motion.velocity_reference;
        self.acceleration_reference = motion.acceleration_reference;
        self.position = motion.position;
        self.velocity = motion.velocity;
    }
}

/// Inputs with this reference and measurement; all others are 0.
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
        /// One clock: computes a tick. Ignored during a computation.
        start: Bit as bool;
        /// Law: 0 sliding mode, 1 PD, 2 PID, 3 as 1; taken at `start`.
        law: Bits(2) as u8;
        /// Constant; high: a rotary axis, whose references wrap.
        modulo: Bit as bool;
        /// Reference position r; taken at `start`.
        position_reference: Signed(32) as i32, "counts, Q24.8";
        /// Reference velocity dr.
        velocity_reference: Signed(32) as i32, "counts per tick, Q16.16";
        /// Reference acceleration ddr.
        acceleration_reference: Signed(32) as i32, "counts per tick², Q8.24";
        /// Measured position x, changing at any time; taken at `start`.
        position: Signed(32) as i32, "counts";
        /// Measured velocity v.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// Setting at the `setting_address` of the clock before.
        setting: Bits(32) as u32;
        /// Clears Σe; wins over a sum being computed, from the first clock of step 14 to the end of step 15.
        clear_integral: Bit as bool;
        /// Clears `saturated_high`, `saturated_low`, `overrun`.
        clear_flags: Bit as bool;
    }

    /// The output ports, all of them registers but `setting_address` and `ends`, which follow from registers.
    outputs Outputs {
        /// Row of the settings, whose word is expected in the next clock.
        setting_address: Bits(4) as u8;
        /// Position error e: new in the clock after `start`.
        error: Signed(32) as i32, "counts, Q16.16";
        /// Sliding variable s, with every law.
        sliding: Signed(32) as i32, "counts per tick, Q16.16";
        /// The command, within ±limit.
        command: Signed(32) as i32, "command units, Q20.12";
        /// The command as high time of the PWM.
        duty: Signed(18) as i32, "clocks";
        /// One clock: all outputs belong to the last `start`.
        valid: Bit as bool;
        /// A computation is running.
        busy: Bit as bool;
        /// The last command was clamped at +limit.
        limited_high: Bit as bool;
        /// The last command was clamped at −limit.
        limited_low: Bit as bool;
        /// Time since which the command has been clamped; stops at 65,535. A supervisor can trip on it.
        limited_ticks: Bits(16) as u16, "ticks";
        /// Sticky: values that were clamped at their upper end: bit 0 e, 1 de, 2 s, 3 a, 4 Σe, 5 command, 6 duty. A
        /// flag is set one clock after its value, all of them by `valid`. Setting wins over clearing.
        saturated_high: Bits(7) as u8;
        /// Sticky: values that were clamped at their lower end; bits as in `saturated_high`.
        saturated_low: Bits(7) as u8;
        /// Sticky: a `start` came while `busy` and was ignored. Setting wins over clearing.
        overrun: Bit as bool;
        /// One clock: the last of a computation. `valid` is high in the next clock, in which another computation may
        /// start.
        ends: Bit as bool;
    }
}
