//! `posicast verify`: RTL against the bit-exact model, clock by clock.

use crate::design::Report as DesignReport;
use crate::failure::Failure;
use crate::output::{self, Table};
use crate::{generate, machine, progress};
use clap::ValueEnum;
use posicast_hdl::machine::{AxisShaper, machine_ports};
use posicast_hdl::shaper;
use posicast_model::rtl::{ClockedBlock, Port};
use posicast_model::spec::Machine;
use posicast_synth::package;
use posicast_testbench::campaign::Campaign;
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, TwoValued};
use posicast_testbench::verilator::{self, Source, Verilated};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Compare the Verilog with the bit-exact model in every clock
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast verify examples/xy-stage.toml --cycles 10000000
  posicast verify xy_stage                    the Verilog in that folder, as it is

Exit status: 0 no mismatch, 1 a mismatch, 2 bad input, 3 the simulator is missing.")]
pub(crate) struct Args {
    /// Machine file, or a folder that `generate` or `run` wrote
    source: PathBuf,
    /// Simulator [default: verilator; rusthdl, the weaker check, where Verilator is missing]
    #[arg(long)]
    simulator: Option<Simulator>,
    /// Clocks to compare [default: 1000000 with verilator, 20000 with icarus and rusthdl]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    cycles: Option<u64>,
    /// Seed of the random stimuli
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

/// Seed where none is given: the same run every time.
pub(crate) const DEFAULT_SEED: u64 = 1;

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
    pub(crate) fn choose(asked: Option<Self>) -> Self {
        match asked {
            Some(simulator) => simulator,
            None if verilator::version().is_ok() => Self::Verilator,
            None => {
                output::say(
                    "warning: Verilator is not installed: RustHDL's own simulator runs instead, on fewer clocks. It is the \
                     weaker check: the emitted Verilog itself is not simulated.",
                );
                Self::Rusthdl
            }
        }
    }

    fn default_cycles(self) -> u64 {
        match self {
            Self::Verilator => 1_000_000,
            Self::Icarus | Self::Rusthdl => 20_000,
        }
    }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let job = Job::new(&args.source)?;
    if job.from_folder && args.simulator == Some(Simulator::Rusthdl) {
        return Err(Failure::from(miette::miette!(
            help = "use --simulator verilator or icarus, or verify the machine file",
            "`--simulator rusthdl` runs the RustHDL description: it cannot run the Verilog in `{}`",
            args.source.display()
        )));
    }
    let simulator = if job.from_folder {
        args.simulator.unwrap_or(Simulator::Verilator)
    } else {
        Simulator::choose(args.simulator)
    };
    let cycles = args.cycles.unwrap_or(simulator.default_cycles());
    let report = job.lockstep(simulator, cycles, args.seed)?;
    let document = Document { simulator, seed: args.seed, report: &report };
    if args.json { output::print_json(&document)? } else { output::print(&document.text())? }
    match report.result {
        Verdict::Match => Ok(()),
        Verdict::Mismatch => Err(Failure::Check("the RTL does not match the model".to_owned())),
    }
}

/// A machine whose Verilog is to be compared with its model.
pub(crate) struct Job {
    pub(crate) machine: Machine,
    pub(crate) shapers: Vec<AxisShaper>,
    pub(crate) files: Vec<PathBuf>,
    from_folder: bool,
    _scratch: Option<tempfile::TempDir>,
}

impl Job {
    fn new(source: &Path) -> Result<Self, Failure> {
        let (machine, folder) = if source.is_dir() {
            let contents = package::read(source).map_err(Failure::because)?;
            (machine::parse(&contents.machine_path, &contents.machine_toml)?, Some(contents.rtl))
        } else {
            (machine::read(source)?.machine, None)
        };
        let design = DesignReport::new(&machine)?.design;
        let shapers = machine::shapers(&machine, &design)?;
        let from_folder = folder.is_some();
        let (files, scratch) = match folder {
            Some(files) => (files, None),
            None => {
                let (files, scratch) = generate::write_scratch(&generate::modules(&machine.name, &shapers)?)?;
                (files, Some(scratch))
            }
        };
        Ok(Self { machine, shapers, files, from_folder, _scratch: scratch })
    }
}
