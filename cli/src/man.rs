//! `posicast man`: writes the help of every command as a manual page.

use crate::failure::Failure;
use crate::output;
use clap_mangen::Man;
use posicast_system::output::{self as files, OutputFiles};
use std::path::PathBuf;

/// Write manual pages, one per command, into a folder
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  posicast man ~/.local/share/man/man1      then `man posicast-run`")]
pub(crate) struct Args {
    /// Folder, made where it is missing
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
        Failure::from(miette::miette!(
            help = "name a folder that can be made",
            "DIR {}: {error}",
            args.folder.display()
        ))
    })?;
    let mut outputs = OutputFiles::new(args.force);
    let mut written = Vec::new();
    for page in pages {
        let name = page.get_display_name().unwrap_or_else(|| page.get_name());
        let path = args.folder.join(format!("{name}.1"));
        outputs.claim("DIR", &path).map_err(Failure::because)?;
        let mut text = Vec::new();
        Man::new(page).render(&mut text).map_err(Failure::because)?;
        written.push((path, text));
    }
    for (path, text) in &written {
        files::write_text(path, &String::from_utf8_lossy(text)).map_err(Failure::because)?;
    }
    output::print(&format!(
        "{} pages written to {}\n",
        written.len(),
        args.folder.display()
    ))
}
