//! `posicast doctor`: reports which of the programs that posicast calls are installed.

mod tools;

use crate::output;
use crate::style;
use crate::table::Table;
use posicast_flow::Failure;
use posicast_system::tool::{self, Ended};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;
use std::time::Duration;
use tools::{Need, TOOLS, Tool};

/// Time limit for a program to print its version: those of YoWASP compile themselves at their first start.
const PATIENCE: Duration = Duration::from_secs(120);
/// Longest version that the table shows, in characters.
const VERSION_LENGTH: usize = 32;

/// List the external programs that posicast calls: installed or not, what they are for, how to get them
#[derive(clap::Args)]
#[command(after_help = "\
A variable such as VERILATOR or POSICAST_YOSYS selects another executable; the table shows the variables that are set.

Exit status: 0 everything that `posicast run` needs is installed, 1 a program is missing or does not start.")]
pub(crate) struct Args {
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let found: Vec<Finding> = TOOLS.iter().map(Finding::for_tool).collect();
    let lacking: Vec<&Finding> = found.iter().filter(|f| f.need == Need::Run && !f.works).collect();
    let missing: Vec<&str> = lacking.iter().map(|f| f.tool).collect();
    if args.json {
        output::print_json(&Document {
            ready: missing.is_empty(),
            missing: &missing,
            tools: &found,
        })?;
    } else {
        output::print_styled(&text(&found))?;
    }
    if missing.is_empty() {
        return Ok(());
    }
    let remedies: Vec<&str> = lacking.iter().map(|f| f.install).collect();
    Err(Failure::Check(format!(
        "`posicast run` needs {}: {}",
        missing.join(", "),
        remedies.join("; ")
    )))
}

/// Result for a tool.
#[derive(Serialize, JsonSchema)]
struct Finding {
    tool: &'static str,
    /// Path of the executable; `None` if there is none.
    executable: Option<String>,
    version: Option<String>,
    /// Whether it is installed and prints its version, if it has an option for that.
    works: bool,
    need: Need,
    purpose: &'static str,
    /// The environment variable that names another executable.
    variable: Option<&'static str>,
    variable_is_set: bool,
    install: &'static str,
}

impl Finding {
    fn for_tool(tool: &Tool) -> Self {
        let programs = tool::executables(tool.variable.unwrap_or(""), tool.names);
        let program = programs.iter().find(|program| tool::located(program).is_some());
        let version = program.map(|program| version(program, tool.version));
        let name = |program: &Path| program.file_name().map(|name| name.to_string_lossy().into_owned());
        Self {
            tool: tool.names[0],
            executable: program.and_then(|program| name(program)),
            works: matches!(version, Some(Ok(_))),
            version: version.and_then(Result::ok).flatten(),
            need: tool.need,
            purpose: tool.purpose,
            variable: tool.variable,
            variable_is_set: tool
                .variable
                .is_some_and(|v| std::env::var_os(v).is_some_and(|v| !v.is_empty())),
            install: tool.install,
        }
    }

    /// The text of the table's cell.
    fn state(&self) -> String {
        let state = match (&self.executable, &self.version) {
            (None, _) => "missing".to_owned(),
            (Some(_), _) if !self.works => "does not start".to_owned(),
            (Some(_), None) => "found".to_owned(),
            (Some(_), Some(version)) => version.clone(),
        };
        let by_name = self.executable.iter().filter(|name| *name != self.tool);
        let by_name: String = by_name.map(|name| format!(", as {name}")).collect();
        let variable = self.variable.filter(|_| self.variable_is_set);
        let by_variable = variable.map_or_else(String::new, |variable| format!(", by ${variable}"));
        state + &by_name + &by_variable
    }
}

/// Asks a program for its version; `None` if it has no option for that, an error if it cannot be started.
fn version(program: &Path, arguments: &[&str]) -> Result<Option<String>, ()> {
    if arguments.is_empty() {
        return Ok(None);
    }
    match tool::run_within(tool::command(program).args(arguments), PATIENCE) {
        Ok(Ended::Well(printed)) => Ok(version_in(&printed)),
        _ => Err(()),
    }
}

/// Returns the first word that looks like a version, or else the beginning of the line.
fn version_in(printed: &str) -> Option<String> {
    let line = Some(tool::version_line(printed)).filter(|line| !line.is_empty())?;
    let is_version = |word: &&str| {
        let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        word.contains('.') && word.split('.').all(digits)
    };
    let version = line.split([' ', '-', '(', ')']).find(is_version);
    Some(version.map_or_else(|| line.chars().take(VERSION_LENGTH).collect(), str::to_owned))
}

fn text(found: &[Finding]) -> String {
    let groups = [
        (Need::Run, "`posicast run` needs"),
        (Need::Option, "Other commands and options"),
        (Need::Development, "Tests of posicast itself"),
    ];
    let mut text = String::new();
    for (need, heading) in groups {
        let mut table = Table::new(&["tool", "version", "for", "install"]);
        for finding in found.iter().filter(|f| f.need == need) {
            let install = if finding.works { "" } else { finding.install };
            let state = match (finding.works, need) {
                (true, _) => style::good(&finding.state()),
                (false, Need::Run) => style::bad(&finding.state()),
                (false, _) => style::doubtful(&finding.state()),
            };
            let cells = [finding.tool, &state, finding.purpose, install];
            table.row(cells.map(str::to_owned));
        }
        text += &format!("{heading}\n{}\n", table.text("  "));
    }
    text.pop();
    text
}

/// `doctor --json`.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Document<'a> {
    /// Whether everything that `run` needs is installed.
    ready: bool,
    missing: &'a [&'a str],
    tools: &'a [Finding],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_found_in_what_the_tools_print() {
        let cases = [
            ("Verilator 5.006 2023-01-22 rev (Debian 5.006-3)\n", "5.006"),
            ("g++ (Debian 12.2.0-14+deb12u1) 12.2.0\nCopyright", "12.2.0"),
            ("Yosys 0.23 (git sha1 7ce5011c24b)", "0.23"),
            (
                "\"nextpnr-ecp5\" -- Next Generation Place and Route (Version nextpnr-0.11.1-7-g4bfd)",
                "0.11.1",
            ),
            ("\n  something else entirely", "something else entirely"),
        ];
        for (printed, version) in cases {
            assert_eq!(version_in(printed).as_deref(), Some(version));
        }
        assert_eq!(version_in("\n\n"), None);
    }
}
