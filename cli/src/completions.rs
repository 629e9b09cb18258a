//! `posicast completions`: writes scripts with which a shell completes commands and options.

use crate::output;
use clap_complete::Shell;
use posicast_flow::Failure;

/// Print a script that lets a shell complete posicast's commands and options
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast completions bash > ~/.local/share/bash-completion/completions/posicast
  posicast completions fish > ~/.config/fish/completions/posicast.fish
  posicast completions zsh > ~/.zfunc/_posicast      with `fpath+=~/.zfunc` before compinit in ~/.zshrc")]
pub(crate) struct Args {
    /// Shell
    shell: Shell,
}

pub(crate) fn run(args: &Args, command: &mut clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, command, "posicast", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}
