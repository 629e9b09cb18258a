//! `posicast run`: runs all steps from the machine file to the verdict.

use crate::contour::CornerArgs;
use crate::moves::MotionArgs;
use crate::terminal::Terminal;
use crate::{choice, output, render};
use posicast_flow::run::{Options, run as run_all};
use posicast_flow::verify::DEFAULT_SEED;
use posicast_flow::{Failure, Simulator, clocks};
use std::path::PathBuf;

/// Do everything: design, Verilog, simulation, comparison, estimate, verdict
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast run examples/xy-stage.toml -o xy_stage
  posicast run examples/xy-stage.toml --move x=0.04,y=-0.02 --speed 0.1
  posicast run examples/xy-stage.toml --contour part.gcode

Exit status: 0 all checks hold, 1 a check failed (the folder holds the evidence), 2 bad input, 3 a tool that was asked for is missing.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Output folder: new, empty, or written by posicast before [default: ./NAME]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    motion: MotionArgs,
    /// Radius of the circle of the closed loop, in the unit of the first axis [default: one that suits the limits of the axes]
    #[arg(long, allow_negative_numbers = true)]
    radius: Option<f64>,
    /// Path of the closed loop instead of the circle: circle, square, a CSV file of points x,y, or a G-code file. It
    /// begins where the axes stand at reset; --radius and --speed apply to it
    #[arg(long, value_name = "SHAPE|FILE", conflicts_with = "command")]
    contour: Option<String>,
    #[command(flatten)]
    corners: CornerArgs,
    /// Simulator [default: verilator; rusthdl, the weaker check, where Verilator is missing]
    #[arg(long, value_parser = choice::parser::<Simulator>())]
    simulator: Option<Simulator>,
    /// Clocks of the lock step [default: 1000000 with verilator, 20000 with icarus and rusthdl]
    #[arg(long, value_parser = clocks)]
    cycles: Option<u64>,
    /// Seed of the random stimuli
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// Print all tables and every check
    #[arg(short, long)]
    verbose: bool,
    /// Print only the verdict, and what failed
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Print one JSON document on standard output
    #[arg(long, conflicts_with_all = ["verbose", "quiet"])]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = Options {
        machine: args.machine.clone(),
        output: args.output.clone(),
        motion: args.motion.motion(),
        radius: args.radius,
        contour: args.contour.clone(),
        corners: args.corners.corners(),
        simulator: args.simulator,
        cycles: args.cycles,
        seed: args.seed,
    };
    let text = match (args.verbose, args.quiet) {
        (true, _) => render::run::everything,
        (false, true) => render::run::verdict,
        (false, false) => render::run::summary,
    };
    output::show(run_all(&options, &Terminal)?, args.json, text)
}
