//! The `posicast` command: from a machine's modes to verified input-shaper hardware.
//!
//! There is one file per subcommand. This crate reads arguments, calls the steps of `posicast-flow`, and prints their documents, as JSON
//! or as text (`render`); it computes nothing itself.
//! Exit status: 0 all checks hold, 1 a check failed, 2 bad usage or input, 3 a required tool is missing; 130 and 143 after
//! SIGINT and SIGTERM, with nothing left behind.
//!
//! It is a library with the function [`main`], because two programs call it: `src/main.rs`, and the console script of the Python package.

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
pub mod schema;
mod simulate;
mod style;
mod synth;
mod table;
mod terminal;
mod verify;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use posicast_system::interrupt;
use std::ffi::OsString;

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

/// Runs the command with these arguments, of which the first is the program's name, and returns the exit status.
///
/// Call it once in a process, which then ends: it handles SIGINT, SIGTERM and SIGHUP from the start, and makes no temporary file any more
/// when it has returned.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    // Errors of the arguments are printed before the arguments are known.
    let command = Cli::command().color(style::of_arguments(arguments.iter().cloned()));
    let parsed = command.try_get_matches_from(&arguments);
    let Cli { command, color } = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => return refused(&error),
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
        Command::Campaign(args) => campaign::run(&args, &arguments),
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
    let status = match result {
        Ok(()) => 0,
        Err(failure) => failure::report(&failure),
    };
    output::flush();
    status
}

/// Prints why the arguments were refused, or the help or version that they ask for, and returns the exit status.
fn refused(error: &clap::Error) -> u8 {
    // If it cannot be printed, nothing sensible is left to do.
    let _ = error.print();
    output::flush();
    u8::try_from(error.exit_code()).unwrap_or(2)
}
