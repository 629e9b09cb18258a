//! Writes what a comparison gives in addition to its result: files, and what GitHub Actions shows.

use std::io::Write as _;
use std::path::PathBuf;

use super::{Args, CliError, CommandHost, Output};
use crate::WaveError;
use crate::diff::{self, Comparison, DiffOptions, DiffVerdict};
use crate::files::write_text;

/// Environment variable with the path from which GitHub Actions takes a step's summary.
const SUMMARY: &str = "GITHUB_STEP_SUMMARY";

pub(super) fn write(
    args: &Args,
    options: &DiffOptions,
    comparison: &Comparison,
    host: &dyn CommandHost,
) -> Result<(), CliError> {
    let Args { a, b, output, .. } = args;
    let Output {
        junit,
        html,
        show,
        merged,
        github,
        ..
    } = output;
    let names = format!("{} {}", a.display(), b.display());
    if let Some(path) = junit {
        write_text(host, path, &diff::junit(comparison, &names))?;
    }
    let different = comparison.result == DiffVerdict::Different;
    if let (Some(base), true) = (show, different)
        && diff::show(host, base, a, b, comparison)?
    {
        host.say(&format!(
            "shown in {}",
            base.with_extension("{vcd,gtkw,sucl,svg}").display()
        ));
    }
    if let (Some(path), true) = (html, different) {
        write_text(host, path, &diff::html(a, b, comparison)?)?;
        host.say(&format!("waves around each difference in {}", path.display()));
    }
    if let Some(path) = merged {
        diff::merged(host, path, a, b, comparison)?;
    }
    if *github {
        let files = format!(
            "{names}{}",
            if options.first {
                ", up to the first difference"
            } else {
                ""
            }
        );
        diff::annotations(comparison, &files)
            .lines()
            .for_each(|line| host.say(line));
        if let Some(path) = std::env::var_os(SUMMARY).filter(|path| !path.is_empty()) {
            let path = PathBuf::from(path);
            let file = std::fs::OpenOptions::new().append(true).create(true).open(&path);
            let text = diff::step_summary(comparison, &files);
            let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
            written.map_err(WaveError::file(&path, "write the step's summary"))?;
        }
    }
    Ok(())
}
