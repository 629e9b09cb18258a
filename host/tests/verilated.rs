//! The library against the Verilog of bridge and stage, bit by bit on the line.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use posicast_blocks::Direction;
use posicast_blocks::linked_stage::address_limit;
use posicast_host::{HostedStage, Link, LinkOptions};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use posicast_taps::TapTable;
use posicast_testbench::blocks::Sources;
use posicast_testbench::linked_stage::LinkedStageBlock;
use posicast_testbench::lockstep::Device;
use posicast_testbench::verilator::Verilated;

/// Clocks of a bit at 3,000,000 baud and 50 MHz, times three.
const THREE_BITS: u64 = 50;

/// The pins of the Verilog: a sender and a receiver of bytes.
struct Line {
    device: Verilated,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    unknown: Vec<u64>,
    /// Thirds of a clock that bits have taken.
    thirds: u64,
    /// Clocks since the falling edge of a start bit, and the bits that were taken since.
    receiving: Option<(u64, u32)>,
    coming: VecDeque<u8>,
}

impl Line {
    fn clocks(&mut self, level: bool, clocks: u64) {
        self.inputs[1] = level.into();
        for _ in 0..clocks {
            self.device
                .step(&self.inputs, &mut self.outputs, &mut self.unknown)
                .unwrap();
            let tx = self.outputs[0] != 0;
            self.receiving = match self.receiving {
                None if tx => None,
                None => Some((0, 0)),
                Some((since, bits)) => {
                    let since = since + 1;
                    // The middle of bit k is 1/2 + k bits after the edge.
                    let taken = (6 * since / THREE_BITS).div_ceil(2);
                    let before = (6 * (since - 1) / THREE_BITS).div_ceil(2);
                    let bits = if taken > before && (2..=9).contains(&taken) {
                        bits >> 1 | u32::from(tx) << 7
                    } else {
                        bits
                    };
                    if taken == 10 {
                        self.coming.push_back(bits as u8);
                        None
                    } else {
                        Some((since, bits))
                    }
                }
            };
        }
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            let word = 0x200 | u32::from(*byte) << 1;
            for bit in 0..10 {
                self.thirds += THREE_BITS;
                let clocks = self.thirds / 3;
                self.thirds %= 3;
                self.clocks(word >> bit & 1 != 0, clocks);
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Line {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.clocks(true, 1000);
        if self.coming.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.coming.read(bytes)
    }
}

#[test]
fn long_the_library_operates_the_verilog_of_a_stage_with_its_bridge() {
    let text = include_str!("../../examples/xy-stage.toml");
    let machine = machine_file::parse("xy-stage.toml", &format!("{text}[link]\nbaud = 3_000_000\n")).unwrap();
    let design = design_machine(&machine).unwrap();
    let hardware = Hardware::of(&machine, &design).unwrap();
    let stage = hardware.stage().unwrap().unwrap();
    let config = machine
        .link
        .unwrap()
        .bridge(&machine.clock, address_limit(&stage.component))
        .unwrap();
    let names = ["xy_link", "xy_stage", "xy"];
    let block = LinkedStageBlock::new(&stage.of_machine.config, (config, 50e6), names).unwrap();
    let device = Sources::write(&block).unwrap().verilated(&block, 1).unwrap();
    let count = |direction| device.ports().iter().filter(|port| port.direction == direction).count();
    let (inputs, outputs) = (count(Direction::Input), count(Direction::Output));
    let mut line = Line {
        device,
        inputs: vec![0; inputs],
        outputs: vec![0; outputs],
        unknown: vec![0; outputs],
        thirds: 0,
        receiving: None,
        coming: VecDeque::new(),
    };
    line.inputs[0] = 1;
    line.clocks(true, 10);
    line.receiving = None;
    line.inputs[0] = 0;
    line.clocks(true, 1000);
    let options = LinkOptions {
        timeout: Duration::from_secs(5),
        attempts: 1,
    };
    let mut host = HostedStage::open(Link::new(line, options), &machine, stage).unwrap();
    let all = host.status().unwrap();
    // Emergency stop and drives: every line of the pins is low.
    assert!(
        posicast_host::causes(all[0].causes).contains(&"emergency-stop"),
        "{all:?}"
    );
    assert_eq!(host.load_table(1, &TapTable::bypass(16).unwrap()).unwrap(), 1);
    host.kick().unwrap();
    assert_eq!(host.status().unwrap()[1].table_bank, 1);
    assert_eq!(host.link().statistics().repeated, 0);
}
