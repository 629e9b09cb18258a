//! `wavecmp`: compares two waveforms.

mod own_files;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, Parser, ValueEnum};
use wavecmp::cli::{self, Args, CommandHost, EXAMPLES, INCOMPARABLE};
use wavecmp::diff::{DiffVerdict, JSON_SCHEMA};

use self::own_files::OwnFiles;

/// Compare two waveforms (VCD or FST), sampled at the clock, and list which signals differ, from when on, and how often
#[derive(Parser)]
#[command(name = "wavecmp", version, after_help = EXAMPLES)]
struct Cli {
    #[command(flatten)]
    args: Args,
}

fn main() -> ExitCode {
    let words = std::env::args_os().skip(1).take(2);
    let words: Vec<String> = words.map(|word| word.to_string_lossy().into_owned()).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["--man"] => printed(man()),
        ["--completions", shell] => printed(completions(shell)),
        ["--schema"] => printed(Ok(JSON_SCHEMA.as_bytes().to_vec())),
        _ => compared(&Cli::parse().args),
    }
}

fn compared(args: &Args) -> ExitCode {
    let mut host = OwnFiles::new(args.force());
    match cli::run(args, &mut host) {
        Ok(comparison) => {
            if let Some(line) = cli::verdict(&comparison) {
                host.say(&format!("wavecmp: {line}"));
            }
            match comparison.result {
                DiffVerdict::Equal => ExitCode::SUCCESS,
                DiffVerdict::Different => ExitCode::from(1),
                DiffVerdict::Incomparable => {
                    host.say(&format!("help: {INCOMPARABLE}"));
                    ExitCode::from(2)
                }
            }
        }
        Err(error) => {
            host.say(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

fn printed(content: io::Result<Vec<u8>>) -> ExitCode {
    let printed = content.and_then(|content| io::stdout().lock().write_all(&content));
    match printed {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(2)
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
