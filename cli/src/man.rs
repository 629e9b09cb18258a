//! `posicast man`: writes the help of every command as a manual page.
//!
//! The synopsis contains the values of the options. The text after the options in the help becomes separate sections:
//! the examples, and the exit status, which every page has.

use crate::output;
use clap::Arg;
use clap_mangen::Man;
use clap_mangen::roff::{Inline, Roff, bold, italic, roman};
use posicast_flow::Failure;
use posicast_flow::text::write_text;
use posicast_system::output::OutputFiles;
use std::path::PathBuf;

/// Write manual pages, one per command, into a folder
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  posicast man ~/.local/share/man/man1      then `man posicast-run`")]
pub(crate) struct Args {
    /// Folder; created if it is missing
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Replace files that posicast did not write, or that were changed since
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: &Args, command: clap::Command) -> Result<(), Failure> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let shown = command.get_subcommands().filter(|one| !one.is_hide_set());
    let pages: Vec<clap::Command> = std::iter::once(&command).chain(shown).cloned().collect();
    std::fs::create_dir_all(&args.folder).map_err(|error| {
        Failure::input(format!("DIR {}: {error}", args.folder.display())).with_help("name a folder that can be created")
    })?;
    let mut outputs = OutputFiles::new(args.force);
    let mut written = Vec::new();
    for page in pages {
        let name = page.get_display_name().unwrap_or_else(|| page.get_name());
        let path = args.folder.join(format!("{name}.1"));
        outputs.claim("DIR", &path).map_err(Failure::because)?;
        let text = page_text(&page).map_err(Failure::because)?;
        written.push((path, text));
    }
    for (path, text) in &written {
        write_text(path, text.as_str())?;
    }
    output::print(&format!(
        "{} pages written to {}\n",
        written.len(),
        args.folder.display()
    ))
}

/// Beginning of the paragraph of a command's help that describes its exit status.
const EXIT_STATUS: &str = "Exit status";
/// The exit status of a command whose help does not describe it.
const STATUS: &str = "0 success, 1 a check failed, 2 bad usage or input, 3 a tool that was asked for is missing.";
/// The exit status after a signal, which applies to every command.
const SIGNALS: &str = "130 or 143 after SIGINT or SIGTERM, with nothing left behind.";

fn page_text(command: &clap::Command) -> std::io::Result<String> {
    let man = Man::new(command.clone()).source(format!("posicast {}", posicast_flow::VERSION));
    let mut synopsis = Roff::new();
    synopsis.control("SH", ["SYNOPSIS"]).text(usage(command));
    let mut parts = vec![
        rendered(|part| man.render_title(part))?,
        rendered(|part| man.render_name_section(part))?,
        synopsis.to_roff(),
        rendered(|part| man.render_description_section(part))?,
        rendered(|part| man.render_options_section(part))?,
    ];
    if command.get_subcommands().next().is_some() {
        parts.push(rendered(|part| man.render_subcommands_section(part))?);
    }
    let after = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    parts.push(end(&after).to_roff());
    // Each part of clap_mangen begins with the same definitions.
    let is_definition = |line: &&str| line.starts_with(".ie \\n(.g") || line.starts_with(".el .ds Aq");
    let (title, others) = parts.split_at(1);
    let others = others
        .iter()
        .flat_map(|part| part.lines().filter(|line| !is_definition(line)));
    let lines = title.iter().flat_map(|part| part.lines()).chain(others);
    Ok(lines.map(|line| format!("{line}\n")).collect())
}

fn rendered(render: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> std::io::Result<String> {
    let mut part = Vec::new();
    render(&mut part)?;
    Ok(String::from_utf8_lossy(&part).into_owned())
}

/// The sections that come from the text after a command's help.
fn end(after: &str) -> Roff {
    let (status, examples): (Vec<&str>, Vec<&str>) = after
        .split("\n\n")
        .partition(|paragraph| paragraph.trim_start().starts_with(EXIT_STATUS));
    let mut end = Roff::new();
    let examples = examples.join("\n\n");
    if !examples.trim().is_empty() {
        end.control("SH", ["EXAMPLES"]).control("nf", []);
        for line in examples.lines().filter(|line| !line.starts_with("Example")) {
            end.text([roman(line)]);
        }
        end.control("fi", []);
    }
    end.control("SH", ["EXIT STATUS"]);
    let own = status
        .first()
        .map(|own| own.split_whitespace().collect::<Vec<_>>().join(" "));
    match own.as_deref().map(|own| own.trim_start_matches(EXIT_STATUS)) {
        // This is the whole list.
        Some(own) if own.starts_with(':') => end.text([roman(own.trim_start_matches(": "))]),
        // This is the meaning of one of the numbers.
        Some(_) => end
            .text([roman(STATUS)])
            .control("PP", [])
            .text([roman(own.unwrap_or_default())]),
        None => end.text([roman(STATUS)]),
    };
    if !after.contains("130") {
        end.control("PP", []).text([roman(SIGNALS)]);
    }
    end
}

/// The name, every option with its value, and the arguments.
fn usage(command: &clap::Command) -> Vec<Inline> {
    let mut line = vec![bold(command.get_bin_name().unwrap_or_else(|| command.get_name()))];
    let shown = command
        .get_arguments()
        .filter(|argument| !argument.is_hide_set() && !["help", "version"].contains(&argument.get_id().as_str()));
    let (arguments, options): (Vec<&Arg>, Vec<&Arg>) = shown.partition(|argument| argument.is_positional());
    for argument in options.into_iter().chain(arguments) {
        let (open, close) = if argument.is_required_set() {
            (" ", "")
        } else {
            (" [", "]")
        };
        line.push(roman(open));
        let short = argument.get_short().map(|short| format!("-{short}"));
        let long = argument.get_long().map(|long| format!("--{long}"));
        let flags: Vec<String> = short.into_iter().chain(long).collect();
        if !flags.is_empty() {
            line.push(bold(flags.join("|")));
        }
        if argument.get_num_args().is_some_and(|number| number.takes_values()) {
            let names: Vec<&str> = argument
                .get_value_names()
                .unwrap_or_default()
                .iter()
                .map(|name| name.as_str())
                .collect();
            line.extend((!flags.is_empty()).then(|| roman(" ")));
            line.push(italic(names.join(" ")));
        }
        line.push(roman(close));
    }
    if command.get_subcommands().next().is_some() {
        line.extend([roman(" "), italic("COMMAND")]);
    }
    line
}
