//! `posicast verify`: RTL against the bit-exact model, clock by clock.

use crate::bench::{Bench, Simulator};
use crate::design::Report as DesignReport;
use crate::failure::Failure;
use crate::output::{self, Table};
use crate::{command, generate, machine};
use posicast_model::design::MachineDesign;
use posicast_synth::package;
use posicast_testbench::lockstep::report::{Report, Verdict};
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
        Simulator::choose(args.simulator)?
    };
    let cycles = args.cycles.unwrap_or(simulator.default_cycles());
    let report = job.lockstep(simulator, cycles, args.seed)?;
    if report.samples == 0 {
        output::say("warning: no output sample was among these clocks: compare more with --cycles");
    }
    let document = Document {
        simulator,
        seed: args.seed,
        report: &report,
    };
    if args.json {
        output::print_json(&document)?
    } else {
        output::print(&document.text())?
    }
    match report.result {
        Verdict::Match => Ok(()),
        Verdict::Mismatch => Err(Failure::Check("the RTL does not match the model".to_owned())),
    }
}

/// A machine whose Verilog is to be compared with its model.
struct Job {
    design: MachineDesign,
    bench: Bench,
    files: Vec<PathBuf>,
    from_folder: bool,
    _scratch: Option<tempfile::TempDir>,
}

impl Job {
    fn new(source: &Path) -> Result<Self, Failure> {
        let (machine, folder) = if source.is_dir() {
            let contents = package::read(source).map_err(Failure::because)?;
            (
                machine::parse(&contents.machine_path, &contents.machine_toml)?,
                Some(contents.rtl),
            )
        } else {
            (machine::read(source)?.machine, None)
        };
        let design = DesignReport::new(&machine, source)?.design;
        let bench = Bench::new(&machine, machine::shapers(&machine, &design, source)?)?;
        let from_folder = folder.is_some();
        let (files, scratch) = match folder {
            Some(files) => (files, None),
            None => {
                let (files, scratch) = generate::write_scratch(&generate::modules(&machine.name, &bench.shapers)?)?;
                (files, Some(scratch))
            }
        };
        Ok(Self {
            design,
            bench,
            files,
            from_folder,
            _scratch: scratch,
        })
    }

    fn lockstep(&self, simulator: Simulator, cycles: u64, seed: u64) -> Result<Report, Failure> {
        let mut device = self.bench.device(simulator, &self.files, seed)?;
        // A move that does not fit the words is an error of `run`; a lock step has its other stimuli.
        let words = command::words(&self.bench.machine, &self.design, None).unwrap_or_default();
        self.bench
            .lockstep(device.as_mut(), &command::widened(&words), cycles, seed)
    }
}

/// `verify --json`.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    report: &'a Report,
    simulator: Simulator,
    seed: u64,
}

impl Document<'_> {
    fn text(&self) -> String {
        let mut table = Table::new(&["block", "instance", ">clocks", ">mismatches"]);
        for block in &self.report.blocks {
            let counts = [block.cycles.to_string(), block.mismatches.to_string()];
            table.row([block.name.clone(), block.instance.clone()].into_iter().chain(counts));
        }
        let mut text = table.text("");
        for first in self.report.blocks.iter().filter_map(|b| b.first.as_ref()) {
            text += &format!("\n{first}\n");
        }
        let verdict = match self.report.result {
            Verdict::Match => "match: every output of every clock is equal to the model's",
            Verdict::Mismatch => "MISMATCH",
        };
        text + &format!(
            "{verdict}; {} clocks, {} samples, simulator {}, seed {}\n",
            self.report.cycles, self.report.samples, self.simulator, self.seed
        )
    }
}
