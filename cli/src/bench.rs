//! A machine on the test bench: its models, the device that is compared with them, and the lock step of both.

use crate::failure::Failure;
use crate::{output, progress};
use clap::ValueEnum;
use posicast_hdl::machine::AxisShaper;
use posicast_model::rtl::shaper::{Shaper, pass_clocks};
use posicast_model::rtl::{ClockedBlock, Port};
use posicast_model::spec::Machine;
use posicast_testbench::Error;
use posicast_testbench::campaign::Campaign;
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::Report;
use posicast_testbench::lockstep::{self, Device, Joined, Options, TwoValued};
use posicast_testbench::stimuli::Layout;
use posicast_testbench::verilator::{self, Source, Verilated};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// What runs the hardware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Simulator {
    /// The emitted Verilog, compiled
    Verilator,
    /// The emitted Verilog, in a second, event-driven simulator
    Icarus,
    /// The RustHDL description itself, not the Verilog: needs no tool, the weaker check
    Rusthdl,
}

impl Simulator {
    /// The simulator that was asked for, else the best that is installed.
    ///
    /// A Verilator that `$VERILATOR` names, or that fails, is no Verilator that is not installed: that is an error.
    pub(crate) fn choose(asked: Option<Self>) -> Result<Self, Failure> {
        if let Some(simulator) = asked {
            return Ok(simulator);
        }
        match verilator::version() {
            Ok(_) => Ok(Self::Verilator),
            Err(error) if !error.is_missing_tool() || std::env::var_os("VERILATOR").is_some() => Err(failure(error)),
            Err(_) => {
                output::say(
                    "warning: Verilator is not installed: RustHDL's own simulator runs instead, on fewer clocks. It is the \
                     weaker check: the emitted Verilog itself is not simulated.",
                );
                Ok(Self::Rusthdl)
            }
        }
    }

    /// Clocks of a lock step where none are asked for.
    pub(crate) fn default_cycles(self) -> u64 {
        match self {
            Self::Verilator => 1_000_000,
            Self::Icarus | Self::Rusthdl => 20_000,
        }
    }
}

impl fmt::Display for Simulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Verilator => "verilator",
            Self::Icarus => "icarus",
            Self::Rusthdl => "rusthdl",
        })
    }
}

/// A machine on the test bench.
pub(crate) struct Bench {
    pub(crate) machine: Machine,
    pub(crate) shapers: Vec<AxisShaper>,
    pub(crate) layout: Layout,
    /// Clocks of the longest pass of all axes.
    pub(crate) pass_clocks: u32,
    ports: Vec<Port>,
}

impl Bench {
    /// The bench for a machine whose axes have these shapers.
    pub(crate) fn new(machine: &Machine, shapers: Vec<AxisShaper>) -> Result<Self, Failure> {
        let ports = model(&shapers, 0).ports().to_vec();
        let fraction = shapers.first().map_or(1, |s| s.config.coefficient_fraction());
        let layout = Layout::new(&ports, fraction).map_err(failure)?;
        let taps = shapers
            .iter()
            .map(|s| s.config.table().taps().len() as u32)
            .max()
            .unwrap_or(0);
        Ok(Self {
            machine: machine.clone(),
            shapers,
            layout,
            pass_clocks: pass_clocks(taps),
            ports,
        })
    }

    /// The bit-exact model of the machine's top module.
    pub(crate) fn model(&self, seed: u64) -> Joined {
        model(&self.shapers, seed)
    }

    /// The hardware in a simulator. `files` is the Verilog; RustHDL's simulator runs its own description instead.
    pub(crate) fn device(
        &self,
        simulator: Simulator,
        files: &[PathBuf],
        seed: u64,
    ) -> Result<Box<dyn Device>, Failure> {
        let source = Source {
            files,
            top: &self.machine.name,
            ports: &self.ports,
        };
        match simulator {
            Simulator::Verilator => {
                let spinner = progress::spinner("Verilator builds the Verilog");
                let device = Verilated::build(&source, seed).map_err(failure)?;
                spinner.finish_and_clear();
                Ok(Box::new(device))
            }
            Simulator::Icarus => Ok(Box::new(Icarus::build(&source).map_err(failure)?)),
            Simulator::Rusthdl => {
                let blocks = self.shapers.iter().map(|s| {
                    let block = posicast_hdl::shaper::simulate(&s.config).map_err(Failure::because)?;
                    Ok((s.axis.clone(), block))
                });
                let joined = Joined::new(blocks.collect::<Result<_, Failure>>()?);
                Ok(Box::new(TwoValued(Box::new(joined))))
            }
        }
    }

    /// Compares `device` with the model in every clock: directed cases, the move `words`, random stimuli.
    pub(crate) fn lockstep(
        &self,
        device: &mut dyn Device,
        words: &[Vec<i64>],
        cycles: u64,
        seed: u64,
    ) -> Result<Report, Failure> {
        let mut model = self.model(seed);
        let instances = model.instances("shaper");
        let mut campaign = Campaign::new(&self.layout, self.pass_clocks, words, cycles, seed);
        let bar = progress::bar("lock step", cycles);
        let report = lockstep::run(
            &mut model,
            device,
            &mut campaign,
            &instances,
            &Options::cycles(cycles),
            &mut |_| {},
            &mut |done| bar.set_position(done),
        )
        .map_err(failure)?;
        bar.finish_and_clear();
        Ok(report)
    }
}

fn model(shapers: &[AxisShaper], seed: u64) -> Joined {
    let block = |(index, s): (usize, &AxisShaper)| {
        // Each memory starts with other contents: nothing may depend on them.
        let block: Box<dyn ClockedBlock> = Box::new(Shaper::new(&s.config, seed.wrapping_add(index as u64)));
        (s.axis.clone(), block)
    };
    Joined::new(shapers.iter().enumerate().map(block).collect())
}

/// How an error of the test bench ends a command.
pub(crate) fn failure(error: Error) -> Failure {
    if error.is_missing_tool() {
        Failure::missing_tool(error)
    } else {
        Failure::because(error)
    }
}
