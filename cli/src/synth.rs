//! `posicast synth`: estimates the resources that a machine's Verilog needs on a device.

use crate::terminal::Terminal;
use crate::{output, render};
use posicast_flow::Failure;
use posicast_flow::synth::{Options, synth};
use posicast_synth::yosys::Family;
use std::path::PathBuf;

/// Estimate logic cells, registers, memory and multipliers of the machine's Verilog
#[derive(clap::Args)]
#[command(after_help = "Example:\n  posicast synth examples/xy-stage.toml --family cyclone5")]
pub(crate) struct Args {
    /// Machine file, or a folder that `generate` or `run` wrote
    source: PathBuf,
    /// Device family: cyclone2, cyclone4e, cyclone10lp, cyclone5, max10 [default: the machine file's, else cyclone5]
    #[arg(long)]
    family: Option<Family>,
    /// Estimate the clock of this top module, by place and route on an open family as a proxy: takes minutes for a stage; may
    /// be given several times
    #[arg(long, value_name = "TOP")]
    clock: Vec<String>,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = Options {
        source: args.source.clone(),
        family: args.family,
        clock: args.clock.clone(),
    };
    output::show(synth(&options, &Terminal)?, args.json, render::synth)
}
