//! `posicast simulate`: passes a command through the bit-exact model and the float design to the simulated machine.

use crate::contour::ContourArgs;
use crate::moves::MotionArgs;
use crate::terminal::Terminal;
use crate::{output, render};
use posicast_flow::Failure;
use posicast_flow::simulate::{Options, simulate};
use std::path::PathBuf;

/// Run a command through the bit-exact model and the float design, on the simulated machine
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast simulate examples/xy-stage.toml -o move.vcd
  posicast simulate examples/xy-stage.toml --move 0.04
  posicast simulate examples/xy-stage.toml --command moves.csv
  posicast simulate examples/xy-stage.toml --contour circle --radius 0.01 --speed 0.1 --plot circle.svg
  posicast simulate examples/xy-stage.toml --contour part.gcode

The waveform holds, per axis and in LSB of the command word: command x, shaped y, float design y_float, and the
machine's position with and without shaping. The words of a modulo axis wrap; the machine's position counts on.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Waveform to write [default: ./NAME.vcd]
    #[arg(short, long, value_name = "FILE.vcd", conflicts_with = "contour")]
    output: Option<PathBuf>,
    #[command(flatten)]
    motion: MotionArgs,
    #[command(flatten)]
    contour: ContourArgs,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long)]
    force: bool,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = Options {
        machine: args.machine.clone(),
        output: args.output.clone(),
        motion: args.motion.motion(),
        path: args.contour.path(),
        force: args.force,
        form: output::form(args.json),
    };
    output::show(simulate(&options, &Terminal)?, args.json, render::simulate)
}
