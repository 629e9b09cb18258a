//! `posicast diff`: two waveform files compared.

use crate::failure::Failure;
use crate::{output, progress};
use posicast_testbench::diff::{self, Comparison, Options, Verdict};
use std::path::PathBuf;

/// Compare two VCD files, sampled at the clock
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast diff model.vcd rtl.vcd                        exact, at the rising edges of the only clock
  posicast diff rtl.vcd float.vcd --tolerance x_y=1.5
  posicast diff a.vcd b.vcd --map top.dut=tb.u_dut --clock clk

Exit status: 0 equal, 1 different, 2 nothing in common or unreadable.")]
pub(crate) struct Args {
    /// First file
    a: PathBuf,
    /// Second file
    b: PathBuf,
    /// Sample at the rising edge of this 1-bit signal [default: the only clock found, else every change]
    #[arg(long, value_name = "NAME")]
    clock: Option<String>,
    /// Scope or signal A of the first file is B of the second (repeatable)
    #[arg(long, value_name = "A=B")]
    map: Vec<String>,
    /// Largest difference that counts as equal, in LSB, of one signal or of all (repeatable)
    #[arg(long, value_name = "[SIGNAL=]LSB")]
    tolerance: Vec<String>,
    /// A signal that only one file has is a difference; without it such signals are only listed
    #[arg(long)]
    require_all: bool,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let mut options = Options {
        clock: args.clock.clone(),
        require_all: args.require_all,
        ..Options::default()
    };
    for map in &args.map {
        options.add_map(map).map_err(Failure::because)?;
    }
    for tolerance in &args.tolerance {
        options.add_tolerance(tolerance).map_err(Failure::because)?;
    }
    let spinner = progress::spinner("comparing");
    let comparison = diff::compare(&args.a, &args.b, &options, &mut |samples| spinner.set_position(samples))
        .map_err(Failure::because)?;
    spinner.finish_and_clear();
    if args.json {
        output::print_json(&comparison)?
    } else {
        output::print(&comparison.to_string())?
    }
    verdict(&comparison)
}

fn verdict(comparison: &Comparison) -> Result<(), Failure> {
    match comparison.result {
        Verdict::Equal => Ok(()),
        Verdict::Different => Err(Failure::Check(format!(
            "{} signals differ",
            comparison.differences.len()
        ))),
        Verdict::Incomparable => Err(Failure::from(miette::miette!(
            help = "name the clock with --clock, or say with --map A=B which scope or signal is which",
            "the files have nothing in common that can be compared"
        ))),
    }
}
