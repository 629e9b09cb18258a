//! `posicast verify`: compares the RTL with the bit-exact model, clock by clock, block by block.

use crate::terminal::Terminal;
use crate::{choice, output, render};
use posicast_flow::replay::Recording;
use posicast_flow::verify::{DEFAULT_SEED, Options, verify};
use posicast_flow::{Failure, Simulator, clocks};
use std::path::PathBuf;

/// Compare the Verilog with the bit-exact model in every clock
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast verify examples/xy-stage.toml --cycles 10000000
  posicast verify examples/xy-stage.toml --block pulse_counter --block divider
  posicast verify xy_stage                    the Verilog in that folder, as it is
  posicast verify xy_stage --stimulus recorded.vcd --map tb.dut=xy_stage

Exit status: 0 everything was exercised and equal, 1 something was not, 2 bad input, 3 the simulator is missing.")]
pub(crate) struct Args {
    /// Machine file, or a folder that `generate` or `run` wrote
    source: PathBuf,
    /// Simulator [default: verilator; rusthdl, the weaker check, where Verilator is missing]
    #[arg(long, value_parser = choice::parser::<Simulator>())]
    simulator: Option<Simulator>,
    /// Only the blocks of this name, such as pulse_counter; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    /// Clocks to compare in every row, with --stimulus at most [default: 1000000 with verilator, 20000 with icarus and
    /// rusthdl, and more if exercising every tap, bank and flag takes more]
    #[arg(long, value_parser = clocks)]
    cycles: Option<u64>,
    /// Seed of the random stimuli
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// Let both simulators judge edited Verilog in the folder; without this option, edited Verilog is no match
    #[arg(long)]
    edited: bool,
    /// Also print what the clocks of each row reached (samples, moves, taps, registers) and how much of it a match needs
    #[arg(short, long, conflicts_with = "json")]
    verbose: bool,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    recording: RecordingArgs,
}

/// The recording, and how its names are read.
#[derive(clap::Args)]
#[command(next_help_heading = "Recorded stimuli")]
struct RecordingArgs {
    /// Replay the inputs in this VCD or FST into RTL and model, and compare with the outputs in it
    #[arg(long, value_name = "FILE")]
    stimulus: Option<PathBuf>,
    /// Match scope or signal A of the recording with B of the block, whose scope is its top module; with * in both, a pattern (repeatable)
    #[arg(long, value_name = "A=B", requires = "stimulus")]
    map: Vec<String>,
    /// Look only below this scope of the recording
    #[arg(long, value_name = "SCOPE", requires = "stimulus")]
    root: Option<String>,
    /// The recorded clock [default: the only clk or clock]
    #[arg(long, value_name = "NAME", requires = "stimulus")]
    clock: Option<String>,
    /// Compare recorded outputs from where this signal is released; `none`: from the first edge [default: the only reset found]
    #[arg(long, value_name = "NAME[=0|1]", requires = "stimulus")]
    reset: Option<String>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let recording = &args.recording;
    let options = Options {
        source: args.source.clone(),
        simulator: args.simulator,
        blocks: args.blocks.clone(),
        cycles: args.cycles,
        seed: args.seed,
        edited: args.edited,
        recording: Recording {
            stimulus: recording.stimulus.clone(),
            map: recording.map.clone(),
            root: recording.root.clone(),
            clock: recording.clock.clone(),
            reset: recording.reset.clone(),
        },
    };
    let text = if args.verbose {
        render::verify_with_reached
    } else {
        render::verify
    };
    output::show(verify(&options, &Terminal)?, args.json, text)
}
