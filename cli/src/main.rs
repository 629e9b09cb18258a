//! The program `posicast`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(posicast_cli::main(std::env::args_os()))
}
