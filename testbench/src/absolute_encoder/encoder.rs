//! An encoder at the lines of the block, clock by clock, which can have faults.

use posicast_blocks::absolute_encoder::{AbsoluteEncoderConfig, AbsoluteProtocol, FrameCheck};
use rand::{Rng, RngExt};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::table::pick;

/// Longest delay of the line in clocks.
const MOST_DELAY_CLOCKS: usize = 126;

/// Clocks by which the encoder is ready before the pause is over.
const READY_CLOCKS: u64 = 6;

/// What is wrong with a reading.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum EncoderFault {
    /// Nothing.
    #[default]
    None,
    /// A bit of the frame is inverted on its way.
    FlippedBit,
    /// The encoder does not see the clock.
    Silent,
    /// The line stays low after the reading before this one.
    Low,
    /// The error bit is set.
    Error,
    /// The warning bit is set, which is no fault.
    Warning,
    /// The frame has a position that is far away.
    Far,
    /// BiSS: it answers, and does not begin.
    NeverBegins,
    /// BiSS: it answers one edge too early.
    Early,
    /// BiSS: its answer is shorter than half a bit.
    ShortAnswer,
    /// SSI: the line rises behind the last bit.
    HighEnd,
}

impl EncoderFault {
    pub(crate) const ALL: [Self; 11] = [
        Self::None,
        Self::FlippedBit,
        Self::Silent,
        Self::Low,
        Self::Error,
        Self::Warning,
        Self::Far,
        Self::NeverBegins,
        Self::Early,
        Self::ShortAnswer,
        Self::HighEnd,
    ];
}

/// The encoder.
#[derive(Debug, Clone)]
pub(crate) struct SimulatedEncoder {
    config: AbsoluteEncoderConfig,
    /// Where the axis stands.
    pub(crate) position: u64,
    pub(crate) fault: EncoderFault,
    /// Clocks from its output to `data`, and what is on its way.
    pub(crate) delay: usize,
    /// Whether the delay of a clock is sometimes one longer.
    pub(crate) jitters: bool,
    /// Periods that BiSS takes to compute.
    pub(crate) computes: u32,
    way: u128,
    clock: bool,
    active: bool,
    rises: u32,
    idle_clocks: u64,
    frame: Vec<bool>,
    output: bool,
    short_clocks: u64,
}

impl SimulatedEncoder {
    pub(crate) fn new(config: &AbsoluteEncoderConfig) -> Self {
        Self {
            config: *config,
            position: 0,
            fault: EncoderFault::None,
            delay: 0,
            jitters: false,
            computes: 0,
            way: u128::MAX,
            clock: true,
            active: false,
            rises: 0,
            idle_clocks: 0,
            frame: Vec::new(),
            output: true,
            short_clocks: 0,
        }
    }

    fn is_biss(&self) -> bool {
        self.config.protocol() == AbsoluteProtocol::BissC
    }

    /// The level of `data`, one clock after this level of `clock_out`.
    pub(crate) fn clock(&mut self, clock: bool, rng: &mut Xoshiro256PlusPlus) -> bool {
        let (rises, edges) = (clock && !self.clock, clock != self.clock);
        self.clock = clock;
        // It is ready when the block has paused, in spite of the delay.
        let ready_clocks = self
            .config
            .times()
            .pause_clocks
            .saturating_sub(self.delay as u64 + READY_CLOCKS);
        self.idle_clocks = if edges { 0 } else { self.idle_clocks + 1 };
        if edges && !self.active && self.fault != EncoderFault::Silent {
            self.begin(rng);
        }
        if self.active {
            if rises {
                self.rises += 1;
                self.output = self.level_of(self.rises);
            }
            if self.short_clocks > 0 {
                self.short_clocks -= 1;
                self.output = self.short_clocks == 0;
            }
            if self.idle_clocks > ready_clocks {
                self.active = false;
                self.output = self.fault != EncoderFault::Low;
            }
        } else if self.fault != EncoderFault::Low {
            self.output = true;
        }
        self.way = self.way << 1 | u128::from(self.output);
        let late = usize::from(self.jitters && rng.random());
        self.way >> (self.delay + late).min(MOST_DELAY_CLOCKS) & 1 == 1
    }

    fn begin(&mut self, rng: &mut Xoshiro256PlusPlus) {
        (self.active, self.rises) = (true, 0);
        let far = if self.fault == EncoderFault::Far {
            rng.next_u64()
        } else {
            0
        };
        self.frame = frame(&self.config, self.position ^ far, self.fault, rng);
        if self.fault == EncoderFault::FlippedBit {
            // The bits before the position count only for the check.
            let place = rng.random_range(0..self.frame.len());
            self.frame[place] ^= true;
        }
    }

    /// The output after a rising edge.
    fn level_of(&mut self, rise: u32) -> bool {
        let of_frame = |place: u32| self.frame.get(place as usize).copied();
        if !self.is_biss() {
            let end = self.fault == EncoderFault::HighEnd;
            return of_frame(rise - 1).unwrap_or(end);
        }
        let first = if self.fault == EncoderFault::Early { 1 } else { 2 };
        let start = first + 1 + self.computes;
        match rise {
            _ if rise < first => true,
            _ if rise == first && self.fault == EncoderFault::ShortAnswer => {
                self.short_clocks = 1 + self.config.times().half_period_clocks / 2;
                false
            }
            _ if rise < start || self.fault == EncoderFault::NeverBegins => false,
            _ if rise == start => true,
            _ if rise == start + 1 => false,
            _ => of_frame(rise - start - 2).unwrap_or(false),
        }
    }
}

/// The bits of a frame, as the datasheets of encoders describe it.
fn frame(
    config: &AbsoluteEncoderConfig,
    position: u64,
    fault: EncoderFault,
    rng: &mut Xoshiro256PlusPlus,
) -> Vec<bool> {
    let frame = config.frame();
    let shown = if frame.gray {
        position ^ ((position & range(config)) >> 1)
    } else {
        position
    };
    let mut bits: Vec<bool> = (0..frame.leading_bits).map(|_| rng.random()).collect();
    bits.extend((0..frame.position_bits).rev().map(|bit| shown >> bit & 1 == 1));
    for place in 0..frame.trailing_bits {
        let of = |bit: Option<_>, wrong| {
            let bit: posicast_blocks::absolute_encoder::FrameStatusBit = bit?;
            (bit.place == place).then_some(bit.active_low != wrong)
        };
        let error = of(frame.error, fault == EncoderFault::Error);
        let warning = of(frame.warning, fault == EncoderFault::Warning);
        bits.push(error.or(warning).unwrap_or_else(|| rng.random()));
    }
    let ones = bits.iter().filter(|bit| **bit).count();
    match frame.check {
        FrameCheck::None => {}
        FrameCheck::EvenParity => bits.push(ones % 2 == 1),
        FrameCheck::OddParity => bits.push(ones.is_multiple_of(2)),
        FrameCheck::Crc6 => {
            let crc = remainder(&bits);
            bits.extend((0..6).rev().map(|bit| crc >> bit & 1 == 0));
        }
    }
    bits
}

/// All positions of the encoder, as a mask.
pub(crate) fn range(config: &AbsoluteEncoderConfig) -> u64 {
    (1 << config.frame().position_bits) - 1
}

/// The remainder of the bits, times x^6, by x^6 + x + 1: long division.
fn remainder(bits: &[bool]) -> u64 {
    let dividend = bits.iter().fold(0u128, |word, bit| word << 1 | u128::from(*bit)) << 6;
    let divide = |rest: u128, place: usize| {
        if rest >> (place + 6) & 1 == 1 {
            rest ^ 0b100_0011 << place
        } else {
            rest
        }
    };
    (0..bits.len()).rev().fold(dividend, divide) as u64
}

/// A delay of the line that the protocol allows, in clocks.
pub(crate) fn allowed_delay(config: &AbsoluteEncoderConfig, rng: &mut Xoshiro256PlusPlus) -> usize {
    let period = config.period_clocks();
    let most = match config.protocol() {
        // One clock passes at the pins of the simulation, and one may be jitter.
        AbsoluteProtocol::Ssi => config.most_ssi_delay_clocks().saturating_sub(2),
        AbsoluteProtocol::BissC => {
            let ready = config.times().pause_clocks.saturating_sub(period + READY_CLOCKS + 2);
            (5 * period).min(ready).min(MOST_DELAY_CLOCKS as u64 - 1)
        }
    };
    let any = rng.random_range(0..=most);
    *pick(rng, &[0, most, any, any]) as usize
}

#[cfg(test)]
mod tests {
    use super::remainder;

    /// The remainders of x^6, x^7, … by x^6 + x + 1, worked out by hand.
    #[test]
    fn unit_powers_of_x_leave_the_remainders_of_the_field() {
        let expected = [
            0b00_0011, 0b00_0110, 0b00_1100, 0b01_1000, 0b11_0000, 0b10_0011, 0b00_0101,
        ];
        for (power, rest) in expected.into_iter().enumerate() {
            let mut bits = vec![true];
            bits.extend(vec![false; power]);
            assert_eq!(remainder(&bits), rest, "x^{}", power + 6);
        }
    }
}
