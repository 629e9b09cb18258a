//! Build parameters of an absolute encoder: protocol and frame, times of the lines, and what a position may do.

use super::frame::{AbsoluteFrame, AbsoluteProtocol};
use std::ops::RangeInclusive;

/// Clocks of half a period of the line.
pub const HALF_PERIOD_CLOCKS: RangeInclusive<u64> = 2..=4095;
/// Clocks that the line rests between two readings.
pub const PAUSE_CLOCKS: RangeInclusive<u64> = 8..=65_535;
/// Largest number of clocks until the frame of BiSS begins.
pub const MOST_ANSWER_CLOCKS: u64 = 32_767;
/// Smallest number of half periods until the frame of BiSS begins.
pub const LEAST_ANSWER_HALVES: u64 = 8;
/// Most readings in a row that may fail.
pub const MOST_TOLERATED: u64 = 255;
/// Fastest line of SSI in Hz.
pub const MOST_SSI_HZ: f64 = 2e6;
/// Fastest line of BiSS-C in Hz.
pub const MOST_BISS_HZ: f64 = 10e6;

/// Times of the lines in clocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AbsoluteTimes {
    /// `clock_out` is low this long, and high at least this long.
    pub half_period_clocks: u64,
    /// From the last rising edge of a reading to the first falling edge of the next, at the least: longer than the
    /// encoder's monoflop time (SSI) or time-out (BiSS).
    pub pause_clocks: u64,
    /// BiSS-C: from the first falling edge to the start bit, at the most: a few periods, the line's delay and the time
    /// that the encoder takes to compute. Without meaning for SSI.
    pub answer_clocks: u64,
}

/// Times of the lines in seconds, as an encoder's datasheet has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AbsoluteTimesInSeconds {
    /// Fastest clock of the line in Hz.
    pub line_hz: f64,
    /// As [`AbsoluteTimes::pause_clocks`].
    pub pause_s: f64,
    /// As [`AbsoluteTimes::answer_clocks`].
    pub answer_s: f64,
}

/// What a position may do from reading to reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AbsoluteLimits {
    /// Largest change of the position from one reading to the next, in counts; over n failed readings n + 1 times that.
    pub largest_jump: u64,
    /// Number of failed readings in a row over which the position is extrapolated. One more is `lost`.
    pub tolerated: u64,
}

/// Why an absolute encoder cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AbsoluteEncoderConfigError {
    /// A position is too short or too long.
    #[error("a position of {0} bits: 8 to 40 are allowed")]
    PositionBits(u32),
    /// Too many bits before or behind the position.
    #[error("{bits} {name} bits: at most 16 are allowed")]
    OtherBits {
        /// Which of them.
        name: &'static str,
        /// What was found.
        bits: u32,
    },
    /// The frame has no such trailing bit.
    #[error("the {name} bit has place {place}, but the frame has {trailing_bits} trailing bits, from place 0 on")]
    StatusPlace {
        /// Which of them.
        name: &'static str,
        /// What was found.
        place: u32,
        /// Trailing bits of the frame.
        trailing_bits: u32,
    },
    /// BiSS without its CRC.
    #[error("a frame of BiSS-C with the check `{0}`: it has a CRC of 6 bits (crc6)")]
    BissCheck(&'static str),
    /// A frequency or a time that is no number above 0.
    #[error("`{name}` of {value} at {clock_hz} Hz: frequencies and times are above 0")]
    Number {
        /// Which of them.
        name: &'static str,
        /// What was found.
        value: f64,
        /// The clock's frequency.
        clock_hz: f64,
    },
    /// The line is faster than its protocol.
    #[error("a line of {line_hz} Hz: {protocol} goes up to {most_hz} Hz")]
    LineHz {
        /// What was found.
        line_hz: f64,
        /// Name of the protocol.
        protocol: &'static str,
        /// Fastest line.
        most_hz: f64,
    },
    /// A time is out of the range of its timer.
    #[error("`{name}` takes {clocks} clocks: {least} to {most} are allowed; check the unit, or choose another clock")]
    Clocks {
        /// Which of the times.
        name: &'static str,
        /// What was found.
        clocks: u64,
        /// Smallest number of clocks.
        least: u64,
        /// Largest number of clocks.
        most: u64,
    },
    /// Too many failed readings are tolerated.
    #[error("{0} failed readings tolerated: 0 to 255 are allowed")]
    Tolerated(u64),
    /// The jump is 0, or so large that half the range of the encoder cannot tell its direction.
    #[error(
        "a jump of {largest_jump} counts over {readings} readings: it is at least 1, and over all of them at most \
         {most} counts; choose a smaller one, or tolerate fewer readings"
    )]
    Jump {
        /// What was found.
        largest_jump: u64,
        /// Readings over which it may add up: the tolerated ones and one more.
        readings: u64,
        /// Largest sum.
        most: u64,
    },
}

impl AbsoluteTimes {
    /// The times in clocks. Half a period, pause and answer are rounded up, so the line is never faster than stated. What
    /// is above a whole number of clocks by a millionth of a clock only counts as that number.
    ///
    /// # Errors
    /// [`AbsoluteEncoderConfigError::Number`] for a number that is not above 0 or not finite, and
    /// [`LineHz`](AbsoluteEncoderConfigError::LineHz) for a line that is faster than its protocol.
    pub fn from_seconds(
        times: AbsoluteTimesInSeconds,
        protocol: AbsoluteProtocol,
        clock_hz: f64,
    ) -> Result<Self, AbsoluteEncoderConfigError> {
        let AbsoluteTimesInSeconds {
            line_hz,
            pause_s,
            answer_s,
        } = times;
        let wanted = [("line_hz", line_hz), ("pause_s", pause_s), ("answer_s", answer_s)];
        let is_used = |name| protocol == AbsoluteProtocol::BissC || name != "answer_s";
        for (name, value) in wanted.into_iter().filter(|(name, _)| is_used(*name)) {
            if !(value.is_finite() && value > 0.0 && clock_hz.is_finite() && clock_hz > 0.0) {
                return Err(AbsoluteEncoderConfigError::Number { name, value, clock_hz });
            }
        }
        let most_hz = match protocol {
            AbsoluteProtocol::Ssi => MOST_SSI_HZ,
            AbsoluteProtocol::BissC => MOST_BISS_HZ,
        };
        if line_hz > most_hz {
            return Err(AbsoluteEncoderConfigError::LineHz {
                line_hz,
                protocol: protocol.name(),
                most_hz,
            });
        }
        let clocks = |seconds: f64| (seconds * clock_hz - 1e-6).ceil().max(0.0) as u64;
        Ok(Self {
            half_period_clocks: clocks(0.5 / line_hz).max(*HALF_PERIOD_CLOCKS.start()),
            pause_clocks: clocks(pause_s).max(*PAUSE_CLOCKS.start()),
            answer_clocks: match protocol {
                AbsoluteProtocol::Ssi => 0,
                AbsoluteProtocol::BissC => clocks(answer_s),
            },
        })
    }
}

/// Build parameters of an absolute encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AbsoluteEncoderConfig {
    protocol: AbsoluteProtocol,
    frame: AbsoluteFrame,
    times: AbsoluteTimes,
    limits: AbsoluteLimits,
}

impl AbsoluteEncoderConfig {
    /// An encoder with this protocol, frame, times and limits.
    ///
    /// # Errors
    /// [`AbsoluteEncoderConfigError`] for a frame that the protocol does not have, and for what does not fit the registers.
    pub fn new(
        protocol: AbsoluteProtocol,
        frame: AbsoluteFrame,
        times: AbsoluteTimes,
        limits: AbsoluteLimits,
    ) -> Result<Self, AbsoluteEncoderConfigError> {
        use AbsoluteEncoderConfigError as Wrong;

        frame.checked(protocol)?;
        let within = |name, clocks: u64, range: RangeInclusive<u64>| {
            if range.contains(&clocks) {
                return Ok(());
            }
            let (least, most) = range.into_inner();
            Err(Wrong::Clocks {
                name,
                clocks,
                least,
                most,
            })
        };
        let half = times.half_period_clocks;
        within("half period", half, HALF_PERIOD_CLOCKS)?;
        within("pause", times.pause_clocks, PAUSE_CLOCKS)?;
        let answer_clocks = match protocol {
            AbsoluteProtocol::Ssi => 0,
            AbsoluteProtocol::BissC => {
                let range = LEAST_ANSWER_HALVES * half..=MOST_ANSWER_CLOCKS;
                within("answer", times.answer_clocks, range)?;
                times.answer_clocks
            }
        };
        if limits.tolerated > MOST_TOLERATED {
            return Err(Wrong::Tolerated(limits.tolerated));
        }
        let readings = limits.tolerated + 1;
        let most = (1 << (frame.position_bits.min(32) - 1)) - 1;
        if limits.largest_jump == 0 || limits.largest_jump > most / readings {
            return Err(Wrong::Jump {
                largest_jump: limits.largest_jump,
                readings,
                most,
            });
        }
        Ok(Self {
            protocol,
            frame,
            times: AbsoluteTimes { answer_clocks, ..times },
            limits,
        })
    }

    /// How encoder and block talk.
    pub fn protocol(&self) -> AbsoluteProtocol {
        self.protocol
    }

    /// The bits of a frame.
    pub fn frame(&self) -> &AbsoluteFrame {
        &self.frame
    }

    /// Times of the lines in clocks; `answer_clocks` is 0 for SSI.
    pub fn times(&self) -> AbsoluteTimes {
        self.times
    }

    /// What a position may do.
    pub fn limits(&self) -> AbsoluteLimits {
        self.limits
    }

    /// Clocks of a period of the line.
    pub fn period_clocks(&self) -> u64 {
        2 * self.times.half_period_clocks
    }

    /// Clocks from the tick to the edge that holds the position: the position of a reading is that of this clock.
    pub fn latch_clocks(&self) -> u64 {
        match self.protocol {
            AbsoluteProtocol::Ssi => 1,
            AbsoluteProtocol::BissC => 1 + self.times.half_period_clocks,
        }
    }

    /// Largest number of clocks from the tick to `valid`. A reading that succeeds needs as many at the most; a failed one is
    /// known earlier.
    pub fn most_valid_clocks(&self) -> u64 {
        let bits = u64::from(self.frame.bits());
        match self.protocol {
            // Half a period to the first bit, a period for each, and one to see the line low behind the last.
            AbsoluteProtocol::Ssi => self.times.half_period_clocks + self.period_clocks() * (bits + 1) + 4,
            // The start bit is seen in the last clock of `answer_clocks`; the bit 0 and the frame follow.
            AbsoluteProtocol::BissC => self.times.answer_clocks + self.period_clocks() * (bits + 1) + 4,
        }
    }

    /// Smallest number of clocks from tick to tick in which every tick is taken: a reading and the pause.
    pub fn least_tick_clocks(&self) -> u64 {
        // After a reading of BiSS the line may have to rise first.
        self.most_valid_clocks() + self.times.half_period_clocks + self.times.pause_clocks
    }

    /// Largest delay from an edge of `clock_out` to the bit at `data` with which SSI is read rightly, in clocks: lines,
    /// drivers and encoder together. BiSS-C measures it, and takes any within `answer_clocks`.
    pub fn most_ssi_delay_clocks(&self) -> u64 {
        self.period_clocks() - 3
    }
}
