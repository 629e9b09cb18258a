//! The absolute encoder: a reading of an SSI or BiSS-C encoder at every tick, as a count that is extended beyond its range.
//!
//! The datasheet is `docs/absolute_encoder.md`; the hardware is compared with this reference model.
//!
//! - A tick begins a reading: the block clocks the encoder, and takes a bit per period. The position belongs to the edge that
//!   holds it, a fixed number of clocks after the tick ([`AbsoluteEncoderConfig::latch_clocks`]).
//! - SSI takes a bit just before the next rising edge. BiSS-C counts the periods from the edge of the answer: so the delay of
//!   the line is compensated, whatever it is.
//! - A reading is good if its check holds, its error bit is off, and its position is near enough to the last good one. The
//!   difference to that, modulo the range, moves the count.
//! - A reading that fails continues the count with the last change of a single reading. If more of them fail in a row than the
//!   build tolerates, the axis is `lost`: the count stands until `clear_flags` and a good reading.
//!
//! ```text
//! tick       _/‾\___________________________________________________________
//! clock_out  ‾‾‾‾\___/‾‾‾\___/‾‾‾\___/‾‾‾ ⋯ ‾\___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾   SSI
//! data       ‾‾‾‾‾‾‾‾‾‾< n − 1 >< n − 2 > ⋯ >< 0 >____________/‾‾‾‾‾‾‾‾‾‾‾‾
//! taken                        ↑       ↑         ↑ low                ready
//! valid      _______________________________________/‾\_____________________
//! ```
//!
//! ```
//! use posicast_blocks::absolute_encoder::{
//!     AbsoluteEncoder, AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, Inputs,
//! };
//!
//! let times = AbsoluteTimes { half_period_clocks: 4, pause_clocks: 50, answer_clocks: 0 };
//! let limits = AbsoluteLimits { largest_jump: 20, tolerated: 2 };
//! let config = AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, AbsoluteFrame::ssi(12), times, limits)?;
//! let mut block = AbsoluteEncoder::new(&config);
//! // An encoder at 1234: a bit follows each rising edge, and the line is high while the clock rests.
//! let (mut before, mut bit, mut data) = (true, 0, true);
//! for clock in 0..config.least_tick_clocks() + 4 {
//!     let shown = block.step(&Inputs { tick: clock == 4, data, ..Inputs::default() });
//!     if shown.clock_out && !before {
//!         data = bit < 12 && 1234 >> (11 - bit) & 1 == 1;
//!         bit += 1;
//!     }
//!     before = shown.clock_out;
//! }
//! assert_eq!((block.outputs().count, block.outputs().known), (1234, true));
//! # Ok::<(), posicast_blocks::absolute_encoder::AbsoluteEncoderConfigError>(())
//! ```

mod config;
mod frame;
mod line;
mod ports;
mod word;

pub use config::{
    AbsoluteEncoderConfig, AbsoluteEncoderConfigError, AbsoluteLimits, AbsoluteTimes, AbsoluteTimesInSeconds,
    HALF_PERIOD_CLOCKS, LEAST_ANSWER_HALVES, MOST_ANSWER_CLOCKS, MOST_BISS_HZ, MOST_SSI_HZ, MOST_TOLERATED,
    PAUSE_CLOCKS,
};
pub use frame::{AbsoluteFrame, AbsoluteProtocol, FrameCheck, FrameStatusBit, MOST_OTHER_BITS, POSITION_BITS};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};

use self::line::{EncoderLine, LineState};
use self::word::FrameWord;
use super::{FOREVER, Moore, clocked_block, show_each};

/// Clocks from the end of a reading to `valid`: difference, limit, count.
pub const JUDGE_CLOCKS: u64 = 3;

/// Bits of the sum whose low 32 bits are the count.
const SUM_BITS: u32 = 40;

/// The sticky flags but `lost`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Flags {
    check_failed: bool,
    silent: bool,
    stuck: bool,
    error_bit: bool,
    warning_bit: bool,
    jumped: bool,
    overrun: bool,
}

/// A reading on its way to the count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Judged {
    /// The difference is there; then, whether the reading is good.
    differs: bool,
    decides: bool,
    /// Line, check or error bit say that the reading failed.
    failed: bool,
    /// To the last good position, modulo the range.
    difference: i64,
    good: bool,
}

/// The cycle-accurate model of the absolute encoder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AbsoluteEncoder {
    config: AbsoluteEncoderConfig,
    line: EncoderLine,
    word: FrameWord,
    judged: Judged,
    /// The last good position, extended modulo 2^40.
    position: u64,
    count: i32,
    /// Last change of a single reading.
    change: i32,
    /// Failed readings in a row, and the largest difference after them.
    missed: u64,
    allowed: u64,
    known: bool,
    valid: bool,
    extrapolated: bool,
    lost: bool,
    flags: Flags,
}

impl AbsoluteEncoder {
    /// An absolute encoder after reset.
    pub fn new(config: &AbsoluteEncoderConfig) -> Self {
        Self {
            config: *config,
            line: EncoderLine::new(),
            word: FrameWord::default(),
            judged: Judged::default(),
            position: 0,
            count: 0,
            change: 0,
            missed: 0,
            allowed: config.limits().largest_jump,
            known: false,
            valid: false,
            extrapolated: false,
            lost: false,
            flags: Flags::default(),
        }
    }

    fn is_busy(&self) -> bool {
        self.line.state != LineState::Rest || self.line.ended || self.judged.differs || self.judged.decides
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let Flags {
            check_failed,
            silent,
            stuck,
            error_bit,
            warning_bit,
            jumped,
            overrun,
        } = self.flags;
        Outputs {
            clock_out: self.line.clock_out,
            count: self.count,
            valid: self.valid,
            known: self.known,
            extrapolated: self.extrapolated,
            busy: self.is_busy(),
            line_delay: self.line.line_delay,
            lost: self.lost,
            check_failed,
            silent,
            stuck,
            error_bit,
            warning_bit,
            jumped,
            overrun,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        if inputs.rst {
            *self = Self::new(&self.config);
        } else {
            self.clock(inputs);
        }
        outputs
    }

    fn clock(&mut self, inputs: &Inputs) {
        let busy = self.is_busy();
        let starts = inputs.tick && !busy;
        if inputs.clear_flags {
            self.flags = Flags::default();
        }
        self.flags.overrun |= inputs.tick && busy;
        self.count_clock(inputs.clear_flags);
        self.judge();
        if starts {
            self.word = FrameWord::default();
        }
        if let Some(bit) = self.line.clock(&self.config, starts, inputs.data) {
            self.word.take(&self.config, bit);
        }
    }

    /// The last of the three clocks: the count.
    fn count_clock(&mut self, clears: bool) {
        self.valid = false;
        let limits = self.config.limits();
        if self.lost {
            if clears {
                (self.lost, self.missed, self.allowed) = (false, 0, limits.largest_jump);
            }
        } else if self.judged.decides && self.judged.good {
            if self.known {
                self.position = self.position.wrapping_add_signed(self.judged.difference);
                if self.missed == 0 {
                    self.change = self.judged.difference as i32;
                }
            } else {
                (self.position, self.change) = (self.word.position, 0);
            }
            self.position &= (1 << SUM_BITS) - 1;
            self.count = self.position as u32 as i32;
            (self.missed, self.allowed) = (0, limits.largest_jump);
            (self.valid, self.known, self.extrapolated) = (true, true, false);
        } else if self.judged.decides && self.missed == limits.tolerated {
            (self.lost, self.known) = (true, false);
        } else if self.judged.decides {
            self.missed += 1;
            self.allowed += limits.largest_jump;
            if self.known {
                self.count = self.count.wrapping_add(self.change);
                (self.valid, self.extrapolated) = (true, true);
            }
        }
    }

    /// The two clocks before it: the difference and the flags of the frame, then the limit.
    fn judge(&mut self) {
        let Judged {
            differs,
            failed,
            difference,
            ..
        } = self.judged;
        let jumps = self.known && difference.unsigned_abs() > self.allowed;
        self.judged.good = !failed && !jumps;
        self.judged.decides = differs;
        self.flags.jumped |= differs && !failed && jumps;

        let EncoderLine {
            ended, silent, stuck, ..
        } = self.line;
        let whole = ended && !silent && !stuck;
        let wrong = self.word.is_wrong(&self.config);
        self.flags.silent |= silent;
        self.flags.stuck |= stuck;
        self.flags.check_failed |= whole && wrong;
        self.flags.error_bit |= whole && !wrong && self.word.error;
        self.flags.warning_bit |= whole && !wrong && self.word.warning;
        self.judged.differs = ended;
        self.judged.failed = !whole || wrong || self.word.error;
        self.judged.difference = self.difference();
    }

    /// From the last good position to that of the frame, modulo the range.
    fn difference(&self) -> i64 {
        let unused = 64 - self.config.frame().position_bits;
        (self.word.position.wrapping_sub(self.position) << unused) as i64 >> unused
    }
}

clocked_block!(AbsoluteEncoder, "the absolute encoder");

impl Moore for AbsoluteEncoder {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        let mut next = self.clone();
        next.step(&inputs);
        if next == *self {
            return FOREVER;
        }
        let only_the_line = Self {
            line: self.line.clone(),
            ..next
        };
        if only_the_line == *self {
            self.line.quiet_clocks(&self.config, inputs.data)
        } else {
            0
        }
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        // At rest nothing counts.
        if self.line.state != LineState::Rest {
            self.line.pass(&self.config, clocks);
        }
    }
}
