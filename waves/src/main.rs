//! `wavecmp`: compares two waveforms.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(wavecmp::cli::main(std::env::args_os()))
}
