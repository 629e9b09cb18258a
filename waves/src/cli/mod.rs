//! The command line that `wavecmp` and `posicast diff` share. It needs the feature `cli`.
//!
//! The [`CommandHost`] decides where files may be written, and how a message looks.

mod answers;
mod options;
mod own_files;
mod program;
mod progress;

use std::io;
use std::path::{Path, PathBuf};

use self::options::{How, When, Which};
pub use self::program::{compare, main};
use self::progress::LateBar;
use crate::WaveError;
use crate::diff::{self, Comparison, DiffVerdict};
use crate::files::OutputSink;

/// Examples for the help of `wavecmp`.
pub const EXAMPLES: &str = "\
Examples:
  wavecmp golden.vcd new.vcd                             exact, at the rising edges of the only clock
  wavecmp rtl.vcd float.vcd --tolerance x_y=1.5 --view 'x_*=q15.16'
  wavecmp a.vcd.gz b.fst --map top.dut=tb.u_dut --clock clk --html diff.html
  wavecmp pins.vcd pins2.vcd --raw --time-tolerance 2ns --glitch 1ns
  simulator | wavecmp golden.vcd - --github --junit diff.xml

A SIGNAL is a full name, its end after a dot, or a pattern: * within a scope, ** across scopes.

Exit status: 0 equal, 1 different, 2 nothing in common or unreadable.

wavecmp --man, --completions SHELL and --schema print the manual page, the script for bash, elvish, fish, powershell or zsh, and the
JSON Schema of --json.";

/// The options, for clap.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// First file: VCD (also in gzip, xz or zstd) or FST; `-` is the standard input
    a: PathBuf,
    /// Second file
    b: PathBuf,
    #[command(flatten)]
    when: When,
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    how: How,
    #[command(flatten)]
    output: Output,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
struct Output {
    /// Write the result as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// If the files differ, write one HTML page with the waves around each difference
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// If the files differ, write NAME.vcd with both sides, NAME.gtkw and NAME.sucl that open it there, and NAME.svg
    #[arg(long, value_name = "NAME")]
    show: Option<PathBuf>,
    /// Write one VCD with all signals of both files, and the difference of those that differ
    #[arg(long, value_name = "FILE.vcd")]
    merged: Option<PathBuf>,
    /// Annotate the run of GitHub Actions, and write its step summary
    #[arg(long)]
    github: bool,
    /// List which signals were matched and how, and why the others were not
    #[arg(long)]
    explain: bool,
    /// Replace a file that this program did not write, or that was changed since; never one that this command reads
    #[arg(long)]
    force: bool,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

/// The program that runs the command.
pub trait CommandHost: OutputSink {
    /// Registers a file that the command reads, described by `words` in messages: it is never replaced.
    fn reads(&mut self, what: &'static str, path: &Path);

    /// Requests a file that the command will write, before any work.
    ///
    /// # Errors
    /// A text that says why the file may not be written.
    fn claim(&mut self, option: &str, path: &Path) -> Result<(), Box<dyn std::error::Error + Send + Sync>>;

    /// Returns whether one of the files is the standard output.
    fn writes_standard_output(&self) -> bool;

    /// Prints on standard output.
    ///
    /// # Errors
    /// The error of the operating system.
    fn print(&self, text: &str) -> io::Result<()>;

    /// Writes a message on standard error.
    fn say(&self, line: &str);
}

/// Why the command could not run: exit status 2.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A file or an option is wrong.
    #[error(transparent)]
    Wave(#[from] WaveError),
    /// A file may not be written.
    #[error(transparent)]
    Refused(Box<dyn std::error::Error + Send + Sync>),
    /// Two options exclude each other.
    #[error("{0}")]
    Usage(String),
    /// Standard output cannot be written.
    #[error("cannot write the result: {0}")]
    Print(io::Error),
}

impl Args {
    /// Whether `--force` was given.
    pub fn force(&self) -> bool {
        self.output.force
    }
}

/// Compares, prints and writes the requested files. The result determines the exit status.
///
/// # Errors
/// [`CliError`]: exit status 2.
pub fn run(args: &Args, host: &mut dyn CommandHost) -> Result<Comparison, CliError> {
    let Args { a, b, output, .. } = args;
    let mut options = options::of(args)?;
    options.explain = output.explain;
    claim(args, host)?;
    if output.json && host.writes_standard_output() {
        return Err(CliError::Usage(
            "--json: standard output takes one document, and a file is written there already; name a file for it, or leave \
             out --json"
                .to_owned(),
        ));
    }
    let mut bar = LateBar::new();
    let comparison = diff::compare(a, b, &options, &mut |progress| bar.show(progress));
    bar.clear();
    let comparison = comparison?;
    answers::write(args, &options, &comparison, host)?;
    let text = if output.json {
        let json = serde_json::to_string_pretty(&comparison).map_err(io::Error::other);
        json.map_err(CliError::Print)? + "\n"
    } else {
        format!("{comparison}\n")
    };
    if host.writes_standard_output() {
        host.say(text.trim_end());
    } else {
        match host.print(&text) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => return Err(CliError::Print(error)),
            _ => {}
        }
    }
    Ok(comparison)
}

/// Requests each file that will be written.
fn claim(args: &Args, host: &mut dyn CommandHost) -> Result<(), CliError> {
    let Output {
        junit,
        html,
        show,
        merged,
        ..
    } = &args.output;
    host.reads("the first file", &args.a);
    host.reads("the second file", &args.b);
    if let Some(maps) = args.which.map_file() {
        host.reads("the file of maps", maps);
    }
    for (option, path) in [("--show", show), ("--merged", merged), ("--html", html)] {
        if path.is_some() && [&args.a, &args.b].contains(&&PathBuf::from("-")) {
            return Err(CliError::Usage(format!(
                "{option} reads the files a second time, and the standard input can be read once: save it in a file"
            )));
        }
    }
    if let Some(path) = merged
        .as_ref()
        .filter(|path| path.extension().is_none_or(|end| end != "vcd"))
    {
        return Err(CliError::Usage(format!(
            "--merged {}: the merged file is a VCD: give a name that ends in .vcd",
            path.display()
        )));
    }
    let mut files: Vec<(&str, PathBuf)> = Vec::new();
    files.extend(junit.iter().map(|path| ("--junit", path.clone())));
    files.extend(html.iter().map(|path| ("--html", path.clone())));
    files.extend(
        show.iter()
            .flat_map(|base| diff::shown_files(base))
            .map(|path| ("--show", path)),
    );
    files.extend(
        merged
            .iter()
            .flat_map(|path| diff::merged_files(path))
            .map(|path| ("--merged", path)),
    );
    for (option, path) in files {
        host.claim(option, &path).map_err(CliError::Refused)?;
    }
    Ok(())
}

/// Returns the last line of a command that found a difference or nothing to compare; `None` if everything is equal.
pub fn verdict(comparison: &Comparison) -> Option<String> {
    match comparison.result {
        DiffVerdict::Equal => None,
        DiffVerdict::Different => Some(comparison.differing()),
        DiffVerdict::Incomparable => Some("the files have nothing in common that can be compared".to_owned()),
    }
}

/// Remedy if nothing could be compared.
pub const INCOMPARABLE: &str = "name the clock with --clock, match scopes or signals with --map A=B, and list what was found \
                                with --explain";
