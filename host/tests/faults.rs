//! The host's end against the byte-exact bridge, over a line that loses, doubles, changes and invents bytes.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use posicast_blocks::link::{Bus, LinkBridge, LinkStatus};
use posicast_host::{Line as AnyLine, Link, LinkError, LinkOptions};

pub(crate) const REGISTERS: u16 = 512;

/// Registers that remember what was written.
#[derive(Default)]
pub(crate) struct Registers {
    pub(crate) writes: Vec<(u16, u32)>,
}

impl Bus for Registers {
    fn read(&mut self, address: u16) -> u32 {
        u32::from(address) << 8 | 1
    }

    fn write(&mut self, address: u16, word: u32) {
        self.writes.push((address, word));
    }
}

/// A line with a bridge and registers at its end. One byte in `one_in` is damaged on either way; 0: none.
pub(crate) struct Line<B> {
    bridge: LinkBridge,
    registers: B,
    one_in: u64,
    random: u64,
    faults: u64,
    coming: VecDeque<u8>,
}

impl<B: Bus> Line<B> {
    pub(crate) fn new(registers: B, address_limit: u16, one_in: u64) -> Self {
        Self {
            bridge: LinkBridge::new(address_limit),
            registers,
            one_in,
            random: 1,
            faults: 0,
            coming: VecDeque::new(),
        }
    }

    /// xorshift64 (Marsaglia 2003).
    fn below(&mut self, end: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random % end
    }

    fn carry(&mut self, byte: u8) -> Vec<u8> {
        if self.one_in == 0 || self.below(self.one_in) != 0 {
            return vec![byte];
        }
        self.faults += 1;
        let any = self.below(256) as u8;
        match self.below(5) {
            0 => vec![],
            1 => vec![byte, byte],
            2 => vec![byte ^ 1 << (any % 8)],
            3 => vec![any, byte],
            _ => vec![any],
        }
    }
}

impl<B: Bus> Write for Line<B> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            for carried in self.carry(*byte) {
                for answer in self.bridge.byte(carried, &mut self.registers).unwrap_or_default() {
                    let carried = self.carry(answer);
                    self.coming.extend(carried);
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<B: Bus> Read for Line<B> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.coming.is_empty() {
            // Time passes, and the bridge drops a frame that has only begun.
            self.bridge.silence();
            return Err(ErrorKind::TimedOut.into());
        }
        // A frame comes in several pieces.
        let most = bytes.len().min(7);
        self.coming.read(&mut bytes[..most])
    }
}

fn line(one_in: u64) -> Line<Registers> {
    Line::new(Registers::default(), REGISTERS, one_in)
}

const FAST: LinkOptions = LinkOptions {
    timeout: Duration::from_micros(20),
    attempts: 20,
};

#[test]
fn words_are_read_and_written() {
    let mut link = Link::new(line(0), FAST);
    assert_eq!(link.read(2, 3).unwrap(), [0x201, 0x301, 0x401]);
    let long = link.read(0, 100).unwrap();
    assert_eq!((long.len(), long[99]), (100, 99 << 8 | 1));
    assert_eq!(link.read_list(&[9, 3]).unwrap(), [0x901, 0x301]);
    link.write(5, &[7, 8]).unwrap();
    link.write_list(&[(1, 0), (500, 9)]).unwrap();
    assert_eq!(link.into_line().registers.writes, [(5, 7), (6, 8), (1, 0), (500, 9)]);
}

#[test]
fn a_refusal_of_the_bridge_is_an_error_and_writes_nothing() {
    let mut link = Link::new(line(0), FAST);
    let error = link.write_list(&[(1, 1), (REGISTERS, 1)]).unwrap_err();
    assert!(matches!(error, LinkError::Refused(LinkStatus::WrongAddress)), "{error}");
    assert_eq!(
        error.to_string(),
        "the bridge refuses the request: an address beyond the registers"
    );
    assert!(matches!(link.write(0, &[0; 41]), Err(LinkError::Request(_))));
    assert!(link.into_line().registers.writes.is_empty());
}

#[test]
fn a_line_without_a_bridge_is_an_error_that_says_what_to_look_for() {
    let mut link = Link::new(io::Cursor::new(vec![0_u8; 0]), FAST);
    let error = link.read(0, 1).unwrap_err().to_string();
    assert!(
        error.starts_with("no reply in 20 attempts of 0 ms, 0 damaged frames: is the hardware powered"),
        "{error}"
    );
}

/// Writes one to five words per call, and reads up to `most` words, which must be those of the bench's registers. Returns the address and
/// the word of every write, in order.
pub(crate) fn write_and_read<L: AnyLine>(link: &mut Link<L>, calls: u32, most: u32) -> Vec<(u16, u32)> {
    let mut expected = Vec::new();
    for call in 0..calls {
        let words: Vec<u32> = (0..1 + call % 5)
            .map(|word| (call * 8 + word).wrapping_mul(0x9e37_79b1))
            .collect();
        let address = (call % 400) as u16;
        link.write(address, &words).unwrap();
        expected.extend((address..).zip(words));
        let count = 1 + (call % most) as u16;
        let read: Vec<u32> = (address..address + count)
            .map(|address| u32::from(address) << 8 | 1)
            .collect();
        assert_eq!(link.read(address, count).unwrap(), read);
    }
    expected
}

/// Every write arrives once and in order, although one byte in 60 is damaged.
fn campaign(calls: u32) -> u64 {
    let mut link = Link::new(line(60), FAST);
    let expected = write_and_read(&mut link, calls, 7);
    let statistics = link.statistics();
    let line = link.into_line();
    assert!(line.registers.writes == expected);
    assert!(statistics.repeated > u64::from(calls) / 10, "{statistics:?}");
    line.faults
}

#[test]
fn prop_a_damaged_line_changes_nothing_but_the_time() {
    assert!(campaign(3000) > 2000);
}
