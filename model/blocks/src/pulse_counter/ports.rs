//! The ports of the pulse counter.

use crate::ports;

/// Longest setting of the input filters, in clocks.
pub const FILTER_CLOCKS_MAX: u32 = 63;

impl Inputs {
    /// Pins and complements of A, B and Z.
    pub(super) fn pins(&self) -> [(bool, bool); 3] {
        [(self.a, self.a_n), (self.b, self.b_n), (self.z, self.z_n)]
    }

    /// Whether the filtered levels of A and B allow an index.
    pub(super) fn index_gate_open(&self, [a, b]: [bool; 2]) -> bool {
        let bit = |place: u32| self.index_gate >> place & 1 != 0;
        (!bit(0) || a == bit(1)) && (!bit(2) || b == bit(3))
    }
}

ports! {
    pulse_counter_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// Line A, or step, or up; asynchronous.
        a: Bit as bool;
        /// Line B, or direction (high is up), or down; asynchronous.
        b: Bit as bool;
        /// Index line; asynchronous.
        z: Bit as bool;
        /// Complement of A, used if `differential`.
        a_n: Bit as bool;
        /// Complement of B, used if `differential`.
        b_n: Bit as bool;
        /// Complement of Z, used if `differential`.
        z_n: Bit as bool;
        /// The lines are differential pairs.
        differential: Bit as bool;
        /// Longest pulse that is ignored.
        filter_clocks: Bits(6) as u8, "clocks";
        /// 0 quadrature ×4, 1 ×2, 2 ×1, 3 step and direction, 4 up and down, 5 to 7 nothing counts.
        mode: Bits(3) as u8;
        /// Exchanges A and B.
        swap: Bit as bool;
        /// Reverses the direction.
        invert: Bit as bool;
        /// One clock: latches the next index.
        index_arm: Bit as bool;
        /// Latches every index.
        index_always: Bit as bool;
        /// A latched index also presets the position.
        index_presets: Bit as bool;
        /// Bit 0: an index counts only while A equals bit 1; bit 2: only while B equals bit 3.
        index_gate: Bits(4) as u8;
        /// One clock: the position becomes `preset_value`, visible 2 clocks later; with 0 it is cleared.
        preset: Bit as bool;
        /// Position after a preset; read in the clock after `preset`.
        preset_value: Signed(32) as i32, "counts";
        /// Clears `illegal`, `illegal_count`, `disagreement`, `velocity_missed`.
        clear_flags: Bit as bool;
        /// One clock: the sample tick.
        tick: Bit as bool;
        /// Lowest 24 bits of the stage's clock counter.
        time_stamp: Bits(24) as u32, "clocks";
        /// Velocity by method M alone: counts per tick.
        velocity_m: Bit as bool;
        /// Exponent k of the one-pole filter with coefficient 2^−k, 0 to 3.
        smoothing: Bits(2) as u8;
        /// Time without an edge after which the velocity is 0, in units of 65,536 clocks.
        timeout: Bits(8) as u8;
        /// One clock: `quotient` is that of `steps` and `elapsed`.
        quotient_valid: Bit as bool;
        /// Quotient of the divider, Q16.16 counts per tick.
        quotient: Signed(32) as i32, "counts per tick, Q16.16";
    }

    /// The output ports. `position` is a difference of registers, all others are registers.
    outputs Outputs {
        /// Steps since reset, modulo 2^32; a preset does not change it.
        count: Signed(32) as i32, "counts";
        /// Count at which the position is 0.
        origin: Signed(32) as i32, "counts";
        /// Position, `count − origin`.
        position: Signed(32) as i32, "counts";
        /// Count at the last latched index.
        index_count: Signed(32) as i32, "counts";
        /// One clock, in which `index_count` is new: an index was latched.
        index_seen: Bit as bool;
        /// The next index will be latched.
        index_armed: Bit as bool;
        /// Number of transitions in which A and B changed together; stops at 255.
        illegal_count: Bits(8) as u8;
        /// Sticky: there was such a transition.
        illegal: Bit as bool;
        /// Sticky: the lines of a differential pair were equal for longer than the filter.
        disagreement: Bit as bool;
        /// Filtered level of A.
        level_a: Bit as bool;
        /// Filtered level of B.
        level_b: Bit as bool;
        /// Filtered level of Z.
        level_z: Bit as bool;
        /// Dividend for the divider.
        steps: Signed(18) as i32, "counts";
        /// Divisor for the divider; 0 stands for one tick.
        elapsed: Bits(24) as u32, "clocks";
        /// A tick waits for its quotient.
        velocity_pending: Bit as bool;
        /// Measured velocity.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// One clock: `velocity` is that of the last tick.
        velocity_valid: Bit as bool;
        /// Sticky: a tick came while another one waited for its quotient.
        velocity_missed: Bit as bool;
    }
}
