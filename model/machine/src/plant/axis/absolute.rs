//! An absolute encoder, as its protocol describes it: the line's clock in, data out.
//!
//! It is written from the published protocols, apart from the hardware that reads it.
//!
//! | | SSI | BiSS-C |
//! |---|---|---|
//! | position is held at | the first falling edge | the first rising edge |
//! | answer | a bit after each rising edge | low from the second rising edge, while it computes |
//! | frame | leading bits, position, trailing bits, parity | start bit, 0, position, nError, nWarning, inverted CRC |
//! | after it | low until the monoflop has run out | low until the time-out |

use crate::machine_file::{AbsoluteSection, CABLE_DELAY_S_PER_M, ClockSection};
use posicast_blocks::absolute_encoder::{AbsoluteFrame, AbsoluteProtocol, FrameCheck};

/// The encoder rests again after this share of the pause that the machine file states.
const REST: f64 = 0.75;
/// It takes this share of the longest answer to compute its position.
const COMPUTES: f64 = 0.5;
/// The history of the line holds this many clocks.
const MOST_DELAY_CLOCKS: u32 = 63;

/// A fault of an absolute encoder or its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AbsoluteFault {
    /// The data line stays at this level.
    Stuck(bool),
    /// This bit of each frame is inverted; 0 is the first one of the frame.
    Inverted(u32),
    /// The encoder sets its error bit, if its frame has one.
    Error,
}

/// An absolute encoder of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AbsoluteEncoder {
    protocol: AbsoluteProtocol,
    frame: AbsoluteFrame,
    offset: i64,
    invert: bool,
    rest_clocks: u64,
    compute_clocks: u64,
    delay_clocks: u32,
    fault: Option<AbsoluteFault>,
    clock: bool,
    /// Rising edges since the position was held, or since the frame of BiSS-C began.
    edges: u32,
    state: State,
    /// Clocks since the last edge of the line.
    since_edge: u64,
    /// Clocks since the answer began.
    since_answer: u64,
    /// The frame to send, first bit highest, and its length.
    bits: u64,
    length: u32,
    /// The line, most recent clock lowest.
    history: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Rest,
    /// BiSS-C: the line has fallen, and nothing is held yet.
    Woken,
    /// BiSS-C: the position is held; the answer begins with the next rising edge.
    Held,
    /// BiSS-C: the line is low while the encoder computes.
    Computes,
    Sends,
}

impl AbsoluteEncoder {
    pub(super) fn new(section: &AbsoluteSection, invert: bool, clock: &ClockSection) -> Self {
        let clocks = |seconds: f64| (seconds * clock.frequency_hz) as u64;
        let delay = section.cable_m.unwrap_or_default() * CABLE_DELAY_S_PER_M * clock.frequency_hz;
        Self {
            protocol: section.protocol,
            frame: section.frame,
            offset: section.offset.into(),
            invert,
            rest_clocks: clocks(REST * section.times.pause_s),
            compute_clocks: clocks(COMPUTES * section.times.answer_s),
            delay_clocks: (delay as u32).min(MOST_DELAY_CLOCKS),
            fault: None,
            clock: true,
            edges: 0,
            state: State::Rest,
            since_edge: 0,
            since_answer: 0,
            bits: 0,
            length: 0,
            history: u64::MAX,
        }
    }

    pub(super) fn set_fault(&mut self, fault: Option<AbsoluteFault>) {
        self.fault = fault;
    }

    /// The data line in the next clock, at the other end of the cable.
    pub(super) fn data(&self) -> bool {
        match self.fault {
            Some(AbsoluteFault::Stuck(level)) => level,
            _ => self.history >> self.delay_clocks & 1 == 1,
        }
    }

    /// Clocks from now on in which the data line stays, if the line's clock does: at least one.
    pub(super) fn quiet_clocks(&self) -> u64 {
        let on_the_way = u64::MAX >> (MOST_DELAY_CLOCKS - self.delay_clocks);
        let arrived = if self.level() { on_the_way } else { 0 };
        if self.history & on_the_way != arrived {
            return 1;
        }
        match self.state {
            State::Rest => u64::MAX,
            _ if self.clock => self.rest_clocks.saturating_sub(self.since_edge).max(1),
            _ => u64::MAX,
        }
    }

    /// Sees the level of the line's clock in this clock; `count` is the axis's position.
    pub(super) fn see(&mut self, clock: bool, count: i64) {
        if clock == self.clock {
            return;
        }
        (self.clock, self.since_edge) = (clock, 0);
        match self.protocol {
            AbsoluteProtocol::Ssi => self.ssi_edge(clock, count),
            AbsoluteProtocol::BissC => self.biss_edge(clock, count),
        }
    }

    /// Simulates this many clocks, 1 to [`quiet_clocks`](Self::quiet_clocks), in which the line's clock stays.
    pub(super) fn pass(&mut self, clocks: u64) {
        let level = u64::from(self.level());
        for _ in 0..clocks.min(u64::BITS.into()) {
            self.history = self.history << 1 | level;
        }
        self.since_edge += clocks;
        self.since_answer += clocks;
        if self.clock && self.since_edge >= self.rest_clocks {
            self.state = State::Rest;
        }
    }

    fn ssi_edge(&mut self, rises: bool, count: i64) {
        match (self.state, rises) {
            (State::Rest, false) => {
                self.hold(count);
                (self.state, self.edges) = (State::Sends, 0);
            }
            (State::Sends, true) => self.edges += 1,
            _ => {}
        }
    }

    fn biss_edge(&mut self, rises: bool, count: i64) {
        match (self.state, rises) {
            (State::Rest, false) => self.state = State::Woken,
            (State::Woken, true) => {
                self.hold(count);
                self.state = State::Held;
            }
            (State::Held, true) => (self.state, self.since_answer) = (State::Computes, 0),
            (State::Computes, true) if self.since_answer >= self.compute_clocks => {
                (self.state, self.edges) = (State::Sends, 1);
            }
            (State::Sends, true) => self.edges += 1,
            _ => {}
        }
    }

    /// The level at the encoder.
    fn level(&self) -> bool {
        match (self.state, self.protocol) {
            (State::Rest | State::Woken | State::Held, _) => true,
            (State::Computes, _) => false,
            // Before the first rising edge the line of SSI still rests.
            (State::Sends, AbsoluteProtocol::Ssi) if self.edges == 0 => true,
            (State::Sends, _) => self.edges <= self.length && self.bits >> (self.length - self.edges) & 1 == 1,
        }
    }

    /// Holds the position, and makes the frame of it.
    fn hold(&mut self, count: i64) {
        let frame = &self.frame;
        let range = (1_u64 << frame.position_bits) - 1;
        let place = (self.offset + if self.invert { -count } else { count }) as u64 & range;
        let code = if frame.gray { place ^ place >> 1 } else { place };
        let mut bits = code << frame.trailing_bits;
        let is_wrong = self.fault == Some(AbsoluteFault::Error);
        for (bit, is_set) in [(frame.error, is_wrong), (frame.warning, false)] {
            if let Some(bit) = bit {
                bits |= u64::from(is_set != bit.active_low) << (frame.trailing_bits - 1 - bit.place);
            }
        }
        let length = frame.leading_bits + frame.position_bits + frame.trailing_bits;
        let ones = bits.count_ones() & 1;
        let check = match frame.check {
            FrameCheck::None => 0,
            FrameCheck::EvenParity => u64::from(ones),
            FrameCheck::OddParity => u64::from(ones ^ 1),
            FrameCheck::Crc6 => u64::from(inverted_crc6(bits, length)),
        };
        bits = bits << frame.check.bits() | check;
        let of_frame = length + frame.check.bits();
        if let Some(AbsoluteFault::Inverted(bit)) = self.fault
            && bit < of_frame
        {
            bits ^= 1 << (of_frame - 1 - bit);
        }
        // BiSS-C begins with a start bit and a 0.
        let begins = match self.protocol {
            AbsoluteProtocol::Ssi => 0,
            AbsoluteProtocol::BissC => 2,
        };
        self.length = of_frame + begins;
        self.bits = bits | if begins > 0 { 1 << (of_frame + 1) } else { 0 };
    }
}

/// CRC of x^6 + x + 1 over the lowest `length` bits, the highest of them first, inverted.
fn inverted_crc6(bits: u64, length: u32) -> u8 {
    let mut remainder = 0_u8;
    for place in (0..length).rev() {
        let carry = (remainder >> 5 & 1) ^ (bits >> place & 1) as u8;
        remainder = ((remainder << 1) & 0x3f) ^ (carry * 0b11);
    }
    !remainder & 0x3f
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crc_divides_as_by_hand() {
        // 1 followed by six zeros, divided by x^6 + x + 1, leaves x + 1.
        assert_eq!(inverted_crc6(1, 1), !0b11 & 0x3f);
        // A frame with its remainder behind it leaves 0.
        let bits = 0b1011_0011_1000;
        let remainder = u64::from(!inverted_crc6(bits, 12) & 0x3f);
        assert_eq!(!inverted_crc6(bits << 6 | remainder, 18) & 0x3f, 0);
    }
}
