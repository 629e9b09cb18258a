//! `posicast generate`: writes the Verilog of a machine, and the files that Quartus needs with it, into a folder.

use crate::terminal::Terminal;
use crate::{output, render};
use posicast_flow::Failure;
use posicast_flow::block_kit::{self, generate_block};
use posicast_flow::generate::{Options, generate};
use posicast_flow::hal::SERVO_HZ;
use std::path::PathBuf;

/// Write the machine's Verilog, its components and its Quartus projects into a folder
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast generate examples/xy-stage.toml -o xy_stage
  posicast generate --block step_generator -o step_generator
  posicast generate examples/xy-stage.toml --block pulse_counter

It prints the number of files and their folder, the top modules, and what to do next.")]
pub(crate) struct Args {
    /// Machine file
    #[arg(required_unless_present = "block")]
    machine: Option<PathBuf>,
    /// Write one block alone, with its bench, proofs, datasheet and buses: at the sizes of the machine file, or of the library
    #[arg(long, value_name = "NAME", conflicts_with = "hal")]
    block: Option<String>,
    /// Output folder: new, empty, or written by posicast before [default: ./NAME]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Also write what LinuxCNC needs: its real-time component, HAL and INI files, tap tables at the servo rate
    #[arg(long)]
    hal: bool,
    /// Rate of LinuxCNC's servo thread in Hz
    #[arg(long, value_name = "HZ", requires = "hal", default_value_t = SERVO_HZ)]
    servo_hz: f64,
    /// List every file that was written
    #[arg(short, long)]
    verbose: bool,
    /// Print one JSON document on standard output: name, folder, top modules, files
    #[arg(long, conflicts_with = "verbose")]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(block) = &args.block {
        let kit = generate_block(
            &block_kit::Options {
                block: block.clone(),
                machine: args.machine.clone(),
                output: args.output.clone(),
            },
            &Terminal,
        )?;
        let text = if args.verbose {
            render::list_block
        } else {
            render::block
        };
        return output::show(kit, args.json, text);
    }
    let options = Options {
        machine: args.machine.clone().unwrap_or_default(),
        output: args.output.clone(),
        servo_hz: args.hal.then_some(args.servo_hz),
    };
    let generated = generate(&options, &Terminal)?;
    let text = if args.verbose { render::list } else { render::generate };
    output::show(generated, args.json, text)
}
