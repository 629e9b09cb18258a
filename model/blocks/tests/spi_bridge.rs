//! The cycle-accurate model of the bridge compared with the model that knows bytes only, and its times.

use crate::support::link::{REGISTERS, Registers, request};
use crate::support::random_inputs::Random;

use posicast_blocks::link::{Bus, LinkBridge, Reply, Request};
use posicast_blocks::spi_bridge::{Inputs, Outputs, SpiBridge, SpiBridgeConfig};

/// The bridge with its registers, and a host that is its SPI controller.
struct Bench {
    bridge: SpiBridge,
    constants: Inputs,
    registers: Registers,
    /// Clocks of half a period of `spi_sck`.
    half: u32,
    /// Clocks for which the registers wait in each access, and how many of them are over.
    waits: u32,
    waited: u32,
    clocks: u32,
    busy_clocks: u32,
    busy: bool,
    /// The clock of each access, counted while the bridge is busy, and from the start.
    accessed: Vec<(u32, u32)>,
}

impl Bench {
    fn new(half: u32) -> Self {
        let config = SpiBridgeConfig::new(50_000_000, 0.002, REGISTERS).unwrap();
        let mut bench = Self {
            bridge: SpiBridge::new(),
            constants: config.inputs(),
            registers: Registers::NEW,
            half,
            waits: 2,
            waited: 0,
            clocks: 0,
            busy_clocks: 0,
            busy: false,
            accessed: Vec::new(),
        };
        bench.deselect();
        bench
    }

    fn clock(&mut self, spi_cs_n: bool, spi_sck: bool, spi_mosi: bool) -> Outputs {
        let mut inputs = Inputs {
            spi_cs_n,
            spi_sck,
            spi_mosi,
            ..self.constants
        };
        let asked = self.bridge.outputs(&inputs);
        self.busy = asked.busy;
        self.busy_clocks += u32::from(asked.busy);
        if asked.avm_read || asked.avm_write {
            inputs.avm_waitrequest = self.waited < self.waits;
            self.waited += 1;
            if !inputs.avm_waitrequest {
                self.waited = 0;
                self.accessed.push((self.busy_clocks, self.clocks));
                if asked.avm_write {
                    self.registers.write(asked.avm_address, asked.avm_writedata)
                } else {
                    inputs.avm_readdata = self.registers.read(asked.avm_address)
                }
            }
        }
        self.clocks += 1;
        self.bridge.step(&inputs)
    }

    /// Lets the lines be for some clocks, and returns the last level of the line to the host.
    fn lines(&mut self, spi_cs_n: bool, spi_sck: bool, spi_mosi: bool, clocks: u32) -> bool {
        let levels = (0..clocks).map(|_| self.clock(spi_cs_n, spi_sck, spi_mosi).spi_miso);
        levels.last().unwrap_or(false)
    }

    fn select(&mut self) {
        self.lines(false, false, false, self.half);
    }

    fn deselect(&mut self) {
        self.lines(true, false, false, self.half + 4);
    }

    /// Clocks the upper bits of a byte in both directions. The host takes its bit with the rising edge.
    fn bits(&mut self, byte: u8, count: u32) -> u8 {
        (0..count).fold(0, |taken, bit| {
            let mosi = byte >> (7 - bit) & 1 != 0;
            let miso = self.lines(false, false, mosi, self.half);
            self.lines(false, true, mosi, self.half);
            taken << 1 | u8::from(miso)
        })
    }

    fn byte(&mut self, byte: u8) -> u8 {
        self.bits(byte, 8)
    }

    /// A selection: clocks these bytes, and gives what came.
    fn transfer(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.select();
        let taken = bytes.iter().map(|byte| self.byte(*byte)).collect();
        self.deselect();
        taken
    }

    /// Clocks bytes 00 until the bridge has nothing more to say. A new selection begins before one byte in `cut`.
    fn reply(&mut self, cut: u64, random: &mut Random) -> Vec<u8> {
        let mut reply = Vec::new();
        let mut quiet = 0;
        self.select();
        while quiet < 3 {
            if random.below(cut) == 0 {
                self.deselect();
                self.select();
            }
            let byte = self.byte(0);
            quiet = if self.busy { 0 } else { quiet + 1 };
            reply.extend((byte != 0 || !reply.is_empty()).then_some(byte));
        }
        self.deselect();
        let end = reply
            .iter()
            .position(|byte| *byte == 0)
            .map_or(reply.len(), |end| end + 1);
        assert!(reply[end..].iter().all(|byte| *byte == 0), "{reply:?}");
        reply.truncate(end);
        reply
    }
}

fn write(word: u32) -> Request {
    Request::Write {
        address: 3,
        words: vec![word],
    }
}

/// Damaged and whole frames, in any order and in any selections: both models answer the same bytes, and leave the same registers.
#[test]
fn prop_the_model_of_bytes_and_the_model_of_clocks_agree() {
    for half in [4, 5, 23] {
        let mut random = Random(u64::from(half));
        let mut bench = Bench::new(half);
        let (mut bytes, mut registers) = (LinkBridge::new(REGISTERS), Registers::NEW);
        let mut answers = 0;
        for sequence in 0..60_u8 {
            let mut frame = request(&mut random).encode(1 + sequence / 2).unwrap();
            match random.below(6) {
                0 => drop(frame.remove(random.below(frame.len() as u64) as usize)),
                1 => frame[random.below(9) as usize] ^= 1 << random.below(8),
                _ => {}
            }
            // The bytes 00 by which the host asks for the reply end a frame without its end.
            frame.push(0);
            let mut expected = Vec::new();
            bench.select();
            for byte in frame {
                if random.below(8) == 0 {
                    bench.deselect();
                    bench.select();
                }
                expected.extend(bytes.byte(byte, &mut registers).unwrap_or_default());
                assert_eq!(bench.byte(byte), 0, "the bridge has nothing to say");
                if !expected.is_empty() {
                    break;
                }
            }
            bench.deselect();
            assert_eq!(bench.reply(8, &mut random), expected, "{sequence}");
            assert_eq!(bench.registers, registers, "{sequence}");
            answers += u32::from(!expected.is_empty());
        }
        assert!((35..60).contains(&answers), "{answers} of 60 answered");
    }
}

/// Bits that are lost or invented shift the bytes up to the end of the selection: nothing is written, and the next selection is whole.
#[test]
fn bits_that_are_lost_or_invented_shift_nothing_beyond_the_selection() {
    for count in [1, 7, 9, 15] {
        let mut bench = Bench::new(4);
        let frame = write(7).encode(1).unwrap();
        bench.select();
        bench.byte(frame[0]);
        bench.bits(frame[1], 8 * (count / 8));
        bench.bits(frame[1], count % 8);
        for byte in &frame[2..] {
            bench.byte(*byte);
        }
        bench.deselect();
        let mut random = Random(1);
        assert_eq!(bench.reply(99, &mut random), [0; 0]);
        assert_eq!(bench.registers, Registers::NEW);
        // The host ends what the bridge may have taken for the beginning of a frame, and repeats.
        bench.transfer(&[0]);
        bench.transfer(&frame);
        let reply = bench.reply(99, &mut random);
        assert!(Reply::decode(&reply[..reply.len() - 1]).unwrap().status.is_ok());
        assert_eq!(bench.registers.words[3], 7);
    }
}

/// A byte of the reply that was not begun is there in the next selection; one that was begun is lost, and a repetition of the
/// request gets the whole reply without a second write.
#[test]
fn a_selection_that_ends_within_a_byte_loses_that_byte_of_the_reply() {
    for (bits, lost) in [(0, false), (1, true), (7, true)] {
        let mut bench = Bench::new(4);
        let frame = write(7).encode(1).unwrap();
        bench.transfer(&frame);
        bench.lines(true, false, false, 400);
        bench.select();
        bench.bits(0, bits);
        bench.deselect();
        let mut random = Random(1);
        let reply = bench.reply(99, &mut random);
        assert_eq!(
            Reply::decode(&reply[..reply.len() - 1]).is_err(),
            lost,
            "{bits} {reply:?}"
        );
        bench.transfer(&frame);
        let again = bench.reply(99, &mut random);
        assert!(Reply::decode(&again[..again.len() - 1]).unwrap().status.is_ok());
        assert_eq!((bench.registers.words[3], bench.registers.accesses), (7, 1));
    }
}

/// Half a period of four clocks is enough for the line to the host, three are not.
#[test]
fn the_fastest_clock_of_the_host_is_an_eighth() {
    for (half, right) in [(4, true), (3, false)] {
        let mut bench = Bench::new(half);
        bench.transfer(&write(7).encode(1).unwrap());
        bench.lines(true, false, false, 400);
        // Ten bytes of reply and the 0 behind them.
        let taken = bench.transfer(&[0; 11]);
        assert_eq!(Reply::decode(&taken[..9]).is_ok(), right, "{half}: {taken:?}");
        // The line from the host has more time.
        assert_eq!(bench.registers.words[3], 7);
    }
}

/// The time-out is that of the configuration: 2 ms are 100,000 clocks.
#[test]
fn a_pause_within_a_frame_drops_it_after_the_time_out() {
    for (clocks, answered) in [(99_000, true), (101_000, false)] {
        let mut bench = Bench::new(4);
        let frame = write(5).encode(1).unwrap();
        bench.transfer(&frame[..7]);
        bench.lines(true, false, false, clocks);
        bench.transfer(&frame[7..]);
        assert_eq!(
            (bench.reply(99, &mut Random(1)).is_empty(), bench.registers.words[3]),
            (!answered, if answered { 5 } else { 0 })
        );
    }
}

/// The figures of `docs/hosts.md`, for a write of one word at an eighth of the clock: from the selection to the bus, and to the
/// end of the selection in which the reply's last byte came.
#[test]
fn clocks_from_the_selection_for_a_write_to_the_bus_and_to_the_end_of_the_reply() {
    let mut bench = Bench::new(4);
    bench.waits = 0;
    let begin = bench.clocks;
    bench.transfer(&write(7).encode(1).unwrap());
    bench.select();
    let mut ended = 0;
    while ended < 2 {
        let byte = bench.byte(0);
        ended = match (ended, byte) {
            (0, 0) => 0,
            (_, 0) => 2,
            _ => 1,
        };
    }
    bench.deselect();
    let (busy, bus) = bench.accessed[0];
    assert_eq!((busy, bus - begin), (57, 1021));
    assert_eq!(bench.clocks - begin, 1688);
}
