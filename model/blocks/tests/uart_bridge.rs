//! The cycle-accurate model of the bridge compared with the model that knows bytes only, and its times.

use crate::support::link::{REGISTERS, Registers, request};
use crate::support::random_inputs::Random;

use posicast_blocks::link::{Bus, LinkBridge, Request};
use posicast_blocks::uart_bridge::{Inputs, Outputs, UartBridge, UartBridgeConfig};

/// The bridge with its registers, and a host's receiver at its line.
struct Bench {
    bridge: UartBridge,
    constants: Inputs,
    registers: Registers,
    /// Clocks for which the registers wait in each access, and how many of them are over.
    waits: u32,
    waited: u32,
    busy_clocks: u32,
    clocks: u32,
    /// The last clock in which the line to the host was low.
    last_low: u32,
    /// The clock of each access, counted while the bridge is busy.
    accessed: Vec<u32>,
    /// Clocks of a bit, and bytes seen on the line.
    bit_clocks: u32,
    low: Option<u32>,
    bits: u32,
    heard: Vec<u8>,
}

impl Bench {
    fn new(clock_hz: u64, baud: u32) -> Self {
        let config = UartBridgeConfig::new(clock_hz, baud, 0.002, REGISTERS).unwrap();
        Self {
            bridge: UartBridge::new(),
            constants: config.inputs(),
            registers: Registers::NEW,
            waits: 2,
            waited: 0,
            busy_clocks: 0,
            clocks: 0,
            last_low: 0,
            accessed: Vec::new(),
            bit_clocks: (clock_hz as f64 / f64::from(baud)).round() as u32,
            low: None,
            bits: 0,
            heard: Vec::new(),
        }
    }

    fn clock(&mut self, uart_rx: bool) -> Outputs {
        let mut inputs = Inputs {
            uart_rx,
            ..self.constants
        };
        let asked = self.bridge.outputs(&inputs);
        self.busy_clocks += u32::from(asked.busy);
        if asked.avm_read || asked.avm_write {
            inputs.avm_waitrequest = self.waited < self.waits;
            self.waited += 1;
            if !inputs.avm_waitrequest {
                self.waited = 0;
                self.accessed.push(self.busy_clocks);
                if asked.avm_write {
                    self.registers.write(asked.avm_address, asked.avm_writedata)
                } else {
                    inputs.avm_readdata = self.registers.read(asked.avm_address)
                }
            }
        }
        let outputs = self.bridge.step(&inputs);
        self.clocks += 1;
        if !outputs.uart_tx {
            self.last_low = self.clocks;
        }
        self.hear(outputs.uart_tx);
        outputs
    }

    /// Samples each bit in its middle.
    fn hear(&mut self, line: bool) {
        match self.low {
            None if !line => self.low = Some(0),
            None => {}
            Some(clock) => {
                let (bit, within) = (clock / self.bit_clocks, clock % self.bit_clocks);
                if within == self.bit_clocks / 2 {
                    self.bits = (self.bits >> 1) | (u32::from(line) << 9);
                }
                self.low = Some(clock + 1);
                if bit == 9 && within > self.bit_clocks / 2 + 1 {
                    assert_eq!(self.bits & 0x201, 0x200, "start and stop bit");
                    self.heard.push((self.bits >> 1) as u8);
                    self.low = None;
                }
            }
        }
    }

    /// Lets the line be high for a while.
    fn idle(&mut self) {
        (0..500).for_each(|_| {
            self.clock(true);
        });
    }

    fn byte(&mut self, byte: u8) {
        let bits = 0x200 | u32::from(byte) << 1;
        for clock in 0..10 * self.bit_clocks {
            self.clock(bits >> (clock / self.bit_clocks) & 1 != 0);
        }
    }

    /// Lets the bridge finish its reply, and returns it.
    fn reply(&mut self) -> Vec<u8> {
        let mut quiet = 0;
        while quiet < 40 * self.bit_clocks {
            let outputs = self.clock(true);
            quiet = if outputs.busy || !outputs.uart_tx { 0 } else { quiet + 1 };
        }
        std::mem::take(&mut self.heard)
    }
}

/// Damaged and whole frames, in any order: both models answer the same bytes, and leave the same registers.
#[test]
fn prop_the_model_of_bytes_and_the_model_of_clocks_agree() {
    for (clock_hz, baud) in [
        (50_000_000, 3_000_000),
        (24_000_000, 3_000_000),
        (100_000_000, 2_000_000),
    ] {
        let mut random = Random(u64::from(baud) + clock_hz);
        let mut bench = Bench::new(clock_hz, baud);
        let (mut bytes, mut registers) = (LinkBridge::new(REGISTERS), Registers::NEW);
        let mut answers = 0;
        bench.idle();
        for sequence in 0..100_u8 {
            let mut frame = request(&mut random).encode(1 + sequence / 2).unwrap();
            match random.below(6) {
                0 => drop(frame.remove(random.below(frame.len() as u64) as usize)),
                1 => frame[random.below(9) as usize] ^= 1 << random.below(8),
                _ => {}
            }
            let mut expected = Vec::new();
            for byte in frame {
                expected.extend(bytes.byte(byte, &mut registers).unwrap_or_default());
                bench.byte(byte);
                if !expected.is_empty() {
                    break;
                }
            }
            assert_eq!(bench.reply(), expected, "{sequence}");
            assert_eq!(bench.registers, registers, "{sequence}");
            answers += u32::from(!expected.is_empty());
        }
        assert!((60..95).contains(&answers), "{answers} of 100 answered");
    }
}

/// The time-out is that of the configuration: 2 ms are 6000 bits of 16.67 clocks.
#[test]
fn a_pause_within_a_frame_drops_it_after_the_time_out() {
    for (clocks, answered) in [(99_000, true), (101_000, false)] {
        let mut bench = Bench::new(50_000_000, 3_000_000);
        let frame = Request::Write {
            address: 1,
            words: vec![5],
        }
        .encode(1)
        .unwrap();
        bench.idle();
        for (place, byte) in frame.iter().enumerate() {
            bench.byte(*byte);
            if place == 6 {
                (0..clocks).for_each(|_| {
                    bench.clock(true);
                });
            }
        }
        assert_eq!(
            (bench.reply().is_empty(), bench.registers.words[1]),
            (!answered, if answered { 5 } else { 0 })
        );
    }
}

/// The clocks of the datasheet: from `busy` to the access of each word, with registers that do not wait.
#[test]
fn clocks_from_the_end_of_a_request_to_its_accesses() {
    let words = |count: u32| vec![0x0101_0101; count as usize];
    let list = |count: u32| (0..count as u16).collect::<Vec<u16>>();
    for (request, first, each) in [
        (
            Request::Write {
                address: 3,
                words: words(1),
            },
            57,
            vec![],
        ),
        (
            Request::Write {
                address: 3,
                words: words(4),
            },
            87,
            vec![10, 10, 10],
        ),
        (
            Request::WriteList(list(4).into_iter().zip(words(4)).collect()),
            99,
            vec![14, 14, 14],
        ),
        (Request::Read { address: 3, count: 1 }, 41, vec![]),
        (Request::Read { address: 3, count: 4 }, 47, vec![33, 36, 36]),
        (Request::ReadList(list(4)), 59, vec![37, 36, 36]),
    ] {
        let mut bench = Bench::new(50_000_000, 3_000_000);
        bench.waits = 0;
        bench.idle();
        request.encode(1).unwrap().into_iter().for_each(|byte| bench.byte(byte));
        bench.reply();
        let between: Vec<u32> = bench.accessed.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert_eq!((bench.accessed[0], between), (first, each), "{request:?}");
    }
}

/// The figures of `docs/hosts.md`, for a write of one word at 3,000,000 baud: from its first bit to the bus, and to the stop bit
/// of the reply. The host's bits are those of the bridge or 2 % longer.
#[test]
fn clocks_from_the_first_bit_of_a_write_to_the_bus_and_to_the_end_of_the_reply() {
    let mut bench = Bench::new(50_000_000, 3_000_000);
    bench.waits = 0;
    bench.idle();
    let begin = bench.clocks;
    let frame = Request::Write {
        address: 3,
        words: vec![7],
    };
    let mut to_bus = None;
    for byte in frame.encode(1).unwrap() {
        let bits = 0x200 | u32::from(byte) << 1;
        for clock in 0..10 * bench.bit_clocks {
            let outputs = bench.clock(bits >> (clock / bench.bit_clocks) & 1 != 0);
            to_bus = to_bus.or(outputs.avm_write.then_some(bench.clocks - begin));
        }
    }
    while to_bus.is_none() {
        let outputs = bench.clock(true);
        to_bus = outputs.avm_write.then_some(bench.clocks - begin);
    }
    bench.reply();
    let to_reply = bench.last_low - begin;
    assert!((2590..=2620).contains(&to_bus.unwrap()), "{to_bus:?}");
    assert!((4250..=4310).contains(&to_reply), "{to_reply}");
}
