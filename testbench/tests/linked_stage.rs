//! The stage with its line, serial or SPI: compares the joined Verilog of stage and bridge with the model, and checks the replies that a
//! host at the line gets.

use posicast_blocks::component::Component;
use posicast_blocks::link::{Reply, Request};
use posicast_blocks::linked_stage::{BridgeConfig, LinkedStage, address_limit};
use posicast_blocks::stage::StageConfig;
use posicast_blocks::{ClockedBlock, Direction, Port};
use posicast_machine::hardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_testbench::blocks;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::linked_stage::{DenseLinkBlock, LinkedStageBlock};
use posicast_testbench::lockstep::report::LockstepVerdict;
use posicast_testbench::named_mutant::NamedMutant;

/// Clocks of a bit at 3,000,000 baud and 50 MHz, times three.
const THREE_BITS: u64 = 50;

const UART: &str = "baud = 3_000_000";
const SPI: &str = "line = \"spi\"\nsck_hz = 6_250_000";
/// Clocks of half a bit at 6.25 MHz and 50 MHz.
const HALF_BIT: u64 = 4;

/// The machine of the example with this line.
fn machine(line: &str) -> Machine {
    let text = include_str!("../../examples/xy-stage.toml");
    machine_file::parse("xy-stage.toml", &format!("{text}[link]\n{line}\n")).unwrap()
}

/// The stage of the machine, and the constants of its bridge.
fn stage(machine: &Machine) -> (Component, BridgeConfig) {
    let stage = hardware::stage(machine, &design_machine(machine).unwrap())
        .unwrap()
        .unwrap();
    let component = Component::stage(&stage.config).unwrap();
    let link = machine.link.unwrap();
    let config = link.bridge(&machine.clock, address_limit(&component)).unwrap();
    (component, config)
}

fn block(line: &str) -> (StageConfig, LinkedStageBlock) {
    let machine = machine(line);
    let (_, config) = stage(&machine);
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap())
        .unwrap()
        .unwrap()
        .config;
    let block = LinkedStageBlock::new(&stage, (config, 50e6), ["xy_link", "xy_stage", "xy"]).unwrap();
    (stage, block)
}

/// The same block with the fastest line and short ticks, so that the most happens per clock.
fn dense(line: &str) -> DenseLinkBlock {
    let (stage, machine) = block(line);
    DenseLinkBlock::new(&stage, &machine).unwrap().unwrap()
}

/// A few requests in the simulator that compiles fast; the long tests have many.
fn a_few_requests_agree(line: &str) {
    let block = dense(line);
    let sources = Sources::write(&block).unwrap();
    assert_eq!(sources.lint(&block).unwrap(), [""; 0]);
    let mut device = sources.icarus(&block).unwrap();
    let report = blocks::check(&block, &mut device, 8_000, 1, &mut |_| {}).unwrap();
    assert_eq!(report.mismatches(), 0, "{:?}", report.blocks);
}

#[test]
fn lockstep_a_host_at_the_serial_line_of_a_stage() {
    a_few_requests_agree(UART);
}

#[test]
fn long_lockstep_a_host_at_the_spi_lines_of_a_stage() {
    a_few_requests_agree(SPI);
}

/// A driver at the line reaches the same as one at the bus. Only the model runs, so this tests the stimuli alone.
fn reaches_everything(line: &str, clocks: u64) {
    let block = dense(line);
    let mut model = posicast_testbench::lockstep::TwoValued(block.model(1));
    let report = blocks::judge(&block, &mut model, clocks..=clocks, 1, &mut |_| {}).unwrap();
    assert_eq!(
        report.result,
        LockstepVerdict::Match,
        "{:?}",
        report.not_exercised_names()
    );
    assert!(report.samples > 200, "{}", report.samples);
    let reached = &report.blocks[0].reached;
    let count = |what: &str| reached.iter().find(|count| count.what == what).unwrap().count;
    for axis in ["x", "y"] {
        assert!(count(&format!("moves of {axis}")) >= 1, "{reached:?}");
        assert!(count(&format!("taps of {axis}")) >= 2, "{reached:?}");
    }
}

#[test]
fn a_driver_at_the_serial_line_moves_every_axis_and_loads_tables() {
    reaches_everything(UART, 300_000);
}

#[test]
fn long_a_driver_at_the_spi_lines_moves_every_axis_and_loads_tables() {
    reaches_everything(SPI, 400_000);
}

/// Faults that a million clocks of the former row did not find: the halves of each word of a memory, and single bits.
const MUTANTS: [NamedMutant<'static>; 6] = [
    NamedMutant {
        name: "a read that is taken in its first clock",
        module: None,
        from: "(avm_read & ~read_before)",
        to: "(1'b0)",
    },
    NamedMutant {
        name: "the halves of a history's words exchanged",
        module: Some("ram_128x32"),
        from: "words[write_address] <= write_data;",
        to: "words[write_address] <= {write_data[15:0], write_data[31:16]};",
    },
    NamedMutant {
        name: "a bit of the taps inverted",
        module: Some("ram_128x25"),
        from: "words[write_address] <= write_data;",
        to: "words[write_address] <= write_data ^ 25'h40;",
    },
    NamedMutant {
        name: "a bit of the shaped position inverted",
        module: Some("xy_stage_x"),
        from: ".reference_position     (shaped_position)",
        to: ".reference_position     (shaped_position ^ 32'h1000)",
    },
    NamedMutant {
        name: "a bit of the measured position inverted",
        module: Some("xy_stage_y"),
        from: ".position               (captured_position)",
        to: ".position               (captured_position ^ 32'h10)",
    },
    NamedMutant {
        name: "a bit of the controller's duty inverted",
        module: Some("xy_stage_y"),
        from: ".controller_duty    (controller_duty)",
        to: ".controller_duty    (controller_duty ^ 18'h4)",
    },
];

fn every_mutant_is_found(line: &str) {
    let block = dense(line);
    let sources = Sources::write(&block).unwrap();
    let mut device = sources.verilated(&block, 1).unwrap();
    let report = blocks::judge(&block, &mut device, 400_000..=400_000, 1, &mut |_| {}).unwrap();
    assert_eq!(report.result, LockstepVerdict::Match, "{:?}", report.blocks[0].first);
    for mutant in &MUTANTS {
        let sources = Sources::of_modules(&mutant.put_into(&block.modules().unwrap()).unwrap()).unwrap();
        let mut device = sources.verilated(&block, 1).unwrap();
        let report = blocks::check(&block, &mut device, 400_000, 1, &mut |_| {}).unwrap();
        assert!(report.mismatches() > 0, "{}", mutant.name);
    }
}

#[test]
fn long_lockstep_catches_every_mutant_behind_the_serial_line() {
    every_mutant_is_found(UART);
}

#[test]
fn long_lockstep_catches_every_mutant_behind_the_spi_lines() {
    every_mutant_is_found(SPI);
}

/// A line with a host at it: sends a request, and returns the reply and the clocks from the first bit of the request to the last of the
/// reply.
fn ask(linked: &mut LinkedStage, request: &Request, sequence: u8) -> (Reply, u64) {
    let inputs = linked
        .ports()
        .iter()
        .filter(|port| port.direction == Direction::Input)
        .count();
    let mut idle = vec![0; inputs];
    idle[1] = 1;
    let mut outputs = vec![0; linked.ports().len() - inputs];
    let mut clocks = 0;
    let mut tx = Vec::new();
    let mut step = |level: bool, tx: &mut Vec<bool>| {
        idle[1] = level.into();
        linked.step(&idle, &mut outputs).unwrap();
        tx.push(outputs[0] != 0);
        clocks += 1;
    };
    let mut third = 0;
    for byte in request.encode(sequence).unwrap() {
        let bits = 0x200 | u32::from(byte) << 1;
        for bit in 0..10 {
            third += THREE_BITS;
            let wait = third / 3;
            third %= 3;
            (0..wait).for_each(|_| step(bits >> bit & 1 != 0, &mut tx));
        }
    }
    (0..40_000).for_each(|_| step(true, &mut tx));
    // A receiver of its own: the middle of each bit, from the falling edge.
    let (mut at, mut bytes, mut last) = (0, Vec::new(), 0);
    while at < tx.len() {
        if tx[at] {
            at += 1;
            continue;
        }
        let level = |bit: u64| tx[at + ((2 * bit + 1) * THREE_BITS / 6) as usize];
        bytes.push((0..8).fold(0_u8, |byte, bit| byte | u8::from(level(1 + bit)) << bit));
        assert!(level(9), "a stop bit");
        at += (19 * THREE_BITS / 6) as usize;
        last = at as u64;
    }
    let end = bytes.pop();
    assert_eq!(end, Some(0));
    (Reply::decode(&bytes).unwrap(), last)
}

/// The same over SPI: a selection with the request and with bytes 00 until the reply has come. The clocks are those from the selection to
/// its end.
fn ask_spi(linked: &mut LinkedStage, request: &Request, sequence: u8) -> (Reply, u64) {
    let is_input = |port: &&Port| port.direction == Direction::Input;
    let inputs = linked.ports().iter().filter(is_input).count();
    let (mut levels, mut outputs) = (vec![0; inputs], vec![0; linked.ports().len() - inputs]);
    let mut clocks = 0;
    let mut lines = |[sck, cs_n, mosi]: [bool; 3]| {
        levels[1..4].copy_from_slice(&[sck, cs_n, mosi].map(u64::from));
        for _ in 0..HALF_BIT {
            linked.step(&levels, &mut outputs).unwrap();
        }
        clocks += HALF_BIT;
        outputs[0] != 0
    };
    // Not selected: what a host does between two requests.
    lines([false, true, false]);
    lines([false, true, false]);
    lines([false, false, false]);
    let mut sent = request.encode(sequence).unwrap().into_iter();
    let (mut bytes, mut asked) = (Vec::new(), 0);
    while bytes.is_empty() || bytes.last() != Some(&0) {
        let byte = sent.next().unwrap_or(0);
        let taken = (0..8).rev().fold(0, |taken, bit| {
            let mosi = byte >> bit & 1 != 0;
            let miso = lines([false, false, mosi]);
            lines([true, false, mosi]);
            taken << 1 | u8::from(miso)
        });
        if taken != 0 || !bytes.is_empty() {
            bytes.push(taken);
        }
        asked += 1;
        assert!(asked < 1000, "no reply");
    }
    lines([false, true, false]);
    bytes.pop();
    (Reply::decode(&bytes).unwrap(), clocks - 2 * HALF_BIT)
}

#[test]
fn golden_a_host_over_spi_reads_the_constants_and_writes_a_register() {
    let machine = machine(SPI);
    let (component, config) = stage(&machine);
    let mut linked = LinkedStage::new(&component, &config, 1);
    let (reply, _) = ask_spi(&mut linked, &Request::Read { address: 0, count: 7 }, 0);
    let letters = u32::from_le_bytes(*b"STGE");
    assert_eq!(reply.words[..4], [letters, 0x2_0002, 2, 5000]);
    assert_eq!(reply.words[6], machine.link.unwrap().machine_crc);
    // The interrupt enables, word 13 of the stage's map.
    let (reply, clocks) = ask_spi(&mut linked, &Request::WriteList(vec![(0x0d, 0x1234)]), 1);
    assert!(reply.status.is_ok());
    // The datasheet: 1688 clocks up to the last edge for a write of one word, whose frame is a byte shorter than that of a list.
    assert!((1688..1688 + 64 + 3 * HALF_BIT).contains(&clocks), "{clocks}");
    let (reply, _) = ask_spi(&mut linked, &Request::ReadList(vec![0x0d, 0x00]), 2);
    assert_eq!(reply.words, [0x1234, letters]);
    let (reply, _) = ask_spi(&mut linked, &Request::ReadList(vec![0x300]), 3);
    assert_eq!(reply.status, posicast_blocks::link::LinkStatus::WrongAddress);
}

#[test]
fn golden_a_host_at_the_serial_line_reads_the_constants_and_writes_a_register() {
    let machine = machine(UART);
    let (component, config) = stage(&machine);
    let mut linked = LinkedStage::new(&component, &config, 1);
    let (reply, _) = ask(&mut linked, &Request::Read { address: 0, count: 7 }, 0);
    let crc = machine.link.unwrap().machine_crc;
    let letters = u32::from_le_bytes(*b"STGE");
    assert_eq!(reply.words[..4], [letters, 0x2_0002, 2, 5000]);
    assert_eq!(reply.words[6], crc);
    // The interrupt enables, word 13 of the stage's map.
    let (reply, clocks) = ask(&mut linked, &Request::WriteList(vec![(0x0d, 0x1234)]), 1);
    assert!(reply.status.is_ok());
    // The datasheet: 2500 clocks on the line, 57 in the bridge, 1667 for the reply; a stop bit's rest is not awaited here.
    assert!((4180..4260).contains(&clocks), "{clocks}");
    let (reply, _) = ask(&mut linked, &Request::ReadList(vec![0x0d, 0x00]), 2);
    assert_eq!(reply.words, [0x1234, letters]);
    // Beyond the windows of the stage and its two axes.
    let (reply, _) = ask(&mut linked, &Request::ReadList(vec![0x300]), 3);
    assert_eq!(reply.status, posicast_blocks::link::LinkStatus::WrongAddress);
}
