//! The internal encoder: it generates quadrature at a set rate, which can replace the pins in front of the pulse
//! counter.
//!
//! The datasheet is `docs/encoder_generator.md`; the hardware is compared with this reference model.
//!
//! - Every clock `sum += rate`, 64 bits modulo 2^64; `generated_count` is the upper half, the floor of the exact sum.
//!   The width of `rate` limits it to less than half a count per clock, so that counts in one direction are at least
//!   two clocks apart.
//! - A and B show the count in Gray code; A leads B when it goes up. They change at most in every other clock,
//!   whatever the rate does: a count that comes and goes within a clock is not shown.
//! - Z is high for one count in every `index_every`, rounded down to a multiple of four: where A and B are both low.
//! - With `loop_back` the outputs show these lines, else the pins. Every output is registered after this choice.
//!
//! ```text
//! clock             0   1   2   3        a count passes in clock 0
//! generated_count  < n ><n+1>------
//! lines            ----< n ><n+1>--      inside
//! a, b, z          --------< n ><n+1>    and a pin of clock n shows in clock n + 1
//! ```
//!
//! ```
//! use posicast_blocks::encoder_generator::{EncoderGenerator, Inputs};
//!
//! // A sixteenth of a count per clock, for 160 clocks.
//! let mut generator = EncoderGenerator::new();
//! let inputs = Inputs { loop_back: true, rate: 1 << 28, ..Inputs::default() };
//! (0..160).for_each(|_| { generator.step(&inputs); });
//! assert_eq!(generator.outputs().generated_count, 10);
//! ```

use super::{Moore, clocked_block, ports, quiet_at_rest, show_each};

/// Fraction bits of `rate`.
pub const RATE_FRACTION: u32 = 32;
/// Counts in a period of A and B; the distance of two indexes is a multiple of it.
pub const PERIOD_COUNTS: u16 = 4;
/// Clocks from a pin to its output.
pub const LATENCY_CLOCKS: u32 = 1;

/// Number of lines: A, B, Z and their complements.
pub const LINES: usize = 6;

ports! {
    encoder_generator_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// High: the outputs show the generator's lines. Low: they show the pins.
        loop_back: Bit as bool;
        /// Rate in counts per clock; its sign is the direction.
        rate: Signed(32) as i32, "counts per clock, Q0.32";
        /// Counts from index to index, rounded down to a multiple of 4; 0 to 3: no index.
        index_every: Bits(16) as u16, "counts";
        /// Pin A, asynchronous.
        pin_a: Bit as bool;
        /// Pin B, asynchronous.
        pin_b: Bit as bool;
        /// Pin Z, asynchronous.
        pin_z: Bit as bool;
        /// Complement of pin A for differential lines, asynchronous.
        pin_a_n: Bit as bool;
        /// Complement of pin B for differential lines, asynchronous.
        pin_b_n: Bit as bool;
        /// Complement of pin Z for differential lines, asynchronous.
        pin_z_n: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// Line A, for the pulse counter.
        a: Bit as bool;
        /// Line B, for the pulse counter.
        b: Bit as bool;
        /// Line Z, for the pulse counter.
        z: Bit as bool;
        /// Complement of A, which the generator always provides.
        a_n: Bit as bool;
        /// Complement of B, which the generator always provides.
        b_n: Bit as bool;
        /// Complement of Z, which the generator always provides.
        z_n: Bit as bool;
        /// Generated counts since the reset, modulo 2^32.
        generated_count: Signed(32) as i32, "counts";
    }
}

impl Inputs {
    /// The pins A, B, Z and their complements.
    fn pins(&self) -> [bool; LINES] {
        [
            self.pin_a,
            self.pin_b,
            self.pin_z,
            self.pin_a_n,
            self.pin_b_n,
            self.pin_z_n,
        ]
    }

    /// The inputs with other pins: A, B, Z and their complements.
    pub fn with_pins(self, [pin_a, pin_b, pin_z, pin_a_n, pin_b_n, pin_z_n]: [bool; LINES]) -> Self {
        Self {
            pin_a,
            pin_b,
            pin_z,
            pin_a_n,
            pin_b_n,
            pin_z_n,
            ..self
        }
    }
}

impl Outputs {
    /// A, B, Z and their complements.
    pub fn lines(&self) -> [bool; LINES] {
        [self.a, self.b, self.z, self.a_n, self.b_n, self.z_n]
    }
}

/// Registers of the generated lines.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Encoder {
    /// Counts, Q32.32, modulo 2^64.
    sum: i64,
    /// Number of periods of A and B since the index.
    period: u16,
    /// Levels of A, B and Z.
    lines: [bool; 3],
    /// Whether A or B has just changed; they then stay for a clock.
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

/// The cycle-accurate model of the internal encoder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EncoderGenerator {
    encoder: Encoder,
    /// Pins or lines of the clock before. A reset does not clear these registers.
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
            encoder: Encoder::default(),
            shown: [false; LINES],
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let [a, b, z, a_n, b_n, z_n] = self.shown;
        let generated_count = self.encoder.count();
        Outputs {
            a,
            b,
            z,
            a_n,
            b_n,
            z_n,
            generated_count,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        let before = if inputs.rst { Encoder::default() } else { self.encoder };
        let [a, b, z] = before.lines;
        self.shown = if inputs.loop_back {
            [a, b, z, !a, !b, !z]
        } else {
            inputs.pins()
        };
        if inputs.rst {
            self.encoder = Encoder::default();
        } else {
            self.encoder.clock(inputs.rate, inputs.index_every);
        }
        outputs
    }
}

clocked_block!(EncoderGenerator, "the internal encoder");

impl Moore for EncoderGenerator {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            EncoderGenerator::step(next, &Inputs::from_raw(raw));
        })
    }
}
