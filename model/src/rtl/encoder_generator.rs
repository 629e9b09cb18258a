//! The internal encoder: quadrature at a set rate, which can take the place of the pins in front of the pulse counter.
//!
//! The datasheet is `docs/encoder_generator.md`; this is the reference that the hardware is compared with.
//!
//! - Every clock `sum += rate`, 64 bits modulo 2^64; `generated_count` is the upper half: the floor of the exact sum. The
//!   range of `rate` is its limit: less than half a count per clock, so that counts in one direction are at least two clocks
//!   apart.
//! - A and B show the count in Gray code, A leads B when it goes up. They change at most in every other clock, whatever the
//!   rate does: a count that comes and goes within a clock is not shown.
//! - Z is high for one count in every `index_every`, taken down to a multiple of four: where A and B are both low.
//! - With `loop_back` the outputs show these lines, else the pins; every output is a register behind the choice.
//!
//! ```text
//! clock             0   1   2   3        a count passes in clock 0
//! generated_count  < n ><n+1>------
//! lines            ----< n ><n+1>--      inside
//! a, b, z          --------< n ><n+1>    and a pin of clock n shows in clock n + 1
//! ```
//!
//! ```
//! use posicast_model::rtl::encoder_generator::{EncoderGenerator, Inputs};
//!
//! // A sixteenth of a count per clock, for 160 clocks.
//! let mut generator = EncoderGenerator::new();
//! let inputs = Inputs { loop_back: true, rate: 1 << 28, ..Inputs::default() };
//! (0..160).for_each(|_| { generator.step(&inputs); });
//! assert_eq!(generator.outputs().generated_count, 10);
//! ```

use std::sync::Arc;

use super::{ClockedBlock, Moore, PlainRow, Port, StepError, ports_of, quiet_at_rest};

/// Fraction bits of `rate`.
pub const RATE_FRACTION: u32 = 32;
/// Counts of a period of A and B: an index has a multiple of these.
pub const PERIOD_COUNTS: u16 = 4;
/// Clocks from a pin to its output.
pub const LATENCY_CLOCKS: u32 = 1;

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// The outputs are the generator's lines, else the pins.
    pub loop_back: bool,
    /// Counts per clock, Q0.32; the sign is the direction.
    pub rate: i32,
    /// Counts from index to index, taken down to a multiple of 4; below 4: none.
    pub index_every: u16,
    /// The pins A, B, Z and their complements, at any time.
    pub pins: [bool; LINES],
}

/// A, B, Z and their complements.
pub const LINES: usize = 6;

/// The output ports, all of them registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// A, B, Z and their complements, for the pulse counter.
    pub lines: [bool; LINES],
    /// Counts ×4 since the reset, modulo 2^32.
    pub generated_count: i32,
}

/// Input ports in port order, with their widths.
const INPUTS: [PlainRow; 10] = [
    ("rst", 1, false),
    ("loop_back", 1, false),
    ("rate", 32, true),
    ("index_every", 16, false),
    ("pin_a", 1, false),
    ("pin_b", 1, false),
    ("pin_z", 1, false),
    ("pin_a_n", 1, false),
    ("pin_b_n", 1, false),
    ("pin_z_n", 1, false),
];

/// Output ports in port order, with their widths.
const OUTPUTS: [PlainRow; 7] = [
    ("a", 1, false),
    ("b", 1, false),
    ("z", 1, false),
    ("a_n", 1, false),
    ("b_n", 1, false),
    ("z_n", 1, false),
    ("generated_count", 32, true),
];

/// Number of input ports, without `clk`.
pub const INPUT_PORTS: usize = INPUTS.len();
/// Number of output ports.
pub const OUTPUT_PORTS: usize = OUTPUTS.len();

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    ports_of(&INPUTS, &OUTPUTS)
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; INPUT_PORTS]) -> Self {
        let [rst, loop_back, rate, index_every, pins @ ..] = *raw;
        Self {
            rst: rst & 1 != 0,
            loop_back: loop_back & 1 != 0,
            rate: rate as i32,
            index_every: index_every as u16,
            pins: pins.map(|pin| pin & 1 != 0),
        }
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        let [a, b, z, a_n, b_n, z_n] = self.lines.map(u64::from);
        [a, b, z, a_n, b_n, z_n, u64::from(self.generated_count as u32)]
    }
}

/// The encoder's registers behind the outputs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Encoder {
    /// Counts, Q32.32, modulo 2^64.
    sum: i64,
    /// Periods of A and B since the index.
    period: u16,
    /// A, B, Z as they are shown.
    lines: [bool; 3],
    /// A or B have just changed: they stay for a clock.
    moved: bool,
}

impl Encoder {
    fn count(&self) -> i32 {
        (self.sum >> RATE_FRACTION) as i32
    }

    fn clock(&mut self, rate: i32, index_every: u16) {
        let index_periods = index_every / PERIOD_COUNTS;
        let quarter = self.count() & 3;
        let lines = [
            quarter == 1 || quarter == 2,
            quarter >= 2,
            quarter == 0 && self.period == 0 && index_periods > 0,
        ];
        let moves = !self.moved && lines[..2] != self.lines[..2];
        if !self.moved {
            self.lines = lines;
        }
        self.moved = moves;

        self.sum = self.sum.wrapping_add(i64::from(rate));
        let down = rate < 0;
        let next_period = match (quarter, self.count() & 3, down) {
            (3, 0, false) => self.period + 1,
            (0, 3, true) if self.period == 0 => index_periods.wrapping_sub(1),
            (0, 3, true) => self.period - 1,
            _ => self.period,
        };
        self.period = if next_period < index_periods { next_period } else { 0 };
    }
}

/// The internal encoder, cycle accurate at its ports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EncoderGenerator {
    ports: Arc<[Port]>,
    encoder: Encoder,
    /// Pins or lines of the clock before: the only registers that a reset does not clear.
    shown: [bool; LINES],
}

impl Default for EncoderGenerator {
    fn default() -> Self {
        Self::new()
    }
}

impl EncoderGenerator {
    /// A generator after power-up.
    pub fn new() -> Self {
        Self {
            ports: ports().into(),
            encoder: Encoder::default(),
            shown: [false; LINES],
        }
    }

    /// What the outputs show now.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            lines: self.shown,
            generated_count: self.encoder.count(),
        }
    }

    /// One clock: what the outputs show before the rising edge, then the edge.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        let before = if inputs.rst { Encoder::default() } else { self.encoder };
        let [a, b, z] = before.lines;
        self.shown = if inputs.loop_back {
            [a, b, z, !a, !b, !z]
        } else {
            inputs.pins
        };
        if inputs.rst {
            self.encoder = Encoder::default();
        } else {
            self.encoder.clock(inputs.rate, inputs.index_every);
        }
        outputs
    }
}

impl ClockedBlock for EncoderGenerator {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (Ok(raw), OUTPUT_PORTS) = (<&[u64; INPUT_PORTS]>::try_from(inputs), outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the internal encoder has {INPUT_PORTS} and {OUTPUT_PORTS}",
                inputs.len(),
                outputs.len()
            )));
        };
        let shown = EncoderGenerator::step(self, &Inputs::from_raw(raw));
        outputs.copy_from_slice(&shown.to_raw());
        Ok(())
    }
}

impl Moore for EncoderGenerator {
    fn show(&self, outputs: &mut [u64]) {
        for (output, value) in outputs.iter_mut().zip(self.outputs().to_raw()) {
            *output = value;
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        match <&[u64; INPUT_PORTS]>::try_from(inputs) {
            Ok(raw) => quiet_at_rest(self, |next| {
                EncoderGenerator::step(next, &Inputs::from_raw(raw));
            }),
            Err(_) => 0,
        }
    }
}
