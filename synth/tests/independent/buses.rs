//! A component on AXI4-Lite and on Wishbone, accessed by the masters of cocotbext-axi and cocotbext-wishbone in Icarus, and compared
//! access by access with its bit-exact model.

use super::{output, python, stage, write};
use posicast_blocks::bus_component::BridgedBus;
use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::registers::Access;
use posicast_blocks::{ClockedBlock, Direction};
use posicast_testbench::blocks::Block;
use posicast_testbench::bus_component::BusComponentBlock;
use std::path::Path;

/// Inputs of the component's own bus, with reset.
const BUS_INPUTS: usize = 6;

/// The component's model on its own bus, an access at a time.
struct Model {
    model: Composed,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    read_data: usize,
}

impl Model {
    fn new(component: &Component) -> Self {
        let ports = component.composition().ports();
        let count = |wanted| ports.iter().filter(|port| port.direction == wanted).count();
        let mut outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let mut model = Self {
            inputs: vec![0; count(Direction::Input)],
            outputs: vec![0; count(Direction::Output)],
            read_data: outputs.position(|port| port.name == "avs_readdata").unwrap(),
            model: component.model(1),
        };
        model.clock([1, 0, 0, 0, 0, 0]);
        model
    }

    fn clock(&mut self, bus: [u64; BUS_INPUTS]) {
        self.inputs[..BUS_INPUTS].copy_from_slice(&bus);
        self.model.step(&self.inputs, &mut self.outputs).unwrap();
    }

    fn write(&mut self, word: u64, data: u64, bytes: u64) {
        self.clock([0, word, 0, 1, bytes, data]);
        self.clock([0; BUS_INPUTS]);
    }

    fn read(&mut self, word: u64) -> u64 {
        self.clock([0, word, 1, 0, 0, 0]);
        self.clock([0; BUS_INPUTS]);
        self.outputs[self.read_data]
    }
}

/// Whether a read of the word depends on what was written alone, not on when.
fn is_timeless(component: &Component, word: u64) -> bool {
    let registers = component.map().registers().iter();
    let mut of_word = registers.filter(|of| (of.offset..of.offset + of.words()).contains(&(word as u32)));
    of_word.next().is_none_or(|register| {
        matches!(
            register.access,
            Access::Constant | Access::Configuration | Access::Command { .. } | Access::Snapshot
        )
    })
}

fn counter() -> Component {
    Component::pulse_counter(DividerConfig::new(5000).unwrap(), 8, false).unwrap()
}

fn answers_as_the_model(component: &Component, name: &str, accesses: usize) {
    let bus = match name {
        "axi" => BridgedBus::AxiLite,
        _ => BridgedBus::Wishbone { pipelined: false },
    };
    let block = BusComponentBlock::new(component.clone(), bus, &[], ["bus_top", "inner", "alone"]);
    let inputs = component.composition().ports().iter();
    let inputs = inputs
        .filter(|port| port.direction == Direction::Input)
        .skip(BUS_INPUTS);
    let pins: Vec<&str> = inputs.map(|port| port.name.as_str()).collect();
    let folder = tempfile::tempdir().unwrap();
    let modules = block.modules().unwrap();
    let files = modules
        .iter()
        .map(|module| write(folder.path(), &format!("{}.v", module.name), &module.text));
    let log = folder.path().join("log");
    let build = folder.path().join("build");
    let mut run = python("run_cocotb.py");
    run.env("POSICAST_BUS", name)
        .env("POSICAST_WORDS", component.map().words().to_string())
        .env("POSICAST_PINS", pins.join(","))
        .env("POSICAST_ACCESSES", accesses.to_string())
        .env("POSICAST_LOG", &log);
    if name == "pipelined" {
        run.env("POSICAST_PARAMETERS", "PIPELINED=1");
    }
    let bench = [Path::new("bench_bus"), Path::new("bus_top"), &build];
    let said = output(run.args(bench).args(files));
    assert!(said.contains("1 tests, 0 failed"), "{said}");

    let mut model = Model::new(component);
    let (mut read, mut refused) = (0, 0);
    let text = std::fs::read_to_string(log).unwrap();
    for (number, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split(' ').collect();
        let [word, data, rest @ ..] = &words[1..]
            .iter()
            .map(|word| word.parse().unwrap())
            .collect::<Vec<u64>>()[..]
        else {
            panic!("{line}");
        };
        let registers = component.map().registers().iter();
        let is_mapped = registers
            .clone()
            .any(|of| (of.offset..of.offset + of.words()).contains(&(*word as u32)));
        assert_eq!(rest.last(), Some(&u64::from(!is_mapped)), "access {number}: {line}");
        refused += u64::from(!is_mapped);
        if words[0] == "w" {
            model.write(*word, *data, rest[0]);
        } else {
            let expected = model.read(*word);
            if is_timeless(component, *word) {
                assert_eq!(*data, expected, "access {number}: {line}");
                read += u64::from(expected != 0);
            }
        }
    }
    assert_eq!(text.lines().count(), accesses);
    assert!(
        read * 40 > accesses as u64 && refused * 10 > accesses as u64,
        "{read} {refused}"
    );
}

#[test]
fn crosssim_a_manager_of_axi4_lite_gets_what_the_model_gives() {
    answers_as_the_model(&counter(), "axi", 3000);
}

#[test]
fn crosssim_a_master_of_wishbone_gets_what_the_model_gives() {
    answers_as_the_model(&counter(), "wishbone", 3000);
}

#[test]
fn crosssim_a_master_of_pipelined_wishbone_gets_what_the_model_gives() {
    answers_as_the_model(&counter(), "pipelined", 3000);
}

#[test]
fn long_crosssim_a_stage_on_axi4_lite_and_on_wishbone_gives_what_its_model_gives() {
    for bus in ["axi", "wishbone"] {
        answers_as_the_model(&stage(), bus, 1500);
    }
}

#[test]
fn long_masters_of_other_buses_make_a_hundred_thousand_accesses() {
    for bus in ["axi", "wishbone", "pipelined"] {
        answers_as_the_model(&counter(), bus, 100_000);
    }
}
