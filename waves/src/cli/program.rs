//! The program `wavecmp`.

use std::ffi::OsString;
use std::io::{self, Write};

use clap::{CommandFactory, Parser, ValueEnum};

use super::own_files::OwnFiles;
use super::{Args, CliError, CommandHost, EXAMPLES, INCOMPARABLE, options, run, verdict};
use crate::diff::{self, Comparison, DiffVerdict, JSON_SCHEMA};

/// Exit status for unreadable files, wrong usage, and files with nothing in common.
const TROUBLE: u8 = 2;

/// Compare two waveforms (VCD or FST), sampled at the clock, and list which signals differ, from when on, and how often
#[derive(Parser)]
#[command(name = "wavecmp", version, after_help = EXAMPLES)]
struct Cli {
    #[command(flatten)]
    args: Args,
}

/// Runs the command with these arguments, of which the first is the program's name, and returns the exit status.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let words: Vec<_> = arguments
        .iter()
        .skip(1)
        .take(2)
        .map(|word| word.to_string_lossy())
        .collect();
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words[..] {
        ["--man"] => printed(man()),
        ["--completions", shell] => printed(completions(shell)),
        ["--schema"] => printed(Ok(JSON_SCHEMA.as_bytes().to_vec())),
        _ => match Cli::try_parse_from(&arguments) {
            Ok(cli) => compared(&cli.args),
            Err(error) => {
                // If it cannot be printed, nothing sensible is left to do.
                let _ = error.print();
                u8::try_from(error.exit_code()).unwrap_or(TROUBLE)
            }
        },
    }
}

/// Compares two files as the command with these arguments does, without printing or writing anything. The first argument is the program's
/// name.
///
/// # Errors
/// [`CliError`] for arguments and files that are wrong.
pub fn compare(arguments: impl IntoIterator<Item = OsString>) -> Result<Comparison, CliError> {
    let Cli { args } = Cli::try_parse_from(arguments).map_err(|error| {
        let text = error.to_string();
        CliError::Usage(text.strip_prefix("error: ").unwrap_or(&text).trim_end().to_owned())
    })?;
    let mut options = options::of(&args)?;
    options.explain = args.output.explain;
    Ok(diff::compare(&args.a, &args.b, &options, &mut |_| {})?)
}

fn compared(args: &Args) -> u8 {
    let mut host = OwnFiles::new(args.force());
    match run(args, &mut host) {
        Ok(comparison) => {
            if let Some(line) = verdict(&comparison) {
                host.say(&format!("wavecmp: {line}"));
            }
            match comparison.result {
                DiffVerdict::Equal => 0,
                DiffVerdict::Different => 1,
                DiffVerdict::Incomparable => {
                    host.say(&format!("help: {INCOMPARABLE}"));
                    TROUBLE
                }
            }
        }
        Err(error) => {
            host.say(&format!("error: {error}"));
            TROUBLE
        }
    }
}

fn printed(content: io::Result<Vec<u8>>) -> u8 {
    let mut out = io::stdout().lock();
    // Rust's own `main` would flush, but Python's does not.
    let printed = content.and_then(|content| out.write_all(&content).and_then(|()| out.flush()));
    match printed {
        Ok(()) => 0,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            TROUBLE
        }
    }
}

fn man() -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Cli::command()).render(&mut page)?;
    Ok(page)
}

fn completions(shell: &str) -> io::Result<Vec<u8>> {
    let shell = clap_complete::Shell::from_str(shell, true)
        .map_err(|_| io::Error::other(format!("--completions {shell}: bash, elvish, fish, powershell or zsh")))?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "wavecmp", &mut script);
    Ok(script)
}
