//! The ports of the excitation.

use crate::rtl::{PlainRow, Port, ports_of};

/// What the signal is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Kind {
    /// None; 0.
    #[default]
    None,
    /// A pseudo-random binary sequence, a bit per period; 1.
    Prbs,
    /// A triangle whose frequency rises; 2.
    Chirp,
    /// A square wave; 3.
    Square,
}

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: `y_0` to `y_2` are new.
    pub valid: bool,
    /// Shaped position, Q24.8 counts.
    pub y_0: i32,
    /// Shaped velocity, Q16.16 counts per tick.
    pub y_1: i32,
    /// Shaped acceleration, Q8.24 counts per tick².
    pub y_2: i32,
    /// A host wants the signal; after each signal it must have been low before the next.
    pub enable: bool,
    /// The axis can stand it; low: no signal from the next `valid` on.
    pub allowed: bool,
    /// What.
    pub kind: Kind,
    /// Q8.8 counts, 16 bits.
    pub amplitude: u16,
    /// Largest amplitude, Q8.8 counts.
    pub amplitude_limit: u16,
    /// Ticks of a PRBS bit, of a square's period, or of a chirp's first period.
    pub period_ticks: u16,
    /// Of a chirp: in every tick the frequency rises by so many 65,536ths of the first.
    pub sweep: u16,
    /// Ticks of the signal, 24 bits; 0: it never starts.
    pub duration_ticks: u32,
    /// The position is modulo 2^32 LSB; else it stays at the ends of its word.
    pub modulo: bool,
}

/// The output ports, all of them registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// `y_0` and the signal, Q24.8 counts.
    pub position_reference: i32,
    /// `y_1`.
    pub velocity_reference: i32,
    /// `y_2`.
    pub acceleration_reference: i32,
    /// One clock: the references are new.
    pub reference_valid: bool,
    /// The signal in `position_reference`, Q24.8 counts.
    pub excitation_value: i32,
    /// A signal runs.
    pub excitation_active: bool,
    /// One clock: it has ended by itself.
    pub excitation_done: bool,
}

/// Input ports in port order, with their widths.
const INPUTS: [PlainRow; 14] = [
    ("rst", 1, false),
    ("valid", 1, false),
    ("y_0", 32, true),
    ("y_1", 32, true),
    ("y_2", 32, true),
    ("enable", 1, false),
    ("allowed", 1, false),
    ("kind", 2, false),
    ("amplitude", 16, false),
    ("amplitude_limit", 16, false),
    ("period_ticks", 16, false),
    ("sweep", 16, false),
    ("duration_ticks", DURATION_BITS, false),
    ("modulo", 1, false),
];

/// Output ports in port order, with their widths.
const OUTPUTS: [PlainRow; 7] = [
    ("position_reference", 32, true),
    ("velocity_reference", 32, true),
    ("acceleration_reference", 32, true),
    ("reference_valid", 1, false),
    ("excitation_value", 32, true),
    ("excitation_active", 1, false),
    ("excitation_done", 1, false),
];

/// Width of `duration_ticks`.
pub const DURATION_BITS: u32 = 24;
/// Number of input ports, without `clk`.
pub const INPUT_PORTS: usize = INPUTS.len();
/// Number of output ports.
pub const OUTPUT_PORTS: usize = OUTPUTS.len();

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; INPUT_PORTS]) -> Self {
        let bit = |value: u64| value & 1 != 0;
        let [
            rst,
            valid,
            y_0,
            y_1,
            y_2,
            enable,
            allowed,
            kind,
            amplitude,
            amplitude_limit,
            period_ticks,
            sweep,
            duration_ticks,
            modulo,
        ] = *raw;
        Self {
            rst: bit(rst),
            valid: bit(valid),
            y_0: y_0 as i32,
            y_1: y_1 as i32,
            y_2: y_2 as i32,
            enable: bit(enable),
            allowed: bit(allowed),
            kind: match kind & 3 {
                1 => Kind::Prbs,
                2 => Kind::Chirp,
                3 => Kind::Square,
                _ => Kind::None,
            },
            amplitude: amplitude as u16,
            amplitude_limit: amplitude_limit as u16,
            period_ticks: period_ticks as u16,
            sweep: sweep as u16,
            duration_ticks: duration_ticks as u32 & ((1 << DURATION_BITS) - 1),
            modulo: bit(modulo),
        }
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        [
            u64::from(self.position_reference as u32),
            u64::from(self.velocity_reference as u32),
            u64::from(self.acceleration_reference as u32),
            u64::from(self.reference_valid),
            u64::from(self.excitation_value as u32),
            u64::from(self.excitation_active),
            u64::from(self.excitation_done),
        ]
    }
}

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    ports_of(&INPUTS, &OUTPUTS)
}
