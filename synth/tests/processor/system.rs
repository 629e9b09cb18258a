//! Simulates the stage with a core on its bus and a machine at its pins, and the model of the stage beside it.
//!
//! ```text
//!      core ─► avs_* or wb_* ───┬─► stage (Verilog) ─┬─► gates, drive_enable, brake_release ─► plants ─┐
//!                               └─► stage (model) ───┴─► every output equal, in every clock            │
//!                                                        a, b, z, home, drive_fault_n ◄────────────────┘
//! ```

use super::core::Core;
use crate::driver::support::{Driver, run};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::{AxisPlant, DrivePins, PlantOptions};
use posicast_testbench::verilator::{Verilated, VerilogSource};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Size of the core's memory in bytes.
const RAM_BYTES: u32 = 32_768;
/// Counts at which the simulated encoders have their index, and from which on the home switch of X is pressed.
pub(super) const INDEX_AT: i64 = 22;
pub(super) const HOME_FROM: i64 = 30;
const ENCODER: [&str; 3] = ["a", "b", "z"];
const DRIVE: [&str; 6] = ["a_high", "a_low", "b_high", "b_low", "drive_enable", "brake_release"];
/// A program for the core.
pub(super) struct Firmware {
    words: Vec<u32>,
    /// Number of bytes of code and constants, and of variables.
    pub(super) text: u32,
    pub(super) data: u32,
    /// Number of bytes of code and constants of each of the driver's files, by its name, before unused code is removed.
    pub(super) files: Vec<(String, u32)>,
}

/// Returns the number of bytes of `.text`, `.data` and `.bss` of a file.
fn sizes(file: &Path) -> [u32; 3] {
    let said = run(Command::new("riscv64-unknown-elf-size").arg(file));
    let mut numbers = said.lines().nth(1).unwrap().split_whitespace();
    [(); 3].map(|()| numbers.next().unwrap().parse().unwrap())
}

impl Firmware {
    /// Compiles the generated driver with its start code and linker script, and the program of this test.
    pub(super) fn build(driver: &Driver, core: &Core) -> Self {
        let bare_metal = driver.path().join("bare_metal");
        let program = driver.path().join("firmware.elf");
        let gcc = || {
            let mut gcc = Command::new("riscv64-unknown-elf-gcc");
            gcc.args([
                "-march=rv32im",
                "-mabi=ilp32",
                "-Os",
                "-std=c99",
                "-ffreestanding",
                "-ffunction-sections",
            ])
            // These are the Makefile's options for memory.c.
            .args(["-Wall", "-Wextra", "-Werror", "-fno-tree-loop-distribute-patterns"])
            .args(&core.options)
            .arg("-I")
            .arg(driver.path().join("inc"));
            gcc
        };
        let mut files = Vec::new();
        for source in driver.core() {
            let object = source.with_extension("o");
            run(gcc().arg("-c").arg(&source).arg("-o").arg(&object));
            let name = source.file_name().unwrap().to_string_lossy().into_owned();
            files.push((name, sizes(&object)[0]));
        }
        run(gcc()
            .args(["-nostartfiles", "-nostdlib", "-Wl,--gc-sections"])
            .arg(format!("-Wl,--defsym=RAM_BASE={}", core.ram_base))
            .arg(format!("-Wl,--defsym=RAM_BYTES={RAM_BYTES}"))
            .arg("-T")
            .arg(bare_metal.join("link.ld"))
            .arg(here("vector.S"))
            .args(["start.S", "memory.c"].map(|name| bare_metal.join(name)))
            .arg(here("firmware.c"))
            .args(driver.core())
            .args(["-lgcc", "-o"])
            .arg(&program));
        let [text, data, bss] = sizes(&program);
        let image = program.with_extension("bin");
        run(Command::new("riscv64-unknown-elf-objcopy")
            .args(["-O", "binary"])
            .args([&program, &image]));
        let bytes = std::fs::read(image).unwrap();
        let words = bytes.chunks(4).map(|chunk| {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            u32::from_le_bytes(word)
        });
        Self {
            words: words.collect(),
            text,
            data: data + bss,
            files,
        }
    }
}

pub(super) fn here(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/processor").join(name)
}

/// Accesses of the bus in a step of the program.
#[derive(Debug, Clone, Default)]
pub(super) struct Step {
    pub(super) name: String,
    pub(super) clocks: u64,
    pub(super) ticks: u64,
    pub(super) reads: u64,
    pub(super) writes: u64,
    /// Number of these that interrupt handlers made.
    pub(super) in_interrupt: u64,
}

/// Result of a run.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub(super) results: BTreeMap<String, i64>,
    pub(super) steps: Vec<Step>,
    pub(super) clocks: u64,
    /// Number of outputs of the stage that were compared, over all clocks.
    pub(super) compared: u64,
    /// Largest number of clocks from the stage's interrupt to the core's first instruction for it.
    pub(super) longest_latency: u64,
    /// Complaints of the program about the driver.
    complaint: String,
}

/// The core, the stage, its model and the machine.
pub(super) struct System {
    device: Verilated,
    core: Core,
    plants: Vec<AxisPlant>,
    places: Places,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
}

/// Positions in the system's lists of inputs and outputs.
struct Places {
    input: BTreeMap<String, usize>,
    output: BTreeMap<String, usize>,
    /// For each axis, the inputs A, B and index, and the pins that act on its plant.
    encoder: Vec<[usize; 3]>,
    drive: Vec<[usize; 6]>,
    /// For each of the model's inputs, the system's output if the core drives it, or else the system's input.
    model_input: Vec<Result<usize, usize>>,
    /// For each of the model's outputs, the system's, except those that the system does not have.
    model_output: Vec<Option<usize>>,
}

impl Places {
    fn new(machine: &Machine, core: &Core) -> Self {
        let places_of = |direction| -> BTreeMap<String, usize> {
            let these = core.seen.iter().filter(|port| port.direction == direction);
            let names = these.map(|port| port.name.strip_prefix(core.prefix).unwrap_or(&port.name));
            names
                .enumerate()
                .map(|(place, name)| (name.to_owned(), place))
                .collect()
        };
        let (input, output) = (places_of(Direction::Input), places_of(Direction::Output));
        let of_model = |direction| core.ports.iter().filter(move |port| port.direction == direction);
        let of_axis = |axis: &str, pin: &str| format!("{axis}_{pin}");
        let axes = || machine.axes.iter().map(|axis| axis.name.as_str());
        Self {
            encoder: axes()
                .map(|axis| ENCODER.map(|pin| input[&of_axis(axis, pin)]))
                .collect(),
            drive: axes()
                .map(|axis| DRIVE.map(|pin| output[&of_axis(axis, pin)]))
                .collect(),
            model_input: of_model(Direction::Input)
                .map(|port| output.get(&port.name).copied().ok_or_else(|| input[&port.name]))
                .collect(),
            model_output: of_model(Direction::Output)
                .map(|port| (!core.unseen.contains(&port.name.as_str())).then(|| output[&port.name]))
                .collect(),
            input,
            output,
        }
    }
}

impl System {
    /// Builds the driver's machine with a core, with all lines at their healthy levels.
    pub(super) fn new(driver: &Driver, core: Core) -> Self {
        let machine = &driver.machine;
        let source = VerilogSource {
            files: &core.files,
            top: core.top,
            ports: &core.seen,
        };
        let options = PlantOptions {
            index_at: INDEX_AT,
            ..PlantOptions::default()
        };
        let plant = |axis| AxisPlant::new(axis, &machine.clock, &options).unwrap();
        let places = Places::new(machine, &core);
        // High is the healthy level of every line except reset, encoders and home switches.
        let is_healthy = |name: &str| name.ends_with("_n") || name.ends_with("ready") || name.ends_with("locked");
        let mut inputs = vec![0; places.input.len()];
        for (_, place) in places.input.iter().filter(|(name, _)| is_healthy(name)) {
            inputs[*place] = 1;
        }
        Self {
            device: Verilated::build(&source, 1).unwrap(),
            plants: machine.axes.iter().map(plant).collect(),
            outputs: vec![0; places.output.len()],
            inputs,
            places,
            core,
        }
    }

    /// Drives a line, from the next clock on.
    pub(super) fn set(&mut self, line: &str, level: bool) {
        self.inputs[self.places.input[line]] = level.into();
    }

    /// Returns the position of an axis.
    pub(super) fn count(&self, axis: usize) -> i64 {
        self.plants[axis].count()
    }

    /// Advances everything by a clock; panics at the first output that differs from the model's.
    fn clock(&mut self, now: u64) {
        for (plant, places) in self.plants.iter().zip(&self.places.encoder) {
            let pins = plant.encoder();
            for (place, level) in places.iter().zip([pins.a, pins.b, pins.z]) {
                self.inputs[*place] = level.into();
            }
        }
        self.device.step(&self.inputs, &mut self.outputs).unwrap();
        let of_model = self.places.model_input.iter().map(|place| match *place {
            Ok(driven) => self.outputs[driven],
            Err(line) => self.inputs[line],
        });
        let (inputs, mut expected) = (of_model.collect::<Vec<_>>(), vec![0; self.places.model_output.len()]);
        self.core.model.step(&inputs, &mut expected).unwrap();
        let differs = |(place, expected): (&Option<usize>, &u64)| place.is_some_and(|at| self.outputs[at] != *expected);
        if self.places.model_output.iter().zip(&expected).any(differs) {
            let named = self
                .places
                .model_output
                .iter()
                .zip(&expected)
                .filter_map(|(place, expected)| {
                    let place = (*place)?;
                    let (name, _) = self.places.output.iter().find(|(_, other)| **other == place)?;
                    Some((name, self.outputs[place], *expected))
                });
            let wrong: Vec<_> = named.filter(|(_, actual, expected)| actual != expected).collect();
            panic!("clock {now}: Verilog and model show {wrong:?}");
        }
        for (plant, places) in self.plants.iter_mut().zip(&self.places.drive) {
            let [a_high, a_low, b_high, b_low, drive_enable, brake_release] = places.map(|at| self.outputs[at] != 0);
            let pins = DrivePins {
                a_high,
                a_low,
                b_high,
                b_low,
                drive_enable,
                brake_release,
            };
            plant.clocks(pins, 1);
        }
    }

    /// Loads the program under reset and runs it until it ends, for at most this number of clocks. `seed` is that of
    /// the bridge's waits, where it has some. `surroundings` sets lines in every clock; its argument is the step of the program.
    pub(super) fn run(
        &mut self,
        firmware: &Firmware,
        seed: u16,
        most_clocks: u64,
        surroundings: &mut dyn FnMut(&mut Self, &str),
    ) -> Outcome {
        let place = |name: &str| self.places.input[name];
        let [rst, load, load_word, load_data] = ["rst", "load", "load_word", "load_data"].map(place);
        if let Some(place) = self.places.input.get("seed") {
            self.inputs[*place] = seed.into();
        }
        (self.inputs[rst], self.inputs[load]) = (1, 1);
        for (word, data) in firmware.words.iter().enumerate() {
            self.inputs[load_word] = word as u64;
            self.inputs[load_data] = u64::from(*data);
            self.clock(0);
        }
        (self.inputs[rst], self.inputs[load]) = (0, 0);
        let mut watch = Watch::new(self);
        for now in 1..=most_clocks {
            surroundings(self, watch.step());
            self.clock(now);
            if let Some(outcome) = watch.look(self, now) {
                return outcome;
            }
        }
        panic!("no end after {most_clocks} clocks: {:#?}", watch.outcome);
    }
}

/// Observes the system's outputs while the program runs.
struct Watch {
    outcome: Outcome,
    line: String,
    /// Positions of outputs.
    stopped: Option<usize>,
    console: [usize; 2],
    in_interrupt: usize,
    irq: usize,
    tick: usize,
    /// With the level that each has during the access.
    read: Vec<(usize, bool)>,
    write: Vec<(usize, bool)>,
    /// Clock since which the stage's interrupt waits for the core.
    asked_at: Option<u64>,
}

impl Watch {
    fn new(system: &System) -> Self {
        let place = |name: &str| system.places.output[name];
        let levels = |of: &[(&str, bool)]| of.iter().map(|(name, level)| (place(name), *level)).collect();
        Self {
            outcome: Outcome {
                steps: vec![Step::default()],
                ..Outcome::default()
            },
            line: String::new(),
            stopped: system.places.output.get("stopped").copied(),
            console: system.core.console.map(place),
            in_interrupt: place("in_interrupt"),
            irq: place("irq"),
            tick: place("tick"),
            read: levels(system.core.read),
            write: levels(system.core.write),
            asked_at: None,
        }
    }

    fn step(&self) -> &str {
        self.outcome.steps.last().map_or("", |step| step.name.as_str())
    }

    /// Reads the outputs after a clock; returns the result if the program has ended.
    fn look(&mut self, system: &System, now: u64) -> Option<Outcome> {
        let is_high = |place: usize| system.outputs[place] != 0;
        assert!(
            !self.stopped.is_some_and(is_high),
            "clock {now}: the core has trapped, in {:#?}",
            self.outcome
        );
        let in_interrupt = is_high(self.in_interrupt);
        if in_interrupt {
            let latency = self.asked_at.take().map_or(0, |asked| now - asked);
            self.outcome.longest_latency = self.outcome.longest_latency.max(latency);
        } else if is_high(self.irq) {
            self.asked_at.get_or_insert(now);
        }
        let are_so =
            |levels: &[(usize, bool)]| u64::from(levels.iter().all(|(place, level)| is_high(*place) == *level));
        let (reads, writes) = (are_so(&self.read), are_so(&self.write));
        if let Some(step) = self.outcome.steps.last_mut() {
            step.clocks += 1;
            step.ticks += u64::from(is_high(self.tick));
            step.reads += reads;
            step.writes += writes;
            step.in_interrupt += if in_interrupt { reads + writes } else { 0 };
        }
        let [valid, data] = self.console;
        if is_high(valid) {
            self.character(char::from(system.outputs[data] as u8));
        }
        let status = self.outcome.results.remove("end")?;
        assert_eq!(status, 0, "{:#?}", self.outcome);
        self.outcome.clocks = now;
        self.outcome.compared = now * system.places.model_output.iter().flatten().count() as u64;
        Some(std::mem::take(&mut self.outcome))
    }

    /// Reads a line of the console: `> step`, `= name value`, or a complaint.
    fn character(&mut self, character: char) {
        if character != '\n' {
            self.line.push(character);
            return;
        }
        let line = std::mem::take(&mut self.line);
        let words: Vec<&str> = line.splitn(2, ' ').collect();
        match words[..] {
            [">", name] => self.outcome.steps.push(Step {
                name: name.to_owned(),
                ..Step::default()
            }),
            ["=", result] => {
                let (name, value) = result.split_once(' ').unwrap();
                let value = u32::from_str_radix(value, 16).unwrap() as i32;
                self.outcome.results.insert(name.to_owned(), value.into());
            }
            _ => self.outcome.complaint.push_str(&line),
        }
    }
}
