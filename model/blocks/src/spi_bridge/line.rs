//! The SPI lines: synchronisers, edges, bytes in both directions.

/// Bits of a byte.
const BYTE_BITS: u8 = 8;

/// The line's pins in a clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pins {
    pub(super) sck: bool,
    pub(super) cs_n: bool,
    pub(super) mosi: bool,
}

/// Takes bytes from the host and gives it bytes, most significant bit first, in mode 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct SpiLine {
    /// The synchronisers: first and second flip-flop. That of `spi_cs_n` is on the inverted line.
    sck: [bool; 2],
    selected: [bool; 2],
    mosi: [bool; 2],
    /// Clock line and selection of the clock before.
    sck_before: bool,
    selected_before: bool,
    /// Bits of the byte that have come.
    place: u8,
    taken: u8,
    pub(super) byte: u8,
    /// One clock: `byte` is new.
    pub(super) received: bool,
    /// One clock: the selection ended within a byte.
    pub(super) bad: bool,
    /// Byte that is being sent to the host, the next bit highest. `gives`: it belongs to a reply; otherwise it is a filling 00.
    given: u8,
    gives: bool,
    /// The byte that the host gets next, if there is one.
    waiting: u8,
    full: bool,
}

impl SpiLine {
    /// Whether a byte waits to be sent.
    pub(super) fn is_busy(&self) -> bool {
        self.full
    }

    /// The line to the host.
    pub(super) fn miso(&self) -> bool {
        self.given >> (BYTE_BITS - 1) != 0
    }

    /// `start` is the next byte for the host, unless one waits.
    pub(super) fn clock(&mut self, pins: Pins, start: Option<u8>) {
        let ([_, sck], [_, selected], [_, mosi]) = (self.sck, self.selected, self.mosi);
        let (rises, falls) = (sck && !self.sck_before, !sck && self.sck_before);
        (self.received, self.bad) = (false, false);
        let (full, waiting) = (self.full, self.waiting);
        if let Some(byte) = start.filter(|_| !full) {
            (self.waiting, self.full) = (byte, true);
        }
        let first = self.place == 0;
        let mut loads = false;
        if !selected {
            self.bad = !first;
            self.place = 0;
            (self.given, self.gives) = (0, false);
        } else if !self.selected_before {
            loads = true;
        } else if rises {
            self.taken = self.taken << 1 | u8::from(mosi);
            self.place = (self.place + 1) % BYTE_BITS;
            self.received = self.place == 0;
            if self.received {
                self.byte = self.taken;
            }
            // From its first bit on, the byte is the host's.
            self.full &= !(first && self.gives);
            self.gives &= !first;
        } else if falls {
            loads = first;
            self.given <<= 1;
        }
        if loads {
            (self.given, self.gives) = (if full { waiting } else { 0 }, full);
        }
        (self.sck_before, self.selected_before) = (sck, selected);
        self.sck = [pins.sck, self.sck[0]];
        self.selected = [!pins.cs_n, self.selected[0]];
        self.mosi = [pins.mosi, self.mosi[0]];
    }
}
