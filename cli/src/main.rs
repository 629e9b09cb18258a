//! The `posicast` command: from a machine's modes to verified input-shaper hardware.
//!
//! There is one file per subcommand. This crate reads arguments, calls the steps of `posicast-flow`, and prints their documents, as JSON
//! or as text ([`render`]); it computes nothing itself.
//! Exit status: 0 all checks hold, 1 a check failed, 2 bad usage or input, 3 a required tool is missing; 130 and 143 after
//! SIGINT and SIGTERM, with nothing left behind.

mod bitstream;
mod campaign;
mod choice;
mod completions;
mod contour;
mod design;
mod diff;
mod doctor;
mod export;
mod failure;
mod generate;
mod host;
mod identify;
mod man;
mod moves;
mod new;
mod output;
mod render;
mod reproduce;
mod run;
mod schema;
mod simulate;
mod style;
mod synth;
mod table;
mod terminal;
mod verify;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use posicast_system::interrupt;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  posicast new stage.toml                             a machine file to start from
  posicast run examples/xy-stage.toml -o xy_stage     everything, with a verdict
  posicast design examples/xy-stage.toml --plot x.svg impulses, residuals and the tap table
  posicast verify examples/xy-stage.toml --cycles 10000000
  posicast diff xy_stage/wave/model.vcd xy_stage/wave/rtl.vcd

Exit status: 0 all checks hold, 1 a check failed, 2 bad usage or input, 3 a needed tool is missing,\n130 or 143 ended by SIGINT or SIGTERM, with nothing left behind.";

/// From a machine's modes to verified input-shaper hardware
#[derive(Parser)]
#[command(name = "posicast", version = posicast_flow::VERSION, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// When to use colours
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    color: style::When,
}

#[derive(Subcommand)]
enum Command {
    New(new::Args),
    Run(run::Args),
    Design(design::Args),
    Export(export::Args),
    Generate(generate::Args),
    Simulate(simulate::Args),
    Verify(verify::Args),
    /// Compare two waveforms (VCD or FST), sampled at the clock
    #[command(after_help = diff::EXAMPLES)]
    Diff(Box<diff::Args>),
    Campaign(campaign::Args),
    Synth(synth::Args),
    Bitstream(bitstream::Args),
    Identify(identify::Args),
    Host(host::Args),
    Reproduce(reproduce::Args),
    Doctor(doctor::Args),
    Schema(schema::Args),
    Completions(completions::Args),
    Man(man::Args),
}

fn main() -> ExitCode {
    // Errors of the arguments are printed before the arguments are known.
    let matches = Cli::command()
        .color(style::of_arguments(std::env::args_os()))
        .get_matches();
    let Cli { command, color } = match Cli::from_arg_matches(&matches) {
        Ok(cli) => cli,
        Err(error) => error.exit(),
    };
    style::set(color);
    if let Err(error) = interrupt::listen() {
        output::say(&format!(
            "warning: temporary files will remain if a signal ends posicast: {error}"
        ));
    }
    let result = match command {
        Command::New(args) => new::run(&args),
        Command::Run(args) => run::run(&args),
        Command::Design(args) => design::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Generate(args) => generate::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Campaign(args) => campaign::run(&args),
        Command::Synth(args) => synth::run(&args),
        Command::Bitstream(args) => bitstream::run(&args),
        Command::Identify(args) => identify::run(&args),
        Command::Host(args) => host::run(&args),
        Command::Reproduce(args) => reproduce::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Schema(args) => schema::run(&args),
        Command::Completions(args) => completions::run(&args, &mut Cli::command()),
        Command::Man(args) => man::run(&args, Cli::command()),
    };
    interrupt::done();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure::report(&failure),
    }
}
