//! `posicast bitstream`: builds a bitstream of a machine's shapers for a board, and checks its bits.

use crate::terminal::Terminal;
use crate::{output, render};
use posicast_flow::bitstream::{Options, bitstream, board_names};
use posicast_flow::verify::DEFAULT_SEED;
use posicast_flow::{Failure, clocks};
use std::path::PathBuf;

/// Build a bitstream of the machine for a board by open tools, and check its bits against the model
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  posicast bitstream examples/robot-joint.toml --board icebreaker -o robot_joint

Of a machine with shapers alone it builds the shapers; of one with loops and a [link], the whole stage. The machine's clock becomes the board's oscillator. Nobody has run such a bitstream on hardware yet.

Exit status: 0 every check holds and the files are written, 1 a check failed, 2 bad input, 3 a tool is missing.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    #[arg(long, value_name = "NAME", help = format!("Board: {}", board_names()))]
    board: String,
    /// For a board without wires: stand-ins take the place of the machine, and no pin but the line's is used
    #[arg(long)]
    bare_board: bool,
    /// Check this packed file, which was built earlier, and write nothing; the exit status is 2 if it is of another machine, board or device
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    packed: Option<PathBuf>,
    /// Output folder: new, empty, or written by posicast before [default: ./NAME]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Clocks of the lock step [default: 2000000 for shapers, 1000000 for a stage, and more if exercising what is checked takes more; with --bare-board as many as the moves take, at most 20000000]
    #[arg(long, value_parser = clocks)]
    clocks: Option<u64>,
    /// Seed of the random commands
    #[arg(long, default_value_t = DEFAULT_SEED)]
    seed: u64,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = Options {
        machine: args.machine.clone(),
        board: args.board.clone(),
        bare: args.bare_board,
        packed: args.packed.clone(),
        output: args.output.clone(),
        clocks: args.clocks,
        seed: args.seed,
    };
    output::show(bitstream(&options, &Terminal)?, args.json, render::bitstream)
}
