//! The host's end over SPI: against the cycle-accurate bridge, whose lines lose and invent edges and damage bits, and against a stage.

use std::io::{self, Read, Write};
use std::time::Duration;

use crate::faults::write_and_read;
use crate::stage::stage;
use posicast_blocks::link::{DELIMITER, Reply, Request};
use posicast_blocks::linked_stage::{LinkedStage, address_limit};
use posicast_blocks::spi_bridge::{Inputs, SpiBridge, SpiBridgeConfig};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_host::{HostedStage, Link, LinkOptions, SpiLine, SpiTransfer};
use posicast_machine::machine_file;
use posicast_taps::TapTable;

const REGISTERS: u16 = 512;
/// Clocks of half a bit: the fastest host.
const HALF: u32 = 4;

/// The bridge and its registers, behind lines of which one bit in `one_in` is damaged; 0: none.
struct Bench {
    bridge: SpiBridge,
    constants: Inputs,
    waited: bool,
    writes: Vec<(u16, u32)>,
    one_in: u64,
    random: u64,
    faults: u64,
    clocks: u64,
}

impl Bench {
    fn new(one_in: u64) -> Self {
        Self {
            bridge: SpiBridge::new(),
            constants: SpiBridgeConfig::new(50_000_000, 0.001, REGISTERS).unwrap().inputs(),
            waited: false,
            writes: Vec::new(),
            one_in,
            random: 1,
            faults: 0,
            clocks: 0,
        }
    }

    /// xorshift64 (Marsaglia 2003).
    fn below(&mut self, end: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random % end
    }

    /// Simulates clocks with these levels, and returns that of the line to the host.
    fn lines(&mut self, spi_cs_n: bool, spi_sck: bool, spi_mosi: bool, clocks: u32) -> bool {
        let mut miso = false;
        for _ in 0..clocks {
            let mut inputs = Inputs {
                spi_cs_n,
                spi_sck,
                spi_mosi,
                ..self.constants
            };
            let asked = self.bridge.outputs(&inputs);
            inputs.avm_waitrequest = asked.avm_read && !self.waited;
            self.waited = inputs.avm_waitrequest;
            inputs.avm_readdata = u32::from(asked.avm_address) << 8 | 1;
            if asked.avm_write {
                self.writes.push((asked.avm_address, asked.avm_writedata));
            }
            miso = self.bridge.step(&inputs).spi_miso;
            self.clocks += 1;
        }
        miso
    }

    fn bit(&mut self, mosi: bool) -> bool {
        let fault = if self.one_in != 0 && self.below(self.one_in) == 0 {
            1 + self.below(4)
        } else {
            0
        };
        self.faults += u64::from(fault != 0);
        // A bit that is changed on the way there or back, an edge that is lost, an edge that is invented.
        let miso = self.lines(false, false, mosi ^ (fault == 1), HALF);
        self.lines(false, fault != 3, mosi ^ (fault == 1), HALF);
        if fault == 4 {
            self.lines(false, false, mosi, HALF);
            self.lines(false, true, mosi, HALF);
        }
        miso ^ (fault == 2)
    }
}

impl SpiTransfer for Bench {
    fn transfer(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.lines(false, false, false, HALF);
        for byte in bytes {
            let sent = *byte;
            *byte = (0..8)
                .rev()
                .fold(0, |taken, bit| taken << 1 | u8::from(self.bit(sent >> bit & 1 != 0)));
        }
        self.lines(true, false, false, 2 * HALF);
        Ok(())
    }
}

fn options(timeout: Duration) -> LinkOptions {
    LinkOptions { timeout, attempts: 20 }
}

#[test]
fn words_are_read_and_written() {
    let mut link = Link::new(SpiLine::new(Bench::new(0)), options(Duration::from_secs(2)));
    assert_eq!(link.read(2, 3).unwrap(), [0x201, 0x301, 0x401]);
    let long = link.read(0, 100).unwrap();
    assert_eq!((long.len(), long[99]), (100, 99 << 8 | 1));
    link.write(5, &[7, 8]).unwrap();
    link.write_list(&[(1, 0), (500, 9)]).unwrap();
    assert_eq!(link.statistics().repeated, 0);
    let mut line = link.into_line();
    assert_eq!(line.controller().writes, [(5, 7), (6, 8), (1, 0), (500, 9)]);
}

/// Every write arrives once and in order, although one bit in 1500 is damaged.
#[test]
fn damaged_bits_write_nothing_wrong_and_nothing_twice() {
    let mut link = Link::new(SpiLine::new(Bench::new(1500)), options(Duration::from_millis(4)));
    let expected = write_and_read(&mut link, 150, 1);
    assert!(link.statistics().repeated > 10, "{:?}", link.statistics());
    let mut line = link.into_line();
    assert!(line.controller().writes == expected);
    assert!(line.controller().faults > 50, "{}", line.controller().faults);
}

/// The rest of a long reply would hide the reply to what the host sends next.
#[test]
fn a_repetition_first_drops_the_rest_of_a_reply() {
    let mut line = SpiLine::new(Bench::new(0));
    let frame = Request::Read { address: 0, count: 40 }.encode(0).unwrap();
    let mut reply = [0; 400];
    line.write_all(&frame).unwrap();
    line.flush().unwrap();
    while line.read(&mut reply).unwrap() == 0 || reply.iter().all(|byte| *byte == 0) {}
    line.write_all(&[DELIMITER]).unwrap();
    line.write_all(&frame).unwrap();
    line.flush().unwrap();
    let mut came = Vec::new();
    while came.len() < 400 {
        let count = line.read(&mut reply).unwrap();
        came.extend(&reply[..count]);
    }
    let mut frames = came.split(|byte| *byte == DELIMITER).filter(|frame| !frame.is_empty());
    let reply = Reply::decode(frames.next().unwrap()).unwrap();
    assert_eq!((reply.words.len(), reply.words[39]), (40, 39 << 8 | 1));
    assert_eq!(frames.next(), None);
}

/// The pins of a stage with its bridge.
struct Pins {
    stage: LinkedStage,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
}

impl Pins {
    fn lines(&mut self, sck: bool, cs_n: bool, mosi: bool) -> bool {
        self.inputs[1..4].copy_from_slice(&[sck, cs_n, mosi].map(u64::from));
        for _ in 0..HALF {
            self.stage.step(&self.inputs, &mut self.outputs).unwrap();
        }
        self.outputs[0] != 0
    }
}

impl SpiTransfer for Pins {
    fn transfer(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.lines(false, false, false);
        for byte in bytes {
            let sent = *byte;
            *byte = (0..8).rev().fold(0, |taken, bit| {
                let mosi = sent >> bit & 1 != 0;
                let miso = self.lines(false, false, mosi);
                self.lines(true, false, mosi);
                taken << 1 | u8::from(miso)
            });
        }
        self.lines(false, true, false);
        Ok(())
    }
}

#[test]
fn a_host_sees_and_loads_the_stage_of_its_machine_file() {
    let text = include_str!("../../examples/xy-stage.toml").to_owned() + "[link]\nline = \"spi\"\nsck_hz = 6_250_000\n";
    let machine = machine_file::parse("xy-stage.toml", &text).unwrap();
    let hardware = stage(&machine);
    let limit = address_limit(&hardware.component);
    let config = machine.link.unwrap().bridge(&machine.clock, limit).unwrap();
    let linked = LinkedStage::new(&hardware.component, &config, 1);
    let count = |direction| linked.ports().iter().filter(|port| port.direction == direction).count();
    let pins = Pins {
        inputs: vec![0; count(Direction::Input)],
        outputs: vec![0; count(Direction::Output)],
        stage: linked,
    };
    let once = LinkOptions {
        timeout: Duration::from_secs(5),
        attempts: 1,
    };
    let link = Link::new(SpiLine::new(pins), once);
    let mut host = HostedStage::open(link, &machine, &hardware).unwrap();
    let all = host.status().unwrap();
    // Emergency stop and drives: every line of the pins is low.
    assert!(
        posicast_host::causes(all[0].causes).contains(&"emergency-stop"),
        "{all:?}"
    );
    assert_eq!(host.load_table(1, &TapTable::bypass(16).unwrap()).unwrap(), 1);
    assert_eq!(host.status().unwrap()[1].table_bank, 1);
    assert_eq!(host.link().statistics().repeated, 0);
}
