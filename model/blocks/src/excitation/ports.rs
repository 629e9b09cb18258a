//! The ports of the excitation.

use crate::ports;
use crate::ports::choices;

/// Kind of the signal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ExcitationKind {
    /// 0: no signal.
    #[default]
    None,
    /// 1: a pseudo-random binary sequence, one bit per period.
    Prbs,
    /// 2: a triangle whose frequency rises.
    Chirp,
    /// 3: a square wave.
    Square,
}

/// Width of `duration_ticks` in bits.
pub const DURATION_BITS: u32 = 24;

choices!(ExcitationKind: None, Prbs, Chirp, Square);

ports! {
    excitation_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: `y_0` to `y_2` are new.
        valid: Bit as bool;
        /// Shaped position, Q24.8 counts.
        y_0: Signed(32) as i32, "counts, Q24.8";
        /// Shaped velocity, Q16.16 counts per tick.
        y_1: Signed(32) as i32, "counts per tick, Q16.16";
        /// Shaped acceleration, Q8.24 counts per tick².
        y_2: Signed(32) as i32, "counts per tick², Q8.24";
        /// The host requests the signal.
        enable: Bit as bool;
        /// The axis is in HOLD or RUN, and nothing is wrong.
        allowed: Bit as bool;
        /// Kind of the signal: 0 none, 1 PRBS, 2 chirp (a triangle), 3 square.
        kind: Bits(2) as ExcitationKind;
        /// Amplitude in Q8.8 counts: 0 to 255.996.
        amplitude: Bits(16) as u16, "counts, Q8.8";
        /// Constant from the machine file: largest amplitude in Q8.8 counts.
        amplitude_limit: Bits(16) as u16, "counts, Q8.8";
        /// Ticks of a PRBS bit, of a square's period, or of a chirp's first period.
        period_ticks: Bits(16) as u16, "ticks";
        /// Rise of a chirp's frequency in every tick, in 65,536ths of the first.
        sweep: Bits(16) as u16;
        /// Duration of the signal; with 0 it never starts.
        duration_ticks: Bits(24) as u32, "ticks";
        /// Constant; high: the position wraps modulo 2^32 LSB (a rotary axis).
        modulo: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// `y_0` plus the signal, Q24.8 counts.
        position_reference: Signed(32) as i32, "counts, Q24.8";
        /// `y_1`, in the clock of `position_reference`.
        velocity_reference: Signed(32) as i32, "counts per tick, Q16.16";
        /// `y_2`, in the clock of `position_reference`.
        acceleration_reference: Signed(32) as i32, "counts per tick², Q8.24";
        /// One clock: the references are new.
        reference_valid: Bit as bool;
        /// The signal that is contained in `position_reference`, Q24.8 counts; for the trace.
        excitation_value: Signed(32) as i32, "counts, Q24.8";
        /// A signal is running.
        excitation_active: Bit as bool;
        /// One clock: the signal has ended by itself.
        excitation_done: Bit as bool;
    }
}
