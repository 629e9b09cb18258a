//! The ports of the pulse counter.

use crate::rtl::{Direction, Port};

/// Longest setting of the input filters, in clocks.
pub const FILTER_CLOCKS_MAX: u32 = 63;

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// Line A, or step, or up; any time.
    pub a: bool,
    /// Line B, or direction (high is up), or down; any time.
    pub b: bool,
    /// Index line; any time.
    pub z: bool,
    /// Complement of A, used if `differential`.
    pub a_n: bool,
    /// Complement of B, used if `differential`.
    pub b_n: bool,
    /// Complement of Z, used if `differential`.
    pub z_n: bool,
    /// The lines are pairs.
    pub differential: bool,
    /// Pulses of up to so many clocks are ignored, 6 bits: at most [`FILTER_CLOCKS_MAX`].
    pub filter_clocks: u8,
    /// 0 quadrature ×4, 1 ×2, 2 ×1, 3 step and direction, 4 up and down, else none; 3 bits.
    pub mode: u8,
    /// Exchanges A and B.
    pub swap: bool,
    /// Reverses the direction.
    pub invert: bool,
    /// One clock: latch the next index.
    pub index_arm: bool,
    /// Latch every index.
    pub index_always: bool,
    /// A latched index also presets.
    pub index_presets: bool,
    /// Bit 0: only while A is as bit 1; bit 2: only while B is as bit 3.
    pub index_gate: u8,
    /// One clock: the position becomes `preset_value`; 0 clears it.
    pub preset: bool,
    /// What a preset makes of the position.
    pub preset_value: i32,
    /// Clears `illegal`, `illegal_count`, `disagreement`, `velocity_missed`.
    pub clear_flags: bool,
    /// One clock: the sample tick.
    pub tick: bool,
    /// The stage's clock counter, lowest 24 bits.
    pub time_stamp: u32,
    /// Velocity by M alone: counts per tick.
    pub velocity_m: bool,
    /// k of the one-pole filter with coefficient 2^−k, 0 to 3.
    pub smoothing: u8,
    /// Without an edge for so many times 65,536 clocks, the velocity is 0.
    pub timeout: u8,
    /// One clock: `quotient` is that of `steps` and `elapsed`.
    pub quotient_valid: bool,
    /// From the divider, Q16.16 counts per tick.
    pub quotient: i32,
}

/// The output ports. `position` is a difference of registers, all others are registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Steps since reset, modulo 2^32; never jumps.
    pub count: i32,
    /// The count at which the position is 0.
    pub origin: i32,
    /// `count − origin`.
    pub position: i32,
    /// The count at the index.
    pub index_count: i32,
    /// One clock: an index was latched; `index_count` is new.
    pub index_seen: bool,
    /// The next index will be latched.
    pub index_armed: bool,
    /// Transitions in which A and B changed together; stops at 255.
    pub illegal_count: u8,
    /// Sticky: there was one.
    pub illegal: bool,
    /// Sticky: a pair was equal for longer than the filter.
    pub disagreement: bool,
    /// Filtered A.
    pub level_a: bool,
    /// Filtered B.
    pub level_b: bool,
    /// Filtered Z.
    pub level_z: bool,
    /// For the divider: counts.
    pub steps: i32,
    /// For the divider: clocks; 0 is one tick.
    pub elapsed: u32,
    /// A tick waits for its quotient.
    pub velocity_pending: bool,
    /// Q16.16 counts per tick.
    pub velocity: i32,
    /// One clock: `velocity` is that of the last tick.
    pub velocity_valid: bool,
    /// Sticky: a tick came while one waited.
    pub velocity_missed: bool,
}

/// The ports of a pulse counter in the order of the Verilog's port list, without `clk`.
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
        port("a", Input, 1, false),
        port("b", Input, 1, false),
        port("z", Input, 1, false),
        port("a_n", Input, 1, false),
        port("b_n", Input, 1, false),
        port("z_n", Input, 1, false),
        port("differential", Input, 1, false),
        port("filter_clocks", Input, 6, false),
        port("mode", Input, 3, false),
        port("swap", Input, 1, false),
        port("invert", Input, 1, false),
        port("index_arm", Input, 1, false),
        port("index_always", Input, 1, false),
        port("index_presets", Input, 1, false),
        port("index_gate", Input, 4, false),
        port("preset", Input, 1, false),
        port("preset_value", Input, 32, true),
        port("clear_flags", Input, 1, false),
        port("tick", Input, 1, false),
        port("time_stamp", Input, 24, false),
        port("velocity_m", Input, 1, false),
        port("smoothing", Input, 2, false),
        port("timeout", Input, 8, false),
        port("quotient_valid", Input, 1, false),
        port("quotient", Input, 32, true),
        port("count", Output, 32, true),
        port("origin", Output, 32, true),
        port("position", Output, 32, true),
        port("index_count", Output, 32, true),
        port("index_seen", Output, 1, false),
        port("index_armed", Output, 1, false),
        port("illegal_count", Output, 8, false),
        port("illegal", Output, 1, false),
        port("disagreement", Output, 1, false),
        port("level_a", Output, 1, false),
        port("level_b", Output, 1, false),
        port("level_z", Output, 1, false),
        port("steps", Output, 18, true),
        port("elapsed", Output, 24, false),
        port("velocity_pending", Output, 1, false),
        port("velocity", Output, 32, true),
        port("velocity_valid", Output, 1, false),
        port("velocity_missed", Output, 1, false),
    ]
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order; `None` unless there are 26.
    pub fn from_raw(raw: &[u64]) -> Option<Self> {
        let &[
            rst,
            a,
            b,
            z,
            a_n,
            b_n,
            z_n,
            differential,
            filter_clocks,
            mode,
            swap,
            invert,
            index_arm,
            index_always,
            index_presets,
            index_gate,
            preset,
            preset_value,
            clear_flags,
            tick,
            time_stamp,
            velocity_m,
            smoothing,
            timeout,
            quotient_valid,
            quotient,
        ] = raw
        else {
            return None;
        };
        Some(Self {
            rst: rst & 1 != 0,
            a: a & 1 != 0,
            b: b & 1 != 0,
            z: z & 1 != 0,
            a_n: a_n & 1 != 0,
            b_n: b_n & 1 != 0,
            z_n: z_n & 1 != 0,
            differential: differential & 1 != 0,
            filter_clocks: filter_clocks as u8,
            mode: mode as u8,
            swap: swap & 1 != 0,
            invert: invert & 1 != 0,
            index_arm: index_arm & 1 != 0,
            index_always: index_always & 1 != 0,
            index_presets: index_presets & 1 != 0,
            index_gate: index_gate as u8,
            preset: preset & 1 != 0,
            preset_value: preset_value as i32,
            clear_flags: clear_flags & 1 != 0,
            tick: tick & 1 != 0,
            time_stamp: time_stamp as u32,
            velocity_m: velocity_m & 1 != 0,
            smoothing: smoothing as u8,
            timeout: timeout as u8,
            quotient_valid: quotient_valid & 1 != 0,
            quotient: quotient as i32,
        })
    }

    /// As raw bit patterns, one per input port in port order, each cut to its port's width.
    pub fn to_raw(&self) -> [u64; 26] {
        [
            u64::from(self.rst),
            u64::from(self.a),
            u64::from(self.b),
            u64::from(self.z),
            u64::from(self.a_n),
            u64::from(self.b_n),
            u64::from(self.z_n),
            u64::from(self.differential),
            self.filter_clocks as u64 & 0x3f,
            self.mode as u64 & 0x7,
            u64::from(self.swap),
            u64::from(self.invert),
            u64::from(self.index_arm),
            u64::from(self.index_always),
            u64::from(self.index_presets),
            self.index_gate as u64 & 0xf,
            u64::from(self.preset),
            self.preset_value as u64 & 0xffff_ffff,
            u64::from(self.clear_flags),
            u64::from(self.tick),
            self.time_stamp as u64 & 0xff_ffff,
            u64::from(self.velocity_m),
            self.smoothing as u64 & 0x3,
            self.timeout as u64 & 0xff,
            u64::from(self.quotient_valid),
            self.quotient as u64 & 0xffff_ffff,
        ]
    }

    /// Pin and complement of A, B and Z.
    pub(super) fn pins(&self) -> [(bool, bool); 3] {
        [(self.a, self.a_n), (self.b, self.b_n), (self.z, self.z_n)]
    }

    /// Whether the filtered levels of A and B let an index through.
    pub(super) fn index_gate_open(&self, [a, b]: [bool; 2]) -> bool {
        let bit = |place: u32| self.index_gate >> place & 1 != 0;
        (!bit(0) || a == bit(1)) && (!bit(2) || b == bit(3))
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; 18] {
        [
            self.count as u64 & 0xffff_ffff,
            self.origin as u64 & 0xffff_ffff,
            self.position as u64 & 0xffff_ffff,
            self.index_count as u64 & 0xffff_ffff,
            u64::from(self.index_seen),
            u64::from(self.index_armed),
            u64::from(self.illegal_count),
            u64::from(self.illegal),
            u64::from(self.disagreement),
            u64::from(self.level_a),
            u64::from(self.level_b),
            u64::from(self.level_z),
            self.steps as u64 & 0x3_ffff,
            u64::from(self.elapsed),
            u64::from(self.velocity_pending),
            self.velocity as u64 & 0xffff_ffff,
            u64::from(self.velocity_valid),
            u64::from(self.velocity_missed),
        ]
    }
}
