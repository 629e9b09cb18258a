//! `posicast diff`: a door to `wavecmp`, with posicast's rules for the files that it writes.

use crate::output;
use posicast_flow::Failure;
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::SealedFiles;
use std::error::Error;
use std::path::Path;
use wavecmp::WaveError;
pub(crate) use wavecmp::cli::Args;
use wavecmp::cli::{self, CommandHost, INCOMPARABLE};
use wavecmp::diff::DiffVerdict;
use wavecmp::files::{OutputSink, WriteContent};

/// For the help.
pub(crate) const EXAMPLES: &str = "\
Examples:
  posicast diff model.vcd rtl.vcd                        exact, at the rising edges of the only clock
  posicast diff rtl.vcd float.vcd --tolerance x_y=1.5 --view 'x_*=q15.16'
  posicast diff a.vcd b.fst --map top.dut=tb.u_dut --clock clk --show first
  posicast diff pins.vcd pins2.vcd --raw --time-tolerance 2ns --glitch 1ns

A SIGNAL is a full name, its end behind a dot, or a pattern: * within a scope, ** across scopes.

Exit status: 0 equal, 1 different, 2 nothing in common or unreadable.";

struct Host(OutputFiles);

impl OutputSink for Host {
    fn mark(&self) -> String {
        SealedFiles.mark()
    }

    fn write(&self, path: &Path, content: &mut WriteContent<'_>) -> Result<(), WaveError> {
        SealedFiles.write(path, content)
    }
}

impl CommandHost for Host {
    fn reads(&mut self, what: &'static str, path: &Path) {
        self.0.input(what, path);
    }

    fn claim(&mut self, option: &str, path: &Path) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(self.0.claim(option, path)?)
    }

    fn writes_standard_output(&self) -> bool {
        self.0.take_standard_output()
    }

    fn print(&self, text: &str) -> std::io::Result<()> {
        use std::io::Write;
        let mut out = std::io::stdout().lock();
        out.write_all(text.as_bytes()).and_then(|()| out.flush())
    }

    fn say(&self, line: &str) {
        output::say(line);
    }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let mut host = Host(OutputFiles::new(args.force()));
    let comparison = cli::run(args, &mut host).map_err(Failure::because)?;
    let Some(line) = cli::verdict(&comparison) else {
        return Ok(());
    };
    match comparison.result {
        DiffVerdict::Incomparable => Err(Failure::input(line).with_help(INCOMPARABLE)),
        _ => Err(Failure::Check(line)),
    }
}
