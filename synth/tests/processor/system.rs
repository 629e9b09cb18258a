//! Simulates the stage with a core on its bus and a machine at its pins, and the model of the stage beside it.
//!
//! ```text
//!  picorv32 ─► bridge ─► avs_* ─┬─► stage (Verilog) ─┬─► gates, drive_enable, brake_release ─► plants ─┐
//!                               └─► stage (model) ───┴─► every output equal, in every clock            │
//!                                                        a, b, z, home, drive_fault_n ◄────────────────┘
//! ```

use crate::driver::support::{Driver, run, stage};
use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::{ClockedBlock, Direction, Port};
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::{AxisPlant, DrivePins, PlantOptions};
use posicast_testbench::blocks::Sources;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::verilator::{Verilated, VerilogSource};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name of the stage's top module.
const STAGE: &str = "slide_stage";
/// Its address for the core.
const STAGE_BASE: &str = "0x40000000u";
/// Size of the core's memory in bytes.
const RAM_BYTES: u32 = 32_768;
/// Counts at which the simulated encoders have their index, and from which on the home switch of X is pressed.
pub(super) const INDEX_AT: i64 = 22;
pub(super) const HOME_FROM: i64 = 30;
const ENCODER: [&str; 3] = ["a", "b", "z"];
const DRIVE: [&str; 6] = ["a_high", "a_low", "b_high", "b_low", "drive_enable", "brake_release"];
/// Ports of the processor that the test sees: name, direction, width.
const CORE_PORTS: [(&str, Direction, u32); 9] = [
    ("load", Direction::Input, 1),
    ("load_word", Direction::Input, 13),
    ("load_data", Direction::Input, 32),
    ("seed", Direction::Input, 16),
    ("console_valid", Direction::Output, 1),
    ("end_valid", Direction::Output, 1),
    ("console_data", Direction::Output, 32),
    ("stopped", Direction::Output, 1),
    ("in_interrupt", Direction::Output, 1),
];

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
    pub(super) fn build(driver: &Driver) -> Self {
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
            .arg(format!("-DSTAGE_BASE={STAGE_BASE}"))
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
            .args([
                "-nostartfiles",
                "-nostdlib",
                "-Wl,--gc-sections",
                "-Wl,--defsym=RAM_BASE=0",
            ])
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

fn here(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/processor").join(name)
}

/// Returns the core's Verilog, from the Python package of the tests.
fn core_file() -> PathBuf {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin/python");
    assert!(
        python.exists(),
        "{} is missing: scripts/install-tools makes it",
        python.display()
    );
    let said = run(Command::new(python).args([
        "-c",
        "import pythondata_cpu_picorv32 as core; print(core.data_location)",
    ]));
    Path::new(said.trim()).join("picorv32.v")
}

/// Returns the module that connects processor and stage. Its ports are the stage's pins, its bus to observe, and the
/// test's side of the processor.
fn joined(ports: &[Port]) -> (String, Vec<Port>) {
    let port = |name: &str, direction, width| Port {
        name: name.to_owned(),
        direction,
        width,
        signed: false,
    };
    let mut seen = vec![port("rst", Direction::Input, 1)];
    seen.extend(CORE_PORTS.map(|(name, direction, width)| port(name, direction, width)));
    for other in ports.iter().filter(|port| port.name != "rst") {
        let direction = if other.name.starts_with("avs_") {
            Direction::Output
        } else {
            other.direction
        };
        seen.push(port(&other.name, direction, other.width));
    }
    let mut text = String::from("`default_nettype none\nmodule system (\n    input wire clk");
    for port in &seen {
        let direction = if port.direction == Direction::Input {
            "input"
        } else {
            "output"
        };
        let _ = write!(text, ",\n    {direction} wire [{}:0] {}", port.width - 1, port.name);
    }
    text.push_str("\n);\n");
    let mut instance = |module: &str, parameters: &str, names: &mut dyn Iterator<Item = &str>| {
        let connected: Vec<String> = names.map(|name| format!(".{name}({name})")).collect();
        let _ = writeln!(
            text,
            "    {module} {parameters}{module}_0 (.clk(clk), {});",
            connected.join(", ")
        );
    };
    let bus = seen
        .iter()
        .map(|port| port.name.as_str())
        .filter(|name| name.starts_with("avs_"));
    let own = ["rst", "irq"]
        .into_iter()
        .chain(CORE_PORTS.iter().map(|(name, ..)| *name));
    let bits = ports.iter().find(|port| port.name == "avs_address").unwrap().width;
    instance("processor", &format!("#(.ADDRESS_BITS({bits})) "), &mut own.chain(bus));
    instance(STAGE, "", &mut ports.iter().map(|port| port.name.as_str()));
    text.push_str("endmodule\n");
    (text, seen)
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
    model: Composed,
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
    model_output: Vec<usize>,
}

impl Places {
    fn new(machine: &Machine, seen: &[Port], ports: &[Port]) -> Self {
        let places_of = |direction| -> BTreeMap<String, usize> {
            let these = seen.iter().filter(|port| port.direction == direction).enumerate();
            these.map(|(place, port)| (port.name.clone(), place)).collect()
        };
        let (input, output) = (places_of(Direction::Input), places_of(Direction::Output));
        let of_model = |direction| ports.iter().filter(move |port| port.direction == direction);
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
            model_output: of_model(Direction::Output).map(|port| output[&port.name]).collect(),
            input,
            output,
        }
    }
}

impl System {
    /// Builds the driver's machine with a core, with all lines at their healthy levels.
    pub(super) fn new(driver: &Driver) -> Self {
        let machine = &driver.machine;
        let component = Component::stage(&stage(machine).config).unwrap();
        let block = ComponentBlock::new(component.clone(), STAGE, "xy");
        let ports = component.composition().ports();
        let (text, seen) = joined(ports);
        let system = driver.path().join("system.v");
        std::fs::write(&system, text).unwrap();
        let sources = Sources::write(&block).unwrap();
        let files = [sources.files(), &[system, here("processor.v"), core_file()]].concat();
        let source = VerilogSource {
            files: &files,
            top: "system",
            ports: &seen,
        };
        let options = PlantOptions {
            index_at: INDEX_AT,
            ..PlantOptions::default()
        };
        let plant = |axis| AxisPlant::new(axis, &machine.clock, &options).unwrap();
        let places = Places::new(machine, &seen, ports);
        // High is the healthy level of every line except reset, encoders and home switches.
        let is_healthy = |name: &str| name.ends_with("_n") || name.ends_with("ready") || name.ends_with("locked");
        let mut inputs = vec![0; places.input.len()];
        for (_, place) in places.input.iter().filter(|(name, _)| is_healthy(name)) {
            inputs[*place] = 1;
        }
        Self {
            device: Verilated::build(&source, 1).unwrap(),
            model: component.model(1),
            plants: machine.axes.iter().map(plant).collect(),
            outputs: vec![0; places.output.len()],
            inputs,
            places,
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
        self.model.step(&inputs, &mut expected).unwrap();
        let actual: Vec<u64> = self
            .places
            .model_output
            .iter()
            .map(|place| self.outputs[*place])
            .collect();
        if actual != expected {
            let names = self.places.model_output.iter().map(|place| {
                let named = self.places.output.iter().find(|(_, other)| *other == place);
                named.unwrap().0
            });
            let wrong: Vec<_> = names
                .zip(actual.iter().zip(&expected))
                .filter(|(_, (a, e))| a != e)
                .collect();
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
    /// the bridge's waits. `surroundings` sets lines in every clock; its argument is the step of the program.
    pub(super) fn run(
        &mut self,
        firmware: &Firmware,
        seed: u16,
        most_clocks: u64,
        surroundings: &mut dyn FnMut(&mut Self, &str),
    ) -> Outcome {
        let place = |name: &str| self.places.input[name];
        let [rst, load, load_word, load_data] = ["rst", "load", "load_word", "load_data"].map(place);
        self.inputs[place("seed")] = seed.into();
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
    stopped: usize,
    console_valid: usize,
    end_valid: usize,
    console_data: usize,
    in_interrupt: usize,
    irq: usize,
    tick: usize,
    avs_read: usize,
    avs_write: usize,
    /// Clock since which the stage's interrupt waits for the core.
    asked_at: Option<u64>,
}

impl Watch {
    fn new(system: &System) -> Self {
        let place = |name: &str| system.places.output[name];
        Self {
            outcome: Outcome {
                steps: vec![Step::default()],
                ..Outcome::default()
            },
            line: String::new(),
            stopped: place("stopped"),
            console_valid: place("console_valid"),
            end_valid: place("end_valid"),
            console_data: place("console_data"),
            in_interrupt: place("in_interrupt"),
            irq: place("irq"),
            tick: place("tick"),
            avs_read: place("avs_read"),
            avs_write: place("avs_write"),
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
            !is_high(self.stopped),
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
        let accesses = u64::from(is_high(self.avs_read)) + u64::from(is_high(self.avs_write));
        if let Some(step) = self.outcome.steps.last_mut() {
            step.clocks += 1;
            step.ticks += u64::from(is_high(self.tick));
            step.reads += u64::from(is_high(self.avs_read));
            step.writes += u64::from(is_high(self.avs_write));
            step.in_interrupt += if in_interrupt { accesses } else { 0 };
        }
        if is_high(self.console_valid) {
            self.character(char::from(system.outputs[self.console_data] as u8));
        }
        if !is_high(self.end_valid) {
            return None;
        }
        let status = system.outputs[self.console_data];
        assert_eq!(status, 0, "{:#?}", self.outcome);
        self.outcome.clocks = now;
        self.outcome.compared = now * system.places.model_output.len() as u64;
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
