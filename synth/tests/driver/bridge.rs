//! Carries out the register accesses of a C program, line by line over its pipes, on a stage with its machine.

use crate::driver::support::{Driver, beside, stage};
use posicast_blocks::component::Component;
use posicast_closed_loop::stage_bench::StageBench;
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};
use posicast_testbench::blocks::Sources;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::lockstep::Device;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Number of clocks that pass when the program pauses: half a tick.
const PAUSE_CLOCKS: u64 = 2500;

/// Position of the index of the simulated encoders.
pub(crate) const INDEX_AT: i64 = 22;

/// What a program requests of its hardware.
pub(crate) enum Asked<'a> {
    Read(u32),
    Write(u32, u32),
    Pause,
    Line(&'a str, u64),
}

/// Runs a program until it ends successfully, and returns its results. `answer` returns the word of a read.
pub(crate) fn talk(
    program: &Path,
    arguments: &[&str],
    answer: &mut dyn FnMut(Asked<'_>) -> Option<u32>,
) -> BTreeMap<String, i64> {
    let mut command = Command::new(program);
    let mut child = command
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut to = child.stdin.take().unwrap();
    let from = BufReader::new(child.stdout.take().unwrap());
    let mut results = BTreeMap::new();
    for line in from.lines() {
        let line = line.unwrap();
        let words: Vec<&str> = line.split(' ').collect();
        match words[..] {
            ["r", word] => {
                let data = answer(Asked::Read(word.parse().unwrap())).unwrap_or(0);
                writeln!(to, "{data}").unwrap();
            }
            ["w", word, data] => drop(answer(Asked::Write(word.parse().unwrap(), data.parse().unwrap()))),
            ["p"] => drop(answer(Asked::Pause)),
            ["s", line, level] => drop(answer(Asked::Line(line, level.parse().unwrap()))),
            ["=", name, value] => drop(results.insert(name.to_owned(), value.parse().unwrap())),
            _ => panic!("{line}"),
        }
    }
    let status = child.wait().unwrap();
    assert!(status.success(), "{status}");
    results
}

/// The example's stage, and a program with the driver.
pub(crate) struct Bridge {
    pub(crate) bench: StageBench,
    program: PathBuf,
}

impl Bridge {
    /// Creates the stage of the driver's machine, and this program; with the Verilog beside the model, if wanted.
    pub(crate) fn new(driver: &Driver, program: &str, with_rtl: bool) -> Self {
        let options = PlantOptions {
            index_at: INDEX_AT,
            ..PlantOptions::default()
        };
        Self::with_plants(driver, program, with_rtl, &options)
    }

    /// The same with these options of the simulated axes.
    pub(crate) fn with_plants(driver: &Driver, program: &str, with_rtl: bool, options: &PlantOptions) -> Self {
        let machine = &driver.machine;
        let stage = stage(machine);
        let component = Component::stage(&stage.config).unwrap();
        let device = with_rtl.then(|| {
            let block = ComponentBlock::new(component.clone(), "xy_stage", "xy");
            let sources = Sources::write(&block).unwrap();
            Box::new(sources.verilated(&block, 1).unwrap()) as Box<dyn Device>
        });
        let plant = |axis| AxisPlant::new(axis, &machine.clock, options).unwrap();
        let plants = machine.axes.iter().map(plant).collect();
        let mut bench = StageBench::new(&stage.config, &component, plants, device, 1).unwrap();
        // Filters and encoders settle.
        bench.clocks(1000).unwrap();
        let program = driver.program("on_the_stage", &["-DPOSICAST_ACCESS_FUNCTIONS"], &[beside(program)]);
        Self { bench, program }
    }

    /// Runs the program on the stage.
    pub(crate) fn talk(&mut self, arguments: &[&str]) -> BTreeMap<String, i64> {
        self.talk_beside(arguments, |_| ())
    }

    /// Like [`Self::talk`]; `surroundings` sets lines of the machine whenever time has passed.
    pub(crate) fn talk_beside(
        &mut self,
        arguments: &[&str],
        surroundings: impl Fn(&mut StageBench),
    ) -> BTreeMap<String, i64> {
        let bench = &mut self.bench;
        talk(&self.program, arguments, &mut |asked| {
            match asked {
                Asked::Read(word) => return Some(bench.read_at(word).unwrap()),
                Asked::Write(word, data) => bench.write_at(word, data).unwrap(),
                Asked::Pause => {
                    bench.clocks(PAUSE_CLOCKS).unwrap();
                    surroundings(bench);
                }
                Asked::Line(line, level) => bench.set(line, level).unwrap(),
            }
            None
        })
    }
}
