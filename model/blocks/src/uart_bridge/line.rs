//! The serial line: eighths of a bit, receiver, transmitter.

/// Eighths of a bit in a bit.
const EIGHTHS: u8 = 8;
/// A bit is sampled in this eighth of it, the middle; eighths count from the first one that shows the start bit.
const MIDDLE: u8 = 3;
/// Bits of a byte on the line: start, eight of data, stop.
const LINE_BITS: u8 = 10;

/// Divides the clock: `tick` is high for a clock in each eighth of a bit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Eighths {
    /// Fraction of an eighth, 16 bits.
    sum: u32,
    pub(super) tick: bool,
}

impl Eighths {
    pub(super) fn clock(&mut self, baud_step: u32) {
        let sum = self.sum + baud_step;
        self.tick = sum >> 16 != 0;
        self.sum = sum & 0xffff;
    }
}

/// Takes bytes from the line: start bit, eight bits of data, lowest first, stop bit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Receiver {
    /// The synchroniser, on the inverted line: high while the line is low. First and second flip-flop.
    synchroniser: [bool; 2],
    /// The line in the last two eighths.
    history: [bool; 2],
    receives: bool,
    /// After a byte without a stop bit: waits until the line is high.
    waits: bool,
    eighth: u8,
    bit: u8,
    pub(super) byte: u8,
    /// One clock: `byte` is new.
    pub(super) received: bool,
    /// One clock: a byte had no stop bit.
    pub(super) bad: bool,
}

impl Receiver {
    pub(super) fn clock(&mut self, tick: bool, uart_rx: bool) {
        let [first, low] = self.synchroniser;
        (self.received, self.bad) = (false, false);
        if tick {
            self.eighth_of_a_bit(low);
            self.history = [low, self.history[0]];
        }
        self.synchroniser = [!uart_rx, first];
    }

    fn eighth_of_a_bit(&mut self, low: bool) {
        let [before, long_before] = self.history;
        // The majority of three.
        let low = (low & before) | (low & long_before) | (before & long_before);
        if self.waits {
            self.waits = low;
        } else if !self.receives {
            self.receives = low;
            (self.eighth, self.bit) = (0, 0);
        } else {
            if self.eighth == MIDDLE {
                self.take(low);
            }
            self.eighth = (self.eighth + 1) % EIGHTHS;
        }
    }

    fn take(&mut self, low: bool) {
        match self.bit {
            0 => self.receives = low,
            9 => {
                self.receives = false;
                (self.received, self.bad, self.waits) = (!low, low, low);
            }
            _ => self.byte = (self.byte >> 1) | (u8::from(!low) << 7),
        }
        self.bit += 1;
    }
}

/// Puts bytes on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Transmitter {
    /// Bits that are still to be put on the line, the next one lowest.
    bits: u16,
    left: u8,
    eighth: u8,
    pub(super) line: bool,
}

impl Default for Transmitter {
    fn default() -> Self {
        Self {
            bits: 0,
            left: 0,
            eighth: 0,
            line: true,
        }
    }
}

impl Transmitter {
    pub(super) fn is_busy(&self) -> bool {
        self.left > 0
    }

    /// `start` begins to send a byte, unless busy.
    pub(super) fn clock(&mut self, tick: bool, start: Option<u8>) {
        if self.is_busy() {
            if tick {
                if self.eighth == 0 {
                    self.line = self.bits & 1 != 0;
                    self.bits >>= 1;
                }
                self.eighth = (self.eighth + 1) % EIGHTHS;
                self.left -= u8::from(self.eighth == 0);
            }
        } else if let Some(byte) = start {
            self.bits = 0x200 | u16::from(byte) << 1;
            self.left = LINE_BITS;
        }
    }
}
