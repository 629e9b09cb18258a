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

use super::{Moore, clocked_block, ports, quiet_at_rest};

/// Fraction bits of `rate`.
pub const RATE_FRACTION: u32 = 32;
/// Counts of a period of A and B: an index has a multiple of these.
pub const PERIOD_COUNTS: u16 = 4;
/// Clocks from a pin to its output.
pub const LATENCY_CLOCKS: u32 = 1;

/// A, B, Z and their complements.
pub const LINES: usize = 6;

ports! {
    encoder_generator_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// The outputs are the generator's lines, else the pins.
        loop_back: Bit as bool;
        /// Counts per clock; the sign is the direction.
        rate: Signed(32) as i32, "counts per clock, Q0.32";
        /// Counts from index to index, taken down to a multiple of 4; 0 to 3: none.
        index_every: Bits(16) as u16, "counts";
        /// Pin A, at any time.
        pin_a: Bit as bool;
        /// Pin B, at any time.
        pin_b: Bit as bool;
        /// Pin Z, at any time.
        pin_z: Bit as bool;
        /// Complement of pin A, where lines are pairs; at any time.
        pin_a_n: Bit as bool;
        /// Complement of pin B, where lines are pairs; at any time.
        pin_b_n: Bit as bool;
        /// Complement of pin Z, where lines are pairs; at any time.
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
        /// Complement of A; the generator always has pairs.
        a_n: Bit as bool;
        /// Complement of B; the generator always has pairs.
        b_n: Bit as bool;
        /// Complement of Z; the generator always has pairs.
        z_n: Bit as bool;
        /// Counts ×4 since the reset, modulo 2^32.
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

    /// These inputs with other pins: A, B, Z and their complements.
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
            encoder: Encoder::default(),
            shown: [false; LINES],
        }
    }

    /// What the outputs show now.
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

    /// One clock: what the outputs show before the rising edge, then the edge.
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
